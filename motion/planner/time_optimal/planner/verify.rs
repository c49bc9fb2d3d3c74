//! Verification of a profile between the nodes of its grid, and tighter limits or shorter cells where it exceeds them.

use super::Planner;
use super::commit::KEPT_ROOM;
use super::refine::SHORTEST;
use crate::planned_motion::ProfileSegment;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::cell::Cell;
use crate::time_optimal::rows::LEAST_TIME;
use crate::time_optimal::smooth::{Broken, Guess};
use twin_path::prepare::CheckedElement;

/// Acceleration, jerk and velocity between the places where limits are asked for may be so much of the limit; a cell in which
/// they are more than the second number is too long.
const ALLOWED: [[f64; 2]; 3] = [[1.0005, 1.01], [1.045, 1.2], [1.0005, 1.01]];
/// Where the jerk is in what [`Planner::worst`] gives.
const JERK: usize = 1;
/// Largest number of rounds that cut cells in half: a shorter cell gives the profile more freedom, which it may use to exceed
/// limits somewhere else.
pub(super) const HALVING: u32 = 6;
/// Cells of fewer times the shortest are not cut often any more.
const FEW_CUTS: f64 = 4.0;
/// Factor by which a limit is tightened further if it is still exceeded.
const AGAIN: i32 = 4;

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Looks between the places where limits were asked for. Where they are exceeded, limits are made tighter, or asked for at
    /// more places, and in the first rounds cells are cut in half where they are exceeded by much. Those cells, by their new
    /// numbers; `guess` is fitted to the new ones. Cells before `first` stay as they are.
    pub(super) fn tighten(
        &mut self,
        stretches: &[ProfileSegment],
        (first, round): (usize, u32),
        broken: &Broken,
        mut guess: Option<&mut Guess>,
    ) -> Vec<usize> {
        let fresh = self.kept.len().saturating_sub(1);
        self.budget.looked(self.cells.len());
        let mut cells = Vec::with_capacity(self.cells.len());
        let mut changed = Vec::new();
        let known = std::mem::take(&mut self.cells);
        let last = known.len().saturating_sub(1);
        for (index, (mut cell, stretch)) in known.into_iter().zip(stretches).enumerate() {
            let worst = self.worst(&cell, stretch);
            let kept = index < fresh;
            if index < first || !exceeds(worst, kept) {
                cells.push(cell);
                continue;
            }
            // Accelerations at a node are asked for in the cell before it.
            if broken.has(index) || index.checked_sub(1).is_some_and(|before| broken.has(before)) {
                // Limits that were left out will be kept the next time. How much is exceeded then is another question.
                changed.push(cells.len());
                cells.push(cell);
                continue;
            }
            let moved = guess.as_ref().is_some_and(|guess| guess.has_moved(cells.len()));
            if moved && round < HALVING {
                // It is solved again anyway, unless that goes to and fro.
                cells.push(cell);
                continue;
            }
            // What was planned before with limited jerk stays on its nodes: on others there may be no such plan.
            let free = !kept || !self.jerk_limited;
            let too_long = is_too_long(worst);
            let rest = self.jerk_limited && (index == 0 || index == last);
            let halve = round < HALVING && free && too_long && !rest;
            if halve && stretch.duration() > SHORTEST {
                cell.tight = [1.0; 3];
                // Halves with jerks limited in their middles alone would have as much freedom at their ends, and these cannot be
                // cut much further.
                let [_, jerk, _] = worst;
                cell.dense |= jerk > ALLOWED[JERK][1] && stretch.duration() < FEW_CUTS * SHORTEST;
                if let Ok(parts) = self.sampler.parts(&cell, &[0.5])
                    && parts.len() == 2
                {
                    self.budget.sampled(parts.len());
                    if let Some(guess) = guess.as_deref_mut() {
                        guess.cut(cells.len(), &[0.5]);
                    }
                    changed.extend([cells.len(), cells.len() + 1]);
                    if kept {
                        self.keep_within(cells.len(), stretch, &[0.5]);
                    }
                    cells.extend(parts);
                    continue;
                }
            }
            changed.push(cells.len());
            for (kind, (worst, allowed)) in worst.into_iter().zip(allowed(kept)).enumerate() {
                if worst <= allowed {
                    continue;
                }
                if kind == JERK && !cell.dense {
                    cell.dense = true;
                } else if let Some(tight) = cell.tight.get_mut(kind) {
                    let factor = worst / (1.0 + 0.5 * (allowed - 1.0));
                    // Between the ends of the cell it may be more than at the ends, where it did not help then.
                    let again = if *tight > 1.0 { AGAIN } else { 1 };
                    *tight *= factor.powi(again).min(2.0);
                }
            }
            cells.push(cell);
        }
        self.cells = cells;
        changed
    }

    /// The largest acceleration, jerk and velocity in a cell as parts of the limits.
    pub(super) fn worst(&self, cell: &Cell, stretch: &ProfileSegment) -> [f64; 3] {
        let mut worst = [0.0_f64; 3];
        let limits = self.sampler.axes().limits();
        // What jerk limits have smoothed is not so far from the places where it is known.
        let smooth = self.jerk_limited && !self.options.course.turning;
        let step = match (cell.is_even, smooth) {
            // The largest values are at the ends.
            (true, _) => 8,
            (false, true) => 2,
            (false, false) => 1,
        };
        let eighths = (0..=8_u8).step_by(step);
        let mut before: [Option<f64>; 2] = [None; 2];
        for eighth in eighths {
            let u = 0.125 * f64::from(eighth) * cell.length();
            let between;
            let sample = match eighth {
                0 => &cell.start,
                4 => &cell.middle,
                8 => &cell.end,
                _ => {
                    let s = cell.from + u;
                    let Ok(sample) = self.sampler.sample(&cell.element, s, &cell.start.position)
                    else {
                        continue;
                    };
                    between = sample;
                    &between
                }
            };
            let excess = sample.excess(limits, stretch, u);
            for (worst, excess) in worst.iter_mut().zip(excess) {
                *worst = worst.max(excess);
            }
            let [now, ..] = excess;
            if let [Some(earlier), Some(last)] = before {
                worst[0] = worst[0].max(highest(earlier, last, now));
            }
            before = [before[1], Some(now)];
        }
        if stretch.duration() < LEAST_TIME {
            worst[JERK] = 0.0;
        }
        worst
    }
}

/// The highest point of a parabola through three values at equal distances, between the first and the last.
fn highest(before: f64, here: f64, after: f64) -> f64 {
    let slope = 0.5 * (after - before);
    let bend = 2.0 * here - before - after;
    if slope.abs() < bend { here + 0.5 * slope * slope / bend } else { before.max(after) }
}

/// True if a limit in a cell is exceeded so much that the cell is too long.
pub(super) fn is_too_long(worst: [f64; 3]) -> bool {
    worst.iter().zip(ALLOWED).any(|(worst, [_, far])| *worst > far)
}

/// True if a limit in a cell is exceeded. Cells of an earlier plan (`kept`) have the additional room of replanning.
pub(super) fn exceeds(worst: [f64; 3], kept: bool) -> bool {
    worst.iter().zip(allowed(kept)).any(|(worst, allowed)| *worst > allowed)
}

/// So much may be between the places where limits are asked for, as a part of the limits.
fn allowed(kept: bool) -> [f64; 3] {
    let mut allowed = ALLOWED.map(|[allowed, _]| allowed);
    if kept {
        for (allowed, room) in allowed.iter_mut().zip(KEPT_ROOM) {
            *allowed *= 1.0 + room;
        }
    }
    allowed
}
