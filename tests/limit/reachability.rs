//! Reference solver for time-optimal profiles with limited velocity and acceleration. It makes the two passes of
//! reachability analysis (Pham and Pham 2018), but each step is a linear program in two variables whose corners are all
//! tried.

use crate::path::Path;

/// Rounding of a constraint, as a part of it.
const ROUNDING: f64 = 1e-12;

/// c₀·x + c₁·y ≤ c₂ for the squared rates x and y at both ends of a cell.
type Half = [f64; 3];

/// The largest squared rates at the nodes, from `start`, at most, to `end`.
pub fn between(path: &Path, start: f64, end: f64) -> Vec<f64> {
    let cells = path.cells();
    let mut squared = vec![end; cells + 1];
    for cell in (0..cells).rev() {
        let mut halves = halves(path, cell);
        halves.extend([[1.0, 0.0, path.cap(cell)], [0.0, 1.0, squared[cell + 1]]]);
        squared[cell] = largest(&halves, 0);
    }
    squared[0] = squared[0].min(start);
    for cell in 0..cells {
        let mut halves = halves(path, cell);
        halves.extend([[1.0, 0.0, squared[cell]], [0.0, 1.0, squared[cell + 1]]]);
        // x is what it is: shift it to the right.
        let x = squared[cell];
        let top = halves.iter().filter(|half| half[1] > 0.0);
        squared[cell + 1] =
            top.map(|[p, r, one]| (one - p * x) / r).fold(f64::INFINITY, f64::min).max(0.0);
    }
    squared
}

/// Acceleration limits at both ends of a cell.
fn halves(path: &Path, cell: usize) -> Vec<Half> {
    let slope = 0.5 / (path.nodes[cell + 1] - path.nodes[cell]);
    let mut halves = vec![[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
    for end in 0..2 {
        let [first, second, _] = &path.rates[cell + end];
        for (axis, limits) in path.limits.iter().enumerate() {
            let mut row = [-first[axis] * slope, first[axis] * slope];
            row[end] += second[axis];
            let [p, r] = row.map(|value| value / limits.acceleration);
            halves.extend([[p, r, 1.0], [-p, -r, 1.0]]);
        }
    }
    halves
}

/// The largest value of a variable that all halves allow.
fn largest(halves: &[Half], variable: usize) -> f64 {
    let allowed = |point: &[f64; 2]| {
        halves.iter().all(|[p, r, one]| {
            let terms = [p * point[0], r * point[1]];
            let size = terms[0].abs() + terms[1].abs() + one.abs();
            terms[0] + terms[1] - one <= ROUNDING * size
        })
    };
    let mut best = 0.0_f64;
    for (index, [p, r, one]) in halves.iter().enumerate() {
        for [p2, r2, one2] in &halves[..index] {
            let determinant = p * r2 - p2 * r;
            let corner = [(one * r2 - one2 * r) / determinant, (p * one2 - p2 * one) / determinant];
            if corner[variable] > best && allowed(&corner) {
                best = corner[variable];
            }
        }
    }
    best
}
