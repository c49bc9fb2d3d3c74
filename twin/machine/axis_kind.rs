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
    const fn turns(self) -> bool {
        matches!(self, Self::Rotary)
    }

    /// In machine files.
    pub(crate) const fn name(self) -> &'static str {
        if self.turns() { "rotary" } else { "linear" }
    }

    /// The unit that people read and write.
    pub const fn unit(self) -> &'static str {
        if self.turns() { "deg" } else { "mm" }
    }

    /// The unit of what its motor gives.
    pub const fn effort_unit(self) -> &'static str {
        if self.turns() { "Nm" } else { "N" }
    }

    /// Name of the motor's effort: torque or force.
    pub const fn effort_name(self) -> &'static str {
        if self.turns() { "torque" } else { "force" }
    }

    /// One such unit in SI.
    pub const fn scale(self) -> f64 {
        if self.turns() { std::f64::consts::PI / 180.0 } else { 1e-3 }
    }
}
