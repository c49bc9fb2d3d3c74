//! Tests that simulation errors use the names of the machine file.

use super::{SCARA2, edited, load};
use crate::{Machine, SimulationError};
use twin_physics::{PhysicsError, Side};

fn said(machine: &Machine, error: PhysicsError) -> String {
    SimulationError::of(machine, error).to_string()
}

#[test]
fn axes_joints_and_links_have_names() {
    // An axis that is called otherwise than its joint and what it moves.
    let arm = edited(SCARA2, "name = \"A\"\nrole = \"A\"", "name = \"shoulder\"\nrole = \"A\"");
    let machine = load(&arm);
    for (error, expected) in [
        (PhysicsError::AxisWithoutJoint(2), "no joint of the model is moved by axis Z"),
        (
            PhysicsError::AxisMovesTwoJoints { joint: 1, axis: 0 },
            "joint B is moved by axis shoulder, which moves another joint already",
        ),
        (
            PhysicsError::JointAxis(0),
            "joint shoulder and its machine axis do not belong together (a joint that moves has one, a fixed one none)",
        ),
        (
            PhysicsError::NotATree { joint: 2, parent: 0, child: 3 },
            "joint Z joins parent link base and child link quill, out of the order of a tree",
        ),
        (
            PhysicsError::MassProperties { link: 1, mass: -2.0 },
            "link arm1 of -2 kg has mass properties no body can have",
        ),
        (PhysicsError::UnevenRod(2), "link arm2 is a rod whose mass is not the same all around it"),
        (
            PhysicsError::DriveParameter { axis: 0, parameter: "position_gain", value: -1.0 },
            "axis shoulder: position_gain = -1 is out of range",
        ),
        (
            PhysicsError::LimitSwitch { axis: 1, side: Side::Upper },
            "axis B ran on its upper limit switch",
        ),
    ] {
        assert_eq!(said(&machine, error), expected);
    }
    // What there is not keeps its number, and so does everything where names are not known.
    let beyond = PhysicsError::LimitSwitch { axis: 7, side: Side::Lower };
    assert_eq!(said(&machine, beyond), "axis 7 ran on its lower limit switch");
    let inner = PhysicsError::MassProperties { link: 1, mass: -2.0 };
    assert!(inner.to_string().starts_with("link 1 of -2 kg"), "{inner}");
}

/// Links and joints without a body or an axis, in machines whose parts have other numbers within physics.
#[test]
fn the_part_that_is_wrong_is_the_one_that_is_named() {
    let refused = |machine: &Machine| {
        let start = machine.start_axes().unwrap();
        SimulationError::of(machine, machine.physics(&start).unwrap_err()).to_string()
    };
    let mut machine = load(SCARA2);
    machine.model.links[2].inertial.as_mut().unwrap().inertia.m11 = -1.0;
    assert_eq!(refused(&machine), "link arm2 of 3 kg has mass properties no body can have");
    // A table on an additional axis of a tripod is a separate link.
    let text = include_str!("../../../machines/tripod.toml").to_owned()
        + "[[axes]]\nname = \"table\"\nrole = \"U\"\nkind = \"linear\"\nposition_min_mm = -50\nposition_max_mm = 50\n\
           max_velocity_mm_per_s = 100\nmax_acceleration_mm_per_s2 = 1000\n";
    let text = text.replace("drive = \"board\"\n", "").replace("drive_axis = ", "# drive_axis = ");
    let text = text.replace("increments = ", "# ").replace("per_mm = 4", "# per_mm = 4");
    let mut machine = load(&text);
    let joint = machine.model.joints.iter().position(|joint| joint.name == "table").unwrap();
    let link = machine.model.joints[joint].child;
    let name = machine.model.links[link].name.clone();
    let table = machine.model.links[link].inertial.as_mut().unwrap();
    table.mass = -0.5;
    let expected = format!("link {name} of -0.5 kg has mass properties no body can have");
    assert_eq!(refused(&machine), expected);
}
