//! The linear program of a shape.
//!
//! It is solved for places where the peaks were; then the true peaks of the new cam, found exactly, are added, until there are no
//! others.

use super::super::super::curve::Curve;
use super::super::super::knot::{Knot, Piece};
use super::super::super::polynomial::{Coefficients, extremes};
use super::super::linear_program::Program;
use super::short::KEPT_AT_TAPPETS;
use super::{POSITION, ReshapeError, Wish};
use crate::Quantity;
use clarabel::solver::SolverStatus;

/// Rounds in which peaks are added for one velocity.
const ROUNDS: usize = 30;
/// A peak that exceeds what the program found by less than this part is none.
const PEAK: f64 = 1e-7;
/// A solution stays this part of the tolerances within limits of the position, and this part of a limit of the motion within
/// that, so that Clarabel's last digits keep them.
const MARGIN: f64 = 1e-6;
const MARGIN_OF_LIMITS: f64 = 2.0 * PEAK;
/// Rows of positions are divided by no less than this part of the cam's reach: rounding would be as large as what they say.
const NARROWEST: f64 = 1e-9;

/// A sum of y, y′, y″ and y‴, and between what it is to be.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    factors: [f64; 4],
    ends: [f64; 2],
    /// Whether its magnitude is to be as small as possible, instead of between the ends.
    counts: bool,
}

/// The rows at a velocity of the master: with the `least` quantity and its size that quantity counts and the others keep their
/// limits; without, all count alike, as parts of their limits.
pub(super) fn rows(wish: &Wish, velocity: f64, least: Option<(Quantity, f64)>) -> Vec<Row> {
    let mut rows = Vec::new();
    for quantity in Quantity::ALL {
        let counts = least.is_none_or(|(least, _)| least == quantity);
        let size = least.filter(|_| counts).map(|(_, size)| size);
        let unit = size.unwrap_or(wish.limits.of(quantity));
        if unit.is_finite() {
            let row = |[one, two, three]: [f64; 3]| {
                let factors = [0.0, one, two, three].map(|by| by / unit);
                Row { factors, ends: [-1.0, 1.0], counts }
            };
            rows.extend(quantity.factors(&wish.master(velocity)).into_iter().map(row));
        }
    }
    if wish.position.iter().any(|limit| limit.is_finite()) {
        rows.push(Row { factors: [1.0, 0.0, 0.0, 0.0], ends: wish.position, counts: false });
    }
    rows
}

impl Row {
    fn is_position(&self) -> bool {
        self.factors[0] != 0.0
    }
}

/// A value of a point that may be changed, and the point at the other end of a periodic cam that is changed with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unknown {
    point: usize,
    value: usize,
    twin: Option<usize>,
    tolerance: f64,
}

pub(super) struct Problem<'a> {
    knots: &'a [Knot],
    wish: &'a Wish,
    pub(super) unknowns: Vec<Unknown>,
    /// Pieces, places on them and rows that are limited there.
    places: Vec<(usize, f64, usize)>,
    /// How far the slave goes, and how far from 0 it is at most: changes of its position far below are rounding.
    height: f64,
    reach: f64,
    margin: f64,
    pub(super) programs: usize,
}

/// Position, velocity or acceleration of a point.
fn value(knot: &mut Knot, index: usize) -> &mut f64 {
    match index {
        0 => &mut knot.slave,
        1 => &mut knot.velocity,
        _ => &mut knot.acceleration,
    }
}

impl<'a> Problem<'a> {
    pub(super) fn new(knots: &'a [Knot], wish: &'a Wish, rows: &[Row]) -> Self {
        let last = knots.len() - 1;
        let mut unknowns = Vec::new();
        for (point, tolerance) in wish.tolerances.iter().enumerate() {
            let all = [tolerance.slave, tolerance.velocity, tolerance.acceleration];
            for (value, tolerance) in all.into_iter().enumerate() {
                let twin = (wish.repeated && point == 0).then_some(last);
                if tolerance > 0.0 && !(wish.repeated && point == last) {
                    unknowns.push(Unknown { point, value, twin, tolerance });
                }
            }
        }
        let mut places = Vec::new();
        for (piece, pair) in knots.windows(2).enumerate() {
            let width = pair[1].master - pair[0].master;
            for row in 0..rows.len() {
                places.extend([0.0, 0.25, 0.5, 0.75, 1.0].map(|share| (piece, share * width, row)));
            }
        }
        let (height, reach) = Curve::polynomial(knots).map_or((0.0, 0.0), |curve| {
            let found = curve.extremes().position;
            let height = found.max - found.min;
            (height, height.max(found.magnitude()))
        });
        let margin = MARGIN_OF_LIMITS;
        Self { knots, wish, unknowns, places, height, reach, margin, programs: 0 }
    }

    /// The points that make the largest part of a limit smallest, a little within the limits that only have to be kept; on them,
    /// where nothing is left within.
    pub(super) fn solve(&mut self, rows: &[Row]) -> Result<Vec<Knot>, ReshapeError> {
        let only_kept = rows.iter().any(|row| !row.counts && !row.is_position());
        match self.solve_within(rows) {
            Err(ReshapeError::NoShape) if only_kept && self.margin > 0.0 => {
                self.margin = 0.0;
                self.solve_within(rows)
            }
            solved => solved,
        }
    }

