//! The fastest motion along the course, window by window.
//!
//! A window begins where the last one was left and ends at rest: at a stop of the path, or at the end of what is known of
//! it. Of a window that does not end at a stop, only the part is committed that this makeshift end has no influence on.

use super::axis_path::AxisPath;
use super::convex::NotSolved;
use super::course::{Course, CourseElement};
use super::gain::Gain;
use super::grid::{Constraint, Grid};
use super::linear::LinearSolver;
use super::options::LimitOptions;
use super::reachable;
use super::sample::{Cell, Sampler, grid};
use super::smooth::{Beginning, SmoothSolver};
use super::stretch::Stretch;
use crate::Place;
use crate::prepare::CheckedElement;
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use twin_kinematics::{AxisVector, KinematicsError};

/// Within this time, s, after the path rested, or before it will, steps are shorter in proportion: there the velocity changes
/// fast.
const GRADE: f64 = 0.04;
/// The first and last cell of a path between stops take so long, s, and at most a quarter of the whole: there the jerk is
/// constant.
const LAUNCH: f64 = 8e-3;
/// Between stops there are at least so many cells.
const FEWEST: usize = 4;
/// So many times the time in which acceleration builds up is left between what is committed and where the end of the window
/// begins to be felt.
const MARGIN: f64 = 4.0;
/// Acceleration, jerk and velocity between the places where limits are asked for may be so much of the limit; a cell in which
/// they are more than the second number is too long.
const ALLOWED: [[f64; 2]; 3] = [[1.0005, 1.01], [1.045, 1.2], [1.0005, 1.01]];
/// What was planned before is planned again with so much more room.
const ROOM: [f64; 3] = [2e-4, 2e-3, 1e-6];
/// Cells that take less time, s, are too short to tell a jerk.
const SHORT: f64 = 2e-5;
/// Limits are tightened at most so often, and cells cut in half at most in so many of these rounds: a shorter cell gives the
/// profile more freedom, which it may use to exceed limits somewhere else.
const ROUNDS: u32 = 12;
const HALVING: u32 = 6;

/// A part of an element and how it is gone through.
#[derive(Clone, Debug)]
pub struct Leg {
    /// The element.
    pub element: Arc<CourseElement>,
    /// Where on it the part begins, m.
    pub from: f64,
    /// How it is gone through.
    pub stretch: Stretch,
}

/// What comes next along the course.
#[derive(Clone, Debug)]
pub enum Planned {
    /// Motion.
    Leg(Leg),
    /// What is no motion: an M function, a dwell, a jump. The path rests before it.
    Pause(Arc<CourseElement>),
}

/// Why the path does not go on as programmed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LimitError<E> {
    /// An error from upstream.
    #[error(transparent)]
    Upstream(E),
    /// The machine cannot follow an element, which is left out.
    #[error("{error}")]
    Kinematics {
        /// The block.
        place: Place,
        /// What the kinematics says.
        error: KinematicsError,
    },
    /// No profile was found for some elements, which are left out.
    #[error("{error}")]
    NotSolved {
        /// The first block.
        place: Place,
        /// What Clarabel says.
        error: NotSolved,
    },
}

/// What planning took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Windows planned.
    pub windows: u64,
    /// Windows for which Clarabel came to no answer, so that another profile was taken.
    pub failed: u64,
    /// Windows in which a limit is still exceeded somewhere between the places where it was asked for, after all that was
    /// tried.
    pub exceeded: u64,
    /// Iterations of Clarabel.
    pub iterations: u64,
    /// Cells planned, those planned again included.
    pub cells: u64,
    /// Cells committed.
    pub committed: u64,
}

/// Plans the motion along the elements of `upstream` on a machine: an iterator of [`Planned`].
#[derive(Debug)]
pub struct Planner<I, E, A> {
    course: Course<I, E>,
    sampler: Sampler<A>,
    options: LimitOptions,
    jerk_limited: bool,
    /// What is known of the path and not committed.
    cells: Vec<Cell>,
    /// b at the nodes of those of them that were planned before and stay as they are.
    kept: Vec<f64>,
    /// What the last window had planned behind what was committed of it: to rest.
    tail: Vec<Leg>,
    beginning: Beginning,
    /// What follows the cells, if they end at a stop.
    after: Option<After<E>>,
    near: AxisVector,
    ready: VecDeque<Result<Planned, LimitError<E>>>,
    smooth: SmoothSolver,
    linear: LinearSolver,
    effort: Effort,
    /// What limits cost in the window that is being planned, and in all that was committed.
    gains: Vec<Gain>,
    costs: BTreeMap<Constraint, f64>,
    over: bool,
}

