//! Tests of generated machines against the closed forms of their transforms.

pub(super) mod gantry;
mod scara3;
pub(super) mod tripod;

use super::{gantry, scara, seeded};
use crate::{
    DimensionError, Joint, JointKind, MachineJoint, Model, PlaneDrive, ScaraDimensions, SolidShape,
};
use nalgebra::{Isometry3, Point3, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::{AxisSource, AxisVector, Coordinate, Kinematics, MachineAxes};

/// Lower and upper corner of the box around a solid of a link at `pose`.
fn around(pose: &Isometry3<f64>, solid: &crate::Solid) -> [Point3<f64>; 2] {
    let pose = pose * solid.origin;
    let matrix = pose.rotation.to_rotation_matrix();
    let upright = (matrix.matrix()[(2, 2)].abs() - 1.0).abs() < 1e-12;
    let half = match &solid.shape {
        SolidShape::Box { size } => matrix.matrix().abs() * size / 2.0,
        // However it is turned about its own axis.
        SolidShape::Cylinder { radius, length } if upright => {
            Vector3::new(*radius, *radius, length / 2.0)
        }
        SolidShape::Cylinder { radius, length } => {
            matrix.matrix().abs() * Vector3::new(*radius, *radius, length / 2.0)
        }
        SolidShape::Sphere { radius } => Vector3::repeat(*radius),
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

fn corners(model: &Model) -> Vec<Vec<f64>> {
    let limits = |joint: &Joint| joint.position_limits.unwrap();
    let limits: Vec<_> = model.moving_joints().map(|(_, joint)| limits(joint)).collect();
    let count = 1 << limits.len();
    (0..count)
        .map(|corner| {
            limits.iter().enumerate().map(|(i, limit)| limit[(corner >> i) & 1]).collect()
        })
        .collect()
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
        assert!(
            (quill[0] - (axes[2] - 0.08)).abs() < 1e-15 && quill[0] > base[0],
            "{quill:?} {base:?}"
        );
        assert!(model.tip_position(&axes).z >= base[0] + 0.0199);
    }
    let lowest = model.link_poses(&[0.0, 0.0, -0.1])[3] * Point3::origin();
    let shaft_top = heights(&bounds(&model, 3, &[0.0, 0.0, -0.1]))[1];
    let arm2_beam = bounds(&model, 2, &[0.0; 3])[0];
    assert!(
        (lowest.z + 0.1).abs() < 1e-15 && shaft_top > arm2_beam[1].z,
        "{shaft_top} {arm2_beam:?}"
    );
}

/// The gantry test would notice parts that meet.
#[test]
fn parts_that_meet_are_noticed() {
    let model = gantry().model().unwrap();
    let quill_in_table = bounds(&model, 3, &[0.3, 0.0, -0.25]);
    assert!(meet(&bounds(&model, 0, &[0.0; 3]), &quill_in_table));
}

#[test]
fn joints_are_the_axes_of_the_machine() {
    let effort = |joint: MachineJoint| MachineJoint {
        effort_limit: Some(40.0),
        velocity_limit: Some(3.0),
        ..joint
    };
    let mut dimensions = scara();
    dimensions.arm_joints = dimensions.arm_joints.map(effort);
    dimensions.arm_joints[0].machine_axis = 2;
    dimensions.quill_joint.as_mut().unwrap().machine_axis = 0;
    let model = dimensions.model().unwrap();
    let found: Vec<_> = model
        .moving_joints()
        .map(|(index, joint)| (index, joint.name.as_str(), joint.drive.axis()))
        .collect();
    assert_eq!(found, [(0, "A", Some(2)), (1, "B", Some(1)), (2, "Z", Some(0))]);
    let [a, _, z] = &model.joints[..] else { panic!() };
    assert_eq!(
        (a.position_limits, a.velocity_limit, a.effort_limit),
        (Some([-2.5, 2.5]), Some(3.0), Some(40.0))
    );
    assert_eq!((z.kind, z.effort_limit), (JointKind::Prismatic, None));
    // Z first: axis 0 is 10 mm up.
    assert!((model.tip_position(&[0.01, 0.0, 0.0]) - Point3::new(0.45, 0.0, -0.07)).norm() < 1e-15);
}

#[test]
fn a_scara_without_a_z_axis_works_in_one_plane() {
    let dimensions =
        ScaraDimensions { quill_joint: None, tool: Vector3::zeros(), tool_mass: 0.0, ..scara() };
    let model = dimensions.model().unwrap();
    assert_eq!(model.moving_joints().count(), 2);
    assert_eq!(model.joints[2].kind, JointKind::Fixed);
    assert!((model.tip_position(&[0.0, 0.0]) - Point3::new(0.45, 0.0, 0.0)).norm() < 1e-15);
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
        let expected =
            [w * w + h * h, l * l + h * h, l * l + w * w].map(|square| mass / 12.0 * square);
        assert!(
            (inertial.inertia.diagonal() - Vector3::from(expected)).norm() < 1e-16,
            "{inertial:?}"
        );
    }
    // The derived sections are those, give or take 5 mm, and the derived masses follow from them.
    let derived = ScaraDimensions { arms: [0.4, 0.3], ..scara() }.model().unwrap();
    assert!((derived.links[1].inertial.unwrap().mass - 8.0).abs() < 1e-12);
}

#[test]
fn every_moving_link_is_a_possible_body() {
    let models = [
        scara().model(),
        scara3::scara3().model(),
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
            assert!(
                moments.min() > 0.0 && 2.0 * moments.max() <= moments.sum() * (1.0 + 1e-12),
                "{link:?}"
            );
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
    let refusal = |dimensions: ScaraDimensions| dimensions.model().unwrap_err().to_string();
    let arms = ScaraDimensions { arms: [0.25, -0.2], ..scara() };
    assert_eq!(refusal(arms), "the length of arm 2 is -0.2; it must be a finite number above 0");
    let quill = ScaraDimensions { quill_radius: Some(f64::NAN), ..scara() };
    assert_eq!(
        refusal(quill),
        "the radius of the quill is NaN; it must be a finite number above 0"
    );
    let tool = ScaraDimensions { tool: Vector3::new(0.0, 0.0, 0.01), ..scara() };
    assert_eq!(
        refusal(tool),
        "the length of the tool is -0.01; it must be a finite number, 0 or above"
    );
    let offset = ScaraDimensions { offsets: [0.0, f64::INFINITY], ..scara() };
    assert_eq!(refusal(offset), "an offset is not a finite number");
    let mut twice = gantry();
    twice.quill_joint.as_mut().unwrap().name = "X".to_owned();
    let joints = ["X".to_owned(), "X".to_owned()];
    assert_eq!(twice.model(), Err(DimensionError::JointTwice(joints)));
    let mut shared = gantry();
    shared.quill_joint.as_mut().unwrap().machine_axis = 1;
    assert_eq!(
        shared.model().unwrap_err().to_string(),
        "joints Y and Z have the same name or the same machine axis"
    );
    let mut stuck = gantry();
    let PlaneDrive::Axes([x, _]) = &mut stuck.plane else { panic!() };
    x.position_limits = [0.5, 0.5];
    assert!(stuck.model().unwrap_err().to_string().contains("joint X can move from 0.5 to 0.5"));
}

proptest! {
    #![proptest_config(seeded())]

    /// The chain of joints and the transform are two ways to the same tool tip.
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
        let tip = model.tip_position(&position);
        prop_assert!((tip - expected).norm() < 1e-14, "{tip} {expected}");
        let poses = model.link_poses(&position);
        prop_assert!((poses[model.tip.link] * model.tip.point - expected).norm() < 1e-14);
        prop_assert_eq!(poses[0], Isometry3::identity());
    }
}
