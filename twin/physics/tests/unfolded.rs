//! Reference equation of motion: sums over all links separately, by their Jacobians in the machine frame.
//!
//! It is slower than the tree dynamics in use, in other frames and by another formulation. Both must agree.
//!
//! A joint moves the origin of the machine frame, carried along by the joint's subtree, by the column `(a, p × a)` per
//! unit of its velocity (revolute, direction `a` through `p`) or by `(0, a)` (prismatic). The Jacobian of a link has the
//! columns of its branch; the derivative of a column is its cross product with the velocity of its body (Featherstone,
//! *Rigid Body Dynamics Algorithms*, 2008, chapters 2, 5 and 6).

use nalgebra::{SMatrix, Translation3, UnitQuaternion};
use proptest::prelude::*;

use super::*;
use crate::bodies::{MassProperties, Motion, Tree};
use crate::joint::JointMatrix;

/// Rotation, and translation of the point at the origin of the machine frame: columns of joints, velocity, acceleration.
type Twist = [Vector3<f64>; 2];

fn add_scaled(sum: &mut Twist, twist: &Twist, factor: f64) {
    sum.iter_mut().zip(twist).for_each(|(sum, part)| *sum += part * factor);
}

/// A link at one instant, in the machine frame.
#[derive(Clone)]
struct LinkState {
    pose: Isometry3<f64>,
    mass: MassProperties,
    /// The column of each joint, 0 of those that do not move the link.
    columns: [Twist; MAX_AXES],
    velocity: Twist,
    /// With gravity as an upward acceleration of the base.
    acceleration: Twist,
}

impl LinkState {
    fn center(&self) -> Vector3<f64> {
        (self.pose * self.mass.center).coords
    }

    /// About the centre of mass.
    fn inertia(&self) -> Matrix3<f64> {
        let rotation = self.pose.rotation.to_rotation_matrix();
        rotation * self.mass.inertia * rotation.inverse()
    }

    /// Velocity of the centre of mass by that of the link.
    fn at_center(&self, [angular, linear]: &Twist) -> Vector3<f64> {
        linear + angular.cross(&self.center())
    }

    /// Rotation, and translation of the centre of mass, by the velocities of the joints.
    fn jacobians(&self) -> [SMatrix<f64, 3, MAX_AXES>; 2] {
        let centers = self.columns.map(|column| self.at_center(&column));
        [self.columns.map(|[angular, _]| angular), centers].map(|rows| SMatrix::from_columns(&rows))
    }
}

/// The equation of motion of one machine.
pub(super) struct Unfolded {
    gravity: Vector3<f64>,
    tree: Tree,
    armature: JointVector,
    /// Joint motion by that of the axes; the identity unless axes are coupled.
    coupling: JointMatrix,
    /// Of axes that the machine does not have.
    beyond: JointMatrix,
}

impl Unfolded {
    pub(super) fn new(
        model: &Model,
        axis_count: usize,
        gravity: Vector3<f64>,
        armature: JointVector,
    ) -> Self {
        let tree = Tree::new(model, axis_count).unwrap();
        let coupling = tree.coupling.unwrap_or_else(JointMatrix::identity);
        let beyond = JointMatrix::from_fn(|row, column| {
            f64::from(u8::from(row == column && row >= axis_count))
        });
        Self { gravity, tree, armature, coupling, beyond }
    }

    /// The efforts that give the axes the acceleration `a` at position `q` and velocity `v`.
    fn inverse_dynamics(&self, q: &JointVector, v: &JointVector, a: &JointVector) -> JointVector {
        let mut effort = JointVector::zeros();
        for link in self.links(q, v, a) {
            let ([angular, linear], inertia) = (link.jacobians(), link.inertia());
            let ([turning, _], [turning_change, _]) = (link.velocity, link.acceleration);
            let force =
                link.at_center(&link.acceleration) + turning.cross(&link.at_center(&link.velocity));
            let torque = inertia * turning_change + turning.cross(&(inertia * turning));
            effort += linear.tr_mul(&(force * link.mass.mass)) + angular.tr_mul(&torque);
        }
        self.coupling.tr_mul(&effort) + self.armature.component_mul(a)
    }

    /// The inertia of the axes; 1 where the machine has no axis.
    fn inertia_at(&self, q: &JointVector) -> JointMatrix {
        let mut inertia = JointMatrix::zeros();
        for link in self.links(q, &JointVector::zeros(), &JointVector::zeros()) {
            let [angular, linear] = link.jacobians();
            inertia += linear.tr_mul(&linear) * link.mass.mass
                + angular.tr_mul(&(link.inertia() * angular));
        }
        let rotors = JointMatrix::from_diagonal(&self.armature);
        self.coupling.tr_mul(&(inertia * self.coupling)) + rotors + self.beyond
    }

