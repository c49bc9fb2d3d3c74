//! Tests of machine files of every kind: transform and links agree on the tool position for any dimensions.

use super::{edited, load, says};
use crate::{DirectionRule, Machine};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use twin_kinematics::{AxisVector, Branch, Kinematics, KinematicsError, Pose, ToPath};

const SHIPPED: [(&str, &str); 7] = [
    ("scara2", include_str!("../../../machines/scara2.toml")),
    ("scara3", include_str!("../../../machines/scara3.toml")),
    ("gantry3", include_str!("../../../machines/gantry3.toml")),
    ("gantry_h2", include_str!("../../../machines/gantry_h2.toml")),
    ("gantry_cutter3", include_str!("../../../machines/gantry_cutter3.toml")),
    ("gantry3_tool2", include_str!("../../../machines/gantry3_tool2.toml")),
    ("tripod", include_str!("../../../machines/tripod.toml")),
];

fn shipped(kind: &str) -> &'static str {
    SHIPPED.iter().find(|(name, _)| *name == kind).unwrap().1
}

/// Axis positions at a part of the way between the software limits.
fn part_of_the_way(machine: &Machine, parts: &[f64]) -> AxisVector {
    AxisVector::from_values(machine.axes.iter().zip(parts).map(|(axis, part)| {
        let [low, high] = axis.position_limits;
        // A modulo axis goes as far as numbers do; a turn is enough.
        let (low, high) = if axis.limited { (low, high) } else { (0.0, axis.period.unwrap()) };
        low + part * (high - low)
    }))
}

/// The transform and the links agree about the tool tip; `None` where the axes lead nowhere.
fn tip_error(machine: &Machine, axes: &AxisVector) -> Option<f64> {
    let pose = machine.kinematics.forward(axes).ok()?;
    Some((machine.model.tip_position(axes) - pose.position).norm())
}

#[test]
fn shipped_files_are_of_their_kind_and_can_stand_at_their_start() {
    for (kind, text) in SHIPPED {
        let machine = load(text);
        assert_eq!((machine.kind, machine.name.as_str()), (kind, kind));
        let axes = machine.start_axes().unwrap_or_else(|| panic!("{kind} cannot be at its start"));
        let error = tip_error(&machine, &axes).unwrap();
        assert!(error < 1e-12, "{kind}: {error}");
        for (axis, position) in machine.axes.iter().zip(axes.iter()) {
            let [low, high] = axis.position_limits;
            assert!((low..=high).contains(position), "{kind} {}: {position}", axis.name);
        }
    }
}

/// Kinds without a file of their own.
#[test]
fn every_kind_can_be_read() {
    let plane = |text: &str, kind: &str, from: &str| {
        let text = edited(text, &format!("kind = \"{from}\""), &format!("kind = \"{kind}\""));
        edited(&text, "offsets_mm = [0.0, 0.0, 0.0]", "offsets_mm = [1.0, 2.0]")
    };
    let gantry2 = load(&plane(shipped("gantry3"), "gantry2", "gantry3"));
    let cutter2 = load(&plane(shipped("gantry_cutter3"), "gantry_cutter2", "gantry_cutter3"));
    let tool2 = load(&plane(shipped("gantry3_tool2"), "gantry2_tool2", "gantry3_tool2"));
    let tool1 = edited(shipped("gantry3_tool2"), "tool_left_mm = 15.0", "");
    let tool1 = plane(&tool1, "gantry2_tool1", "gantry3_tool2");
    let tool1 = load(&tool1);
    for machine in [gantry2, cutter2, tool2, tool1] {
        // Z is an axis of its own.
        let axes = part_of_the_way(&machine, &[0.3, 0.6, 0.2, 0.4]);
        let error = tip_error(&machine, &axes).unwrap();
        assert!(error < 1e-12, "{}: {error}", machine.kind);
    }
}

#[test]
fn belts_are_laid_in_four_ways() {
    // The tool goes 10 mm along x and 20 mm along y; offsets are added before the belt.
    for (belt, a, b) in [
        ("standard", 30.0, 10.0),
        ("coordinates_exchanged", 30.0, -10.0),
        ("drives_exchanged", 10.0, 30.0),
        ("both_exchanged", -10.0, 30.0),
    ] {
        let machine = load(&edited(shipped("gantry_h2"), "coordinates_exchanged", belt));
        let pose = Pose::at(0.01, 0.02, 0.0);
        let axes = machine.kinematics.inverse(&pose, &AxisVector::zeros(3)).unwrap();
        assert!(
            (axes[0] * 1e3 - a).abs() < 1e-12 && (axes[1] * 1e3 - b).abs() < 1e-12,
            "{belt} {axes:?}"
        );
        assert!(tip_error(&machine, &axes).unwrap() < 1e-12, "{belt}");
    }
}

