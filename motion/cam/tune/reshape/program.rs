//! The linear program of a shape, and the places it looks at.

use super::super::super::curve::Curve;
use super::super::super::knot::{Derivatives, Knot, Piece};
use super::super::super::polynomial::{Coefficients, extremes};
use super::super::linear_program::Program;
use super::weight::Weights;
use super::{KEPT_AT_TAPPETS, PEAK, POSITION, ROUNDS, ReshapeError, Wish};
use clarabel::solver::SolverStatus;

/// What may be changed: which value of which point, and of which other one with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unknown {
    point: usize,
    value: usize,
    twin: Option<usize>,
    tolerance: f64,
}

/// At a place of a piece this sum of y′, y″ and y‴ is limited.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    piece: usize,
    u: f64,
    /// Which row of the weights.
    row: usize,
}

pub(super) struct Problem<'a> {
    knots: &'a [Knot],
    wish: &'a Wish,
    pub(super) unknowns: Vec<Unknown>,
    places: Vec<Place>,
    /// Pieces and places in them where the slave's position is limited.
    positions: Vec<(usize, f64)>,
    /// How far the slave goes, and how far from 0 it is at most: beside them, changes of its position are rounding.
    height: f64,
    reach: f64,
    /// So far from limits that only have to be kept what is solved stays.
    margin: f64,
    pub(super) programs: usize,
}

/// Of the tolerances: so far from a limit of the position what is solved stays, so that Clarabel's last digits keep it.
const MARGIN: f64 = 1e-6;
/// Rows of positions are divided by no less than this part of the cam's reach: rounding would be as large as what they say.
const NARROWEST: f64 = 1e-9;
/// Of a limit of the motion that only has to be kept: more than peaks that are not looked at again exceed it.
const MARGIN_OF_LIMITS: f64 = 2.0 * PEAK;

fn values(knot: &Knot) -> [f64; 3] {
    [knot.slave, knot.velocity, knot.acceleration]
}

fn set(knot: &mut Knot, value: usize, by: f64) {
    match value {
        0 => knot.slave += by,
        1 => knot.velocity += by,
        _ => knot.acceleration += by,
    }
}

impl<'a> Problem<'a> {
    pub(super) fn new(knots: &'a [Knot], wish: &'a Wish, weights: &Weights) -> Self {
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
        let rows = weights.rows.len();
        let places = (0..last)
            .flat_map(|piece| (0..rows).map(move |row| (piece, row)))
            .filter_map(|(piece, row)| {
                let width = knots.get(piece + 1)?.master - knots.get(piece)?.master;
                Some([0.0, 0.25, 0.5, 0.75, 1.0].map(|share| Place {
                    piece,
                    u: share * width,
                    row,
                }))
            })
            .flatten()
            .collect();
        let bounded = wish.position.iter().any(|limit| limit.is_finite());
        let positions = (0..last)
            .filter(|_| bounded)
            .filter_map(|piece| {
                let width = knots.get(piece + 1)?.master - knots.get(piece)?.master;
                Some([0.0, 0.25, 0.5, 0.75, 1.0].map(|share| (piece, share * width)))
            })
            .flatten()
            .collect();
        let margin = MARGIN_OF_LIMITS;
        let (height, reach) = Curve::polynomial(knots).map_or((0.0, 0.0), |curve| {
            let found = curve.extremes().position;
            let height = found.max - found.min;
            (height, height.max(found.magnitude()))
        });
        Self { knots, wish, unknowns, places, positions, height, reach, margin, programs: 0 }
    }

    /// The points that make the largest part of a limit smallest, a little within the limits that only have to be kept; on them,
    /// where nothing is left within.
    pub(super) fn solve(&mut self, weights: &Weights) -> Result<Vec<Knot>, ReshapeError> {
        let only_kept = weights.rows.iter().any(|weight| !weight.counts);
        match self.solve_within(weights) {
            Err(ReshapeError::NoShape) if only_kept && self.margin > 0.0 => {
                self.margin = 0.0;
                self.solve_within(weights)
            }
            solved => solved,
        }
    }

    fn solve_within(&mut self, weights: &Weights) -> Result<Vec<Knot>, ReshapeError> {
        let mut moved = self.knots.to_vec();
        for _ in 0..ROUNDS {
            let (shares, part) = self.program(weights)?;
            moved = self.knots.to_vec();
            for (unknown, share) in self.unknowns.iter().zip(&shares) {
                let by = share.clamp(-1.0, 1.0) * unknown.tolerance;
                for point in [Some(unknown.point), unknown.twin].into_iter().flatten() {
                    if let Some(knot) = moved.get_mut(point) {
                        set(knot, unknown.value, by);
                    }
                }
            }
            if !self.add_peaks(&moved, weights, part) {
                break;
            }
        }
        Ok(moved)
    }

