//! Tests of the file, line and part in every error.

use crate::{Model, UrdfNote, UrdfOptions};
use std::path::Path;

/// Line by line, so that a line can be counted.
const TEXT: &str = r#"<?xml version="1.0"?>
<robot name="lines">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="base">
    <visual>
      <origin xyz="0 0 0" rpy="0 0 0"/>
      <geometry><box size="1 1 1"/></geometry>
      <material name="red"/>
    </visual>
  </link>
  <link name="slide">
    <inertial>
      <mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
    </inertial>
    <collision>
      <geometry><sphere radius="1"/></geometry>
    </collision>
  </link>
  <link name="tool_tip"/>
  <joint name="X" type="prismatic">
    <parent link="base"/>
    <child link="slide"/>
    <axis xyz="1 0 0"/>
    <limit lower="0" upper="1" velocity="1" effort="1"/>
  </joint>
  <joint name="tip" type="fixed">
    <parent link="slide"/>
    <child link="tool_tip"/>
  </joint>
</robot>
"#;

fn read(text: &str) -> Result<crate::Loaded, crate::UrdfFileError> {
    Model::read_urdf(text, Path::new("some/robot.urdf"), &UrdfOptions::default())
}

/// The refusal of the text with a change in it; an apostrophe stands for a quotation mark.
fn changed(from: &str, to: &str) -> String {
    let [from, to] = [from, to].map(|text| text.replace('\'', "\""));
    assert!(TEXT.contains(&from), "{from}");
    read(&TEXT.replacen(&from, &to, 1)).unwrap_err().to_string()
}

/// A part of the text, what takes its place, and what is said then: of the form of the text, and of what it says.
const CHANGES: &str = r#"size='1 1 1' | size='1 1' | 7: link base: size of <box> is "1 1"; expected three numbers
value='1' | value='one' | 13: link slide: value of <mass> is "one"; expected a number
rpy='0 0 0' | rpy='0 0 ${pi/2}' | 6: this is xacro, of which URDF is made: run `xacro IN.urdf.xacro > OUT.urdf` and take what it writes
<parent link='base'/> |  | 21: joint X: <joint> has no <parent>
name='slide' | nom='slide' | 11: <link> has no name
rgba='1 0 0 1' | rgba='red' | 3: rgba of <color> is "red"; expected four numbers
radius='1' | radius='-1' | 16: link slide: the radius of a sphere is -1; it must be above 0
value='1' | value='-1' | 12: link slide: its mass is -1; it must be above 0
1 0 0' | 0 0 0' | 24: joint X: its axis is 0 0 0
upper='1' | upper='-1' | 25: joint X: its lower limit 0 is above its upper limit -1
<child link='slide'/> | <child link='gone'/> | 21: joint X: there is no link gone
xyz='0 0 0' | xyz='0 0 inf' | 5: link base: an origin is not a finite number
link name='base' | link name='slide' | 11: there are two of link slide
type='fixed' | type='planar' | 20: link tool_tip marks the tool tip: it has neither body nor mass, hangs on a fixed joint and carries nothing
type='prismatic' | type='floating' | 21: joint X: a floating joint is not supported yet"#;

#[test]
fn lines_and_parts_are_named() {
    let loaded = read(TEXT).unwrap();
    assert_eq!((loaded.model.links.len(), loaded.warnings), (2, Vec::new()));
    for change in CHANGES.lines() {
        let [from, to, expected] = change.split(" | ").collect::<Vec<_>>()[..] else {
            panic!("{change}")
        };
        assert_eq!(changed(from, to), format!("some/robot.urdf:{expected}"), "{change}");
    }
    let orientation = format!("rpy=\"0 0 0\" {}=\"0 0 0 1\"", crate::QUATERNION);
    let refusal = changed("rpy='0 0 0'", &orientation);
    let expected = "some/robot.urdf:5: link base: rpy and quaternion_wxyz";
    assert!(refusal.starts_with(expected), "{refusal}");
}

#[test]
fn xml_that_is_broken_has_a_line_too() {
    for (from, to, line) in [
        ("</inertial>", "</inertia>", 15),
        ("<axis xyz", "<axis xyz='1' xyz", 24),
        ("</robot>", "", 31),
        ("name='X'", "name=X", 21),
        ("<child", "<other:child", 23),
    ] {
        let refusal = changed(from, to);
        assert!(refusal.starts_with(&format!("some/robot.urdf:{line}: not URDF: ")), "{refusal}");
    }
    assert!(read("").unwrap_err().to_string().starts_with("some/robot.urdf:1: not URDF: "));
    let other = "<!-- a world -->\n<sdf/>";
    let expected = "some/robot.urdf:2: not URDF: the text is a <sdf>, not a <robot>";
    assert_eq!(read(other).unwrap_err().to_string(), expected);
    let deep = format!("<robot>{}{}</robot>", "<a>".repeat(100), "</a>".repeat(100));
    assert!(read(&deep).unwrap_err().to_string().contains("65 deep"));
}

