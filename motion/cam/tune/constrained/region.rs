//! Pairs of a scaling and an offset that are allowed together.
//!
//! Every constraint is linear in the two. Elimination of the offset (Fourier–Motzkin) says how large the scaling may be, and which
//! two constraints say so; a quadratic objective has its minimum inside, on an edge or in a corner.

use crate::Quantity;
use std::fmt;
use twin_number::Short;

/// A constraint that holds a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// The end of its own interval, or of the interval of the other one of scaling and offset.
    Interval {
        /// Which end.
        end: f64,
    },
    /// A value that stays as it is.
    Given,
    /// A limit of the slave's position.
    Position {
        /// u.
        limit: f64,
    },
    /// A limit of the slave's motion.
    Limit {
        /// Of what.
        quantity: Quantity,
        /// What it is.
        limit: f64,
    },
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interval { end } => write!(f, "the end of an interval, {}", Short(*end)),
            Self::Given => f.write_str("what stays as it is"),
            Self::Position { limit } => {
                write!(f, "the slave's limit of position, {}", Short(*limit))
            }
            Self::Limit { quantity, limit } => {
                write!(f, "the slave's limit of {quantity}, {}", Short(*limit))
            }
        }
    }
}

/// `scaling` · a + `offset` · b ≤ `most`.
#[derive(Clone, Copy, Debug)]
struct Row {
    scaling: f64,
    offset: f64,
    most: f64,
    bound: Bound,
}

/// The least or the greatest value, and the constraints that hold it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::tune) struct End {
    pub(in crate::tune) value: f64,
    pub(in crate::tune) by: [Option<Bound>; 2],
}

impl End {
    pub(super) fn at(value: f64, bound: Bound) -> Self {
        Self { value, by: [Some(bound), None] }
    }
}

/// Pairs of scaling and offset.
#[derive(Clone, Debug, Default)]
pub(in crate::tune) struct Region {
    rows: Vec<Row>,
}

/// A quadratic objective of scaling and offset: their best values without constraints, and the matrix, a², a·b and b².
#[derive(Clone, Copy, Debug)]
pub(super) struct Quadratic {
    pub(super) slope: [f64; 2],
    pub(super) curve: [f64; 3],
}

/// This part of a sum is rounding.
const ROUNDING: f64 = 1e-13;
/// A row that is exceeded by less than this part of its terms is kept.
const KEPT: f64 = 1e-11;

impl Region {
    /// Demands that `scaling` · a + `offset` · b lies between two values, which may be infinite.
    pub(in crate::tune) fn between(
        &mut self,
        [scaling, offset]: [f64; 2],
        ends: [(f64, Bound); 2],
    ) -> &mut Self {
        let [(low, below), (high, above)] = ends;
        if high < f64::INFINITY {
            self.rows.push(Row { scaling, offset, most: high, bound: above });
        }
        if low > f64::NEG_INFINITY {
            let (scaling, offset) = (-scaling, -offset);
            self.rows.push(Row { scaling, offset, most: -low, bound: below });
        }
        self
    }

    /// Least and greatest scaling with which there is an offset; the least is above the greatest if there is none.
    pub(in crate::tune) fn scalings(&self) -> [End; 2] {
        let mut ends = NONE;
        for row in self.rows.iter().filter(|row| row.offset == 0.0) {
            take(&mut ends, row.scaling, row.most, row.most.abs(), [Some(row.bound), None]);
        }
        for upper in self.rows.iter().filter(|row| row.offset > 0.0) {
            for lower in self.rows.iter().filter(|row| row.offset < 0.0) {
                let (one, other) = (-lower.offset, upper.offset);
                let (by, size) = sum([upper.scaling * one, lower.scaling * other]);
                let by = if by.abs() <= ROUNDING * size { 0.0 } else { by };
                let (most, size) = sum([upper.most * one, lower.most * other]);
                take(&mut ends, by, most, size, [Some(upper.bound), Some(lower.bound)]);
            }
        }
        ends
    }

