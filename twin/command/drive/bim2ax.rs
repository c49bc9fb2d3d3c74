//! `twin drive bim2ax`.

use super::bim2ax_parameters::{get, set};
use super::by_switch::BySwitch;
use super::consent::Consent;
use super::on_file::OnFile;
use super::session::{BRAKING, Session, Stopping, no_clock};
use super::words::{self, on_off};
use crate::command::{Failure, Status, show};
use crate::real::{ModuleMemory, module_memory};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use twin_drives::bim2ax::bits::{card, message};
use twin_drives::bim2ax::zone::Positions;
use twin_drives::bim2ax::{
    AxisSettings, Bim2Ax, Bim2AxDrive, Bim2AxDriveOptions, Bim2AxOptions, ByteOrder, Identity,
    ModuleAxis, Move, Start, describe_messages,
};
use twin_drives::{Action as Doing, Axes, DriveError, Exchange};

/// BIBOX BIM2AX-BOCM: two step axes behind a dual-port RAM; positions in µsteps, speeds as the axis's drive mode has them
///
/// For instance, with `twin emulate bim2ax --link /tmp/module` in another window:
///   twin drive bim2ax --port /tmp/module status
///   twin drive bim2ax --port /tmp/module unlock 1
///   twin drive bim2ax --port /tmp/module move 1 4000 --speed 250
///
/// The module has no outputs of its own to switch, and keeps parameters in its EEPROM as soon as they are set.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct Arguments {
    /// Memory file of `twin emulate bim2ax`, or with --map the device that shows the bus, like /dev/uio0 or /dev/mem
    #[arg(long, value_name = "PATH")]
    port: PathBuf,

    /// PATH is a device to map: the module's 256 bytes are so far into it (0 for a UIO device)
    #[arg(long, value_name = "OFFSET", value_parser = offset)]
    map: Option<u64>,

    /// The module's numbers have their least significant byte first
    #[arg(long)]
    little_endian: bool,

    /// Longest time an answer may take, ms
    #[arg(long, value_name = "MS", default_value = "10", value_parser = words::milliseconds)]
    deadline: Duration,

    #[command(flatten)]
    consent: Consent,

    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Look who is there: version, rating, axes; changes nothing
    Scan,
    /// Show positions and messages of both axes; changes nothing
    Status,
    /// Give motors current, after a motor test where the module does not know that order; nothing moves
    Unlock {
        /// Axes, 1 or 2 or both
        #[arg(required = true, value_parser = axis)]
        axes: Vec<ModuleAxis>,
    },
    /// Let axes search their home cams, as the module's parameters say (asks first)
    Home {
        /// Axes, 1 or 2 or both
        #[arg(required = true, value_parser = axis)]
        axes: Vec<ModuleAxis>,

        /// Longest time it may take, s
        #[arg(long, default_value_t = 60, value_name = "S", value_parser = clap::value_parser!(u64).range(1..=3600))]
        timeout: u64,

        #[command(flatten)]
        by_switch: BySwitch,
    },
    #[command(flatten)]
    OnFile(OnFile),
    /// Move one axis by a distance, µsteps (asks first)
    Jog {
        /// 1 or 2
        #[arg(value_parser = axis)]
        axis: ModuleAxis,

        /// µsteps; below 0: backwards
        #[arg(allow_negative_numbers = true, value_name = "USTEPS")]
        distance: i32,

        #[command(flatten)]
        speed: Speed,
    },
    /// Move one axis to a position, µsteps (asks first)
    Move {
        /// 1 or 2
        #[arg(value_parser = axis)]
        axis: ModuleAxis,

        /// Where to, µsteps
        #[arg(allow_negative_numbers = true, value_name = "USTEPS")]
        position: i32,

        #[command(flatten)]
        speed: Speed,
    },
    /// Bring both axes to rest on their ramps
    Stop {
        /// Without ramps; homing is lost
        #[arg(long)]
        now: bool,
    },
    /// Show a parameter, or all of them
    Get {
        /// Name, or number ($0 to $63)
        parameter: Option<String>,
    },
    /// Change a parameter, at rest; the module keeps it in its EEPROM at once
    Set {
        /// Name, or number ($0 to $63)
        parameter: String,

        /// New value, decimal or $1F
        #[arg(allow_negative_numbers = true, value_parser = words::value)]
        value: i64,
    },
    /// Restart the module, after which all parameters act: positions and homing are lost, motors get no current
    Reset,
    /// Show end switches and home cams
    Inputs,
}

