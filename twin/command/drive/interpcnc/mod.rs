//! `twin drive interpcnc`.

mod coupled;
mod motion;
mod parameters;
mod show;

use super::action::Command;
use super::by_switch::{BySwitch, one_at_a_time};
use super::consent::Consent;
use super::family::{Family, Nothing, Travel};
use super::session::{BRAKING, Session, no_clock};
use super::words;
use crate::command::emulate::{PARITIES, one_of};
use crate::command::{Failure, Status};
use comfy_table::Cell;
use coupled::with_follower;
use parameters::Known;
use show::Output;
use std::ops::RangeInclusive;
use std::time::Duration;
use twin_drives::Drive;
use twin_interpcnc::protocol::registers::MAX_SPEED_HZ;
use twin_interpcnc::{
    AxisOptions, BoardAxis, InterpCnc, InterpCncDrive, InterpCncOptions, Line, MoveProfile, Parity,
};

/// A board.
#[derive(Debug)]
pub(super) struct HandBoard {
    session: Session,
    board: InterpCnc,
    consent: Consent,
    /// The axis that goes along with the one that is moved.
    follower: Option<BoardAxis>,
}

#[derive(Debug, clap::Args)]
pub(super) struct LineOptions {
    /// Serial port, like /dev/ttyUSB0, or the link of `twin emulate interpcnc`
    #[arg(long, value_name = "PATH")]
    port: String,

    /// Address of the board on its line; Modbus calls it station
    #[arg(long, visible_alias = "station", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=247))]
    address: u8,

    /// Bits per second
    #[arg(long, default_value_t = 115_200, value_parser = clap::value_parser!(u32).range(4800..=256_000))]
    baud: u32,

    /// Parity
    #[arg(long, default_value = "none", value_parser = one_of(&PARITIES))]
    parity: Parity,

    /// The adapter hears what it sends (two-wire RS485 without receiver control)
    #[arg(long)]
    echo: bool,

    /// Longest time an answer may take beyond its bytes, ms
    #[arg(long, value_name = "MS", default_value = "250", value_parser = words::milliseconds)]
    deadline: Duration,
}

#[derive(Debug, clap::Args)]
pub(super) struct Scan {
    /// Addresses to ask, FIRST-LAST within 1-247; each that is not there takes two deadlines and more
    #[arg(long, visible_alias = "stations", default_value = "1-16", value_parser = addresses)]
    addresses: RangeInclusive<u8>,
}

#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Home {
    /// Axes, like X Y
    #[arg(required = true, value_parser = axis)]
    axes: Vec<BoardAxis>,

    /// Longest way of each to its switch, steps
    #[arg(long, default_value_t = 100_000, value_name = "STEPS", allow_negative_numbers = true, value_parser = clap::value_parser!(i32).range(1..))]
    max_stroke: i32,
}

#[derive(Debug, clap::Args)]
pub(super) struct Axis {
    /// X, Y, Z, A or B
    #[arg(value_parser = axis)]
    axis: BoardAxis,
}

/// Speed and ramps of a move.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct Ramps {
    /// Speed, steps/s
    #[arg(long, default_value_t = 1000, value_name = "HZ", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SPEED_HZ)))]
    speed: u32,

    /// Speed at which the motor starts and stops without ramp, steps/s
    #[arg(long, default_value_t = 200, value_name = "HZ")]
    start_stop: u16,

    /// Acceleration, 1000 steps/s²
    #[arg(long, default_value_t = 50, value_name = "KHZ/S", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..))]
    acceleration: u16,

    /// Deceleration, 1000 steps/s²
    #[arg(long, default_value_t = 50, value_name = "KHZ/S", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..))]
    deceleration: u16,
}

#[derive(Debug, clap::Args)]
pub(super) struct Outputs {
    /// Outputs to switch, 1 to 32, like 3=on 4=off; analog outputs to set, A1 or A2 to 0 to 1023, like A1=512
    #[arg(value_name = "N=on|off", value_parser = show::output)]
    outputs: Vec<Output>,
}

fn axis(text: &str) -> Result<BoardAxis, String> {
    let named = |axis: &BoardAxis| axis.to_string().eq_ignore_ascii_case(text);
    BoardAxis::ALL.into_iter().find(named).ok_or_else(|| "the axes are X, Y, Z, A, B".to_owned())
}

fn addresses(text: &str) -> Result<RangeInclusive<u8>, String> {
    words::addresses(text, 1..=247)
}

impl HandBoard {
    /// The board at an address.
    fn at(command: &Command<Self>, address: u8) -> Result<Self, Failure> {
        let options = options(command, address, &BoardAxis::ALL)?;
        let session = Session::start()?;
        let board = session.inside(|| InterpCnc::open(&command.line.port, &options))?;
        Ok(Self { session, board, consent: command.consent(), follower: None })
    }
}

/// Settings of the driver for a board at an address, of which these axes are in use.
fn options(
    command: &Command<HandBoard>,
    address: u8,
    axes: &[BoardAxis],
) -> Result<InterpCncOptions, Failure> {
    let line = &command.line;
    Ok(InterpCncOptions {
        assumptions: command.assume.take()?,
        address,
        line: Line { baud: line.baud, parity: line.parity },
        deadline: line.deadline,
        turnaround: Duration::ZERO,
        worst_latency: 2 * line.deadline,
        echo: line.echo,
        ..InterpCncOptions::new(axes.iter().copied().map(AxisOptions::new).collect())
    })
}

