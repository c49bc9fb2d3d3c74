//! The equation of motion of a tree of links in joint space: `M(q)·a + b(q, v) = effort`.
//!
//! Everything is written in the machine frame about its origin. A joint contributes one column, the velocity it gives
//! its subtree per unit of joint velocity: `(a, p × a)` for a revolute joint with direction `a` through `p`,
//! `(0, a)` for a prismatic one. Velocities of all bodies are then plain sums of columns along the branch, and
//! the derivative of a column is the cross product with the velocity of its body (Featherstone, *Rigid Body Dynamics
//! Algorithms*, 2008, chapters 2, 5 and 6). `b` holds gravity, centrifugal and Coriolis terms (recursive
//! Newton–Euler with zero acceleration); `M` is summed from the bodies' Jacobians and has the reflected rotor inertia
//! on its diagonal.
//!
//! Joint `i` here is machine axis `i`, whatever the order of the joints in the model. Where two motors on one belt move two
//! joints together, joint positions are G·q with a constant G, efforts of the joints become Gᵀ·effort at the motors, and
//! the inertia Gᵀ·M·G; rotors turn with the motors. Positions, velocities and efforts are those of the axes, always.

use nalgebra::{Isometry3, Matrix3, SMatrix, SVector, Translation3, UnitQuaternion, Vector3};
use twin_kinematics::MAX_AXES;
use twin_urdf::Model;

use super::bodies::{Motion, Tree};
use super::error::PhysicsError;

/// One value per axis; axes the machine does not have are 0.
pub(super) type JointVector = SVector<f64, MAX_AXES>;

/// One value per pair of axes.
pub(super) type JointMatrix = SMatrix<f64, MAX_AXES, MAX_AXES>;

/// A velocity or acceleration of space as a body carries it: rotation, and translation of the point that is at the
/// origin of the machine frame just now.
#[derive(Clone, Copy, Debug)]
struct Twist {
    angular: Vector3<f64>,
    linear: Vector3<f64>,
}

impl Twist {
    const ZERO: Self =
        Self { angular: Vector3::new(0.0, 0.0, 0.0), linear: Vector3::new(0.0, 0.0, 0.0) };

    fn add_scaled(&self, other: &Self, factor: f64) -> Self {
        Self {
            angular: self.angular + other.angular * factor,
            linear: self.linear + other.linear * factor,
        }
    }

    /// How `column` changes when its body moves with this velocity.
    fn derivative_of(&self, column: &Self) -> Self {
        Self {
            angular: self.angular.cross(&column.angular),
            linear: self.angular.cross(&column.linear) + self.linear.cross(&column.angular),
        }
    }
}

/// A link at one instant.
#[derive(Clone, Copy, Debug)]
struct BodyState {
    pose: Isometry3<f64>,
    velocity: Twist,
    /// Acceleration at the joint accelerations of the last evaluation, gravity as an upward acceleration of the base.
    acceleration: Twist,
    /// Centre of mass, machine frame.
    center: Vector3<f64>,
    /// About the centre of mass, axes of the machine frame.
    inertia: Matrix3<f64>,
}

impl BodyState {
    const BASE: Self = Self {
        pose: Isometry3 {
            rotation: UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(1.0, 0.0, 0.0, 0.0)),
            translation: Translation3 { vector: Vector3::new(0.0, 0.0, 0.0) },
        },
        velocity: Twist::ZERO,
        acceleration: Twist::ZERO,
        center: Vector3::new(0.0, 0.0, 0.0),
        inertia: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };
}

/// The equation of motion of one machine.
#[derive(Clone, Debug)]
pub(super) struct Dynamics {
    axis_count: usize,
    gravity: Vector3<f64>,
    tree: Tree,
    /// Reflected rotor inertia per axis.
    armature: JointVector,
    /// Workspace: the bodies at the last evaluation, in the order of the tree.
    states: Vec<BodyState>,
    /// Workspace: the joint columns at the last evaluation.
    columns: [Twist; MAX_AXES],
}

impl Dynamics {
    /// The equation of motion of `model` under `gravity` (m/s², machine frame), with `armature` (kg or kg·m²) added to
    /// what each axis moves.
    ///
    /// # Errors
    /// Whatever makes the model no tree of links whose joints are the axes `0..axis_count`, each moving some inertia.
    pub(super) fn new(
        model: &Model,
        axis_count: usize,
        gravity: Vector3<f64>,
        armature: JointVector,
    ) -> Result<Self, PhysicsError> {
        if axis_count == 0 || axis_count > MAX_AXES {
            return Err(PhysicsError::AxisNumber { given: axis_count });
        }
        if !gravity.iter().all(|value| value.is_finite()) {
            return Err(PhysicsError::Input { time_ns: 0 });
        }
        let tree = Tree::new(model, axis_count)?;
        if let Some(axis) = (0..axis_count).find(|axis| !tree.moves_with(*axis)) {
            return Err(PhysicsError::AxisWithoutJoint { axis });
        }
        Ok(Self::of_tree(tree, axis_count, gravity, armature))
    }

