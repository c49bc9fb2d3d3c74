//! Goal, result and error of the ramp-in optimisation.

use super::super::super::coupling::CouplingError;
use super::super::super::selection::{CamInput, CamTable};
use crate::{Quantity, SlaveLimits};
use twin_number::Short;
use twin_profile::{ProfileError, RampType, State};

/// What a ramp is to be best in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RampGoal {
    /// The slave is on its cam as soon as what the cam leaves of its limits allows.
    Soonest,
    /// The ramp has the smallest velocity, acceleration or jerk with which the slave is on its cam in this time.
    Gentlest {
        /// s.
        within_s: f64,
        /// Of what the peak is to be small; the jerk only of parabolic and sigmoid ramps.
        least: Quantity,
    },
}

/// A start with a ramp.
#[derive(Clone, Debug)]
pub struct RampWish {
    /// The cam as `MC_CamTableSelect` gives it.
    pub table: CamTable,
    /// Inputs of `MC_CamIn`; what it says of a ramp does not count but for the direction of the start mode.
    pub input: CamInput,
    /// Where the master is at the start and how fast it goes on; its acceleration does not count.
    pub master: State,
    /// Where the slave is at the start, and its velocity.
    pub slave: State,
    /// The ramps of the slave's axis: [`RampType::Trapezoid`], whose acceleration steps, so that the limits have no jerk, or
    /// [`RampType::Parabolic`] or [`RampType::Sigmoid`] with the jerk of the limits.
    pub ramp: RampType,
    /// What the slave may do; velocity and acceleration finite, with parabolic and sigmoid ramps the jerk as well.
    pub limits: SlaveLimits,
    /// Least and greatest position of the slave, u; infinite where there is no limit.
    pub position: [f64; 2],
    /// What the ramp is to be best in.
    pub goal: RampGoal,
}

/// A ramp, and what comes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RampIn {
    /// `VelocityDiff`, u/s.
    pub velocity_difference: f64,
    /// `Acceleration`, u/s².
    pub acceleration: f64,
    /// `Deceleration`, u/s².
    pub deceleration: f64,
    /// The jerk of the slave's axis that belongs to it, u/s³; without meaning for trapezoid ramps.
    pub ramp_jerk: f64,
    /// When the slave is on its cam, s after the start.
    pub duration_s: f64,
    /// The largest velocity of the slave until then, u/s.
    pub peak_velocity: f64,
    /// The largest acceleration of the slave until then, u/s².
    pub peak_acceleration: f64,
    /// Jerk that the slave does not exceed until then, u/s³: that of the ramp and the largest one of the cam. Infinite with
    /// trapezoid ramps.
    pub peak_jerk: f64,
    /// Least and greatest position of the slave until then, u.
    pub positions: [f64; 2],
}

impl RampIn {
    pub(super) fn peak(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Velocity => self.peak_velocity,
            Quantity::Acceleration => self.peak_acceleration,
            Quantity::Jerk => self.peak_jerk,
        }
    }
}

/// Reason why no ramp is found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RampError {
    /// The coupling does not start.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// The profile of the ramp cannot be computed.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// A ramp needs a limit of this.
    #[error("a ramp needs a limit of the slave's {what} that is greater than 0; {}",
        if .value.is_infinite() { "none is given".to_owned() } else { format!("it is {value}") })]
    NoLimit {
        /// Velocity, acceleration or jerk.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// A jerk limit with a ramp whose acceleration steps.
    #[error(
        "the acceleration of a trapezoid ramp steps, so that it has no limit of the jerk: use parabolic or sigmoid ramps"
    )]
    Steps,
    /// The start exceeds a limit.
    #[error("the slave's {what} is {} until it is on its cam, its limit is {}: start it elsewhere, slower or at another place of the master",
        Short(*.reached), Short(*.limit))]
    Beyond {
        /// Position, velocity or acceleration.
        what: &'static str,
        /// What is reached, u, u/s or u/s².
        reached: f64,
        /// Its limit.
        limit: f64,
    },
    /// The cam leaves nothing over for a ramp.
    #[error("the cam alone takes the slave's {what} to {} on the way, its limit is {}: nothing is left for a ramp",
        Short(*.peak), Short(*.limit))]
    NoRoom {
        /// Velocity, acceleration or jerk.
        what: &'static str,
        /// What the cam reaches, u/s, u/s² or u/s³.
        peak: f64,
        /// Its limit.
        limit: f64,
    },
    /// The limits do not allow a ramp as short as it should be.
    #[error("the slave is on its cam after {} s at the earliest, not within {} s", Short(*.soonest_s), Short(*.within_s))]
    TooLate {
        /// The shortest ramp that was found, s.
        soonest_s: f64,
        /// The time it was to take at most, s.
        within_s: f64,
    },
    /// The shortest ramp is longer than any sensible one.
    #[error("the slave is on its cam after {} s at the earliest, which is more than {} s: it is too far from the cam, or \
             the limits are too small", Short(*.soonest_s), Short(*.most_s))]
    TooLong {
        /// The shortest ramp that was found, s.
        soonest_s: f64,
        /// The longest sensible ramp, s.
        most_s: f64,
    },
}
