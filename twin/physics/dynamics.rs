//! Equation of motion of a tree of links in joint space: `M(q)·a + b(q, v) = effort`.
//!
//! `b` holds gravity, centrifugal and Coriolis terms; `M` includes rotors. Without rotary joints both are constant.
//!
//! Joint `i` is machine axis `i`. Two motors on one belt move two joints together: joint positions are G·q with a
//! constant G, efforts at the motors are Gᵀ·effort of the joints, the inertia is Gᵀ·M·G. Rotors turn with the
//! motors. Positions, velocities and efforts are those of the axes.

use nalgebra::Vector3;
use twin_kinematics::MAX_AXES;
use twin_urdf::Model;

use crate::bodies::Tree;
use crate::error::{PhysicsError, Result};
use crate::joint::{JointMatrix, JointVector};
use crate::linear::{solve, solve_and_invert};
use crate::tree_dynamics::TreeDynamics;

/// Checks that a machine can have this number of axes.
pub(super) fn check_axis_count(axis_count: usize) -> Result<()> {
    let possible = (1..=MAX_AXES).contains(&axis_count);
    if possible { Ok(()) } else { Err(PhysicsError::AxisNumber(axis_count)) }
}

/// The equation of motion of one machine.
#[derive(Clone, Debug)]
pub(super) struct Dynamics {
    axis_count: usize,
    gravity: Vector3<f64>,
    tree: Tree,
    bodies: TreeDynamics,
    /// Reflected rotor inertia per axis.
    armature: JointVector,
    /// Efforts against gravity, if nothing turns: then they and the inertia are the same everywhere.
    weight: Option<JointVector>,
    /// That inertia, or workspace: that of coupled axes.
    inertia: JointMatrix,
}

impl Dynamics {
    /// Equation of motion of `model` under `gravity` (m/s², machine frame), with rotors of `armature` (kg or
    /// kg·m²).
    /// Errors: a model that is not a tree of links moved by these axes, or an axis without inertia.
    pub(super) fn new(
        model: &Model,
        axis_count: usize,
        gravity: Vector3<f64>,
        armature: JointVector,
    ) -> Result<Self> {
        check_axis_count(axis_count)?;
        if !gravity.iter().all(|value| value.is_finite()) {
            return Err(PhysicsError::Input(0));
        }
        let tree = Tree::new(model, axis_count)?;
        tree.check_coupling(axis_count)?;
        if let Some(axis) = (0..axis_count).find(|axis| !tree.moves_with(*axis)) {
            return Err(PhysicsError::AxisWithoutJoint(axis));
        }
        Ok(Self::of_tree(tree, axis_count, gravity, armature))
    }

    /// Equation of motion of checked bodies, which need not move with every axis.
    pub(super) fn of_tree(
        tree: Tree,
        axis_count: usize,
        gravity: Vector3<f64>,
        armature: JointVector,
    ) -> Self {
        // Where axes are coupled, rotors do not turn with a joint each.
        let coupled = tree.coupling.is_some();
        let with_joints = if coupled { JointVector::zeros() } else { armature };
        let bodies = TreeDynamics::new(&tree, &with_joints, axis_count);
        let uniform = bodies.is_uniform();
        let inertia = JointMatrix::identity();
        let mut result =
            Self { axis_count, gravity, tree, bodies, armature, weight: None, inertia };
        if uniform {
            let zero = JointVector::zeros();
            result.place(&zero);
            let weight = result.efforts(&zero, &zero);
            result.inertia = *result.inertia();
            result.weight = Some(weight);
        }
        result
    }

    pub(super) fn axis_count(&self) -> usize {
        self.axis_count
    }

    /// Inertia and efforts against gravity, if nothing turns: then they are the same everywhere.
    pub(super) fn uniform(&self) -> Option<(&JointMatrix, &JointVector)> {
        Some((&self.inertia, self.weight.as_ref()?))
    }

    /// The efforts that give the joint accelerations `acceleration` at `position` and `velocity`.
    pub(super) fn inverse_dynamics(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        acceleration: &JointVector,
    ) -> JointVector {
        if let Some(weight) = &self.weight {
            return self.inertia * acceleration + weight;
        }
        self.place(position);
        self.efforts(velocity, acceleration)
    }

    /// The inertia at `position`; the identity where the machine has no axis.
    pub(super) fn inertia_at(&mut self, position: &JointVector) -> JointMatrix {
        if self.weight.is_none() {
            self.place(position);
        }
        *self.inertia()
    }

    /// The joint accelerations that `effort` gives; `None` if some axis moves no inertia.
    pub(super) fn acceleration(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        effort: &JointVector,
    ) -> Option<JointVector> {
        let axes = self.axis_count;
        let (inertia, bias) = self.inertia_and_bias(position, velocity);
        solve(axes, inertia, &(effort - bias))
    }

    /// As [`Self::acceleration`], and M⁻¹, with 1 on its diagonal where the machine has no axis.
    pub(super) fn acceleration_and_mobility(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        effort: &JointVector,
    ) -> Option<(JointVector, JointMatrix)> {
        let axes = self.axis_count;
        let (inertia, bias) = self.inertia_and_bias(position, velocity);
        solve_and_invert(axes, inertia, &(effort - bias))
    }

    /// M and b.
    fn inertia_and_bias(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
    ) -> (&JointMatrix, JointVector) {
        let bias = if let Some(weight) = self.weight {
            weight
        } else {
            self.place(position);
            self.efforts(velocity, &JointVector::zeros())
        };
        (self.inertia(), bias)
    }

    fn place(&mut self, position: &JointVector) {
        match &self.tree.coupling {
            Some(coupling) => self.bodies.place(&(coupling * position)),
            None => self.bodies.place(position),
        }
    }

    /// At the last place.
    fn efforts(&mut self, velocity: &JointVector, acceleration: &JointVector) -> JointVector {
        let Some(coupling) = &self.tree.coupling else {
            return self.bodies.efforts(velocity, acceleration, &self.gravity);
        };
        let [joint_velocity, changes] = [velocity, acceleration].map(|values| coupling * values);
        let efforts = self.bodies.efforts(&joint_velocity, &changes, &self.gravity);
        coupling.tr_mul(&efforts) + self.armature.component_mul(acceleration)
    }

    /// At the last place.
    fn inertia(&mut self) -> &JointMatrix {
        if self.weight.is_some() {
            return &self.inertia;
        }
        let Some(coupling) = &self.tree.coupling else { return self.bodies.inertia() };
        let mut inertia = coupling.tr_mul(&(self.bodies.inertia() * coupling));
        for (axis, armature) in self.armature.iter().enumerate() {
            inertia[(axis, axis)] += if axis < self.axis_count { *armature } else { 1.0 };
        }
        self.inertia = inertia;
        &self.inertia
    }
}
