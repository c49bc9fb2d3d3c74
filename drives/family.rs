//! Drive family: the keys of its devices in a machine file, and the way from a device to a drive, an emulator and a
//! prediction.
//!
//! A family implements [`Family`] and [`Device`] and takes one line in the list of families of the program. Everything
//! here is in increments: a device does not know the axes of the machine that it moves.

use std::{any::Any, fmt::Debug, ops::RangeInclusive, time::Duration};

use crate::{Assumed, Drive, DriveError, EmulatorError, Prediction};

/// Deadline of exchanges with an emulated device. The kernel passes the bytes of a pseudo-terminal on when it has
/// nothing more urgent to do, which on a busy computer takes a while; a wire does not wait.
pub const EMULATED_DEADLINE: Duration = Duration::from_secs(2);

/// Keys of one table of a machine file. A key with a wrong value is reported at its place and gives none.
pub trait Keys {
    /// True if the table has the key.
    fn has(&self, key: &str) -> bool;

    /// All keys of the table, which all are known then.
    fn keys(&self) -> Vec<String>;

    /// A text.
    fn text(&self, key: &str) -> Option<String>;

    /// Place of a text among some words.
    fn word(&self, key: &str, words: &[&str]) -> Option<usize>;

    /// `true` or `false`.
    fn flag(&self, key: &str) -> Option<bool>;

    /// A whole number within a range.
    fn integer(&self, key: &str, range: RangeInclusive<i64>) -> Option<i64>;

    /// Up to `most` whole numbers within a range; none if the key is absent.
    fn integers(&self, key: &str, range: &RangeInclusive<i64>, most: usize) -> Vec<i64>;

    /// A number within a range.
    fn number(&self, key: &str, range: RangeInclusive<f64>) -> Option<f64>;

    /// A table within the table; none if the key is absent.
    fn table(&self, key: &str) -> Option<Box<dyn Keys + '_>>;

    /// Reports that the table lacks a key, unless it has it.
    fn require(&self, key: &str);

    /// Reports something wrong with the value of a key.
    fn complain(&self, key: &str, message: String);

    /// Reports the keys that nothing has read.
    fn finish(&self);
}

/// One of a few words, each with its meaning.
pub fn choice<T: Copy>(keys: &dyn Keys, key: &str, choices: &[(&str, T)]) -> Option<T> {
    let words: Vec<_> = choices.iter().map(|(word, _)| *word).collect();
    choices.get(keys.word(key, &words)?).map(|(_, meaning)| *meaning)
}

/// A whole number within a range that the table must have.
pub fn required_integer(keys: &dyn Keys, key: &str, range: RangeInclusive<i64>) -> Option<i64> {
    keys.require(key);
    keys.integer(key, range)
}

/// A time in ms, up to a second, as whole µs.
pub fn microseconds(keys: &dyn Keys, key: &str, default_ms: f64) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to a million")]
    let time_us = (keys.number(key, 0.0..=1000.0).unwrap_or(default_ms) * 1e3).round() as u32;
    time_us
}

/// The assumptions of the table `assumptions` over the usual ones of a family.
pub fn assumptions<A: Assumed>(keys: &dyn Keys) -> A {
    let mut assumed = A::default();
    let Some(table) = keys.table("assumptions") else { return assumed };
    for name in table.keys() {
        if let Some(value) = table.text(&name)
            && let Err(error) = assumed.set(&name, &value)
        {
            table.complain(&name, error.to_string());
        }
    }
    assumed
}

/// True if an assumption with this value differs from the usual ones of a family.
pub fn is_assumed_otherwise<A: Assumed>(name: &str, value: &str) -> bool {
    let mut assumed = A::default();
    assumed.set(name, value).is_ok() && assumed != A::default()
}

/// Demand of a machine on one axis of a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisDemand {
    /// Axis of the device, as [`Family::axis`] counts it.
    pub index: usize,
    /// Largest speed, with room to catch up, increments/s.
    pub speed: f64,
    /// Software limits, increments; none for an axis without.
    pub limits: Option<[i32; 2]>,
}

/// A positive number, rounded up to a whole one from 1 to `most`.
pub fn counted(value: f64, most: u32) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
    let value = value.ceil().clamp(1.0, f64::from(most)) as u32;
    value
}

/// Abilities of a device on any machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Abilities {
    /// Speeds that an axis may have at its largest velocity, increments/s.
    pub speeds: RangeInclusive<f64>,
    /// Largest position of its counters, increments.
    pub counts: f64,
    /// Speed that its step motors start with at once, increments/s; none if it is not known.
    pub start_stop: Option<f64>,
}