#[derive(Debug)]
enum After<E> {
    /// The path goes on from rest.
    Path,
    Pause(Arc<CourseElement>),
    Error(LimitError<E>),
    End,
}

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Plans the elements of `upstream` on the machine `axes`.
    pub fn new(upstream: I, axes: A, options: LimitOptions) -> Self {
        let near = axes.home();
        let jerk_limited = axes.limits().iter().any(|limits| limits.jerk.is_some());
        Self {
            course: Course::new(upstream, options.course),
            sampler: Sampler::new(axes, options),
            options,
            jerk_limited,
            cells: Vec::new(),
            kept: Vec::new(),
            tail: Vec::new(),
            beginning: Beginning::Rest,
            after: None,
            near,
            ready: VecDeque::new(),
            smooth: SmoothSolver::default(),
            linear: LinearSolver::default(),
            effort: Effort::default(),
            gains: Vec::new(),
            costs: BTreeMap::new(),
            over: false,
        }
    }

    /// What planning has taken so far.
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// What each limit has cost so far: by how much shorter the motion would be per part by which the limit were raised, s. At 20 %
    /// more it is about a fifth of that, as long as nothing else holds the path back.
    pub fn costs(&self) -> &BTreeMap<Constraint, f64> {
        &self.costs
    }

    /// Takes one more element from the course.
    fn pull(&mut self) {
        let element = match self.course.next() {
            Some(Ok(element)) => Arc::new(element),
            Some(Err(error)) => {
                self.after = Some(After::Error(LimitError::Upstream(error)));
                return;
            }
            None => {
                self.after = Some(After::End);
                return;
            }
        };
        if element.length() <= 0.0 {
            self.after = Some(After::Pause(element));
            return;
        }
        let known = self.cells.len();
        match self.sampler.cells(&element, 0.0, &self.near, &mut self.cells) {
            Ok(()) => self.join(known),
            Err(error) => {
                self.cells.truncate(known);
                let place = element.place();
                self.after = Some(After::Error(LimitError::Kinematics { place, error }));
                return;
            }
        }
        if element.stops_at_end() {
            self.after = Some(After::Path);
        }
    }

    /// Bounds the velocity at the joint before the cell `index`.
    fn join(&mut self, index: usize) {
        if let Some(last) = self.cells.last() {
            self.near = last.end.position;
        }
        if let Some((before, [after, ..])) = self.cells.split_at_mut_checked(index)
            && let Some(before) = before.last_mut()
        {
            before.joint = self.sampler.joint(&before.end, &after.start);
        }
    }

    /// Pulls elements until `horizon` s of the path are known, or a stop.
    fn fill(&mut self, horizon: f64) {
        let mut check = 64;
        while self.after.is_none() {
            self.pull();
            if self.cells.len() >= check && self.after.is_none() {
                let grid = grid(&self.sampler, &self.cells);
                if self.estimate(&grid).1 >= horizon {
                    return;
                }
                check = self.cells.len() + self.cells.len() / 2;
            }
        }
    }

    /// A first profile of b at the nodes, with stops as jerk limits allow them, and its duration.
    fn estimate(&self, grid: &Grid) -> (Vec<f64>, f64) {
        let cells = 0..grid.cells();
        let start = match self.beginning {
            Beginning::Rest => 0.0,
            Beginning::Moving { b, .. } => b,
        };
        let mut b = reachable::fastest(grid, cells.clone(), start, 0.0);
        if self.jerk_limited {
            if self.beginning == Beginning::Rest {
                soften(&mut b, grid.nodes(), grid.jerk_start(0));
            }
            let mirrored: Vec<f64> = grid.nodes().iter().rev().map(|u| -u).collect();
            b.reverse();
            soften(&mut b, &mirrored, grid.jerk_end(cells.end.saturating_sub(1)));
            b.reverse();
        }
        let pairs = b.windows(2).zip(cells);
        let duration =
            pairs.map(|(pair, cell)| time(pair, grid.length(cell), self.jerk_limited)).sum();
        (b, duration)
    }

    /// Cuts cells that take too long, but not those that are kept.
    fn refine(&mut self) -> Result<(), KinematicsError> {
        for _ in 0..12 {
            let grid = grid(&self.sampler, &self.cells);
            let (b, duration) = self.estimate(&grid);
            let step = self.options.step.min(duration / 12.0);
            let count = self.cells.len();
            let mut refined = Vec::with_capacity(2 * count);
            let mut cut = false;
            // Time since the path rested, and until it will.
            let mut since = if self.beginning == Beginning::Rest { 0.0 } else { f64::INFINITY };
            let mut left = if self.after.is_some() { duration } else { f64::INFINITY };
            for (index, cell) in std::mem::take(&mut self.cells).into_iter().enumerate() {
                let pair = b.get(index..index + 2).unwrap_or_default();
                let takes = time(pair, cell.length(), self.jerk_limited);
                let fine = step * (since.min(left) / GRADE).clamp(0.125, 1.0);
                since += takes;
                left -= takes;
                // A profile with limited jerk has to have a choice.
                let few = self.jerk_limited && count < FEWEST;
                if index + 1 < self.kept.len() || takes <= 1.6 * fine && !few {
                    refined.push(cell);
                    continue;
                }
                let rest = [
                    self.jerk_limited && index == 0 && self.beginning == Beginning::Rest,
                    self.jerk_limited && index + 1 == count,
                ];
                let mut at = if rest == [false; 2] {
                    cuts(pair, takes, fine)
                } else {
                    rest_cuts(
                        cell.length(),
                        rest,
                        grid.rest_rates(index),
                        LAUNCH.min(0.25 * duration),
                    )
                };
                if few && at.is_empty() {
                    at.push(0.5);
                }
                cut |= !at.is_empty();
                refined.extend(self.sampler.parts(&cell, &at)?);
            }
            self.cells = refined;
            if !cut {
                break;
            }
        }
        Ok(())
    }

    /// Plans the cells at hand.
    fn plan(&mut self) {
        let mut horizon = self.options.horizon;
        loop {
            self.fill(horizon);
            if self.cells.is_empty() {
                break;
            }
            if let Err(error) = self.refine() {
                let place = self.rest_instead();
                self.ready.push_back(Err(LimitError::Kinematics { place, error }));
                break;
            }
            let grid = grid(&self.sampler, &self.cells);
            if self.safe(&grid).0 == 0 {
                // All that is known is within braking distance.
                horizon *= 2.0;
                self.coarsen(self.kept.len().saturating_sub(1));
                continue;
            }
            match self.solve_verified() {
                Ok(stretches) => self.commit(&stretches),
                Err(error) => self.fall_back(error),
            }
            break;
        }
        if self.cells.is_empty()
            && let Some(after) = self.after.take()
        {
            match after {
                After::Path => {}
                After::Pause(element) => self.ready.push_back(Ok(Planned::Pause(element))),
                After::Error(error) => self.ready.push_back(Err(error)),
                After::End => self.over = true,
            }
        }
    }

    /// How many cells can be committed: those that the makeshift end of the window has no influence on; and how many it
    /// lets go on as fast as they can.
    fn safe(&self, grid: &Grid) -> (usize, usize) {
        let cells = 0..grid.cells();
        if self.after.is_some() {
            return (cells.end, cells.end);
        }
        let stopping = reachable::controllable(grid, cells.clone(), 0.0);
        let free = reachable::controllable(grid, cells, f64::INFINITY);
        let pairs = stopping.iter().zip(&free);
        let free = pairs.take_while(|(s, f)| **s >= **f * (1.0 - 1e-9)).count().saturating_sub(1);
        // Jerk limits ask for braking earlier: by the time in which the acceleration comes and goes, and a margin.
        let limits = self.sampler.axes().limits().iter();
        let build_up = limits.filter_map(|limits| Some(limits.acceleration / limits.jerk?));
        let mut left = MARGIN * build_up.fold(0.0, f64::max);
        let mut end = free;
        let (b, _) = self.estimate(grid);
        while end > 0 && left > 0.0 {
            end -= 1;
            left -= time(b.get(end..end + 2).unwrap_or_default(), grid.length(end), false);
        }
        (end, free)
    }

    /// Goes to rest as the last window had it, after a window that could not be planned.
    fn fall_back(&mut self, error: NotSolved) {
        let tail = std::mem::take(&mut self.tail);
        let Some(last) = tail.last() else {
            let place = self.rest_instead();
            self.ready.push_back(Err(LimitError::NotSolved { place, error }));
            return;
        };
        let (element, at) = (Arc::clone(&last.element), last.from + last.stretch.length());
        self.ready.extend(tail.into_iter().map(|leg| Ok(Planned::Leg(leg))));
        self.beginning = Beginning::Rest;
        self.kept.clear();
        let behind = self
            .cells
            .iter()
            .position(|cell| Arc::ptr_eq(&cell.element, &element) && cell.to > at * (1.0 + 1e-12));
        let behind = behind.or_else(|| {
            let last = self.cells.iter().rposition(|cell| Arc::ptr_eq(&cell.element, &element));
            last.map(|index| index + 1)
        });
        self.cells.drain(..behind.unwrap_or(0).min(self.cells.len()));
        if let Some(first) = self.cells.first_mut()
            && Arc::ptr_eq(&first.element, &element)
        {
            first.from = at;
        }
        self.coarsen(0);
    }

    /// Gives up the cells at hand and begins again from rest behind them; the place where they began.
    fn rest_instead(&mut self) -> Place {
        let place = self.cells.first().map_or(Place::default(), |cell| cell.element.place());
        self.ready
            .extend(std::mem::take(&mut self.tail).into_iter().map(|leg| Ok(Planned::Leg(leg))));
        self.cells.clear();
        self.kept.clear();
        self.beginning = Beginning::Rest;
        place
    }

    /// Solves, looks between the places where limits were asked for, and makes them tighter, or the cells shorter, where they
    /// are exceeded.
    fn solve_verified(&mut self) -> Result<Vec<Stretch>, NotSolved> {
        self.effort.windows += 1;
        let mut stretches = self.solve(None)?;
        for round in 0..ROUNDS {
            let Some(warm) = self.tighten(&stretches, round < HALVING) else { break };
            stretches = self.solve(Some(warm))?;
            if round + 1 == ROUNDS {
                let mut cells = self.cells.iter().zip(&stretches);
                let exceeds = |(cell, stretch): (&Cell, &Stretch)| {
                    let worst = self.worst(cell, stretch);
                    worst.iter().zip(ALLOWED).any(|(worst, [allowed, _])| *worst > allowed)
                };
                if cells.any(exceeds) {
                    self.effort.exceeded += 1;
                }
            }
        }
        Ok(stretches)
    }

    /// Makes limits tighter in cells where they are exceeded, and with `halving` cuts them in half where they are exceeded
    /// by much. The profile so far at the nodes, if there are any such cells.
    fn tighten(&mut self, stretches: &[Stretch], halving: bool) -> Option<Vec<f64>> {
        let fresh = self.kept.len().saturating_sub(1);
        let mut cells = Vec::with_capacity(self.cells.len());
        let start = stretches.first().map_or(0.0, |stretch| stretch.at_position(0.0).0);
        let mut profile = vec![start];
        let mut any = false;
        let known = std::mem::take(&mut self.cells);
        let last = known.len().saturating_sub(1);
        for (index, (mut cell, stretch)) in known.into_iter().zip(stretches).enumerate() {
            let worst = self.worst(&cell, stretch);
            let mut halve = false;
            for ((tight, worst), [allowed, far]) in cell.tight.iter_mut().zip(worst).zip(ALLOWED) {
                if worst > allowed {
                    *tight *= (worst / (1.0 + 0.5 * (allowed - 1.0))).min(2.0);
                    // What was planned before stays on its nodes.
                    halve |= halving && index >= fresh && worst > far;
                    any = true;
                }
            }
            let rest = self.jerk_limited && (index == 0 || index == last);
            if halve && !rest && stretch.duration() > 4.0 * SHORT {
                cell.tight = [1.0; 3];
                if let Ok(parts) = self.sampler.parts(&cell, &[0.5]) {
                    profile.push(stretch.at_position(0.5 * stretch.length()).0);
                    cells.extend(parts);
                } else {
                    cells.push(cell);
                }
            } else {
                cells.push(cell);
            }
            profile.push(stretch.at_position(stretch.length()).0);
        }
        self.cells = cells;
        any.then_some(profile)
    }

    /// The largest acceleration, jerk and velocity in a cell as parts of the limits.
    fn worst(&self, cell: &Cell, stretch: &Stretch) -> [f64; 3] {
        let mut worst = [0.0_f64; 3];
        let limits = self.sampler.axes().limits();
        for eighth in 0..=8_u8 {
            let part = 0.125 * f64::from(eighth);
            let u = part * cell.length();
            let sample = match eighth {
                0 => cell.start,
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
            worst[1] = 0.0;
        }
        worst
    }

    /// How each cell is gone through; `warm`: a profile of b at the nodes that is nearly right.
    fn solve(&mut self, warm: Option<Vec<f64>>) -> Result<Vec<Stretch>, NotSolved> {
        let grid = &grid(&self.sampler, &self.cells);
        let cells = 0..grid.cells();
        self.effort.cells += cells.len() as u64;
        let lengths = cells.clone().map(|cell| grid.length(cell));
        if !self.jerk_limited {
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
            let pairs = b.windows(2).zip(lengths);
            return Ok(pairs
                .filter_map(|(pair, length)| match pair {
                    [from, to] => Some(Stretch::uniform(length, *from, *to)),
                    _ => None,
                })
                .collect());
        }
        let solves = if warm.is_some() { 1 } else { self.options.solves };
        let guess = warm.unwrap_or_else(|| {
            let mut guess = self.estimate(grid).0;
            for (guess, kept) in guess.iter_mut().zip(&self.kept) {
                *guess = *kept;
            }
            guess
        });
        let profile = self.smooth.solve(grid, cells.clone(), self.beginning, &guess, solves);
        let profile = profile.inspect_err(|_| self.effort.failed += 1)?;
        self.effort.iterations += u64::from(profile.iterations);
        self.gains = profile.gains;
        let count = cells.len();
        let pairs = profile.b.windows(2).zip(&profile.a).zip(lengths).enumerate();
        Ok(pairs
            .filter_map(|(index, ((pair, a), length))| match pair {
                [_, to] if index == 0 && self.beginning == Beginning::Rest => {
                    Some(Stretch::launch(length, *to))
                }
                [from, _] if index + 1 == count => Some(Stretch::landing(length, *from)),
                [from, to] => Some(Stretch::bent(length, *from, from + a * length, *to)),
                _ => None,
            })
            .collect())
    }

    /// Hands out the first `end` cells, keeps those up to `free` and prepares the rest for the next window.
    fn commit(&mut self, stretches: &[Stretch]) {
        let (end, free) = self.safe(&grid(&self.sampler, &self.cells));
        let legs = self.cells.iter().zip(stretches).map(|(cell, stretch)| Leg {
            element: Arc::clone(&cell.element),
            from: cell.from,
            stretch: *stretch,
        });
        let mut legs: Vec<Leg> = legs.collect();
        self.tail = legs.split_off(end.min(legs.len()));
        self.effort.committed += legs.len() as u64;
        for gain in self.gains.drain(..).filter(|gain| gain.cell < end) {
            *self.costs.entry(gain.constraint).or_default() += gain.time;
        }
        let last = legs.last().map(|leg| leg.stretch);
        self.ready.extend(legs.into_iter().map(|leg| Ok(Planned::Leg(leg))));
        self.kept.clear();
        let Some(last) = last.filter(|_| end < self.cells.len()) else {
            self.cells.clear();
            self.beginning = Beginning::Rest;
            return;
        };
        let (b, a) = last.at_position(last.length());
        self.beginning = Beginning::Moving { b, a };
        self.kept.push(b);
        let kept = self.tail.iter().take(free - end);
        self.kept.extend(kept.map(|leg| leg.stretch.at_position(leg.stretch.length()).0));
        self.cells.drain(..end);
        for cell in self.cells.iter_mut().take(free - end) {
            // The plan so far shall not be the only one.
            for (tight, room) in cell.tight.iter_mut().zip(ROOM) {
                *tight /= 1.0 + room;
            }
        }
        self.coarsen(free - end);
    }

    /// Makes the cells from `index` on as coarse as they came.
    fn coarsen(&mut self, index: usize) {
        let fine = self.cells.split_off(index.min(self.cells.len()));
        let mut near = fine.first().map_or(self.near, |cell| cell.start.position);
        let mut elements: Vec<(Arc<CourseElement>, f64)> = Vec::new();
        for cell in &fine {
            if elements.last().is_none_or(|(element, _)| !Arc::ptr_eq(element, &cell.element)) {
                elements.push((Arc::clone(&cell.element), cell.from));
            }
        }
        for (element, from) in elements {
            let known = self.cells.len();
            // What could be sampled before can be sampled again.
            if self.sampler.cells(&element, from, &near, &mut self.cells).is_ok() {
                self.join(known);
                near = self.near;
            }
        }
    }
}

