//! Report of drives: following-error prediction and axis maxima.

use crate::check::PredictedFollowing;
use crate::per_axis::PerAxis;
use crate::report::StatisticsReport;
use twin_axis::Largest;
use twin_machine::{Axis, Machine};
use twin_number::rounded;

/// Following-error prediction of the drives.
#[derive(Clone, Debug, serde::Serialize)]
pub struct PredictedFollowingReport {
    /// Of the tool tip.
    tool_mm: Option<StatisticsReport>,
    axes: PerAxis<PredictedAxisReport>,
    /// By their names in the machine file.
    devices: PerAxis<PredictedDeviceReport>,
}

/// How far the drive of one axis will be from its plan.
#[derive(Clone, Debug, serde::Serialize)]
struct PredictedAxisReport {
    unit: &'static str,
    device: String,
    /// `max_following_error` of the machine file.
    limit: Option<f64>,
    #[serde(flatten)]
    error: StatisticsReport,
}

/// What is said on the wire of a device.
#[derive(Clone, Copy, Debug, serde::Serialize)]
struct PredictedDeviceReport {
    family: &'static str,
    /// At most.
    commands_per_s: f64,
    /// At most.
    samples_per_s: f64,
    /// Commands and samples while the program runs.
    exchanges_per_s: f64,
}

impl PredictedFollowingReport {
    /// For a machine.
    pub(crate) fn new(machine: &Machine, predicted: &PredictedFollowing) -> Self {
        let axes = machine.axes.iter().zip(&predicted.axes).filter_map(|(axis, statistics)| {
            let device = machine.drives.get(axis.drive.as_ref()?.device)?.name.clone();
            let error = StatisticsReport::new(statistics.as_ref()?, axis.from_si(1.0))?;
            let limit = axis.max_following_error.map(|limit| rounded(axis.from_si(limit)));
            let unit = axis.unit();
            Some((axis.name.clone(), PredictedAxisReport { unit, device, limit, error }))
        });
        let devices = predicted.devices.iter().filter_map(|traffic| {
            let device = machine.drives.get(traffic.device)?;
            let report = PredictedDeviceReport {
                family: device.family_name(),
                commands_per_s: rounded(traffic.rates.commands_per_s),
                samples_per_s: rounded(traffic.rates.samples_per_s),
                exchanges_per_s: rounded(traffic.exchanges_per_s),
            };
            Some((device.name.clone(), report))
        });
        Self {
            tool_mm: StatisticsReport::new(&predicted.tool, 1e3),
            axes: PerAxis(axes.collect()),
            devices: PerAxis(devices.collect()),
        }
    }
}

/// Results of SoftMotion's diagnosis blocks for an axis, in its unit.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct AxisMaximaReport {
    unit: &'static str,
    dead_time_cycles: u8,
    tracking_error: MaximumReport,
    set_velocity: MaximumReport,
    set_acceleration: MaximumReport,
}

#[derive(Clone, Copy, Debug, serde::Serialize)]
struct MaximumReport {
    max: f64,
    time_s: f64,
}

impl AxisMaximaReport {
    /// Of an axis: its tracking error against the set position a number of cycles ago, its set velocity and acceleration; stamps are
    /// in ms.
    pub fn new(axis: &Axis, dead_time_cycles: u8, maxima: [Largest; 3]) -> Self {
        let report = |most: Largest| MaximumReport {
            max: rounded(most.value),
            time_s: rounded(f64::from(most.time) * 1e-3),
        };
        let [tracking_error, set_velocity, set_acceleration] = maxima.map(report);
        Self { unit: axis.unit(), dead_time_cycles, tracking_error, set_velocity, set_acceleration }
    }
}
