//! Motor load of an axis of the simulated machine, in its units.

use twin_machine::Axis;
use twin_number::rounded;
use twin_physics::MotorLoad;

/// Load of the motor of one axis in the simulated machine, at the axis.
#[derive(Clone, Debug, serde::Serialize)]
pub struct MotorLoadReport {
    effort_unit: &'static str,
    peak_effort: f64,
    rms_effort: f64,
    /// Largest effort the motor has, if that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    effort_limit: Option<f64>,
    /// Largest effort against that, %.
    #[serde(skip_serializing_if = "Option::is_none")]
    utilisation_percent: Option<f64>,
    peak_power_w: f64,
    rms_power_w: f64,
    driving_energy_j: f64,
    braking_energy_j: f64,
    /// Largest losses of the winding, smoothed by its thermal time constant, against those it bears for ever, %.
    #[serde(skip_serializing_if = "Option::is_none")]
    warmth_percent: Option<f64>,
}

impl MotorLoadReport {
    /// For one axis.
    pub fn new(axis: &Axis, load: &MotorLoad) -> Self {
        Self {
            effort_unit: axis.kind.effort_unit(),
            peak_effort: rounded(load.peak_effort),
            rms_effort: rounded(load.rms_effort),
            effort_limit: axis.effort_limit().map(rounded),
            utilisation_percent: axis
                .effort_limit()
                .map(|limit| rounded(load.peak_effort / limit * 100.0)),
            peak_power_w: rounded(load.peak_power),
            rms_power_w: rounded(load.rms_power),
            driving_energy_j: rounded(load.driving_energy),
            braking_energy_j: rounded(load.braking_energy),
            warmth_percent: load.peak_warmth.map(|warmth| rounded(warmth * 100.0)),
        }
    }
}
