//! Tests of generated machines against the closed forms of their transforms.

pub(super) mod gantry;
pub(super) mod scara3;
pub(super) mod tripod;

use super::{assert_near, gantry, scara, seeded};
use crate::{DimensionError, JointKind, Model, ScaraDimensions, ScaraHand, SolidShape};
use nalgebra::{Isometry3, Point3, Vector3};
use proptest::prelude::*;
use scara3::scara3;
use std::f64::consts::PI;
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::{AxisSource, AxisVector, Coordinate, Kinematics, MachineAxes};

/// Lower and upper corner of the box around a solid of a link at `pose`.
fn around(pose: &Isometry3<f64>, solid: &crate::Solid) -> [Point3<f64>; 2] {
    let pose = pose * solid.origin;
    let matrix = pose.rotation.to_rotation_matrix();
    let turned = matrix.matrix().abs();
    let upright = (turned[(2, 2)] - 1.0).abs() < 1e-12;
    let half = match solid.shape {
        SolidShape::Box { size } => turned * size / 2.0,
        SolidShape::Cylinder { radius, length } => {
            let half = Vector3::new(radius, radius, length / 2.0);
            // However it is turned about its own axis.
            if upright { half } else { turned * half }
        }
        SolidShape::Sphere { radius } => Vector3::repeat(radius),
        SolidShape::Capsule { .. } | SolidShape::Mesh { .. } => panic!("not generated"),
    };
    let center = Point3::from(pose.translation.vector);
    [center - half, center + half]
}

/// Lower and upper corner of the boxes around what a link fills when the machine's axes are at `axes`.
fn bounds(model: &Model, link: usize, axes: &[f64]) -> Vec<[Point3<f64>; 2]> {
    let pose = model.link_poses(axes)[link];
    model.links[link].solids.iter().map(|solid| around(&pose, solid)).collect()
}

/// True if any solids of two links meet.
fn meet(one: &[[Point3<f64>; 2]], other: &[[Point3<f64>; 2]]) -> bool {
    let apart = |a: &[Point3<f64>; 2], b: &[Point3<f64>; 2]| {
        (0..3).any(|i| a[1][i] < b[0][i] || b[1][i] < a[0][i])
    };
    one.iter().any(|a| other.iter().any(|b| !apart(a, b)))
}

/// Lowest and highest point.
fn heights(solids: &[[Point3<f64>; 2]]) -> [f64; 2] {
    let low = solids.iter().map(|solid| solid[0].z).fold(f64::INFINITY, f64::min);
    let high = solids.iter().map(|solid| solid[1].z).fold(f64::NEG_INFINITY, f64::max);
    [low, high]
}

/// The corners of these ranges, the first one changing fastest.
fn corners_of(limits: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let axis = |corner: usize, i: usize| limits[i][(corner >> i) & 1];
    let corner = |corner| (0..limits.len()).map(|i| axis(corner, i)).collect();
    (0..1 << limits.len()).map(corner).collect()
}

fn corners(model: &Model) -> Vec<Vec<f64>> {
    let limits = model.moving_joints().map(|(_, joint)| joint.position_limits.unwrap());
    corners_of(&limits.collect::<Vec<_>>())
}

/// Asserts that dimensions are refused with this message, or with one that begins like this where it ends in an ellipsis.
#[track_caller]
fn assert_refused(model: Result<Model, DimensionError>, said: &str) {
    let refusal = model.unwrap_err().to_string();
    match said.strip_suffix('…') {
        Some(start) => assert!(refusal.starts_with(start), "{refusal}"),
        None => assert_eq!(refusal, said),
    }
}

