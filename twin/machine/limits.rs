//! Limits of axes and path for feed planning, each with its source. Plain data, SI.

use super::conditions::PreparationInputs;
use crate::section::Section;
use std::ops::RangeInclusive;
use twin_interpcnc::protocol::registers::MAX_SPEED_HZ;

/// Default of the largest distance from the programmed path at joints, m.
const BLEND_TOLERANCE: f64 = 1e-6;

/// Step frequencies that may be given, kHz: at most what the board makes.
const STEP_FREQUENCY_KHZ: RangeInclusive<f64> = 0.1..=MAX_SPEED_HZ as f64 / 1e3;

/// Largest override headroom, percent: ten times the planned velocity.
const MOST_HEADROOM_PERCENT: f64 = 90.0;

/// Source of a velocity limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VelocitySource {
    /// The axis itself: `max_velocity_…`.
    Axis,
    /// Steps its drive makes: `max_step_frequency_khz`, or the most the drive is able to.
    StepFrequency,
    /// Revolutions of its motor: `max_motor_rpm`.
    MotorSpeed,
}

impl VelocitySource {
    /// In words, for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Axis => "axis",
            Self::StepFrequency => "step frequency",
            Self::MotorSpeed => "motor speed",
        }
    }
}

/// Velocity limit of an axis, and its source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityLimit {
    /// m/s or rad/s.
    pub value: f64,
    /// Source that would have to be raised first.
    pub source: VelocitySource,
}

/// All velocities that limit an axis, m/s or rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityLimits {
    /// Of the axis itself.
    pub axis: f64,
    /// At the largest step frequency; `None` without a drive.
    pub step_frequency: Option<f64>,
    /// At the largest speed of the motor; `None` if that is not given.
    pub motor_speed: Option<f64>,
}

impl VelocityLimits {
    /// The smallest limit; of equal ones that of the axis.
    pub fn smallest(&self) -> VelocityLimit {
        // Increments and turns are ratios: equal velocities differ by rounding.
        const ROUNDING: f64 = 1e-12;
        let others = [
            (self.step_frequency, VelocitySource::StepFrequency),
            (self.motor_speed, VelocitySource::MotorSpeed),
        ];
        let axis = VelocityLimit { value: self.axis, source: VelocitySource::Axis };
        others.into_iter().fold(axis, |least, (value, source)| match value {
            Some(value) if value < least.value * (1.0 - ROUNDING) => {
                VelocityLimit { value, source }
            }
            _ => least,
        })
    }
}

/// Limits of an axis in a plan, less the override headroom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimit {
    /// Largest velocity, m/s or rad/s.
    pub velocity: VelocityLimit,
    /// Largest acceleration while the speed grows, m/s² or rad/s².
    pub acceleration: f64,
    /// Largest deceleration, m/s² or rad/s².
    pub deceleration: f64,
    /// Largest jerk, m/s³ or rad/s³; `None`: not limited.
    pub jerk: Option<f64>,
    /// Part of the velocity that is left to the override, 0 to 0.9.
    pub headroom: f64,
}

/// Limits of the path in a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathLimits {
    /// Largest distance of the path from the programmed one where it rounds joints that are passed without a stop, m.
    pub blend_tolerance: f64,
    /// Largest acceleration of the tool tip, in any direction, m/s²; `None`: not limited.
    pub tool_acceleration: Option<f64>,
    /// Largest centripetal acceleration, m/s² (`dMaxAcc` of `SMC_LimitCircularVelocities`); `None`: not limited.
    pub centripetal_acceleration: Option<f64>,
    /// Largest jump of that from one element to the next, m/s² (`dMaxAccJump`); `None`: not limited.
    pub centripetal_jump: Option<f64>,
}

/// Drive and motor limits in `[[axes]]`, in addition to the velocity of the axis itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct DriveLimits {
    /// As given, steps/s.
    pub(super) step_frequency_hz: Option<f64>,
    /// Velocity of the axis at the largest speed of the motor, deg/s or mm/s.
    motor_speed: Option<f64>,
    /// Turns of the motor per degree or mm, if that is said.
    pub(super) motor_turns: Option<f64>,
}

impl DriveLimits {
    /// Reads it; `unit` is that of the axis.
    pub(super) fn read(section: &Section<'_>, unit: &str) -> Self {
        let frequency = section.number("max_step_frequency_khz", STEP_FREQUENCY_KHZ);
        let keys = ["max_motor_rpm".to_owned(), format!("motor_turns_per_{unit}")];
        let [rpm, turns] = &keys;
        let values = [section.number(rpm, 0.1..=1e6), section.number(turns, 1e-9..=1e6)];
        for (key, other) in [(rpm, turns), (turns, rpm)] {
            if section.has(key) && !section.has(other) {
                let message = format!("`{key}` has no effect without `{other}`");
                section.complain_at(key, message);
            }
        }
        let motor_speed = match values {
            [Some(rpm), Some(turns)] => Some(rpm / 60.0 / turns),
            _ => None,
        };
        let [_, motor_turns] = values;
        Self { step_frequency_hz: frequency.map(|khz| khz * 1e3), motor_speed, motor_turns }
    }

    /// Adds the velocity limit of the axis and that of a drive (increments per unit, largest frequency), deg/s or
    /// mm/s.
    pub(super) fn with(&self, axis: f64, drive: Option<(f64, f64)>) -> VelocityLimits {
        let step_frequency = drive.map(|(increments_per_unit, most_hz)| {
            self.step_frequency_hz.unwrap_or(most_hz) / increments_per_unit.abs()
        });
        VelocityLimits { axis, step_frequency, motor_speed: self.motor_speed }
    }
}

impl VelocityLimits {
    /// Every one of them times `factor`.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        let scaled = |value: f64| value * factor;
        Self {
            axis: scaled(self.axis),
            step_frequency: self.step_frequency.map(scaled),
            motor_speed: self.motor_speed.map(scaled),
        }
    }
}

/// Reads `headroom_percent` of an axis, as a part.
pub(super) fn read_headroom(section: &Section<'_>) -> f64 {
    section.number("headroom_percent", 0.0..=MOST_HEADROOM_PERCENT).unwrap_or(0.0) / 100.0
}

/// Reads `[path]`; what limits curves is in `[preparation]`.
pub(super) fn read_path(root: &Section<'_>, preparation: &PreparationInputs) -> PathLimits {
    let section = root.section("path");
    let metres = |key, range| section.number(key, range).map(|value| value * 1e-3);
    let given = |value: f64| (value > 0.0 && value.is_finite()).then_some(value);
    let circular = preparation.circular;
    let limits = PathLimits {
        blend_tolerance: metres("blend_tolerance_mm", 0.0..=10.0).unwrap_or(BLEND_TOLERANCE),
        tool_acceleration: metres("max_tool_acceleration_mm_per_s2", 1e-3..=1e8),
        centripetal_acceleration: circular.and_then(|circular| given(circular.acceleration)),
        centripetal_jump: circular.and_then(|circular| given(circular.acceleration_jump)),
    };
    section.finish();
    limits
}
