//! `twin run`: run a program on the simulated machine and on the drives at the same time.

mod agreed;
mod axis_watch;
mod deadline;
mod interrupt;
mod keys;
mod outputs;
mod perform;
mod prompt;
mod startup;
mod summary;
mod watcher;

use super::options::{
    self, AcknowledgeOption, DEFAULT_ADDRESS, InputOptions, LimitsOption, MachineOption,
    ReadOptions, SceneOption, SimulationOptions, unreadable,
};
use super::progress::ProgressLines;
use super::{Failure, Status, check, following, show};
use crate::check::{CheckOptions, Outcome};
use crate::command::atomic_file;
use crate::finding;
use crate::program::{Dialect, ProgramFile};
use crate::session::{Ending, OverrideAt, Stopped, whereabouts};
use crate::troubleshooting::STANDSTILL;
use axis_watch::AxisWatchOptions;
pub(super) use interrupt::Interrupt;
use perform::{Done, perform};
use startup::StartUpOptions;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use summary::{Report, summary};
use twin_kinematics::AxisVector;
use twin_machine::Machine;
use twin_number::counted;

/// Part of each axis's largest velocity with which the drives approach the start of the program.
const APPROACH: f64 = 0.25;

/// Run a program on the simulated machine and, from the same set-points, on drives; show how far apart they are
///
/// The whole program is checked first, and nothing moves if it is not fit for the machine. Without drives the run
/// goes as fast as it can; with drives it is in step with the wall clock. Ctrl-C brakes on the path and still
/// writes recording and report; a second one brakes every axis at its own limits.
///
/// In step with the wall clock (with drives, or --realtime) and on a terminal the keys + and - change the override by
/// 10 %, and space holds the path and lets it go on. What is asked for counts from 0.1 s later on; if planning takes
/// longer, the path goes on as planned until there is a new plan, and a hold is over at the end of what is planned at the
/// latest, 1 to 3 s ahead. With --limits programmed the key s switches single step on and off, n waiting at the
/// next stop.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct Arguments {
    /// The program; several are run in this order, and the axes bridge the gap from the end of each to the start of the next
    #[arg(required = true, value_name = "PROGRAM")]
    programs: Vec<PathBuf>,

    #[command(flatten)]
    machine: MachineOption,

    #[command(flatten)]
    scene: SceneOption,

    #[command(flatten)]
    read: ReadOptions,

    #[command(flatten)]
    inputs: InputOptions,

    #[command(flatten)]
    m_functions: AcknowledgeOption,

    #[command(flatten)]
    limits: LimitsOption,

    /// Change the override while the program runs: 2s=50,3.5s=0,5s=100 halves the feed from 2 s on and holds the path from 3.5 s
    /// to 5 s; may be given several times
    #[arg(long, value_name = "TIME=PERCENT", value_delimiter = ',')]
    override_at: Vec<OverrideAt>,

    /// Drives to run in parallel to the simulated machine. Positions of real drives may differ from the machine file by up to 2.5
    /// increments
    #[arg(long, value_enum, default_value = "emulated")]
    drives: Drives,

    #[command(flatten)]
    start_up: StartUpOptions,

    #[command(flatten)]
    axis_watch: AxisWatchOptions,

    /// Run in step with the wall clock also without drives
    #[arg(long)]
    realtime: bool,

    /// Write a rerun recording
    #[arg(long, value_name = "OUT.rrd")]
    record: Option<PathBuf>,

    /// Show the run live in the built-in web viewer, until Ctrl-C [default address: 127.0.0.1:9090]
    #[arg(long, value_name = "ADDR", num_args = 0..=1, default_missing_value = DEFAULT_ADDRESS, value_parser = options::address)]
    serve: Option<SocketAddr>,

    /// Write a JSON report
    #[arg(long, value_name = "OUT.json")]
    report: Option<PathBuf>,

    /// Exit with status 1 if the tool of twin or drives is farther than this from its set-point
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    tolerance: Option<f64>,

    #[command(flatten)]
    simulation: SimulationOptions,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Drives {
    /// The simulated machine alone
    None,
    /// Emulators of the drives named in the machine file, on pseudo-terminals, with the real driver code
    Emulated,
    /// The drives on the ports of the machine file, after start-up checks and a question
    Real,
}

