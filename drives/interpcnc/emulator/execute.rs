//! Execution of Modbus requests by the emulated board.

use super::{
    Board,
    bench::input_bit,
    eeprom::KEPT,
    homing::Homing,
    map::FIRST_RECIPE,
    probe::ProbeCommand,
    rtu::{self, Block, Refusal, Request},
    segments::Segment,
};
use crate::{
    BoardStop, Command, MoveProfile,
    protocol::{
        frame, parameters,
        registers::{AxisMask, COMMAND},
    },
};

impl Board {
    /// Takes one frame and gives the answer, if the board answers.
    pub fn handle(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        let (address, function, data) = frame::open(frame)?;
        let broadcast = address == 0;
        if !self.is_dead() {
            self.frames_seen += 1;
        }
        if self.is_dead() || (address != self.address && !broadcast) {
            return None;
        }
        self.frames_handled += 1;
        if broadcast && !self.assumptions.broadcasts {
            return None;
        }
        let done = Request::decode(function, data).and_then(|request| self.execute(&request, data));
        self.settle();
        let answer = match done {
            Ok(body) => [&[address, function], body.as_slice()].concat(),
            Err(refusal) => vec![address, function | 0x80, refusal.code(&self.assumptions)?],
        };
        (!broadcast).then(|| frame::seal(answer))
    }

    /// The answer that refuses a frame with an exception, if it is one that the board would answer at all.
    pub fn refusal(&self, frame: &[u8], code: u8) -> Option<Vec<u8>> {
        let (address, function, _) = frame::open(frame)?;
        (!self.is_dead() && address == self.address)
            .then(|| frame::seal(vec![address, function | 0x80, code]))
    }

    /// Gives the board a command as a master does, in a frame of its own (function 16).
    ///
    /// # Errors
    /// The exception code with which it is refused.
    pub fn send(&mut self, command: &Command) -> Result<(), u8> {
        let registers = command.registers();
        let count = u8::try_from(registers.len()).map_err(|_beyond| 3_u8)?;
        let [high, low] = COMMAND.to_be_bytes();
        let mut frame = vec![self.address, 16, high, low, 0, count, count.saturating_mul(2)];
        frame.extend(registers.iter().flat_map(|register| register.to_be_bytes()));
        match self.handle(&frame::seal(frame)).as_deref() {
            Some([_, function, code, ..]) if function & 0x80 != 0 => Err(*code),
            _ => Ok(()),
        }
    }

    /// The data of the answer.
    fn execute(&mut self, request: &Request, data: &[u8]) -> Result<Vec<u8>, Refusal> {
        let bits = |block: &Block, of: &dyn Fn(u16) -> Result<bool, Refusal>| {
            Ok(rtu::bits_answer(&block.addresses()?.map(of).collect::<Result<Vec<_>, _>>()?))
        };
        let registers = |block: &Block, of: &dyn Fn(u16) -> Result<u16, Refusal>| {
            Ok(rtu::registers_answer(&block.addresses()?.map(of).collect::<Result<Vec<_>, _>>()?))
        };
        match request {
            Request::ReadCoils(block) => return bits(block, &|address| self.coil(address)),
            Request::ReadInputs(block) => return bits(block, &|address| self.discrete(address)),
            Request::ReadHolding(block) | Request::ReadRegisters(block)
                if block.count > self.assumptions.most_read =>
            {
                return Err(Refusal::Value);
            }
            Request::ReadHolding(block) => {
                return registers(block, &|address| self.holding(address));
            }
            Request::ReadRegisters(block) => {
                return registers(block, &|address| self.input_register(address));
            }
            Request::WriteCoils(start, values) => {
                let places = addressed(*start, values)?;
                if !places.iter().all(|(address, _)| Self::coil_is_writable(*address)) {
                    return Err(Refusal::Address);
                }
                if Self::switches_outputs(&places) {
                    self.check_lock()?;
                }
                for (address, value) in places {
                    self.set_coil(address, value);
                }
            }
            Request::WriteHolding(start, values) => self.write_holding(*start, values)?,
        }
        // Writes are confirmed with address and value or count.
        Ok(data.iter().take(4).copied().collect())
    }

    fn write_holding(&mut self, start: u16, values: &[u16]) -> Result<(), Refusal> {
        if values.len() > usize::from(self.assumptions.most_written) {
            return Err(Refusal::Value);
        }
        let places = addressed(start, values)?;
        places.iter().try_for_each(|(address, value)| self.check_holding(*address, *value))?;
        if Self::sets_outputs(&places) {
            self.check_lock()?;
        }
        let kept = places
            .iter()
            .filter(|(address, _)| KEPT.contains(address) || *address >= FIRST_RECIPE)
            .count();
        for (address, value) in places {
            self.set_holding(address, value);
        }
        if kept > 0 {
            self.begin_store(i64::try_from(kept).unwrap_or(i64::MAX));
            if !self.assumptions.line_at_restart {
                self.take_line_parameters();
            }
            if self.eeprom.broken() && self.assumptions.eeprom_refuses {
                return Err(Refusal::Failure);
            }
        }
        if start == COMMAND {
            if !self.assumptions.arguments_stay {
                self.memory.forget_arguments(values.len());
            }
            self.command()?;
        }
        Ok(())
    }

    /// Whether a locked board refuses, where it says so at all.
    fn check_lock(&self) -> Result<(), Refusal> {
        let refuses = self.locked && self.assumptions.locked_exception.is_some();
        if refuses { Err(Refusal::Locked) } else { Ok(()) }
    }

