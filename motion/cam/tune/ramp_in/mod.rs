//! Ramp-in optimisation: `VelocityDiff`, `Acceleration` and `Deceleration` of `MC_CamIn` (manual 4.6.1 and 5.4).
//!
//! The slave reaches its cam either as soon as possible, or in a given time with the smallest peak.
//!
//! The ramp is added to the cam, which goes on meanwhile, so both together have to keep the limits of the axis. While
//! the master moves evenly, the cam's velocity and acceleration are polynomials of time. Those of the ramp are
//! piecewise lines or, with limited jerk, parabolas or sines. The extremes of the sum are found exactly
//! (`motion/cam/tune/ramp_in/course.rs`).
//!
//! One search serves both goals (`motion/cam/tune/ramp_in/search.rs`). It begins with ramps of many kinds and durations
//! (`motion/cam/tune/ramp_in/seeds.rs`). For the soonest ramp the durations grow until one keeps the limits. For the
//! gentlest ramp all durations up to the given time are tried, because an earlier arrival may be gentler where the cam
//! moves away.
//!
//! `MC_CamIn` has no input for the jerk of a ramp: that is the axis's. The jerk limit holds for ramp and cam together.
//! So where the cam has a jerk of its own the axis must be given less; how much less is found with the other values.

mod course;
mod descent;
mod passes;
mod place;
mod problem;
mod program;
mod refusal;
mod search;
mod seeds;
mod settled;
mod shown;
mod wish;

#[cfg(test)]
pub(super) use problem::Problem;
pub use shown::{RampMoment, RampShown, on_cam, ramp_shown};
pub use wish::{Held, RampError, RampGoal, RampIn, RampWish};

use super::super::bounds::{Quantity, SlaveLimits};
use place::Aim;
#[cfg(not(test))]
use problem::Problem;
use search::Search;
use twin_profile::RampType;

/// A ramp that takes longer, s, is asked for by mistake.
const LONGEST_S: f64 = 3600.0;
/// A soonest ramp is looked for so much beyond the least time where that is longer.
const LONGER: f64 = 16.0;
/// Of a cycle: a ramp that takes less is none.
const NOTHING: f64 = 1e-3;
/// From one time with which ramps are begun to the next, as a factor; of a pass of the cam so many parts, and how many of them;
/// and how many of the factors are one step between longer times.
const STEP: f64 = 1.26;
const PARTS: f64 = 12.0;
const EVEN: i32 = 16;
const FAR_STEPS: usize = 6;
/// Twice the time is no gain if the ramp is gentler by less than this part, and if it is none so often, no more is looked at.
const NEXT: f64 = 1e-3;
const IDLE: usize = 3;
/// A ramp that is sooner by this part is sooner.
const HELD: f64 = 1e-3;

/// Finds the ramp.
///
/// # Errors
/// [`RampError`] if the coupling does not start, the cam leaves nothing over, or the limits do not allow the time.
pub fn ramp_in(wish: &RampWish) -> Result<RampIn, RampError> {
    let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
    let mut needed = vec![("velocity", velocity), ("acceleration", acceleration)];
    if wish.ramp != RampType::Trapezoid {
        needed.push(("jerk", jerk));
    }
    for (what, value) in needed {
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
            let aim = Aim { least: None, within_s: f64::INFINITY };
            let soonest = problem.soonest()?.map_or_else(|| Err(problem.refusal()?), Ok)?;
            if soonest.duration_s > LONGEST_S {
                let most_s = LONGEST_S;
                return Err(RampError::TooLong { soonest_s: soonest.duration_s, most_s });
            }
            problem.settled(soonest, &aim)
        }
        RampGoal::Gentlest { within_s, least } => problem.gentlest(within_s, least),
    }
}

