//! Sensitivities where b is proved.
//!
//! There every bₖ is held by a cap, or by an active row with a positive coefficient for it: braking to the next node,
//! or speeding up from the one before. The value of a higher bₖ is the cost of that cap or row. As the row gives more
//! if b at its other node is higher, a part of that cost is passed on to the cap or row of the other node: along the
//! chains to the caps at their ends. With λₖ for the cap or row that holds bₖ (p its coefficients) this is the
//! stationarity of the program,
//!
//! ```text
//!   pₖ(k)·λₖ + pₖ₋₁(k)·λₖ₋₁ + pₖ₊₁(k)·λₖ₊₁ = −∂T/∂xₖ − (rows of Clarabel that go to k),
//! ```
//!
//! tridiagonal. The coefficients of an active row have the sum 1 and those for other nodes are negative: the matrix is
//! diagonally dominant by columns with a positive diagonal and no positive off-diagonal element, so that no λ is
//! negative.
//!
//! A chain that ends at a variable of Clarabel makes it worth more ([`Chain::ends`]): its rows cost more by that
//! ([`shift`](super::shift)), and so may the rows chained to them beyond it.

use super::CAPPED;
use super::scaled::{Active, Scaled};
use crate::time_optimal::bound::Constraint;
use crate::time_optimal::grid::Grid;
use crate::time_optimal::sensitivity::Sensitivity;
use std::ops::Range;

/// A row that is less active holds nothing.
const ACTIVE: f64 = 0.99;
/// What is left of a coefficient by less than this part is rounding: the row holds what those before it hold already.
const ROUNDING: f64 = 1e-9;
/// Less, s, is rounding.
pub(super) const NO_GAIN: f64 = 1e-12;

/// Known worth of b at the nodes.
#[derive(Debug)]
pub(super) struct Chain<'g> {
    grid: &'g Grid,
    cells: Range<usize>,
    nodes: Vec<Worth>,
    held: Vec<Held>,
    /// What it is worth to have more of what holds the nodes.
    duals: Vec<f64>,
}

/// Worth of more b at a node, per part, as far as it is not passed on to the cap or row that holds it.
#[derive(Clone, Copy, Debug, Default)]
struct Worth {
    time: f64,
    /// True if it is neither a variable of Clarabel nor given.
    held: bool,
}

/// Cap or row that holds b at a node.
#[derive(Clone, Copy, Debug, Default)]
struct Held {
    constraint: Option<Constraint>,
    cell: usize,
    /// Coefficients for the node before, the node itself and the one after.
    row: [f64; 3],
    share: f64,
}

impl<'g> Chain<'g> {
    pub(super) fn new(grid: &'g Grid, cells: Range<usize>, variables: &[Option<usize>]) -> Self {
        let last = cells.len();
        let nodes = variables.iter().enumerate().map(|(node, variable)| Worth {
            time: 0.0,
            held: variable.is_none() && node > 0 && node < last,
        });
        Self { grid, nodes: nodes.collect(), cells, held: Vec::new(), duals: Vec::new() }
    }

    /// A row of Clarabel goes to this node: its multiplier times its coefficient.
    pub(super) fn pull(&mut self, node: usize, pull: f64) {
        if let Some(worth) = self.nodes.get_mut(node) {
            worth.time -= pull;
        }
    }

    /// Finds the caps and rows that hold the profile `b`.
    pub(super) fn hold(&mut self, b: &[f64]) {
        self.held = self.held(b);
        self.duals = vec![0.0; b.len()];
    }

