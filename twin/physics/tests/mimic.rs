//! Tests of mimic joints.

use nalgebra::{Isometry3, Vector3};
use twin_urdf::{JointDrive, JointKind, Model};

use super::*;

/// A slide of 2 kg along x with axis 0, and on the base next to it a slide of 3 kg upwards and one of 5 kg on that, the first of
/// which follows −2 times and 0.1 m more, and the second half of the first and 0.02 m more: −1·x + 0.07.
fn machine() -> Model {
    let cube = |mass| Some(uniform_box(mass, [0.01, 0.02, 0.03], [0.1; 3]));
    let slide = |axis, x: f64, mass| {
        (JointKind::Prismatic, axis, Isometry3::translation(x, 0.0, 0.0), cube(mass))
    };
    let mut model = chain([
        slide(Vector3::x(), 0.0, 2.0),
        slide(Vector3::z(), 0.5, 3.0),
        slide(Vector3::z(), 0.0, 5.0),
    ]);
    model.joints[1].parent = 0;
    model.joints[1].drive = JointDrive::Mimic { joint: 0, multiplier: -2.0, offset: 0.1 };
    model.joints[2].drive = JointDrive::Mimic { joint: 1, multiplier: 0.5, offset: 0.02 };
    model
}

/// Virtual work: with x the second goes −2, and the third −2 and −1 more.
#[test]
fn what_follows_is_felt() {
    let model = machine();
    let inertia = axis_inertia(&model, &axes([0.3])).unwrap();
    assert!((inertia[0] - (2.0 + 4.0 * 3.0 + 9.0 * 5.0)).abs() < 1e-12, "{inertia:?}");
    let effort = holding_effort(&model, &axes([0.3]));
    assert!((effort[0] + (2.0 * 3.0 + 3.0 * 5.0) * G).abs() < 1e-12, "{effort:?}");
}

/// The bodies are where the model has them, offsets included, all along a fall of exactly constant acceleration.
#[test]
fn bodies_follow() {
    let model = machine();
    let mut machine = started(&model, &[SLACK], down(), &axes([0.0]));
    let acceleration = 21.0 * G / 59.0;
    for step in 1..=200 {
        let state = machine.step_with_efforts(&axes([0.0])).unwrap();
        let time = f64::from(step) * 1e-3;
        let expected = 0.5 * acceleration * time * time;
        assert!((state.position[0] - expected).abs() < 1e-12, "{step}: {state:?} {expected}");
        let x = state.position[0];
        let poses = machine.link_poses();
        let places = [[x, 0.0, 0.0], [0.5, 0.0, 0.1 - 2.0 * x], [0.5, 0.0, 0.17 - 3.0 * x]];
        for (pose, place) in poses[1..].iter().zip(places) {
            let error = (pose.translation.vector - Vector3::from(place)).norm();
            assert!(error < 1e-12, "{step}: {error}");
        }
        for (pose, expected) in poses.iter().zip(model.link_poses(&state.position)) {
            assert!((pose.translation.vector - expected.translation.vector).norm() < 1e-12);
        }
    }
    assert!(machine.axis_state().position[0] > 0.06);
}

#[test]
fn what_follows_nothing_that_moves_is_refused() {
    let mut model = machine();
    model.joints[0].drive = JointDrive::Mimic { joint: 2, multiplier: 1.0, offset: 0.0 };
    let refusal = axis_inertia(&model, &axes([0.0])).unwrap_err();
    assert_eq!(refusal, PhysicsError::CoupledJoint(0));
}
