//! Down to the best scaling of the master.

use super::{Aim, Bound, Found, GentleError, Problem};

/// Scalings of the grid; they stand the nearer to each other, the nearer they are to the one that is the best without limits.
const GRID: u32 = 240;
/// Places of the grid from where on it is looked for.
const VALLEYS: usize = 3;
/// Samples that the search looks at; the last step takes them all.
const SEARCHED: usize = 1000;
/// Halvings after which a share is known to its last digit, and golden sections after which what is found no longer changes.
const HALVINGS: usize = 1100;
const SECTIONS: usize = 60;
/// So much farther the scaling is looked for than the limits of the motion ask for, where the error is to be small.
const BEYOND: f64 = 0.2;
/// A smaller part of its scaling leaves nothing of the master.
const LEAST: f64 = 1e-9;

impl Problem<'_> {
    /// The best place with another scaling of the master.
    pub(super) fn searched(&self) -> Result<Found, GentleError> {
        let from = self.wish.from;
        let still = self.region(None);
        let [least, greatest] = self.allowed(&still)?;
        let gentlest = if from[3] < 0.0 { greatest.value } else { least.value };
        let loose = self.best(from, &still);
        // Below this part of its scaling no limit of the motion takes anything from the slave any more, above the other one
        // nothing is left.
        let bottom = largest(|share| self.reached(from[1] * share, loose.values[3]) <= 1.0);
        let beyond = match self.aim {
            // An error may be less with another part of the cam, whatever the motion.
            Aim::Error(_) => BEYOND,
            Aim::Change if bottom >= 1.0 && self.starts_between(from[1]) => return Ok(loose),
            Aim::Change => 0.0,
        };
        let most = 1.0 + beyond;
        let top = most * largest(|share| self.reached(from[1] * share * most, gentlest) <= 1.0);
        if top < LEAST {
            self.allowed(&self.region(Some(from[1])))?;
        }
        let ([low, high], [of_low, of_high]) = self.shares();
        let unknown = "MasterScaling";
        if low > high {
            return Err(GentleError::Contradictory { unknown, one: of_low, other: of_high });
        }
        if low > top {
            // The least of the scalings asks the motion for too much.
            let allowed = self.allowed(&self.region(Some(from[1] * low)));
            allowed.map_err(|error| match error {
                GentleError::Contradictory { one, .. } => {
                    GentleError::Contradictory { unknown, one, other: of_low }
                }
                other => other,
            })?;
        }
        let top = top.max(low).min(high);
        let bottom = (bottom * (1.0 - beyond)).clamp(low.max(0.0).min(top), top);
        let usual = 1.0_f64.clamp(bottom, top);
        let few: Vec<_>;
        let coarse = match self.aim {
            Aim::Error(samples) => {
                let stride = samples.len().div_ceil(SEARCHED).max(1);
                few = samples.iter().step_by(stride).copied().collect();
                Problem { aim: Aim::Error(&few), ..*self }
            }
            Aim::Change => Problem { ..*self },
        };
        // The middle of the samples stays where it is on the cam.
        let middle = match self.aim {
            Aim::Error(samples) => {
                let all = samples.iter().map(|sample| (sample.weight, sample.master));
                let (weights, sum) =
                    all.fold((0.0, 0.0), |(w, sum), (weight, at)| (w + weight, sum + weight * at));
                if weights > 0.0 { sum / weights } else { 0.0 }
            }
            Aim::Change => 0.0,
        };
        let at = |problem: &Problem<'_>, share: f64| {
            let way = if share > 0.0 { usual - bottom } else { top - usual };
            let scaling = from[1] * (usual - way * share.powi(3));
            let mut start = loose.values;
            start[1] = scaling;
            if self.free[0] {
                start[0] += (from[1] - scaling) * middle;
            }
            problem.best(start, &problem.region(Some(scaling)))
        };
        // Less than 0 above the scaling that is the best without limits, if there is anything.
        let least = if top > usual { -1.0 } else { 0.0 };
        let share = |index: u32| least + (1.0 - least) * f64::from(index) / f64::from(GRID);
        let row: Vec<f64> = (0..=GRID).map(|index| at(&coarse, share(index)).cost).collect();
        let mut valleys: Vec<(f64, u32)> = (0..=GRID)
            .zip(&row)
            .zip(row.iter().skip(1).chain([&f64::INFINITY]))
            .zip([f64::INFINITY].iter().chain(&row))
            .filter(|(((_, cost), next), before)| cost <= next && cost <= before)
            .map(|(((index, cost), _), _)| (*cost, index))
            .collect();
        valleys.sort_by(|one, other| one.0.total_cmp(&other.0));
        let deepest = valleys.into_iter().take(VALLEYS).map(|(_, index)| {
            let ends = [share(index.saturating_sub(1)), share((index + 1).min(GRID))];
            let found = golden(ends, |share| at(&coarse, share).cost);
            // The ends of all are places themselves.
            let both = [found, share(index)].map(|share| at(self, share));
            let [one, other] = both;
            if one.cost <= other.cost { one } else { other }
        });
        deepest.min_by(|one, other| one.cost.total_cmp(&other.cost)).ok_or(GentleError::NoPlace)
    }
}

impl Problem<'_> {
    /// Between what the scaling of the master may be, as shares of what it is without limits, and what says so.
    fn shares(&self) -> ([f64; 2], [Bound; 2]) {
        let from = self.wish.from[1];
        let [mut low, mut high] = self.scalings().map(|(end, by)| (end / from, by));
        if low.0 > high.0 {
            (low, high) = (high, low);
        }
        ([low.0, high.0], [low.1, high.1])
    }

    /// Whether a scaling of the master is between these.
    fn starts_between(&self, scaling: f64) -> bool {
        let [(low, _), (high, _)] = self.scalings();
        (low..=high).contains(&scaling)
    }
}

/// The largest share, 1 at most, that holds; what is less holds, too. 0 if none does.
fn largest(holds: impl Fn(f64) -> bool) -> f64 {
    if holds(1.0) {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            break;
        }
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Where something is least in a valley.
fn golden([mut low, mut high]: [f64; 2], of: impl Fn(f64) -> f64) -> f64 {
    let ratio = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut one, mut other) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut of_one, mut of_other) = (of(one), of(other));
    for _ in 0..SECTIONS {
        if of_one <= of_other {
            (high, other, of_other) = (other, one, of_one);
            one = high - ratio * (high - low);
            of_one = of(one);
        } else {
            (low, one, of_one) = (one, other, of_other);
            other = low + ratio * (high - low);
            of_other = of(other);
        }
    }
    f64::midpoint(low, high)
}
