//! State of the axes, motors and transmissions that the integration advances.

use crate::friction::FrictionParameters;
use crate::joint::JointVector;
use crate::transmission::ElasticTransmission;

/// Positions and velocities of all axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JointState {
    pub(super) position: JointVector,
    pub(super) velocity: JointVector,
}

impl JointState {
    pub(super) fn at_rest(position: JointVector) -> Self {
        Self { position, velocity: JointVector::zeros() }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.position.iter().chain(self.velocity.iter()).all(|value| value.is_finite())
    }

    pub(super) fn moved(&self, slope: &Self, dt: f64) -> Self {
        Self {
            position: self.position + slope.position * dt,
            velocity: self.velocity + slope.velocity * dt,
        }
    }

    /// Mean of the four slopes of a Runge–Kutta step.
    pub(super) fn mean(slopes: [&Self; 4]) -> Self {
        let [first, second, third, fourth] = slopes;
        let mean = |of: fn(&Self) -> &JointVector| {
            (of(first) + (of(second) + of(third)) * 2.0 + of(fourth)) / 6.0
        };
        Self { position: mean(|slope| &slope.position), velocity: mean(|slope| &slope.velocity) }
    }
}

/// Both ends of all transmissions; a motor without an elastic one is where its axis is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MachineState {
    pub(super) axes: JointState,
    pub(super) motors: JointState,
}

impl MachineState {
    pub(super) fn is_finite(&self) -> bool {
        self.axes.is_finite() && self.motors.is_finite()
    }

    pub(super) fn moved(&self, slope: &Self, dt: f64) -> Self {
        Self {
            axes: self.axes.moved(&slope.axes, dt),
            motors: self.motors.moved(&slope.motors, dt),
        }
    }
}

/// Time within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stage {
    Start,
    Middle,
    End,
    /// At this part of the step.
    At(f64),
}

impl Stage {
    pub(super) fn new(part: f64) -> Self {
        if part <= 0.0 {
            Self::Start
        } else if part >= 1.0 {
            Self::End
        } else if (part - 0.5).abs() <= f64::EPSILON {
            Self::Middle
        } else {
            Self::At(part)
        }
    }
}

/// Motors of the axes.
pub(super) trait Motors {
    /// Efforts of all motors with these positions and velocities, N or Nm at the axes.
    fn efforts(&self, stage: Stage, motors: &JointState) -> JointVector;
}

/// Transmission between one motor and its axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Train {
    /// Of the axis, and of all that is joined to it rigidly.
    pub(super) friction: FrictionParameters,
    pub(super) elastic: Option<Elastic>,
}

/// A motor at the far end of a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Elastic {
    pub(super) transmission: ElasticTransmission,
    /// Rotor inertia at the axis, kg or kg·m².
    pub(super) inertia: f64,
    pub(super) friction: FrictionParameters,
}

impl Train {
    /// Adds a brake on the motor that holds `effort`.
    pub(super) fn brake(&mut self, effort: f64) {
        let braked = match &mut self.elastic {
            Some(elastic) => &mut elastic.friction,
            None => &mut self.friction,
        };
        *braked = braked.and(&FrictionParameters::new(effort, 0.0));
    }
}
