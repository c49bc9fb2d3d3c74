//! `SmartDRIVE`s on a bus.

use super::bench::{self, stretch};
use super::control::{Obeys, Switch, one_of};
use super::faults::{self, Carrier, Said, WireWord};
use super::{Common, Failure, Status, milliseconds, serve};
use std::collections::HashSet;
use std::path::PathBuf;
use std::time::Duration;
use twin_smartdrive::emulator::{
    Cam, Condition, Control, DeviceOptions, EmulatedBus, EmulatorOptions, Event, Happening,
    HomingOptions, Input, Wire,
};
use twin_smartdrive::{Alarms, Mode};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    common: Common,

    /// Addresses of the drives on the bus, 1 to 31, elsewhere called stations
    #[arg(long, visible_alias = "station", value_delimiter = ',', default_value = "1", value_parser = clap::value_parser!(u8).range(1..=31))]
    address: Vec<u8>,

    /// Time a drive takes to answer, ms; the manual allows 50
    #[arg(long, default_value_t = 2.0, value_name = "MS")]
    turnaround_ms: f64,

    /// Understand masters at any speed; otherwise those at another than 115200 baud get no answer, as from a drive
    #[arg(long)]
    any_baud: bool,

    /// Release of the firmware, with the number of its build: from 310 on DONE ends homing, from 315 on homing has an alarm
    #[arg(long, default_value = "1.2.0.315", value_name = "RELEASE", value_parser = release)]
    firmware: (u16, u16),

    /// Mode that power-up and MODE 255 choose: 0 off, 1 custom, 3 remote, 4 position, 5 to 8 velocity, 9 to 12 distances
    #[arg(long, default_value = "0", value_name = "MODE", value_parser = mode)]
    power_up_mode: Mode,

    /// Commands come back before their answers, as some RS485 adapters have it
    #[arg(long)]
    echo: bool,
}

pub(super) fn run(options: &Arguments) -> Result<Status, Failure> {
    if bench::help(&options.common, |words| obeyed(words, &options.address).map(drop))? {
        return Ok(Status::Fit);
    }
    let link = options.common.link()?;
    let assumptions = options.common.assume.take()?;
    let response = milliseconds("--turnaround-ms", options.turnaround_ms)?;
    let mut seen = HashSet::new();
    if let Some(twice) = options.address.iter().find(|address| !seen.insert(**address)) {
        return Err(Failure::Usage(format!(
            "--address {twice} is given twice: each drive of a line has an address of its own"
        )));
    }
    let devices = options.address.iter().map(|address| DeviceOptions {
        address: *address,
        release: options.firmware.0,
        build: options.firmware.1,
        configured_mode: options.power_up_mode,
        assumptions,
        ..DeviceOptions::default()
    });
    let mut devices: Vec<_> = devices.collect();
    let afterwards = bench::set_up(&options.common, |words| {
        let later = obeyed(words, &options.address)?;
        let Control::Event(Happening { device, event }) = later else { return Ok(Some(later)) };
        let Some(device) = devices.get_mut(device) else { return Ok(Some(later)) };
        match event {
            Event::Cam { input, from, to } => {
                device.cams.push(Cam { input, from: from.into(), to: to.into() });
            }
            Event::NoCams(input) => device.cams.retain(|cam| cam.input != input),
            Event::Homing(homing) => device.homing = homing,
            _ => return Ok(Some(later)),
        }
        Ok(None)
    })?;
    let files = options.address.iter().filter_map(|address| flash_file(options, *address));
    let emulator = EmulatorOptions {
        devices,
        flash: Vec::new(),
        files: files.collect(),
        wire: Wire { response, echo: options.echo, ..Wire::default() },
        link: Some(link.to_owned()),
        any_speed: options.any_baud,
        seed: options.common.seed,
        speed: options.common.speed(),
    };
    let (console, bus) = options.common.start(|clock| EmulatedBus::start(&emulator, clock))?;
    afterwards.into_iter().try_for_each(|what| bus.control(what))?;
    stderr!(
        "SmartDRIVE, addresses {:?}, on {} ({})",
        options.address,
        link.display(),
        bus.path().display()
    );
    let mut bus = Bus { bus, addresses: options.address.clone() };
    serve(console, &mut bus)?;
    let devices = bus.bus.stop()?;
    for (device, address) in devices.iter().zip(&options.address) {
        stderr!(
            "address {address}: {} frames, position {}",
            device.frames_handled(),
            device.counter()
        );
    }
    Ok(Status::Fit)
}