#[test]
fn a_scara_stands_over_its_work() {
    let model = scara().model().unwrap();
    let names: Vec<_> = model.links.iter().map(|link| link.name.as_str()).collect();
    assert_eq!(names, ["base", "arm1", "arm2", "quill"]);
    for axes in corners(&model) {
        let [base, arm1, arm2, quill] =
            [0, 1, 2, 3].map(|link| heights(&bounds(&model, link, &axes)));
        assert!(base[1] < arm1[0] && arm1[1] < arm2[0], "{base:?} {arm1:?} {arm2:?}");
        // The flange, which is where Z is, below arm 2; the shaft out of its top; the tool above the floor.
        assert!(axes[2] < arm2[0] && quill[1] > axes[2] + 0.15, "{quill:?} {arm2:?}");
        let tip = axes[2] - 0.08;
        assert!((quill[0] - tip).abs() < 1e-15 && tip > base[0], "{quill:?} {base:?}");
        assert!(model.tip_position(&axes).z >= base[0] + 0.0199);
    }
    let lowest = model.link_poses(&[0.0, 0.0, -0.1])[3] * Point3::origin();
    let shaft_top = heights(&bounds(&model, 3, &[0.0, 0.0, -0.1]))[1];
    let beam = bounds(&model, 2, &[0.0; 3])[0];
    assert!((lowest.z + 0.1).abs() < 1e-15 && shaft_top > beam[1].z, "{shaft_top} {beam:?}");
}

#[test]
fn joints_are_the_axes_of_the_machine() {
    let mut dimensions = scara();
    let a = &mut dimensions.arm_joints[0];
    (a.effort_limit, a.velocity_limit, a.machine_axis) = (Some(40.0), Some(3.0), 2);
    dimensions.quill_joint.as_mut().unwrap().machine_axis = 0;
    let model = dimensions.model().unwrap();
    let joints = model.moving_joints();
    let found = joints.map(|(index, joint)| (index, joint.name.as_str(), joint.drive.axis()));
    let expected = [(0, "A", Some(2)), (1, "B", Some(1)), (2, "Z", Some(0))];
    assert_eq!(found.collect::<Vec<_>>(), expected);
    let [a, _, z] = &model.joints[..] else { panic!() };
    assert_eq!(a.position_limits, Some([-2.5, 2.5]));
    assert_eq!((a.velocity_limit, a.effort_limit), (Some(3.0), Some(40.0)));
    assert_eq!((z.kind, z.effort_limit), (JointKind::Prismatic, None));
    // Z first: axis 0 is 10 mm up.
    assert_near(model.tip_position(&[0.01, 0.0, 0.0]), [0.45, 0.0, -0.07], 1e-15);
}

#[test]
fn a_scara_without_a_z_axis_works_in_one_plane() {
    let dimensions =
        ScaraDimensions { quill_joint: None, tool: Vector3::zeros(), tool_mass: 0.0, ..scara() };
    let model = dimensions.model().unwrap();
    assert_eq!(model.moving_joints().count(), 2);
    assert_eq!(model.joints[2].kind, JointKind::Fixed);
    assert_near(model.tip_position(&[0.0, 0.0]), [0.45, 0.0, 0.0], 1e-15);
}

/// Arms of 0.4 and 0.3 m, 8 and 4 kg, sections 100 × 80 and 80 × 60 mm: the uniform boxes of the reference machine.
#[test]
fn arms_are_uniform_boxes() {
    let dimensions = ScaraDimensions {
        arms: [0.4, 0.3],
        arm_sections: Some([[0.1, 0.08], [0.08, 0.06]]),
        arm_masses: Some([8.0, 4.0]),
        ..scara()
    };
    let model = dimensions.model().unwrap();
    for (link, mass, [l, w, h]) in
        [(1, 8.0, [0.4_f64, 0.1_f64, 0.08_f64]), (2, 4.0, [0.3, 0.08, 0.06])]
    {
        let inertial = model.links[link].inertial.unwrap();
        assert_eq!((inertial.mass, inertial.center), (mass, Point3::new(l / 2.0, 0.0, 0.0)));
        let expected = Vector3::new(w * w + h * h, l * l + h * h, l * l + w * w) * (mass / 12.0);
        assert!((inertial.inertia.diagonal() - expected).norm() < 1e-16, "{inertial:?}");
    }
    // The derived sections are those, give or take 5 mm, and the derived masses follow from them.
    let derived = ScaraDimensions { arms: [0.4, 0.3], ..scara() }.model().unwrap();
    assert!((derived.links[1].inertial.unwrap().mass - 8.0).abs() < 1e-12);
}

