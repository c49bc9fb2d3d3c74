//! `twin drive bim2ax`.

mod module;
mod motion;
mod parameters;
mod show;
mod unsound;

use super::by_switch::BySwitch;
use super::consent::{Beforehand, Consent};
use super::on_file::OnFile;
use super::session::{Session, no_clock};
use super::words;
use crate::advice::CHECK_SUM;
use crate::command::assume::Assume;
use crate::command::{Failure, Status};
use crate::real::{ModuleMemory, module_beside, module_memory};
use module::{Module, of};
use motion::{home, standing, travel, unlock};
use parameters::{get, set};
use show::{inputs, scan, status};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use twin_drives::bim2ax::{Bim2AxDrive, Bim2AxDriveOptions, Bim2AxOptions, ByteOrder, ModuleAxis};
use twin_drives::{Action as Doing, DriveError, Exchange};

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
    consent: Beforehand,

    #[command(flatten)]
    assume: Assume,

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

        /// Longest time it may take, s [default: what the way between the soft limits takes; 60 where there are none]
        #[arg(long, value_name = "S", value_parser = clap::value_parser!(u64).range(1..=3600))]
        timeout: Option<u64>,

        #[command(flatten)]
        by_switch: BySwitch,

        #[command(flatten)]
        consent: Consent,
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

        #[command(flatten)]
        consent: Consent,
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

        #[command(flatten)]
        consent: Consent,
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
    /// Say that there is nothing to do: the module keeps parameters when they are set
    Save,
    /// Show end switches, home cams and encoders
    Inputs,
    /// Say that there are none
    Outputs {
        /// What other families switch here
        #[arg(value_name = "NAME=on|off", hide = true)]
        switches: Vec<String>,
    },
}

/// Speed of a move.
#[derive(Clone, Copy, Debug, clap::Args)]
struct Speed {
    /// Speed in the unit of the drive mode, steps/s or µsteps/s [default: the fast speed]
    #[arg(long, value_name = "PER_S", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..))]
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

    /// The module's name and memory, and how it is spoken to. Only a stop goes to a module that has another master.
    fn memory(&self) -> Result<(Arc<str>, ModuleMemory, Bim2AxOptions), Failure> {
        let port: Arc<str> = self.port.display().to_string().into();
        let byte_order = if self.little_endian { ByteOrder::Little } else { ByteOrder::Big };
        let options = Bim2AxOptions {
            byte_order,
            deadline: self.deadline,
            assumptions: self.assume.take()?,
            ..Default::default()
        };
        let stops = matches!(self.action, Action::Stop { .. });
        let memory = if stops { module_beside } else { module_memory };
        let memory = memory(&self.port, self.map).map_err(|source| {
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

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let session = Session::start()?;
    let consent = arguments.consent();
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
            by_switch.carry_out(&mut arguments.drive(&[axis])?, (&name, "µsteps"), consent)?;
            return Ok(Status::Fit);
        }
        Action::Save => {
            say!("a BIM2AX keeps parameters in its EEPROM when they are set: nothing to do");
            return Ok(Status::Fit);
        }
        Action::Outputs { .. } => {
            let message = "a BIM2AX has no outputs: its watchdog contact is its own";
            return Err(Failure::Usage(message.to_owned()));
        }
        _ => {}
    }
    let mut module = Module::open(arguments)?;
    if let Action::Stop { now } = &arguments.action {
        stop(&session, &mut module, *now)?;
        // One that has noticed and ended meanwhile moves nothing any more.
        let driven = module.is_beside() && module_memory(&arguments.port, arguments.map).is_err();
        if !driven {
            return Ok(Status::Fit);
        }
        tell!(
            "another program drives this module and may move it again, for one that waits sees no stop: end it, or use the \
             emergency stop"
        );
        return Ok(Status::Unfit);
    }
    let known = session.ask(module.driver.identify_any(&no_clock))?;
    let Some(identity) = known else {
        return unsound::carry_out(&session, &mut module, &arguments.action);
    };
    match &arguments.action {
        Action::Scan => scan(&identity)?,
        Action::Status => {
            let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
            status(&seen)?;
        }
        Action::Unlock { axes } => unlock(&session, &mut module, axes)?,
        Action::Home { axes, timeout, .. } => {
            home(&session, &mut module, consent, axes, timeout.map(Duration::from_secs))?;
        }
        Action::Jog { axis, distance, speed, .. } => {
            let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
            let (from, _) = of(&seen, *axis);
            let target = from.checked_add(*distance).ok_or_else(|| {
                let number = axis.number();
                Failure::Usage(format!(
                    "axis {number} at {from} cannot go {distance} µsteps further"
                ))
            })?;
            travel(&session, &mut module, consent, *axis, target, speed.speed)?;
        }
        Action::Move { axis, position, speed, .. } => {
            travel(&session, &mut module, consent, *axis, *position, speed.speed)?;
        }
        Action::Stop { .. } | Action::Save | Action::Outputs { .. } | Action::OnFile(_) => {}
        Action::Get { parameter } => get(&session, &mut module.driver, parameter.as_deref())?,
        Action::Set { parameter, value } => set(&session, &mut module.driver, parameter, *value)?,
        Action::Reset => {
            standing(&session, &mut module, "reset")?;
            session.ask(module.driver.reset())?;
            return restarted(&session, &mut module);
        }
        Action::Inputs => inputs(&session, &mut module)?,
    }
    Ok(Status::Fit)
}

/// Says in which state a module has come up.
fn restarted(session: &Session, module: &mut Module) -> Result<Status, Failure> {
    let known = session.ask(module.driver.identify_any(&no_clock))?;
    if known.is_some() {
        say!("running again; both axes have to be homed");
        return Ok(Status::Fit);
    }
    say!(
        "running again, and the check sum of its EEPROM is wrong: it takes parameters, and no orders"
    );
    say!("next: {CHECK_SUM}");
    Ok(Status::Unfit)
}

fn stop(session: &Session, module: &mut Module, now: bool) -> Result<(), Failure> {
    if session.ask(module.stop_for_good(now))? {
        tell!("the module writes its numbers in the other byte order: see --little-endian");
    }
    let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
    let [one, two] = seen.positions;
    say!("at rest at {one}, {two}");
    Ok(())
}
