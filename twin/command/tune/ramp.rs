//! Report of a ramp.

use super::report::{Report, Section, short};
use serde_json::json;
use twin_profile::RampType;

impl Report<'_> {
    /// The ramp.
    pub(super) fn ramp(&self) -> Section {
        let mut text = Vec::new();
        let [_, slave] = self.units();
        let value = self.ramp.as_ref().map(|(kind, ramp)| {
            let (name, jerk) = match kind {
                RampType::Trapezoid => ("trapezoid", None),
                RampType::Sigmoid => ("sigmoid", Some(ramp.ramp_jerk)),
                RampType::Parabolic => ("parabolic", Some(ramp.ramp_jerk)),
            };
            let [duration, v, a, j] =
                [ramp.duration_s, ramp.peak_velocity, ramp.peak_acceleration, ramp.peak_jerk]
                    .map(short);
            let [low, high] = ramp.positions.map(|position| self.slave(position));
            let j = match jerk {
                Some(_) => format!("{v} {slave}/s, {a} {slave}/s² and {j} {slave}/s³ at most"),
                None => format!("{v} {slave}/s and {a} {slave}/s²"),
            };
            text.push(format!(
                "ramp: on the cam after {duration} s; the slave reaches {j}, and goes from {low} to {high} {slave}"
            ));
            let limit = self.before.limits.motion.jerk * (1.0 - 1e-6);
            text.extend(jerk.filter(|jerk| *jerk < limit).map(|jerk| {
                let jerk = short(jerk);
                format!(
                    "  with a jerk of {jerk} {slave}/s³ of the slave's axis: `max_jerk_…` of the machine file, MC_CamIn has no \
                     input for it"
                )
            }));
            json!({
                "velocity_difference": ramp.velocity_difference, "acceleration": ramp.acceleration,
                "deceleration": ramp.deceleration, "duration_s": ramp.duration_s,
                "peak_velocity": ramp.peak_velocity, "peak_acceleration": ramp.peak_acceleration,
                "peak_jerk": jerk.map(|_| ramp.peak_jerk), "ramp": name,
                "axis_jerk": jerk, "position_min": ramp.positions[0], "position_max": ramp.positions[1],
            })
        });
        Section { key: "ramp", value: json!(value), text }
    }
}
