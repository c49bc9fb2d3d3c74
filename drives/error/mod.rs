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
        /// Exchange in which it happened.
        at: Exchange,
        /// Error of the operating system.
        source: io::Error,
    },
    /// No answer before the deadline. Whether the device got the request is unknown.
    #[error("{at}: no answer within {} ms", deadline.as_millis())]
    Timeout {
        /// Exchange in which it happened.
        at: Exchange,
        /// The deadline.
        deadline: Duration,
    },
    /// An answer came that is not the answer to the request.
    #[error("{at}: {fault}")]
    Protocol {
        /// Exchange in which it happened.
        at: Exchange,
        /// The fault.
        fault: ProtocolFault,
    },
    /// The device reports a fault in the terms of its family.
    #[error("{at}: {fault}")]
    Device {
        /// Exchange in which it happened.
        at: Exchange,
        /// The fault.
        fault: Box<dyn DeviceFault>,
    },
    /// The device is not in the mode in which it obeys, or does not leave it.
    #[error("{at}: the drive is in mode {found}, not in {expected}")]
    Mode {
        /// Exchange in which it happened.
        at: Exchange,
        /// Number of the mode it should be in.
        expected: u8,
        /// Number of the mode it is in; 31 while it changes.
        found: u8,
    },
    /// The motor was blocked.
    #[error("{at}: the motor has stalled")]
    Stalled {
        /// Exchange in which it happened.
        at: Exchange,
    },
    /// Homing has ended without a home position.
    #[error("{at}: homing has not found its switch")]
    NotHomed {
        /// Exchange in which it happened.
        at: Exchange,
    },
    /// The device is not what it should be, or set otherwise than it should be.
    #[error("{at}: {name} is {found}, not {}", with_unit(expected, unit))]
    Parameter {
        /// Exchange in which it happened.
        at: Exchange,
        /// Name of the parameter.
        name: &'static str,
        /// Its unit; empty for what has none.
        unit: &'static str,
        /// Expected value, at least for ceilings.
        expected: i64,
        /// Found value.
        found: i64,
    },
    /// A value is beyond what the command can say.
    #[error("{at}: {what} = {} is impossible ({low} to {high})", with_unit(value, unit))]
    Value {
        /// Exchange in which it happened.
        at: Exchange,
        /// Found value.
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
    #[error("{at}: the output is still {}, although the drive has confirmed the command", if *on { "off" } else { "on" })]
    NotSwitched {
        /// Exchange in which it happened.
        at: Exchange,
        /// As it should be.
        on: bool,
    },
    /// The device is locked: it accepts motion commands and does nothing.
    #[error("{at}: the board is locked")]
    Locked {
        /// Exchange in which it happened.
        at: Exchange,
    },
    /// The enable input is open (emergency stop): the device is locked and cannot be unlocked.
    #[error("{at}: the ENABLE input is open, the board cannot be unlocked")]
    EnableOpen {
        /// Exchange in which it happened.
        at: Exchange,
    },
    /// The device should have locked itself and has not.
    #[error("{at}: the board is not locked")]
    NotLocked {
        /// Exchange in which it happened.
        at: Exchange,
    },
    /// An axis has run onto a limit switch.
    #[error("{at}: a limit switch is active{}", axes.listed())]
    LimitSwitch {
        /// Exchange in which it happened.
        at: Exchange,
        /// The axes.
        axes: Axes,
    },
    /// Axes move that must be at rest for what was asked.
    #[error("{at}: still moving{}", axes.listed())]
    Moving {
        /// Exchange in which it happened.
        at: Exchange,
        /// The axes.
        axes: Axes,
    },
    /// An action has not ended in the time it was given.
    #[error("{at}: not finished within {} ms", patience.as_millis())]
    Unfinished {
        /// Exchange in which it happened.
        at: Exchange,
        /// The time.
        patience: Duration,
    },
    /// An axis has stopped elsewhere than on its target: something else has stopped it.
    #[error("{at}: {axis} is at {found} instead of {target} {}", axis.unit())]
    NotArrived {
        /// Exchange in which it happened.
        at: Exchange,
        /// The axis.
        axis: Axes,
        /// Expected position, increments.
        target: i64,
        /// Found position, increments.
        found: i64,
    },
    /// An axis rests although the device has confirmed a move, and confirmed it again.
    #[error("{at}: {axis} stays at {found} {}: two moves were confirmed and had no effect", axis.unit())]
    NoEffect {
        /// Exchange in which it happened.
        at: Exchange,
        /// The axis.
        axis: Axes,
        /// Found position, increments.
        found: i64,
    },
    /// Homing has failed: no switch within the stroke, or something else has stopped it.
    #[error("{at}: homing has failed{}", axes.listed())]
    HomingFailed {
        /// Exchange in which it happened.
        at: Exchange,
        /// The axes.
        axes: Axes,
    },
    /// The shaft of an axis is not where its counter says, by its encoder: it is held, steps are lost, or the encoder does not
    /// count as it is said to.
    #[error(
        "{at}: {axis} is at {counter} {unit} by its counter and at {encoder} {unit} by its encoder{}: they may be {tolerance} {unit} apart",
        points.map_or_else(String::new, |points| format!(" ({points} points)"))
    )]
    EncoderDiffers {
        /// Exchange in which it happened.
        at: Exchange,
        /// The axis.
        axis: Axes,
        /// Counter, increments; of a range that it passed while the encoder was read the nearest value.
        counter: i64,
        /// Counter by the encoder, increments.
        encoder: i64,
        /// Name of this device's increments.
        unit: &'static str,
        /// So far they may be apart, increments; what the axis may have moved between two readings comes on top.
        tolerance: u32,
        /// Encoder itself, points, where the device does not report increments.
        points: Option<i32>,
    },
    /// The device could not write its EEPROM.
    #[error("{at}: the EEPROM could not be written")]
    EepromFailed {
        /// Exchange in which it happened.
        at: Exchange,
    },
    /// A register or parameter does not hold what was just written to it.
    #[error("{at}: {address} reads {found} after {written} was written")]
    NotKept {
        /// Exchange in which it happened.
        at: Exchange,
        /// Register, or number of the parameter.
        address: u16,
        /// Written.
        written: u32,
        /// Read back.
        found: u32,
    },
    /// A parameter of the device differs from the settings of the client.
    #[error("{at}: parameter {number} is {found} instead of {}", with_unit(expected, unit))]
    ParameterDiffers {
        /// Exchange in which it happened.
        at: Exchange,
        /// Number of the parameter.
        number: u16,
        /// Its unit; empty for what has none.
        unit: &'static str,
        /// Expected value of the settings.
        expected: u32,
        /// Value of the device.
        found: u32,
    },
    /// A position counter does not hold what was just written to it.
    #[error("{at}: the counter of {axis} reads {found} after {written} {} was written", axis.unit())]
    NotWritten {
        /// Exchange in which it happened.
        at: Exchange,
        /// The axis.
        axis: Axes,
        /// Increments written.
        written: i64,
        /// Increments read back.
        found: i64,
    },
    /// A value does not fit the register that carries it.
    #[error("{at}: {} does not fit register {register} ({low} to {high})", with_unit(value, unit))]
    Range {
        /// Exchange in which it happened.
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
        /// Exchange in which it happened.
        at: Exchange,
        /// Missing ability.
        what: &'static str,
    },
    /// There is no such parameter.
    #[error("{at}: there is no {id}")]
    NoParameter {
        /// Exchange in which it happened.
        at: Exchange,
        /// Number of the parameter.
        id: ParameterId,
    },
    /// The parameter cannot be set.
    #[error("{at}: {id} is read-only")]
    ReadOnly {
        /// Exchange in which it happened.
        at: Exchange,
        /// Number of the parameter.
        id: ParameterId,
    },
    /// The parameter cannot have this value.
    #[error("{at}: {id} = {value} is impossible ({values})")]
    ParameterValue {
        /// Exchange in which it happened.
        at: Exchange,
        /// Number of the parameter.
        id: ParameterId,
        /// The value.
        value: i64,
        /// Values that it takes.
        values: Values,
    },
    /// A setting of the driver itself is impossible.
    #[error("{at}: {setting} = {value} is impossible ({low} to {high})")]
    Setting {
        /// Exchange in which it happened.
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
