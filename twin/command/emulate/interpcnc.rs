//! An InterpCNC board.

use super::control::{Obeys, Switch};
use super::faults::{self, Said, WireWord};
use super::{Common, Failure, Status, milliseconds, serve};
use crate::clock::Clock;
use twin_drives::interpcnc::emulator::{
    BoardOptions, Control, EmulatedBoard, EmulatorOptions, Event, Wire,
};
use twin_drives::interpcnc::{BoardAxis, Line, Parity};

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
        seed: options.common.seed,
        speed: options.common.speed(),
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
    #[command(flatten)]
    Wire(WireWord),
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum AxisWord {
    X,
    Y,
    Z,
    A,
    B,
}

impl Word {
    fn control(self) -> Result<Control, Said> {
        let axis = |axis: AxisWord| match axis {
            AxisWord::X => BoardAxis::X,
            AxisWord::Y => BoardAxis::Y,
            AxisWord::Z => BoardAxis::Z,
            AxisWord::A => BoardAxis::A,
            AxisWord::B => BoardAxis::B,
        };
        let event = match self {
            Self::Wire(word) => return word.control(obeyed),
            Self::Enable { state } => Event::Enable(state.is_on()),
            Self::Input { number, state } => Event::Input { number, level: state.is_on() },
            Self::Release { number } => Event::ReleaseInput(number),
            Self::Analog { number, value } => Event::AnalogInput { number, value },
            Self::Stall { axis: word, state } => Event::Stall(axis(word), state.is_on()),
            Self::StuckStatus { state } => Event::StuckStatus(state.is_on()),
            Self::BreakEeprom { state } => Event::BreakEeprom(state.is_on()),
            Self::BrownOut { ms } => Event::BrownOut { off_ns: i64::from(ms) * 1_000_000 },
        };
        Ok(Control::Event(event))
    }
}

fn obeyed(words: &[&str]) -> Result<Control, Said> {
    faults::control(words, Word::control)
}

impl Obeys for EmulatedBoard {
    fn obey(&mut self, words: &[&str]) -> Result<String, String> {
        match obeyed(words) {
            Ok(control) => self.control(control).map_err(|error| error.to_string())?,
            Err(said) => return said,
        }
        Ok(String::new())
    }
}
