//! What SoftMotion's diagnosis blocks tell of axes in a run: logs (`SMC_AxisDiagnosticLog`), the tracking error with dead time
//! (`SMC_GetTrackingError`) and the largest set values (`SMC_GetMaxSetVelocity`, `SMC_GetMaxSetAccDec`).

use crate::command::Failure;
use crate::command::whole::WholeFile;
use crate::machine::{Axis, Machine};
use crate::number::seconds;
use crate::report::AxisMaximaReport;
use crate::session::{DriveSample, TwinCycle};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use twin_drives::axis::{
    AxisError, DiagnosticLog, LogFormat, LogSelection, LogValues, MaxSetAccDec, MaxSetVelocity,
    Maximum, SetValues, TrackingError,
};
use twin_kinematics::AxisVector;

/// Cycles whose set positions are remembered: the longest dead time, and how late drives may be heard of.
const REMEMBERED: usize = 4000;
/// Records that the buffer of a log has room for in any case.
const RECORDS: u32 = 16;

/// What is watched of axes.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct AxisWatchOptions {
    /// Write values of an axis to a file, as `SMC_AxisDiagnosticLog` does, a record per sample of the drives, or per cycle without
    /// drives: AXIS=VALUES:FILE, with VALUES all or a list of set-position, act-position, set-velocity, act-velocity,
    /// set-acceleration, act-acceleration; may be given several times
    #[arg(long, value_name = "AXIS=VALUES:FILE")]
    log_axis: Vec<AxisLog>,

    /// Report per axis the largest tracking error against the set position so many cycles ago (`SMC_GetTrackingError`), and the
    /// largest set velocity and acceleration [default: 0 cycles]
    #[arg(long, value_name = "CYCLES", num_args = 0..=1, default_missing_value = "0")]
    tracking_error: Option<u8>,
}

/// A log of an axis that is wanted.
#[derive(Clone, Debug)]
struct AxisLog {
    axis: String,
    selection: LogSelection,
    file: PathBuf,
}

impl FromStr for AxisLog {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('=').and_then(|(axis, rest)| {
            let (values, file) = rest.split_once(':')?;
            Some((axis, values, file)).filter(|_| !axis.is_empty() && !file.is_empty())
        });
        let Some((axis, values, file)) = parts else {
            return Err(
                "expected AXIS=VALUES:FILE, like X=set-position,act-position:x.log".to_owned()
            );
        };
        let mut selection = LogSelection::default();
        for value in values.split(',') {
            let all = value == "all";
            let mut known = all;
            let mut choose = |name: &str, slot: &mut bool| {
                known |= value == name;
                *slot |= all || value == name;
            };
            choose("set-position", &mut selection.set_position);
            choose("act-position", &mut selection.act_position);
            choose("set-velocity", &mut selection.set_velocity);
            choose("act-velocity", &mut selection.act_velocity);
            choose("set-acceleration", &mut selection.set_acceleration);
            choose("act-acceleration", &mut selection.act_acceleration);
            if !known {
                return Err(format!(
                    "`{value}` is none of all, set-position, act-position, set-velocity, act-velocity, set-acceleration, \
                     act-acceleration"
                ));
            }
        }
        Ok(Self { axis: axis.to_owned(), selection, file: file.into() })
    }
}

impl AxisWatchOptions {
    /// The files that will be written.
    pub(super) fn targets(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        self.log_axis.iter().map(|log| ("--log-axis", log.file.as_path()))
    }

    /// Opens the logs; `drives` says whether drives are heard of.
    pub(super) fn open<'m>(
        &self,
        machine: &'m Machine,
        drives: bool,
    ) -> Result<AxisWatch<'m>, Failure> {
        let mut logs = Vec::with_capacity(self.log_axis.len());
        for wanted in &self.log_axis {
            let axis = machine.axes.iter().position(|axis| axis.name == wanted.axis);
            let axis = axis.ok_or_else(|| {
                let names: Vec<_> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
                let (name, names) = (&wanted.axis, names.join(", "));
                Failure::Usage(format!("--log-axis: there is no axis `{name}`; there are {names}"))
            })?;
            let file = WholeFile::create(&wanted.file)?;
            let log = DiagnosticLog::start(|| Ok(file), wanted.selection, &LogFormat::default());
            let log = log.map_err(|error| unlogged(&error))?;
            logs.push(Log { axis, out: log, waiting: 0, last: None });
        }
        let tracking = TrackingError::new(0);
        let (velocity, acceleration) = (MaxSetVelocity::default(), MaxSetAccDec::default());
        let one = Watched {
            tracking,
            velocity: (velocity, Maximum::default()),
            acceleration: (acceleration, Maximum::default()),
        };
        Ok(AxisWatch {
            machine,
            drives,
            dead_time: self.tracking_error,
            set: VecDeque::new(),
            axes: machine.axes.iter().map(|_| one.clone()).collect(),
            logs,
            failure: None,
        })
    }
}

fn unlogged(error: &AxisError) -> Failure {
    Failure::Usage(format!("--log-axis: {error}"))
}

/// Axes under watch.
pub(super) struct AxisWatch<'m> {
    machine: &'m Machine,
    /// Whether drives tell where the axes are, and not the simulated machine.
    drives: bool,
    /// Of the tracking error, in cycles, if that is wanted.
    dead_time: Option<u8>,
    /// Set positions of the last cycles, with their times.
    set: VecDeque<(i64, AxisVector)>,
    axes: Vec<Watched>,
    logs: Vec<Log>,
    /// What has gone wrong first.
    failure: Option<AxisError>,
}

