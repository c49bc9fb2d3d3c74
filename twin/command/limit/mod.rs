//! `twin limit`: time-optimal plan of a program within the limits of the machine.

mod feasible;
mod outputs;

use super::options::{MachineOption, ReadOptions, expect_path, plans_without_inputs, unreadable};
use super::{Failure, Status, show};
use crate::check::PlanCheck;
use crate::command::atomic_file;
use crate::command::atomic_file::{AtomicFile, unwritable};
use crate::command::progress::ProgressLines;
use crate::finding;
use crate::finding::{Finding, Rule};
use crate::limit::{
    AxisRules, ControllerProfile, LimitFailure, LimitReport, LimitRules, LimitSummary, Limits,
    Profile, ProfileItem, Summing, Windows, write_lines, write_summary,
};
use crate::program::{Dialect, ProgramFile};
use indicatif::ProgressBar;
use outputs::Outputs;
use std::collections::BTreeMap;
use std::io::{self, BufRead, Write};
use std::path::PathBuf;
use twin_gcode::refeed::LineLimit;
use twin_machine::Machine;
use twin_machine::text;
use twin_planner::planned_motion::PlannedPiece;
use twin_planner::time_optimal::Shown;

/// Plan a program as fast as all limits of the machine allow: which limit holds it back, where, and what it costs
///
/// The path is followed with the largest velocity at which no axis exceeds its velocity, acceleration and jerk, and no
/// programmed feed (F) or acceleration (E) is exceeded. Joints that are passed without a stop are rounded within
/// `blend_tolerance_mm` of the machine file. Within velocities and accelerations two passes give the fastest profile;
/// where jerk is limited, convex programs do, with Clarabel behind a faster solver. Between the places where limits are asked for an acceleration
/// may be a thousandth above its limit, a jerk a twentieth.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Arguments {
    /// The program
    #[arg(value_name = "PROGRAM")]
    program: PathBuf,

    #[command(flatten)]
    machine: MachineOption,

    #[command(flatten)]
    read: ReadOptions,

    /// Write the profile, one row per cycle, as a table (.csv) or as a picture (.svg); may be given several times
    #[arg(long, short, value_name = "FILE.csv|FILE.svg")]
    output: Vec<PathBuf>,

    /// Write the program with F words that every axis can follow at constant velocity; nothing else is changed
    #[arg(long, value_name = "FILE")]
    feasible: Option<PathBuf>,

    /// Write a table with a row per limit that holds back a line: the time it takes and loses there, and the largest feed of
    /// the line
    #[arg(long, value_name = "FILE.csv")]
    lines: Option<PathBuf>,

    /// Whose limits the path is planned with: those of the axes, or, for comparison, the controller's own (transition
    /// velocities, limits on curves and interpolator as in the manual), which know no axes
    #[arg(long, value_enum, default_value = "axes")]
    limits: Limits,

    /// Leave something unlimited; may be given several times
    #[arg(long, value_enum, value_name = "LIMIT")]
    without: Vec<Limit>,

    /// Output for people or for other programs (one JSON object)
    #[arg(long, value_enum, default_value = "human")]
    format: Format,
}

const AFTER_HELP: &str = "\
Examples:
  twin limit examples/plate.cnc --machine machines/scara2.toml
  twin limit examples/plate.cnc --machine machines/scara2.toml -o profile.svg -o profile.csv
  twin limit examples/plate.cnc --machine machines/scara2.toml --lines lines.csv
  twin limit examples/plate.cnc --machine machines/scara2.toml --feasible slower.cnc
  twin limit examples/plate.cnc --machine machines/scara2.toml --limits programmed";

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    Human,
    Json,
}

/// What can be switched off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Limit {
    /// Velocities of the axes
    AxisVelocity,
    /// Accelerations of the axes
    AxisAcceleration,
    /// Jerks of the axes
    AxisJerk,
    /// Torques and forces of the motors
    MotorTorque,
    /// The programmed velocity (F), and that of rapids
    Feed,
    /// The programmed accelerations (E)
    PathAcceleration,
    /// The acceleration of the tool tip
    ToolAcceleration,
    /// The acceleration towards the centre of curves, and its jumps ([preparation] of the machine file)
    Centripetal,
    /// Step frequencies of the drives and speeds of the motors
    DriveSpeed,
    /// What is kept back for the override (`headroom_percent` of the machine file)
    Headroom,
    /// Stops: rapids (G0), sharp corners, M functions and dwells
    Stops,
}

