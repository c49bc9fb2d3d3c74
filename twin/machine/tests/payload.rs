//! Tests of the payload against closed forms.

use super::{SCARA2, edited, load, workspace};
use crate::Machine;
use nalgebra::{Point3, Vector3};
use std::f64::consts::FRAC_PI_2;
use twin_kinematics::AxisVector;
use twin_physics::axis_inertia;

/// m/s².
const G: f64 = 9.81;

const HELD: &str = "[payload]\nmass_kg = 2.5\ncenter_mm = [30.0, -20.0, -90.0]\ninertia_kg_m2 = [0.01, 0.02, 0.025]\n";
/// The same in SI.
const MASS: f64 = 2.5;
const CENTER: [f64; 3] = [0.03, -0.02, -0.09];
const ABOUT_Z: f64 = 0.025;

const SCARA3: &str = include_str!("../../../machines/scara3.toml");
const CUTTER: &str = include_str!("../../../machines/gantry_cutter3.toml");
const OFFSET_TOOL: &str = include_str!("../../../machines/gantry3_tool2.toml");
const TRIPOD: &str = include_str!("../../../machines/tripod.toml");
const PORTALS: [&str; 2] = [
    include_str!("../../../machines/gantry3.toml"),
    include_str!("../../../machines/gantry_h2.toml"),
];

fn with(text: &str, payload: &str) -> Machine {
    load(&edited(text, "[program]\n", &format!("{payload}[program]\n")))
}

/// What the payload adds to what each axis moves (kg or kg·m²) and to what holds it (N or Nm), with the axes at `position`.
fn added(text: &str, position: &AxisVector) -> [Vec<f64>; 2] {
    let [without, with] = [load(text), with(text, HELD)].map(|machine| {
        let inertia = axis_inertia(&machine.model, position).unwrap();
        let effort = machine.physics(position).unwrap().axis_state().effort;
        [inertia, effort]
    });
    [0, 1].map(|which| {
        let pairs = with[which].iter().zip(without[which].iter());
        pairs.map(|(with, without)| with - without).collect()
    })
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{found}, not {expected}");
}

/// A shoulder feels the payload at its distance, an elbow too, a quill its weight.
#[test]
fn a_scara_carries_it_at_the_end_of_its_arm() {
    let elbow = 0.7_f64;
    let [inertia, effort] = added(SCARA2, &AxisVector::from_values([0.4, elbow, 0.02]));
    let [x, y, _] = CENTER;
    // From the elbow, along and across the second arm; and the first arm of 250 mm, seen from there.
    let from_elbow = Vector3::new(0.2 + x, y, 0.0);
    let from_shoulder = from_elbow + Vector3::new(0.25 * elbow.cos(), -0.25 * elbow.sin(), 0.0);
    near(inertia[0], MASS * from_shoulder.norm_squared() + ABOUT_Z);
    near(inertia[1], MASS * from_elbow.norm_squared() + ABOUT_Z);
    near(inertia[2], MASS);
    for (effort, expected) in effort.into_iter().zip([0.0, 0.0, MASS * G]) {
        near(effort, expected);
    }
}

/// On a wall, with gravity along −x, the arms hold it as well: m·g times its distance from the axis.
#[test]
fn gravity_pulls_it_whichever_way_it_goes() {
    let text = edited(SCARA2, "[0.0, 0.0, -9.81]", "[-9.81, 0.0, 0.0]");
    let position = AxisVector::from_values([0.4, 0.7, 0.02]);
    let [_, effort] = added(&text, &position);
    let [x, y, _] = CENTER;
    let (second, first) = (1.1_f64.sin_cos(), 0.4_f64.sin_cos());
    // y of the payload, from the elbow and from the shoulder: a torque that turns it up, against a pull along −x, is −m·g·y.
    let from_elbow = (0.2 + x) * second.0 + y * second.1;
    let from_shoulder = 0.25 * first.0 + from_elbow;
    near(effort[0], -MASS * G * from_shoulder);
    near(effort[1], -MASS * G * from_elbow);
    near(effort[2], 0.0);
}

/// The frame of the flange is at the end of the hand of 40 mm, and turns with it; that of a knife turns about the axis of R.
#[test]
fn hands_and_knives_turn_it() {
    let [x, y, _] = CENTER;
    for (text, name, reach) in [(SCARA3, "C", 0.04), (CUTTER, "R", 0.0)] {
        let machine = load(text);
        let axis = machine.axes.iter().position(|axis| axis.name == name).unwrap();
        let [inertia, effort] = added(text, &machine.middle());
        near(inertia[axis], MASS * ((reach + x) * (reach + x) + y * y) + ABOUT_Z);
        let lifted = machine.axes.iter().position(|axis| axis.name == "Z").unwrap();
        near(effort[lifted], MASS * G);
    }
}

