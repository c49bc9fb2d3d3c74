//! Report as JSON: its shape is part of the command-line contract.

mod bodies;
mod drives;
mod m_functions;
mod motor_load;
mod rest;
mod switch_points;
mod tappets;

use crate::check::{BlockClearance, Outcome};
use crate::compare::{ErrorStatistics, Statistics};
use crate::finding::Finding;
use crate::peak::AxisPeakReport;
use crate::per_axis::PerAxis;
use crate::program::ProgramFile;
use crate::session::{OverrideChange, Punctuality};
pub use bodies::{BodyReport, PoseReport};
pub use drives::{AxisMaximaReport, PredictedFollowingReport};
use m_functions::MFunctionsReport;
pub use motor_load::MotorLoadReport;
pub use rest::RestReport;
use switch_points::SwitchPointsReport;
use tappets::TappetsReport;
use twin_machine::{Axis, Machine};
use twin_number::{rounded, seconds};

/// Report of `twin check` per program, which is also a part of the report of `twin run`.
#[derive(Clone, Debug, serde::Serialize)]
pub struct CheckReport {
    program: String,
    machine: String,
    dialect: &'static str,
    elements: u64,
    length_mm: f64,
    duration_s: f64,
    peak: PerAxis<AxisPeakReport>,
    /// With physics.
    #[serde(skip_serializing_if = "PerAxis::is_empty")]
    motor_load: PerAxis<MotorLoadReport>,
    /// With physics, if there are loose bodies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    bodies: Vec<BodyReport>,
    /// If the machine file says what is in the way.
    #[serde(skip_serializing_if = "Option::is_none")]
    clearance: Option<ClearanceReport>,
    /// If the reach of the machine has an edge.
    #[serde(skip_serializing_if = "Option::is_none")]
    edge_distance: Option<EdgeDistanceReport>,
    /// If the machine file names drives and they are wanted.
    #[serde(skip_serializing_if = "Option::is_none")]
    predicted_following: Option<PredictedFollowingReport>,
    /// If cams with tappets are run.
    #[serde(skip_serializing_if = "Option::is_none")]
    tappets: Option<TappetsReport>,
    /// If the path switches anything.
    #[serde(skip_serializing_if = "Option::is_none")]
    switch_points: Option<SwitchPointsReport>,
    /// If the program has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    m_functions: Option<MFunctionsReport>,
    findings: Vec<Finding>,
    findings_left_out: u64,
}

impl CheckReport {
    /// The outcome of checking `program` on `machine`.
    pub fn new(machine: &Machine, program: &ProgramFile, outcome: &Outcome) -> Self {
        let peaks = machine.axes.iter().zip(&outcome.peaks);
        Self {
            program: program.path().display().to_string(),
            machine: machine.path.display().to_string(),
            dialect: program.dialect().name(),
            elements: outcome.elements,
            length_mm: rounded(outcome.length * 1e3),
            duration_s: rounded(seconds(outcome.duration_ns)),
            peak: PerAxis(
                peaks
                    .map(|(axis, peak)| (axis.name.clone(), AxisPeakReport::new(axis, peak)))
                    .collect(),
            ),
            motor_load: PerAxis(
                machine
                    .axes
                    .iter()
                    .zip(&outcome.loads)
                    .map(|(axis, load)| (axis.name.clone(), MotorLoadReport::new(axis, load)))
                    .collect(),
            ),
            bodies: BodyReport::all(machine, &outcome.bodies),
            clearance: outcome.clearances.least.map(|least| ClearanceReport::new(machine, &least)),
            edge_distance: outcome.edge.map(|nearest| EdgeDistanceReport {
                least_mm: rounded(nearest.distance * 1e3),
                line: nearest.place.line,
                block: nearest.place.block,
            }),
            predicted_following: outcome
                .following
                .as_ref()
                .map(|predicted| PredictedFollowingReport::new(machine, predicted)),
            tappets: TappetsReport::new(&outcome.tappets),
            switch_points: SwitchPointsReport::new(&outcome.switch_points),
            m_functions: MFunctionsReport::new(&outcome.m_functions),
            findings: outcome.findings.clone(),
            findings_left_out: outcome.findings_left_out,
        }
    }
}

/// Smallest distance from the edge of the reach.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct EdgeDistanceReport {
    least_mm: f64,
    line: u32,
    block: Option<u32>,
}

/// Smallest clearance and its parts.
#[derive(Clone, Debug, serde::Serialize)]
pub struct ClearanceReport {
    least_mm: f64,
    between: [String; 2],
    line: u32,
    block: Option<u32>,
    time_s: f64,
}

impl ClearanceReport {
    /// Of the least of all.
    fn new(machine: &Machine, least: &BlockClearance) -> Self {
        let BlockClearance { place, time_ns, nearest, .. } = least;
        Self {
            least_mm: rounded(nearest.distance * 1e3),
            between: least.names(machine),
            line: place.line,
            block: place.block,
            time_s: rounded(seconds(*time_ns)),
        }
    }
}

