//! Emulators of the drives a machine file names, in this process, with the real driver connected to them.

use crate::attached::Attached;
use crate::clock::Clock;
use std::time::Duration;
use twin_bim2ax as bim2ax;
use twin_bim2ax::emulator::{Eeprom, Module, ModuleOptions, Surroundings};
use twin_bim2ax::{
    AxisSettings, Bim2AxDrive, Bim2AxDriveOptions, Bim2AxOptions, Bim2AxPrediction, MOST_POSITION,
    PredictionOptions, SharedModule,
};
use twin_drives::{Drive, DriveError, EmulatorError, Prediction};
use twin_interpcnc as interpcnc;
use twin_interpcnc::emulator::{
    Bench, BoardOptions, EmulatedBoard, EmulatorOptions, EncoderLink, Wire,
};
use twin_interpcnc::{
    AxisOptions, EncoderOptions, Following, InterpCncDrive, InterpCncOptions, Line,
    protocol::registers::{BoardAxis, MAX_SPEED_HZ},
};
use twin_machine::{
    Axis, Bim2AxEntry, DeviceEntry, DriveFamily, InterpCncEntry, Machine, Parity, SmartDriveEntry,
};
use twin_smartdrive as smartdrive;
use twin_smartdrive::emulator::EmulatedBus;
use twin_smartdrive::{
    BusDelays, SmartDriveBus, SmartDriveOptions, SmartDrivePrediction, protocol::parameters,
};

/// How long an emulated board may take to answer. The kernel passes the bytes of a pseudo-terminal on when nothing
/// more urgent is to be done, which on a busy computer can be a while; a wire does not wait.
const EMULATED_DEADLINE: Duration = Duration::from_secs(2);

/// A board may take so long to store a parameter.
const LONGEST_STORING: Duration = Duration::from_secs(10);

/// A drive that lags may go this much faster than its axis's largest velocity.
pub(crate) const CATCH_UP: f64 = 1.2;

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

/// An emulated device.
#[derive(Debug)]
pub enum Emulator {
    /// A board on a pseudo-terminal.
    InterpCnc(EmulatedBoard),
    /// Drives on a pseudo-terminal.
    SmartDrive(EmulatedBus),
    /// A module in the memory of this process.
    Bim2Ax(SharedModule),
}

impl Emulator {
    /// Where it is to be found.
    pub fn place(&self) -> String {
        match self {
            Self::InterpCnc(board) => board.path().display().to_string(),
            Self::SmartDrive(bus) => bus.path().display().to_string(),
            Self::Bim2Ax(_) => "memory of this process".to_owned(),
        }
    }
}

/// Powers up an emulator for each device on which axes hang, and opens it with its driver.
///
/// # Errors
/// [`ConnectError`].
pub fn connect(machine: &Machine) -> Result<Vec<(Emulator, Attached)>, ConnectError> {
    let driven = machine.drives.iter().enumerate();
    let driven = driven.filter(|(index, _)| machine.axes_of(*index).next().is_some());
    let connected = driven
        .map(|(device, entry)| {
            let (emulator, drive) = match &entry.family {
                DriveFamily::InterpCnc(board) => self::board(machine, (device, board))?,
                DriveFamily::SmartDrive(bus) => smartdrive(machine, (device, bus))?,
                DriveFamily::Bim2Ax(module) => bim2ax(machine, (device, module))?,
            };
            Ok((emulator, Attached { device, drive }))
        })
        .collect::<Result<Vec<_>, ConnectError>>()?;
    if connected.is_empty() { Err(ConnectError::NoDevice) } else { Ok(connected) }
}

type Opened = Result<(Emulator, Box<dyn Drive>), ConnectError>;

