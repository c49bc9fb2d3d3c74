//! Endless motion.

use super::Planned;
use crate::axis::ownership::Start;
use crate::axis::{Axis, AxisState, Direction, Motion, Progress, SmcError, Stage};

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

impl Motion for MoveVelocity {
    type With = ();
    type Run = Planned;
    const STATE: AxisState = AxisState::ContinuousMotion;

    fn plan(&self, start: Start, axis: &Axis, (): ()) -> Result<Planned, SmcError> {
        let sign = self.direction.sign(axis, start.state);
        let sign = sign.ok_or(SmcError::MvDirectionNotApplicable)?;
        // A velocity of 0 brakes; a limit has to be positive.
        let limit = if self.velocity == 0.0 { f64::MIN_POSITIVE } else { self.velocity };
        let limits = axis.limits(limit, self.acceleration, self.deceleration);
        Planned::to_velocity(sign * self.velocity, limits, start, axis)
            .map_err(|_invalid| SmcError::MvInvalidAccdecValues)
    }

    fn duration(run: &Planned) -> Option<f64> {
        Some(run.duration())
    }

    fn step(&self, run: &mut Planned, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        Ok(run.step(axis, Stage::Reached))
    }
}
