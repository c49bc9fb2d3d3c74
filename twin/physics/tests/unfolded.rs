//! Reference equation of motion: sums over all links separately, in the machine frame about its origin.
//!
//! It is slower than the tree dynamics in use, in other frames and by another formulation. Both must agree.
//!
//! A joint contributes one column, the velocity it gives its subtree per unit of joint velocity: `(a, p × a)` for a
//! revolute joint with direction `a` through `p`, `(0, a)` for a prismatic one. Velocities of all bodies are then plain
//! sums of columns along the branch, and the derivative of a column is the cross product with the velocity of its body
//! (Featherstone, *Rigid Body Dynamics Algorithms*, 2008, chapters 2, 5 and 6). The inertia is summed from the bodies'
//! Jacobians.

use nalgebra::{Translation3, UnitQuaternion};
use proptest::prelude::*;

use super::*;
use crate::bodies::{Motion, Tree};
use crate::joint::JointMatrix;

/// A velocity or acceleration of space as a body carries it: rotation, and translation of the point that is at the
/// origin of the machine frame just now.
#[derive(Clone, Copy, Debug, Default)]
struct Twist {
    angular: Vector3<f64>,
    linear: Vector3<f64>,
}

impl Twist {
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
#[derive(Clone, Copy, Debug, Default)]
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

/// The equation of motion of one machine.
#[derive(Clone, Debug)]
pub(super) struct Unfolded {
    axis_count: usize,
    gravity: Vector3<f64>,
    tree: Tree,
    /// Joints that move each body, base side first.
    moved_by: Vec<Vec<usize>>,
    armature: JointVector,
    /// The bodies at the last evaluation, in the order of the tree.
    states: Vec<BodyState>,
    /// The joint columns at the last evaluation.
    columns: [Twist; MAX_AXES],
}

impl Unfolded {
    pub(super) fn new(
        model: &Model,
        axis_count: usize,
        gravity: Vector3<f64>,
        armature: JointVector,
    ) -> Self {
        let tree = Tree::new(model, axis_count).unwrap();
        let mut moved_by: Vec<Vec<usize>> = Vec::new();
        for body in &tree.bodies {
            let mut joints = body.parent.map_or_else(Vec::new, |parent| moved_by[parent].clone());
            joints.extend(body.motion.joint());
            moved_by.push(joints);
        }
        let (states, columns) = (Vec::new(), [Twist::default(); MAX_AXES]);
        Self { axis_count, gravity, tree, moved_by, armature, states, columns }
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
        for ((body, state), moved_by) in
            self.tree.bodies.iter().zip(&self.states).zip(&self.moved_by)
        {
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
            for (axis, column) in moving(moved_by, &self.columns) {
                if let Some(effort) = effort.get_mut(axis) {
                    *effort += column.angular.dot(&torque) + column.linear.dot(&force);
                }
            }
        }
        coupling.map_or(effort, |coupling| coupling.tr_mul(&effort) + rotors)
    }

