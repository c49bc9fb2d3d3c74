//! Moves points of a cam within tolerances so that its master may go faster, or that the slave's peak becomes smaller.
//!
//! At given master positions y, y′, y″ and y‴ are linear in position, velocity and acceleration of the points on both sides.
//! For one velocity of the master "nothing exceeds s times its limit, s as small as possible" is a linear program
//! (`motion/cam/tune/reshape/program.rs`). The largest velocity of the new cam is the next one to try, and it never falls. The
//! smallest peak at a given velocity is one such program: the other quantities keep their limits.
//!
//! Points keep their masters, so the cam stays twice continuously differentiable and tappets stay where they are; the
//! slave stays where it is at every tappet, too.

mod program;
mod short;

use super::super::bounds::{Factors, MasterMotion, Peak, Quantity, SlaveLimits};
use super::super::curve::Curve;
use super::super::error::CamError;
use super::super::knot::Knot;
use crate::maximum_master_velocity::{Largest, LimitError};
use clarabel::solver::SolverStatus;
use program::{Problem, rows};
#[cfg(test)]
pub(super) use short::near;
use short::shortened;

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
    /// The master's acceleration that counts with its velocity, u/s².
    pub master_acceleration: f64,
    /// The master's jerk that counts with them, u/s³; for the jerk of the slave only.
    pub master_jerk: f64,
    /// Whether the cam is periodic: its end changes with its begin.
    pub repeated: bool,
}

/// Points that were moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Reshaped<T> {
    /// The points.
    pub knots: Vec<Knot>,
    /// The largest velocity of the master, or the peak of the slave, before, exact.
    pub before: T,
    /// The same now, exact.
    pub after: T,
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
    #[error("point {index}: a tolerance of {value} is not a magnitude")]
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
    /// Clarabel came to no answer, or to one that is not good enough.
    #[error("Clarabel ended with {0:?}")]
    NotSolved(SolverStatus),
}

/// Velocities that are tried.
const TRIALS: usize = 40;
/// A gain in velocity, or in a peak, below this part of it is not worth another trial, or to move a point.
const GAIN: f64 = 1e-7;
/// A position beyond its limit by less than this part of the cam's height is rounding.
const POSITION: f64 = 1e-12;
/// A limit that is exceeded by less than this part is kept.
const KEPT: f64 = 1e-6;
/// Where it is kept by points as they are rounded, it is exceeded by rounding alone.
const ROUNDING: f64 = 1e-12;
/// What was to be best may be worse by this part with short points: linear programs know it no better.
const LOSS: f64 = 1e-7;

