//! `twin tune cam`: offsets, scalings, dead times and ramps of cams.

use super::find::tuned;
use super::least::{Find, LeastOptions, Sought, sought};
use super::outcome::{apply, picture};
use super::report::Report;
use super::words::{Ramp, SlaveColumn, start};
use crate::cam::check::{AxisLimits, CamCheck, CamUse};
use crate::cam::run::RecordedRun;
use crate::cam::tune::{self, changes};
use crate::command::atomic_file;
use crate::command::cam::{
    Format, LimitOptions, MasterOptions, UseOptions, load, number, positive, show_findings,
};
use crate::command::{Failure, Status};
use crate::finding;
use std::io;
use std::path::PathBuf;
use twin_cam::tune::Free;

/// Tune a cam: offsets and scalings from a recorded run or within limits, the dead time of tappets, ramps
///
/// A run (CSV of time, master, slave) gives offsets and scalings by least squares, each with the half width of its 95 %
/// interval. `slave` is where the slave was measured while the coupling of the cam's file was in effect; wanted is the cam with
/// that coupling, or with `wanted_…` of `[coupling]` where the file has them (--write puts them there). What is proposed undoes
/// the deviation: a slave that lags gets a master offset that leads. Tappets are moved on the cam by the same, so that they stay
/// where they are on the master; with --slave wanted they go with the cam. Recorded outputs (columns `tappet_N`) give
/// the dead time of what tappets switch. The master's velocity and acceleration are those of the run where none are given. Where
/// what undoes the deviation would exceed limits of the slave's set-points, the values are those within the limits that leave the
/// least error. Without a run what is to be found keeps the limits with the least error to the motion so far, and tappets stay where they are
/// on the master. With --minimise the slave's peak acceleration or jerk is made smallest: intervals and the limits hold offsets and
/// scalings then, for a scaling of 0 would be the smallest.
/// What the data do not say, or contradict, is said and not fitted: samples that are far from the others with their lines.
#[derive(Debug, clap::Args)]
#[command(
    after_help = AFTER_HELP,
    mut_arg("master_velocity", |arg| arg.help(VELOCITY)),
    mut_arg("master_acceleration", |arg| arg.help(ACCELERATION)),
)]
pub(super) struct Arguments {
    /// The cam
    #[arg(value_name = "CAM")]
    cam: PathBuf,

    /// A recorded run: CSV of time, master and slave (where it was measured, see --slave), with columns `tappet_N` (0 or 1, TRUE or FALSE) for outputs
    #[arg(long, value_name = "FILE.csv")]
    run: Option<PathBuf>,

    /// What `slave` of the run is: where the slave was measured, so that its deviation from what is wanted is undone, or the
    /// motion wanted, so that the cam is laid over it and its tappets go with it
    #[arg(long, value_enum, default_value = "measured", requires = "run")]
    pub(super) slave: SlaveColumn,

    /// The master of the run is recorded within this period, u [default: what its positions jump back by, if that is whole passes of
    /// the cam, or turns]
    #[arg(long, value_name = "U", requires = "run", value_parser = positive)]
    master_period: Option<f64>,

    /// Parameters to find: master-offset, master-scaling, slave-offset, slave-scaling [default: both offsets with a run]. With a run
    /// they are fitted to it, `MasterScaling` within 5 % of itself, without one to the limits. NAME=FROM..TO gives an interval, like
    /// slave-scaling=0.9..1.1: in a run it decides between equally good fits, without one the value stays in it
    #[arg(long, value_name = "NAME[=FROM..TO]", value_delimiter = ',', value_parser = sought)]
    pub(super) find: Vec<Sought>,

    /// Where the master is when `MC_CamIn` starts, u: it has to be on the cam then (error 626) [default: that of --ramp-in, or where
    /// the --run begins if the coupling in effect starts there]
    #[arg(long, value_name = "U", allow_hyphen_values = true, value_parser = number)]
    master_start: Option<f64>,

    /// Find `VelocityDiff`, Acceleration and Deceleration for a start from here: master, slave, and the slave's velocity. Within
    /// the limits of velocity, acceleration, position and jerk
    #[arg(long, value_name = "MASTER,SLAVE[,VELOCITY]", allow_hyphen_values = true, value_parser = start, conflicts_with_all = ["run", "find", "master_start"])]
    pub(super) ramp_in: Option<[f64; 3]>,

