//! `twin drive smartdrive`.

mod axis;
mod motion;
mod parameters;
mod show;

use super::by_switch::BySwitch;
use super::consent::{Beforehand, Consent};
use super::on_file::OnFile;
use super::session::{Session, Stopping, no_clock};
use super::words;
use crate::advice;
use crate::command::assume::Assume;
use crate::command::{Failure, Status};
use axis::Axis;
use motion::{home, standing, travel};
use parameters::{get, set};
use show::{inputs, next, outputs, status};
use std::ops::RangeInclusive;
use std::time::Duration;
use twin_drives::smartdrive::parameters::{ACCELERATION_MAX, FULL_STEPS, STEP_DIVISOR};
use twin_drives::smartdrive::{
    ADDRESSES, AxisOptions, IoUpdate, Mode, SmartDrive, SmartDriveBus, SmartDriveOptions,
    StepsPerTurn,
};
use twin_drives::{Drive, DriveError, ParameterId};

/// SmartDRIVE v1.2: up to 31 step motor drives on one RS485 bus, protocol ATB; positions in µsteps, speeds in rpm
///
/// For instance, with `twin emulate smartdrive --link /tmp/bus` in another window:
///   twin drive smartdrive --port /tmp/bus scan
///   twin drive smartdrive --port /tmp/bus unlock
///   twin drive smartdrive --port /tmp/bus jog 3200 --speed 60
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct Arguments {
    /// Serial port, like /dev/ttyUSB0, or the link of `twin emulate smartdrive`
    #[arg(long, value_name = "PATH")]
    port: String,

    /// Address of the drive on the bus, elsewhere called station
    #[arg(long, visible_alias = "station", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=31))]
    address: u8,

    /// Longest time an answer may take, ms
    #[arg(long, value_name = "MS", default_value = "100", value_parser = words::milliseconds)]
    deadline: Duration,

    #[command(flatten)]
    consent: Beforehand,

    #[command(flatten)]
    assume: Assume,

    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Ask which addresses answer; changes nothing
    Scan {
        /// Addresses to ask, FIRST-LAST within 1-31
        #[arg(long, visible_alias = "stations", default_value = "1-31", value_parser = addresses)]
        addresses: RangeInclusive<u8>,
    },
    /// Show mode, position and alarms; changes nothing
    Status,
    /// Make the drive obey the bus (mode 3): its motor gets current, its position becomes 0 and alarms are cleared
    ///
    /// Nothing moves. A drive that is in mode 3 already keeps its position.
    Unlock,
    /// Let the axis search its home switch, as the drive's parameters say (asks first)
    Home {
        /// Longest time it may take, s
        #[arg(long, default_value_t = 60, value_name = "S", value_parser = clap::value_parser!(u64).range(1..=3600))]
        timeout: u64,

        #[command(flatten)]
        by_switch: BySwitch,

        #[command(flatten)]
        consent: Consent,
    },
    #[command(flatten)]
    OnFile(OnFile),
    /// Move by a distance, µsteps (asks first)
    Jog {
        /// µsteps; below 0: backwards
        #[arg(allow_negative_numbers = true, value_name = "USTEPS")]
        distance: i32,

        #[command(flatten)]
        ramps: Ramps,

        #[command(flatten)]
        consent: Consent,
    },
    /// Move to a position, µsteps (asks first)
    Move {
        /// Where to, µsteps
        #[arg(allow_negative_numbers = true, value_name = "USTEPS")]
        position: i32,

        #[command(flatten)]
        ramps: Ramps,

        #[command(flatten)]
        consent: Consent,
    },
    /// Bring the axis to rest on its ramp
    Stop {
        /// Switch the motor off at once (mode 0) instead: a load may run on or fall
        #[arg(long)]
        now: bool,
    },
    /// Show a parameter or variable, or all of them
    Get {
        /// Name of a parameter or variable, or number of a parameter
        parameter: Option<String>,
    },
    /// Change the working value of a parameter, at rest, or a variable; `save` keeps parameters over a restart
    Set {
        /// Name of a parameter or variable, or number of a parameter
        parameter: String,

        /// New value, decimal or 0x1F; currents (Cur_...) are 32768ths
        #[arg(allow_negative_numbers = true)]
        value: String,
    },
    /// Write all working values of parameters to the drive's flash; its position becomes 0
    Save,
    /// Show inputs and the edges they have caught
    Inputs,
    /// Show outputs, after switching some
    Outputs {
        /// Outputs to switch: RDY, BRK or LED, like LED=on
        #[arg(value_name = "NAME=on|off", value_parser = words::switch)]
        switches: Vec<(String, bool)>,
    },
}