#[test]
fn every_moving_link_is_a_possible_body() {
    let models = [
        scara().model(),
        scara3().model(),
        gantry().model(),
        gantry::cutter().model(),
        gantry::h_gantry().model(),
        tripod::tripod().model(),
    ];
    for model in models.map(Result::unwrap) {
        assert!(model.links[0].inertial.is_none());
        for link in &model.links[1..] {
            // The crosses of ball joints are only joints.
            let Some(inertial) = link.inertial else {
                assert!(link.solids.is_empty() && model.loops.len() == 5, "{link:?}");
                continue;
            };
            let moments = inertial.inertia.symmetric_eigenvalues();
            assert!(inertial.mass > 0.01 && inertial.mass < 100.0, "{link:?}");
            let possible = 2.0 * moments.max() <= moments.sum() * (1.0 + 1e-12);
            assert!(moments.min() > 0.0 && possible, "{link:?}");
            // The centre of mass lies within the box around the link.
            let boxes = link.solids.iter().map(|solid| around(&Isometry3::identity(), solid));
            let [low, high] =
                boxes.reduce(|a, b| [a[0].inf(&b[0]), a[1].sup(&b[1])]).expect("it has solids");
            let center = inertial.center;
            assert!((0..3).all(|i| low[i] <= center[i] && center[i] <= high[i]), "{link:?}");
        }
    }
}

#[test]
fn impossible_dimensions_are_named() {
    let refused = |change: fn(&mut ScaraDimensions), said: &str| {
        let mut dimensions = scara();
        change(&mut dimensions);
        assert_refused(dimensions.model(), said);
    };
    refused(
        |d| d.arms[1] = -0.2,
        "the length of arm 2 is -0.2; it must be a finite number above 0",
    );
    refused(|d| d.quill_radius = Some(f64::NAN), "the radius of the quill is NaN; it must be …");
    let length = "the length of the tool is -0.01; it must be a finite number, 0 or above";
    refused(|d| d.tool.z = 0.01, length);
    refused(|d| d.offsets[1] = f64::INFINITY, "an offset is not a finite number");
    let hand = |change: fn(&mut ScaraHand), said: &str| {
        let mut dimensions = scara3();
        change(dimensions.hand.as_mut().unwrap());
        assert_refused(dimensions.model(), said);
    };
    hand(|hand| hand.length = -0.1, "the length of the hand is -0.1; …");
    hand(|hand| hand.mass = Some(f64::NAN), "the mass of the hand is NaN; …");
    hand(|hand| hand.offset = f64::NAN, "an offset is not a finite number");
    hand(|hand| hand.joint.machine_axis = 1, "joints …");
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn the_tip_of_a_scara_is_where_its_transform_says(
        arms in prop::array::uniform2(0.1..0.8), offsets in prop::array::uniform2(-PI..PI), tool_length in 0.0_f64..0.3,
        position in [-PI..PI, -PI..PI, -0.1..0.05], low in any::<bool>(),
    ) {
        let model = ScaraDimensions { arms, offsets, tool: Vector3::new(0.0, 0.0, -tool_length), ..scara() }.model().unwrap();
        let elbow = if low { Elbow::Low } else { Elbow::High };
        let sources = vec![AxisSource::Transform(0), AxisSource::Transform(1), AxisSource::Coordinate(Coordinate::Z)];
        let transform = Box::new(Scara2::new(arms, offsets, elbow).unwrap());
        let machine = MachineAxes::new(transform, sources, -Vector3::z() * tool_length).unwrap();
        let expected = machine.forward(&AxisVector::from_values(position)).unwrap().position;
        assert_near(model.tip_position(&position), expected, 1e-14);
        let poses = model.link_poses(&position);
        assert_near(poses[model.tip.link] * model.tip.point, expected, 1e-14);
        prop_assert_eq!(poses[0], Isometry3::identity());
    }
}
