//! One axis of the emulated board.

use crate::{MoveProfile, protocol::registers::MAX_SPEED_HZ};
use twin_drives::ramp::{Motion, Ramp, State};

/// An axis: a motion under way or ended, and the profile it was started with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis {
    motion: Motion,
    ramp: Ramp,
    /// Sense of the motion before the present one, which counts as long as that has not moved.
    positive: bool,
    /// The motion is part of an interpolated move.
    interpolated: bool,
    /// The motion is a ramp stop.
    braking: bool,
    /// Where the mechanics are when the counter is 0, steps.
    shift: f64,
    /// Where the mechanics are held while the motor is stalled, steps.
    stalled: Option<f64>,
}

impl Default for Axis {
    fn default() -> Self {
        let ramp =
            Ramp { start_stop: 1.0, acceleration: 1e3, speed: 1.0, deceleration: 1e3, target: 0.0 };
        Self {
            motion: Motion::at_rest(0.0),
            ramp,
            positive: false,
            interpolated: false,
            braking: false,
            shift: 0.0,
            stalled: None,
        }
    }
}

impl Axis {
    /// Standing somewhere, perhaps between two steps of its counter.
    pub(crate) fn at_rest(position: f64) -> Self {
        Self { motion: Motion::at_rest(position), ..Self::default() }
    }

    /// Position counter: whole steps, each from half a step before its middle on.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "whole, and a float cast saturates as a counter may"
    )]
    pub(crate) fn counter(&self, now_ns: i64) -> i32 {
        (self.motion.at(now_ns).position + 0.5).floor() as i32
    }

    /// True while any move is in progress.
    pub(crate) fn moving(&self, now_ns: i64) -> bool {
        self.motion.moving(now_ns)
    }

    /// True while an independent move is in progress ("Async Moving").
    pub(super) fn independent(&self, now_ns: i64) -> bool {
        self.moving(now_ns) && !self.interpolated
    }

    /// True while it takes part in an interpolated move.
    pub(super) fn interpolating(&self, now_ns: i64) -> bool {
        self.moving(now_ns) && self.interpolated
    }

    /// True while it stops on its ramp.
    pub(super) fn is_braking(&self) -> bool {
        self.braking
    }

    /// Speed, steps/s, with sign.
    pub(crate) fn velocity(&self, now_ns: i64) -> f64 {
        self.motion.at(now_ns).velocity
    }

    /// Direction bit of the extended status: of the motion, or of the last one.
    pub(crate) fn positive(&self, now_ns: i64) -> bool {
        let sense = self.motion.sense(now_ns);
        if sense == 0.0 { self.positive } else { sense > 0.0 }
    }

    /// Command 80.
    pub(crate) fn start(&mut self, now_ns: i64, profile: &MoveProfile) {
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

    /// Its part of an interpolated move, from rest.
    pub(crate) fn start_segment(&mut self, now_ns: i64, ramp: &Ramp) {
        self.replace(now_ns, Motion::plan(now_ns, self.motion.at(now_ns), ramp));
        self.ramp = *ramp;
        self.interpolated = true;
    }

    /// Command 96: ignored at rest, in the final deceleration and in other moves than independent ones.
    pub(crate) fn change_speed(&mut self, now_ns: i64, speed_hz: u32) {
        if self.independent(now_ns) && !self.braking && !self.motion.in_final_brake(now_ns) {
            self.ramp.speed = f64::from(speed_hz.min(MAX_SPEED_HZ));
            self.replace(now_ns, Motion::plan(now_ns, self.motion.at(now_ns), &self.ramp));
        }
    }

    /// Commands 41 and 42.
    pub(crate) fn ramp_stop(&mut self, now_ns: i64) {
        if self.moving(now_ns) && !self.braking {
            let interpolated = self.interpolated;
            self.replace(now_ns, Motion::stop(now_ns, self.motion.at(now_ns), &self.ramp));
            (self.interpolated, self.braking) = (interpolated, true);
        }
    }

    /// Command 43, loss of ENABLE: rests where it is.
    pub(crate) fn stop(&mut self, now_ns: i64) {
        let counter = self.counter(now_ns);
        self.replace(now_ns, Motion::at_rest(f64::from(counter)));
    }

    /// Command 67; ignored while the axis moves.
    pub(crate) fn write_counter(&mut self, now_ns: i64, counter: i32) {
        if !self.moving(now_ns) {
            let counter = f64::from(counter);
            self.shift += self.state(now_ns).position - counter;
            self.replace(now_ns, Motion::at_rest(counter));
        }
    }

    /// Position and velocity between the steps.
    pub(crate) fn state(&self, now_ns: i64) -> State {
        self.motion.at(now_ns)
    }

    /// Where the mechanics are, steps from where they were when the board was first powered up.
    pub(super) fn mechanical(&self, now_ns: i64) -> f64 {
        self.stalled.unwrap_or_else(|| self.state(now_ns).position + self.shift)
    }

    /// The first instant at which the mechanics are on the other side of `edge`.
    pub(super) fn crossing(&self, after_ns: i64, edge: f64) -> Option<i64> {
        if self.stalled.is_some() {
            return None;
        }
        self.motion.crossing(after_ns, edge - self.shift)
    }

    /// When its motion ends, if that is to come.
    pub(super) fn end_ns(&self, now_ns: i64) -> Option<i64> {
        self.moving(now_ns).then(|| self.motion.end_ns())
    }

    /// Whether its motion reverses.
    pub(super) fn has_turn(&self) -> bool {
        self.motion.turns()
    }

    /// When it has last turned or will turn in order to reverse.
    pub(super) fn turn_ns(&self) -> i64 {
        self.motion.turn_ns()
    }

    /// The motor stalls, so that the mechanics stay behind the counter, or follows again from where it is.
    pub(super) fn set_stalled(&mut self, now_ns: i64, stalled: bool) {
        match (self.stalled, stalled) {
            (None, true) => self.stalled = Some(self.mechanical(now_ns).round()),
            (Some(held), false) => {
                self.shift = held - self.state(now_ns).position;
                self.stalled = None;
            }
            _ => {}
        }
    }

    /// Power is gone: it rests, and its counter with the power is 0 again.
    pub(super) fn power_cycle(&mut self, now_ns: i64) {
        let mechanical = self.mechanical(now_ns).round();
        let stalled = self.stalled;
        *self = Self { shift: mechanical, stalled, ..Self::default() };
    }

    /// Does from now on what `leader` does, from where it is.
    pub(super) fn go_along(&mut self, now_ns: i64, leader: &Self) {
        let apart = self.state(now_ns).position - leader.state(now_ns).position;
        self.replace(now_ns, leader.motion.shifted(apart));
        self.ramp = Ramp { target: leader.ramp.target + apart, ..leader.ramp };
        (self.interpolated, self.braking) = (leader.interpolated, leader.braking);
    }

    fn replace(&mut self, now_ns: i64, motion: Motion) {
        self.positive = self.positive(now_ns);
        self.motion = motion;
        (self.interpolated, self.braking) = (false, false);
    }
}
