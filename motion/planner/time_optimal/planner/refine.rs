//! Grid of a window: the cells between which the profile may change its acceleration.

use super::{NoWindow, Planner};
use crate::planned_motion::ProfileSegment;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::bound::{Cap, CapSource};
use crate::time_optimal::cell::Cell;
use crate::time_optimal::grid::Grid;
use crate::time_optimal::reachable;
use crate::time_optimal::rows::LEAST_TIME;
use crate::time_optimal::sample::grid;
use crate::time_optimal::smooth::{Beginning, Guess};
use std::sync::Arc;
use twin_path::prepare::CheckedElement;

/// Within this time, s, after the path rested, or before it will, steps are shorter in proportion: there the velocity changes
/// fast.
const GRADE: f64 = 0.06;
/// Cells that take no more than this, s, are not cut for the sake of time: in shorter cells rounding would drown their jerks.
pub(super) const SHORTEST: f64 = 4.0 * LEAST_TIME;
/// The first and last cell of a path between stops take at most so long, s, and at most a quarter of the whole: there the jerk
/// is constant.
const LAUNCH: f64 = 8e-3;
/// But no less than this, s.
const SHORTEST_LAUNCH: f64 = 2.0 * LEAST_TIME;
/// Steps of the grid that is first solved on where jerks are limited, in steps of the one that counts.
const COARSE: f64 = 4.0;
/// Least number of steps between stops.
const FEWEST_STEPS: f64 = 12.0;
/// Cells that take more steps are cut.
const TOO_LONG: f64 = 1.6;
/// A path that takes less than this number of horizons is planned in one window.
const BEYOND: f64 = 1.5;
/// A plan whose parts take no more than this number of steps stays fine everywhere: an override may ask for braking in any part.
const SHORT: f64 = 2.0;
/// Share of a window's horizon that the longest cell at the largest velocity takes up, in steps.
const CRUISE: f64 = 4.0;
/// Where they move evenly at the largest velocity, cells may take this part of the time to the nearest change.
const STEADY: f64 = 0.3;
/// At the largest velocity, without ü, accelerations and jerks below this part of their limits do not limit the motion.
const SLACK: f64 = 0.5;
/// A u̇² is the largest if it is less by no more than this part of it.
const AT_CAP: f64 = 1e-4;
/// Duration of the cells next to a place where the acceleration changes, s.
const SWITCH: f64 = 2e-4;
/// A first profile may be faster by this part, in u̇², than what keeps the jerk limits at constant velocity: not much more can be won
/// by speeding up and slowing down.
const BEND_ROOM: f64 = 2.0;
/// The path does not rest where b is more than this part of what it is a node before.
const NO_REST: f64 = 1e-6;
/// Least number of cells between stops.
const FEWEST: usize = 4;
/// Cells in which jerks differ by more than this part of their limits are cut in half.
const VARIES: f64 = 0.12;

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// A first profile of b at the nodes, with stops as jerk limits allow them, and its duration.
    pub(super) fn estimate(&self, grid: &Grid) -> (Vec<f64>, f64) {
        let cells = 0..grid.cells();
        let start = self.start();
        let mut b = reachable::fastest(grid, cells.clone(), start, 0.0);
        if self.jerk_limited
            && let Some(slower) = slow_in_bends(grid, &b)
        {
            b = reachable::fastest(&slower, cells.clone(), start, 0.0);
        }
        go_on(grid, &mut b);
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

    /// Share of the horizon of each cell, s: less than its time where only the largest velocity limits it.
    pub(super) fn horizons(&self) -> Vec<f64> {
        let grid = grid(&self.sampler, &self.cells);
        let (b, _) = self.estimate(&grid);
        let pairs = b.windows(2).zip(&self.cells);
        let times = pairs.map(|(pair, cell)| time(pair, cell.length(), self.jerk_limited));
        let times: Vec<f64> = times.collect();
        let cruises = self.cruises(&grid, &b);
        let parts = times.iter().zip(cruises);
        let part = (CRUISE / self.options.longest).min(1.0);
        parts.map(|(takes, cruises)| if cruises { part * takes } else { *takes }).collect()
    }

    /// Leaves what is more than `horizon` s ahead for the next window.
    pub(super) fn cut_off(&mut self, horizon: f64) -> Result<(), NoWindow> {
        let horizons = self.horizons();
        if horizons.iter().sum::<f64>() < BEYOND * horizon {
            return Ok(());
        }
        let mut left = horizon;
        let mut times = horizons.into_iter().enumerate();
        // What was planned before stays in the window, and something is to be new.
        let least = self.kept.len();
        let Some((index, takes)) = times.find(|(index, takes)| {
            left -= takes;
            left <= 0.0 && *index >= least
        }) else {
            return Ok(());
        };
        let Some(cell) = self.cells.get(index) else { return Ok(()) };
        let part = 1.0 + left / takes;
        // A window of one cell would begin and end at rest all the way.
        let at =
            if takes > 0.1 * horizon && part < 0.9 { vec![0.5 * part, part] } else { vec![0.5] };
        let parts = self.sampler.parts(cell, &at);
        let mut parts =
            parts.map_err(|error| NoWindow::Kinematics(Arc::clone(&cell.element), error))?;
        let behind = parts.split_off(parts.len().min(2));
        let mut beyond = self.cells.split_off(index + 1);
        beyond.splice(..0, behind);
        self.cells.truncate(index);
        self.cells.append(&mut parts);
        if !beyond.is_empty() {
            self.return_beyond(&beyond);
        }
        Ok(())
    }

    /// Cuts cells that take too long, but not those that are kept. Where jerks are limited this is only the grid of a first,
    /// rough solution, which is then cut by how long its cells take ([`Self::subdivide`]).
    pub(super) fn refine(&mut self) -> Result<(), NoWindow> {
        // Little is to choose where the path has to brake nearly as hard as it can: there the grid is fine from the beginning.
        let coarse = self.jerk_limited && !self.smooth.positive;
        let step = if coarse { COARSE * self.options.step } else { self.options.step };
        for _ in 0..12 {
            if self.budget.is_spent() {
                break;
            }
            let grid = grid(&self.sampler, &self.cells);
            let (b, duration) = self.estimate(&grid);
            let step = step.min(duration / FEWEST_STEPS);
            let count = self.cells.len();
            let mut refined = Vec::with_capacity(2 * count);
            self.budget.looked(count);
            let mut cut = false;
            let launch = LAUNCH.min(0.25 * duration);
            let times = b.windows(2).zip(&self.cells);
            let times = times.map(|(pair, cell)| time(pair, cell.length(), self.jerk_limited));
            let times: Vec<f64> = times.collect();
            // A jerk-limited profile changes earlier and later than the one without.
            let steady = self.steady(&grid, &b, &times, self.build_up());
            let cells = b.windows(2).zip(&times);
            let fastest =
                [reached(cells.clone(), 2.0 * launch), reached(cells.rev(), 2.0 * launch)];
            // Time since the path rested, and until it will.
            let mut since = if self.beginning == Beginning::Rest { 0.0 } else { f64::INFINITY };
            let mut left = if self.stops() { duration } else { f64::INFINITY };
            let mut known = std::mem::take(&mut self.cells).into_iter().enumerate();
            while let Some((index, cell)) = known.next() {
                let pair = b.get(index..index + 2).unwrap_or_default();
                let takes = times.get(index).copied().unwrap_or_default();
                let even = cell.is_even && !self.jerk_limited;
                let steady = steady.get(index).copied().unwrap_or_default();
                let fine = graded(step, since.min(left)).max(steady);
                let fine = if even { self.longest() } else { fine };
                since += takes;
                left -= takes;
                let switches = if even { even_cuts(pair, &grid, index) } else { Vec::new() };
                // A profile with limited jerk has to have a choice.
                let few = self.jerk_limited && count < FEWEST;
                let short = takes <= TOO_LONG * fine && !few && switches.is_empty();
                let fine_enough = short || self.budget.is_spent();
                if index + 1 < self.kept.len() || fine_enough {
                    refined.push(cell);
                    continue;
                }
                let rest = [
                    self.jerk_limited && index == 0 && self.beginning == Beginning::Rest,
                    self.jerk_limited && index + 1 == count,
                ];
                let mut at = if !switches.is_empty() {
                    switches
                } else if rest == [false; 2] {
                    cuts(pair, takes, fine)
                } else {
                    rest_cuts(cell.length(), rest, grid.rest_rates(index), fastest, launch)
                };
                if few && at.is_empty() {
                    at.push(0.5);
                }
                cut |= !at.is_empty();
                self.budget.sampled(at.len() + 1);
                match self.sampler.parts(&cell, &at) {
                    Ok(parts) => refined.extend(parts),
                    Err(error) => {
                        // Nothing of the path is lost.
                        let element = Arc::clone(&cell.element);
                        refined.push(cell);
                        refined.extend(known.map(|(_, cell)| cell));
                        self.cells = refined;
                        return Err(NoWindow::Kinematics(element, error));
                    }
                }
            }
            self.cells = refined;
            if !cut {
                break;
            }
        }
        Ok(())
    }

    /// The longest time that a part of the plan takes, s.
    pub(super) fn longest(&self) -> f64 {
        self.options.longest * self.options.step
    }

    /// Longest duration of each cell, s, where only the largest velocity limits the motion in it and within `margin` s of it; 0 for
    /// all others.
    fn steady(&self, grid: &Grid, b: &[f64], times: &[f64], margin: f64) -> Vec<f64> {
        if self.options.longest <= SHORT {
            return vec![0.0; times.len()];
        }
        let cruises = self.cruises(grid, b);
        // Time since the last change, and until the next one.
        let since = |cells: &mut dyn Iterator<Item = (&bool, &f64)>| -> Vec<f64> {
            let mut since = 0.0;
            let of = |(cruises, takes): (&bool, &f64)| {
                let before = since;
                since = if *cruises { since + takes } else { 0.0 };
                before
            };
            cells.map(of).collect()
        };
        let after = since(&mut cruises.iter().zip(times));
        let mut before = since(&mut cruises.iter().zip(times).rev());
        before.reverse();
        let distances = after.iter().zip(&before).zip(&cruises);
        let longest = |((after, before), cruises): ((&f64, &f64), &bool)| {
            let apart = (after.min(*before) - margin).max(0.0);
            if *cruises { (STEADY * apart).min(self.longest()) } else { 0.0 }
        };
        distances.map(longest).collect()
    }

    /// True for each cell that `b` passes at the largest velocity, the same all the way, far from all other limits.
    fn cruises(&self, grid: &Grid, b: &[f64]) -> Vec<bool> {
        let caps = grid.caps();
        let at_cap = |node: usize| {
            let pair = b.get(node).zip(caps.get(node));
            pair.is_some_and(|(b, cap)| *b >= cap.v2 * (1.0 - AT_CAP))
        };
        let cruises = |(index, cell): (usize, &Cell)| {
            let Some([from, to]) = b.get(index..index + 2) else { return false };
            let is_level = (from - to).abs() <= AT_CAP * from && at_cap(index) && at_cap(index + 1);
            is_level && (cell.is_even || self.has_slack(cell, *from))
        };
        self.cells.iter().enumerate().map(cruises).collect()
    }

    /// True if axes that go through a cell with this u̇² all the way are far from the limits of acceleration and jerk.
    fn has_slack(&self, cell: &Cell, b: f64) -> bool {
        let limits = self.sampler.axes().limits();
        let even = ProfileSegment::uniform(cell.length(), b, b);
        [&cell.start, &cell.middle, &cell.end].into_iter().all(|sample| {
            let [acceleration, jerk, _] = sample.excess(limits, &even, 0.0);
            acceleration <= SLACK && jerk <= SLACK
        })
    }

    /// Cuts cells that take too long at `guess`, but not those that are kept, nor those that begin or end at rest.
    pub(super) fn subdivide(&mut self, guess: &mut Guess) {
        let times = self.cells.iter().enumerate().map(|(index, cell)| {
            let motion = guess.motion(index, cell.length());
            motion.map_or(0.0, |motion| motion.duration)
        });
        let times: Vec<f64> = times.collect();
        let duration: f64 = times.iter().sum();
        let step = self.options.step.min(duration / FEWEST_STEPS);
        let mut since = if self.beginning == Beginning::Rest { 0.0 } else { f64::INFINITY };
        let mut left = if self.stops() { duration } else { f64::INFINITY };
        let steady = self.steady(&grid(&self.sampler, &self.cells), &guess.b, &times, 0.0);
        let inner = self.kept.len().max(2) - 1..self.cells.len().saturating_sub(1);
        let mut cells = Vec::with_capacity(self.cells.len());
        for ((index, cell), takes) in
            std::mem::take(&mut self.cells).into_iter().enumerate().zip(times)
        {
            let steady = steady.get(index).copied().unwrap_or_default();
            let fine = graded(step, since.min(left)).max(steady);
            since += takes;
            left -= takes;
            let place = cells.len();
            let pair = guess.b.get(place..place + 2).unwrap_or_default();
            if inner.contains(&index)
                && takes > TOO_LONG * fine
                && let at = cuts(pair, takes, fine)
                && let Ok(parts) = self.sampler.parts(&cell, &at)
                && parts.len() == at.len() + 1
            {
                self.budget.sampled(parts.len());
                guess.cut(place, &at);
                cells.extend(parts);
            } else {
                cells.push(cell);
            }
        }
        self.cells = cells;
    }

    /// Cuts cells in half in which jerks would differ too much from place to place.
    pub(super) fn bend(&mut self, guess: &mut Guess) {
        let grid = grid(&self.sampler, &self.cells);
        let fresh = self.kept.len().saturating_sub(1);
        let mut cells = Vec::with_capacity(self.cells.len());
        let last = grid.cells().saturating_sub(1);
        for (index, cell) in std::mem::take(&mut self.cells).into_iter().enumerate() {
            let place = cells.len();
            let rest = index == last || index == 0;
            if !rest
                && index >= fresh
                && let Some(motion) = guess.motion(place, grid.length(index))
                && motion.duration > SHORTEST
                && grid.varies(index, &motion.ends) > VARIES
                && let Ok(parts) = self.sampler.parts(&cell, &[0.5])
                && parts.len() == 2
            {
                self.budget.sampled(parts.len());
                guess.cut(place, &[0.5]);
                cells.extend(parts);
            } else {
                cells.push(cell);
            }
        }
        self.cells = cells;
    }
}

