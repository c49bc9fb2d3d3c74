//! Search for scaling and offset of the master: a grid, and a compass search from its best places.
//!
//! A compass search tries the points of a small square around the best place, goes to the best of them, and halves the square where
//! none is better (Kolda, Lewis and Torczon, SIAM Review 45, 2003).

use super::{Bound, ConstraintError, End, Objective, Place, Problem, close, nearest};
use crate::tune::Sample;
use crate::tune::fit::NAMES;

/// Steps of the grid in each of two directions, or in one.
const GRID: u32 = 24;
const LINE: u32 = 200;
/// How many of its best places a compass search begins at, and how many squares each has at most.
const BEGINS: usize = 8;
const SQUARES: usize = 400;
/// Points of a square on each side of its middle, and the half width, as a part of the range, below which a search ends.
const SIDE: i32 = 2;
const LEAST: f64 = 1e-16;
/// Samples that the grid looks at; the last search takes all.
const SEARCHED: usize = 256;
/// The error may be least with a scaling that is greater by this part.
const BEYOND: f64 = 0.2;
/// The objective of a place that exceeds constraints: greater than any other, and the greater the farther it is.
const EXCEEDED: f64 = 1e100;

/// Scaling and offset as shares of their ranges.
type Shares = [f64; 2];

/// The values of the master that are searched.
struct Domain {
    /// Scalings: the one next to 0, the usual one, and the farthest one.
    scalings: [f64; 3],
    /// The mean master of the samples, where the offset compensates the scaling.
    pivot: f64,
    /// Whether scaling and offset are searched.
    free: [bool; 2],
}

