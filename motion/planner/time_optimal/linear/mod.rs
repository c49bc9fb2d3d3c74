//! Time-optimal path parameterisation with limited acceleration as a convex program ([`LinearSolver`]).
//!
//! The acceleration is constant in a cell and limits hold at both of its ends, as in [`reachable`](super::reachable).
//! Variables are xₖ = bₖ/Uₖ at the inner nodes, where Uₖ is the largest possible bₖ, so that 0 ≤ x ≤ 1. The duration T
//! = Σ 2h/(√bₖ + √bₖ₊₁) is taken to second order about c, the profile of the two passes, or U/1.6 where that is more.
//! It is expanded again about the solution if the true slope of the duration differs from the assumed one. About U/1.6
//! the cost falls in every x all over 0 ≤ x ≤ 1 ([`cost`]). The presolve relies on that, as the duration itself has the
//! same property: it proves most b before Clarabel runs. The others, around points where an axis has no inertia, are
//! the variables of Clarabel's program. The profile is the exact optimum of the program. On the curves of the benchmark
//! (`tests/benches/limit`) none to nearly all of the nodes are left to it, 28 % in the middle: fewer the finer the
//! grid.

mod approach;
mod chain;
mod cost;
mod presolve;
mod scaled;
mod shift;
#[cfg(test)]
mod tests;

use super::bound::Constraint;
use super::convex::{Answer, Cone, NotSolved, Origin, Program};
use super::grid::Grid;
use super::reachable;
use crate::time_optimal::sensitivity::{Sensitivity, gains};
use approach::Open;
use chain::Chain;
use presolve::Presolved;
use scaled::Scaled;
use std::collections::BTreeMap;
use std::ops::Range;

/// Rows less active than this where every b is the largest it can be are left out at first.
const SCREEN: f64 = 0.9;

/// What the least variables keep of a row to within this is kept by all that is optimal.
const KEPT: f64 = 1e-6;
/// The duration is taken about no less than this part of the largest b.
const ABOUT: f64 = 1.0 / 1.6;
/// How often what is proved and what is not make each other worth more at most: once for every part of a window between.
const MOST_PASSES: u32 = 64;
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
    /// Sensitivities to the limits.
    pub gains: Vec<Sensitivity>,
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
            chain.hold(&b);
            chain.ends();
            let gains = added(chain.gains());
            return Ok(LinearProfile { b, variables: 0, iterations: 0, rows: 0, gains });
        }
        self.program.reset(count);
        self.beside.clear();
        self.add_bounds(grid, cells, &b, &variables);
        for (first, cell) in cells.clone().enumerate() {
            let (Some([from, to]), Some([here, next])) =
                (variables.get(first..first + 2), b.get(first..first + 2))
            else {
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
            self.add_rows(Scaled::new(grid, cell, [*here, *next]), &nodes);
        }
        // What proved b pass on to variables, where all are the largest that they can be.
        chain.hold(&b);
        let chained = chain.ends();
        let open = Open { grid, cells, variables: &variables, scales: &b, chained: &chained };
        let (found, answer) = self.approach(&open, &about(grid, cells, &b, presolved))?;
        b = found;
        let duals = self.costs(&mut chain, &b, (&variables, &chained), &answer);
        let gains = added(gains(&self.program.gains(&duals)).into_iter().chain(chain.gains()));
        let (iterations, rows) = (answer.iterations, self.program.rows());
        Ok(LinearProfile { b, variables: count, iterations, rows, gains })
    }

    /// Caps. Where the bound x ≤ 1 is what accelerations make of it, their rows say the same: were that a row as well, what
    /// the limit costs would be hidden in it.
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
                let entries = [(index, bound / cap.v2), (0, 0.0), (0, 0.0)];
                self.program.add_spare(entries, 1.0, origin);
            }
        }
    }

    /// The multipliers of Clarabel's rows with what is proved beside them.
    fn costs(
        &self,
        chain: &mut Chain<'_>,
        b: &[f64],
        (variables, chained): (&[Option<usize>], &[f64]),
        answer: &Answer,
    ) -> Vec<f64> {
        chain.hold(b);
        let mut chained = chained.to_vec();
        let mut duals = answer.duals.clone();
        let mut pulled = vec![0.0; duals.len()];
        for _ in 0..MOST_PASSES {
            for Beside { node, row, coefficient } in &self.beside {
                if let (Some(dual), Some(pulled)) = (duals.get(*row), pulled.get_mut(*row)) {
                    chain.pull(*node, (dual - *pulled) * coefficient);
                    *pulled = *dual;
                }
            }
            let mut worth = vec![0.0; answer.x.len()];
            for ((passed, chained), variable) in
                chain.ends().iter().zip(&mut chained).zip(variables)
            {
                let Some(index) = *variable else { continue };
                if let (Some(slot), Some(x)) = (worth.get_mut(index), answer.x.get(index)) {
                    *slot = if *x > 0.0 { passed / x - *chained } else { 0.0 };
                }
                *chained = 0.0;
            }
            if worth.iter().all(|worth| worth.abs() < chain::NO_GAIN) {
                break;
            }
            shift::shift(&self.program, &mut duals, &worth);
        }
        duals
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

/// Of each limit in each cell what it costs in all: one that holds both of its b may do so to one at the cost of the other.
fn added(gains: impl Iterator<Item = Sensitivity>) -> Vec<Sensitivity> {
    let mut sums = BTreeMap::<_, f64>::new();
    for Sensitivity { cell, constraint, time } in gains {
        *sums.entry((cell, constraint)).or_default() += time;
    }
    let sums = sums.into_iter().filter(|(_, time)| *time > chain::NO_GAIN);
    sums.map(|((cell, constraint), time)| Sensitivity { cell, constraint, time }).collect()
}

/// Profile about which the duration is expanded.
fn about(grid: &Grid, cells: &Range<usize>, scale: &[f64], presolved: &Presolved) -> Vec<f64> {
    let (Some(start), Some(end)) = (scale.first(), scale.last()) else { return Vec::new() };
    let passes = reachable::fastest(grid, cells.clone(), *start, *end);
    let nodes = scale.iter().zip(passes).enumerate();
    nodes
        .map(|(node, (scale, b))| if presolved.open(node) { b.max(scale * ABOUT) } else { *scale })
        .collect()
}
