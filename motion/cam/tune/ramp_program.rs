//! A place in the search for a ramp, and the linear program that says where a better one is.

use super::ramp_in::Values;
use super::reshape::rows::Rows;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};

/// What an excess costs from there on: more than any limit is worth.
pub(super) const DEAR: f64 = 20.0;
/// So far from its limits a ramp stays, so that the last digits of a program keep them.
const MARGIN: f64 = 1e-7;

/// A ramp and what it is judged by: parts of the aim, and parts beyond limits.
pub(super) struct Place {
    pub(super) at: Values,
    pub(super) aims: Vec<Option<f64>>,
    pub(super) beyond: Vec<Option<f64>>,
}

fn greatest(parts: &[Option<f64>]) -> f64 {
    parts.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max)
}

impl Place {
    pub(super) fn aim(&self) -> f64 {
        greatest(&self.aims)
    }

    pub(super) fn cost(&self, of_excess: f64) -> f64 {
        self.aim() + of_excess * (greatest(&self.beyond) + MARGIN).max(0.0)
    }
}

/// How parts change with one value.
#[derive(Default)]
pub(super) struct Slope {
    pub(super) aims: Vec<f64>,
    pub(super) beyond: Vec<f64>,
}

/// The best place in a region if all is linear there: by how much each value is to be changed, and what is gained.
pub(super) fn program(
    place: &Place,
    slopes: &[Slope],
    most: &Values,
    region: f64,
) -> Option<(Vec<f64>, f64)> {
    let n = slopes.len();
    let (aim, cost) = (place.aim(), place.cost(DEAR));
    // The unknowns are parts of the region, how much greater the aim is, and how large the excess, as parts of it as well.
    let mut rows = Rows::new(n + 2);
    let of = |slopes: Vec<f64>| slopes.into_iter().enumerate();
    let size = |slopes: &[f64]| slopes.iter().map(|slope| slope.abs()).sum::<f64>();
    for (index, value) in place.aims.iter().enumerate() {
        let Some(value) = value else { continue };
        let slopes: Vec<_> =
            slopes.iter().map(|slope| slope.aims.get(index).copied().unwrap_or(0.0)).collect();
        rows.add(of(slopes).chain([(n, -1.0)]), (aim - value) / region);
    }
    for (index, value) in place.beyond.iter().enumerate() {
        let Some(value) = value.map(|value| value + MARGIN) else { continue };
        let slopes: Vec<_> =
            slopes.iter().map(|slope| slope.beyond.get(index).copied().unwrap_or(0.0)).collect();
        // What is not reached in the region holds nothing.
        if value + size(&slopes) * region > 0.0 {
            rows.add(of(slopes).chain([(n + 1, -1.0)]), -value / region);
        }
    }
    rows.add([(n + 1, -1.0)].into_iter(), 0.0);
    for (column, (at, most)) in place.at.iter().zip(most).take(n).enumerate() {
        rows.add([(column, 1.0)].into_iter(), ((most - at) / region).clamp(0.0, 1.0));
        rows.add([(column, -1.0)].into_iter(), 1.0);
    }
    let count = rows.count();
    let (matrix, right) = rows.into_matrix();
    let mut costs = vec![0.0; n];
    costs.extend([1.0, DEAR]);
    let cones = [SupportedConeT::NonnegativeConeT(count)];
    let settings: DefaultSettings<f64> =
        DefaultSettingsBuilder::default().verbose(false).build().unwrap_or_default();
    let none = CscMatrix::zeros((n + 2, n + 2));
    let mut solver = DefaultSolver::new(&none, &costs, &matrix, &right, &cones, settings).ok()?;
    solver.solve();
    if !matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
        return None;
    }
    let mut found = std::mem::take(&mut solver.solution.x);
    let (excess, more) = (found.pop()?, found.pop()?);
    let promised = cost - (aim + region * more + DEAR * region * excess.max(0.0));
    Some((found.into_iter().map(|part| part.clamp(-1.0, 1.0) * region).collect(), promised))
}
