//! Motion profiles of one axis: to a position, to a velocity, to a halt (manual 2.1.3, 5.3).
//!
//! ```text
//! State, target, AxisLimits, RampType → Profile → at(t) → State
//! ```
//!
//! A profile may start from any state of motion. It continues from there without a step of the velocity, and with
//! sigmoid and parabolic ramps without a step of the acceleration. If the target cannot be reached directly, the
//! profile overshoots and comes back.
//!
//! `acceleration` limits how fast the speed may grow and `deceleration` how fast it may fall, in both directions of
//! travel. A profile that starts beyond a limit first returns to it, as fast as the other limits allow, and then keeps
//! it.
//!
//! There is no clock and no allocation: a profile is a plain value with room for the largest number of segments.
//!
//! ```
//! use twin_profile::{AxisLimits, Profile, RampType, State};
//!
//! // 100 mm at 10 mm/s, with 20 mm/s² both ways: s/v + v/a = 10 s + 0.5 s.
//! let limits = AxisLimits { velocity: 10.0, acceleration: 20.0, deceleration: 20.0, jerk: 200.0 };
//! let from = State::resting(0.0);
//! let steps = Profile::to_position(from, 100.0, 0.0, limits, RampType::Trapezoid)?;
//! assert!((steps.duration() - 10.5).abs() < 1e-12);
//! // A jerk of 200 mm/s³ adds a/j = 0.1 s.
//! let smooth = Profile::to_position(from, 100.0, 0.0, limits, RampType::Parabolic)?;
//! assert!((smooth.duration() - 10.6).abs() < 1e-12);
//! assert!((smooth.at(5.3).position - 50.0).abs() < 1e-9, "half of the way after half of the time");
//! # Ok::<(), twin_profile::ProfileError>(())
//! ```

mod error;
mod parabolic;
mod planned;
mod rates;
mod segment;
mod sigmoid;
mod table;
#[cfg(test)]
mod tests;
mod trapezoid;

pub use error::ProfileError;
pub use planned::Profile;
pub use table::{MOST_POINTS, ProfilePoint, ProfileTable, TableProfile};

/// Motion state of an axis: position, velocity and acceleration, in units of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Position, u.
    pub position: f64,
    /// Velocity, u/s.
    pub velocity: f64,
    /// Acceleration, u/s²: that of the velocity with its sign, so that it is negative where a positive velocity falls.
    pub acceleration: f64,
}

impl State {
    /// At rest at `position` u.
    pub fn resting(position: f64) -> Self {
        Self { position, ..Self::default() }
    }
}

/// Shape of the velocity between two constant velocities (`Type de rampe de vitesse`, manual 2.1.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RampType {
    /// Constant acceleration; it steps.
    #[default]
    Trapezoid,
    /// The velocity follows sin², the acceleration is continuous.
    Sigmoid,
    /// The acceleration is continuous and changes with constant jerk up to its limit; the velocity consists of
    /// parabolas. The fastest motion under a limited jerk.
    Parabolic,
}

/// Limits of a profile. All are positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Largest speed in both directions, u/s.
    pub velocity: f64,
    /// Largest growth of the speed, u/s².
    pub acceleration: f64,
    /// Largest fall of the speed, u/s².
    pub deceleration: f64,
    /// Largest change of the acceleration, u/s³; without meaning for [`RampType::Trapezoid`].
    pub jerk: f64,
}

impl AxisLimits {
    /// Largest growth (`true`) or fall of the speed, u/s².
    fn rate(self, grows: bool) -> f64 {
        if grows { self.acceleration } else { self.deceleration }
    }
}
