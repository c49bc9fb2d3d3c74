//! Reasons why homing by a switch fails, with the manual's numbers (9.3) where it has them.

/// Fault of homing by a switch. Values are in the unit of the caller: technical units, or increments.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HomingFault {
    /// The axis is on a limit switch that is watched; the manual has no other number than that of the software limits
    /// (`SMC_DI_SWLIMITS_EXCEEDED`).
    #[error("position {position} is on the {} limit switch", if *.positive { "positive" } else { "negative" })]
    HardwareLimit {
        /// Position of the axis.
        position: f64,
        /// On that towards larger positions.
        positive: bool,
    },
    /// A velocity, acceleration or deceleration of homing is impossible (`SMC_3SH_INVALID_VELACC_VALUES`).
    #[error("homing cannot be done with {what} = {value}")]
    Value {
        /// Name of the value.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// Homing past the switch needs watched limit switches (`SMC_3SH_MODE_NEEDS_HWLIMIT`).
    #[error("this homing mode needs the limit switches: bIgnoreHWLimit must be FALSE")]
    NeedsHardwareLimit,
    /// Homing has gone as far as it may.
    #[error("{what} has not come within {travel} from {from}")]
    Travel {
        /// Signal that was sought.
        what: &'static str,
        /// Start of the search.
        from: f64,
        /// Longest way.
        travel: f64,
    },
    /// The axis was past the home switch before it stood still.
    #[error(
        "the home switch is shorter than the way the axis brakes: it is at {position}, past it"
    )]
    SwitchPassed {
        /// Position of the axis.
        position: f64,
    },
    /// The axis is not where homing has sent it.
    #[error("the axis is at {position} instead of {target}")]
    NotArrived {
        /// Position of the axis.
        position: f64,
        /// Target.
        target: f64,
    },
}

impl HomingFault {
    /// Number of the manual's `SMC_Error`; `None` where it has none.
    pub fn number(&self) -> Option<u16> {
        match self {
            Self::HardwareLimit { .. } => Some(10),
            Self::Value { .. } => Some(50),
            Self::NeedsHardwareLimit => Some(51),
            Self::Travel { .. } | Self::SwitchPassed { .. } | Self::NotArrived { .. } => None,
        }
    }
}
