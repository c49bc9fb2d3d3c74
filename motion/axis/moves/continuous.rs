//! Continuous moves: to a position, and on with a velocity (`SMC_MoveContinuousAbsolute`,
//! `SMC_MoveContinuousRelative`).

use super::{Planned, PlannedMotion};
use crate::ownership::Start;
use crate::{Axis, AxisState, Direction, SmcError, Stage};
use twin_profile::{AxisLimits, Profile};

/// To a position with a velocity there, and on with it (`SMC_MoveContinuousAbsolute`, manual 5.3).
///
/// Where the way is too short for the velocity, the axis backs up first. `done` is `InEndVelocity`.
#[doc(alias = "SMC_MoveContinuousAbsolute")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveContinuousAbsolute {
    /// Position, u; of a rotary axis its place within the period.
    pub position: f64,
    /// Largest velocity on the way, u/s; it need not be reached.
    pub velocity: f64,
    /// Speed at the position and after it, u/s.
    pub end_velocity: f64,
    /// Direction of that: positive, negative or current.
    pub end_velocity_direction: Direction,
    /// Acceleration, u/s².
    pub acceleration: f64,
    /// Deceleration, u/s².
    pub deceleration: f64,
    /// Direction of a rotary axis; not fastest.
    pub direction: Direction,
}

impl PlannedMotion for MoveContinuousAbsolute {
    const STATE: AxisState = AxisState::ContinuousMotion;
    const END: Stage = Stage::Reached;

    fn plan(&self, start: Start, axis: &Axis) -> Result<Planned, SmcError> {
        if self.direction == Direction::Fastest {
            return Err(SmcError::McaDirectionNotApplicable);
        }
        let sign = self.end_velocity_direction.sign(axis, start.state);
        let sign = sign.ok_or(SmcError::McaInvalidDirection)?;
        let end_velocity = speed(self.end_velocity).ok_or(SmcError::McaInvalidVelaccValues)? * sign;
        let limits = axis.limits(self.velocity, self.acceleration, self.deceleration);
        let target = axis.to_drive(self.position);
        let target = self.direction.unwound(axis, start.state, target, limits, end_velocity);
        on_from(target, end_velocity, limits, start, axis).ok_or(SmcError::McaInvalidVelaccValues)
    }
}

/// By a distance to a velocity, and on with it (`SMC_MoveContinuousRelative`, manual 5.3).
///
/// The distance counts from where the axis is at the edge to where it has the velocity. `done` is `InEndVelocity`.
#[doc(alias = "SMC_MoveContinuousRelative")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveContinuousRelative {
    /// Way, u, with its sign.
    pub distance: f64,
    /// Largest velocity on the way, u/s; it need not be reached.
    pub velocity: f64,
    /// Speed at the end of the way and after it, u/s.
    pub end_velocity: f64,
    /// Direction of that: positive, negative or current.
    pub end_velocity_direction: Direction,
    /// Acceleration, u/s².
    pub acceleration: f64,
    /// Deceleration, u/s².
    pub deceleration: f64,
}

impl PlannedMotion for MoveContinuousRelative {
    const STATE: AxisState = AxisState::ContinuousMotion;
    const END: Stage = Stage::Reached;

    fn plan(&self, start: Start, axis: &Axis) -> Result<Planned, SmcError> {
        let sign = self.end_velocity_direction.sign(axis, start.state);
        let sign = sign.ok_or(SmcError::McrInvalidDirection)?;
        let end_velocity = speed(self.end_velocity).ok_or(SmcError::McrInvalidVelaccValues)? * sign;
        let limits = axis.limits(self.velocity, self.acceleration, self.deceleration);
        let target = start.state.position + self.distance;
        on_from(target, end_velocity, limits, start, axis).ok_or(SmcError::McrInvalidVelaccValues)
    }
}

/// A velocity without a sign.
fn speed(velocity: f64) -> Option<f64> {
    (velocity >= 0.0).then_some(velocity)
}

fn on_from(
    target: f64,
    end_velocity: f64,
    limits: AxisLimits,
    start: Start,
    axis: &Axis,
) -> Option<Planned> {
    let profile = Profile::to_position(start.state, target, end_velocity, limits, axis.ramp());
    Some(Planned::new(&profile.ok()?, start, axis))
}
