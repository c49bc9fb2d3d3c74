//! Moves points of a cam within tolerances so that its master may go faster.
//!
//! At given master positions y, y′, y″ and y‴ are linear in slave position, velocity and acceleration of the points
//! beside them. For one velocity of the master "nothing exceeds s times its limit, s as small as possible" is a linear
//! program. It is solved for places where the peaks were; then the true peaks of the new cam, found exactly, are added,
//! until there are no others. The largest velocity of that cam is the next one to try, and it never falls.
//!
//! Points keep their masters, so the cam stays twice continuously differentiable and tappets stay where they are; the
//! slave stays where it is at every tappet, too.

use super::super::bounds::{Factors, Largest, LimitError, MasterMotion, SlaveLimits};
use super::super::curve::Curve;
use super::super::error::CamError;
use super::super::knot::{Derivatives, Knot, Piece};
use super::super::polynomial::{Coefficients, extremes};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};

/// By how much a point may be changed, either way; 0 for what stays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// Slave position, u.
    pub slave: f64,
    /// Velocity.
    pub velocity: f64,
    /// Acceleration, 1/u.
    pub acceleration: f64,
}

/// What a cam is reshaped for.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// One for every point.
    pub tolerances: Vec<Tolerance>,
    /// Masters at which the slave stays where it is: those of the tappets.
    pub held: Vec<f64>,
    /// What the slave may do; at least one of them finite.
    pub limits: SlaveLimits,
    /// The master's acceleration that counts beside its velocity, u/s².
    pub master_acceleration: f64,
    /// Whether the cam is put end to end: what is changed at its begin is changed at its end.
    pub repeated: bool,
}

/// A cam that lets its master go faster.
#[derive(Clone, Debug, PartialEq)]
pub struct Reshaped {
    /// The points.
    pub knots: Vec<Knot>,
    /// The largest velocity of the master before, exact.
    pub before: Largest,
    /// The largest velocity of the master now, exact.
    pub after: Largest,
    /// Linear programs that were solved.
    pub programs: usize,
}

/// Why a cam cannot be reshaped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReshapeError {
    /// There are not as many tolerances as points.
    #[error("there are {found} tolerances for {expected} points")]
    Tolerances {
        /// How many there are.
        found: usize,
        /// How many points there are.
        expected: usize,
    },
    /// A tolerance is negative or no number.
    #[error("point {index}: a tolerance of {value} is no magnitude")]
    NoMagnitude {
        /// Which point, from 1.
        index: usize,
        /// The tolerance.
        value: f64,
    },
    /// The points make no cam.
    #[error(transparent)]
    Cam(#[from] CamError),
    /// The cam as it is cannot be followed at any velocity.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// Nothing limits the velocity of the master.
    #[error("no limit of the slave says how fast the master may go")]
    NoLimit,
    /// Clarabel came to no answer.
    #[error("Clarabel ended with {status:?}")]
    NotSolved {
        /// Its own word for it.
        status: SolverStatus,
    },
}

/// Velocities that are tried.
const TRIALS: usize = 40;
/// Rounds in which peaks are added for one velocity.
const ROUNDS: usize = 30;
/// A peak that exceeds what the program found by less than this part is none.
const PEAK: f64 = 1e-7;
/// The last step in velocity, as a part of it, that is worth another trial.
const GAIN: f64 = 1e-7;