    /// Ramps of the slave's axis, as `ramp` of a job says: the acceleration of trapezoid ones steps, parabolic and sigmoid ones keep
    /// the limit of the jerk together with the cam
    #[arg(
        long,
        value_name = "TYPE",
        value_enum,
        default_value = "trapezoid",
        requires = "ramp_in",
        conflicts_with_all = ["run", "find"]
    )]
    pub(super) ramp: Ramp,

    /// The ramp takes this long at most, s, and the slave's peak acceleration is small (with --minimise jerk its peak jerk); else it
    /// is as short as the limits allow
    #[arg(long, value_name = "S", requires = "ramp_in", value_parser = positive, conflicts_with_all = ["run", "find"])]
    pub(super) within: Option<f64>,

    /// A picture of before and after: of the cam, and with --ramp-in of what the slave does until it is on it, with its limits
    #[arg(long, short, value_name = "FILE.svg")]
    output: Option<PathBuf>,

    /// Write what was found into the cam's file, comments kept, or into another one
    #[arg(long, value_name = "FILE.toml", num_args = 0..=1)]
    #[expect(clippy::option_option, reason = "not given, given alone, given with a file")]
    write: Option<Option<PathBuf>>,

    /// What has the name of --write already, and is not the cam itself, is replaced
    #[arg(long, requires = "write")]
    force: bool,

    /// For people, or one JSON object
    #[arg(long, value_enum, default_value = "human")]
    format: Format,

    // Groups with headings come last: options after them would be listed under these.
    #[command(flatten)]
    pub(super) least: LeastOptions,

    #[command(flatten)]
    master: MasterOptions,

    #[command(flatten)]
    limits: LimitOptions,

    #[command(flatten)]
    coupling: UseOptions,
}

/// What `twin cam` says of them, and what a run shows.
const VELOCITY: &str = "Its velocity, u/s; a master that goes backwards has a negative --master-scaling [default: 1; with a --run that of the run]";
const ACCELERATION: &str =
    "Its acceleration and deceleration, u/s² [default: 0; with a --run those of the run]";

const AFTER_HELP: &str = "\
Exit status:
  0  what was asked for was found, and the slave keeps its limits
  1  the data do not say it or contradict it, or the slave exceeds a limit: nothing is written then;
     or the cam has another error that `twin cam check` reports
  2  the command could not be carried out

Examples:
  twin tune cam cam.toml --run run.csv --find master-offset,slave-offset,slave-scaling -o fit.svg
  twin tune cam cam.toml --find slave-scaling=0.9..1.1,master-scaling=0.9..1.1 --minimise jerk
  twin tune cam cam.toml --ramp-in 0,35 --master-velocity 200 --max-velocity 900 --max-acceleration 20000";

impl Arguments {
    pub(super) fn free(&self) -> Free {
        let has = |find| self.find.iter().any(|sought| sought.what == find);
        let usual = self.find.is_empty() && self.run.is_some();
        Free {
            master_offset: usual || has(Find::MasterOffset),
            master_scaling: has(Find::MasterScaling),
            slave_offset: usual || has(Find::SlaveOffset),
            slave_scaling: has(Find::SlaveScaling),
        }
    }

    /// Nothing that is read is overwritten but the cam itself, and that only with --write.
    fn check_targets(&self) -> Result<(), Failure> {
        let read = [Some(self.cam.as_path()), self.run.as_deref(), self.limits.machine_file()];
        let other = match &self.write {
            Some(Some(path)) if !atomic_file::is_same(path, &self.cam) => {
                Some(("--write", path.as_path()))
            }
            _ => None,
        };
        if let Some((_, path)) = other {
            atomic_file::refuse_existing(path, self.force)?;
        }
        self.output.as_deref().map_or(Ok(()), atomic_file::check_picture)?;
        let picture = self.output.as_deref().map(|path| ("--output", path));
        atomic_file::check_targets(
            None,
            read.into_iter().flatten(),
            picture.into_iter().chain(other),
        )
    }

