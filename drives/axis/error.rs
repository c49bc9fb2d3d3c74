//! What goes wrong with an axis, by the manual's numbers (9.3) where it has one.

use super::mode::ControlType;

/// What goes wrong with an axis. Values are in the unit of who asked: technical units, or increments.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AxisError {
    /// The axis has left its window (`SMC_DI_SWLIMITS_EXCEEDED`).
    #[error("position {position} is outside the software limits ({negative} to {positive})")]
    SoftwareLimit {
        /// Where it is.
        position: f64,
        /// `fSWLimitNegative`.
        negative: f64,
        /// `fSWLimitPositive`.
        positive: f64,
    },
    /// The axis is on a limit switch that is watched; the manual has no other number than that of the software limits.
    #[error("position {position} is on the {} limit switch", side(*.positive))]
    HardwareLimit {
        /// Where it is.
        position: f64,
        /// On that towards larger positions.
        positive: bool,
    },
    /// A velocity, acceleration or deceleration of homing is impossible (`SMC_3SH_INVALID_VELACC_VALUES`).
    #[error("homing cannot be done with {what} = {value}")]
    HomingValue {
        /// Which.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// Homing past the switch wants the limit switches to be watched (`SMC_3SH_MODE_NEEDS_HWLIMIT`).
    #[error("this homing mode needs the limit switches: bIgnoreHWLimit must be FALSE")]
    NeedsHardwareLimit,
    /// Homing has gone as far as it may.
    #[error("{what} has not come within {travel} from {from}")]
    Travel {
        /// What was sought.
        what: &'static str,
        /// Where the search began.
        from: f64,
        /// How far it may go.
        travel: f64,
    },
    /// The axis was past the home switch before it stood still.
    #[error(
        "the home switch is shorter than the way the axis brakes: it stands at {position}, past it"
    )]
    SwitchPassed {
        /// Where it stands.
        position: f64,
    },
    /// The axis does not stand where homing has sent it.
    #[error("the axis stands at {position} instead of {target}")]
    NotArrived {
        /// Where it stands.
        position: f64,
        /// Where it should be.
        target: f64,
    },
    /// The device does not exchange these values.
    #[error("control type {control:?} is not supported")]
    ControlType {
        /// The type.
        control: ControlType,
    },
    /// The start-up of an axis group has failed (`SMC_RAG_ERROR_DURING_STARTUP`).
    #[error("start-up has failed: {text}")]
    StartUp {
        /// What has gone wrong (`g_strBootupError`).
        text: String,
    },
    /// A conversion without sense (`SMC_CGR_ZERO_VALUES`).
    #[error("{what} = {value} is impossible")]
    Gearing {
        /// Which.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// The axis is powered and cannot be changed (`SMC_CGR_DRIVE_POWERED`).
    #[error("the gearing cannot be changed while the drive is powered")]
    Powered,
    /// A position is beyond what can be counted.
    #[error("position {position} is beyond what increments can say")]
    Overflow {
        /// The position, units or increments.
        position: f64,
    },
    /// The log file cannot be opened (`SMC_ADL_FILE_CANNOT_BE_OPENED`).
    #[error("the log file cannot be opened: {reason}")]
    LogNotOpened {
        /// What the operating system says.
        reason: String,
    },
    /// The log's buffer is full (`SMC_ADL_BUFFER_OVERRUN`).
    #[error("the log's buffer of {capacity} bytes is full: call WriteToFile more often")]
    LogOverrun {
        /// Its size.
        capacity: usize,
    },
    /// The log file cannot be written.
    #[error("the log file cannot be written: {reason}")]
    LogNotWritten {
        /// What the operating system says.
        reason: String,
    },
}

fn side(positive: bool) -> &'static str {
    if positive { "positive" } else { "negative" }
}

impl AxisError {
    /// Number of the manual's `SMC_Error`; `None` where it has none.
    pub fn number(&self) -> Option<u16> {
        match self {
            Self::SoftwareLimit { .. } | Self::HardwareLimit { .. } => Some(10),
            Self::HomingValue { .. } => Some(50),
            Self::NeedsHardwareLimit => Some(51),
            Self::StartUp { .. } => Some(80),
            Self::Gearing { .. } => Some(90),
            Self::Powered => Some(91),
            Self::LogNotOpened { .. } => Some(2100),
            Self::LogOverrun { .. } => Some(2101),
            Self::Travel { .. }
            | Self::SwitchPassed { .. }
            | Self::NotArrived { .. }
            | Self::ControlType { .. }
            | Self::Overflow { .. }
            | Self::LogNotWritten { .. } => None,
        }
    }
}