/// Speed of a move.
#[derive(Clone, Copy, Debug, clap::Args)]
struct Speed {
    /// Speed in the unit of the drive mode, steps/s or µsteps/s [default: the fast speed]
    #[arg(long, value_name = "PER_S", value_parser = clap::value_parser!(u16).range(1..))]
    speed: Option<u16>,
}

fn axis(text: &str) -> Result<ModuleAxis, String> {
    match text {
        "1" => Ok(ModuleAxis::One),
        "2" => Ok(ModuleAxis::Two),
        _ => Err("the axes are 1 and 2".to_owned()),
    }
}

fn offset(text: &str) -> Result<u64, String> {
    let number = words::integer(text).and_then(|number| u64::try_from(number).ok());
    number.ok_or_else(|| format!("`{text}` is no offset"))
}

/// Position and messages of an axis.
fn of(seen: &Positions, axis: ModuleAxis) -> (i32, u16) {
    let index = axis.index();
    let position = seen.positions.get(index).copied().unwrap_or(0);
    (position, seen.messages.get(index).copied().unwrap_or(0))
}

/// The module and its name.
struct Module {
    driver: Bim2Ax,
    port: Arc<str>,
}

impl Arguments {
    /// The module's name and memory, and how it is spoken to.
    fn memory(&self) -> Result<(Arc<str>, ModuleMemory, Bim2AxOptions), Failure> {
        let port: Arc<str> = self.port.display().to_string().into();
        let byte_order = if self.little_endian { ByteOrder::Little } else { ByteOrder::Big };
        let options = Bim2AxOptions { byte_order, deadline: self.deadline, ..Default::default() };
        let memory = module_memory(&self.port, self.map).map_err(|source| {
            let at = Exchange { port: Arc::clone(&port), station: 0, action: Doing::Open };
            Failure::Drive(DriveError::Transport { at, source })
        })?;
        Ok((port, memory, options))
    }

    /// The module as runs drive it, of which these axes are in use.
    fn drive(&self, axes: &[ModuleAxis]) -> Result<Bim2AxDrive, Failure> {
        let (port, memory, driver) = self.memory()?;
        let options =
            Bim2AxDriveOptions { driver, axes: axes.to_vec(), ..Bim2AxDriveOptions::new() };
        Ok(Bim2AxDrive::new(&port, memory, &options)?)
    }
}

impl Module {
    fn open(arguments: &Arguments) -> Result<Self, Failure> {
        let (port, memory, options) = arguments.memory()?;
        let driver = Bim2Ax::new(&port, memory, &options);
        Ok(Self { driver, port })
    }

    /// Fails for the first of these axes whose messages are wrong.
    fn check(
        &self,
        seen: &Positions,
        axes: &[ModuleAxis],
        wrong: impl Fn(u16) -> bool,
    ) -> Result<(), DriveError> {
        let Some(axis) = axes.iter().find(|axis| wrong(of(seen, **axis).1)) else { return Ok(()) };
        let (_, messages) = of(seen, *axis);
        let at = Exchange { port: Arc::clone(&self.port), station: 0, action: Doing::ReadState };
        let axis = u8::try_from(axis.number()).unwrap_or(0);
        Err(DriveError::AxisMessages { at, axis, messages })
    }

    async fn home(&mut self, axes: &[ModuleAxis], patience: Duration) -> Result<(), DriveError> {
        self.driver.home(axes, &no_clock).await?;
        let (seen, _) = self.driver.rested(patience, &no_clock).await?;
        self.check(&seen, axes, |messages| messages & message::HOMED == 0)
    }

