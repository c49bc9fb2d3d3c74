//! The board without hardware: its own Modbus slave, byte for byte, and its motion.
//!
//! [`Board`] is pure and deterministic: it is told how much time passes and which frames arrive. [`EmulatedBoard`]
//! serves one in real time on a pseudo-terminal.
//!
//! What the emulator does: functions 1 to 6, 15 and 16 on the whole address map; commands 40, 41, 42, 43, 66, 67, 80
//! and 96; lock, ENABLE and unlock input; outputs, inputs, user bits and registers, parameters, recipes. What it
//! does not do: commands 6, 71 and 78 (answered with exception 3, as an unknown number is), limit switches,
//! analog inputs, encoder and counters (read 0), axis coupling, failures of the EEPROM.
//!
//! Where the manual is silent the emulator assumes: arguments absent from a command keep their last value; locked,
//! motion commands and output writes are answered normally and do nothing; losing ENABLE stops without ramp and
//! without keeping the target; speeds above 200 kHz are clamped; a zero speed, acceleration or deceleration is a
//! wrong value (exception 3).

mod map;
mod motion;
mod probe;
mod rtu;
mod serve;
#[cfg(test)]
mod tests;
mod thread;

use map::Memory;
pub(super) use motion::Axis;
use probe::{Probe, ProbeCommand};
#[cfg(test)]
pub(super) use rtu::seal;
use rtu::{Block, Refusal, Request};
pub use serve::{Control, Wire, serve};
pub use thread::{EmulatedBoard, EmulatorOptions};

use super::{
    Command, Line, MoveProfile, Parity,
    registers::{AXES, AxisMask, BoardAxis, COMMAND, Status},
};

/// Losing ENABLE counts after this long (firmware 5.27: "Filtrage entrée ENABLE (100ms sur toutes les cartes)").
const ENABLE_FILTER_NS: i64 = 100_000_000;
/// Parameter 88, `EE_INPUT_UNLOCK`: input that unlocks; 0 and polarity 1: unlocked as soon as ENABLE is there.
const UNLOCK_INPUT: u16 = 88;
/// Parameter 89, `EE_INPUT_UNLOCK_POLARITY`: 0 = NO, 1 = NC.
const UNLOCK_POLARITY: u16 = 89;
/// Parameters of the serial line; encodings are not documented: baud as a number, parity 0, 1, 2.
const MODBUS_SPEED: u16 = 101;
const MODBUS_PARITY: u16 = 102;
const MODBUS_ADDRESS: u16 = 103;

/// A board at power-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardOptions {
    /// Station address.
    pub station: u8,
    /// Serial line; the board shows it in its parameters.
    pub line: Line,
    /// Whether 24 V are on the ENABLE input.
    pub enable: bool,
}

impl Default for BoardOptions {
    /// Station 1, 115200 baud, no parity (the manual gives no defaults), ENABLE active.
    fn default() -> Self {
        Self { station: 1, line: Line::default(), enable: true }
    }
}

/// The board: registers, lock and axes at one instant.
#[derive(Clone, Debug)]
pub struct Board {
    station: u8,
    now_ns: i64,
    axes: [Axis; AXES],
    memory: Memory,
    probe: Probe,
    locked: bool,
    /// The ENABLE input behind its filter.
    enabled: bool,
    /// Since when the ENABLE input is open, if the filter has not yet passed it on.
    open_since_ns: Option<i64>,
    frames_handled: u64,
}

impl Board {
    /// A board just powered up: locked, all counters 0.
    pub fn new(options: &BoardOptions) -> Self {
        let mut memory = Memory::new();
        memory.set_parameter(MODBUS_SPEED, options.line.baud);
        let parity = match options.line.parity {
            Parity::None => 0,
            Parity::Even => 1,
            Parity::Odd => 2,
        };
        memory.set_parameter(MODBUS_PARITY, parity);
        memory.set_parameter(MODBUS_ADDRESS, options.station.into());
        Self {
            station: options.station,
            now_ns: 0,
            axes: [Axis::default(); AXES],
            memory,
            probe: Probe::default(),
            locked: true,
            enabled: options.enable,
            open_since_ns: None,
            frames_handled: 0,
        }
    }

