//! Set-point interpolation between two cycles.

use twin_kinematics::AxisMotion;

use crate::checked;
use crate::error::Result;
use crate::joint::JointVector;

/// A set-point in the shape of joint-space mathematics.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setpoint {
    pub(super) position: JointVector,
    pub(super) velocity: JointVector,
    pub(super) acceleration: JointVector,
}

impl Setpoint {
    pub(super) fn new(motion: &AxisMotion, axes: usize, time_ns: i64) -> Result<Self> {
        Ok(Self {
            position: checked(&motion.position, axes, time_ns)?,
            velocity: checked(&motion.velocity, axes, time_ns)?,
            acceleration: checked(&motion.acceleration, axes, time_ns)?,
        })
    }

    /// Set-point at `phase` (0 to 1) towards `end`, `duration` (s) later: cubic in position, linear in
    /// acceleration.
    pub(super) fn towards(&self, end: &Self, phase: f64, duration: f64) -> Self {
        let rest = 1.0 - phase;
        let distance = end.position - self.position;
        let position = self.position * (rest * rest * (1.0 + 2.0 * phase))
            + end.position * (phase * phase * (3.0 - 2.0 * phase))
            + (self.velocity * rest - end.velocity * phase) * (phase * rest * duration);
        let velocity = distance * (6.0 * phase * rest / duration)
            + self.velocity * (rest * (1.0 - 3.0 * phase))
            + end.velocity * (phase * (3.0 * phase - 2.0));
        Self {
            position,
            velocity,
            acceleration: self.acceleration * rest + end.acceleration * phase,
        }
    }
}