    /// Poses of the links, the base (link 0) first.
    pub(super) fn link_poses(&self, q: &JointVector) -> Vec<Isometry3<f64>> {
        let links = self.links(q, &JointVector::zeros(), &JointVector::zeros());
        std::iter::once(Isometry3::identity()).chain(links.iter().map(|link| link.pose)).collect()
    }

    /// Kinetic and potential energy, J, the latter 0 with every centre of mass at the origin.
    pub(super) fn energy(&self, q: &JointVector, v: &JointVector) -> f64 {
        let links = self.links(q, v, &JointVector::zeros());
        let of_links = links.iter().map(|link| {
            let turning = link.velocity[0];
            let squares = link.mass.mass * link.at_center(&link.velocity).norm_squared()
                + turning.dot(&(link.inertia() * turning));
            0.5 * squares - link.mass.mass * self.gravity.dot(&link.center())
        });
        let rotors = 0.5 * self.armature.dot(&v.component_mul(v));
        of_links.sum::<f64>() + rotors
    }

    /// The links in the order of the tree.
    fn links(&self, q: &JointVector, v: &JointVector, a: &JointVector) -> Vec<LinkState> {
        let [q, v, a] = [q, v, a].map(|axes| self.coupling * axes);
        let mut links: Vec<LinkState> = Vec::new();
        for body in &self.tree.bodies {
            let zero = [Vector3::zeros(); 2];
            let mut link = body.parent.map_or_else(
                || LinkState {
                    pose: Isometry3::identity(),
                    mass: body.mass,
                    columns: [zero; MAX_AXES],
                    velocity: zero,
                    acceleration: [Vector3::zeros(), -self.gravity],
                },
                |parent| links[parent].clone(),
            );
            link.mass = body.mass;
            link.pose *= body.origin;
            let (rotation, place) = (link.pose.rotation, link.pose.translation.vector);
            let moving = match body.motion {
                Motion::Fixed => None,
                Motion::Revolute(joint, axis) => {
                    let direction = rotation * axis.into_inner();
                    link.pose *= UnitQuaternion::from_axis_angle(&axis, q[joint]);
                    Some((joint, [direction, place.cross(&direction)]))
                }
                Motion::Prismatic(joint, axis) => {
                    link.pose *= Translation3::from(axis.into_inner() * q[joint]);
                    Some((joint, [Vector3::zeros(), rotation * axis.into_inner()]))
                }
            };
            if let Some((joint, column)) = moving {
                link.columns[joint] = column;
                add_scaled(&mut link.velocity, &column, v[joint]);
                let ([w, u], [angular, linear]) = (link.velocity, column);
                let derivative = [w.cross(&angular), w.cross(&linear) + u.cross(&angular)];
                add_scaled(&mut link.acceleration, &column, a[joint]);
                add_scaled(&mut link.acceleration, &derivative, v[joint]);
            }
            links.push(link);
        }
        links
    }
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
        let unfolded = Unfolded::new(&model, count, down(), rotors);
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

    /// The power of the efforts is the rate of the energy (central difference): gravity, Coriolis terms and inertia
    /// have the signs and sizes they must have.
    #[test]
    fn effort_is_power(case in cases()) {
        let count = case.motion[0].len();
        let [q, v, a, _] = case.motion.map(|values| joint_vector(values.iter().copied()));
        let mut dynamics = Dynamics::new(&case.model, count, down(), JointVector::zeros()).unwrap();
        let power = dynamics.inverse_dynamics(&q, &v, &a).dot(&v);
        let h = 1e-4;
        let unfolded = Unfolded::new(&case.model, count, down(), JointVector::zeros());
        let energy = |t: f64| unfolded.energy(&(q + v * t + a * (0.5 * t * t)), &(v + a * t));
        let rate = (energy(h) - energy(-h)) / (2.0 * h);
        let scale = 1.0 + energy(0.0).abs();
        prop_assert!((power - rate).abs() < 1e-3 * scale, "{power} W, but the energy grows with {rate} W");
    }

    /// rapier, given the bias efforts, leaves the velocity alone on every tree: same frames, masses and axes.
    #[test]
    fn rapier_agrees_about_the_bias(case in cases()) {
        let count = case.motion[0].len();
        let [q, v, ..] = case.motion.map(|values| joint_vector(values.iter().copied()));
        let zero = JointVector::zeros();
        let mut dynamics = Dynamics::new(&case.model, count, down(), zero).unwrap();
        let mut world = RapierAlone::new(&case.model, (&zero, &q), (1e-3, 1));
        world.set_velocity(&v);
        world.apply_effort(&dynamics.inverse_dynamics(&q, &v, &zero));
        world.step();
        let (position, velocity) = world.motion();
        prop_assert!((velocity - v).amax() < 1e-9, "{velocity} instead of {v}");
        prop_assert!((position - (q + v * 1e-3)).amax() < 1e-12);
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
