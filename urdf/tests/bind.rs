//! Tests of binding a loaded model to machine axes.

use super::{assert_near, seeded};
use crate::{AxisJoint, BindError, JointDrive, JointKind, Model, UrdfOptions};
use nalgebra::{Isometry3, Point3, Vector3};
use proptest::prelude::*;
use std::path::Path;

/// Two arms of 1 m, a quill that goes down when its joint goes up, a gripper of two fingers of which one mimics the other.
const ROBOT: &str = "<robot name='r'>
  <link name='base'/> <link name='arm1'/> <link name='arm2'/> <link name='quill'/>
  <link name='finger1'/> <link name='finger2'/> <link name='tcp'/>
  <joint name='j1' type='revolute'><parent link='base'/><child link='arm1'/>
    <axis xyz='0 0 1'/><limit lower='-2' upper='2' velocity='1' effort='1'/></joint>
  <joint name='j2' type='revolute'><parent link='arm1'/><child link='arm2'/><origin xyz='1 0 0'/>
    <axis xyz='0 0 1'/><limit lower='-2.5' upper='2.5' velocity='1' effort='1'/></joint>
  <joint name='j3' type='prismatic'><parent link='arm2'/><child link='quill'/><origin xyz='1 0 0'/>
    <axis xyz='0 0 -1'/><limit lower='0' upper='0.3' velocity='1' effort='1'/></joint>
  <joint name='left' type='prismatic'><parent link='quill'/><child link='finger1'/>
    <axis xyz='0 1 0'/><limit lower='0' upper='0.02' velocity='1' effort='1'/></joint>
  <joint name='right' type='prismatic'><parent link='quill'/><child link='finger2'/><axis xyz='0 1 0'/>
    <limit lower='-0.1' upper='0.1' velocity='1' effort='1'/><mimic joint='left' multiplier='-1' offset='0.001'/></joint>
  <joint name='flange' type='fixed'><parent link='quill'/><child link='tcp'/><origin xyz='0 0 -0.1'/></joint>
</robot>";

fn robot() -> Model {
    let options = UrdfOptions { tip_link: Some("tcp".to_owned()), ..UrdfOptions::default() };
    Model::read_urdf(ROBOT, Path::new(""), &options).unwrap().model
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
        assert_near(bound.tip_position(&q), stand * read.tip_position(&joints), 1e-13);
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
    for joint in &model.joints[3..=4] {
        assert_eq!((joint.kind, &joint.drive), (JointKind::Fixed, &JointDrive::Fixed));
    }
    let poses = model.link_poses(&[0.0, 0.0, -0.1]);
    // The axis goes down when it goes back: the joint's direction is −z.
    assert_near(poses[4] * Point3::origin(), [2.0, 0.015, -0.1], 1e-15);
    assert_near(poses[5] * Point3::origin(), [2.0, -0.014, -0.1], 1e-15);
    assert_near(model.tip_position(&[0.0, 0.0, -0.1]), [2.0, 0.0, -0.2], 1e-15);
}

#[test]
fn what_does_not_belong_together_is_named() {
    let refusal = |axes: &[AxisJoint], held: &[(&str, f64)]| {
        let held: Vec<_> = held.iter().map(|(name, at)| ((*name).to_owned(), *at)).collect();
        robot().bind(axes, &held).unwrap_err()
    };
    let all =
        |last: &str| ["j1", "j2", "j3", last].map(|joint| axis(0, joint, false, 0.0)).to_vec();
    let unknown = refusal(&all("J4"), &[]).to_string();
    assert_eq!(unknown, "there is no joint J4; those that move are j1, j2, j3, left");
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
    assert_near(model.tip.point, [0.01, -0.02, 0.05], 1e-15);
    let link = &model.links[model.tip.link];
    let inertial = link.inertial.unwrap();
    assert_near(inertial.center, [0.01, -0.02, 0.025], 1e-15);
    assert_eq!((inertial.mass, link.solids.len()), (0.3, 2));
    assert!(model.mount_tool(&half_turn, &Vector3::z(), 0.3).is_err());
}