    fn solve_within(&mut self, rows: &[Row]) -> Result<Vec<Knot>, ReshapeError> {
        let mut moved = self.knots.to_vec();
        for _ in 0..ROUNDS {
            let (shares, part) = self.program(rows)?;
            moved = self.knots.to_vec();
            for (unknown, share) in self.unknowns.iter().zip(&shares) {
                for point in [Some(unknown.point), unknown.twin].into_iter().flatten() {
                    *value(&mut moved[point], unknown.value) +=
                        share.clamp(-1.0, 1.0) * unknown.tolerance;
                }
            }
            if !self.add_peaks(&moved, rows, part) {
                break;
            }
        }
        Ok(moved)
    }

    /// Adds the places where the new points exceed what the program says; whether there were any.
    fn add_peaks(&mut self, moved: &[Knot], rows: &[Row], part: f64) -> bool {
        let before = self.places.len();
        for (piece, pair) in moved.windows(2).enumerate() {
            let polynomial = Piece::between(&pair[0], &pair[1]);
            let derivatives = polynomial.polynomials();
            for (row, Row { factors, ends, counts }) in rows.iter().enumerate() {
                let mut sum: Coefficients = [0.0; 7];
                for (by, derivative) in factors.iter().zip(&derivatives) {
                    sum.iter_mut().zip(derivative).for_each(|(sum, of)| *sum += by * of);
                }
                let found = extremes(&sum, polynomial.width);
                let [low, high] = if rows[row].is_position() {
                    let room = POSITION * found.max.abs().max(found.min.abs());
                    [ends[0] - room, ends[1] + room]
                } else {
                    let most = if *counts { part } else { 1.0 - self.margin } * (1.0 + PEAK);
                    [-most, most]
                };
                for (u, value) in [(found.at_min, found.min), (found.at_max, found.max)] {
                    let place = (piece, u, row);
                    if (value < low || value > high) && !self.places.contains(&place) {
                        self.places.push(place);
                    }
                }
            }
        }
        self.places.len() > before
    }

    /// A sum of y, y′, y″ and y‴ at a place: its value without changes, and what each unknown, at its tolerance, adds.
    fn form(&self, piece: usize, u: f64, factors: &[f64; 4]) -> (f64, Vec<(usize, f64)>) {
        let mut constant = 0.0;
        let mut entries = Vec::new();
        for end in 0..2 {
            let mut knot = self.knots[piece + end];
            for index in 0..3 {
                let mut ends =
                    [piece, piece + 1].map(|at| Knot::at_rest(self.knots[at].master, 0.0));
                *value(&mut ends[end], index) = 1.0;
                let d = Piece::between(&ends[0], &ends[1]).at(u);
                let all = [d.position, d.velocity, d.acceleration, d.jerk];
                let by: f64 = all.iter().zip(factors).map(|(one, by)| one * by).sum();
                constant += *value(&mut knot, index) * by;
                let point = piece + end;
                let changes = |unknown: &Unknown| {
                    unknown.value == index
                        && (unknown.point == point || unknown.twin == Some(point))
                };
                if let Some(column) = self.unknowns.iter().position(changes) {
                    entries.push((column, by * self.unknowns[column].tolerance));
                }
            }
        }
        (constant, entries)
    }

    /// Solves the linear program: shares of the tolerances, and the largest part of a limit.
    fn program(&mut self, rows: &[Row]) -> Result<(Vec<f64>, f64), ReshapeError> {
        self.programs += 1;
        let n = self.unknowns.len();
        let mut costs = vec![0.0; n];
        costs.push(1.0);
        let mut program = Program::new(costs);
        let most = |entries: &[(usize, f64)]| entries.iter().map(|(_, by)| by.abs()).sum::<f64>();
        for held in &self.wish.held {
            let piece = self.knots.partition_point(|knot| knot.master <= *held).max(1) - 1;
            let piece = piece.min(self.knots.len() - 2);
            let at = held - self.knots[piece].master;
            let (_, entries) = self.form(piece, at, &[1.0, 0.0, 0.0, 0.0]);
            // An end that stays needs nothing that holds it.
            let size = most(&entries);
            if size > KEPT_AT_TAPPETS * self.height {
                program.equal(entries.into_iter().map(|(column, by)| (column, by / size)), 0.0);
            }
        }
        for (piece, u, row) in &self.places {
            let Some(Row { factors, ends, counts }) = rows.get(*row) else { continue };
            let (constant, entries) = self.form(*piece, *u, factors);
            let (mut size, mut margin) = (1.0, self.margin);
            if factors[0] != 0.0 {
                // A position that no unknown moves by more than rounding stays; the limits are checked in the end.
                if most(&entries) <= POSITION * self.reach {
                    continue;
                }
                (size, margin) = (most(&entries).max(NARROWEST * self.reach), MARGIN);
            }
            for (sign, end) in [(1.0, ends[1]), (-1.0, -ends[0])] {
                let row = entries.iter().map(|(column, by)| (*column, sign * by / size));
                if *counts {
                    program.most(row.chain([(n, -1.0)]), -sign * constant);
                } else if end.is_finite() {
                    program.most(row, (end - sign * constant) / size - margin);
                }
            }
        }
        for column in 0..n {
            program.most([(column, 1.0)], 1.0);
            program.most([(column, -1.0)], 1.0);
        }
        let mut found = program.solved().map_err(|status| match status {
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                ReshapeError::NoShape
            }
            status => ReshapeError::NotSolved(status),
        })?;
        let part = found.pop().unwrap_or(f64::INFINITY);
        Ok((found, part))
    }
}
