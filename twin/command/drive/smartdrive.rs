//! `twin drive smartdrive`.

use super::by_switch::BySwitch;
use super::consent::Consent;
use super::on_file::OnFile;
use super::session::{BRAKING, Session, Stopping, no_clock};
use super::smartdrive_parameters::{get, set};
use super::words::{self, on_off, right};
use crate::command::show;
use crate::command::{Failure, Status};
use std::ops::RangeInclusive;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::{sleep, timeout};
use twin_drives::smartdrive::parameters::{self, FULL_STEPS, STEP_DIVISOR};
use twin_drives::smartdrive::{
    ADDRESSES, AxisOptions, Command, DriveState, IoUpdate, Mode, SmartDrive, SmartDriveBus,
    SmartDriveOptions, StepsPerTurn, TrajectoryFlags,
};
use twin_drives::{Action as Doing, Axes, Drive, DriveError, Exchange, ParameterId};

/// Time between two looks at a drive that moves.
const LOOK: Duration = Duration::from_millis(10);
/// Names of the pins, bit 0 first: three outputs, then the inputs.
const PINS: [&str; 8] = ["RDY", "BRK", "LED", "GO", "DIR", "OFF", "LIMP", "LIMN"];
/// How many of them are outputs.
const OUTPUTS: usize = 3;

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

    /// Address of the drive on the bus
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=31))]
    address: u8,

    /// Longest time an answer may take, ms
    #[arg(long, value_name = "MS", default_value = "100", value_parser = words::milliseconds)]
    deadline: Duration,

    #[command(flatten)]
    consent: Consent,

    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Ask which addresses answer; changes nothing
    Scan {
        /// Addresses to ask, FIRST-LAST within 1-31
        #[arg(long, default_value = "1-31", value_parser = addresses)]
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
    },
    /// Move to a position, µsteps (asks first)
    Move {
        /// Where to, µsteps
        #[arg(allow_negative_numbers = true, value_name = "USTEPS")]
        position: i32,

        #[command(flatten)]
        ramps: Ramps,
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
    /// Change the working value of a parameter, or a variable; `save` keeps parameters over a restart
    Set {
        /// Name of a parameter or variable, or number of a parameter
        parameter: String,

        /// New value, decimal or 0x1F
        #[arg(allow_negative_numbers = true, value_parser = words::value)]
        value: i64,
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
    #[arg(long, value_name = "RPM", value_parser = clap::value_parser!(u16).range(1..=32_767))]
    speed: Option<u16>,

    /// Acceleration, rpm/s [default: the drive's largest, `Trj_AccMax`]
    #[arg(long, value_name = "RPM/S", value_parser = clap::value_parser!(u16).range(1..=32_767))]
    acceleration: Option<u16>,
}

fn addresses(text: &str) -> Result<RangeInclusive<u8>, String> {
    words::stations(text, ADDRESSES)
}

/// One drive of a bus.
pub(super) struct Axis {
    pub(super) bus: SmartDrive,
    port: Arc<str>,
    pub(super) address: u8,
}

impl Axis {
    fn at(&self) -> Exchange {
        Exchange { port: Arc::clone(&self.port), station: self.address, action: Doing::ReadState }
    }

    async fn state(&mut self) -> Result<DriveState, DriveError> {
        self.bus.state(self.address, &no_clock).await.map(|(state, _)| state)
    }

    /// Waits until nothing moves.
    async fn rested(&mut self, patience: Duration) -> Result<DriveState, DriveError> {
        let resting = async {
            loop {
                let state = self.state().await?;
                if !state.moving() {
                    return Ok(state);
                }
                sleep(LOOK).await;
            }
        };
        let outcome = timeout(patience, resting).await;
        outcome.unwrap_or_else(|_| Err(DriveError::Unfinished { at: self.at(), patience }))
    }

    /// GOTO, and waits until the axis stands there.
    async fn go(
        &mut self,
        target: i32,
        profile: Option<(u16, u16)>,
        patience: Duration,
    ) -> Result<(), DriveError> {
        self.bus.go_to(self.address, target, profile).await?;
        let state = self.rested(patience).await?;
        if !state.alarms.is_empty() {
            return Err(DriveError::Alarm { at: self.at(), alarms: state.alarms });
        }
        if state.flags.contains(TrajectoryFlags::STALLED) {
            return Err(DriveError::Stalled { at: self.at() });
        }
        if state.position == target {
            return Ok(());
        }
        let (target, found) = (target.into(), state.position.into());
        Err(DriveError::NotArrived { at: self.at(), axis: Axes::Only, target, found })
    }
}

impl Stopping for Axis {
    async fn soft_stop(&mut self) -> Result<(), DriveError> {
        match self.bus.stop(self.address, 0).await {
            // A drive that is off or in alarm refuses; then it does not move.
            Ok(_) | Err(DriveError::Rejected { .. }) => self.rested(BRAKING).await.map(|_| ()),
            Err(error) => Err(error),
        }
    }

    async fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.bus.set_mode(self.address, Some(Mode::Off)).await
    }
}

