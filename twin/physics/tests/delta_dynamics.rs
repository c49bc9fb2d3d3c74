//! Tests of the closed-form delta dynamics against the general tripod and against the closed loops of its links.

use proptest::prelude::*;
use twin_kinematics::tripod::{Rod, TripodDeviations};
use twin_urdf::{JointPositions, MachineJoint, TripodDimensions};

use super::parallel::{NAMES, generated, rings};
use super::*;
use crate::passive::PassiveJoints;
use crate::tripod::TripodDynamics;

/// The tripod that `rods` are, with parts of different masses, which does not matter for the platform.
fn uneven(rods: &[Rod; 6], masses: [f64; 5]) -> Model {
    let joints = [2, 0, 1].map(|axis| MachineJoint::new(NAMES[axis], axis, [0.25, 0.45]));
    let [carriage, rod, platform, lighter, further] = masses;
    let dimensions = TripodDimensions {
        carriage_mass: Some(carriage),
        rod_mass: Some(rod),
        platform_mass: Some(platform),
        ..TripodDimensions::new("tripod", joints, *rods)
    };
    let mut model = dimensions.model().unwrap();
    let mut rods = model
        .links
        .iter_mut()
        .filter(|link| link.name.starts_with("rod") && link.inertial.is_some());
    let body = rods.nth(3).unwrap().inertial.as_mut().unwrap();
    body.mass *= lighter;
    body.center.z *= further;
    let body = model.links[1].inertial.as_mut().unwrap();
    body.mass += lighter;
    model
}

/// Axes within reach of one another.
fn places() -> impl Strategy<Value = JointVector> {
    prop::array::uniform3(0.25..0.45_f64).prop_map(joints)
}

fn motions() -> impl Strategy<Value = JointVector> {
    prop::array::uniform3(-2.0..2.0_f64).prop_map(joints)
}

