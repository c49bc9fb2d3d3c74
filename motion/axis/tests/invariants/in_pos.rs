//! Promise of a gear with a synchronous position, before and after it.

use super::called::{Called, Moving, own, passes_on};
use super::checker::Promise;
use super::random::Random;
use crate::{Axis, GearInPos, Master, Outputs, fmod};
use twin_profile::{RampType, State};

/// A gear with a sync position: up to there it follows its polynomial, from there on its ratio.
pub(super) struct InPos {
    moving: Moving<GearInPos>,
    /// The master in the cycle before.
    last: Option<Master>,
    way: Option<Way>,
    /// The most that the way asks for in this cycle, u/s².
    steepest: f64,
}

/// The way into step: y over the master's way x from y0 with slope v0 and curvature k0 to y1 with slope v1 at h, where the
/// curvature is 0 (manual 5.4: a polynomial; that of least degree which leaves nothing to step).
#[derive(Clone, Copy, Debug)]
struct Way {
    owner: i64,
    x: f64,
    h: f64,
    y: [f64; 2],
    slopes: [f64; 2],
    curvature: f64,
    /// It has been in step, and stays so wherever the master goes.
    in_step: bool,
}

impl Way {
    /// Where it begins, from the cycle before.
    fn new(gear: &GearInPos, owner: i64, axis: &Axis, last: &Master, now: &Master) -> Self {
        let from = axis.saved_base;
        let limited = axis.ramp() != RampType::Trapezoid;
        let at_rest = from.velocity == 0.0 && (from.acceleration == 0.0 || !limited);
        let sign = now.velocity.signum();
        // The place moves with the zero.
        let ahead = sign * (gear.master_sync_position - last.position - (now.zero - last.zero));
        let ahead = now.period.map_or(ahead, |period| match fmod(ahead, period) {
            0.0 => period,
            ahead => ahead,
        });
        let v0 = if at_rest { 0.0 } else { from.velocity / last.velocity };
        let v1 = f64::from(gear.ratio_numerator) / f64::from(gear.ratio_denominator);
        let curvature = if at_rest || !limited {
            0.0
        } else {
            (from.acceleration - v0 * last.acceleration) / last.velocity.powi(2)
        };
        let h = sign * ahead;
        let natural = from.position + 0.5 * (v0 + v1) * h;
        let y1 = axis.to_drive(gear.slave_sync_position);
        let y1 = axis.period().map_or(y1, |it| y1 + it * ((natural - y1) / it).round());
        let (y, slopes) = ([from.position, y1], [v0, v1]);
        Self { owner, x: 0.0, h, y, slopes, curvature, in_step: false }
    }

    /// Value, slope and curvature at x, by Hermite's polynomials of fifth degree.
    fn at(&self, x: f64) -> [f64; 3] {
        let Self { h, y: [y0, y1], slopes: [v0, v1], curvature: k0, .. } = *self;
        let w = x / h;
        if w >= 1.0 || self.in_step {
            return [y1 + v1 * (x - h), v1, 0.0];
        }
        let by = |from: [f64; 3], to: [f64; 2]| {
            y0 * from[0] + v0 * h * from[1] + k0 * h * h * from[2] + y1 * to[0] + v1 * h * to[1]
        };
        let (w2, w3, w4, w5) = (w * w, w.powi(3), w.powi(4), w.powi(5));
        let end = 10.0 * w3 - 15.0 * w4 + 6.0 * w5;
        let value = by(
            [1.0 - end, w - 6.0 * w3 + 8.0 * w4 - 3.0 * w5, 0.5 * (w2 - 3.0 * w3 + 3.0 * w4 - w5)],
            [end, -4.0 * w3 + 7.0 * w4 - 3.0 * w5],
        );
        let end = 30.0 * w2 - 60.0 * w3 + 30.0 * w4;
        let slope = by(
            [
                -end,
                1.0 - 18.0 * w2 + 32.0 * w3 - 15.0 * w4,
                0.5 * (2.0 * w - 9.0 * w2 + 12.0 * w3 - 5.0 * w4),
            ],
            [end, -12.0 * w2 + 28.0 * w3 - 15.0 * w4],
        );
        let end = 60.0 * w - 180.0 * w2 + 120.0 * w3;
        let curvature = by(
            [
                -end,
                -36.0 * w + 96.0 * w2 - 60.0 * w3,
                0.5 * (2.0 - 18.0 * w + 36.0 * w2 - 20.0 * w3),
            ],
            [end, -24.0 * w + 84.0 * w2 - 60.0 * w3],
        );
        [value, slope / h, curvature / (h * h)]
    }

    /// State of the slave there for a state of the master.
    fn state(&self, x: f64, velocity: f64, acceleration: f64) -> State {
        let [position, slope, curvature] = self.at(x);
        State {
            position,
            velocity: slope * velocity,
            acceleration: slope * acceleration + curvature * velocity * velocity,
        }
    }
}

impl InPos {
    pub(super) fn new(moving: Moving<GearInPos>) -> Self {
        Self { moving, last: None, way: None, steepest: 0.0 }
    }

    /// Position and velocity of the slave are those of the polynomial.
    fn see_way(&mut self, in_step: bool, axis: &Axis, now: &Master) -> Result<(), String> {
        let owner = self.moving.owner();
        let (way, last) = (self.way.take().filter(|way| way.owner == owner), self.last.take());
        let Some(run) = self.moving.block.running() else { return Ok(()) };
        self.last = Some(*now);
        // Once Execute has fallen, `done` shows for a cycle only.
        let couples = in_step || run.is_coupling() || way.is_some();
        let Some(last) = last.filter(|_| couples) else { return Ok(()) };
        let gear = &self.moving.taken;
        let mut way = way.unwrap_or_else(|| Way::new(gear, owner, axis, &last, now));
        let from = way.x;
        way.x += now.travel_since(&last);
        self.steepest = (0..=16).map(f64::from).fold(0.0, |most: f64, part| {
            let between = |a: f64, b: f64| a + (b - a) * part / 16.0;
            let velocity = between(last.velocity, now.velocity);
            let acceleration = last.acceleration.abs().max(now.acceleration.abs());
            let [_, slope, curvature] = way.at(between(from, way.x));
            most.max((slope * acceleration).abs() + (curvature * velocity * velocity).abs())
        });
        way.in_step |= way.x / way.h >= 1.0;
        let expected = way.state(way.x, now.velocity, now.acceleration);
        let State { position, velocity, acceleration } = axis.base;
        let differs =
            |is: f64, expected: f64| (is - expected).abs() > 1e-6 * expected.abs().max(1.0);
        if differs(position, expected.position)
            || differs(velocity, expected.velocity)
            || differs(acceleration, expected.acceleration)
        {
            let place = if run.is_coupling() { "on the way into step" } else { "in step" };
            return Err(format!("{place}, but {:?}, not {expected:?}", axis.base));
        }
        self.way = Some(way);
        Ok(())
    }
}

impl Called for InPos {
    passes_on!(moving: call change name owner);

    fn watch(&mut self, shown: Outputs, axis: &Axis, master: &Axis) -> Result<(), String> {
        self.see_way(shown.done && shown.busy, axis, &Master::of(master))
    }

    /// Until it is coupled its motion goes on.
    fn promise(&self) -> Promise {
        match self.way {
            Some(_) => Promise::Smooth(self.steepest),
            None => own(0.0, 0.0, 0.0),
        }
    }
}