/// Moves the points of a polynomial cam within their tolerances so that the master may go as fast as possible.
///
/// # Errors
/// [`ReshapeError`] if the points make no cam, or nothing says what is better.
pub fn reshape(knots: &[Knot], wish: &Wish) -> Result<Reshaped, ReshapeError> {
    if wish.tolerances.len() != knots.len() {
        let (found, expected) = (wish.tolerances.len(), knots.len());
        return Err(ReshapeError::Tolerances { found, expected });
    }
    for (index, tolerance) in (1..).zip(&wish.tolerances) {
        let Tolerance { slave, velocity, acceleration } = *tolerance;
        for value in [slave, velocity, acceleration] {
            if !value.is_finite() || value < 0.0 {
                return Err(ReshapeError::NoMagnitude { index, value });
            }
        }
    }
    let before = largest(&Curve::polynomial(knots)?, wish)?;
    if before.limited.is_none() {
        return Err(ReshapeError::NoLimit);
    }
    let mut problem = Problem::new(knots, wish);
    let mut best = Reshaped { knots: knots.to_vec(), before, after: before, programs: 0 };
    if problem.unknowns.is_empty() {
        return Ok(best);
    }
    for _ in 0..TRIALS {
        let velocity = best.after.value;
        let moved = problem.solve(velocity)?;
        let Ok(after) = largest(&Curve::polynomial(&moved)?, wish) else { break };
        let gain = after.value / velocity - 1.0;
        if gain > 0.0 {
            (best.knots, best.after) = (moved, after);
        }
        if gain <= GAIN || after.limited.is_none() {
            break;
        }
    }
    best.programs = problem.programs;
    Ok(best)
}

fn largest(curve: &Curve, wish: &Wish) -> Result<Largest, LimitError> {
    let master = MasterMotion { acceleration: wish.master_acceleration, ..MasterMotion::default() };
    curve.largest_master_velocity(&wish.limits, &master, Factors::default(), wish.repeated)
}

/// What may be changed: which value of which point, and of which other one with it.
#[derive(Clone, Copy, Debug)]
struct Unknown {
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
    /// Which of [`weights`].
    row: usize,
}

struct Problem<'a> {
    knots: &'a [Knot],
    wish: &'a Wish,
    unknowns: Vec<Unknown>,
    places: Vec<Place>,
    programs: usize,
}

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
    fn new(knots: &'a [Knot], wish: &'a Wish) -> Self {
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
        let rows = weights(wish, 1.0).len();
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
        Self { knots, wish, unknowns, places, programs: 0 }
    }

    /// The points that make the largest part of a limit smallest at a velocity of the master.
    fn solve(&mut self, velocity: f64) -> Result<Vec<Knot>, ReshapeError> {
        let weights = weights(self.wish, velocity);
        let mut moved = self.knots.to_vec();
        for _ in 0..ROUNDS {
            let (shares, part) = self.program(&weights)?;
            moved = self.knots.to_vec();
            for (unknown, share) in self.unknowns.iter().zip(&shares) {
                let by = share.clamp(-1.0, 1.0) * unknown.tolerance;
                for point in [Some(unknown.point), unknown.twin].into_iter().flatten() {
                    if let Some(knot) = moved.get_mut(point) {
                        set(knot, unknown.value, by);
                    }
                }
            }
            if !self.add_peaks(&moved, &weights, part) {
                break;
            }
        }
        Ok(moved)
    }

    /// Adds the places where the new points exceed what the program says; whether there were any.
    fn add_peaks(&mut self, moved: &[Knot], weights: &[[f64; 3]], part: f64) -> bool {
        let before = self.places.len();
        for (piece, pair) in moved.windows(2).enumerate() {
            let [from, to] = pair else { continue };
            let polynomial = Piece::between(from, to);
            let [_, first, second, third] = polynomial.polynomials();
            for (row, [a, b, c]) in weights.iter().enumerate() {
                let mut sum: Coefficients = [0.0; 7];
                for (((sum, first), second), third) in
                    sum.iter_mut().zip(first).zip(second).zip(third)
                {
                    *sum = a * first + b * second + c * third;
                }
                let found = extremes(&sum, polynomial.width);
                for (u, value) in [(found.at_min, found.min), (found.at_max, found.max)] {
                    let place = Place { piece, u, row };
                    if value.abs() > part * (1.0 + PEAK) && !self.places.contains(&place) {
                        self.places.push(place);
                    }
                }
            }
        }
        self.places.len() > before
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
    fn program(&mut self, weights: &[[f64; 3]]) -> Result<(Vec<f64>, f64), ReshapeError> {
        self.programs += 1;
        let n = self.unknowns.len();
        let mut rows = Rows::new(n + 1);
        // Held places first: what is equal.
        for held in &self.wish.held {
            let piece = self.knots.partition_point(|knot| knot.master <= *held).max(1) - 1;
            let piece = piece.min(self.knots.len() - 2);
            let Some(from) = self.knots.get(piece) else { continue };
            let (_, factors) = self.form(piece, held - from.master, &|d| d.position);
            let size = factors.iter().map(|(_, factor)| factor.abs()).fold(0.0, f64::max);
            if size > 0.0 {
                rows.add(factors.into_iter().map(|(column, f)| (column, f / size)), 0.0);
            }
        }
        let equal = rows.count();
        for place in &self.places {
            let Some([a, b, c]) = weights.get(place.row) else { continue };
            let of = |d: &Derivatives| a * d.velocity + b * d.acceleration + c * d.jerk;
            let (constant, factors) = self.form(place.piece, place.u, &of);
            for sign in [1.0, -1.0] {
                let entries = factors.iter().map(|(column, factor)| (*column, sign * factor));
                rows.add(entries.chain([(n, -1.0)]), -sign * constant);
            }
        }
        for column in 0..n {
            rows.add([(column, 1.0)].into_iter(), 1.0);
            rows.add([(column, -1.0)].into_iter(), 1.0);
        }
        let unequal = rows.count() - equal;
        let (matrix, right) = rows.into_matrix();
        let mut cost = vec![0.0; n];
        cost.push(1.0);
        let cones = [SupportedConeT::ZeroConeT(equal), SupportedConeT::NonnegativeConeT(unequal)];
        let settings: DefaultSettings<f64> =
            DefaultSettingsBuilder::default().verbose(false).build().unwrap_or_default();
        let none = CscMatrix::zeros((n + 1, n + 1));
        let solver = DefaultSolver::new(&none, &cost, &matrix, &right, &cones, settings);
        let Ok(mut solver) = solver else {
            return Err(ReshapeError::NotSolved { status: SolverStatus::Unsolved });
        };
        solver.solve();
        let status = solver.solution.status;
        if !matches!(status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
            return Err(ReshapeError::NotSolved { status });
        }
        let mut shares = std::mem::take(&mut solver.solution.x);
        let part = shares.pop().unwrap_or(f64::INFINITY);
        Ok((shares, part))
    }
}

