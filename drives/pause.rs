//! Pauses on a wire, which are shorter than a runtime's timers can tell.

use std::time::Duration;

use tokio::time::{Instant, sleep_until};

/// The runtime's timers are late by up to a millisecond and a bit: pauses of 2 ms would take half as long again.
pub const TIMER: Duration = Duration::from_micros(1200);

/// A pause that has begun.
#[derive(Clone, Copy, Debug)]
pub struct Pause {
    end: Instant,
    /// Whether a pause below the resolution of a timer is slept away, with everything else on this thread.
    exact: bool,
}

impl Pause {
    /// From now on. `exact` is for those who have their thread to themselves.
    pub fn begin(duration: Duration, exact: bool) -> Self {
        Self { end: Instant::now() + duration, exact }
    }

    /// Waits until it is over.
    pub async fn over(self) {
        if !self.exact {
            return sleep_until(self.end).await;
        }
        if let Some(coarse) = self.end.checked_sub(TIMER).filter(|coarse| *coarse > Instant::now())
        {
            sleep_until(coarse).await;
        }
        std::thread::sleep(self.end.saturating_duration_since(Instant::now()));
    }
}