#[test]
fn portals_and_tripods_carry_it() {
    for text in PORTALS {
        let [inertia, effort] = added(text, &AxisVector::zeros(3));
        // Each motor of a belt feels half of it along x and half along y: ¼·m each.
        let along = if text.contains("kind = \"gantry_h2\"") { 0.5 * MASS } else { MASS };
        for (found, expected) in inertia.into_iter().zip([along, along, MASS]) {
            near(found, expected);
        }
        for (found, expected) in effort.into_iter().zip([0.0, 0.0, MASS * G]) {
            near(found, expected);
        }
    }
    // A platform that stays level does not mind where it is; in the middle each motor has a third of it.
    let [_, effort] = added(TRIPOD, &AxisVector::from_values([0.4; 3]));
    for effort in effort {
        assert!((effort - MASS * G / 3.0).abs() < 1e-9, "{effort}");
    }
}

/// Where it is: as seen from the flange, which is where the tool begins; at the tip of the tool unless something is said.
#[test]
fn it_hangs_where_the_tool_does() {
    // By what it adds to the first moment of the link that carries the tool, in the machine frame.
    let center = |without: &Machine, with: &Machine, position: &[f64]| {
        let moment = |machine: &Machine| {
            let link = machine.model.tip.link;
            // The tip of a URDF may be a frame without a body.
            let Some(body) = machine.model.links[link].inertial else {
                return (0.0, Vector3::zeros());
            };
            let center = machine.model.link_poses(position)[link] * body.center;
            (body.mass, center.coords * body.mass)
        };
        let ((light, before), (heavy, after)) = (moment(without), moment(with));
        near(heavy - light, MASS);
        Point3::from((after - before) / MASS)
    };
    let [x, y, z] = CENTER;
    let expect = |found: Point3<f64>, expected: [f64; 3]| {
        assert!((found - Point3::from(expected)).norm() < 1e-12, "{found}, not {expected:?}");
    };
    let axes = [0.1, 0.2, 0.03];
    // Away from the crossing of the axes, 60 mm along +y and 15 mm to the left of that.
    expect(
        center(&load(OFFSET_TOOL), &with(OFFSET_TOOL, HELD), &axes),
        [0.1 - 0.015 + x, 0.2 + 0.06 + y, 0.03 + z],
    );
    let tip = "[payload]\nmass_kg = 2.5\n";
    expect(center(&load(OFFSET_TOOL), &with(OFFSET_TOOL, tip), &axes), [0.085, 0.26, 0.03 - 0.04]);
    // A URDF whose last link is upside down: along the last arm, to its left, and down all the same.
    let path = workspace().join("tests/data/urdf_scara/machine.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let read = |payload: &str| {
        let tool = "[tool]\nlength_mm = 60.0\noffset_mm = [20.0, 7.0]\n";
        let text = edited(&text, "[program]\n", &format!("{tool}{payload}[program]\n"));
        Machine::parse(&path, &text).unwrap_or_else(|problems| panic!("{problems:#?}"))
    };
    let axes = [0.0, FRAC_PI_2, -0.1];
    expect(center(&read(""), &read(HELD), &axes), [0.425 - y, 0.345 + x, -0.1 + z]);
    expect(center(&read(""), &read(tip), &axes), [0.425 - 0.007, 0.345 + 0.02, -0.16]);
    // And it weighs there what it does elsewhere.
    let position = AxisVector::from_values(axes);
    let [without, with] = [read(""), read(HELD)].map(|machine| {
        let inertia = axis_inertia(&machine.model, &position).unwrap();
        let effort = machine.physics(&position).unwrap().axis_state().effort;
        [inertia[1], effort[2]]
    });
    near(with[0] - without[0], MASS * ((0.345 + x) * (0.345 + x) + y * y) + ABOUT_Z);
    near((with[1] - without[1]).abs(), MASS * G);
}

#[test]
fn nothing_is_held_by_default() {
    for text in ["", "[payload]\nmass_kg = 0.0\n"] {
        assert_eq!(with(SCARA2, text).model, load(SCARA2).model);
    }
    let machine = with(SCARA2, HELD);
    near(machine.moving_mass() - load(SCARA2).moving_mass(), MASS);
}
