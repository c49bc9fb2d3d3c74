//! The fastest profile with limited acceleration as a convex program.
//!
//! The acceleration is constant in a cell and limits hold at both of its ends, as in [`reachable`]. Variables are
//! xₖ = bₖ/Uₖ at the inner nodes, where Uₖ is the largest bₖ that any profile can have ([`reachable::bounds`]), so
//! that 0 ≤ x ≤ 1. The duration T = Σ 2h/(√bₖ + √bₖ₊₁) is taken to second order about the profile of the two passes.

use super::convex::{NotSolved, Program};
use super::grid::{End, Grid};
use super::reachable;
use std::ops::Range;

/// Rows less active than this where every b is the largest it can be are left out at first.
const SCREEN: f64 = 0.9;

/// A profile with constant acceleration in every cell.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearProfile {
    /// b at every node of the cells, m²/s².
    pub b: Vec<f64>,
    /// Iterations of the solver.
    pub iterations: u32,
    /// Rows it was given.
    pub rows: usize,
}

/// Solves windows with limited acceleration; keeps its memory from one to the next.
#[derive(Debug, Default)]
pub struct LinearSolver {
    program: Program,
}

impl LinearSolver {
    /// The fastest profile over `cells` from b = `start` to b = `end`.
    ///
    /// # Errors
    /// If Clarabel finds none.
    pub fn solve(
        &mut self,
        grid: &Grid,
        cells: Range<usize>,
        start: f64,
        end: f64,
    ) -> Result<LinearProfile, NotSolved> {
        let guess = reachable::bounds(grid, cells.clone(), start, end);
        let inner = cells.len().saturating_sub(1);
        self.program.reset(inner);
        let scale: Vec<f64> = guess.iter().skip(1).take(inner).copied().collect();
        let variable = |node: usize| {
            // Node 0 and the last one are given.
            node.checked_sub(1).filter(|index| *index < inner)
        };
        let at = |node: usize| guess.get(node).copied().unwrap_or_default();
        for index in 0..inner {
            self.program.add_row(&[(index, 1.0)], 1.0);
        }
        for (index, cell) in cells.clone().enumerate() {
            let h = grid.length(cell);
            let slope = 0.5 / h;
            let (b0, b1) = (at(index), at(index + 1));
            let (s0, s1) = (b0.sqrt(), b1.sqrt());
            // T = 2h/(√x + √y): first and second derivatives.
            let sum = s0 + s1;
            let (v0, v1) = (variable(index), variable(index + 1));
            let d = |s: f64| -h / (s * sum * sum);
            let dd = |s: f64| h / (sum * sum) * (0.5 / (s * s * s)) + h / (s * s * sum * sum * sum);
            let cross = h / (s0 * s1 * sum * sum * sum);
            if let Some(v0) = v0 {
                let c = b0;
                let mut q = d(s0) - dd(s0) * b0;
                if v1.is_some() {
                    q -= cross * b1;
                }
                self.program.add_cost(v0, dd(s0) * c * c, q * c);
            }
            if let Some(v1) = v1 {
                let c = b1;
                let mut q = d(s1) - dd(s1) * b1;
                if v0.is_some() {
                    q -= cross * b0;
                }
                self.program.add_cost(v1, dd(s1) * c * c, q * c);
            }
            if let (Some(v0), Some(_)) = (v0, v1) {
                self.program.add_coupling(v0, cross * b0 * b1);
            }
            for side in End::BOTH {
                let (axes, further) = grid.rows(cell, side);
                let mut add = |a: f64, b: f64| {
                    let r = a * slope;
                    let (p, r) = match side {
                        End::Start => (b - r, r),
                        End::Finish => (-r, b + r),
                    };
                    let (p, r) = (p * b0, r * b1);
                    if p.max(0.0) + r.max(0.0) <= 1.0 {
                        return;
                    }
                    let mut right = 1.0;
                    let mut entries = [(0, 0.0); 3];
                    match v0 {
                        Some(v) => entries[0] = (v, p),
                        None => right -= p,
                    }
                    match v1 {
                        Some(v) => entries[1] = (v, r),
                        None => right -= r,
                    }
                    if p + r < SCREEN {
                        self.program.add_spare(entries, right);
                    } else {
                        self.program.add_row(&entries, right);
                    }
                };
                for row in axes {
                    add(row.a, row.b);
                    add(-row.a, -row.b);
                }
                for row in further {
                    add(row.a, row.b);
                }
            }
        }
        let answer = self.program.solve_all(1e-7)?;
        let mut b = guess.clone();
        for ((slot, x), scale) in b.iter_mut().skip(1).zip(&answer.x).zip(&scale) {
            *slot = (x * scale).max(0.0);
        }
        Ok(LinearProfile { b, iterations: answer.iterations, rows: self.program.rows() })
    }
}
