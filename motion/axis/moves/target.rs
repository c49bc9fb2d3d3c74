//! Absolute, relative and additive moves (`MC_MoveAbsolute`, `MC_MoveRelative`, `MC_MoveAdditive`).

use super::{Planned, PlannedMotion};
use crate::ownership::Start;
use crate::{Axis, Direction, SmcError};

/// To a position (`MC_MoveAbsolute`, manual 5.3).
///
/// From motion the axis goes on without a step of the velocity; if it cannot brake in time, it overshoots and returns.
#[doc(alias = "MC_MoveAbsolute")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveAbsolute {
    /// Target, u; of a rotary axis its place within the period.
    pub position: f64,
    /// Largest velocity, u/s; it need not be reached.
    pub velocity: f64,
    /// Acceleration, u/s².
    pub acceleration: f64,
    /// Deceleration, u/s².
    pub deceleration: f64,
    /// Direction of a rotary axis.
    pub direction: Direction,
}

impl PlannedMotion for MoveAbsolute {
    fn plan(&self, start: Start, axis: &Axis) -> Result<Planned, SmcError> {
        let limits = axis.limits(self.velocity, self.acceleration, self.deceleration);
        let target = axis.to_drive(self.position);
        let target = self.direction.unwound(axis, start.state, target, limits, 0.0);
        Planned::to(target, limits, start, axis).map_err(|_invalid| SmcError::MaInvalidVelaccValues)
    }
}

/// By a distance from where the axis is (`MC_MoveRelative`, manual 5.3).
#[doc(alias = "MC_MoveRelative")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveRelative {
    /// Way to go, u, with its sign.
    pub distance: f64,
    /// Largest velocity, u/s; it need not be reached.
    pub velocity: f64,
    /// Acceleration, u/s².
    pub acceleration: f64,
    /// Deceleration, u/s².
    pub deceleration: f64,
}

impl PlannedMotion for MoveRelative {
    fn plan(&self, start: Start, axis: &Axis) -> Result<Planned, SmcError> {
        let limits = axis.limits(self.velocity, self.acceleration, self.deceleration);
        Planned::to(start.state.position + self.distance, limits, start, axis)
            .map_err(|_invalid| SmcError::MrInvalidVelaccValues)
    }
}

/// By a distance from the target of the motion there is (`MC_MoveAdditive`, manual 5.3).
///
/// In `discrete_motion` the distance adds to the pending target, otherwise to the position. The part of a superimposed motion
/// that is done counts for the target; the rest ends.
#[doc(alias = "MC_MoveAdditive")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveAdditive {
    /// Way to add, u, with its sign.
    pub distance: f64,
    /// Largest velocity, u/s; it need not be reached.
    pub velocity: f64,
    /// Acceleration, u/s².
    pub acceleration: f64,
    /// Deceleration, u/s².
    pub deceleration: f64,
}

impl PlannedMotion for MoveAdditive {
    fn plan(&self, start: Start, axis: &Axis) -> Result<Planned, SmcError> {
        let limits = axis.limits(self.velocity, self.acceleration, self.deceleration);
        let from = start.aim.unwrap_or(start.state.position);
        Planned::to(from + self.distance, limits, start, axis)
            .map_err(|_invalid| SmcError::MadInvalidVelaccValues)
    }
}
