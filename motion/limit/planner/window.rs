//! A profile over a window, verified between the places where limits are asked for.

use super::Planner;
use crate::limit::axis_path::AxisPath;
use crate::limit::convex::NotSolved;
use crate::limit::grid::Grid;
use crate::limit::reachable;
use crate::limit::sample::{Cell, grid};
use crate::limit::smooth::{Beginning, Broken, Guess, SmoothProfile};
use crate::limit::stretch::Stretch;
use crate::prepare::CheckedElement;

/// Acceleration, jerk and velocity between the places where limits are asked for may be so much of the limit; a cell in which
/// they are more than the second number is too long.
const ALLOWED: [[f64; 2]; 3] = [[1.0005, 1.01], [1.045, 1.2], [1.0005, 1.01]];
/// Where the jerk is in what [`Planner::worst`] gives.
const JERK: usize = 1;
/// Cells that take less time, s, are too short to tell a jerk.
const SHORT: f64 = 2e-5;
/// Windows are solved again at most so often, and cells cut in half at most in so many of these rounds: a shorter cell gives
/// the profile more freedom, which it may use to exceed limits somewhere else.
const ROUNDS: u32 = 12;
const HALVING: u32 = 6;
/// Nor are there so many times more of them.
const MOST_CELLS: usize = 4;

/// Cells in which jerks differ by more than this part of their limits are cut in half.
const VARIES: f64 = 0.12;
/// A profile that takes less than the one that it is about by more than this part is solved about again, so often at most.
const SETTLED: f64 = 1e-3;
const MOST_SOLVES: u32 = 8;

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Solves, looks between the places where limits were asked for, and makes them tighter, or the cells shorter, where they
    /// are exceeded.
    pub(super) fn solve_verified(&mut self) -> Result<Vec<Stretch>, NotSolved> {
        self.effort.windows += 1;
        let mut guess = self.jerk_limited.then(|| self.first_guess());
        let mut broken = Broken::default();
        let (mut round, mut solves, mut before) = (0, 0, 0.0);
        let most = MOST_CELLS * self.cells.len();
        loop {
            let grid = grid(&self.sampler, &self.cells);
            self.effort.cells += grid.cells() as u64;
            let stretches = match &mut guess {
                None => self.solve_linear(&grid),
                Some(guess) => {
                    let profile =
                        self.smooth.solve_about(&grid, 0..grid.cells(), self.beginning, guess);
                    let (profile, left_out) = profile.inspect_err(|_| self.effort.failed += 1)?;
                    self.effort.iterations += u64::from(profile.iterations);
                    let takes = duration(&grid, &profile.b);
                    let settled = takes > before * (1.0 - SETTLED);
                    before = takes;
                    solves += 1;
                    if solves < self.options.solves || !settled && solves < MOST_SOLVES {
                        if solves == 1 {
                            self.bend(&grid, guess);
                        }
                        continue;
                    }
                    broken = left_out;
                    self.gains.clone_from(&profile.gains);
                    stretches(&grid, &profile)
                }
            };
            if round == ROUNDS {
                let mut cells = self.cells.iter().zip(&stretches);
                if cells.any(|(cell, stretch)| exceeds(self.worst(cell, stretch))) {
                    self.effort.exceeded += 1;
                }
                return Ok(stretches);
            }
            let halving = round < HALVING && self.cells.len() < most;
            if !self.tighten(&stretches, halving, &broken, guess.as_mut()) {
                return Ok(stretches);
            }
            round += 1;
        }
    }

    /// What a window with limited jerk is solved about at first.
    fn first_guess(&self) -> Guess {
        let mut guess = self.estimate(&grid(&self.sampler, &self.cells)).0;
        for (guess, kept) in guess.iter_mut().zip(&self.kept) {
            *guess = *kept;
        }
        Guess::rough(guess)
    }

    /// Cuts cells in half in which jerks would differ too much from place to place.
    fn bend(&mut self, grid: &Grid, guess: &mut Guess) {
        let fresh = self.kept.len().saturating_sub(1);
        let mut cells = Vec::with_capacity(self.cells.len());
        let last = grid.cells().saturating_sub(1);
        for (index, cell) in std::mem::take(&mut self.cells).into_iter().enumerate() {
            let place = cells.len();
            let rest = index == last || index == 0;
            if !rest
                && index >= fresh
                && let Some(motion) = guess.motion(place, grid.length(index))
                && motion.duration > 4.0 * SHORT
                && grid.varies(index, &motion.ends) > VARIES
                && let Ok(parts) = self.sampler.parts(&cell, &[0.5])
                && parts.len() == 2
            {
                guess.halve(place);
                cells.extend(parts);
            } else {
                cells.push(cell);
            }
        }
        self.cells = cells;
    }

    /// How each cell is gone through where no jerk is limited.
    fn solve_linear(&mut self, grid: &Grid) -> Vec<Stretch> {
        let cells = 0..grid.cells();
        let start = match self.beginning {
            Beginning::Rest => 0.0,
            Beginning::Moving { b, .. } => b,
        };
        let b = match self.linear.solve(grid, cells.clone(), start, 0.0) {
            Ok(profile) => {
                self.effort.iterations += u64::from(profile.iterations);
                self.gains = profile.gains;
                profile.b
            }
            Err(_failed) => {
                self.effort.failed += 1;
                reachable::fastest(grid, cells.clone(), start, 0.0)
            }
        };
        let ends = b.iter().zip(b.iter().skip(1));
        cells
            .zip(ends)
            .map(|(cell, (from, to))| Stretch::uniform(grid.length(cell), *from, *to))
            .collect()
    }

    /// Looks between the places where limits were asked for. Where they are exceeded, limits are made tighter, or asked for at
    /// more places, and with `halving` cells are cut in half where they are exceeded by much. Whether there are any such
    /// cells; `guess` is fitted to the new ones.
    fn tighten(
        &mut self,
        stretches: &[Stretch],
        halving: bool,
        broken: &Broken,
        mut guess: Option<&mut Guess>,
    ) -> bool {
        let fresh = self.kept.len().saturating_sub(1);
        let mut cells = Vec::with_capacity(self.cells.len());
        let mut any = false;
        let known = std::mem::take(&mut self.cells);
        let last = known.len().saturating_sub(1);
        for (index, (mut cell, stretch)) in known.into_iter().zip(stretches).enumerate() {
            let worst = self.worst(&cell, stretch);
            if !exceeds(worst) {
                cells.push(cell);
                continue;
            }
            any = true;
            // What was planned before stays on its nodes.
            let too_long = worst.iter().zip(ALLOWED).any(|(worst, [_, far])| *worst > far);
            let rest = self.jerk_limited && (index == 0 || index == last);
            let halve = halving && index >= fresh && too_long && !rest;
            if halve && stretch.duration() > 4.0 * SHORT {
                cell.tight = [1.0; 3];
                if let Ok(parts) = self.sampler.parts(&cell, &[0.5])
                    && parts.len() == 2
                {
                    if let Some(guess) = guess.as_deref_mut() {
                        guess.halve(cells.len());
                    }
                    cells.extend(parts);
                    continue;
                }
            }
            for (kind, (worst, [allowed, _])) in worst.into_iter().zip(ALLOWED).enumerate() {
                if worst <= allowed {
                    continue;
                }
                if kind == JERK && broken.jerk(index) {
                    // A row of it was left out, and will not be the next time.
                } else if kind == JERK && !cell.dense {
                    cell.dense = true;
                } else if let Some(tight) = cell.tight.get_mut(kind) {
                    *tight *= (worst / (1.0 + 0.5 * (allowed - 1.0))).min(2.0);
                }
            }
            cells.push(cell);
        }
        self.cells = cells;
        any
    }

    /// The largest acceleration, jerk and velocity in a cell as parts of the limits.
    fn worst(&self, cell: &Cell, stretch: &Stretch) -> [f64; 3] {
        let mut worst = [0.0_f64; 3];
        let limits = self.sampler.axes().limits();
        // What jerk limits have smoothed is not so far from the places where it is known.
        let eighths = (0..=8_u8).step_by(if self.jerk_limited { 2 } else { 1 });
        for eighth in eighths {
            let u = 0.125 * f64::from(eighth) * cell.length();
            let sample = match eighth {
                0 => cell.start,
                4 => cell.middle,
                8 => cell.end,
                _ => {
                    let s = cell.from + u;
                    let Ok(sample) = self.sampler.sample(&cell.element, s, &cell.start.position)
                    else {
                        continue;
                    };
                    sample
                }
            };
            let excess = sample.excess(limits, stretch, u);
            for (worst, excess) in worst.iter_mut().zip(excess) {
                *worst = worst.max(excess);
            }
        }
        if stretch.duration() < SHORT {
            worst[JERK] = 0.0;
        }
        worst
    }
}

