//! Progress lines of long work, for standard error without a progress bar.

use crate::check::Progress;
use crate::clock::Clock;
use std::io::{self, IsTerminal, Write};
use twin_number::seconds;

const MINUTE_NS: i64 = 60_000_000_000;

/// Progress lines of long work on standard error, if that is not a terminal with a progress bar.
#[derive(Debug)]
pub(super) struct ProgressLines {
    what: String,
    clock: Clock,
    /// When the last line was written, and how many of a hundred parts were done then.
    last: (i64, u64),
    silent: bool,
}

impl ProgressLines {
    /// Of work called `what`, which begins now.
    pub(super) fn new(what: String) -> Self {
        let silent = io::stderr().is_terminal();
        Self { what, clock: Clock::start(), last: (0, 0), silent }
    }

    /// Reports progress of a check of a program of `bytes` bytes.
    pub(super) fn checked(&mut self, progress: &Progress, bytes: u64) {
        let Some(done) = progress.bytes else { return self.set_time(progress.time_ns) };
        self.set(done, bytes);
    }

    /// The program is at this time, of a whole that nobody knows.
    fn set_time(&mut self, time_ns: i64) {
        let (now_ns, (last_ns, _)) = (self.clock.now_ns(), self.last);
        if self.silent || now_ns.saturating_sub(last_ns) < MINUTE_NS {
            return;
        }
        self.last.0 = now_ns;
        writeln!(io::stderr(), "{}: at {:.0} s", self.what, seconds(time_ns)).unwrap_or_default();
    }

    /// Reports that `done` of `of` parts are done.
    pub(super) fn set(&mut self, done: u64, of: u64) {
        if self.silent {
            return;
        }
        if let Some(percent) = due(self.clock.now_ns(), self.last, (done, of)) {
            self.last = (self.clock.now_ns(), percent);
            writeln!(io::stderr(), "{}: {percent} %", self.what).unwrap_or_default();
        }
    }
}

/// The percentage, if a line is due: after 10 s and a tenth of the work, and after a minute in any case.
fn due(now_ns: i64, (last_ns, last): (i64, u64), (done, of): (u64, u64)) -> Option<u64> {
    let percent = done.saturating_mul(100).checked_div(of)?.min(100);
    let since = now_ns.saturating_sub(last_ns) / 1_000_000_000;
    let far = percent >= last.saturating_add(10);
    (since >= 60 || since >= 10 && far).then_some(percent)
}

#[cfg(test)]
mod tests {
    use super::due;

    #[test]
    fn lines_of_progress_are_some() {
        const S: i64 = 1_000_000_000;
        assert_eq!(due(9 * S, (0, 0), (50, 100)), None);
        assert_eq!(due(10 * S, (0, 0), (50, 100)), Some(50));
        assert_eq!(due(21 * S, (10 * S, 50), (59, 100)), None);
        assert_eq!(due(70 * S, (10 * S, 50), (51, 100)), Some(51));
        assert_eq!(due(20 * S, (0, 0), (7, 0)), None);
        assert_eq!(due(20 * S, (0, 0), (700, 7)), Some(100));
    }
}
