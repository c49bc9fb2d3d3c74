//! Sample statistics of devices: count, rate and longest gap.

use twin_number::seconds;

/// Sample statistics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Heard {
    /// Samples.
    pub count: u32,
    first_ns: i64,
    last_ns: i64,
    /// Longest time between two of them, ns; in this time the device is not corrected.
    pub longest_gap_ns: i64,
    /// Answers that were lost and asked for again, from the start-up on.
    pub lost_answers: u32,
}

impl Heard {
    /// A sample of this time; those before the last one say nothing new.
    pub(crate) fn include(&mut self, time_ns: i64) {
        if self.count == 0 {
            self.first_ns = time_ns;
        } else {
            self.longest_gap_ns = self.longest_gap_ns.max(time_ns.saturating_sub(self.last_ns));
        }
        self.last_ns = time_ns;
        self.count = self.count.saturating_add(1);
    }

    /// Mean rate, 1/s.
    pub fn per_s(self) -> f64 {
        let time = seconds(self.last_ns - self.first_ns);
        if time > 0.0 { f64::from(self.count.saturating_sub(1)) / time } else { 0.0 }
    }

    /// Longest time between two samples, ms.
    pub fn longest_gap_ms(self) -> f64 {
        seconds(self.longest_gap_ns) * 1e3
    }
}

/// Axis positions of a device in its last sample.
#[derive(Clone, Debug, PartialEq)]
pub struct LastHeard {
    /// Its name.
    pub device: String,
    /// Time, ns.
    pub time_ns: i64,
    /// Its axes in machine-file order, and where they were, m or rad.
    pub axes: Vec<(usize, f64)>,
    /// It has failed since: where its axes are now is not known.
    pub lost: bool,
}

#[cfg(test)]
mod tests {
    use super::Heard;

    /// Two devices that are heard of in turn: what lies between two samples of all is no gap of either.
    #[test]
    fn gaps_are_between_samples_of_one_device() {
        let mut heard = [Heard::default(); 2];
        for time_ms in [0, 10, 20, 70, 80] {
            heard[0].include(time_ms * 1_000_000);
            heard[1].include((2 * time_ms + 5) * 1_000_000);
        }
        assert_eq!(heard.map(|one| one.longest_gap_ns), [50_000_000, 100_000_000]);
        assert_eq!(heard.map(|one| one.count), [5, 5]);
        // Four in 80 ms, and in 160 ms.
        assert!((heard[0].per_s() - 50.0).abs() < 1e-9 && (heard[1].per_s() - 25.0).abs() < 1e-9);
    }
}
