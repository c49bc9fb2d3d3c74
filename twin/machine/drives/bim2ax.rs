//! `[[drives]]` entry of a BIM2AX module.

use super::{Abilities, ModuleEncoder, assumptions, encoder, microseconds};
use crate::section::Section;
use twin_bim2ax::{Assumptions, ByteOrder, DriveMode, MOST_POSITION};

/// Entry of a module, whose axes are alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bim2AxEntry {
    /// Drive mode (parameters 2 and 3): microsteps, and the unit of speeds.
    pub mode: DriveMode,
    /// Start-stop speed (parameters $C and $D), steps/s.
    pub start_stop_speed: u16,
    /// Acceleration (parameters $14 and $15), steps/s².
    pub acceleration: u16,
    /// Assumptions where the manual is silent.
    pub assumptions: Assumptions,
    /// From an order to the begin of its motion, µs.
    pub order_us: u32,
    /// Offset of the module's memory in the device that is to be mapped; `None` for a memory file.
    pub map_offset: Option<u64>,
    /// Byte order of the module's numbers.
    pub byte_order: ByteOrder,
    /// Encoders of its axes.
    pub encoder: Option<ModuleEncoder>,
}

impl Bim2AxEntry {
    /// Speeds are whole steps/s, at least the start-stop speed; a quarter of the largest is one, too.
    pub(super) fn abilities(&self) -> Abilities {
        let unit = self.mode.speed_unit();
        Abilities { speeds: 4.0 * unit..=65_535.0 * unit, counts: f64::from(MOST_POSITION) }
    }
}

pub(super) fn read(section: &Section<'_>) -> Option<Bim2AxEntry> {
    let microsteps = section.integer("microsteps", 1..=64).unwrap_or(16);
    // Modes whose speeds are in steps/s: those in microsteps/s are too slow for 16 bits.
    let code = match microsteps {
        1 => Some(0x0001),
        2 => Some(0x0100),
        4 => Some(0x0200),
        8 => Some(0x0300),
        16 => Some(0x0400),
        32 => Some(0x0500),
        64 => Some(0x0600),
        _ => None,
    };
    if code.is_none() {
        let message = format!("`microsteps` is {microsteps}; a step has 1, 2, 4, 8, 16, 32 or 64");
        section.complain_at("microsteps", message);
    }
    let start_stop = section.integer("start_stop_steps_per_s", 1..=65_535).unwrap_or(100);
    let acceleration = section.integer("acceleration_steps_per_s2", 1..=65_535).unwrap_or(65_535);
    let order_us = microseconds(section, "emulated_turnaround_ms", 10.0);
    let map_offset = section.integer("map_offset", 0..=i64::MAX);
    let orders = [("big", ByteOrder::Big), ("little", ByteOrder::Little)];
    let byte_order = section.choice("byte_order", &orders).unwrap_or(ByteOrder::Big);
    let mode = code.and_then(DriveMode::from_code);
    let encoder = encoder::of_module(section, mode.unwrap_or(DriveMode::FULL_STEP));
    Some(Bim2AxEntry {
        mode: mode?,
        start_stop_speed: u16::try_from(start_stop).ok()?,
        acceleration: u16::try_from(acceleration).ok()?,
        assumptions: assumptions(section),
        order_us,
        map_offset: map_offset.and_then(|offset| u64::try_from(offset).ok()),
        byte_order,
        encoder,
    })
}
