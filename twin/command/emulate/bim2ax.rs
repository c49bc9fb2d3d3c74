//! A BIM2AX module.

use super::control::{Obeys, Switch};
use super::faults::{self, Said, WireWord};
use super::{Common, Failure, Status, serve};
use crate::clock::Clock;
use twin_drives::bim2ax::emulator::{
    Control, EmulatedModule, EmulatorOptions, Event, ModuleOptions, Surroundings,
};
use twin_drives::bim2ax::{ByteOrder, Contact, ModuleAxis};

#[derive(Debug, clap::Args)]
pub(super) struct Options {
    #[command(flatten)]
    common: Common,

    /// Byte order of its numbers; the manual is silent
    #[arg(long, value_enum, default_value = "big")]
    byte_order: OrderWord,

    /// Version of its software; from 15 on, several zones go with one interrupt
    #[arg(long, default_value_t = 15)]
    software: u16,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum OrderWord {
    Big,
    Little,
}

pub(super) fn run(options: &Options) -> Result<Status, Failure> {
    let byte_order = match options.byte_order {
        OrderWord::Big => ByteOrder::Big,
        OrderWord::Little => ByteOrder::Little,
    };
    let module =
        ModuleOptions { byte_order, version: options.software, ..ModuleOptions::default() };
    let emulator = EmulatorOptions {
        module,
        eeprom: options.common.eeprom.clone(),
        seed: options.common.seed,
        speed: options.common.speed(),
        ..EmulatorOptions::new(&options.common.link)
    };
    let clock = Clock::start();
    let mut running = EmulatedModule::start(&emulator, move || clock.now_ns())?;
    eprintln!("BIM2AX-BOCM, memory file {}", running.path().display());
    serve(&options.common, &mut running)?;
    let module = running.stop()?;
    let positions = ModuleAxis::ALL.map(|axis| module.position(axis));
    eprintln!("{} interrupts served; positions {positions:?}", module.served());
    Ok(Status::Fit)
}

/// What can be done to a module.
#[derive(Debug, clap::Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
enum Word {
    /// A contact of an axis that is always closed (on) or open (off) from now on, or obeys the axis again
    Contact {
        #[arg(value_parser = clap::value_parser!(u8).range(1..=2))]
        axis: u8,
        #[arg(value_enum)]
        contact: ContactWord,
        #[arg(value_enum)]
        state: ContactState,
    },
    /// Where a contact is actuated, whole µsteps of the shaft
    Place {
        #[arg(value_parser = clap::value_parser!(u8).range(1..=2))]
        axis: u8,
        #[arg(value_enum)]
        contact: ContactWord,
        #[arg(allow_negative_numbers = true)]
        low: i64,
        #[arg(allow_negative_numbers = true)]
        high: i64,
    },
    /// Power, phases, or a shaft that is held
    Motor {
        #[arg(value_parser = clap::value_parser!(u8).range(1..=2))]
        axis: u8,
        #[arg(value_enum)]
        what: MotorWord,
        #[arg(value_enum)]
        state: Switch,
    },
    /// The shaft of an axis is held, as by `motor AXIS stalled`
    Stall {
        #[arg(value_parser = clap::value_parser!(u8).range(1..=2))]
        axis: u8,
        #[arg(value_enum)]
        state: Switch,
    },
    /// Positions and axis messages stay as they are now
    StuckStatus {
        #[arg(value_enum)]
        state: Switch,
    },
    /// The supply fails, for so many ms
    BrownOut {
        #[arg(default_value_t = 100)]
        ms: u32,
    },
    /// The check sum of the EEPROM is wrong
    SpoilEeprom,
    #[command(flatten)]
    Wire(WireWord),
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

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum MotorWord {
    Power,
    PhaseOpen,
    PhaseShort,
    Stalled,
}

impl Word {
    /// What happens to a module with these surroundings.
    fn control(self, mut surroundings: Surroundings) -> Result<Control, Said> {
        let axis = |axis: u8| if axis == 1 { ModuleAxis::One } else { ModuleAxis::Two };
        let event = match self {
            Self::Wire(word) => return word.control(|words| obeyed(words, surroundings)),
            Self::Contact { axis: number, contact, state } => {
                let slot = contact.of(&mut surroundings, axis(number))?;
                // One that nothing actuates.
                let nowhere = Contact::between(i64::MAX, i64::MAX, true);
                slot.get_or_insert(nowhere).stuck = match state {
                    ContactState::On => Some(true),
                    ContactState::Off => Some(false),
                    ContactState::Free => None,
                };
                Event::Surroundings(Box::new(surroundings))
            }
            Self::Place { axis: number, contact, low, high } => {
                *contact.of(&mut surroundings, axis(number))? =
                    Some(Contact::between(low, high, true));
                Event::Surroundings(Box::new(surroundings))
            }
            Self::Motor { axis: number, what, state } => match what {
                MotorWord::Power => Event::Power(axis(number), state.is_on()),
                MotorWord::PhaseOpen => Event::PhaseOpen(axis(number), state.is_on()),
                MotorWord::PhaseShort => Event::PhaseShort(axis(number), state.is_on()),
                MotorWord::Stalled => Event::Stall(axis(number), state.is_on()),
            },
            Self::Stall { axis: number, state } => Event::Stall(axis(number), state.is_on()),
            Self::StuckStatus { state } => Event::StuckStatus(state.is_on()),
            Self::BrownOut { ms } => Event::BrownOut { off_ns: i64::from(ms) * 1_000_000 },
            Self::SpoilEeprom => Event::SpoilEeprom,
        };
        Ok(Control::Event(event))
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
