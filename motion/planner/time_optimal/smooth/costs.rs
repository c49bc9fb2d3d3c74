//! Cost functions of the convex program: shortest duration, or minimum speed.

use super::{BESIDE, Guess, SmoothSolver};
use crate::time_optimal::grid::Grid;
use std::ops::Range;

impl SmoothSolver {
    /// The duration.
    pub(super) fn add_costs(
        &mut self,
        grid: &Grid,
        cells: &Range<usize>,
        guess: &Guess,
        free: &Range<usize>,
    ) {
        let nodes = self.knots.iter().zip(&guess.b).zip(cells.clone()).enumerate();
        for (index, ((knot, guessed), cell)) in nodes.skip(free.start).take(free.len() + 1) {
            let Some(before) = index.checked_sub(1) else { continue };
            let weight = 0.5 * (grid.length(cell.saturating_sub(1)) + grid.length(cell));
            // w/√b to second order about the guess.
            let (first, second) = (
                -0.5 * weight / (guessed * guessed.sqrt()),
                0.75 * weight / (guessed * guessed * guessed.sqrt()),
            );
            let at = |values: &[f64], cell: usize| values.get(cell).copied().unwrap_or_default();
            let parts = [(before, knot.b[0]), (index, knot.b[1])];
            let given = parts.iter().filter(|(cell, _)| !free.contains(cell));
            let given: f64 = given.map(|(cell, part)| part * at(&guess.c, *cell)).sum();
            let linear = first + second * (given - guessed);
            for (cell, part) in parts.into_iter().filter(|(cell, _)| free.contains(cell)) {
                let part = part * at(&self.scale, cell);
                self.program.add_cost(cell - free.start, second * part * part, linear * part);
            }
            if let [(before, p), (after, r)] = parts
                && free.contains(&before)
                && free.contains(&after)
            {
                let product = p * at(&self.scale, before) * r * at(&self.scale, after);
                self.program.add_coupling(before - free.start, second * product);
            }
        }
    }

    /// Σ wₖ·bₖ/b̄ₖ as the cost: every b is as small as those before it allow.
    pub(super) fn add_velocities(
        &mut self,
        grid: &Grid,
        cells: &Range<usize>,
        guess: &[f64],
        free: &Range<usize>,
    ) {
        let total: f64 = cells.clone().map(|cell| grid.length(cell)).sum();
        // Behind the last floor the path is only to come to rest, somehow: that is not to be bought with velocity before.
        let behind = self.floors.iter().rposition(|floor| *floor > 0.0);
        let first = guess.first().copied().unwrap_or_default();
        let knots = self.knots.iter().zip(guess).zip(cells.clone()).enumerate().skip(1);
        for (index, ((knot, guess), cell)) in knots {
            let counts = behind.is_none_or(|behind| index <= behind);
            let guess = if counts { *guess } else { first.max(*guess) / BESIDE };
            let weight = 0.5 * (grid.length(cell - 1) + grid.length(cell)) / (total * guess);
            for (part, of) in knot.b.into_iter().zip([index - 1, index]) {
                let scale = self.scale.get(of).copied().unwrap_or_default();
                if free.contains(&of) {
                    self.program.add_cost(of - free.start, 0.0, weight * part * scale);
                }
            }
        }
    }
}
