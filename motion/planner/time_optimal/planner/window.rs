//! Window solve: a profile over a window, verified between the nodes of its grid.

use super::drag::MOST_TANGENTS;
use super::even::MOST_CUTS;
use super::guess::{ROOM, SLOWER};
use super::verify::{HALVING, exceeds, is_too_long};
use super::{NOT_SOLVED, Planner};
use crate::planned_motion::ProfileSegment;
use crate::time_optimal::adjoint;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::convex::NotSolved;
use crate::time_optimal::grid::Grid;
use crate::time_optimal::reachable;
use crate::time_optimal::sample::grid;
use crate::time_optimal::smooth::{Beginning, Broken, Guess, SmoothProfile};
use std::ops::Range;
use twin_path::prepare::CheckedElement;

/// Largest number of solves of a window.
const ROUNDS: u32 = 16;
/// Largest growth of the number of cells by cutting.
const MOST_CELLS: usize = 4;

/// A change is felt for so many times the time in which acceleration builds up: mostly, and where between the ends of that
/// there is no profile.
const FELT: [f64; 2] = [2.0, 4.0];
/// A profile far from what it is about is solved about again, so often at most.
const MOST_SOLVES: u32 = 20;

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Solves, looks between the places where limits were asked for, and makes them tighter, or the cells shorter, where they
    /// are exceeded.
    pub(super) fn solve_verified(&mut self) -> Result<Vec<ProfileSegment>, NotSolved> {
        self.effort.windows += 1;
        if self.jerk_limited {
            return self.solve_smooth();
        }
        let (mut round, mut tangents, mut cuts) = (0, 0, 0);
        loop {
            if self.budget.is_spent() {
                return Err(NOT_SOLVED);
            }
            let grid = grid(&self.sampler, &self.cells);
            self.effort.cells += grid.cells() as u64;
            self.budget.looked(grid.cells());
            let b = reachable::fastest(&grid, 0..grid.cells(), self.start(), 0.0);
            let stretches = uniform(&grid, &b);
            if cuts < MOST_CUTS && self.even_out(&stretches) {
                cuts += 1;
                continue;
            }
            if tangents < MOST_TANGENTS && !self.take_tangents(&stretches).is_empty() {
                tangents += 1;
                continue;
            }
            if self.is_last(round, &stretches)
                || self.tighten(&stretches, (0, round), &Broken::default(), None).is_empty()
            {
                self.gains = adjoint::sensitivities(&grid, &b);
                return Ok(stretches);
            }
            round += 1;
        }
    }

    fn solve_smooth(&mut self) -> Result<Vec<ProfileSegment>, NotSolved> {
        let failed = self.effort.failed;
        let asked = self.asked_of_kept();
        let mut solved = self.solve_smooth_about(self.first_guess());
        // In sharp corners a profile about one that is much too fast may be impossible. Where work is counted there are other
        // ways, but for tools that turn.
        let more = self.options.course.turning || !self.smooth.positive;
        for part in SLOWER.into_iter().filter(|_| more) {
            match &solved {
                Ok(stretches) if can_be_followed(stretches) => return solved,
                Err(_unknown) if self.budget.is_spent() => return solved,
                Ok(_) => {}
                Err(_impossible) => self.effort.failed = failed,
            }
            self.ask_of_kept(&asked);
            self.loosen(asked.len(), ROOM);
            solved = self.solve_smooth_about(self.slower_guess(part));
        }
        let followed = solved.as_ref().is_ok_and(|stretches| can_be_followed(stretches));
        if !followed
            && !self.budget.is_spent()
            && let Some(slowed) = self.slowed()
        {
            self.effort.failed = failed + 1;
            self.gains.clear();
            return Ok(slowed);
        }
        solved
    }

    fn solve_smooth_about(&mut self, mut guess: Guess) -> Result<Vec<ProfileSegment>, NotSolved> {
        self.solve_whole(&mut guess)?;
        self.subdivide(&mut guess);
        self.bend(&mut guess);
        let failed = self.effort.failed;
        let mut solved = self.solve_whole(&mut guess);
        if solved.is_err() && !self.budget.is_spent() {
            // About what a coarse grid allows, or what does not keep all limits, there may be nothing on this one.
            self.effort.failed = failed;
            guess = self.first_guess();
            guess.ask_all();
            self.solve_whole(&mut guess)?;
            solved = self.solve_whole(&mut guess);
        }
        let (mut profile, mut broken) = solved?;
        let asked = self.asked_of_kept();
        // From here on limits are made tighter.
        let mut first = 0;
        let (mut round, mut solves, mut tangents) = (0, 2, 0);
        let most = MOST_CELLS * self.cells.len();
        loop {
            if self.cells.len() > most {
                // Shorter cells have not helped so far.
                round = round.max(HALVING);
            }
            let stretches = stretches(&grid(&self.sampler, &self.cells), &profile);
            if tangents < MOST_TANGENTS {
                let mut changed = self.take_tangents(&stretches);
                if !changed.is_empty() {
                    tangents += 1;
                    let before = (guess.clone(), self.effort.failed);
                    changed.append(&mut guess.moved);
                    changed.sort_unstable();
                    match self.solve_again(&mut guess, changed) {
                        Ok(solved) => (profile, broken) = solved,
                        Err(_failed) => {
                            // What there is keeps the limits.
                            (guess, self.effort.failed) = before;
                            tangents = MOST_TANGENTS;
                        }
                    }
                    continue;
                }
            }
            if self.is_last(round, &stretches) {
                return Ok(stretches);
            }
            if solves >= MOST_SOLVES {
                guess.moved.clear();
            }
            let known = self.cells.clone();
            let mut changed = self.tighten(&stretches, (first, round), &broken, Some(&mut guess));
            round += u32::from(!changed.is_empty());
            changed.append(&mut guess.moved);
            changed.sort_unstable();
            if changed.is_empty() {
                if first > 0 {
                    self.count_exceeded(&stretches);
                }
                return Ok(stretches);
            }
            let failed = self.effort.failed;
            let mut solved = self.solve_again(&mut guess, changed);
            if solved.is_err() && first < asked.len() && !self.budget.is_spent() {
                // With tighter limits there may be no way on from where the window begins. With those there were the plan so far
                // is one.
                self.effort.failed = failed;
                self.ask_of_kept(&asked);
                first = asked.len();
                guess.ask_all();
                solved = self.solve_whole(&mut guess);
            }
            (profile, broken) = match solved {
                Ok(solved) => solved,
                Err(error) => {
                    // That which exceeds them by a little between the places where they are asked for is better than none.
                    self.cells = known;
                    if !self.are_nearly_kept(&stretches) {
                        return Err(error);
                    }
                    self.effort.failed = failed;
                    self.count_exceeded(&stretches);
                    return Ok(stretches);
                }
            };
            solves += 1;
        }
    }

    /// True if there will be no further round; counts what is still exceeded then.
    fn is_last(&mut self, round: u32, stretches: &[ProfileSegment]) -> bool {
        if round >= ROUNDS {
            self.count_exceeded(stretches);
        }
        round >= ROUNDS
    }

    /// True if nothing is so much more than it may be that cells are too long.
    fn are_nearly_kept(&self, stretches: &[ProfileSegment]) -> bool {
        let mut cells = self.cells.iter().zip(stretches);
        cells.all(|(cell, stretch)| !is_too_long(self.worst(cell, stretch)))
    }

    /// Counts the window if something in it is more than it may be.
    fn count_exceeded(&mut self, stretches: &[ProfileSegment]) {
        let fresh = self.kept.len().saturating_sub(1);
        let mut cells = self.cells.iter().zip(stretches).enumerate();
        if cells.any(|(index, (cell, stretch))| exceeds(self.worst(cell, stretch), index < fresh)) {
            self.effort.exceeded += 1;
        }
    }

    /// Solves about `guess`, with all cells free.
    fn solve_whole(&mut self, guess: &mut Guess) -> Result<(SmoothProfile, Broken), NotSolved> {
        let grid = grid(&self.sampler, &self.cells);
        let (profile, broken) = self.solve_part(&grid, guess, 1..grid.cells().saturating_sub(1))?;
        self.gains.clone_from(&profile.gains);
        Ok((profile, broken))
    }

    /// Solves again about `guess` around cells that have `changed`, in their order.
    fn solve_again(
        &mut self,
        guess: &mut Guess,
        mut changed: Vec<usize>,
    ) -> Result<(SmoothProfile, Broken), NotSolved> {
        let grid = grid(&self.sampler, &self.cells);
        let (mut all_broken, mut moved) = (Broken::default(), Vec::new());
        for felt in FELT {
            let parts = self.around(&grid, guess, &changed, felt);
            if 2 * parts.iter().map(Range::len).sum::<usize>() >= grid.cells() {
                break;
            }
            let (mut result, mut failed) = (None, Vec::new());
            for part in parts {
                let failed_before = self.effort.failed;
                let Ok((profile, broken)) = self.solve_part(&grid, guess, part.clone()) else {
                    // Between given ends there may be none.
                    self.effort.failed = failed_before;
                    failed.extend(changed.iter().filter(|cell| part.contains(cell)));
                    continue;
                };
                self.gains.retain(|gain| !part.contains(&gain.cell));
                self.gains.extend_from_slice(&profile.gains);
                all_broken.extend(broken);
                moved.append(&mut guess.moved);
                result = Some(profile);
            }
            if let Some(profile) = result.filter(|_| failed.is_empty()) {
                guess.moved = moved;
                return Ok((profile, all_broken));
            }
            changed = failed;
        }
        self.solve_whole(guess)
    }

    /// Solves once about `guess`, with the cells `free` of all.
    fn solve_part(
        &mut self,
        grid: &Grid,
        guess: &mut Guess,
        free: Range<usize>,
    ) -> Result<(SmoothProfile, Broken), NotSolved> {
        self.effort.cells += free.len() as u64;
        self.smooth.program.most_iterations = self.budget.iterations(free.len())?;
        let solved =
            self.smooth.solve_about(grid, 0..grid.cells(), self.beginning, guess, free.clone());
        let taken = match &solved {
            Ok((profile, _)) => profile.iterations,
            Err(error) => error.iterations,
        };
        self.budget.solved(grid.cells(), 1);
        self.budget.solved(free.len(), taken);
        self.effort.iterations += u64::from(taken);
        solved.inspect_err(|_| self.effort.failed += 1)
    }

    /// Parts of the window around these cells, as far as a change there makes itself `felt`, in times in which acceleration
    /// builds up.
    fn around(
        &self,
        grid: &Grid,
        guess: &Guess,
        changed: &[usize],
        felt: f64,
    ) -> Vec<Range<usize>> {
        let time = felt * self.build_up();
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
}