impl Arguments {
    /// The same for each program. Of several, the files written for the second are numbered 2, and so on.
    fn per_program(&self) -> impl Iterator<Item = Self> + '_ {
        (1..).zip(&self.programs).map(|(number, program)| {
            let mut own = Self { programs: vec![program.clone()], ..self.clone() };
            if number > 1 {
                let written = [&mut own.record, &mut own.report].into_iter().flatten();
                for path in written.chain(own.axis_watch.files()) {
                    *path = numbered(path, number);
                }
            }
            own
        })
    }

    /// The program, if it can be run with these options.
    fn open(&self, machine: &Machine) -> Result<ProgramFile, Failure> {
        let unit = machine.conditions.rs274.units;
        let [path] = &self.programs[..] else {
            return Err(Failure::Usage("one program at a time".to_owned()));
        };
        let program = self.read.program_with(path, unit, &self.inputs)?;
        stderr!("{} is read as {}", program.path().display(), program.dialect().name());
        program.size().map_err(|source| unreadable(program.path(), source))?;
        if !program.is_repeatable() {
            return Err(Failure::Usage(format!(
                "{} is not a regular file: a run reads its program twice, to check it and to run it",
                program.path().display()
            )));
        }
        let faster = self.override_at.iter().any(|change| change.factor > 1.0);
        if program.dialect() == Dialect::Job && faster {
            return Err(Failure::Usage(
                "--override-at is 100 % at most for a job: its blocks say themselves how fast"
                    .to_owned(),
            ));
        }
        self.check_targets(&program)?;
        // Options that exclude each other are found before anything is checked.
        self.limits.of(machine, &program)?;
        Ok(program)
    }

    /// Number of the recording of a simulated run: the same for the same run.
    fn number(&self, machine: &Machine, outcome: &Outcome) -> u64 {
        let mut run = Self { record: None, report: None, serve: None, ..self.clone() };
        run.axis_watch = AxisWatchOptions::default();
        let mut hasher = DefaultHasher::new();
        let Outcome { elements, length, duration_ns, .. } = outcome;
        format!("{run:?} {} {elements} {length} {duration_ns}", machine.name).hash(&mut hasher);
        hasher.finish()
    }

    /// The report, if one is wanted.
    fn report<'a>(
        &'a self,
        machine: &'a Machine,
        program: &'a ProgramFile,
        outcome: &'a Outcome,
    ) -> Report<'a> {
        Report { path: self.report.as_deref(), machine, program, outcome }
    }

    /// Nothing is written over what is read, and nothing twice.
    fn check_targets(&self, program: &ProgramFile) -> Result<(), Failure> {
        let read = [self.machine.path()].into_iter().chain(self.read.variables_file());
        let read = read.chain(self.simulation.faults_file()).chain(self.scene.file());
        let record = self.record.iter().map(|path| ("--record", path.as_path()));
        let report = self.report.iter().map(|path| ("--report", path.as_path()));
        let logs = self.axis_watch.targets();
        atomic_file::check_targets(Some(program.path()), read, record.chain(report).chain(logs))
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    arguments.check()?;
    let mut machine = arguments.machine.load()?;
    arguments.scene.apply(&mut machine)?;
    arguments.simulation.in_loop.apply(&mut machine)?;
    if arguments.drives == Drives::Real {
        startup::expect_real(&mut machine);
    }
    // All programs are checked before anything moves.
    let mut checked = Vec::new();
    let (mut continues, mut tool) = (None, None);
    for own in arguments.per_program() {
        let program = own.open(&machine)?.with_tool(tool);
        check::may_follow(&program, continues.as_ref())?;
        let outcome = check_first(&machine, &program, &own, continues)?;
        let Some(start) = outcome.start.filter(|_| !finding::unfit(&outcome.findings)) else {
            let report = own.report(&machine, &program, &outcome);
            report.write_nothing("the program is not fit for the machine; nothing moved")?;
            let mut out = io::stdout().lock();
            check::human(&mut out, &machine, &program, &outcome, false).map_err(Failure::Stdio)?;
            return Ok(Status::Unfit);
        };
        show::findings(&program, &outcome.findings, show::Shown::Brief);
        let before = std::mem::replace(&mut continues, outcome.end);
        tool = outcome.tool.or(tool);
        checked.push(Checked { arguments: own, program, outcome, start, continues: before });
    }
    let (mut status, mut caught) = (Status::Fit, None);
    let count = checked.len();
    for (index, checked) in checked.iter().enumerate() {
        let ((one, outputs), interrupt) = execute(&machine, checked, caught.take())?;
        status = status.max(one).max(outputs);
        if one != Status::Fit {
            match count - index - 1 {
                0 => {}
                more => stderr!("not run: {}", counted(more, "further program")),
            }
            break;
        }
        caught = Some(interrupt);
    }
    Ok(status)
}