/// A drive family.
pub trait Family: Debug + Sync {
    /// Its name in a machine file: the value of `kind`.
    fn kind(&self) -> &'static str;

    /// Its name for people.
    fn title(&self) -> &'static str;

    /// The key of an axis of a machine that names the axis of the device.
    fn axis_key(&self) -> &'static str {
        "drive_axis"
    }

    /// Reads the axis of the device from the table of an axis of a machine.
    fn axis(&self, keys: &dyn Keys) -> Option<usize>;

    /// Name of an axis of a device.
    fn axis_name(&self, index: usize) -> String;

    /// Number of outputs of a device of which some axes are in use.
    fn outputs(&self, _axes: usize) -> u32 {
        0
    }

    /// True if the table `encoder` of a device describes encoders.
    fn has_encoders(&self) -> bool {
        false
    }

    /// Message and help for a key that says an address, where the address of this family belongs elsewhere.
    fn misplaced_address(&self, _key: &str) -> Option<(String, String)> {
        None
    }

    /// True if an assumption with this value differs from the usual ones.
    fn is_assumed_otherwise(&self, _name: &str, _value: &str) -> bool {
        false
    }

    /// Reads a device; none if something is wrong with it.
    fn read(&self, keys: &dyn Keys) -> Option<Box<dyn Device>>;
}

/// A device of a family as a machine file describes it.
pub trait Device: Any + Debug + Send + Sync {
    /// Its family.
    fn family(&self) -> &'static dyn Family;

    /// The same once more.
    fn copied(&self) -> Box<dyn Device>;

    /// Abilities on any machine.
    fn abilities(&self) -> Abilities;

    /// Expected time from a request to its effect, µs.
    fn response_us(&self) -> u32;

    /// Expects another response time from now on, µs.
    fn expect_response_us(&mut self, response_us: u32);

    /// What the deadline of an answer of the real device has to spare for computer and adapter, and the pause before it is asked
    /// again. `said` is the first of the machine file.
    fn waits(&self, said: Option<Duration>) -> [Duration; 2];

    /// Offset of the device in the memory at its port; none of a device with a port of its own.
    fn map_offset(&self) -> Option<u64> {
        None
    }

    /// Opens the real device at a port, with `waits` as [`Self::waits`]. Sends nothing.
    ///
    /// # Errors
    /// If the port cannot be opened, or the settings do not fit each other.
    fn open(
        &self,
        port: &str,
        axes: &[AxisDemand],
        waits: [Duration; 2],
    ) -> Result<Box<dyn Drive>, DriveError>;

    /// Powers an emulated device up with the parameters that a real one has been given, and opens it. `clock` gives the time
    /// by which its axes move.
    ///
    /// # Errors
    /// If the emulator does not start, or it cannot be opened.
    fn emulate(&self, axes: &[AxisDemand], clock: DeviceClock) -> Result<Connected, ConnectError>;

    /// The device and its client in simulated time.
    fn prediction(&self, axes: &[AxisDemand]) -> Box<dyn Prediction>;
}

impl dyn Device {
    /// The device, if it is one of this type.
    pub fn of<D: Device>(&self) -> Option<&D> {
        (self as &dyn Any).downcast_ref()
    }
}

impl Clone for Box<dyn Device> {
    fn clone(&self) -> Self {
        self.copied()
    }
}

/// Clock of an emulated device.
pub type DeviceClock = Box<dyn Fn() -> i64 + Send + Sync>;

/// An emulated device that is running.
pub trait Emulator: Any + Debug {
    /// The place at which it can be opened, for messages.
    fn place(&self) -> String;
}

impl<T: crate::emulator_host::SerialDevice<Event: Send, Seen: Send> + Send + 'static> Emulator
    for crate::emulator_host::Emulated<T>
{
    fn place(&self) -> String {
        self.path().display().to_string()
    }
}

impl dyn Emulator {
    /// The emulator, if it is one of this type.
    pub fn of<E: Emulator>(&self) -> Option<&E> {
        (self as &dyn Any).downcast_ref()
    }

    /// The emulator, if it is one of this type; another one ends.
    pub fn into<E: Emulator>(self: Box<Self>) -> Option<Box<E>> {
        (self as Box<dyn Any>).downcast().ok()
    }
}

/// An emulated device, and the drive that is connected to it.
pub type Connected = (Box<dyn Emulator>, Box<dyn Drive>);

/// Error of an emulated device that cannot be connected.
#[derive(Debug, thiserror::Error)]
pub enum ConnectError {
    /// The emulator.
    #[error("the drive cannot be emulated: {0}")]
    Emulator(#[from] EmulatorError),
    /// Its drive.
    #[error(transparent)]
    Drive(#[from] DriveError),
}
