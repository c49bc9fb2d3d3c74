//! `twin limit`: how fast the machine can go along the program.

mod feasible;
mod outputs;

use super::options::{MachineOption, ReadOptions, plans_without_inputs, unreadable};
use super::{Failure, Status, show};
use crate::finding::{self, Finding};
use crate::limit::{
    AxisRules, ControllerProfile, LimitFailure, LimitReport, LimitRules, LimitSummary, Limits,
    Profile, ProfileItem, Summing, Windows, write_summary,
};
use crate::machine::Machine;
use crate::program::ProgramFile;
use outputs::Outputs;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use twin_motion::refeed::LineLimit;

/// Plan a program as fast as all limits of the machine allow: which limit holds it back, where, and what it costs
///
/// The path is followed with the largest velocity at which no axis exceeds its velocity, acceleration and jerk, and no
/// programmed feed (F) or acceleration (E) is exceeded. Joints that are passed without a stop are rounded within
/// `blend_tolerance_mm` of the machine file. Clarabel solves the convex programs that this comes down to.
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
  twin limit examples/plate.cnc --machine machines/scara2.toml --feasible slower.cnc
  twin limit examples/plate.cnc --machine machines/scara2.toml --limits softmotion";

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
}

impl Arguments {
    /// Options that say nothing here are mistakes.
    fn check_for(&self, program: &ProgramFile) -> Result<(), Failure> {
        let wrong = match self.limits {
            Limits::Axes => return plans_without_inputs(program),
            Limits::Softmotion if !self.without.is_empty() => {
                "--without is for --limits axes: the controller's own planning knows none of these limits"
            }
            Limits::Softmotion if self.feasible.is_some() => "--feasible is for --limits axes",
            Limits::Softmotion => return Ok(()),
        };
        Err(Failure::Usage(wrong.to_owned()))
    }

    fn rules(&self) -> Result<LimitRules, Failure> {
        let with = |limit| !self.without.contains(&limit);
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
    let machine = arguments.machine.load()?;
    let program = arguments.read.program(&arguments.program, machine.conditions.rs274.units)?;
    arguments.check_for(&program)?;
    if let Some(target) = &arguments.feasible {
        let others = arguments.output.iter().map(PathBuf::as_path);
        feasible::check_target(&program, target, others.chain([arguments.machine.path()]))?;
    }
    let mut outputs = Outputs::new(&machine, &arguments.output)?;
    let mut job = Job::new(&machine, &program)?;
    let (summary, limits) = match arguments.limits {
        Limits::Axes => {
            let profile = Profile::new(&program, &machine, arguments.rules()?);
            let mut profile = profile.map_err(|failure| failed(&program, failure))?;
            job.follow(&mut profile, Profile::bytes_read, &mut outputs)?;
            job.within_axes(profile)
        }
        Limits::Softmotion => {
            let profile = ControllerProfile::new(&program, &machine);
            let mut profile = profile.map_err(|failure| failed(&program, failure))?;
            job.follow(&mut profile, ControllerProfile::bytes_read, &mut outputs)?;
            (job.by_controller()?, Vec::new())
        }
    };
    outputs.finish(&program, &machine, arguments.limits)?;
    let mut findings = job.findings;
    if summary.length <= 0.0 && findings.is_empty() {
        findings.push(finding::nothing_moves());
    }
    finding::sort(&mut findings);
    report(arguments, &machine, &program, &summary, &findings).map_err(Failure::Stdio)?;
    if let Some(target) = &arguments.feasible
        && finding::unfit(&findings)
    {
        feasible::tell_none(target).map_err(Failure::Stdio)?;
    } else if let Some(target) = &arguments.feasible {
        let refed = feasible::write(&program, &machine, limits, target)?;
        feasible::tell(&refed, target).map_err(Failure::Stdio)?;
    }
    Ok(if finding::unfit(&findings) { Status::Unfit } else { Status::Fit })
}

/// A program that is being planned.
struct Job<'a> {
    machine: &'a Machine,
    program: &'a ProgramFile,
    /// Bytes of the program.
    bytes: u64,
    summing: Summing,
    findings: Vec<Finding>,
}

impl<'a> Job<'a> {
    fn new(machine: &'a Machine, program: &'a ProgramFile) -> Result<Self, Failure> {
        let bytes = program.size().map_err(|source| unreadable(program.path(), source))?;
        let factor = program.settings().inputs.override_factor.factor();
        let summing = Summing::under(machine.axes.len(), factor);
        Ok(Self { machine, program, bytes, summing, findings: Vec::new() })
    }

    /// Takes all of a profile, of which `read` tells how many bytes of the program it has read.
    fn follow<P: Iterator<Item = ProfileItem>>(
        &mut self,
        profile: &mut P,
        read: fn(&P) -> u64,
        outputs: &mut Outputs<'_>,
    ) -> Result<(), Failure> {
        let bar = show::progress(self.bytes, "{msg} {bar:30} {percent:>3} % {bytes_per_sec}");
        bar.set_message(self.program.path().display().to_string());
        let mut countdown = 0u32;
        while let Some(item) = profile.next() {
            match item {
                ProfileItem::Sample(sample) => {
                    self.summing.include(&sample);
                    outputs.include(&sample)?;
                }
                ProfileItem::Finding(finding) => self.findings.push(finding),
                ProfileItem::Io(source) => return Err(unreadable(self.program.path(), source)),
            }
            countdown = countdown.checked_sub(1).unwrap_or_else(|| {
                bar.set_position(read(profile));
                1000
            });
        }
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

    /// The summary of the controller's own profile, beside that within the limits of the axes.
    fn by_controller(&mut self) -> Result<LimitSummary, Failure> {
        let mut axes = Job::new(self.machine, self.program)?;
        let profile = Profile::new(self.program, self.machine, LimitRules::default());
        let mut profile = profile.map_err(|failure| failed(self.program, failure))?;
        axes.follow(&mut profile, Profile::bytes_read, &mut Outputs::default())?;
        let (within_axes, limits) = axes.within_axes(profile);
        let lines = by_line(&limits);
        let summing = std::mem::take(&mut self.summing);
        let summary = summing.finish(Windows::default(), |line| lines.get(&line).copied());
        let duration_under_axes_s = Some(within_axes.duration_s);
        Ok(LimitSummary { limits: Limits::Softmotion, duration_under_axes_s, ..summary })
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
            show::findings(program, findings);
            if finding::unfit(findings) {
                writeln!(
                    out,
                    "NOT fit for the machine: what could not be planned is missing below"
                )?;
            }
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

fn unwritable(path: &Path, source: io::Error) -> Failure {
    Failure::Write { path: path.display().to_string(), source }
}