/// Ceilings of a move; without them the drive's own.
#[derive(Clone, Copy, Debug, clap::Args)]
struct Ramps {
    /// Speed, rpm [default: the drive's largest, `Trj_VelMax`]
    #[arg(long, value_name = "RPM", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=32_767))]
    speed: Option<u16>,

    /// Acceleration, rpm/s [default: the drive's largest, `Trj_AccMax`]
    #[arg(long, value_name = "RPM/S", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=32_767))]
    acceleration: Option<u16>,
}

fn addresses(text: &str) -> Result<RangeInclusive<u8>, String> {
    words::addresses(text, ADDRESSES)
}

impl Arguments {
    /// Whether what the action asks about may be done.
    fn consent(&self) -> Consent {
        self.consent.or(match &self.action {
            Action::Home { consent, .. }
            | Action::Jog { consent, .. }
            | Action::Move { consent, .. } => Some(*consent),
            Action::OnFile(on_file) => on_file.consent(),
            _ => None,
        })
    }

    /// Of a drive whose turn has so many µsteps, and which goes at most so fast.
    fn options(&self, turn: StepsPerTurn, velocity_rpm: u16) -> Result<SmartDriveOptions, Failure> {
        let homing = match &self.action {
            Action::Home { timeout, .. } => Duration::from_secs(*timeout),
            _ => Duration::from_mins(1),
        };
        let axis = AxisOptions {
            address: self.address,
            turn,
            velocity_rpm,
            acceleration_rpm_per_s: 1,
            deceleration_rpm_per_s: 0,
        };
        Ok(SmartDriveOptions {
            assumptions: self.assume.take()?,
            deadline: self.deadline,
            worst_latency: self.deadline,
            mode_change: Duration::from_secs(2).max(10 * self.deadline),
            homing,
            ..SmartDriveOptions::new(vec![axis])
        })
    }

    /// Where ceilings and turn, which are those of following, do not count.
    fn any_options(&self) -> Result<SmartDriveOptions, Failure> {
        let turn = StepsPerTurn::new(200, 16)
            .ok_or_else(|| Failure::Usage("200 steps of 16 µsteps are no turn".to_owned()))?;
        self.options(turn, 1)
    }

    fn open(&self, session: &Session) -> Result<Axis, Failure> {
        let options = self.any_options()?;
        let bus = session.inside(|| SmartDrive::open(&self.port, &options))?;
        Ok(Axis { bus, port: self.port.as_str().into(), address: self.address })
    }

