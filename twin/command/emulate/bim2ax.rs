//! A BIM2AX module.

use super::control::{Obeys, Switch, parsed};
use super::{Common, Failure, Status, serve};
use crate::clock::Clock;
use twin_drives::bim2ax::emulator::{EmulatedModule, EmulatorOptions, ModuleFaults, ModuleOptions};
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
    /// Interrupts are lost
    Deaf {
        #[arg(value_enum)]
        state: Switch,
    },
    /// What the module says is not refreshed
    Frozen {
        #[arg(value_enum)]
        state: Switch,
    },
    /// Interrupts take effect so many ms later
    Late { ms: u32 },
    /// The supply fails for a moment
    BrownOut,
    /// The check sum of the EEPROM is wrong
    SpoilEeprom,
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

impl Obeys for EmulatedModule {
    fn obey(&mut self, words: &[&str]) -> Result<String, String> {
        parsed::<Word>(words, |word| {
            let mut module = self.module();
            let mut surroundings = *module.surroundings();
            let mut faults: ModuleFaults = module.faults();
            let place = |axis: u8| usize::from(axis.saturating_sub(1));
            match word {
                Word::Contact { axis, contact, state } => {
                    let bench = surroundings.benches.get_mut(place(axis)).ok_or("no such axis")?;
                    let slot = match contact {
                        ContactWord::Plus => &mut bench.plus,
                        ContactWord::Minus => &mut bench.minus,
                        ContactWord::Cam => &mut bench.cam,
                    };
                    // One that nothing actuates.
                    let nowhere = Contact::between(i64::MAX, i64::MAX, true);
                    slot.get_or_insert(nowhere).stuck = match state {
                        ContactState::On => Some(true),
                        ContactState::Off => Some(false),
                        ContactState::Free => None,
                    };
                }
                Word::Place { axis, contact, low, high } => {
                    let bench = surroundings.benches.get_mut(place(axis)).ok_or("no such axis")?;
                    let found = Some(Contact::between(low, high, true));
                    match contact {
                        ContactWord::Plus => bench.plus = found,
                        ContactWord::Minus => bench.minus = found,
                        ContactWord::Cam => bench.cam = found,
                    }
                }
                Word::Motor { axis, what, state } => {
                    let bench = surroundings.benches.get_mut(place(axis)).ok_or("no such axis")?;
                    match what {
                        MotorWord::Power => bench.power = state.is_on(),
                        MotorWord::PhaseOpen => bench.phase_open = state.is_on(),
                        MotorWord::PhaseShort => bench.phase_short = state.is_on(),
                        MotorWord::Stalled => bench.stalled = state.is_on(),
                    }
                }
                Word::Deaf { state } => faults.deaf = state.is_on(),
                Word::Frozen { state } => faults.frozen = state.is_on(),
                Word::Late { ms } => faults.late_ns = i64::from(ms) * 1_000_000,
                Word::BrownOut => module.brown_out(),
                Word::SpoilEeprom => module.spoil_eeprom(),
            }
            module.set_surroundings(&surroundings);
            module.set_faults(&faults);
            Ok(String::new())
        })
    }
}