/// Whether something in a cell is more than it may be.
fn exceeds(worst: [f64; 3]) -> bool {
    worst.iter().zip(ALLOWED).any(|(worst, [allowed, _])| *worst > allowed)
}

/// About how long it takes to go through the cells of `grid` with these b at its nodes, s.
fn duration(grid: &Grid, b: &[f64]) -> f64 {
    let ends = b.iter().zip(b.iter().skip(1)).enumerate();
    ends.map(|(cell, (from, to))| 2.0 * grid.length(cell) / (from.sqrt() + to.sqrt())).sum()
}

/// How each cell is gone through.
fn stretches(grid: &Grid, profile: &SmoothProfile) -> Vec<Stretch> {
    let last = grid.cells().saturating_sub(1);
    let ends = profile.b.iter().zip(profile.b.iter().skip(1)).zip(&profile.a);
    let stretch = |(cell, ((from, to), a)): (usize, ((&f64, &f64), &f64))| {
        let length = grid.length(cell);
        if cell == 0 && profile.beginning == Beginning::Rest {
            Stretch::launch(length, *to)
        } else if cell == last {
            Stretch::landing(length, *from)
        } else {
            Stretch::bent(length, *from, from + a * length, *to)
        }
    };
    ends.enumerate().map(stretch).collect()
}
