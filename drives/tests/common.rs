//! Clocks in real time, and the fault in an outcome, for the tests of all families.

use std::time::Instant;

use twin_drives::{DeviceFault, DriveError, IncrementMotion, SetpointStream};

/// The fault of a family that an outcome has ended with.
pub(crate) fn fault_of<F: DeviceFault, T>(outcome: &Result<T, DriveError>) -> Option<&F> {
    outcome.as_ref().err()?.fault()
}

#[expect(
    clippy::disallowed_methods,
    reason = "these tests run in real time and are their own session"
)]
pub(crate) fn wall_clock() -> impl Fn() -> i64 + Send + Sync + Copy {
    let zero = Instant::now();
    move || i64::try_from(zero.elapsed().as_nanos()).unwrap()
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