#[test]
fn what_was_measured_is_added_to_what_was_designed() {
    let text = edited(
        shipped("scara3"),
        "[kinematics.deviations]\narm_lengths_mm = [0.0, 0.0, 0.0]\noffsets_deg = [0.0, 0.0, 0.0]",
        "[kinematics.deviations]\narm_lengths_mm = [0.5, -0.25, 1.0]\noffsets_deg = [1.0, -2.0, 3.0]",
    );
    let machine = load(&text);
    let stretched = [1.0_f64, -2.0, 3.0, 0.0].map(f64::to_radians);
    let pose = machine.kinematics.forward(&AxisVector::from_values(stretched)).unwrap();
    assert!((pose.position - Point3::new(0.49125, 0.0, -0.06)).norm() < 1e-15, "{pose:?}");
    assert!(pose.direction.abs() < 1e-15);
}

/// A rod that is half a millimetre longer moves the platform; the links agree, tilted as it is.
#[test]
fn measured_tripods_tilt() {
    let text = edited(
        shipped("tripod"),
        "rod_lengths_mm = [0.0, 0.0, 0.0,",
        "rod_lengths_mm = [0.5, 0.0, 0.0,",
    );
    let (nominal, measured) = (load(shipped("tripod")), load(&text));
    let axes = part_of_the_way(&nominal, &[0.5, 0.4, 0.6]);
    let moved = measured.kinematics.forward(&axes).unwrap().position
        - nominal.kinematics.forward(&axes).unwrap().position;
    assert!((1e-4..2e-3).contains(&moved.norm()), "{moved}");
    assert!(tip_error(&measured, &axes).unwrap() < 1e-11);
}

#[test]
fn a_knife_that_trails_is_made_up_for() {
    let machine = load(shipped("gantry_cutter3"));
    assert_eq!(machine.direction, DirectionRule::Path(ToPath::Tangential, 0.0));
    let pose = Pose { position: Point3::new(0.1, 0.2, 0.0), direction: 90_f64.to_radians() };
    let axes = machine.kinematics.inverse(&pose, &AxisVector::zeros(4)).unwrap();
    // Pointing along +y, the axis of R is 2 mm ahead of the edge.
    let expected = [0.1, 0.202, 0.04, 90_f64.to_radians()];
    for (found, expected) in axes.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-15, "{axes:?}");
    }
    assert!(tip_error(&machine, &axes).unwrap() < 1e-12);
    let knife = &machine.axes[3];
    assert!(!knife.limited);
    let folded = machine.kinematics.fold(&AxisVector::from_values([0.1, 0.2, 0.3, -0.5]));
    let expected = 360_f64.to_radians() - 0.5;
    assert!((folded[3] - expected).abs() < 1e-14 && folded[0] == 0.1);
}

#[test]
fn directions_come_from_where_the_file_says() {
    let with =
        |line: &str| load(&edited(shipped("scara3"), "direction = \"fixed\" ", line)).direction;
    assert_eq!(with("direction = \"right\" "), DirectionRule::Path(ToPath::Right, 0.0));
    assert_eq!(with("direction = \"U\" "), DirectionRule::Additional(2, 0.0));
    let fixed = edited(shipped("scara3"), "direction_deg = 0.0", "direction_deg = 90.0");
    assert_eq!(load(&fixed).direction, DirectionRule::Fixed(90_f64.to_radians()));
}

#[test]
fn a_tool_beside_the_flange_turns_with_the_arm() {
    let machine =
        load(&edited(shipped("scara2"), "# offset_mm = [0.0, 0.0]", "offset_mm = [10.0, 5.0]"));
    // Both arms along +x: the tip is ahead of the flange and to its left.
    let pose = machine.kinematics.forward(&AxisVector::zeros(3)).unwrap();
    assert!((pose.position - Point3::new(0.46, 0.005, -0.06)).norm() < 1e-15, "{pose:?}");
    assert_eq!(machine.kinematics.branch(), Branch::ElbowLow);
}

/// Work frame by six points: the sample in scara2.toml lies at (300, 0, 0) mm with axes parallel to the machine's.
#[test]
fn the_work_is_where_it_was_probed() {
    let text = shipped("scara2").replace("translation_mm = [0.0, 0.0, 0.0]\n", "");
    let text = text.replace("rotation_deg = [0.0, 0.0, 0.0]\n", "");
    let text = text.replace("# [work_frame.probed_mm]", "[work_frame.probed_mm]");
    let mut text = text;
    for key in ["a1", "a2", "a3", "b1", "b2", "c1"] {
        text = text.replace(&format!("# {key} = "), &format!("{key} = "));
    }
    let machine = load(&text);
    let there = machine.frame.point_to_machine(&Point3::new(0.01, 0.02, 0.03));
    assert!((there - Point3::new(0.31, 0.02, 0.03)).norm() < 1e-15, "{there}");
    let both = text.replace("[work_frame]", "[work_frame]\ntranslation_mm = [1.0, 0.0, 0.0]");
    says(&both, &["say the same"]);
    let flat = edited(&text, "a3 = [310.0, 70.0, 0.0]", "a3 = [350.0, 10.0, 0.0]");
    says(&flat, &["line"]);
}

