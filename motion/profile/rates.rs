//! Limits of ramps under limited jerk, with the values derived from them.

use super::AxisLimits;

/// Limits, and values computed from them once for all ramps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rates {
    /// Largest velocity, u/s, growth and fall of the speed, u/s².
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
    pub(super) deceleration: f64,
    /// Largest jerk, u/s³, and its reciprocal.
    pub(super) jerk: f64,
    pub(super) inverse: f64,
}

impl From<&AxisLimits> for Rates {
    fn from(limits: &AxisLimits) -> Self {
        let AxisLimits { velocity, acceleration, deceleration, jerk } = *limits;
        Self { velocity, acceleration, deceleration, jerk, inverse: jerk.recip() }
    }
}

/// −1 for negative values, otherwise 1.
pub(super) fn side(value: f64) -> f64 {
    if value < 0.0 { -1.0 } else { 1.0 }
}

impl Rates {
    /// Velocity at which the acceleration gets 0 if it is taken back from now on with the largest jerk, u/s.
    pub(super) fn settled(&self, velocity: f64, acceleration: f64) -> f64 {
        velocity + 0.5 * acceleration * acceleration.abs() * self.inverse
    }
}
