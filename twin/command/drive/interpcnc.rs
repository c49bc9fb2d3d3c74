//! `twin drive interpcnc`.

use super::by_switch::BySwitch;
use super::consent::Consent;
use super::interpcnc_parameters::{get, set};
use super::on_file::OnFile;
use super::session::{BRAKING, Session, Stopping, no_clock};
use super::words::{self, on_off, right};
use crate::command::show;
use crate::command::{Failure, Status};
use std::ops::RangeInclusive;
use std::time::Duration;
use twin_drives::DriveError;
use twin_drives::interpcnc::registers::{INPUTS, MAX_SPEED_HZ, OUTPUTS, Status as Bits};
use twin_drives::interpcnc::{
    AxisOptions, AxisValues, BoardAxis, InterpCnc, InterpCncDrive, InterpCncOptions, Line,
    MoveProfile, Parity, Snapshot, parameters,
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

    /// Modbus station
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=247))]
    station: u8,

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
    consent: Consent,

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
    /// Ask which stations answer; changes nothing
    Scan {
        /// Stations to ask, FIRST-LAST within 1-247; each that is not there takes two deadlines and more
        #[arg(long, default_value = "1-16", value_parser = stations)]
        stations: RangeInclusive<u8>,
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
        #[arg(long, default_value_t = 100_000, value_name = "STEPS", value_parser = clap::value_parser!(i32).range(1..))]
        max_stroke: i32,

        #[command(flatten)]
        by_switch: BySwitch,
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
    /// Change a parameter: the board keeps it in its EEPROM at once
    Set {
        /// Name, or number 0 to 383
        parameter: String,

        /// New value, decimal or 0x1F
        #[arg(allow_negative_numbers = true, value_parser = words::value)]
        value: i64,
    },
    /// Show inputs
    Inputs,
    /// Show outputs, after switching some
    Outputs {
        /// Outputs to switch, 1 to 32, like 3=on 4=off
        #[arg(value_name = "N=on|off", value_parser = words::switch)]
        switches: Vec<(String, bool)>,
    },
}

/// Speed and ramps of a move.
#[derive(Clone, Copy, Debug, clap::Args)]
struct Ramps {
    /// Speed, steps/s
    #[arg(long, default_value_t = 1000, value_name = "HZ", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SPEED_HZ)))]
    speed: u32,

    /// Speed at which the motor starts and stops without ramp, steps/s
    #[arg(long, default_value_t = 200, value_name = "HZ")]
    start_stop: u16,

    /// Acceleration, 1000 steps/s²
    #[arg(long, default_value_t = 50, value_name = "KHZ/S", value_parser = clap::value_parser!(u16).range(1..))]
    acceleration: u16,

    /// Deceleration, 1000 steps/s²
    #[arg(long, default_value_t = 50, value_name = "KHZ/S", value_parser = clap::value_parser!(u16).range(1..))]
    deceleration: u16,
}

fn axis(text: &str) -> Result<BoardAxis, String> {
    let named = |axis: &BoardAxis| axis.to_string().eq_ignore_ascii_case(text);
    BoardAxis::ALL.into_iter().find(named).ok_or_else(|| "the axes are X, Y, Z, A, B".to_owned())
}

fn stations(text: &str) -> Result<RangeInclusive<u8>, String> {
    words::stations(text, 1..=247)
}

impl Stopping for InterpCnc {
    async fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.ramp_stop(BRAKING, &no_clock).await.map(|_| ())
    }

    async fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.stop_and_lock(&no_clock).await.map(|_| ())
    }
}

impl Arguments {
    /// The board as runs drive it, of which these axes are in use.
    fn drive(&self, axes: &[BoardAxis]) -> Result<InterpCncDrive, Failure> {
        let axes = axes.iter().copied().map(AxisOptions::new).collect();
        let options = InterpCncOptions { axes, ..self.options(self.station) };
        Ok(InterpCncDrive::open(&self.port, &options)?)
    }

