//! A profile over a window, verified between the places where limits are asked for.

use super::Planner;
use super::guess::SLOWER;
use crate::limit::axis_path::AxisPath;
use crate::limit::convex::NotSolved;
use crate::limit::grid::Grid;
use crate::limit::reachable;
use crate::limit::sample::{Cell, grid};
use crate::limit::smooth::{Beginning, Broken, Guess, SmoothProfile};
use crate::limit::stretch::Stretch;
use crate::prepare::CheckedElement;
use std::ops::Range;

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
/// Nor are there to be so many times more of them.
const MOST_CELLS: usize = 4;

/// Cells in which jerks differ by more than this part of their limits are cut in half.
const VARIES: f64 = 0.12;
/// A change is felt for so many times the time in which acceleration builds up.
const FELT: f64 = 4.0;
/// A profile far from what it is about is solved about again, so often at most.
const MOST_SOLVES: u32 = 20;

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Solves, looks between the places where limits were asked for, and makes them tighter, or the cells shorter, where they
    /// are exceeded.
    pub(super) fn solve_verified(&mut self) -> Result<Vec<Stretch>, NotSolved> {
        self.effort.windows += 1;
        if self.jerk_limited {
            return self.solve_smooth();
        }
        let mut round = 0;
        loop {
            let grid = grid(&self.sampler, &self.cells);
            self.effort.cells += grid.cells() as u64;
            let stretches = self.solve_linear(&grid);
            if self.is_last(round, &stretches) {
                return Ok(stretches);
            }
            if self.tighten(&stretches, round, &Broken::default(), None).is_empty() {
                return Ok(stretches);
            }
            round += 1;
        }
    }

    fn solve_smooth(&mut self) -> Result<Vec<Stretch>, NotSolved> {
        let mut solved = self.solve_smooth_about(self.first_guess());
        if self.options.course.turning {
            // In sharp corners a profile about one that is much too fast may be impossible.
            for part in SLOWER {
                match &solved {
                    Ok(stretches) if can_be_followed(stretches) => return solved,
                    Ok(_) => {}
                    Err(_impossible) => self.effort.failed -= 1,
                }
                self.loosen();
                solved = self.solve_smooth_about(self.slower_guess(part));
            }
        }
        solved
    }

    fn solve_smooth_about(&mut self, mut guess: Guess) -> Result<Vec<Stretch>, NotSolved> {
        let (mut profile, mut broken) = self.settle(&mut guess)?;
        let mut round = 0;
        let most = MOST_CELLS * self.cells.len();
        loop {
            if self.cells.len() > most {
                // Shorter cells have not helped so far.
                round = round.max(HALVING);
            }
            let stretches = stretches(&grid(&self.sampler, &self.cells), &profile);
            if self.is_last(round, &stretches) {
                return Ok(stretches);
            }
            let changed = self.tighten(&stretches, round, &broken, Some(&mut guess));
            if changed.is_empty() {
                return Ok(stretches);
            }
            (profile, broken) = self.solve_again(&mut guess, &changed)?;
            round += 1;
        }
    }

    /// Whether there will be no further round; counts what is still exceeded then.
    fn is_last(&mut self, round: u32, stretches: &[Stretch]) -> bool {
        if round < ROUNDS {
            return false;
        }
        let mut cells = self.cells.iter().zip(stretches);
        if cells.any(|(cell, stretch)| exceeds(self.worst(cell, stretch))) {
            self.effort.exceeded += 1;
        }
        true
    }

    /// Solves about the solution before until that makes no difference any more.
    fn settle(&mut self, guess: &mut Guess) -> Result<(SmoothProfile, Broken), NotSolved> {
        let mut solves = 0;
        loop {
            let grid = grid(&self.sampler, &self.cells);
            let whole = 1..grid.cells().saturating_sub(1);
            let mut solved = self.solve_part(&grid, guess, whole)?;
            solves += 1;
            if solves >= self.options.solves {
                self.gains.clone_from(&solved.0.gains);
                while !guess.moved.is_empty() && solves < MOST_SOLVES {
                    let moved = std::mem::take(&mut guess.moved);
                    solved = self.solve_again(guess, &moved)?;
                    solves += 1;
                }
                return Ok(solved);
            }
            if solves == 1 {
                self.bend(&grid, guess);
            }
        }
    }

    /// Solves again about `guess` around cells that have `changed`.
    fn solve_again(
        &mut self,
        guess: &mut Guess,
        changed: &[usize],
    ) -> Result<(SmoothProfile, Broken), NotSolved> {
        let grid = grid(&self.sampler, &self.cells);
        let parts = self.around(&grid, guess, changed);
        let whole = 1..grid.cells().saturating_sub(1);
        let mut all_broken = Broken::default();
        let (mut result, mut moved) = (None, Vec::new());
        if 2 * parts.iter().map(Range::len).sum::<usize>() < whole.len() {
            for part in parts {
                let Ok((profile, broken)) = self.solve_part(&grid, guess, part.clone()) else {
                    // Between given ends there may be none.
                    self.effort.failed -= 1;
                    result = None;
                    break;
                };
                self.gains.retain(|gain| !part.contains(&gain.cell));
                self.gains.extend_from_slice(&profile.gains);
                all_broken.extend(broken);
                moved.append(&mut guess.moved);
                result = Some(profile);
            }
        }
        if let Some(profile) = result {
            guess.moved = moved;
            return Ok((profile, all_broken));
        }
        let (profile, broken) = self.solve_part(&grid, guess, whole)?;
        self.gains.clone_from(&profile.gains);
        Ok((profile, broken))
    }

    /// Solves once about `guess`, with the cells `free` of all.
    fn solve_part(
        &mut self,
        grid: &Grid,
        guess: &mut Guess,
        free: Range<usize>,
    ) -> Result<(SmoothProfile, Broken), NotSolved> {
        self.effort.cells += free.len() as u64;
        let solved = self.smooth.solve_about(grid, 0..grid.cells(), self.beginning, guess, free);
        let (profile, broken) = solved.inspect_err(|_| self.effort.failed += 1)?;
        self.effort.iterations += u64::from(profile.iterations);
        Ok((profile, broken))
    }

    /// Parts of the window around these cells, as far as a change there makes itself felt.
    fn around(&self, grid: &Grid, guess: &Guess, changed: &[usize]) -> Vec<Range<usize>> {
        let time = FELT * self.build_up();
        let takes = |cell: usize| {
            let motion = guess.motion(cell, grid.length(cell));
            motion.map_or(f64::INFINITY, |motion| motion.duration)
        };
        let last = grid.cells().saturating_sub(1);
        let mut parts: Vec<Range<usize>> = Vec::new();
        for cell in changed {
            let (mut from, mut left) = (*cell, time);
            while from > 1 && left > 0.0 {
                from -= 1;
                left -= takes(from);
            }
            let (mut to, mut left) = (cell + 1, time);
            while to < last && left > 0.0 {
                left -= takes(to);
                to += 1;
            }
            let from = from.max(1);
            match parts.last_mut() {
                Some(part) if from <= part.end + 2 => part.end = to.max(part.end),
                _ => parts.push(from..to.min(last)),
            }
        }
        parts
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
    /// more places, and in the first rounds cells are cut in half where they are exceeded by much. Those cells, by their new
    /// numbers; `guess` is fitted to the new ones.
    fn tighten(
        &mut self,
        stretches: &[Stretch],
        round: u32,
        broken: &Broken,
        mut guess: Option<&mut Guess>,
    ) -> Vec<usize> {
        let fresh = self.kept.len().saturating_sub(1);
        let mut cells = Vec::with_capacity(self.cells.len());
        let mut changed = Vec::new();
        let known = std::mem::take(&mut self.cells);
        let last = known.len().saturating_sub(1);
        for (index, (mut cell, stretch)) in known.into_iter().zip(stretches).enumerate() {
            let worst = self.worst(&cell, stretch);
            if !exceeds(worst) {
                cells.push(cell);
                continue;
            }
            // What was planned before stays on its nodes.
            let too_long = worst.iter().zip(ALLOWED).any(|(worst, [_, far])| *worst > far);
            let rest = self.jerk_limited && (index == 0 || index == last);
            let halve = round < HALVING && index >= fresh && too_long && !rest;
            if halve && stretch.duration() > 4.0 * SHORT {
                cell.tight = [1.0; 3];
                if let Ok(parts) = self.sampler.parts(&cell, &[0.5])
                    && parts.len() == 2
                {
                    if let Some(guess) = guess.as_deref_mut() {
                        guess.halve(cells.len());
                    }
                    changed.extend([cells.len(), cells.len() + 1]);
                    cells.extend(parts);
                    continue;
                }
            }
            changed.push(cells.len());
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
        changed
    }

    /// The largest acceleration, jerk and velocity in a cell as parts of the limits.
    fn worst(&self, cell: &Cell, stretch: &Stretch) -> [f64; 3] {
        let mut worst = [0.0_f64; 3];
        let limits = self.sampler.axes().limits();
        // What jerk limits have smoothed is not so far from the places where it is known.
        let smooth = self.jerk_limited && !self.options.course.turning;
        let eighths = (0..=8_u8).step_by(if smooth { 2 } else { 1 });
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

/// Whether a profile does not have to go backwards in between.
pub(super) fn can_be_followed(stretches: &[Stretch]) -> bool {
    stretches.iter().all(|stretch| stretch.duration().is_finite())
}

/// Whether something in a cell is more than it may be.
fn exceeds(worst: [f64; 3]) -> bool {
    worst.iter().zip(ALLOWED).any(|(worst, [allowed, _])| *worst > allowed)
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
