//! Clocks of emulated devices, in real time or faster.

use std::time::Duration;

/// Clock of an emulated device. Any function or closure that returns nanoseconds is a clock.
///
/// Only differences count; the clock never runs backwards.
pub trait Clock: Send + Sync {
    /// The time, ns.
    fn now_ns(&self) -> i64;

    /// Time to wait in the world outside until this much time of the clock has passed, ns; zero
    /// where that is past.
    fn wait(&self, ns: i64) -> Duration {
        Duration::from_nanos(u64::try_from(ns).unwrap_or(0))
    }
}

/// Clock of exchanges whose time is not used.
pub fn no_clock() -> i64 {
    0
}

impl<F: Fn() -> i64 + Send + Sync> Clock for F {
    fn now_ns(&self) -> i64 {
        self()
    }
}

impl Clock for &dyn Clock {
    fn now_ns(&self) -> i64 {
        (**self).now_ns()
    }

    fn wait(&self, ns: i64) -> Duration {
        (**self).wait(ns)
    }
}

/// Speed of the time of emulated devices against their clock, wires included. 1 is real time.
///
/// The behaviour of a device depends on its own time alone: the same requests at the same instants of it are answered in the
/// same way at any speed. A master's deadlines are its own, in its own time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Speed(u32);

impl Speed {
    /// Real time.
    pub const REAL: Self = Self(1);
    /// Fastest speed; the shortest waits are then below what an operating system can wait.
    pub const MOST: u32 = 1000;

    /// This factor; at least 1 and at most [`Self::MOST`].
    pub fn times(times: u32) -> Self {
        Self(times.clamp(1, Self::MOST))
    }

    /// The factor.
    pub fn get(self) -> u32 {
        self.0
    }
}

impl Default for Speed {
    fn default() -> Self {
        Self::REAL
    }
}

/// A clock that goes faster than another from the instant it was made.
#[derive(Clone, Copy, Debug)]
pub struct Accelerated<C> {
    clock: C,
    start_ns: i64,
    speed: Speed,
}

impl<C: Clock> Accelerated<C> {
    /// Shows what `clock` shows now, and goes so much faster from now on.
    pub fn new(clock: C, speed: Speed) -> Self {
        let start_ns = clock.now_ns();
        Self { clock, start_ns, speed }
    }
}

impl<C: Clock> Clock for Accelerated<C> {
    fn now_ns(&self) -> i64 {
        let passed = self.clock.now_ns().saturating_sub(self.start_ns);
        self.start_ns.saturating_add(passed.saturating_mul(self.speed.0.into()))
    }

    fn wait(&self, ns: i64) -> Duration {
        // Rounded up: never before it is time.
        let times = i64::from(self.speed.0);
        self.clock.wait(ns.max(0).saturating_add(times - 1) / times)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{
        Arc,
        atomic::{AtomicI64, Ordering},
    };

    use super::*;

    #[test]
    fn accelerated_clocks_start_with_theirs_and_go_faster() {
        let time = Arc::new(AtomicI64::new(1000));
        let shared = Arc::clone(&time);
        let clock = Accelerated::new(move || shared.load(Ordering::SeqCst), Speed::times(20));
        assert_eq!(clock.now_ns(), 1000);
        time.store(1003, Ordering::SeqCst);
        assert_eq!(clock.now_ns(), 1060);
        // 41 ns of it have passed when 3 have passed outside, and not after 2.
        assert_eq!(clock.wait(41), Duration::from_nanos(3));
        assert_eq!(clock.wait(40), Duration::from_nanos(2));
        assert_eq!(clock.wait(-1), Duration::ZERO);
        // One on the other: 20 · 3.
        let both = Accelerated::new(&clock as &dyn Clock, Speed::times(3));
        assert_eq!(both.wait(60), Duration::from_nanos(1));
    }

    #[test]
    fn speeds_are_whole_and_possible() {
        assert_eq!([0, 1, 20, 5000].map(|times| Speed::times(times).get()), [1, 1, 20, 1000]);
        assert_eq!(Speed::default(), Speed::REAL);
    }
}
