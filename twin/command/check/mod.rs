//! `twin check`: check programs against a machine.

mod clearance;

use super::options::{
    AcknowledgeOption, InputOptions, LimitsOption, MachineOption, ReadOptions, SceneOption,
    SimulationOptions, unreadable,
};
use super::progress::ProgressLines;
use super::{Failure, Status, following, show, switch_points, tappets};
use crate::check;
use crate::check::{CheckOptions, Outcome};
use crate::finding;
use crate::program::{Dialect, ProgramFile};
use crate::report::CheckReport;
use clearance::ClearanceFiles;
use indicatif::MultiProgress;
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use twin_kinematics::AxisVector;
use twin_machine::{Collision, Machine, Scenario};
use twin_number::counted;
use twin_number::seconds;

/// Check programs against a machine: syntax, reach, axis limits, velocities and accelerations, per program line
///
/// Everything `twin run` checks before it moves anything. Several programs are checked in parallel, each by itself.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Arguments {
    /// Programs to check
    #[arg(required = true, value_name = "PROGRAM")]
    programs: Vec<PathBuf>,

    /// Check the programs in this order on one machine, as `twin run` runs them: each begins where the one before ended, with its tool in the spindle
    #[arg(long)]
    sequence: bool,

    #[command(flatten)]
    machine: MachineOption,

    #[command(flatten)]
    scene: SceneOption,

    #[command(flatten)]
    read: ReadOptions,

    /// Output for people or for other programs (one JSON object per program, a line each)
    #[arg(long, value_enum, default_value = "human")]
    format: Format,

    /// Write how near the machine comes to what is around it, and its links to each other: as a table with a row per block
    /// (.csv: the least clearance in mm, when, between what, and the nearest point in the machine frame) or as a picture along
    /// the program (.svg); may be given several times. Of one program, and where the machine file has [[obstacles]] or
    /// [collision]
    #[arg(long, value_name = "FILE.csv|FILE.svg")]
    clearance: Vec<PathBuf>,

    #[command(flatten)]
    inputs: InputOptions,

    #[command(flatten)]
    m_functions: AcknowledgeOption,

    #[command(flatten)]
    limits: LimitsOption,

    /// Also run each program on the simulated machine and report following errors
    #[arg(long)]
    physics: bool,

    /// Predict how well the drives of the machine file follow, in simulated time; `twin run` always does
    #[arg(long, value_enum, default_value = "none", value_name = "none|predicted")]
    drives: Drives,

    /// Also print every finding and note and, with --drives predicted, what one lost answer of a real drive would cost
    #[arg(short, long)]
    verbose: bool,

    #[command(flatten)]
    simulation: SimulationOptions,
}