fn board(machine: &Machine, (device, entry): (usize, &InterpCncEntry)) -> Opened {
    let clock = Clock::start();
    let board = EmulatedBoard::start(&emulator_options(entry), move || clock.now_ns())?;
    let port = board.path().display().to_string();
    let options = InterpCncOptions {
        deadline: EMULATED_DEADLINE,
        ..driver_options(machine, (device, entry))
    };
    let mut drive = InterpCncDrive::open(&port, &options)?;
    if let Following::Buffered { start_stop_hz, acceleration_khz_per_s } = options.following {
        // The ramps of segments are parameters, which a real board has been given.
        let assumed = options.assumptions;
        for (number, value) in [
            (assumed.segment_acceleration, acceleration_khz_per_s),
            (assumed.segment_start_stop, start_stop_hz),
        ] {
            let (board, runtime) = drive.board();
            let set = board.set_parameter(number, value.into(), LONGEST_STORING, &|| 0);
            runtime.block_on(set)?;
        }
    }
    Ok((Emulator::InterpCnc(board), Box::new(drive)))
}

fn smartdrive(machine: &Machine, (device, entry): (usize, &SmartDriveEntry)) -> Opened {
    let clock = Clock::start();
    let axes: Vec<_> =
        machine.axes_of(device).map(|(_, axis)| smartdrive_axis(axis, entry)).collect();
    let devices = axes.iter().map(|axis| smartdrive::emulator::DeviceOptions {
        address: axis.address,
        assumptions: entry.assumptions,
        ..smartdrive::emulator::DeviceOptions::default()
    });
    let response = Duration::from_micros(entry.response_us.into());
    let options = smartdrive::emulator::EmulatorOptions {
        devices: devices.collect(),
        wire: smartdrive::emulator::Wire { response, ..smartdrive::emulator::Wire::default() },
        ..smartdrive::emulator::EmulatorOptions::default()
    };
    let emulator = EmulatedBus::start(&options, move || clock.now_ns())?;
    let port = emulator.path().display().to_string();
    let options = SmartDriveOptions {
        deadline: EMULATED_DEADLINE,
        assumptions: entry.assumptions,
        ..SmartDriveOptions::new(axes.clone())
    };
    let mut bus = SmartDriveBus::open(&port, &options)?;
    // Emulated drives come from the factory: they get the parameters that real ones have been given.
    bus.run(async |bus| {
        for (axis, (_, described)) in axes.iter().zip(machine.axes_of(device)) {
            let [lowest, highest] = software_limits(described, [0; 2]);
            let deceleration = axis.deceleration_rpm_per_s.max(axis.acceleration_rpm_per_s);
            for (parameter, value) in [
                (parameters::FULL_STEPS, i64::from(entry.full_steps)),
                (parameters::STEP_DIVISOR, entry.microsteps.into()),
                (parameters::VELOCITY_MAX, axis.velocity_rpm.into()),
                (parameters::ACCELERATION_MAX, axis.acceleration_rpm_per_s.into()),
                (parameters::DECELERATION_MAX, deceleration.into()),
                (parameters::POSITION_MIN, lowest.into()),
                (parameters::POSITION_MAX, highest.into()),
            ] {
                bus.set_parameter(axis.address, parameter, value).await?;
            }
        }
        Ok::<_, DriveError>(())
    })?;
    Ok((Emulator::SmartDrive(emulator), Box::new(bus)))
}

