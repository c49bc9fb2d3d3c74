//! Motion of one axis at one set-point, and the largest feed that keeps it within a limit.

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
    pub(super) path_acceleration: f64,
}

impl Instant {
    pub(super) fn of(setpoint: &AxisSetpoint, index: usize) -> Self {
        let value = |vector: &AxisVector| vector.get(index).copied().unwrap_or_default();
        let (tool, path_velocity) = (&setpoint.tool, setpoint.path_velocity);
        let along = tool.acceleration.dot(&tool.velocity);
        Self {
            place: setpoint.place,
            position: value(&setpoint.axes.position),
            velocity: value(&setpoint.axes.velocity),
            acceleration: value(&setpoint.axes.acceleration),
            path_velocity,
            path_acceleration: if path_velocity > 0.0 { along / path_velocity } else { 0.0 },
        }
    }

    /// The largest feed with which the axis does not exceed the velocity `limit` here, mm/s: along a given path the
    /// axes' velocities are proportional to the feed. Where the tool is slower than the feed only because it is still
    /// accelerating, a feed below its velocity here makes it the feed.
    pub(super) fn feed_for_velocity(&self, before: Option<&Self>, limit: f64) -> Option<f64> {
        let per_feed = self.worst(before, |one| one.velocity / one.path_velocity)?;
        Some(limit / per_feed * 1e3)
    }

    /// The same for the acceleration `limit`: at constant feed it grows with the square of the feed. `None` if the axis
    /// would exceed it on a straight path too, by the acceleration or deceleration (E) alone.
    pub(super) fn feed_for_acceleration(&self, before: Option<&Self>, limit: f64) -> Option<f64> {
        let along = |one: &Self| one.path_acceleration * one.velocity / one.path_velocity;
        let bend = |one: &Self| (one.acceleration - along(one)) / one.path_velocity.powi(2);
        let per_feed_v2 = self.worst(before, bend)?;
        // Below what it has here the tool keeps its feed here; between set-points that may begin or end a bit slower.
        let varies = self.on_element(before).map_or(0.0, |before| {
            (self.path_velocity - before.path_velocity).abs().min(self.path_velocity)
        });
        let feed = (limit / per_feed_v2).sqrt().min(self.path_velocity - varies);
        (along(self).abs() <= limit).then_some(feed * 1e3)
    }

    /// Acceleration that follows from the positions of two cycles beyond the one that both velocities explain. For an
    /// axis `free` of any path it is the acceleration beyond the mean of both, and that of velocities that step.
    pub(super) fn jump(&self, before: &Self, cycle: f64, free: bool) -> f64 {
        let stepped = (self.position - before.position) / cycle;
        if free {
            // It may stand for a cycle as well, between two velocities that are the same.
            let kink = (stepped - self.velocity.midpoint(before.velocity)).abs();
            return kink.max((self.velocity - before.velocity).abs()) / cycle;
        }
        let explained = self.velocity.abs().max(before.velocity.abs());
        (stepped.abs() - explained).max(0.0) / cycle
    }

    /// The magnitude of something that depends on the path alone. Between set-points it may be larger than at them, by
    /// no more than it has changed since the one `before`, if that is on the same element. `None` at rest.
    fn worst(&self, before: Option<&Self>, of: impl Fn(&Self) -> f64) -> Option<f64> {
        let here = of(self);
        let change = self.on_element(before).map_or(0.0, |before| (here - of(before)).abs());
        (self.path_velocity > 0.0).then_some(here.abs() + change)
    }

    /// The instant before, if the tool moved on the same element.
    fn on_element<'b>(&self, before: Option<&'b Self>) -> Option<&'b Self> {
        before.filter(|before| before.path_velocity > 0.0 && before.place == self.place)
    }
}
