//! Emulators of the drives a machine file names, in this process, with the real driver connected to them.

use crate::clock::Clock;
use crate::machine::{
    Axis, Bim2AxEntry, DeviceEntry, DriveFamily, InterpCncEntry, Machine, Parity, SmartDriveEntry,
};
use std::time::Duration;
use twin_drives::bim2ax::{AxisSettings, Bim2AxRehearsal, RehearsalOptions};
use twin_drives::interpcnc::emulator::{BoardOptions, EmulatedBoard, EmulatorOptions, Wire};
use twin_drives::interpcnc::{
    AxisOptions, InterpCncDrive, InterpCncOptions, InterpCncRehearsal, Line,
    registers::{BoardAxis, MAX_SPEED_HZ},
};
use twin_drives::smartdrive::{self, BusDelays, SmartDriveRehearsal};
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
    /// A run has one device.
    #[error(
        "the machine file names {devices} drives; runs have one so far: --drives none runs without, --drives-in-loop with \
         their profile generators"
    )]
    Several {
        /// How many.
        devices: usize,
    },
    /// There is no emulator for the device.
    #[error(
        "drive {name}: {family} cannot be emulated in runs yet: --drives none runs without, --drives-in-loop with its \
         profile generators"
    )]
    NotEmulated {
        /// Its name.
        name: String,
        /// Its family.
        family: &'static str,
    },
}

/// Powers up an emulated board on a pseudo-terminal and opens it with the driver.
///
/// # Errors
/// [`ConnectError`].
pub fn connect(machine: &Machine) -> Result<(EmulatedBoard, Box<dyn Drive>), ConnectError> {
    let [device] = &machine.drives[..] else {
        return Err(match machine.drives.len() {
            0 => ConnectError::NoDevice,
            devices => ConnectError::Several { devices },
        });
    };
    let DriveFamily::InterpCnc(entry) = &device.family else {
        let (name, family) = (device.name.clone(), device.family_name());
        return Err(ConnectError::NotEmulated { name, family });
    };
    let clock = Clock::start();
    let board = EmulatedBoard::start(&emulator_options(entry), move || clock.now_ns())?;
    let port = board.path().display().to_string();
    let options =
        InterpCncOptions { deadline: EMULATED_DEADLINE, ..driver_options(machine, (0, entry)) };
    let drive = InterpCncDrive::open(&port, &options)?;
    Ok((board, Box::new(drive)))
}

/// What driver and device make of a plan on the wire that `device` (with its place in the file) describes, in simulated
/// time.
pub(crate) fn rehearsal(
    machine: &Machine,
    (index, device): (usize, &DeviceEntry),
) -> Box<dyn Rehearsal> {
    match &device.family {
        DriveFamily::InterpCnc(entry) => {
            let options = driver_options(machine, (index, entry));
            Box::new(InterpCncRehearsal::new(&options.axes, &wire(entry)))
        }
        DriveFamily::SmartDrive(entry) => {
            let axes: Vec<_> =
                machine.axes_of(index).map(|(_, axis)| smartdrive_axis(axis, entry)).collect();
            let response = Duration::from_micros(entry.response_us.into());
            let delays = BusDelays { response, ..BusDelays::default() };
            Box::new(SmartDriveRehearsal::new(&axes, delays))
        }
        DriveFamily::Bim2Ax(entry) => {
            let axes = machine.axes_of(index).map(|(_, axis)| bim2ax_axis(axis, entry)).collect();
            let order_ns = i64::from(entry.order_us) * 1000;
            let options = RehearsalOptions { order_ns, ..RehearsalOptions::new(axes) };
            Box::new(Bim2AxRehearsal::new(&options))
        }
    }
}

/// The largest speed that a drive may make of an axis: the axis's own with room to catch up, increments/s.
fn most_increments_per_s(axis: &Axis) -> f64 {
    (axis.max_velocity * axis.increments_per_si()).abs() * CATCH_UP
}

/// A number from 1 to `most`, upwards.
fn counted(value: f64, most: u32) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
    let value = value.ceil().clamp(1.0, f64::from(most)) as u32;
    value
}

/// The same in 16 bits.
fn narrow(value: f64, most: u16) -> u16 {
    u16::try_from(counted(value, most.into())).unwrap_or(most)
}

/// What a drive on a bus is driven with.
fn smartdrive_axis(axis: &Axis, entry: &SmartDriveEntry) -> smartdrive::AxisOptions {
    let address = axis.drive.as_ref().map_or(0, |drive| drive.index);
    smartdrive::AxisOptions {
        address: u8::try_from(address).unwrap_or(0),
        turn: entry.turn,
        velocity_rpm: narrow(entry.turn.rpm(most_increments_per_s(axis)), 32_767),
        acceleration_rpm_per_s: entry.acceleration_rpm_per_s,
        deceleration_rpm_per_s: entry.deceleration_rpm_per_s,
    }
}

/// The parameters of an axis of a module.
fn bim2ax_axis(axis: &Axis, entry: &Bim2AxEntry) -> AxisSettings {
    let fastest = most_increments_per_s(axis) / entry.mode.speed_unit();
    AxisSettings {
        mode: entry.mode,
        fast_speed: narrow(fastest, u16::MAX),
        start_stop_speed: entry.start_stop_speed,
        acceleration: entry.acceleration,
        ..AxisSettings::default()
    }
}

/// The board that `entry` describes.
pub fn emulator_options(entry: &InterpCncEntry) -> EmulatorOptions {
    let line = line(entry);
    EmulatorOptions {
        board: BoardOptions { station: entry.station, line, ..BoardOptions::default() },
        wire: wire(entry),
        link: None,
    }
}

/// How the driver is to speak to a board, with its place in the file, which moves axes of `machine`.
fn driver_options(machine: &Machine, (index, entry): (usize, &InterpCncEntry)) -> InterpCncOptions {
    let axes = machine.axes_of(index).filter_map(|(_, axis)| {
        let board_axis = BoardAxis::ALL.get(axis.drive.as_ref()?.index)?;
        Some(AxisOptions {
            start_stop_hz: entry.start_stop_hz,
            acceleration_khz_per_s: entry.acceleration_khz_per_s,
            deceleration_khz_per_s: entry.acceleration_khz_per_s,
            max_speed_hz: counted(most_increments_per_s(axis).floor(), MAX_SPEED_HZ),
            ..AxisOptions::new(*board_axis)
        })
    });
    InterpCncOptions {
        station: entry.station,
        line: line(entry),
        ..InterpCncOptions::new(axes.collect())
    }
}

fn wire(entry: &InterpCncEntry) -> Wire {
    Wire { line: line(entry), turnaround: Duration::from_micros(entry.turnaround_us.into()) }
}

fn line(entry: &InterpCncEntry) -> Line {
    use twin_drives::interpcnc::Parity as WireParity;
    let parity = match entry.parity {
        Parity::None => WireParity::None,
        Parity::Even => WireParity::Even,
        Parity::Odd => WireParity::Odd,
    };
    Line { baud: entry.baud, parity }
}
