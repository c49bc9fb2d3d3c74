//! Time-optimal path parameterisation with limited jerk as a convex program ([`SmoothSolver`]).
//!
//! # The profile
//!
//! b(u) is a quadratic spline: with Bézier's middle value cᵢ in the cell i of length hᵢ, value and slope at the node
//! between two cells are
//!
//! ```text
//!   bₖ = (hₖ·cₖ₋₁ + hₖ₋₁·cₖ) / (hₖ₋₁ + hₖ)        aₖ = b′/2 = (cₖ − cₖ₋₁) / (hₖ₋₁ + hₖ)
//! ```
//!
//! and in a cell γ = b″/2 = (bᵢ − 2·cᵢ + bᵢ₊₁)/hᵢ² is constant. So a = ü is continuous, and the interpolator follows
//! exactly the profile of the program.
//!
//! If the path starts from rest, its first cell has constant jerk j: u = j·t³/6, which is b = ¼·j^⅔·(6u)^4/3. Value and
//! slope at its end, j^⅔·(6h)^4/3/4 and j^⅔·(6h)^⅓, are both proportional to j^⅔, so that the cell adds only one thing
//! to the program: the next node's value is a part of the next c. The same holds, mirrored, for the last cell of a path
//! that ends at rest.
//!
//! # The program
//!
//! Limits of acceleration are linear in b and a. A limit of jerk, ±(q‴·b + 3·q″·a + q′·γ) ≤ J/√b, is convex except for
//! its right side, and there the tangent about a guess b̄ is below: J/√b ≥ J·(3 − b/b̄)/(2·√b̄). So every solution
//! keeps the limit, and solving again about it is never worse. The duration Σ wₖ/√bₖ, wₖ half the length of the two
//! cells next to a node, is taken to second order about b̄. Variables are cᵢ/c̄ᵢ.

mod costs;
mod guess;

use guess::MOST_AROUND;
pub(super) use guess::{Broken, Guess};

use super::bound::{CapSource, Constraint};
use super::convex::{NotSolved, Origin, Program};
use super::grid::{End, Grid};
use super::rows::{Around, Known, Place, Screen, Writer};
use crate::time_optimal::sensitivity::{Sensitivity, gains};
use std::ops::Range;

/// A c that is to be positive is at least this part of the guess.
const LEAST: f64 = 1e-3;

/// What need not be slow weighs so much where something else is to be.
const BESIDE: f64 = 1e-3;

/// How exactly a guess, a profile that is looked at afterwards, and one that is not, are solved for.
const ROUGH: f64 = 1e-5;
const FINE: f64 = 1e-6;
const EXACT: f64 = 1e-9;

/// Rows that were left out are looked for at most so often.
const MORE: u32 = 10;

/// Objective of a profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Aim {
    /// The shortest duration.
    #[default]
    Fastest,
    /// The smallest velocities above those of [`SmoothSolver::floors`]: braking, and no bounds on the velocity.
    Slowest,
}

/// Begin of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Beginning {
    /// At rest.
    Rest,
    /// With u̇² and ü.
    Moving {
        /// u̇².
        b: f64,
        /// ü.
        a: f64,
    },
}

/// A profile with limited jerk over some cells, which ends at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothProfile {
    /// Its begin.
    pub beginning: Beginning,
    /// u̇² at the nodes.
    pub b: Vec<f64>,
    /// ü at the nodes: continuous.
    pub a: Vec<f64>,
    /// Iterations of the solver, over all solves.
    pub iterations: u32,
    /// Solves.
    pub solves: u32,
    /// Rows of the last solve.
    pub rows: usize,
    /// Sensitivities to the limits.
    pub gains: Vec<Sensitivity>,
}

impl SmoothProfile {
    /// With `part` of u̇² and of ü everywhere.
    pub(super) fn scale(&mut self, part: f64) {
        for value in self.b.iter_mut().chain(&mut self.a) {
            *value *= part;
        }
    }
}

/// The b (or a) of a node as a part of the c of the cell before and of the cell after.
#[derive(Clone, Copy, Debug, Default)]
struct Knot {
    b: [f64; 2],
    a: [f64; 2],
}

/// Solves windows with limited jerk; keeps its memory from one to the next.
#[derive(Debug, Default)]
pub struct SmoothSolver {
    pub(super) program: Program,
    knots: Vec<Knot>,
    /// Of the variables: c of every cell is a multiple of it.
    scale: Vec<f64>,
    pub(super) aim: Aim,
    /// The least c of every cell, if that is the aim.
    pub(super) floors: Vec<f64>,
    /// True if c is to be positive whatever the aim: where the path brakes to nearly nothing it need not be.
    pub(super) positive: bool,
}