/// Moves the points of a polynomial cam within their tolerances so that the master may go as fast as possible.
///
/// # Errors
/// [`ReshapeError`] if the points make no cam, or nothing limits the slave.
pub fn reshape(knots: &[Knot], wish: &Wish) -> Result<Reshaped<Largest>, ReshapeError> {
    check(knots, wish)?;
    let fastest = |knots: &[Knot]| -> Result<Largest, ReshapeError> {
        let (curve, master) = (Curve::polynomial(knots)?, wish.master(0.0));
        let factors = Factors::default();
        Ok(curve.largest_master_velocity(&wish.limits, &master, factors, wish.repeated)?)
    };
    let before = fastest(knots)?;
    if before.limited.is_none() {
        return Err(ReshapeError::NoLimit);
    }
    let mut problem = Problem::new(knots, wish, &rows(wish, 1.0, None));
    let mut best = Reshaped { knots: knots.to_vec(), before, after: before, programs: 0 };
    // A cam that leaves its positions as it is has to be changed, even if it becomes slower.
    let stays = wish.keeps_position(knots)?;
    let mut kept = stays;
    for _ in 0..if problem.unknowns.is_empty() { 0 } else { TRIALS } {
        let velocity = best.after.value;
        let moved = problem.solve(&rows(wish, velocity, None))?;
        let Ok(after) = fastest(&moved) else { break };
        if !wish.keeps_position(&moved)? {
            break;
        }
        let (gain, first) = (after.value / velocity - 1.0, !kept);
        if gain > 0.0 || first {
            (best.knots, best.after, kept) = (moved, after, true);
        }
        if (gain <= GAIN && !first) || after.limited.is_none() {
            break;
        }
    }
    if !kept {
        return Err(ReshapeError::NoShape);
    }
    best.programs = problem.programs;
    // A smaller gain is in the last digits of the solver and does not move a point.
    if best.after.value <= before.value * (1.0 + GAIN) && stays {
        return Ok(Reshaped { knots: knots.to_vec(), after: before, ..best });
    }
    let faster = best.after.value >= before.value;
    let least = (best.after.value * (1.0 - LOSS)).max(if faster { before.value } else { 0.0 });
    best.knots = shortened(knots, &best.knots, wish, &|knots| {
        fastest(knots).is_ok_and(|found| found.value >= least)
            && wish.keeps_position(knots).unwrap_or(false)
    });
    best.after = fastest(&best.knots)?;
    Ok(best)
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
) -> Result<Reshaped<Peak>, ReshapeError> {
    check(knots, wish)?;
    if !(velocity.is_finite() && velocity > 0.0) {
        let name = "the master's velocity";
        return Err(LimitError::NoMagnitude { name, value: velocity }.into());
    }
    let master = wish.master(velocity);
    let of = |knots: &[Knot], quantity| -> Result<Peak, CamError> {
        Ok(Curve::polynomial(knots)?.peak(quantity, &master, Factors::default()))
    };
    let before = of(knots, quantity)?;
    let mut best = Reshaped { knots: knots.to_vec(), before, after: before, programs: 0 };
    let rows = rows(wish, velocity, Some((quantity, before.value)));
    let mut problem = Problem::new(knots, wish, &rows);
    let stays = wish.keeps_position(knots)?;
    let unmoved = |best| if stays { Ok(best) } else { Err(ReshapeError::NoShape) };
    if problem.unknowns.is_empty() || before.value == 0.0 {
        return unmoved(best);
    }
    let moved = problem.solve(&rows)?;
    best.programs = problem.programs;
    if !wish.keeps_position(&moved)? {
        return unmoved(best);
    }
    // By which part the other quantities exceed their limits.
    let excess = |knots: &[Knot]| -> Result<Vec<f64>, CamError> {
        let others = Quantity::ALL.into_iter().filter(|other| *other != quantity);
        others.map(|other| Ok(of(knots, other)?.value / wish.limits.of(other) - 1.0)).collect()
    };
    let room = excess(&moved)?;
    if room.iter().any(|excess| *excess > KEPT) {
        return Err(ReshapeError::NotSolved(SolverStatus::AlmostSolved));
    }
    let after = of(&moved, quantity)?.value;
    // What exceeds its limits as it is has to be changed, even if its peak grows.
    let kept = excess(knots)?.into_iter().all(|excess| excess <= KEPT);
    if after < before.value * (1.0 - GAIN) || !stays || !kept {
        let most = if after <= before.value { before.value } else { f64::INFINITY };
        let most = most.min(after * (1.0 + LOSS));
        best.knots = shortened(knots, &moved, wish, &|short| {
            let within = |excess: Vec<f64>| {
                excess.iter().zip(&room).all(|(excess, room)| *excess <= room.max(ROUNDING))
            };
            of(short, quantity).is_ok_and(|peak| peak.value <= most)
                && excess(short).is_ok_and(within)
                && wish.keeps_position(short).unwrap_or(false)
        });
        best.after = of(&best.knots, quantity)?;
    }
    Ok(best)
}

fn check(knots: &[Knot], wish: &Wish) -> Result<(), ReshapeError> {
    if wish.tolerances.len() != knots.len() {
        let (found, expected) = (wish.tolerances.len(), knots.len());
        return Err(ReshapeError::Tolerances { found, expected });
    }
    let magnitude = |value: f64| value.is_finite() && value >= 0.0;
    for (index, tolerance) in (1..).zip(&wish.tolerances) {
        let all = [tolerance.slave, tolerance.velocity, tolerance.acceleration];
        if let Some(value) = all.into_iter().find(|value| !magnitude(*value)) {
            return Err(ReshapeError::NoMagnitude { index, value });
        }
    }
    for (name, value) in [
        ("the master's acceleration", wish.master_acceleration),
        ("the master's jerk", wish.master_jerk),
    ] {
        if !magnitude(value) {
            return Err(LimitError::NoMagnitude { name, value }.into());
        }
    }
    Ok(())
}

impl Wish {
    /// What the master does at most, at a velocity, u/s.
    fn master(&self, velocity: f64) -> MasterMotion {
        let (acceleration, jerk) = (self.master_acceleration, self.master_jerk);
        MasterMotion { velocity, acceleration, jerk }
    }

    /// Whether the slave stays within its positions, rounding aside.
    fn keeps_position(&self, knots: &[Knot]) -> Result<bool, CamError> {
        let [low, high] = self.position;
        let found = Curve::polynomial(knots)?.extremes().position;
        let room = POSITION * (found.max - found.min).max(found.magnitude());
        Ok(found.min >= low - room && found.max <= high + room)
    }
}
