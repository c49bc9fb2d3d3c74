//! An InterpCNC board.

use super::control::{Obeys, Switch, parsed};
use super::{Common, Failure, Status, milliseconds, serve};
use crate::clock::Clock;
use twin_drives::interpcnc::emulator::{
    BoardOptions, Control, EmulatedBoard, EmulatorOptions, Wire,
};
use twin_drives::interpcnc::{BoardAxis, Line, Parity};
use twin_drives::{Direction, FaultRule, When, WireFault};

#[derive(Debug, clap::Args)]
pub(super) struct Options {
    #[command(flatten)]
    common: Common,

    /// Modbus station
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=247))]
    station: u8,

    /// Bits per second; the time bytes need on the wire is emulated
    #[arg(long, default_value_t = 115_200, value_parser = clap::value_parser!(u32).range(4800..=256_000))]
    baud: u32,

    /// Parity
    #[arg(long, value_enum, default_value = "none")]
    parity: ParityOption,

    /// Time the board takes to answer, ms
    #[arg(long, default_value_t = 2.0, value_name = "MS")]
    turnaround_ms: f64,

    /// Leave the ENABLE input open: the board stays locked
    #[arg(long)]
    enable_open: bool,

    /// Seed of faults by chance
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ParityOption {
    None,
    Even,
    Odd,
}

pub(super) fn run(options: &Options) -> Result<Status, Failure> {
    let turnaround = milliseconds("--turnaround-ms", options.turnaround_ms)?;
    let parity = match options.parity {
        ParityOption::None => Parity::None,
        ParityOption::Even => Parity::Even,
        ParityOption::Odd => Parity::Odd,
    };
    let line = Line { baud: options.baud, parity };
    let enable = !options.enable_open;
    let emulator = EmulatorOptions {
        board: BoardOptions { station: options.station, line, enable, ..BoardOptions::default() },
        wire: Wire { line, turnaround },
        link: Some(options.common.link.clone()),
        eeprom: options.common.eeprom.clone(),
        seed: options.seed,
        ..EmulatorOptions::default()
    };
    let clock = Clock::start();
    let mut running = EmulatedBoard::start(&emulator, move || clock.now_ns())?;
    eprintln!(
        "InterpCNC, station {}, {} baud, on {} ({})",
        options.station,
        options.baud,
        options.common.link.display(),
        running.path().display()
    );
    serve(&options.common, &mut running)?;
    let board = running.stop()?;
    eprintln!("{} frames answered; counters {:?}", board.frames_handled(), board.counters());
    Ok(Status::Fit)
}

/// What can be done to a board.
#[derive(Debug, clap::Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
enum Word {
    /// The ENABLE input
    Enable {
        #[arg(value_enum)]
        state: Switch,
    },
    /// An input, IN1 to IN32, by hand
    Input {
        #[arg(value_parser = clap::value_parser!(u8).range(1..=32))]
        number: u8,
        #[arg(value_enum)]
        state: Switch,
    },
    /// The hand is taken off an input
    Release {
        #[arg(value_parser = clap::value_parser!(u8).range(1..=32))]
        number: u8,
    },
    /// The voltage at analog input 1 to 4, 0 to 1023
    Analog {
        #[arg(value_parser = clap::value_parser!(u8).range(1..=4))]
        number: u8,
        #[arg(value_parser = clap::value_parser!(u16).range(0..=1023))]
        value: u16,
    },
    /// The motor of an axis does not follow
    Stall {
        #[arg(value_enum)]
        axis: AxisWord,
        #[arg(value_enum)]
        state: Switch,
    },
    /// The status stays as it is now
    StuckStatus {
        #[arg(value_enum)]
        state: Switch,
    },
    /// Writes to the EEPROM fail
    BreakEeprom {
        #[arg(value_enum)]
        state: Switch,
    },
    /// The supply fails, for so many ms
    BrownOut {
        #[arg(default_value_t = 100)]
        ms: u32,
    },
    /// The plug is pulled (off) or put back (on)
    Plug {
        #[arg(value_enum)]
        state: Switch,
    },
    /// A fault of the wire: drop, delay MS, corrupt BYTES, truncate KEEP, duplicate, reorder, wrong-check, noise BYTES, refuse
    /// CODE, echo
    Fault {
        #[arg(value_enum)]
        direction: DirectionWord,
        #[arg(value_enum)]
        fault: FaultWord,
        /// What it takes
        #[arg(default_value_t = 1)]
        value: u32,
        /// Only the next so many frames
        #[arg(long)]
        next: Option<u32>,
    },
    /// The wire is good again
    NoFaults,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum AxisWord {
    X,
    Y,
    Z,
    A,
    B,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum DirectionWord {
    Request,
    Answer,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum FaultWord {
    Drop,
    Delay,
    Corrupt,
    Truncate,
    Duplicate,
    Reorder,
    WrongCheck,
    Noise,
    Refuse,
    Echo,
}

impl Word {
    fn control(self) -> Result<Control, String> {
        let axis = |axis: AxisWord| match axis {
            AxisWord::X => BoardAxis::X,
            AxisWord::Y => BoardAxis::Y,
            AxisWord::Z => BoardAxis::Z,
            AxisWord::A => BoardAxis::A,
            AxisWord::B => BoardAxis::B,
        };
        Ok(match self {
            Self::Enable { state } => Control::Enable(state.is_on()),
            Self::Input { number, state } => Control::Input { number, level: state.is_on() },
            Self::Release { number } => Control::ReleaseInput(number),
            Self::Analog { number, value } => Control::AnalogInput { number, value },
            Self::Stall { axis: word, state } => Control::Stall(axis(word), state.is_on()),
            Self::StuckStatus { state } => Control::StuckStatus(state.is_on()),
            Self::BreakEeprom { state } => Control::BreakEeprom(state.is_on()),
            Self::BrownOut { ms } => Control::BrownOut { off_ns: i64::from(ms) * 1_000_000 },
            Self::Plug { state } => Control::Disconnect(!state.is_on()),
            Self::NoFaults => Control::NoFaults,
            Self::Fault { direction, fault, value, next } => {
                let direction = match direction {
                    DirectionWord::Request => Direction::Request,
                    DirectionWord::Answer => Direction::Answer,
                };
                let count = || usize::try_from(value).unwrap_or(usize::MAX);
                let fault = match fault {
                    FaultWord::Drop => WireFault::Drop,
                    FaultWord::Delay => WireFault::Delay { ns: i64::from(value) * 1_000_000 },
                    FaultWord::Corrupt => WireFault::Corrupt { bytes: count() },
                    FaultWord::Truncate => WireFault::Truncate { keep: count() },
                    FaultWord::Duplicate => WireFault::Duplicate,
                    FaultWord::Reorder => WireFault::Reorder,
                    FaultWord::WrongCheck => WireFault::WrongCheck,
                    FaultWord::Noise => WireFault::Noise { bytes: count() },
                    FaultWord::Refuse => WireFault::Refuse {
                        code: u8::try_from(value).map_err(|_beyond| format!("no code {value}"))?,
                    },
                    FaultWord::Echo => WireFault::Echo,
                };
                let when = next.map_or(When::Always, When::Next);
                Control::Fault(FaultRule { direction, when, fault })
            }
        })
    }
}

impl Obeys for EmulatedBoard {
    fn obey(&mut self, words: &[&str]) -> Result<String, String> {
        parsed::<Word>(words, |word| {
            self.control(word.control()?).map_err(|error| error.to_string())?;
            Ok(String::new())
        })
    }
}
