//! Tests of reading: order of elements, axes, limits by version.

use super::assert_near;
use crate::{Joint, JointKind, Model, SolidShape, UrdfError};
use nalgebra::{Matrix3, Point3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Links and joints out of order, a colour defined in another link, one defined for the robot, and one nowhere needed;
/// collision geometry alone, an inertia with turned axes, an axis that is not a unit vector.
const TEXT: &str = r#"<?xml version="1.0"?>
<!-- a comment -->
<robot name="example" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <joint name="tool" type="fixed">
    <parent link="slide"/><child link="tool_tip"/><origin xyz="0 0 -0.1" rpy="1 2 3"/>
  </joint>
  <joint name="Z" type="prismatic">
    <parent link="arm"/><child link="slide"/><axis xyz="0 0 2"/>
    <limit lower="-0.2" upper="0.1" velocity="1" effort="0"/>
  </joint>
  <joint name="C" type="continuous">
    <parent link="world"/><child link="arm"/><axis xyz="0 0 1"/>
    <origin xyz="0 0 0.5" rpy="0 0 1.5707963267948966"/>
  </joint>
  <link name="tool_tip"/>
  <link name="slide">
    <collision><geometry><sphere radius="0.2"/></geometry></collision>
    <inertial>
      <mass value="3"/><origin xyz="0 0 0.1" rpy="0 0 1.5707963267948966"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/>
    </inertial>
  </link>
  <link name="arm">
    <visual><geometry><box size="1 2 3"/></geometry><material name="red"/></visual>
    <visual><origin xyz="1 0 0"/><geometry><cylinder radius="1" length="2"/></geometry>
      <material name="green"><color rgba="0 1 0 1"/></material></visual>
    <visual><geometry><box size="1 1 1"/></geometry></visual>
  </link>
  <link name="world">
    <visual><geometry><box size="1 1 1"/></geometry><material name="green"/></visual>
  </link>
  <material name="red"><color rgba="1 0 0 1"/></material>
  <transmission name="t"><type>passed over</type></transmission>
</robot>"#;

#[test]
fn a_robot_in_any_order() {
    let model = Model::from_urdf(TEXT, &["Z", "C"]).unwrap();
    let links: Vec<_> = model.links.iter().map(|link| link.name.as_str()).collect();
    assert_eq!((model.name.as_str(), links), ("example", vec!["world", "arm", "slide"]));
    let [turn, slide] = &model.joints[..] else { panic!("{:?}", model.joints) };
    let about = |joint: &Joint| (joint.name.clone(), joint.kind, joint.drive.axis());
    let limits = |joint: &Joint| (joint.position_limits, joint.velocity_limit, joint.effort_limit);
    assert_eq!(about(turn), ("C".to_owned(), JointKind::Revolute, Some(1)));
    assert_eq!(limits(turn), (None, None, None));
    assert_eq!(about(slide), ("Z".to_owned(), JointKind::Prismatic, Some(0)));
    assert_eq!((slide.parent, slide.child, slide.axis), (1, 2, Vector3::z_axis()));
    assert_eq!(limits(slide), (Some([-0.2, 0.1]), Some(1.0), None));
    assert_eq!((model.tip.link, model.tip.point), (2, Point3::new(0.0, 0.0, -0.1)));

    let colors =
        |link: usize| model.links[link].solids.iter().map(|solid| solid.color).collect::<Vec<_>>();
    let (red, green, grey) = ([1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.6, 0.6, 0.6, 1.0]);
    assert_eq!((colors(0), colors(1)), (vec![green], vec![red, green, grey]));
    assert_eq!(model.links[2].solids[0].shape, SolidShape::Sphere { radius: 0.2 });
    assert_eq!(model.links[1].inertial, None);
    let inertial = model.links[2].inertial.unwrap();
    assert_eq!((inertial.mass, inertial.center), (3.0, Point3::new(0.0, 0.0, 0.1)));
    // A quarter turn about z exchanges the moments about x and y.
    let expected = Matrix3::from_diagonal(&Vector3::new(2.0, 1.0, 2.5));
    assert!((inertial.inertia - expected).norm() < 1e-15, "{inertial:?}");

    // The arm is turned by a quarter, so what is along x of it is along y; Z is axis 0.
    let arm = model.link_poses(&[0.05, 0.0])[1];
    assert_near(arm * Point3::new(1.0, 0.0, 0.0), [0.0, 1.0, 0.5], 1e-15);
    assert_near(model.tip_position(&[0.05, -FRAC_PI_2]), [0.0, 0.0, 0.45], 1e-15);
}

#[test]
fn moving_joints_and_axes_belong_together() {
    let refusal = |axes: &[&str]| Model::from_urdf(TEXT, axes).unwrap_err();
    let message = "line 11: joint C moves, but no axis of the machine is called C";
    assert_eq!(refusal(&["Z"]).to_string(), message);
    let error = refusal(&["Z", "C", "A"]);
    assert!(matches!(&*error.error, UrdfError::NoJoint(axis) if axis == "A"), "{error}");
    // A fixed joint moves no axis, even if it has the name of one.
    assert!(matches!(*refusal(&["Z", "C", "tool"]).error, UrdfError::NoJoint(_)));
}

/// In version 1.2 an absent limit is no limit, and 0 is 0.
#[test]
fn limits_of_version_1_2() {
    let text = TEXT
        .replace("name=\"example\"", "name=\"example\" version=\"1.2\"")
        .replace("lower=\"-0.2\" upper=\"0.1\" velocity=\"1\" ", "upper=\"0.1\" ");
    let model = Model::from_urdf(&text, &["Z", "C"]).unwrap();
    let slide = &model.joints[1];
    assert_eq!(slide.position_limits, Some([f64::NEG_INFINITY, 0.1]));
    assert_eq!((slide.velocity_limit, slide.effort_limit), (None, Some(0.0)));
}
