//! Shift of the sensitivities when variables are worth more than Clarabel assumed.
//!
//! More worth w per variable does not change a solution that is held by as many rows as it has variables: these rows
//! cost more, by the Δλ with Aᵀ·Δλ = w. The multipliers show which rows hold it. If more rows hold it than are needed,
//! they share the cost by their multipliers: with D the multipliers, the Δλ that is least by D⁻² is
//!
//! ```text
//!   Δλ = D²·A·y    with    Aᵀ·D²·A·y = w,
//! ```
//!
//! tridiagonal, since rows are of two neighbours.

use crate::time_optimal::convex::{Hold, Program};

/// What is left of a diagonal by less than this part is rounding: nothing holds that variable.
const ROUNDING: f64 = 1e-13;

/// Adds Δλ to the multipliers.
pub(super) fn shift(program: &Program, duals: &mut [f64], worth: &[f64]) {
    let holds: Vec<Hold> = program.holds(duals).filter(|hold| hold.dual > 0.0).collect();
    let y = solve(&holds, worth);
    for hold in holds {
        let along: f64 = hold
            .entries
            .iter()
            .map(|(column, value)| value * y.get(*column).copied().unwrap_or_default())
            .sum();
        // Δλ/λ.
        let part = hold.dual * along;
        for dual in duals.get_mut(hold.duals).unwrap_or_default() {
            *dual *= (1.0 + part).max(0.0);
        }
    }
}

/// Solves Aᵀ·D²·A·y = w.
fn solve(holds: &[Hold], worth: &[f64]) -> Vec<f64> {
    let mut diagonal = vec![0.0; worth.len()];
    let mut beside = vec![0.0; worth.len()];
    for Hold { entries: [(first, p), (second, r)], dual, .. } in holds {
        let weight = dual * dual;
        for (column, value) in [(first, p), (second, r)] {
            if let Some(slot) = diagonal.get_mut(*column) {
                *slot += weight * value * value;
            }
        }
        if let Some(slot) = beside.get_mut(*first.min(second)) {
            *slot += weight * p * r;
        }
    }
    let mut left: Vec<[f64; 2]> = Vec::with_capacity(worth.len());
    let (mut pivot, mut rest, mut above) = (1.0, 0.0, 0.0);
    for ((diagonal, beside), worth) in diagonal.iter().zip(&beside).zip(worth) {
        let factor: f64 = above / pivot;
        (pivot, rest) = (diagonal - factor * above, worth - factor * rest);
        above = *beside;
        if pivot <= diagonal * ROUNDING {
            (pivot, rest, above) = (f64::INFINITY, 0.0, 0.0);
        }
        left.push([pivot, rest]);
    }
    let mut result = vec![0.0; worth.len()];
    let mut next = 0.0;
    for ((slot, [pivot, rest]), beside) in result.iter_mut().zip(left).zip(beside).rev() {
        next = (rest - beside * next) / pivot;
        *slot = next;
    }
    result
}
