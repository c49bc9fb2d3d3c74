//! Points in time with a fraction of a nanosecond.

/// A point in time: whole nanoseconds and a fraction of one.
///
/// The durations of millions of elements add up without loss: what is rounded is a fraction of a nanosecond each
/// time, not the time since the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Instant {
    ns: i64,
    /// Fraction of a nanosecond, 0 to 1.
    fraction: f64,
}

/// Instants closer than this to a whole nanosecond are meant to be on it, ns. Durations carry rounding of about
/// 1e-7 ns; at rest a picosecond moves nothing.
const ROUNDING_NS: f64 = 1e-3;

const NS_PER_S: f64 = 1e9;

impl Instant {
    /// A whole nanosecond.
    pub(crate) fn at_ns(ns: i64) -> Self {
        Self { ns, fraction: 0.0 }
    }

    /// `seconds` (not negative) later. Beyond the range of `i64` nanoseconds, 292 years, the time stays the same.
    #[expect(clippy::cast_possible_truncation, reason = "the cast saturates, and so does the sum")]
    pub(crate) fn after(self, seconds: f64) -> Self {
        let fraction = self.fraction + seconds * NS_PER_S;
        let whole = fraction.floor();
        let fraction = if whole.is_finite() { fraction - whole } else { 0.0 };
        Self { ns: self.ns.saturating_add(whole as i64), fraction }
    }

    /// The whole nanosecond it is meant to be, if it is one but for rounding; else itself.
    pub(crate) fn settled(self) -> Self {
        if self.fraction < ROUNDING_NS {
            Self::at_ns(self.ns)
        } else if self.fraction > 1.0 - ROUNDING_NS {
            Self::at_ns(self.ns.saturating_add(1))
        } else {
            self
        }
    }

    /// True if it is at or before `ns`.
    pub(crate) fn reached_at(self, ns: i64) -> bool {
        self.ns < ns || (self.ns == ns && self.fraction <= 0.0)
    }

    /// The first of the cycles `now_ns`, `now_ns` + `cycle_ns`, … at or after it.
    pub(crate) fn first_cycle(self, now_ns: i64, cycle_ns: i64) -> i64 {
        let end_ns = self.ns.saturating_add(i64::from(self.fraction > 0.0));
        let left_ns = end_ns.saturating_sub(now_ns).max(0);
        // Rounded up.
        let cycles = left_ns / cycle_ns + i64::from(left_ns % cycle_ns > 0);
        now_ns.saturating_add(cycles.saturating_mul(cycle_ns))
    }

    /// Time from here to `ns`, s.
    #[expect(
        clippy::cast_precision_loss,
        reason = "the time within one element: exact below 104 days"
    )]
    pub(crate) fn until(self, ns: i64) -> f64 {
        (ns.saturating_sub(self.ns) as f64 - self.fraction) / NS_PER_S
    }

    /// Time since 0, s.
    #[expect(clippy::cast_precision_loss, reason = "a duration for people and reports")]
    pub(crate) fn seconds(self) -> f64 {
        (self.ns as f64 + self.fraction) / NS_PER_S
    }
}