fn bim2ax(machine: &Machine, (device, entry): (usize, &Bim2AxEntry)) -> Opened {
    use bim2ax::protocol::parameter::{AxisParameter, Parameter};
    let assumptions = entry.assumptions;
    let options = ModuleOptions { assumptions, ..ModuleOptions::default() };
    let mut eeprom = Eeprom::new(options.rating_ma);
    let mut surroundings = Surroundings::default();
    let mut axes = Vec::new();
    for (_, axis) in machine.axes_of(device) {
        let index = axis.drive.as_ref().map_or(0, |drive| drive.index);
        let Some(on_module) = bim2ax::ModuleAxis::ALL.get(index).copied() else { continue };
        let settings = bim2ax_axis(axis, entry);
        for (parameter, value) in [
            (AxisParameter::Coefficient, settings.coefficient.into()),
            (AxisParameter::Mode, settings.mode.code().into()),
            (AxisParameter::FastSpeed, settings.fast_speed.into()),
            (AxisParameter::StartStopSpeed, settings.start_stop_speed.into()),
            (AxisParameter::SoftPlus, settings.soft_plus.cast_unsigned()),
            (AxisParameter::SoftMinus, settings.soft_minus.cast_unsigned()),
            (AxisParameter::Acceleration, settings.acceleration.into()),
        ] {
            eeprom.set(Parameter::Axis(parameter, on_module), value);
        }
        if let Some(encoder) = entry.encoder.as_ref().filter(|said| said.axes.contains(&on_module))
        {
            for (parameter, value) in [
                (AxisParameter::Dividend, encoder.increments_per_turn),
                (AxisParameter::Divisor, encoder.points_per_turn),
                (AxisParameter::EncoderDefinition, bim2ax::protocol::bits::definition::PRESENT),
            ] {
                eeprom.set(Parameter::Axis(parameter, on_module), value.into());
            }
            if let Some(slot) = surroundings.encoders.get_mut(on_module.index()) {
                *slot = Some(bim2ax::EncoderBench {
                    points_per_turn: encoder.points_per_turn.into(),
                    microsteps_per_turn: encoder.increments_per_turn.into(),
                    ..bim2ax::EncoderBench::default()
                });
            }
        }
        axes.push(on_module);
    }
    let clock = Clock::start();
    let module = Module::new(&options, &eeprom, &surroundings);
    // It has been switched on before.
    let on_for_ns = options.boot_ns;
    let module = SharedModule::new(module, move || clock.now_ns() + on_for_ns);
    let driver = Bim2AxOptions { assumptions, ..Bim2AxOptions::default() };
    let options = Bim2AxDriveOptions { axes, driver, ..module_options(entry) };
    let drive = Bim2AxDrive::new("module", module.clone(), &options)?;
    Ok((Emulator::Bim2Ax(module), Box::new(drive)))
}

/// What the driver of a module is told of its encoders.
pub(crate) fn module_options(entry: &Bim2AxEntry) -> Bim2AxDriveOptions {
    let encoder = entry.encoder.as_ref();
    Bim2AxDriveOptions {
        encoder_axes: encoder.map_or_else(Vec::new, |encoder| encoder.axes.clone()),
        encoder_tolerance: encoder.and_then(|encoder| encoder.tolerance),
        ..Bim2AxDriveOptions::new()
    }
}

