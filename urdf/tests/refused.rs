//! Tests of refused URDF: solids, masses, joints, trees, tool tips.

use super::gantry;
use crate::{Link, Model, UrdfError};

/// A machine of one joint, X, with something said about its link and about its joint.
pub(super) fn robot(link: &str, joint: &str, more: &str) -> String {
    format!(
        r#"<robot name="r">
          <link name="base"/>
          <link name="slide">{link}</link>
          <link name="tool_tip"/>
          <joint name="X" type="prismatic"><parent link="base"/><child link="slide"/>{joint}</joint>
          <joint name="tip" type="fixed"><parent link="slide"/><child link="tool_tip"/></joint>
          {more}
        </robot>"#
    )
}

const LIMIT: &str = r#"<limit lower="0" upper="1" velocity="1" effort="1"/>"#;

/// What is wrong, without the line, which `tests::lines` is about.
fn refusal(text: &str) -> String {
    let refusal = Model::from_urdf(text, &["X"]).unwrap_err();
    let (line, message) = (refusal.line, refusal.to_string());
    let message = message.strip_prefix(&format!("line {line}: ")).expect("the line comes first");
    assert!(line >= 1 && usize::try_from(line).unwrap() <= text.lines().count(), "{refusal}");
    message.to_owned()
}

fn visual(geometry: &str) -> String {
    format!("<visual><geometry>{geometry}</geometry></visual>")
}

#[test]
fn solids() {
    Model::from_urdf(&robot(&visual("<box size='1 1 1'/>"), LIMIT, ""), &["X"]).unwrap();
    for (geometry, said) in [
        ("<capsule radius='1' length='0'/>", "the length of a capsule is 0; it must be above 0"),
        ("<box size='1 0 1'/>", "an edge of a box is 0; it must be above 0"),
        ("<sphere radius='inf'/>", "the radius of a sphere is not a finite number"),
        ("<box size='1 1 x 1'/>", "size of <box> is \"1 1 x 1\"; expected three numbers"),
        ("<cone/>", "<geometry> has no shape (box, cylinder, sphere, capsule or mesh)"),
        ("<sphere radius='1'/><box size='1 1 1'/>", "<geometry> has more than one shape"),
    ] {
        let found = refusal(&robot(&visual(geometry), LIMIT, ""));
        assert_eq!(found, format!("link slide: {said}"));
    }
    let moved = "<visual><origin xyz='nan 0 0'/><geometry><sphere radius='1'/></geometry></visual>";
    assert_eq!(refusal(&robot(moved, LIMIT, "")), "link slide: an origin is not a finite number");
}

#[test]
fn masses() {
    for (mass, ixx, said) in [
        ("0", "1", "its mass is 0; it must be above 0"),
        ("inf", "1", "its mass is not a finite number"),
        ("1", "-2", "a principal moment of inertia is -2; it must be above 0"),
    ] {
        let inertia = format!("<inertia ixx='{ixx}' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>");
        let body = format!("<inertial><mass value='{mass}'/>{inertia}</inertial>");
        assert_eq!(refusal(&robot(&body, LIMIT, "")), format!("link slide: {said}"));
    }
}

#[test]
fn joints() {
    let of = |joint: &str| refusal(&robot("", joint, ""));
    let soft = "<safety_controller k_velocity='1' soft_lower_limit='1' soft_upper_limit='0.5'/>";
    for (element, said) in [
        ("<mimic joint='Y'/>", " mimics Y, which is not a joint"),
        ("<mimic joint='X'/>", " mimics itself, by way of others or directly"),
        ("<mimic joint='tip'/>", " mimics tip; a fixed joint neither mimics nor is mimicked"),
        ("<mimic/>", ": <mimic> has no joint"),
        ("<mimic joint='X' offset='nan'/>", ": what it mimics with is not a finite number"),
        ("<calibration rising='inf'/>", ": its calibration is not a finite number"),
        ("<safety_controller/>", ": <safety_controller> has no k_velocity"),
        (soft, ": its lower limit 1 is above its upper limit 0.5"),
        ("<dynamics friction='-0.1'/>", ": its friction is -0.1; it must be 0 or above"),
        ("<dynamics damping='inf'/>", ": its damping is not a finite number"),
        (LIMIT, ": <joint> has more than one <limit>"),
    ] {
        assert_eq!(of(&format!("{LIMIT}{element}")), format!("joint X{said}"));
    }
    assert!(of("").starts_with("joint X: it has no <limit>"));
    for (limit, said) in [
        ("lower='0' upper='1'", "<limit> has no velocity"),
        ("lower='0' upper='1' velocity='-1'", "its velocity limit is -1; it must be 0 or above"),
        ("lower='nan' upper='1' velocity='1'", "a limit is not a finite number"),
    ] {
        assert_eq!(of(&format!("<limit {limit} effort='1'/>")), format!("joint X: {said}"));
    }
    let strange = robot("", LIMIT, "").replace("prismatic", "elastic");
    assert!(refusal(&strange).starts_with("joint X: type of <joint> is \"elastic\"; expected "));
    for kind in ["floating", "planar", "spherical"] {
        let text = robot("", LIMIT, "").replace("prismatic", kind);
        assert_eq!(refusal(&text), format!("joint X: a {kind} joint is not supported yet"));
    }
}