/// The board as runs drive it, of which these axes are in use.
fn drive(command: &Command<HandBoard>, axes: &[BoardAxis]) -> Result<InterpCncDrive, Failure> {
    let line = &command.line;
    Ok(InterpCncDrive::open(&line.port, &options(command, line.address, axes)?)?)
}

impl Family for HandBoard {
    type Line = LineOptions;
    type Scan = Scan;
    type Unlock = Nothing;
    type Home = Home;
    type Axis = Axis;
    type Ramps = Ramps;
    type Outputs = Outputs;
    type Profile = MoveProfile;
    type Parameter = Known;

    const UNIT: &'static str = "steps";
    const KEEPS: Option<&'static str> =
        Some("an InterpCNC keeps parameters in its EEPROM when they are set: nothing to do");
    const NO_RESET: Option<&'static str> =
        Some("an InterpCNC is not restarted by a command: switch it off and on");
    const COLUMNS: &'static [&'static str] = &["number", "name", "value", "unit"];

    fn open(command: &Command<Self>) -> Result<Self, Failure> {
        Self::at(command, command.line.address)
    }

    fn drive(command: &Command<Self>, restore: bool) -> Result<Box<dyn Drive>, Failure> {
        // Some parameters end or bend what moves.
        if restore {
            Self::open(command)?.at_rest("restore")?;
        }
        Ok(Box::new(drive(command, &BoardAxis::ALL)?))
    }

    fn scan(command: &Command<Self>, scan: &Scan) -> Result<Status, Failure> {
        show::scan(scan.addresses.clone(), |address| Self::at(command, address))
    }

    fn home_by_switch(
        command: &Command<Self>,
        home: &Home,
        by_switch: &BySwitch,
    ) -> Result<(), Failure> {
        let [axis] = *home.axes else { return Err(one_at_a_time()) };
        let follower = Self::open(command)?.follower(&[axis], "home")?;
        let also = with_follower(follower);
        let space = if also.is_empty() { "" } else { " " };
        let name = format!("axis {axis}{space}{also}");
        let named = (name.as_str(), Self::UNIT);
        by_switch.carry_out(&mut drive(command, &[axis])?, named, command.consent())?;
        Self { follower, ..Self::open(command)? }.report_follower()
    }

    fn status(&mut self) -> Result<(), Failure> {
        show::status(&self.session.ask(self.board.snapshot(&no_clock))?)
    }

    fn unlock(&mut self, _: &Nothing) -> Result<(), Failure> {
        self.session.ask(self.board.clear_errors(true, true, &no_clock))?;
        self.session.ask(self.board.unlock(&no_clock))?;
        say!("unlocked");
        Ok(())
    }

    fn home(&mut self, home: &Home) -> Result<(), Failure> {
        self.home_axes(&home.axes, home.max_stroke)
    }

    fn axis_name(axis: &Axis) -> String {
        format!("axis {}", axis.axis)
    }

    fn plan(
        &mut self,
        axis: &Axis,
        ramps: &Ramps,
        target: &dyn Fn(i32) -> Result<i32, Failure>,
    ) -> Result<Travel<MoveProfile>, Failure> {
        self.plan_move(axis.axis, *ramps, target)
    }

    fn travel(&mut self, axis: &Axis, to: &Travel<MoveProfile>) -> Result<(), Failure> {
        self.session.motion(&mut self.board, async |board| {
            board.move_axis(axis.axis, &to.profile, to.patience, &no_clock).await
        })
    }

    fn report_follower(&mut self) -> Result<(), Failure> {
        self.report_follower()
    }

    fn stop(&mut self, now: bool) -> Result<String, Failure> {
        let state = if now {
            self.session.ask(self.board.stop_and_lock(&no_clock))?
        } else {
            self.session.ask(self.board.ramp_stop(BRAKING, &no_clock))?
        };
        Ok(format!("at rest at {}", state.positions.map(|one| one.to_string()).join(", ")))
    }

    fn find(text: &str) -> Result<Known, Failure> {
        parameters::find(text)
    }

    fn parameters() -> Vec<Known> {
        parameters::known()
    }

    fn row(&mut self, one: &Known) -> Result<Vec<Cell>, Failure> {
        let value = self.session.ask(self.board.parameter(one.number, &no_clock))?;
        let Known { number, name, unit } = one;
        Ok(vec![words::right(number), name.into(), words::right(value), (*unit).into()])
    }

    fn set(&mut self, parameter: &Known, value: &str) -> Result<(), Failure> {
        let value = words::value(value).map_err(Failure::Usage)?;
        self.at_rest("set")?;
        parameters::set(&self.session, &mut self.board, parameter, value)
    }

    fn inputs(&mut self) -> Result<(), Failure> {
        show::inputs(&self.session, &mut self.board)
    }

    fn outputs(&mut self, outputs: &Outputs) -> Result<(), Failure> {
        show::outputs(&self.session, &mut self.board, &outputs.outputs)
    }
}
