//! An InterpCNC board.

use super::bench::{self, stretch};
use super::control::{Obeys, Switch, one_of};
use super::faults::{self, Carrier, Said, WireWord};
use super::{Common, Failure, Status, milliseconds, serve};
use twin_interpcnc::emulator::{
    Bench, BoardOptions, Cam, Condition, Control, EmulatedBoard, EmulatorOptions, EncoderLink,
    Event, Wire,
};
use twin_interpcnc::{BoardAxis, Line, Parity};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    common: Common,

    /// Address of the board; Modbus calls it station
    #[arg(long, visible_alias = "station", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=247))]
    address: u8,

    /// Bits per second; the time bytes need on the wire is emulated
    #[arg(long, default_value_t = 115_200, value_parser = clap::value_parser!(u32).range(4800..=256_000))]
    baud: u32,

    /// Parity; a pseudo-terminal does not tell that of a master
    #[arg(long, default_value = "none", value_parser = one_of(&PARITIES))]
    parity: Parity,

    /// Understand masters at any speed; otherwise those at another than --baud get no answer, as from a board
    #[arg(long)]
    any_baud: bool,

    /// Time the board takes to answer, ms
    #[arg(long, default_value_t = 2.0, value_name = "MS")]
    turnaround_ms: f64,

    /// Leave the ENABLE input open: the board stays locked
    #[arg(long)]
    enable_open: bool,

    /// A board older than V2.1D: it has neither encoder nor counters
    #[arg(long = "older-than-v2.1d")]
    older: bool,
}

/// Parities by their words.
pub(in crate::command) const PARITIES: [(&str, Parity); 3] =
    [("none", Parity::None), ("even", Parity::Even), ("odd", Parity::Odd)];
const AXES: [(&str, BoardAxis); 5] = [
    ("x", BoardAxis::X),
    ("y", BoardAxis::Y),
    ("z", BoardAxis::Z),
    ("a", BoardAxis::A),
    ("b", BoardAxis::B),
];
const CONDITIONS: [(&str, Condition); 10] = [
    ("buffer-frozen", Condition::BufferFrozen),
    ("overridden", Condition::Overridden),
    ("override-allowed", Condition::OverrideAllowed),
    ("waiting-for-input", Condition::WaitingForInput),
    ("wait-timeout", Condition::WaitTimeout),
    ("height-control", Condition::HeightControl),
    ("basic-tx-overrun", Condition::BasicTxOverrun),
    ("basic-rx-overrun", Condition::BasicRxOverrun),
    ("basic-running", Condition::BasicRunning),
    ("recipes-changed", Condition::RecipesChanged),
];

pub(super) fn run(options: &Arguments) -> Result<Status, Failure> {
    if bench::help(&options.common, |words| obeyed(words, &Bench::default()).map(drop))? {
        return Ok(Status::Fit);
    }
    let link = options.common.link()?;
    let assumptions = options.common.assume.take()?;
    let turnaround = milliseconds("--turnaround-ms", options.turnaround_ms)?;
    let line = Line { baud: options.baud, parity: options.parity };
    let enable = !options.enable_open;
    let mut bench = Bench::default();
    let afterwards = bench::set_up(&options.common, |words| {
        Ok(match obeyed(words, &bench)? {
            Control::Event(Event::Bench(changed)) => {
                bench = changed;
                None
            }
            later => Some(later),
        })
    })?;
    let emulator = EmulatorOptions {
        bench,
        board: BoardOptions {
            address: options.address,
            line,
            enable,
            counts: !options.older,
            assumptions,
        },
        wire: Wire { line, turnaround },
        link: Some(link.to_owned()),
        any_speed: options.any_baud,
        eeprom: options.common.eeprom.clone(),
        seed: options.common.seed,
        speed: options.common.speed(),
    };
    let start = |clock| EmulatedBoard::start(&emulator, clock);
    let (console, mut running) = options.common.start(start)?;
    afterwards.into_iter().try_for_each(|what| running.control(what))?;
    stderr!(
        "InterpCNC, address {}, {} baud, on {} ({})",
        options.address,
        options.baud,
        link.display(),
        running.path().display()
    );
    serve(console, &mut running)?;
    let board = running.stop()?;
    stderr!("{} frames answered; counters {:?}", board.frames_handled(), board.counters());
    Ok(Status::Fit)
}

