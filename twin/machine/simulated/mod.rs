//! `[axes.physics]`: the motor, the transmission and the drive that move an axis of the simulated machine.

mod motor;
mod shaft;

use crate::axis_kind::AxisKind;
use crate::section::Section;
use motor::Motors;
use shaft::{elastic, needs_shaft, shaft};
use twin_physics::{
    AxisDriveParameters, BrakeParameters, EffortFeedForward, ElasticTransmission,
    FrictionParameters, Motor, NoiseParameters, OverloadParameters, ServoParameters,
    StepperParameters, SwitchParameters,
};

/// Motor and transmission of an axis of the simulated machine. SI, at the axis (behind the gear).
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedAxis {
    /// Largest force or torque up to the axis's largest velocity, N or Nm.
    pub effort_limit: f64,
    /// Bandwidth of the velocity loop, Hz.
    pub bandwidth_hz: f64,
    /// Friction of the axis.
    pub friction: FrictionParameters,
    /// Friction of the motor.
    pub motor_friction: FrictionParameters,
    /// Rotor and gear inertia, kg or kg·m².
    pub armature: f64,
    /// The motor.
    pub motor: SimulatedMotor,
    /// Elastic transmission between motor and axis.
    pub transmission: Option<SimulatedTransmission>,
    /// The holding brake.
    pub brake: Option<BrakeParameters>,
    /// Overload parameters of the motor.
    pub overload: Option<OverloadParameters>,
    /// Limit and home switches.
    pub switches: SwitchParameters,
    /// Noise of encoder and axis.
    pub noise: NoiseParameters,
}

/// A motor with its drive.
#[derive(Clone, Debug, PartialEq)]
pub enum SimulatedMotor {
    /// Gains follow from the bandwidth and the inertia of the axis unless they are given.
    Servo(SimulatedServo),
    /// A step motor.
    Stepper(StepperParameters),
}

/// Servo drive in a machine file.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedServo {
    /// Kv, 1/s.
    pub position_gain: Option<f64>,
    /// Tn, s.
    pub integral_time: Option<f64>,
    /// 0 to 1.
    pub velocity_feed_forward: f64,
    /// Of torques.
    pub effort_feed_forward: FeedForward,
    /// Everything else; gains and feed-forward of efforts are still to be found.
    pub parameters: ServoParameters,
}

/// Torque feed-forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedForward {
    /// Nothing.
    None,
    /// The inertia of the axis alone.
    Inertia,
    /// The inverse dynamics of the whole machine.
    Dynamics,
}

/// A transmission that gives way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedTransmission {
    /// N/m or Nm/rad.
    pub stiffness: f64,
    /// Between the inertias of motor and axis.
    pub damping_ratio: f64,
    /// m or rad.
    pub backlash: f64,
}

impl SimulatedAxis {
    /// The drive of an axis that moves `inertia` (kg or kg·m², without its motor).
    pub fn drive(&self, inertia: f64) -> AxisDriveParameters {
        let motor = match &self.motor {
            SimulatedMotor::Stepper(stepper) => Motor::Stepper(stepper.clone()),
            SimulatedMotor::Servo(servo) => {
                Motor::Servo(self.servo(servo, inertia + self.armature))
            }
        };
        AxisDriveParameters {
            motor,
            armature: self.armature,
            friction: self.friction,
            motor_friction: self.motor_friction,
            transmission: self.transmission.map(|elastic| {
                let SimulatedTransmission { stiffness, damping_ratio, backlash } = elastic;
                let motor = self.armature;
                ElasticTransmission::damped(stiffness, damping_ratio, backlash, motor, inertia)
            }),
            brake: self.brake,
            overload: self.overload,
            switches: self.switches,
            noise: self.noise,
        }
    }

    /// Keeps its efforts within `limit`, N or Nm.
    pub(super) fn limit_effort(&mut self, limit: f64) {
        self.effort_limit = self.effort_limit.min(limit);
        if let SimulatedMotor::Servo(servo) = &mut self.motor {
            servo.parameters.effort_limit = servo.parameters.effort_limit.min(limit);
        }
    }

    /// True if it has a step motor.
    pub fn steps(&self) -> bool {
        matches!(self.motor, SimulatedMotor::Stepper(_))
    }

    /// Dry friction of axis and motor while it moves, N or Nm.
    pub fn dry_friction(&self) -> f64 {
        self.friction.coulomb + self.motor_friction.coulomb
    }

    /// Friction of both that grows with velocity, N·s/m or Nm·s/rad.
    pub fn viscous_friction(&self) -> f64 {
        self.friction.viscous + self.motor_friction.viscous
    }

    /// The servo drive of an axis that moves `inertia`, its motor included.
    fn servo(&self, servo: &SimulatedServo, inertia: f64) -> ServoParameters {
        let tuned = ServoParameters::tuned(inertia, self.bandwidth_hz, self.effort_limit);
        ServoParameters {
            position_gain: servo.position_gain.unwrap_or(tuned.position_gain),
            velocity_gain: tuned.velocity_gain,
            integral_time: servo.integral_time.unwrap_or(tuned.integral_time),
            velocity_feed_forward: servo.velocity_feed_forward,
            effort_feed_forward: match servo.effort_feed_forward {
                FeedForward::None => EffortFeedForward::None,
                FeedForward::Inertia => EffortFeedForward::Inertia(inertia),
                FeedForward::Dynamics => EffortFeedForward::Dynamics(1.0),
            },
            ..servo.parameters.clone()
        }
    }
}

