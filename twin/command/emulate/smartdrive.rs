//! `SmartDRIVE`s on a bus.

use super::control::{Obeys, Switch, parsed};
use super::wire::{LATER, WireWord, nanoseconds, put_off};
use super::{Common, Failure, Status, milliseconds, serve};
use crate::clock::Clock;
use std::path::{Path, PathBuf};
use twin_drives::Speed;
use twin_drives::smartdrive::Alarms;
use twin_drives::smartdrive::emulator::{
    Control, DeviceOptions, EmulatedBus, EmulatorOptions, Event, Input, Wire,
};

#[derive(Debug, clap::Args)]
pub(super) struct Options {
    #[command(flatten)]
    common: Common,

    /// Addresses of the drives on the bus, 1 to 31
    #[arg(long, value_delimiter = ',', default_value = "1", value_parser = clap::value_parser!(u8).range(1..=31))]
    address: Vec<u8>,

    /// Time a drive takes to answer, ms; the manual allows 50
    #[arg(long, default_value_t = 2.0, value_name = "MS")]
    turnaround_ms: f64,

    /// Commands come back before their answers, as some RS485 adapters have it
    #[arg(long)]
    echo: bool,
}

pub(super) fn run(options: &Options) -> Result<Status, Failure> {
    let response = milliseconds("--turnaround-ms", options.turnaround_ms)?;
    let devices = options
        .address
        .iter()
        .map(|address| DeviceOptions { address: *address, ..DeviceOptions::default() });
    let files: Vec<_> =
        options.address.iter().map(|address| flash_file(options, *address)).collect();
    let flash = files.iter().map(|file| remembered(file.as_deref())).collect::<Result<_, _>>()?;
    let emulator = EmulatorOptions {
        devices: devices.collect(),
        flash,
        wire: Wire { response, echo: options.echo, ..Wire::default() },
        link: Some(options.common.link.clone()),
        seed: options.common.seed,
        speed: Speed::times(options.common.speed),
    };
    let clock = Clock::start();
    let bus = EmulatedBus::start(&emulator, move || clock.now_ns())?;
    eprintln!(
        "SmartDRIVE, addresses {:?}, on {} ({})",
        options.address,
        options.common.link.display(),
        bus.path().display()
    );
    let mut bus = Bus { bus, addresses: options.address.clone() };
    serve(&options.common, &mut bus)?;
    let devices = bus.bus.stop()?;
    for ((device, address), file) in devices.iter().zip(&options.address).zip(&files) {
        eprintln!(
            "address {address}: {} frames, position {}",
            device.frames_handled(),
            device.counter()
        );
        if let Some(file) = file {
            std::fs::write(file, device.flash()).map_err(|source| unusable(file, &source))?;
        }
    }
    Ok(Status::Fit)
}

/// Where a drive keeps its flash memory: one file each.
fn flash_file(options: &Options, address: u8) -> Option<PathBuf> {
    let path = options.common.eeprom.clone()?;
    if options.address.len() == 1 {
        return Some(path);
    }
    let mut name = path.into_os_string();
    name.push(format!(".{address}"));
    Some(name.into())
}

fn remembered(file: Option<&Path>) -> Result<Vec<u8>, Failure> {
    match file.filter(|file| file.exists()) {
        Some(file) => std::fs::read(file).map_err(|source| unusable(file, &source)),
        None => Ok(Vec::new()),
    }
}

fn unusable(file: &Path, source: &std::io::Error) -> Failure {
    Failure::Usage(format!("--eeprom {}: {source}", file.display()))
}

/// The bus, and which drive is where on it.
struct Bus {
    bus: EmulatedBus,
    addresses: Vec<u8>,
}

/// What can be done to the bus.
#[derive(Debug, clap::Parser)]
#[command(no_binary_name = true, disable_help_flag = true, after_help = LATER)]
#[command(before_help = "The address of a drive and a word: what happens to that drive (1 help)")]
enum Line {
    #[command(flatten)]
    Wire(WireWord),
}

/// What can be done to a drive.
#[derive(Debug, clap::Parser)]
#[command(no_binary_name = true, disable_help_flag = true, after_help = LATER)]
struct DriveLine {
    /// Address of the drive
    address: u8,
    #[command(subcommand)]
    word: Word,
}

#[derive(Debug, clap::Subcommand)]
enum Word {
    /// An input
    Input {
        #[arg(value_enum)]
        input: InputWord,
        #[arg(value_enum)]
        state: Switch,
    },
    /// Analog input 1 or 2, 0 to 32767
    Analog {
        #[arg(value_parser = clap::value_parser!(u8).range(1..=2))]
        number: u8,
        #[arg(value_parser = clap::value_parser!(u16).range(0..=32_767))]
        value: u16,
    },
    /// The supply, V; below 9 the drive stops, and boots when it is back
    Supply { volts: u16 },
    /// The cause of an alarm
    Alarm {
        #[arg(value_enum)]
        alarm: AlarmWord,
        #[arg(value_enum)]
        state: Switch,
    },
    /// The rotor is blocked for a moment
    Stall,
    /// Status and position stay as they are now
    StuckStatus {
        #[arg(value_enum)]
        state: Switch,
    },
    /// The supply fails, for so many ms
    BrownOut {
        #[arg(default_value_t = 100)]
        ms: u32,
    },
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum InputWord {
    Go,
    Dir,
    Off,
    Limp,
    Limn,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum AlarmWord {
    PowerDriver,
    Overtemperature,
    CurrentProbes,
    Oscillator,
}

impl Word {
    fn event(self) -> Event {
        match self {
            Self::Input { input, state } => {
                let input = match input {
                    InputWord::Go => Input::Go,
                    InputWord::Dir => Input::Dir,
                    InputWord::Off => Input::Off,
                    InputWord::Limp => Input::LimP,
                    InputWord::Limn => Input::LimN,
                };
                Event::Input { input, level: state.is_on() }
            }
            Self::Analog { number, value } => Event::Analog { number, value },
            Self::Supply { volts } => Event::Supply(volts),
            Self::Alarm { alarm, state } => {
                let alarms = match alarm {
                    AlarmWord::PowerDriver => Alarms::POWER_DRIVER,
                    AlarmWord::Overtemperature => Alarms::OVERTEMPERATURE,
                    AlarmWord::CurrentProbes => Alarms::CURRENT_PROBES,
                    AlarmWord::Oscillator => Alarms::OSCILLATOR,
                };
                Event::Fault { alarms, present: state.is_on() }
            }
            Self::Stall => Event::Stall,
            Self::StuckStatus { state } => Event::StuckStatus(state.is_on()),
            Self::BrownOut { ms } => Event::BrownOut { off_ns: nanoseconds(ms) },
        }
    }
}

impl Bus {
    fn control(&self, control: Control, requests: u32) -> Result<String, String> {
        self.bus.control(control.after(requests)).map_err(|error| error.to_string())?;
        Ok(String::new())
    }
}

impl Obeys for Bus {
    fn obey(&mut self, words: &[&str]) -> Result<String, String> {
        let (requests, words) = put_off(words)?;
        if words.first().is_none_or(|word| word.parse::<u8>().is_err()) {
            return parsed::<Line>(words, |Line::Wire(word)| {
                self.control(word.control()?, requests)
            });
        }
        parsed::<DriveLine>(words, |line| {
            let place = self.addresses.iter().position(|address| *address == line.address);
            let Some(place) = place else {
                return Err(format!(
                    "no drive has address {}; there are {:?}",
                    line.address, self.addresses
                ));
            };
            self.control(line.word.event().to(place), requests)
        })
    }
}
