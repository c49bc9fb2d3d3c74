//! Moves points of a cam within tolerances so that its master may go faster, or that the slave is moved more gently.
//!
//! At given master positions y, y′, y″ and y‴ are linear in slave position, velocity and acceleration of the points
//! beside them. For one velocity of the master "nothing exceeds s times its limit, s as small as possible" is a linear
//! program. It is solved for places where the peaks were; then the true peaks of the new cam, found exactly, are added,
//! until there are no others. The largest velocity of that cam is the next one to try, and it never falls. To be gentle at
//! a given velocity is one such program: the peak of one quantity is as small as possible, the others keep their limits.
//!
//! Points keep their masters, so the cam stays twice continuously differentiable and tappets stay where they are; the
//! slave stays where it is at every tappet, too.

mod program;
mod scale;
mod short;
mod weight;

use super::super::bounds::{Factors, MasterMotion, Peak, Quantity, SlaveLimits};
use super::super::curve::Curve;
use super::super::error::CamError;
use super::super::knot::Knot;
use crate::maximum_master_velocity::{Largest, LimitError};
use clarabel::solver::SolverStatus;
use program::Problem;
use scale::scaled;
#[cfg(test)]
pub(super) use short::near;
use short::shortened;
use twin_number::Short;
use weight::Weights;

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
    /// Least and greatest position of the slave, u; infinite where there is no limit.
    pub position: [f64; 2],
    /// The master's acceleration that counts beside its velocity, u/s².
    pub master_acceleration: f64,
    /// The master's jerk that counts beside them, u/s³; for the jerk of the slave only.
    pub master_jerk: f64,
    /// Whether the cam is put end to end: what is changed at its begin is changed at its end.
    pub repeated: bool,
}

impl Wish {
    /// What the master does at most, at a velocity, u/s.
    fn master(&self, velocity: f64) -> MasterMotion {
        let (acceleration, jerk) = (self.master_acceleration, self.master_jerk);
        MasterMotion { velocity, acceleration, jerk }
    }
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
    /// Within the tolerances nothing keeps the limits.
    #[error("no shape within the tolerances keeps the limits")]
    NoShape,
    /// What was found exceeds a limit.
    #[error("the slave's {quantity} would reach {} at master {}, its limit is {}",
        Short(.peak.value), Short(.peak.master), Short(*.limit))]
    Exceeded {
        /// Of what.
        quantity: Quantity,
        /// How much, and where.
        peak: Peak,
        /// What is allowed.
        limit: f64,
    },
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
/// The last step in velocity, or in a peak, as a part of it, that is worth another trial, or to move a point.
const GAIN: f64 = 1e-7;

/// A position beyond its limit by less than this part of the cam's height is rounding.
pub(super) const POSITION: f64 = 1e-12;
/// A limit that is exceeded by less than this part is kept.
const KEPT: f64 = 1e-6;
/// Where it is kept by points as they are rounded, it is exceeded by rounding alone.
const ROUNDING: f64 = 1e-12;
/// The slave may be so far from where it was at a tappet, as a part of how far it goes at all.
const KEPT_AT_TAPPETS: f64 = 1e-9;
/// What was to be best may be worse by this part with short points: linear programs know it no better.
const LOSS: f64 = 1e-7;

/// Moves the points of a polynomial cam within their tolerances so that the master may go as fast as possible.
///
/// # Errors
/// [`ReshapeError`] if the points make no cam, or nothing says what is better.
pub fn reshape(knots: &[Knot], wish: &Wish) -> Result<Reshaped, ReshapeError> {
    check(knots, wish)?;
    let before = largest(&Curve::polynomial(knots)?, wish)?;
    if before.limited.is_none() {
        return Err(ReshapeError::NoLimit);
    }
    let wish = &scaled(knots, wish)?;
    let mut problem = Problem::new(knots, wish, &Weights::fastest(wish, 1.0));
    let mut best = Reshaped { knots: knots.to_vec(), before, after: before, programs: 0 };
    // What leaves its way as it is has to be changed, whatever that costs.
    let mut kept = keeps_position(knots, wish)?;
    if problem.unknowns.is_empty() {
        return if kept { Ok(best) } else { Err(ReshapeError::NoShape) };
    }
    for _ in 0..TRIALS {
        let velocity = best.after.value;
        let moved = problem.solve(&Weights::fastest(wish, velocity))?;
        let Ok(after) = largest(&Curve::polynomial(&moved)?, wish) else { break };
        if !keeps_position(&moved, wish)? {
            break;
        }
        let gain = after.value / velocity - 1.0;
        let first = !kept;
        if gain > 0.0 || first {
            (best.knots, best.after) = (moved, after);
            kept = true;
        }
        if (gain <= GAIN && !first) || after.limited.is_none() {
            break;
        }
    }
    if !kept {
        return Err(ReshapeError::NoShape);
    }
    best.programs = problem.programs;
    // What is gained beyond that is in the last digits of the solver, and no reason to move a point.
    if best.after.value <= before.value * (1.0 + GAIN) && keeps_position(knots, wish)? {
        return Ok(Reshaped { knots: knots.to_vec(), after: before, ..best });
    }
    let faster = best.after.value >= before.value;
    let least = (best.after.value * (1.0 - LOSS)).max(if faster { before.value } else { 0.0 });
    let reached = |knots: &[Knot]| largest(&Curve::polynomial(knots).ok()?, wish).ok();
    best.knots = shortened(knots, &best.knots, wish, &|knots| {
        reached(knots).is_some_and(|found| found.value >= least)
            && keeps_position(knots, wish).unwrap_or(false)
    });
    best.after = largest(&Curve::polynomial(&best.knots)?, wish)?;
    Ok(best)
}

