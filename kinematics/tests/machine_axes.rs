//! Tests of whole machines: order of axes, coordinates without a transform, and refused combinations.

use super::seeded;
use crate::gantry::Gantry3;
use crate::scara::{Elbow, Scara2};
use crate::{
    AxisSource, AxisVector, Coordinate, Kinematics, KinematicsError, MachineAxes, MachineAxesError,
    Pose, ToolMotion, Transform,
};
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;

const A: AxisSource = AxisSource::Transform(0);
const B: AxisSource = AxisSource::Transform(1);
const Z: AxisSource = AxisSource::Coordinate(Coordinate::Z);

fn scara() -> Scara2 {
    Scara2::new([0.25, 0.2], [0.1, -0.2], Elbow::Low).unwrap()
}

/// A tool straight down.
fn down(length: f64) -> Vector3<f64> {
    Vector3::new(0.0, 0.0, -length)
}

fn made(sources: &[AxisSource], tool_length: f64) -> Result<MachineAxes, MachineAxesError> {
    MachineAxes::new(Box::new(scara()), sources.to_vec(), down(tool_length))
}

fn machine(sources: &[AxisSource], tool_length: f64) -> MachineAxes {
    made(sources, tool_length).unwrap()
}

#[test]
fn axes_come_in_the_order_of_the_machine_file() {
    let [a, b] = scara().to_axes(&Vector2::new(0.3, 0.2)).unwrap().into();
    let pose = Pose::at(0.3, 0.2, -0.05);
    for (sources, expected) in
        [([A, B, Z], [a, b, 0.07]), ([Z, B, A], [0.07, b, a]), ([B, Z, A], [b, 0.07, a])]
    {
        // A tool of 120 mm whose tip is at −50 mm hangs on a flange at 70 mm.
        let machine = machine(&sources, 0.12);
        assert_eq!(machine.axis_count(), 3);
        assert_eq!(machine.coordinates(), Coordinate::TRANSLATIONS);
        let found = machine.inverse(&pose, &AxisVector::zeros(3)).unwrap();
        let off = [0, 1, 2].map(|axis| (found[axis] - expected[axis]).abs());
        assert!(off.iter().all(|off| *off < 1e-15), "{found:?}");
        let back = machine.forward(&found).unwrap();
        assert!((back.position - pose.position).norm() < 1e-15, "{back:?}");
    }
}

#[test]
fn motion_reaches_every_axis() {
    let mut tool = ToolMotion::at_rest(Pose::at(0.3, 0.2, -0.05));
    tool.velocity = Vector3::new(0.1, -0.2, 0.3);
    tool.acceleration = Vector3::new(1.0, 2.0, -3.0);
    let mut flat = tool;
    flat.pose.position.z = 0.0;
    let expected = scara().inverse_motion(&flat, &AxisVector::zeros(2)).unwrap();
    let found = machine(&[B, Z, A], 0.12).inverse_motion(&tool, &AxisVector::zeros(3)).unwrap();
    let [a, b] = [0, 1].map(|axis| (expected.velocity[axis], expected.acceleration[axis]));
    assert_eq!(*found.velocity, [b.0, 0.3, a.0]);
    assert_eq!(*found.acceleration, [b.1, -3.0, a.1]);
    assert!((found.position[1] - 0.07).abs() < 1e-16);
}

#[test]
fn near_reaches_the_transform_in_its_order() {
    let turn = std::f64::consts::TAU;
    let machine = machine(&[Z, B, A], 0.0);
    let pose = Pose::at(0.3, 0.2, 0.0);
    let base = machine.inverse(&pose, &AxisVector::zeros(3)).unwrap();
    let near = AxisVector::from_values([0.0, base[1] - turn, base[2] + turn]);
    let found = machine.inverse(&pose, &near).unwrap();
    assert!((found[1] - near[1]).abs() < 1e-14 && (found[2] - near[2]).abs() < 1e-14, "{found:?}");
}

