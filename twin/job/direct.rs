//! Set-points from the job itself, cycle by cycle (`SMC_Follow…`, `SMC_ControlAxisBy…`, manual 2.2.5).
//!
//! A controller's program computes such set-points. A job gives them as points over time. Between the points they are
//! on straight lines or, where positions have velocities, on cubics.

use super::block::{Called, With};
use twin_axis::{Axis, Block, ControlAxisBy, Follow, Outputs, Watched};

/// A point: time after the previous point, s, and the set-point there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) after: f64,
    pub(super) setpoint: Follow,
}

/// Limits for bridging jumps; 0 selects the limit of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gaps {
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
    pub(super) deceleration: f64,
}

#[derive(Debug)]
enum Kind {
    Followed(Block<Follow>),
    Watched(Block<ControlAxisBy>),
}

#[derive(Debug)]
struct Direct {
    kind: Kind,
    points: Vec<Point>,
    /// Where it begins, u and u/s, once it has begun.
    from: Option<[f64; 2]>,
    /// Since then, s; it stands while a jump is bridged.
    time: f64,
    /// Since then on the job's clock, s.
    elapsed: f64,
    /// How fast that time goes by: 0 while it stands, and then up to 1, so that the set-points come to speed within the
    /// acceleration of the axis, as those of an interpolator do that has waited.
    rate: f64,
}

/// Least part of the axis's acceleration that brings set-points to speed where they need the rest themselves.
const LEAST_ROOM: f64 = 0.1;

impl Direct {
    /// Whether the set-points wait: a jump is being bridged.
    fn waits(&self) -> bool {
        let Kind::Watched(block) = &self.kind else { return false };
        block.running().is_some_and(Watched::stop_ipo)
    }

    /// Lets the time of the set-points go on by a cycle, or stand.
    fn go_on(&mut self, from: [f64; 2], axis: &Axis) {
        let cycle = axis.cycle();
        let before = self.rate;
        self.rate = match (self.waits(), before < 1.0) {
            (true, _) => 0.0,
            (false, false) => 1.0,
            (false, true) => (before + cycle * self.growth(from, axis)).min(1.0),
        };
        self.elapsed += cycle;
        if !self.waits() {
            self.time += f64::midpoint(before, self.rate) * cycle;
        }
    }

    /// How fast the rate may grow for the axis to keep its acceleration, 1/s.
    fn growth(&self, from: [f64; 2], axis: &Axis) -> f64 {
        let cycle = axis.cycle();
        let position = |time: f64| match self.asked(from, time)?.0 {
            Follow::Position(position) | Follow::PositionVelocity(position, _) => Some(position),
            // Velocities are bridged as velocities: nothing has to come to speed.
            Follow::Velocity(_) => None,
        };
        let places = [0.0, 1.0, 2.0].map(|ahead| position(self.time + ahead * cycle));
        let [Some(first), Some(second), Some(third)] = places else { return f64::INFINITY };
        let speed = (second - first).abs().max((third - second).abs()) / cycle;
        let own = (third - 2.0 * second + first).abs() / (cycle * cycle);
        // fSWMaxAcceleration.
        let most = axis.read_parameter(1123).unwrap_or(f64::INFINITY);
        (most - self.rate * self.rate * own).max(LEAST_ROOM * most) / speed
    }

    /// What is asked for at `time`, and whether that is the end.
    fn asked(&self, [position, velocity]: [f64; 2], time: f64) -> Option<(Follow, bool)> {
        let (mut begin, mut before) = (0.0, [position, velocity]);
        for point in &self.points {
            let Point { after, setpoint } = *point;
            let end = begin + after;
            if time < end {
                let part = (time - begin) / after;
                let line = |from: f64, to: f64| from + part * (to - from);
                let [y, v] = before;
                return Some(match setpoint {
                    Follow::Position(to) => (Follow::Position(line(y, to)), false),
                    Follow::Velocity(to) => (Follow::Velocity(line(v, to)), false),
                    Follow::PositionVelocity(to, speed) => {
                        let (way, v0, v1) = (to - y, v * after, speed * after);
                        let (square, cube) = (3.0 * way - 2.0 * v0 - v1, v0 + v1 - 2.0 * way);
                        let place = y + part * (v0 + part * (square + part * cube));
                        let rate = v0 + part * (2.0 * square + part * 3.0 * cube);
                        (Follow::PositionVelocity(place, rate / after), false)
                    }
                });
            }
            begin = end;
            before = match setpoint {
                Follow::Position(to) => [to, velocity],
                Follow::Velocity(to) => [position, to],
                Follow::PositionVelocity(to, speed) => [to, speed],
            };
        }
        self.points.last().map(|last| (last.setpoint, true))
    }
}

impl Called for Direct {
    fn call(&mut self, execute: bool, axis: &mut Axis, _with: With<'_>) -> Outputs {
        let from = *self.from.get_or_insert([axis.set_position(), axis.set_velocity()]);
        self.go_on(from, axis);
        // A cycle that rounds to just before a point is the point.
        let time = self.time + 1e-9 * axis.cycle();
        let Some((setpoint, ended)) = self.asked(from, time) else { return Outputs::default() };
        let setpoint = match setpoint {
            Follow::PositionVelocity(position, velocity) => {
                Follow::PositionVelocity(position, self.rate * velocity)
            }
            other => other,
        };
        let shown = match &mut self.kind {
            Kind::Followed(block) => {
                block.inputs = setpoint;
                block.call(execute, axis)
            }
            Kind::Watched(block) => {
                block.inputs.setpoint = setpoint;
                block.call(execute, axis)
            }
        };
        // The block itself has no end: the job goes on where its points do.
        Outputs { done: shown.busy && ended && !self.waits(), ..shown }
    }

    /// To the last of the points, with the time that jumps have taken so far.
    fn lasts(&self) -> Option<f64> {
        let points: f64 = self.points.iter().map(|point| point.after).sum();
        Some(points + (self.elapsed - self.time))
    }
}

/// Follows set-points, watched and with jumps bridged if `gaps` say so.
pub(super) fn direct(points: Vec<Point>, gaps: Option<Gaps>) -> Option<Box<dyn Called>> {
    let setpoint = points.first()?.setpoint;
    let kind = match gaps {
        None => Kind::Followed(Block::new(setpoint)),
        Some(Gaps { velocity, acceleration, deceleration }) => {
            Kind::Watched(Block::new(ControlAxisBy {
                setpoint,
                avoid_gaps: true,
                gap_velocity: velocity,
                gap_acceleration: acceleration,
                gap_deceleration: deceleration,
            }))
        }
    };
    Some(Box::new(Direct { kind, points, from: None, time: 0.0, elapsed: 0.0, rate: 1.0 }))
}
