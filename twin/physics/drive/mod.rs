//! Drive of one axis: motor, brake, overload model, switches, and transmission to the axis.

mod curve;
mod encoder;
mod overload;
mod servo;
mod stepper;
mod switches;

pub use curve::EffortCurve;
pub use encoder::{EncoderParameters, EncoderSide};
pub use overload::OverloadParameters;
pub use servo::{EffortFeedForward, ServoParameters};
pub use stepper::StepperParameters;
pub use switches::{SwitchParameters, SwitchStates};

pub(super) use servo::{DriveInput, ServoDrive};
pub(super) use stepper::{FieldSetpoint, StepperDrive};

use crate::friction::FrictionParameters;
use crate::joint::{JointVector, joint_vector};
use crate::noise::{Noise, NoiseParameters};
use crate::state::{JointState, Motors, Stage};
use crate::transmission::ElasticTransmission;
use overload::Overload;

/// Parameters of a drive. Efforts in N or Nm, lengths in m or rad, everything at the axis (behind the gear).
#[derive(Clone, Debug, PartialEq)]
pub struct AxisDriveParameters {
    /// The motor of the axis.
    pub motor: Motor,
    /// Rotor (and gear) inertia as felt at the axis, gear ratio squared times rotor inertia, kg or kg·m².
    pub armature: f64,
    /// Friction of the axis: slides, bearings.
    pub friction: FrictionParameters,
    /// Friction of the motor and of what turns with it.
    pub motor_friction: FrictionParameters,
    /// Elastic transmission between motor and axis; `None` if it is rigid.
    pub transmission: Option<ElasticTransmission>,
    /// A brake on the motor, closed without power.
    pub brake: Option<BrakeParameters>,
    /// Overload parameters of the motor.
    pub overload: Option<OverloadParameters>,
    /// Switches along the axis.
    pub switches: SwitchParameters,
    /// Noise of encoder and axis.
    pub noise: NoiseParameters,
}

/// Motor of an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Motor {
    /// A servo drive.
    Servo(ServoParameters),
    /// A step motor.
    Stepper(StepperParameters),
}

/// A holding brake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrakeParameters {
    /// Holding effort, N or Nm at the axis.
    pub effort: f64,
    /// From the loss of power until it holds, s; 20 to 100 ms.
    pub closing_time: f64,
}

impl AxisDriveParameters {
    /// A drive without effort, on an axis without friction.
    pub const SLACK: Self = Self {
        motor: Motor::Servo(ServoParameters::SLACK),
        armature: 0.0,
        friction: FrictionParameters::NONE,
        motor_friction: FrictionParameters::NONE,
        transmission: None,
        brake: None,
        overload: None,
        switches: SwitchParameters { lower: None, upper: None, home: None },
        noise: NoiseParameters { position: 0.0, effort: 0.0 },
    };

    /// A rigid servo axis without friction.
    pub fn servo(parameters: ServoParameters) -> Self {
        Self { motor: Motor::Servo(parameters), ..Self::SLACK }
    }