    /// Moves an axis and waits until it stands there.
    async fn go(
        &mut self,
        axis: ModuleAxis,
        target: i32,
        speed: Option<u16>,
        patience: Duration,
    ) -> Result<(), DriveError> {
        let start = Start { to: Move::To(target), speed, directly: false };
        let starts = ModuleAxis::ALL.map(|any| (any == axis).then_some(start));
        self.driver.start(starts, &no_clock).await?;
        let (seen, _) = self.driver.rested(patience, &no_clock).await?;
        let (found, _) = of(&seen, axis);
        if found == target {
            return Ok(());
        }
        // An end switch, a limit, a motor: the messages say why.
        let why = message::MOVING | message::HOMED | message::ON_CAM;
        self.check(&seen, &[axis], |messages| messages & !why != 0)?;
        let at = Exchange { port: Arc::clone(&self.port), station: 0, action: Doing::ReadState };
        let axis = Axes::Numbers(1 << axis.index());
        Err(DriveError::NotArrived { at, axis, target: target.into(), found: found.into() })
    }
}

impl Stopping for Module {
    async fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.driver.abandon(&no_clock).await?;
        self.driver.rested(BRAKING, &no_clock).await.map(|_| ())
    }

    async fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.driver.stop_hard(&no_clock).await?;
        self.driver.rested(BRAKING, &no_clock).await.map(|_| ())
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let session = Session::start()?;
    let consent = arguments.consent;
    match &arguments.action {
        Action::OnFile(on_file) => {
            on_file.carry_out(&mut arguments.drive(&ModuleAxis::ALL)?, consent)?;
            return Ok(Status::Fit);
        }
        Action::Home { axes, by_switch, .. } if by_switch.is_wanted() => {
            let [axis] = **axes else {
                let message = "home --by-switch homes one axis at a time";
                return Err(Failure::Usage(message.to_owned()));
            };
            let name = format!("axis {}", axis.number());
            by_switch.carry_out(&mut arguments.drive(&[axis])?, &name, consent)?;
            return Ok(Status::Fit);
        }
        _ => {}
    }
    let mut module = Module::open(arguments)?;
    let identity = session.ask(module.driver.identify(&no_clock))?;
    match &arguments.action {
        Action::Scan => scan(&identity),
        Action::Status => {
            let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
            status(&seen);
        }
        Action::Unlock { axes } => unlock(&session, &mut module, axes)?,
        Action::OnFile(_) => {}
        Action::Home { axes, timeout, .. } => {
            home(&session, &mut module, consent, axes, Duration::from_secs(*timeout))?;
        }
        Action::Jog { axis, distance, speed } => {
            let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
            let (from, _) = of(&seen, *axis);
            let target = from.saturating_add(*distance);
            travel(&session, &mut module, consent, *axis, target, speed.speed)?;
        }
        Action::Move { axis, position, speed } => {
            travel(&session, &mut module, consent, *axis, *position, speed.speed)?;
        }
        Action::Stop { now } => {
            if *now {
                session.ask(module.hard_stop())?;
            } else {
                session.ask(module.soft_stop())?;
            }
            let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
            let [one, two] = seen.positions;
            println!("at rest at {one}, {two}");
        }
        Action::Get { parameter } => get(&session, &mut module.driver, parameter.as_deref())?,
        Action::Set { parameter, value } => set(&session, &mut module.driver, parameter, *value)?,
        Action::Reset => {
            standing(&session, &mut module, "reset")?;
            session.ask(module.driver.reset())?;
            println!("running again; both axes have to be homed");
        }
        Action::Inputs => inputs(&session, &mut module)?,
    }
    Ok(Status::Fit)
}

fn scan(identity: &Identity) {
    let axes = [(card::AXIS_1, "1"), (card::AXIS_2, "2")];
    let declared = axes.into_iter().filter(|(bit, _)| identity.card_messages & bit != 0);
    let declared: Vec<_> = declared.map(|(_, axis)| axis).collect();
    let rating = match identity.rating_ma {
        -1 => "unknown".to_owned(),
        rating => format!("{rating} mA"),
    };
    let mut table = show::table();
    table.set_header(["module", "version", "rating", "axes declared"]);
    table.add_row([
        "BIM2AX-BOCM".to_owned(),
        identity.version.to_string(),
        rating,
        declared.join(", "),
    ]);
    println!("{table}");
}

fn status(seen: &Positions) {
    let mut table = show::table();
    table.set_header(["axis", "position, µsteps", "state"]);
    for axis in ModuleAxis::ALL {
        let (position, messages) = of(seen, axis);
        let mut said = describe_messages(messages);
        // What it says of an axis at rest that is home.
        if messages & message::HOMED != 0 {
            let others = messages & !(message::HOMED | message::ON_CAM) != 0;
            said = if others { format!("home, {said}") } else { "home".to_owned() };
        }
        let number = axis.number().to_string();
        table.add_row([number.into(), words::right(position), said.into()]);
    }
    println!("{table}");
}