impl SmoothSolver {
    /// The fastest profile over `cells` (at least 3), from `beginning` to rest, about the profile `guess` of b at the nodes, which must
    /// be positive at all inner ones. Solves as often as told, each time about the solution before, and as often as rows are
    /// found that should not have been left out.
    ///
    /// # Errors
    /// If Clarabel finds none.
    pub fn solve(
        &mut self,
        grid: &Grid,
        cells: Range<usize>,
        beginning: Beginning,
        guess: &[f64],
        solves: u32,
    ) -> Result<SmoothProfile, NotSolved> {
        let mut guess = Guess::rough(guess.to_vec());
        (guess.tolerance, guess.around) = (EXACT, MOST_AROUND);
        let mut iterations = 0;
        let mut solved = 0;
        loop {
            solved += 1;
            let free = 1..cells.len().saturating_sub(1);
            let (mut profile, broken) =
                self.solve_about(grid, cells.clone(), beginning, &mut guess, free)?;
            iterations += profile.iterations;
            // Nobody looks at it afterwards: what may count stays in the program.
            guess.known = Known::Nearly;
            if solved >= solves && (broken.0.is_empty() || solved >= solves + MORE) {
                (profile.iterations, profile.solves) = (iterations, solved);
                return Ok(profile);
            }
        }
    }

    /// Solves once about `guess`, which then is about the solution. In cells that are not `free` the profile stays what it is
    /// in the guess; the first and the last are never free.
    pub(super) fn solve_about(
        &mut self,
        grid: &Grid,
        cells: Range<usize>,
        beginning: Beginning,
        guess: &mut Guess,
        free: Range<usize>,
    ) -> Result<(SmoothProfile, Broken), NotSolved> {
        self.set_knots(grid, &cells, beginning);
        self.scale.clear();
        self.scale.extend(pairs(&guess.b).map(|(from, to)| from.midpoint(to)));
        if let Beginning::Moving { b, a } = beginning {
            let given = b + a * grid.length(cells.start);
            for first in [self.scale.first_mut(), guess.c.first_mut()].into_iter().flatten() {
                *first = given;
            }
        }
        self.build(grid, &cells, beginning, guess, &free);
        // What is only the guess for another need not be exact.
        let rough = guess.known == Known::Rough;
        let tolerance = if rough { ROUGH } else { guess.tolerance };
        let mut answer = self.program.solve(tolerance)?;
        // A profile that would go backwards is no guess for another.
        while self.program.goes_backwards(&answer.x) {
            self.program.add_broken(&answer.x);
            self.program.count_down(answer.iterations);
            let iterations = answer.iterations;
            answer = self.program.solve(tolerance)?;
            answer.iterations += iterations;
        }
        let broken = Broken(self.program.broken(&answer.x).collect());
        let mut c = guess.c.clone();
        let solved = self.scale.iter().skip(free.start).zip(&answer.x);
        for (slot, (scale, x)) in c.iter_mut().skip(free.start).zip(solved) {
            *slot = scale * x;
        }
        let (b, a) = self.values(&cells, beginning, &c);
        guess.follow(&b, &c, &broken);
        let profile = SmoothProfile {
            beginning,
            b,
            a,
            iterations: answer.iterations,
            solves: 1,
            rows: self.program.rows(),
            gains: gains(&answer.gains),
        };
        Ok((profile, broken))
    }

    /// The profile over `grid` that has these c, which nothing was solved for.
    pub(super) fn profile(
        &mut self,
        grid: &Grid,
        beginning: Beginning,
        c: &[f64],
    ) -> SmoothProfile {
        let cells = 0..grid.cells();
        self.set_knots(grid, &cells, beginning);
        let (b, a) = self.values(&cells, beginning, c);
        SmoothProfile { beginning, b, a, iterations: 0, solves: 0, rows: 0, gains: Vec::new() }
    }

    fn set_knots(&mut self, grid: &Grid, cells: &Range<usize>, beginning: Beginning) {
        let count = cells.len();
        self.knots.clear();
        self.knots.push(match beginning {
            Beginning::Rest => Knot::default(),
            // What is given, as a part of the first c, which is given, too.
            Beginning::Moving { b, a } => {
                let c = b + a * grid.length(cells.start);
                Knot { b: [0.0, b / c], a: [0.0, a / c] }
            }
        });
        for (index, cell) in cells.clone().enumerate().skip(1) {
            let (before, after) = (grid.length(cell - 1), grid.length(cell));
            let knot = if index == 1 && beginning == Beginning::Rest {
                let (b, a) = launch(before, after);
                Knot { b: [0.0, b], a: [0.0, a] }
            } else if index + 1 == count {
                let (b, a) = launch(after, before);
                Knot { b: [b, 0.0], a: [-a, 0.0] }
            } else {
                let sum = before + after;
                Knot { b: [after / sum, before / sum], a: [-1.0 / sum, 1.0 / sum] }
            };
            self.knots.push(knot);
        }
        self.knots.push(Knot::default());
    }

