//! What a master passes of a cam, and what that asks of the slave.

use super::super::super::bounds::Quantity;
use super::super::super::polynomial::{Coefficients, Extremes, extremes, value};
use super::super::along::along;
use super::Problem;

/// The part of a cam that the master passes, with a scaling and an offset.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passed {
    /// Where it begins, and how far it is, on the cam.
    from: f64,
    way: f64,
    /// Factor of the master's position.
    scaling: f64,
    /// Least and greatest y.
    pub(super) reached: [f64; 2],
    /// The same where limits of the position count.
    pub(super) position: Option<[f64; 2]>,
}

impl Problem<'_> {
    /// What is passed; none if the slave would have to stop at once where the cam ends.
    pub(super) fn passed(&self, scaling: f64, offset: f64) -> Option<Passed> {
        let (curve, repeated) = (self.curve, self.wish.repeated);
        let [start, end] = [curve.start(), curve.end()];
        let Some(travel) = self.wish.travel else {
            let y = curve.extremes().position;
            let reached = [y.min, y.max];
            // What gains in every pass goes everywhere.
            let position = (!repeated || curve.rise() == 0.0).then_some(reached);
            return Some(Passed { from: start, way: end - start, scaling, reached, position });
        };
        let [one, other] = travel.map(|master| master * scaling + offset);
        let (low, high) = (one.min(other), one.max(other));
        if repeated {
            let reached = self.reached(low, high);
            let position = Some(reached);
            return Some(Passed { from: low, way: high - low, scaling, reached, position });
        }
        let room = 1e-12 * (end - start);
        let stops = |backwards| curve.stop_jumps(backwards).iter().any(Option::is_some);
        let leaves = |beyond: bool, inside: bool, backwards| beyond && inside && stops(backwards);
        if leaves(high > end + room, low < end, false)
            || leaves(low < start - room, high > start, true)
        {
            return None;
        }
        let (from, to) = (low.clamp(start, end), high.clamp(start, end));
        let reached = self.reached(from, to);
        Some(Passed { from, way: to - from, scaling, reached, position: Some(reached) })
    }

    /// Least and greatest y between two places.
    fn reached(&self, low: f64, high: f64) -> [f64; 2] {
        let mut found = Extremes::NONE;
        // A pass from either end: what lies between is between these.
        for (from, way) in [(low, high - low), (high, low - high)] {
            let repeated = self.wish.repeated;
            let at = |x| if repeated { self.curve.repeated(x) } else { self.curve.at(x) };
            let mut position = at(from).position;
            found.include(from, position);
            along(self.curve, from, way, repeated, &mut |[y, ..], width, _| {
                let mut y = y;
                y[0] = position;
                found.join(&extremes(&y, width), 0.0);
                position = value(&y, width);
            });
        }
        [found.min, found.max]
    }

    /// The largest velocity, acceleration or jerk of y on the way, whatever the master does.
    pub(super) fn peak(&self, passed: &Passed, quantity: Quantity) -> f64 {
        let by = passed.scaling.abs();
        let master = self.wish.master;
        let [v, a, j] = [master.velocity, master.acceleration, master.jerk].map(|value| value * by);
        let mut found = 0.0_f64;
        // Signs of the derivatives as the way has them: forwards they are the curve's own.
        let mut look = |c: &Coefficients, width: f64| {
            let extremes = extremes(c, width);
            found = found.max(extremes.max.abs()).max(extremes.min.abs());
        };
        let sum = |parts: [(f64, &Coefficients); 3]| {
            let mut sum: Coefficients = [0.0; 7];
            for (by, c) in parts {
                for (sum, c) in sum.iter_mut().zip(c) {
                    *sum += by * c;
                }
            }
            sum
        };
        along(
            self.curve,
            passed.from,
            passed.way,
            self.wish.repeated,
            &mut |[_, first, second, third], width, _| match quantity {
                Quantity::Velocity => look(&first.map(|c| c * v), width),
                Quantity::Acceleration => {
                    for a in [a, -a] {
                        look(&sum([(v * v, &second), (a, &first), (0.0, &third)]), width);
                    }
                }
                Quantity::Jerk => {
                    for (a, j) in [(a, j), (a, -j), (-a, j), (-a, -j)] {
                        let parts = [(v * v * v, &third), (3.0 * v * a, &second), (j, &first)];
                        look(&sum(parts), width);
                    }
                }
            },
        );
        found
    }

    /// Tappets that the master passes, on the cam: with what they ask of scaling and offset the outermost ones speak for all.
    pub(super) fn outermost(&self) -> Vec<f64> {
        let all = self.tappets();
        let ends = [
            all.iter().copied().min_by(f64::total_cmp),
            all.iter().copied().max_by(f64::total_cmp),
        ];
        let mut ends: Vec<f64> = ends.into_iter().flatten().collect();
        ends.dedup();
        ends
    }

    /// The first and the last passage of every tappet.
    fn tappets(&self) -> Vec<f64> {
        let Some(travel) = self.wish.travel else { return self.wish.tappets.clone() };
        let [offset, scaling, ..] = self.wish.from;
        let [one, other] = travel.map(|master| master * scaling + offset);
        let (low, high) = (one.min(other), one.max(other));
        let width = self.curve.end() - self.curve.start();
        let within = |place: &f64| (low..=high).contains(place);
        let mut found = Vec::new();
        for tappet in &self.wish.tappets {
            if self.wish.repeated {
                let first = tappet + ((low - tappet) / width).ceil() * width;
                let last = tappet + ((high - tappet) / width).floor() * width;
                found.extend([first, last].into_iter().filter(within));
            } else {
                found.extend([*tappet].into_iter().filter(within));
            }
        }
        found
    }

    /// Of the tappets those where the slave is least and greatest: place and y.
    pub(super) fn slave_at_tappets(&self) -> Vec<(f64, f64)> {
        let at = |place: f64| {
            let repeated = self.wish.repeated && self.wish.travel.is_some();
            if repeated { self.curve.repeated(place) } else { self.curve.at(place) }.position
        };
        let all: Vec<(f64, f64)> = self.tappets().into_iter().map(|x| (x, at(x))).collect();
        let by = |one: &&(f64, f64), other: &&(f64, f64)| one.1.total_cmp(&other.1);
        let mut ends: Vec<(f64, f64)> =
            [all.iter().min_by(by), all.iter().max_by(by)].into_iter().flatten().copied().collect();
        ends.dedup();
        ends
    }
}
