//! Execution of commands by the emulated device.

use super::{Device, Phase, Work, control::Shown, memory::Copies};
use crate::{
    Alarms, Command, Init, Mode, RejectCode, SetEffect, Status, TrajectoryFlags,
    protocol::{
        frame::Answer,
        parameters::{
            ACCELERATION_SETPOINT, ALARM_STATUS, ANALOG_1, ANALOG_2, INPUT_GO, Kind, OUTPUT_LED,
            OUTPUT_RDY, POSITION_ACTUAL, POSITION_SETPOINT, REVERSE_LIMN, SUPPLY, VAR_ENCODER_1,
            VAR_ENCODER_2, VELOCITY_ACTUAL, VELOCITY_ATTENUATION, VELOCITY_SETPOINT, variable_at,
        },
    },
};

/// Data and TAG of an answer.
enum Reply {
    /// Position and state of the trajectory.
    Position,
    /// Position and alarms, if there are any.
    Ping,
    /// Any four bytes; TAG is not defined.
    Data([u8; 4]),
    /// A parameter.
    Words { saved: u16, working: u16, factory: u16 },
}

impl From<Copies> for Reply {
    fn from(Copies { saved, working, factory }: Copies) -> Self {
        Self::Words { saved, working, factory }
    }
}

impl Device {
    pub(super) fn answer(&mut self, command: Result<Command, RejectCode>, address: u8) -> Answer {
        let reply = command.and_then(|command| self.perform(&command));
        let Shown { status, position, tag } = self.stuck.unwrap_or_else(|| self.shown());
        // The answer comes from the address that was asked, even to the SET that changes it.
        let status = Status(status.0 & 0xE0FF | u16::from(address & 0x1F) << 8);
        let position = position.to_le_bytes();
        match reply {
            Err(code) => Answer {
                status: status.with(Status::REJECT, true),
                data: position,
                tag: code.number(),
            },
            Ok(Reply::Ping) if !self.alarms.is_empty() && self.stuck.is_none() => Answer {
                status: status.with(Status::ALARM, true),
                data: position,
                tag: self.alarms.0,
            },
            Ok(Reply::Position | Reply::Ping) => Answer { status, data: position, tag },
            Ok(Reply::Data(data)) => Answer { status, data, tag: 0 },
            Ok(Reply::Words { saved, working, factory }) => {
                let ([a, b], [c, d]) = (saved.to_le_bytes(), working.to_le_bytes());
                Answer { status, data: [a, b, c, d], tag: factory }
            }
        }
    }

    fn perform(&mut self, command: &Command) -> Result<Reply, RejectCode> {
        let always = matches!(command, Command::Ping | Command::Read { .. } | Command::Get { .. });
        if matches!(self.phase, Phase::Changing { .. }) && !always {
            return Err(RejectCode::Working);
        }
        if command.needs_remote() {
            if self.mode != Mode::Remote {
                return Err(RejectCode::BadMode);
            }
            return self.move_as_told(command).map(|()| Reply::Position);
        }
        match *command {
            Command::Ping => return Ok(Reply::Ping),
            Command::IoUpdate(update) => {
                let both = self.options.assumptions.both_bits;
                return Ok(Reply::Data(self.pins.update(update, both)));
            }
            Command::Write { variable, value } => {
                let entry = variable_at(variable).ok_or(RejectCode::NotAvailable)?;
                // "Variables": the domain of all that can be written is 0/FFFFh.
                if !entry.writable || !matches!(value, 0 | 0xFFFF) {
                    return Err(RejectCode::BadParams);
                }
                self.pins.set_output(variable - OUTPUT_RDY, value != 0);
                return Ok(Reply::Data(self.read(variable)?.to_le_bytes()));
            }
            Command::Read { variable } => {
                return Ok(Reply::Data(self.read(variable)?.to_le_bytes()));
            }
            Command::Set { parameter, value } => {
                return self.set_parameter(parameter, value).map(Reply::from);
            }
            Command::Get { parameter } => {
                return self.memory.copies(parameter).map(Reply::from);
            }
            Command::Mode(mode) => {
                self.alarms = Alarms::default();
                self.change_mode(mode.unwrap_or(self.options.configured_mode), Work::None);
            }
            Command::Save => self.change_mode(self.mode, Work::Save),
            Command::Load(source) => self.change_mode(self.mode, Work::Load(source)),
            Command::Reset { bootloader: false } => self.boot(),
            Command::Reset { bootloader: true } => {
                self.power_off(TrajectoryFlags::NONE);
                self.phase = Phase::Dead;
            }
            // Motion commands are above.
            _ => return Err(RejectCode::NotAvailable),
        }
        Ok(Reply::Position)
    }

