//! Fastest profile with limited jerk on an adaptively refined grid.

use crate::cases::Case;
use crate::solvers::{equal_times, grid, smooth, stretches};
use twin_planner::planned_motion::ProfileSegment;
use twin_planner::time_optimal::{Beginning, SmoothSolver};

/// Cells to begin with, and rounds in which they are cut.
const CELLS: usize = 400;
const ROUNDS: u32 = 9;
/// Cells that take no longer than this, s, are not cut: some way above the time below which rounding drowns jerks.
const SHORT: f64 = 8e-5;
/// Jerk and velocity may change by this part from cell to cell and within one.
const CHANGE: f64 = 0.01;
/// The path is left and met with constant jerk for at most so long, s, and half the time in which acceleration builds up.
const LAUNCH: f64 = 0.02;
/// Over that way the axes change their rates by at most this part.
const EVEN: f64 = 1e-7;
/// Each time about the solution before.
const SOLVES: u32 = 6;

/// Duration of a case from rest to rest.
pub fn duration(case: &Case) -> f64 {
    let coarse = grid(&case.path(CELLS), true);
    let profile = smooth(&coarse, SOLVES).expect("a profile");
    let mut laws = stretches(&coarse, &profile);
    let mut nodes = launched(case, &equal_times(&coarse, &laws, CELLS), build_up(&laws));
    let mut known = (coarse.nodes().to_vec(), laws);
    for _ in 0..ROUNDS {
        let grid = grid(&(case.path)(nodes.clone()), true);
        let guess = at_nodes(&nodes, &known);
        let cells = 0..grid.cells();
        let profile = SmoothSolver::default()
            .solve(&grid, cells, Beginning::Rest, &guess, SOLVES)
            .expect("a profile");
        laws = stretches(&grid, &profile);
        let finer = cut(&nodes, &laws);
        known = (std::mem::replace(&mut nodes, finer), laws);
    }
    known.1.iter().map(ProfileSegment::duration).sum()
}

/// Time until the acceleration no longer grows, s.
fn build_up(laws: &[ProfileSegment]) -> f64 {
    let mut most = 0.0;
    let growing = laws.iter().take_while(|law| {
        let (_, a) = law.at_position(law.length());
        let grows = a > 1.01 * most;
        most = a;
        grows
    });
    growing.map(ProfileSegment::duration).sum()
}

/// With a first and a last cell that are gone through with constant jerk.
fn launched(case: &Case, nodes: &[f64], build_up: f64) -> Vec<f64> {
    let ends = grid(&(case.path)(vec![0.0, case.end]), true);
    let ways =
        |time: f64| [ends.jerk_start(0), ends.jerk_end(0)].map(|jerk| jerk * time.powi(3) / 6.0);
    let mut time = LAUNCH.min(0.5 * build_up);
    // With constant jerk of the parameter: where the axes do not follow evenly, not for long.
    while uneven(case, ways(time)) {
        time *= 0.8;
    }
    let [first, last] = ways(time);
    let inner = nodes.iter().copied();
    let inner = inner.filter(|u| *u > 1.2 * first && *u < case.end - 1.2 * last);
    [0.0, first].into_iter().chain(inner).chain([case.end - last, case.end]).collect()
}

/// True if the axes change their rates over the first and the last way.
fn uneven(case: &Case, [first, last]: [f64; 2]) -> bool {
    let path = (case.path)(vec![0.0, first, case.end - last, case.end]);
    let rates: Vec<&Vec<f64>> = path.rates.iter().map(|rates| &rates[0]).collect();
    let pairs = [(rates[0], rates[1]), (rates[3], rates[2])];
    pairs.iter().any(|(at_rest, inside)| {
        let mut axes = at_rest.iter().zip(inside.iter());
        axes.any(|(at_rest, inside)| (inside - at_rest).abs() > EVEN * at_rest.abs())
    })
}

/// What is known of the squared rates, at other nodes.
fn at_nodes(nodes: &[f64], (known, laws): &(Vec<f64>, Vec<ProfileSegment>)) -> Vec<f64> {
    let mut cell = 0;
    let squared = nodes.iter().map(|u| {
        while cell + 1 < laws.len() && known[cell + 1] <= *u {
            cell += 1;
        }
        laws[cell].at_position(u - known[cell]).0
    });
    squared.collect()
}

/// Cells in halves where jerk or velocity change much.
fn cut(nodes: &[f64], laws: &[ProfileSegment]) -> Vec<f64> {
    let jerks: Vec<f64> = laws.iter().map(|law| law.jerk_at(0.5 * law.length())).collect();
    let most = jerks.iter().fold(0.0_f64, |most, jerk| most.max(jerk.abs()));
    let mut finer = vec![nodes[0]];
    for (cell, law) in laws.iter().enumerate() {
        let inner = cell > 0 && cell + 1 < laws.len();
        if inner && law.duration() > SHORT {
            let jumps = [jerks[cell] - jerks[cell - 1], jerks[cell + 1] - jerks[cell]];
            let ends = [0.0, law.length()].map(|u| law.at_position(u).0.sqrt());
            let faster = ends[0].max(ends[1]) / ends[0].min(ends[1]) - 1.0;
            if jumps.iter().any(|jump| jump.abs() > CHANGE * most) || faster > CHANGE {
                finer.push(0.5 * (nodes[cell] + nodes[cell + 1]));
            }
        }
        finer.push(nodes[cell + 1]);
    }
    finer
}
