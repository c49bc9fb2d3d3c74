//! Search for scaling and offset of the master: differential evolution from a grid.

use super::region::Region;
use super::{Bound, ConstraintError, End, Objective, Place, Problem, close, nearest};
use crate::tune::Sample;
use crate::tune::evolution::{Evolution, Population, evolve};
use crate::tune::fit::NAMES;
use std::f64::consts::TAU;

/// Places of the grid in each of two directions, or in one.
const GRID: u32 = 24;
const LINE: u32 = 200;
/// How many of the best places are evolved, for how many generations; the last ones with all samples, around the best place.
const EVOLVED: [(usize, usize, bool); 2] = [(80, 20, true), (20, 100, false)];
const AROUND: f64 = 0.02;
/// The angle between directions that never come again, rad.
const GOLDEN: f64 = 0.618_033_988_749_895 * TAU;
/// Samples that the search looks at; its end takes all.
const SEARCHED: usize = 256;
/// The error may be least with a scaling that is greater by this part.
const BEYOND: f64 = 0.2;
/// The objective of a place that exceeds constraints: greater than any other, and the greater the farther it is.
const EXCEEDED: f64 = 1e100;
/// So many last digits are rounding.
const DIGITS: i32 = 16;

type Shares = [f64; 2];

/// The values of the master that are searched.
struct Domain<'a> {
    masters: &'a Region,
    /// Scalings: the one next to 0, the usual one, and the farthest one.
    scalings: [f64; 3],
    /// The mean master of the samples, where the offset compensates the scaling.
    pivot: f64,
    /// Whether scaling and offset are searched.
    free: [bool; 2],
}

