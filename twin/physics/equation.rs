//! Equation of motion of a simulated machine of any kind, in axis positions.

use nalgebra::Vector3;
use twin_urdf::Model;

use crate::dynamics::Dynamics;
use crate::error::Result;
use crate::joint::{JointMatrix, JointVector};
use crate::tripod::TripodDynamics;

/// Equation of motion of a tree of links or of a tripod.
#[derive(Clone, Debug)]
pub(super) enum Equation {
    Tree(Box<Dynamics>),
    Tripod(Box<TripodDynamics>),
}

impl Equation {
    /// Of `model` with the axes `0..axis_count` under `gravity` (m/s², machine frame), with rotors of `armature`
    /// (kg or kg·m²).
    /// Errors: a model that is neither a tree nor a tripod.
    pub(super) fn new(
        model: &Model,
        axis_count: usize,
        gravity: Vector3<f64>,
        armature: JointVector,
    ) -> Result<Self> {
        if model.loops.is_empty() {
            let tree = Dynamics::new(model, axis_count, gravity, armature)?;
            return Ok(Self::Tree(Box::new(tree)));
        }
        let tripod = TripodDynamics::new(model, axis_count, gravity, armature)?;
        Ok(Self::Tripod(Box::new(tripod)))
    }

    pub(super) fn axis_count(&self) -> usize {
        match self {
            Self::Tree(tree) => tree.axis_count(),
            Self::Tripod(tripod) => tripod.axis_count(),
        }
    }

    /// The efforts that give the axes `acceleration` at `position` and `velocity`; `None` where the machine cannot be.
    pub(super) fn inverse_dynamics(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        acceleration: &JointVector,
    ) -> Option<JointVector> {
        match self {
            Self::Tree(tree) => Some(tree.inverse_dynamics(position, velocity, acceleration)),
            Self::Tripod(tripod) => tripod.inverse_dynamics(position, velocity, acceleration),
        }
    }

    /// The accelerations of the axes that `effort` gives; `None` where the machine cannot be, or if some axis moves no inertia.
    pub(super) fn acceleration(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        effort: &JointVector,
    ) -> Option<JointVector> {
        match self {
            Self::Tree(tree) => tree.acceleration(position, velocity, effort),
            Self::Tripod(tripod) => tripod.acceleration(position, velocity, effort),
        }
    }

    /// The inertia at `position`: efforts per accelerations. 1 on the diagonal where the machine has no axis.
    pub(super) fn inertia(&mut self, position: &JointVector) -> Option<JointMatrix> {
        match self {
            Self::Tree(tree) => Some(tree.inertia_at(position)),
            Self::Tripod(tripod) => tripod.inertia(position),
        }
    }

    /// [`Self::acceleration`] and the inverse of [`Self::inertia`] for hardly more than the first alone.
    pub(super) fn acceleration_and_mobility(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        effort: &JointVector,
    ) -> Option<(JointVector, JointMatrix)> {
        match self {
            Self::Tree(tree) => tree.acceleration_and_mobility(position, velocity, effort),
            Self::Tripod(tripod) => tripod.acceleration_and_mobility(position, velocity, effort),
        }
    }
}
