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
    /// Time since then, s; it stops while a jump is bridged.
    time: f64,
    /// Time since then on the job's clock, s.
    elapsed: f64,
    /// Rate of that time: 0 while it stops, then up to 1, so that the set-points come to speed within the acceleration of the
    /// axis, like those of an interpolator after a wait.
    rate: f64,
}

/// Least part of the axis's acceleration for coming to speed.
const LEAST_ROOM: f64 = 0.1;

impl Direct {
    /// True while a jump is bridged: the set-points wait.
    fn waits(&self) -> bool {
        let Kind::Watched(block) = &self.kind else { return false };
        block.running().is_some_and(Watched::stop_ipo)
    }

    /// Advances the time of the set-points by a cycle, unless they wait.
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

    /// Largest growth of the rate within the acceleration of the axis, 1/s.
    fn growth(&self, from: [f64; 2], axis: &Axis) -> f64 {
        let cycle = axis.cycle();
        let position = |time: f64| match self.asked(from, time)?.0 {
            Follow::Position(position) | Follow::PositionVelocity(position, _) => Some(position),
            // Velocities are bridged as velocities.
            Follow::Velocity(_) => None,
        };
        let places = [0.0, 1.0, 2.0].map(|ahead| position(self.time + ahead * cycle));
        let [Some(first), Some(second), Some(third)] = places else { return f64::INFINITY };
        let speed = (second - first).abs().max((third - second).abs()) / cycle;
        let own = (third - 2.0 * second + first).abs() / (cycle * cycle);
        // fSWMaxAcceleration.
        let most = axis.max_acceleration();
        (most - self.rate * self.rate * own).max(LEAST_ROOM * most) / speed
    }

    /// The set-point at `time`; true at the end.
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
        // The block itself has no end: it is done at the end of the points.
        Outputs { done: shown.busy && ended && !self.waits(), ..shown }
    }

    /// To the last of the points, with the time that jumps have taken so far.
    fn lasts(&self) -> Option<f64> {
        let points: f64 = self.points.iter().map(|point| point.after).sum();
        Some(points + (self.elapsed - self.time))
    }
}

/// Follows set-points; with the other inputs of a block that bridges their jumps, if there are any.
pub(super) fn direct(points: Vec<Point>, gaps: Option<ControlAxisBy>) -> Option<Box<dyn Called>> {
    let setpoint = points.first()?.setpoint;
    let kind = match gaps {
        None => Kind::Followed(Block::new(setpoint)),
        Some(inputs) => Kind::Watched(Block::new(ControlAxisBy { setpoint, ..inputs })),
    };
    Some(Box::new(Direct { kind, points, from: None, time: 0.0, elapsed: 0.0, rate: 1.0 }))
}