/// Factors of y′, y″ and y‴ whose sums are parts of the limits at a velocity of the master; each counts with both signs.
fn weights(wish: &Wish, velocity: f64) -> Vec<[f64; 3]> {
    let SlaveLimits { velocity: v, acceleration: a, jerk: j } = wish.limits;
    let pull = wish.master_acceleration;
    let square = velocity * velocity;
    let mut rows = Vec::new();
    if v.is_finite() {
        rows.push([velocity / v, 0.0, 0.0]);
    }
    if a.is_finite() {
        rows.push([pull / a, square / a, 0.0]);
        if pull != 0.0 {
            rows.push([-pull / a, square / a, 0.0]);
        }
    }
    if j.is_finite() {
        let both = 3.0 * velocity * pull / j;
        rows.push([0.0, both, square * velocity / j]);
        if pull != 0.0 {
            rows.push([0.0, -both, square * velocity / j]);
        }
    }
    rows
}

/// Rows of a sparse matrix with their right sides.
struct Rows {
    columns: Vec<Vec<(usize, f64)>>,
    right: Vec<f64>,
}

impl Rows {
    fn new(columns: usize) -> Self {
        Self { columns: vec![Vec::new(); columns], right: Vec::new() }
    }

    fn count(&self) -> usize {
        self.right.len()
    }

    fn add(&mut self, entries: impl Iterator<Item = (usize, f64)>, right: f64) {
        let row = self.right.len();
        for (column, value) in entries {
            if let Some(column) = self.columns.get_mut(column) {
                column.push((row, value));
            }
        }
        self.right.push(right);
    }

    fn into_matrix(self) -> (CscMatrix<f64>, Vec<f64>) {
        let rows = self.right.len();
        let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in &self.columns {
            for (row, value) in column {
                indices.push(*row);
                values.push(*value);
            }
            starts.push(values.len());
        }
        (CscMatrix::new(rows, self.columns.len(), starts, indices, values), self.right)
    }
}
