//! `[axes.physics.servo]`, `[axes.physics.stepper]` and related keys: a motor, with values at its shaft.

use super::shaft::{Shaft, needs_shaft};
use super::{FeedForward, SimulatedMotor, SimulatedServo};
use crate::axis_kind::AxisKind;
use crate::section::Section;
use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use twin_physics::{
    BrakeParameters, EffortCurve, EncoderParameters, EncoderSide, FrictionParameters,
    OverloadParameters, ServoParameters, StepperParameters,
};

/// Torques, Nm.
const TORQUE: RangeInclusive<f64> = 1e-6..=1e7;

/// Default damping ratio of a step motor's swing.
const STEPPER_DAMPING_RATIO: f64 = 0.1;

/// Default thermal time constant of a motor, s.
const THERMAL_TIME_S: f64 = 30.0;

/// Reader of motor values that are given at the shaft.
pub(super) struct Motors<'s, 'a> {
    pub(super) section: &'s Section<'a>,
    pub(super) kind: AxisKind,
    pub(super) shaft: Option<Shaft>,
    /// Largest velocity of the axis, m/s or rad/s.
    pub(super) max_velocity: Option<f64>,
}

/// Motor values of a file, at the axis except for the inertia.
pub(super) struct Said {
    pub(super) motor: SimulatedMotor,
    /// kg·m², at the shaft.
    pub(super) inertia: Option<f64>,
    pub(super) effort_limit: f64,
    pub(super) friction: FrictionParameters,
    pub(super) overload: Option<OverloadParameters>,
}

