//! Presolve: proves values of the fastest profile before Clarabel runs.
//!
//! The cost falls strictly in every bₖ (see [`super`]), so that in an optimum every bₖ is held by a cap, or by an
//! active row with a positive coefficient for it. Let U be upper bounds on b. In the plane of the b at both ends of a
//! cell, x and y as parts of theirs, rows are of three kinds.
//!
//! - Rows that hold where x and y are both 1 and whose coefficients are both positive hold everywhere: they are redundant.
//! - Rows with coefficients of both signs, p·x ≤ 1 + |r|·y: more y is never bad for x. They hold where both are 1.
//! - Rows p·x + r·y ≤ 1 that do not hold where both are 1: there x can be traded for y. Such rows are near points where
//!   an axis has no inertia. For every y, such a row leaves (1 − r)/p to x.
//!
//! So where b is optimal and b ≥ L, b ≥ Φ(L), with Φₖ(L) the least of the cap, (1 + |r|·Lⱼ)/p over the rows of the second kind
//! and (1 − r)/p over those of the third. Φ is monotone and, as the least of affine functions, concave, and Φ(0) > 0 (where
//! (1 − r)/p ≤ 0, L = 0 says nothing and is a constant). Such a map has one fixed point, to which Φ(0), Φ(Φ(0)), … rises:
//! it is below every optimum, and above every L ≤ Φ(L). The largest L ≤ Φ(L) is found by two passes with (1 − r)/p as caps.
//! With discs the least of what they leave at y = Lⱼ and at y = 1 takes the place of the affine functions; it is concave as
//! well.
//!
//! Where L = U, b is proved. All else lies between L and U: some cells before and behind points without inertia.

use super::scaled::Scaled;
use crate::time_optimal::grid::Grid;
use crate::time_optimal::reachable;
use crate::time_optimal::reachable::Step;
use std::ops::Range;

/// A row that is exceeded by less than this where both b are the largest they can be counts as kept: rounding.
pub(super) const TIGHT: f64 = 1e-12;
/// What lowers a bound by less than this part of it lowers it by rounding.
const ROUNDING: f64 = 1e-14;
/// Where the two bounds are as near as this, in parts of them, b is proved: a profile that is lower by that takes longer by
/// half of it.
const PROVED: f64 = 1e-9;

/// Between what the b of every fastest profile over some cells are, at their nodes.
#[derive(Debug)]
pub(super) struct Presolved {
    /// No profile has more.
    pub(super) upper: Vec<f64>,
    /// No fastest profile has less.
    pub(super) lower: Vec<f64>,
}

impl Presolved {
    pub(super) fn new(grid: &Grid, cells: Range<usize>, start: f64, end: f64) -> Self {
        let upper = reachable::bounds(grid, cells.clone(), start, end);
        let mut lower = upper.clone();
        let mut traded = false;
        for (index, cell) in cells.clone().enumerate() {
            let Some([here, next]) = upper.get(index..index + 2) else { break };
            let Some(caps) = Scaled::new(grid, cell, [*here, *next]).traded() else { continue };
            traded = true;
            for ((lower, upper), cap) in lower.iter_mut().zip(&upper).skip(index).zip(caps) {
                *lower = lower.min(upper * cap);
            }
        }
        // Those at the ends are given.
        let ends = [0, cells.len()];
        for node in ends {
            if let (Some(lower), Some(upper)) = (lower.get_mut(node), upper.get(node)) {
                *lower = *upper;
            }
        }
        let mut presolved = Self { upper, lower };
        if traded {
            presolved.lower_chains(grid, cells);
        }
        presolved
    }

    /// Nothing proved: all of it is left to Clarabel.
    #[cfg(test)]
    pub(super) fn nothing(grid: &Grid, cells: Range<usize>, start: f64, end: f64) -> Self {
        let upper = reachable::bounds(grid, cells.clone(), start, end);
        let mut lower = vec![0.0; upper.len()];
        for node in [0, cells.len()] {
            lower[node] = upper[node];
        }
        Self { upper, lower }
    }

    /// Lowers the lower bounds to what can be met and reached: braking before a node that was lowered, speeding up behind it.
    fn lower_chains(&mut self, grid: &Grid, cells: Range<usize>) {
        let mut step = Step::new(grid);
        let inner = cells.len().saturating_sub(1);
        let Self { upper, lower } = self;
        let (mut next, mut lowered) = (0.0, false);
        let nodes = lower.iter_mut().zip(upper.iter()).skip(1).take(inner);
        for (cell, (slot, upper)) in cells.clone().skip(1).zip(nodes).rev() {
            if lowered {
                let least = step.before::<0>(cell, *slot, next);
                if least < *slot * (1.0 - ROUNDING) {
                    *slot = least;
                }
            }
            (next, lowered) = (*slot, *slot < *upper);
        }
        let (mut here, mut lowered) = (0.0, false);
        let nodes = lower.iter_mut().zip(upper.iter()).skip(1).take(inner);
        for (cell, (slot, upper)) in cells.zip(nodes) {
            if lowered {
                let least = step.behind::<0>(cell, *slot, here);
                if least < *slot * (1.0 - ROUNDING) {
                    *slot = least;
                }
            }
            (here, lowered) = (*slot, *slot < *upper);
        }
    }

    /// True if b at this node is not proved.
    pub(super) fn open(&self, node: usize) -> bool {
        match (self.lower.get(node), self.upper.get(node)) {
            (Some(lower), Some(upper)) => *lower < upper * (1.0 - PROVED),
            _ => false,
        }
    }

    /// The scale of b at every node: what is proved of it, or the upper bound.
    pub(super) fn scale(&self) -> Vec<f64> {
        let nodes = self.lower.iter().zip(&self.upper).enumerate();
        nodes.map(|(node, (lower, upper))| if self.open(node) { *upper } else { *lower }).collect()
    }
}
