//! `[[drives]]` entry of an InterpCNC board.

use super::{Abilities, assumptions, encoder, microseconds};
use crate::section::Section;
use twin_interpcnc::protocol::registers::MAX_SPEED_HZ;
use twin_interpcnc::{Assumptions, EncoderOptions, Following};

/// Entry of a board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InterpCncEntry {
    /// Modbus station.
    pub address: u8,
    /// Bits per second.
    pub baud: u32,
    /// Parity on the wire.
    pub parity: Parity,
    /// Time an emulated board takes to answer, µs.
    pub turnaround_us: u32,
    /// Start and stop frequency of its ramps, steps/s.
    pub start_stop_hz: u16,
    /// Acceleration and deceleration of its ramps, thousand steps/s².
    pub acceleration_khz_per_s: u16,
    /// Assumptions where the manual is silent.
    pub assumptions: Assumptions,
    /// Method by which the board follows a plan.
    pub following: Following,
    /// True if the adapter of the real board hears what it sends.
    pub echo: bool,
    /// Its encoder, from V2.1D on.
    pub encoder: Option<EncoderOptions>,
}

/// Parity of a serial line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// 8N1.
    None,
    /// 8E1.
    Even,
    /// 8O1.
    Odd,
}

impl InterpCncEntry {
    /// A quarter of its largest velocity, with which the start of a program is approached, must be a speed too, and 200
    /// kHz is the most the board makes.
    pub(super) fn abilities() -> Abilities {
        Abilities { speeds: 4.0..=f64::from(MAX_SPEED_HZ), counts: f64::from(i32::MAX) }
    }
}

pub(super) fn read(section: &Section<'_>) -> Option<InterpCncEntry> {
    let address = section.integer("station", 1..=247).unwrap_or(1);
    let baud = section.integer("baud", 4800..=256_000).unwrap_or(115_200);
    let parities = [("none", Parity::None), ("even", Parity::Even), ("odd", Parity::Odd)];
    let parity = section.choice("parity", &parities).unwrap_or(Parity::None);
    let turnaround_us = microseconds(section, "emulated_turnaround_ms", 2.0);
    let start_stop = section.integer("start_stop_hz", 1..=65_535).unwrap_or(200);
    let acceleration = section.integer("acceleration_khz_per_s", 1..=65_535).unwrap_or(2000);
    let echo = section.flag("echo").unwrap_or(false);
    let start_stop_hz = u16::try_from(start_stop).ok()?;
    let acceleration_khz_per_s = u16::try_from(acceleration).ok()?;
    let buffered = Following::Buffered { start_stop_hz, acceleration_khz_per_s };
    let ways = [("retargeted", Following::Retargeted), ("buffered", buffered)];
    let following = section.choice("following", &ways).unwrap_or_default();
    Some(InterpCncEntry {
        address: u8::try_from(address).ok()?,
        baud: u32::try_from(baud).ok()?,
        parity,
        turnaround_us,
        start_stop_hz,
        acceleration_khz_per_s,
        assumptions: assumptions(section),
        following,
        echo,
        encoder: encoder::of_board(section),
    })
}
