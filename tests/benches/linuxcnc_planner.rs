//! Cycle times of programs that LinuxCNC's planner has run (`tests/data/linuxcnc_planner`), at the same limits, and
//! axis peaks from differences of samples every millisecond.
//!
//! It prints a table that is the same on every machine; it does not measure computing time.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::format_push_string,
    dead_code,
    unused_imports,
    missing_docs,
    missing_debug_implementations,
    unreachable_pub,
    reason = "a table that cannot be made has failed; the modules are those of a test"
)]

#[path = "../limit/differences.rs"]
mod differences;
#[path = "../limit/path.rs"]
mod path;
#[path = "../limit/planners.rs"]
mod planners;
#[path = "../limit/programs.rs"]
mod programs;

use differences::{Peak, largest};
use planners::PLANNERS;
use programs::{ACCELERATION, JERK, VELOCITY, all};

fn main() {
    if !std::env::args().any(|argument| argument == "--bench") {
        return; // cargo only tests that benchmarks can be run
    }
    println!(
        "Every axis {} mm/s, {} mm/s², where jerk is limited {} mm/s³; largest of any axis by differences at 1 kHz.",
        VELOCITY * 1e3,
        ACCELERATION * 1e3,
        JERK * 1e3
    );
    let mut top = format!("{:20} | {:^35}", "", "LinuxCNC 2.9");
    let mut head = format!("{:20} | {:>8}{}", "program", "s", columns());
    for planner in PLANNERS {
        top += &format!(" | {:^43}", planner.name);
        head += &format!(" | {:>8}{:>8}{}", "s", "ratio", columns());
    }
    println!("{top}\n{head}");
    for program in all() {
        let mut line =
            format!("{:20} | {:>8.3}{}", program.name, program.duration, units(program.peak));
        for planner in PLANNERS {
            line += &match (planner.plan)(&program) {
                Ok(planned) => format!(
                    " | {:>8.3}{:>8.4}{}",
                    planned.duration,
                    planned.duration / program.duration,
                    units(largest(&planned.peaks))
                ),
                Err(error) => format!(" | {error}"),
            };
        }
        println!("{line}");
    }
}

fn columns() -> String {
    format!("{:>8}{:>9}{:>10}", "mm/s", "mm/s²", "mm/s³")
}

fn units(peak: Peak) -> String {
    let [velocity, acceleration, jerk] =
        [peak.velocity, peak.acceleration, peak.jerk].map(|value| value * 1e3);
    format!("{velocity:>8.1}{acceleration:>9.0}{jerk:>10.0}")
}
