//! Iteration of Clarabel's program: solves it about one profile after the other until its second-order duration matches
//! the true one.

use super::LinearSolver;
use super::cost::CellCost;
use crate::time_optimal::convex::{Answer, NotSolved};
use crate::time_optimal::grid::Grid;
use crate::time_optimal::reachable;
use std::ops::Range;

/// Of the rows, and of the cost in parts of it.
const TOLERANCE: f64 = 2e-8;
/// Where the costs are off by less than this part of the duration they are those of the duration.
const ASTRAY: f64 = 1e-3;
/// Largest number of expansions of the duration about another profile.
const MOST_ROUNDS: u32 = 4;
/// It is not taken about less than this part of the largest b, where it bends without end.
const LEAST_ABOUT: f64 = 1e-3;

/// The open part of a window, which Clarabel solves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open<'s> {
    pub(super) grid: &'s Grid,
    pub(super) cells: &'s Range<usize>,
    pub(super) variables: &'s [Option<usize>],
    pub(super) scales: &'s [f64],
    /// Additional worth of the variables that are not proved.
    pub(super) chained: &'s [f64],
}

/// A cell of it.
#[derive(Clone, Copy, Debug)]
struct OpenCell {
    cost: CellCost,
    scales: [f64; 2],
    variables: [Option<usize>; 2],
}

impl Open<'_> {
    /// Its cells, the duration taken about these b.
    fn cells(&self, about: &[f64]) -> impl Iterator<Item = OpenCell> {
        let Self { grid, cells, variables, scales, .. } = *self;
        cells.clone().enumerate().map_while(move |(first, cell)| {
            let (Some([from, to]), Some([here, next]), Some([c0, c1])) = (
                variables.get(first..first + 2),
                scales.get(first..first + 2),
                about.get(first..first + 2),
            ) else {
                return None;
            };
            Some(OpenCell {
                cost: CellCost::new(grid.length(cell), [*c0, *c1]),
                scales: [*here, *next],
                variables: [*from, *to],
            })
        })
    }
}

/// Solution of Clarabel.
#[derive(Debug)]
struct Approached {
    b: Vec<f64>,
    answer: Answer,
    /// Error of the expanded duration there, as a part of the duration.
    astray: f64,
}

impl LinearSolver {
    /// Solves it about a profile, and about what is found until that is what the duration is taken about.
    pub(super) fn approach(
        &mut self,
        open: &Open<'_>,
        about: &[f64],
    ) -> Result<(Vec<f64>, Answer), NotSolved> {
        let mut best = self.solve_about(open, about)?;
        for _ in 1..MOST_ROUNDS {
            if best.astray <= ASTRAY {
                break;
            }
            let least = open.scales.iter().map(|scale| scale * LEAST_ABOUT);
            let about: Vec<f64> = best.b.iter().zip(least).map(|(b, least)| b.max(least)).collect();
            let iterations = best.answer.iterations;
            // What has been found is a profile, whatever becomes of this one.
            let Ok(mut next) = self.solve_about(open, &about) else { break };
            next.answer.iterations += iterations;
            if next.astray >= best.astray {
                break;
            }
            best = next;
        }
        Ok((best.b, best.answer))
    }

    fn solve_about(&mut self, open: &Open<'_>, about: &[f64]) -> Result<Approached, NotSolved> {
        self.program.forget_costs();
        for cell in open.cells(about) {
            cell.cost.add_to(&mut self.program, cell.scales, cell.variables);
        }
        for (variable, chained) in open.variables.iter().zip(open.chained) {
            if let Some(index) = *variable {
                self.program.add_cost(index, 0.0, -chained);
            }
        }
        let answer = self.program.solve_all(TOLERANCE)?;
        let b: Vec<f64> = open
            .scales
            .iter()
            .zip(open.variables)
            .map(|(scale, variable)| {
                let x = variable.and_then(|index| answer.x.get(index));
                x.map_or(*scale, |x| (scale * x).max(0.0))
            })
            .collect();
        let sum: f64 =
            open.cells(about)
                .zip(b.windows(2))
                .map(|(cell, b)| {
                    if let [b0, b1] = b {
                        cell.cost.astray([*b0, *b1], cell.variables)
                    } else {
                        0.0
                    }
                })
                .sum();
        let astray = sum / reachable::duration(open.grid, open.cells.clone(), &b);
        Ok(Approached { b, answer, astray })
    }
}
