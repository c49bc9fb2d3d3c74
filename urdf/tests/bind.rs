//! Tests of binding a loaded model to machine axes.

use super::seeded;
use crate::{AxisJoint, BindError, JointDrive, JointKind, Model, UrdfOptions};
use nalgebra::{Isometry3, Point3, Vector3};
use proptest::prelude::*;
use std::path::Path;

/// Two arms of 1 m, a quill that goes down when its joint goes up, a gripper of two fingers of which one mimics the other.
fn robot() -> Model {
    let joint = |name: &str, kind: &str, parent: &str, child: &str, origin: &str, more: &str| {
        format!(
            "<link name='{child}'/><joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>\
             <origin {origin}/>{more}</joint>"
        )
    };
    let limited = |axis: &str, lower: f64, upper: f64| {
        format!(
            "<axis xyz='{axis}'/><limit lower='{lower}' upper='{upper}' velocity='1' effort='1'/>"
        )
    };
    let text = [
        "<robot name='r'><link name='base'/>".to_owned(),
        joint("j1", "revolute", "base", "arm1", "", &limited("0 0 1", -2.0, 2.0)),
        joint("j2", "revolute", "arm1", "arm2", "xyz='1 0 0'", &limited("0 0 1", -2.5, 2.5)),
        joint("j3", "prismatic", "arm2", "quill", "xyz='1 0 0'", &limited("0 0 -1", 0.0, 0.3)),
        joint("left", "prismatic", "quill", "finger1", "", &limited("0 1 0", 0.0, 0.02)),
        joint(
            "right",
            "prismatic",
            "quill",
            "finger2",
            "",
            &(limited("0 1 0", -0.1, 0.1) + "<mimic joint='left' multiplier='-1' offset='0.001'/>"),
        ),
        joint("flange", "fixed", "quill", "tcp", "xyz='0 0 -0.1'", ""),
        "</robot>".to_owned(),
    ];
    let options = UrdfOptions { tip_link: Some("tcp".to_owned()), ..UrdfOptions::default() };
    Model::read_urdf(&text.concat(), Path::new(""), &options).unwrap().model
}

fn axis(machine_axis: usize, joint: &str, reversed: bool, offset: f64) -> AxisJoint {
    AxisJoint { machine_axis, joint: joint.to_owned(), reversed, offset }
}

proptest! {
    #![proptest_config(seeded())]

    /// Joint = ± axis + offset, with any followers and any base.
    #[test]
    fn joints_are_where_their_axes_put_them(
        q in [-1.0..1.0, -1.0..1.0, -0.2..0.2, -0.01..0.01], reversed in prop::array::uniform4(any::<bool>()),
        offset in [-1.0..1.0, -1.0..1.0, -0.2..0.2, -0.01..0.01], base in prop::array::uniform3(-1.0..1.0), turn in -3.0..3.0,
    ) {
        let read = robot();
        let mut bound = read.clone();
        let stand = Isometry3::new(Vector3::from(base), Vector3::z() * turn);
        bound.stand_at(stand);
        let axes: Vec<_> = ["j2", "j1", "j3", "left"].into_iter().enumerate()
            .map(|(index, joint)| axis(index, joint, reversed[index], offset[index])).collect();
        bound.bind(&axes, &[]).unwrap();
        let of = |index: usize| if reversed[index] { offset[index] - q[index] } else { offset[index] + q[index] };
        let joints = [of(1), of(0), of(2), of(3)];
        let expected = read.link_poses(&joints);
        let found = bound.link_poses(&q);
        prop_assert_eq!(found.len(), expected.len() + 1);
        for (found, expected) in found[1..].iter().zip(expected) {
            let difference = (stand * expected).to_homogeneous() - found.to_homogeneous();
            prop_assert!(difference.norm() < 1e-13, "{difference}");
        }
        let tip = stand * read.tip_position(&joints);
        prop_assert!((bound.tip_position(&q) - tip).norm() < 1e-13);
        // Limits are those of the axis.
        let [lower, upper] = bound.joints[3].usable_limits().unwrap();
        let ends = [0.0, 0.3].map(|end| if reversed[2] { offset[2] - end } else { end - offset[2] });
        prop_assert!((lower - ends[0].min(ends[1])).abs() < 1e-15 && (upper - ends[0].max(ends[1])).abs() < 1e-15);
        let text = bound.to_urdf().unwrap();
        prop_assert_eq!(Model::from_urdf(&text, &["j2", "j1", "j3", "left"]).unwrap().joints, bound.joints);
    }
}

