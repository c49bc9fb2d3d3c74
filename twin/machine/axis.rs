//! `[[axes]]`: name, kind, limits and drive of each axis of the machine.

use super::axis_drive::{self, AxisDrive};
use super::counting::Counting;
use super::drives::Seen;
use super::limits::{AxisLimit, DriveLimits, VelocityLimit, VelocityLimits, read_headroom};
use super::simulated::{self, SimulatedAxis, SimulatedMotor};
use crate::axis_kind::AxisKind;
use crate::section::Section;
use std::ops::Range;

/// Farthest position of an axis, degrees or mm.
const MOST: f64 = 1e6;

/// One axis of the machine. SI inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Its name in reports.
    pub name: String,
    /// Rotary or linear.
    pub kind: AxisKind,
    /// Software limits, m or rad; for a modulo axis without limits the range of numbers or of its drive.
    pub position_limits: [f64; 2],
    /// Modulo period (`fPositionPeriod`), m or rad; `None`: not modulo.
    pub period: Option<f64>,
    /// True if the machine file gives the limits.
    pub limited: bool,
    /// m/s or rad/s: the smallest of [`Self::velocity_limits`].
    pub max_velocity: f64,
    /// Velocity limits by source.
    pub velocity_limits: VelocityLimits,
    /// Largest acceleration, m/s² or rad/s²; also the deceleration unless [`Self::max_deceleration`] differs.
    pub max_acceleration: f64,
    /// Largest deceleration, m/s² or rad/s²: while its speed falls (`fSWMaxDeceleration`).
    pub max_deceleration: f64,
    /// m/s³ or rad/s³; `None`: not limited.
    pub max_jerk: Option<f64>,
    /// Largest change of the velocity at once, m/s or rad/s, if the file says it: [`Self::velocity_step`].
    pub max_velocity_step: Option<f64>,
    /// Part of the velocity that a plan leaves to the override, 0 to 0.9.
    pub headroom: f64,
    /// Largest distance from the set-point, m or rad; `None`: not watched.
    pub max_following_error: Option<f64>,
    /// Its drive in the simulated machine.
    pub simulated: SimulatedAxis,
    /// Its drive, if it has one.
    pub drive: Option<AxisDrive>,
}

impl Axis {
    /// The unit that people read: "deg" or "mm".
    pub const fn unit(&self) -> &'static str {
        self.kind.unit()
    }

    /// A value in SI (or a derivative of one) in the unit people read.
    pub fn from_si(&self, value: f64) -> f64 {
        value / self.kind.scale()
    }

    /// A value in the unit people write (or a derivative) in SI.
    pub fn to_si(&self, value: f64) -> f64 {
        value * self.kind.scale()
    }

    /// The largest deceleration, if it is not the largest acceleration.
    pub fn own_deceleration(&self) -> Option<f64> {
        let own = self.max_deceleration.to_bits() != self.max_acceleration.to_bits();
        own.then_some(self.max_deceleration)
    }

    /// The smaller of the two, which holds whether the speed grows or falls.
    pub fn smallest_acceleration(&self) -> f64 {
        self.max_acceleration.min(self.max_deceleration)
    }

    /// True if the deceleration limits an `acceleration` at this `velocity`: the speed falls.
    ///
    /// If the axis starts or stops within a `cycle` (s), the larger limit counts.
    pub fn slows(&self, velocity: f64, acceleration: f64, cycle: f64) -> bool {
        if self.own_deceleration().is_none() {
            false
        } else if velocity.abs() <= acceleration.abs() * cycle {
            self.max_deceleration > self.max_acceleration
        } else {
            velocity * acceleration < 0.0
        }
    }

    /// The limit of an acceleration that does this, m/s² or rad/s².
    pub fn acceleration_limit(&self, slows: bool) -> f64 {
        if slows { self.max_deceleration } else { self.max_acceleration }
    }

    /// The largest change of its velocity at once, m/s or rad/s: unless the file says it, what its acceleration makes in
    /// one `cycle`, s.
    pub fn velocity_step(&self, cycle: f64) -> f64 {
        self.max_velocity_step.unwrap_or(self.smallest_acceleration() * cycle)
    }

    /// The largest force or torque of its motor, N or Nm, if that is limited.
    pub fn effort_limit(&self) -> Option<f64> {
        Some(self.simulated.effort_limit).filter(|limit| limit.is_finite())
    }

    /// Velocity limit without headroom.
    pub fn velocity_limit(&self) -> VelocityLimit {
        self.velocity_limits.smallest()
    }

    /// Its limits in a plan.
    ///
    /// A plan run k times as fast has k times its velocities, k² its accelerations and k³ its jerks. With a
    /// headroom h it therefore stays within the limits up to the override 1 / (1 − h).
    pub fn limit(&self) -> AxisLimit {
        let left = 1.0 - self.headroom;
        let VelocityLimit { value, source } = self.velocity_limit();
        AxisLimit {
            velocity: VelocityLimit { value: value * left, source },
            acceleration: self.max_acceleration * left.powi(2),
            deceleration: self.max_deceleration * left.powi(2),
            jerk: self.max_jerk.map(|jerk| jerk * left.powi(3)),
            headroom: self.headroom,
        }
    }

    /// Exact position counting of its drive.
    pub fn counting(&self) -> Option<Counting> {
        self.drive.as_ref().map(|drive| drive.counting)
    }

    /// Increments per m or rad, rounded; 0 without a drive. For speeds and estimates: [`Self::counting`] is exact.
    #[expect(clippy::cast_precision_loss, reason = "read from a file where it is at most 10^12")]
    pub fn increments_per_si(&self) -> f64 {
        self.drive
            .as_ref()
            .map_or(0.0, |drive| drive.ratio.increments as f64 / self.to_si(drive.ratio.per_units))
    }
}

