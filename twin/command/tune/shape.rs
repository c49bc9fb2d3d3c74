//! Report of a reshaped cam and of a ramp.

use super::report::{Report, Section, short};
use crate::cam::tune::{ShapeGoal, Shaped};
use serde_json::json;
use twin_cam::Curve;
use twin_number::at_most;
use twin_profile::RampType;

impl Report<'_> {
    /// Points that were moved.
    pub(super) fn shape(&self) -> Section {
        let Some(shaped) = &self.shaped else { return Section::empty("shape") };
        let [master, slave] = self.units();
        let (what, first) = if let Some(ShapeGoal::Peak(quantity)) = self.goal {
            let ([before, after], unit) =
                ([shaped.before, shaped.after].map(short), self.of(quantity));
            let text = format!(
                "shape: the slave's largest {quantity} falls from {before} to {after} {unit}"
            );
            (format!("peak {quantity}"), text)
        } else {
            let [before, after] = [shaped.before, shaped.after].map(|value| at_most(value, 6));
            let text =
                format!("shape: the master may go {after} {master}/s, it was {before} {master}/s");
            ("master velocity".to_owned(), text)
        };
        let mut text = vec![first];
        text.extend(shaped.limited.map(|(quantity, at)| {
            let at = self.place(at);
            format!("  now limited by the slave's {quantity} at master {at} {master}")
        }));
        let beyond = self.beyond(shaped);
        for (at, reached, limit) in &beyond {
            let edge = if reached > limit { "most" } else { "least" };
            let (at, [reached, limit]) =
                (self.place(*at), [*reached, *limit].map(|y| self.slave(y)));
            text.push(format!(
                "  the slave leaves its old range: it goes to {reached} {slave} at master {at} {master}, it was {limit} at {edge}"
            ));
        }
        let point = |knot: &twin_cam::Knot| {
            json!({
                "master": knot.master, "slave": knot.slave, "velocity": knot.velocity,
                "acceleration": knot.acceleration,
            })
        };
        let beyond = beyond
            .into_iter()
            .map(|(at, reached, limit)| json!({ "master": at, "slave": reached, "was": limit }));
        let value = json!({
            "of": what, "before": shaped.before, "after": shaped.after,
            "limited_by": shaped.limited.map(|(quantity, _)| quantity.to_string()),
            "at_master": shaped.limited.map(|(_, at)| at),
            "beyond": beyond.collect::<Vec<_>>(),
            "points": shaped.knots.iter().map(point).collect::<Vec<_>>(),
        });
        Section { key: "shape", value, text }
    }

    /// Where a shape takes the slave beyond the positions it had: master, position, and its most or least before.
    fn beyond(&self, shaped: &Shaped) -> Vec<(f64, f64, f64)> {
        let Ok(curve) = Curve::polynomial(&shaped.knots) else { return Vec::new() };
        let using = &self.after;
        let ends = |curve: &Curve| {
            let y = curve.extremes().position;
            let mut ends = [(y.min, y.at_min), (y.max, y.at_max)]
                .map(|(y, at)| (using.slave_at(y), using.master_at(at)));
            ends.sort_by(|one, other| one.0.total_cmp(&other.0));
            ends
        };
        let [old, new] = [ends(self.file.cam.curve()), ends(&curve)];
        let room = 1e-9 * (old[1].0 - old[0].0);
        let beyond = [new[0].0 < old[0].0 - room, new[1].0 > old[1].0 + room];
        let all = old.into_iter().zip(new).zip(beyond).filter(|(_, beyond)| *beyond);
        all.map(|(((limit, _), (reached, at)), _)| (at, reached, limit)).collect()
    }

    /// The ramp, and where it begins as a run does.
    pub(super) fn ramp(&self) -> Section {
        let mut text = Vec::from_iter(self.begins());
        let [_, slave] = self.units();
        let value = self.ramp.as_ref().map(|(kind, ramp)| {
            let (name, jerk) = match kind {
                RampType::Trapezoid => ("trapezoid", None),
                RampType::Sigmoid => ("sigmoid", Some(ramp.ramp_jerk)),
                RampType::Parabolic => ("parabolic", Some(ramp.ramp_jerk)),
            };
            let how = match jerk {
                None => "as its acceleration steps within a millisecond",
                Some(_) => "with the cam's own jerk",
            };
            let [duration, v, a, j, of_cam] = [
                ramp.duration_s,
                ramp.peak_velocity,
                ramp.peak_acceleration,
                ramp.peak_jerk,
                ramp.peak_cam_jerk,
            ]
            .map(short);
            let [low, high] = ramp.positions.map(|position| self.slave(position));
            text.push(format!(
                "ramp: on the cam after {duration} s; the slave reaches {v} {slave}/s, {a} {slave}/s² and, {how}, {j} {slave}/s³ \
                 (the cam alone {of_cam}), and goes from {low} to {high} {slave}"
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
                "peak_jerk": ramp.peak_jerk, "peak_cam_jerk": ramp.peak_cam_jerk, "ramp": name,
                "axis_jerk": jerk, "position_min": ramp.positions[0], "position_max": ramp.positions[1],
            })
        });
        Section { key: "ramp", value: json!(value), text }
    }
}
