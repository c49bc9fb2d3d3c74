//! A BIM2AX module.

use super::bench::{self, stretch};
use super::control::{Obeys, Switch, one_of};
use super::faults::{self, Carrier, Said, WireWord};
use super::{Common, Failure, Status, serve};
use clap::builder::TypedValueParser;
use twin_bim2ax::emulator::{
    Control, EmulatedModule, EmulatorOptions, Event, ModuleOptions, Surroundings,
};
use twin_bim2ax::{ByteOrder, Contact, EncoderBench, EncoderKind, ModuleAxis};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    common: Common,

    /// Byte order of its numbers; the manual is silent
    #[arg(long, default_value = "big", value_parser = one_of(&BYTE_ORDERS))]
    byte_order: ByteOrder,

    /// Version of its software; from 15 on, several zones go with one interrupt
    #[arg(long, default_value_t = 15, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..))]
    software: u16,

    /// Rating of the module, mA: 1000, 2000 or 5000
    #[arg(long, default_value_t = 2000, value_name = "MA", value_parser = rating)]
    rating_ma: u32,
}

fn rating(text: &str) -> Result<u32, String> {
    let known = text.parse().ok().filter(|rating| [1000, 2000, 5000].contains(rating));
    known.ok_or_else(|| "modules are rated 1000, 2000 or 5000 mA".to_owned())
}

const BYTE_ORDERS: [(&str, ByteOrder); 2] =
    [("big", ByteOrder::Big), ("little", ByteOrder::Little)];
const ENCODERS: [(&str, EncoderKind); 3] = [
    ("incremental", EncoderKind::Incremental),
    ("ssi", EncoderKind::Ssi),
    ("endat", EncoderKind::EnDat),
];
/// A fault of a motor that begins or ends.
type MotorFault = fn(ModuleAxis, bool) -> Event;
const MOTOR_FAULTS: [(&str, MotorFault); 4] = [
    ("power", Event::Power),
    ("phase-open", Event::PhaseOpen),
    ("phase-short", Event::PhaseShort),
    ("stalled", Event::Stall),
];

/// Axis 1 or 2.
fn axis() -> impl TypedValueParser<Value = ModuleAxis> {
    clap::value_parser!(u8)
        .range(1..=2)
        .map(|number| if number == 1 { ModuleAxis::One } else { ModuleAxis::Two })
}

pub(super) fn run(options: &Arguments) -> Result<Status, Failure> {
    if bench::help(&options.common, |words| obeyed(words, Surroundings::default()).map(drop))? {
        return Ok(Status::Fit);
    }
    let link = options.common.link()?;
    let module = ModuleOptions {
        byte_order: options.byte_order,
        version: options.software,
        rating_ma: options.rating_ma,
        assumptions: options.common.assume.take()?,
        ..ModuleOptions::default()
    };
    let mut surroundings = Surroundings::default();
    let afterwards = bench::set_up(&options.common, |words| {
        Ok(match obeyed(words, surroundings)? {
            Control::Event(Event::Surroundings(changed)) => {
                surroundings = *changed;
                None
            }
            later => Some(later),
        })
    })?;
    let emulator = EmulatorOptions {
        module,
        surroundings,
        eeprom: options.common.eeprom.clone(),
        seed: options.common.seed,
        speed: options.common.speed(),
        ..EmulatorOptions::new(link)
    };
    let start = |clock| EmulatedModule::start(&emulator, clock);
    let (console, mut running) = options.common.start(start)?;
    for what in afterwards {
        running.control(what);
    }
    stderr!("BIM2AX-BOCM, memory file {}", running.path().display());
    serve(console, &mut running)?;
    let module = running.stop()?;
    let positions = ModuleAxis::ALL.map(|axis| module.position(axis));
    stderr!("{} interrupts served; positions {positions:?}", module.served());
    Ok(Status::Fit)
}

