//! `twin drive smartdrive`.

mod axis;
mod motion;
mod parameters;
mod show;

use super::action::{Action, Command};
use super::by_switch::BySwitch;
use super::family::{Family, Nothing, Travel};
use super::session::{Session, Stopping, no_clock};
use super::words;
use crate::command::{Failure, Status};
use crate::troubleshooting;
pub(super) use axis::Axis;
use axis::Unit;
use comfy_table::Cell;
use parameters::Found;
use std::ops::RangeInclusive;
use std::time::Duration;
use twin_drives::{Drive, DriveError, ParameterId};
use twin_smartdrive::protocol::parameters::{ACCELERATION_MAX, FULL_STEPS, STEP_DIVISOR};
use twin_smartdrive::{
    ADDRESSES, AxisOptions, IoUpdate, Mode, SmartDrive, SmartDriveBus, SmartDriveOptions,
    StepsPerTurn,
};

#[derive(Debug, clap::Args)]
pub(super) struct LineOptions {
    /// Serial port, like /dev/ttyUSB0, or the link of `twin emulate smartdrive`
    #[arg(long, value_name = "PATH")]
    port: String,

    /// Address of the drive on the bus, elsewhere called station
    #[arg(long, visible_alias = "station", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=31))]
    address: u8,

    /// Longest time an answer may take beyond its bytes, ms
    #[arg(long, value_name = "MS", default_value = "100", value_parser = words::milliseconds)]
    deadline: Duration,
}

#[derive(Debug, clap::Args)]
pub(super) struct Scan {
    /// Addresses to ask, FIRST-LAST within 1-31
    #[arg(long, visible_alias = "stations", default_value = "1-31", value_parser = addresses)]
    addresses: RangeInclusive<u8>,
}

#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Home {
    /// Longest time it may take, s
    #[arg(long, default_value_t = 60, value_name = "S", value_parser = clap::value_parser!(u64).range(1..=3600))]
    timeout: u64,
}

/// Ceilings of a move; without them the drive's own.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct Ramps {
    /// Speed, rpm [default: the drive's largest, `Trj_VelMax`]
    #[arg(long, value_name = "RPM", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=32_767))]
    speed: Option<u16>,

    /// Acceleration, rpm/s [default: the drive's largest, `Trj_AccMax`]
    #[arg(long, value_name = "RPM/S", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=32_767))]
    acceleration: Option<u16>,
}

#[derive(Debug, clap::Args)]
pub(super) struct Outputs {
    /// Outputs to switch: RDY, BRK or LED, like LED=on
    #[arg(value_name = "NAME=on|off", value_parser = words::switch)]
    switches: Vec<(String, bool)>,
}

fn addresses(text: &str) -> Result<RangeInclusive<u8>, String> {
    words::addresses(text, ADDRESSES)
}

/// Settings of the driver for a drive with these µsteps per turn and this largest speed.
fn options(
    command: &Command<Axis>,
    turn: StepsPerTurn,
    velocity_rpm: u16,
) -> Result<SmartDriveOptions, Failure> {
    let line = &command.line;
    let homing = match &command.action {
        Action::Home { home, .. } => Duration::from_secs(home.timeout),
        _ => Duration::from_mins(1),
    };
    let axis = AxisOptions {
        address: line.address,
        turn,
        velocity_rpm,
        acceleration_rpm_per_s: 1,
        deceleration_rpm_per_s: 0,
    };
    Ok(SmartDriveOptions {
        assumptions: command.assume.take()?,
        deadline: line.deadline,
        turnaround: Duration::ZERO,
        worst_latency: line.deadline,
        mode_change: Duration::from_secs(2).max(10 * line.deadline),
        homing,
        ..SmartDriveOptions::new(vec![axis])
    })
}

/// Settings of the driver where speed and turn, which only following uses, do not matter.
fn any_options(command: &Command<Axis>) -> Result<SmartDriveOptions, Failure> {
    let turn = StepsPerTurn::new(200, 16)
        .ok_or_else(|| Failure::Usage("200 steps of 16 µsteps are not a turn".to_owned()))?;
    options(command, turn, 1)
}

impl Family for Axis {
    type Line = LineOptions;
    type Scan = Scan;
    type Unlock = Nothing;
    type Home = Home;
    type Axis = Nothing;
    type Ramps = Ramps;
    type Outputs = Outputs;
    /// Speed, rpm, and acceleration, rpm/s.
    type Profile = (u16, u16);
    type Parameter = Found;

