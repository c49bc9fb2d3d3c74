//! Solvers of `motion/planner/time_optimal` (time-optimal planning) behind one interface: the one file of golden set and benchmark
//! that depends on it.

use crate::path::{Path, as_float};
use nalgebra::Point3;
use twin_kinematics::{AxisVector, KinematicsError};
use twin_path::Place;
use twin_path::prepare::{CheckError, CheckVelocities};
use twin_path::{ElementKind, PathElement, Shape};
use twin_planner::blended_path::{BlendOptions, BlendedElement};
use twin_planner::planned_motion::ProfileSegment;
use twin_planner::time_optimal::{
    AxisLimits, AxisPath, AxisPoint, Beginning, Cap, CapSource, CellEnd, Effort, Grid,
    LimitOptions, Planned, Planner, Rates, SmoothProfile, SmoothSolver, reachable,
};

/// The path as a grid, with jerk limits or without.
pub fn grid(path: &Path, jerk: bool) -> Grid {
    let limits = path.limits.iter().map(|limits| AxisLimits {
        velocity: limits.velocity,
        acceleration: limits.acceleration,
        deceleration: limits.acceleration,
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

/// The profile with limited jerk from rest to rest, solved so often, each time about the solution before.
pub fn smooth(grid: &Grid, solves: u32) -> Option<SmoothProfile> {
    let guess = passes(grid, [0.0; 2]);
    let mut solver = SmoothSolver::default();
    solver.solve(grid, 0..grid.cells(), Beginning::Rest, &guess, solves).ok()
}

/// The profile in time, as the interpolator follows it: cell by cell.
pub fn stretches(grid: &Grid, profile: &SmoothProfile) -> Vec<ProfileSegment> {
    let last = grid.cells() - 1;
    let stretches = (0..grid.cells()).map(|cell| {
        let length = grid.length(cell);
        let (from, to) = (profile.b[cell], profile.b[cell + 1]);
        if cell == 0 {
            ProfileSegment::launch(length, to)
        } else if cell == last {
            ProfileSegment::landing(length, from)
        } else {
            ProfileSegment::bent(length, from, from + profile.a[cell] * length, to)
        }
    });
    stretches.collect()
}

/// Nodes that the profile passes in equal times.
pub fn equal_times(grid: &Grid, stretches: &[ProfileSegment], cells: usize) -> Vec<f64> {
    let total: f64 = stretches.iter().map(ProfileSegment::duration).sum();
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

/// A path that is given by its rates, wherever the planner of whole programs wants to know them.
struct Given<F> {
    limits: Vec<AxisLimits>,
    rates: F,
}

impl<F: Fn(f64) -> crate::path::Rates> AxisPath for Given<F> {
    fn limits(&self) -> &[AxisLimits] {
        &self.limits
    }

    fn home(&self) -> AxisVector {
        AxisVector::zeros(self.limits.len())
    }

    fn axes(
        &self,
        _: &BlendedElement,
        s: f64,
        near: &AxisVector,
    ) -> Result<AxisPoint, KinematicsError> {
        let [first, second, third] = (self.rates)(s).map(AxisVector::from_values);
        Ok(AxisPoint { position: *near, rates: Rates { first, second, third } })
    }
}

/// Fineness of the planner of whole programs.
#[derive(Clone, Copy, Debug)]
pub struct Fineness {
    /// Between nodes, s.
    pub step: f64,
    /// Of a window, s.
    pub horizon: f64,
}

impl Fineness {
    /// As programs are planned.
    pub fn ordinary() -> Self {
        let LimitOptions { step, horizon, .. } = LimitOptions::new(BlendOptions::new(0.0));
        Self { step, horizon }
    }

    /// Factor by which the nodes are closer to each other.
    pub fn finer(self, times: f64) -> Self {
        Self { step: self.step / times, ..self }
    }

    /// Everything in one window.
    pub fn whole(self) -> Self {
        Self { horizon: 1e3, ..self }
    }
}

/// Plan of the planner of whole programs for a path from rest to rest on a grid of its own: its duration, s, and the
/// effort; none if there is no profile. The feed limits it if it is finite.
pub fn planned(
    limits: &[crate::path::Limits],
    jerk: bool,
    extent: (f64, f64),
    rates: impl Fn(f64) -> crate::path::Rates,
    fineness: Fineness,
) -> Option<(f64, Effort)> {
    let (segments, effort) = segments(limits, jerk, extent, rates, fineness)?;
    Some((segments.iter().map(ProfileSegment::duration).sum(), effort))
}

/// Profile segments of the same plan.
pub fn segments(
    limits: &[crate::path::Limits],
    jerk: bool,
    (end, feed): (f64, f64),
    rates: impl Fn(f64) -> crate::path::Rates,
    Fineness { step, horizon }: Fineness,
) -> Option<(Vec<ProfileSegment>, Effort)> {
    let limits = limits.iter().map(|limits| AxisLimits {
        velocity: limits.velocity,
        acceleration: limits.acceleration,
        deceleration: limits.acceleration,
        jerk: jerk.then_some(limits.jerk),
    });
    let axes = Given { limits: limits.collect(), rates };
    let shape = Shape::Line { start: Point3::origin(), end: Point3::new(end, 0.0, 0.0) };
    let element = PathElement {
        feed: feed.min(1e6),
        acceleration: 1e6,
        deceleration: 1e6,
        ..PathElement::new(Place::default(), ElementKind::Cut, shape)
    };
    let path = CheckVelocities::new([Ok::<_, CheckError>(element)].into_iter(), 0.0);
    let options = LimitOptions {
        feed: feed.is_finite(),
        path_acceleration: false,
        step,
        horizon,
        ..LimitOptions::new(BlendOptions::new(0.0))
    };
    let mut planner = Planner::new(path, axes, options);
    let mut segments = Vec::new();
    for part in planner.by_ref() {
        if let Planned::Leg(leg) = part.ok()? {
            segments.push(leg.stretch);
        }
    }
    Some((segments, planner.effort()))
}
