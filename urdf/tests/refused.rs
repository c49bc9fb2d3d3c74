//! Tests of refused URDF: solids, masses, joints, trees, tool tips.

use super::gantry;
use crate::{Link, Model, UrdfError};

/// A machine of one joint, X, with something said about its link and about its joint.
fn robot(link: &str, joint: &str, more: &str) -> String {
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
fn the_machine_without_what_is_refused_is_read() {
    Model::from_urdf(&robot(&visual("<box size='1 1 1'/>"), LIMIT, ""), &["X"]).unwrap();
}

#[test]
fn solids() {
    let of = |geometry: &str| refusal(&robot(&visual(geometry), LIMIT, ""));
    assert_eq!(
        of("<capsule radius='1' length='0'/>"),
        "link slide: the length of a capsule is 0; it must be above 0"
    );
    assert_eq!(of("<box size='1 0 1'/>"), "link slide: an edge of a box is 0; it must be above 0");
    assert_eq!(
        of("<sphere radius='inf'/>"),
        "link slide: the radius of a sphere is not a finite number"
    );
    let two = "link slide: size of <box> is \"1 1\"; expected three numbers";
    assert_eq!(of("<box size='1 1'/>"), two);
    assert_eq!(of("<box size='1 1 x 1'/>"), two.replace("1 1", "1 1 x 1"));
    assert_eq!(
        of("<cone/>"),
        "link slide: <geometry> has no shape (box, cylinder, sphere, capsule or mesh)"
    );
    let both = "<sphere radius='1'/><box size='1 1 1'/>";
    assert_eq!(of(both), "link slide: <geometry> has more than one shape");
    let moved = "<visual><origin xyz='nan 0 0'/><geometry><sphere radius='1'/></geometry></visual>";
    assert_eq!(refusal(&robot(moved, LIMIT, "")), "link slide: an origin is not a finite number");
}

#[test]
fn masses() {
    let of = |mass: &str, ixx: &str| {
        let inertia = format!("<inertia ixx='{ixx}' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>");
        refusal(&robot(&format!("<inertial><mass value='{mass}'/>{inertia}</inertial>"), LIMIT, ""))
    };
    assert_eq!(of("-1", "1"), "link slide: its mass is -1; it must be above 0");
    assert_eq!(of("0", "1"), "link slide: its mass is 0; it must be above 0");
    assert_eq!(of("inf", "1"), "link slide: its mass is not a finite number");
    assert_eq!(
        of("1", "-2"),
        "link slide: a principal moment of inertia is -2; it must be above 0"
    );
}

#[test]
fn joints() {
    let of = |joint: &str| refusal(&robot("", joint, ""));
    let with = |more: &str| of(&format!("{LIMIT}{more}"));
    assert_eq!(with("<mimic joint='Y'/>"), "joint X mimics Y, which is not a joint");
    assert_eq!(with("<mimic joint='X'/>"), "joint X mimics itself, by way of others or directly");
    let fixed = "joint X mimics tip; a fixed joint neither mimics nor is mimicked";
    assert_eq!(with("<mimic joint='tip'/>"), fixed);
    assert_eq!(with("<mimic/>"), "joint X: <mimic> has no joint");
    assert_eq!(
        with("<mimic joint='X' offset='nan'/>"),
        "joint X: what it mimics with is not a finite number"
    );
    let calibration = with("<calibration rising='inf'/>");
    assert_eq!(calibration, "joint X: its calibration is not a finite number");
    assert_eq!(with("<safety_controller/>"), "joint X: <safety_controller> has no k_velocity");
    let soft = "<safety_controller k_velocity='1' soft_lower_limit='1' soft_upper_limit='0.5'/>";
    assert_eq!(with(soft), "joint X: its lower limit 1 is above its upper limit 0.5");
    let friction = with("<dynamics friction='-0.1'/>");
    assert_eq!(friction, "joint X: its friction is -0.1; it must be 0 or above");
    let damping = with("<dynamics damping='inf'/>");
    assert_eq!(damping, "joint X: its damping is not a finite number");
    assert_eq!(with(LIMIT), "joint X: <joint> has more than one <limit>");
    assert_eq!(of("<limit lower='0' upper='1' effort='1'/>"), "joint X: <limit> has no velocity");
    let negative = of("<limit lower='0' upper='1' velocity='-1' effort='1'/>");
    assert_eq!(negative, "joint X: its velocity limit is -1; it must be 0 or above");
    let strange = robot("", LIMIT, "").replace("prismatic", "elastic");
    assert!(refusal(&strange).starts_with("joint X: type of <joint> is \"elastic\"; expected "));
    assert_eq!(with("<axis xyz='0 0 0'/>"), "joint X: its axis is 0 0 0");
    assert!(of("").starts_with("joint X: it has no <limit>"));
    let crossed = of("<limit lower='2' upper='1' velocity='1' effort='1'/>");
    assert_eq!(crossed, "joint X: its lower limit 2 is above its upper limit 1");
    let nan = of("<limit lower='nan' upper='1' velocity='1' effort='1'/>");
    assert_eq!(nan, "joint X: a limit is not a finite number");
    for kind in ["floating", "planar", "spherical"] {
        let text = robot("", LIMIT, "").replace("prismatic", kind);
        assert_eq!(refusal(&text), format!("joint X: a {kind} joint is not supported yet"));
    }
}

#[test]
fn trees() {
    let of = |more: &str| refusal(&robot("", LIMIT, more));
    let joint = |parent: &str, child: &str| {
        format!(
            "<joint name='j' type='fixed'><parent link='{parent}'/><child link='{child}'/></joint>"
        )
    };
    assert_eq!(of("<link name='slide'/>"), "there are two of link slide");
    assert_eq!(of(&joint("slide", "gone")), "joint j: there is no link gone");
    assert_eq!(
        of("<link name='other'/>"),
        "links base and other hang on no joint; only one can be the base"
    );
    assert_eq!(
        of(&joint("slide", "base")),
        "no link is the base: each is the child of a joint, or there is none"
    );
    let twice = "link slide is the child of joint X and of joint j; only a tree can be read";
    assert_eq!(of(&joint("base", "slide")), twice);
    let ring = "<link name='a'/><link name='b'/><joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>\
        <joint name='k' type='fixed'><parent link='b'/><child link='a'/></joint>";
    assert_eq!(of(ring), "joint j does not hang on the base: its links make a loop");
    assert_eq!(of(&joint("base", "base").replace("'j'", "'X'")), "there are two of joint X");
    assert_eq!(of("<link name=''/>"), "a link or joint has no name");
    assert_eq!(
        refusal("<robot name='r'/>"),
        "no link is the base: each is the child of a joint, or there is none"
    );
    assert!(refusal("no XML").starts_with("not URDF: "));
    assert!(refusal("<robot name='r'>").starts_with("not URDF: "));
}

#[test]
fn tool_tips() {
    let marked = "link tool_tip marks the tool tip: it has neither body nor mass, hangs on a fixed joint and carries nothing";
    let text = robot("", LIMIT, "");
    let none = text.replace("tool_tip", "other");
    assert!(refusal(&none).starts_with("there is no link tool_tip: "));
    let body = text.replace(
        "<link name=\"tool_tip\"/>",
        &format!("<link name='tool_tip'>{}</link>", visual("<sphere radius='1'/>")),
    );
    assert_eq!(refusal(&body), marked);
    let carries = robot(
        "",
        LIMIT,
        "<link name='a'/><joint name='j' type='fixed'><parent link='tool_tip'/><child link='a'/></joint>",
    );
    assert_eq!(refusal(&carries), marked);
    let alone = "<robot name='r'><link name='tool_tip'/></robot>";
    assert_eq!(refusal(alone), marked);
}

#[test]
fn models_that_cannot_be_written() {
    let refusal = |change: fn(&mut Model)| {
        let mut model = gantry().model().unwrap();
        change(&mut model);
        model.to_urdf().unwrap_err().to_string()
    };
    let link = || Link::new("more", None, Vec::new());
    assert_eq!(
        refusal(|model| model.links[1].name = "base".to_owned()),
        "there are two of link base"
    );
    assert_eq!(
        refusal(|model| model.links[1].name = "tool_tip".to_owned()),
        "there are two of link tool_tip"
    );
    assert_eq!(refusal(|model| model.joints[2].name = "X".to_owned()), "there are two of joint X");
    assert_eq!(refusal(|model| model.joints[2].name.clear()), "a link or joint has no name");
    let order = "joint Y: a model's joint i moves link i + 1, and parents come before children";
    assert_eq!(refusal(|model| model.joints[1].parent = 2), order);
    assert_eq!(
        refusal(|model| model.tip.point.x = f64::NAN),
        "joint tool_tip: its origin is not a finite number"
    );
    assert_eq!(
        refusal(|model| model.joints[0].effort_limit = Some(f64::NAN)),
        "joint X: a limit is not a finite number"
    );
    let mass = |model: &mut Model| model.links[2].inertial.as_mut().unwrap().mass = 0.0;
    assert_eq!(refusal(mass), "link carriage: its mass is 0; it must be above 0");
    let color = |model: &mut Model| model.links[0].solids[0].color[3] = f64::INFINITY;
    assert_eq!(refusal(color), "link base: a colour is not a finite number");
    let mut model = gantry().model().unwrap();
    model.links.push(link());
    assert!(matches!(model.to_urdf(), Err(UrdfError::Count { links: 5, joints: 3 })));
}
