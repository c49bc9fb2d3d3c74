//! One short step: the machine, its friction, and the efforts on its parts.

use twin_kinematics::MAX_AXES;

use crate::equation::Equation;
use crate::friction::DryFriction;
use crate::joint::JointVector;
use crate::state::{JointState, MachineState, Motors, Stage, Train};

/// Dry friction on both sides of the transmissions.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Dry {
    pub(super) axes: [DryFriction; MAX_AXES],
    pub(super) motors: [DryFriction; MAX_AXES],
    /// Sticking axes.
    pub(super) sticking_axes: Sticking,
    /// Sticking motors.
    pub(super) sticking_motors: Sticking,
}

/// Number of sticking parts: none, some or all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Sticking {
    #[default]
    None,
    Some,
    All,
}

/// Presence of springs between motors and axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Springs {
    None,
    Some,
    All,
}

impl Springs {
    pub(super) fn of(trains: &[Train]) -> Self {
        let is_elastic = |train: &Train| train.elastic.is_some();
        if trains.iter().all(is_elastic) {
            Self::All
        } else if trains.iter().any(is_elastic) {
            Self::Some
        } else {
            Self::None
        }
    }
}

/// A machine in a step.
pub(super) struct Step<'a, M: ?Sized> {
    pub(super) equation: &'a mut Equation,
    pub(super) trains: &'a [Train; MAX_AXES],
    pub(super) motors: &'a M,
    /// Further efforts on the axes, N or Nm.
    pub(super) disturbance: &'a JointVector,
    /// Number of axes.
    pub(super) axes: usize,
    pub(super) springs: Springs,
    /// True if there is dry friction.
    pub(super) dry: bool,
    /// s.
    pub(super) dt: f64,
}

/// Efforts on axes and motors at some time, N or Nm.
pub(super) struct Pushed {
    pub(super) axes: JointVector,
    /// Only of motors behind springs.
    pub(super) motors: JointVector,
    /// The efforts of all motors.
    pub(super) effort: JointVector,
}

impl<M: Motors + ?Sized> Step<'_, M> {
    /// `motors` where there are elastic transmissions, and the axes elsewhere.
    pub(super) fn motors_of(&self, axes: &JointState, motors: &JointState) -> JointState {
        let mut result = *axes;
        let rows = result.position.iter_mut().zip(result.velocity.iter_mut());
        let motors = motors.position.iter().zip(motors.velocity.iter());
        for (((position, velocity), motor), train) in rows.zip(motors).zip(self.trains) {
            if train.elastic.is_some() {
                (*position, *velocity) = (*motor.0, *motor.1);
            }
        }
        result
    }

    /// Efforts on all parts at `state`, except the forces that hold sticking parts.
    #[inline]
    pub(super) fn pushed(&self, stage: Stage, state: &MachineState, dry: &Dry) -> Pushed {
        let MachineState { axes, motors } = state;
        let mixed;
        let motors = match self.springs {
            Springs::None => axes,
            Springs::All => motors,
            Springs::Some => {
                mixed = self.motors_of(axes, motors);
                &mixed
            }
        };
        let effort = self.motors.efforts(stage, motors);
        let mut pushed = Pushed { axes: effort, motors: JointVector::zeros(), effort };
        let rows = pushed.axes.iter_mut().zip(pushed.motors.iter_mut()).zip(self.trains);
        for (axis, (((at_axis, at_motor), train), (dry, dry_motor))) in
            rows.zip(dry.axes.iter().zip(&dry.motors)).enumerate().take(self.axes)
        {
            let velocity = axes.velocity[axis];
            if let Some(elastic) = &train.elastic {
                let motor_velocity = motors.velocity[axis];
                let twist = motors.position[axis] - axes.position[axis];
                let passed = elastic.transmission.effort(twist, motor_velocity - velocity);
                let friction = dry_motor.force(motor_velocity, &elastic.friction);
                *at_motor = *at_axis - passed + friction;
                *at_axis = passed;
            }
            *at_axis += dry.force(velocity, &train.friction);
        }
        pushed.axes += self.disturbance;
        pushed
    }
}
