//! Adjoint of the two passes: the sensitivity of their duration to every limit.
//!
//! In a profile of [`reachable::fastest`] every bₖ comes from one of these:
//!
//! - the row that bounds it in the forward pass: it depends on bₖ₋₁,
//! - its cap, in the backward pass,
//! - a row that bounds it in the backward pass: it depends on bₖ₊₁ there,
//! - two rows that meet in the backward pass, near points where an axis has no inertia: it depends on them alone.
//!
//! The time that a larger bₖ saves goes to these limits, and to the b that they depend on: through the forward pass from
//! the last node to the first, then through the backward pass from the first to the last. The result is the derivative of
//! the duration, but near points where an axis has no inertia. There a row trades one b for the other, and the derivative
//! of the passes may have poles of both signs. If a limit then seems to be worth more than the whole duration, the limit of such
//! a row gets all of the time that its b saves and passes none on: no sensitivity is negative, and all together are the duration.

#[cfg(test)]
mod tests;

use super::bound::Constraint;
use super::grid::Grid;
use super::plane::{Bound, Plane, Source};
use super::reachable;
use super::sensitivity::Sensitivity;
use std::collections::BTreeMap;

/// Less, s, is rounding.
const NO_GAIN: f64 = 1e-12;
/// Where the b at the end of a cell has no larger part in the row that bounds it, the b at the start is at the edge of a
/// disc, which leaves one b to the end: the two grow together.
const EDGE: f64 = 1e-6;

/// Sensitivities to the limits where the two passes lead to the profile `b` over all cells of a grid, to rest at its end.
/// The b at its start is given.
pub(super) fn sensitivities(grid: &Grid, b: &[f64]) -> Vec<Sensitivity> {
    let derivative = along(grid, b, f64::INFINITY);
    let mut sums = BTreeMap::<Constraint, f64>::new();
    for Sensitivity { constraint, time, .. } in &derivative {
        *sums.entry(*constraint).or_default() += time;
    }
    let duration = reachable::duration(grid, 0..grid.cells(), b);
    if sums.values().all(|time| time.abs() <= duration) { derivative } else { along(grid, b, 0.0) }
}

/// Sensitivities with rows that trade this part of one b for the other at most.
fn along(grid: &Grid, b: &[f64], traded: f64) -> Vec<Sensitivity> {
    let most = reachable::controllable(grid, 0..grid.cells(), 0.0);
    let mut worth = worth(grid, b);
    let mut adjoint = Adjoint { grid, plane: Plane::default(), traded, gains: BTreeMap::new() };
    let mut passed = 0.0;
    let cells = b.iter().zip(b.iter().zip(&most).skip(1)).enumerate();
    for ((cell, (here, (next, most))), worth) in cells.zip(worth.iter_mut().skip(1)).rev() {
        *worth += std::mem::take(&mut passed);
        if next < most
            && let Some(before) = adjoint.forward(cell, [*here, *next, *most], *worth)
        {
            (passed, *worth) = (before, 0.0);
        }
    }
    // What is left of it goes to the given b at the start.
    passed = 0.0;
    let cells = most.iter().zip(most.iter().skip(1)).enumerate();
    for ((cell, (here, next)), worth) in cells.zip(&worth).skip(1) {
        passed = adjoint.backward(cell, [*here, *next], worth + passed);
    }
    let gains = adjoint.gains.into_iter().filter(|(_, time)| time.abs() > NO_GAIN);
    gains.map(|((cell, constraint), time)| Sensitivity { cell, constraint, time }).collect()
}

/// The time that more b saves at every node, s per b; nothing where the path rests.
fn worth(grid: &Grid, b: &[f64]) -> Vec<f64> {
    let mut worth = vec![0.0; b.len()];
    for (cell, pair) in b.windows(2).enumerate() {
        let [from, to] = [pair.first(), pair.last()].map(|b| b.map_or(0.0, |b| b.sqrt()));
        // −∂/∂b of 2h/(√b₀ + √b₁), but for 1/√b.
        let slope = grid.length(cell) / ((from + to) * (from + to));
        for (worth, root) in worth.iter_mut().skip(cell).zip([from, to]) {
            *worth += if root > 0.0 { slope / root } else { 0.0 };
        }
    }
    worth
}

/// The way back through the passes.
#[derive(Debug)]
struct Adjoint<'g> {
    grid: &'g Grid,
    plane: Plane,
    /// A row trades this part of one b for the other at most.
    traded: f64,
    /// By cell and limit: one that bounds both b of a cell may do so to one at the cost of the other.
    gains: BTreeMap<(usize, Constraint), f64>,
}

impl Adjoint<'_> {
    /// Gives the worth of the b at the end of a cell, `next`, to the row that bounds it in the forward pass; what that
    /// leaves to the b at the start, `here`. None if `next` is the b of the backward pass, but for rounding.
    fn forward(&mut self, cell: usize, [here, next, most]: [f64; 3], worth: f64) -> Option<f64> {
        if next <= 0.0 {
            return Some(0.0);
        }
        self.plane.set(self.grid, cell);
        let Bound { row: [p, r], source, .. } = self.plane.bound_after(here, most);
        if source == Source::Given {
            return None;
        }
        if r * next <= EDGE {
            return Some(worth * next / here);
        }
        // What goes to the b at the start is the worth of a part of this one, and the limit gets the rest.
        let passed = -worth * next * (p * here / (r * next)).min(self.traded);
        self.gain(cell, source, worth * next - passed);
        Some(passed / here)
    }

    /// Gives the worth of the b at the start of a cell, `here`, to what bounds it in the backward pass; what that leaves
    /// to the b at the end, `next`.
    fn backward(&mut self, cell: usize, [here, next]: [f64; 2], worth: f64) -> f64 {
        if here <= 0.0 || worth == 0.0 {
            return 0.0;
        }
        if let Some(cap) = self.grid.caps().get(cell).filter(|cap| here >= cap.v2) {
            let constraint = Constraint::Velocity(cap.source);
            self.add(cell.saturating_sub(1), constraint, worth * here * cap.source.share());
            return 0.0;
        }
        self.plane.set(self.grid, cell);
        let [low, high] = self.plane.bounds_before(here, next);
        // They meet in x = (rₕ·1ₗ − rₗ·1ₕ)/(pₗ·rₕ − pₕ·rₗ), where 1ₗ and 1ₕ are their right sides.
        let ([pl, rl], [ph, rh]) = (low.row, high.row);
        let bottom = pl * rh - ph * rl;
        if bottom <= 0.0 {
            return 0.0;
        }
        // Together they get the time that all of this b saves.
        let whole = worth * here;
        let part = (-worth * rl / bottom / whole).clamp(-self.traded, 1.0 + self.traded);
        let of_high = whole * part;
        self.gain(cell, low.source, whole - of_high);
        self.gain(cell, high.source, of_high);
        if high.source == Source::Given { of_high * rh } else { 0.0 }
    }

    fn gain(&mut self, cell: usize, source: Source, time: f64) {
        if let Some(constraint) = self.plane.constraint(self.grid, source) {
            self.add(cell, constraint, time);
        }
    }

    fn add(&mut self, cell: usize, constraint: Constraint, time: f64) {
        *self.gains.entry((cell, constraint)).or_default() += time;
    }
}