impl Problem<'_> {
    /// The best place.
    pub(super) fn searched(&self) -> Result<Place, ConstraintError> {
        let from = self.wish.from;
        let ends = self.interval(1).map(|(value, bound)| End::at(value, bound));
        if self.is_peak() {
            let scaling = self.nearest_zero(1, ends)?.value;
            let offset = nearest(from[0], self.interval(0).map(|(end, _)| end));
            return self.allowed([offset, scaling], None);
        }
        let domain = self.domain(ends);
        let few: Vec<Sample>;
        let mut coarse = *self;
        if let Objective::Error(samples) = self.objective {
            let stride = samples.len().div_ceil(SEARCHED).max(1);
            few = samples.iter().step_by(stride).copied().collect();
            coarse.objective = Objective::Error(&few);
        }
        let mut all: Vec<(f64, Shares)> = domain.grid();
        for (found, shares) in &mut all {
            *found = coarse.score(&domain, *shares);
        }
        all.sort_by(|one, other| one.0.total_cmp(&other.0));
        all.truncate(BEGINS);
        let best = all
            .into_iter()
            .map(|begin| coarse.compass(&domain, begin))
            .min_by(|one, other| one.0.total_cmp(&other.0));
        let (_, found) = best.unwrap_or_default();
        let (_, found) = self.compass(&domain, (self.score(&domain, found), found));
        let farthest = domain.scalings[0];
        let end = ends.into_iter().find(|end| close(end.value, farthest));
        let mut place = self.allowed(self.place(&domain, found), end.filter(|_| domain.free[0]))?;
        let width = self.curve.end() - self.curve.start();
        if self.wish.repeated && self.curve.rise() == 0.0 && domain.free[1] {
            // Whole passes are the same cam.
            place.values[0] -= ((place.values[0] - from[0]) / width).round() * width;
        }
        Ok(place)
    }

    fn score(&self, domain: &Domain, shares: Shares) -> f64 {
        let [offset, scaling] = self.place(domain, shares);
        match self.best(scaling, offset) {
            Ok(place) => place.cost,
            Err(by) => EXCEEDED * (1.0 + by.min(EXCEEDED)),
        }
    }

    fn compass(&self, domain: &Domain, begin: (f64, Shares)) -> (f64, Shares) {
        let mut best = begin;
        let mut half = f64::from(GRID).recip();
        let sides = domain.free.map(|free| if free { SIDE } else { 0 });
        for _ in 0..SQUARES {
            let (before, middle) = best;
            for one in -sides[0]..=sides[0] {
                for other in -sides[1]..=sides[1] {
                    let at = |middle: f64, step: i32| {
                        (middle + half * f64::from(step) / f64::from(SIDE)).clamp(0.0, 1.0)
                    };
                    let shares = [at(middle[0], one), at(middle[1], other)];
                    let found = self.score(domain, shares);
                    if found < best.0 {
                        best = (found, shares);
                    }
                }
            }
            if best.0 >= before {
                half /= 2.0;
                if half < LEAST {
                    break;
                }
            }
        }
        best
    }

    /// The best place with these values of the master; else why there is none. `end` is the end of the scaling's interval that asks
    /// least of the slave.
    fn allowed(
        &self,
        [offset, scaling]: [f64; 2],
        end: Option<End>,
    ) -> Result<Place, ConstraintError> {
        let factor = self.wish.from[3];
        let contradicts = |(ends, _): ([End; 2], f64)| {
            let first = |end: End| end.by.into_iter().flatten().find(|by| *by != Bound::Given);
            match (Self::contradiction(ends, self.unknown_of_slave()), end.and_then(first)) {
                // With less of the master the limits of the motion would be kept.
                (ConstraintError::Contradictory { one, .. }, Some(other))
                    if matches!(one, Bound::Limit { .. }) && !self.is_peak() =>
                {
                    ConstraintError::Contradictory { unknown: NAMES[1], one, other }
                }
                (error, _) => error,
            }
        };
        let ends = Self::scalings(&self.slaves(scaling), factor).map_err(contradicts)?;
        if self.is_peak() {
            self.nearest_zero(3, ends)?;
        }
        self.best(scaling, offset).map_err(|_infeasible| ConstraintError::Infeasible)
    }

    fn domain(&self, ends: [End; 2]) -> Domain {
        let from = self.wish.from;
        let [least, greatest] = ends.map(|end| end.value);
        let (mut near, mut far) = (least / from[1], greatest / from[1]);
        if near > far {
            (near, far) = (far, near);
        }
        let (beyond, pivot) = match self.objective {
            Objective::Error(samples) => {
                let sum = |of: &dyn Fn(&Sample) -> f64| samples.iter().map(of).sum::<f64>();
                (BEYOND, sum(&|s| s.weight * s.master) / sum(&|s| s.weight))
            }
            Objective::Peak(_) => (0.0, 0.0),
        };
        let near = near.max(0.0);
        let far = far.min(1.0 + beyond).max(near);
        // The ends stay what they are, to the last digit.
        let exact = |share: f64| {
            let end = [least, greatest].into_iter().find(|end| close(end / from[1], share));
            end.unwrap_or(from[1] * share)
        };
        let scalings = [exact(near), exact(1.0_f64.clamp(near, far)), exact(far)];
        let offset = self.interval(0).map(|(end, _)| end);
        let free = [!close(scalings[0], scalings[2]), !close(offset[0], offset[1])];
        Domain { scalings, pivot, free }
    }

    /// Offset and scaling of the master at shares of their ranges: the offset within a quarter of a pass about where it was.
    fn place(&self, domain: &Domain, [of_scaling, of_offset]: Shares) -> [f64; 2] {
        let within = |[from, to]: [f64; 2], share: f64| {
            if share >= 1.0 { to } else { from + share * (to - from) }
        };
        let [near, _, far] = domain.scalings;
        let scaling = within([near, far], of_scaling);
        let from = self.wish.from;
        let [low, high] = self.interval(0).map(|(end, _)| end);
        let reach = (self.curve.end() - self.curve.start()) / 4.0;
        let middle = from[0] + (from[1] - scaling) * domain.pivot;
        let offsets = [middle - reach, middle + reach].map(|offset| offset.clamp(low, high));
        [within(offsets, of_offset), scaling]
    }
}

impl Domain {
    /// Shares all over the ranges: of the scaling the denser the nearer to the usual one, with which the error is least without
    /// limits.
    fn grid(&self) -> Vec<(f64, Shares)> {
        let [near, usual, far] = self.scalings;
        let usual = if close(near, far) { 0.0 } else { (usual - near) / (far - near) };
        let count = if self.free == [true; 2] { GRID } else { LINE };
        let steps = |free: bool| 0..=if free { count } else { 0 };
        let share = |step: u32| f64::from(step) / f64::from(count);
        let scalings = steps(self.free[0]).flat_map(|step| {
            let dense = share(step).powi(3);
            [share(step), usual - usual * dense, usual + (1.0 - usual) * dense]
        });
        let offsets = steps(self.free[1]).map(share);
        scalings.flat_map(|one| offsets.clone().map(move |other| (0.0, [one, other]))).collect()
    }
}
