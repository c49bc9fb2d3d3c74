//! Step motor: a magnetic spring between the stepping field and the rotor.
//!
//! ```text
//! δ = (field − rotor) / full step
//! effort = T(ω)·(sin(π/2·δ) + d·(ω_field − ω)·cos(π/2·δ)), within ± T(ω), − detent·sin(2π·rotor/full step)
//! ```
//!
//! T is the pull-out torque at the speed of the rotor, reached one full step behind the field. Two full steps
//! behind, the effort changes sign, and the rotor falls four full steps back: these are lost. Damping (d) models
//! chopper drives and back-EMF; it costs no torque in step. Acarnley, *Stepping Motors: a guide to theory and
//! practice*, 2002, chapters 2 to 4.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::curve::EffortCurve;
use crate::state::Stage;

/// Full steps in which the field is back where it was.
const PERIOD: f64 = 4.0;

/// Parameters of a step motor and its power stage, everything at the axis (behind the gear).
#[derive(Clone, Debug, PartialEq)]
pub struct StepperParameters {
    /// One full step, m or rad; most motors have 200 in a turn.
    pub full_step: f64,
    /// Microsteps per full step, 1 to 1024.
    pub microsteps: u16,
    /// Pull-out torque by speed, the holding torque at 0; N or Nm.
    pub pull_out: EffortCurve,
    /// Detent torque of the rotor without current, N or Nm; hybrid motors have 2 to 10 % of the holding torque.
    pub detent: f64,
    /// Damping ratio of the swing about the field; 0.05 to 0.3.
    pub damping_ratio: f64,
}

impl StepperParameters {
    /// The stiffness of the magnetic spring at `speed` (m/s or rad/s), N/m or Nm/rad.
    pub(crate) fn stiffness(&self, speed: f64) -> f64 {
        self.pull_out.at(speed) * FRAC_PI_2 / self.full_step
    }

    /// The fields with their names and ranges.
    pub(super) fn ranges(&self) -> [(&'static str, f64, f64, f64); 5] {
        [
            ("full_step", self.full_step, f64::MIN_POSITIVE, f64::MAX),
            ("microsteps", f64::from(self.microsteps), 1.0, 1024.0),
            ("holding torque", self.pull_out.at(0.0), f64::MIN_POSITIVE, f64::MAX),
            ("detent", self.detent, 0.0, f64::MAX),
            ("damping_ratio", self.damping_ratio, 0.0, 10.0),
        ]
    }
}

/// Correction factor of a sine that advances by 2·`angle` in a step: the Runge–Kutta weights (1, 4, 1) then give
/// its mean exactly.
///
/// Out of step the field may pass the rotor more than once in a step; samples could make it seem to rest.
fn whole(angle: f64) -> f64 {
    if angle.abs() < 1e-3 {
        return 1.0;
    }
    let (sin, cos) = angle.sin_cos();
    3.0 * sin / (angle * (2.0 + cos))
}

/// Set-point of the field of a motor at one instant.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FieldSetpoint {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
}

/// A step motor at work.
#[derive(Clone, Debug)]
pub(crate) struct StepperDrive {
    pub(crate) parameters: StepperParameters,
    /// d, s/m or s/rad.
    damping: f64,
    /// The field at start, middle and end of the step.
    field: [FieldSetpoint; 3],
    /// Length of the step, s.
    step: f64,
    /// Set-point at which the motor was homed; microsteps count from there.
    zero: f64,
    /// From the set-point to the field, m or rad: what held the load where it was homed, less steps that never came.
    offset: f64,
    /// Full steps of pulses that will not reach the motor.
    missing: f64,
    /// Full steps that have not, upwards, and have not been reported.
    missed: f64,
    /// Last position of the pulse train, m or rad.
    commanded: f64,
    /// Turns of the field, four full steps each, that the rotor has fallen behind.
    behind: i64,
}