    /// The same of checked bodies, which need not move with every axis.
    pub(super) fn of_tree(
        tree: Tree,
        axis_count: usize,
        gravity: Vector3<f64>,
        armature: JointVector,
    ) -> Self {
        let states = Vec::with_capacity(tree.bodies.len());
        Self { axis_count, gravity, tree, armature, states, columns: [Twist::ZERO; MAX_AXES] }
    }

    pub(super) fn axis_count(&self) -> usize {
        self.axis_count
    }

    /// The efforts that give the joint accelerations `acceleration` at `position` and `velocity`.
    pub(super) fn inverse_dynamics(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        acceleration: &JointVector,
    ) -> JointVector {
        self.evaluate(position, velocity, acceleration);
        let rotors = self.armature.component_mul(acceleration);
        let coupling = self.tree.coupling.as_ref();
        let mut effort = if coupling.is_none() { rotors } else { JointVector::zeros() };
        for (body, state) in self.tree.bodies.iter().zip(&self.states) {
            let angular_velocity = state.velocity.angular;
            let angular_acceleration = state.acceleration.angular;
            let center_velocity = state.velocity.linear + angular_velocity.cross(&state.center);
            let center_acceleration = state.acceleration.linear
                + angular_acceleration.cross(&state.center)
                + angular_velocity.cross(&center_velocity);
            let force = center_acceleration * body.mass.mass;
            let torque = state.inertia * angular_acceleration
                + angular_velocity.cross(&(state.inertia * angular_velocity))
                + state.center.cross(&force);
            for (axis, column) in moving(&body.moved_by, &self.columns) {
                if let Some(effort) = effort.get_mut(axis) {
                    *effort += column.angular.dot(&torque) + column.linear.dot(&force);
                }
            }
        }
        coupling.map_or(effort, |coupling| coupling.tr_mul(&effort) + rotors)
    }

    /// The joint-space inertia at the last evaluated position; the identity where the machine has no axis.
    fn inertia(&self) -> JointMatrix {
        let rotors = inertia_of_rotors(&self.armature, self.axis_count);
        let coupling = self.tree.coupling.as_ref();
        let mut inertia = if coupling.is_none() { rotors } else { JointMatrix::zeros() };
        for (body, state) in self.tree.bodies.iter().zip(&self.states) {
            for (count, (row, column)) in moving(&body.moved_by, &self.columns).enumerate() {
                let center_velocity =
                    (column.linear + column.angular.cross(&state.center)) * body.mass.mass;
                let momentum = state.inertia * column.angular;
                for (other_row, other) in moving(&body.moved_by, &self.columns).take(count + 1) {
                    let other_velocity = other.linear + other.angular.cross(&state.center);
                    let value = center_velocity.dot(&other_velocity) + momentum.dot(&other.angular);
                    add(&mut inertia, row, other_row, value);
                    if row != other_row {
                        add(&mut inertia, other_row, row, value);
                    }
                }
            }
        }
        coupling.map_or(inertia, |coupling| coupling.tr_mul(&(inertia * coupling)) + rotors)
    }

    /// The same at `position`.
    pub(super) fn inertia_at(&mut self, position: &JointVector) -> JointMatrix {
        self.evaluate(position, &JointVector::zeros(), &JointVector::zeros());
        self.inertia()
    }

    /// The links.
    pub(super) fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The joint accelerations that `effort` gives; `None` if some axis moves no inertia.
    pub(super) fn acceleration(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        effort: &JointVector,
    ) -> Option<JointVector> {
        let bias = self.inverse_dynamics(position, velocity, &JointVector::zeros());
        solve(self.axis_count, &self.inertia(), &(effort - bias))
    }

    /// Poses of the links in the machine frame, the base (link 0) first.
    #[cfg(test)]
    pub(super) fn link_poses(&mut self, position: &JointVector) -> Vec<Isometry3<f64>> {
        self.evaluate(position, &JointVector::zeros(), &JointVector::zeros());
        std::iter::once(Isometry3::identity())
            .chain(self.states.iter().map(|state| state.pose))
            .collect()
    }

    /// Kinetic and potential energy, J; potential energy is 0 with every centre of mass at the origin.
    #[cfg(test)]
    pub(super) fn energy(&mut self, position: &JointVector, velocity: &JointVector) -> (f64, f64) {
        self.evaluate(position, velocity, &JointVector::zeros());
        let kinetic = 0.5 * (velocity.transpose() * self.inertia() * velocity).x;
        let potential = self.tree.bodies.iter().zip(&self.states);
        (
            kinetic,
            -potential
                .map(|(body, state)| body.mass.mass * self.gravity.dot(&state.center))
                .sum::<f64>(),
        )
    }