/// Reading compares each attribute of an element with all others, and each name with all namespaces.
#[test]
fn text_that_would_take_long_to_read_is_refused() {
    let many = |what: &dyn Fn(usize) -> String, count| (0..count).map(what).collect::<String>();
    let attributes = |count| {
        format!("<robot>\n<a>\n<b{}/></a></robot>", many(&|at| format!(" a{at}='1'"), count))
    };
    let expected = "some/robot.urdf:3: not URDF: an element has 200000 attributes, and at most 100 are read; \
                    remove those that URDF does not know";
    assert_eq!(read(&attributes(200_000)).unwrap_err().to_string(), expected);
    let fine = read(&attributes(100)).unwrap_err().to_string();
    assert!(!fine.contains("attributes"), "{fine}");
    let spaces = many(&|at| format!("\n<a xmlns:a{at}='{at}'/>"), 101);
    let expected = "some/robot.urdf:102: not URDF: more than 100 namespaces are declared (xmlns), the most that are \
                    read; remove those that are not used";
    assert_eq!(read(&format!("<robot>{spaces}</robot>")).unwrap_err().to_string(), expected);
}

#[test]
fn xacro_is_recognised() {
    let declared = "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>\n<xacro:include filename='a'/></robot>";
    assert!(read(declared).unwrap_err().to_string().contains(":2: this is xacro"));
    let undeclared = "<robot name='r'>\n\n<xacro:arm/></robot>";
    assert!(read(undeclared).unwrap_err().to_string().contains(":3: this is xacro"));
    // Elsewhere a dollar is nothing to us.
    let other = TEXT.replace("</robot>", "<gazebo path='$(find x)'/></robot>");
    read(&other).unwrap();
}

#[test]
fn what_only_looks_differently_is_a_warning() {
    let text = TEXT.replace("<material name=\"red\"/>", "<material name=\"blue\"/>");
    let loaded = read(&text).unwrap();
    let [warning] = &loaded.warnings[..] else { panic!("{:?}", loaded.warnings) };
    let expected = "some/robot.urdf:5: link base: the colour of material \"blue\" is not in this file; grey is taken";
    assert_eq!(warning.to_string(), expected);
    let grey = [0.6, 0.6, 0.6, 1.0].map(f64::to_bits);
    assert_eq!(loaded.model.links[0].solids[0].color.map(f64::to_bits), grey);
    let texture = "<material name=\"wood\"><texture filename=\"wood.png\"/></material>";
    let loaded = read(&TEXT.replace("<material name=\"red\"/>", texture)).unwrap();
    let UrdfNote::Texture { file, .. } = &loaded.warnings[0].note else { panic!("{loaded:?}") };
    assert_eq!(file, "wood.png");
}

/// 3.14 is meant to be half a turn, where one says so; 3.1 is not.
#[test]
fn right_angles_that_were_rounded() {
    let text = TEXT.replace("rpy=\"0 0 0\"", "rpy=\"3.14 -1.571 3.1\"");
    let options = UrdfOptions { right_angle_tolerance: 2e-3, ..UrdfOptions::default() };
    let loaded = Model::read_urdf(&text, Path::new(""), &options).unwrap();
    let (roll, pitch, yaw) = loaded.model.links[0].solids[0].origin.rotation.euler_angles();
    // At a pitch of −90° roll and yaw are one: their sum.
    assert!((pitch + std::f64::consts::FRAC_PI_2).abs() < 1e-7, "{roll} {pitch} {yaw}");
    let notes: Vec<_> = loaded.warnings.iter().map(ToString::to_string).collect();
    let angles = [("3.14", "180"), ("-1.571", "-90")];
    let note =
        |(rad, degrees)| format!("line 5: link base: an angle of {rad} rad is taken as {degrees}°");
    assert_eq!(notes, angles.map(note));
    assert!(read(&text).unwrap().warnings.is_empty());
}

/// URDF 1.1 has quaternions in place of angles; a text may not have both.
#[test]
fn quaternions_in_place_of_angles() {
    let version = |text: &str| text.replace("name=\"lines\"", "name=\"lines\" version=\"1.1\"");
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let text = version(&TEXT.replace("rpy=\"0 0 0\"", &format!("quat_xyzw=\"0 0 {half} {half}\"")));
    let origin = read(&text).unwrap().model.links[0].solids[0].origin;
    let turned = origin * nalgebra::Vector3::x();
    assert!((turned - nalgebra::Vector3::y()).norm() < 1e-15, "{turned}");
    let both = version(&TEXT.replace("rpy=", "quat_xyzw=\"0 0 0 1\" rpy="));
    assert!(read(&both).unwrap_err().to_string().contains(":6: link base: <origin> has more"));
}
