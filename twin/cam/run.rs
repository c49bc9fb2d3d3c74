//! Recorded runs: where master and slave were, and what tappets had switched.

use std::borrow::Cow;
use std::path::Path;
use twin_machine::cam_file::columns;
use twin_machine::cam_file::{AxisScale, unit_of};
use twin_machine::cam_file::{CamFile, CamFileError};
use twin_machine::limited_read;
use twin_number::counted;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RunSample {
    pub(crate) line: u64,
    /// s.
    pub(crate) time_s: f64,
    /// Position of the master, u.
    pub(crate) master: f64,
    /// Position of the slave, u.
    pub(crate) slave: f64,
    /// Whether the output of each group was on.
    pub(crate) outputs: Vec<bool>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RecordedRun {
    /// Groups of tappets whose outputs were recorded, in the order of [`RunSample::outputs`].
    pub(crate) groups: Vec<i16>,
    /// By ascending times.
    pub(crate) samples: Vec<RunSample>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Column {
    Time(f64),
    Master,
    Slave,
    Tappet(i16),
}

impl RecordedRun {
    /// Reads a run of a cam, as [`Self::parse`]; units of master and slave that the header names must be those of the cam's file.
    pub(crate) fn load_for(file: &CamFile, path: &Path) -> Result<Self, CamFileError> {
        let bytes = bytes(path)?;
        let names = columns::read(path, &bytes)?.names;
        for name in names.iter().flatten() {
            let (which, own) = match columns::plain(name).as_str() {
                "master" => ("master", &file.master),
                "slave" => ("slave", &file.slave),
                _ => continue,
            };
            let named = AxisScale { unit: unit_of(name), ..own.clone() };
            let unknown = named.unit.is_empty() || own.unit.is_empty();
            if !unknown && !named.key().eq_ignore_ascii_case(&own.key()) {
                let message = format!("column `{name}`: the {which} of the cam is in {}", own.unit);
                return Err(CamFileError::Table { path: path.to_owned(), line: 1, message });
            }
        }
        Self::parse(path, &bytes)
    }

    /// Reads a run: columns time, master and slave, in this order if there is no header, and `tappet_N` for outputs of
    /// groups (0 or 1). Units in the header are tolerated; times in ms and µs (`time_ms`, `time_us`) become seconds.
    /// [`CamFileError`] has file, line and column; `path` is for messages.
    pub(crate) fn parse(path: &Path, bytes: &[u8]) -> Result<Self, CamFileError> {
        let wrong = |line, message| CamFileError::Table { path: path.to_owned(), line, message };
        let read = columns::read(path, bytes)?;
        let width = read.rows.first().map_or(0, |(_, row)| row.len());
        let order = match &read.names {
            None if width == 3 => vec![Column::Time(1.0), Column::Master, Column::Slave],
            None => {
                let message = format!(
                    "{} without a header; expected time, master and slave, or a header that names them",
                    counted(width, "column")
                );
                return Err(wrong(1, message));
            }
            Some(names) => names
                .iter()
                .map(|name| column(name).map_err(|message| wrong(1, message)))
                .collect::<Result<Vec<_>, _>>()?,
        };
        for (what, is) in [
            ("time", (|column| matches!(column, Column::Time(_))) as fn(&Column) -> bool),
            ("master", |column| *column == Column::Master),
            ("slave", |column| *column == Column::Slave),
        ] {
            let found = order.iter().filter(|column| is(column)).count();
            if found != 1 {
                return Err(wrong(1, format!("{found} columns `{what}`; there must be one")));
            }
        }
        let groups = order.iter().filter_map(|column| match column {
            Column::Tappet(group) => Some(*group),
            _ => None,
        });
        let groups: Vec<_> = groups.collect();
        let mut sorted = groups.clone();
        sorted.sort_unstable();
        if let Some(same) = sorted.chunk_by(|a, b| a == b).find(|same| same.len() > 1)
            && let [group, ..] = same
        {
            let message = format!("{} columns `tappet_{group}`; there must be one", same.len());
            return Err(wrong(1, message));
        }
        let mut run = Self { groups, samples: Vec::with_capacity(read.rows.len()) };
        for (line, row) in &read.rows {
            let mut sample = RunSample {
                line: *line,
                time_s: 0.0,
                master: 0.0,
                slave: 0.0,
                outputs: Vec::new(),
            };
            for (value, column) in row.iter().zip(&order) {
                match column {
                    Column::Time(unit) => sample.time_s = value * unit,
                    Column::Master => sample.master = *value,
                    Column::Slave => sample.slave = *value,
                    Column::Tappet(group) => match *value {
                        0.0 => sample.outputs.push(false),
                        1.0 => sample.outputs.push(true),
                        _ => {
                            let message = format!("tappet_{group} is {value}; it must be 0 or 1");
                            return Err(wrong(*line, message));
                        }
                    },
                }
            }
            if let Some(last) = run.samples.last().filter(|last| sample.time_s <= last.time_s) {
                let message = format!(
                    "time {} s is not later than {} s in line {}",
                    sample.time_s, last.time_s, last.line
                );
                return Err(wrong(*line, message));
            }
            run.samples.push(sample);
        }
        Ok(run)
    }

    /// The usual time between two samples, s: the median.
    pub(crate) fn between_s(&self) -> f64 {
        let pairs = self.samples.iter().zip(self.samples.iter().skip(1));
        median(pairs.map(|(one, next)| next.time_s - one.time_s).collect())
    }

    /// The same run with a master that goes on where its positions begin again after whole turns of `turn`, as those do that are
    /// recorded within the period of an axis. A step is taken for such an end if it goes over more than half a turn, and over
    /// more than half of where the master goes at all: one that is so fast goes farther.
    pub(crate) fn unwound(&self, turn: f64) -> Cow<'_, Self> {
        let masters = || self.samples.iter().map(|sample| sample.master);
        let least = masters().fold(f64::INFINITY, f64::min);
        let most = masters().fold(f64::NEG_INFINITY, f64::max);
        let end = (turn / 2.0).max((most - least) / 2.0);
        let on = turns(masters(), turn, end);
        if !(turn > 0.0 && end.is_finite() && on.iter().any(|turns| *turns != 0.0)) {
            return Cow::Borrowed(self);
        }
        let mut run = self.clone();
        run.samples.iter_mut().zip(on).for_each(|(sample, turns)| sample.master += turns * turn);
        Cow::Owned(run)
    }

    /// The standard deviation of the noise of the master's positions, u: by how far samples lie off the line through their
    /// neighbours, but for one in twenty, which may be where the master jumps. Acceleration counts as noise.
    pub(crate) fn noise(&self) -> f64 {
        // Of normal noise 95 % lie within.
        const WITHIN: f64 = 1.959_963_984_540_054;
        let off_line = |three: &[RunSample]| {
            let [before, sample, after] = three else { return None };
            let share = (sample.time_s - before.time_s) / (after.time_s - before.time_s);
            let line = before.master + share * (after.master - before.master);
            // Each of the three has the noise.
            let larger = (1.0 + share * share + (1.0 - share).powi(2)).sqrt();
            Some((sample.master - line).abs() / larger)
        };
        let off_line = |three: &[RunSample]| off_line(three).filter(|apart| apart.is_finite());
        let mut all: Vec<_> = self.samples.windows(3).filter_map(off_line).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() * 19 / 20).copied().unwrap_or_default() / WITHIN
    }

    /// The master's velocity about a sample, u/s: the slope of the line that fits it and three on either side best.
    pub(crate) fn velocity(&self, index: usize) -> f64 {
        let near = self.samples.get(index.saturating_sub(3)..(index + 4).min(self.samples.len()));
        let near = near.unwrap_or_default();
        #[expect(clippy::cast_precision_loss, reason = "seven at most")]
        let count = near.len().max(1) as f64;
        let time = near.iter().map(|sample| sample.time_s).sum::<f64>() / count;
        let master = near.iter().map(|sample| sample.master).sum::<f64>() / count;
        let (mut above, mut below) = (0.0, 0.0);
        for sample in near {
            above += (sample.time_s - time) * (sample.master - master);
            below += (sample.time_s - time).powi(2);
        }
        if below > 0.0 { above / below } else { 0.0 }
    }
}