/// Lets a profile go on that all but rests on the way. In a cell in which an axis nearly turns round two passes may be as fast
/// as possible at its start and then have to stop at its end, where being slower before would be better.
fn go_on(grid: &Grid, b: &mut [f64]) {
    for node in 2..b.len().saturating_sub(1) {
        let (Some(before), Some(here)) = (b.get(node - 1), b.get(node)) else { continue };
        if *before <= 0.0 || *here > NO_REST * before {
            continue;
        }
        let bends = grid.jerk_bound(node - 1).min(grid.jerk_bound(node));
        let from = bends.min(0.5 * before);
        let onwards = reachable::fastest(grid, node..grid.cells(), from, 0.0);
        for (b, onwards) in b.iter_mut().skip(node).zip(onwards) {
            *b = b.max(onwards);
        }
    }
}

/// The grid with bounds on the velocity where `b` is so large that the bends alone ask for much more jerk than there is; none if
/// it is so nowhere.
fn slow_in_bends(grid: &Grid, b: &[f64]) -> Option<Grid> {
    let mut slower = None;
    for cell in 0..grid.cells() {
        let v2 = BEND_ROOM * grid.jerk_bound(cell);
        // Where the window begins it is as fast as it is.
        for node in [cell, cell + 1] {
            if node > 0 && b.get(node).is_some_and(|b| *b > v2) {
                let slower = slower.get_or_insert_with(|| grid.clone());
                slower.cap_at(node, Cap { v2, source: CapSource::Unconstrained });
            }
        }
    }
    slower
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
pub(super) fn time(pair: &[f64], length: f64, jerk_limited: bool) -> f64 {
    let [from, to] = pair else { return 0.0 };
    let rest = from.min(*to) <= 0.0;
    // With constant jerk from rest the mean velocity is a third of the last one, with constant acceleration half of it.
    let parts = if rest && jerk_limited { 3.0 } else { 2.0 };
    parts * length / (from.sqrt() + to.sqrt())
}

/// The largest b within the first `left` s of `cells`, which are b at their ends and their times. The last of these cells counts
/// as a whole.
fn reached<'a>(cells: impl Iterator<Item = (&'a [f64], &'a f64)>, mut left: f64) -> f64 {
    let mut most = 0.0;
    for (pair, takes) in cells {
        most = pair.iter().copied().fold(most, f64::max);
        left -= takes;
        if left <= 0.0 {
            break;
        }
    }
    most
}

