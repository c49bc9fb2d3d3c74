//! Ramp-in: `VelocityDiff`, `Acceleration` and `Deceleration` of `MC_CamIn` (manual 4.6.1 and 5.4) with which the slave is on its
//! cam soonest, or comes onto it in a given time with the least peak.
//!
//! The ramp is added to the cam, which goes on meanwhile, so both together have to keep the limits of the axis. While the master
//! moves evenly, what both reach is found exactly (`motion/cam/tune/ramp_in/course.rs`). One seeded search finds the best ramp
//! (`motion/cam/tune/ramp_in/search.rs`).
//!
//! `MC_CamIn` has no input for the jerk of a ramp: that is the axis's. The limit of the jerk holds for ramp and cam together, so where
//! the cam has one of its own the axis is to have less, and how much that is, is found with the other values.

mod course;
mod passes;
mod problem;
mod search;
mod shown;
mod wish;

#[cfg(test)]
pub(super) use problem::Problem;
pub use shown::{RampMoment, RampShown, on_cam, ramp_shown};
pub use wish::{RampError, RampGoal, RampIn, RampWish};

use super::super::bounds::{Quantity, SlaveLimits};
use super::along::extremes_along;
#[cfg(not(test))]
use problem::Problem;
use search::Aim;
use twin_profile::RampType;

/// A ramp that takes longer, s, is asked for by mistake.
const LONGEST_S: f64 = 3600.0;
/// A ramp that takes less than this part of a cycle is none.
const NOTHING: f64 = 1e-3;

/// Finds the ramp.
///
/// # Errors
/// [`RampError`] if the coupling does not start, the cam leaves nothing over, or the limits do not allow the time.
pub fn ramp_in(wish: &RampWish) -> Result<RampIn, RampError> {
    let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
    let needed = [("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)];
    let count = if wish.ramp == RampType::Trapezoid { 2 } else { 3 };
    for (what, value) in needed.into_iter().take(count) {
        if !(value.is_finite() && value > 0.0) {
            return Err(RampError::NoLimit { what, value });
        }
    }
    let problem = Problem::new(wish)?;
    // Who is on the cam already has nothing to go.
    let at_once = problem.ramp([velocity, acceleration, acceleration, jerk])?;
    if at_once.duration_s <= NOTHING * wish.cycle_s && problem.keeps(&at_once) {
        return Ok(at_once);
    }
    let none = || problem.refusal().unwrap_or_else(|error| error);
    let soonest = || problem.best(Aim::SOONEST).ok_or_else(none);
    match wish.goal {
        RampGoal::Soonest => {
            let too_long = |soonest_s| RampError::TooLong { soonest_s, most_s: LONGEST_S };
            if problem.least_time() > LONGEST_S {
                return Err(too_long(problem.least_time()));
            }
            let found = soonest()?;
            if found.duration_s > LONGEST_S {
                return Err(too_long(found.duration_s));
            }
            problem.settled(found, &Aim::SOONEST)
        }
        RampGoal::Gentlest { within_s, least } => {
            let aim = Aim { least: Some(least), within_s };
            let found = problem.best(aim).map_or_else(soonest, Ok)?;
            if found.duration_s > within_s {
                return Err(RampError::TooLate { soonest_s: found.duration_s, within_s });
            }
            problem.settled(found, &aim)
        }
    }
}

impl Problem<'_> {
    /// The limit that prevents a ramp: without it there is one, all others kept.
    fn refusal(&self) -> Result<RampError, RampError> {
        let wish = self.wish;
        let [low, high] = wish.position;
        let free = f64::INFINITY;
        if low.is_finite() || high.is_finite() {
            let anywhere = RampWish { position: [-free, free], ..wish.clone() };
            if let Some(found) = self.with(&anywhere).best(Aim::SOONEST) {
                let [least, greatest] = found.positions;
                let (reached, limit) = if least < low { (least, low) } else { (greatest, high) };
                return Ok(RampError::Beyond { what: "position", reached, limit });
            }
        }
        for least in [Quantity::Jerk, Quantity::Acceleration, Quantity::Velocity] {
            let (what, limit) = (least.name(), wish.limits.of(least));
            if limit.is_infinite() {
                continue;
            }
            let wish = RampWish { limits: wish.limits.with(least, free), ..wish.clone() };
            let aim = Aim { least: Some(least), within_s: f64::INFINITY };
            let Some(found) = self.with(&wish).best(aim) else { continue };
            let (peak, reached) = (self.peak_of_cam(&found, least), found.peak(least));
            return Ok(if least != Quantity::Jerk && peak >= limit {
                RampError::NoRoom { what, peak, limit }
            } else {
                RampError::Beyond { what, reached, limit }
            });
        }
        let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
        let hardest = self.ramp([velocity.min(self.most), acceleration, acceleration, jerk])?;
        let part = |quantity: &Quantity| hardest.peak(*quantity) / wish.limits.of(*quantity);
        let worst =
            Quantity::ALL.into_iter().max_by(|one, other| part(one).total_cmp(&part(other)));
        let worst = worst.unwrap_or(Quantity::Jerk);
        let (reached, limit) = (hardest.peak(worst), wish.limits.of(worst));
        Ok(RampError::Beyond { what: worst.name(), reached, limit })
    }

    /// The peak of the cam alone during a ramp.
    fn peak_of_cam(&self, ramp: &RampIn, quantity: Quantity) -> f64 {
        let (speed, periodic) = (self.speed(), self.wish.table.periodic);
        let found = extremes_along(self.curve(), self.place, speed * ramp.duration_s, periodic);
        let peak = match quantity {
            Quantity::Velocity => found.velocity.magnitude() * speed,
            Quantity::Acceleration => found.acceleration.magnitude() * speed * speed,
            Quantity::Jerk => found.jerk.magnitude() * speed.powi(3),
        };
        (peak * self.wish.input.slave_scaling).abs()
    }
}