/// A cam that moves its slave more gently.
#[derive(Clone, Debug, PartialEq)]
pub struct Softened {
    /// The points.
    pub knots: Vec<Knot>,
    /// The peak before, exact.
    pub before: Peak,
    /// The peak now, exact.
    pub after: Peak,
    /// Linear programs that were solved.
    pub programs: usize,
}

/// Moves the points of a polynomial cam within their tolerances so that the peak of one quantity of the slave is as small
/// as possible with the master at `velocity` (u/s); the others keep the limits of the wish.
///
/// # Errors
/// [`ReshapeError`] if the points make no cam, or none within the tolerances keeps the limits.
pub fn soften(
    knots: &[Knot],
    wish: &Wish,
    quantity: Quantity,
    velocity: f64,
) -> Result<Softened, ReshapeError> {
    check(knots, wish)?;
    let master = wish.master(velocity);
    if !(velocity.is_finite() && velocity > 0.0) {
        let name = "the master's velocity";
        return Err(LimitError::NoMagnitude { name, value: velocity }.into());
    }
    let peak = |knots: &[Knot]| -> Result<Peak, CamError> {
        Ok(Curve::polynomial(knots)?.peak(quantity, &master, Factors::default()))
    };
    let before = peak(knots)?;
    let mut best = Softened { knots: knots.to_vec(), before, after: before, programs: 0 };
    let weights = Weights::gentlest(wish, velocity, quantity, before.value);
    let wish = &scaled(knots, wish)?;
    let mut problem = Problem::new(knots, wish, &weights);
    let stays = keeps_position(knots, wish)?;
    if problem.unknowns.is_empty() || before.value == 0.0 {
        return if stays { Ok(best) } else { Err(ReshapeError::NoShape) };
    }
    let moved = problem.solve(&weights)?;
    best.programs = problem.programs;
    if !keeps_position(&moved, wish)? {
        return if stays { Ok(best) } else { Err(ReshapeError::NoShape) };
    }
    // The others: Clarabel's last digits aside.
    let curve = Curve::polynomial(&moved)?;
    for other in Quantity::ALL.into_iter().filter(|other| *other != quantity) {
        let limit = wish.limits.of(other);
        let reached = curve.peak(other, &master, Factors::default());
        if reached.value > limit * (1.0 + KEPT) {
            return Err(ReshapeError::Exceeded { quantity: other, peak: reached, limit });
        }
    }
    let after = peak(&moved)?;
    // What exceeds its limits as it is has to be changed, whatever that costs.
    let kept = |knots: &[Knot]| -> Result<bool, CamError> {
        let curve = Curve::polynomial(knots)?;
        Ok(Quantity::ALL.into_iter().filter(|other| *other != quantity).all(|other| {
            let reached = curve.peak(other, &master, Factors::default());
            reached.value <= wish.limits.of(other) * (1.0 + KEPT)
        }))
    };
    if after.value < before.value * (1.0 - GAIN) || !stays || !kept(knots)? {
        let gentler = after.value <= before.value;
        let most =
            (after.value * (1.0 + LOSS)).min(if gentler { before.value } else { f64::INFINITY });
        let excess = |curve: &Curve, other| {
            let limit = wish.limits.of(other);
            curve.peak(other, &master, Factors::default()).value / limit - 1.0
        };
        best.knots = shortened(knots, &moved, wish, &|short| {
            let Ok(short_curve) = Curve::polynomial(short) else { return false };
            let others = Quantity::ALL.into_iter().filter(|other| *other != quantity);
            let peak = short_curve.peak(quantity, &master, Factors::default());
            peak.value <= most
                && others
                    .into_iter()
                    .all(|other| excess(&short_curve, other) <= excess(&curve, other).max(ROUNDING))
                && keeps_position(short, wish).unwrap_or(false)
        });
        best.after = peak(&best.knots)?;
    }
    Ok(best)
}

fn check(knots: &[Knot], wish: &Wish) -> Result<(), ReshapeError> {
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
    for (name, value) in [
        ("the master's acceleration", wish.master_acceleration),
        ("the master's jerk", wish.master_jerk),
    ] {
        if !value.is_finite() || value < 0.0 {
            return Err(LimitError::NoMagnitude { name, value }.into());
        }
    }
    Ok(())
}

/// Whether the slave stays within its positions; rounding aside.
fn keeps_position(knots: &[Knot], wish: &Wish) -> Result<bool, CamError> {
    let [low, high] = wish.position;
    let found = Curve::polynomial(knots)?.extremes().position;
    let room = POSITION * (found.max - found.min).max(found.magnitude());
    Ok(found.min >= low - room && found.max <= high + room)
}

fn largest(curve: &Curve, wish: &Wish) -> Result<Largest, LimitError> {
    curve.largest_master_velocity(
        &wish.limits,
        &wish.master(0.0),
        Factors::default(),
        wish.repeated,
    )
}