/// A program that may run.
struct Checked {
    arguments: Arguments,
    program: ProgramFile,
    outcome: Outcome,
    /// Axis positions at its start, m or rad.
    start: AxisVector,
    /// The same, if a program before it ended there.
    continues: Option<AxisVector>,
}

/// Runs a checked program and reports. The first status is that of the run, the second that of its outputs.
fn execute(
    machine: &Machine,
    checked: &Checked,
    caught: Option<Interrupt>,
) -> Result<((Status, Status), Interrupt), Failure> {
    let Checked { arguments, program, outcome, start, continues } = checked;
    let report = arguments.report(machine, program, outcome);
    let mut outcome = outcome.clone();
    if let Some(predicted) = &outcome.following {
        stderr!("{}", following::predicted(machine, predicted));
    }
    let (done, interrupt) = match perform(arguments, &report, (start, *continues), caught) {
        Ok(done) => done,
        Err(failure) => {
            // What went wrong first is what counts; a report that cannot be written either is the lesser news.
            report.write_nothing(&failure.to_string()).unwrap_or_default();
            return Err(failure);
        }
    };
    // What only a run shows.
    let mut behind = crate::check::following_errors(machine, &done.ending.comparison);
    if arguments.drives == Drives::Emulated {
        let (comparison, busy) = (&done.ending.comparison, summary::busy(&done.ending));
        let predicted = outcome.following.as_ref();
        behind.extend(crate::check::drive_errors(machine, comparison, predicted, busy.as_deref()));
    }
    behind.extend(crate::check::happenings(machine, &done.ending.record));
    if done.ending.stopped.is_none() {
        behind.extend(crate::check::faults_to_come(machine, &done.ending.record));
    }
    outcome.loads.clone_from(&done.ending.record.loads);
    outcome.bodies.clone_from(&done.ending.record.bodies);
    behind.extend_from_slice(&done.ended);
    show::findings(program, &behind, show::Shown::WithNotes);
    outcome.findings.extend(behind);
    finding::sort(&mut outcome.findings);
    let report = Report { outcome: &outcome, ..report };

    let reason = done.ending.reason();
    // First what was asked for in files: nobody may be reading what is printed.
    let parts = (done.samples, done.maxima.clone());
    let is_reported = report.write(&done.ending, parts, reason.clone()).is_ok();
    let mut out = io::stdout().lock();
    check::summary(&mut out, machine, program, &outcome).map_err(Failure::Stdio)?;
    summary(&mut out, machine, &done).map_err(Failure::Stdio)?;
    if let Some(reason) = &reason {
        stderr!("{reason}");
    }
    if let (Some(Stopped::Interrupted(_)), Some(signal)) =
        (&done.ending.stopped, interrupt.signal())
    {
        stderr!("what asked for it was {signal}, nobody at the keyboard");
    }
    if let Some(rest) = &done.ending.rest {
        stderr!("{}", rest.message(machine));
    }
    for line in whereabouts(machine, &done.ending.last_heard) {
        stderr!("{line}");
    }
    if done.ending.standstill_ns().is_some() {
        stderr!("help: {STANDSTILL}");
    } else if let Some(Stopped::Drives { source, .. }) = &done.ending.stopped
        && let Some(advice) = source.advice()
    {
        stderr!("help: {advice}");
    }
    tell_not_stopped(&done.ending.not_stopped);
    for output in &done.ending.left_on {
        stderr!("output {output} of the drives could not be switched off: it is perhaps still on");
    }
    done.shown?;
    let unfit = if finding::unfit(&outcome.findings) { Status::Unfit } else { Status::Fit };
    let is_whole = is_reported && done.ended.is_empty();
    let outputs = if is_whole { Status::Fit } else { Status::Failed };
    let status = judge(arguments, &done.ending).max(unfit);
    drop(done.deadline);
    if let Some(url) = done.picture.url().filter(|_| interrupt.count() == 0) {
        stderr!("the view stays at {url} until Ctrl-C");
        interrupt.wait();
    }
    Ok(((status, outputs), interrupt))
}