/// Entry of `[[axes]]`: the axis and further keys.
#[derive(Clone, Debug)]
pub(super) struct AxisEntry {
    pub(super) axis: Axis,
    /// Output of the transform or coordinate that it moves. Its name, unless `role` says otherwise.
    pub(super) role: String,
    /// Place of the role in the file.
    pub(super) role_span: Range<usize>,
    /// True if it names a drive, right or wrong.
    pub(super) driven: bool,
    /// The joint of a URDF that it moves.
    pub(super) joint: JointEntry,
}

/// `joint`, `joint_sense` and `joint_offset` of an axis.
#[derive(Clone, Debug)]
pub(super) struct JointEntry {
    /// Its name, if the file says it; else that of the axis.
    pub(super) name: Option<String>,
    /// The joint moves backwards when the axis moves forwards.
    pub(super) reversed: bool,
    /// Position of the joint with the axis at 0, m or rad.
    pub(super) offset: f64,
    /// Place of these keys in the file; the place of the axis if there are none.
    pub(super) span: Range<usize>,
    /// True if the file has any of these keys.
    pub(super) given: bool,
}

impl JointEntry {
    fn read(section: &Section<'_>, kind: AxisKind) -> Self {
        let offset_key = format!("joint_offset_{}", kind.unit());
        let name = section.text("joint").map(str::to_owned);
        let sense = section.choice("joint_sense", &[("same", false), ("opposite", true)]);
        let offset = section.number(&offset_key, -MOST..=MOST);
        let keys = ["joint", "joint_sense", &offset_key];
        let said = keys.into_iter().find(|key| section.has(key));
        Self {
            name,
            reversed: sense.unwrap_or(false),
            offset: offset.unwrap_or(0.0) * kind.scale(),
            span: section.span_of(said.unwrap_or("name")),
            given: said.is_some(),
        }
    }
}

/// Speed with which the motor of a `drive` starts at once, units/s, if the file says it.
fn starts_at(drive: &AxisDrive, devices: &[Seen]) -> Option<f64> {
    let seen = devices.get(drive.device).filter(|seen| seen.starts)?;
    Some(seen.abilities.as_ref()?.start_stop? / drive.ratio.per_unit().abs())
}

