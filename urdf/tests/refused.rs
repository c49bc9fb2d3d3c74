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

fn refusal(text: &str) -> String {
    Model::from_urdf(text, &["X"]).unwrap_err().to_string()
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
        of("<mesh filename='package://a/b.stl'/>"),
        "link slide: a mesh is not supported yet"
    );
    assert_eq!(
        of("<capsule radius='1' length='2'/>"),
        "link slide: a capsule is not supported yet"
    );
    assert_eq!(of("<box size='1 0 1'/>"), "link slide: an edge of a box is 0; it must be above 0");
    assert_eq!(
        of("<sphere radius='inf'/>"),
        "link slide: the radius of a sphere is not a finite number"
    );
    assert!(of("<box size='1 1'/>").starts_with("not URDF: "));
    let differs = visual("<box size='1 1 1'/>")
        + "<collision><geometry><sphere radius='1'/></geometry></collision>";
    let expected = "link slide: its collision geometry differs from its visual geometry, which is not supported yet";
    assert_eq!(refusal(&robot(&differs, LIMIT, "")), expected);
    let moved = "<visual><origin xyz='nan 0 0'/><geometry><sphere radius='1'/></geometry></visual>";
    assert_eq!(refusal(&robot(moved, LIMIT, "")), "link slide: an origin is not a finite number");
}

#[test]
fn materials() {
    let of = |material: &str| {
        let visual =
            format!("<visual><geometry><sphere radius='1'/></geometry>{material}</visual>");
        refusal(&robot(&visual, LIMIT, ""))
    };
    assert_eq!(
        of("<material name='blue'/>"),
        "link slide: no colour is given for material \"blue\""
    );
    let textured = "<material name='a'><texture filename='a.png'/></material>";
    assert_eq!(of(textured), "link slide: a texture is not supported yet");
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
    assert_eq!(with("<mimic joint='Y'/>"), "joint X: <mimic> is not supported yet");
    assert_eq!(with("<calibration rising='0'/>"), "joint X: <calibration> is not supported yet");
    assert_eq!(
        with("<safety_controller k_velocity='1'/>"),
        "joint X: <safety_controller> is not supported yet"
    );
    let friction = with("<dynamics friction='0.1'/>");
    assert_eq!(friction, "joint X: <dynamics> with damping or friction is not supported yet");
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
    let jerk = robot("", &LIMIT.replace("velocity", "jerk='9' velocity"), "")
        .replace("name=\"r\"", "name='r' version='1.2'");
    assert_eq!(refusal(&jerk), "joint X: a limit of acceleration or jerk is not supported yet");
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
    let link = || Link { name: "more".to_owned(), inertial: None, solids: Vec::new() };
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
