//! The board without hardware: its own Modbus slave, byte for byte, and its motion.
//!
//! [`Board`] is pure and deterministic: time and frames come from the caller, and its axes press
//! the switches of a [`Bench`] as they move. [`EmulatedBoard`] serves one in real time on a
//! pseudo-terminal.
//!
//! The emulator does functions 1 to 6, 15 and 16 on the whole address map and all commands of the manual. Nothing on
//! Modbus brings about speed override, waiting for inputs, torch height control and what a Basic program does: their
//! bits are the bench's ([`Condition`]).
//!
//! Where the manual is silent the board behaves by its [`Assumptions`]. Beyond those: a zero speed, acceleration or
//! deceleration is a wrong value (exception 3), speeds above 200 kHz are clamped, command 80 on an axis of an
//! interpolated move that is being carried out is refused as command 6 on one in an independent move is, counters and
//! everything else in RAM are 0 after power-up, and parameters count as soon as they are written.

mod bench;
mod control;
mod eeprom;
mod execute;
mod homing;
mod limits;
mod lock;
mod map;
mod motion;
mod power;
mod probe;
mod rtu;
mod segments;
mod serve;
#[cfg(test)]
mod tests;
mod time;

use bench::Surroundings;
pub use bench::{Bench, Cam, Condition, EncoderLink};
pub use control::{Control, Event};
pub use eeprom::BadImage;
use eeprom::Eeprom;
use homing::Homings;
use map::Memory;
pub(super) use motion::Axis;
use probe::Probe;
use segments::Buffer;
pub(super) use segments::segment_ramps;
pub use serve::{EmulatedBoard, EmulatorOptions, ServedBoard, Wire, serve};

use super::{Assumptions, Line};
use crate::protocol::registers::{AXES, AxisMask, BoardAxis, Status};

/// A board at power-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardOptions {
    /// Station address; a board with an EEPROM of its own takes that from there.
    pub address: u8,
    /// Serial line; the board shows it in its parameters. A board with an EEPROM of its own takes that from there.
    pub line: Line,
    /// Whether 24 V are on the ENABLE input.
    pub enable: bool,
    /// Whether it has an encoder and counters, as boards from V2.1D on: otherwise their registers are outside its map.
    pub counts: bool,
    /// Assumptions where the manual is silent.
    pub assumptions: Assumptions,
}

impl Default for BoardOptions {
    /// Station 1, 115200 baud, no parity (the manual gives no defaults), ENABLE active, a board with encoder and counters.
    fn default() -> Self {
        let assumptions = Assumptions::default();
        Self { address: 1, line: Line::default(), enable: true, counts: true, assumptions }
    }
}

/// The board: registers, lock and axes at one instant.
#[derive(Clone, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "independent facts, each so or not")]
pub struct Board {
    address: u8,
    line: Line,
    assumptions: Assumptions,
    now_ns: i64,
    axes: [Axis; AXES],
    memory: Memory,
    eeprom: Eeprom,
    surroundings: Surroundings,
    probe: Probe,
    homings: Homings,
    buffer: Buffer,
    /// Bits of status and extended status that the bench has set.
    conditions: (u32, u32),
    /// Status and extended status that are shown instead of the real ones.
    stuck: Option<(u32, u32)>,
    /// Moves to come that are confirmed and not carried out.
    ignored_moves: u32,
    locked: bool,
    /// Whether 24 V are on the ENABLE input.
    enable_input: bool,
    /// Whether it has an encoder and counters.
    counts: bool,
    /// The ENABLE input behind its filter.
    enabled: bool,
    /// Since when the ENABLE input is open, if the filter has not yet passed it on.
    open_since_ns: Option<i64>,
    /// Without power until then.
    dead_until_ns: i64,
    frames_handled: u64,
    frames_seen: u64,
}

impl Board {
    /// Time since power-up, ns.
    pub fn now_ns(&self) -> i64 {
        self.now_ns
    }

    /// Outputs, bit 0 = OUT1.
    pub fn outputs(&self) -> u32 {
        self.memory.outputs
    }

    /// Analog outputs 1 and 2, 0 to 1023.
    pub fn analog_outputs(&self) -> [u16; 2] {
        self.memory.analog_outputs()
    }

    /// The serial line by its parameters.
    pub fn line(&self) -> Line {
        self.line
    }

    /// Assumptions where the manual is silent.
    pub fn assumptions(&self) -> &Assumptions {
        &self.assumptions
    }

