//! Work budget of replanning, in solver iterations.

use super::NOT_SOLVED;
use crate::time_optimal::convex::NotSolved;

/// A solve that is left with fewer would come to nothing.
const FEWEST_ITERATIONS: u32 = 5;
/// What it takes to sample a cell and to look at one, as iterations of the solver over it.
const SAMPLING: u64 = 3;
const LOOKING: u64 = 2;

/// The work that is left, in cells times iterations of the solver: a measure of time that is the same on every computer.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Budget {
    /// Nothing: as much as it takes.
    left: Option<u64>,
    spent: u64,
}

impl Budget {
    /// So much from now on.
    pub(super) fn of(work: u64) -> Self {
        Self { left: Some(work), spent: 0 }
    }

    /// Spent work.
    pub(super) fn spent(&self) -> u64 {
        self.spent
    }

    fn spend(&mut self, work: u64) {
        self.spent = self.spent.saturating_add(work);
        if let Some(left) = &mut self.left {
            *left = left.saturating_sub(work);
        }
    }

    /// Counts a solve: its cells and its iterations.
    pub(super) fn solved(&mut self, cells: usize, iterations: u32) {
        self.spend((cells as u64).saturating_mul(u64::from(iterations)));
    }

    /// Counts sampled cells.
    pub(super) fn sampled(&mut self, cells: usize) {
        self.spend(SAMPLING.saturating_mul(cells as u64));
    }

    /// Counts inspected cells.
    pub(super) fn looked(&mut self, cells: usize) {
        self.spend(LOOKING.saturating_mul(cells as u64));
    }

    /// True if there is nothing left.
    pub(super) fn is_spent(&self) -> bool {
        self.left == Some(0)
    }

    /// Largest number of iterations of a solve over this number of cells; `None`: unlimited.
    ///
    /// # Errors
    /// If that is too few.
    pub(super) fn iterations(&self, cells: usize) -> Result<Option<u32>, NotSolved> {
        let Some(left) = self.left else { return Ok(None) };
        let left = left / (cells as u64).max(1);
        let left = u32::try_from(left).unwrap_or(u32::MAX);
        if left < FEWEST_ITERATIONS { Err(NOT_SOLVED) } else { Ok(Some(left)) }
    }
}
