//! Result of a run: the summary for people and the report for programs.

use super::{Done, outputs};
use crate::check::Outcome;
use crate::command::atomic_file::{AtomicFile, unwritable};
use crate::command::{Failure, show};
use crate::compare::{Comparison, ErrorStatistics, Statistics};
use crate::hardware::Heard;
use crate::messages::recording_ended;
use crate::per_axis::PerAxis;
use crate::program::ProgramFile;
use crate::report::AxisMaximaReport;
use crate::report::{
    AxisErrorReport, CheckReport, ComparisonReport, DeviceSamplesReport, DriveSamplesReport,
    LatenessReport, OverrideChangeReport, RestReport, RunReport,
};
use crate::session::{Ending, Punctuality};
use std::io::{self, Write};
use std::path::Path;
use std::time::Duration;
use twin_machine::Machine;
use twin_number::{rounded, seconds};
use twin_viz::{Background, Ended, Item};

/// How often drives were heard of, all together and each.
fn samples_report(all: Heard, devices: &[(String, Heard)]) -> DriveSamplesReport {
    let of = |heard: Heard| DeviceSamplesReport {
        count: heard.count,
        per_s: heard.per_s(),
        longest_gap_ms: heard.longest_gap_ms(),
        lost_answers: heard.lost_answers,
    };
    let longest = devices.iter().map(|(_, heard)| heard.longest_gap_ms());
    DriveSamplesReport {
        count: all.count,
        per_s: all.per_s(),
        longest_gap_ms: longest.fold(0.0, f64::max),
        devices: PerAxis(devices.iter().map(|(name, heard)| (name.clone(), of(*heard))).collect()),
    }
}

/// A cycle that is so late shows a busy computer, µs.
const BUSY_US: u64 = 20_000;
/// Drives are heard of some thirty times a second; a gap of several times that is reported.
const LONGEST_USUAL_GAP_NS: i64 = 120_000_000;

/// Whether this computer was too busy for emulated drives, in words: nothing else delays them or their terminals.
pub(super) fn busy(ending: &Ending) -> Option<String> {
    let late_us = ending.punctuality.as_ref().map_or(0, Punctuality::max_us);
    let longest = ending.heard.iter().max_by_key(|(_, heard)| heard.longest_gap_ns);
    let gap = longest.filter(|(_, heard)| heard.longest_gap_ns > LONGEST_USUAL_GAP_NS);
    match gap {
        Some((device, heard)) => {
            let gap_ms = heard.longest_gap_ms();
            Some(format!("this computer was busy: `{device}` was not heard of for {gap_ms:.0} ms"))
        }
        None if late_us > BUSY_US => {
            Some(format!("this computer was busy: a cycle was {} ms late", late_us / 1000))
        }
        None => None,
    }
}

/// A few lines and a table for people.
pub(super) fn summary(out: &mut impl Write, machine: &Machine, done: &Done<'_>) -> io::Result<()> {
    let Done { ending, samples, took, .. } = done;
    let executed = seconds(ending.executed_ns);
    let ratio = if *took > 0.0 { executed / took } else { 0.0 };
    writeln!(out, "ran {executed:.3} s of program in {took:.3} s ({ratio:.1} × real time)")?;
    for change in &ending.overrides {
        let OverrideChangeReport { asked_s, override_percent, followed_after_s } =
            OverrideChangeReport::new(change);
        let what = if override_percent > 0.0 {
            format!("override {override_percent:.0} %")
        } else {
            "feed hold".to_owned()
        };
        match followed_after_s {
            Some(after) => {
                writeln!(
                    out,
                    "{what} asked for at {asked_s:.3} s; the path followed {after:.3} s later"
                )?;
            }
            None => {
                writeln!(out, "{what} asked for at {asked_s:.3} s; the path did not come to that")?;
            }
        }
    }
    if ending.late_plans > 0 {
        writeln!(
            out,
            "note: {} times a plan came too late and the path went on as it was planned before",
            ending.late_plans
        )?;
    }
    let mut busy = String::new();
    if let Some(punctuality) = &ending.punctuality {
        let LatenessReport { p50_us, p99_us, max_us, .. } = LatenessReport::new(punctuality);
        if max_us > BUSY_US {
            busy = format!(", or this computer was busy (a cycle was {} ms late)", max_us / 1000);
        }
        writeln!(
            out,
            "cycles: half of them at most {p50_us} µs late, 99 % at most {p99_us} µs, the latest {max_us} µs"
        )?;
    }
    if samples.count > 0 {
        writeln!(out, "drives: {} samples, {:.0} per second", samples.count, samples.per_s())?;
        for (device, heard) in &ending.heard {
            writeln!(
                out,
                "device `{device}`: {} samples, {:.0} per second, longest gap {:.0} ms{}",
                heard.count,
                heard.per_s(),
                heard.longest_gap_ms(),
                match heard.lost_answers {
                    0 => String::new(),
                    1 => ", 1 lost answer asked for again".to_owned(),
                    lost => format!(", {lost} lost answers asked for again"),
                }
            )?;
            if heard.longest_gap_ns > LONGEST_USUAL_GAP_NS {
                writeln!(
                    out,
                    "note: for {:.0} ms device `{device}` did not answer, and its axes were not corrected: an answer was lost or late{busy}; their errors are partly due to that",
                    heard.longest_gap_ms()
                )?;
            }
        }
    }
    for line in outputs::lateness(&ending.switched) {
        writeln!(out, "{line}")?;
    }
    let mut table = show::table();
    table.set_header(["error", "max", "rms", "line of max"]);
    let mut rows = |name: &str, statistics: &ErrorStatistics, scale: f64, unit: &str| {
        let mut row = |what: &str, one: &Statistics| {
            if let Some((max, place)) = one.maximum() {
                let block = place.block.map_or(String::new(), |block| format!(" (N{block})"));
                table.add_row([
                    format!("{name}, {what}"),
                    show::amount(max * scale, 4, unit),
                    show::amount(one.rms() * scale, 4, unit),
                    format!("{}{block}", place.line),
                ]);
            }
        };
        row("twin", &statistics.twin);
        row("drives", &statistics.drives);
        row("drives against twin", &statistics.drives_against_twin);
    };
    rows("tool", &ending.comparison.tool, 1e3, "mm");
    for (axis, statistics) in machine.axes.iter().zip(&ending.comparison.axes) {
        rows(&format!("axis {}", axis.name), statistics, axis.from_si(1.0), axis.unit());
    }
    writeln!(out, "{table}")
}

