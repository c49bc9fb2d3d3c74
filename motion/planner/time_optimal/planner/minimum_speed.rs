//! Minimum speed profile from the present motion: braking as hard as the limits allow.

use super::backlog::rests;
use super::refine::time;
use super::{Leg, NOT_SOLVED, Planner};
use crate::blended_path::BlendedElement;
use crate::planned_motion::ProfileSegment;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::cell::Cell;
use crate::time_optimal::convex::NotSolved;
use crate::time_optimal::feeds::Feeds;
use crate::time_optimal::grid::Grid;
use crate::time_optimal::reachable;
use crate::time_optimal::sample::grid;
use crate::time_optimal::smooth::{Aim, Beginning, Guess};
use std::sync::Arc;
use twin_path::prepare::CheckedElement;

/// So much of the plan so far, s, is looked at first for a place to rest at.
const LOOK: f64 = 0.25;
/// Of the way that braking takes without jerk limits so much is added.
const FURTHER: f64 = 0.5;
/// With this override programmed velocities do not matter.
const ANY: f64 = 1e3;
/// Limits are tightened by and by within this time, s: at first they may be used up.
const BY_AND_BY: f64 = 0.02;
/// Solves at most, and what a further one has to lower the sum of b by.
const MOST_SOLVES: u32 = 10;
const SETTLED: f64 = 2e-4;
/// A plan is hardly faster than the slowest if its b is larger by no more than this part.
const NEAR: f64 = 0.05;
/// Accuracy with which solvers keep bounds.
const EXACT: f64 = 1e-4;
/// Least number of cells for braking.
const FEWEST: f64 = 32.0;
/// b below this part of the first is rest.
const REST: f64 = 3e-4;
/// With a landing of constant jerk the way left is this times b/|a|.
const LANDING: f64 = 2.0 / 3.0;
/// Where the path is to rest it may be faster than the slowest profile by this part of the first b.
const LAST: f64 = 1e-3;

/// Part of the plan so far that is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Look {
    /// As much as braking takes, roughly.
    Short,
    /// More, as long as that is not enough, up to all of it.
    Long,
}

/// Room of the followed profile around the slowest one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// By how much tighter accelerations and jerks are limited.
    pub(super) tight: [f64; 2],
    /// u̇² may be larger by this part where the override would have it smaller.
    pub(super) faster: f64,
    /// The path rests behind the first place possible by this part of the way.
    pub(super) behind: f64,
}

/// The slowest profile along the plan so far.
#[derive(Debug)]
pub(super) struct Slowest {
    cells: Vec<Cell>,
    b: Vec<f64>,
    /// From the first node, if it is not where the plan so far ends.
    rest: Option<f64>,
}

impl Slowest {
    /// With the override `factor` from the beginning of the profile on.
    pub(super) fn feeds(&self, factor: f64, room: Room) -> Feeds {
        let mut feeds = Feeds::new(factor);
        let first = self.b.first().copied().unwrap_or_default();
        let last = if factor > 0.0 { 0.0 } else { LAST * first };
        let at = |node: usize| {
            // Between nodes it may bend.
            let around = self.b.iter().skip(node.saturating_sub(1));
            let b = around.take(if node > 0 { 3 } else { 2 }).copied().fold(0.0, f64::max);
            [b + last, b * room.faster]
        };
        for (node, cell) in self.cells.iter().enumerate() {
            feeds.brake(&cell.element, cell.from..cell.to, [at(node), at(node + 1)]);
        }
        feeds
    }

    /// Place where the path comes to rest.
    pub(super) fn rest(&self, room: Room) -> Option<(&Arc<BlendedElement>, f64)> {
        let mut left = self.rest.map_or(f64::INFINITY, |rest| rest * (1.0 + room.behind));
        for cell in &self.cells {
            if left <= cell.length() {
                return Some((&cell.element, cell.from + left));
            }
            left -= cell.length();
        }
        self.cells.last().map(|cell| (&cell.element, cell.to))
    }

