//! Exchanges with a device: measured turnaround, answer deadline and lost answers.
//!
//! An exchange takes the time of its bytes on the wire and the turnaround of the device, in which adapter and operating system
//! are included. The first answers, which come at start-up, give the turnaround: a smoothed mean and its deviation, as TCP
//! computes its retransmission time-out (RFC 6298). An answer that is spoilt or does not come by the deadline is lost. What a
//! repeat does not harm is then asked again at once.

use std::time::Duration;

use tokio::time::Instant;

/// Losses in a row after which an exchange is given up.
pub const ATTEMPTS: u32 = 10;
/// The same of a device that has not answered yet, or where answers take very long.
const LEAST_ATTEMPTS: u32 = 3;
/// The same where the request before was given up: others wait for this one.
const LAST_ATTEMPTS: u32 = 2;
/// An exchange is not repeated for longer than this: axes wait to be stopped.
pub const LONGEST_REPEATING: Duration = Duration::from_secs(1);
/// Answers from which on the turnaround counts as measured.
const MEASURED: u32 = 4;
/// Weights of a new turnaround in mean and deviation, and multiple of the deviation in the longest one.
const MEAN_GAIN: f64 = 0.125;
const DEVIATION_GAIN: f64 = 0.25;
const DEVIATIONS: f64 = 4.0;

/// Answers that did not come, or came spoilt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// All of them.
    pub total: u32,
    /// Those since the last request that was answered.
    pub in_row: u32,
}

/// Repeats of one request.
#[derive(Clone, Copy, Debug)]
pub struct Repeats {
    losses_before: u32,
    since: Instant,
}

impl Repeats {
    /// Whether a request whose answer was lost this number of times may be sent once more.
    pub fn allow(&self, lost: u32) -> bool {
        let patient = self.since.elapsed() < LONGEST_REPEATING;
        lost < if patient { ATTEMPTS } else { LEAST_ATTEMPTS }
    }
}

/// Statistics of the exchanges with a device.
#[derive(Clone, Copy, Debug)]
pub struct Exchanges {
    expected: Duration,
    answers: u32,
    /// Of the turnaround, s.
    mean: f64,
    deviation: f64,
    shortest: f64,
    losses: Losses,
}

impl Exchanges {
    /// With a device whose turnaround is at most `expected` until it is measured.
    pub fn new(expected: Duration) -> Self {
        Self {
            expected,
            answers: 0,
            mean: 0.0,
            deviation: 0.0,
            shortest: f64::INFINITY,
            losses: Losses::default(),
        }
    }

    /// Longest turnaround, as far as it is known.
    pub fn turnaround(&self) -> Duration {
        if self.answers < MEASURED {
            return self.expected;
        }
        Duration::try_from_secs_f64(self.mean + DEVIATIONS * self.deviation).unwrap_or_default()
    }

    /// Shortest turnaround, once it is measured: that of device and adapter alone, on a computer that is not busy.
    pub fn shortest_turnaround(&self) -> Option<Duration> {
        let measured = self.answers >= MEASURED;
        measured.then(|| Duration::try_from_secs_f64(self.shortest).unwrap_or_default())
    }

    /// Deadline of an answer: `wire` for the bytes of request and answer, the turnaround, and what the user adds.
    pub fn deadline(&self, wire: Duration, added: Duration) -> Duration {
        wire.saturating_add(self.turnaround()).saturating_add(added)
    }

    /// An answer has come `took` after its request was sent, bytes included, which take `wire`.
    pub fn answered(&mut self, took: Duration, wire: Duration) {
        // A line faster than its baud rate (a pseudo-terminal) takes less than its bytes.
        let turnaround = took.saturating_sub(wire).as_secs_f64();
        self.shortest = self.shortest.min(turnaround);
        if self.answers == 0 {
            (self.mean, self.deviation) = (turnaround, 0.5 * turnaround);
        } else {
            self.deviation += DEVIATION_GAIN * ((turnaround - self.mean).abs() - self.deviation);
            self.mean += MEAN_GAIN * (turnaround - self.mean);
        }
        self.answers = self.answers.saturating_add(1);
    }

