//! Lines that lose most time, found in bounded memory.

use super::LineLoss;
use std::collections::HashMap;

/// Number of lines that are compared at once. A line that is left out has lost less than all of them, up to then.
const WATCHED: usize = 4096;

/// Adds up what lines lose.
#[derive(Clone, Debug, Default)]
pub(super) struct Losses {
    lines: HashMap<u32, LineLoss>,
}

impl Losses {
    pub(super) fn include(&mut self, piece: LineLoss) {
        let full = self.lines.len() >= 2 * WATCHED;
        if full && !self.lines.contains_key(&piece.place.line) {
            let mut kept = sorted(std::mem::take(&mut self.lines));
            kept.truncate(WATCHED);
            self.lines = kept.into_iter().map(|line| (line.place.line, line)).collect();
        }
        self.lines.entry(piece.place.line).and_modify(|line| line.include(&piece)).or_insert(piece);
    }

    /// The worst `count`, the worst first.
    pub(super) fn worst(&self, count: usize) -> Vec<LineLoss> {
        let mut worst = sorted(self.lines.clone());
        worst.retain(|line| line.lost_s > 0.0);
        worst.truncate(count);
        worst
    }
}

fn sorted(lines: HashMap<u32, LineLoss>) -> Vec<LineLoss> {
    let mut sorted: Vec<_> = lines.into_values().collect();
    sorted.sort_by(|one, other| {
        other.lost_s.total_cmp(&one.lost_s).then(one.place.cmp(&other.place))
    });
    sorted
}
