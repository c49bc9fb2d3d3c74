//! Ramp-in: `VelocityDiff`, `Acceleration` and `Deceleration` of `MC_CamIn` (manual 4.6.1 and 5.4) with which the slave is on its
//! cam soonest, or comes onto it in a given time with the least peak.
//!
//! The ramp is added to the cam, which goes on meanwhile, so both together have to keep the limits of the axis. While the master
//! moves evenly, what both reach is found exactly (`motion/cam/tune/ramp_in/course.rs`). One search finds the best ramp
//! (`motion/cam/tune/ramp_in/search.rs`): from longer and longer times until a ramp keeps the limits for the soonest one, from all
//! times that are short enough for the gentlest.
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
pub use wish::{Held, RampError, RampGoal, RampIn, RampWish};

use super::super::bounds::{Quantity, SlaveLimits};
use super::along::extremes_along;
#[cfg(not(test))]
use problem::Problem;
use search::{Aim, Search};
use twin_profile::RampType;

/// A ramp that takes longer, s, is asked for by mistake; soonest ramps are searched up to this multiple of their least time.
const LONGEST_S: f64 = 3600.0;
const LONGER: f64 = 16.0;
/// A ramp that takes less than this part of a cycle is none.
const NOTHING: f64 = 1e-3;
/// From one time to the next, as a factor, or as a part of a pass of the cam if that is less; how many of these parts, and how many
/// factors are one step between longer times.
const STEP: f64 = 1.26;
const PARTS: f64 = 12.0;
const EVEN: i32 = 16;
const FAR_STEPS: usize = 6;
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
    match wish.goal {
        RampGoal::Soonest => {
            let most_s = LONGEST_S;
            let too_long = |soonest_s| RampError::TooLong { soonest_s, most_s };
            if problem.least_time() > most_s {
                return Err(too_long(problem.least_time()));
            }
            let soonest = problem.first(None).map_or_else(|| Err(problem.refusal()?), Ok)?;
            if soonest.duration_s > most_s {
                return Err(too_long(soonest.duration_s));
            }
            problem.settled(soonest, &Aim { least: None, within_s: f64::INFINITY })
        }
        RampGoal::Gentlest { within_s, least } => problem.gentlest(within_s, least),
    }
}

impl Problem<'_> {
    /// Times that are the same ones for all wishes onto a cam, from the shortest on that a ramp can take. It matters where on its cam
    /// the slave arrives, unless the ramp goes on for much longer than a pass.
    fn times(&self) -> impl Iterator<Item = f64> + use<> {
        let curve = self.curve();
        let pass = (curve.end() - curve.start()) / self.speed().abs();
        let part = if pass.is_finite() { pass / PARTS } else { f64::INFINITY };
        // From here on parts of a pass are less than the steps.
        let even = self.wish.cycle_s.max(part / (STEP - 1.0));
        let (cycle_s, least) = (self.wish.cycle_s, self.least_time());
        let scale = move |index: i32| cycle_s * STEP.powi(index);
        let uneven = (0..).map(scale).take_while(move |time| *time < even);
        let passes = (1..=EVEN).map(move |index| even + part * f64::from(index));
        let last = if part.is_finite() { even + part * f64::from(EVEN) } else { even };
        let far = (0..).map(scale).filter(move |time| *time > last).step_by(FAR_STEPS);
        uneven
            .chain(passes.filter(|time| time.is_finite()))
            .chain(far)
            .filter(move |time| *time * STEP > least)
    }

    /// The best ramp of those that take the least times in which there are any.
    fn first(&self, least: Option<Quantity>) -> Option<RampIn> {
        let mut search = Search::new(self, Aim { least, within_s: f64::INFINITY });
        let longest = LONGEST_S.max(LONGER * self.least_time());
        for time in self.times().take_while(|time| *time <= longest) {
            search.sow(time);
            if search.best().is_some() {
                break;
            }
        }
        search.run();
        search.best()
    }

    /// The ramp with the smallest peak of one quantity that takes a time at most. Shorter ramps are searched, too: an earlier arrival
    /// may have a smaller peak where the cam moves away.
    fn gentlest(&self, within_s: f64, least: Quantity) -> Result<RampIn, RampError> {
        let aim = Aim { least: Some(least), within_s };
        let mut search = Search::new(self, aim);
        for time in self.times().take_while(|time| *time < within_s).chain([within_s]) {
            search.sow(time);
        }
        search.run();
        if search.best().is_none() {
            // One that is soon enough is one that can be made gentler.
            let soonest = self.first(None).map_or_else(|| Err(self.refusal()?), Ok)?;
            if soonest.duration_s > within_s {
                return Err(self.too_late(&soonest, within_s));
            }
            search.begin_with(&soonest);
            search.run();
        }
        self.settled(search.best().map_or_else(|| Err(self.refusal()?), Ok)?, &aim)
    }

    /// Says whether it is the largest `VelocityDiff` that makes a ramp late.
    fn too_late(&self, soonest: &RampIn, within_s: f64) -> RampError {
        // Sooner by this part is sooner.
        const SOONER: f64 = 1e-3;
        let soonest_s = soonest.duration_s;
        let free_s = self.free().first(None).map_or(soonest_s, |free| free.duration_s);
        let sooner = free_s < soonest_s * (1.0 - SOONER);
        let held = sooner.then_some(Held { velocity: self.most, free_s });
        RampError::TooLate { soonest_s, within_s, held }
    }

    /// The limit that prevents a ramp: without it there is one, all others kept.
    fn refusal(&self) -> Result<RampError, RampError> {
        let wish = self.wish;
        let [low, high] = wish.position;
        let free = f64::INFINITY;
        if low.is_finite() || high.is_finite() {
            let anywhere = RampWish { position: [-free, free], ..wish.clone() };
            if let Some(found) = self.with(&anywhere).first(None) {
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
            let Some(found) = self.with(&wish).first(Some(least)) else { continue };
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
