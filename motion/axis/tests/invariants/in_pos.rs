//! Promise of a gear with a synchronous position, before and after it.

use super::*;

/// Watch over a gear with a sync position: up to there it follows its polynomial, from there on its ratio.
#[derive(Default)]
pub(super) struct InPos {
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

    /// Value, slope and curvature at x: a parabola by the begin, and w³ times another one by the end, in Newton's form.
    fn at(&self, x: f64) -> [f64; 3] {
        let Self { h, y: [y0, y1], slopes: [v0, v1], curvature: k0, .. } = *self;
        let w = x / h;
        if w >= 1.0 || self.in_step {
            return [y1 + v1 * (x - h), v1, 0.0];
        }
        let [m0, m1, k] = [v0 * h, v1 * h, k0 * h * h];
        let a = y1 - y0 - m0 - 0.5 * k;
        let b = m1 - m0 - k - 3.0 * a;
        let c = -0.5 * k - 3.0 * (a + b);
        let (u, w2, w3) = (w - 1.0, w * w, w.powi(3));
        let [g, slope, bend] = [a + b * u + c * u * u, b + 2.0 * c * u, 2.0 * c];
        let value = y0 + m0 * w + 0.5 * k * w2 + w3 * g;
        let first = m0 + k * w + 3.0 * w2 * g + w3 * slope;
        let second = k + 6.0 * w * g + 6.0 * w2 * slope + w3 * bend;
        [value, first / h, second / (h * h)]
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

impl Watch<GearInPos> for InPos {
    /// Position and velocity of the slave are those of the polynomial.
    fn see(&mut self, it: &Look<'_, GearInPos>) -> Checked {
        let Look { block, taken: gear, shown, axis, lead } = it;
        let (in_step, now) = (shown.done && shown.busy, &Master::of(lead));
        let owner = block.owner().unwrap_or_default();
        let (way, last) = (self.way.take().filter(|way| way.owner == owner), self.last.take());
        let Some(run) = block.running() else { return Ok(()) };
        self.last = Some(*now);
        // Once Execute has fallen, `done` shows for a cycle only.
        let couples = in_step || run.is_coupling() || way.is_some();
        let Some(last) = last.filter(|_| couples) else { return Ok(()) };
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

    fn promise(&self) -> Option<Promise> {
        self.way.map(|_| Promise::Smooth(self.steepest))
    }
}
