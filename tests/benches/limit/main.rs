//! Benchmark of time-optimal planning against toppra, which limits velocity and acceleration (seidel, rows at both ends
//! of every cell): the same paths, grids and rows in one run.
//!
//! Every row is a path on a machine with a number of cells. Durations are those of the profiles; points are cells per
//! second of computing, on one core, from the derivatives at the nodes to the profile. Machines are noisy: compare
//! within a row. The planner of whole programs chooses a grid of its own, uniform in time, and asks the transform for
//! its nodes; its points are the cells that it commits. Numbers are printed, nothing fails on them.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::format_push_string,
    dead_code,
    missing_docs,
    missing_debug_implementations,
    unreachable_pub,
    reason = "a benchmark that cannot be set up has failed; the modules are those of a test, too"
)]

mod curves;
mod machines;
mod ours;
#[path = "../../limit/path.rs"]
mod path;
mod peer;
#[path = "../python.rs"]
mod python;
#[path = "../../limit/solvers.rs"]
mod solvers;
mod table;

use curves::Curve;
use machines::{Machine, all, long};
use ours::{Problem, least_time};
use peer::Peer;
use table::Row;

/// Cells per path.
const CELLS: [usize; 3] = [100, 1_000, 10_000];
/// Cells of the long path: 0.1 mm each.
const LONG: usize = 50_000;

fn main() {
    // Not when cargo only tests that benchmarks can be run.
    let measure = std::env::args().any(|argument| argument == "--bench");
    let machines = all();
    for curve in machines.iter().flat_map(|machine| &machine.curves) {
        curves::check(curve);
    }
    let (machine, curve) = long();
    curves::check(&curve);
    if !measure {
        check_machines(&machines);
        return;
    }
    let mut peer = Peer::start();
    table::head();
    let mut rows = Vec::new();
    for machine in &machines {
        for curve in &machine.curves {
            let least = least_time(machine, curve);
            for cells in CELLS {
                rows.push(measured(machine, curve, cells, least, peer.as_mut()));
            }
        }
    }
    let least = least_time(&machine, &curve);
    rows.push(measured(&machine, &curve, LONG, least, peer.as_mut()));
    table::summary(&rows);
}

fn measured(
    machine: &Machine,
    curve: &Curve,
    cells: usize,
    least: Option<f64>,
    peer: Option<&mut Peer>,
) -> Row {
    let (path, rates) = (machine.path(curve, cells), machine.rates(curve));
    let grid = solvers::grid(&path, false);
    let problem = Problem { path: &path, grid: &grid, rates: &rates };
    let row = Row::measured(format!("{} {}", machine.name, curve.name), &problem, least, peer);
    row.print();
    row
}

/// The axes' derivatives are those of where the axes are: what the benchmark is about.
fn check_machines(machines: &[Machine]) {
    for machine in machines {
        for curve in &machine.curves {
            let path = machine.path(curve, 4_000);
            for order in 0..2 {
                let of = |node: usize, axis: usize| path.rates[node][order][axis];
                for axis in 0..path.axes() {
                    let most = path.rates.iter().map(|rates| rates[order + 1][axis].abs());
                    let most = most.fold(0.0, f64::max);
                    for node in 1..path.cells() {
                        let way = path.nodes[node + 1] - path.nodes[node - 1];
                        let difference = (of(node + 1, axis) - of(node - 1, axis)) / way;
                        let error = (difference - path.rates[node][order + 1][axis]).abs();
                        assert!(
                            error < 1e-3 * most + 1e-9,
                            "{} {}: order {} of axis {axis} is {error} off",
                            machine.name,
                            curve.name,
                            order + 2
                        );
                    }
                }
            }
        }
    }
}