/// Reads one `[[axes]]` table. `devices` are the `[[drives]]`.
pub(super) fn read(section: &Section<'_>, devices: &[Seen]) -> Option<AxisEntry> {
    let name = section.required_text("name");
    let role = section.text("role").or(name);
    let kind = section
        .required_choice("kind", &[("rotary", AxisKind::Rotary), ("linear", AxisKind::Linear)]);
    let Some(kind) = kind else {
        // The other keys carry the unit, which is not known: one complaint is enough.
        section.accept_all();
        return None;
    };
    section.is_of_kind(kind.name());
    let unit = kind.unit();
    let period = section.number(&format!("period_{unit}"), 1e-3..=MOST);
    let limits = ["position_min", "position_max"].map(|name| format!("{name}_{unit}"));
    // A modulo axis may go round and round; one limit alone would be an oversight.
    let limited =
        !section.has(&format!("period_{unit}")) || limits.iter().any(|key| section.has(key));
    let [position_min, position_max] = limits.map(|key| {
        if limited {
            section.required_number(&key, -MOST..=MOST)
        } else {
            section.number(&key, -MOST..=MOST)
        }
    });
    let max_velocity = section.required_number(&format!("max_velocity_{unit}_per_s"), 1e-3..=1e6);
    let max_acceleration =
        section.required_number(&format!("max_acceleration_{unit}_per_s2"), 1e-3..=1e8);
    let max_deceleration = section.number(&format!("max_deceleration_{unit}_per_s2"), 1e-3..=1e8);
    let max_jerk = section.number(&format!("max_jerk_{unit}_per_s3"), 1e-3..=1e12);
    let max_step = section.number(&format!("max_velocity_step_{unit}_per_s"), 1e-6..=1e6);
    let drive_limits = DriveLimits::read(section, unit);
    let headroom = read_headroom(section);
    let max_following_error = section.number(&format!("max_following_error_{unit}"), 1e-6..=1e4);
    let simulated = simulated::read(
        &section.section("physics"),
        kind,
        max_velocity.map(|velocity| velocity * kind.scale()),
        drive_limits.motor_turns.map(|turns| turns / kind.scale()),
    );
    let drive = axis_drive::read(section, kind, devices);
    let abilities = |drive: &AxisDrive| devices.get(drive.device)?.abilities.as_ref();
    let joint = JointEntry::read(section, kind);
    let (min, max) = if limited {
        (position_min?, position_max?)
    } else {
        // As far as the drive counts.
        let counted = drive.as_ref().map_or(MOST, |drive| {
            abilities(drive).map_or(MOST, |able| able.counts / drive.ratio.per_unit().abs())
        });
        let most = MOST.min(counted);
        (-most, most)
    };
    if min >= max {
        let key = format!("position_max_{unit}");
        section.complain_at(
            &key,
            format!("`{key}` is {max}; it must be above `position_min_{unit}`, {min}"),
        );
        return None;
    }
    let starts_at = drive.as_ref().and_then(|drive| starts_at(drive, devices));
    let increments = drive.as_ref().map(|drive| {
        let most = abilities(drive).map_or(f64::INFINITY, |able| *able.speeds.end());
        (drive.ratio.per_unit(), most)
    });
    let velocities = drive_limits.with(max_velocity?, increments);
    if let Some(drive) = &drive {
        // Without a drive's own limit.
        let velocity = VelocityLimits { step_frequency: None, ..velocities }.smallest().value;
        if let Some(able) = abilities(drive) {
            let frequency = drive_limits.step_frequency_hz;
            axis_drive::check(section, unit, &drive.ratio, able, [min, max], (velocity, frequency));
        }
    }
    if let (Some(drive), SimulatedMotor::Stepper(stepper)) = (&drive, &simulated.motor) {
        let microsteps = f64::from(stepper.microsteps) / stepper.full_step * kind.scale();
        axis_drive::check_steps(section, unit, drive.ratio.per_unit(), microsteps);
    }
    let scale = kind.scale();
    let velocity_limits = velocities.scaled(scale);
    Some(AxisEntry {
        axis: Axis {
            name: name?.to_owned(),
            kind,
            position_limits: [min * scale, max * scale],
            period: period.map(|period| period * scale),
            limited,
            max_velocity: velocity_limits.smallest().value,
            velocity_limits,
            max_acceleration: max_acceleration? * scale,
            max_deceleration: max_deceleration.or(max_acceleration)? * scale,
            max_jerk: max_jerk.map(|jerk| jerk * scale),
            max_velocity_step: max_step.or(starts_at).map(|step| step * scale),
            headroom,
            max_following_error: max_following_error.map(|error| error * scale),
            simulated,
            drive,
        },
        role: role?.to_owned(),
        role_span: section.span_of(if section.has("role") { "role" } else { "name" }),
        driven: section.has("drive"),
        joint,
    })
}