/// How long a round takes on the wire of a device (with its place in the file), in which each of its axes gets a command and
/// is seen.
pub(crate) fn round(machine: &Machine, (index, device): (usize, &DeviceEntry)) -> Duration {
    let rates = prediction(machine, (index, device)).rates();
    let axes = u32::try_from(machine.axes_of(index).count()).unwrap_or(u32::MAX);
    let seconds = (f64::from(axes) / rates.commands_per_s).max(1.0 / rates.samples_per_s);
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

/// What driver and device make of a plan on the wire that `device` (with its place in the file) describes, in simulated
/// time.
pub(crate) fn prediction(
    machine: &Machine,
    (index, device): (usize, &DeviceEntry),
) -> Box<dyn Prediction> {
    match &device.family {
        DriveFamily::InterpCnc(entry) => {
            let options = driver_options(machine, (index, entry));
            interpcnc::board_prediction(
                &options.axes,
                &wire(entry),
                options.following,
                options.encoder,
            )
        }
        DriveFamily::SmartDrive(entry) => {
            let axes: Vec<_> =
                machine.axes_of(index).map(|(_, axis)| smartdrive_axis(axis, entry)).collect();
            let response = Duration::from_micros(entry.response_us.into());
            let answers = entry.assumptions.answer_length;
            let delays = BusDelays { response, answers, ..BusDelays::default() };
            Box::new(SmartDrivePrediction::new(&axes, delays))
        }
        DriveFamily::Bim2Ax(entry) => {
            let axes = machine.axes_of(index).map(|(_, axis)| bim2ax_axis(axis, entry)).collect();
            let order_ns = i64::from(entry.order_us) * 1000;
            let mut options = PredictionOptions { order_ns, ..PredictionOptions::new(axes) };
            // A look at counters is followed by one at encoders.
            options.read_ns *= if entry.encoder.is_some() { 2 } else { 1 };
            Box::new(Bim2AxPrediction::new(&options))
        }
    }
}

/// The largest speed that a drive may make of an axis: the axis's own with room to catch up, increments/s.
fn most_increments_per_s(axis: &Axis) -> f64 {
    (axis.max_velocity * axis.increments_per_si()).abs() * CATCH_UP
}

/// The largest velocity of an axis, m/s or rad/s, that a drive which makes so many increments/s can follow.
pub(crate) fn velocity_within(axis: &Axis, increments_per_s: f64) -> f64 {
    increments_per_s / axis.increments_per_si().abs() / CATCH_UP
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

/// Software limits for a device, increments: an increment beyond those of the axis, where an axis may stand; those given for
/// an axis without.
pub(crate) fn software_limits(axis: &Axis, none: [i32; 2]) -> [i32; 2] {
    if !axis.limited {
        return none;
    }
    let Some(counting) = axis.counting() else { return none };
    let [one, other] = axis.position_limits.map(|limit| counting.increments(limit));
    #[expect(clippy::cast_possible_truncation, reason = "saturates, as counters end there")]
    let limits = [one.min(other).floor() as i32, one.max(other).ceil() as i32];
    let [lowest, highest] = limits;
    [lowest.saturating_sub(1), highest.saturating_add(1)]
}

/// What a drive on a bus is driven with.
pub(crate) fn smartdrive_axis(axis: &Axis, entry: &SmartDriveEntry) -> smartdrive::AxisOptions {
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
pub(crate) fn bim2ax_axis(axis: &Axis, entry: &Bim2AxEntry) -> AxisSettings {
    let fastest = most_increments_per_s(axis) / entry.mode.speed_unit();
    let [lowest, highest] = software_limits(axis, [-MOST_POSITION, MOST_POSITION])
        .map(|limit| limit.clamp(-MOST_POSITION, MOST_POSITION));
    AxisSettings {
        soft_minus: lowest,
        soft_plus: highest,
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
        board: BoardOptions {
            address: entry.address,
            line,
            assumptions: entry.assumptions,
            ..BoardOptions::default()
        },
        bench: Bench { encoder: entry.encoder.map(link), ..Bench::default() },
        wire: wire(entry),
        ..EmulatorOptions::default()
    }
}

/// The encoder as the axis turns it.
fn link(encoder: EncoderOptions) -> EncoderLink {
    let EncoderOptions { axis, points: counts, increments: steps, .. } = encoder;
    EncoderLink { axis, counts, steps, counts_per_revolution: 0 }
}

/// How the driver is to speak to a board, with its place in the file, which moves axes of `machine`.
pub(crate) fn driver_options(
    machine: &Machine,
    (index, entry): (usize, &InterpCncEntry),
) -> InterpCncOptions {
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
        address: entry.address,
        line: line(entry),
        following: entry.following,
        encoder: entry.encoder,
        assumptions: entry.assumptions,
        ..InterpCncOptions::new(axes.collect())
    }
}

fn wire(entry: &InterpCncEntry) -> Wire {
    Wire { line: line(entry), turnaround: Duration::from_micros(entry.turnaround_us.into()) }
}

/// The line of a board.
pub(crate) fn line(entry: &InterpCncEntry) -> Line {
    use twin_interpcnc::Parity as WireParity;
    let parity = match entry.parity {
        Parity::None => WireParity::None,
        Parity::Even => WireParity::Even,
        Parity::Odd => WireParity::Odd,
    };
    Line { baud: entry.baud, parity }
}
