//! `twin limit`: how fast the machine can go along the program.

use super::options::{MachineOption, ReadOptions, unreadable};
use super::{Failure, Status, show};
use crate::finding;
use crate::limit::{
    AxisRules, LimitFailure, LimitReport, LimitRules, LimitSummary, Picture, Profile, ProfileCsv,
    ProfileItem, Summing, Windows, write_summary,
};
use crate::machine::Machine;
use crate::program::{Dialect, ProgramFile};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use twin_motion::interpolate::Inputs;
use twin_motion::refeed::{LineLimit, Refed, RefeedError, Unrepaired};
use twin_motion::{din66025, rs274};

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
  twin limit examples/plate.cnc --machine machines/scara2.toml --feasible slower.cnc";

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
}

impl Arguments {
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
        })
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let machine = arguments.machine.load()?;
    let program = arguments.read.program(&arguments.program, machine.conditions.rs274.units)?;
    if program.settings().inputs != Inputs::default() {
        return Err(Failure::Usage(
            "--override and --profile are for the controller's own planning; `twin limit` plans with the limits of the \
             machine"
                .to_owned(),
        ));
    }
    if let Some(target) = &arguments.feasible {
        check_target(&program, target)?;
    }
    let mut outputs = Outputs::new(&machine, &arguments.output)?;
    let bytes = program.size().map_err(|source| unreadable(program.path(), source))?;
    let bar = show::progress(bytes, "{msg} {bar:30} {percent:>3} % {bytes_per_sec}");
    bar.set_message(program.path().display().to_string());
    let profile = Profile::new(&program, &machine, arguments.rules()?);
    let mut profile = profile.map_err(|failure| failed(&program, failure))?;
    let mut findings = Vec::new();
    let mut summing = Summing::new(machine.axes.len());
    let mut countdown = 0u32;
    while let Some(item) = profile.next() {
        match item {
            ProfileItem::Sample(sample) => {
                summing.include(&sample);
                outputs.include(&sample)?;
            }
            ProfileItem::Finding(finding) => findings.push(finding),
            ProfileItem::Io(source) => return Err(unreadable(program.path(), source)),
        }
        countdown = countdown.checked_sub(1).unwrap_or_else(|| {
            bar.set_position(profile.bytes_read());
            1000
        });
    }
    bar.finish_and_clear();
    let effort = profile.effort();
    let windows =
        Windows { count: effort.windows, failed: effort.failed, exceeded: effort.exceeded };
    let changes = profile.changes();
    let limits = profile.line_limits();
    let lines = by_line(&limits);
    let mut summary = summing.finish(windows, |line| lines.get(&line).copied());
    summary.changes = changes;
    outputs.finish(&program, &machine)?;
    finding::sort(&mut findings);
    report(arguments, &machine, &program, &summary, &findings).map_err(Failure::Stdio)?;
    if let Some(target) = &arguments.feasible {
        let refed = write_feasible(&program, &machine, limits, target)?;
        tell(&refed, target).map_err(Failure::Stdio)?;
    }
    Ok(if finding::unfit(&findings) { Status::Unfit } else { Status::Fit })
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
    findings: &[finding::Finding],
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

/// The files a profile is written to.
struct Outputs<'m> {
    tables: Vec<(&'m Path, ProfileCsv<'m, BufWriter<File>>)>,
    pictures: Vec<&'m Path>,
    picture: Option<Picture<'m>>,
}

impl<'m> Outputs<'m> {
    fn new(machine: &'m Machine, files: &'m [PathBuf]) -> Result<Self, Failure> {
        let efforts = machine.path_dynamics().is_ok_and(|dynamics| dynamics.is_some());
        let mut outputs = Self { tables: Vec::new(), pictures: Vec::new(), picture: None };
        for path in files {
            let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
            match ending.as_deref() {
                Some("csv") => {
                    let file = File::create(path).map_err(|source| unwritable(path, source))?;
                    let table = ProfileCsv::new(BufWriter::new(file), &machine.axes, efforts);
                    outputs
                        .tables
                        .push((path, table.map_err(|error| unwritable(path, error.into()))?));
                }
                Some("svg") => {
                    outputs.pictures.push(path);
                    outputs.picture.get_or_insert_with(|| Picture::new(&machine.axes, efforts));
                }
                _ => {
                    return Err(Failure::Usage(format!(
                        "{}: profiles are written as .csv or .svg",
                        path.display()
                    )));
                }
            }
        }
        Ok(outputs)
    }