#[derive(Clone, Debug)]
struct Watched {
    tracking: TrackingError,
    velocity: (MaxSetVelocity, Maximum),
    acceleration: (MaxSetAccDec, Maximum),
}

struct Log {
    axis: usize,
    out: DiagnosticLog<WholeFile>,
    /// Records in the buffer.
    waiting: u32,
    /// The record before, and when.
    last: Option<(i64, LogValues)>,
}

/// Milliseconds since the start, which stamps of maxima are.
fn stamp(time_ns: i64) -> u32 {
    u32::try_from(time_ns / 1_000_000).unwrap_or(0)
}

impl AxisWatch<'_> {
    /// A cycle of the simulated machine.
    pub(super) fn twin(&mut self, cycle: &TwinCycle<'_>) {
        let (time_ns, set) = (cycle.setpoint.time_ns, &cycle.setpoint.axes);
        if self.dead_time.is_some() {
            if self.set.len() == REMEMBERED {
                self.set.pop_front();
            }
            self.set.push_back((time_ns, set.position));
            for (index, (axis, watched)) in self.machine.axes.iter().zip(&mut self.axes).enumerate()
            {
                let of = |values: &AxisVector| {
                    axis.from_si(values.get(index).copied().unwrap_or_default())
                };
                let (velocity, acceleration) = (of(&set.velocity), of(&set.acceleration));
                let values = SetValues { velocity, acceleration };
                let (velocity, largest) = &mut watched.velocity;
                *largest = velocity.update(true, false, &values, stamp(time_ns));
                let (acceleration, largest) = &mut watched.acceleration;
                *largest = acceleration.update(true, false, &values, stamp(time_ns));
            }
        }
        if !self.drives {
            self.found(time_ns, &set.position, &cycle.twin.axes);
        }
    }

    /// A sample of the drives.
    pub(super) fn drives(&mut self, sample: &DriveSample<'_>) {
        self.found(sample.time_ns, &sample.wanted.axes, &sample.drives.axes);
    }

    /// The axes were found at `actual` when they should have been at `set`.
    fn found(&mut self, time_ns: i64, set: &AxisVector, actual: &AxisVector) {
        if let Some(cycles) = self.dead_time {
            let then_ns = time_ns - i64::from(cycles) * self.machine.cycle_ns;
            let then = self.set.iter().rev().find(|(at_ns, _)| *at_ns <= then_ns);
            // The set position of the sample itself is known between cycles, too.
            let then = if cycles == 0 { Some(*set) } else { then.map(|(_, set)| *set) };
            if let Some(then) = then {
                let axes = self.machine.axes.iter().zip(&mut self.axes);
                for ((axis, watched), (set, actual)) in axes.zip(then.iter().zip(actual.iter())) {
                    let pair = (axis.from_si(*set), axis.from_si(*actual));
                    let period = axis.period.map(|period| axis.from_si(period));
                    watched.tracking.update(true, false, pair, period, stamp(time_ns));
                }
            }
        }
        for log in &mut self.logs {
            let Some(axis) = self.machine.axes.get(log.axis) else { continue };
            if let Err(error) = log.record(axis, time_ns, [set, actual]) {
                self.failure.get_or_insert(error);
            }
        }
    }

    /// What there is to report, if it is wanted.
    pub(super) fn maxima(&self) -> Option<Vec<(String, AxisMaximaReport)>> {
        let dead_time_cycles = self.dead_time?;
        let axes = self.machine.axes.iter().zip(&self.axes).map(|(axis, watched)| {
            let (tracking, velocity, acceleration) =
                (watched.tracking.most(), watched.velocity.1, watched.acceleration.1);
            let report =
                AxisMaximaReport::new(axis, dead_time_cycles, [tracking, velocity, acceleration]);
            (axis.name.clone(), report)
        });
        Some(axes.collect())
    }

    /// Closes the logs.
    pub(super) fn finish(self) -> Result<(), Failure> {
        let mut failure = self.failure;
        let mut files = Vec::with_capacity(self.logs.len());
        for mut log in self.logs {
            match log.out.close() {
                Ok(file) => files.extend(file),
                Err(error) => {
                    failure.get_or_insert(error);
                }
            }
        }
        files.into_iter().try_for_each(WholeFile::finish)?;
        failure.map_or(Ok(()), |error| Err(unlogged(&error)))
    }
}

impl Log {
    /// Velocities and accelerations are those since the record before.
    fn record(
        &mut self,
        axis: &Axis,
        time_ns: i64,
        [set, actual]: [&AxisVector; 2],
    ) -> Result<(), AxisError> {
        let of =
            |values: &AxisVector| axis.from_si(values.get(self.axis).copied().unwrap_or_default());
        let mut values =
            LogValues { set_position: of(set), act_position: of(actual), ..LogValues::default() };
        if let Some((before_ns, before)) = self.last {
            let since = seconds(time_ns - before_ns);
            if since <= 0.0 {
                return Ok(());
            }
            values.set_velocity = (values.set_position - before.set_position) / since;
            values.act_velocity = (values.act_position - before.act_position) / since;
            values.set_acceleration = (values.set_velocity - before.set_velocity) / since;
            values.act_acceleration = (values.act_velocity - before.act_velocity) / since;
        }
        self.last = Some((time_ns, values));
        self.out.record(&values)?;
        self.waiting += 1;
        if self.waiting >= RECORDS {
            self.waiting = 0;
            self.out.write_to_file()?;
        }
        Ok(())
    }
}
