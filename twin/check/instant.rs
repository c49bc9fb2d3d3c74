//! Motion of one axis at one set-point.

use crate::setpoint::AxisSetpoint;
use twin_kinematics::AxisVector;
use twin_path::Place;

/// One axis at one instant. SI.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instant {
    pub(super) place: Place,
    pub(super) position: f64,
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
    /// Of the tool along the path.
    pub(super) path_velocity: f64,
}

impl Instant {
    pub(super) fn of(setpoint: &AxisSetpoint, index: usize) -> Self {
        let value = |vector: &AxisVector| vector.get(index).copied().unwrap_or_default();
        Self {
            place: setpoint.place,
            position: value(&setpoint.axes.position),
            velocity: value(&setpoint.axes.velocity),
            acceleration: value(&setpoint.axes.acceleration),
            path_velocity: setpoint.path_velocity,
        }
    }

    /// Acceleration that follows from the positions of two cycles beyond the mean of both velocities, or from velocities
    /// that step.
    pub(super) fn jump(&self, before: &Self, cycle: f64) -> f64 {
        let stepped = (self.position - before.position) / cycle;
        // It may stand for a cycle as well, between two velocities that are the same.
        let kink = (stepped - self.velocity.midpoint(before.velocity)).abs();
        kink.max((self.velocity - before.velocity).abs()) / cycle
    }
}