impl Arguments {
    /// Options that say nothing here are mistakes.
    fn check_for(&self, program: &ProgramFile) -> Result<(), Failure> {
        expect_path(program)?;
        let wrong = match self.limits {
            Limits::Axes => return plans_without_inputs(program),
            Limits::Programmed if !self.without.is_empty() => {
                "--without is for --limits axes: the controller's own planning knows none of these limits"
            }
            Limits::Programmed if self.feasible.is_some() => "--feasible is for --limits axes",
            Limits::Programmed => return Ok(()),
        };
        Err(Failure::Usage(wrong.to_owned()))
    }

    fn has(&self, limit: Limit) -> bool {
        !self.without.contains(&limit)
    }

    /// False if what a rule is about is switched off.
    fn counts(&self, rule: Rule) -> bool {
        match rule {
            Rule::AxisVelocity => self.has(Limit::AxisVelocity),
            Rule::AxisAcceleration | Rule::AxisVelocityStep => self.has(Limit::AxisAcceleration),
            Rule::AxisJerk => self.has(Limit::AxisJerk),
            _ => true,
        }
    }

    /// The machine, without what of it is switched off.
    fn machine(&self) -> Result<Machine, Failure> {
        let mut machine = self.machine.load()?;
        for axis in &mut machine.axes {
            if !self.has(Limit::DriveSpeed) {
                axis.velocity_limits.step_frequency = None;
                axis.velocity_limits.motor_speed = None;
                axis.max_velocity = axis.velocity_limit().value;
            }
            if !self.has(Limit::Headroom) {
                axis.headroom = 0.0;
            }
        }
        machine.conditions.stops = self.has(Limit::Stops);
        Ok(machine)
    }

    /// Nothing is written over what is read, and nothing twice.
    fn check_targets(&self, program: &ProgramFile) -> Result<(), Failure> {
        if self.feasible.is_some() {
            feasible::check_dialect(program)?;
        }
        let feasible = self.feasible.iter().map(|path| ("--feasible", path.as_path()));
        let lines = self.lines.iter().map(|path| ("--lines", path.as_path()));
        let outputs = self.output.iter().map(|path| ("--output", path.as_path()));
        let read = [self.machine.path()].into_iter().chain(self.read.variables_file());
        atomic_file::check_targets(Some(program.path()), read, outputs.chain(lines).chain(feasible))
    }