    const UNIT: &'static str = "µsteps";
    const NO_RESET: Option<&'static str> =
        Some("a SmartDRIVE needs no restart: parameters act when they are set");
    const COLUMNS: &'static [&'static str] =
        &["number", "name", "value", "saved", "factory", "unit"];

    fn open(command: &Command<Self>) -> Result<Self, Failure> {
        let (options, line) = (any_options(command)?, &command.line);
        let session = Session::start()?;
        let bus = session.inside(|| SmartDrive::open(&line.port, &options))?;
        let unit = Unit { bus, port: line.port.as_str().into(), address: line.address };
        Ok(Self { session, unit, consent: command.consent() })
    }

    fn drive(command: &Command<Self>, _: bool) -> Result<Box<dyn Drive>, Failure> {
        Ok(Box::new(SmartDriveBus::open(&command.line.port, &any_options(command)?)?))
    }

    fn scan(command: &Command<Self>, scan: &Scan) -> Result<Status, Failure> {
        let Self { session, mut unit, .. } = Self::open(command)?;
        let (mut found, mut garbled) = (Vec::new(), Vec::new());
        for address in scan.addresses.clone() {
            match session.ask(unit.bus.state(address, &no_clock)) {
                Ok((state, _)) => found.push((address, state, None)),
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
            stderr!("no address answers: {}", troubleshooting::NOBODY);
            return Ok(Status::Unfit);
        }
        if !found.is_empty() {
            show::status(&found)?;
        }
        Ok(Status::Fit)
    }

    /// Homes the drive as runs drive it, with what its parameters say of turns and ramps.
    fn home_by_switch(
        command: &Command<Self>,
        _: &Home,
        by_switch: &BySwitch,
    ) -> Result<(), Failure> {
        let (port, address) = (&command.line.port, command.line.address);
        let mut drive = SmartDriveBus::open(port, &any_options(command)?)?;
        let mut value = |number| {
            let id = ParameterId { address, number };
            drive.parameter(id).map(|value| u16::try_from(value).unwrap_or(0))
        };
        let [full_steps, divisor] = [value(FULL_STEPS)?, value(STEP_DIVISOR)?];
        let rate = value(ACCELERATION_MAX)?;
        drop(drive);
        let turn = StepsPerTurn::new(full_steps, divisor).ok_or_else(|| {
            Failure::Usage(format!("{full_steps} steps of {divisor} µsteps are not a turn"))
        })?;
        let rpm = turn.rpm(by_switch.fastest()).ceil().clamp(1.0, 32_767.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let mut options = options(command, turn, rpm as u16)?;
        for axis in &mut options.axes {
            axis.acceleration_rpm_per_s = rate.max(1);
        }
        let mut drive = SmartDriveBus::open(port, &options)?;
        let name = format!("drive {address}");
        let (named, consent) = ((name.as_str(), Self::UNIT), command.consent());
        by_switch.carry_out_at_zero(&mut drive, named, consent, |drive| drive.zero_here(0))
    }

    fn status(&mut self) -> Result<(), Failure> {
        let Self { session, unit, .. } = self;
        let state = session.ask(unit.state())?;
        let address = unit.address;
        // While its mode changes a drive says nothing of its pins.
        let pins = session.ask(unit.bus.io(address, IoUpdate::default())).ok();
        show::status(&[(address, state, pins.map(|pins| pins.levels))])?;
        if let Some(next) = show::next(&state) {
            say!("next: {next}");
        }
        Ok(())
    }

    fn unlock(&mut self, _: &Nothing) -> Result<(), Failure> {
        let state = self.at_rest("unlock")?;
        if state.mode == Mode::Remote.number() && state.alarms.is_empty() {
            say!("obeys the bus already, at {}", state.position);
        } else {
            let Unit { bus, address, .. } = &mut self.unit;
            self.session.ask(bus.set_mode(*address, Some(Mode::Remote)))?;
            say!("obeys the bus, at 0");
        }
        Ok(())
    }

    fn home(&mut self, _: &Home) -> Result<(), Failure> {
        self.home_axis()
    }

    fn axis_name(_: &Nothing) -> String {
        "the axis".to_owned()
    }

    fn plan(
        &mut self,
        _: &Nothing,
        ramps: &Ramps,
        target: &dyn Fn(i32) -> Result<i32, Failure>,
    ) -> Result<Travel<(u16, u16)>, Failure> {
        self.plan_move(*ramps, target)
    }

    fn travel(&mut self, _: &Nothing, to: &Travel<(u16, u16)>) -> Result<(), Failure> {
        self.session.motion(&mut self.unit, async |unit| {
            let profile = Some(to.profile);
            unit.bus.travel(unit.address, to.target, profile, to.patience).await
        })
    }

    fn stop(&mut self, now: bool) -> Result<String, Failure> {
        if now {
            self.session.ask(self.unit.hard_stop())?;
            return Ok("off".to_owned());
        }
        self.session.ask(self.unit.soft_stop())?;
        let state = self.session.ask(self.unit.state())?;
        Ok(format!("at rest at {}", state.position))
    }

    fn find(text: &str) -> Result<Found, Failure> {
        parameters::find(text)
    }

    fn parameters() -> Vec<Found> {
        parameters::all()
    }

    fn row(&mut self, found: &Found) -> Result<Vec<Cell>, Failure> {
        parameters::row(&self.session, &mut self.unit, *found)
    }

    fn set(&mut self, found: &Found, value: &str) -> Result<(), Failure> {
        self.set_parameter(*found, value)
    }

    fn save(&mut self) -> Result<(), Failure> {
        self.at_rest("save")?;
        let Unit { bus, address, .. } = &mut self.unit;
        self.session.ask(bus.save(*address))?;
        say!("saved; the position is 0");
        Ok(())
    }

    fn inputs(&mut self) -> Result<(), Failure> {
        show::inputs(&self.session, &mut self.unit)
    }

    fn outputs(&mut self, outputs: &Outputs) -> Result<(), Failure> {
        show::outputs(&self.session, &mut self.unit, &outputs.switches)
    }
}