/// Lowers `b` from rest at the first node on to what the jerk allows, u being the parameter of the nodes.
fn soften(b: &mut [f64], u: &[f64], jerk: f64) {
    if !jerk.is_finite() {
        // Nothing moves whose jerk is limited.
        return;
    }
    let start = u.first().copied().unwrap_or_default();
    let scale = 0.25 * jerk.powf(2.0 / 3.0);
    for (b, u) in b.iter_mut().zip(u) {
        let most = scale * (6.0 * (u - start)).powf(4.0 / 3.0);
        // Beyond the first meeting the acceleration is what counts.
        if most >= *b && u > &start {
            break;
        }
        *b = most;
    }
}

/// Time for a cell with these b at its ends, s.
fn time(pair: &[f64], length: f64, jerk_limited: bool) -> f64 {
    let [from, to] = pair else { return 0.0 };
    let rest = from.min(*to) <= 0.0;
    // With constant jerk from rest the mean velocity is a third of the last one, with constant acceleration half of it.
    let parts = if rest && jerk_limited { 3.0 } else { 2.0 };
    parts * length / (from.sqrt() + to.sqrt())
}

/// Where to cut a cell that begins or ends at rest, as parts of its length: after what is gone in `time` with the whole of the
/// jerk limit, or until the acceleration is what it may be. What is left of it is cut like others. `limits`: acceleration and
/// jerk of the parameter at its start and its end.
fn rest_cuts(length: f64, rest: [bool; 2], limits: [[f64; 2]; 2], time: f64) -> Vec<f64> {
    let [first, last] = limits.map(|[acceleration, jerk]| {
        // Where no jerk is limited: that which builds up the acceleration in the time.
        let jerk = if jerk.is_finite() { jerk } else { acceleration / time };
        jerk * time.min(acceleration / jerk).powi(3) / 6.0 / length
    });
    match rest {
        [true, true] => vec![first.min(0.25), 0.5, 1.0 - last.min(0.25)],
        [true, false] if first < 0.8 => vec![first],
        [false, true] if last < 0.8 => vec![1.0 - last],
        _ => Vec::new(),
    }
}

/// Where to cut a cell that takes `takes` into parts of about `step`, as parts of its length.
fn cuts(pair: &[f64], takes: f64, step: f64) -> Vec<f64> {
    let [from, to] = pair else { return Vec::new() };
    let parts = (takes / step).round().clamp(2.0, 8.0);
    let (v0, v1) = (from.sqrt(), to.sqrt());
    let mut at = Vec::new();
    let mut index = 1.0;
    while index < parts {
        // With constant acceleration: the way after a part of the time.
        let part = index / parts;
        at.push(part * (2.0 * v0 + part * (v1 - v0)) / (v0 + v1));
        index += 1.0;
    }
    at
}

impl<I, E, A> Iterator for Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    type Item = Result<Planned, LimitError<E>>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.ready.is_empty() && !self.over {
            self.plan();
        }
        self.ready.pop_front()
    }
}
