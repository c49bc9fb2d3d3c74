//! The fastest profile with limited acceleration as a convex program.
//!
//! The acceleration is constant in a cell and limits hold at both of its ends, as in [`reachable`]. Variables are
//! xₖ = bₖ/Uₖ at the inner nodes, where Uₖ is the largest bₖ that any profile can have ([`reachable::bounds`]), so
//! that 0 ≤ x ≤ 1. The duration T = Σ 2h/(√bₖ + √bₖ₊₁) is taken to second order about the profile of the two passes.

use super::convex::{NotSolved, Origin, Program};
use super::gain::{Gain, gains};
use super::grid::{Cap, CapSource, Constraint, End, Grid, Row, number};
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
    /// What limits cost.
    pub gains: Vec<Gain>,
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
        for (index, cell) in cells.clone().skip(1).enumerate() {
            let bound = at(index + 1);
            let cap = grid.caps().get(cell).copied().unwrap_or(Cap::NONE);
            // Where it is no cap, the bound is what the accelerations beside it make of others.
            let (constraint, share) = if cap.v2 <= bound * (1.0 + 1e-9) {
                (Constraint::Velocity(cap.source), 2.0)
            } else {
                (most_active(grid, cell, bound, at(index + 2)), 1.0)
            };
            self.program.add_row(
                &[(index, 1.0)],
                1.0,
                Origin { cell: index, constraint, upper: true, share },
            );
        }
        for (index, cell) in cells.clone().enumerate() {
            let step = Step::new(grid.length(cell), at(index), at(index + 1));
            let variables = (variable(index), variable(index + 1));
            self.add_costs(&step, variables);
            self.add_rows(grid, cell, index, &step, variables);
        }
        let answer = self.program.solve_all(1e-7)?;
        let mut b = guess.clone();
        for ((slot, x), scale) in b.iter_mut().skip(1).zip(&answer.x).zip(&scale) {
            *slot = (x * scale).max(0.0);
        }
        let gains = gains(&answer.gains);
        Ok(LinearProfile { b, iterations: answer.iterations, rows: self.program.rows(), gains })
    }

    /// The duration of a cell, 2h/(√x + √y), to second order about the bounds.
    fn add_costs(&mut self, step: &Step, (first, second): (Option<usize>, Option<usize>)) {
        let Step { h, bounds: [b0, b1] } = *step;
        let (s0, s1) = (b0.sqrt(), b1.sqrt());
        let sum = s0 + s1;
        let slope = |s: f64| -h / (s * sum * sum);
        let bend = |s: f64| h / (sum * sum) * (0.5 / (s * s * s) + 1.0 / (s * s * sum));
        let cross = h / (s0 * s1 * sum * sum * sum);
        for (variable, other, s, b, beside) in
            [(first, second, s0, b0, b1), (second, first, s1, b1, b0)]
        {
            let Some(variable) = variable else { continue };
            let with = if other.is_some() { cross * beside } else { 0.0 };
            let linear = slope(s) - bend(s) * b - with;
            self.program.add_cost(variable, bend(s) * b * b, linear * b);
        }
        if let (Some(variable), Some(_)) = (first, second) {
            self.program.add_coupling(variable, cross * b0 * b1);
        }
    }

    /// The limits at both ends of a cell.
    fn add_rows(
        &mut self,
        grid: &Grid,
        cell: usize,
        index: usize,
        step: &Step,
        (first, second): (Option<usize>, Option<usize>),
    ) {
        for end in End::BOTH {
            let (axes, further) = grid.rows(cell, end);
            let mut add = |row: &Row, constraint| {
                let [p, r] = step.turned(row, end);
                // Never reached between the bounds.
                if p.max(0.0) + r.max(0.0) <= 1.0 {
                    return;
                }
                let mut right = 1.0;
                let mut entries = [(0, 0.0); 3];
                for (slot, (variable, value)) in entries.iter_mut().zip([(first, p), (second, r)]) {
                    match variable {
                        Some(variable) => *slot = (variable, value),
                        None => right -= value,
                    }
                }
                let origin = Origin { cell: index, constraint, upper: true, share: 1.0 };
                if p + r < SCREEN {
                    self.program.add_spare(entries, right, origin);
                } else {
                    self.program.add_row(&entries, right, origin);
                }
            };
            for (axis, row) in axes.iter().enumerate() {
                let constraint = Constraint::AxisAcceleration(number(axis));
                add(row, constraint);
                add(&Row { a: -row.a, b: -row.b }, constraint);
            }
            for (place, row) in further.iter().enumerate() {
                add(row, Constraint::Further(number(place)));
            }
            if let Some(disc) = grid.disc(cell, end) {
                let mut cone = [[(0, 0.0); 3]; 3];
                for (line, (a, b)) in cone.iter_mut().zip(disc.a.iter().zip(disc.b)) {
                    let turned = step.turned(&Row { a: *a, b }, end);
                    for (slot, (variable, value)) in
                        line.iter_mut().zip([(first, turned[0]), (second, turned[1])])
                    {
                        *slot = (variable.unwrap_or_default(), variable.map_or(0.0, |_| value));
                    }
                }
                let constraint = Constraint::ToolAcceleration;
                self.program
                    .add_cone(cone, Origin { cell: index, constraint, upper: true, share: 1.0 });
            }
        }
    }
}

/// A cell with the bounds of b at its ends.
#[derive(Clone, Copy, Debug)]
struct Step {
    h: f64,
    bounds: [f64; 2],
}

impl Step {
    fn new(h: f64, start: f64, end: f64) -> Self {
        Self { h, bounds: [start, end] }
    }

    /// A row at an end of the cell in terms of b at both ends, as parts of their bounds.
    fn turned(&self, row: &Row, end: End) -> [f64; 2] {
        let r = row.a * 0.5 / self.h;
        let [p, r] = match end {
            End::Start => [row.b - r, r],
            End::Finish => [-r, row.b + r],
        };
        [p * self.bounds[0], r * self.bounds[1]]
    }
}

/// The limit of acceleration that is most active in a cell with these b.
fn most_active(grid: &Grid, cell: usize, start: f64, end: f64) -> Constraint {
    let step = Step::new(grid.length(cell), start, end);
    let mut most = (0.0, Constraint::Velocity(CapSource::Nothing));
    for side in End::BOTH {
        let (axes, further) = grid.rows(cell, side);
        let of = |row: &Row| step.turned(row, side).iter().sum::<f64>();
        let axes = axes.iter().enumerate();
        let axes =
            axes.map(|(axis, row)| (of(row).abs(), Constraint::AxisAcceleration(number(axis))));
        let further = further.iter().enumerate();
        let further = further.map(|(place, row)| (of(row), Constraint::Further(number(place))));
        for (activity, constraint) in axes.chain(further) {
            if activity > most.0 {
                most = (activity, constraint);
            }
        }
    }
    most.1
}
