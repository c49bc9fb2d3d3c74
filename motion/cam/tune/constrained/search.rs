//! Search for scaling and offset of the master: a grid, then golden sections, or a direct search where both are free.

use super::region::Region;
use super::{Bound, ConstraintError, End, Objective, Place, Problem, close, nearest};
use crate::tune::Sample;
use crate::tune::fit::NAMES;

/// Places of the grid: in each of two directions, or in one.
const GRID: u32 = 40;
const LINE: u32 = 400;
/// Places of it from which the search goes on.
const BEST: usize = 6;
/// Golden sections of a bracket.
const SECTIONS: usize = 80;
/// Directions that are tried before the step of the direct search halves, its last step, and all its steps.
const DIRECTIONS: u32 = 16;
const LAST: f64 = 1e-11;
const STEPS: u32 = 3000;
/// A gain below this part is none.
const GAIN: f64 = 1e-13;
/// The angle between directions that never come again, as a part of a turn.
const GOLDEN: f64 = 0.618_033_988_749_895;
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
    /// The mean master of the samples: what is there on the cam stays there.
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
        if self.is_peak() && self.wish.travel.is_none() {
            let scaling = self.nearest_zero(1, ends)?.value;
            let offset = nearest(from[0], masters.offsets(scaling).map(|end| end.value));
            return self.allowed(self.on_cam([offset, scaling]), None);
        }
        let domain = self.domain(masters, ends)?;
        let few: Vec<Sample>;
        let coarse = match self.objective {
            Objective::Error(samples) => {
                let stride = samples.len().div_ceil(SEARCHED).max(1);
                few = samples.iter().step_by(stride).copied().collect();
                Problem { objective: Objective::Error(&few), ..*self }
            }
            _ => *self,
        };
        let at = |shares: Shares| self.place(&domain, shares);
        let scored = |problem: &Problem<'_>, shares: Shares| {
            let [offset, scaling] = self.place(&domain, shares);
            match problem.best(scaling, offset) {
                Ok(place) => place.cost,
                Err(by) => EXCEEDED * (1.0 + by.min(EXCEEDED)),
            }
        };
        let score = |shares: Shares| scored(&coarse, shares);
        let mut found = match domain.free {
            [false, false] => [0.0, 0.0],
            [true, true] => descend_from_grid(&score),
            [scaling, _] => {
                let shares = |share: f64| if scaling { [share, 0.0] } else { [0.0, share] };
                shares(least_on_line(&|share| score(shares(share))))
            }
        };
        if let (Objective::Error(samples), true) = (self.objective, domain.free != [false; 2])
            && samples.len() > few_of(&coarse)
        {
            // All samples move the answer by little.
            let step = 0.5 / f64::from(GRID);
            let score = |shares: Shares| scored(self, shares);
            found = descend((score(found), found), step, domain.free, &score).1;
        }
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
        let passed = self.passed(scaling, offset).ok_or(ConstraintError::Infeasible)?;
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
        let ends = Self::scalings(&self.slaves(&passed), factor).map_err(contradicts)?;
        if self.is_peak() {
            self.nearest_zero(3, ends)?;
        }
        self.best(scaling, offset).map_err(|_infeasible| ConstraintError::Infeasible)
    }

    fn domain<'a>(
        &self,
        masters: &'a Region,
        ends: [End; 2],
    ) -> Result<Domain<'a>, ConstraintError> {
        let from = self.wish.from;
        let [least, greatest] = ends.map(|end| end.value);
        let (scalings, pivot) = if let Objective::Peak(_) = self.objective {
            if !(least.is_finite() && greatest.is_finite()) {
                return Err(ConstraintError::Unterminated { unknown: NAMES[1] });
            }
            self.nearest_zero(1, ends)?;
            ([least, least, greatest], 0.0)
        } else {
            let (mut near, mut far) = (least / from[1], greatest / from[1]);
            if near > far {
                (near, far) = (far, near);
            }
            let beyond = if let Objective::Error(_) = self.objective { BEYOND } else { 0.0 };
            let near = near.max(0.0);
            let far = far.min(1.0 + beyond).max(near);
            let pivot = match self.objective {
                Objective::Error(samples) => {
                    let sum = |of: &dyn Fn(&Sample) -> f64| samples.iter().map(of).sum::<f64>();
                    sum(&|s| s.weight * s.master) / sum(&|s| s.weight)
                }
                _ => 0.0,
            };
            // The ends stay what they are, to the last digit.
            let exact = |share: f64| {
                let end = [least, greatest].into_iter().find(|end| close(end / from[1], share));
                end.unwrap_or(from[1] * share)
            };
            ([exact(near), exact(1.0_f64.clamp(near, far)), exact(far)], pivot)
        };
        let mut domain = Domain { masters, scalings, pivot, free: [false; 2] };
        domain.free[0] = !close(scalings[0], scalings[2]);
        domain.free[1] = [scalings[0], scalings[2]].into_iter().any(|scaling| {
            let [low, high] = self.offsets(&domain, scaling);
            low < high && !close(low, high)
        });
        Ok(domain)
    }

    /// Offset and scaling of the master at shares of their ranges. Where the usual scaling is the best without limits, the grid is
    /// the finer the nearer it is.
    fn place(&self, domain: &Domain<'_>, [of_scaling, of_offset]: Shares) -> [f64; 2] {
        let [near, usual, far] = domain.scalings;
        let scaling = if self.is_peak() {
            near + of_scaling * (far - near)
        } else if of_scaling >= 1.0 || close(near, far) {
            near
        } else {
            let (one, other) = (usual - near, far - usual);
            // Shares above `split` lie between the usual scaling and the one next to 0.
            let split = if close(usual, far) { 0.0 } else { 0.25 };
            if of_scaling >= split {
                usual - one * ((of_scaling - split) / (1.0 - split)).powi(3)
            } else {
                usual + other * ((split - of_scaling) / split).powi(3)
            }
        };
        let [low, high] = self.offsets(domain, scaling);
        [if of_offset >= 1.0 { high } else { low + of_offset * (high - low) }, scaling]
    }

    /// Least and greatest offset with a scaling: half a pass about where it was, or once along the cam, within the constraints.
    fn offsets(&self, domain: &Domain<'_>, scaling: f64) -> [f64; 2] {
        let from = self.wish.from;
        let (curve, width) = (self.curve, self.curve.end() - self.curve.start());
        let [low, high] = domain.masters.offsets(scaling).map(|end| end.value);
        let [least, greatest] = if self.is_peak() {
            let [one, other] = self.wish.travel.unwrap_or_default().map(|master| master * scaling);
            if self.wish.repeated {
                [from[0] - width / 2.0, from[0] + width / 2.0]
            } else {
                [curve.start() - one.max(other), curve.end() - one.min(other)]
            }
        } else {
            let middle = from[0] + (from[1] - scaling) * domain.pivot;
            let within = [middle - width / 4.0, middle + width / 4.0];
            return if low > high {
                [nearest(middle, [low, high]); 2]
            } else {
                within.map(|offset| offset.clamp(low, high))
            };
        };
        let (low, high) = match (low.is_finite(), high.is_finite()) {
            (true, true) => (low, high),
            (true, false) => (low, greatest.max(low)),
            (false, true) => (least.min(high), high),
            (false, false) => (least, greatest),
        };
        if self.wish.repeated && curve.rise() == 0.0 && high - low > width {
            let middle = from[0].clamp(low + width / 2.0, high - width / 2.0);
            return [middle - width / 2.0, middle + width / 2.0];
        }
        if low <= high { [low, high] } else { [nearest(from[0], [low, high]); 2] }
    }

    /// The same values but for the rounding that puts the master beside the cam when the slave is coupled.
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

