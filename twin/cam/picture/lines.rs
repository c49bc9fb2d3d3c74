//! The lines of a picture: quantities over the master.

use super::super::sample::at;
use super::Shown;
use crate::chart::COLUMNS;

/// Points of a curve over the whole width.
#[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
const POINTS: f64 = COLUMNS as f64;

/// Pieces of a curve of one quantity.
pub(super) fn curve(shown: &Shown<'_>, quantity: usize) -> Vec<Vec<(f64, f64)>> {
    line_of(shown, &|place| {
        let [_, others @ ..] = at(shown.file, shown.using, place);
        others.get(quantity).copied().unwrap_or_default()
    })
}

/// Pieces of a line over the master: each polynomial for itself, for what jumps between them. Jumps between polynomials that are
/// no wider than a column of the picture are steep lines there, and of many points in one column only the outermost are kept.
pub(super) fn line_of(shown: &Shown<'_>, value: &dyn Fn(f64) -> f64) -> Vec<Vec<(f64, f64)>> {
    let joints: Vec<_> = shown.file.cam.curve().joints().collect();
    let width = shown.file.cam.curve().end() - shown.file.cam.curve().start();
    let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut narrow = [false; 2];
    for pair in joints.windows(2) {
        let [from, to] = pair else { continue };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of points"
        )]
        let count = ((to - from) / width * POINTS).ceil().max(1.0) as usize;
        let mut piece: Vec<(f64, f64)> = Vec::with_capacity(count + 1);
        for index in 0..=count {
            #[expect(clippy::cast_precision_loss, reason = "a share of points")]
            let inside = from + (to - from) * index as f64 / count as f64;
            // Its own end, not the begin of the next.
            let place = if index == count { to.next_down() } else { inside };
            piece.push((shown.using.master_at(place), value(place)));
        }
        narrow = [narrow[1], (to - from) * POINTS < width];
        match (pieces.last_mut(), piece.first()) {
            // What does not jump is one line.
            (Some(before), Some(first))
                if narrow == [true; 2]
                    || before.last().is_some_and(|last| alike(last.1, first.1)) =>
            {
                before.extend(piece);
            }
            _ => pieces.push(piece),
        }
    }
    let ends = [shown.file.cam.curve().start(), shown.file.cam.curve().end()];
    let ends = ends.map(|place| shown.using.master_at(place));
    pieces.into_iter().map(|piece| thinned(&piece, ends)).collect()
}

/// What a picture can show of a line between two masters: of more points that follow each other in a column of it the first, the
/// least, the greatest and the last, which draw the same.
pub(super) fn thinned(line: &[(f64, f64)], [from, to]: [f64; 2]) -> Vec<(f64, f64)> {
    let column = |point: &(f64, f64)| ((point.0 - from) / (to - from) * POINTS).floor();
    let mut kept = Vec::with_capacity(line.len().min(4 * COLUMNS));
    for run in line.chunk_by(|one, other| column(one).to_bits() == column(other).to_bits()) {
        if run.len() <= 4 {
            kept.extend(run);
            continue;
        }
        let values = || (0..).zip(run.iter().map(|(_, value)| *value));
        let by = |one: &(usize, f64), other: &(usize, f64)| one.1.total_cmp(&other.1);
        let [least, greatest] = [values().min_by(by), values().max_by(by)]
            .map(|found| found.map_or(0, |(index, _)| index));
        let mut chosen = vec![0, least, greatest, run.len() - 1];
        chosen.sort_unstable();
        chosen.dedup();
        kept.extend(chosen.into_iter().filter_map(|index| run.get(index)));
    }
    kept
}

fn alike(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-6 * one.abs().max(other.abs())
}