    /// Number of `legs` along it whose u̇² is hardly larger than its own.
    pub(super) fn near(&self, legs: &[Leg]) -> usize {
        let mut nodes = self.cells.iter().zip(self.b.iter().skip(1));
        let near = legs.iter().take_while(|leg| {
            let to = leg.from + leg.stretch.length();
            let same = |cell: &Cell| {
                Arc::ptr_eq(&cell.element, &leg.element) && (cell.to - to).abs() <= 1e-9 * to
            };
            let (b, _) = leg.stretch.at_position(leg.stretch.length());
            let slowest = nodes.by_ref().find_map(|(cell, b)| same(cell).then_some(*b));
            slowest.is_some_and(|slowest| b <= (1.0 + NEAR) * slowest)
        });
        near.count()
    }
}

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// The slowest profile from the beginning on, along the plan so far. `tight`: by how much tighter accelerations and jerks
    /// are limited.
    pub(super) fn slowest(&mut self, tight: [f64; 2], far: Look) -> Result<Slowest, NotSolved> {
        let mut look = LOOK;
        let mut longer = 1.0;
        loop {
            let feeds = std::mem::replace(&mut self.sampler.feeds, Feeds::new(ANY));
            let cells = self.old_cells(look, tight);
            self.sampler.feeds = feeds;
            let (cells, floors) = cells?;
            let all = cells.len() >= self.tail.len();
            let grid = grid(&self.sampler, &cells);
            let (b, rest) = reachable::slowest(&grid, 0..cells.len(), self.start());
            let rest = rest
                .and_then(|(cell, part)| Some(grid.nodes().get(cell)? + part * grid.length(cell)));
            let Some(rest) = rest.or(all.then_some(f64::INFINITY)) else {
                look *= 2.0;
                continue;
            };
            if !self.jerk_limited {
                let rest = rest.is_finite().then_some(rest);
                return Ok(Slowest { cells, b, rest });
            }
            let build_up = self.build_up();
            let enough = rest * (1.0 + FURTHER) + 2.0 * build_up * self.start().sqrt();
            let enough = longer * enough;
            let slow = grid.nodes().iter().position(|u| *u > enough);
            // Down to what the override allows, and the same way again to rest.
            let ways = if self.asked > 0.0 { 2.0 } else { 1.0 };
            let count = grid.nodes().iter().position(|u| *u > ways * enough);
            if count.is_none() && !all {
                look *= 2.0;
                continue;
            }
            let count = count.filter(|count| *count > 4 && *count < cells.len());
            if let Some(count) = count {
                let mut some = cells.clone();
                some.truncate(count);
                let slow = slow.filter(|_| self.asked > 0.0).unwrap_or_default();
                let floors = floors.iter().enumerate().take(count);
                let floors = floors.map(|(cell, floor)| if cell < slow { *floor } else { 0.0 });
                let slowest = self.slowest_smooth(some, floors.collect());
                if slowest.is_ok() || far == Look::Short {
                    return slowest;
                }
                longer *= 2.0;
                continue;
            }
            if all {
                return self.slowest_smooth(cells, floors);
            }
            look *= 2.0;
        }
    }

    /// u̇² at the beginning.
    pub(super) fn start(&self) -> f64 {
        match self.beginning {
            Beginning::Rest => 0.0,
            Beginning::Moving { b, .. } => b,
        }
    }

    /// The legs of the plan so far as cells, of about `look` s, with no regard to programmed velocities; and the u̇² that the override
    /// allows in each.
    fn old_cells(
        &mut self,
        look: f64,
        tight: [f64; 2],
    ) -> Result<(Vec<Cell>, Vec<f64>), NotSolved> {
        let mut floors = Vec::new();
        let asked = Feeds::new(self.asked);
        let mut cells = Vec::new();
        let mut near = self.near;
        let mut at = 0.0;
        for leg in &self.tail {
            if at > look {
                break;
            }
            if self.budget.is_spent() {
                return Err(NOT_SOLVED);
            }
            self.budget.sampled(1);
            let part = leg.from..leg.from + leg.stretch.length();
            let middle = part.start.midpoint(part.end);
            let cell = self.sampler.cell(&leg.element, part, &near);
            let mut cell = cell.map_err(|_refused| NOT_SOLVED)?;
            let any = std::mem::replace(&mut self.sampler.feeds, asked.clone());
            let slow = self.sampler.sample(&leg.element, middle, &near);
            self.sampler.feeds = any;
            floors.push(slow.map_or(0.0, |slow| slow.cap()));
            at += leg.stretch.duration();
            let grown = (at / BY_AND_BY).min(1.0);
            let [acceleration, jerk] = tight.map(|tight| 1.0 + (tight - 1.0) * grown);
            cell.tight = [acceleration, jerk, 1.0];
            near = cell.end.position;
            cell.take_tangents(&leg.stretch);
            cells.push(cell);
        }
        Ok((cells, floors))
    }

    /// The same where jerks are limited: down to `caps` in each cell, unless the plan so far is slower, and no further.
    fn slowest_smooth(
        &mut self,
        mut cells: Vec<Cell>,
        mut caps: Vec<f64>,
    ) -> Result<Slowest, NotSolved> {
        let mut guess = self.old_guess(cells.len());
        let mut old = guess.clone();
        let mut before = f64::INFINITY;
        self.smooth.aim = Aim::Slowest;
        let mut solves = 0;
        let result = loop {
            let grid = grid(&self.sampler, &cells);
            self.effort.cells += grid.cells() as u64;
            let floors = caps.iter().zip(&old.c).map(|(cap, c)| cap.min(*c));
            self.smooth.floors = floors.map(|floor| (1.0 - EXACT) * floor.max(0.0)).collect();
            let free = 1..grid.cells().saturating_sub(1);
            self.smooth.program.most_iterations = match self.budget.iterations(free.len()) {
                Ok(most) => most,
                Err(spent) => break Err(spent),
            };
            let solved =
                self.smooth.solve_about(&grid, 0..grid.cells(), self.beginning, &mut guess, free);
            let (profile, broken) = match solved {
                Ok(solved) => solved,
                Err(error) => {
                    self.budget.solved(grid.cells(), error.iterations + 1);
                    break Err(error);
                }
            };
            self.budget.solved(grid.cells(), profile.iterations + 1);
            self.effort.iterations += u64::from(profile.iterations);
            solves += 1;
            let sum: f64 =
                (0..grid.cells()).zip(&profile.b).map(|(cell, b)| grid.length(cell) * b).sum();
            let settled = broken.is_empty() && sum >= before * (1.0 - SETTLED);
            before = sum;
            if settled || solves >= MOST_SOLVES {
                let rest = rest(&grid, &profile.b, &profile.a);
                break Ok((profile.b, rest));
            }
            self.halve_slow(&mut cells, &profile.b, [&mut guess, &mut old], &mut caps);
        };
        self.smooth.aim = Aim::Fastest;
        let (b, rest) = result?;
        Ok(Slowest { cells, b, rest })
    }

    /// The plan so far as a guess, for the first `count` cells of it.
    fn old_guess(&self, count: usize) -> Guess {
        let legs = || self.tail.iter().take(count).map(|leg| &leg.stretch);
        let mut b: Vec<f64> = legs().map(|stretch| stretch.at_position(0.0).0).collect();
        b.extend(legs().next_back().map(|stretch| stretch.at_position(stretch.length()).0));
        let middle = |stretch: &ProfileSegment| {
            let (b, a) = stretch.at_position(0.0);
            let (end, _) = stretch.at_position(stretch.length());
            // What jerk is constant in from or to rest is at an end, where c is none of the variables.
            if rests(b) || rests(end) { 0.5 * (b + end) } else { b + a * stretch.length() }
        };
        let mut guess = Guess::rough(b);
        guess.c = legs().map(middle).collect();
        guess
    }

    /// Cuts cells in half that take long.
    fn halve_slow(
        &self,
        cells: &mut Vec<Cell>,
        b: &[f64],
        guesses: [&mut Guess; 2],
        caps: &mut Vec<f64>,
    ) {
        let least = REST * b.first().copied().unwrap_or_default();
        let pairs =
            cells.iter().zip(b.windows(2)).take_while(|(_, pair)| pair.iter().all(|b| *b > least));
        let braking: f64 = pairs.map(|(cell, pair)| time(pair, cell.length(), true)).sum();
        let step = self.options.step.min(braking / FEWEST);
        let last = cells.len().saturating_sub(1);
        let [guess, old] = guesses;
        let mut halved = Vec::with_capacity(cells.len());
        for (index, cell) in std::mem::take(cells).into_iter().enumerate() {
            let pair = b.get(index..index + 2).unwrap_or_default();
            let moving = pair.first().is_some_and(|from| *from > least);
            let long = time(pair, cell.length(), true) > 1.5 * step;
            if moving
                && long
                && index > 0
                && index < last
                && let Ok(parts) = self.sampler.parts(&cell, &[0.5])
                && parts.len() == 2
            {
                guess.cut(halved.len(), &[0.5]);
                old.cut(halved.len(), &[0.5]);
                caps.insert(halved.len(), caps.get(halved.len()).copied().unwrap_or_default());
                halved.extend(parts);
            } else {
                halved.push(cell);
            }
        }
        *cells = halved;
    }
}

/// Distance from the first node at which the slowest profile rests.
fn rest(grid: &Grid, b: &[f64], a: &[f64]) -> Option<f64> {
    let least = REST * b.first()?;
    let nodes = grid.nodes();
    let moving = b.iter().rposition(|b| *b > least)?;
    if moving + 2 >= nodes.len() {
        return None;
    }
    let (b, a) = (b.get(moving)?, a.get(moving)?);
    let (from, to) = (nodes.get(moving)?, nodes.get(moving + 1)?);
    let left = if *a < 0.0 { LANDING * b / a.abs() } else { f64::INFINITY };
    Some(from - nodes.first()? + left.min(to - from))
}
