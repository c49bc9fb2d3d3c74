//! Errors of drives: everything that can fail between the twin and a device.

mod at;
mod axes;
mod device_fault;
mod emulator;
mod exchange;
mod parameter;

use std::{fmt::Display, io, time::Duration};

pub use self::parameter::find_parameter;
pub use self::{
    axes::Axes,
    device_fault::DeviceFault,
    emulator::EmulatorError,
    exchange::{Action, Exchange, ProtocolFault},
};
use crate::{ParameterId, Values};

/// A device that did not do what it was asked to, with the reason.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// The port cannot be opened, read or written.
    #[error("{at}: {source}")]
    Transport {
        /// Where.
        at: Exchange,
        /// What the operating system says.
        source: io::Error,
    },
    /// No answer before the deadline. Whether the device got the request is unknown.
    #[error("{at}: no answer within {} ms", deadline.as_millis())]
    Timeout {
        /// Where.
        at: Exchange,
        /// The deadline.
        deadline: Duration,
    },
    /// An answer came that is not the answer to the request.
    #[error("{at}: {fault}")]
    Protocol {
        /// Where.
        at: Exchange,
        /// What is wrong with it.
        fault: ProtocolFault,
    },
    /// The device reports a fault in the terms of its family.
    #[error("{at}: {fault}")]
    Device {
        /// Where.
        at: Exchange,
        /// Which.
        fault: Box<dyn DeviceFault>,
    },
    /// The device is not in the mode in which it obeys, or does not leave it.
    #[error("{at}: the drive is in mode {found}, not in {expected}")]
    Mode {
        /// Where.
        at: Exchange,
        /// Number of the mode it should be in.
        expected: u8,
        /// Number of the mode it is in; 31 while it changes.
        found: u8,
    },
    /// The motor was blocked.
    #[error("{at}: the motor has stalled")]
    Stalled {
        /// Where.
        at: Exchange,
    },
    /// Homing has ended without a home position.
    #[error("{at}: homing has not found its switch")]
    NotHomed {
        /// Where.
        at: Exchange,
    },
    /// The device is not what it should be, or set otherwise than it should be.
    #[error("{at}: {name} is {found}, not {}", with_unit(expected, unit))]
    Parameter {
        /// Where.
        at: Exchange,
        /// Name of the parameter.
        name: &'static str,
        /// Its unit; empty for what has none.
        unit: &'static str,
        /// What it should be, at least for ceilings.
        expected: i64,
        /// What it is.
        found: i64,
    },
    /// A value is beyond what the command can say.
    #[error("{at}: {what} = {} is impossible ({low} to {high})", with_unit(value, unit))]
    Value {
        /// Where.
        at: Exchange,
        /// What it is.
        what: &'static str,
        /// The value.
        value: f64,
        /// Its unit; empty for what has none.
        unit: &'static str,
        /// Smallest value possible.
        low: f64,
        /// Largest value possible.
        high: f64,
    },
    /// An output that the device should have switched is as it was.
    #[error("{at}: the drive has confirmed it, and the output is still {}", if *on { "off" } else { "on" })]
    NotSwitched {
        /// Where.
        at: Exchange,
        /// As it should be.
        on: bool,
    },
    /// The device is locked: it accepts motion commands and does nothing.
    #[error("{at}: the board is locked")]
    Locked {
        /// Where.
        at: Exchange,
    },
    /// The enable input is open (emergency stop): the device is locked and cannot be unlocked.
    #[error("{at}: the ENABLE input is open, the board cannot be unlocked")]
    EnableOpen {
        /// Where.
        at: Exchange,
    },
    /// The device should have locked itself and has not.
    #[error("{at}: the board is not locked")]
    NotLocked {
        /// Where.
        at: Exchange,
    },
    /// An axis has run onto a limit switch.
    #[error("{at}: a limit switch is active{}", axes.listed())]
    LimitSwitch {
        /// Where.
        at: Exchange,
        /// Which.
        axes: Axes,
    },
    /// Axes move that must be at rest for what was asked.
    #[error("{at}: still moving{}", axes.listed())]
    Moving {
        /// Where.
        at: Exchange,
        /// Which.
        axes: Axes,
    },
    /// What was begun has not ended in the time it was given.
    #[error("{at}: not finished within {} ms", patience.as_millis())]
    Unfinished {
        /// Where.
        at: Exchange,
        /// The time.
        patience: Duration,
    },
    /// An axis has stopped elsewhere than on its target: something else has stopped it.
    #[error("{at}: {axis} stands at {found} instead of {target} {}", axis.unit())]
    NotArrived {
        /// Where.
        at: Exchange,
        /// Which.
        axis: Axes,
        /// Where it should be, increments.
        target: i64,
        /// Where it is, increments.
        found: i64,
    },
    /// Homing has failed: no switch within the stroke, or something else has stopped it.
    #[error("{at}: homing has failed{}", axes.listed())]
    HomingFailed {
        /// Where.
        at: Exchange,
        /// Which.
        axes: Axes,
    },
    /// The shaft of an axis is not where its counter says, by its encoder: it is held, steps are lost, or the encoder does not
    /// count as it is said to.
    #[error(
        "{at}: {axis} is at {counter} {unit} by its counter and at {encoder} {unit} by its encoder{}: they may be {tolerance} {unit} apart",
        points.map_or_else(String::new, |points| format!(" ({points} points)"))
    )]
    EncoderDiffers {
        /// Where.
        at: Exchange,
        /// Which.
        axis: Axes,
        /// What the counter shows, increments; of a stretch that it passed while the encoder was read the nearest place.
        counter: i64,
        /// What it would be by the encoder, increments.
        encoder: i64,
        /// What increments of this device are called.
        unit: &'static str,
        /// So far they may be apart, increments; what the axis may have moved between two readings comes on top.
        tolerance: u32,
        /// What the encoder itself shows, points, where the device does not tell increments.
        points: Option<i32>,
    },
    /// The input that a probing move awaited did not come.
    #[error("{at}: the probe has found nothing")]
    ProbeFailed {
        /// Where.
        at: Exchange,
    },
    /// The device could not write its EEPROM.
    #[error("{at}: the EEPROM could not be written")]
    EepromFailed {
        /// Where.
        at: Exchange,
    },
    /// A register or parameter does not hold what was just written to it.
    #[error("{at}: {address} reads {found} after {written} was written")]
    NotKept {
        /// Where.
        at: Exchange,
        /// Register, or number of the parameter.
        address: u16,
        /// Written.
        written: u32,
        /// Read back.
        found: u32,
    },
    /// A parameter of the device is not what the driver has been told.
    #[error("{at}: parameter {number} is {found} instead of {}", with_unit(expected, unit))]
    ParameterDiffers {
        /// Where.
        at: Exchange,
        /// Number of the parameter.
        number: u16,
        /// Its unit; empty for what has none.
        unit: &'static str,
        /// What the driver has been told.
        expected: u32,
        /// What the device has.
        found: u32,
    },
    /// A position counter does not hold what was just written to it.
    #[error("{at}: the counter of {axis} reads {found} after {written} {} was written", axis.unit())]
    NotWritten {
        /// Where.
        at: Exchange,
        /// Which.
        axis: Axes,
        /// Increments written.
        written: i64,
        /// Increments read back.
        found: i64,
    },
    /// A value does not fit the register that carries it.
    #[error("{at}: {} does not fit register {register} ({low} to {high})", with_unit(value, unit))]
    Range {
        /// Where.
        at: Exchange,
        /// First register of the value.
        register: u16,
        /// The value.
        value: f64,
        /// Its unit; empty for what has none.
        unit: &'static str,
        /// Smallest value that fits.
        low: f64,
        /// Largest value that fits.
        high: f64,
    },
    /// The device has no such function.
    #[error("{at}: the device has no {what}")]
    Unsupported {
        /// Where.
        at: Exchange,
        /// What it does not have.
        what: &'static str,
    },
    /// There is no such parameter.
    #[error("{at}: there is no {id}")]
    NoParameter {
        /// Where.
        at: Exchange,
        /// Which.
        id: ParameterId,
    },
    /// The parameter cannot be set.
    #[error("{at}: {id} is read-only")]
    ReadOnly {
        /// Where.
        at: Exchange,
        /// Which.
        id: ParameterId,
    },
    /// The parameter cannot have this value.
    #[error("{at}: {id} = {value} is impossible ({values})")]
    ParameterValue {
        /// Where.
        at: Exchange,
        /// Which.
        id: ParameterId,
        /// The value.
        value: i64,
        /// What it takes.
        values: Values,
    },
    /// A setting of the driver itself is impossible.
    #[error("{at}: {setting} = {value} is impossible ({low} to {high})")]
    Setting {
        /// Where.
        at: Exchange,
        /// Name of the setting.
        setting: &'static str,
        /// Its value.
        value: u32,
        /// Smallest value possible.
        low: u32,
        /// Largest value possible.
        high: u32,
    },
}

/// A value with its unit: "5 steps", or "5" for what has no unit.
fn with_unit(value: impl Display, unit: &str) -> String {
    if unit.is_empty() { value.to_string() } else { format!("{value} {unit}") }
}
