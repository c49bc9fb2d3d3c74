//! Cycle lateness of a run in step with the wall clock.

use crate::setpoint::HORIZON_NS;
use hdrhistogram::Histogram;

/// Longest lateness that is distinguished from longer ones, µs: a minute.
const LONGEST_US: u64 = 60_000_000;

/// Cycle lateness of a run, each cycle against the instant at which it was due on the session's clock.
///
/// Set-points are planned ahead, so a late cycle is a late command to a drive only when it is later than the horizon of the
/// plan ([`crate::setpoint::HORIZON_NS`]); it is how well this computer keeps time.
#[derive(Clone, Debug)]
pub struct Punctuality {
    /// µs, three digits; none if there is no room for it.
    lateness: Option<Histogram<u64>>,
    /// Longest sleep of the computer, ns.
    slept_ns: i64,
}

impl Punctuality {
    /// Of a run without cycles so far.
    pub(super) fn new() -> Self {
        Self { lateness: Histogram::new_with_max(LONGEST_US, 3).ok(), slept_ns: 0 }
    }

    /// A cycle that was due at `due_ns` has been taken up at `taken_ns`.
    pub(super) fn record(&mut self, due_ns: i64, taken_ns: i64) {
        let late_us = u64::try_from((taken_ns - due_ns) / 1000).unwrap_or(0);
        if let Some(lateness) = &mut self.lateness {
            lateness.saturating_record(late_us);
        }
    }

    /// The computer has slept, so that the session's clock stood still as well.
    pub(super) fn slept(&mut self, slept_ns: i64) {
        self.slept_ns = self.slept_ns.max(slept_ns);
    }

    /// Longest time for which this computer did not look after the run, ns, if the plan of the drives does not last so
    /// long ([`HORIZON_NS`]): the process was stopped, or the computer slept or was overloaded.
    pub fn standstill_ns(&self) -> Option<i64> {
        let late_ns = i64::try_from(self.max_us()).unwrap_or(i64::MAX).saturating_mul(1000);
        Some(late_ns.max(self.slept_ns)).filter(|longest| *longest > HORIZON_NS)
    }

    /// Number of cycles.
    pub fn cycles(&self) -> u64 {
        self.lateness.as_ref().map_or(0, Histogram::len)
    }

    /// Lateness that `percent` % of the cycles do not exceed, µs, to three digits.
    pub fn percentile_us(&self, percent: f64) -> u64 {
        self.lateness.as_ref().map_or(0, |lateness| lateness.value_at_percentile(percent))
    }

    /// Largest lateness, µs, to three digits.
    pub fn max_us(&self) -> u64 {
        self.lateness.as_ref().map_or(0, Histogram::max)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]
mod tests {
    use super::Punctuality;

    #[test]
    fn percentiles_are_those_of_the_cycles() {
        let mut punctuality = Punctuality::new();
        assert_eq!((punctuality.cycles(), punctuality.max_us()), (0, 0));
        // 1 to 1000 µs late, in any order.
        for cycle in 0..1000_i64 {
            let late_us = (cycle * 7919) % 1000 + 1;
            punctuality.record(cycle * 1_000_000, cycle * 1_000_000 + late_us * 1000);
        }
        assert_eq!(punctuality.cycles(), 1000);
        assert_eq!(punctuality.percentile_us(50.0), 500);
        assert_eq!(punctuality.percentile_us(99.0), 990);
        assert_eq!(punctuality.max_us(), 1000);
    }

    #[test]
    fn a_standstill_is_longer_than_the_plan_ahead() {
        let mut punctuality = Punctuality::new();
        punctuality.record(0, 249_000_000);
        assert_eq!(punctuality.standstill_ns(), None);
        punctuality.slept(700_000_000);
        assert_eq!(punctuality.standstill_ns(), Some(700_000_000));
        punctuality.record(1_000_000, 2_001_000_000);
        let late_ns = punctuality.standstill_ns().unwrap();
        assert!((late_ns - 2_000_000_000).abs() < 3_000_000, "{late_ns}");
    }

    #[test]
    fn early_is_not_late_and_a_very_late_cycle_counts() {
        let mut punctuality = Punctuality::new();
        punctuality.record(5_000_000, 4_000_000);
        assert_eq!(punctuality.max_us(), 0);
        punctuality.record(0, i64::MAX);
        assert_eq!(punctuality.cycles(), 2);
        assert!(punctuality.max_us() >= 59_000_000, "{}", punctuality.max_us());
    }
}