    /// Adds the places where the new points exceed what the program says; whether there were any.
    fn add_peaks(&mut self, moved: &[Knot], weights: &Weights, part: f64) -> bool {
        let before = self.places.len() + self.positions.len();
        let [lowest, highest] = self.wish.position;
        for (piece, pair) in moved.windows(2).enumerate() {
            let [from, to] = pair else { continue };
            let polynomial = Piece::between(from, to);
            let [position, first, second, third] = polynomial.polynomials();
            let found = extremes(&position, polynomial.width);
            let room = POSITION * found.max.abs().max(found.min.abs());
            for (u, beyond) in [
                (found.at_min, found.min < lowest - room),
                (found.at_max, found.max > highest + room),
            ] {
                if beyond && !self.positions.contains(&(piece, u)) {
                    self.positions.push((piece, u));
                }
            }
            for (row, weight) in weights.rows.iter().enumerate() {
                let [a, b, c] = weight.factors;
                let most = if weight.counts { part } else { 1.0 - self.margin };
                let mut sum: Coefficients = [0.0; 7];
                for (((sum, first), second), third) in
                    sum.iter_mut().zip(first).zip(second).zip(third)
                {
                    *sum = a * first + b * second + c * third;
                }
                let found = extremes(&sum, polynomial.width);
                for (u, value) in [(found.at_min, found.min), (found.at_max, found.max)] {
                    let place = Place { piece, u, row };
                    if value.abs() > most * (1.0 + PEAK) && !self.places.contains(&place) {
                        self.places.push(place);
                    }
                }
            }
        }
        self.places.len() + self.positions.len() > before
    }

    /// How much one value of one end of a piece adds to y, y′, y″ and y‴ at a place.
    fn basis(&self, piece: usize, end: usize, value: usize, u: f64) -> Derivatives {
        let (Some(from), Some(to)) = (self.knots.get(piece), self.knots.get(piece + 1)) else {
            return Derivatives::default();
        };
        let mut ends = [from, to].map(|knot| Knot::at_rest(knot.master, 0.0));
        if let Some(knot) = ends.get_mut(end) {
            set(knot, value, 1.0);
        }
        Piece::between(&ends[0], &ends[1]).at(u)
    }

    /// A linear form of the unknowns: its value without changes, and what each of them, at its tolerance, adds.
    fn form(
        &self,
        piece: usize,
        u: f64,
        of: &dyn Fn(&Derivatives) -> f64,
    ) -> (f64, Vec<(usize, f64)>) {
        let mut constant = 0.0;
        let mut factors = Vec::new();
        for end in 0..2 {
            let point = piece + end;
            let Some(knot) = self.knots.get(point) else { continue };
            for (value, present) in values(knot).into_iter().enumerate() {
                let by = of(&self.basis(piece, end, value, u));
                constant += present * by;
                let column = self.unknowns.iter().position(|unknown| {
                    unknown.value == value
                        && (unknown.point == point || unknown.twin == Some(point))
                });
                if let Some(column) = column
                    && let Some(unknown) = self.unknowns.get(column)
                {
                    factors.push((column, by * unknown.tolerance));
                }
            }
        }
        (constant, factors)
    }

    /// Solves the linear program: shares of the tolerances, and the largest part of a limit.
    fn program(&mut self, weights: &Weights) -> Result<(Vec<f64>, f64), ReshapeError> {
        self.programs += 1;
        let n = self.unknowns.len();
        let mut costs = vec![0.0; n];
        costs.push(1.0);
        let mut program = Program::new(costs);
        for held in &self.wish.held {
            let piece = self.knots.partition_point(|knot| knot.master <= *held).max(1) - 1;
            let piece = piece.min(self.knots.len() - 2);
            let Some(from) = self.knots.get(piece) else { continue };
            let (_, factors) = self.form(piece, held - from.master, &|d| d.position);
            // Where nothing moves the slave by more than it may be off, as at an end that stays, nothing has to hold it.
            let most: f64 = factors.iter().map(|(_, factor)| factor.abs()).sum();
            if most > KEPT_AT_TAPPETS * self.height {
                program.equal(factors.into_iter().map(|(column, f)| (column, f / most)), 0.0);
            }
        }
        for place in &self.places {
            let Some(weight) = weights.rows.get(place.row) else { continue };
            let [a, b, c] = weight.factors;
            let of = |d: &Derivatives| a * d.velocity + b * d.acceleration + c * d.jerk;
            let (constant, factors) = self.form(place.piece, place.u, &of);
            for sign in [1.0, -1.0] {
                let entries = factors.iter().map(|(column, factor)| (*column, sign * factor));
                // What counts is the part that is made small, the others keep their limits.
                let (part, most) =
                    if weight.counts { (-1.0, 0.0) } else { (0.0, 1.0 - self.margin) };
                program.most(entries.chain([(n, part)]), most - sign * constant);
            }
        }
        let [lowest, highest] = self.wish.position;
        for (piece, u) in &self.positions {
            let (constant, factors) = self.form(*piece, *u, &|d| d.position);
            let most: f64 = factors.iter().map(|(_, factor)| factor.abs()).sum();
            // What no unknown moves by more than rounding is as it is: what keeps the limits is looked at in the end.
            if most <= POSITION * self.reach {
                continue;
            }
            let size = most.max(NARROWEST * self.reach);
            for (sign, limit) in [(1.0, highest), (-1.0, -lowest)] {
                if limit.is_finite() {
                    let entries = factors.iter().map(|(column, f)| (*column, sign * f / size));
                    program.most(entries, (limit - sign * constant) / size - MARGIN);
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
            status => ReshapeError::NotSolved { status },
        })?;
        let part = found.pop().unwrap_or(f64::INFINITY);
        Ok((found, part))
    }
}