/// The report of a run, if one was requested.
pub(super) struct Report<'a> {
    /// Path of the report; none if it was not requested.
    pub(super) path: Option<&'a Path>,
    pub(super) machine: &'a Machine,
    pub(super) program: &'a ProgramFile,
    pub(super) outcome: &'a Outcome,
}

impl Report<'_> {
    /// Writes how a run ended; on standard output, with a finding, if the file cannot be written.
    ///
    /// # Errors
    /// [`Failure::Write`] if it is not in its file.
    pub(super) fn write(
        &self,
        ending: &Ending,
        (samples, maxima): (Heard, Option<Vec<(String, AxisMaximaReport)>>),
        stopped_because: Option<String>,
    ) -> Result<(), Failure> {
        let Some(path) = self.path else { return Ok(()) };
        let Comparison { tool, axes } = &ending.comparison;
        let axis_error = self.machine.axes.iter().zip(axes);
        let mut report = RunReport {
            check: CheckReport::new(self.machine, self.program, self.outcome),
            completed: stopped_because.is_none(),
            stopped_because,
            rest: ending.rest.as_ref().map(|rest| RestReport::new(self.machine, rest)),
            executed_s: rounded(seconds(ending.executed_ns)),
            override_changes: ending.overrides.iter().map(OverrideChangeReport::new).collect(),
            drive_samples: (samples.count > 0).then(|| samples_report(samples, &ending.heard)),
            switched_outputs: outputs::report(&ending.switched),
            cycle_lateness: ending.punctuality.as_ref().map(LatenessReport::new),
            tool_error_mm: ComparisonReport::new(tool, 1e3),
            axis_error: PerAxis(
                axis_error
                    .map(|(axis, one)| (axis.name.clone(), AxisErrorReport::new(axis, one)))
                    .collect(),
            ),
            axis_maxima: maxima.map(PerAxis),
        };
        let Err(ended) = to_file(path, ending.executed_ns, json(&report)?) else { return Ok(()) };
        let finding = recording_ended("report", path, &ended);
        show::findings(self.program, std::slice::from_ref(&finding), show::Shown::WithNotes);
        let mut outcome = self.outcome.clone();
        outcome.findings.push(finding);
        report.check = CheckReport::new(self.machine, self.program, &outcome);
        io::stdout().write_all(&json(&report)?).map_err(Failure::Stdio)?;
        Err(unwritable(path, ended.cause))
    }

    /// Writes that a run came to nothing, and why.
    pub(super) fn write_nothing(&self, reason: &str) -> Result<(), Failure> {
        let nothing = (Heard::default(), None);
        self.write(&Ending::nothing(self.machine), nothing, Some(reason.to_owned()))
    }
}

fn json(report: &RunReport) -> Result<Vec<u8>, Failure> {
    let mut text =
        serde_json::to_vec_pretty(report).map_err(|error| Failure::Stdio(error.into()))?;
    text.push(b'\n');
    Ok(text)
}

/// Writes a report to its file, which has half a second for it.
fn to_file(path: &Path, time_ns: i64, data: Vec<u8>) -> Result<(), Ended> {
    let name = path.to_owned();
    let never = |cause| Ended { time_ns, line: 0, cause, lost: 0 };
    let mut file = Background::open("report", move || AtomicFile::begin(&name)).map_err(never)?;
    file.send(Item { time_ns, line: 0, bytes: data.len(), records: 0, data }, Duration::ZERO);
    file.finish(Duration::from_millis(500))
}
