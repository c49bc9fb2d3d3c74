//! Kind of an axis, rotary or linear, and its units.

/// Kind of an axis, rotary or linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisKind {
    /// Positions in rad, shown in degrees.
    Rotary,
    /// Positions in m, shown in mm.
    Linear,
}

impl AxisKind {
    /// In machine files.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Rotary => "rotary",
            Self::Linear => "linear",
        }
    }

    /// The unit that people read and write.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Rotary => "deg",
            Self::Linear => "mm",
        }
    }

    /// The unit of what its motor gives.
    pub const fn effort_unit(self) -> &'static str {
        match self {
            Self::Rotary => "Nm",
            Self::Linear => "N",
        }
    }

    /// Name of the motor's effort: torque or force.
    pub const fn effort_name(self) -> &'static str {
        match self {
            Self::Rotary => "torque",
            Self::Linear => "force",
        }
    }

    /// One such unit in SI.
    pub const fn scale(self) -> f64 {
        match self {
            Self::Rotary => std::f64::consts::PI / 180.0,
            Self::Linear => 1e-3,
        }
    }
}
