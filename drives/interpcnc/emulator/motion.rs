//! One axis of the emulated board.

use crate::{
    interpcnc::{MoveProfile, registers::MAX_SPEED_HZ},
    ramp::{Motion, Ramp, State},
};

/// An axis: a motion under way or ended, and the profile it was started with.
#[derive(Clone, Copy, Debug)]
pub(in crate::interpcnc) struct Axis {
    motion: Motion,
    ramp: Ramp,
    /// Sense of the motion before the present one, which counts as long as that has not moved.
    positive: bool,
}

impl Default for Axis {
    fn default() -> Self {
        let ramp =
            Ramp { start_stop: 1.0, acceleration: 1e3, speed: 1.0, deceleration: 1e3, target: 0.0 };
        Self { motion: Motion::at_rest(0.0), ramp, positive: false }
    }
}

impl Axis {
    /// Standing somewhere, perhaps between two steps of its counter.
    pub(in crate::interpcnc) fn at_rest(position: f64) -> Self {
        Self { motion: Motion::at_rest(position), ..Self::default() }
    }

    /// Position counter: whole steps.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounded, and a float cast saturates as a counter may"
    )]
    pub(in crate::interpcnc) fn counter(&self, now_ns: i64) -> i32 {
        self.motion.at(now_ns).position.round() as i32
    }

    /// True while an independent move is in progress ("Async Moving").
    pub(in crate::interpcnc) fn moving(&self, now_ns: i64) -> bool {
        self.motion.moving(now_ns)
    }

    /// Speed, steps/s, with sign.
    pub(in crate::interpcnc) fn velocity(&self, now_ns: i64) -> f64 {
        self.motion.at(now_ns).velocity
    }

    /// Direction bit of the extended status: of the motion, or of the last one.
    pub(in crate::interpcnc) fn positive(&self, now_ns: i64) -> bool {
        let sense = self.motion.sense(now_ns);
        if sense == 0.0 { self.positive } else { sense > 0.0 }
    }

    /// Command 80.
    pub(in crate::interpcnc) fn start(&mut self, now_ns: i64, profile: &MoveProfile) {
        let ramp = Ramp {
            start_stop: f64::from(profile.start_stop_hz),
            acceleration: 1e3 * f64::from(profile.acceleration_khz_per_s),
            speed: f64::from(profile.speed_hz.min(MAX_SPEED_HZ)),
            deceleration: 1e3 * f64::from(profile.deceleration_khz_per_s),
            target: f64::from(profile.target),
        };
        self.replace(now_ns, Motion::plan(now_ns, self.motion.at(now_ns), &ramp));
        self.ramp = ramp;
    }

    /// Command 96: ignored at rest and in the final deceleration.
    pub(in crate::interpcnc) fn change_speed(&mut self, now_ns: i64, speed_hz: u32) {
        if self.moving(now_ns) && !self.motion.in_final_brake(now_ns) {
            self.ramp.speed = f64::from(speed_hz.min(MAX_SPEED_HZ));
            self.replace(now_ns, Motion::plan(now_ns, self.motion.at(now_ns), &self.ramp));
        }
    }

    /// Commands 41 and 42.
    pub(in crate::interpcnc) fn ramp_stop(&mut self, now_ns: i64) {
        if self.moving(now_ns) {
            self.replace(now_ns, Motion::stop(now_ns, self.motion.at(now_ns), &self.ramp));
        }
    }

    /// Command 43, loss of ENABLE: stands where it is.
    pub(in crate::interpcnc) fn stop(&mut self, now_ns: i64) {
        let counter = self.counter(now_ns);
        self.replace(now_ns, Motion::at_rest(f64::from(counter)));
    }

    /// Command 67; ignored while the axis moves.
    pub(in crate::interpcnc) fn write_counter(&mut self, now_ns: i64, counter: i32) {
        if !self.moving(now_ns) {
            self.replace(now_ns, Motion::at_rest(f64::from(counter)));
        }
    }

    /// Position and velocity between the steps.
    pub(in crate::interpcnc) fn state(&self, now_ns: i64) -> State {
        self.motion.at(now_ns)
    }

    fn replace(&mut self, now_ns: i64, motion: Motion) {
        self.positive = self.positive(now_ns);
        self.motion = motion;
    }
}
