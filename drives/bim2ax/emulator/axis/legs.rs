//! The legs that moves are made of.

use super::{Axis, Homing, Programmed, Task};
use crate::{
    CamStart,
    protocol::bits::{coefficient, message},
};
use twin_drives::ramp::{Motion, Ramp};

/// Farther than any counter of 32 bits gets, µsteps.
const BEYOND: i64 = 1 << 33;

impl Axis {
    /// Starts a leg to `target` from rest.
    fn leg(&mut self, target: i64, ramp: &Ramp) {
        let from = self.count(self.now_ns);
        self.sense = if target < from { -1 } else { 1 };
        self.motion = Motion::plan(self.now_ns, self.motion.at(self.now_ns), ramp);
    }

    /// Runs at the start-stop speed in the sense of `sense`, on and on.
    pub(super) fn run(&mut self, sense: i64) {
        self.run_to(sense * BEYOND, sense);
    }

    fn run_to(&mut self, target: i64, sense: i64) {
        #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
        let ramp = self.settings.ramp(self.settings.start_stop(), target as f64);
        self.stand();
        self.leg(target, &ramp);
        self.sense = sense;
    }

    /// A phase of homing over a distance at the start-stop speed, which needs no ramp.
    pub(super) fn run_by(&mut self, phase: Homing, sense: i64, distance: i64) {
        self.task = Task::Homing(phase);
        self.run_to(self.count(self.now_ns) + sense * distance, sense);
    }

    /// Sense of homing, ±1.
    pub(super) fn home_sense(&self) -> i64 {
        if self.settings.has(coefficient::HOME_PLUS) { 1 } else { -1 }
    }

    /// Homing towards its edge.
    pub(super) fn seek(&mut self) {
        self.task = Task::Homing(Homing::Seeking);
        self.run(self.home_sense());
    }

    /// Starts homing.
    pub(super) fn home(&mut self) {
        self.latch(message::HOMED, false);
        let on_cam = !self.encoder.homes_on_index() && self.on_cam();
        if on_cam && !self.settings.has(coefficient::STAY_ON_CAM) {
            self.task = Task::Homing(Homing::Leaving);
            self.run(-self.home_sense());
        } else if on_cam && self.assumptions.cam_start == CamStart::FarEdge {
            self.task = Task::Homing(Homing::Crossing);
            self.run(self.home_sense());
        } else {
            // On a cam that is not cleared the edge counts as taken: it is "reached" at once.
            self.seek();
        }
    }

    /// True if a move to `target` has to come from beyond it.
    pub(super) fn approaches(&self, target: i32) -> bool {
        let from = self.count(self.now_ns);
        let plus = self.settings.has(coefficient::APPROACH_PLUS);
        self.settings.has(coefficient::APPROACH)
            && self.settings.approach > 0
            && i64::from(target) != from
            && (i64::from(target) < from) == plus
    }

    /// Starts a leg of a programmed move.
    pub(super) fn go(&mut self, programmed: Programmed) {
        self.task = Task::Programmed(programmed);
        let target = self.leg_target(&programmed);
        #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
        let ramp = self.settings.ramp(self.settings.speed(programmed.speed), target as f64);
        self.leg(target, &ramp);
    }

    /// Where the programmed move under way ends, or where the counter is.
    pub(crate) fn target(&self) -> i32 {
        match self.task {
            Task::Programmed(programmed) if !self.braking => programmed.target,
            _ => self.counter(),
        }
    }

    /// Where the leg under way of a programmed move ends.
    pub(super) fn leg_target(&self, programmed: &Programmed) -> i64 {
        let beyond = i64::from(self.settings.approach);
        let target = i64::from(programmed.target);
        if !programmed.overshooting {
            target
        } else if self.settings.has(coefficient::APPROACH_PLUS) {
            target - beyond
        } else {
            target + beyond
        }
    }
}
