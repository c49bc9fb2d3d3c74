//! Motion of one axis over time: to a position, to a velocity, to a halt (manual 2.1.3, 5.3).
//!
//! ```text
//! State, target, AxisLimits, RampType → Profile → at(t) → State
//! ```
//!
//! A profile may start from any state of motion. It goes on from there without a step of the velocity, with sigmoid and
//! parabolic ramps without one of the acceleration. What cannot be met on the way is met by going past and coming back.
//!
//! `acceleration` limits how fast the speed may grow and `deceleration` how fast it may fall, in both directions of
//! travel. A profile that starts beyond a limit first comes back to it, as fast as the other limits allow, and then
//! keeps it.
//!
//! No clock and no allocation: a profile is a plain value with room for all the segments it can have.

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

/// Where an axis is and how it moves, in units of the axis.
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

/// What a profile keeps to. All are positive.
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
