//! The lines of a picture: quantities over the master.

use super::super::sample::at;
use super::Shown;

/// Points of a curve over the whole width.
const POINTS: f64 = 1800.0;

/// Pieces of a curve of one quantity.
pub(super) fn curve(shown: &Shown<'_>, quantity: usize) -> Vec<Vec<(f64, f64)>> {
    line_of(shown, &|place| {
        let [_, others @ ..] = at(shown.file, shown.using, place);
        others.get(quantity).copied().unwrap_or_default()
    })
}

/// Pieces of a line over the master: each polynomial for itself, for what jumps between them.
pub(super) fn line_of(shown: &Shown<'_>, value: &dyn Fn(f64) -> f64) -> Vec<Vec<(f64, f64)>> {
    let joints: Vec<_> = shown.file.cam.curve().joints().collect();
    let width = shown.file.cam.curve().end() - shown.file.cam.curve().start();
    let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
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
        match (pieces.last_mut(), piece.first()) {
            // What does not jump is one line.
            (Some(before), Some(first))
                if before.last().is_some_and(|last| alike(last.1, first.1)) =>
            {
                before.extend(piece);
            }
            _ => pieces.push(piece),
        }
    }
    pieces
}

fn alike(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-6 * one.abs().max(other.abs())
}
