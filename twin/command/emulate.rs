//! `twin emulate`: a drive without hardware, for any master.

use super::{Failure, Status, run};
use crate::clock::Clock;
use std::path::PathBuf;
use std::time::Duration;
use twin_drives::interpcnc::emulator::{BoardOptions, EmulatedBoard, EmulatorOptions, Wire};
use twin_drives::interpcnc::{Line, Parity};

/// Emulate a drive on a pseudo-terminal, for any master to talk to
///
/// Serves until Ctrl-C. The device answers as the manual says and moves in real time.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    device: Device,
}

#[derive(Debug, clap::Subcommand)]
enum Device {
    /// SOPROLEC InterpCNC V2.1: five step axes on Modbus RTU
    ///
    /// Commands 40, 41, 42, 43, 66, 67, 80 and 96 do what the manual says; interpolated moves (6) and homing (71, 78)
    /// are answered with exception 3 so far.
    ///
    /// For instance, with the port at /tmp/board:
    ///   mbpoll -m rtu -b 115200 -P none -0 -B -t 3:int -r 1026 -c 5 -1 /tmp/board
    #[command(verbatim_doc_comment)]
    Interpcnc(InterpCnc),
}

#[derive(Debug, clap::Args)]
struct InterpCnc {
    /// Symbolic link to make to the pseudo-terminal; removed at the end, refused if it is in use
    #[arg(long, value_name = "PATH")]
    link: PathBuf,

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

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let Device::Interpcnc(options) = &arguments.device;
    if !(0.0..=10_000.0).contains(&options.turnaround_ms) {
        return Err(Failure::Usage("--turnaround-ms must lie between 0 and 10000".to_owned()));
    }
    let parity = match options.parity {
        ParityOption::None => Parity::None,
        ParityOption::Even => Parity::Even,
        ParityOption::Odd => Parity::Odd,
    };
    let line = Line { baud: options.baud, parity };
    let enable = !options.enable_open;
    let board = BoardOptions { station: options.station, line, enable, ..BoardOptions::default() };
    let wire = Wire { line, turnaround: Duration::from_secs_f64(options.turnaround_ms * 1e-3) };
    let interrupt = run::Interrupt::catch()?;
    let clock = Clock::start();
    let link = Some(options.link.clone());
    let emulator = EmulatorOptions { board, wire, link, ..EmulatorOptions::default() };
    let running = EmulatedBoard::start(&emulator, move || clock.now_ns())?;
    eprintln!(
        "InterpCNC, station {}, {} baud, on {} ({})",
        options.station,
        options.baud,
        options.link.display(),
        running.path().display()
    );
    eprintln!("Ctrl-C ends it.");
    interrupt.wait();
    let board = running.stop()?;
    eprintln!("{} frames answered; counters {:?}", board.frames_handled(), board.counters());
    Ok(Status::Fit)
}