impl Problem<'_> {
    /// The best place.
    pub(super) fn searched(&self, masters: &Region) -> Result<Place, ConstraintError> {
        let from = self.wish.from;
        let unknown = if self.wish.sought[1].is_none() && self.wish.sought[0].is_none() {
            NAMES[0]
        } else {
            NAMES[1]
        };
        let ends = Self::scalings(masters, from[1])
            .map_err(|(ends, _)| Self::contradiction(ends, unknown))?;
        if self.is_peak() {
            let scaling = self.nearest_zero(1, ends)?.value;
            let offset = nearest(from[0], masters.offsets(scaling).map(|end| end.value));
            return self.allowed(self.on_cam([offset, scaling]), None);
        }
        let domain = self.domain(masters, ends);
        let few: Vec<Sample>;
        let mut coarse = *self;
        if let Objective::Error(samples) = self.objective {
            let stride = samples.len().div_ceil(SEARCHED).max(1);
            few = samples.iter().step_by(stride).copied().collect();
            coarse.objective = Objective::Error(&few);
        }
        let at = |shares: Shares| self.place(&domain, shares);
        let score = |problem: &Problem<'_>, shares: &mut Shares| {
            *shares = shares.map(|share| share.clamp(0.0, 1.0));
            let [offset, scaling] = at(*shares);
            match problem.best(scaling, offset) {
                Ok(place) => place.cost,
                Err(by) => EXCEEDED * (1.0 + by.min(EXCEEDED)),
            }
        };
        let mut all: Population<2> = domain.grid();
        for (found, shares) in &mut all {
            *found = score(&coarse, shares);
        }
        all.sort_by(|one, other| one.0.total_cmp(&other.0));
        let free = domain.free;
        for (count, generations, crowded) in EVOLVED {
            all.truncate(count);
            let by = Evolution { free, generations, crowded, stream: 0 };
            all = evolve(all, by, &mut |shares| score(&coarse, shares));
        }
        if let Objective::Error(samples) = self.objective
            && samples.len() > SEARCHED
        {
            // All samples move the answer by little.
            let (_, [one, other]) = all[0];
            let mut angle = 0.0_f64;
            for (found, shares) in &mut all {
                angle += GOLDEN;
                let by = AROUND * (angle / TAU).fract();
                *shares = [one + by * angle.cos(), other + by * angle.sin()];
                *found = score(self, shares);
            }
            let by = Evolution { free, generations: EVOLVED[1].1, crowded: false, stream: 0 };
            all = evolve(all, by, &mut |shares| score(self, shares));
        }
        let found = all[0].1;
        let farthest = domain.scalings[0];
        let end = ends.into_iter().find(|end| close(end.value, farthest));
        let mut place = self.allowed(self.on_cam(at(found)), end.filter(|_| domain.free[0]))?;
        let width = self.curve.end() - self.curve.start();
        if matches!(self.objective, Objective::Error(_))
            && self.wish.repeated
            && self.curve.rise() == 0.0
            && self.wish.start.is_none()
            && domain.free[1]
        {
            // Whole passes are the same cam.
            place.values[0] -= ((place.values[0] - from[0]) / width).round() * width;
        }
        Ok(place)
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

    fn domain<'a>(&self, masters: &'a Region, ends: [End; 2]) -> Domain<'a> {
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
            _ => (0.0, 0.0),
        };
        let near = near.max(0.0);
        let far = far.min(1.0 + beyond).max(near);
        // The ends stay what they are, to the last digit.
        let exact = |share: f64| {
            let end = [least, greatest].into_iter().find(|end| close(end / from[1], share));
            end.unwrap_or(from[1] * share)
        };
        let scalings = [exact(near), exact(1.0_f64.clamp(near, far)), exact(far)];
        let mut domain = Domain { masters, scalings, pivot, free: [false; 2] };
        domain.free[0] = !close(scalings[0], scalings[2]);
        domain.free[1] = [scalings[0], scalings[2]].into_iter().any(|scaling| {
            let [low, high] = self.offsets(&domain, scaling);
            low < high && !close(low, high)
        });
        domain
    }

    /// Offset and scaling of the master at shares of their ranges.
    fn place(&self, domain: &Domain<'_>, [of_scaling, of_offset]: Shares) -> [f64; 2] {
        let within = |[from, to]: [f64; 2], share: f64| {
            if share >= 1.0 { to } else { from + share * (to - from) }
        };
        let [near, _, far] = domain.scalings;
        let scaling = within([near, far], of_scaling);
        [within(self.offsets(domain, scaling), of_offset), scaling]
    }

    /// Least and greatest offset with a scaling: a quarter of a pass about where it was, within the constraints.
    fn offsets(&self, domain: &Domain<'_>, scaling: f64) -> [f64; 2] {
        let from = self.wish.from;
        let reach = (self.curve.end() - self.curve.start()) / 4.0;
        let [low, high] = domain.masters.offsets(scaling).map(|end| end.value);
        let middle = from[0] + (from[1] - scaling) * domain.pivot;
        if low > high {
            return [nearest(middle, [low, high]); 2];
        }
        [middle - reach, middle + reach].map(|offset| offset.clamp(low, high))
    }

    /// The same values but for the rounding that puts the master off the cam when the slave is coupled.
    fn on_cam(&self, [offset, scaling]: [f64; 2]) -> [f64; 2] {
        let Some(master) = self.wish.start else { return [offset, scaling] };
        let free = [0, 1].map(|index| self.wish.sought[index].is_some());
        let size =
            (master * scaling).abs().max(self.curve.start().abs()).max(self.curve.end().abs());
        let digit = f64::EPSILON * size.max(offset.abs());
        let near =
            (0..=DIGITS).flat_map(|step| [1.0, -1.0].map(|sign| sign * f64::from(step) * digit));
        let near = near.flat_map(|by| {
            let of_offset = (free[0] || by == 0.0).then_some([offset + by, scaling]);
            let of_scaling = (free[1] && master != 0.0).then(|| [offset, scaling + by / master]);
            [of_offset, of_scaling].into_iter().flatten()
        });
        let mut near = near;
        near.find(|[offset, scaling]| self.curve.contains(master * scaling + offset))
            .unwrap_or([offset, scaling])
    }
}

impl Domain<'_> {
    /// Shares all over the ranges: of the scaling the denser the nearer to the usual one, with which the error is least without
    /// limits.
    fn grid(&self) -> Population<2> {
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
