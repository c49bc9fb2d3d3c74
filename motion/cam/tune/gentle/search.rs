//! Which part of a cam the master is to go, where it goes a part only.

use super::region::Region;
use super::{GentleError, NAMES, Problem, close};

/// Places of the grid, in both directions, or in one where the other is given.
const GRID: u32 = 40;
const LINE: u32 = 800;
/// Places from which on it is looked for nearer.
const BEST: usize = 6;
/// Directions that are tried before the step gets smaller; the last step.
const DIRECTIONS: u32 = 24;
const LAST: f64 = 1e-11;
/// Steps in all, and the part of a peak below which nothing is gained.
const MOST: u32 = 4000;
const GAIN: f64 = 1e-12;
/// The angle between directions that never come again, as a part of a turn.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// The shares of the intervals.
type Shares = [f64; 2];

impl Problem<'_> {
    /// Scaling and offset of the master with the smallest peak of the slave.
    pub(super) fn search(
        &self,
        masters: &Region,
        [least, greatest]: [f64; 2],
    ) -> Result<(f64, f64), GentleError> {
        if !(least.is_finite() && greatest.is_finite()) {
            return Err(GentleError::Endless { unknown: NAMES[1] });
        }
        let from = self.wish.from;
        self.nearest_zero(1, if from[1] < 0.0 { greatest } else { least })?;
        let at = |[of_scaling, of_offset]: Shares| {
            let scaling = least + of_scaling * (greatest - least);
            let [low, high] = self.offsets(masters, scaling);
            (scaling, low + of_offset * (high - low))
        };
        let score = |shares: Shares| self.score(at(shares));
        let one_scaling = close(least, greatest);
        let [low, high] = self.offsets(masters, least);
        let [other_low, other_high] = self.offsets(masters, greatest);
        let one_offset = close(low, high) && close(other_low, other_high);
        let counts = match (one_scaling, one_offset) {
            // What contradicts there is told by who looks at it alone.
            (true, true) => return Ok(at([0.0, 0.0])),
            (true, false) => [0, LINE],
            (false, true) => [LINE, 0],
            (false, false) => [GRID, GRID],
        };
        let share = |index: u32, count: u32| f64::from(index) / f64::from(count.max(1));
        let mut places: Vec<(f64, Shares)> = Vec::new();
        for one in 0..=counts[0] {
            for other in 0..=counts[1] {
                let shares = [share(one, counts[0]), share(other, counts[1])];
                places.push((score(shares), shares));
            }
        }
        places.retain(|(score, _)| score.is_finite());
        places.sort_by(|one, other| one.0.total_cmp(&other.0));
        let step = 1.0 / f64::from(if counts[0] == GRID { GRID } else { LINE });
        // Not all from the same valley.
        let mut starts: Vec<(f64, Shares)> = Vec::new();
        for place in places {
            let near = |start: &(f64, Shares)| {
                let [one, other] = [0, 1].map(|index: usize| {
                    let of = |shares: &Shares| shares.get(index).copied().unwrap_or_default();
                    (of(&start.1) - of(&place.1)).abs()
                });
                one.max(other) < 2.5 * step
            };
            if starts.len() < BEST && !starts.iter().any(near) {
                starts.push(place);
            }
        }
        let ends = starts.into_iter().map(|start| descend(start, step, &score));
        let best = ends.min_by(|one, other| one.0.total_cmp(&other.0));
        best.map(|(_, shares)| at(shares)).ok_or(GentleError::NoPlace)
    }

    /// Least and greatest offset of the master with a scaling: where nothing else says it, once along the cam.
    fn offsets(&self, masters: &Region, scaling: f64) -> [f64; 2] {
        let [low, high] = masters.offsets(scaling).map(|end| end.value);
        let (curve, from) = (self.curve, self.wish.from[0]);
        let width = curve.end() - curve.start();
        let [one, other] = self.wish.travel.unwrap_or_default().map(|master| master * scaling);
        let [least, greatest] = if self.wish.repeated {
            [from - width / 2.0, from + width / 2.0]
        } else {
            [curve.start() - one.max(other), curve.end() - one.min(other)]
        };
        let (low, high) = match (low.is_finite(), high.is_finite()) {
            (true, true) => (low, high),
            (true, false) => (low, greatest.max(low)),
            (false, true) => (least.min(high), high),
            (false, false) => (least, greatest),
        };
        // Whole passes are the same cam, if it gains nothing.
        if self.wish.repeated && curve.rise() == 0.0 && high - low > width {
            let middle = from.clamp(low + width / 2.0, high - width / 2.0);
            return [middle - width / 2.0, middle + width / 2.0];
        }
        if low <= high { [low, high] } else { [super::nearest(from, low, high); 2] }
    }

    /// The slave's peak with the smallest scaling of the slave that does; infinite if none does.
    fn score(&self, (scaling, offset): (f64, f64)) -> f64 {
        let Some(passed) = self.passed(scaling, offset) else { return f64::INFINITY };
        let Ok([least, greatest]) = self.scalings(&self.slaves(&passed), 3) else {
            return f64::INFINITY;
        };
        let end = if self.wish.from[3] < 0.0 { greatest } else { least };
        // What nothing holds is told where the answer is.
        let factor = self.nearest_zero(3, end.value).unwrap_or(0.0);
        factor.abs() * self.peak(&passed, self.wish.quantity)
    }
}

/// From a place on down, in directions that never come again.
fn descend(
    (mut best, mut shares): (f64, Shares),
    mut step: f64,
    score: &dyn Fn(Shares) -> f64,
) -> (f64, Shares) {
    let mut failed = 0;
    for turn in 0..MOST {
        if step <= LAST {
            break;
        }
        let (sin, cos) = (std::f64::consts::TAU * GOLDEN * f64::from(turn)).sin_cos();
        // The axes themselves first: ends of intervals lie along them.
        let way = match failed {
            0 => [1.0, 0.0],
            1 => [-1.0, 0.0],
            2 => [0.0, 1.0],
            3 => [0.0, -1.0],
            _ => [cos, sin],
        };
        let [one, other] = shares;
        let tried = [one + step * way[0], other + step * way[1]].map(|share| share.clamp(0.0, 1.0));
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
