//! `[axes.physics.transmission]`: transmission from the motor's shaft to the axis.

use super::SimulatedTransmission;
use crate::axis_kind::AxisKind;
use crate::section::Section;
use std::f64::consts::TAU;
use twin_physics::EffortCurve;

/// Default damping ratio of a spring.
const DAMPING_RATIO: f64 = 0.05;

/// From the motor's shaft to the axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shaft {
    /// Radians of the motor per m or rad of the axis.
    pub(super) ratio: f64,
}

impl Shaft {
    pub(super) fn effort(self, torque: f64) -> f64 {
        torque * self.ratio
    }

    pub(super) fn inertia(self, inertia: f64) -> f64 {
        inertia * self.ratio * self.ratio
    }

    /// Efforts by speeds of the axis, from torques (Nm) by speeds of the motor (1/min).
    pub(super) fn curve(self, points: &[[f64; 2]]) -> Option<EffortCurve> {
        let points = points
            .iter()
            .map(|[rpm, torque]| [rpm * TAU / 60.0 / self.ratio, self.effort(*torque)]);
        EffortCurve::new(points.collect())
    }
}

/// From the motor to the axis, as far as it is known.
pub(super) fn shaft(
    section: &Section<'_>,
    kind: AxisKind,
    motor_turns: Option<f64>,
) -> Option<Shaft> {
    let gear = section.number("gear_ratio", 1e-3..=1e6);
    let pitch = match kind {
        AxisKind::Linear => section.number("pitch_mm", 1e-3..=1e5),
        AxisKind::Rotary => None,
    };
    let turns = match (kind, pitch) {
        (AxisKind::Rotary, _) => gear.map(|gear| gear / TAU),
        (AxisKind::Linear, Some(pitch)) => Some(gear.unwrap_or(1.0) / (pitch * 1e-3)),
        (AxisKind::Linear, None) => None,
    };
    if kind == AxisKind::Linear && gear.is_some() && pitch.is_none() {
        section.complain_at("gear_ratio", "`gear_ratio` has no effect without `pitch_mm`");
    }
    turns.or(motor_turns).map(|turns| Shaft { ratio: turns * TAU })
}

/// Reads what gives way.
pub(super) fn elastic(section: &Section<'_>, kind: AxisKind) -> Option<SimulatedTransmission> {
    let (key, scale) = match kind {
        AxisKind::Rotary => ("stiffness_nm_per_rad", 1.0),
        AxisKind::Linear => ("stiffness_n_per_mm", 1e3),
    };
    let stiffness = section.number(key, 1e-3..=1e9).map(|stiffness| stiffness * scale);
    let backlash_key = format!("backlash_{}", kind.unit());
    let backlash = section.number(&backlash_key, 0.0..=1e3);
    let damping_ratio = section.number("damping_ratio", 0.0..=2.0);
    if stiffness.is_none() && !section.has(key) {
        for wasted in [backlash_key.as_str(), "damping_ratio"] {
            if section.has(wasted) {
                section.complain_at(wasted, format!("`{wasted}` has no effect without `{key}`"));
            }
        }
    }
    Some(SimulatedTransmission {
        stiffness: stiffness?,
        damping_ratio: damping_ratio.unwrap_or(DAMPING_RATIO),
        backlash: backlash.unwrap_or(0.0) * kind.scale(),
    })
}

/// Complains that `key` is said at the motor's shaft, from which no way to the axis is known.
pub(super) fn needs_shaft(section: &Section<'_>, key: &str, kind: AxisKind) {
    let wanted = match kind {
        AxisKind::Rotary => "gear_ratio",
        AxisKind::Linear => "pitch_mm",
    };
    let message = format!(
        "`{key}` is of the motor's shaft and needs `{wanted}` in [axes.physics.transmission]"
    );
    section.complain_at(key, message);
}