    /// Homes the drive as runs drive it, with what its parameters say of turns and ramps.
    fn home_by_switch(&self, by_switch: &BySwitch) -> Result<(), Failure> {
        let mut drive = SmartDriveBus::open(&self.port, &self.any_options()?)?;
        let mut value = |number| {
            let id = ParameterId { station: self.address, number };
            drive.parameter(id).map(|value| u16::try_from(value).unwrap_or(0))
        };
        let steps = [value(FULL_STEPS)?, value(STEP_DIVISOR)?];
        let rate = value(ACCELERATION_MAX)?;
        drop(drive);
        let [full_steps, divisor] = steps;
        let turn = StepsPerTurn::new(full_steps, divisor).ok_or_else(|| {
            Failure::Usage(format!("{full_steps} steps of {divisor} µsteps are no turn"))
        })?;
        let rpm = turn.rpm(by_switch.fastest()).ceil().clamp(1.0, 32_767.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let mut options = self.options(turn, rpm as u16)?;
        for axis in &mut options.axes {
            axis.acceleration_rpm_per_s = rate.max(1);
        }
        let mut drive = SmartDriveBus::open(&self.port, &options)?;
        let name = format!("drive {}", self.address);
        let named = (name.as_str(), "µsteps");
        by_switch.carry_out_at_zero(&mut drive, named, self.consent(), |drive| drive.zero_here(0))
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let session = Session::start()?;
    match &arguments.action {
        Action::OnFile(on_file) => {
            let mut drive = SmartDriveBus::open(&arguments.port, &arguments.any_options()?)?;
            on_file.carry_out(&mut drive, arguments.consent())?;
            return Ok(Status::Fit);
        }
        Action::Home { by_switch, .. } if by_switch.is_wanted() => {
            arguments.home_by_switch(by_switch)?;
            return Ok(Status::Fit);
        }
        _ => {}
    }
    let mut axis = arguments.open(&session)?;
    let address = axis.address;
    match &arguments.action {
        Action::Scan { addresses } => {
            let (mut found, mut garbled) = (Vec::new(), Vec::new());
            for address in addresses.clone() {
                match session.ask(axis.bus.state(address, &no_clock)) {
                    Ok((state, _)) => found.push((address, state)),
                    Err(Failure::Drive(DriveError::Timeout { .. })) => {}
                    Err(Failure::Drive(DriveError::Protocol { .. })) => garbled.push(address),
                    Err(other) => return Err(other),
                }
            }
            for address in &garbled {
                say!(
                    "address {address}: answers garble each other: two devices at this address? (Give each one of its own with only it \
                     on the line.) If all addresses do so, it is the line: its baud rate, its end, its cable"
                );
            }
            if found.is_empty() && garbled.is_empty() {
                tell!("no address answers: {}", advice::NOBODY);
                return Ok(Status::Unfit);
            }
            let found = found.into_iter().map(|(address, state)| (address, state, None));
            let found: Vec<_> = found.collect();
            if !found.is_empty() {
                status(&found)?;
            }
        }
        Action::Status => {
            let state = session.ask(axis.state())?;
            // While its mode changes a drive says nothing of its pins.
            let pins = session.ask(axis.bus.io(address, IoUpdate::default())).ok();
            status(&[(address, state, pins.map(|pins| pins.levels))])?;
            if let Some(next) = next(&state) {
                say!("next: {next}");
            }
        }
        Action::Unlock => {
            let state = standing(&session, &mut axis, "unlock")?;
            if state.mode == Mode::Remote.number() && state.alarms.is_empty() {
                say!("obeys the bus already, at {}", state.position);
            } else {
                session.ask(axis.bus.set_mode(address, Some(Mode::Remote)))?;
                say!("obeys the bus, at 0");
            }
        }
        Action::OnFile(_) => {}
        Action::Home { .. } => home(&session, &mut axis, arguments.consent())?,
        Action::Jog { distance, ramps, .. } => {
            let from = session.ask(axis.state())?.position;
            let target = from.checked_add(*distance).ok_or_else(|| {
                Failure::Usage(format!("from {from} it cannot go {distance} µsteps further"))
            })?;
            travel(&session, &mut axis, arguments.consent(), target, *ramps)?;
        }
        Action::Move { position, ramps, .. } => {
            travel(&session, &mut axis, arguments.consent(), *position, *ramps)?;
        }
        Action::Stop { now: true } => {
            session.ask(axis.hard_stop())?;
            say!("off");
        }
        Action::Stop { now: false } => {
            session.ask(axis.soft_stop())?;
            let state = session.ask(axis.state())?;
            say!("at rest at {}", state.position);
        }
        Action::Get { parameter } => get(&session, &mut axis, parameter.as_deref())?,
        Action::Set { parameter, value } => set(&session, &mut axis, parameter, value)?,
        Action::Save => {
            standing(&session, &mut axis, "save")?;
            session.ask(axis.bus.save(address))?;
            say!("saved; the position is 0");
        }
        Action::Inputs => inputs(&session, &mut axis)?,
        Action::Outputs { switches } => outputs(&session, &mut axis, switches)?,
    }
    Ok(Status::Fit)
}
