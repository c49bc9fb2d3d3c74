//! Scaled limits of one cell: its half planes in the b at its two ends, as parts of given values.

use crate::time_optimal::bound::{Constraint, Disc, Row, number};
use crate::time_optimal::grid::{End, Grid};

use super::presolve::TIGHT;

/// A limit with less room than this may be what a bound comes from.
const SLACK: f64 = 1e-6;
/// A limit with a smaller coefficient for x does not hold it: where the tool turns at constant speed rounding leaves it one.
const HOLDS: f64 = 1e-6;

/// A cell with b at its ends of which x and y are parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scaled<'g> {
    grid: &'g Grid,
    cell: usize,
    slope: f64,
    pub(super) b: [f64; 2],
}

/// |P·x + R·y| ≤ 1.
pub(super) type Vectors = [[f64; 3]; 2];

impl<'g> Scaled<'g> {
    pub(super) fn new(grid: &'g Grid, cell: usize, b: [f64; 2]) -> Self {
        Self { grid, cell, slope: 0.5 / grid.length(cell), b }
    }

    /// The half plane p·x + r·y ≤ 1 of a row at an end of the cell.
    fn turned(&self, row: &Row, end: End) -> [f64; 2] {
        let with = row.a * self.slope;
        let [p, r] = match end {
            End::Start => [row.b - with, with],
            End::Finish => [-with, row.b + with],
        };
        [p * self.b[0], r * self.b[1]]
    }

    /// Half planes p·x + r·y ≤ 1; those with `true` hold with both signs.
    pub(super) fn rows(self) -> impl Iterator<Item = (Constraint, [f64; 2], bool)> + use<'g> {
        End::BOTH.into_iter().flat_map(move |end| {
            let (axes, further) = self.grid.rows(self.cell, end);
            let axes = axes.iter().enumerate().map(move |(axis, row)| {
                (Constraint::AxisAcceleration(number(axis)), self.turned(row, end), true)
            });
            axes.chain(
                further.iter().enumerate().map(move |(place, row)| {
                    (self.grid.further(place), self.turned(row, end), false)
                }),
            )
        })
    }

    /// Half planes p·x + r·y ≤ 1, those of the axes with both signs.
    pub(super) fn halves(self) -> impl Iterator<Item = (Constraint, [f64; 2])> + use<'g> {
        self.rows().flat_map(|(constraint, [p, r], both)| {
            let other = both.then_some((constraint, [-p, -r]));
            [(constraint, [p, r])].into_iter().chain(other)
        })
    }

    /// The discs of the tool tip.
    pub(super) fn discs(self) -> impl Iterator<Item = Vectors> + use<'g> {
        End::BOTH.into_iter().filter_map(move |end| {
            let Disc { a, b } = self.grid.disc(self.cell, end)?;
            let mut vectors = Vectors::default();
            for (index, (a, b)) in a.iter().zip(*b).enumerate() {
                let turned = self.turned(&Row { a: *a, b }, end);
                for (vector, value) in vectors.iter_mut().zip(turned) {
                    if let Some(slot) = vector.get_mut(index) {
                        *slot = value;
                    }
                }
            }
            Some(vectors)
        })
    }

    /// True if all x and y from these least ones to 1 keep a half plane.
    pub(super) fn half_holds([p, r]: [f64; 2], least: [f64; 2]) -> bool {
        let most = |value: f64, least: f64| if value > 0.0 { value } else { value * least };
        most(p, least[0]) + most(r, least[1]) < 1.0 - SLACK
    }

    /// As [`Self::half_holds`]: a disc is convex, so that its corners tell.
    pub(super) fn disc_holds(vectors: &Vectors, least: [f64; 2]) -> bool {
        [[1.0, 1.0], [least[0], 1.0], [1.0, least[1]], least]
            .iter()
            .all(|corner| norm(vectors, *corner) < 1.0 - SLACK)
    }

    /// Caps of x and y from limits that x = y = 1 breaks, if there are such: if one is more, the other is less.
    pub(super) fn traded(self) -> Option<[f64; 2]> {
        let mut caps = [f64::INFINITY; 2];
        for (_, [p, r], both) in self.rows() {
            let sum = p + r;
            if (if both { sum.abs() } else { sum }) > 1.0 + TIGHT && p * r > 0.0 {
                let (p, r) = (p.abs(), r.abs());
                caps = [caps[0].min((1.0 - r) / p), caps[1].min((1.0 - p) / r)];
            }
        }
        for [p, r] in self.discs() {
            if norm(&[p, r], [1.0; 2]) > 1.0 + TIGHT {
                caps = [caps[0].min(beside(&p, &r)), caps[1].min(beside(&r, &p))];
            }
        }
        caps.iter().any(|cap| cap.is_finite()).then(|| caps.map(|cap| cap.max(0.0)))
    }

    /// The limit that holds x, and that which holds y, that is most active where both are 1.
    pub(super) fn most_active(self) -> [Active; 2] {
        let mut found = [Active::default(); 2];
        let mut take = |constraint, row: [f64; 2]| {
            let activity = row[0] + row[1];
            for (found, own) in found.iter_mut().zip(row) {
                if own > HOLDS && activity > found.activity {
                    *found = Active { activity, constraint: Some(constraint), row };
                }
            }
        };
        for (constraint, [p, r], both) in self.rows() {
            let sign = if both { (p + r).signum() } else { 1.0 };
            take(constraint, [sign * p, sign * r]);
        }
        for [p, r] in self.discs() {
            let sum = [p[0] + r[0], p[1] + r[1], p[2] + r[2]];
            let length = dot(&sum, &sum).sqrt();
            if length > 0.0 {
                // The tangent.
                let row = [dot(&sum, &p) / length, dot(&sum, &r) / length];
                take(Constraint::ToolAcceleration, row);
            }
        }
        found
    }
}

