//! Following a plan with independent moves that are retargeted (command 80): what its registers can say.
//!
//! # When the program dies
//!
//! No watchdog is documented: each axis goes on to its last target and rests there. That target is a position of the
//! plan within its horizon, so an axis goes on for at most horizon × speed; with segments ([`Buffered`]) the one under
//! way and at most one that waits are carried out, which end within the horizon as well (`kill` in
//! `tests/fault_matrix`).

mod buffered;
#[cfg(test)]
mod tests;

pub(crate) use buffered::{Buffered, SegmentOrder};

use crate::{AxisOptions, Line, MoveProfile};
use twin_drives::{
    follow::{self, Registers, Timing},
    ramp::Ramp,
};

/// Follows a plan; speaks to nobody.
pub(crate) type Follower = follow::Follower<AxisOptions>;

/// The follower of axes at rest on a line.
pub(crate) fn follower(axes: &[AxisOptions], line: Line) -> Follower {
    // Request 27 bytes, answer 8, two silences; 2 ms for the board until it is known better.
    let silence = line.silence().as_secs_f64();
    let timing = Timing {
        exchange: line.duration(35).as_secs_f64() + 2.0 * silence + 0.002,
        lead: line.duration(27).as_secs_f64() + 2.0 * silence,
        uncertainty: 0.5 * silence + 0.001,
        samples: 1,
    };
    Follower::new(axes, &timing)
}

impl Registers for AxisOptions {
    type Move = MoveProfile;

    const ONE_RATE: bool = false;

    fn limits(&self) -> Ramp {
        Ramp {
            start_stop: f64::from(self.start_stop_hz),
            acceleration: 1e3 * f64::from(self.acceleration_khz_per_s),
            speed: f64::from(self.max_speed_hz),
            deceleration: 1e3 * f64::from(self.deceleration_khz_per_s),
            target: 0.0,
        }
    }

    fn speed_step(&self) -> f64 {
        1.0
    }

    fn whole_speed(&self, speed: f64) -> f64 {
        speed.round()
    }

    /// Whole kHz/s.
    fn whole_rate(&self, rate: f64, most: f64) -> f64 {
        ((rate / 1e3).ceil() * 1e3).clamp(1e3, most.max(1e3))
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive and limited"
    )]
    fn encode(&self, wanted: &Ramp) -> MoveProfile {
        let limits = self.limits();
        let up = self.whole_rate(wanted.acceleration, limits.acceleration);
        let down = self.whole_rate(wanted.deceleration, limits.deceleration);
        MoveProfile {
            start_stop_hz: self.start_stop_hz,
            acceleration_khz_per_s: (up / 1e3) as u16,
            speed_hz: wanted.speed.round().clamp(1.0, limits.speed) as u32,
            deceleration_khz_per_s: (down / 1e3) as u16,
            target: wanted.target.round() as i32,
        }
    }

    fn ramp(&self, profile: &MoveProfile) -> Ramp {
        Ramp {
            start_stop: f64::from(profile.start_stop_hz),
            acceleration: 1e3 * f64::from(profile.acceleration_khz_per_s),
            speed: f64::from(profile.speed_hz),
            deceleration: 1e3 * f64::from(profile.deceleration_khz_per_s),
            target: f64::from(profile.target),
        }
    }
}
