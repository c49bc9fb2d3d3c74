//! Events at served devices other than on the wire, and their handling.

use super::{Cam, Device, HomingOptions, Input, Phase};
use crate::{Alarms, BadFrame, Status, TrajectoryFlags, protocol::frame};

/// Events at devices on a line, and faults of the line.
pub type Control = twin_drives::Control<Happening>;

/// Event at a device other than on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// An input changes.
    Input {
        /// The input.
        input: Input,
        /// Its level.
        level: bool,
    },
    /// Analog input 1 or 2 changes.
    Analog {
        /// 1 or 2.
        number: u8,
        /// 0 to 32767.
        value: u16,
    },
    /// The supply changes, V.
    Supply(u16),
    /// The supply fails and is back after this time, ns: the device starts anew.
    BrownOut {
        /// Without supply for so long, ns.
        off_ns: i64,
    },
    /// The cause of alarms comes or goes.
    Fault {
        /// The alarms.
        alarms: Alarms,
        /// Comes or goes.
        present: bool,
    },
    /// The rotor is blocked for a moment.
    Stall,
    /// A bit of which the manual only says that it is there comes (true) or goes.
    Condition(Condition, bool),
    /// Status, position and flags are shown as they are now for good (true), or as they are.
    StuckStatus(bool),
    /// The next moves, of this number, are confirmed and not carried out.
    IgnoreMoves(u32),
    /// One more switch that the mechanics operate.
    Cam {
        /// Input it is wired to.
        input: Input,
        /// It is active from here, µsteps from where the axis stood when the emulator was started.
        from: i32,
        /// To here.
        to: i32,
    },
    /// All switches that the mechanics operate at an input are gone: it is off.
    NoCams(Input),
    /// Homing works otherwise from now on.
    Homing(HomingOptions),
}

/// Condition whose cause the manual does not say: two bits "for internal use", and a trigger for which
/// there is no command. A new motion command clears the last, a restart all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// `STA_SIGNALLED`, of the sequencer.
    Signalled,
    /// `STA_BUSY`, whether the device is available.
    Busy,
    /// `TRJ_TRIGGERED`, the trigger has fired.
    Triggered,
}

/// An event and the device it happens to, counted from 0 in the order of the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Happening {
    /// Place on the bus, from 0.
    pub device: usize,
    /// The event.
    pub event: Event,
}

impl Event {
    /// This, to the device at a place on the bus, from 0.
    pub fn to(self, device: usize) -> Control {
        Control::Event(Happening { device, event: self })
    }
}

/// What a device shows of itself in the answers that tell where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shown {
    pub(super) status: Status,
    pub(super) position: i32,
    pub(super) tag: u16,
}

impl Device {
    /// Lets something happen.
    pub fn happen(&mut self, event: Event) {
        match event {
            Event::Input { input, level } => self.set_input(input, level),
            Event::Analog { number, value } => self.set_analog(number, value),
            Event::Supply(volts) => self.set_supply(volts),
            Event::BrownOut { off_ns } => self.brown_out(off_ns),
            Event::Fault { alarms, present } => self.set_fault(alarms, present),
            Event::Stall => self.stall(),
            Event::Condition(condition, on) => self.set_condition(condition, on),
            Event::StuckStatus(stuck) => self.set_stuck_status(stuck),
            Event::IgnoreMoves(moves) => self.ignored_moves = moves,
            Event::Cam { input, from, to } => {
                self.options.cams.push(Cam { input, from: from.into(), to: to.into() });
                self.operate_cams();
            }
            Event::NoCams(input) => {
                self.options.cams.retain(|cam| cam.input != input);
                self.set_input(input, false);
            }
            Event::Homing(homing) => self.options.homing = homing,
        }
    }

    /// The supply fails and is back after so long, ns: the motor rests, and what is not in the flash memory is lost.
    pub fn brown_out(&mut self, off_ns: i64) {
        self.power_off(TrajectoryFlags::NONE);
        let until_ns = self.after(self.options.boot).saturating_add(off_ns.max(0));
        self.phase = Phase::Booting { until_ns };
    }

    /// Brings a condition about, or ends it.
    pub fn set_condition(&mut self, condition: Condition, on: bool) {
        let bit = match condition {
            Condition::Signalled => Status::SIGNALLED,
            Condition::Busy => Status::BUSY,
            Condition::Triggered => return self.generator.set_triggered(on),
        };
        self.conditions = if on { self.conditions | bit } else { self.conditions & !bit };
    }

    /// Status, position and flags are shown as they are now, whatever happens, or as they are.
    pub fn set_stuck_status(&mut self, stuck: bool) {
        self.stuck = stuck.then(|| self.shown());
    }

    /// What the device shows of itself now.
    pub(super) fn shown(&self) -> Shown {
        let (status, position) = (self.status(), self.counter());
        Shown { status, position, tag: self.trajectory_tag() }
    }

    /// The answer that refuses a command with a code, if it is one that this device would answer.
    pub fn refusal(&self, command: &[u8], code: u16) -> Option<Vec<u8>> {
        let (address, _) = frame::decode(command)?;
        (self.is_alive() && address == self.address()).then(|| self.rejection(command, code))
    }

    /// Whether it hears anything at all.
    pub(super) fn is_alive(&self) -> bool {
        match self.phase {
            Phase::Running => true,
            Phase::Changing { .. } => !self.options.assumptions.silent_while_changing,
            Phase::Booting { .. } | Phase::Dead => false,
        }
    }

    fn rejection(&self, command: &[u8], code: u16) -> Vec<u8> {
        let status = self.status().with(Status::REJECT, true);
        let data = self.counter().to_le_bytes();
        self.sealed(command, frame::Answer { status, data, tag: code })
    }

    /// An answer to a command as bytes.
    pub(super) fn sealed(&self, command: &[u8], answer: frame::Answer) -> Vec<u8> {
        let assumed = self.options.assumptions.answer_length;
        answer.encode_in(frame::answer_length(command, assumed))
    }

    /// Its answer to a frame whose check sum or length is wrong, if the frame seems to be for this device.
    pub(super) fn bad_frame(&self, frame: &[u8]) -> Option<Vec<u8>> {
        match self.options.assumptions.bad_frame {
            BadFrame::Refused(code)
                if self.is_alive() && frame.first() == Some(&self.address()) =>
            {
                Some(self.rejection(frame, code.number()))
            }
            BadFrame::Refused(_) | BadFrame::Silent => None,
        }
    }
}