    /// An answer is lost.
    pub fn lost(&mut self) {
        self.losses.total = self.losses.total.saturating_add(1);
        self.losses.in_row = self.losses.in_row.saturating_add(1);
    }

    /// A request has been answered in the end.
    pub fn done(&mut self) {
        self.losses.in_row = 0;
    }

    /// Lost answers so far.
    pub fn losses(&self) -> Losses {
        self.losses
    }

    /// Begins a request that may be repeated.
    pub fn begin(&self) -> Repeats {
        Repeats { losses_before: self.losses.in_row, since: Instant::now() }
    }

    /// Whether the request may be sent once more.
    pub fn may_repeat(&self, repeats: &Repeats) -> bool {
        let lost = self.losses.in_row.saturating_sub(repeats.losses_before);
        if repeats.losses_before >= LEAST_ATTEMPTS {
            lost < LAST_ATTEMPTS
        } else if self.answers < MEASURED {
            lost < LEAST_ATTEMPTS
        } else {
            repeats.allow(lost)
        }
    }
}

/// Longest time that a request is repeated where each attempt takes `attempt`.
pub fn longest_repeating(attempt: Duration) -> Duration {
    (ATTEMPTS * attempt).min((LONGEST_REPEATING + attempt).max(LEAST_ATTEMPTS * attempt))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    #[test]
    fn a_deadline_is_the_time_of_the_bytes_the_turnaround_and_what_is_added() {
        let mut exchanges = Exchanges::new(50 * MS);
        // 255 bytes of 10 bits at 9600 baud: 265.6 ms.
        let wire = Duration::from_micros(265_625);
        assert_eq!(exchanges.deadline(wire, 20 * MS), wire + 70 * MS);
        for answer in 0..4 {
            assert_eq!(exchanges.turnaround(), 50 * MS, "{answer}");
            exchanges.answered(12 * MS, 4 * MS);
        }
        // A steady 8 ms; RFC 6298: the deviation begins with 4 ms and loses a quarter with each of the three others.
        let longest = 8.0 + 4.0 * 4.0 * 0.75_f64.powi(3);
        assert!((1e3 * exchanges.turnaround().as_secs_f64() - longest).abs() < 1e-5);
        for _ in 0..100 {
            exchanges.answered(12 * MS, 4 * MS);
        }
        assert!((1e3 * exchanges.turnaround().as_secs_f64() - 8.0).abs() < 1e-3);
        // A computer that was busy for a while says nothing of the wire.
        (0..4).for_each(|_| exchanges.answered(200 * MS, 4 * MS));
        assert!(exchanges.turnaround() > 100 * MS);
        assert_eq!(exchanges.shortest_turnaround(), Some(8 * MS));
        // A pseudo-terminal passes bytes faster than a wire.
        exchanges.answered(MS, 4 * MS);
        assert_eq!(exchanges.shortest_turnaround(), Some(Duration::ZERO));
    }

    #[tokio::test(start_paused = true)]
    async fn ten_losses_in_a_row_are_the_end_and_three_where_nobody_has_answered() {
        let attempts = |exchanges: &mut Exchanges| {
            let repeats = exchanges.begin();
            exchanges.lost();
            while exchanges.may_repeat(&repeats) {
                exchanges.lost();
            }
            exchanges.losses().in_row
        };
        let mut exchanges = Exchanges::new(MS);
        assert_eq!(attempts(&mut exchanges), 3);
        exchanges.done();
        (0..4).for_each(|_| exchanges.answered(MS, MS));
        assert_eq!(attempts(&mut exchanges), 10);
        // The next request has two more.
        assert_eq!(attempts(&mut exchanges), 12);
        exchanges.done();
        assert_eq!(exchanges.losses(), Losses { total: 15, in_row: 0 });
        // Three that take as long as all may are the end.
        let repeats = exchanges.begin();
        for more in [true, true, false] {
            tokio::time::sleep(LONGEST_REPEATING).await;
            exchanges.lost();
            assert_eq!(exchanges.may_repeat(&repeats), more);
        }
        assert_eq!(longest_repeating(30 * MS), 300 * MS);
        assert_eq!(longest_repeating(400 * MS), 1400 * MS);
        assert_eq!(longest_repeating(2000 * MS), 6000 * MS);
    }
}