fn few_of(problem: &Problem<'_>) -> usize {
    match problem.objective {
        Objective::Error(samples) => samples.len(),
        _ => 0,
    }
}

fn share(index: u32, count: u32) -> f64 {
    f64::from(index) / f64::from(count)
}

/// The share with the least score: the best of the grid, and of golden sections about its minima.
fn least_on_line(score: &dyn Fn(f64) -> f64) -> f64 {
    let row: Vec<(f64, f64)> =
        (0..=LINE).map(|index| share(index, LINE)).map(|share| (score(share), share)).collect();
    let at = |index: usize| row.get(index).map_or(f64::INFINITY, |(score, _)| *score);
    let mut minima: Vec<(f64, f64)> = row
        .iter()
        .enumerate()
        .filter(|(index, (score, _))| {
            *score <= at(index.wrapping_sub(1)) && *score <= at(index + 1)
        })
        .map(|(_, place)| *place)
        .collect();
    minima.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut best = minima.first().copied().unwrap_or((f64::INFINITY, 0.0));
    for (_, middle) in minima.into_iter().take(BEST) {
        let ends = [-1.0, 1.0].map(|by| (middle + by / f64::from(LINE)).clamp(0.0, 1.0));
        let found = golden(ends, score);
        if found.0 < best.0 {
            best = found;
        }
    }
    best.1
}

