//! Drag on the axes: linearised (tangents) at the velocity of the motion.

use super::Planner;
use crate::planned_motion::ProfileSegment;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::cell::{Cell, Sample};
use crate::time_optimal::drag::DragRow;
use std::sync::Arc;
use twin_path::prepare::CheckedElement;

/// Drag may be counted for too much by this part of a limit.
const SURPLUS: f64 = 1e-4;
/// A row this near to its limit holds the motion back.
const HOLDS: f64 = 0.99;
/// Tangents are taken again at most so often in a window.
pub(super) const MOST_TANGENTS: u32 = 12;

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Takes the tangent of the drag at the present velocity in cells where drag holds the motion back and is
    /// overestimated; that allows the present motion and faster ones. Returns the numbers of these cells.
    pub(super) fn take_tangents(&mut self, stretches: &[ProfileSegment]) -> Vec<usize> {
        let rows = self.sampler.axes().further_rows();
        if rows == 0 {
            return Vec::new();
        }
        let mut changed = Vec::new();
        for (index, (cell, stretch)) in self.cells.iter_mut().zip(stretches).enumerate() {
            let tight = cell.tight.first().copied().unwrap_or(1.0);
            let ends = [(&mut cell.start, 0.0), (&mut cell.end, stretch.length())];
            let taken = ends.map(|(end, u)| {
                let (b, a) = stretch.at_position(u);
                let velocity = b.sqrt();
                let surplus = |row: &DragRow| {
                    let surplus = row.surplus(velocity, end.reference);
                    surplus > SURPLUS && (row.part(a, velocity) + surplus) * tight >= HOLDS
                };
                let exact = !end.further.iter().take(rows).any(surplus);
                if !exact {
                    Arc::make_mut(end).reference = velocity;
                }
                !exact
            });
            if taken != [false; 2] {
                changed.push(index);
            }
        }
        changed
    }

    /// Counts drag as it is at the velocities of the plan so far, as far as the cells go along that.
    pub(super) fn take_tangents_of_plan(&mut self) {
        if self.sampler.axes().further_rows() == 0 {
            return;
        }
        let mut legs = self.tail.iter();
        let Some(mut leg) = legs.next() else { return };
        for cell in &mut self.cells {
            let middle = cell.from.midpoint(cell.to);
            while !Arc::ptr_eq(&leg.element, &cell.element)
                || middle > leg.from + leg.stretch.length()
            {
                let Some(next) = legs.next() else { return };
                leg = next;
            }
            let velocity = |s: f64| leg.stretch.at_position((s - leg.from).max(0.0)).0.sqrt();
            Arc::make_mut(&mut cell.start).reference = velocity(cell.from);
            Arc::make_mut(&mut cell.end).reference = velocity(cell.to);
        }
    }
}

impl Cell {
    /// Counts drag as it is at the velocities of `stretch`.
    pub(super) fn take_tangents(&mut self, stretch: &ProfileSegment) {
        let take = |end: &mut Arc<Sample>, u: f64| {
            Arc::make_mut(end).reference = stretch.at_position(u).0.sqrt();
        };
        take(&mut self.start, 0.0);
        take(&mut self.end, stretch.length());
    }
}
