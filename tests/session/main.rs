//! Runs of a program on the simulated machine and on drives, as `twin run` makes them, without the command line.

#![expect(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that cannot be set up has failed"
)]
#![expect(clippy::float_cmp, reason = "at rest, given, or to be the same bit for bit")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_precision_loss,
    reason = "short runs"
)]
#![expect(clippy::indexing_slicing, reason = "a test that looks beyond an end has failed")]

mod emergency;
mod emulated;
mod gaps;
mod m_functions;
mod overrides;
mod puppet;
mod recorder;
mod simulated;

use std::path::Path;
use tempfile::TempDir;
use twin::check::CheckOptions;
use twin::finding::{Finding, Rule, Severity};
use twin::limit::Limits;
use twin::m_function::Acknowledge;
use twin::program::settings::ReadSettings;
use twin::program::{Dialect, ProgramFile};
use twin::session::{Ending, OverrideAt, Session};
use twin::simulated::Simulated;
use twin_kinematics::AxisVector;
use twin_machine::Machine;

use recorder::Recorder;

/// Start at 300, 0, 20; A: 160000 increments a turn, B: 128000, Z: 640 per mm.
const SCARA2: &str = include_str!("../../machines/scara2.toml");
/// 320, 320 and 640 increments per mm.
const GANTRY3: &str = include_str!("../../machines/gantry3.toml");

fn machine(text: &str) -> Machine {
    Machine::parse(Path::new("machine.toml"), text)
        .unwrap_or_else(|problems| panic!("{problems:#?}"))
}

/// The portal with programs that start where every axis is at 0, as the counters of a board are at power-up: nothing has
/// to be approached.
fn portal() -> Machine {
    machine(&GANTRY3.replace("start_mm = [0.0, 0.0, 20.0]", "start_mm = [0.0, 0.0, -40.0]"))
}

/// A program on disk.
struct Program {
    file: ProgramFile,
    limits: Limits,
    overrides: Vec<OverrideAt>,
    _folder: TempDir,
}

impl Program {
    fn new(text: &str) -> Self {
        Self::read_by(text, ReadSettings::default())
    }

    fn read_by(text: &str, settings: ReadSettings) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("program.cnc");
        std::fs::write(&path, text).unwrap();
        let file = ProgramFile::new(&path, Some(Dialect::Din66025), settings).unwrap();
        Self { file, limits: Limits::Programmed, overrides: Vec::new(), _folder: folder }
    }

    /// Planned within the limits of the axes.
    fn within_axes(self) -> Self {
        Self { limits: Limits::Axes, ..self }
    }

    /// With overrides like `2s=50%`.
    fn with_overrides(self, overrides: &[&str]) -> Self {
        let overrides = overrides.iter().map(|text| text.parse().unwrap()).collect();
        Self { overrides, ..self }
    }

    /// A run of it without drives, which acknowledges M functions by itself.
    fn session<'a, P>(&'a self, machine: &'a Machine, twin: P) -> Session<'a, P> {
        Session {
            machine,
            continues: None,
            program: &self.file,
            twin,
            hardware: None,
            limits: self.limits,
            acknowledge: Acknowledge::Auto,
            overrides: &self.overrides,
            realtime: false,
        }
    }

    /// Checks it as every run is checked.
    fn check(&self, machine: &Machine) -> twin::check::Outcome {
        let options = CheckOptions { limits: self.limits, ..CheckOptions::default() };
        let outcome = twin::check::check(machine, &self.file, options, &mut |_| {}).unwrap();
        let mut findings = outcome.findings.iter();
        // Feeds that the axes cannot hold, what another controller would do, and steps of trapezoidal profiles.
        let rules = [Rule::AxisJerk, Rule::ProgrammedPlan];
        let harmless = |one: &Finding| one.severity == Severity::Note || rules.contains(&one.rule);
        assert!(findings.all(harmless), "{:#?}", outcome.findings);
        outcome
    }
}

/// Runs it without drives.
fn simulate(
    machine: &Machine,
    program: &Program,
    recorder: &mut Recorder<'_>,
    interrupts: &dyn Fn() -> u32,
) -> Ending {
    simulate_with(Acknowledge::Auto, machine, program, recorder, interrupts)
}

fn simulate_with(
    acknowledge: Acknowledge,
    machine: &Machine,
    program: &Program,
    recorder: &mut Recorder<'_>,
    interrupts: &dyn Fn() -> u32,
) -> Ending {
    let start = program.check(machine).start.unwrap();
    simulate_from(&start, acknowledge, machine, program, recorder, interrupts)
}

/// Without a check.
fn simulate_from(
    start: &AxisVector,
    acknowledge: Acknowledge,
    machine: &Machine,
    program: &Program,
    recorder: &mut Recorder<'_>,
    interrupts: &dyn Fn() -> u32,
) -> Ending {
    let twin = Simulated::new(machine, start).unwrap();
    let session = Session { acknowledge, ..program.session(machine, twin) };
    session.run(recorder, interrupts).unwrap()
}
