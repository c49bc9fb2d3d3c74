//! Events at a served board other than on the wire, and their handling.

use super::{Bench, Board, Condition};
use crate::protocol::registers::BoardAxis;

/// Events at the board, and faults of the wire.
pub type Control = twin_drives::Control<Event>;

/// Event at the board other than on the wire.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// The ENABLE input closes (true) or opens.
    Enable(bool),
    /// A hand sets an input, also against a cam.
    Input {
        /// 1 to 32.
        number: u8,
        /// Its level.
        level: bool,
    },
    /// The hand is taken off an input: its cams press it again.
    ReleaseInput(u8),
    /// The voltage at an analog input changes.
    AnalogInput {
        /// 1 to 4.
        number: u8,
        /// 0 to 1023.
        value: u16,
    },
    /// Pulses arrive at counter A (false) or B.
    Pulses {
        /// Counter B.
        second: bool,
        /// Number of pulses.
        count: u32,
    },
    /// The board gets another bench.
    Bench(Bench),
    /// A condition comes about (true) or ends.
    Condition(Condition, bool),
    /// The motor of an axis stalls (true) or follows again.
    Stall(BoardAxis, bool),
    /// The status is shown as it is now for good (true), or as it is.
    StuckStatus(bool),
    /// The next moves, of this number, are confirmed and not carried out.
    IgnoreMoves(u32),
    /// Writes to the EEPROM fail (true) or no more.
    BreakEeprom(bool),
    /// The supply fails and is back after this time, ns.
    BrownOut {
        /// Without supply for so long, ns.
        off_ns: i64,
    },
}

impl Board {
    /// Lets something happen now.
    pub fn happen(&mut self, event: Event) {
        match event {
            Event::Enable(closed) => self.set_enable(closed),
            Event::Input { number, level } => self.set_input(number, level),
            Event::ReleaseInput(number) => self.release_input(number),
            Event::AnalogInput { number, value } => self.set_analog_input(number, value),
            Event::Pulses { second, count } => self.add_pulses(second, count),
            Event::Bench(bench) => self.set_bench(bench),
            Event::Condition(condition, on) => self.set_condition(condition, on),
            Event::Stall(axis, stalled) => self.set_stalled(axis, stalled),
            Event::StuckStatus(stuck) => self.set_stuck_status(stuck),
            Event::IgnoreMoves(moves) => self.ignored_moves = moves,
            Event::BreakEeprom(broken) => self.set_eeprom_broken(broken),
            Event::BrownOut { off_ns } => self.brown_out(off_ns),
        }
    }
}