/// MAJOR.MINOR.CORRECTION, and the build behind them; as the drive tells it.
fn release(text: &str) -> Result<(u16, u16), String> {
    let wrong = || format!("{text}: a release is like 1.2.0 or 1.2.0.315");
    let numbers: Result<Vec<u16>, _> = text.split('.').map(str::parse).collect();
    let (major, minor, correction, build) = match numbers.map_err(|_other| wrong())?[..] {
        [major, minor, correction] => (major, minor, correction, DeviceOptions::default().build),
        [major, minor, correction, build] => (major, minor, correction, build),
        _ => return Err(wrong()),
    };
    if major > 15 || minor > 255 || correction > 15 {
        return Err(format!("{text}: a drive tells 15.255.15 at most"));
    }
    Ok((major << 12 | minor << 4 | correction, build))
}

fn mode(text: &str) -> Result<Mode, String> {
    let known = text.parse().ok().and_then(Mode::from_number);
    known.ok_or_else(|| format!("there is no mode {text}: 0, 1 and 3 to 12 are"))
}

/// Where a drive keeps its flash memory: one file each.
fn flash_file(options: &Arguments, address: u8) -> Option<PathBuf> {
    let path = options.common.eeprom.clone()?;
    if options.address.len() == 1 {
        return Some(path);
    }
    let mut name = path.into_os_string();
    name.push(format!(".{address}"));
    Some(name.into())
}

/// The bus, and which drive is where on it.
struct Bus {
    bus: EmulatedBus,
    addresses: Vec<u8>,
}

/// What can be done to drives, each by its address, and to their line.
#[derive(Debug, clap::Parser)]
#[command(no_binary_name = true, disable_help_flag = true, override_usage = "WORD ...")]
enum Word {
    /// An input
    Input {
        address: u8,
        #[arg(value_parser = one_of(&INPUTS))]
        input: Input,
        #[arg(value_enum)]
        state: Switch,
    },
    /// One more switch at an input, active while the axis is on a stretch: a home or limit switch
    Cam {
        address: u8,
        #[arg(value_parser = one_of(&INPUTS))]
        input: Input,
        /// FROM..TO, µsteps from where the axis stood at the start; without an end: from there on, or up to there
        #[arg(value_parser = stretch, allow_hyphen_values = true)]
        range: (Option<i32>, Option<i32>),
    },
    /// All switches at an input are taken away
    NoCams {
        address: u8,
        #[arg(value_parser = one_of(&INPUTS))]
        input: Input,
    },
    /// Homing looks for a switch at this input, towards smaller positions; the manual does not say where it is chosen
    Homing {
        address: u8,
        #[arg(value_parser = one_of(&INPUTS))]
        input: Input,
        /// Towards larger positions
        #[arg(long)]
        positive: bool,
        /// Given up after so many s
        #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u16).range(1..=3600))]
        timeout: u16,
    },
    /// Analog input 1 or 2, 0 to 32767
    Analog {
        address: u8,
        #[arg(value_parser = clap::value_parser!(u8).range(1..=2))]
        number: u8,
        #[arg(value_parser = clap::value_parser!(u16).range(0..=32_767))]
        value: u16,
    },
    /// The supply, V; below 9 the drive stops, and boots when it is back
    Supply { address: u8, volts: u16 },
    /// The cause of an alarm
    Alarm {
        address: u8,
        #[arg(value_parser = one_of(&ALARMS))]
        alarm: Alarms,
        #[arg(value_enum)]
        state: Switch,
    },
    /// The rotor is blocked for a moment
    Stall { address: u8 },
    /// A bit of the status of which the manual does not say what sets it; a new motion clears the last
    Condition {
        address: u8,
        #[arg(value_parser = one_of(&CONDITIONS))]
        condition: Condition,
        #[arg(value_enum)]
        state: Switch,
    },
    /// Status, position and flags stay as they are now
    StuckStatus {
        address: u8,
        #[arg(value_enum)]
        state: Switch,
    },
    /// The next N moves are confirmed and not carried out
    IgnoreMoves { address: u8, moves: u32 },
    /// The supply fails, for so many ms
    BrownOut {
        address: u8,
        #[arg(default_value_t = 100)]
        ms: u32,
    },
    #[command(flatten)]
    Wire(WireWord),
}