impl Arguments {
    /// Of a drive whose turn has so many µsteps, and which goes at most so fast.
    fn options(&self, turn: StepsPerTurn, velocity_rpm: u16) -> SmartDriveOptions {
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
        SmartDriveOptions {
            deadline: self.deadline,
            worst_latency: self.deadline,
            mode_change: Duration::from_secs(2).max(10 * self.deadline),
            homing,
            ..SmartDriveOptions::new(vec![axis])
        }
    }

    /// Where ceilings and turn, which are those of following, do not count.
    fn any_options(&self) -> Result<SmartDriveOptions, Failure> {
        let turn = StepsPerTurn::new(200, 16)
            .ok_or_else(|| Failure::Usage("200 steps of 16 µsteps are no turn".to_owned()))?;
        Ok(self.options(turn, 1))
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
        let steps = [value(parameters::FULL_STEPS)?, value(parameters::STEP_DIVISOR)?];
        let rate = value(parameters::ACCELERATION_MAX)?;
        drop(drive);
        let [full_steps, divisor] = steps;
        let turn = StepsPerTurn::new(full_steps, divisor).ok_or_else(|| {
            Failure::Usage(format!("{full_steps} steps of {divisor} µsteps are no turn"))
        })?;
        let rpm = turn.rpm(by_switch.fastest()).ceil().clamp(1.0, 32_767.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let mut options = self.options(turn, rpm as u16);
        for axis in &mut options.axes {
            axis.acceleration_rpm_per_s = rate.max(1);
        }
        let mut drive = SmartDriveBus::open(&self.port, &options)?;
        by_switch.carry_out(&mut drive, &format!("drive {}", self.address), self.consent)
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let session = Session::start()?;
    match &arguments.action {
        Action::OnFile(on_file) => {
            let mut drive = SmartDriveBus::open(&arguments.port, &arguments.any_options()?)?;
            on_file.carry_out(&mut drive, arguments.consent)?;
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
            let found = session.ask(axis.bus.scan(addresses.clone()))?;
            if found.is_empty() {
                eprintln!("no address answers");
                return Ok(Status::Unfit);
            }
            status(&found);
        }
        Action::Status => {
            let state = session.ask(axis.state())?;
            status(&[(address, state)]);
        }
        Action::Unlock => {
            let state = standing(&session, &mut axis, "unlock")?;
            if state.mode == Mode::Remote.number() && state.alarms.is_empty() {
                println!("obeys the bus already, at {}", state.position);
            } else {
                session.ask(axis.bus.set_mode(address, Some(Mode::Remote)))?;
                println!("obeys the bus, at 0");
            }
        }
        Action::OnFile(_) => {}
        Action::Home { .. } => home(&session, &mut axis, arguments.consent)?,
        Action::Jog { distance, ramps } => {
            let from = session.ask(axis.state())?.position;
            let target = from.checked_add(*distance).ok_or_else(|| {
                Failure::Usage(format!("from {from} it cannot go {distance} µsteps further"))
            })?;
            travel(&session, &mut axis, arguments.consent, target, *ramps)?;
        }
        Action::Move { position, ramps } => {
            travel(&session, &mut axis, arguments.consent, *position, *ramps)?;
        }
        Action::Stop { now: true } => {
            session.ask(axis.hard_stop())?;
            println!("off");
        }
        Action::Stop { now: false } => {
            session.ask(axis.soft_stop())?;
            let state = session.ask(axis.state())?;
            println!("at rest at {}", state.position);
        }
        Action::Get { parameter } => get(&session, &mut axis, parameter.as_deref())?,
        Action::Set { parameter, value } => set(&session, &mut axis, parameter, *value)?,
        Action::Save => {
            standing(&session, &mut axis, "save")?;
            session.ask(axis.bus.save(address))?;
            println!("saved; the position is 0");
        }
        Action::Inputs => {
            let seen = session.ask(axis.bus.io(address, IoUpdate::default()))?;
            let mut table = show::table();
            table.set_header(["input", "level", "caught, active", "caught, inverse"]);
            for (place, name) in PINS.iter().enumerate().skip(OUTPUTS) {
                let bit = |word: u8| on_off(word >> place & 1 == 1);
                table.add_row([*name, bit(seen.levels), bit(seen.active), bit(seen.reverse)]);
            }
            println!("{table}");
        }
        Action::Outputs { switches } => outputs(&session, &mut axis, switches)?,
    }
    Ok(Status::Fit)
}

/// What a mode is.
fn mode(number: u8) -> String {
    match Mode::from_number(number) {
        Some(Mode::Off) => "0, off".to_owned(),
        Some(Mode::Remote) => "3, obeys the bus".to_owned(),
        Some(mode) => format!("{number}, {mode:?}"),
        None if number == Mode::Changing.number() => "changing".to_owned(),
        None => number.to_string(),
    }
}

/// Whether the motor turns or homing runs. One that has had no move yet has nothing that is done, either.
fn turns(state: &DriveState) -> bool {
    state.homing || state.flags.contains(TrajectoryFlags::IN_MOTION)
}

fn status(found: &[(u8, DriveState)]) {
    let mut table = show::table();
    table.set_header(["address", "mode", "position, µsteps", "state"]);
    for (address, state) in found {
        let flags = state.flags;
        let facts = [
            (!state.alarms.is_empty(), format!("alarm: {}", state.alarms)),
            (state.homing, "homing".to_owned()),
            (turns(state), "moving".to_owned()),
            (!turns(state), "at rest".to_owned()),
            (flags.contains(TrajectoryFlags::STALLED), "stalled".to_owned()),
            (flags.contains(TrajectoryFlags::LIMITED_P), "stopped by LIMP".to_owned()),
            (flags.contains(TrajectoryFlags::LIMITED_N), "stopped by LIMN".to_owned()),
        ];
        let said: Vec<_> = facts.into_iter().filter(|(is, _)| *is).map(|(_, what)| what).collect();
        let said = said.join(", ");
        table.add_row([
            right(address),
            mode(state.mode).into(),
            right(state.position),
            said.into(),
        ]);
    }
    println!("{table}");
}

/// The state of a drive that obeys and does not move.
fn standing(session: &Session, axis: &mut Axis, what: &str) -> Result<DriveState, Failure> {
    let state = session.ask(axis.state())?;
    if turns(&state) {
        let message = format!("{}: it moves, which `{what}` would end: `stop` first", axis.at());
        return Err(Failure::Usage(message));
    }
    Ok(state)
}

/// The same, which has to obey the bus.
fn obeying(session: &Session, axis: &mut Axis, what: &str) -> Result<DriveState, Failure> {
    let state = standing(session, axis, what)?;
    if state.mode != Mode::Remote.number() {
        let message = format!("{}: it is in mode {}: `unlock` first", axis.at(), mode(state.mode));
        return Err(Failure::Usage(message));
    }
    Ok(state)
}

fn home(session: &Session, axis: &mut Axis, consent: Consent) -> Result<(), Failure> {
    let from = obeying(session, axis, "home")?.position;
    let address = axis.address;
    let mut working = |index| session.ask(axis.bus.parameter(address, index));
    let enter = working(parameters::VELOCITY_ENTER_HOME)?.working;
    let offset = working(parameters::POSITION_OFFSET)?.working;
    consent.ask(&format!(
        "home the axis at address {address} from {from} to its switch, which is at {offset} µsteps, at {enter} rpm"
    ))?;
    let position = session.motion(axis, async |axis| axis.bus.home(address).await)?;
    println!("home, at {position}");
    Ok(())
}

fn travel(
    session: &Session,
    axis: &mut Axis,
    consent: Consent,
    target: i32,
    ramps: Ramps,
) -> Result<(), Failure> {
    let from = obeying(session, axis, "move")?.position;
    let address = axis.address;
    let mut working = |index| {
        let value = session.ask(axis.bus.parameter(address, index))?.working;
        Ok::<u16, Failure>(u16::try_from(value).unwrap_or(u16::MAX))
    };
    let largest = [working(parameters::VELOCITY_MAX)?, working(parameters::ACCELERATION_MAX)?];
    let turn = f64::from(working(FULL_STEPS)?) * f64::from(working(STEP_DIVISOR)?);
    let [speed, acceleration] = largest;
    // More than its ceilings no drive does.
    let speed = ramps.speed.map_or(speed, |wanted| wanted.min(speed));
    let acceleration = ramps.acceleration.map_or(acceleration, |wanted| wanted.min(acceleration));
    consent.ask(&format!(
        "move the axis at address {address} from {from} to {target} µsteps at {speed} rpm"
    ))?;
    let per_s = |rpm: u16| f64::from(rpm.max(1)) * turn / 60.0;
    let distance = f64::from(target) - f64::from(from);
    let patience = words::patience(distance, per_s(speed), per_s(acceleration));
    let profile = Some((speed, acceleration));
    session.motion(axis, async |axis| axis.go(target, profile, patience).await)?;
    println!("stands at {target}");
    Ok(())
}

fn outputs(session: &Session, axis: &mut Axis, switches: &[(String, bool)]) -> Result<(), Failure> {
    let mut update = IoUpdate::default();
    for (name, on) in switches {
        let outputs = PINS.iter().take(OUTPUTS);
        let place = outputs.clone().position(|output| output.eq_ignore_ascii_case(name));
        let Some(place) = place else {
            return Err(Failure::Usage(format!("output {name}: there are RDY, BRK and LED")));
        };
        let mask = 1 << place;
        if *on {
            update.set |= mask;
        } else {
            update.clear |= mask;
        }
    }
    let seen = session.ask(axis.bus.io(axis.address, update))?;
    let mut table = show::table();
    table.set_header(["output", "level"]);
    for (place, name) in PINS.iter().enumerate().take(OUTPUTS) {
        table.add_row([*name, on_off(seen.levels >> place & 1 == 1)]);
    }
    println!("{table}");
    let command = Command::IoUpdate(update);
    let wrong = update.set & !seen.levels | update.clear & seen.levels;
    if wrong == 0 {
        return Ok(());
    }
    Err(Failure::Usage(format!("{}: {} was not obeyed", axis.at(), command.name())))
}