impl StepperDrive {
    /// Enabled and homed at `position`, moving `inertia` (kg or kg·m²); the field gives `holding` as far as it can.
    pub(super) fn enabled(
        parameters: StepperParameters,
        inertia: f64,
        position: f64,
        holding: f64,
    ) -> Self {
        let critical = 2.0 * (parameters.stiffness(0.0) * inertia).sqrt();
        let damping = parameters.damping_ratio * critical / parameters.pull_out.at(0.0);
        let mut motor = Self {
            damping,
            field: [FieldSetpoint { position, velocity: 0.0 }; 3],
            step: 0.0,
            zero: position,
            offset: 0.0,
            missing: 0.0,
            missed: 0.0,
            commanded: position,
            behind: 0,
            parameters,
        };
        let part = (holding + motor.detent(position)) / motor.parameters.pull_out.at(0.0);
        motor.offset = motor.parameters.full_step * part.clamp(-1.0, 1.0).asin() / FRAC_PI_2;
        motor
    }

    /// Sets the course of the field for the next step, of `dt` s.
    pub(crate) fn begin_step(&mut self, setpoints: [FieldSetpoint; 3], dt: f64) {
        self.step = dt;
        let microstep = self.parameters.full_step / f64::from(self.parameters.microsteps);
        self.field = setpoints.map(|setpoint| {
            let steps = ((setpoint.position - self.zero) / microstep).round();
            let commanded = self.zero + steps * microstep;
            let pulses = (commanded - std::mem::replace(&mut self.commanded, commanded))
                / self.parameters.full_step;
            let missed = pulses.clamp(-self.missing, self.missing);
            self.missing -= missed.abs();
            self.missed += missed;
            self.offset -= missed * self.parameters.full_step;
            FieldSetpoint { position: commanded + self.offset, ..setpoint }
        });
    }

    /// Load angle: lead of the field over the rotor, in full steps.
    pub(crate) fn load_angle(&self, rotor: f64) -> f64 {
        let [.., end] = self.field;
        (end.position - rotor) / self.parameters.full_step
    }

    /// The full steps lost since it was asked last: more than 0 where the rotor fell behind a field that moves upwards.
    pub(crate) fn lost(&mut self, rotor: f64) -> i64 {
        let turns = (self.load_angle(rotor) / PERIOD).round();
        // The count of a rotor that runs away is bounded.
        #[expect(clippy::cast_possible_truncation, reason = "within what is just said")]
        let behind = turns.clamp(-1e15, 1e15) as i64;
        let before = std::mem::replace(&mut self.behind, behind);
        // Reported when they are whole, within rounding.
        let missed = (self.missed * (1.0 + 1e-9)).trunc();
        self.missed -= missed;
        #[expect(clippy::cast_possible_truncation, reason = "no more than have been taken out")]
        let missed = missed as i64;
        (behind - before) * 4 + missed
    }

    /// Drops the next `full_steps` full steps of the pulse train, in either direction.
    pub(crate) fn drop_steps(&mut self, full_steps: f64) {
        self.missing += full_steps;
    }

    /// Effort on the rotor at `position` and `velocity`.
    pub(super) fn effort(&self, stage: Stage, position: f64, velocity: f64) -> f64 {
        let [start, middle, end] = &self.field;
        let between = |one: &FieldSetpoint, other: &FieldSetpoint, part: f64| FieldSetpoint {
            position: one.position + (other.position - one.position) * part,
            velocity: one.velocity + (other.velocity - one.velocity) * part,
        };
        let field = match stage {
            Stage::Start => *start,
            Stage::Middle => *middle,
            Stage::End => *end,
            Stage::At(part) if part < 0.5 => between(start, middle, 2.0 * part),
            Stage::At(part) => between(middle, end, 2.0 * part - 1.0),
        };
        let full_step = self.parameters.full_step;
        let (sin, cos) = (FRAC_PI_2 * (field.position - position) / full_step).sin_cos();
        let slip = field.velocity - velocity;
        let part = (sin + self.damping * slip * cos).clamp(-1.0, 1.0);
        let passed = 0.5 * FRAC_PI_2 * slip * self.step / full_step;
        self.parameters.pull_out.at(velocity) * part * whole(passed) - self.detent(position)
    }

    /// Effort on the rotor without current.
    pub(super) fn detent(&self, position: f64) -> f64 {
        if self.parameters.detent <= 0.0 {
            return 0.0;
        }
        self.parameters.detent * (TAU * position / self.parameters.full_step).sin()
    }
}