    fn rules(&self) -> Result<LimitRules, Failure> {
        let with = |limit| self.has(limit);
        let axes = AxisRules {
            velocity: with(Limit::AxisVelocity),
            acceleration: with(Limit::AxisAcceleration),
            jerk: with(Limit::AxisJerk),
            effort: with(Limit::MotorTorque),
        };
        if !axes.acceleration && !with(Limit::PathAcceleration) {
            return Err(Failure::Usage(
                "without axis-acceleration and path-acceleration nothing limits how fast the path speeds up: \
                 leave one of the two"
                    .to_owned(),
            ));
        }
        Ok(LimitRules {
            axes,
            feed: with(Limit::Feed),
            path_acceleration: with(Limit::PathAcceleration),
            tool_acceleration: with(Limit::ToolAcceleration),
            centripetal: with(Limit::Centripetal),
        })
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let machine = arguments.machine()?;
    let program = arguments.read.program(&arguments.program, machine.conditions.rs274.units)?;
    arguments.check_for(&program)?;
    arguments.check_targets(&program)?;
    let mut outputs = Outputs::new(&machine, &arguments.output)?;
    let mut job = Job::new(&machine, &program, arguments.limits)?;
    if arguments.lines.is_some() {
        job.summing = std::mem::take(&mut job.summing).with_every_line();
    }
    let (summary, limits) = match arguments.limits {
        Limits::Axes => {
            let profile = Profile::new(&program, &machine, arguments.rules()?);
            let mut profile = profile.map_err(|failure| failed(&program, failure))?;
            profile.record();
            if outputs.is_empty() && machine.couplings.is_empty() {
                profile.show(Shown::Legs);
            }
            let (read, piece) = (Profile::bytes_read, Profile::next_piece);
            job.follow(&mut profile, (read, piece), &mut outputs)?;
            job.within_axes(profile)
        }
        Limits::Programmed => {
            let profile = ControllerProfile::new(&program, &machine);
            let mut profile = profile.map_err(|failure| failed(&program, failure))?;
            let (read, piece) = (ControllerProfile::bytes_read, ControllerProfile::next_piece);
            job.follow(&mut profile, (read, piece), &mut outputs)?;
            (job.by_controller()?, Vec::new())
        }
    };
    outputs.finish(&program, &machine, arguments.limits)?;
    if let Some(path) = &arguments.lines {
        let mut file = AtomicFile::create(path)?;
        let written = write_lines(&mut file, &machine.axes, &summary.every_line);
        written.map_err(|error| unwritable(path, error.into()))?;
        file.finish()?;
    }
    let mut findings = job.findings;
    findings.retain(|finding| arguments.counts(finding.rule));
    if summary.length <= 0.0 && !finding::unfit(&findings) {
        findings.push(finding::nothing_moves());
    }
    finding::sort(&mut findings);
    report(arguments, &machine, &program, &summary, &findings).map_err(Failure::Stdio)?;
    if let Some(target) = &arguments.feasible
        && finding::unfit(&findings)
    {
        feasible::tell_none(target).map_err(Failure::Stdio)?;
    } else if let Some(target) = &arguments.feasible {
        let refed = feasible::write(&program, &machine, &limits, target)?;
        feasible::tell(&refed, target).map_err(Failure::Stdio)?;
    }
    Ok(if finding::unfit(&findings) { Status::Unfit } else { Status::Fit })
}

/// What there is to do. A short program is read at once and planned for long: its lines tell more than its bytes.
#[derive(Clone, Copy)]
enum Progress {
    Lines(u64),
    Bytes(u64),
}

impl Progress {
    fn of(program: &ProgramFile) -> io::Result<Self> {
        match program.dialect() {
            // What can be read only once is not read for its lines.
            Dialect::Din66025 | Dialect::Rs274 if program.is_repeatable() => {
                let mut lines = text::lines_of(program.path())?;
                let mut count = 0;
                while lines.skip_until(b'\n')? > 0 {
                    count += 1;
                }
                Ok(Self::Lines(count))
            }
            _ => Ok(Self::Bytes(program.size()?)),
        }
    }

    fn bar(self) -> ProgressBar {
        match self {
            Self::Lines(lines) => show::progress(lines, "{msg} {bar:30} line {pos} of {len}"),
            Self::Bytes(bytes) => show::progress(bytes, "{msg} {bar:30} {percent:>3} %"),
        }
    }
}

type BytesRead<P> = fn(&P) -> u64;
type NextPiece<P> = fn(&mut P) -> Option<PlannedPiece>;

/// A program that is being planned.
struct Job<'a> {
    machine: &'a Machine,
    program: &'a ProgramFile,
    /// How far planning has come.
    progress: Progress,
    summing: Summing<'a>,
    check: PlanCheck<'a>,
    findings: Vec<Finding>,
}

impl<'a> Job<'a> {
    fn new(
        machine: &'a Machine,
        program: &'a ProgramFile,
        limits: Limits,
    ) -> Result<Self, Failure> {
        let progress =
            Progress::of(program).map_err(|source| unreadable(program.path(), source))?;
        let factor = program.settings().inputs.override_factor.factor();
        let check = PlanCheck::new(machine, program, limits);
        let summing = Summing::under(&machine.axes, factor).by_pieces(check.free().to_vec());
        Ok(Self { machine, program, progress, summing, check, findings: Vec::new() })
    }