/// Reads the section of an axis with `max_velocity` (m/s or rad/s) and `motor_turns` per m or rad, if known.
pub(super) fn read(
    section: &Section<'_>,
    kind: AxisKind,
    max_velocity: Option<f64>,
    motor_turns: Option<f64>,
) -> SimulatedAxis {
    let unit = kind.unit();
    let (effort, per_speed, inertia) = match kind {
        AxisKind::Rotary => ("nm", "nm_s_per_rad", "kg_m2"),
        AxisKind::Linear => ("n", "n_s_per_m", "kg"),
    };
    let most_key = format!("max_{}_{effort}", kind.effort_name());
    let most = section.number(&most_key, 1e-3..=1e7);
    let bandwidth_hz = section
        .number("velocity_loop_bandwidth_hz", 1.0..=250.0)
        .unwrap_or(ServoParameters::DEFAULT_BANDWIDTH_HZ);
    let coulomb = section.number(&format!("coulomb_friction_{effort}"), 0.0..=1e6).unwrap_or(0.0);
    let viscous =
        section.number(&format!("viscous_friction_{per_speed}"), 0.0..=1e6).unwrap_or(0.0);
    let breakaway_key = format!("breakaway_friction_{effort}");
    let breakaway = section.number(&breakaway_key, 0.0..=1e6).unwrap_or(coulomb);
    if breakaway < coulomb {
        section.complain_at(
            &breakaway_key,
            format!(
                "`{breakaway_key}` is {breakaway}; it is at least the Coulomb friction, {coulomb}"
            ),
        );
    }
    // 1 mm/s, or 0.1 degrees/s.
    let stribeck = section
        .number(&format!("stribeck_velocity_{unit}_per_s"), 1e-6..=1e6)
        .unwrap_or(if kind == AxisKind::Linear { 1.0 } else { 0.1 });
    let armature = section.number(&format!("rotor_inertia_{inertia}"), 0.0..=1e6).unwrap_or(0.0);
    let transmission = section.section("transmission");
    let shaft = shaft(&transmission, kind, motor_turns);
    let gear = transmission.number("inertia_kg_m2", 0.0..=1e3);
    if gear.is_some() && shaft.is_none() {
        needs_shaft(&transmission, "inertia_kg_m2", kind);
    }
    let elastic = elastic(&transmission, kind);
    transmission.check_unknown();

    let motors = Motors { section, kind, shaft, max_velocity };
    let motor = motors.read();
    let at_shaft = gear.unwrap_or(0.0) + motor.inertia.unwrap_or(0.0);
    let armature = armature + shaft.map_or(0.0, |shaft| shaft.inertia(at_shaft));
    let mut simulated = SimulatedAxis {
        effort_limit: motor.effort_limit,
        bandwidth_hz,
        friction: FrictionParameters {
            coulomb,
            breakaway,
            stribeck_velocity: stribeck * kind.scale(),
            viscous,
        },
        motor_friction: motor.friction,
        armature,
        motor: motor.motor,
        transmission: elastic,
        brake: motors.brake(),
        overload: motor.overload,
        switches: switches(section, kind),
        noise: noise(section, kind, effort),
    };
    if let Some(most) = most {
        if simulated.steps() {
            section.complain_at(
                &most_key,
                format!(
                    "`{most_key}` does not apply to a step motor: its torque follows from `holding_torque_nm` or `pull_out_rpm_nm` in [stepper]"
                ),
            );
        }
        simulated.limit_effort(most);
    }
    if simulated.transmission.is_some() && armature <= 0.0 {
        section.complain(
            "a transmission that gives way needs the inertia of its motor: `rotor_inertia_kg_m2` in [servo] or [stepper]",
        );
    }
    section.check_unknown();
    simulated
}

fn noise(section: &Section<'_>, kind: AxisKind, effort: &str) -> NoiseParameters {
    let section = section.section("noise");
    let position = section.number(&format!("encoder_{}", kind.unit()), 0.0..=1e3);
    let effort = section.number(&format!("{}_{effort}", kind.effort_name()), 0.0..=1e6);
    section.check_unknown();
    NoiseParameters {
        position: position.unwrap_or(0.0) * kind.scale(),
        effort: effort.unwrap_or(0.0),
    }
}

fn switches(section: &Section<'_>, kind: AxisKind) -> SwitchParameters {
    let section = section.section("switches");
    let unit = kind.unit();
    let number = |key: &str| section.number(&format!("{key}_{unit}"), -1e6..=1e6);
    let [lower, upper] = ["lower", "upper"].map(|key| number(key).map(|at| at * kind.scale()));
    if let (Some(lower), Some(upper)) = (lower, upper)
        && lower >= upper
    {
        let message = format!(
            "the lower switch is above the upper one: `lower_{unit}` is on at and below, `upper_{unit}` at and above"
        );
        section.complain_at(&format!("lower_{unit}"), message);
    }
    let home_key = format!("home_{unit}");
    let home = section.numbers::<2>(&home_key, -1e6..=1e6);
    if let Some([from, to]) = home
        && from > to
    {
        section.complain_at(&home_key, format!("`{home_key}` goes from {from} down to {to}"));
    }
    section.check_unknown();
    SwitchParameters { lower, upper, home: home.map(|ends| ends.map(|end| end * kind.scale())) }
}
