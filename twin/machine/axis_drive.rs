//! Drive of an axis in `[[axes]]`: device, increments per unit, limit switches and homing direction.

use super::counting::{Counting, IncrementRatio};
use super::drives::Seen;
use crate::axis_kind::AxisKind;
use crate::section::Section;
use twin_drives::family::Abilities;

/// The drive of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisDrive {
    /// Index into [`super::Machine::drives`].
    pub device: usize,
    /// Axis of the device, from 0; the address of a SmartDRIVE.
    pub index: usize,
    /// Increments per unit.
    pub ratio: IncrementRatio,
    /// The same ratio in the form for computation.
    pub counting: Counting,
    /// Its switches in the file.
    pub switches: Switches,
}

/// Switches of an axis in the machine file, which its device has to know.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switches {
    /// Presence of a limit switch towards smaller positions, and towards larger ones.
    pub limits: Option<[bool; 2]>,
    /// Homing direction: true towards larger positions.
    pub home_positive: Option<bool>,
}

impl Switches {
    const KEYS: [&'static str; 2] = ["limit_switches", "home_direction"];

    fn read(section: &Section<'_>) -> Self {
        let ends = [
            ("none", [false, false]),
            ("negative", [true, false]),
            ("positive", [false, true]),
            ("both", [true, true]),
        ];
        Self {
            limits: section.choice("limit_switches", &ends),
            home_positive: section
                .choice("home_direction", &[("negative", false), ("positive", true)]),
        }
    }
}

impl AxisDrive {
    /// True if the drive counts down where the axis goes towards larger positions.
    pub const fn reversed(&self) -> bool {
        self.ratio.increments < 0
    }
}

pub(super) fn read(section: &Section<'_>, kind: AxisKind, devices: &[Seen]) -> Option<AxisDrive> {
    let (axis_kind, unit) = (kind, kind.unit());
    let device = section.text("drive");
    // Which of them it is depends on the device.
    let axis_keys = ["drive_axis", "drive_address"];
    for key in axis_keys {
        section.accept(key);
    }
    let increments = section.integer("increments", -1_000_000_000_000..=1_000_000_000_000);
    let per_key = format!("per_{unit}");
    let per_units = section.number(&per_key, 1e-6..=1e9);
    let switches = Switches::read(section);
    let Some(device) = device else {
        if !section.has("drive") {
            let keys = ["drive_axis", "drive_address", "increments", &per_key];
            for key in keys.into_iter().chain(["max_step_frequency_khz"]).chain(Switches::KEYS) {
                if section.has(key) {
                    section.complain_at(key, format!("`{key}` has no effect without a `drive`"));
                }
            }
        }
        return None;
    };
    let Some(found) = devices.iter().position(|seen| seen.name == device) else {
        let known = if devices.is_empty() {
            "there is no [[drives]]".to_owned()
        } else {
            let names: Vec<_> = devices.iter().map(|device| device.name.as_str()).collect();
            format!("the [[drives]] are named {}", names.join(", "))
        };
        section.complain_at("drive", format!("`drive` is \"{device}\", but {known}"));
        return None;
    };
    let seen = devices.get(found)?;
    // Without a family it is not known which axes there are.
    let family = seen.family?;
    let index = family.axis(section);
    for key in axis_keys.into_iter().filter(|key| *key != family.axis_key() && section.has(key)) {
        let message = format!("axes of this drive are named by `{}`", family.axis_key());
        section.complain_at(key, message);
    }
    for key in [family.axis_key(), "increments", &per_key] {
        if !section.has(key) {
            section.complain(format!("an axis with a `drive` needs `{key}` too"));
        }
    }
    if increments == Some(0) {
        section
            .complain_at("increments", "`increments` is 0; a drive that never steps moves nothing");
        return None;
    }
    let ratio = IncrementRatio { increments: increments?, per_units: per_units? };
    // Without its abilities the device has an error, which is reported already.
    #[expect(clippy::cast_possible_truncation, reason = "the counters of devices have 32 bits")]
    let most = seen.abilities.as_ref().map_or(i32::MAX.into(), |able| able.counts as i64);
    let counting = Counting::new(axis_kind, &ratio, most)?;
    Some(AxisDrive { device: found, index: index?, ratio, counting, switches })
}

/// Checks that an increment of the drive is a microstep of the simulated step motor.
pub(super) fn check_steps(section: &Section<'_>, unit: &str, increments: f64, microsteps: f64) {
    if (increments.abs() / microsteps - 1.0).abs() > 1e-6 {
        let message = format!(
            "the drive makes {:.6} increments per {unit}, the motor of [axes.physics.stepper] has {microsteps:.6} microsteps \
             per {unit}: one of `increments`, `full_steps_per_turn`, `microsteps` and the transmission is wrong",
            increments.abs()
        );
        section.complain_at("increments", message);
    }
}

/// Checks counter and step frequency of the drive against the limits of the axis.
pub(super) fn check(
    section: &Section<'_>,
    unit: &str,
    ratio: &IncrementRatio,
    able: &Abilities,
    limits: [f64; 2],
    (max_velocity, step_frequency_hz): (f64, Option<f64>),
) {
    let per_unit = ratio.per_unit().abs();
    let speed = (max_velocity * per_unit).min(step_frequency_hz.unwrap_or(f64::INFINITY));
    let Abilities { speeds, counts, .. } = able;
    if !speeds.contains(&speed) {
        let (low, high) = (speeds.start(), speeds.end());
        let mut message = format!(
            "{max_velocity} {unit}/s are {speed:.0} steps/s; the drive makes {low} to {high} steps/s"
        );
        if speed > *high {
            message += ", and `max_step_frequency_khz` would keep the axis within them";
        }
        section.complain_at("increments", message);
    }
    let farthest = limits.into_iter().map(f64::abs).fold(0.0, f64::max);
    let count = farthest * per_unit;
    if count > *counts {
        let message =
            format!("{farthest} {unit} are {count:.0} increments; the drive counts to {counts}");
        section.complain_at("increments", message);
    }
}