    fn include(&mut self, sample: &crate::limit::ProfileSample) -> Result<(), Failure> {
        for (path, table) in &mut self.tables {
            table.write(sample).map_err(|error| unwritable(path, error.into()))?;
        }
        if let Some(picture) = &mut self.picture {
            picture.include(sample);
        }
        Ok(())
    }

    fn finish(self, program: &ProgramFile, machine: &Machine) -> Result<(), Failure> {
        for (path, table) in self.tables {
            table
                .finish()
                .and_then(|mut out| out.flush())
                .map_err(|source| unwritable(path, source))?;
        }
        if let Some(picture) = self.picture {
            let name = program.path().display().to_string();
            let text = picture
                .draw(&name, &machine.name)
                .map_err(|error| Failure::Usage(error.to_string()))?;
            for path in self.pictures {
                std::fs::write(path, &text).map_err(|source| unwritable(path, source))?;
            }
        }
        Ok(())
    }
}

fn unwritable(path: &Path, source: io::Error) -> Failure {
    Failure::Write { path: path.display().to_string(), source }
}

/// A program is not written over itself, and only programs have F words.
fn check_target(program: &ProgramFile, target: &Path) -> Result<(), Failure> {
    match program.dialect() {
        Dialect::Din66025 | Dialect::Rs274 => {}
        Dialect::Queue | Dialect::Dxf => {
            return Err(Failure::Usage(format!("{} has no F words", program.path().display())));
        }
    }
    let same = |path: &Path| std::fs::canonicalize(path).ok();
    if same(target).is_some_and(|target| Some(target) == same(program.path())) {
        return Err(Failure::Usage(format!(
            "--feasible {}: this is the program itself; name another file",
            target.display()
        )));
    }
    Ok(())
}

fn write_feasible(
    program: &ProgramFile,
    machine: &Machine,
    limits: Vec<LineLimit>,
    target: &Path,
) -> Result<Refed, Failure> {
    let source = File::open(program.path()).map_err(|error| unreadable(program.path(), error))?;
    let reader = BufReader::new(source);
    let file = File::create(target).map_err(|source| unwritable(target, source))?;
    let mut out = BufWriter::new(file);
    let limits = limits.into_iter().map(Ok);
    let refed = if program.dialect() == Dialect::Rs274 {
        let options = program.rs274_options(&machine.conditions);
        rs274::refeed(reader, &options, limits, &mut out)
    } else {
        let options = program.din66025_options(&machine.conditions);
        din66025::refeed(reader, &options, limits, &mut out)
    };
    let refed = refed.map_err(|error| match error {
        RefeedError::Read(source) => unreadable(program.path(), source),
        RefeedError::Write(source) => unwritable(target, source),
        error => Failure::Usage(error.to_string()),
    })?;
    out.flush().map_err(|source| unwritable(target, source))?;
    Ok(refed)
}

/// What became of the F words.
fn tell(refed: &Refed, target: &Path) -> io::Result<()> {
    let mut out = io::stderr().lock();
    let Refed { lines, changed, lowered, .. } = refed;
    writeln!(
        out,
        "{}: {lowered} of {lines} lines are slower than programmed, F changed in {changed}",
        target.display()
    )?;
    let left = refed.unrepaired.len() as u64 + refed.unrepaired_left_out;
    if left > 0 {
        writeln!(out, "{left} lines stay too fast, because no F governs them:")?;
        for line in refed.unrepaired.iter().take(10) {
            let Unrepaired { place, reason, programmed, limit } = line;
            writeln!(
                out,
                "  {place}: {:.1} mm/s, the machine allows {:.1} mm/s; {reason}",
                programmed * 1e3,
                limit * 1e3
            )?;
        }
    }
    Ok(())
}
