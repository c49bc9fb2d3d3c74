//! Metadata of a cam file: scales of master and slave, and the coupling.

use crate::axis_kind::AxisKind;
use twin_cam::{CamInput, Scale, StartMode};

/// Range and unit of master or slave, for tables and pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisScale {
    /// Least value, u.
    pub min: f64,
    /// Greatest value, u.
    pub max: f64,
    /// Distance of marks, u.
    pub step: f64,
    /// Unit u; empty if the file does not say.
    pub unit: String,
}

impl AxisScale {
    /// The unit in words for people: `u` if it is not known.
    pub fn unit(&self) -> &str {
        if self.unit.is_empty() { "u" } else { &self.unit }
    }

    /// The unit as part of a key or a column: letters and digits only.
    pub fn key(&self) -> String {
        let unit = self.unit.replace('°', "deg");
        let plain: String = unit.chars().filter(char::is_ascii_alphanumeric).collect();
        if plain.is_empty() { "u".to_owned() } else { plain }
    }

    /// Without a unit; a scale of no width is 1 wide, in tenths.
    pub(super) fn bare(min: f64, max: f64) -> Self {
        let step = if max > min { (max - min) / 10.0 } else { 0.1 };
        Self { min, max, step, unit: String::new() }
    }

    /// A column of positions: `master_deg`, or `master (1/min)` if the unit is more than letters and digits.
    pub(super) fn column(&self, name: &str) -> String {
        let key = self.key();
        if self.unit.is_empty() || key == self.unit || self.unit == "°" {
            format!("{name}_{key}")
        } else {
            format!("{name} ({})", self.unit)
        }
    }
}

/// Unit of a column; empty if it is `u`, which is not known.
pub fn unit_of(column: &str) -> String {
    let unit = super::columns::unit(column);
    if unit == "u" { String::new() } else { unit.to_owned() }
}

impl From<&Scale> for AxisScale {
    fn from(scale: &Scale) -> Self {
        Self { min: scale.min, max: scale.max, step: scale.step, unit: scale.unit.clone() }
    }
}

/// `[coupling]`: how the cam is used, the inputs of `MC_CamIn` and `SMC_CAMRegister` (manual 5.4, 5.5).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coupling {
    /// Inputs of `MC_CamIn`.
    pub input: CamInput,
    /// `DeadTimeCompensation` of the tappets, s.
    pub dead_time_s: f64,
    /// Intended offsets and scalings of master and slave, if the inputs compensate others; `None`: the inputs.
    pub wanted: Option<[f64; 4]>,
}

/// Smallest magnitude of a scaling: smaller ones are rounding errors of 0.
const LEAST_SCALING: f64 = 1e-15;

/// Error message if the scaling `name` is 0 or rounding, or is not finite.
pub fn no_scaling(name: &str, value: f64) -> Option<String> {
    if value == 0.0 {
        Some(format!("{name} is 0; nothing would move"))
    } else if !value.is_finite() {
        Some(format!("{name} is {value}; it must be a finite number"))
    } else if value.abs() < LEAST_SCALING {
        Some(format!("{name} is {value:e}; {LEAST_SCALING:e} is the least scaling"))
    } else {
        None
    }
}

/// Keys of [`Coupling::wanted`].
pub const WANTED: [&str; 4] = [
    "wanted_master_offset",
    "wanted_master_scaling",
    "wanted_slave_offset",
    "wanted_slave_scaling",
];

/// The start modes by their names in files.
pub(crate) const START_MODES: [(&str, StartMode); 5] = [
    ("absolute", StartMode::Absolute),
    ("relative", StartMode::Relative),
    ("ramp_in", StartMode::RampIn),
    ("ramp_in_pos", StartMode::RampInPositive),
    ("ramp_in_neg", StartMode::RampInNegative),
];

impl Coupling {
    /// Keys of `[coupling]` with the names of the inputs and their values, without the start mode.
    pub fn numbers(&self) -> [(&'static str, &'static str, f64); 9] {
        let input = &self.input;
        [
            ("master_offset", "MasterOffset", input.master_offset),
            ("master_scaling", "MasterScaling", input.master_scaling),
            ("slave_offset", "SlaveOffset", input.slave_offset),
            ("slave_scaling", "SlaveScaling", input.slave_scaling),
            ("velocity_difference", "VelocityDiff", input.velocity_difference),
            ("acceleration", "Acceleration", input.acceleration),
            ("deceleration", "Deceleration", input.deceleration),
            ("tappet_hysteresis", "TappetHysteresis", input.tappet_hysteresis),
            ("dead_time_s", "DeadTimeCompensation", self.dead_time_s),
        ]
    }

    /// The name of the start mode in files.
    pub fn start_mode(&self) -> &'static str {
        let mode = self.input.start_mode;
        START_MODES.iter().find(|(_, other)| *other == mode).map_or("absolute", |(name, _)| name)
    }
}

/// True if the unit of a scale fits an axis, or is not known.
pub fn unit_fits(scale: &AxisScale, kind: AxisKind) -> bool {
    let known: &[&str] = match kind {
        AxisKind::Rotary => &["deg", "°", "degree", "degrees"],
        AxisKind::Linear => &["mm"],
    };
    scale.unit.is_empty() || known.contains(&scale.unit.trim())
}