fn inputs(session: &Session, module: &mut Module) -> Result<(), Failure> {
    let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
    let mut table = show::table();
    table.set_header(["axis", "+ end switch", "- end switch", "home cam"]);
    for axis in ModuleAxis::ALL {
        let (_, messages) = of(&seen, axis);
        let bits = [message::PLUS_SWITCH, message::MINUS_SWITCH, message::ON_CAM];
        let [plus, minus, cam] = bits.map(|bit| on_off(messages & bit != 0).to_owned());
        table.add_row([axis.number().to_string(), plus, minus, cam]);
    }
    println!("{table}");
    Ok(())
}

fn unlock(session: &Session, module: &mut Module, axes: &[ModuleAxis]) -> Result<(), Failure> {
    const FAULTS: u16 = message::PHASE_OPEN | message::PHASE_SHORT | message::POWER_ABSENT;
    standing(session, module, "unlock")?;
    let driver = &mut module.driver;
    session.ask(async {
        match driver.set_phases(axes, true, &no_clock).await {
            // Modules from before revision D do not know that order; a motor test switches phases on and clears faults
            // that are gone (7.6).
            Err(DriveError::AxisMessages { messages, .. }) if messages & FAULTS == 0 => {
                driver.test_motors(axes, &no_clock).await
            }
            done => done,
        }
    })?;
    println!("motors have current");
    Ok(())
}

/// What both axes say, none of which moves.
fn standing(session: &Session, module: &mut Module, what: &str) -> Result<Positions, Failure> {
    let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
    if seen.messages.iter().any(|messages| messages & message::MOVING != 0) {
        let port = &module.port;
        return Err(Failure::Usage(format!("{port}: an axis moves: `stop` before `{what}`")));
    }
    Ok(seen)
}

/// What the module's parameters say about an axis.
fn settings(
    session: &Session,
    module: &mut Module,
    axis: ModuleAxis,
) -> Result<AxisSettings, Failure> {
    session.ask(module.driver.axis_settings(axis, &no_clock))
}

fn home(
    session: &Session,
    module: &mut Module,
    consent: Consent,
    axes: &[ModuleAxis],
    patience: Duration,
) -> Result<(), Failure> {
    use twin_drives::bim2ax::bits::coefficient::HOME_PLUS;
    let seen = standing(session, module, "home")?;
    let mut said = Vec::with_capacity(axes.len());
    for axis in axes {
        let of_axis = settings(session, module, *axis)?;
        let sign = if of_axis.has(HOME_PLUS) { "+" } else { "-" };
        let speed = of_axis.speed(of_axis.fast_speed);
        let (from, _) = of(&seen, *axis);
        said.push(format!(
            "axis {} from {from} towards {sign} to its cam, at {speed} µsteps/s at most",
            axis.number()
        ));
    }
    consent.ask(&format!("home {}", said.join("; ")))?;
    session.motion(module, async |module| module.home(axes, patience).await)?;
    let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
    for axis in axes {
        println!("axis {} is home, at {}", axis.number(), of(&seen, *axis).0);
    }
    Ok(())
}

fn travel(
    session: &Session,
    module: &mut Module,
    consent: Consent,
    axis: ModuleAxis,
    target: i32,
    speed: Option<u16>,
) -> Result<(), Failure> {
    let seen = standing(session, module, "move")?;
    let (from, _) = of(&seen, axis);
    let of_axis = settings(session, module, axis)?;
    let per_s = of_axis.speed(speed.unwrap_or(of_axis.fast_speed));
    let number = axis.number();
    consent
        .ask(&format!("move axis {number} from {from} to {target} µsteps at {per_s} µsteps/s"))?;
    // An axis may approach its target from one side, and go further for that.
    let way = f64::from(target) - f64::from(from);
    let distance = way.abs() + 2.0 * f64::from(of_axis.approach);
    let patience = words::patience(distance, per_s, of_axis.rate());
    session.motion(module, async |module| module.go(axis, target, speed, patience).await)?;
    println!("axis {number} stands at {target}");
    Ok(())
}