    /// Lets time pass.
    pub fn advance(&mut self, ns: i64) {
        let then = self.now_ns.saturating_add(ns.max(0));
        if let Some(since) = self.open_since_ns
            && then - since >= ENABLE_FILTER_NS
        {
            self.now_ns = since + ENABLE_FILTER_NS;
            self.open_since_ns = None;
            self.enabled = false;
            self.lock();
        }
        self.now_ns = then;
        self.end_probe();
    }

    /// Time since power-up, ns.
    pub fn now_ns(&self) -> i64 {
        self.now_ns
    }

    /// Opens or closes the ENABLE input.
    pub fn set_enable(&mut self, closed: bool) {
        if !closed {
            let present = self.enabled && self.open_since_ns.is_none();
            if present {
                self.open_since_ns = Some(self.now_ns);
            }
            return;
        }
        self.open_since_ns = None;
        if !self.enabled {
            self.enabled = true;
            let automatic = self.memory.parameter(UNLOCK_INPUT) == 0
                && self.memory.parameter(UNLOCK_POLARITY) == 1;
            if automatic {
                self.unlock();
            }
        }
    }

    /// Sets input `number` (IN1 to IN32).
    pub fn set_input(&mut self, number: u8, level: bool) {
        if !(1..=32).contains(&number) {
            return;
        }
        let mask = 1 << (number - 1);
        self.memory.inputs =
            if level { self.memory.inputs | mask } else { self.memory.inputs & !mask };
        let normally_closed = self.memory.parameter(UNLOCK_POLARITY) == 1;
        if self.memory.parameter(UNLOCK_INPUT) == u32::from(number) && level != normally_closed {
            self.unlock();
        }
        self.probe_input();
    }

    /// Outputs, bit 0 = OUT1.
    pub fn outputs(&self) -> u32 {
        self.memory.outputs
    }

    /// The status register.
    pub fn status(&self) -> Status {
        let moving = self.axis_bits(|axis| axis.moving(self.now_ns)) << Status::ASYNC_MOVING_SHIFT;
        let emergency = if self.enabled { 0 } else { Status::EMERGENCY_STOP };
        let locked = if self.locked { Status::BOARD_LOCKED } else { 0 };
        let probing = if self.probe.in_progress() { Status::PROBE_IN_PROGRESS } else { 0 };
        let failed = if self.probe.failed() { Status::PROBE_ERROR } else { 0 };
        Status(Status::BUFFER_EMPTY | moving | emergency | locked | probing | failed)
    }

    /// Speed of an axis, steps/s.
    pub fn velocity(&self, axis: BoardAxis) -> f64 {
        self.axes.get(axis.index()).map_or(0.0, |axis| axis.velocity(self.now_ns))
    }

    /// Position of an axis between its steps, steps.
    pub fn position(&self, axis: BoardAxis) -> f64 {
        self.axes.get(axis.index()).map_or(0.0, |axis| axis.state(self.now_ns).position)
    }

    /// Frames that were whole, error-free and for this station; LED D1 changes with each.
    pub fn frames_handled(&self) -> u64 {
        self.frames_handled
    }

    /// Takes one frame and gives the answer, if the board answers.
    pub fn handle(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        let (station, function, data) = rtu::open(frame)?;
        let broadcast = station == 0;
        if station != self.station && !broadcast {
            return None;
        }
        self.frames_handled += 1;
        let answer = match Request::decode(function, data)
            .and_then(|request| self.execute(&request, data))
        {
            Ok(body) => [&[station, function], body.as_slice()].concat(),
            Err(refusal) => vec![station, function | 0x80, refusal.code()?],
        };
        (!broadcast).then(|| rtu::seal(answer))
    }

    /// Gives the board a command as a master does, in a frame of its own (function 16).
    ///
    /// # Errors
    /// The exception code with which it is refused.
    pub fn send(&mut self, command: &Command) -> Result<(), u8> {
        let registers = command.registers();
        let count = u8::try_from(registers.len()).map_err(|_beyond| 3_u8)?;
        let [high, low] = COMMAND.to_be_bytes();
        let mut frame = vec![self.station, 16, high, low, 0, count, count.saturating_mul(2)];
        frame.extend(registers.iter().flat_map(|register| register.to_be_bytes()));
        match self.handle(&rtu::seal(frame)).as_deref() {
            Some([_, function, code, ..]) if function & 0x80 != 0 => Err(*code),
            _ => Ok(()),
        }
    }