    /// Refuses calls that ask for nothing, and options without effect.
    fn check(&self) -> Result<(), Failure> {
        let wrong = if self.run.is_none() && self.find.is_empty() && self.ramp_in.is_none() {
            "nothing is to be found: give a recorded --run, what to --find within the limits, or a --ramp-in"
        } else {
            let ramp = [self.ramp_in.is_some(), self.within.is_some()];
            return self.least.check(&self.find, self.run.is_some(), ramp);
        };
        Err(Failure::Usage(wrong.to_owned()))
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    arguments.check()?;
    arguments.check_targets()?;
    let file = load(&arguments.cam, arguments.coupling.interpolation)?;
    let limits = arguments.limits.limits(&file)?;
    let AxisLimits { position, motion, .. } = limits;
    let all = [position[0], position[1], motion.velocity, motion.acceleration, motion.jerk];
    let unlimited = all.into_iter().all(f64::is_infinite);
    let peak = arguments.least.quantity().is_some();
    if unlimited && arguments.run.is_none() && !arguments.find.is_empty() && !peak {
        let message = "--find without a --run keeps the limits of the slave, and none is given: --machine FILE --axis NAME, or \
                       --max-velocity, --max-acceleration, --max-jerk, --position-min, --position-max";
        return Err(Failure::Usage(message.to_owned()));
    }
    let load_run = |path| RecordedRun::load_for(&file, path);
    let recorded = arguments.run.as_deref().map(load_run).transpose().map_err(Box::new)?;
    let mut before = arguments.coupling.using(&file, arguments.master.motion(), limits);
    let wound = recorded.as_ref().map(|run| {
        let tune::Unwound { run, master, slave } =
            tune::unwound(&file, &before, run, arguments.master_period);
        (run.into_owned(), [master, slave])
    });
    let (recorded, wound) = wound.map_or((None, [None; 2]), |(run, wound)| (Some(run), wound));
    let shown = recorded.as_ref().and_then(|run| tune::master_motion(&file, &before, run));
    before.master = arguments.master.motion_or(shown.unwrap_or(before.master));
    let given = arguments.ramp_in.map(|[master, ..]| master).or(arguments.master_start);
    before.start = given.or_else(|| {
        let of_run = recorded.as_ref().and_then(|run| run.samples.first()).map(|one| one.master);
        let starts = |master: &f64| before.starts_at(file.cam.curve(), *master);
        of_run.filter(starts)
    });
    let mut report = Report::new(&file, before);
    report.wound = wound;
    match tuned(arguments, &file, recorded.as_ref(), &mut report) {
        Ok(()) => {}
        Err(error) if error.is_of_call() => return Err(Failure::Usage(error.to_string())),
        Err(error) => {
            report.refused = Some(error.to_string());
            report
                .write(arguments.format, arguments.write.is_some(), &mut io::stdout().lock())
                .map_err(Failure::Stdio)?;
            stderr!("{:?}", miette::Report::msg(error.to_string()));
            return Ok(Status::Unfit);
        }
    }
    let after_file = report.kept.as_ref().map_or(&file, |kept| &kept.file).clone();
    let check = CamCheck::new(&after_file, report.after);
    // What was given on the command line belongs to what was found.
    let in_file = CamUse { coupling: file.coupling, ..before };
    report.changes = changes(&in_file, &report.after);
    let tappets: Vec<_> = report.kept.iter().flat_map(|kept| kept.changes()).collect();
    report.changes.extend(tappets);
    // Files first: who reads only the first lines of the report has them, too.
    if let Some(path) = &arguments.output {
        picture(path, &file, &after_file, &report, recorded.as_ref())?;
    }
    // What exceeds a limit, or does not start, is for reading, not for files.
    let refused = check.findings.iter().find(|finding| tune::refuses(finding));
    let target = arguments.write.as_ref().filter(|_| refused.is_none());
    if let Some(target) = target {
        apply(&file, &after_file, &report, target.as_deref())?;
    }
    report
        .write(arguments.format, arguments.write.is_some(), &mut io::stdout().lock())
        .map_err(Failure::Stdio)?;
    if let (Some(_), Some(refused)) = (&arguments.write, refused) {
        let exceeds = tune::exceeds(refused);
        let why =
            if exceeds { "the slave would exceed a limit" } else { "MC_CamIn would not start" };
        stderr!("nothing is written: {why}");
    }
    show_findings(&check.findings);
    Ok(if finding::unfit(&check.findings) { Status::Unfit } else { Status::Fit })
}