    /// Takes what has become known of the worth of b to what holds it, and what that passes on to variables, by their nodes.
    pub(super) fn ends(&mut self) -> Vec<f64> {
        // Eliminated from the first node to the last: what is left of the diagonal and of the right side.
        let mut left: Vec<[f64; 2]> = Vec::with_capacity(self.held.len());
        let (mut before, mut pivot, mut rest) = (Held::default(), 1.0, 0.0);
        for (held, worth) in self.held.iter().zip(&mut self.nodes) {
            let [back, own, _] = held.row;
            let factor = before.row[2] / pivot;
            let time = std::mem::take(&mut worth.time);
            if held.constraint.is_some() {
                // The row of the node before goes to this one by `before.row[2]`, that of this one goes back by `back`.
                (pivot, rest) = (own - factor * back, time - factor * rest);
                if pivot <= own * ROUNDING {
                    (pivot, rest) = (f64::INFINITY, 0.0);
                }
            } else {
                (pivot, rest) = (1.0, 0.0);
            }
            left.push([pivot, rest]);
            before = *held;
        }
        let mut passed = vec![0.0; self.held.len()];
        let mut behind = 0.0;
        let nodes = self.held.iter().zip(left).zip(&mut self.duals).enumerate().rev();
        for (node, ((held, [pivot, rest]), sum)) in nodes {
            if held.constraint.is_none() {
                behind = 0.0;
                continue;
            }
            let dual = (rest - behind) / pivot;
            behind = held.row[0] * dual;
            *sum += dual;
            for (slot, coefficient) in
                [(node.checked_sub(1), held.row[0]), (Some(node + 1), held.row[2])]
            {
                if let Some(slot) = slot.and_then(|node| passed.get_mut(node)) {
                    *slot -= coefficient * dual;
                }
            }
        }
        for (passed, held) in passed.iter_mut().zip(&self.held) {
            if held.constraint.is_some() {
                *passed = 0.0;
            }
        }
        passed
    }

    /// Sensitivities of the limits, to be added to those found elsewhere: they may be negative.
    pub(super) fn gains(&self) -> impl Iterator<Item = Sensitivity> {
        self.held.iter().zip(&self.duals).filter_map(|(held, dual)| {
            let time = dual * held.share;
            let constraint = held.constraint.filter(|_| time != 0.0)?;
            Some(Sensitivity { cell: held.cell, constraint, time })
        })
    }

    /// Caps and rows that hold b at every node, and their worth where b is proved.
    fn held(&mut self, b: &[f64]) -> Vec<Held> {
        let mut result = vec![Held::default(); b.len()];
        let mut before = (Active::default(), 0.0);
        for (node, cell) in self.cells.clone().enumerate() {
            let Some([here, next]) = b.get(node..node + 2) else { break };
            let [start, finish] = Scaled::new(self.grid, cell, [*here, *next]).most_active();
            let (s, t) = (here.sqrt(), next.sqrt());
            // −∂T/∂b·b of 2h/(s + t).
            let slope = self.grid.length(cell) / ((s + t) * (s + t));
            if let (Some(worth), Some(slot)) = (self.nodes.get_mut(node), result.get_mut(node)) {
                let (active, slope_before) = before;
                if worth.held && *here > 0.0 {
                    worth.time += slope_before + slope * s;
                    let cap =
                        self.grid.caps().get(cell).filter(|cap| *here >= cap.v2 * (1.0 - CAPPED));
                    *slot = if let Some(cap) = cap {
                        Held {
                            constraint: Some(Constraint::Velocity(cap.source)),
                            cell: node.saturating_sub(1),
                            row: [0.0, 1.0, 0.0],
                            share: cap.source.share(),
                        }
                    } else if active.activity > start.activity {
                        let [p, r] = active.row;
                        held_by(&active, node.saturating_sub(1), [p, r, 0.0])
                    } else {
                        let [p, r] = start.row;
                        held_by(&start, node, [0.0, p, r])
                    };
                }
            }
            before = (finish, slope * t);
        }
        result
    }
}

fn held_by(active: &Active, cell: usize, row: [f64; 3]) -> Held {
    let constraint = active.constraint.filter(|_| active.activity > ACTIVE);
    // No known limit holds it.
    constraint.map_or(Held::default(), |_| Held { constraint, cell, row, share: 1.0 })
}
