//! A BIM2AX module.

use super::control::{Obeys, Switch, parsed};
use super::wire::{LATER, WireWord, nanoseconds, put_off};
use super::{Common, Failure, Status, serve};
use crate::clock::Clock;
use twin_drives::Speed;
use twin_drives::bim2ax::emulator::{
    Control, EmulatedModule, EmulatorOptions, Event, ModuleOptions, Surroundings,
};
use twin_drives::bim2ax::{Bench, ByteOrder, Contact, ModuleAxis};

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
        speed: Speed::times(options.common.speed),
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
#[command(no_binary_name = true, disable_help_flag = true, after_help = LATER)]
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

impl ContactWord {
    fn of(self, bench: &mut Bench) -> &mut Option<Contact> {
        match self {
            Self::Plus => &mut bench.plus,
            Self::Minus => &mut bench.minus,
            Self::Cam => &mut bench.cam,
        }
    }
}

impl Word {
    /// What it does to a module with these surroundings.
    fn control(self, mut surroundings: Surroundings) -> Result<Control, String> {
        let mut contact =
            |axis: u8, contact: ContactWord, change: &dyn Fn(&mut Option<Contact>)| {
                let bench = surroundings.benches.get_mut(usize::from(axis.saturating_sub(1)));
                change(contact.of(bench.ok_or("no such axis")?));
                Ok::<_, String>(Event::Surroundings(Box::new(surroundings)))
            };
        Ok(Control::Event(match self {
            Self::Wire(word) => return word.control(),
            Self::Contact { axis, contact: which, state } => contact(axis, which, &|found| {
                // One that nothing actuates.
                let nowhere = Contact::between(i64::MAX, i64::MAX, true);
                found.get_or_insert(nowhere).stuck = match state {
                    ContactState::On => Some(true),
                    ContactState::Off => Some(false),
                    ContactState::Free => None,
                };
            })?,
            Self::Place { axis, contact: which, low, high } => {
                contact(axis, which, &|found| *found = Some(Contact::between(low, high, true)))?
            }
            Self::Motor { axis, what, state } => {
                let axis = if axis == 1 { ModuleAxis::One } else { ModuleAxis::Two };
                match what {
                    MotorWord::Power => Event::Power(axis, state.is_on()),
                    MotorWord::PhaseOpen => Event::PhaseOpen(axis, state.is_on()),
                    MotorWord::PhaseShort => Event::PhaseShort(axis, state.is_on()),
                    MotorWord::Stalled => Event::Stall(axis, state.is_on()),
                }
            }
            Self::StuckStatus { state } => Event::StuckStatus(state.is_on()),
            Self::BrownOut { ms } => Event::BrownOut { off_ns: nanoseconds(ms) },
            Self::SpoilEeprom => Event::SpoilEeprom,
        }))
    }
}

impl Obeys for EmulatedModule {
    fn obey(&mut self, words: &[&str]) -> Result<String, String> {
        let (requests, words) = put_off(words)?;
        parsed::<Word>(words, |word| {
            let surroundings = *self.module().surroundings();
            EmulatedModule::control(self, word.control(surroundings)?.after(requests));
            Ok(String::new())
        })
    }
}