    /// Least and greatest offset with a scaling.
    pub(in crate::tune) fn offsets(&self, scaling: f64) -> [End; 2] {
        let mut ends = NONE;
        for row in self.rows.iter().filter(|row| row.offset != 0.0) {
            let (most, size) = sum([row.most, -row.scaling * scaling]);
            take(&mut ends, row.offset, most, size, [Some(row.bound), None]);
        }
        ends
    }

    /// The pair with the least value of a quadratic, and the constraints that hold it; none if there is no pair.
    pub(super) fn least(&self, of: &Quadratic) -> Option<([f64; 2], Vec<Bound>)> {
        let Quadratic { slope: [u, v], curve: [aa, ab, bb] } = *of;
        let value =
            |[a, b]: [f64; 2]| u * a + v * b + (aa * a * a + 2.0 * ab * a * b + bb * b * b) / 2.0;
        let (determinant, size) = sum([aa * bb, -ab * ab]);
        let free = (determinant > ROUNDING * size)
            .then(|| [(ab * v - bb * u) / determinant, (ab * u - aa * v) / determinant]);
        let edge = |row: &Row| {
            // From the foot of the row's normal along the row.
            let square = row.scaling.powi(2) + row.offset.powi(2);
            let [a, b] = [row.scaling, row.offset].map(|part| part * row.most / square);
            let [x, y] = [-row.offset, row.scaling];
            let slope = x * (u + aa * a + ab * b) + y * (v + ab * a + bb * b);
            let bend = aa * x * x + 2.0 * ab * x * y + bb * y * y;
            (bend > 0.0).then(|| [a - x * slope / bend, b - y * slope / bend])
        };
        let corner = |one: &Row, other: &Row| {
            let (determinant, size) =
                sum([one.scaling * other.offset, -other.scaling * one.offset]);
            (determinant.abs() > ROUNDING * size).then(|| {
                [
                    (one.most * other.offset - other.most * one.offset) / determinant,
                    (one.scaling * other.most - other.scaling * one.most) / determinant,
                ]
            })
        };
        let rows = || self.rows.iter().filter(|row| row.scaling != 0.0 || row.offset != 0.0);
        let mut all: Vec<([f64; 2], Vec<Bound>)> =
            free.into_iter().map(|at| (at, Vec::new())).collect();
        for (index, row) in rows().enumerate() {
            all.extend(edge(row).map(|at| (at, vec![row.bound])));
            let corners = rows().take(index).filter_map(|other| Some((corner(row, other)?, other)));
            all.extend(corners.map(|(at, other)| (at, vec![other.bound, row.bound])));
        }
        all.retain(|(at, _)| self.rows.iter().all(|row| row.keeps(*at)));
        all.into_iter().min_by(|one, other| value(one.0).total_cmp(&value(other.0)))
    }
}

impl Row {
    fn keeps(&self, [a, b]: [f64; 2]) -> bool {
        let terms = [self.scaling * a, self.offset * b];
        let size = terms[0].abs() + terms[1].abs() + self.most.abs();
        terms[0] + terms[1] <= self.most + KEPT * size
    }
}

/// A sum, and the size of its terms.
fn sum([one, other]: [f64; 2]) -> (f64, f64) {
    (one + other, one.abs() + other.abs())
}

const NONE: [End; 2] =
    [End { value: f64::NEG_INFINITY, by: [None; 2] }, End { value: f64::INFINITY, by: [None; 2] }];

/// value · `by` ≤ `most`, a sum of terms as large as `size`.
fn take(ends: &mut [End; 2], by: f64, most: f64, size: f64, bounds: [Option<Bound>; 2]) {
    let [least, greatest] = ends;
    let end = End { value: most / by, by: bounds };
    if by > 0.0 {
        if end.value < greatest.value {
            *greatest = end;
        }
    } else if by < 0.0 {
        if end.value > least.value {
            *least = end;
        }
    } else if most < -ROUNDING * size {
        // No value keeps it.
        *least = End { value: f64::INFINITY, by: bounds };
        *greatest = End { value: f64::NEG_INFINITY, by: bounds };
    }
}
