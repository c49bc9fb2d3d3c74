//! What happens to a served board other than on the wire.

use super::{Bench, Board, Condition};
use crate::{FaultRule, FaultyWire, interpcnc::registers::BoardAxis};

/// What happens to the board other than on the wire, and to the wire.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Control {
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
        /// How many.
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
    /// Writes to the EEPROM fail (true) or no more.
    BreakEeprom(bool),
    /// The supply fails and is back after so many ns.
    BrownOut {
        /// Without supply for so long, ns.
        off_ns: i64,
    },
    /// One more fault of the wire.
    Fault(FaultRule),
    /// The wire has no faults any more.
    NoFaults,
    /// The plug is pulled (true) or put back.
    Disconnect(bool),
}

impl Control {
    /// Makes it happen now.
    pub(super) fn apply(self, board: &mut Board, wire: &mut FaultyWire) {
        match self {
            Self::Enable(closed) => board.set_enable(closed),
            Self::Input { number, level } => board.set_input(number, level),
            Self::ReleaseInput(number) => board.release_input(number),
            Self::AnalogInput { number, value } => board.set_analog_input(number, value),
            Self::Pulses { second, count } => board.add_pulses(second, count),
            Self::Bench(bench) => board.set_bench(bench),
            Self::Condition(condition, on) => board.set_condition(condition, on),
            Self::Stall(axis, stalled) => board.set_stalled(axis, stalled),
            Self::StuckStatus(stuck) => board.set_stuck_status(stuck),
            Self::BreakEeprom(broken) => board.set_eeprom_broken(broken),
            Self::BrownOut { off_ns } => board.brown_out(off_ns),
            Self::Fault(rule) => wire.add(rule),
            Self::NoFaults => wire.clear(),
            Self::Disconnect(disconnected) => wire.set_disconnected(disconnected),
        }
    }
}
