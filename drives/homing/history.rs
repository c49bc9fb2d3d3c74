//! Position history of an axis, interpolated between samples.

use std::collections::VecDeque;

/// Samples that are kept at most.
const MOST: usize = 4096;

/// Positions of an axis over the last time, for what was so long ago.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Time, ns, and position; rising times.
    samples: VecDeque<(i64, f64)>,
    keep_ns: i64,
}

impl History {
    /// Keeps what is needed for times up to `keep_ns` before the last sample.
    pub fn new(keep_ns: i64) -> Self {
        Self { samples: VecDeque::new(), keep_ns: keep_ns.max(0) }
    }

    /// The axis was at `position` at `time_ns`; earlier than the last sample it is not taken.
    pub fn push(&mut self, time_ns: i64, position: f64) {
        if self.samples.back().is_some_and(|(last, _)| *last >= time_ns) {
            return;
        }
        self.samples.push_back((time_ns, position));
        // One sample from before is needed to interpolate.
        while self.samples.get(1).is_some_and(|(second, _)| time_ns - second > self.keep_ns)
            || self.samples.len() > MOST
        {
            self.samples.pop_front();
        }
    }

    /// Position of the axis at `time_ns`, on straight lines between the samples; before the first and after the last it was
    /// where they are. `None` without samples.
    pub fn at(&self, time_ns: i64) -> Option<f64> {
        let after = self.samples.partition_point(|(time, _)| *time <= time_ns);
        let next = self.samples.get(after);
        let last = after.checked_sub(1).and_then(|place| self.samples.get(place));
        match (last, next) {
            (Some((from, a)), Some((to, b))) => {
                #[expect(clippy::cast_precision_loss, reason = "times between two looks")]
                let part = (time_ns - from) as f64 / (to - from) as f64;
                Some(a + (b - a) * part)
            }
            (Some((_, position)), None) | (None, Some((_, position))) => Some(*position),
            (None, None) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_interpolated_and_forgotten() {
        let mut history = History::new(100);
        assert_eq!(history.at(5), None);
        for (time, position) in [(0, 0.0), (100, 10.0), (200, 30.0), (150, 99.0)] {
            history.push(time, position);
        }
        let found = [-5, 50, 100, 175, 999].map(|time| history.at(time).unwrap());
        for (found, expected) in found.into_iter().zip([0.0, 5.0, 10.0, 25.0, 30.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        history.push(350, 60.0);
        // 250 is asked for at most: 200 is the last before it.
        assert_eq!(history.at(0), Some(30.0));
        assert_eq!(history.at(275), Some(45.0));
    }
}
