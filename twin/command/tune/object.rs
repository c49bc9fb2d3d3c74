//! JSON output of the tuning report.

use super::report::Report;
use crate::cam::tune;
use crate::cam::tune::ShapeGoal;
use serde_json::{Value, json};
use twin_cam::tune::Estimate;
use twin_profile::RampType;

impl Report<'_> {
    pub(super) fn json(&self) -> Value {
        let estimate = |Estimate { value, half_width }: Estimate| json!({ "value": value, "half_width_95": half_width });
        let fit = self.fit.as_ref().map(|fit| {
            let names = || self.before.coupling.numbers().into_iter().map(|(_, name, _)| name.to_owned());
            let named = names().zip(fit.estimates.map(estimate));
            let proposed = names().zip(self.proposed.iter().flatten()).enumerate();
            let proposed = proposed.filter_map(|(index, (name, found))| {
                self.proposed_within(index).map(|_| (name, estimate(*found)))
            });
            json!({
                "estimates": named.collect::<serde_json::Map<_, _>>(),
                "proposed": self.proposed.as_ref().map(|_| proposed.collect::<serde_json::Map<_, _>>()),
                "samples": self.samples, "rms_before": self.error_before, "rms_after": self.error_after,
                "correlation": fit.correlation, "quantum": fit.quantum,
            })
        });
        let dead_time = self.dead_time.as_ref().map(|(found, count)| {
            json!({ "dead_time_s": estimate(found.dead_time_s), "switchings": count })
        });
        let [master_period, slave_period] = self.wound;
        let shape = self.shaped.as_ref().map(|shaped| {
            let what = match self.goal {
                Some(ShapeGoal::Peak(quantity)) => format!("peak {quantity}"),
                _ => "master velocity".to_owned(),
            };
            json!({
                "of": what, "before": shaped.before, "after": shaped.after,
                "limited_by": shaped.limited.map(|(quantity, _)| quantity.to_string()),
                "at_master": shaped.limited.map(|(_, at)| at),
                "beyond": self.beyond(shaped).into_iter().map(|(at, reached, limit)| {
                    json!({ "master": at, "slave": reached, "was": limit })
                }).collect::<Vec<_>>(),
                "points": shaped.knots.iter().map(|knot| {
                    json!({ "master": knot.master, "slave": knot.slave, "velocity": knot.velocity, "acceleration": knot.acceleration })
                }).collect::<Vec<_>>(),
            })
        });
        let ramp = self.ramp.as_ref().map(|(kind, ramp)| {
            let (kind, jerk) = match kind {
                RampType::Trapezoid => ("trapezoid", None),
                RampType::Sigmoid => ("sigmoid", Some(ramp.ramp_jerk)),
                RampType::Parabolic => ("parabolic", Some(ramp.ramp_jerk)),
            };
            json!({
                "velocity_difference": ramp.velocity_difference, "acceleration": ramp.acceleration,
                "deceleration": ramp.deceleration, "duration_s": ramp.duration_s,
                "peak_velocity": ramp.peak_velocity, "peak_acceleration": ramp.peak_acceleration,
                "peak_jerk": ramp.peak_jerk, "peak_cam_jerk": ramp.peak_cam_jerk, "ramp": kind, "axis_jerk": jerk, "position_min": ramp.positions[0], "position_max": ramp.positions[1],
            })
        });
        let [within, least] = [&self.within, &self.least]
            .map(|found| found.as_ref().map(|found| self.constrained_json(found)));
        let (file, block) = self.lines();
        let numbers =
            self.after.coupling.numbers().map(|(key, _, value)| (key.to_owned(), json!(value)));
        json!({
            "cam": self.file.cam.name(),
            "file": self.file.path.display().to_string(),
            "master": {
                "velocity": self.before.master.velocity, "acceleration": self.before.master.acceleration, "period": master_period,
                "passes_too_often_per_s": fit.as_ref().and_then(|_| tune::passes_too_often(self.file, &self.before)),
            },
            "slave_period": slave_period,
            "slave": fit.as_ref().map(|_| if self.wanted.is_some() { "measured" } else { "wanted" }),
            "fit": fit, "limited": self.limited.as_ref().map(|limited| self.limited_json(limited)),
            "within": within, "start": self.start_json(),
            "least": least, "dead_time": dead_time,
            "no_dead_time": self.no_dead_time, "shape": shape, "ramp": ramp,
            "tappets": self.tappets_json(),
            "coupling": numbers.into_iter().collect::<serde_json::Map<_, _>>(),
            "lines": { "coupling": file, "inputs": block, "points": self.points(), "tappets": self.moved_tappets() },
            "refused": self.refused,
        })
    }
}
