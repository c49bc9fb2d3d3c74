//! `twin drive bim2ax`.

mod card;
mod checksum_fault;
mod motion;
mod parameters;
mod show;

use super::action::{Action, Command};
use super::by_switch::{BySwitch, one_at_a_time};
use super::consent::Consent;
use super::family::{Family, Nothing, Travel};
use super::session::{Session, no_clock};
use super::words;
use crate::command::{Failure, Status};
use crate::troubleshooting::CHECK_SUM;
use card::Card;
use comfy_table::Cell;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use twin_bim2ax::protocol::memory::OpenedMemory;
use twin_bim2ax::protocol::parameter::Parameter;
use twin_bim2ax::{Bim2AxDrive, Bim2AxDriveOptions, Bim2AxOptions, ByteOrder, ModuleAxis};
use twin_drives::{Action as Doing, Drive, DriveError, Exchange};

/// A module.
#[derive(Debug)]
pub(super) struct Module {
    session: Session,
    card: Card,
    consent: Consent,
    /// Whether the speeds of each axis are in whole steps, once that is known.
    per_step: Option<[bool; 2]>,
}

#[derive(Debug, clap::Args)]
pub(super) struct LineOptions {
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
}

#[derive(Debug, clap::Args)]
pub(super) struct Unlock {
    /// Axes, 1 or 2 or both
    #[arg(required = true, value_parser = axis)]
    axes: Vec<ModuleAxis>,
}

#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Home {
    /// Axes, 1 or 2 or both
    #[arg(required = true, value_parser = axis)]
    axes: Vec<ModuleAxis>,

    /// Longest time it may take, s [default: what the way between the soft limits takes; 60 where there are none]
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u64).range(1..=3600))]
    timeout: Option<u64>,
}

#[derive(Debug, clap::Args)]
pub(super) struct Axis {
    /// 1 or 2
    #[arg(value_parser = axis)]
    axis: ModuleAxis,
}

/// Speed of a move.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct Speed {
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
    number.ok_or_else(|| format!("`{text}` is not an offset"))
}

/// Arguments of `outputs`: there are none.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct NoOutputs {
    /// What other families switch here
    #[arg(value_name = "NAME=on|off", hide = true)]
    switches: Vec<String>,
}

/// The module's name and memory, and how it is spoken to. Only a stop goes to a module that has another master.
fn memory(command: &Command<Module>) -> Result<(Arc<str>, OpenedMemory, Bim2AxOptions), Failure> {
    let line = &command.line;
    let port: Arc<str> = line.port.display().to_string().into();
    let byte_order = if line.little_endian { ByteOrder::Little } else { ByteOrder::Big };
    let options = Bim2AxOptions {
        byte_order,
        deadline: line.deadline,
        assumptions: command.assume.take()?,
        ..Default::default()
    };
    let stops = matches!(command.action, Action::Stop { .. });
    let memory = if stops { OpenedMemory::shared } else { OpenedMemory::alone };
    let memory = memory(&line.port, line.map).map_err(|source| {
        let at = Exchange { port: Arc::clone(&port), address: 0, action: Doing::Open };
        Failure::Drive(DriveError::Transport { at, source })
    })?;
    Ok((port, memory, options))
}

/// The module as runs drive it, of which these axes are in use.
fn drive(command: &Command<Module>, axes: &[ModuleAxis]) -> Result<Bim2AxDrive, Failure> {
    let (port, memory, driver) = memory(command)?;
    let options = Bim2AxDriveOptions { driver, axes: axes.to_vec(), ..Bim2AxDriveOptions::new() };
    Ok(Bim2AxDrive::new(&port, memory, &options)?)
}

impl Family for Module {
    type Line = LineOptions;
    type Scan = Nothing;
    type Unlock = Unlock;
    type Home = Home;
    type Axis = Axis;
    type Ramps = Speed;
    type Outputs = NoOutputs;
    type Profile = Option<u16>;
    type Parameter = Parameter;