/// What can be done to a module.
#[derive(Debug, clap::Parser)]
#[command(no_binary_name = true, disable_help_flag = true, override_usage = "WORD ...")]
enum Word {
    /// A contact of an axis that is always closed (on) or open (off) from now on, or obeys the axis again
    Contact {
        #[arg(value_parser = axis())]
        axis: ModuleAxis,
        #[arg(value_enum)]
        contact: ContactWord,
        #[arg(value_enum)]
        state: ContactState,
    },
    /// Where an end switch or a home cam is actuated
    Place {
        #[arg(value_parser = axis())]
        axis: ModuleAxis,
        #[arg(value_enum)]
        contact: ContactWord,
        /// FROM..TO, whole µsteps of the shaft, 0 where it stood at the start; without an end: from there on, or up to there
        #[arg(value_parser = stretch, allow_hyphen_values = true)]
        range: (Option<i32>, Option<i32>),
        /// The contact opens when it is actuated
        #[arg(long)]
        opens: bool,
    },
    /// An end switch or a home cam is taken away: its input is open
    Remove {
        #[arg(value_parser = axis())]
        axis: ModuleAxis,
        #[arg(value_enum)]
        contact: ContactWord,
    },
    /// The encoder of an axis; the module looks for its kind when it starts and on RESET, where its parameters declare one
    Encoder(EncoderWord),
    /// The encoder of an axis is taken away
    NoEncoder {
        #[arg(value_parser = axis())]
        axis: ModuleAxis,
    },
    /// The plug of an axis has this value, 0 to 4294967294
    AxisPlug {
        #[arg(value_parser = axis())]
        axis: ModuleAxis,
        #[arg(value_parser = clap::value_parser!(u32).range(..i64::from(u32::MAX)))]
        value: u32,
    },
    /// The plug of an axis is pulled out
    NoAxisPlug {
        #[arg(value_parser = axis())]
        axis: ModuleAxis,
    },
    /// Power, phases, or a shaft that is held
    Motor {
        #[arg(value_parser = axis())]
        axis: ModuleAxis,
        #[arg(value_parser = one_of(&MOTOR_FAULTS))]
        what: fn(ModuleAxis, bool) -> Event,
        #[arg(value_enum)]
        state: Switch,
    },
    /// The shaft of an axis is held, as by `motor AXIS stalled`
    Stall {
        #[arg(value_parser = axis())]
        axis: ModuleAxis,
        #[arg(value_enum)]
        state: Switch,
    },
    /// Positions and axis messages stay as they are now
    StuckStatus {
        #[arg(value_enum)]
        state: Switch,
    },
    /// The next N moves are confirmed and not carried out
    IgnoreMoves { moves: u32 },
    /// The supply fails, for so many ms
    BrownOut {
        #[arg(default_value_t = 100)]
        ms: u32,
    },
    /// The check sum of the EEPROM is wrong from the next RESET or start on
    SpoilEeprom,
    #[command(flatten)]
    Wire(WireWord),
}

/// An encoder on the shaft of an axis.
#[derive(Clone, Copy, Debug, clap::Args)]
#[expect(clippy::struct_excessive_bools, reason = "independent switches of a command")]
struct EncoderWord {
    #[arg(value_parser = axis())]
    axis: ModuleAxis,
    #[arg(value_parser = one_of(&ENCODERS))]
    kind: EncoderKind,
    /// Points per turn: lines × 4 of an incremental encoder
    #[arg(long, default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..))]
    points: u32,
    /// µsteps of the shaft per turn
    #[arg(long, default_value_t = 3200, value_parser = clap::value_parser!(u32).range(1..))]
    microsteps: u32,
    /// It counts down where the shaft counts up
    #[arg(long)]
    inverted: bool,
    /// Points that an absolute encoder shows with the shaft at 0
    #[arg(long, default_value_t = 0, allow_negative_numbers = true)]
    origin: i64,
    /// Bits of an absolute encoder
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u8).range(1..=32))]
    bits: u8,
    /// An SSI encoder that speaks Gray code
    #[arg(long)]
    gray: bool,
    /// An SSI encoder that sends parity
    #[arg(long)]
    parity: bool,
    /// An incremental encoder without the complements of A and B
    #[arg(long)]
    single_ended: bool,
    /// It does not answer, or a channel is missing
    #[arg(long)]
    disconnected: bool,
    /// The alarm bit of an EnDat encoder
    #[arg(long)]
    alarm: bool,
}

