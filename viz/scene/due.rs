//! Interval timer on program time.

/// Something done once per interval of program time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Due {
    interval_ns: i64,
    next_ns: Option<i64>,
}

impl Due {
    /// Due at once, then an interval after each time it was done.
    pub(super) fn every(interval_ns: i64) -> Self {
        Self { interval_ns, next_ns: None }
    }

    /// True if it is due; then it counts as done.
    pub(super) fn take(&mut self, time_ns: i64) -> bool {
        let is_due = self.next_ns.is_none_or(|next| time_ns >= next);
        if is_due {
            self.next_ns = Some(time_ns.saturating_add(self.interval_ns));
        }
        is_due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn due_at_once_and_then_no_sooner_than_the_interval() {
        let mut due = Due::every(20);
        let done: Vec<i64> =
            [5, 6, 24, 25, 44, 60, 61, 80].into_iter().filter(|time| due.take(*time)).collect();
        assert_eq!(done, [5, 25, 60, 80]);
    }

    #[test]
    fn the_end_of_time_is_no_overflow() {
        let mut due = Due::every(20);
        assert!(due.take(i64::MAX - 1));
        assert!(!due.take(i64::MAX - 1));
        assert!(due.take(i64::MAX));
    }
}
