//! Sensitivity of the duration to the limits: from the adjoint of the two passes, or the multipliers of a convex program.

use super::bound::Constraint;
use super::convex::Origin;

/// Sensitivity of the duration to one limit in one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    /// The cell, from that of the window.
    pub cell: usize,
    /// The limit.
    pub constraint: Constraint,
    /// By how much shorter the window would take per part by which the limit is raised, s: at 20 % more about a fifth of
    /// it, as long as nothing else holds the path back. Less than 0 where it would take longer.
    pub time: f64,
}

/// Sensitivities from the multipliers of a convex program.
pub(super) fn gains(multipliers: &[(Origin, f64)]) -> Vec<Sensitivity> {
    let of = |(origin, time): &(Origin, f64)| Sensitivity {
        cell: origin.cell,
        constraint: origin.constraint,
        time: *time,
    };
    multipliers.iter().map(of).collect()
}
