//! Following a plan with GOTO v,a (63h): what its registers can say.
//!
//! Speeds are whole rpm, rounded up: an axis that is a bit too fast is slowed down again, one that is too slow would
//! fall behind for ever. Rates are whole rpm/s, one for acceleration and deceleration. Every answer is a sample, so a
//! round has one exchange for each axis, whether it needs a command or only a look.
//!
//! # When the program dies
//!
//! Nothing in a drive watches its master: it goes on to the target of its last GOTO and rests there. That target is a
//! position of the plan within its horizon, so the drive goes on for at most horizon × speed (`kill` in
//! `tests/fault_matrix`).

#[cfg(test)]
mod tests;

use std::time::Duration;

use crate::{client::AxisOptions, protocol::command::Command, protocol::line::wire_time};
use twin_drives::{
    follow::{self, Registers, Timing},
    ramp::Ramp,
};

/// Follows a plan; speaks to nobody.
pub(crate) type Follower = follow::Follower<AxisOptions>;

/// What of a speed counts as rounding, rpm.
const ROUNDING: f64 = 1e-6;

/// The numbers of a GOTO v,a.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GoTo {
    /// µsteps.
    pub target: i32,
    /// rpm, not 0.
    pub speed: u16,
    /// rpm/s, not 0.
    pub rate: u16,
}

impl GoTo {
    /// As it goes over the wire.
    pub(crate) fn command(self) -> Command {
        Command::GoTo { target: self.target, profile: Some((self.speed, self.rate)) }
    }
}

/// The follower of drives at rest. `delay` is the expected time of an answer until the first measurement.
pub(crate) fn follower(axes: &[AxisOptions], delay: Duration) -> Follower {
    let delay = delay.as_secs_f64();
    let timing = Timing {
        exchange: wire_time(11 + 9).as_secs_f64() + delay + 0.001,
        lead: wire_time(11).as_secs_f64() + 0.5 * delay,
        uncertainty: 0.5 * delay + 0.0005,
        samples: 0,
    };
    Follower::new(axes, &timing)
}

impl AxisOptions {
    /// A number of rpm or rpm/s as registers hold it: whole, rounded up, 1 to `most`.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive and limited"
    )]
    fn whole(self, steps: f64, most: u16) -> u16 {
        let whole = (self.turn.rpm(steps) - ROUNDING).ceil();
        whole.clamp(1.0, f64::from(most.max(1))) as u16
    }
}

impl Registers for AxisOptions {
    type Move = GoTo;

    const ONE_RATE: bool = true;

    fn limits(&self) -> Ramp {
        self.ceilings().ramp(0, 0, 0)
    }

    fn speed_step(&self) -> f64 {
        self.turn.steps(1.0)
    }

    fn whole_speed(&self, speed: f64) -> f64 {
        self.turn.steps(f64::from(self.whole(speed, self.velocity_rpm)))
    }

    fn whole_rate(&self, rate: f64, most: f64) -> f64 {
        self.turn.steps(f64::from(self.whole(rate.min(most), u16::MAX)))
    }

    #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates as a counter does")]
    fn encode(&self, wanted: &Ramp) -> GoTo {
        let steepest = self.acceleration_rpm_per_s.max(self.deceleration_rpm_per_s);
        GoTo {
            target: wanted.target.round() as i32,
            speed: self.whole(wanted.speed, self.velocity_rpm),
            rate: self.whole(wanted.acceleration.max(wanted.deceleration), steepest),
        }
    }

    fn ramp(&self, order: &GoTo) -> Ramp {
        self.ceilings().ramp(order.target, order.speed, order.rate)
    }
}
