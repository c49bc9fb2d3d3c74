//! The fastest motion along the course, window by window.
//!
//! A window begins where the last one was left and ends at rest: at a stop of the path, or at the end of what is known of
//! it. Of a window that does not end at a stop, only the part is committed that this makeshift end has no influence on.

use super::axis_path::AxisPath;
use super::convex::NotSolved;
use super::course::{Course, CourseElement};
use super::grid::Grid;
use super::linear::LinearSolver;
use super::options::LimitOptions;
use super::reachable;
use super::sample::{Cell, Sampler, grid};
use super::smooth::{Beginning, SmoothSolver};
use super::stretch::Stretch;
use crate::Place;
use crate::prepare::CheckedElement;
use std::collections::VecDeque;
use std::sync::Arc;
use twin_kinematics::{AxisVector, KinematicsError};

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
    /// So many of them were planned before and shall stay as they are.
    kept: usize,
    beginning: Beginning,
    /// What follows the cells, if they end at a stop.
    after: Option<After<E>>,
    near: AxisVector,
    ready: VecDeque<Result<Planned, LimitError<E>>>,
    smooth: SmoothSolver,
    linear: LinearSolver,
    effort: Effort,
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
            kept: 0,
            beginning: Beginning::Rest,
            after: None,
            near,
            ready: VecDeque::new(),
            smooth: SmoothSolver::default(),
            linear: LinearSolver::default(),
            effort: Effort::default(),
            over: false,
        }
    }

    /// What planning has taken so far.
    pub fn effort(&self) -> Effort {
        self.effort
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
            let mut mirrored: Vec<f64> = grid.nodes().iter().rev().map(|u| -u).collect();
            b.reverse();
            soften(&mut b, &mirrored, grid.jerk_end(cells.end.saturating_sub(1)));
            b.reverse();
            mirrored.clear();
        }
        let pairs = b.windows(2).zip(cells);
        let duration = pairs.map(|(pair, cell)| time(pair, grid.length(cell), self.jerk_limited)).sum();
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
            for (index, cell) in std::mem::take(&mut self.cells).into_iter().enumerate() {
                let pair = b.get(index..index + 2).unwrap_or_default();
                let takes = time(pair, cell.length(), self.jerk_limited);
                if index < self.kept || takes <= 1.6 * step {
                    refined.push(cell);
                    continue;
                }
                let rest = [
                    self.jerk_limited && index == 0 && self.beginning == Beginning::Rest,
                    self.jerk_limited && index + 1 == count,
                ];
                let at = cuts(pair, takes, step, rest);
                cut |= !at.is_empty();
                refined.extend(self.sampler.parts(cell, &at)?);
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
                let place = self.cells.first().map_or(Place::default(), |cell| cell.element.place());
                self.cells.clear();
                self.kept = 0;
                self.beginning = Beginning::Rest;
                self.ready.push_back(Err(LimitError::Kinematics { place, error }));
                break;
            }
            let grid = grid(&self.sampler, &self.cells);
            let end = if self.after.is_some() { self.cells.len() } else { self.safe(&grid) };
            if end == 0 {
                // All that is known is within braking distance.
                horizon *= 2.0;
                self.coarsen(0);
                continue;
            }
            let stretches = self.solve(&grid);
            match stretches {
                Ok(stretches) => self.commit(stretches, end, &grid),
                Err(error) => {
                    let place = self.cells.first().map_or(Place::default(), |cell| cell.element.place());
                    self.cells.clear();
                    self.kept = 0;
                    self.beginning = Beginning::Rest;
                    self.ready.push_back(Err(LimitError::NotSolved { place, error }));
                }
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

    /// How many cells the makeshift end of the window has no influence on.
    fn safe(&self, grid: &Grid) -> usize {
        let cells = 0..grid.cells();
        let stopping = reachable::controllable(grid, cells.clone(), 0.0);
        let free = reachable::controllable(grid, cells, f64::INFINITY);
        let same = stopping.iter().zip(&free).take_while(|(s, f)| **s >= **f * (1.0 - 1e-9)).count();
        // Jerk limits ask for braking earlier: by the time in which the acceleration comes and goes, and a margin.
        let limits = self.sampler.axes().limits().iter();
        let mut left = limits.map(|limits| limits.jerk.map_or(0.0, |jerk| 4.0 * limits.acceleration / jerk)).fold(0.0, f64::max);
        let mut end = same.saturating_sub(1);
        let (b, _) = self.estimate(grid);
        while end > 0 && left > 0.0 {
            end -= 1;
            left -= time(b.get(end..end + 2).unwrap_or_default(), grid.length(end), false);
        }
        end
    }

    /// How each cell is gone through.
    fn solve(&mut self, grid: &Grid) -> Result<Vec<Stretch>, NotSolved> {
        let cells = 0..grid.cells();
        self.effort.windows += 1;
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
        let (guess, _) = self.estimate(grid);
        let profile = self.smooth.solve(grid, cells.clone(), self.beginning, &guess, self.options.solves);
        let profile = profile.inspect_err(|_| self.effort.failed += 1)?;
        self.effort.iterations += u64::from(profile.iterations);
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

    /// Hands out the first `end` cells and prepares the rest for the next window.
    fn commit(&mut self, stretches: Vec<Stretch>, end: usize, grid: &Grid) {
        let _ = grid;
        let mut last = None;
        for (cell, stretch) in self.cells.iter().zip(stretches).take(end) {
            last = Some(stretch);
            let leg = Leg { element: Arc::clone(&cell.element), from: cell.from, stretch };
            self.ready.push_back(Ok(Planned::Leg(leg)));
        }
        self.effort.committed += end as u64;
        if end == self.cells.len() {
            self.cells.clear();
            self.beginning = Beginning::Rest;
            self.kept = 0;
            return;
        }
        if let Some(stretch) = last {
            let (b, a) = stretch.at_position(stretch.length());
            self.beginning = if self.jerk_limited { Beginning::Moving { b, a } } else { Beginning::Moving { b, a: 0.0 } };
        }
        self.cells.drain(..end);
        self.coarsen(0);
    }

    /// Makes the cells from `index` on as coarse as they came.
    fn coarsen(&mut self, index: usize) {
        let fine = self.cells.split_off(index.min(self.cells.len()));
        self.kept = self.cells.len();
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

/// Where to cut a cell that takes `takes` into parts of about `step`, as parts of its length. `rest`: it begins from, or
/// ends at, rest with constant jerk.
fn cuts(pair: &[f64], takes: f64, step: f64, rest: [bool; 2]) -> Vec<f64> {
    let [from, to] = pair else { return Vec::new() };
    // The first cell from rest is longer than the others, for the sake of those behind it.
    let first = 3.0 * step / takes;
    match rest {
        [true, true] => return vec![0.25, 0.5, 0.75],
        [true, false] if first < 0.8 => return vec![first.powi(3)],
        [false, true] if first < 0.8 => return vec![1.0 - first.powi(3)],
        [true, _] | [_, true] => return Vec::new(),
        _ => {}
    }
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