impl Problem<'_> {
    /// Times that are the same ones for all wishes onto a cam, from the shortest on that a ramp can take: each longer than the one
    /// before by a part of it, or of a pass of the cam if that is less, for it matters where on its cam the slave arrives. Ramps
    /// that go on for much longer than the cam does the same differ little.
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
        let far = (0..).map(scale).filter(move |time| *time > last);
        let far = far.enumerate().filter(|(index, _)| index % FAR_STEPS == 0).map(|(_, time)| time);
        uneven
            .chain(passes.filter(|time| time.is_finite()))
            .chain(far)
            .filter(move |time| *time * STEP > least)
    }

    /// The ramp that takes the least time.
    fn soonest(&self) -> Result<Option<RampIn>, RampError> {
        self.first(None)
    }

    /// The best one of those that take the least times in which there are any.
    fn first(&self, least: Option<Quantity>) -> Result<Option<RampIn>, RampError> {
        let mut search = Search::new(self, Aim { least, within_s: f64::INFINITY });
        let longest = LONGEST_S.max(LONGER * self.least_time());
        for time in self.times().take_while(|time| *time <= longest) {
            search.sow(time);
            if search.best().is_some() {
                break;
            }
        }
        search.run()?;
        Ok(search.best())
    }

    /// The ramp with the smallest peak of one quantity that takes a time at most.
    ///
    /// Shorter times are looked at first, from each of them to the next twice as long and the same ones for all wishes: the best
    /// ramp that takes less is one of those that the next search begins with. So who has more time does not end in a worse
    /// valley than who has less.
    fn gentlest(&self, within_s: f64, least: Quantity) -> Result<RampIn, RampError> {
        let (mut before, mut idle) = (None, 0);
        let (cycle_s, least_s) = (self.wish.cycle_s, self.least_time());
        let shorter = (0..).map(|octave| cycle_s * 2.0_f64.powi(octave));
        let aim = |within_s| Aim { least: Some(least), within_s };
        for time in shorter.take_while(|time| *time < within_s).filter(|time| *time > least_s) {
            let found = self.gentle_search(aim(time), before)?;
            let gains = match (before, found) {
                (Some(before), Some(found)) => {
                    aim(time).of(&found) < aim(time).of(&before) * (1.0 - NEXT)
                }
                _ => true,
            };
            idle = if gains { 0 } else { idle + 1 };
            before = found;
            if idle == IDLE {
                break;
            }
        }
        let mut found = self.gentle_search(aim(within_s), before)?;
        if found.is_none() {
            // One that is soon enough is one that can be made gentler.
            let soonest = self.soonest()?.map_or_else(|| Err(self.refusal()?), Ok)?;
            if soonest.duration_s > within_s {
                return Err(self.too_late(&soonest, within_s)?);
            }
            found = self.gentle_search(aim(within_s), Some(soonest))?;
        }
        let found = found.map_or_else(|| Err(self.refusal()?), Ok)?;
        self.settled(found, &aim(within_s))
    }

    /// The best ramp in a time at most, from ramps of all shorter times on and from one that is known.
    fn gentle_search(&self, aim: Aim, known: Option<RampIn>) -> Result<Option<RampIn>, RampError> {
        let mut search = Search::new(self, aim);
        for time in self.times().take_while(|time| *time < aim.within_s) {
            search.sow(time);
        }
        search.sow(aim.within_s);
        if let Some(known) = known {
            search.begin_with(&known);
        }
        search.run()?;
        Ok(search.best())
    }

    /// Says whether it is the largest `VelocityDiff` that makes a ramp late.
    fn too_late(&self, soonest: &RampIn, within_s: f64) -> Result<RampError, RampError> {
        let soonest_s = soonest.duration_s;
        let free_s = self.free().soonest()?.map_or(soonest_s, |free| free.duration_s);
        let sooner = free_s < soonest_s * (1.0 - HELD);
        let held = sooner.then_some(Held { velocity: self.most, free_s });
        Ok(RampError::TooLate { soonest_s, within_s, held })
    }
}
