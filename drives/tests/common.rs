//! Clocks in real time, and the fault in an outcome, for the tests of all families.

use std::time::Instant;

use twin_drives::{DeviceFault, DriveError, IncrementMotion, SetpointStream};

/// The fault of a family that an outcome has ended with.
pub(crate) fn fault_of<F: DeviceFault, T>(outcome: &Result<T, DriveError>) -> Option<&F> {
    outcome.as_ref().err()?.fault()
}

pub(crate) fn wall_clock() -> impl Fn() -> i64 + Send + Sync + Copy {
    let clock = WallClock::new();
    move || clock.now()
}

/// The clock of these tests: they run in real time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallClock(Instant);

impl WallClock {
    #[expect(
        clippy::disallowed_methods,
        reason = "these tests run in real time and are their own session"
    )]
    pub(crate) fn new() -> Self {
        Self(Instant::now())
    }

    pub(crate) fn now(self) -> i64 {
        i64::try_from(self.0.elapsed().as_nanos()).unwrap()
    }
}

/// A stream for its clock: nothing moves by it.
impl SetpointStream for WallClock {
    fn now_ns(&self) -> i64 {
        self.now()
    }

    fn at(&self, _time_ns: i64) -> IncrementMotion {
        IncrementMotion::default()
    }

    fn horizon_ns(&self) -> i64 {
        0
    }
}

/// A plan in closed form, in seconds, that begins at `start_ns` of its clock.
pub(crate) struct Plan<C, F> {
    pub(crate) clock: C,
    pub(crate) start_ns: i64,
    pub(crate) of: F,
}

impl<C, F> SetpointStream for Plan<C, F>
where
    C: Fn() -> i64 + Sync,
    F: Fn(f64) -> IncrementMotion + Sync,
{
    fn now_ns(&self) -> i64 {
        (self.clock)() - self.start_ns
    }

    #[expect(clippy::cast_precision_loss, reason = "seconds")]
    fn at(&self, time_ns: i64) -> IncrementMotion {
        (self.of)(time_ns as f64 * 1e-9)
    }

    fn horizon_ns(&self) -> i64 {
        250_000_000
    }
}