const INPUTS: [(&str, Input); 5] = [
    ("go", Input::Go),
    ("dir", Input::Dir),
    ("off", Input::Off),
    ("limp", Input::LimP),
    ("limn", Input::LimN),
];
const ALARMS: [(&str, Alarms); 4] = [
    ("power-driver", Alarms::POWER_DRIVER),
    ("overtemperature", Alarms::OVERTEMPERATURE),
    ("current-probes", Alarms::CURRENT_PROBES),
    ("oscillator", Alarms::OSCILLATOR),
];
const CONDITIONS: [(&str, Condition); 3] = [
    ("signalled", Condition::Signalled),
    ("busy", Condition::Busy),
    ("triggered", Condition::Triggered),
];

impl Word {
    /// What happens, and the address of the drive.
    fn event(self, addresses: &[u8]) -> Result<Control, Said> {
        let (address, event) = match self {
            Self::Wire(word) => {
                return word.control(Carrier::Wire, |words| obeyed(words, addresses));
            }
            Self::Input { address, input, state } => {
                (address, Event::Input { input, level: state.is_on() })
            }
            Self::Cam { address, input, range: (from, to) } => {
                let (from, to) = (from.unwrap_or(i32::MIN), to.unwrap_or(i32::MAX));
                (address, Event::Cam { input, from, to })
            }
            Self::NoCams { address, input } => (address, Event::NoCams(input)),
            Self::Homing { address, input, positive, timeout } => {
                let timeout = Duration::from_secs(timeout.into());
                (address, Event::Homing(HomingOptions { input, positive, timeout }))
            }
            Self::Analog { address, number, value } => (address, Event::Analog { number, value }),
            Self::Supply { address, volts } => (address, Event::Supply(volts)),
            Self::Alarm { address, alarm, state } => {
                (address, Event::Fault { alarms: alarm, present: state.is_on() })
            }
            Self::Stall { address } => (address, Event::Stall),
            Self::Condition { address, condition, state } => {
                (address, Event::Condition(condition, state.is_on()))
            }
            Self::IgnoreMoves { address, moves } => (address, Event::IgnoreMoves(moves)),
            Self::StuckStatus { address, state } => (address, Event::StuckStatus(state.is_on())),
            Self::BrownOut { address, ms } => {
                (address, Event::BrownOut { off_ns: i64::from(ms) * 1_000_000 })
            }
        };
        let place = addresses.iter().position(|other| *other == address);
        place
            .map(|place| event.to(place))
            .ok_or_else(|| Err(format!("no drive has address {address}; there are {addresses:?}")))
    }
}

fn obeyed(words: &[&str], addresses: &[u8]) -> Result<Control, Said> {
    faults::control(words, |word: Word| word.event(addresses))
}

impl Obeys for Bus {
    fn obey(&mut self, words: &[&str]) -> Result<String, String> {
        match obeyed(words, &self.addresses) {
            Ok(control) => self.bus.control(control).map_err(|error| error.to_string())?,
            Err(said) => return said,
        }
        Ok(String::new())
    }
}
