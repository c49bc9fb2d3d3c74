//! What `motion/limit` makes of a path on a grid: the one file of golden set and benchmark that knows it.

use crate::path::{Path, as_float};
use twin_kinematics::AxisVector;
use twin_motion::limit::{
    AxisLimits, Beginning, Cap, CapSource, CellEnd, Grid, LinearSolver, Rates, SmoothProfile,
    SmoothSolver, Stretch, reachable,
};

/// The path as a grid, with jerk limits or without.
pub fn grid(path: &Path, jerk: bool) -> Grid {
    let limits = path.limits.iter().map(|limits| AxisLimits {
        velocity: limits.velocity,
        acceleration: limits.acceleration,
        jerk: jerk.then_some(limits.jerk),
    });
    let mut grid = Grid::new(limits.collect(), 0, path.nodes[0]);
    let feed = Cap { v2: path.feed * path.feed, source: CapSource::Feed };
    let cap = if path.feed.is_finite() { feed } else { Cap::NONE };
    let end = |node: usize| {
        let rates = path.rates[node].each_ref();
        let [first, second, third] =
            rates.map(|rates| AxisVector::from_values(rates.iter().copied()));
        CellEnd { rates: Rates { first, second, third }, cap, rows: &[], disc: None }
    };
    let mut start = end(0);
    for (node, s) in path.nodes.windows(2).enumerate() {
        let finish = end(node + 1);
        grid.push(s[1] - s[0], &start, &finish);
        start = finish;
    }
    grid
}

/// The squared rates of two passes.
pub fn passes(grid: &Grid, [start, end]: [f64; 2]) -> Vec<f64> {
    reachable::fastest(grid, 0..grid.cells(), start, end)
}

/// The squared rates of one program for Clarabel with limited acceleration.
pub fn linear(grid: &Grid, [start, end]: [f64; 2]) -> Option<Vec<f64>> {
    let profile = LinearSolver::default().solve(grid, 0..grid.cells(), start, end).ok()?;
    Some(profile.b)
}

/// The profile with limited jerk from rest to rest, solved so often, each time about the solution before.
pub fn smooth(grid: &Grid, solves: u32) -> Option<SmoothProfile> {
    let guess = passes(grid, [0.0; 2]);
    let mut solver = SmoothSolver::default();
    solver.solve(grid, 0..grid.cells(), Beginning::Rest, &guess, solves).ok()
}

/// The profile in time, as the interpolator follows it: cell by cell.
pub fn stretches(grid: &Grid, profile: &SmoothProfile) -> Vec<Stretch> {
    let last = grid.cells() - 1;
    let stretches = (0..grid.cells()).map(|cell| {
        let length = grid.length(cell);
        let (from, to) = (profile.b[cell], profile.b[cell + 1]);
        if cell == 0 {
            Stretch::launch(length, to)
        } else if cell == last {
            Stretch::landing(length, from)
        } else {
            Stretch::bent(length, from, from + profile.a[cell] * length, to)
        }
    });
    stretches.collect()
}

/// Nodes that the profile passes in equal times.
pub fn equal_times(grid: &Grid, stretches: &[Stretch], cells: usize) -> Vec<f64> {
    let total: f64 = stretches.iter().map(Stretch::duration).sum();
    let step = total / as_float(cells);
    let mut nodes = vec![grid.nodes()[0]];
    let (mut cell, mut before) = (0, 0.0);
    for node in 1..cells {
        let time = step * as_float(node);
        while time > before + stretches[cell].duration() {
            before += stretches[cell].duration();
            cell += 1;
        }
        nodes.push(grid.nodes()[cell] + stretches[cell].at(time - before).position);
    }
    nodes.extend(grid.nodes().last());
    nodes
}
