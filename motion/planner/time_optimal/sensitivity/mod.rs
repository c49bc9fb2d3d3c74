//! Sensitivity of the duration to the limits: from the multipliers of the convex programs where jerks are limited, else
//! from the difference that a limit makes which is a little higher or lower.

#[cfg(test)]
#[allow(clippy::expect_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]
mod tests;

use super::bound::Constraint;
use super::convex::Origin;
use super::grid::Grid;
use super::reachable;

/// The part by which a limit is raised, and lowered.
const CHANGED: f64 = 1e-4;

/// Sensitivity of the duration to one limit in one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    /// The cell, from that of the window.
    pub cell: usize,
    /// The limit.
    pub constraint: Constraint,
    /// By how much shorter the window would take per part by which the limit is raised, s: at 20 % more about a fifth of
    /// it, as long as nothing else holds the path back.
    pub time: f64,
}

pub(super) fn gains(multipliers: &[(Origin, f64)]) -> Vec<Sensitivity> {
    let of = |(origin, time): &(Origin, f64)| Sensitivity {
        cell: origin.cell,
        constraint: origin.constraint,
        time: *time,
    };
    multipliers.iter().map(of).collect()
}

/// Sensitivities of the profile `b` that two passes have found over all of `grid`.
///
/// Around points where an axis has no inertia two passes come to more or less of the optimum, by jumps. A limit is
/// therefore both raised and lowered, and that counts which changes less.
pub(super) fn of_passes(grid: &Grid, b: &[f64]) -> Vec<Sensitivity> {
    let (Some(start), Some(end)) = (b.first(), b.last()) else { return Vec::new() };
    let times = |b: &[f64]| -> Vec<f64> {
        let cells = b.windows(2).enumerate();
        cells.map(|(cell, b)| reachable::duration(grid, cell..cell + 1, b)).collect()
    };
    let known = times(b);
    let mut result = Vec::new();
    for constraint in grid.active(b) {
        let changes = [CHANGED, -CHANGED].map(|part| {
            let changed = grid.raised(constraint, 1.0 + part);
            let changed = times(&reachable::fastest(&changed, 0..grid.cells(), *start, *end));
            let pairs = known.iter().zip(changed);
            pairs.map(|(known, changed)| (known - changed) / part).collect::<Vec<f64>>()
        });
        let [raised, lowered] = changes;
        let size = |times: &[f64]| times.iter().sum::<f64>().abs();
        let less = if size(&raised) <= size(&lowered) { raised } else { lowered };
        let felt = less.into_iter().enumerate().filter(|(_, time)| *time != 0.0);
        result.extend(felt.map(|(cell, time)| Sensitivity { cell, constraint, time }));
    }
    result
}
