//! Cycle of an axis: reading the drive, supervision, and the command at its end.

use super::drive::{Command, Feedback};
use super::state::AxisState;
use super::{Axis, SmcError};
use twin_profile::{Profile, RampType, State};

impl Axis {
    /// Reads the drive's feedback (the drive interface before the program).
    ///
    /// Without power, or with the brake on, the set position follows the actual one. An error of the drive brings
    /// the axis into errorstop.
    pub fn begin_cycle(&mut self, feedback: &Feedback) {
        self.take_in(feedback);
        self.pass_time();
        self.save();
        if !feedback.communicating && self.drive_known {
            self.fail_with(SmcError::DiGeneralCommunicationError.number());
        } else if let Some(error) = feedback.error {
            self.fail_with(error);
        }
        self.drive_known |= feedback.communicating;
        let powered = self.is_powered();
        match self.state {
            AxisState::PowerOff if powered => self.enter(AxisState::Standstill),
            AxisState::ErrorStop => {}
            _ if !powered => self.lose_power(),
            _ => {}
        }
        if !powered {
            self.follow_drive();
        }
    }

    /// Supervises the cycle and gives the drive its set-point (the drive interface after the program).
    ///
    /// If the owner was not called, or the set position leaves the software limits, the axis goes into errorstop and brakes
    /// with `fSWMaxDeceleration`.
    pub fn end_cycle(&mut self) -> Command {
        if self.is_deserted() {
            self.fail_with(SmcError::FbWasntCalledDuringMotion.number());
        }
        self.brake();
        self.show_set_values();
        self.watch_software_limits();
        self.drive_command()
    }

    fn pass_time(&mut self) {
        let exact = self.values.task_cycle * 1e9 + self.clock_rest;
        let whole = exact.round();
        if whole.is_finite() {
            #[expect(clippy::cast_possible_truncation, reason = "whole, and saturates")]
            let cycle_ns = whole as i64;
            self.clock_ns = self.clock_ns.saturating_add(cycle_ns);
            self.clock_rest = exact - whole;
        }
    }

    fn take_in(&mut self, feedback: &Feedback) {
        let cycle = self.values.task_cycle;
        let acceleration = if cycle > 0.0 && self.drive_known {
            (feedback.velocity - self.drive.velocity) / cycle
        } else {
            0.0
        };
        let position = self.in_program(feedback.position);
        let values = &mut self.values;
        values.act_position = position;
        values.act_velocity = feedback.velocity;
        values.act_acceleration = acceleration;
        values.regulator_real_state = feedback.regulator_on;
        values.drive_start_real_state = feedback.brake_released;
        values.communication = feedback.communicating;
        self.drive = *feedback;
    }

    fn save(&mut self) {
        let mut counts_anew = false;
        if self.home.is_some() {
            // While the drive homes itself, a block or an error goes on from the drive's position.
            let Feedback { position, velocity, .. } = self.drive;
            let before = self.total();
            let way = f64::midpoint(before.velocity, velocity) * self.values.task_cycle;
            // Beyond its velocity the change is the new reference.
            self.zero += position - before.position - way;
            self.base = State { position, velocity, acceleration: 0.0 };
            self.overlay = State::default();
            counts_anew = true;
        }
        self.saved = self.total();
        self.saved_base = self.base;
        self.overlay_moved = false;
        let values = &mut self.values;
        values.moved_in_this_cycle = false;
        values.save_position = values.set_position;
        values.save_velocity = values.set_velocity;
        if counts_anew {
            // Position and zero change together.
            self.show_set_values();
            self.values.save_position = self.values.set_position;
        }
    }

    /// Computes the set values from base and overlay.
    pub(super) fn show_set_values(&mut self) {
        let total = self.total();
        let position = self.in_program(total.position);
        let values = &mut self.values;
        values.set_position = position;
        values.set_velocity = total.velocity;
        values.set_acceleration = total.acceleration;
        if total.velocity != 0.0 {
            self.went = if total.velocity < 0.0 { -1 } else { 1 };
        }
    }

    /// Power on and brake released.
    pub(super) fn is_powered(&self) -> bool {
        self.values.regulator_real_state && self.values.drive_start_real_state
    }

    pub(super) fn enter(&mut self, state: AxisState) {
        #[cfg(test)]
        self.entered.push([self.state, state]);
        self.state = state;
    }

    fn lose_power(&mut self) {
        self.desert();
        self.enter(AxisState::PowerOff);
    }

    /// Takes the axis from whoever moves it.
    fn desert(&mut self) {
        self.values.owner = 0;
        self.overlay_owner = 0;
        self.stop_homing();
        self.aim = None;
    }

    /// Puts the set-point at the axis's position.
    pub(super) fn follow_drive(&mut self) {
        self.base = State::resting(self.drive.position);
        self.overlay = State::default();
        self.braking = None;
        self.saved = self.base;
        self.saved_base = self.base;
        self.show_set_values();
    }

    /// Into errorstop, with the number of an error; the first one stays.
    pub(crate) fn fail_with(&mut self, number: u16) {
        self.values.error = true;
        if self.state == AxisState::ErrorStop {
            return;
        }
        self.values.error_id = number.into();
        self.desert();
        self.enter(AxisState::ErrorStop);
    }

    /// True if a block that was to move the axis has not.
    fn is_deserted(&self) -> bool {
        let held = self.state == AxisState::Stopping && self.base.velocity == 0.0;
        let owner = self.values.owner != 0 && !self.values.moved_in_this_cycle && !held;
        owner || (self.overlay_owner != 0 && !self.overlay_moved)
    }

    /// In errorstop the axis brakes itself.
    fn brake(&mut self) {
        if self.state != AxisState::ErrorStop || !self.is_powered() {
            self.braking = None;
            return;
        }
        let cycle = self.values.task_cycle;
        let (profile, elapsed) = if let Some((profile, elapsed)) = self.braking {
            (Some(profile), elapsed)
        } else {
            let limits = self.implicit_limits();
            let velocity = limits.velocity.max(self.saved.velocity.abs());
            let limits = twin_profile::AxisLimits { velocity, ..limits };
            // Without a valid jerk it brakes without one.
            let profile = Profile::halt(self.saved, limits, self.ramp)
                .or_else(|_invalid| Profile::halt(self.saved, limits, RampType::Trapezoid));
            (profile.ok(), 0.0)
        };
        self.overlay = State::default();
        let elapsed = elapsed + cycle;
        // Without a valid deceleration it stops at once.
        self.base = profile.map_or(State::resting(self.saved.position), |it| it.at(elapsed));
        self.braking = profile.map(|profile| (profile, elapsed));
    }

    fn watch_software_limits(&mut self) {
        let total = self.total();
        let position = self.in_program(total.position);
        let values = &self.values;
        let watched = values.sw_limit_enable && self.movement == super::Movement::Linear;
        let above = watched && position > values.sw_limit_positive;
        let below = watched && position < values.sw_limit_negative;
        // The way back inside is free.
        let outward = (above && total.velocity > 0.0) || (below && total.velocity < 0.0);
        if outward && self.is_powered() {
            self.fail_with(SmcError::DiSwlimitsExceeded.number());
        }
    }

    fn drive_command(&self) -> Command {
        let total = self.total();
        Command {
            position: self.wrapped(total.position),
            velocity: total.velocity,
            acceleration: total.acceleration,
            regulator_on: self.values.regulator_on,
            release_brake: self.values.drive_start,
            capture: self.capture,
            home: self.home,
            reset: self.values.error_acknowledged,
        }
    }
}
