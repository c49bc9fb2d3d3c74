//! Delay of switched outputs.

use twin_number::seconds;

/// Number of switched outputs of a device, and their delays after the set-points at which they were due.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SwitchedOutputs {
    /// Switchings that the device has confirmed.
    pub count: u32,
    sum_ns: i64,
    /// The latest of them, ns.
    pub latest_ns: i64,
}

impl SwitchedOutputs {
    /// A switching more, confirmed `late_ns` after it was due. What the confirmation takes on the wire is part of that.
    pub(super) fn include(&mut self, late_ns: i64) {
        self.latest_ns = if self.count == 0 { late_ns } else { self.latest_ns.max(late_ns) };
        self.sum_ns = self.sum_ns.saturating_add(late_ns);
        self.count = self.count.saturating_add(1);
    }

    /// Mean delay, ms; 0 if there were none.
    pub fn mean_ms(self) -> f64 {
        seconds(self.sum_ns) * 1e3 / f64::from(self.count.max(1))
    }

    /// The latest of them, ms.
    pub fn latest_ms(self) -> f64 {
        seconds(self.latest_ns) * 1e3
    }
}

#[cfg(test)]
mod tests {
    use super::SwitchedOutputs;

    #[test]
    fn the_latest_and_the_mean_are_kept() {
        let mut switched = SwitchedOutputs::default();
        assert!(switched.mean_ms().abs() < 1e-12);
        for late_ms in [4, 9, 5] {
            switched.include(late_ms * 1_000_000);
        }
        assert_eq!((switched.count, switched.latest_ns), (3, 9_000_000));
        assert!(
            (switched.mean_ms() - 6.0).abs() < 1e-9 && (switched.latest_ms() - 9.0).abs() < 1e-9
        );
    }
}