/// What can be done to a board.
#[derive(Debug, clap::Parser)]
#[command(no_binary_name = true, disable_help_flag = true, override_usage = "WORD ...")]
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
    /// One more switch at an input, pressed while an axis is on a stretch: a home or limit switch, or what a probe touches
    Cam {
        #[arg(value_parser = clap::value_parser!(u8).range(1..=32))]
        number: u8,
        #[arg(ignore_case = true, value_parser = one_of(&AXES))]
        axis: BoardAxis,
        /// FROM..TO, steps from where the axis stood at the start; without an end: from there on, or up to there
        #[arg(value_parser = stretch, allow_hyphen_values = true)]
        range: (Option<i32>, Option<i32>),
        /// The contact opens when it is pressed (NC)
        #[arg(long)]
        opens: bool,
    },
    /// All switches at an input are taken away
    NoCams {
        #[arg(value_parser = clap::value_parser!(u8).range(1..=32))]
        number: u8,
    },
    /// The encoder is on an axis and counts so many edges in so many steps of it
    Encoder {
        #[arg(ignore_case = true, value_parser = one_of(&AXES))]
        axis: BoardAxis,
        /// Below 0: it counts down where the axis counts up
        #[arg(allow_negative_numbers = true)]
        counts: i32,
        #[arg(value_parser = clap::value_parser!(u32).range(1..))]
        steps: u32,
        /// Counts per turn, after which the index comes [default: no index]
        #[arg(long, default_value_t = 0, hide_default_value = true)]
        turn: u32,
    },
    /// The encoder is taken away
    NoEncoder,
    /// Pulses arrive at a counter
    Pulses {
        #[arg(value_enum, ignore_case = true)]
        counter: CounterWord,
        count: u32,
    },
    /// Something that nothing on Modbus brings about is so (on) or no more (off)
    Condition {
        #[arg(value_parser = one_of(&CONDITIONS))]
        condition: Condition,
        #[arg(value_enum)]
        state: Switch,
    },
    /// The motor of an axis does not follow
    Stall {
        #[arg(ignore_case = true, value_parser = one_of(&AXES))]
        axis: BoardAxis,
        #[arg(value_enum)]
        state: Switch,
    },
    /// The status stays as it is now
    StuckStatus {
        #[arg(value_enum)]
        state: Switch,
    },
    /// The next N moves are confirmed and not carried out
    IgnoreMoves { moves: u32 },
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum CounterWord {
    A,
    B,
}

impl Word {
    /// What happens to a board on this bench.
    fn control(self, bench: &Bench) -> Result<Control, Said> {
        let mut bench = bench.clone();
        let event = match self {
            Self::Wire(word) => return word.control(Carrier::Wire, |words| obeyed(words, &bench)),
            Self::Cam { number: input, axis, range: (from, to), opens } => {
                bench.cams.push(Cam {
                    input,
                    axis,
                    from: from.unwrap_or(i32::MIN),
                    to: to.unwrap_or(i32::MAX),
                    normally_closed: opens,
                });
                Event::Bench(bench)
            }
            Self::NoCams { number } => {
                bench.cams.retain(|cam| cam.input != number);
                Event::Bench(bench)
            }
            Self::Encoder { axis, counts, steps, turn: counts_per_revolution } => {
                bench.encoder = Some(EncoderLink { axis, counts, steps, counts_per_revolution });
                Event::Bench(bench)
            }
            Self::NoEncoder => {
                bench.encoder = None;
                Event::Bench(bench)
            }
            Self::Pulses { counter, count } => {
                Event::Pulses { second: counter == CounterWord::B, count }
            }
            Self::Condition { condition, state } => Event::Condition(condition, state.is_on()),
            Self::Enable { state } => Event::Enable(state.is_on()),
            Self::Input { number, state } => Event::Input { number, level: state.is_on() },
            Self::Release { number } => Event::ReleaseInput(number),
            Self::Analog { number, value } => Event::AnalogInput { number, value },
            Self::Stall { axis, state } => Event::Stall(axis, state.is_on()),
            Self::IgnoreMoves { moves } => Event::IgnoreMoves(moves),
            Self::StuckStatus { state } => Event::StuckStatus(state.is_on()),
            Self::BreakEeprom { state } => Event::BreakEeprom(state.is_on()),
            Self::BrownOut { ms } => Event::BrownOut { off_ns: i64::from(ms) * 1_000_000 },
        };
        Ok(Control::Event(event))
    }
}

fn obeyed(words: &[&str], bench: &Bench) -> Result<Control, Said> {
    faults::control(words, |word: Word| word.control(bench))
}

impl Obeys for EmulatedBoard {
    fn obey(&mut self, words: &[&str]) -> Result<String, String> {
        let board = self.look().map_err(|error| error.to_string())?;
        match obeyed(words, board.bench()) {
            Ok(control) => self.control(control).map_err(|error| error.to_string())?,
            Err(said) => return said,
        }
        Ok(String::new())
    }
}