    fn options(&self, station: u8) -> InterpCncOptions {
        let parity = match self.parity {
            ParityOption::None => Parity::None,
            ParityOption::Even => Parity::Even,
            ParityOption::Odd => Parity::Odd,
        };
        InterpCncOptions {
            station,
            line: Line { baud: self.baud, parity },
            deadline: self.deadline,
            worst_latency: 2 * self.deadline,
            echo: self.echo,
            ..InterpCncOptions::new(BoardAxis::ALL.map(AxisOptions::new).to_vec())
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let session = Session::start()?;
    let open =
        |station| session.inside(|| InterpCnc::open(&arguments.port, &arguments.options(station)));
    if let Action::Scan { stations } = &arguments.action {
        return scan(&session, stations.clone(), open);
    }
    let consent = arguments.consent;
    match &arguments.action {
        Action::OnFile(on_file) => {
            on_file.carry_out(&mut arguments.drive(&BoardAxis::ALL)?, consent)?;
            return Ok(Status::Fit);
        }
        Action::Home { axes, by_switch, .. } if by_switch.is_wanted() => {
            let [axis] = **axes else {
                let message = "home --by-switch homes one axis at a time";
                return Err(Failure::Usage(message.to_owned()));
            };
            let mut drive = arguments.drive(&[axis])?;
            by_switch.carry_out(&mut drive, &format!("axis {axis}"), consent)?;
            return Ok(Status::Fit);
        }
        _ => {}
    }
    let mut board = open(arguments.station)?;
    match &arguments.action {
        Action::Scan { .. } | Action::OnFile(_) => {}
        Action::Status => status(&session.ask(board.snapshot(&no_clock))?),
        Action::Unlock => {
            session.ask(board.clear_errors(true, true, &no_clock))?;
            session.ask(board.unlock(&no_clock))?;
            println!("unlocked");
        }
        Action::Home { axes, max_stroke, .. } => {
            home(&session, &mut board, consent, axes, *max_stroke)?;
        }
        Action::Jog { axis, distance, ramps } => {
            let from = position(&session, &mut board, *axis)?;
            let target = from.checked_add(*distance).ok_or_else(|| {
                Failure::Usage(format!("axis {axis} at {from} cannot go {distance} steps further"))
            })?;
            travel(&session, &mut board, consent, *axis, (from, target), *ramps)?;
        }
        Action::Move { axis, position: target, ramps } => {
            let from = position(&session, &mut board, *axis)?;
            travel(&session, &mut board, consent, *axis, (from, *target), *ramps)?;
        }
        Action::Stop { now } => {
            let state = if *now {
                session.ask(board.stop_and_lock(&no_clock))?
            } else {
                session.ask(board.ramp_stop(BRAKING, &no_clock))?
            };
            println!("at rest at {}", state.positions.map(|one| one.to_string()).join(", "));
        }
        Action::Get { parameter } => get(&session, &mut board, parameter.as_deref())?,
        Action::Set { parameter, value } => set(&session, &mut board, parameter, *value)?,
        Action::Inputs => {
            let seen = session.ask(board.snapshot(&no_clock))?;
            let mut table = show::table();
            table.set_header(["input", "level"]);
            for number in 1..=INPUTS {
                let on = seen.inputs >> (number - 1) & 1 == 1;
                table.add_row([right(number), on_off(on).into()]);
            }
            for (number, value) in (1..).zip(seen.analog_inputs) {
                table.add_row([right(format!("analog {number}")), right(value)]);
            }
            println!("{table}");
        }
        Action::Outputs { switches } => outputs(&session, &mut board, switches)?,
    }
    Ok(Status::Fit)
}

fn scan(
    session: &Session,
    stations: RangeInclusive<u8>,
    open: impl Fn(u8) -> Result<InterpCnc, Failure>,
) -> Result<Status, Failure> {
    let mut table = show::table();
    table.set_header(["station", "line by its parameters", "recipes, command 78"]);
    let mut found = 0;
    for station in stations {
        let mut board = open(station)?;
        match session.ask(board.identify(&no_clock)) {
            Ok(identity) => {
                let line = identity.line.map_or("unknown codes".to_owned(), |line| {
                    format!("{} baud, parity {:?}", line.baud, line.parity).to_lowercase()
                });
                let recipes = if identity.has_recipes { "yes" } else { "no" };
                table.add_row([right(station), line.into(), recipes.into()]);
                found += 1;
            }
            Err(Failure::Drive(DriveError::Timeout { .. })) => {}
            // It is there, and has not what was asked.
            Err(Failure::Drive(DriveError::Device { .. })) => {
                table.add_row([right(station), "not told".into(), "not told".into()]);
                found += 1;
            }
            // Something is there that speaks otherwise, or at another speed.
            Err(Failure::Drive(error @ DriveError::Protocol { .. })) => {
                eprintln!("{error}");
            }
            Err(other) => return Err(other),
        }
    }
    if found == 0 {
        eprintln!("no station answers");
        return Ok(Status::Unfit);
    }
    println!("{table}");
    Ok(Status::Fit)
}

fn status(seen: &Snapshot) {
    let (status, extended) = (seen.state.status, seen.extended);
    let facts = [
        (status.enable_open(), "ENABLE open"),
        (status.locked(), "locked"),
        (!status.locked(), "unlocked"),
        (status.has(Bits::HOMING_IN_PROGRESS), "homing"),
        (status.has(Bits::HOMING_ERROR), "homing has failed"),
        (status.probing(), "probing"),
        (status.probe_failed(), "probing has failed"),
        (status.has(Bits::EEPROM_BUSY), "EEPROM busy"),
        (status.has(Bits::EEPROM_ERROR), "EEPROM has failed"),
        (status.has(Bits::BUFFER_FROZEN), "buffer frozen"),
        (status.has(Bits::OVERRIDDEN), "speed overridden"),
    ];
    let said: Vec<_> = facts.into_iter().filter(|(is, _)| *is).map(|(_, what)| what).collect();
    println!("{}", said.join(", "));
    let mut table = show::table();
    table.set_header(["axis", "position, steps", "state"]);
    for (axis, position) in BoardAxis::ALL.into_iter().zip(seen.state.positions) {
        let facts = [
            (status.moving().contains(axis), "moving"),
            (!status.moving().contains(axis), "at rest"),
            (extended.homing().contains(axis), "homing"),
            (extended.homing_failed().contains(axis), "homing has failed"),
            (status.on_limit_switch().contains(axis), "on a limit switch"),
        ];
        let said: Vec<_> = facts.into_iter().filter(|(is, _)| *is).map(|(_, what)| what).collect();
        table.add_row([axis.to_string().into(), right(position), said.join(", ").into()]);
    }
    println!("{table}");
}

fn position(session: &Session, board: &mut InterpCnc, axis: BoardAxis) -> Result<i32, Failure> {
    let (state, _) = session.ask(board.state(&no_clock))?;
    Ok(state.positions.get(axis.index()).copied().unwrap_or(0))
}

fn travel(
    session: &Session,
    board: &mut InterpCnc,
    consent: Consent,
    axis: BoardAxis,
    (from, target): (i32, i32),
    ramps: Ramps,
) -> Result<(), Failure> {
    consent.ask(&format!(
        "move axis {axis} from {from} to {target} steps at {} steps/s",
        ramps.speed
    ))?;
    let profile = MoveProfile {
        start_stop_hz: ramps.start_stop,
        acceleration_khz_per_s: ramps.acceleration,
        speed_hz: ramps.speed,
        deceleration_khz_per_s: ramps.deceleration,
        target,
    };
    let slowest = 1000.0 * f64::from(ramps.acceleration.min(ramps.deceleration));
    let distance = f64::from(target) - f64::from(from);
    let patience = words::patience(distance, ramps.speed.into(), slowest);
    session
        .motion(board, async |board| board.move_axis(axis, &profile, patience, &no_clock).await)?;
    println!("axis {axis} stands at {target}");
    Ok(())
}

fn home(
    session: &Session,
    board: &mut InterpCnc,
    consent: Consent,
    axes: &[BoardAxis],
    max_stroke: i32,
) -> Result<(), Failure> {
    let (state, _) = session.ask(board.state(&no_clock))?;
    let mut strokes = AxisValues::default();
    let mut said = Vec::with_capacity(axes.len());
    let mut patience = Duration::ZERO;
    for axis in axes {
        let mut parameter = |number| session.ask(board.parameter(number, &no_clock));
        let input = parameter(parameters::home_input(*axis))?;
        let speed = parameter(parameters::home_speed(*axis))?;
        let positive = parameter(parameters::home_direction(*axis))? == 1;
        if input == 0 {
            let message = format!("axis {axis} has no home switch: set home-input-{axis}");
            return Err(Failure::Usage(message.to_lowercase()));
        }
        if let Some(stroke) = strokes.get_mut(axis.index()) {
            *stroke = Some(max_stroke);
        }
        let from = state.positions.get(axis.index()).copied().unwrap_or(0);
        let sign = if positive { "+" } else { "-" };
        said.push(format!(
            "axis {axis} from {from} towards {sign} until input {input} says so, {max_stroke} steps at most, at {speed} steps/s"
        ));
        // There, and off the switch much slower; axes may go one after the other.
        patience +=
            words::patience(max_stroke.into(), speed.max(1).into(), f64::from(speed.max(1)));
    }
    consent.ask(&format!("home {}", said.join("; ")))?;
    let patience = patience.saturating_add(Duration::from_mins(1));
    let state = session
        .motion(board, async |board| board.home_machine(&strokes, patience, &no_clock).await)?;
    for axis in axes {
        let position = state.positions.get(axis.index()).copied().unwrap_or(0);
        println!("axis {axis} is home, at {position}");
    }
    Ok(())
}

fn outputs(
    session: &Session,
    board: &mut InterpCnc,
    switches: &[(String, bool)],
) -> Result<(), Failure> {
    let mut wanted = Vec::with_capacity(switches.len());
    for (name, on) in switches {
        let number = name.parse().ok().filter(|number| (1..=OUTPUTS).contains(number));
        let number: u8 = number
            .ok_or_else(|| Failure::Usage(format!("output {name}: there are 1 to {OUTPUTS}")))?;
        wanted.push((number, *on));
    }
    for (number, on) in wanted {
        session.ask(board.set_output(number, on, &no_clock))?;
    }
    let levels = session.ask(board.outputs(&no_clock))?;
    let mut table = show::table();
    table.set_header(["output", "level"]);
    for number in 1..=OUTPUTS {
        table.add_row([right(number), on_off(levels >> (number - 1) & 1 == 1).into()]);
    }
    println!("{table}");
    Ok(())
}
