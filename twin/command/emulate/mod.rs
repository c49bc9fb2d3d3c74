//! `twin emulate`: a drive without hardware, for any master.

mod bench;
mod bim2ax;
mod control;
mod faults;
mod interpcnc;
mod smartdrive;

use super::assume::Assume;
use super::{Failure, Status, run};
use crate::clock::Clock;
pub(super) use control::one_of;
use control::{Console, Obeys};
pub(super) use interpcnc::PARITIES;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;
use twin_drives::family::DeviceClock;
use twin_drives::{EmulatorError, Speed};

/// How often the control socket is looked at.
const PAUSE: Duration = Duration::from_millis(20);

/// Emulate a drive, for any master to talk to
///
/// Serves until Ctrl-C. The device answers as the manual says and moves in real time, or faster (`--speed`). Words describe
/// its surroundings: `--with` and the lines of a file (`--bench`) before it starts, the socket of `--control` while it runs.
/// `--with help` lists the words. A home switch and an encoder, for instance:
///
///   twin emulate interpcnc --link /tmp/board --with "cam 5 X -3000..-1500" --with "encoder X 4000 3200"
///   twin emulate smartdrive --link /tmp/bus --with "cam 1 dir -3000..-1000" --with "homing 1 dir"
///   twin emulate bim2ax --link /tmp/module --with "place 1 cam -900..-400" --with "encoder 1 incremental"
///
/// Through the socket, a line at a time, switches are pressed and things go wrong; the same words make the same faults of
/// all three:
///
///   twin emulate interpcnc --link /tmp/board --control /tmp/board.control
///   echo "input 3 on" | nc -U -N /tmp/board.control
///   echo "fault answer drop --next 1" | nc -U -N /tmp/board.control
///   echo "after 20 brown-out" | nc -U -N /tmp/board.control
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct Arguments {
    #[command(subcommand)]
    device: Device,
}

subcommands!(Device {
    /// SOPROLEC InterpCNC V2.1: five step axes on Modbus RTU, on a pseudo-terminal
    ///
    /// For instance, with the port at /tmp/board:
    ///   mbpoll -m rtu -b 115200 -P none -0 -B -t 3:int -r 1026 -c 5 -1 /tmp/board
    #[command(verbatim_doc_comment)]
    Interpcnc(interpcnc),

    /// SmartDRIVE v1.2: one or more drives on a bus (ATB), on a pseudo-terminal
    Smartdrive(smartdrive),

    /// BIM2AX-BOCM: a module for two axes, its dual-port RAM in a memory file
    Bim2ax(bim2ax),
});

/// What all of them have.
#[derive(Debug, clap::Args)]
struct Common {
    /// Symbolic link to make to the pseudo-terminal (bim2ax: the memory file), without which nothing is emulated; removed at
    /// the end. One that is left of an emulator that has ended is replaced, one that is in use is refused
    #[arg(long, value_name = "PATH")]
    link: Option<PathBuf>,

    /// Unix socket to make that takes commands, a line each
    #[arg(long, value_name = "PATH")]
    control: Option<PathBuf>,

    /// Surroundings of the device and events that happen to it, in words of the control socket, before it starts; may be given
    /// several times. `--with help` lists the words, `--with "help fault"` explains one
    #[arg(long, value_name = "WORDS")]
    with: Vec<String>,

    /// File of such words, a line each, before those of --with; what follows a # is a comment
    #[arg(long, value_name = "FILE")]
    bench: Vec<PathBuf>,

    #[command(flatten)]
    assume: Assume,

    /// File that keeps what the device stores (EEPROM, flash) from one start to the next
    #[arg(long, value_name = "FILE")]
    eeprom: Option<PathBuf>,

    /// Factor by which it is faster than the clock, delays of the wire included; a master's deadlines are its own
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(Speed::MOST)))]
    speed: u32,

    /// Seed of faults by chance
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

impl Common {
    /// Where the device is to be.
    fn link(&self) -> Result<&Path, Failure> {
        let missing = "--link PATH is missing, the path at which masters open the device, like --link /tmp/device";
        self.link.as_deref().ok_or_else(|| Failure::Usage(missing.to_owned()))
    }

    /// The control socket, if there is to be one: before the device, which is said to be there when all of it is.
    fn console(&self) -> Result<Option<Console>, Failure> {
        let open = |path: &PathBuf| {
            let named = |source: io::Error| {
                let why = match source.kind() {
                    io::ErrorKind::AddrInUse => {
                        "it is in use; remove it or choose another path".to_owned()
                    }
                    _ => source.to_string(),
                };
                Failure::Usage(format!("--control {}: {why}", path.display()))
            };
            Console::open(path).map_err(named)
        };
        self.control.as_ref().map(open).transpose()
    }

    /// Opens the control socket and starts the emulator on a clock of its own.
    fn start<E>(
        &self,
        start: impl FnOnce(DeviceClock) -> Result<E, EmulatorError>,
    ) -> Result<(Option<Console>, E), Failure> {
        let (console, clock) = (self.console()?, Clock::start());
        let running = start(Box::new(move || clock.now_ns()));
        Ok((console, running.map_err(|error| self.named(error))?))
    }

    /// With the option that has named the file.
    fn named(&self, error: EmulatorError) -> Failure {
        // Of several drives on a line each has a file, with its address after the name.
        let starts = |path: &Path, with: &Option<PathBuf>| {
            let given = with.as_ref().map(|with| with.as_os_str().as_encoded_bytes());
            given.is_some_and(|given| path.as_os_str().as_encoded_bytes().starts_with(given))
        };
        match &error {
            EmulatorError::File { path, .. } if starts(path, &self.eeprom) => {
                Failure::Usage(format!("--eeprom {error}"))
            }
            EmulatorError::File { .. } | EmulatorError::LinkTaken { .. } => {
                Failure::Usage(format!("--link {error}"))
            }
            EmulatorError::Link { .. } => Failure::Usage(format!("--link: {error}")),
            _ => error.into(),
        }
    }

    fn speed(&self) -> Speed {
        Speed::times(self.speed)
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    arguments.device.run()
}

/// Serves until Ctrl-C, obeying the control socket.
fn serve(mut console: Option<Console>, device: &mut dyn Obeys) -> Result<(), Failure> {
    let interrupt = run::Interrupt::catch_as_started()?;
    stderr!("{}", interrupt.how_it_ends());
    while interrupt.count() == 0 {
        if let Some(console) = &mut console {
            console.serve(device);
        }
        std::thread::sleep(PAUSE);
    }
    Ok(())
}

/// A time in ms that makes sense.
fn milliseconds(option: &str, value: f64) -> Result<Duration, Failure> {
    if !(0.0..=10_000.0).contains(&value) {
        return Err(Failure::Usage(format!("{option} {value}: it must lie between 0 and 10000")));
    }
    Ok(Duration::from_secs_f64(value * 1e-3))
}
