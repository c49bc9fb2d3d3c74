//! SoftMotion's diagnosis of axes during a run: logs (`SMC_AxisDiagnosticLog`), tracking error with dead time
//! (`SMC_GetTrackingError`), largest set values (`SMC_GetMaxSetVelocity`, `SMC_GetMaxSetAccDec`).

use crate::clock::Clock;
use crate::command::Failure;
use crate::command::atomic_file::{AtomicFile, unwritable};
use crate::finding::Finding;
use crate::messages::recording_ended;
use crate::report::AxisMaximaReport;
use crate::session::{DriveSample, TwinCycle};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;
use twin_axis::{Largest, tracking_error};
use twin_kinematics::AxisVector;
use twin_machine::{Axis, Machine};
use twin_number::seconds;
use twin_viz::{Background, Item};

/// Cycles whose set positions are remembered: the longest dead time, and how late drives may be heard of.
const REMEMBERED: usize = 4000;
/// Records are written when they have this size, bytes.
const BATCH: usize = 16 << 10;
/// How long a log may hold up a run that is not in step with the clock.
const PATIENCE: Duration = Duration::from_secs(1);
/// Values of a record, in the manual's order (10.4).
const VALUES: [&str; 6] = [
    "set-position",
    "act-position",
    "set-velocity",
    "act-velocity",
    "set-acceleration",
    "act-acceleration",
];

/// What is watched of axes.
#[derive(Clone, Debug, Default, clap::Args)]
pub(super) struct AxisWatchOptions {
    /// Write values of an axis to a file, as `SMC_AxisDiagnosticLog` does, a record per sample of the drives, or per cycle without
    /// drives: AXIS=VALUES:FILE, with VALUES all or a list of set-position, act-position, set-velocity, act-velocity,
    /// set-acceleration, act-acceleration; may be given several times
    #[arg(long, value_name = "AXIS=VALUES:FILE")]
    log_axis: Vec<AxisLog>,

    /// Report per axis the largest tracking error against the set position CYCLES ago (`SMC_GetTrackingError`), and the
    /// largest set velocity and acceleration [default: 0 cycles]
    #[arg(long, value_name = "CYCLES", num_args = 0..=1, default_missing_value = "0")]
    tracking_error: Option<u8>,
}

/// A log of an axis that is wanted.
#[derive(Clone, Debug)]
#[doc(alias = "SMC_AxisDiagnosticLog")]
struct AxisLog {
    axis: String,
    /// Which of [`VALUES`].
    selection: [bool; VALUES.len()],
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
        let mut selection = [false; VALUES.len()];
        for value in values.split(',') {
            if value != "all" && !VALUES.contains(&value) {
                return Err(format!("`{value}` is none of all, {}", VALUES.join(", ")));
            }
            for (chosen, name) in selection.iter_mut().zip(VALUES) {
                *chosen |= value == "all" || value == name;
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

    /// The same, to be changed.
    pub(super) fn files(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        self.log_axis.iter_mut().map(|log| &mut log.file)
    }

    /// Opens the logs; `drives` is true if there are samples of drives, `is_paced` if the run is in step with the clock:
    /// then a slow file costs records instead of time.
    pub(super) fn open<'m>(
        &self,
        machine: &'m Machine,
        drives: bool,
        is_paced: bool,
    ) -> Result<AxisWatch<'m>, Failure> {
        let mut logs = Vec::with_capacity(self.log_axis.len());
        for wanted in &self.log_axis {
            let axis = machine.axes.iter().position(|axis| axis.name == wanted.axis);
            let axis = axis.ok_or_else(|| {
                let names: Vec<_> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
                let (name, names) = (&wanted.axis, names.join(", "));
                Failure::Usage(format!("--log-axis: unknown axis `{name}`; the axes are {names}"))
            })?;
            let (selection, path) = (wanted.selection, wanted.file.clone());
            let file = Background::open("log", move || AtomicFile::begin(&path));
            let file = file.map_err(|source| unwritable(&wanted.file, source))?;
            let patience = if is_paced { Duration::ZERO } else { PATIENCE };
            let (path, batch) = (wanted.file.clone(), Item::default());
            logs.push(Log { axis, selection, path, file, patience, batch, last: None });
        }
        Ok(AxisWatch {
            machine,
            drives,
            dead_time: self.tracking_error,
            set: VecDeque::new(),
            axes: vec![Watched::default(); machine.axes.len()],
            logs,
        })
    }
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
}

#[derive(Clone, Copy, Debug, Default)]
struct Watched {
    tracking: Largest,
    velocity: Largest,
    acceleration: Largest,
}

