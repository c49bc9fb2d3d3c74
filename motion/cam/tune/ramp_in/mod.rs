//! Ramp-in: `VelocityDiff`, `Acceleration` and `Deceleration` of `MC_CamIn` (manual 4.6.1 and 5.4).
//!
//! The ramp is added to the cam, which goes on meanwhile. It therefore gets what the cam leaves of the slave's limits on the way of
//! the master until then: the limit less the peak of the cam. Both together keep the limits, whatever their signs. The soonest ramp
//! uses all of it; the gentlest one has the smallest peak of ramp and cam together among ramps that arrive in the given time
//! or sooner with the smallest acceleration, or jerk, of their own.
//!
//! `MC_CamIn` has no input for the jerk of a ramp: that is the axis's, which is to be the limit less what the cam needs.

mod problem;
mod shown;
mod wish;

pub use shown::{RampMoment, RampShown, on_cam, ramp_shown};
pub use wish::{RampError, RampGoal, RampIn, RampWish};

use super::super::bounds::{Quantity, SlaveLimits};
use problem::Problem;
use twin_profile::RampType;

/// A ramp that takes longer, s, is asked for by mistake.
const LONGEST_S: f64 = 3600.0;
/// The soonest ramp assumes a longer way of the cam than its own, by this part.
const FURTHER: f64 = 1e-3;
/// Times up to the given one for which the gentlest ramp is found.
const TIMES: u32 = 12;
/// Halvings of the range of the gentlest ramp.
const HALVINGS: u32 = 60;

/// Finds the ramp.
///
/// # Errors
/// [`RampError`] if the coupling does not start, the cam leaves nothing over, or the limits do not allow the time.
pub fn ramp_in(wish: &RampWish) -> Result<RampIn, RampError> {
    let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
    let needed = [("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)];
    let steps = wish.ramp == RampType::Trapezoid;
    for (what, value) in needed.into_iter().take(if steps { 2 } else { 3 }) {
        if !(value.is_finite() && value > 0.0) {
            return Err(RampError::NoLimit { what, value });
        }
    }
    let least_jerk = matches!(wish.goal, RampGoal::Gentlest { least: Quantity::Jerk, .. });
    if steps && (jerk.is_finite() || least_jerk) {
        return Err(RampError::Steps);
    }
    let problem = Problem::new(wish)?;
    let soonest = problem.soonest()?;
    let soonest_s = soonest.duration_s;
    let ramp = match wish.goal {
        RampGoal::Soonest if soonest_s > LONGEST_S => {
            return Err(RampError::TooLong { soonest_s, most_s: LONGEST_S });
        }
        RampGoal::Soonest => soonest,
        RampGoal::Gentlest { within_s, .. } if soonest_s > within_s => {
            return Err(RampError::TooLate { soonest_s, within_s });
        }
        RampGoal::Gentlest { within_s, least } => {
            // The cam may need more on a longer way.
            let times = (1..=TIMES).map(|k| f64::from(k) / f64::from(TIMES));
            let times = times.map(|part| soonest_s + part * (within_s - soonest_s));
            let all = times.filter_map(|time_s| problem.gentlest(time_s, least));
            let all = all.chain([soonest]).filter(|ramp| problem.beyond(ramp).is_none());
            all.min_by(|one, other| one.peak(least).total_cmp(&other.peak(least)))
                .unwrap_or(soonest)
        }
    };
    problem.beyond(&ramp).map_or(Ok(ramp), Err)
}

impl Problem<'_> {
    /// The ramp with all that the cam leaves.
    fn soonest(&self) -> Result<RampIn, RampError> {
        let mut time_s = 0.0;
        loop {
            let ramp = self.ramp(self.left(time_s)?)?;
            if ramp.duration_s <= time_s || ramp.duration_s > f64::from(u32::MAX) {
                return Ok(ramp);
            }
            time_s = ramp.duration_s * (1.0 + FURTHER);
        }
    }

    /// The ramp in a time with the smallest peak; none if what the cam leaves on the way in that time does not do.
    fn gentlest(&self, within_s: f64, least: Quantity) -> Option<RampIn> {
        let most = self.left(within_s).ok()?;
        let with = |part: f64| {
            let mut values = most;
            match least {
                Quantity::Velocity => values[0] *= part,
                Quantity::Acceleration => (values[1], values[2]) = (most[1] * part, most[2] * part),
                Quantity::Jerk => values[3] *= part,
            }
            let ramp = self.ramp(values).ok()?;
            (ramp.duration_s <= within_s && self.beyond(&ramp).is_none()).then_some(ramp)
        };
        let mut best = with(1.0)?;
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            match with(middle) {
                Some(ramp) => (best, high) = (ramp, middle),
                None => low = middle,
            }
        }
        Some(best)
    }
}
