//! Cell refinement where the acceleration changes much, without jerk limits.

use super::Planner;
use super::refine::SHORTEST;
use crate::planned_motion::ProfileSegment;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::bound::AxisLimits;
use crate::time_optimal::cell::{Cell, Sample};
use twin_path::prepare::CheckedElement;

/// An acceleration may change by this part of its limit from one end of a cell to the other.
const EVEN: f64 = 0.1;
/// One that is less than this part of its limit at both ends costs nothing.
const FELT: f64 = 0.8;
/// Largest number of cuts of a cell, and of the parts of each cut.
pub(super) const MOST_CUTS: u32 = 3;
const MOST_PARTS: f64 = 8.0;

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Cuts cells in which an acceleration that is asked for in full at one end is much less at the other: with the same ü all
    /// over the cell and limits at both of its ends the path would be slower than it can be. Whether there were any.
    pub(super) fn even_out(&mut self, stretches: &[ProfileSegment]) -> bool {
        let known = std::mem::take(&mut self.cells);
        let fresh = self.kept.len().saturating_sub(1);
        let count = known.len();
        for (index, (cell, stretch)) in known.into_iter().zip(stretches).enumerate() {
            let change = changes(&cell, self.sampler.axes().limits(), stretch);
            let shortest = 2.0 * stretch.duration() / SHORTEST;
            let parts = (change / EVEN).ceil().min(shortest.floor()).min(MOST_PARTS);
            let at = std::iter::successors(Some(1.0), |part| Some(part + 1.0));
            let at: Vec<f64> =
                at.take_while(|part| *part < parts).map(|part| part / parts).collect();
            if !at.is_empty()
                && let Ok(parts) = self.sampler.parts(&cell, &at)
                && parts.len() == at.len() + 1
            {
                self.budget.sampled(parts.len());
                if index < fresh {
                    self.keep_within(self.cells.len(), stretch, &at);
                }
                self.cells.extend(parts);
            } else {
                self.cells.push(cell);
            }
        }
        self.cells.len() > count
    }

    /// The cell `index`, which was planned before, is cut at these parts of its length.
    pub(super) fn keep_within(&mut self, index: usize, stretch: &ProfileSegment, at: &[f64]) {
        let place = (index + 1).min(self.kept.len());
        let between = at.iter().map(|part| stretch.at_position(part * stretch.length()).0);
        self.kept.splice(place..place, between);
    }
}

/// By how much an acceleration changes in a cell, at most, as a part of its limit.
fn changes(cell: &Cell, limits: &[AxisLimits], stretch: &ProfileSegment) -> f64 {
    let ends = [(&cell.start, 0.0), (&cell.end, stretch.length())];
    let [start, end] =
        ends.map(|(sample, u)| accelerations(sample, limits, stretch.at_position(u)));
    start.zip(end).fold(0.0, |most: f64, (start, end)| {
        if start.abs().max(end.abs()) < FELT { most } else { most.max((end - start).abs()) }
    })
}

/// Of the axes and along the path, as parts of their limits, with these b and a.
fn accelerations(
    sample: &Sample,
    limits: &[AxisLimits],
    (b, a): (f64, f64),
) -> impl Iterator<Item = f64> {
    let rates = sample.rates.first.iter().zip(sample.rates.second.iter());
    let axes = rates.zip(limits);
    let axes = axes.map(move |((first, second), limits)| {
        let acceleration = first * a + second * b;
        acceleration / limits.acceleration_at(*first, acceleration)
    });
    let along = sample.along.iter().map(move |row| row.a * a + row.b * b);
    axes.chain(along)
}
