//! The fastest profile with limited acceleration as a convex program.
//!
//! The acceleration is constant in a cell and limits hold at both of its ends, as in [`reachable`](super::reachable).
//! Variables are xₖ = bₖ/Uₖ at the inner nodes, where Uₖ is the largest bₖ that any profile can have, so that 0 ≤ x ≤ 1. The
//! duration T = Σ 2h/(√bₖ + √bₖ₊₁) is taken to second order about c, the profile of the two passes, or U/1.6 where that is
//! more. With s = √c and S = sₖ + sₖ₊₁ the slope of a cell by bₖ is at c, and at most (its second derivatives are positive, so
//! that it is largest where all b are U, and U − c ≤ 0.6·c)
//!
//! ```text
//!   −h/(s·S²)     and     −h/(s·S²) + 0.6·h/S²·(0.5/s + 1/S + s′/(s·S)) = −0.1·h/(s·S²)
//! ```
//!
//! so that the cost falls in every x all over 0 ≤ x ≤ 1. That is what the presolve rests on, as it does for the duration
//! itself: most b are proved before Clarabel is asked, and those that are not, around points where an axis has no inertia,
//! are the variables of its program. The profile is the optimum of the program all the same. On the curves of the benchmark
//! (`tests/benches/limit`) none to nearly all of the nodes are left to it, 28 % in the middle: fewer the finer the grid.

mod chain;
mod presolve;
mod scaled;
#[cfg(test)]
mod tests;

use super::bound::Constraint;
use super::convex::{Cone, NotSolved, Origin, Program};
use super::gain::{Gain, gains};
use super::grid::Grid;
use super::reachable;
use chain::Chain;
use presolve::Presolved;
use scaled::Scaled;
use std::ops::Range;

/// Rows less active than this where every b is the largest it can be are left out at first.
const SCREEN: f64 = 0.9;

/// What the least variables keep of a row to within this is kept by all that is optimal.
const KEPT: f64 = 1e-6;
/// The duration is taken about no less than this part of the largest b.
const ABOUT: f64 = 1.0 / 1.6;
/// b counts as held by a cap that is higher by no more than this part.
const CAPPED: f64 = 1e-9;

/// A profile with constant acceleration in every cell.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearProfile {
    /// b at every node of the cells, m²/s².
    pub b: Vec<f64>,
    /// Inner nodes whose b was left to the solver: all others are proved without it.
    pub variables: usize,
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
    pub(super) program: Program,
    /// What is given in rows.
    beside: Vec<Beside>,
}

/// A part of a row whose b is given.
#[derive(Clone, Copy, Debug)]
struct Beside {
    node: usize,
    row: usize,
    coefficient: f64,
}

