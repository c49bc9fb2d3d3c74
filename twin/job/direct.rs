//! Set-points straight from the job, cycle by cycle (`SMC_Follow…`, `SMC_ControlAxisBy…`, manual 2.2.5).
//!
//! A controller's program computes them; a job says them as points over time, between which they lie on straight lines, or,
//! where positions come with their velocities, on cubics through both.

use super::block::{Called, With};
use twin_motion::axis::{Axis, Block, ControlAxisBy, Follow, Outputs};

/// A point: time after the one before it, s, with what the block is told there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) after: f64,
    pub(super) setpoint: Follow,
}

/// What jumps are bridged with; what is 0 is the axis's own.
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
}

impl Direct {
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
        let waits = matches!(&self.kind, Kind::Watched(block) if block.running() == Some(&true));
        let from = *self.from.get_or_insert([axis.set_position(), axis.set_velocity()]);
        if !waits {
            self.time += axis.cycle();
        }
        // A cycle that rounds to just before a point is the point.
        let time = self.time + 1e-9 * axis.cycle();
        let Some((setpoint, ended)) = self.asked(from, time) else { return Outputs::default() };
        let (shown, bridging) = match &mut self.kind {
            Kind::Followed(block) => {
                block.inputs = setpoint;
                (block.call(execute, axis), false)
            }
            Kind::Watched(block) => {
                block.inputs.setpoint = setpoint;
                let shown = block.call(execute, axis);
                (shown, block.running() == Some(&true))
            }
        };
        // The block itself has no end: the job goes on where its points do.
        Outputs { done: shown.busy && ended && !bridging, ..shown }
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
    Some(Box::new(Direct { kind, points, from: None, time: 0.0 }))
}