/// How many periods each of the positions is on from where it was recorded: a step of more than `end` is the end of a period.
pub(crate) fn turns(
    positions: impl Iterator<Item = f64> + Clone,
    period: f64,
    end: f64,
) -> Vec<f64> {
    let steps = positions.clone().zip(positions.skip(1)).map(|(one, next)| next - one);
    let mut turns = 0.0;
    let on = steps.map(|step| {
        turns -= if step.abs() > end { (step / period).round() } else { 0.0 };
        turns
    });
    std::iter::once(0.0).chain(on).collect()
}

pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

fn bytes(path: &Path) -> Result<Vec<u8>, CamFileError> {
    limited_read::read(path)
        .map_err(|source| CamFileError::ReadRun { path: path.to_owned(), source })
}

fn column(name: &str) -> Result<Column, String> {
    match columns::plain(name).as_str() {
        "time" | "t" => match columns::unit(name) {
            "" | "s" => Ok(Column::Time(1.0)),
            "ms" => Ok(Column::Time(1e-3)),
            "us" | "µs" => Ok(Column::Time(1e-6)),
            other => Err(format!(
                "column `{name}`: `{other}` is not a unit of time; expected s, ms or us"
            )),
        },
        "master" => Ok(Column::Master),
        "slave" => Ok(Column::Slave),
        "tappet" => {
            let group = columns::unit(name).parse().ok();
            group.map(Column::Tappet).ok_or_else(|| {
                format!(
                    "column `{name}` names no group: expected tappet_N with N from -32768 to 32767"
                )
            })
        }
        _ => Err(format!("column `{name}` is not one of time, master, slave, tappet_N")),
    }
}