#[test]
fn joints_that_are_held_do_not_move() {
    let mut model = robot();
    let axes = [axis(0, "j1", false, 0.0), axis(1, "j2", false, 0.0), axis(2, "j3", true, 0.0)];
    model.bind(&axes, &[("left".to_owned(), 0.015)]).unwrap();
    let moving: Vec<_> = model.moving_joints().map(|(_, joint)| joint.name.as_str()).collect();
    assert_eq!(moving, ["j1", "j2", "j3"]);
    let fixed = |index: usize| (model.joints[index].kind, model.joints[index].drive.clone());
    assert_eq!(
        (fixed(3), fixed(4)),
        ((JointKind::Fixed, JointDrive::Fixed), (JointKind::Fixed, JointDrive::Fixed))
    );
    let poses = model.link_poses(&[0.0, 0.0, -0.1]);
    // The axis goes down when it goes back: the joint's direction is −z.
    assert!((poses[4].translation.vector - Vector3::new(2.0, 0.015, -0.1)).norm() < 1e-15);
    assert!((poses[5].translation.vector - Vector3::new(2.0, -0.014, -0.1)).norm() < 1e-15);
    assert!((model.tip_position(&[0.0, 0.0, -0.1]) - Point3::new(2.0, 0.0, -0.2)).norm() < 1e-15);
}

#[test]
fn what_does_not_belong_together_is_named() {
    let refusal = |axes: &[AxisJoint], held: &[(&str, f64)]| {
        let held: Vec<_> = held.iter().map(|(name, at)| ((*name).to_owned(), *at)).collect();
        robot().bind(axes, &held).unwrap_err()
    };
    let all =
        |last: &str| ["j1", "j2", "j3", last].map(|joint| axis(0, joint, false, 0.0)).to_vec();
    assert_eq!(
        refusal(&all("J4"), &[]).to_string(),
        "there is no joint J4; those that move are j1, j2, j3, left"
    );
    assert_eq!(refusal(&all("flange"), &[]), BindError::Fixed("flange".to_owned()));
    assert_eq!(refusal(&all("right"), &[]), BindError::Mimics("right".to_owned()));
    assert_eq!(refusal(&all("j1"), &[]), BindError::Twice("j1".to_owned()));
    assert_eq!(refusal(&all("left"), &[("left", 0.0)]), BindError::Twice("left".to_owned()));
    let held = refusal(&all("left")[..3], &[("left", 0.0), ("left", 0.0)]);
    assert_eq!(held, BindError::Twice("left".to_owned()));
    let unmoved = refusal(&all("left")[1..3], &[]).to_string();
    assert_eq!(unmoved, "no axis moves j1, left, and nothing holds them");
    let beyond = refusal(&all("left")[..3], &[("left", 0.03)]).to_string();
    assert_eq!(beyond, "joint left is held at 0.03 (m or rad), beyond its limits 0 … 0.02");
}

/// A tool on the link of the tip: 50 mm down and 10 mm to the side, as the flange has it.
#[test]
fn a_tool_hangs_on_the_tip() {
    let mut model = robot();
    let half_turn = Isometry3::rotation(Vector3::x() * std::f64::consts::PI);
    model.mount_tool(&half_turn, &Vector3::new(0.01, 0.02, -0.05), 0.3).unwrap();
    assert!((model.tip.point - Point3::new(0.01, -0.02, 0.05)).norm() < 1e-15);
    let link = &model.links[model.tip.link];
    let inertial = link.inertial.unwrap();
    assert!((inertial.center - Point3::new(0.01, -0.02, 0.025)).norm() < 1e-15, "{inertial:?}");
    assert_eq!((inertial.mass, link.solids.len()), (0.3, 2));
    assert!(model.mount_tool(&half_turn, &Vector3::z(), 0.3).is_err());
}
