//! The fastest profile with limited jerk as a convex program.
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
//! and in a cell γ = b″/2 = (bᵢ − 2·cᵢ + bᵢ₊₁)/hᵢ² is constant. So a = ü is continuous, and what the program decides is
//! what the interpolator will follow.
//!
//! Where the path starts from rest, its first cell is gone through with constant jerk j: u = j·t³/6, which is
//! b = ¼·j^⅔·(6u)^4/3. Value and slope at its end, j^⅔·(6h)^4/3/4 and j^⅔·(6h)^⅓, are both proportional to j^⅔, so that the
//! cell adds nothing to the program but that the next node's value is a part of the next c. The same holds, mirrored,
//! for the last cell of a path that ends at rest.
//!
//! # The program
//!
//! Limits of acceleration are linear in b and a. A limit of jerk, ±(q‴·b + 3·q″·a + q′·γ) ≤ J/√b, is convex but for its
//! right side, and there the tangent about a guess b̄ lies below: J/√b ≥ J·(3 − b/b̄)/(2·√b̄). So every solution keeps the
//! limit, and solving again about it is never worse. The duration Σ wₖ/√bₖ, wₖ half the length of the two cells beside
//! a node, is taken to second order about b̄. Variables are cᵢ/c̄ᵢ.

use super::convex::{NotSolved, Program};
use super::grid::{End, Grid, JerkRow, Row};
use std::ops::Range;

/// Rows less active than this at the guess are left out at first.
const SCREEN: f64 = 0.3;
/// The next guess is not below this part of the one before.
const FLOOR: f64 = 0.05;
/// Cells that take less time, s, are too short to tell a jerk: their coefficients would drown in rounding.
const LEAST_TIME: f64 = 2e-5;
/// Where the velocity varies within a cell, so does the jerk: at its ends it may be larger than in its middle, by this
/// part of the limit.
const AT_ENDS: f64 = 0.04;

/// How a profile begins.
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
    /// How it begins.
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
    program: Program,
    knots: Vec<Knot>,
    /// c of the first cell, if it is given; the scale of the others.
    scale: Vec<f64>,
    /// Guess of b at the nodes.
    guess: Vec<f64>,
}

impl SmoothSolver {
    /// The fastest profile over `cells` (at least 3), from `beginning` to rest, about the profile `guess` of b at the nodes, which must
    /// be positive at all inner ones. Solves as often as told, each time about the solution before.
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
        self.guess.clear();
        self.guess.extend_from_slice(guess);
        self.set_knots(grid, &cells, beginning);
        let mut iterations = 0;
        let mut profile = None;
        for _ in 0..solves.max(1) {
            self.set_scale(grid, &cells, beginning);
            self.build(grid, &cells, beginning);
            let answer = self.program.solve_all(1e-7)?;
            iterations += answer.iterations;
            let (b, a) = self.values(&cells, beginning, &answer.x);
            // A profile that all but rests says little about the next.
            for (guess, b) in self.guess.iter_mut().zip(&b) {
                *guess = b.max(FLOOR * *guess);
            }
            profile = Some((b, a));
        }
        let (b, a) = profile.unwrap_or_default();
        Ok(SmoothProfile { beginning, b, a, iterations, solves, rows: self.program.rows() })
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

    fn set_scale(&mut self, grid: &Grid, cells: &Range<usize>, beginning: Beginning) {
        self.scale.clear();
        self.scale.extend(self.guess.windows(2).map(|pair| match pair {
            [from, to] => 0.5 * (from + to),
            _ => 1.0,
        }));
        if let (Beginning::Moving { b, a }, Some(first)) = (beginning, self.scale.first_mut()) {
            *first = b + a * grid.length(cells.start);
        }
    }