    /// The first field out of range, by name.
    pub(super) fn out_of_range(&self) -> Option<(&'static str, f64)> {
        type Range = (&'static str, f64, f64, f64);
        fn outside<const N: usize>(ranges: [Range; N]) -> Option<(&'static str, f64)> {
            let mut ranges = ranges.into_iter();
            let outside = ranges.find(|(_, value, low, high)| !(low..=high).contains(&value));
            outside.map(|(name, value, ..)| (name, value))
        }
        // Of a rotor without inertia behind a spring nobody could say how it moves.
        let least = if self.transmission.is_some() { f64::MIN_POSITIVE } else { 0.0 };
        let motor = match &self.motor {
            Motor::Servo(servo) => outside(servo.ranges()),
            Motor::Stepper(stepper) => outside(stepper.ranges()),
        };
        let brake = |brake: BrakeParameters| {
            outside([
                ("brake effort", brake.effort, 0.0, f64::MAX),
                ("brake closing time", brake.closing_time, 0.0, f64::MAX),
            ])
        };
        motor
            .or_else(|| outside([("armature", self.armature, least, f64::MAX)]))
            .or_else(|| outside(self.friction.ranges()))
            .or_else(|| outside(self.motor_friction.ranges()))
            .or_else(|| self.transmission.and_then(|elastic| outside(elastic.ranges())))
            .or_else(|| self.brake.and_then(brake))
            .or_else(|| outside(self.noise.ranges()))
            .or_else(|| self.overload.and_then(|overload| outside(overload.ranges())))
    }
}

/// A drive at work.
#[derive(Clone, Debug)]
pub(super) struct AxisDrive {
    pub(super) motor: MotorAtWork,
    pub(super) brake: Option<BrakeParameters>,
    pub(super) overload: Option<Overload>,
    pub(super) switches: SwitchParameters,
    pub(super) switched: SwitchStates,
    pub(super) noise: Noise,
    /// For how long there has been no power, s; `None` with power.
    pub(super) dead_for: Option<f64>,
}

/// A motor at work.
#[derive(Clone, Debug)]
pub(super) enum MotorAtWork {
    Servo(Box<ServoDrive>),
    Stepper(Box<StepperDrive>),
}

impl AxisDrive {
    /// Drive enabled with the effort `holding`, `fed_forward` of it by feed-forward; the motor moves `inertia` at
    /// `position`.
    pub(super) fn enabled(
        parameters: &AxisDriveParameters,
        holding: f64,
        fed_forward: f64,
        inertia: f64,
        (axis, position): (usize, f64),
    ) -> Self {
        let motor = match &parameters.motor {
            Motor::Servo(servo) => MotorAtWork::Servo(Box::new(ServoDrive::enabled(
                servo.clone(),
                holding,
                fed_forward,
            ))),
            Motor::Stepper(stepper) => MotorAtWork::Stepper(Box::new(StepperDrive::enabled(
                stepper.clone(),
                inertia,
                position,
                holding,
            ))),
        };
        let overload = parameters.overload.map(|overload| Overload::new(overload, holding));
        let noise = Noise::new(parameters.noise, 0, axis);
        let switches = parameters.switches;
        let switched = SwitchStates::default();
        Self { motor, brake: parameters.brake, overload, switches, switched, noise, dead_for: None }
    }

    /// The most that its motor can give at `velocity` (m/s or rad/s), N or Nm; `None` without a limit.
    pub(super) fn effort_limit(&self, velocity: f64) -> Option<f64> {
        let most = match &self.motor {
            MotorAtWork::Servo(servo) => servo.parameters.most_effort(velocity),
            MotorAtWork::Stepper(stepper) => stepper.parameters.pull_out.at(velocity),
        };
        most.is_finite().then_some(most)
    }

    /// Relative losses of the motor, smoothed; 1 is the continuous limit. `None` where they are not known.
    pub(super) fn warmth(&self) -> Option<f64> {
        self.overload.as_ref().map(Overload::warmth)
    }

    /// Present holding effort of its brake.
    pub(super) fn braking(&self) -> f64 {
        let closed =
            |brake: &BrakeParameters| self.dead_for.is_some_and(|s| s >= brake.closing_time);
        self.brake.filter(closed).map_or(0.0, |brake| brake.effort)
    }
}

impl Motors for [AxisDrive] {
    fn efforts(&self, stage: Stage, motors: &JointState) -> JointVector {
        let states = motors.position.iter().zip(motors.velocity.iter());
        joint_vector(self.iter().zip(states).map(
            |(drive, (position, velocity))| match &drive.motor {
                MotorAtWork::Servo(_) if drive.dead_for.is_some() => 0.0,
                MotorAtWork::Stepper(stepper) if drive.dead_for.is_some() => {
                    -stepper.detent(*position)
                }
                MotorAtWork::Servo(servo) => servo.effort(stage),
                MotorAtWork::Stepper(stepper) => stepper.effort(stage, *position, *velocity),
            },
        ))
    }
}