/// The best place of golden sections in a bracket.
fn golden([mut low, mut high]: [f64; 2], of: &dyn Fn(f64) -> f64) -> (f64, f64) {
    let at = |share: f64| (of(share), share);
    let inner = |low: f64, high: f64| high - GOLDEN * (high - low);
    let (mut one, mut other) = (at(inner(low, high)), at(low + high - inner(low, high)));
    let mut best = (f64::INFINITY, low);
    for _ in 0..SECTIONS {
        for place in [one, other] {
            if place.0 < best.0 {
                best = place;
            }
        }
        if one.0 <= other.0 {
            (high, other) = (other.1, one);
            one = at(inner(low, high));
        } else {
            (low, one) = (one.1, other);
            other = at(low + high - inner(low, high));
        }
    }
    best
}

/// The best of direct searches from the best places of a grid that are not neighbours.
fn descend_from_grid(score: &dyn Fn(Shares) -> f64) -> Shares {
    let all = (0..=GRID).flat_map(|one| (0..=GRID).map(move |other| [one, other]));
    let mut places: Vec<(f64, Shares)> = all
        .map(|place| place.map(|index| share(index, GRID)))
        .map(|shares| (score(shares), shares))
        .collect();
    places.sort_by(|one, other| one.0.total_cmp(&other.0));
    let step = 1.0 / f64::from(GRID);
    let mut starts: Vec<(f64, Shares)> = Vec::new();
    for place in places {
        let apart = |start: &(f64, Shares)| {
            let by = [0, 1].map(|index: usize| (start.1[index] - place.1[index]).abs());
            by[0].max(by[1]) > 2.5 * step
        };
        if starts.len() < BEST && starts.iter().all(apart) {
            starts.push(place);
        }
    }
    let ends = starts.into_iter().map(|start| descend(start, step, [true; 2], score));
    ends.min_by(|one, other| one.0.total_cmp(&other.0)).map_or([0.0; 2], |(_, shares)| shares)
}

/// Direct search: along the axes, and in directions that never come again.
fn descend(
    (mut best, mut shares): (f64, Shares),
    mut step: f64,
    free: [bool; 2],
    score: &dyn Fn(Shares) -> f64,
) -> (f64, Shares) {
    let mut failed = 0;
    for turn in 0..STEPS {
        if step <= LAST {
            break;
        }
        let (sin, cos) = (std::f64::consts::TAU * GOLDEN * f64::from(turn)).sin_cos();
        let way = match failed {
            0 => [1.0, 0.0],
            1 => [-1.0, 0.0],
            2 => [0.0, 1.0],
            3 => [0.0, -1.0],
            _ => [cos, sin],
        };
        let tried = std::array::from_fn(|index| {
            let by = if free[index] { step * way[index] } else { 0.0 };
            (shares[index] + by).clamp(0.0, 1.0)
        });
        let found = score(tried);
        if found < best * (1.0 - GAIN) {
            (best, shares, failed) = (found, tried, 0);
            step = (step * 1.5).min(0.1);
        } else {
            failed += 1;
            if failed > DIRECTIONS {
                step *= 0.5;
                failed = 0;
            }
        }
    }
    (best, shares)
}