    /// SET, and what follows from it.
    fn set_parameter(&mut self, parameter: u16, value: u16) -> Result<Copies, RejectCode> {
        let assumed = self.options.assumptions;
        let (copies, is_whole) =
            self.memory.set(parameter, value, assumed.applies_words_at_once)?;
        match assumed.set_effect {
            SetEffect::AtOnce => self.memory.take_effect(),
            SetEffect::RestartsMode if is_whole => self.change_mode(self.mode, Work::None),
            SetEffect::RestartsMode | SetEffect::WithMode => {}
        }
        Ok(copies)
    }

    /// The commands that need the mode remote.
    fn move_as_told(&mut self, command: &Command) -> Result<(), RejectCode> {
        let is_stop = matches!(command, Command::Stop { .. });
        if self.homing.is_some() && !is_stop {
            return Err(RejectCode::Working);
        }
        let (now_ns, ceilings) = (self.now_ns, self.ceilings());
        let allowed = match *command {
            Command::Start { speed, rate } => ceilings.allow(speed.unsigned_abs(), rate),
            Command::Stop { rate } => ceilings.allow(0, rate),
            Command::GoTo { profile, .. } | Command::Step { profile, .. } => {
                profile.is_none_or(|(speed, rate)| ceilings.allow(speed, rate))
            }
            _ => true,
        };
        if !allowed && self.options.assumptions.refuses_beyond_ceilings {
            return Err(RejectCode::BadParams);
        }
        if self.ignored_moves > 0 && !is_stop {
            self.ignored_moves -= 1;
            return Ok(());
        }
        match *command {
            Command::TrajectoryInit(Init::All | Init::Position) => self.set_position(0),
            Command::TrajectoryInit(Init::Homing) => return self.begin_homing_if_possible(),
            Command::TrajectoryInit(_) if self.options.build < 310 => {
                return Err(RejectCode::BadParams);
            }
            Command::TrajectoryInit(init) => {
                let [first, second] = &mut self.encoder_zeros;
                let here = self.origin + self.generator.state(now_ns).position;
                if init != Init::Encoder2 {
                    *first = here;
                }
                if init != Init::Encoder1 {
                    *second = here;
                }
            }
            Command::Start { speed, rate } => self.generator.start(now_ns, &ceilings, speed, rate),
            Command::Stop { rate } => {
                if self.homing.take().is_some() {
                    self.obey_limits();
                }
                self.generator.stop(now_ns, &ceilings, rate);
            }
            Command::GoTo { target, profile } => {
                let (speed, rate) = profile.unwrap_or((0, 0));
                return self.generator.go_to(now_ns, &ceilings, target, speed, rate);
            }
            Command::Step { distance, profile } => {
                let (speed, rate) = profile.unwrap_or((0, 0));
                return self.generator.step(now_ns, &ceilings, distance, speed, rate);
            }
            _ => return Err(RejectCode::NotAvailable),
        }
        Ok(())
    }

    /// A variable, its sign extended to 32 bits or not.
    fn read(&self, variable: u16) -> Result<i32, RejectCode> {
        let value = self.value(variable)?;
        let is_short = variable_at(variable).is_some_and(|entry| entry.kind == Kind::Signed);
        let extends = self.options.assumptions.extends_signs;
        Ok(if is_short && !extends { value & 0xFFFF } else { value })
    }

    fn value(&self, variable: u16) -> Result<i32, RejectCode> {
        let flag = |on: bool| if on { 0xFFFF } else { 0 };
        let turn = self.ceilings().turn;
        let state = self.generator.state(self.now_ns);
        let (up, down) = self.generator.rates();
        let assumed = self.options.assumptions.acc_current;
        Ok(match variable {
            ANALOG_1 => i32::from(self.analog[0]),
            ANALOG_2 => i32::from(self.analog[1]),
            VAR_ENCODER_1 => self.encoder(0),
            VAR_ENCODER_2 => self.encoder(1),
            SUPPLY => i32::from(self.supply_v),
            ALARM_STATUS => i32::from(self.alarms.0),
            POSITION_SETPOINT | POSITION_ACTUAL => self.counter(),
            VELOCITY_SETPOINT | VELOCITY_ACTUAL => whole(turn.rpm(state.velocity)),
            // The scale that the device applies to its speeds: none.
            VELOCITY_ATTENUATION => 32_767,
            ACCELERATION_SETPOINT => whole(turn.rpm(up)),
            _ if assumed.deceleration_index() == Some(variable) => whole(turn.rpm(down)),
            _ if assumed.index() == variable => {
                let soon = self.generator.state(self.now_ns + 1000);
                whole(turn.rpm((soon.velocity - state.velocity) * 1e6))
            }
            OUTPUT_RDY..=OUTPUT_LED => flag(self.pins.output(variable - OUTPUT_RDY)),
            INPUT_GO..=REVERSE_LIMN => flag(self.pins.variable(variable - INPUT_GO)),
            _ => return Err(RejectCode::NotAvailable),
        })
    }
}

/// A number of 16 bits with sign, to the nearest.
#[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
fn whole(value: f64) -> i32 {
    i32::from(value.round() as i16)
}
