//! Emulators of the drives a machine file names, in this process, with the real driver connected to them.

use crate::clock::Clock;
use crate::machine::{Axis, DeviceEntry, Machine, Parity};
use std::time::Duration;
use twin_drives::interpcnc::emulator::{BoardOptions, EmulatedBoard, EmulatorOptions, Wire};
use twin_drives::interpcnc::{
    AxisOptions, InterpCncDrive, InterpCncOptions, InterpCncRehearsal, Line,
    registers::{BoardAxis, MAX_SPEED_HZ},
};
use twin_drives::{Drive, DriveError, EmulatorError, Rehearsal};

/// How long an emulated board may take to answer. The kernel passes the bytes of a pseudo-terminal on when nothing
/// more urgent is to be done, which on a busy computer can be a while; a wire does not wait.
const EMULATED_DEADLINE: Duration = Duration::from_secs(2);

/// A drive that lags may go this much faster than its axis's largest velocity.
const CATCH_UP: f64 = 1.2;

/// Why no emulated drive can be had.
#[derive(Debug, thiserror::Error)]
pub enum ConnectError {
    /// The emulator.
    #[error("the drive cannot be emulated: {0}")]
    Emulator(#[from] EmulatorError),
    /// The driver.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// The machine file has no such device.
    #[error("the machine file names no drive for its axes")]
    NoDevice,
}

/// Powers up an emulated board on a pseudo-terminal and opens it with the driver.
///
/// # Errors
/// [`ConnectError`].
pub fn connect(machine: &Machine) -> Result<(EmulatedBoard, Box<dyn Drive>), ConnectError> {
    let device = machine.drives.first().ok_or(ConnectError::NoDevice)?;
    let clock = Clock::start();
    let board = EmulatedBoard::start(&emulator_options(device), move || clock.now_ns())?;
    let port = board.path().display().to_string();
    let options =
        InterpCncOptions { deadline: EMULATED_DEADLINE, ..driver_options(machine, (0, device)) };
    let drive = InterpCncDrive::open(&port, &options)?;
    Ok((board, Box::new(drive)))
}

/// What driver and device make of a plan on the wire that `device` (with its place in the file) describes, in simulated
/// time.
pub(crate) fn rehearsal(machine: &Machine, device: (usize, &DeviceEntry)) -> Box<dyn Rehearsal> {
    let options = driver_options(machine, device);
    Box::new(InterpCncRehearsal::new(&options.axes, &wire(device.1)))
}

/// The speed the board may go, steps/s: the axis's own with room to catch up, within what the board can do.
fn max_speed_hz(axis: &Axis) -> u32 {
    let speed = (axis.max_velocity * axis.increments_per_si()).abs() * CATCH_UP;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
    let speed = speed.clamp(1.0, f64::from(MAX_SPEED_HZ)) as u32;
    speed
}

/// The board that `device` describes.
pub fn emulator_options(device: &DeviceEntry) -> EmulatorOptions {
    let line = line(device);
    EmulatorOptions {
        board: BoardOptions { station: device.station, line, ..BoardOptions::default() },
        wire: wire(device),
        link: None,
    }
}

/// How the driver is to speak to `device`, with its place in the file, which moves axes of `machine`.
fn driver_options(machine: &Machine, (index, device): (usize, &DeviceEntry)) -> InterpCncOptions {
    let axes = machine.axes_of(index).filter_map(|(_, axis)| {
        let board_axis = BoardAxis::ALL.get(axis.drive.as_ref()?.index)?;
        Some(AxisOptions {
            start_stop_hz: device.start_stop_hz,
            acceleration_khz_per_s: device.acceleration_khz_per_s,
            deceleration_khz_per_s: device.acceleration_khz_per_s,
            max_speed_hz: max_speed_hz(axis),
            ..AxisOptions::new(*board_axis)
        })
    });
    InterpCncOptions {
        station: device.station,
        line: line(device),
        ..InterpCncOptions::new(axes.collect())
    }
}

fn wire(device: &DeviceEntry) -> Wire {
    Wire { line: line(device), turnaround: Duration::from_micros(device.turnaround_us.into()) }
}

fn line(device: &DeviceEntry) -> Line {
    use twin_drives::interpcnc::Parity as WireParity;
    let parity = match device.parity {
        Parity::None => WireParity::None,
        Parity::Even => WireParity::Even,
        Parity::Odd => WireParity::Odd,
    };
    Line { baud: device.baud, parity }
}