proptest! {
    /// Accelerations, mobility and efforts are the same to rounding, rotors, odd masses and oblique gravity included.
    #[test]
    fn pairs_of_rods_are_the_same_machine(
        (position, velocity, acceleration) in (places(), motions(), motions()),
        masses in prop::array::uniform5(0.2..2.0_f64),
        rotors in prop::array::uniform3(0.0..3.0_f64),
        sideways in prop::array::uniform2(-5.0..5.0_f64),
    ) {
        let model = uneven(&rings().rods(&TripodDeviations::default()).unwrap(), masses);
        let gravity = Vector3::new(sideways[0], sideways[1], -G);
        let mut closed = TripodDynamics::new(&model, 3, gravity, joints(rotors)).unwrap();
        prop_assert!(closed.is_closed());
        let mut general = closed.clone();
        general.separate_rods();

        let effort = general.inverse_dynamics(&position, &velocity, &acceleration).unwrap();
        let scale = effort.amax().max(1.0);
        let found = closed.inverse_dynamics(&position, &velocity, &acceleration).unwrap();
        prop_assert!((found - effort).amax() < 1e-12 * scale, "{found} is not {effort}");
        let back = closed.acceleration(&position, &velocity, &effort).unwrap();
        prop_assert!((back - acceleration).amax() < 1e-11 * scale, "{back} is not {acceleration}");
        let expected = general.acceleration_and_mobility(&position, &velocity, &effort).unwrap();
        let found = closed.acceleration_and_mobility(&position, &velocity, &effort).unwrap();
        prop_assert!((found.0 - back).amax() < 1e-12 * scale);
        let difference = (found.1 - expected.1).amax();
        prop_assert!(difference < 1e-12 * expected.1.amax(), "{difference} of {}", expected.1);
    }

    /// An additional axis moves as it would alone, at any place among the axes.
    #[test]
    fn axes_beside_it_are_beside_it(
        (position, velocity, effort) in (places(), motions(), motions()),
        number in 0..4_usize,
        rotor in 0.0..2.0_f64,
        additional in prop::array::uniform3(-2.0..2.0_f64),
    ) {
        let mut model = generated(&TripodDeviations::default());
        let alone = chain([(JointKind::Prismatic, Vector3::new(0.3, 0.0, 1.0), Isometry3::identity(), Some(uniform_box(2.0, [0.0; 3], [0.1; 3])))]);
        let joint = Joint { child: model.links.len(), drive: JointDrive::Axis(number), ..alone.joints[0].clone() };
        model.links.push(alone.links[1].clone());
        model.joints.push(joint);
        let others: Vec<usize> = (0..4).filter(|axis| *axis != number).collect();
        for joint in &mut model.joints[..3] {
            let axis = joint.drive.axis().unwrap();
            joint.drive = JointDrive::Axis(others[axis]);
        }
        let spread = |values: &JointVector, own: f64| {
            let mut result = JointVector::zeros();
            for (axis, other) in others.iter().enumerate() {
                result[*other] = values[axis];
            }
            result[number] = own;
            result
        };
        let zero = JointVector::zeros();
        let mut tripod = TripodDynamics::new(&generated(&TripodDeviations::default()), 3, down(), zero).unwrap();
        let mut slide = Dynamics::new(&alone, 1, down(), joints([rotor])).unwrap();
        let mut both = TripodDynamics::new(&model, 4, down(), spread(&zero, rotor)).unwrap();
        prop_assert!(both.is_closed());
        let [q, v, f] = additional;
        let slid = slide.acceleration(&joints([q]), &joints([v]), &joints([f])).unwrap();
        let moved = tripod.acceleration(&position, &velocity, &effort).unwrap();
        let (q, v, f) = (spread(&position, q), spread(&velocity, v), spread(&effort, f));
        let expected = spread(&moved, slid[0]);
        let found = both.acceleration(&q, &v, &f).unwrap();
        prop_assert!((found - expected).amax() < 1e-13 * expected.amax().max(1.0), "{found}, {expected}");
        let back = both.inverse_dynamics(&q, &v, &found).unwrap();
        prop_assert!((back - f).amax() < 1e-11, "{back}, {f}");
        let mut general = both.clone();
        general.separate_rods();
        let apart = general.acceleration(&q, &v, &f).unwrap();
        prop_assert!((apart - expected).amax() < 1e-11 * expected.amax().max(1.0), "{apart}, {expected}");
    }

    /// Every passive joint is where it closes the loops, tilting platforms included.
    #[test]
    fn passive_joints_close_the_loops(
        position in places(),
        made in prop_oneof![Just(0.0), Just(1.0)],
        deviations in prop::array::uniform6(-2e-3..2e-3_f64),
        turned in prop::array::uniform3(-0.02..0.02_f64),
    ) {
        let model = generated(&TripodDeviations {
            rod_lengths: deviations.map(|deviation| made * deviation),
            tower_angles: turned.map(|angle| made * angle),
            ..TripodDeviations::default()
        });
        let tripod = TripodDynamics::new(&model, 3, down(), JointVector::zeros()).unwrap();
        let axes = [0, 1, 2].map(|axis| position[axis]);
        let Ok(platform) = tripod.platform(&position) else { return Ok(()) };
        let mut sought = JointPositions::at_rest(&model);
        prop_assume!(sought.follow(&model, &axes).is_ok());
        let mut values = sought.values().to_vec();
        for (value, joint) in values.iter_mut().zip(&model.joints) {
            if matches!(joint.drive, JointDrive::Passive { .. }) {
                *value = f64::NAN;
            }
        }
        PassiveJoints::of(&model).unwrap().follow(&axes, &platform, &mut values);
        let poses = [sought.values(), &values].map(|values| {
            let mut poses = vec![Isometry3::identity(); model.links.len()];
            model.link_poses_at(values, &mut poses);
            poses
        });
        for (one, other) in poses[0].iter().zip(&poses[1]) {
            let shift = (one.translation.vector - other.translation.vector).norm();
            let turn = one.rotation.angle_to(&other.rotation);
            prop_assert!(shift < 1e-12 && turn < 1e-7, "{shift} m, {turn} rad");
        }
        for closing in &model.loops {
            let [one, other] = [0, 1].map(|side| poses[1][closing.links[side]] * closing.points[side]);
            prop_assert!((one - other).norm() < 1e-13, "{} m", (one - other).norm());
        }
    }
}

/// Where the rods do not meet, or would have to point up, there is no machine.
#[test]
fn no_motion_where_no_platform_can_be() {
    let model = generated(&TripodDeviations::default());
    let mut dynamics = TripodDynamics::new(&model, 3, down(), JointVector::zeros()).unwrap();
    let zero = JointVector::zeros();
    let there = joints([0.35; 3]);
    assert!(dynamics.acceleration(&there, &zero, &zero).is_some());
    for position in [[0.0, 0.0, 2.0], [0.0, 0.6, 0.6], [f64::NAN, 0.35, 0.35]] {
        assert_eq!(dynamics.acceleration(&joints(position), &zero, &zero), None, "{position:?}");
        assert_eq!(dynamics.inverse_dynamics(&joints(position), &zero, &zero), None);
    }
}