impl<'a> Motors<'_, 'a> {
    pub(super) fn read(&self) -> Said {
        let servo = self.section.section("servo");
        let stepper = self.section.section("stepper");
        if self.section.has("servo") && self.section.has("stepper") {
            self.section.complain_at("stepper", "an axis has a servo or a step motor");
        }
        if self.section.has("stepper") {
            servo.accept_all();
            if let Some(said) = self.stepper(&stepper) {
                return said;
            }
        }
        self.servo(&servo)
    }

    /// The shaft, if something said at it needs one.
    fn shaft(&self, section: &Section<'a>, keys: &[&str]) -> Option<Shaft> {
        let needs = keys.iter().find(|key| section.has(key));
        if let Some(key) = needs
            && self.shaft.is_none()
        {
            needs_shaft(section, key, self.kind);
        }
        self.shaft
    }

    fn friction(section: &Section<'a>, shaft: Option<Shaft>) -> FrictionParameters {
        let coulomb = section.number("friction_nm", 0.0..=1e4).unwrap_or(0.0);
        let viscous = section.number("viscous_friction_nm_s_per_rad", 0.0..=1e4).unwrap_or(0.0);
        let ratio = shaft.map_or(0.0, |shaft| shaft.ratio);
        FrictionParameters::new(coulomb * ratio, viscous * ratio * ratio)
    }

    fn overload(section: &Section<'a>, shaft: Option<Shaft>) -> Option<OverloadParameters> {
        let continuous = section.number("continuous_torque_nm", TORQUE);
        let time = section.number("thermal_time_constant_s", 0.1..=1e5);
        Some(OverloadParameters {
            continuous_effort: shaft?.effort(continuous?),
            time_constant: time.unwrap_or(THERMAL_TIME_S),
        })
    }

    /// Torques by speeds, at the axis.
    fn curve(section: &Section<'a>, key: &str, shaft: Option<Shaft>) -> Option<EffortCurve> {
        let points = section.pairs(key, &(0.0..=1e7))?;
        let shaft = shaft?;
        let curve = shaft.curve(&points);
        if curve.is_none() {
            section
                .complain_at(key, format!("the speeds of `{key}` do not rise from pair to pair"));
        }
        curve
    }

    fn servo(&self, section: &Section<'a>) -> Said {
        let shaft = self.shaft(
            section,
            &[
                "rotor_inertia_kg_m2",
                "peak_torque_nm",
                "continuous_torque_nm",
                "torque_rpm_nm",
                "friction_nm",
                "viscous_friction_nm_s_per_rad",
            ],
        );
        let peak = section.number("peak_torque_nm", TORQUE);
        let peak = peak.zip(shaft).map_or(f64::INFINITY, |(torque, shaft)| shaft.effort(torque));
        let curve = Self::curve(section, "torque_rpm_nm", shaft).unwrap_or_default();
        let position_passes = Self::passes(section, "position_loop_period_us");
        let velocity_passes = Self::passes(section, "velocity_loop_period_us");
        let velocity_passes = velocity_passes.or(position_passes);
        let velocity_passes = velocity_passes.unwrap_or(ServoParameters::DEFAULT_PASSES);
        let position_passes = position_passes.unwrap_or(velocity_passes);
        if !velocity_passes.is_multiple_of(position_passes) {
            section.complain_at(
                "position_loop_period_us",
                "`position_loop_period_us` is not a multiple of `velocity_loop_period_us`",
            );
        }
        let parameters = ServoParameters {
            effort_limit: peak,
            effort_curve: curve.clone(),
            current_bandwidth: section
                .number("current_loop_bandwidth_hz", 10.0..=1e5)
                .map_or(f64::INFINITY, |hz| hz * TAU),
            position_passes,
            velocity_passes: if velocity_passes.is_multiple_of(position_passes) {
                velocity_passes
            } else {
                position_passes
            },
            delay: section
                .integer("delay_periods", 0..=8)
                .map_or(0, |delay| u8::try_from(delay).unwrap_or(0)),
            encoder: self.encoder(),
            ..ServoParameters::SLACK
        };
        let forward = [
            ("none", FeedForward::None),
            ("inertia", FeedForward::Inertia),
            ("dynamics", FeedForward::Dynamics),
        ];
        let servo = SimulatedServo {
            position_gain: section.number("position_gain_per_s", 0.0..=1e4),
            integral_time: section.number("integral_time_ms", 0.01..=1e6).map(|ms| ms * 1e-3),
            velocity_feed_forward: section
                .number("velocity_feed_forward_percent", 0.0..=100.0)
                .map_or(1.0, |percent| percent * 0.01),
            effort_feed_forward: section
                .choice("torque_feed_forward", &forward)
                .unwrap_or(FeedForward::Inertia),
            parameters,
        };
        let said = Said {
            motor: SimulatedMotor::Servo(servo),
            inertia: section.number("rotor_inertia_kg_m2", 0.0..=1e3),
            effort_limit: peak.min(self.least(&curve)),
            friction: Self::friction(section, shaft),
            overload: Self::overload(section, shaft),
        };
        section.check_unknown();
        said
    }

    /// Smallest effort up to the axis's largest velocity.
    fn least(&self, curve: &EffortCurve) -> f64 {
        curve.least(self.max_velocity.unwrap_or(0.0))
    }

    fn stepper(&self, section: &Section<'a>) -> Option<Said> {
        let shaft = self.shaft(section, &["holding_torque_nm", "pull_out_rpm_nm"]);
        let full_steps = section.integer("full_steps_per_turn", 4..=10_000).unwrap_or(200);
        let microsteps = section.integer("microsteps", 1..=1024).unwrap_or(16);
        let holding = section.number("holding_torque_nm", TORQUE);
        let curve = Self::curve(section, "pull_out_rpm_nm", shaft);
        let detent = section.number("detent_torque_nm", 0.0..=1e4).unwrap_or(0.0);
        let damping_ratio = section.number("damping_ratio", 0.0..=5.0);
        let inertia = section.number("rotor_inertia_kg_m2", 0.0..=1e3);
        let friction = Self::friction(section, shaft);
        let overload = Self::overload(section, shaft);
        self.encoder();
        section.check_unknown();
        if !section.has("holding_torque_nm") && !section.has("pull_out_rpm_nm") {
            section.complain("[stepper] needs `holding_torque_nm`, or `pull_out_rpm_nm` from 0 on");
        }
        let shaft = shaft?;
        let constant = || EffortCurve::new(vec![[0.0, shaft.effort(holding?)]]);
        let pull_out = curve.or_else(constant)?;
        let full_steps = f64::from(i32::try_from(full_steps).ok()?);
        Some(Said {
            effort_limit: self.least(&pull_out),
            motor: SimulatedMotor::Stepper(StepperParameters {
                full_step: TAU / full_steps / shaft.ratio,
                microsteps: u16::try_from(microsteps).ok()?,
                pull_out,
                detent: shaft.effort(detent),
                damping_ratio: damping_ratio.unwrap_or(STEPPER_DAMPING_RATIO),
            }),
            inertia,
            friction,
            overload,
        })
    }

    /// Passes of a loop in a millisecond.
    fn passes(section: &Section<'a>, key: &str) -> Option<u8> {
        let period = section.number(key, 15.625..=1000.0)?;
        let passes = 1000.0 / period;
        if (passes - passes.round()).abs() > 1e-9 {
            section.complain_at(
                key,
                format!("`{key}` is {period}; a millisecond is a whole number of periods, as of 1000, 500, 250, 125, 62.5"),
            );
            return None;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 64")]
        Some(passes.round() as u8)
    }

    fn encoder(&self) -> EncoderParameters {
        let section = self.section.section("encoder");
        let sides = [("motor", EncoderSide::Motor), ("axis", EncoderSide::Axis)];
        let side = section.choice("on", &sides).unwrap_or(EncoderSide::Motor);
        let unit = self.kind.unit();
        let resolution = match side {
            EncoderSide::Motor => {
                section.is_of_kind("motor");
                let increments = section.number("increments_per_turn", 1.0..=1e12);
                let shaft = self.shaft(&section, &["increments_per_turn"]);
                increments.zip(shaft).map(|(per_turn, shaft)| TAU / per_turn / shaft.ratio)
            }
            EncoderSide::Axis => {
                section.is_of_kind("axis");
                let key = format!("resolution_{unit}");
                section.number(&key, 1e-12..=1e3).map(|one| one * self.kind.scale())
            }
        };
        section.check_unknown();
        EncoderParameters { side, resolution: resolution.unwrap_or(0.0) }
    }

    pub(super) fn brake(&self) -> Option<BrakeParameters> {
        let section = self.section.section("brake");
        let shaft = self.shaft(&section, &["torque_nm"]);
        let torque = if self.section.has("brake") {
            section.required_number("torque_nm", TORQUE)
        } else {
            None
        };
        let closing = section.number("closing_time_ms", 0.0..=1e4).unwrap_or(50.0);
        section.check_unknown();
        Some(BrakeParameters { effort: shaft?.effort(torque?), closing_time: closing * 1e-3 })
    }
}
