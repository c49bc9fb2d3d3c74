//! Sensitivity of the duration to the limits: from the multipliers of the convex programs where jerks are limited, else
//! from the difference that a limit makes which is a little higher.

#[cfg(test)]
#[allow(clippy::expect_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]
mod tests;

use super::bound::Constraint;
use super::convex::Origin;
use super::grid::Grid;
use super::reachable;

/// The part by which a limit is raised.
const RAISED: f64 = 1e-4;

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
pub(super) fn of_passes(grid: &Grid, b: &[f64]) -> Vec<Sensitivity> {
    let (Some(start), Some(end)) = (b.first(), b.last()) else { return Vec::new() };
    let mut result = Vec::new();
    for constraint in grid.constraints() {
        let raised = grid.raised(constraint, 1.0 + RAISED);
        let faster = reachable::fastest(&raised, 0..grid.cells(), *start, *end);
        let pairs = b.windows(2).zip(faster.windows(2)).enumerate();
        result.extend(pairs.filter(|(_, (b, faster))| b != faster).map(|(cell, pairs)| {
            let times: [f64; 2] =
                [pairs.0, pairs.1].map(|b| reachable::duration(grid, cell..cell + 1, b));
            Sensitivity { cell, constraint, time: (times[0] - times[1]) / RAISED }
        }));
    }
    result
}
