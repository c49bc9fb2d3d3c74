//! Committed part of a window, and the fallback when a window cannot be planned.

use super::refine::time;
use super::{Leg, LimitError, Planned, Planner};
use crate::planned_motion::ProfileSegment;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::convex::NotSolved;
use crate::time_optimal::grid::Grid;
use crate::time_optimal::reachable;
use crate::time_optimal::smooth::Beginning;
use std::sync::Arc;
use twin_path::Place;
use twin_path::prepare::CheckedElement;

/// So many times the time in which acceleration builds up is left between what is committed and where the end of the window
/// begins to be felt.
const MARGIN: f64 = 4.0;
/// And at least so long, s: where cells further on have become shorter they may ask for a little earlier braking.
const LEAST_MARGIN: f64 = 0.06;
/// Additional room of earlier plans with limited jerk when they are planned again.
pub(super) const KEPT_ROOM: [f64; 3] = [3e-4, 2e-3, 1e-6];

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Number of cells that can be committed, because the provisional end of the window has no influence on them; and
    /// the number that it does not slow down.
    pub(super) fn safe(&self, grid: &Grid) -> (usize, usize) {
        let cells = 0..grid.cells();
        if self.stops() {
            return (cells.end, cells.end);
        }
        let stopping = reachable::controllable(grid, cells.clone(), 0.0);
        let free = reachable::controllable(grid, cells, f64::INFINITY);
        let pairs = stopping.iter().zip(&free);
        let free = pairs.take_while(|(s, f)| **s >= **f * (1.0 - 1e-9)).count().saturating_sub(1);
        // Jerk limits ask for braking earlier: by the time in which the acceleration comes and goes, and a margin.
        let mut left = LEAST_MARGIN.max(MARGIN * self.build_up());
        let mut end = free;
        let (b, _) = self.estimate(grid);
        while end > 0 && left > 0.0 {
            end -= 1;
            left -= time(b.get(end..end + 2).unwrap_or_default(), grid.length(end), false);
        }
        (end, free)
    }

    /// Time in which the acceleration of the slowest axis builds up, s: A/J, but at most √(2V/J), where a jerk and its opposite
    /// lead from −V to V. An acceleration that no motion reaches makes no difference.
    pub(super) fn build_up(&self) -> f64 {
        let limits = self.sampler.axes().limits().iter();
        let times = limits.filter_map(|limits| {
            let jerk = limits.jerk?;
            let reversal = (2.0 * limits.velocity / jerk).sqrt();
            Some((limits.largest_acceleration() / jerk).min(reversal))
        });
        times.fold(0.0, f64::max)
    }

    /// Goes to rest as the last window had it, after a window that could not be planned.
    pub(super) fn fall_back(&mut self, error: NotSolved) {
        let tail = std::mem::take(&mut self.tail);
        let Some(last) = tail.last() else {
            let place = self.rest_instead();
            self.ready.push_back(Err(LimitError::NotSolved { place, error }));
            return;
        };
        let (element, at) = (Arc::clone(&last.element), last.from + last.stretch.length());
        let near = last.start;
        self.ready.extend(tail.into_iter().map(|leg| Ok(Planned::Leg(leg))));
        self.unplan();
        self.skip_to(&element, at);
        self.near = near;
        self.beginning = Beginning::Rest;
        // It was to be held further on, if at all.
        self.held = self.asked <= 0.0;
    }

    /// Gives up the cells at hand and begins again from rest behind them; the place where they began.
    pub(super) fn rest_instead(&mut self) -> Place {
        let place = self.cells.first().map_or(Place::default(), |cell| cell.element.place());
        self.ready
            .extend(std::mem::take(&mut self.tail).into_iter().map(|leg| Ok(Planned::Leg(leg))));
        self.cells.clear();
        self.kept.clear();
        self.beginning = Beginning::Rest;
        place
    }

    /// Hands out the first `end` cells, some, keeps those up to `free` and prepares the rest for the next window.
    pub(super) fn commit(&mut self, stretches: &[ProfileSegment], (end, free): (usize, usize)) {
        let legs = self.cells.iter().zip(stretches).map(|(cell, stretch)| Leg {
            element: Arc::clone(&cell.element),
            from: cell.from,
            stretch: *stretch,
            start: cell.start.position,
            is_even: cell.is_even,
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
        if self.jerk_limited {
            self.loosen(free - end, KEPT_ROOM);
        }
        self.coarsen(free - end);
    }

    /// Makes the cells from `index` on as coarse as they came.
    pub(super) fn coarsen(&mut self, index: usize) {
        let fine = self.cells.split_off(index.min(self.cells.len()));
        let mut near = fine.first().map_or(self.near, |cell| cell.start.position);
        for part in fine.chunk_by(|one, next| Arc::ptr_eq(&one.element, &next.element)) {
            let ([first, ..], [.., last]) = (part, part) else { continue };
            let known = self.cells.len();
            let range = first.from..last.to;
            if self.sampler.cells(&first.element, range, &near, &mut self.cells).is_err() {
                // What cannot be sampled at other places stays as it is.
                self.cells.truncate(known);
                self.cells.extend_from_slice(part);
            }
            self.join(known);
            near = self.near;
        }
    }
}
