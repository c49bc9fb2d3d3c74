//! Motor efforts along a path for a machine of any kind.

use nalgebra::Vector3;
use twin_urdf::Model;

use crate::dynamics::Dynamics;
use crate::equation::Equation;
use crate::error::PhysicsError;
use crate::joint::JointVector;
use crate::tripod::TripodDynamics;

/// Mechanism: a tree of links or a tripod.
#[derive(Clone, Debug)]
pub(super) enum Mechanism {
    /// The same without gravity, so that it takes nothing from the digits of the rest, and with it.
    Tree([Box<Dynamics>; 2]),
    Tripod(Box<TripodDynamics>),
}

/// Efforts at one place of a path: per unit of s̈, per unit of ṡ², and against gravity.
pub(super) type EffortsAlongPath = [JointVector; 3];

impl Mechanism {
    /// Of `model` with the axes `0..axis_count` under `gravity` (m/s², machine frame), with `armature` (kg or kg·m²) added
    /// to what each axis moves.
    ///
    /// # Errors
    /// Whatever makes the model something else.
    pub(super) fn new(
        model: &Model,
        axis_count: usize,
        gravity: Vector3<f64>,
        armature: JointVector,
    ) -> Result<Self, PhysicsError> {
        Ok(match Equation::new(model, axis_count, gravity, armature)? {
            Equation::Tree(weighty) => {
                let weightless = Dynamics::new(model, axis_count, Vector3::zeros(), armature)?;
                Self::Tree([Box::new(weightless), weighty])
            }
            Equation::Tripod(tripod) => Self::Tripod(tripod),
        })
    }

    /// With the axes at `position`, q′ = `first` and q″ = `second`.
    ///
    /// # Errors
    /// [`PhysicsError::Apart`].
    pub(super) fn along_path(
        &mut self,
        position: &JointVector,
        first: &JointVector,
        second: &JointVector,
    ) -> Result<EffortsAlongPath, PhysicsError> {
        let zero = JointVector::zeros();
        match self {
            Self::Tree([weightless, weighty]) => Ok([
                weightless.inverse_dynamics(position, &zero, first),
                weightless.inverse_dynamics(position, first, second),
                weighty.inverse_dynamics(position, &zero, &zero),
            ]),
            Self::Tripod(tripod) => {
                let state = tripod.state(position)?;
                let weight = tripod.additional_efforts(position, &zero, &zero);
                Ok([
                    tripod.efforts(&state, &zero, first, false)
                        + tripod.additional_efforts(position, &zero, first)
                        - weight,
                    tripod.efforts(&state, first, second, false)
                        + tripod.additional_efforts(position, first, second)
                        - weight,
                    tripod.efforts(&state, &zero, &zero, true) + weight,
                ])
            }
        }
    }
}