const AFTER_HELP: &str = "\
Examples:
  twin check examples/plate.cnc --machine machines/scara2.toml
  twin check examples/*.cnc --machine machines/gantry3.toml --format json
  twin check examples/vice.ngc --machine machines/gantry3_vice.toml --physics
  twin check examples/vice.ngc --machine machines/gantry3_vice.toml --clearance near.svg --clearance near.csv";

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Drives {
    /// Nothing
    None,
    /// Errors of every drive, and the load of its wire
    Predicted,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    Human,
    Json,
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let mut machine = arguments.machine.load()?;
    arguments.scene.apply(&mut machine)?;
    arguments.simulation.in_loop.apply(&mut machine)?;
    let scenario = arguments.simulation.scenario(&machine)?;
    if !arguments.physics {
        arguments.simulation.without_physics()?;
        let collision = machine.collision.as_ref();
        if collision.is_some_and(Collision::handles_bodies) {
            let path = machine.path.display();
            stderr!("{path} has loose bodies or grippers, which only --physics moves");
        }
    }
    clearance::check(arguments, &machine)?;
    let programs: Vec<_> = {
        let unit = machine.conditions.rs274.units;
        let program = |path| arguments.read.program_with(path, unit, &arguments.inputs);
        arguments.programs.iter().map(|path: &PathBuf| program(path)).collect()
    };
    if arguments.sequence {
        return in_sequence(&machine, programs, arguments, &scenario);
    }
    let next = AtomicUsize::new(0);
    let slots: Vec<_> = programs.iter().map(|_| Mutex::new(None)).collect();
    let bars = MultiProgress::new();
    let workers = std::thread::available_parallelism().map_or(1, usize::from).min(programs.len());
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some((Ok(program), slot)) = programs.get(index).zip(slots.get(index))
                    else {
                        if index >= programs.len() {
                            return;
                        }
                        continue;
                    };
                    let outcome = one((&machine, &scenario), program, arguments, None, &bars);
                    if let Ok(mut slot) = slot.lock() {
                        *slot = Some(outcome);
                    }
                }
            });
        }
    });
    // A program that cannot be read does not keep the others from being reported.
    let mut status = Status::Fit;
    for (program, slot) in programs.into_iter().zip(slots) {
        let outcome = program.and_then(|program| match slot.into_inner() {
            Ok(Some(outcome)) => outcome.map(|outcome| (program, outcome)),
            _ => Err(Failure::Usage(format!("{} was not checked", program.path().display()))),
        });
        match outcome {
            Ok((program, outcome)) => {
                report(&machine, &program, &outcome, arguments).map_err(Failure::Stdio)?;
                if finding::unfit(&outcome.findings) {
                    status = status.max(Status::Unfit);
                }
            }
            Err(failure) => {
                failure.show();
                status = Status::Failed;
            }
        }
    }
    Ok(status)
}

/// Refuses a job behind another program: its `[[start]]` says where its axes are.
pub(super) fn may_follow(program: &ProgramFile, end: Option<&AxisVector>) -> Result<(), Failure> {
    if end.is_some() && program.dialect() == Dialect::Job {
        return Err(Failure::Usage(format!(
            "{} is a job, whose [[start]] says where its axes are: it cannot follow another program; put it first",
            program.path().display()
        )));
    }
    Ok(())
}

/// Checks the programs one after the other on one machine, up to the first that cannot be read.
fn in_sequence(
    machine: &Machine,
    programs: Vec<Result<ProgramFile, Failure>>,
    arguments: &Arguments,
    scenario: &Scenario,
) -> Result<Status, Failure> {
    let (mut status, mut end, mut tool) = (Status::Fit, None, None);
    for program in programs {
        let program = program?.with_tool(tool);
        may_follow(&program, end.as_ref())?;
        let outcome = one((machine, scenario), &program, arguments, end, &MultiProgress::new())?;
        report(machine, &program, &outcome, arguments).map_err(Failure::Stdio)?;
        if finding::unfit(&outcome.findings) {
            status = Status::Unfit;
        }
        end = outcome.end.or(end);
        tool = outcome.tool.or(tool);
    }
    Ok(status)
}

fn one(
    (machine, scenario): (&Machine, &Scenario),
    program: &ProgramFile,
    arguments: &Arguments,
    continues: Option<AxisVector>,
    bars: &MultiProgress,
) -> Result<Outcome, Failure> {
    let limits = arguments.limits.of(machine, program)?;
    let bytes = program.size().map_err(|source| unreadable(program.path(), source))?;
    let bar = bars.add(show::progress(bytes, "{msg} {bar:30} {percent:>3} % {bytes_per_sec}"));
    bar.set_message(program.path().display().to_string());
    let mut files = ClearanceFiles::new(machine, &arguments.clearance)?;
    let mut lines = ProgressLines::new(format!("checking {}", program.path().display()));
    let outcome = check::check_watched(
        machine,
        program,
        CheckOptions {
            limits,
            physics: arguments.physics,
            scenario: scenario.clone(),
            acknowledge: arguments.m_functions.acknowledge,
            drives: arguments.drives == Drives::Predicted,
            continues,
        },
        &mut |progress| {
            show::advance(&bar, &progress);
            lines.checked(&progress, bytes);
        },
        &mut |clearance| files.include(clearance),
    );
    bar.finish_and_clear();
    let outcome = outcome.map_err(|failure| Failure::check(program, failure))?;
    files.finish(program)?;
    Ok(outcome)
}

/// Writes what was found about one program: the verdict first, then findings and tables.
fn report(
    machine: &Machine,
    program: &ProgramFile,
    outcome: &Outcome,
    arguments: &Arguments,
) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match arguments.format {
        Format::Json => {
            serde_json::to_writer(&mut out, &CheckReport::new(machine, program, outcome))?;
            writeln!(out)
        }
        Format::Human => {
            human(&mut out, machine, program, outcome, arguments.verbose)?;
            // Of a program that says nothing of motion nothing is predicted.
            let moved = outcome.following.as_ref().filter(|found| found.tool.maximum().is_some());
            if let Some(predicted) = moved {
                writeln!(out, "{}", following::predicted(machine, predicted))?;
                if arguments.verbose
                    && let Some(note) = following::lost_answers(machine, outcome)
                {
                    writeln!(out, "{note}")?;
                }
            }
            Ok(())
        }
    }
}

/// The verdict, the findings and the tables of a check.
pub(super) fn human(
    out: &mut impl Write,
    machine: &Machine,
    program: &ProgramFile,
    outcome: &Outcome,
    verbose: bool,
) -> io::Result<()> {
    writeln!(
        out,
        "{}: {}",
        program.path().display(),
        show::verdict(&outcome.findings, outcome.findings_left_out)
    )?;
    // Findings go to standard error, and must not overtake it.
    out.flush()?;
    let which = if verbose { show::Shown::All } else { show::Shown::Brief };
    show::findings(program, &outcome.findings, which);
    tables(out, machine, program, outcome)
}

/// The verdict of a check and its tables.
pub(super) fn summary(
    out: &mut impl Write,
    machine: &Machine,
    program: &ProgramFile,
    outcome: &Outcome,
) -> io::Result<()> {
    writeln!(out, "{}", show::verdict(&outcome.findings, outcome.findings_left_out))?;
    tables(out, machine, program, outcome)
}

/// Size of the program and the tables of peaks and loads.
fn tables(
    out: &mut impl Write,
    machine: &Machine,
    program: &ProgramFile,
    outcome: &Outcome,
) -> io::Result<()> {
    writeln!(
        out,
        "{} ({}) on {}: {}, {:.1} mm, {:.3} s",
        program.path().display(),
        program.dialect().name(),
        machine.name,
        counted(usize::try_from(outcome.elements).unwrap_or(usize::MAX), "element"),
        outcome.length * 1e3,
        seconds(outcome.duration_ns),
    )?;
    if outcome.peaks.iter().any(|peak| peak.position.is_some()) {
        writeln!(out, "{}", show::peaks(machine, &outcome.peaks))?;
    }
    if !outcome.loads.is_empty() {
        writeln!(out, "{}", show::loads(machine, &outcome.loads))?;
    }
    if let Some(nearest) = &outcome.edge {
        let distance = nearest.distance * 1e3;
        writeln!(out, "nearest to the edge of the reach: {distance:.2} mm, {}", nearest.place)?;
    }
    if let Some(least) = &outcome.clearances.least {
        writeln!(out, "{} (as planned)", least.message(machine))?;
    }
    tappets::write(out, &outcome.tappets)?;
    switch_points::write(out, &outcome.switch_points)?;
    if outcome.untaken_ns > 0 {
        let left_out = seconds(outcome.untaken_ns);
        writeln!(
            out,
            "for {left_out:.3} s of the program the machine cannot take the set-points: the tables leave them out"
        )?;
    }
    Ok(())
}
