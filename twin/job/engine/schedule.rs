//! Start times of blocks, without a scan of all blocks in every cycle.
//!
//! A block with a known start time is kept with that time. Any other block is added when the event that it waits for
//! has happened.

use super::super::{Begins, Call};
use super::nanoseconds;
use std::collections::BTreeSet;

/// Blocks that are to begin, by their numbers.
#[derive(Debug)]
pub(super) struct Schedule {
    begins: Vec<Begins>,
    /// Those whose time is known, ns, and that have not begun.
    due: BTreeSet<(i64, usize)>,
}

impl Schedule {
    /// Schedule of `calls` in the order of the file, those of the machine file first.
    pub(super) fn new(calls: &[Call]) -> Self {
        let begins: Vec<_> = calls.iter().map(|call| call.begins).collect();
        let of_file = begins.iter().position(|begins| *begins != Begins::Standing);
        let time = |(index, begins): (usize, &Begins)| match begins {
            Begins::At(time) => Some((nanoseconds(*time), index)),
            Begins::Standing => Some((0, index)),
            // The first one waits for nothing but the beginning.
            Begins::Next | Begins::WithPrevious if Some(index) == of_file => Some((0, index)),
            Begins::After(pause) if Some(index) == of_file => Some((nanoseconds(*pause), index)),
            _ => None,
        };
        let due = begins.iter().enumerate().filter_map(time).collect();
        Self { begins, due }
    }

    /// The next block that is due at `now_ns`.
    pub(super) fn next(&mut self, now_ns: i64) -> Option<usize> {
        let (time_ns, index) = self.due.first().copied().filter(|(due, _)| *due <= now_ns)?;
        self.due.remove(&(time_ns, index));
        Some(index)
    }

    /// True if no block is due at a known later time.
    pub(super) fn is_empty(&self) -> bool {
        self.due.is_empty()
    }

    /// A block has begun: the one behind it may begin with it.
    pub(super) fn begun(&mut self, index: usize, now_ns: i64) {
        if let Some(Begins::WithPrevious) = self.behind(index) {
            self.due.insert((now_ns, index + 1));
        }
    }

    /// A block is over.
    pub(super) fn over(&mut self, index: usize, now_ns: i64) {
        let pause = match self.behind(index) {
            Some(Begins::Next) => 0.0,
            Some(Begins::After(pause)) => pause,
            _ => return,
        };
        self.due.insert((now_ns.saturating_add(nanoseconds(pause)), index + 1));
    }

    /// How the block behind one of the file begins; couplings of the machine file have none behind them.
    fn behind(&self, index: usize) -> Option<Begins> {
        self.begins.get(index).filter(|begins| **begins != Begins::Standing)?;
        self.begins.get(index + 1).copied()
    }

    /// True if a block of the file begins only when this one is over, or behind one that does.
    pub(super) fn waits_for(&self, index: usize, later: usize) -> bool {
        let between = self.begins.get(index + 1..=later).unwrap_or_default();
        let follows = |begins: &Begins| {
            matches!(begins, Begins::Next | Begins::After(_) | Begins::WithPrevious)
        };
        matches!(between.first(), Some(Begins::Next | Begins::After(_)))
            && between.iter().all(follows)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::block::alone;
    use super::super::super::{Begins, Call};
    use super::Schedule;
    use twin_axis::Halt;

    fn schedule(begins: &[Begins]) -> Schedule {
        let call = |begins: &Begins| Call {
            name: "MC_Halt",
            line: 1,
            axis: 0,
            master: None,
            block: alone(Halt { deceleration: 1.0 }),
            begins: *begins,
        };
        Schedule::new(&begins.iter().map(call).collect::<Vec<_>>())
    }

    fn due(schedule: &mut Schedule, now_ns: i64) -> Vec<usize> {
        std::iter::from_fn(|| schedule.next(now_ns)).collect()
    }

    #[test]
    fn blocks_come_when_what_they_wait_for_has_happened() {
        use Begins::{After, At, EndOfProfile, Next, Standing, WithPrevious};
        let begins =
            [Standing, Next, WithPrevious, After(2e-9), At(5e-9), Next, EndOfProfile, Next];
        let mut plan = schedule(&begins);
        assert_eq!(due(&mut plan, 0), [0, 1]);
        // What stands has nothing behind it, over or not.
        plan.over(0, 1);
        plan.begun(0, 1);
        assert!(due(&mut plan, 4).is_empty());
        plan.begun(1, 4);
        assert_eq!(due(&mut plan, 4), [2]);
        plan.over(1, 4);
        assert!(due(&mut plan, 4).is_empty(), "3 waits for 2");
        plan.over(2, 4);
        assert_eq!(due(&mut plan, 5), [4]);
        assert_eq!(due(&mut plan, 6), [3]);
        plan.over(4, 7);
        assert_eq!((due(&mut plan, 7), plan.is_empty()), (vec![5], true));
        // Of 6 the cam says when.
        plan.over(5, 8);
        assert!(plan.is_empty());
        plan.over(6, 9);
        assert_eq!(due(&mut plan, 9), [7]);
    }

    #[test]
    fn who_waits_for_whom() {
        use Begins::{At, EndOfProfile, Next, WithPrevious};
        let plan = schedule(&[Next, Next, WithPrevious, Next, At(1.0), Next, WithPrevious, Next]);
        let waits = |index: usize| -> Vec<usize> {
            (index + 1..8).filter(|later| plan.waits_for(index, *later)).collect()
        };
        assert_eq!(waits(0), [1, 2, 3]);
        // 2 begins with it, and 3 waits for that one.
        assert!(waits(1).is_empty());
        assert_eq!(waits(4), [5, 6, 7]);
        let plan = schedule(&[Next, Next, EndOfProfile, Next]);
        assert_eq!([1, 2, 3].map(|later| plan.waits_for(0, later)), [true, false, false]);
    }
}
