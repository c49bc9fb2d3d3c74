//! Feed limits of a machine by line.

use super::{LineLimit, RefeedError};
use std::collections::BTreeMap;
use std::io;
use std::iter::Fuse;

/// Largest delay of a limit behind those of later lines, in lines: path preparation lets M functions and the pieces it
/// puts in at corners change places with their neighbours.
pub(super) const LATE: u32 = 256;

/// Differences between a feed and its limit that are rounding and no reason to change a line.
const ROUNDING: f64 = 1e-9;

/// The limits of a line, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limit {
    pub(crate) feed: f64,
    pub(crate) rapid: f64,
}

impl Default for Limit {
    fn default() -> Self {
        Self { feed: f64::INFINITY, rapid: f64::INFINITY }
    }
}

impl Limit {
    /// For a dialect whose F governs rapids, too.
    pub(crate) fn of_both(self) -> f64 {
        self.feed.min(self.rapid)
    }

    pub(crate) fn include(&mut self, limit: &LineLimit) {
        let feed = if limit.feed > 0.0 { limit.feed } else { 0.0 };
        let slot = if limit.rapid { &mut self.rapid } else { &mut self.feed };
        *slot = slot.min(feed);
    }
}

/// Limits in the order of lines, more or less.
#[derive(Debug)]
pub(crate) struct Limits<I: Iterator> {
    source: Fuse<I>,
    waiting: BTreeMap<u32, Limit>,
    newest: u32,
    ended: bool,
}

impl<I: Iterator<Item = io::Result<LineLimit>>> Limits<I> {
    pub(crate) fn new(source: I) -> Self {
        Self { source: source.fuse(), waiting: BTreeMap::new(), newest: 0, ended: false }
    }

    /// The limit of `line`, which is the next one.
    pub(crate) fn of(&mut self, line: u32) -> Result<Limit, RefeedError> {
        while !self.ended && self.newest <= line.saturating_add(LATE) {
            match self.source.next() {
                None => self.ended = true,
                Some(limit) => {
                    let limit = limit.map_err(RefeedError::Limits)?;
                    if limit.line < line {
                        return Err(RefeedError::Late(limit.line));
                    }
                    self.newest = self.newest.max(limit.line);
                    self.waiting.entry(limit.line).or_default().include(&limit);
                }
            }
        }
        Ok(self.waiting.remove(&line).unwrap_or_default())
    }

    /// All of them, for a program that does not go from line to line.
    pub(crate) fn into_table(self) -> Result<BTreeMap<u32, Limit>, RefeedError> {
        let mut table = self.waiting;
        for limit in self.source {
            let limit = limit.map_err(RefeedError::Limits)?;
            table.entry(limit.line).or_default().include(&limit);
        }
        Ok(table)
    }
}

/// True if a limit is below the programmed feed by more than rounding.
pub(crate) fn is_below(limit: f64, programmed: f64) -> bool {
    limit < programmed * (1.0 - ROUNDING)
}