/// Where to cut a cell that begins or ends at rest, as parts of its length.
///
/// The first part takes `time` with the whole jerk limit. It is shorter where the acceleration reaches its limit earlier, or
/// the velocity reaches half of the largest one: from there on the acceleration decreases. The rest is cut like other cells.
///
/// `limits`: acceleration and jerk of the parameter at its start and its end; `fastest`: the largest u̇² after its start and
/// before its end.
fn rest_cuts(
    length: f64,
    rest: [bool; 2],
    limits: [[f64; 2]; 2],
    fastest: [f64; 2],
    time: f64,
) -> Vec<f64> {
    let launch = |[acceleration, jerk]: [f64; 2], velocity: f64| {
        let shortest = SHORTEST_LAUNCH.min(time);
        // Where no jerk is limited: that which builds up the acceleration in the time.
        let build_up = time.min(0.5 * velocity / acceleration).max(shortest);
        let jerk = if jerk.is_finite() { jerk } else { acceleration / build_up };
        let time = time.min(acceleration / jerk).min((velocity / jerk).sqrt()).max(shortest);
        jerk.min(acceleration / time).min(velocity / (time * time)) * time.powi(3) / 6.0 / length
    };
    let ([start, end], [after_start, before_end]) = (limits, fastest);
    let [first, last] = [launch(start, after_start.sqrt()), launch(end, before_end.sqrt())];
    match rest {
        // The velocity is not known yet.
        [true, true] => vec![0.5],
        [true, false] if first < 0.8 => vec![first],
        [false, true] if last < 0.8 => vec![1.0 - last],
        _ => Vec::new(),
    }
}