    /// Fills the workspace with the bodies at the given motion of the axes.
    fn evaluate(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        acceleration: &JointVector,
    ) {
        match &self.tree.coupling {
            Some(coupling) => {
                let [position, velocity, acceleration] =
                    [position, velocity, acceleration].map(|values| coupling * values);
                self.evaluate_joints(&position, &velocity, &acceleration);
            }
            None => self.evaluate_joints(position, velocity, acceleration),
        }
    }

    /// The same of the joints.
    fn evaluate_joints(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        acceleration: &JointVector,
    ) {
        let mut base = BodyState::BASE;
        base.acceleration.linear = -self.gravity;
        self.states.clear();
        for body in &self.tree.bodies {
            let parent =
                body.parent.and_then(|parent| self.states.get(parent)).copied().unwrap_or(base);
            let joint = parent.pose * body.origin;
            let mut state = parent;
            state.pose = match body.motion {
                Motion::Fixed => joint,
                Motion::Revolute(axis, direction) => {
                    joint * UnitQuaternion::from_axis_angle(&direction, at(position, axis))
                }
                Motion::Prismatic(axis, direction) => {
                    joint * Translation3::from(direction.into_inner() * at(position, axis))
                }
            };
            let column = match body.motion {
                Motion::Fixed => None,
                Motion::Revolute(axis, direction) => {
                    let direction = joint.rotation * direction.into_inner();
                    let linear = joint.translation.vector.cross(&direction);
                    Some((axis, Twist { angular: direction, linear }))
                }
                Motion::Prismatic(axis, direction) => {
                    let linear = joint.rotation * direction.into_inner();
                    Some((axis, Twist { angular: Vector3::zeros(), linear }))
                }
            };
            if let Some((axis, column)) = column {
                let speed = at(velocity, axis);
                state.velocity = parent.velocity.add_scaled(&column, speed);
                state.acceleration = parent
                    .acceleration
                    .add_scaled(&column, at(acceleration, axis))
                    .add_scaled(&state.velocity.derivative_of(&column), speed);
                if let Some(slot) = self.columns.get_mut(axis) {
                    *slot = column;
                }
            }
            let rotation = state.pose.rotation.to_rotation_matrix();
            state.center = (state.pose * body.mass.center).coords;
            state.inertia = rotation * body.mass.inertia * rotation.inverse();
            self.states.push(state);
        }
    }
}

/// What rotors alone have of the inertia: `armature` on the diagonal, and 1 where the machine has no axis.
pub(super) fn inertia_of_rotors(armature: &JointVector, axis_count: usize) -> JointMatrix {
    let mut rotors = JointMatrix::from_diagonal(armature);
    for axis in axis_count..MAX_AXES {
        add(&mut rotors, axis, axis, 1.0);
    }
    rotors
}

/// `inertia⁻¹·effort` for the first `axis_count` axes, by a factorisation no larger than they need.
pub(super) fn solve(
    axis_count: usize,
    inertia: &JointMatrix,
    effort: &JointVector,
) -> Option<JointVector> {
    fn first<const N: usize>(inertia: &JointMatrix, effort: &JointVector) -> Option<JointVector> {
        let mut solution = effort.fixed_rows::<N>(0).into_owned();
        inertia.fixed_view::<N, N>(0, 0).into_owned().cholesky()?.solve_mut(&mut solution);
        let mut result = JointVector::zeros();
        result.fixed_rows_mut::<N>(0).copy_from(&solution);
        Some(result)
    }
    match axis_count {
        1 => first::<1>(inertia, effort),
        2 => first::<2>(inertia, effort),
        3 => first::<3>(inertia, effort),
        4 => first::<4>(inertia, effort),
        5 => first::<5>(inertia, effort),
        6 => first::<6>(inertia, effort),
        _ => first::<MAX_AXES>(inertia, effort),
    }
}

/// The value of `axis`; axes are below [`MAX_AXES`] by construction.
pub(super) fn at(values: &JointVector, axis: usize) -> f64 {
    values.get(axis).copied().unwrap_or_default()
}

fn add(matrix: &mut JointMatrix, row: usize, column: usize, value: f64) {
    if let Some(entry) = matrix.get_mut((row, column)) {
        *entry += value;
    }
}

/// The joints of `moved_by` with their columns.
fn moving<'a>(
    moved_by: &'a [usize],
    columns: &'a [Twist; MAX_AXES],
) -> impl Iterator<Item = (usize, &'a Twist)> {
    moved_by.iter().filter_map(|axis| columns.get(*axis).map(|column| (*axis, column)))
}