/// A limit as half plane row[0]·x + row[1]·y ≤ 1.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Active {
    /// Its left side where x and y are 1.
    pub(super) activity: f64,
    pub(super) constraint: Option<Constraint>,
    pub(super) row: [f64; 2],
}

/// The largest x with |P·x + R·y| ≤ 1 at y = 1, or at the largest y for which there is one.
fn beside(p: &[f64; 3], r: &[f64; 3]) -> f64 {
    let (pp, pr) = (dot(p, p), dot(p, r));
    if pp <= 0.0 {
        return f64::INFINITY;
    }
    let cross = [p[1] * r[2] - p[2] * r[1], p[2] * r[0] - p[0] * r[2], p[0] * r[1] - p[1] * r[0]];
    let across = dot(&cross, &cross);
    let y = if across > 0.0 { (pp / across).sqrt().min(1.0) } else { 1.0 };
    let root = (pp - across * y * y).max(0.0).sqrt();
    (root - pr * y) / pp
}

/// The tangent, as half plane, where the own one (0: x, 1: y) is the largest that goes with 1 of the other.
pub(super) fn tangent(vectors: &Vectors, own: usize) -> Option<[f64; 2]> {
    let [p, r] = vectors;
    let (own, given) = if own == 0 { (p, r) } else { (r, p) };
    let most = beside(own, given);
    let v: [f64; 3] = std::array::from_fn(|at| match (own.get(at), given.get(at)) {
        (Some(own), Some(given)) => own * most + given,
        _ => 0.0,
    });
    let length = dot(&v, &v).sqrt();
    (most.is_finite() && length > 0.0).then(|| [dot(&v, p) / length, dot(&v, r) / length])
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm([p, r]: &Vectors, [x, y]: [f64; 2]) -> f64 {
    let sum = [p[0] * x + r[0] * y, p[1] * x + r[1] * y, p[2] * x + r[2] * y];
    dot(&sum, &sum).sqrt()
}
