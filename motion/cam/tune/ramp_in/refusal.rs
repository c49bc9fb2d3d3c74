//! Diagnosis of an infeasible ramp: finds the limit that alone rules out every ramp.

use super::place::Aim;
use super::problem::Problem;
use super::wish::{RampError, RampIn, RampWish};
use crate::tune::along::extremes_along;
use crate::{Quantity, SlaveLimits};

impl Problem<'_> {
    /// What leaves no ramp over.
    pub(super) fn refusal(&self) -> Result<RampError, RampError> {
        let wish = self.wish;
        let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
        let [low, high] = wish.position;
        let anywhere = RampWish { position: [f64::NEG_INFINITY, f64::INFINITY], ..wish.clone() };
        let held = low.is_finite() || high.is_finite();
        if let Some(found) = self.freed(held, &anywhere, None)? {
            let [least, greatest] = found.positions;
            let (reached, limit) = if least < low { (least, low) } else { (greatest, high) };
            return Ok(RampError::Beyond { what: "position", reached, limit });
        }
        let free = f64::INFINITY;
        for (what, least, limit, limits) in [
            ("jerk", Quantity::Jerk, jerk, SlaveLimits { jerk: free, ..wish.limits }),
            (
                "acceleration",
                Quantity::Acceleration,
                acceleration,
                SlaveLimits { acceleration: free, ..wish.limits },
            ),
            (
                "velocity",
                Quantity::Velocity,
                velocity,
                SlaveLimits { velocity: free, ..wish.limits },
            ),
        ] {
            let wish = RampWish { limits, ..wish.clone() };
            let Some(found) = self.freed(limit.is_finite(), &wish, Some(least))? else { continue };
            let peak = self.peak_of_cam(&found, least);
            let aim = Aim { least: Some(least), within_s: free };
            return Ok(if least != Quantity::Jerk && peak >= limit {
                RampError::NoRoom { what, peak, limit }
            } else {
                RampError::Beyond { what, reached: aim.of(&found), limit }
            });
        }
        let hardest = [velocity.min(self.most), acceleration, acceleration, jerk];
        Ok(self.worst(&self.ramp(hardest)?))
    }

    /// Where a limit is held, the gentlest ramp that is found without it, or the soonest.
    fn freed(
        &self,
        held: bool,
        wish: &RampWish,
        least: Option<Quantity>,
    ) -> Result<Option<RampIn>, RampError> {
        if held { self.with(wish).first(least) } else { Ok(None) }
    }

    /// What the cam alone reaches of a quantity beside a ramp, whose own is beside it.
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

    /// Of a ramp what is beyond its limit by the largest part.
    fn worst(&self, ramp: &RampIn) -> RampError {
        let SlaveLimits { velocity, acceleration, jerk } = self.wish.limits;
        let all = [
            ("jerk", ramp.peak_jerk, jerk),
            ("acceleration", ramp.peak_acceleration, acceleration),
            ("velocity", ramp.peak_velocity, velocity),
        ];
        let [first, ..] = all;
        let part = |(_, reached, limit): &(&str, f64, f64)| reached / limit;
        let worst = all.into_iter().max_by(|one, other| part(one).total_cmp(&part(other)));
        let (what, reached, limit) = worst.unwrap_or(first);
        RampError::Beyond { what, reached, limit }
    }
}
