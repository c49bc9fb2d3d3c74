//! Goal, result and error of the ramp-in optimisation.

use super::super::super::coupling::CouplingError;
use super::super::super::selection::{CamInput, CamTable};
use crate::{Quantity, SlaveLimits};
use twin_number::Short;
use twin_profile::{ProfileError, RampType, State};

/// What a ramp is to be best in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RampGoal {
    /// The slave is on its cam as soon as its limits allow.
    Soonest,
    /// The largest velocity, acceleration or jerk of the slave until it is on its cam is as small as can be, and it is there
    /// in this time.
    Gentlest {
        /// s.
        within_s: f64,
        /// Of what the peak is to be small. For the jerk of parabolic and sigmoid ramps that of the axis is found, too.
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
    /// The ramps of the slave's axis: [`RampType::Trapezoid`], whose acceleration steps, which is a jerk of the step by the
    /// time of a cycle, or [`RampType::Parabolic`] or [`RampType::Sigmoid`] with the jerk of the limits.
    pub ramp: RampType,
    /// What the slave may do; velocity and acceleration finite, with parabolic and sigmoid ramps the jerk as well. `MC_CamIn`
    /// has no input for the jerk of a ramp: the axis's own is found so that this limit holds for ramp and cam together.
    pub limits: SlaveLimits,
    /// Least and greatest position of the slave, u; infinite where there is no limit.
    pub position: [f64; 2],
    /// Time from one set-point to the next, s.
    pub cycle_s: f64,
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
    /// The jerk of the slave's axis that belongs to it, u/s³: that of the limits, or less where the smallest jerk is wished or the
    /// cam needs a part of it.
    /// Without meaning for trapezoid ramps.
    pub ramp_jerk: f64,
    /// When the slave is on its cam, s after the start.
    pub duration_s: f64,
    /// The largest velocity of the slave until then, exact, u/s.
    pub peak_velocity: f64,
    /// The largest acceleration of the slave until then, exact, u/s².
    pub peak_acceleration: f64,
    /// The largest jerk of the slave until then, u/s³. With trapezoid ramps the largest step of the ramp's acceleration by
    /// the time of a cycle, and the largest jerk of the cam; with the others exact, of both together.
    pub peak_jerk: f64,
    /// The largest jerk of the cam alone until then, exact, u/s³.
    pub peak_cam_jerk: f64,
    /// Least and greatest position of the slave until then, exact, u.
    pub positions: [f64; 2],
}

impl RampIn {
    pub(in crate::tune) fn peak(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Velocity => self.peak_velocity,
            Quantity::Acceleration => self.peak_acceleration,
            Quantity::Jerk => self.peak_jerk,
        }
    }
}

/// A ramp in a given time has no `VelocityDiff` beyond the velocity of the axis, and one with more would be there sooner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// The velocity of the axis, u/s.
    pub velocity: f64,
    /// When the slave would be on its cam without that, s.
    pub free_s: f64,
}

impl Held {
    fn sentence(self) -> String {
        let Self { velocity, free_s } = self;
        format!(
            " with a `VelocityDiff` of at most the axis's velocity, {}, as a ramp in a given time has it (with more after {} s, as \
             without a given time)",
            Short(velocity),
            Short(free_s)
        )
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
    /// No ramp keeps this limit and all others.
    #[error("no ramp keeps the slave's {what}: it reaches {}, its limit is {}", Short(*.reached), Short(*.limit))]
    Beyond {
        /// Position, velocity, acceleration or jerk.
        what: &'static str,
        /// The position that the soonest ramp reaches without that limit, u, or the smallest peak, u/s, u/s² or u/s³.
        reached: f64,
        /// Its limit.
        limit: f64,
    },
    /// The cam leaves nothing over for a ramp.
    #[error("the cam alone takes the slave's {what} to {}, its limit is {}: nothing is left for a ramp",
        Short(*.peak), Short(*.limit))]
    NoRoom {
        /// Velocity or acceleration.
        what: &'static str,
        /// What the cam reaches, u/s or u/s².
        peak: f64,
        /// Its limit.
        limit: f64,
    },
    /// The limits do not allow a ramp as short as it should be.
    #[error("the slave is on its cam after {} s at the earliest{}, not within {} s", Short(*.soonest_s), .held.map_or_else(String::new, Held::sentence),
        Short(*.within_s))]
    TooLate {
        /// The shortest ramp that was found, s.
        soonest_s: f64,
        /// The time it was to take at most, s.
        within_s: f64,
        /// What makes it that late, if it is not the limits alone.
        held: Option<Held>,
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
