//! Summary of a plan as JSON.

use super::{Binding, Change, LimitSummary, LineLoss};
use crate::finding::Finding;
use crate::peak::AxisPeakReport;
use crate::per_axis::PerAxis;
use crate::program::ProgramFile;
use twin_machine::{Axis, Machine};
use twin_number::rounded;

/// The summary as JSON.
#[derive(Clone, Debug, serde::Serialize)]
pub struct LimitReport {
    program: String,
    machine: String,
    dialect: &'static str,
    limits: &'static str,
    length_mm: f64,
    /// Within all limits.
    duration_s: f64,
    /// With the programmed feed all the time.
    duration_by_feed_s: f64,
    #[serde(flatten)]
    compared: Option<ComparedReport>,
    peak: PerAxis<AxisPeakReport>,
    limited_by: Vec<ShareReport>,
    slowest_lines: Vec<LineReport>,
    changes: Vec<ChangeReport>,
    windows: u64,
    windows_failed: u64,
    windows_exceeded: u64,
    findings: Vec<Finding>,
}

/// Limits other than those of the axes.
#[derive(Clone, Copy, Debug, serde::Serialize)]
struct ComparedReport {
    duration_under_axis_limits_s: f64,
    /// That by `duration_s`.
    ratio: Option<f64>,
}

#[derive(Clone, Debug, serde::Serialize)]
struct ShareReport {
    #[serde(flatten)]
    limit: LimitName,
    time_s: f64,
    lost_s: f64,
}

#[derive(Clone, Debug, serde::Serialize)]
struct ChangeReport {
    #[serde(flatten)]
    limit: LimitName,
    raised_percent: f64,
    gain_s: f64,
}

#[derive(Clone, Debug, serde::Serialize)]
struct LineReport {
    line: u32,
    block: Option<u32>,
    programmed_feed_mm_per_s: f64,
    /// Rounded down.
    largest_feed_mm_per_s: Option<f64>,
    time_s: f64,
    lost_s: f64,
    #[serde(flatten)]
    limit: LimitName,
}

/// A limit; `None` is one that is not known.
#[derive(Clone, Debug, serde::Serialize)]
struct LimitName {
    limit: Option<&'static str>,
    axis: Option<String>,
}

impl LimitName {
    fn new(binding: Option<Binding>, axes: &[Axis]) -> Self {
        let axis = binding.and_then(|binding| binding.axis(axes));
        Self { limit: binding.map(Binding::name), axis: axis.map(|axis| axis.name.clone()) }
    }
}

impl LimitReport {
    /// The summary of `program` on `machine`.
    pub fn new(machine: &Machine, program: &ProgramFile, summary: &LimitSummary) -> Self {
        let axes = &machine.axes;
        let peaks = axes.iter().zip(&summary.peaks);
        let line = |line: &LineLoss| LineReport {
            line: line.place.line,
            block: line.place.block,
            programmed_feed_mm_per_s: rounded(line.programmed * 1e3),
            largest_feed_mm_per_s: line.allowed.map(|feed| rounded(feed * 1e3)),
            time_s: rounded(line.time_s),
            lost_s: rounded(line.lost_s),
            limit: LimitName::new(line.binding, axes),
        };
        Self {
            program: program.path().display().to_string(),
            machine: machine.path.display().to_string(),
            dialect: program.dialect().name(),
            limits: summary.limits.name(),
            length_mm: rounded(summary.length * 1e3),
            duration_s: rounded(summary.duration_s),
            duration_by_feed_s: rounded(summary.duration_by_feed_s),
            compared: summary.duration_under_axes_s.map(|duration_s| {
                let ratio = duration_s / summary.duration_s;
                ComparedReport {
                    duration_under_axis_limits_s: rounded(duration_s),
                    ratio: ratio.is_finite().then(|| rounded(ratio)),
                }
            }),
            peak: PerAxis(
                peaks
                    .map(|(axis, peak)| (axis.name.clone(), AxisPeakReport::new(axis, peak)))
                    .collect(),
            ),
            limited_by: summary
                .limited_by
                .iter()
                .map(|share| ShareReport {
                    limit: LimitName::new(share.binding, axes),
                    time_s: rounded(share.time_s),
                    lost_s: rounded(share.lost_s),
                })
                .collect(),
            slowest_lines: summary.lines.iter().map(line).collect(),
            changes: summary
                .changes
                .iter()
                .map(|change| ChangeReport {
                    limit: LimitName::new(Some(change.binding), axes),
                    raised_percent: rounded(Change::RAISED * 100.0),
                    gain_s: rounded(change.gain_s),
                })
                .collect(),
            windows: summary.windows.count,
            windows_failed: summary.windows.failed,
            windows_exceeded: summary.windows.exceeded,
            findings: Vec::new(),
        }
    }

    /// The report with the findings of the program.
    #[must_use]
    pub fn with_findings(self, findings: &[Finding]) -> Self {
        Self { findings: findings.to_vec(), ..self }
    }
}
