//! Homing on a switch.
//!
//! The manual has the parameters and no sequence; this one is assumed: towards the switch at `VelEnterHome`, brake on
//! it with `DecHome`, off it at `VelExitHome`, and where it releases the position is `PosOffset`, or lies that far before
//! position 0 ([`HomePosition`]).

use super::{Device, Input};
use crate::{
    Alarms, HomePosition, RejectCode,
    emulator::motion::Ceilings,
    protocol::parameters::{
        ACCELERATION_HOME, DECELERATION_HOME, POSITION_OFFSET, VELOCITY_ENTER_HOME,
        VELOCITY_EXIT_HOME,
    },
};

/// Where the sequence is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// On the way to the switch.
    Enter,
    /// Braking on it.
    Brake,
    /// On the way off it.
    Leave,
    /// On by the offset.
    Offset,
}

/// Homing under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Homing {
    step: Step,
    until_ns: i64,
}

impl Device {
    pub(super) fn begin_homing_if_possible(&mut self) -> Result<(), RejectCode> {
        let speeds = [VELOCITY_ENTER_HOME, VELOCITY_EXIT_HOME];
        if speeds.iter().any(|index| self.memory.word(*index) == 0) {
            return Err(RejectCode::BadParams);
        }
        self.begin_homing();
        Ok(())
    }

    pub(super) fn begin_homing(&mut self) {
        let until_ns = self.after(self.options.homing.timeout);
        self.homing = Some(Homing { step: Step::Enter, until_ns });
        self.obey_limits();
        if self.pins.is_active(self.options.homing.input) {
            self.begin_step(Step::Brake);
        } else {
            self.begin_step(Step::Enter);
        }
    }

    fn begin_step(&mut self, step: Step) {
        let positive = self.options.homing.positive;
        match step {
            Step::Enter => self.home_run(VELOCITY_ENTER_HOME, positive),
            Step::Brake => {
                let rate = self.memory.word(DECELERATION_HOME);
                self.generator.stop(self.now_ns, &self.home_ceilings(), rate);
            }
            Step::Leave => self.home_run(VELOCITY_EXIT_HOME, !positive),
            Step::Offset => self.go_offset(),
        }
        if let Some(homing) = &mut self.homing {
            homing.step = step;
        }
    }

    /// The position limits count from a zero that is not known yet.
    fn home_ceilings(&self) -> Ceilings {
        Ceilings { positions: (0, 0), ..self.ceilings() }
    }

    fn home_run(&mut self, speed: u16, positive: bool) {
        let speed = i16::try_from(self.memory.word(speed)).unwrap_or(i16::MAX);
        let speed = if positive { speed } else { -speed };
        let rate = self.memory.word(ACCELERATION_HOME);
        self.generator.start(self.now_ns, &self.home_ceilings(), speed, rate);
    }

    /// Looks what homing has come to.
    pub(super) fn home(&mut self) {
        let Some(Homing { step, until_ns }) = self.homing else { return };
        let input: Input = self.options.homing.input;
        let on_switch = self.pins.is_active(input);
        if self.now_ns >= until_ns {
            self.homing = None;
            if self.options.build >= 315 {
                self.raise(Alarms::HOMING);
            } else {
                self.generator.stop(self.now_ns, &self.ceilings(), 0);
            }
        } else if step == Step::Enter && on_switch {
            self.begin_step(Step::Brake);
        } else if step == Step::Brake && !self.generator.is_under_way(self.now_ns) {
            self.begin_step(Step::Leave);
        } else if step == Step::Leave && !on_switch {
            match self.options.assumptions.home_position {
                HomePosition::IsOffset => self.homed_at(self.home_offset()),
                HomePosition::GoesOffset => self.begin_step(Step::Offset),
            }
        } else if step == Step::Offset && !self.generator.is_under_way(self.now_ns) {
            self.homed_at(0);
        }
    }

    fn homed_at(&mut self, position: i32) {
        self.homing = None;
        self.set_position(position);
    }

    fn home_offset(&self) -> i32 {
        i32::try_from(self.memory.value(POSITION_OFFSET)).unwrap_or(0)
    }

    fn go_offset(&mut self) {
        self.set_position(0);
        let (offset, ceilings) = (self.home_offset(), self.home_ceilings());
        let (speed, rate) =
            (self.memory.word(VELOCITY_EXIT_HOME), self.memory.word(ACCELERATION_HOME));
        let gone = self.generator.go_to(self.now_ns, &ceilings, offset, speed, rate);
        // Without position limits there is no reason to refuse.
        debug_assert!(gone.is_ok());
    }
}
