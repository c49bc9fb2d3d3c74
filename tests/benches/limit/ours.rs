//! Methods of `motion/planner/time_optimal` (time-optimal planning) under measurement.

use crate::curves::Curve;
use crate::machines::Machine;
use crate::path::{Path, Rates};
use crate::solvers::{Fineness, grid, passes, planned};
use twin_planner::time_optimal::Grid;

/// A path on a grid, and between its nodes.
pub struct Problem<'a> {
    pub path: &'a Path,
    /// The path as [`grid`] makes it, without jerk limits.
    pub grid: &'a Grid,
    pub rates: &'a dyn Fn(f64) -> Rates,
}

/// Result of a method.
#[derive(Clone, Copy)]
pub struct Found {
    /// Of the profile, s.
    pub duration: f64,
    /// Cells that it has.
    pub cells: usize,
    /// Windows without an answer.
    pub failed: u64,
}

/// One way to limit a path.
#[derive(Clone, Copy)]
pub struct Method {
    pub name: &'static str,
    /// True if the rows are those of the peer: velocity and acceleration on the same grid.
    pub same: bool,
    /// True if jerk is limited.
    pub jerk: bool,
    /// From rest to rest.
    pub run: fn(&Problem<'_>) -> Option<Found>,
}

/// Refinement of the planner's grid that is taken to lead to the least time.
const FINER: f64 = 4.0;

/// All that are compared.
pub const METHODS: [Method; 4] = [
    Method {
        name: "two passes, grid given",
        same: true,
        jerk: false,
        run: |problem| Some(by_passes(problem.path, problem.grid)),
    },
    Method {
        name: "two passes",
        same: true,
        jerk: false,
        run: |problem| Some(by_passes(problem.path, &grid(problem.path, false))),
    },
    Method { name: "planner", same: false, jerk: false, run: |problem| by_planner(problem, false) },
    Method {
        name: "planner with jerk",
        same: false,
        jerk: true,
        run: |problem| by_planner(problem, true),
    },
];

fn by_passes(path: &Path, grid: &Grid) -> Found {
    let duration = path.duration(&passes(grid, [0.0; 2]));
    Found { duration, cells: path.cells(), failed: 0 }
}

/// The least time with limited jerk, s: what the planner comes to on a much finer grid with all of the path in one window.
pub fn least_time(machine: &Machine, curve: &Curve) -> Option<f64> {
    let (path, rates) = (machine.path(curve, 10), machine.rates(curve));
    let extent = (path.nodes[path.cells()], path.feed);
    let fineness = Fineness::ordinary().finer(FINER).whole();
    let (duration, effort) = planned(&path.limits, true, extent, rates, fineness)?;
    (effort.failed == 0).then_some(duration)
}

/// On a grid of its own, for which it asks for the rates of the axes where it likes.
fn by_planner(problem: &Problem<'_>, jerk: bool) -> Option<Found> {
    let Problem { path, rates, .. } = problem;
    let extent = (path.nodes[path.cells()], path.feed);
    let fineness = Fineness::ordinary();
    let (duration, effort) = planned(&path.limits, jerk, extent, rates, fineness)?;
    let cells = usize::try_from(effort.committed).ok()?;
    Some(Found { duration, cells, failed: effort.failed })
}