    const UNIT: &'static str = "µsteps";
    const KEEPS: Option<&'static str> =
        Some("a BIM2AX keeps parameters in its EEPROM when they are set: nothing to do");
    const NO_OUTPUTS: Option<&'static str> =
        Some("a BIM2AX has no outputs: its watchdog contact is its own");
    const COLUMNS: &'static [&'static str] = &["number", "name", "value", "unit"];

    fn open(command: &Command<Self>) -> Result<Self, Failure> {
        let session = Session::start()?;
        let (port, memory, options) = memory(command)?;
        let shared = memory.has_other_master();
        let card = Card::new(port, memory, options, shared);
        Ok(Self { session, card, consent: command.consent(), per_step: None })
    }

    fn drive(command: &Command<Self>, _: bool) -> Result<Box<dyn Drive>, Failure> {
        Ok(Box::new(drive(command, &ModuleAxis::ALL)?))
    }

    fn scan(command: &Command<Self>, _: &Nothing) -> Result<Status, Failure> {
        let Self { session, mut card, .. } = Self::open(command)?;
        match session.ask(card.driver.identify_any(&no_clock))? {
            Some(identity) => show::scan(&identity)?,
            None => show::checksum_fault_scan()?,
        }
        Ok(Status::Fit)
    }

    fn home_by_switch(
        command: &Command<Self>,
        home: &Home,
        by_switch: &BySwitch,
    ) -> Result<(), Failure> {
        let [axis] = *home.axes else { return Err(one_at_a_time()) };
        let name = format!("axis {}", axis.number());
        let named = (name.as_str(), Self::UNIT);
        by_switch.carry_out(&mut drive(command, &[axis])?, named, command.consent())
    }

    /// Stops first; anything else is for a module whose EEPROM is sound.
    fn prepare(&mut self, command: &Command<Self>) -> Result<Option<Status>, Failure> {
        if let Action::Stop { now } = command.action {
            say!("{}", self.stop(now)?);
            // One that has noticed and ended meanwhile moves nothing any more.
            let line = &command.line;
            if !self.card.is_shared() || OpenedMemory::alone(&line.port, line.map).is_ok() {
                return Ok(Some(Status::Fit));
            }
            stderr!(
                "another program drives this module and may move it again, because it does not notice a stop while it waits: end that \
                 program, or use the emergency stop"
            );
            return Ok(Some(Status::Unfit));
        }
        if self.session.ask(self.card.driver.identify_any(&no_clock))?.is_some() {
            return Ok(None);
        }
        self.with_checksum_fault(&command.action).map(Some)
    }

    fn status(&mut self) -> Result<(), Failure> {
        let (seen, _) = self.session.ask(self.card.driver.positions(&no_clock))?;
        show::status(&seen)
    }

    fn unlock(&mut self, unlock: &Unlock) -> Result<(), Failure> {
        self.at_rest("unlock")?;
        self.session.ask(self.card.driver.energise(&unlock.axes, &no_clock))?;
        say!("motors have current");
        Ok(())
    }

    fn home(&mut self, home: &Home) -> Result<(), Failure> {
        self.home_axes(&home.axes, home.timeout.map(Duration::from_secs))
    }

    fn axis_name(axis: &Axis) -> String {
        format!("axis {}", axis.axis.number())
    }

    fn plan(
        &mut self,
        axis: &Axis,
        speed: &Speed,
        target: &dyn Fn(i32) -> Result<i32, Failure>,
    ) -> Result<Travel<Option<u16>>, Failure> {
        self.plan_move(axis.axis, speed.speed, target)
    }

    fn travel(&mut self, axis: &Axis, to: &Travel<Option<u16>>) -> Result<(), Failure> {
        self.session.motion(&mut self.card, async |card| {
            card.driver.travel(axis.axis, (to.target, to.profile), to.patience, &no_clock).await
        })
    }

    fn stop(&mut self, now: bool) -> Result<String, Failure> {
        if self.session.ask(self.card.stop_for_good(now))? {
            stderr!("the module writes its numbers in the other byte order: see --little-endian");
        }
        let (seen, _) = self.session.ask(self.card.driver.positions(&no_clock))?;
        let [one, two] = seen.positions;
        Ok(format!("at rest at {one}, {two}"))
    }

    fn find(text: &str) -> Result<Parameter, Failure> {
        parameters::find(text)
    }

    fn parameters() -> Vec<Parameter> {
        parameters::all().collect()
    }

    fn row(&mut self, parameter: &Parameter) -> Result<Vec<Cell>, Failure> {
        let per_step = match self.per_step {
            Some(known) => known,
            None => parameters::per_step(&self.session, &mut self.card.driver)?,
        };
        self.per_step = Some(per_step);
        parameters::row(&self.session, &mut self.card.driver, *parameter, per_step)
    }

    fn set(&mut self, parameter: &Parameter, value: &str) -> Result<(), Failure> {
        let value = words::value(value).map_err(Failure::Usage)?;
        parameters::set(&self.session, &mut self.card.driver, *parameter, value)
    }

    fn reset(&mut self) -> Result<Status, Failure> {
        self.at_rest("reset")?;
        self.session.ask(self.card.driver.reset())?;
        if self.session.ask(self.card.driver.identify_any(&no_clock))?.is_some() {
            say!("running again; both axes have to be homed");
            return Ok(Status::Fit);
        }
        say!(
            "running again, and the check sum of its EEPROM is wrong: it takes parameters, and no orders"
        );
        say!("next: {CHECK_SUM}");
        Ok(Status::Unfit)
    }

    fn inputs(&mut self) -> Result<(), Failure> {
        show::inputs(&self.session, &mut self.card)
    }
}
