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
    /// Blocks with a known time, ns, that have not begun.
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
            // The first one begins at once.
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

    /// Begin of the next block of the file; couplings of the machine file have no next block.
    fn behind(&self, index: usize) -> Option<Begins> {
        self.begins.get(index).filter(|begins| **begins != Begins::Standing)?;
        self.begins.get(index + 1).copied()
    }

    /// True if a later block of the file begins only after this one is over.
    pub(super) fn waits_for(&self, index: usize, later: usize) -> bool {
        let between = self.begins.get(index + 1..=later).unwrap_or_default();
        let follows = |begins: &Begins| {
            matches!(begins, Begins::Next | Begins::After(_) | Begins::WithPrevious)
        };
        matches!(between.first(), Some(Begins::Next | Begins::After(_)))
            && between.iter().all(follows)
    }
}