#[test]
fn a_coordinate_without_an_axis_stays_at_zero() {
    let machine = machine(&[A, B], 0.0);
    let near = AxisVector::zeros(2);
    assert_eq!(machine.coordinates(), [Coordinate::X, Coordinate::Y]);
    assert!(machine.inverse(&Pose::at(0.3, 0.2, 0.9e-9), &near).is_ok());
    let error = machine.inverse(&Pose::at(0.3, 0.2, -0.005), &near).unwrap_err();
    assert_eq!(error, KinematicsError::NoAxis { coordinate: Coordinate::Z, value: -0.005 });
    assert_eq!(error.to_string(), "Z = -5.000 mm is asked for, but no axis of the machine moves Z");
}

#[test]
fn errors_speak_of_the_tool_tip() {
    let machine = machine(&[A, B, Z], 0.12);
    let near = AxisVector::zeros(3);
    let error = machine.inverse(&Pose::at(0.4, 0.3, -0.05), &near).unwrap_err();
    let KinematicsError::Unreachable { target: [0.4, 0.3, -0.05], .. } = error else {
        panic!("{error:?}");
    };
    let mut tool = ToolMotion::at_rest(Pose::at(0.45, 0.0, -0.05));
    tool.velocity.x = -0.1;
    let error = machine.inverse_motion(&tool, &near).unwrap_err();
    assert_eq!(error, KinematicsError::Singular([0.45, 0.0, -0.05]));
    // Z alone can move with stretched arms.
    tool.velocity = Vector3::new(0.0, 0.0, 0.1);
    let motion = machine.inverse_motion(&tool, &near).unwrap();
    assert!((motion.velocity[2] - 0.1).abs() < 1e-15, "{motion:?}");
}

#[test]
fn refuses_the_wrong_number_of_values() {
    let machine = machine(&[A, B, Z], 0.0);
    let error = KinematicsError::AxisCount { given: 2, expected: 3 };
    assert_eq!(machine.forward(&AxisVector::zeros(2)), Err(error));
    assert_eq!(machine.inverse(&Pose::at(0.3, 0.2, 0.0), &AxisVector::zeros(2)), Err(error));
    let lost = AxisVector::from_values([0.0, 0.0, f64::NAN]);
    assert_eq!(machine.forward(&lost), Err(KinematicsError::NotFinite));
}

#[test]
fn refuses_axes_that_do_not_fit_the_transform() {
    let (x, u) = (AxisSource::Coordinate(Coordinate::X), AxisSource::Additional(3));
    let third = MachineAxesError::NoSuchOutput { output: 2, outputs: 2 };
    for (sources, tool_length, expected) in [
        (&[A, Z][..], 0.0, MachineAxesError::OutputWithoutAxis(1)),
        (&[A, B, A], 0.0, MachineAxesError::OutputTwice(0)),
        (&[A, B, Z, Z], 0.0, MachineAxesError::CoordinateTwice(Coordinate::Z)),
        (&[A, B, x], 0.0, MachineAxesError::CoordinateOfTransform(Coordinate::X)),
        (&[A, B, u, u], 0.0, MachineAxesError::AdditionalTwice(3)),
        (&[A, B, AxisSource::Transform(2)], 0.0, third),
        (&[A; 9], 0.0, MachineAxesError::TooMany(9)),
        (&[A, B], 0.1, MachineAxesError::ToolWithoutZ(0.1)),
        (&[A, B, Z], f64::NAN, MachineAxesError::Tool),
    ] {
        assert_eq!(made(sources, tool_length).unwrap_err(), expected);
    }
    let message = "output 3 of the transform is assigned to an axis, but the transform has 2";
    assert_eq!(third.to_string(), message);
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn gantry_forward_undoes_inverse(
        offset in prop::array::uniform3(-2.0..2.0), target in prop::array::uniform3(-2.0..2.0),
        tool_length in 0.0..0.5, swapped in any::<bool>(),
    ) {
        let mut sources: Vec<_> = (0..3).map(AxisSource::Transform).collect();
        if swapped {
            sources.swap(0, 2);
        }
        let machine = MachineAxes::new(Box::new(Gantry3::new(offset).unwrap()), sources, down(tool_length)).unwrap();
        let pose = Pose::at(target[0], target[1], target[2]);
        let found = machine.inverse(&pose, &AxisVector::zeros(3)).unwrap();
        let z = found[if swapped { 0 } else { 2 }];
        prop_assert!((z - (target[2] + tool_length + offset[2])).abs() < 1e-14);
        let back = machine.forward(&found).unwrap();
        prop_assert!((back.position - pose.position).norm() < 1e-14);
    }
}
