//! Monotonic session clock: the only place that reads the time.

use std::time::{Duration, Instant, SystemTime};

/// The session's clock: nanoseconds since an instant that it can be set to, monotonic.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    zero: Instant,
}

impl Clock {
    /// A clock that reads 0 now.
    pub fn start() -> Self {
        Self::in_future(Duration::ZERO)
    }

    /// A clock that will read 0 after `delay`, and negative times until then.
    #[expect(clippy::disallowed_methods, reason = "this is the session's clock")]
    pub fn in_future(delay: Duration) -> Self {
        Self { zero: Instant::now() + delay }
    }

    /// Nanoseconds since zero.
    #[expect(clippy::disallowed_methods, reason = "this is the session's clock")]
    pub fn now_ns(&self) -> i64 {
        let now = Instant::now();
        match now.checked_duration_since(self.zero) {
            Some(since) => nanoseconds(since),
            None => -nanoseconds(self.zero - now),
        }
    }

    /// How far the calendar's clock is ahead of this one, ns: that changes when the computer has slept, during which this
    /// clock stands still, or when the calendar's clock is set.
    #[expect(clippy::disallowed_methods, reason = "this is the session's clock")]
    pub(crate) fn calendar_ahead_ns(&self) -> i64 {
        let calendar = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        nanoseconds(calendar.unwrap_or_default()).saturating_sub(self.now_ns())
    }

    /// Sleeps until it reads `time_ns`; not at all if it does already.
    pub(crate) fn sleep_until(&self, time_ns: i64) {
        if let Ok(ahead_ns) = u64::try_from(time_ns.saturating_sub(self.now_ns())) {
            std::thread::sleep(Duration::from_nanos(ahead_ns));
        }
    }
}

fn nanoseconds(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)
}