    /// b and a at all nodes for a solution.
    fn values(
        &self,
        cells: &Range<usize>,
        beginning: Beginning,
        c: &[f64],
    ) -> (Vec<f64>, Vec<f64>) {
        let mut b = vec![0.0; cells.len() + 1];
        let mut a = b.clone();
        for (index, pair) in c.windows(2).enumerate() {
            let [before, after] = pair else { continue };
            let Some(knot) = self.knots.get(index + 1) else { continue };
            if let (Some(b), Some(a)) = (b.get_mut(index + 1), a.get_mut(index + 1)) {
                *b = (knot.b[0] * before + knot.b[1] * after).max(0.0);
                *a = knot.a[0] * before + knot.a[1] * after;
            }
        }
        if let (Beginning::Moving { b: b0, a: a0 }, Some(b), Some(a)) =
            (beginning, b.first_mut(), a.first_mut())
        {
            (*b, *a) = (b0, a0);
        }
        (b, a)
    }

    fn build(
        &mut self,
        grid: &Grid,
        cells: &Range<usize>,
        beginning: Beginning,
        guess: &Guess,
        free: &Range<usize>,
    ) {
        let count = cells.len();
        self.program.reset(free.len());
        match self.aim {
            Aim::Fastest => self.add_costs(grid, cells, guess, free),
            Aim::Slowest => self.add_velocities(grid, cells, &guess.b, free),
        }
        if self.positive || self.aim == Aim::Slowest {
            self.add_floors(free);
        }
        let screen = Screen::about(guess.known);
        // What is free in one cell counts in its neighbours, too.
        let touched = free.start.saturating_sub(1)..(free.end + 1).min(count);
        for (index, cell) in cells.clone().enumerate().skip(touched.start).take(touched.len()) {
            let around = self.around(index, grid.length(cell));
            let rest = (index == 0 && beginning == Beginning::Rest) || index + 1 == count;
            let mut writer = Writer {
                program: &mut self.program,
                scale: &self.scale,
                middles: &guess.c,
                guess: guess.b.get(index..index + 2).unwrap_or_default(),
                asked: guess.asked.get(index).copied().unwrap_or_default(),
                free,
                screen,
                // What counts is far from the guess.
                all: self.aim == Aim::Slowest,
                index,
            };
            if index > 0 && index + 1 < count && self.aim == Aim::Fastest {
                writer.add_cap(grid, cell);
                writer.add_least();
            }
            for end in End::BOTH {
                // Where the path rests, or what it does is given, there is nothing to limit.
                let node = index + end as usize;
                if node > 0 && node < count {
                    writer.add_accelerations(grid, cell, end, &around);
                }
            }
            if rest {
                writer.add_rest(grid, cell, &around);
            } else {
                writer.add_jerks(grid, cell, &around);
            }
        }
    }

    /// b and a at the ends of a cell, and γ in it, as parts of the c of the cell before, of it and of the one after.
    fn around(&self, index: usize, length: f64) -> Around {
        let knot = |index: usize| self.knots.get(index).copied().unwrap_or_default();
        let (from, to) = (knot(index), knot(index + 1));
        let start = Place { b: [from.b[0], from.b[1], 0.0], a: [from.a[0], from.a[1], 0.0] };
        let finish = Place { b: [0.0, to.b[0], to.b[1]], a: [0.0, to.a[0], to.a[1]] };
        let gamma = [from.b[0], from.b[1] - 2.0 + to.b[0], to.b[1]];
        let gamma = gamma.map(|gamma| gamma / (length * length));
        Around { length, start, finish, gamma }
    }

    /// No c below its floor.
    fn add_floors(&mut self, free: &Range<usize>) {
        for (variable, cell) in free.clone().enumerate() {
            let constraint = Constraint::Velocity(CapSource::Stop);
            let origin = Origin { cell, constraint, upper: false, share: 0.0 };
            let least = match self.aim {
                Aim::Fastest => LEAST,
                Aim::Slowest => {
                    let floor = self.floors.get(cell).copied().unwrap_or_default();
                    floor / self.scale.get(cell).copied().unwrap_or(1.0)
                }
            };
            self.program.add_row(&[(variable, -1.0)], -least, origin);
        }
    }
}

/// Values that follow each other.
fn pairs(values: &[f64]) -> impl Iterator<Item = (f64, f64)> + '_ {
    values.iter().copied().zip(values.iter().copied().skip(1))
}

/// b (and a) at the end of a cell of length `h` that is gone through from rest with constant jerk, as a part of the c
/// of the `next` one: c = b + a·next.
fn launch(h: f64, next: f64) -> (f64, f64) {
    // With a = 1: b = 1.5·h.
    let c = 1.5 * h + next;
    (1.5 * h / c, 1.0 / c)
}