    /// The counter at the edge of the input that ended the last probing move, registers 1044 and 1045.
    pub fn probe_position(&self) -> i32 {
        self.probe.position()
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
                for (address, value) in places {
                    self.set_coil(address, value);
                }
            }
            Request::WriteHolding(start, values) => {
                let places = addressed(*start, values)?;
                places
                    .iter()
                    .try_for_each(|(address, value)| self.check_holding(*address, *value))?;
                for (address, value) in places {
                    self.set_holding(address, value);
                }
                if *start == COMMAND {
                    self.command()?;
                }
            }
        }
        // Writes are confirmed with address and value or count.
        Ok(data.iter().take(4).copied().collect())
    }

    /// Carries out the command in the command registers.
    fn command(&mut self) -> Result<(), Refusal> {
        let command = Command::decode(&self.memory.command()).map_err(|_bad| Refusal::Value)?;
        let now = self.now_ns;
        match command {
            Command::Reset { unlock, probe_error, .. } => {
                if unlock {
                    self.unlock();
                }
                if probe_error {
                    self.probe.clear_failure();
                }
            }
            Command::Move { axis, profile } => {
                if profile.speed_hz == 0
                    || profile.acceleration_khz_per_s == 0
                    || profile.deceleration_khz_per_s == 0
                {
                    return Err(Refusal::Value);
                }
                if !self.locked {
                    self.abandon_probe(axis);
                    self.for_axes(axis.mask(), |axis| axis.start(now, &profile));
                }
            }
            Command::ChangeSpeed { axes, speed_hz } => {
                if speed_hz == 0 {
                    return Err(Refusal::Value);
                }
                if !self.locked {
                    self.for_axes(axes, |axis| axis.change_speed(now, speed_hz));
                }
            }
            Command::WritePosition { positions } => {
                for (axis, counter) in self.axes.iter_mut().zip(positions) {
                    if let Some(counter) = counter {
                        axis.write_counter(now, counter);
                    }
                }
            }
            Command::RampStopAxes { axes } => self.for_axes(axes, |axis| axis.ramp_stop(now)),
            Command::RampStop => self.for_axes(AxisMask::ALL, |axis| axis.ramp_stop(now)),
            Command::Stop => self.lock(),
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
                let rates = [acceleration_khz_per_s, deceleration_khz_per_s];
                let axis = axes.axes().next().ok_or(Refusal::Value)?;
                if speed_hz == 0 || rates.contains(&0) {
                    return Err(Refusal::Value);
                }
                let profile = MoveProfile {
                    start_stop_hz,
                    acceleration_khz_per_s,
                    speed_hz,
                    deceleration_khz_per_s,
                    target: 0,
                };
                if !self.locked {
                    let command =
                        ProbeCommand { axis, positive, input, level, max_stroke, profile };
                    self.start_probe(&command);
                }
            }
            Command::Interpolated { .. }
            | Command::HomeMachine { .. }
            | Command::HomeAxis { .. } => return Err(Refusal::Value),
        }
        Ok(())
    }

    fn for_axes(&mut self, mask: AxisMask, mut act: impl FnMut(&mut Axis)) {
        for (name, axis) in BoardAxis::ALL.into_iter().zip(&mut self.axes) {
            if mask.contains(name) {
                act(axis);
            }
        }
    }

    /// Stops every axis without ramp and locks.
    fn lock(&mut self) {
        let now = self.now_ns;
        self.for_axes(AxisMask::ALL, |axis| axis.stop(now));
        self.locked = true;
        self.memory.reset_analog_outputs();
        self.end_probe();
    }

    /// Unlocks if ENABLE is active.
    fn unlock(&mut self) {
        if self.enabled {
            self.locked = false;
        }
    }
}

/// Values with their addresses, none of which exceeds 65535.
fn addressed<T: Copy>(start: u16, values: &[T]) -> Result<Vec<(u16, T)>, Refusal> {
    let count = u16::try_from(values.len()).map_err(|_beyond| Refusal::Value)?;
    let range = Block { start, count }.addresses()?;
    Ok(range.zip(values.iter().copied()).collect())
}