impl EncoderWord {
    fn bench(self) -> EncoderBench {
        EncoderBench {
            kind: Some(self.kind),
            points_per_turn: self.points,
            microsteps_per_turn: self.microsteps,
            inverted: self.inverted,
            origin: self.origin,
            bits: self.bits,
            gray: self.gray,
            parity: self.parity,
            complemented: !self.single_ended,
            disconnected: self.disconnected,
            alarm: self.alarm,
        }
    }
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ContactWord {
    Plus,
    Minus,
    Cam,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ContactState {
    On,
    Off,
    Free,
}

impl Word {
    /// What happens to a module with these surroundings.
    fn control(self, mut surroundings: Surroundings) -> Result<Control, Said> {
        let event = match self {
            Self::Wire(word) => {
                return word.control(Carrier::Bus, |words| obeyed(words, surroundings));
            }
            Self::Contact { axis, contact, state } => {
                let slot = contact.of(&mut surroundings, axis)?;
                // One that nothing actuates.
                let nowhere = Contact::between(i64::MAX, i64::MAX, true);
                slot.get_or_insert(nowhere).stuck = match state {
                    ContactState::On => Some(true),
                    ContactState::Off => Some(false),
                    ContactState::Free => None,
                };
                Event::Surroundings(Box::new(surroundings))
            }
            Self::Place { axis, contact, range: (low, high), opens } => {
                let low = low.map_or(i64::MIN, i64::from);
                let high = high.map_or(i64::MAX, i64::from);
                *contact.of(&mut surroundings, axis)? = Some(Contact::between(low, high, !opens));
                Event::Surroundings(Box::new(surroundings))
            }
            Self::Remove { axis, contact } => {
                *contact.of(&mut surroundings, axis)? = None;
                Event::Surroundings(Box::new(surroundings))
            }
            Self::Encoder(encoder) => {
                put(&mut surroundings.encoders, encoder.axis, Some(encoder.bench()));
                Event::Surroundings(Box::new(surroundings))
            }
            Self::NoEncoder { axis } => {
                put(&mut surroundings.encoders, axis, None);
                Event::Surroundings(Box::new(surroundings))
            }
            Self::AxisPlug { axis, value } => {
                put(&mut surroundings.plugs, axis, Some(value));
                Event::Surroundings(Box::new(surroundings))
            }
            Self::NoAxisPlug { axis } => {
                put(&mut surroundings.plugs, axis, None);
                Event::Surroundings(Box::new(surroundings))
            }
            Self::Motor { axis, what, state } => what(axis, state.is_on()),
            Self::Stall { axis, state } => Event::Stall(axis, state.is_on()),
            Self::IgnoreMoves { moves } => Event::IgnoreMoves(moves),
            Self::StuckStatus { state } => Event::StuckStatus(state.is_on()),
            Self::BrownOut { ms } => Event::BrownOut { off_ns: i64::from(ms) * 1_000_000 },
            Self::SpoilEeprom => Event::SpoilEeprom,
        };
        Ok(Control::Event(event))
    }
}

/// What an axis has of something from now on.
fn put<T>(slots: &mut [Option<T>], axis: ModuleAxis, value: Option<T>) {
    if let Some(slot) = slots.get_mut(axis.index()) {
        *slot = value;
    }
}

impl ContactWord {
    /// The contact at an axis.
    fn of(
        self,
        surroundings: &mut Surroundings,
        axis: ModuleAxis,
    ) -> Result<&mut Option<Contact>, Said> {
        let bench = surroundings.benches.get_mut(axis.index());
        let bench = bench.ok_or_else(|| Err("no such axis".to_owned()))?;
        Ok(match self {
            Self::Plus => &mut bench.plus,
            Self::Minus => &mut bench.minus,
            Self::Cam => &mut bench.cam,
        })
    }
}

fn obeyed(words: &[&str], surroundings: Surroundings) -> Result<Control, Said> {
    faults::control(words, |word: Word| word.control(surroundings))
}

impl Obeys for EmulatedModule {
    fn obey(&mut self, words: &[&str]) -> Result<String, String> {
        let surroundings = *self.module().surroundings();
        match obeyed(words, surroundings) {
            Ok(control) => self.control(control),
            Err(said) => return said,
        }
        Ok(String::new())
    }
}
