//! Benchmark of memory: resident memory of decoding, planning and sampling a program of ten million lines from disk,
//! and one of a thousand.
//!
//! Every program runs in a process of its own, which reports its peak resident memory (`VmHWM`, Linux only). Numbers
//! are printed, nothing fails on them.

#![allow(
    clippy::expect_used,
    dead_code,
    missing_docs,
    unreachable_pub,
    reason = "a benchmark that cannot be set up has failed; the modules are those of another one too"
)]

mod contour;
mod pipeline;

use contour::{Contour, Dialect, din66025_options, rs274_options};
use pipeline::{elements, prepare, sample};
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;
use std::process::Command;
use twin_gcode::{din66025, rs274};

const FEW: u32 = 1_000;
const MANY: u32 = 10_000_000;

fn main() {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let arguments: Vec<&OsStr> = arguments.iter().map(AsRef::as_ref).collect();
    match arguments.as_slice() {
        [file] if Path::new(file).is_file() => run(Path::new(file)),
        // Not when cargo only tests that benchmarks can be run.
        arguments if arguments.iter().any(|argument| *argument == "--bench") => compare(),
        _ => {}
    }
}

/// The ending gives the dialect.
fn name(dialect: Dialect, lines: u32) -> String {
    match dialect {
        Dialect::Din66025 => format!("{lines}.cnc"),
        Dialect::Rs274 => format!("{lines}.ngc"),
    }
}

/// Samples the program in `file` and prints how many set-points that gave and what it took.
fn run(file: &Path) {
    let reader = BufReader::new(File::open(file).expect("a program"));
    let setpoints = if file.extension() == Some(OsStr::new("ngc")) {
        sample(prepare(elements(rs274::Decoder::new(reader, rs274_options()))))
    } else {
        sample(prepare(elements(din66025::Decoder::new(reader, din66025_options()))))
    };
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let most = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let most = most.and_then(|value| value.trim().strip_suffix(" kB"));
    println!("{setpoints} {}", most.unwrap_or("unknown"));
}

fn compare() {
    let folder = tempfile::tempdir().expect("a place for programs");
    for dialect in [Dialect::Din66025, Dialect::Rs274] {
        let mut resident = Vec::new();
        for lines in [FEW, MANY] {
            let file = folder.path().join(name(dialect, lines));
            let mut out = File::create(&file).expect("a place for programs");
            let program = &mut BufReader::new(Contour::new(dialect, lines));
            let bytes = io::copy(program, &mut out).expect("room for a program");
            let this = std::env::current_exe().expect("it runs");
            let output = Command::new(this).arg(&file).output().expect("it runs");
            let output = String::from_utf8_lossy(&output.stdout);
            let (setpoints, most) = output.trim().split_once(' ').expect("what it found");
            println!(
                "{dialect:?}, {lines} lines ({:.1} MB): {setpoints} set-points, {most} kB resident at most",
                f64::from(u32::try_from(bytes / 1_000).unwrap_or(u32::MAX)) / 1e3
            );
            resident.extend(most.parse::<i64>());
            std::fs::remove_file(file).expect("it is there");
        }
        if let [few, many] = resident.as_slice() {
            println!("{dialect:?}, difference: {} kB", many - few);
        }
    }
}