    /// Carries out the command in the command registers.
    fn command(&mut self) -> Result<(), Refusal> {
        let command = Command::decode(&self.memory.command()).map_err(|_bad| Refusal::Value)?;
        if let Some(sense) = moves(&command) {
            if !sense {
                return Err(Refusal::Value);
            }
            self.check_lock()?;
            return if self.locked { Ok(()) } else { self.motion_command(&command) };
        }
        let now = self.now_ns;
        match command {
            Command::Reset { unlock, homing_error, probe_error } => {
                if unlock {
                    self.unlock();
                }
                if homing_error {
                    self.homings.clear_failure();
                }
                if probe_error {
                    self.probe.clear_failure();
                }
            }
            Command::WritePosition { positions } => {
                for (axis, counter) in self.axes.iter_mut().zip(positions) {
                    if let Some(counter) = counter {
                        axis.write_counter(now, counter);
                    }
                }
            }
            Command::RampStopAxes { axes } => {
                let independent = AxisMask::from_bits(self.axis_bits(|axis| axis.independent(now)));
                self.abandon_homing(axes.intersection(independent));
                self.for_axes(axes.intersection(independent), |axis| axis.ramp_stop(now));
            }
            Command::RampStop => {
                self.buffer.clear();
                self.abandon_homing(AxisMask::ALL);
                self.for_axes(AxisMask::ALL, |axis| axis.ramp_stop(now));
            }
            Command::Stop => self.lock(BoardStop::AtOnce),
            // Motion commands have been dealt with.
            _ => {}
        }
        Ok(())
    }

    /// Whether an axis of a motion command is in a move of the other kind.
    fn is_busy_otherwise(&self, command: &Command) -> bool {
        let now = self.now_ns;
        let others = match command {
            Command::Interpolated { .. } => self.axis_bits(|axis| axis.independent(now)),
            _ => self.axis_bits(|axis| axis.interpolating(now)),
        };
        !command.moved_axes().intersection(AxisMask::from_bits(others)).is_empty()
    }

    /// Carries out a command that moves axes, on an unlocked board.
    fn motion_command(&mut self, command: &Command) -> Result<(), Refusal> {
        let now = self.now_ns;
        if self.is_busy_otherwise(command) {
            let refuses = self.assumptions.busy_axis_refuses;
            return if refuses { Err(Refusal::Failure) } else { Ok(()) };
        }
        if self.ignored_moves > 0 {
            self.ignored_moves -= 1;
            return Ok(());
        }
        match *command {
            Command::Move { axis, profile } => {
                self.abandon_probe(axis);
                self.abandon_homing(axis.mask());
                self.for_axes(axis.mask(), |axis| axis.start(now, &profile));
            }
            Command::ChangeSpeed { axes, speed_hz } => {
                self.for_axes(axes, |axis| axis.change_speed(now, speed_hz));
            }
            Command::Probe {
                axes,
                positive,
                input,
                level,
                max_stroke,
                speed_hz,
                start_stop_hz,
                acceleration_khz_per_s,
                deceleration_khz_per_s,
            } => {
                let axis = axes.axes().next().ok_or(Refusal::Value)?;
                let profile = MoveProfile {
                    start_stop_hz,
                    acceleration_khz_per_s,
                    speed_hz,
                    deceleration_khz_per_s,
                    target: 0,
                };
                let probe = ProbeCommand { axis, positive, input, level, max_stroke, profile };
                self.start_probe(&probe);
            }
            Command::Interpolated { speed_hz, targets } => {
                self.queue_segment(Segment { speed_hz, targets })?;
            }
            Command::HomeMachine { max_strokes } => {
                self.home_machine(&max_strokes);
            }
            Command::HomeAxis {
                axis,
                input,
                contact,
                acceleration_khz_per_s,
                fast_hz,
                deceleration_khz_per_s,
                max_stroke,
                slow_hz,
                final_position,
            } => {
                let start_stop = self.memory.parameter(parameters::HOME_START_STOP);
                let profile = MoveProfile {
                    start_stop_hz: u16::try_from(start_stop).unwrap_or(u16::MAX),
                    acceleration_khz_per_s,
                    speed_hz: fast_hz,
                    deceleration_khz_per_s,
                    target: 0,
                };
                self.start_homing(&Homing {
                    axis,
                    input: if contact <= 1 { input_bit(input.into()) } else { 0 },
                    level: contact == 1,
                    stroke: max_stroke,
                    profile,
                    slow_hz: slow_hz.into(),
                    last: Some(final_position),
                    machine: false,
                });
            }
            _ => {}
        }
        Ok(())
    }
}

/// Whether a command moves axes, and if it does, whether its speeds and rates make sense. Homing without sense fails
/// as homing does.
fn moves(command: &Command) -> Option<bool> {
    match command {
        Command::Move { profile, .. } => Some(
            profile.speed_hz != 0
                && profile.acceleration_khz_per_s != 0
                && profile.deceleration_khz_per_s != 0,
        ),
        Command::Probe { speed_hz, acceleration_khz_per_s, deceleration_khz_per_s, .. } => {
            Some(*speed_hz != 0 && *acceleration_khz_per_s != 0 && *deceleration_khz_per_s != 0)
        }
        Command::ChangeSpeed { speed_hz, .. } | Command::Interpolated { speed_hz, .. } => {
            Some(*speed_hz != 0)
        }
        Command::HomeMachine { .. } | Command::HomeAxis { .. } => Some(true),
        _ => None,
    }
}

/// Values with their addresses, none of which exceeds 65535.
fn addressed<T: Copy>(start: u16, values: &[T]) -> Result<Vec<(u16, T)>, Refusal> {
    let count = u16::try_from(values.len()).map_err(|_beyond| Refusal::Value)?;
    let range = Block { start, count }.addresses()?;
    Ok(range.zip(values.iter().copied()).collect())
}