    /// Takes all of a profile, of which `read` gives the bytes of the program read so far, and `piece` the next piece that is
    /// planned.
    fn follow<P: Iterator<Item = ProfileItem>>(
        &mut self,
        profile: &mut P,
        (read, piece): (BytesRead<P>, NextPiece<P>),
        outputs: &mut Outputs<'_>,
    ) -> Result<(), Failure> {
        let bar = self.progress.bar();
        bar.set_message(self.program.path().display().to_string());
        let mut lines = ProgressLines::new(format!("limiting {}", self.program.path().display()));
        let (mut line, mut countdown) = (0, 0u32);
        while let Some(item) = profile.next() {
            while let Some(piece) = piece(profile) {
                self.check.take(&piece, self.summing.peaks());
            }
            match item {
                ProfileItem::Sample(sample) => {
                    line = line.max(sample.place.line.into());
                    self.summing.include(&sample);
                    outputs.include(&sample)?;
                }
                ProfileItem::Finding(finding) => self.findings.push(finding),
                ProfileItem::Io(source) => return Err(unreadable(self.program.path(), source)),
            }
            countdown = countdown.checked_sub(1).unwrap_or_else(|| {
                let (done, of) = match self.progress {
                    Progress::Lines(lines) => (line, lines),
                    Progress::Bytes(bytes) => (read(profile), bytes),
                };
                bar.set_position(done);
                lines.set(done, of);
                1000
            });
        }
        while let Some(piece) = piece(profile) {
            self.check.take(&piece, self.summing.peaks());
        }
        self.check.finish(self.summing.peaks(), &mut self.findings);
        bar.finish_and_clear();
        Ok(())
    }

    /// The summary of a profile within the limits of the axes, and the feeds of its lines.
    fn within_axes(&mut self, profile: Profile<'_>) -> (LimitSummary, Vec<LineLimit>) {
        let effort = profile.effort();
        let windows =
            Windows { count: effort.windows, failed: effort.failed, exceeded: effort.exceeded };
        let changes = profile.changes();
        let limits = profile.line_limits();
        let lines = by_line(&limits);
        let summing = std::mem::take(&mut self.summing);
        let summary = summing.finish(windows, |line| lines.get(&line).copied());
        (LimitSummary { changes, ..summary }, limits)
    }

    /// The summary of the controller's own profile, next to that within the limits of the axes.
    fn by_controller(&mut self) -> Result<LimitSummary, Failure> {
        let mut axes = Job::new(self.machine, self.program, Limits::Axes)?;
        let profile = Profile::new(self.program, self.machine, LimitRules::default());
        let mut profile = profile.map_err(|failure| failed(self.program, failure))?;
        let (read, piece) = (Profile::bytes_read, Profile::next_piece);
        axes.follow(&mut profile, (read, piece), &mut Outputs::default())?;
        let (within_axes, limits) = axes.within_axes(profile);
        let lines = by_line(&limits);
        let summing = std::mem::take(&mut self.summing);
        let summary = summing.finish(Windows::default(), |line| lines.get(&line).copied());
        let duration_under_axes_s = Some(within_axes.duration_s);
        Ok(LimitSummary { limits: Limits::Programmed, duration_under_axes_s, ..summary })
    }
}

fn failed(program: &ProgramFile, failure: LimitFailure) -> Failure {
    match failure {
        LimitFailure::Read(source) => unreadable(program.path(), source),
        LimitFailure::Machine(error) => Failure::Usage(error.to_string()),
    }
}

fn report(
    arguments: &Arguments,
    machine: &Machine,
    program: &ProgramFile,
    summary: &LimitSummary,
    findings: &[Finding],
) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match arguments.format {
        Format::Json => {
            let report = LimitReport::new(machine, program, summary).with_findings(findings);
            serde_json::to_writer(&mut out, &report)?;
            writeln!(out)
        }
        Format::Human => {
            if finding::unfit(findings) {
                writeln!(out, "{}: {}", program.path().display(), show::verdict(findings, 0))?;
                out.flush()?;
            }
            show::findings(program, findings, show::Shown::WithNotes);
            write_summary(&mut out, machine, program, summary)
        }
    }
}

/// The smallest feed of every line.
fn by_line(limits: &[LineLimit]) -> BTreeMap<u32, f64> {
    let mut lines = BTreeMap::new();
    for limit in limits {
        let feed: &mut f64 = lines.entry(limit.line).or_insert(f64::INFINITY);
        *feed = feed.min(limit.feed);
    }
    lines
}