/// Corner and RPY of a tilted work (manual 8.3): six points on the faces of a cuboid turned by roll 0.3, pitch −0.5 and yaw
/// 1.1 rad, R = Rz·Ry·Rx, with its corner at (300, 20, −30) mm.
#[test]
fn a_probed_work_names_its_corner_and_angles() {
    // Columns of R.
    let x = [0.398_068_046, 0.782_108_038, 0.479_425_539];
    let y = [-0.915_668_379, 0.307_070_726, 0.259_343_38];
    let z = [0.055_616_994, -0.542_231_118, 0.838_386_644];
    let point = |[u, v, w]: [f64; 3]| {
        let at =
            |index: usize| [300.0, 20.0, -30.0][index] + u * x[index] + v * y[index] + w * z[index];
        format!("[{:.9}, {:.9}, {:.9}]", at(0), at(1), at(2))
    };
    let mut text = shipped("gantry3").to_owned();
    text.push_str("\n[work_frame.probed_mm]\n");
    for (key, at) in [
        ("a1", [10.0, 10.0, 0.0]),
        ("a2", [90.0, 10.0, 0.0]),
        ("a3", [10.0, 70.0, 0.0]),
        ("b1", [10.0, 0.0, -5.0]),
        ("b2", [90.0, 0.0, -5.0]),
        ("c1", [0.0, 20.0, -5.0]),
    ] {
        text = text + key + " = " + &point(at) + "\n";
    }
    let [corner, angles] = load(&text).work_frame();
    for (found, wanted) in corner.iter().zip([0.3, 0.02, -0.03]) {
        assert!((found - wanted).abs() < 1e-8, "{corner:?}");
    }
    for (found, wanted) in angles.iter().zip([0.3, -0.5, 1.1]) {
        assert!((found - wanted).abs() < 1e-7, "{angles:?}");
    }
}

#[test]
fn a_modulo_axis_may_have_limits_but_both() {
    let text = edited(
        shipped("gantry_cutter3"),
        "period_deg = 360.0 ",
        "period_deg = 360.0\nposition_min_deg = -90.0 ",
    );
    let text = text
        .replace("position_min_deg = -90.0 ", "position_min_deg = -90.0\nposition_max_deg = 90.0 ");
    let limits = load(&text).axes[3].position_limits;
    assert_eq!(limits, [-90_f64, 90.0].map(f64::to_radians));
}

proptest! {
    #[test]
    fn tools_are_where_the_links_are(
        index in 0..SHIPPED.len(), parts in prop::array::uniform4(0.0..=1.0), offset in prop::array::uniform2(-30.0..30.0),
    ) {
        let (_, text) = SHIPPED[index];
        let [x, y] = offset;
        let line = format!("offset_mm = [{x}, {y}]");
        let text = if text.contains("# offset_mm") {
            text.replacen("# offset_mm = [0.0, 0.0]", &line, 1)
        } else if text.contains("offset_mm = [0.0, 0.0] ") {
            text.replacen("offset_mm = [0.0, 0.0] ", &format!("{line} "), 1)
        } else if text.contains("offset_mm = [-2.0, 0.0]") {
            text.replacen("offset_mm = [-2.0, 0.0]", &line, 1)
        } else {
            text.replacen("[tool]\n", &format!("[tool]\n{line}\n"), 1)
        };
        let machine = load(&text);
        let axes = part_of_the_way(&machine, &parts);
        match machine.kinematics.forward(&axes) {
            Ok(pose) => {
                let error = (machine.model.tip_position(&axes) - pose.position).norm();
                // A tripod's links are found by closing loops.
                prop_assert!(error < if machine.kind == "tripod" { 1e-11 } else { 1e-12 }, "{error} at {axes:?}");
                let down = machine.model.tip_position(&axes) - Vector3::zeros();
                let back = machine.kinematics.inverse(&Pose { position: down, ..pose }, &axes);
                if machine.kinematics.branch_at(&axes) == Ok(machine.kinematics.branch()) {
                    for (found, expected) in back.unwrap().iter().zip(axes.iter()) {
                        prop_assert!((found - expected).abs() < 1e-7, "{found} {expected}");
                    }
                }
            }
            Err(error) => prop_assert!(matches!(error, KinematicsError::Apart(_)), "{error}"),
        }
    }
}