/// Motion with constant acceleration through each cell.
fn uniform(grid: &Grid, b: &[f64]) -> Vec<ProfileSegment> {
    let ends = b.iter().zip(b.iter().skip(1)).enumerate();
    ends.map(|(cell, (from, to))| ProfileSegment::uniform(grid.length(cell), *from, *to)).collect()
}

/// True if a profile never goes backwards.
pub(super) fn can_be_followed(stretches: &[ProfileSegment]) -> bool {
    stretches.iter().all(|stretch| stretch.duration().is_finite())
}

/// Motion through each cell.
pub(super) fn stretches(grid: &Grid, profile: &SmoothProfile) -> Vec<ProfileSegment> {
    let last = grid.cells().saturating_sub(1);
    let ends = profile.b.iter().zip(profile.b.iter().skip(1)).zip(&profile.a);
    let stretch = |(cell, ((from, to), a)): (usize, ((&f64, &f64), &f64))| {
        let length = grid.length(cell);
        if cell == 0 && profile.beginning == Beginning::Rest {
            ProfileSegment::launch(length, *to)
        } else if cell == last {
            ProfileSegment::landing(length, *from)
        } else {
            ProfileSegment::bent(length, *from, from + a * length, *to)
        }
    };
    ends.enumerate().map(stretch).collect()
}
