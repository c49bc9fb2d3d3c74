//! `twin drive interpcnc`.

mod coupled;
mod motion;
mod parameters;
mod show;

use super::by_switch::BySwitch;
use super::consent::{Beforehand, Consent};
use super::on_file::OnFile;
use super::session::{BRAKING, Session, no_clock};
use super::words;
use crate::command::assume::Assume;
use crate::command::{Failure, Status};
use coupled::{beside, follower};
use motion::{Way, home, standing, tell_follower, travel};
use parameters::{get, set};
use show::{Output, inputs, output, outputs, scan, status};
use std::ops::RangeInclusive;
use std::time::Duration;
use twin_drives::interpcnc::registers::MAX_SPEED_HZ;
use twin_drives::interpcnc::{
    AxisOptions, BoardAxis, InterpCnc, InterpCncDrive, InterpCncOptions, Line, Parity,
};

/// SOPROLEC InterpCNC V2.1: five step axes X Y Z A B on Modbus RTU; positions in steps
///
/// For instance, with `twin emulate interpcnc --link /tmp/board` in another window:
///   twin drive interpcnc --port /tmp/board status
///   twin drive interpcnc --port /tmp/board unlock
///   twin drive interpcnc --port /tmp/board move X 4000 --speed 2000
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct Arguments {
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
    #[arg(long, value_enum, default_value = "none")]
    parity: ParityOption,

    /// The adapter hears what it sends (two-wire RS485 without receiver control)
    #[arg(long)]
    echo: bool,

    /// Longest time an answer may take, ms
    #[arg(long, value_name = "MS", default_value = "250", value_parser = words::milliseconds)]
    deadline: Duration,

    #[command(flatten)]
    consent: Beforehand,

    #[command(flatten)]
    assume: Assume,

    #[command(subcommand)]
    action: Action,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ParityOption {
    None,
    Even,
    Odd,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Ask which addresses answer; changes nothing
    Scan {
        /// Addresses to ask, FIRST-LAST within 1-247; each that is not there takes two deadlines and more
        #[arg(long, visible_alias = "stations", default_value = "1-16", value_parser = addresses)]
        addresses: RangeInclusive<u8>,
    },
    /// Show lock, positions and errors; changes nothing
    Status,
    /// Clear "Board Locked" and the errors of homing and probing; moves nothing
    Unlock,
    /// Let axes search their home switches, as the board's parameters say (command 71; asks first)
    Home {
        /// Axes, like X Y
        #[arg(required = true, value_parser = axis)]
        axes: Vec<BoardAxis>,

        /// Longest way of each to its switch, steps
        #[arg(long, default_value_t = 100_000, value_name = "STEPS", allow_negative_numbers = true, value_parser = clap::value_parser!(i32).range(1..))]
        max_stroke: i32,

        #[command(flatten)]
        by_switch: BySwitch,

        #[command(flatten)]
        consent: Consent,
    },
    #[command(flatten)]
    OnFile(OnFile),
    /// Move one axis by a distance, steps (asks first)
    Jog {
        /// X, Y, Z, A or B
        #[arg(value_parser = axis)]
        axis: BoardAxis,

        /// Steps; below 0: backwards
        #[arg(allow_negative_numbers = true, value_name = "STEPS")]
        distance: i32,

        #[command(flatten)]
        ramps: Ramps,

        #[command(flatten)]
        consent: Consent,
    },
    /// Move one axis to a position, steps (asks first)
    Move {
        /// X, Y, Z, A or B
        #[arg(value_parser = axis)]
        axis: BoardAxis,

        /// Where to, steps
        #[arg(allow_negative_numbers = true, value_name = "STEPS")]
        position: i32,

        #[command(flatten)]
        ramps: Ramps,

        #[command(flatten)]
        consent: Consent,
    },
    /// Bring all axes to rest on their ramps (command 42)
    Stop {
        /// Without ramps, and lock the board (command 43); steps may be lost
        #[arg(long)]
        now: bool,
    },
    /// Show a parameter, or all that are known
    Get {
        /// Name, or number 0 to 383
        parameter: Option<String>,
    },
    /// Change a parameter: the board keeps it in its EEPROM at once; its axes must be at rest
    Set {
        /// Name, or number 0 to 383
        parameter: String,

        /// New value, decimal or 0x1F
        #[arg(allow_negative_numbers = true, value_parser = words::value)]
        value: i64,
    },
    /// Say that there is nothing to do: the board keeps parameters when they are set
    Save,
    /// Show inputs, encoder and pulse counters
    Inputs,
    /// Show outputs, also the analog ones, after switching or setting some
    Outputs {
        /// Outputs to switch, 1 to 32, like 3=on 4=off; analog outputs to set, A1 or A2 to 0 to 1023, like A1=512
        #[arg(value_name = "N=on|off", value_parser = output)]
        outputs: Vec<Output>,
    },
}

/// Speed and ramps of a move.
#[derive(Clone, Copy, Debug, clap::Args)]
struct Ramps {
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

fn axis(text: &str) -> Result<BoardAxis, String> {
    let named = |axis: &BoardAxis| axis.to_string().eq_ignore_ascii_case(text);
    BoardAxis::ALL.into_iter().find(named).ok_or_else(|| "the axes are X, Y, Z, A, B".to_owned())
}

fn addresses(text: &str) -> Result<RangeInclusive<u8>, String> {
    words::addresses(text, 1..=247)
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

    /// The board as runs drive it, of which these axes are in use.
    fn drive(&self, axes: &[BoardAxis]) -> Result<InterpCncDrive, Failure> {
        let axes = axes.iter().copied().map(AxisOptions::new).collect();
        let options = InterpCncOptions { axes, ..self.options(self.address)? };
        Ok(InterpCncDrive::open(&self.port, &options)?)
    }

    fn options(&self, station: u8) -> Result<InterpCncOptions, Failure> {
        let parity = match self.parity {
            ParityOption::None => Parity::None,
            ParityOption::Even => Parity::Even,
            ParityOption::Odd => Parity::Odd,
        };
        Ok(InterpCncOptions {
            assumptions: self.assume.take()?,
            station,
            line: Line { baud: self.baud, parity },
            deadline: self.deadline,
            worst_latency: 2 * self.deadline,
            echo: self.echo,
            ..InterpCncOptions::new(BoardAxis::ALL.map(AxisOptions::new).to_vec())
        })
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let session = Session::start()?;
    let open = |station| {
        let options = arguments.options(station)?;
        session.inside(|| InterpCnc::open(&arguments.port, &options))
    };
    if let Action::Scan { addresses } = &arguments.action {
        return scan(&session, addresses.clone(), open);
    }
    let consent = arguments.consent();
    match &arguments.action {
        Action::OnFile(on_file) => {
            // Some parameters end or bend what moves.
            if matches!(on_file, OnFile::Restore { .. }) {
                standing(&session, &mut open(arguments.address)?, "restore")?;
            }
            on_file.carry_out(&mut arguments.drive(&BoardAxis::ALL)?, consent)?;
            return Ok(Status::Fit);
        }
        Action::Home { axes, by_switch, .. } if by_switch.is_wanted() => {
            let [axis] = **axes else {
                let message = "home --by-switch homes one axis at a time";
                return Err(Failure::Usage(message.to_owned()));
            };
            let follower = follower(&session, &mut open(arguments.address)?, &[axis], "home")?;
            let also = beside(follower);
            let space = if also.is_empty() { "" } else { " " };
            let name = format!("axis {axis}{space}{also}");
            by_switch.carry_out(&mut arguments.drive(&[axis])?, (&name, "steps"), consent)?;
            tell_follower(&session, &mut open(arguments.address)?, follower)?;
            return Ok(Status::Fit);
        }
        Action::Save => {
            say!("an InterpCNC keeps parameters in its EEPROM when they are set: nothing to do");
            return Ok(Status::Fit);
        }
        _ => {}
    }
    let mut board = open(arguments.address)?;
    match &arguments.action {
        Action::Scan { .. } | Action::OnFile(_) | Action::Save => {}
        Action::Status => status(&session.ask(board.snapshot(&no_clock))?)?,
        Action::Unlock => {
            session.ask(board.clear_errors(true, true, &no_clock))?;
            session.ask(board.unlock(&no_clock))?;
            say!("unlocked");
        }
        Action::Home { axes, max_stroke, .. } => {
            home(&session, &mut board, consent, axes, *max_stroke)?;
        }
        Action::Jog { axis, distance, ramps, .. } => {
            travel(&session, &mut board, consent, *axis, Way::By(*distance), *ramps)?;
        }
        Action::Move { axis, position: target, ramps, .. } => {
            travel(&session, &mut board, consent, *axis, Way::To(*target), *ramps)?;
        }
        Action::Stop { now } => {
            let state = if *now {
                session.ask(board.stop_and_lock(&no_clock))?
            } else {
                session.ask(board.ramp_stop(BRAKING, &no_clock))?
            };
            say!("at rest at {}", state.positions.map(|one| one.to_string()).join(", "));
        }
        Action::Get { parameter } => get(&session, &mut board, parameter.as_deref())?,
        Action::Set { parameter, value } => {
            standing(&session, &mut board, "set")?;
            set(&session, &mut board, parameter, *value)?;
        }
        Action::Inputs => inputs(&session, &mut board)?,
        Action::Outputs { outputs: wanted } => outputs(&session, &mut board, wanted)?,
    }
    Ok(Status::Fit)
}
