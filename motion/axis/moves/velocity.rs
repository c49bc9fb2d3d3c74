//! `MC_MoveVelocity`: endless motion at a velocity.

use super::{Planned, PlannedMotion};
use crate::ownership::Start;
use crate::{Axis, AxisState, Direction, SmcError, Stage};

/// Moves on with a velocity until something else moves the axis (`MC_MoveVelocity`, manual 5.3).
///
/// `done` is `InVelocity`.
#[doc(alias = "MC_MoveVelocity")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveVelocity {
    /// Velocity, u/s, not negative.
    pub velocity: f64,
    /// Acceleration, u/s².
    pub acceleration: f64,
    /// Deceleration, u/s².
    pub deceleration: f64,
    /// Positive, negative or current; the manual's default is current.
    pub direction: Direction,
}

impl PlannedMotion for MoveVelocity {
    const STATE: AxisState = AxisState::ContinuousMotion;
    const END: Stage = Stage::Reached;

    fn plan(&self, start: Start, axis: &Axis) -> Result<Planned, SmcError> {
        let sign = self.direction.sign(axis, start.state);
        let sign = sign.ok_or(SmcError::MvDirectionNotApplicable)?;
        // A velocity of 0 brakes; a limit has to be positive.
        let limit = if self.velocity == 0.0 { f64::MIN_POSITIVE } else { self.velocity };
        let limits = axis.limits(limit, self.acceleration, self.deceleration);
        Planned::to_velocity(sign * self.velocity, limits, start, axis)
            .map_err(|_invalid| SmcError::MvInvalidAccdecValues)
    }
}