    /// The joint-space inertia at the last evaluated position; the identity where the machine has no axis.
    fn inertia(&self) -> JointMatrix {
        let mut rotors = JointMatrix::from_diagonal(&self.armature);
        for axis in self.axis_count..MAX_AXES {
            add(&mut rotors, axis, axis, 1.0);
        }
        let coupling = self.tree.coupling.as_ref();
        let mut inertia = if coupling.is_none() { rotors } else { JointMatrix::zeros() };
        for ((body, state), moved_by) in
            self.tree.bodies.iter().zip(&self.states).zip(&self.moved_by)
        {
            for (count, (row, column)) in moving(moved_by, &self.columns).enumerate() {
                let center_velocity =
                    (column.linear + column.angular.cross(&state.center)) * body.mass.mass;
                let momentum = state.inertia * column.angular;
                for (other_row, other) in moving(moved_by, &self.columns).take(count + 1) {
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

    /// Poses of the links in the machine frame, the base (link 0) first.
    pub(super) fn link_poses(&mut self, position: &JointVector) -> Vec<Isometry3<f64>> {
        self.evaluate(position, &JointVector::zeros(), &JointVector::zeros());
        std::iter::once(Isometry3::identity())
            .chain(self.states.iter().map(|state| state.pose))
            .collect()
    }

    /// Kinetic and potential energy, J; potential energy is 0 with every centre of mass at the origin.
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
        let mut base = BodyState::default();
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
                    joint * UnitQuaternion::from_axis_angle(&direction, position[axis])
                }
                Motion::Prismatic(axis, direction) => {
                    joint * Translation3::from(direction.into_inner() * position[axis])
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
                let speed = velocity[axis];
                state.velocity = parent.velocity.add_scaled(&column, speed);
                state.acceleration = parent
                    .acceleration
                    .add_scaled(&column, acceleration[axis])
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

/// What the machine does at one instant.
#[derive(Clone, Debug)]
struct Case {
    model: Model,
    /// Position, velocity, acceleration and rotors of the axes.
    motion: [AxisVector; 4],
}

/// A tree of 1 to 8 joints with arbitrary frames, directions (among them those of the frame, both ways), masses and order of axes, in
/// which other links are fixed to some.
fn cases() -> impl Strategy<Value = Case> {
    let direction = prop_oneof![
        prop::array::uniform3(-1.0..1.0_f64).prop_map(|[x, y, z]| Vector3::new(x, y, z + 1.5)),
        (0..3_usize, prop::sample::select(vec![1.0, -1.0]))
            .prop_map(|(axis, sign)| Vector3::ith(axis, sign)),
    ];
    let frame = prop_oneof![
        prop::array::uniform6(-1.0..1.0_f64),
        prop::array::uniform3(-1.0..1.0_f64).prop_map(|[x, y, z]| [x, y, z, 0.0, 0.0, 0.0]),
    ];
    let mass =
        (0.5..5.0_f64, prop::array::uniform3(-0.3..0.3_f64), prop::array::uniform3(0.05..0.4_f64));
    let link = (
        (any::<bool>(), prop::bool::weighted(0.3)),
        direction,
        frame,
        mass,
        prop::array::uniform4(-2.0..2.0_f64),
        any::<prop::sample::Index>(),
    );
    (prop::collection::vec(link, 1..=MAX_AXES), 0..MAX_AXES).prop_map(|(links, shift)| {
        let count = links.len();
        let mut model = chain([]);
        for (index, ((revolute, carries), direction, frame, mass, _, parent)) in
            links.iter().enumerate()
        {
            let [x, y, z, a, b, c] = *frame;
            let origin = Isometry3::new(Vector3::new(x, y, z), Vector3::new(a, b, c) * 2.0);
            let (mass, center, size) = *mass;
            let body = Some(uniform_box(mass, center, size));
            let kind = if *revolute { JointKind::Revolute } else { JointKind::Prismatic };
            let link = |kind, drive| {
                let mut piece = chain([(kind, *direction, origin, body)]);
                let joint = Joint { drive, ..piece.joints.remove(0) };
                (joint, piece.links.remove(1))
            };
            let moving = link(kind, JointDrive::Axis((index + shift) % count));
            let fixed = carries.then(|| link(JointKind::Fixed, JointDrive::Fixed));
            for (joint, link) in std::iter::once(moving).chain(fixed) {
                let (parent, child) = (parent.index(model.links.len()), model.links.len());
                model.joints.push(Joint { parent, child, ..joint });
                model.links.push(link);
            }
        }
        let of = |which: usize| AxisVector::from_values(links.iter().map(|link| link.4[which]));
        let rotors = AxisVector::from_values(links.iter().map(|link| link.4[3].abs()));
        Case { model, motion: [of(0), of(1), of(2), rotors] }
    })
}

/// Both axes of a belt, and the last one alone, move the first three joints.
fn coupled(mut model: Model) -> Model {
    let moving: Vec<_> = model.moving_joints().map(|(index, _)| index).collect();
    if let [first, second, ..] = moving.as_slice() {
        model.joints[*first].drive = JointDrive::Combination(vec![(0, 0.5), (1, 0.5)]);
        model.joints[*second].drive = JointDrive::Combination(vec![(0, 0.5), (1, -0.7)]);
        for (axis, joint) in moving.iter().enumerate().skip(2) {
            model.joints[*joint].drive = JointDrive::Axis(axis);
        }
    }
    model
}

proptest! {
    /// Efforts, inertia, accelerations and mobility are the same to rounding.
    #[test]
    fn separated_links_are_the_same_machine(case in cases(), belt in any::<bool>()) {
        let count = case.motion[0].len();
        let [q, v, a, rotors] = case.motion.map(|values| joint_vector(values.iter().copied()));
        let model = if belt { coupled(case.model) } else { case.model };
        let mut unfolded = Unfolded::new(&model, count, down(), rotors);
        let mut dynamics = Dynamics::new(&model, count, down(), rotors).unwrap();
        let effort = unfolded.inverse_dynamics(&q, &v, &a);
        let scale = effort.amax().max(1.0);
        let difference = (dynamics.inverse_dynamics(&q, &v, &a) - effort).amax();
        prop_assert!(difference < 1e-12 * scale, "{difference} of {scale}");
        let inertia = unfolded.inertia_at(&q);
        let difference = (dynamics.inertia_at(&q) - inertia).amax();
        prop_assert!(difference < 1e-13 * inertia.amax(), "{difference} of {inertia}");
        let uneven = dynamics.inertia_at(&q) - dynamics.inertia_at(&q).transpose();
        prop_assert!(uneven.amax() < 1e-15 * inertia.amax(), "{uneven}");

        let (found, mobility) = dynamics.acceleration_and_mobility(&q, &v, &effort).unwrap();
        prop_assert_eq!(dynamics.acceleration(&q, &v, &effort), Some(found));
        let condition = inertia.amax() * mobility.amax();
        prop_assert!((found - a).amax() < 1e-12 * condition * scale, "{found} is not {a}");
        let product = mobility * inertia - JointMatrix::identity();
        prop_assert!(product.amax() < 1e-13 * condition, "{product}");
    }
}

/// Far from the origin of the machine frame nothing is lost, as the sums of links lose it.
#[test]
fn machines_may_stand_anywhere() {
    let near = crooked();
    let mut far = near.clone();
    far.joints[0].origin.translation.vector += Vector3::new(400.0, -300.0, 50.0);
    let [q, v, a] = [[0.7, -0.1, 2.0], [1.5, -0.8, 4.0], [3.0, 1.0, -2.0]].map(joints);
    let efforts = [near, far].map(|model| {
        let mut dynamics = Dynamics::new(&model, 3, down(), JointVector::zeros()).unwrap();
        dynamics.inverse_dynamics(&q, &v, &a)
    });
    assert!((efforts[0] - efforts[1]).amax() < 1e-13 * efforts[0].amax(), "{efforts:?}");
}

/// A machine whose axis moves nothing has no acceleration, however the others move.
#[test]
fn an_axis_without_inertia_has_no_acceleration() {
    let mut model = gantry();
    model.links[3].inertial = None;
    let mut dynamics = Dynamics::new(&model, 3, down(), JointVector::zeros()).unwrap();
    let [q, v, f] = [[0.1, 0.2, 0.3], [0.0; 3], [1.0; 3]].map(joints);
    assert_eq!(dynamics.acceleration(&q, &v, &f), None);
    let mut rotor = Dynamics::new(&model, 3, down(), joints([0.0, 0.0, 2.0])).unwrap();
    let expected = joints([1.0 / 17.0, 1.0 / 5.0, 0.5]);
    let found = rotor.acceleration(&q, &v, &f).unwrap();
    assert!((found - expected).amax() < 1e-15, "{found}");
}