/// What the solver has a variable for, and what is given, at the two nodes of a cell.
#[derive(Clone, Copy, Debug)]
struct Nodes {
    first: usize,
    variables: [Option<usize>; 2],
    /// The least x.
    least: [f64; 2],
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
        let presolved = Presolved::new(grid, cells.clone(), start, end);
        self.solve_rest(grid, &cells, &presolved)
    }

    /// Leaves to Clarabel what is not proved.
    fn solve_rest(
        &mut self,
        grid: &Grid,
        cells: &Range<usize>,
        presolved: &Presolved,
    ) -> Result<LinearProfile, NotSolved> {
        let mut b = presolved.scale();
        let mut count = 0;
        let variables: Vec<Option<usize>> = (0..b.len())
            .map(|node| {
                let variable = presolved.open(node).then_some(count);
                count += usize::from(variable.is_some());
                variable
            })
            .collect();
        let mut chain = Chain::new(grid, cells.clone(), &variables);
        if count == 0 {
            let gains = chain.gains(&b);
            return Ok(LinearProfile { b, variables: 0, iterations: 0, rows: 0, gains });
        }
        self.program.reset(count);
        self.beside.clear();
        self.add_bounds(grid, cells, &b, &variables);
        let about = about(grid, cells, &b, presolved);
        for (first, cell) in cells.clone().enumerate() {
            let (Some([from, to]), Some([here, next]), Some([c0, c1])) = (
                variables.get(first..first + 2),
                b.get(first..first + 2),
                about.get(first..first + 2),
            ) else {
                break;
            };
            let variables = [*from, *to];
            if variables == [None; 2] {
                continue;
            }
            let least = [first, first + 1].map(|node| {
                let bounds = (presolved.lower.get(node), presolved.upper.get(node));
                match bounds {
                    (Some(lower), Some(upper)) if presolved.open(node) => lower / upper,
                    _ => 1.0,
                }
            });
            let nodes = Nodes { first, variables, least };
            self.add_costs(grid.length(cell), [*c0, *c1], [*here, *next], variables);
            self.add_rows(Scaled::new(grid, cell, [*here, *next]), &nodes);
        }
        let answer = self.program.solve_all(1e-7)?;
        for (slot, variable) in b.iter_mut().zip(&variables) {
            if let Some(x) = variable.and_then(|index| answer.x.get(index)) {
                *slot = (*slot * x).max(0.0);
            }
        }
        for Beside { node, row, coefficient } in &self.beside {
            let dual = answer.duals.get(*row).copied().unwrap_or_default();
            chain.pull(*node, dual * coefficient);
        }
        let mut gains = gains(&answer.gains);
        gains.extend(chain.gains(&b));
        let (iterations, rows) = (answer.iterations, self.program.rows());
        Ok(LinearProfile { b, variables: count, iterations, rows, gains })
    }

    /// Caps. Where the bound is what accelerations make of it, their rows say the same as x ≤ 1.
    fn add_bounds(
        &mut self,
        grid: &Grid,
        cells: &Range<usize>,
        bounds: &[f64],
        variables: &[Option<usize>],
    ) {
        let nodes = grid.caps().iter().skip(cells.start).zip(bounds).zip(variables).enumerate();
        for (node, ((cap, bound), variable)) in nodes {
            let Some(index) = *variable else { continue };
            let constraint = Constraint::Velocity(cap.source);
            let share = cap.source.share();
            let origin = Origin { cell: node.saturating_sub(1), constraint, upper: true, share };
            if cap.v2 <= bound * (1.0 + CAPPED) {
                self.program.add_row(&[(index, 1.0)], 1.0, origin);
            } else {
                let entries = [(index, 1.0), (0, 0.0), (0, 0.0)];
                self.program.add_spare(entries, 1.0, Origin { share: 0.0, ..origin });
            }
        }
    }

    /// The duration of a cell, 2h/(√b₀ + √b₁), to second order about c, where b are these `scales` times the variables.
    fn add_costs(
        &mut self,
        h: f64,
        [c0, c1]: [f64; 2],
        scales: [f64; 2],
        [first, second]: [Option<usize>; 2],
    ) {
        let (s0, s1) = (c0.sqrt(), c1.sqrt());
        let sum = s0 + s1;
        let slope = |s: f64| -h / (s * sum * sum);
        let bend = |s: f64| h / (sum * sum) * (0.5 / (s * s * s) + 1.0 / (s * s * sum));
        let cross = h / (s0 * s1 * sum * sum * sum);
        for (variable, other, s, scale, c, beside) in
            [(first, second, s0, scales[0], c0, c1), (second, first, s1, scales[1], c1, c0)]
        {
            let Some(variable) = variable else { continue };
            let with = if other.is_some() { cross * beside } else { 0.0 };
            let linear = slope(s) - bend(s) * c - with;
            self.program.add_cost(variable, bend(s) * scale * scale, linear * scale);
        }
        if let (Some(variable), Some(_)) = (first, second) {
            self.program.add_coupling(variable, cross * scales[0] * scales[1]);
        }
    }

    /// The limits in a cell, but for those that hold whatever its variables are.
    fn add_rows(&mut self, scaled: Scaled<'_>, nodes: &Nodes) {
        for (constraint, row) in scaled.halves() {
            if Scaled::half_holds(row, nodes.least) {
                continue;
            }
            let [Some(first), Some(second)] = nodes.variables else {
                self.add_given(row, constraint, nodes);
                continue;
            };
            let entries = [(first, row[0]), (second, row[1]), (0, 0.0)];
            let origin = Origin { cell: nodes.first, constraint, upper: true, share: 1.0 };
            if row[0] + row[1] < SCREEN {
                self.program.add_spare(entries, 1.0, origin);
            } else {
                self.program.add_row(&entries, 1.0, origin);
            }
        }
        for vectors in scaled.discs() {
            if Scaled::disc_holds(&vectors, nodes.least) {
                continue;
            }
            let constraint = Constraint::ToolAcceleration;
            if let [Some(first), Some(second)] = nodes.variables {
                let [p, r] = vectors;
                let mut cone = Cone::default();
                for (line, (p, r)) in cone.rows.iter_mut().zip(p.into_iter().zip(r)) {
                    *line = [(first, p), (second, r), (0, 0.0)];
                }
                let origin = Origin { cell: nodes.first, constraint, upper: true, share: 1.0 };
                self.program.add_cone(cone, origin);
            } else {
                let own = usize::from(nodes.variables[0].is_none());
                if let Some(row) = scaled::tangent(&vectors, own) {
                    self.add_given(row, constraint, nodes);
                }
            }
        }
    }

    /// A half plane in a cell of which one b is given.
    fn add_given(&mut self, row: [f64; 2], constraint: Constraint, nodes: &Nodes) {
        let [p, r] = row;
        let (variable, own, given, node) = match nodes.variables {
            [Some(variable), None] => (variable, p, r, nodes.first + 1),
            [None, Some(variable)] => (variable, r, p, nodes.first),
            _ => return,
        };
        let least = nodes.least.iter().fold(1.0, |least: f64, part| least.min(*part));
        if own <= 0.0 && own * least + given <= 1.0 + KEPT {
            // It asks for no less than every optimum has. To say so would leave no room, where that is all there can be.
            return;
        }
        let right = 1.0 - given;
        // Raising the limit by a part of it raises 1 by that.
        let origin = Origin { cell: nodes.first, constraint, upper: true, share: 1.0 / right };
        self.beside.push(Beside { node, row: self.program.rows(), coefficient: given });
        self.program.add_row(&[(variable, own)], right, origin);
    }
}

/// What the duration is taken about.
fn about(grid: &Grid, cells: &Range<usize>, scale: &[f64], presolved: &Presolved) -> Vec<f64> {
    let (Some(start), Some(end)) = (scale.first(), scale.last()) else { return Vec::new() };
    let passes = reachable::fastest(grid, cells.clone(), *start, *end);
    let nodes = scale.iter().zip(passes).enumerate();
    nodes
        .map(|(node, (scale, b))| if presolved.open(node) { b.max(scale * ABOUT) } else { *scale })
        .collect()
}