    /// b and a at all nodes for a solution.
    fn values(
        &self,
        cells: &Range<usize>,
        beginning: Beginning,
        x: &[f64],
    ) -> (Vec<f64>, Vec<f64>) {
        let mut c = self.scale.clone();
        for (slot, x) in c.iter_mut().skip(1).zip(x) {
            *slot *= x;
        }
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

    fn build(&mut self, grid: &Grid, cells: &Range<usize>, beginning: Beginning) {
        let count = cells.len();
        let variables = count.saturating_sub(2);
        self.program.reset(variables);
        self.add_costs(grid, cells);
        let fixed = match beginning {
            Beginning::Rest => 0.0,
            Beginning::Moving { .. } => self.scale.first().copied().unwrap_or_default(),
        };
        let writer = Writer { scale: &self.scale, variables, fixed };
        for (index, cell) in cells.clone().enumerate() {
            let h = grid.length(cell);
            let around = self.around(index);
            let inner = index > 0 && index + 1 < count;
            if inner {
                let [from, to] = grid.cell_caps(cell).map(|cap| cap.v2);
                writer.add(&mut self.program, index, [0.0, 1.0, 0.0], 0.5 * (from + to), -1.0);
            }
            let rest = (index == 0 && beginning == Beginning::Rest) || index + 1 == count;
            for end in End::BOTH {
                let place = match end {
                    End::Start => around.start,
                    End::Finish => around.finish,
                };
                // Where the path rests there is nothing to limit.
                let node = index + end as usize;
                if node == count || (node == 0 && beginning == Beginning::Rest) {
                    continue;
                }
                if end == End::Finish && node < count {
                    // Between cells of different limits it is the lower one that counts, which c alone does not keep.
                    let cap = grid.caps().get(cell + 1).map_or(f64::INFINITY, |cap| cap.v2);
                    let beside = [grid.cell_caps(cell), grid.cell_caps(cell + 1)];
                    let mean = beside.map(|[from, to]| 0.5 * (from.v2 + to.v2));
                    if cap < mean[0].max(mean[1]) * (1.0 - 1e-6) {
                        writer.add(&mut self.program, index, place.b, cap, SCREEN);
                    }
                }
                if node > 0 {
                    let (axes, further) = grid.rows(cell, end);
                    for row in axes {
                        let line = place.acceleration(row);
                        writer.add(&mut self.program, index, line, 1.0, SCREEN);
                        writer.add(&mut self.program, index, line.map(|x| -x), 1.0, SCREEN);
                    }
                    for row in further {
                        writer.add(&mut self.program, index, place.acceleration(row), 1.0, SCREEN);
                    }
                }
                if rest {
                    // b ∝ u^4/3.
                    let gamma = place.b.map(|b| b * 2.0 / 9.0 / (h * h));
                    for row in grid.jerks(cell, end) {
                        // One variable, so that the true limit can be given.
                        writer.add_rest(&mut self.program, index, place.jerk(row, gamma), place.b);
                    }
                }
            }
            if rest {
                continue;
            }
            let gamma = around.gamma.map(|g| g / (h * h));
            let middle = around.middle();
            let guess = match self.guess.get(index..index + 2) {
                Some([from, to]) => {
                    0.5 * self.scale.get(index).copied().unwrap_or_default() + 0.25 * (from + to)
                }
                _ => 1.0,
            };
            // A cell that is over at once may change the acceleration by as much as one of the least time.
            let takes = h / guess.sqrt();
            let share = (takes / LEAST_TIME).min(1.0);
            let rows = grid.jerks(cell, End::Start).iter().zip(grid.jerks(cell, End::Finish));
            for (from, to) in rows {
                let line = middle.jerk(&from.between(to), gamma).map(|x| x * share);
                writer.add_jerk(&mut self.program, index, line, middle.b, guess);
            }
            // Where the velocity varies by more than the ends may take.
            for (end, place) in [(End::Start, around.start), (End::Finish, around.finish)] {
                let at_end = self.guess.get(index + end as usize).copied().unwrap_or_default();
                if at_end > guess * (1.0 + AT_ENDS) {
                    for row in grid.jerks(cell, end) {
                        let line = place.jerk(row, gamma).map(|x| x / (1.0 + AT_ENDS));
                        writer.add_jerk(&mut self.program, index, line, place.b, at_end);
                    }
                }
            }
        }
    }

    /// b and a at the ends of a cell, and h²·γ in it, as parts of the c of the cell before, of it and of the one after.
    fn around(&self, index: usize) -> Around {
        let knot = |index: usize| self.knots.get(index).copied().unwrap_or_default();
        let (from, to) = (knot(index), knot(index + 1));
        let start = Place { b: [from.b[0], from.b[1], 0.0], a: [from.a[0], from.a[1], 0.0] };
        let finish = Place { b: [0.0, to.b[0], to.b[1]], a: [0.0, to.a[0], to.a[1]] };
        let gamma = [from.b[0], from.b[1] - 2.0 + to.b[0], to.b[1]];
        Around { start, finish, gamma }
    }

    fn add_costs(&mut self, grid: &Grid, cells: &Range<usize>) {
        let variables = cells.len().saturating_sub(2);
        let nodes = self.knots.iter().zip(&self.guess).zip(cells.clone()).enumerate().skip(1);
        for (index, ((knot, guess), cell)) in nodes {
            let weight = 0.5 * (grid.length(cell - 1) + grid.length(cell));
            // w/√b to second order about the guess.
            let (first, second) = (
                -0.5 * weight / (guess * guess.sqrt()),
                0.75 * weight / (guess * guess * guess.sqrt()),
            );
            let scale = |cell: usize| self.scale.get(cell).copied().unwrap_or_default();
            let (p, r) = (knot.b[0] * scale(index - 1), knot.b[1] * scale(index));
            let linear = first - second * guess;
            let given = index == 1;
            if !given && p != 0.0 {
                self.program.add_cost(index - 2, second * p * p, linear * p);
            }
            if index <= variables && r != 0.0 {
                let extra = if given { second * p } else { 0.0 };
                self.program.add_cost(index - 1, second * r * r, (linear + extra) * r);
                if !given {
                    self.program.add_coupling(index - 2, second * p * r);
                }
            }
        }
    }
}

/// b (and a) at the end of a cell of length `h` that is gone through from rest with constant jerk, as a part of the c
/// of the `next` one: c = b + a·next.
fn launch(h: f64, next: f64) -> (f64, f64) {
    // With a = 1: b = 1.5·h.
    let c = 1.5 * h + next;
    (1.5 * h / c, 1.0 / c)
}

#[derive(Clone, Copy, Debug)]
struct Around {
    start: Place,
    finish: Place,
    gamma: [f64; 3],
}

#[derive(Clone, Copy, Debug)]
struct Place {
    b: [f64; 3],
    a: [f64; 3],
}

impl Around {
    /// In the middle of the cell.
    fn middle(&self) -> Place {
        let mut place = Place { b: [0.0, 0.5, 0.0], a: [0.0; 3] };
        for end in [&self.start, &self.finish] {
            for (slot, b) in place.b.iter_mut().zip(end.b) {
                *slot += 0.25 * b;
            }
            for (slot, a) in place.a.iter_mut().zip(end.a) {
                *slot += 0.5 * a;
            }
        }
        place
    }
}

impl Place {
    fn acceleration(&self, row: &Row) -> [f64; 3] {
        let mut line = [0.0; 3];
        for ((slot, a), b) in line.iter_mut().zip(self.a).zip(self.b) {
            *slot = row.a * a + row.b * b;
        }
        line
    }

