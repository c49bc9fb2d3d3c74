//! Time as this crate is told it.

/// Where an emulated device gets the time from. Any function or closure that returns nanoseconds is a clock.
///
/// Only differences count; the clock never runs backwards.
pub trait Clock: Send + Sync {
    /// The time, ns.
    fn now_ns(&self) -> i64;
}

impl<F: Fn() -> i64 + Send + Sync> Clock for F {
    fn now_ns(&self) -> i64 {
        self()
    }
}
