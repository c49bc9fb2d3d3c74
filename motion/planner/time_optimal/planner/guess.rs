//! Initial guess of a window with limited jerk.

use super::Planner;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::sample::grid;
use crate::time_optimal::smooth::Guess;
use twin_path::prepare::CheckedElement;

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
}