struct Log {
    axis: usize,
    selection: [bool; VALUES.len()],
    path: PathBuf,
    file: Background<Vec<u8>>,
    patience: Duration,
    /// Records to be written.
    batch: Item<Vec<u8>>,
    /// The record before, and when.
    last: Option<(i64, [f64; VALUES.len()])>,
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
                watched.velocity.update(of(&set.velocity), stamp(time_ns));
                watched.acceleration.update(of(&set.acceleration), stamp(time_ns));
            }
        }
        if !self.drives {
            self.found((time_ns, cycle.setpoint.place.line), &set.position, &cycle.twin.axes);
        }
    }

    /// A sample of the drives.
    pub(super) fn drives(&mut self, sample: &DriveSample<'_>) {
        let at = (sample.time_ns, sample.place.line);
        self.found(at, &sample.wanted.axes, &sample.drives.axes);
    }

    /// The axes were found at `actual` when they should have been at `set`.
    fn found(&mut self, at: (i64, u32), set: &AxisVector, actual: &AxisVector) {
        let time_ns = at.0;
        if let Some(cycles) = self.dead_time {
            let then_ns = time_ns - i64::from(cycles) * self.machine.cycle_ns;
            let then = self.set.iter().rev().find(|(at_ns, _)| *at_ns <= then_ns);
            // The set position of the sample itself is known between cycles, too.
            let then = if cycles == 0 { Some(*set) } else { then.map(|(_, set)| *set) };
            if let Some(then) = then {
                let axes = self.machine.axes.iter().zip(&mut self.axes);
                for ((axis, watched), (set, actual)) in axes.zip(then.iter().zip(actual.iter())) {
                    let [set, actual] = [set, actual].map(|si| axis.from_si(*si));
                    let period = axis.period.map(|period| axis.from_si(period));
                    let error = tracking_error(set, actual, period);
                    watched.tracking.update(error, stamp(time_ns));
                }
            }
        }
        for log in &mut self.logs {
            let Some(axis) = self.machine.axes.get(log.axis) else { continue };
            log.record(axis, at, [set, actual]);
        }
    }

    /// Maxima for the report, if they were requested.
    pub(super) fn maxima(&self) -> Option<Vec<(String, AxisMaximaReport)>> {
        let dead_time_cycles = self.dead_time?;
        let axes = self.machine.axes.iter().zip(&self.axes).map(|(axis, watched)| {
            let maxima = [watched.tracking, watched.velocity, watched.acceleration];
            let report = AxisMaximaReport::new(axis, dead_time_cycles, maxima);
            (axis.name.clone(), report)
        });
        Some(axes.collect())
    }

    /// Declares that no records follow.
    pub(super) fn close(&mut self) {
        for log in &mut self.logs {
            log.send();
            log.file.close();
        }
    }

    /// Completes the logs, within a second of [`Self::close`] for all; those that ended before the run.
    pub(super) fn finish(&mut self, since_close: Clock) -> Vec<Finding> {
        let complete = |log: &mut Log| {
            let taken = u64::try_from(since_close.now_ns()).unwrap_or(0);
            let left = PATIENCE.saturating_sub(Duration::from_nanos(taken));
            Some(recording_ended("log", &log.path, &log.file.finish(left).err()?))
        };
        self.logs.iter_mut().filter_map(complete).collect()
    }
}

impl Log {
    /// Writes a record, TAB between its values and CR LF at its end. Velocities and accelerations are those since the record
    /// before.
    fn record(
        &mut self,
        axis: &Axis,
        (time_ns, line): (i64, u32),
        [set, actual]: [&AxisVector; 2],
    ) {
        let of =
            |values: &AxisVector| axis.from_si(values.get(self.axis).copied().unwrap_or_default());
        let positions = [of(set), of(actual)];
        let (mut velocities, mut accelerations) = ([0.0; 2], [0.0; 2]);
        if let Some((before_ns, [p, q, v, w, ..])) = self.last {
            let since = seconds(time_ns - before_ns);
            if since <= 0.0 {
                return;
            }
            let per_s = |now: [f64; 2], before: [f64; 2]| {
                [(now[0] - before[0]) / since, (now[1] - before[1]) / since]
            };
            velocities = per_s(positions, [p, q]);
            accelerations = per_s(velocities, [v, w]);
        }
        let [[p, q], [v, w], [a, b]] = [positions, velocities, accelerations];
        let values = [p, q, v, w, a, b];
        self.last = Some((time_ns, values));
        let chosen = values.iter().zip(self.selection).filter(|(_, chosen)| *chosen);
        let texts: Vec<_> = chosen.map(|(value, _)| value.to_string()).collect();
        if self.batch.records == 0 {
            (self.batch.time_ns, self.batch.line) = (time_ns, line);
        }
        self.batch.records += 1;
        self.batch.data.extend(format!("{}\r\n", texts.join("\t")).bytes());
        if self.batch.data.len() >= BATCH {
            self.send();
        }
    }

    /// Sends the records that are held back.
    fn send(&mut self) {
        let batch = std::mem::take(&mut self.batch);
        if batch.records > 0 {
            self.file.send(Item { bytes: batch.data.len(), ..batch }, self.patience);
        }
    }
}
