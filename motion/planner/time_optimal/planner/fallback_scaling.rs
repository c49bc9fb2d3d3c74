//! Fallback scaling: a profile with limited jerk, scaled down from a guess, for windows where Clarabel finds none.

use super::Planner;
use super::verify::exceeds;
use super::window::{can_be_followed, stretches};
use crate::planned_motion::ProfileSegment;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::sample::grid;
use crate::time_optimal::smooth::Beginning;
use twin_path::prepare::CheckedElement;

/// So often every value of the first guess is made a mean of its neighbours before it is slowed down.
const SMOOTHED: [usize; 6] = [0, 16, 64, 256, 1024, 4096];
/// It is looked so often how much slower it has to be: all but drag of motors is known after the first.
const LOOKS: u32 = 8;
/// A profile that all but rests on the way would be smoothed to rest around there: c is this part of the largest at least.
const LEAST: f64 = 1e-6;

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// From rest to rest, within all limits: with u̇ k times what it is on any profile with a continuous ü accelerations are k² times
    /// what they are and jerks k³ times. The fastest that comes of the first guess; none if the window does not begin at rest.
    pub(super) fn slowed(&mut self) -> Option<Vec<ProfileSegment>> {
        if self.beginning != Beginning::Rest {
            return None;
        }
        let mut guess = self.first_guess();
        self.subdivide(&mut guess);
        self.bend(&mut guess);
        let largest = guess.c.iter().copied().fold(0.0, f64::max);
        let mut logs: Vec<f64> = guess.c.iter().map(|c| c.max(LEAST * largest).ln()).collect();
        let mut fastest: Option<(f64, Vec<ProfileSegment>)> = None;
        let mut passes = 0;
        for wanted in SMOOTHED {
            while passes < wanted {
                smooth(&mut logs);
                passes += 1;
            }
            let c: Vec<f64> = logs.iter().map(|log| log.exp()).collect();
            let Some(slowed) = self.slow_down(&c) else { continue };
            let duration = slowed.iter().map(ProfileSegment::duration).sum();
            if fastest.as_ref().is_none_or(|(least, _)| duration < *least) {
                fastest = Some((duration, slowed));
            }
        }
        let (_, slowed) = fastest?;
        // What was asked for in vain is not asked for any more: the next window begins as this one is left.
        for (cell, stretch) in self.cells.iter_mut().zip(&slowed) {
            (cell.tight, cell.dense) = ([1.0; 3], false);
            cell.take_tangents(stretch);
        }
        Some(slowed)
    }

    /// The profile of these c, as fast as the limits let it be.
    fn slow_down(&mut self, c: &[f64]) -> Option<Vec<ProfileSegment>> {
        let grid = grid(&self.sampler, &self.cells);
        let mut profile = self.smooth.profile(&grid, self.beginning, c);
        for _ in 0..LOOKS {
            let found = stretches(&grid, &profile);
            if !can_be_followed(&found) {
                return None;
            }
            let [acceleration, jerk, velocity] = self.worst_of(&found);
            let b = acceleration.recip().min(jerk.powf(-2.0 / 3.0)).min(velocity.powi(-2));
            if !(b.is_finite() && b > 0.0) {
                return None;
            }
            profile.scale(b);
            let slower = stretches(&grid, &profile);
            if !exceeds(self.worst_of(&slower), false) {
                return Some(slower);
            }
        }
        None
    }

    /// The largest acceleration, jerk and velocity, as parts of the limits, those at joints included.
    fn worst_of(&self, stretches: &[ProfileSegment]) -> [f64; 3] {
        let cells = self.cells.iter().zip(stretches);
        cells.fold([0.0; 3], |[a, j, v]: [f64; 3], (cell, stretch)| {
            let [acceleration, jerk, velocity] = self.worst(cell, stretch);
            let (b, _) = stretch.at_position(stretch.length());
            let joint = (b / cell.joint.v2).sqrt();
            [a.max(acceleration), j.max(jerk), v.max(velocity).max(joint)]
        })
    }
}

/// Every value, but the first and the last, the mean of itself and its neighbours.
fn smooth(values: &mut [f64]) {
    let Some(mut before) = values.first().copied() else { return };
    for index in 1..values.len().saturating_sub(1) {
        let Some([here, after]) = values.get_mut(index..index + 2) else { return };
        let mean = (before + *here + *after) / 3.0;
        before = std::mem::replace(here, mean);
    }
}
