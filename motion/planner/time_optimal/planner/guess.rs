//! Initial guess of a window with limited jerk.

use super::Planner;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::bound::{Cap, CapSource};
use crate::time_optimal::grid::End;
use crate::time_optimal::sample::grid;
use crate::time_optimal::smooth::{Beginning, Guess};
use twin_path::prepare::CheckedElement;

/// So much more room for acceleration, jerk and velocity: limits are looked at again between the nodes.
pub(super) const ROOM: [f64; 3] = [1e-4, 0.01, 1e-6];
/// Parts of the u̇² of the first guess that further guesses have.
pub(super) const SLOWER: [f64; 4] = [0.2, 0.02, 0.6, 2e-3];
/// Or, where the path does not begin at rest, times this of that at which jerks let it be gone through at constant velocity.
const SHARP: f64 = 7.5;

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Initial guess of a window with limited jerk.
    pub(super) fn first_guess(&self) -> Guess {
        let mut guess = self.estimate(&grid(&self.sampler, &self.cells)).0;
        for (guess, kept) in guess.iter_mut().zip(&self.kept) {
            *guess = *kept;
        }
        Guess::rough(guess)
    }

    /// Tightness of the limits of the earlier plan.
    pub(super) fn asked_of_kept(&self) -> Vec<([f64; 3], bool)> {
        let fresh = self.kept.len().saturating_sub(1);
        self.cells.iter().take(fresh).map(|cell| (cell.tight, cell.dense)).collect()
    }

    /// Limits it as tightly as it was.
    pub(super) fn ask_of_kept(&mut self, asked: &[([f64; 3], bool)]) {
        for (cell, asked) in self.cells.iter_mut().zip(asked) {
            (cell.tight, cell.dense) = *asked;
        }
    }

    /// Leaves the first `cells`, which were planned before, a little more room: from where and as fast as the path is there may be
    /// no other plan.
    pub(super) fn loosen(&mut self, cells: usize, room: [f64; 3]) {
        for cell in self.cells.iter_mut().take(cells) {
            for (tight, room) in cell.tight.iter_mut().zip(room) {
                *tight /= 1.0 + room;
            }
        }
    }

    /// A slower one. What is known of its beginning stays.
    pub(super) fn slower_guess(&self, part: f64) -> Guess {
        let mut grid = grid(&self.sampler, &self.cells);
        if self.beginning != Beginning::Rest {
            // Where the path bends so sharply that jerks limit even a constant velocity.
            for node in self.kept.len()..grid.cells() {
                let ends = [(node, End::Start), (node.saturating_sub(1), End::Finish)];
                let rows = ends.into_iter().flat_map(|(cell, end)| grid.jerks(cell, end));
                let sharpest = rows.fold(0.0, |most: f64, row| most.max(row.third.abs()));
                let v2 = SHARP * part * sharpest.powf(-2.0 / 3.0);
                grid.cap_at(node, Cap { v2, source: CapSource::Unconstrained });
            }
        }
        let mut guess = self.estimate(&grid).0;
        if self.beginning == Beginning::Rest {
            for b in &mut guess {
                *b *= part;
            }
        }
        for (guess, kept) in guess.iter_mut().zip(&self.kept) {
            *guess = *kept;
        }
        Guess::rough(guess)
    }
}