    /// The status register.
    pub fn status(&self) -> Status {
        let now = self.now_ns;
        let set = |bit: u32, on: bool| if on { bit } else { 0 };
        // Before firmware 5.31 the bit dropped when a retargeted move reversed.
        let reversing = |axis: &Axis| {
            let since = now - axis.turn_ns();
            (0..self.assumptions.reversal_gap_ns).contains(&since)
        };
        let independent =
            self.axis_bits(|axis| axis.independent(now) && !(axis.has_turn() && reversing(axis)));
        Status(
            self.axis_bits(|axis| axis.interpolating(now))
                | independent << Status::ASYNC_MOVING_SHIFT
                | self.limit_bits() << Status::LIMIT_SWITCH_SHIFT
                | set(Status::BUFFER_EMPTY, self.buffer.is_empty())
                | set(Status::BUFFER_FROZEN, self.buffer.is_held())
                | set(Status::EMERGENCY_STOP, !self.enabled)
                | set(Status::BOARD_LOCKED, self.locked)
                | set(Status::HOMING_IN_PROGRESS, self.homings.machine_in_progress())
                | set(Status::HOMING_ERROR, self.homings.machine_failed())
                | set(Status::PROBE_IN_PROGRESS, self.probe.in_progress())
                | set(Status::PROBE_ERROR, self.probe.failed())
                | set(Status::EEPROM_BUSY, self.eeprom.busy())
                | set(Status::EEPROM_ERROR, self.eeprom.failed())
                | self.conditions.0,
        )
    }

    /// The extended status register.
    pub fn extended_status(&self) -> u32 {
        let directions = self.axis_bits(|axis| axis.positive(self.now_ns));
        directions | self.homings.extended_bits() | self.conditions.1
    }

    /// Status and extended status as registers and bits show them.
    fn shown_status(&self) -> (u32, u32) {
        self.stuck.unwrap_or_else(|| (self.status().0, self.extended_status()))
    }

    /// Whether the bench has frozen the command buffer.
    fn is_frozen(&self) -> bool {
        self.conditions.0 & Condition::BufferFrozen.bits().0 != 0
    }

    /// Speed of an axis, steps/s.
    pub fn velocity(&self, axis: BoardAxis) -> f64 {
        self.axes.get(axis.index()).map_or(0.0, |axis| axis.velocity(self.now_ns))
    }

    /// Position of an axis between its steps, steps.
    pub fn position(&self, axis: BoardAxis) -> f64 {
        self.axes.get(axis.index()).map_or(0.0, |axis| axis.state(self.now_ns).position)
    }

    /// End of an axis when all commands are done, the waiting segments included, steps.
    pub fn target(&self, axis: BoardAxis) -> i32 {
        let moved = self.axes.get(axis.index()).map_or(0, |axis| axis.counter(i64::MAX));
        self.buffer.last_target(axis).unwrap_or(moved)
    }

    /// Frames that were whole, error-free and for this address; LED D1 changes with each.
    pub fn frames_handled(&self) -> u64 {
        self.frames_handled
    }

    /// Frames that were whole and error-free, whichever address they were for; LED D2 changes with each.
    pub fn frames_seen(&self) -> u64 {
        self.frames_seen
    }

    /// The counter at the edge of the input that ended the last probing move, registers 1044 and 1045.
    pub fn probe_position(&self) -> i32 {
        self.probe.position()
    }

    /// Acts on axes of a mask, and on the axis that is coupled to X as on X.
    fn for_axes(&mut self, mask: AxisMask, mut act: impl FnMut(&mut Axis)) {
        let now = self.now_ns;
        let moved = self.axes.first().is_some_and(|axis| axis.moving(now));
        for (name, axis) in BoardAxis::ALL.into_iter().zip(&mut self.axes) {
            if mask.contains(name) {
                act(axis);
            }
        }
        if mask.contains(BoardAxis::X)
            && let Some(coupled) = self.coupled()
            && let Some(leader) = self.axes.first().copied()
            && (moved || leader.moving(now))
            && let Some(axis) = self.axes.get_mut(coupled.index())
        {
            axis.go_along(now, &leader);
        }
    }

    /// The axis that goes along with X (parameter 86).
    fn coupled(&self) -> Option<BoardAxis> {
        match self.memory.parameter(crate::protocol::parameters::COUPLING) {
            1 => Some(BoardAxis::A),
            2 => Some(BoardAxis::B),
            _ => None,
        }
    }
}