#[test]
fn trees() {
    let joint = |name: &str, [parent, child]: [&str; 2]| {
        let links = format!("<parent link='{parent}'/><child link='{child}'/>");
        format!("<joint name='{name}' type='fixed'>{links}</joint>")
    };
    let no_base = "no link is the base: each is the child of a joint, or there is none";
    let twice = "link slide is the child of joint X and of joint j; only a tree can be read";
    let apart = "links base and other hang on no joint; only one can be the base";
    let joints = [joint("j", ["a", "b"]), joint("k", ["b", "a"])].concat();
    let ring = format!("<link name='a'/><link name='b'/>{joints}");
    let looped = "joint j is not connected to the base link: its parent links form a loop; correct a <parent> or <child>";
    for (more, said) in [
        ("<link name='other'/>".to_owned(), apart),
        (joint("j", ["slide", "base"]), no_base),
        (joint("j", ["base", "slide"]), twice),
        (ring, looped),
        (joint("X", ["base", "base"]), "there are two of joint X"),
        ("<link name=''/>".to_owned(), "a link or joint has no name"),
    ] {
        assert_eq!(refusal(&robot("", LIMIT, &more)), said);
    }
    assert_eq!(refusal("<robot name='r'/>"), no_base);
    assert!(refusal("no XML").starts_with("not URDF: "));
}

#[test]
fn tool_tips() {
    let marked = "link tool_tip marks the tool tip: it has neither body nor mass, hangs on a fixed joint and carries nothing";
    let text = robot("", LIMIT, "");
    let none = text.replace("tool_tip", "other");
    assert!(refusal(&none).starts_with("there is no link tool_tip: "));
    let body = format!("<link name='tool_tip'>{}</link>", visual("<sphere radius='1'/>"));
    assert_eq!(refusal(&text.replace("<link name=\"tool_tip\"/>", &body)), marked);
    let carries = "<link name='a'/><joint name='j' type='fixed'><parent link='tool_tip'/><child link='a'/></joint>";
    assert_eq!(refusal(&robot("", LIMIT, carries)), marked);
    let alone = "<robot name='r'><link name='tool_tip'/></robot>";
    assert_eq!(refusal(alone), marked);
}

#[test]
fn models_that_cannot_be_written() {
    type Change = fn(&mut Model);
    let order = "joint Y: a model's joint i moves link i + 1, and parents come before children";
    let no_mass = "link carriage: its mass is 0; it must be above 0";
    let colour = "link base: a colour is not a finite number";
    let limit = "joint X: a limit is not a finite number";
    let changes: [(Change, &str); 9] = [
        (|model| model.links[1].name = "base".to_owned(), "there are two of link base"),
        (|model| model.links[1].name = "tool_tip".to_owned(), "there are two of link tool_tip"),
        (|model| model.joints[2].name = "X".to_owned(), "there are two of joint X"),
        (|model| model.joints[2].name.clear(), "a link or joint has no name"),
        (|model| model.joints[1].parent = 2, order),
        (|model| model.tip.point.x = f64::NAN, "joint tool_tip: its origin is not a finite number"),
        (|model| model.joints[0].effort_limit = Some(f64::NAN), limit),
        (|model| model.links[2].inertial.as_mut().unwrap().mass = 0.0, no_mass),
        (|model| model.links[0].solids[0].color[3] = f64::INFINITY, colour),
    ];
    for (change, said) in changes {
        let mut model = gantry().model().unwrap();
        change(&mut model);
        assert_eq!(model.to_urdf().unwrap_err().to_string(), said);
    }
    let mut model = gantry().model().unwrap();
    model.links.push(Link::new("more", None, Vec::new()));
    assert!(matches!(model.to_urdf(), Err(UrdfError::Count { links: 5, joints: 3 })));
}