/// Report of `twin run`.
#[derive(Clone, Debug, serde::Serialize)]
pub struct RunReport {
    /// The report of `twin check`.
    #[serde(flatten)]
    pub check: CheckReport,
    /// True if the program ran to its end.
    pub completed: bool,
    /// Reason of a stop.
    pub stopped_because: Option<String>,
    /// Rest positions of the axes, if the run was stopped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest: Option<RestReport>,
    /// Time of the last set-point that was sent, s.
    pub executed_s: f64,
    /// Changes of the override while the program ran.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub override_changes: Vec<OverrideChangeReport>,
    /// Sample statistics of the drives, if there were any.
    pub drive_samples: Option<DriveSamplesReport>,
    /// Switching delays of each device, by its name, that has switched outputs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub switched_outputs: Option<PerAxis<SwitchedOutputsReport>>,
    /// Cycle lateness of a run in step with the wall clock.
    pub cycle_lateness: Option<LatenessReport>,
    /// Errors of the tool tip.
    pub tool_error_mm: ComparisonReport,
    /// Errors per axis, in the axis's unit.
    pub axis_error: PerAxis<AxisErrorReport>,
    /// Results of SoftMotion's diagnosis blocks, if they were requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis_maxima: Option<PerAxis<AxisMaximaReport>>,
}

/// A change of the override.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct OverrideChangeReport {
    /// Time of the request, s since the start of the program.
    pub asked_s: f64,
    /// Requested override, %; 0 is a feed hold.
    pub override_percent: f64,
    /// Time from the request until the path began to follow, s; null if it never did.
    pub followed_after_s: Option<f64>,
}

impl OverrideChangeReport {
    /// Of a change during a run.
    pub fn new(change: &OverrideChange) -> Self {
        let OverrideChange { asked, follows_ns } = change;
        Self {
            asked_s: seconds(asked.time_ns),
            override_percent: rounded(asked.factor * 100.0),
            followed_after_s: follows_ns.map(|follows_ns| seconds(follows_ns - asked.time_ns)),
        }
    }
}

/// Sample statistics of the drives.
#[derive(Clone, Debug, serde::Serialize)]
pub struct DriveSamplesReport {
    /// Number of samples, of all devices.
    pub count: u32,
    /// Mean rate of all together, 1/s.
    pub per_s: f64,
    /// Longest time without a sample of one device, ms; in this time its axes are not corrected.
    pub longest_gap_ms: f64,
    /// Statistics of each device, by its name in the machine file.
    pub devices: PerAxis<DeviceSamplesReport>,
}

/// Sample statistics of one device.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct DeviceSamplesReport {
    /// Number of samples.
    pub count: u32,
    /// Mean rate, 1/s.
    pub per_s: f64,
    /// Longest time without one, ms.
    pub longest_gap_ms: f64,
    /// Answers that were lost and asked for again.
    pub lost_answers: u32,
}

/// Switching delays of one device: from the set-point at which an output was due until the device confirmed it.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct SwitchedOutputsReport {
    /// Number of switchings, by M functions and by tappets.
    pub count: u32,
    /// Mean delay, ms.
    pub mean_late_ms: f64,
    /// The latest, ms.
    pub max_late_ms: f64,
}

/// Cycle lateness of a run in step with the wall clock.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct LatenessReport {
    /// Number of cycles.
    pub cycles: u64,
    /// Half of them were not later, µs.
    pub p50_us: u64,
    /// 99 % of them were not later, µs.
    pub p99_us: u64,
    /// The latest, µs.
    pub max_us: u64,
}

impl LatenessReport {
    /// Of what a session has recorded.
    pub fn new(punctuality: &Punctuality) -> Self {
        Self {
            cycles: punctuality.cycles(),
            p50_us: punctuality.percentile_us(50.0),
            p99_us: punctuality.percentile_us(99.0),
            max_us: punctuality.max_us(),
        }
    }
}

/// Statistics of one kind of error for each pair that was compared.
#[derive(Clone, Debug, serde::Serialize)]
pub struct ComparisonReport {
    twin: Option<StatisticsReport>,
    drives: Option<StatisticsReport>,
    drives_against_twin: Option<StatisticsReport>,
}

/// As [`ComparisonReport`], with the unit.
#[derive(Clone, Debug, serde::Serialize)]
pub struct AxisErrorReport {
    unit: &'static str,
    #[serde(flatten)]
    comparison: ComparisonReport,
}

/// Of one kind of error.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct StatisticsReport {
    max: f64,
    rms: f64,
    line: u32,
    block: Option<u32>,
}

impl StatisticsReport {
    /// `scale` turns the SI values into the unit of the report; `None` where nothing was compared.
    pub(crate) fn new(statistics: &Statistics, scale: f64) -> Option<Self> {
        statistics.maximum().map(|(max, place)| Self {
            max: rounded(max * scale),
            rms: rounded(statistics.rms() * scale),
            line: place.line,
            block: place.block,
        })
    }
}

impl ComparisonReport {
    /// `scale` turns the SI values into the unit of the report.
    pub fn new(statistics: &ErrorStatistics, scale: f64) -> Self {
        let one = |one: &Statistics| StatisticsReport::new(one, scale);
        Self {
            twin: one(&statistics.twin),
            drives: one(&statistics.drives),
            drives_against_twin: one(&statistics.drives_against_twin),
        }
    }
}

impl AxisErrorReport {
    /// For one axis.
    pub fn new(axis: &Axis, statistics: &ErrorStatistics) -> Self {
        Self { unit: axis.unit(), comparison: ComparisonReport::new(statistics, axis.from_si(1.0)) }
    }
}