impl Arguments {
    /// What is found out now rather than after a run of an hour.
    fn check(&self) -> Result<(), Failure> {
        if self.drives != Drives::Real {
            self.start_up.without_real()?;
        }
        if self.programs.len() > 1 && self.serve.is_some() {
            return Err(Failure::Usage(
                "--serve shows one program: run several without it, or record them with --record"
                    .to_owned(),
            ));
        }
        let last = self.override_at.iter().max_by_key(|change| change.time_ns);
        if last.is_some_and(|last| last.factor <= 0.0) {
            return Err(Failure::Usage(
                "the last of --override-at is 0: the path would be held for ever".to_owned(),
            ));
        }
        if self.tolerance.is_some_and(|tolerance| tolerance.is_nan() || tolerance <= 0.0) {
            return Err(Failure::Usage("--tolerance must be above 0 mm".to_owned()));
        }
        if let Some(path) = &self.report {
            let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
            let folder = parent.unwrap_or_else(|| Path::new("."));
            let error = if !folder.is_dir() {
                Some(io::Error::new(io::ErrorKind::NotFound, "there is no such folder"))
            } else if path.is_dir() {
                Some(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"))
            } else {
                None
            };
            if let Some(source) = error {
                return Err(Failure::Write { path: path.display().to_string(), source });
            }
        }
        Ok(())
    }
}

/// Nothing is worse than an axis that nobody can stop.
fn tell_not_stopped(devices: &[String]) {
    for device in devices {
        stderr!("{device}: it has not confirmed that it stops; use the emergency stop");
    }
}

/// The exit status that a run deserves; says which tolerance was exceeded.
fn judge(arguments: &Arguments, ending: &Ending) -> Status {
    let mut status = if ending.stopped.is_some() { Status::Failed } else { Status::Fit };
    let Some(tolerance) = arguments.tolerance else { return status };
    let tool = &ending.comparison.tool;
    for (who, statistics) in [("twin", tool.twin), ("drives", tool.drives)] {
        let Some((error, place)) = statistics.maximum() else { continue };
        let error = error * 1e3;
        if error > tolerance {
            stderr!(
                "the tool of the {who} is {error:.4} mm off at {place}; the tolerance is {tolerance} mm"
            );
            status = status.max(Status::Unfit);
        }
    }
    status
}

/// `out.json` for the second of several programs: `out.2.json`.
fn numbered(path: &Path, number: usize) -> PathBuf {
    match path.extension() {
        Some(extension) => path.with_extension(format!("{number}.{}", extension.to_string_lossy())),
        None => path.with_added_extension(number.to_string()),
    }
}

fn check_first(
    machine: &Machine,
    program: &ProgramFile,
    arguments: &Arguments,
    continues: Option<AxisVector>,
) -> Result<Outcome, Failure> {
    let bytes = program.size().map_err(|source| unreadable(program.path(), source))?;
    let acknowledge = arguments.m_functions.acknowledge;
    let limits = arguments.limits.of(machine, program)?;
    let drives = arguments.drives != Drives::None;
    let options =
        CheckOptions { limits, acknowledge, drives, continues, ..CheckOptions::default() };
    let bar = show::progress(bytes, "{msg} {bar:30} {percent:>3} % {bytes_per_sec}");
    bar.set_message("checking");
    let mut lines = ProgressLines::new(format!("checking {}", program.path().display()));
    let outcome = crate::check::check(machine, program, options, &mut |progress| {
        show::advance(&bar, &progress);
        lines.checked(&progress, bytes);
    });
    bar.finish_and_clear();
    outcome.map_err(|failure| Failure::check(program, failure))
}
