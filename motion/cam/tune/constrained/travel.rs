//! The part of a cam that the master passes: positions and peaks of the slave on it, and the tappets there.

use super::super::along::along;
use super::Problem;
use crate::bounds::{Factors, Quantity, scaled, weighted};
use crate::polynomial::{Extremes, extremes, value};

/// The part of a cam that the master passes with a scaling and an offset.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passed {
    /// Where it begins, and its length; none for all of the cam.
    way: Option<[f64; 2]>,
    scaling: f64,
    /// Least and greatest y.
    pub(super) reached: [f64; 2],
    /// Whether limits of the position count: a slave that gains in every pass goes everywhere.
    pub(super) limited: bool,
}

impl Problem<'_> {
    /// The passed part; none if the slave would have to stop at once where the cam ends.
    pub(super) fn passed(&self, scaling: f64, offset: f64) -> Option<Passed> {
        let (curve, repeated) = (self.curve, self.wish.repeated);
        let [start, end] = [curve.start(), curve.end()];
        let Some(travel) = self.wish.travel else {
            let y = curve.extremes().position;
            let limited = !repeated || curve.rise() == 0.0;
            return Some(Passed { way: None, scaling, reached: [y.min, y.max], limited });
        };
        let [one, other] = travel.map(|master| master * scaling + offset);
        let (mut low, mut high) = (one.min(other), one.max(other));
        if !repeated {
            let room = 1e-12 * (end - start);
            let stops = |backwards| curve.stop_jumps(backwards).iter().any(Option::is_some);
            if high > end + room && low < end && stops(false)
                || low < start - room && high > start && stops(true)
            {
                return None;
            }
            (low, high) = (low.clamp(start, end), high.clamp(start, end));
        }
        let reached = self.reached(low, high);
        Some(Passed { way: Some([low, high - low]), scaling, reached, limited: true })
    }

    /// Least and greatest y between two places.
    fn reached(&self, low: f64, high: f64) -> [f64; 2] {
        let mut found = Extremes::NONE;
        // One pass from either end: what lies between them is between these.
        for (from, way) in [(low, high - low), (high, low - high)] {
            let mut position = self.at(from).position;
            found.include(from, position);
            along(self.curve, from, way, self.wish.repeated, &mut |[mut y, ..], width, _| {
                y[0] = position;
                found.join(&extremes(&y, width), 0.0);
                position = value(&y, width);
            });
        }
        [found.min, found.max]
    }

    /// The peak of a quantity of y on the way, whatever the master does within its own limits.
    pub(super) fn peak(&self, passed: &Passed, quantity: Quantity) -> f64 {
        let Passed { scaling, way, .. } = *passed;
        let Some([from, way]) = way else {
            let factors = Factors { master: scaling, slave: 1.0 };
            return self.curve.peak(quantity, &self.wish.master, factors).value;
        };
        let factors = quantity.factors(&scaled(&self.wish.master, scaling));
        let mut found = 0.0_f64;
        along(self.curve, from, way, self.wish.repeated, &mut |y, width, _| {
            for factors in &factors {
                let extremes = extremes(&weighted(&y, *factors), width);
                found = found.max(extremes.max.abs()).max(extremes.min.abs());
            }
        });
        found
    }

    /// The first and the last passage of every tappet, on the cam.
    pub(super) fn tappets(&self) -> Vec<f64> {
        let Some(travel) = self.wish.travel else { return self.wish.tappets.clone() };
        let [offset, scaling, ..] = self.wish.from;
        let [one, other] = travel.map(|master| master * scaling + offset);
        let (low, high) = (one.min(other), one.max(other));
        let width = self.curve.end() - self.curve.start();
        let all = self.wish.tappets.iter().flat_map(|tappet| {
            let first = tappet + ((low - tappet) / width).ceil() * width;
            let last = tappet + ((high - tappet) / width).floor() * width;
            if self.wish.repeated { vec![first, last] } else { vec![*tappet] }
        });
        all.filter(|place| (low..=high).contains(place)).collect()
    }
}
