//! `[[drives]]`: the devices on the wires.

use super::section::Section;
use std::ops::RangeInclusive;
use twin_drives::interpcnc::registers::MAX_SPEED_HZ;

/// Speeds that an axis may have at its largest velocity, steps/s: a quarter of it, with which the start of a program is
/// approached, must be a speed too, and 200 kHz is the most the board makes.
pub(super) fn steps_per_s() -> RangeInclusive<f64> {
    4.0..=f64::from(MAX_SPEED_HZ)
}

/// Largest position a counter of the board holds, increments.
pub(super) fn counts() -> f64 {
    f64::from(i32::MAX)
}

/// A device that moves one or more axes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceEntry {
    /// The name axes refer to.
    pub name: String,
    /// Serial port of the real device, if it is given.
    pub port: Option<String>,
    /// Modbus station.
    pub station: u8,
    /// Bits per second.
    pub baud: u32,
    /// Parity on the wire.
    pub parity: Parity,
    /// Time an emulated device takes to answer, µs.
    pub turnaround_us: u32,
    /// Start and stop frequency of its ramps, steps/s.
    pub start_stop_hz: u16,
    /// Acceleration and deceleration of its ramps, thousand steps/s².
    pub acceleration_khz_per_s: u16,
    /// Whether it stands between set-points and motors of the simulated machine.
    pub in_loop: bool,
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

/// Reads one `[[drives]]` table.
pub(super) fn read(section: &Section<'_>) -> Option<DeviceEntry> {
    let name = section.required_text("name");
    let kind = section.required_choice("kind", &[("interpcnc", ())]);
    let port = section.text("port").map(str::to_owned);
    let station = section.integer("station", 1..=247).unwrap_or(1);
    let baud = section.integer("baud", 4800..=256_000).unwrap_or(115_200);
    let parity = section
        .choice("parity", &[("none", Parity::None), ("even", Parity::Even), ("odd", Parity::Odd)])
        .unwrap_or(Parity::None);
    let turnaround_ms = section.number("emulated_turnaround_ms", 0.0..=1000.0).unwrap_or(2.0);
    let start_stop = section.integer("start_stop_hz", 1..=65_535).unwrap_or(200);
    let acceleration = section.integer("acceleration_khz_per_s", 1..=65_535).unwrap_or(2000);
    let in_loop = section.flag("in_loop").unwrap_or(false);
    kind?;
    Some(DeviceEntry {
        name: name?.to_owned(),
        port,
        station: u8::try_from(station).ok()?,
        baud: u32::try_from(baud).ok()?,
        parity,
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to a million"
        )]
        turnaround_us: (turnaround_ms * 1e3) as u32,
        start_stop_hz: u16::try_from(start_stop).ok()?,
        acceleration_khz_per_s: u16::try_from(acceleration).ok()?,
        in_loop,
    })
}