    fn jerk(&self, row: &JerkRow, gamma: [f64; 3]) -> [f64; 3] {
        let mut line = [0.0; 3];
        for (((slot, a), b), gamma) in line.iter_mut().zip(self.a).zip(self.b).zip(gamma) {
            *slot = row.third * b + 3.0 * row.second * a + row.first * gamma;
        }
        line
    }
}

/// Writes rows around a cell in terms of the program's variables.
#[derive(Debug)]
struct Writer<'s> {
    scale: &'s [f64],
    variables: usize,
    /// c of the first cell, if it is given.
    fixed: f64,
}

impl Writer<'_> {
    /// Adds the row Σ `line`·c ≤ `right` around the cell `index`, unless it is less active than `screen` at the guess.
    fn add(&self, program: &mut Program, index: usize, line: [f64; 3], right: f64, screen: f64) {
        let mut entries = [(0, 0.0); 3];
        let (mut sum, mut free) = (0.0, right);
        for (offset, (slot, value)) in entries.iter_mut().zip(line).enumerate() {
            // The cell of this entry is index + offset − 1; variables begin with cell 1.
            let Some(cell) = (index + offset).checked_sub(1) else { continue };
            if cell == 0 {
                free -= value * self.fixed;
                sum += value * self.fixed;
            } else if cell <= self.variables {
                let value = value * self.scale.get(cell).copied().unwrap_or_default();
                *slot = (cell - 1, value);
                sum += value;
            }
        }
        // Every right side is 1, where that is possible.
        let (scale, to) =
            if free > 1e-3 * right { (1.0 / free, 1.0) } else { (1.0 / right, free / right) };
        let entries = entries.map(|(index, value)| (index, value * scale));
        let most: f64 = entries.iter().map(|(_, value)| value.abs()).sum();
        if sum >= screen * right {
            program.add_row(&entries, to);
        } else if most > 0.5 * to {
            program.add_spare(entries, to);
        }
    }

    /// Adds |line·c|·√(b·c) ≤ 1 with its tangent about b = `guess`.
    fn add_jerk(
        &self,
        program: &mut Program,
        index: usize,
        line: [f64; 3],
        b: [f64; 3],
        guess: f64,
    ) {
        let (of_line, of_b) = (guess.sqrt() / 1.5, 1.0 / (3.0 * guess));
        for sign in [1.0, -1.0] {
            let mut entries = line.map(|x| sign * of_line * x);
            for (entry, b) in entries.iter_mut().zip(b) {
                *entry += of_b * b;
            }
            self.add(program, index, entries, 1.0, SCREEN);
        }
    }

    /// Adds the jerk limit in a cell that begins or ends at rest: |line·c|·√(b·c) ≤ 1 in the one c that counts.
    fn add_rest(&self, program: &mut Program, index: usize, line: [f64; 3], b: [f64; 3]) {
        for (offset, (line, b)) in line.into_iter().zip(b).enumerate() {
            let Some(cell) = (index + offset).checked_sub(1) else { continue };
            let jerk = line.abs() * b.max(0.0).sqrt();
            if jerk > 0.0 && cell >= 1 && cell <= self.variables {
                let most = jerk.powf(-2.0 / 3.0);
                let scale = self.scale.get(cell).copied().unwrap_or_default();
                if scale > SCREEN * most {
                    program.add_row(&[(cell - 1, scale / most)], 1.0);
                }
            }
        }
    }
}