/// Where the acceleration changes in the fastest motion through a cell in which the axes move evenly, between these b at its ends,
/// as parts of its length.
fn even_cuts(pair: &[f64], grid: &Grid, cell: usize) -> Vec<f64> {
    let ([from, to], [[up, _], [down, _]]) = (pair, grid.rest_rates(cell)) else {
        return Vec::new();
    };
    let length = grid.length(cell);
    let most = grid.cell_caps(cell).iter().fold(f64::INFINITY, |most, cap| most.min(cap.v2));
    let (first, last) = (0.5 * (most - from) / up, length - 0.5 * (most - to) / down);
    let at = if first < last {
        vec![(first, most), (last, most)]
    } else {
        let at = (0.5 * (to - from) + down * length) / (up + down);
        vec![(at, from + 2.0 * up * at)]
    };
    // Cells that are over sooner consist of rounding.
    let speed = at.iter().fold(from.max(*to), |most, (_, b)| most.max(*b)).sqrt();
    let least = LEAST_TIME * speed;
    let inner = |at: &f64| *at > least && *at < length - least;
    // Several limits hold at such a node, and only one gets its sensitivity: short cells keep that small.
    let places = at.iter().map(|(at, _)| *at).filter(inner);
    let sides = |at: f64| [-1.0, 0.0, 1.0].map(|side| at + side * SWITCH * speed);
    let mut places: Vec<f64> = places.flat_map(sides).filter(inner).collect();
    places.sort_unstable_by(f64::total_cmp);
    places.dedup_by(|next, before| *next - *before <= least);
    places.into_iter().map(|at| at / length).collect()
}

/// The step so long, s, after the path rested, or before it will.
fn graded(step: f64, from_rest: f64) -> f64 {
    (step * (from_rest / GRADE).clamp(0.125, 1.0)).max(SHORTEST)
}

/// Cuts of a cell that takes `takes` into parts of about `step`, as parts of its length.
fn cuts(pair: &[f64], takes: f64, step: f64) -> Vec<f64> {
    let [from, to] = pair else { return Vec::new() };
    let parts = (takes / step).round().clamp(2.0, 8.0);
    // Evenly where nothing moves.
    let (v0, v1) = if from + to > 0.0 { (from.sqrt(), to.sqrt()) } else { (1.0, 1.0) };
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
