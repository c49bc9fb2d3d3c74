//! Where a master was, sample by sample, so that its passages of a place are found without looking through all of the run.
//!
//! A tree of the least and the greatest place of every half, quarter, … of the samples: what holds no place on one side of another
//! one is left out as a whole, so that the nearest sample there is found in as many steps as the number of samples has bits.

/// Places of a run on the scale of the cam, by time.
pub(super) struct Course<'a> {
    /// Time, s, and place, u.
    samples: &'a [(f64, f64)],
    /// Least and greatest place: of all at 1, of both halves at 2 and 3, and so on; of the samples themselves from `leaves` on.
    ranges: Vec<[f64; 2]>,
    leaves: usize,
}

/// Nothing has such a range.
const EMPTY: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

impl<'a> Course<'a> {
    pub(super) fn new(samples: &'a [(f64, f64)]) -> Self {
        let leaves = samples.len().max(1).next_power_of_two();
        let mut ranges = vec![EMPTY; 2 * leaves];
        for (range, (_, place)) in ranges.iter_mut().skip(leaves).zip(samples) {
            *range = [*place, *place];
        }
        for node in (1..leaves).rev() {
            let [one, other] = [2 * node, 2 * node + 1].map(|half| range_of(&ranges, half));
            if let Some(range) = ranges.get_mut(node) {
                *range = [one[0].min(other[0]), one[1].max(other[1])];
            }
        }
        Self { samples, ranges, leaves }
    }

    /// When the master passed `target` last, in the direction of `velocity`, before the sample behind `index`; else when it does
    /// next. On straight lines between the samples.
    pub(super) fn passage(&self, index: usize, target: f64, velocity: f64) -> Option<f64> {
        let forwards = velocity > 0.0;
        // The range of one sample holds its place alone.
        let beyond = |[low, high]: [f64; 2]| if forwards { high >= target } else { low <= target };
        let short = |[low, high]: [f64; 2]| if forwards { low < target } else { high > target };
        let last = || {
            let end = self.last(index + 2, &beyond)?;
            self.last(end, &short)
        };
        let next = || {
            let begin = self.next(index, &short)?;
            Some(self.next(begin + 1, &beyond)? - 1)
        };
        let begin = last().or_else(next)?;
        let [from, to] = self.samples.get(begin..begin + 2)? else { return None };
        let share = (target - from.1) / (to.1 - from.1);
        Some(from.0 + share * (to.0 - from.0))
    }

    /// The last of the first `count` samples that is so.
    fn last(&self, count: usize, is: &dyn Fn([f64; 2]) -> bool) -> Option<usize> {
        self.found(1, 0, self.leaves, &|from, _| from < count, [1, 0], is)
    }

    /// The first sample from `begin` on that is so.
    fn next(&self, begin: usize, is: &dyn Fn([f64; 2]) -> bool) -> Option<usize> {
        self.found(1, 0, self.leaves, &|from, width| from + width > begin, [0, 1], is)
    }

    /// The first sample that is so of a part that begins with `from`, its halves in an order, as far as they count at all.
    fn found(
        &self,
        node: usize,
        from: usize,
        width: usize,
        counts: &dyn Fn(usize, usize) -> bool,
        order: [usize; 2],
        is: &dyn Fn([f64; 2]) -> bool,
    ) -> Option<usize> {
        if !counts(from, width) || !is(range_of(&self.ranges, node)) {
            return None;
        }
        if width == 1 {
            return Some(from);
        }
        let half = width / 2;
        order.into_iter().find_map(|which| {
            self.found(2 * node + which, from + which * half, half, counts, order, is)
        })
    }
}

fn range_of(ranges: &[[f64; 2]], node: usize) -> [f64; 2] {
    ranges.get(node).copied().unwrap_or(EMPTY)
}

#[cfg(test)]
mod tests {
    use super::Course;

    /// Pair by pair, as it is said.
    fn slow(samples: &[(f64, f64)], index: usize, target: f64, velocity: f64) -> Option<f64> {
        let beyond = |place: f64| (place - target) * velocity.signum() >= 0.0;
        let crosses = |pair: &&[(f64, f64)]| !beyond(pair[0].1) && beyond(pair[1].1);
        let before = samples[..index + 2].windows(2).rev().find(crosses);
        let pair = before.or_else(|| samples[index..].windows(2).find(crosses))?;
        let share = (target - pair[0].1) / (pair[1].1 - pair[0].1);
        Some(pair[0].0 + share * (pair[1].0 - pair[0].0))
    }

    /// To the last digit on masters that go to and fro, stand, and meet places exactly.
    #[test]
    fn passages_are_those_that_looking_through_finds() {
        let mut state = 77_u64;
        // Whole numbers below `most` (Knuth's generator, its high bits).
        let mut draw = |most: u32| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            u32::try_from(state >> 33).expect("31 bits") % most
        };
        let [mut found, mut none] = [0; 2];
        for _ in 0..4000 {
            let mut place = 0.0_f64;
            let samples: Vec<_> = (0..2 + draw(40))
                .map(|index| {
                    // Targets are met.
                    place += f64::from(draw(6)) - 2.0;
                    (0.001 * f64::from(index), place)
                })
                .collect();
            let course = Course::new(&samples);
            for index in 0..samples.len() - 1 {
                let target = f64::from(draw(100)) / 2.0 - 10.0;
                for velocity in [1.0, -3.0] {
                    let passed = course.passage(index, target, velocity);
                    assert_eq!(passed, slow(&samples, index, target, velocity), "{samples:?}");
                    found += u32::from(passed.is_some());
                    none += u32::from(passed.is_none());
                }
            }
        }
        assert!(found > 10_000 && none > 10_000, "{found} {none}");
    }
}
