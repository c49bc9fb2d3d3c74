//! Tests of approaches: the vice of `machines/gantry3_vice.toml`, and machines without a lifting axis.

use super::{Approach, ApproachError, Leg};
use std::path::Path;
use twin_kinematics::{AxisVector, Kinematics};
use twin_machine::Machine;

/// Jaws with their tops at Z−10 from X180 to X320, the fixed one at Y80 to Y100, the moving one at Y160 to Y180; stock
/// between them up to Z0; a table at Z−60. The tool is 6 mm thick.
const VICE: &str = include_str!("../../machines/gantry3_vice.toml");

fn machine(text: &str) -> Machine {
    Machine::parse(Path::new("vice.toml"), text).unwrap_or_else(|problems| panic!("{problems:#?}"))
}

fn vice(program: &str) -> Machine {
    machine(&VICE.replace("[program]\n", &format!("[program]\n{program}\n")))
}

/// Axis positions for a tip, mm: the tool is 60 mm long.
fn axes([x, y, z]: [f64; 3]) -> AxisVector {
    AxisVector::from_values([x, y, z + 60.0].into_iter().map(|value| value * 1e-3))
}

/// From tip to tip.
fn planned(machine: &Machine, from: [f64; 3], to: [f64; 3]) -> Result<Approach, ApproachError> {
    Approach::plan(machine, None, [&axes(from), &axes(to)], 0.25)
}

/// What moves in each step, and the tip at its end.
fn steps(machine: &Machine, way: &Approach) -> Vec<[String; 2]> {
    let described = way.described(machine);
    let halves = described.map(|step| {
        let (axes, tip) = step.split_once("; tool tip at ").unwrap();
        [axes.to_owned(), tip.to_owned()]
    });
    halves.collect()
}

/// All axes at once would cut through the moving jaw: the tool goes up to where it is clear by the 2 mm that are wanted.
#[test]
fn the_tool_goes_up_across_and_down() {
    let machine = vice("");
    let way = planned(&machine, [250.0, 230.0, -30.0], [250.0, 60.0, 20.0]).unwrap();
    let expected = [
        ["Z to 80.000 mm", "X 250.000 Y 230.000 Z 20.000 mm"],
        ["Y to 60.000 mm", "X 250.000 Y 60.000 Z 20.000 mm"],
    ];
    assert_eq!(steps(&machine, &way), expected);
    let deep = planned(&machine, [250.0, 230.0, -30.0], [250.0, 60.0, -40.0]).unwrap();
    // Tops at -10, stock at 0: at 0 it touches, and 10 keeps 2 mm.
    let heights: Vec<_> = steps(&machine, &deep).into_iter().map(|[axes, _]| axes).collect();
    assert_eq!(heights, ["Z to 70.000 mm", "Y to 60.000 mm", "Z to 20.000 mm"]);
    assert!(deep.nearest().is_some_and(|nearest| nearest.distance >= 2e-3), "{deep:?}");
    // That the tip begins on the table says nothing of the way across.
    let low = planned(&machine, [250.0, 230.0, -60.0], [250.0, 60.0, -40.0]).unwrap();
    let heights: Vec<_> = steps(&machine, &low).into_iter().map(|[axes, _]| axes).collect();
    assert_eq!(heights, ["Z to 70.000 mm", "Y to 60.000 mm", "Z to 20.000 mm"]);
    let together = vice("approach = \"together\"");
    let error = planned(&together, [250.0, 230.0, -30.0], [250.0, 60.0, -40.0]).unwrap_err();
    let ApproachError::Collision { leg: Leg::Straight, other, .. } = &error else {
        panic!("{error:?}")
    };
    assert_eq!(other, "moving jaw");
}

#[test]
fn the_file_gives_height_and_order() {
    let machine = vice("safe_z_mm = 33.5");
    let way = planned(&machine, [0.0, 0.0, 0.0], [250.0, 60.0, 20.0]).unwrap();
    let moved =
        |way: &Approach| steps(&machine, way).into_iter().map(|[axes, _]| axes).collect::<Vec<_>>();
    let expected = ["Z to 93.500 mm", "X to 250.000 mm, Y to 60.000 mm", "Z to 80.000 mm"];
    assert_eq!(moved(&way), expected);
    assert_eq!(steps(&machine, &way)[1][1], "X 250.000 Y 60.000 Z 33.500 mm");
    // Where an end is higher, that counts.
    let way = planned(&machine, [0.0, 0.0, 50.0], [250.0, 60.0, 20.0]).unwrap();
    assert_eq!(moved(&way), ["X to 250.000 mm, Y to 60.000 mm", "Z to 80.000 mm"]);
    let machine = vice("approach = \"axis-by-axis\"");
    let way = planned(&machine, [0.0, 0.0, 0.0], [250.0, 60.0, 20.0]).unwrap();
    let moved: Vec<_> = steps(&machine, &way).into_iter().map(|[axes, _]| axes).collect();
    assert_eq!(moved, ["X to 250.000 mm", "Y to 60.000 mm", "Z to 80.000 mm"]);
    let text = VICE.replace("[program]\n", "[program]\nsafe_z_mm = 1\napproach = \"together\"\n");
    let problems = Machine::parse(Path::new("vice.toml"), &text).unwrap_err();
    assert!(format!("{problems:?}").contains("has a height"), "{problems:?}");
}

/// A tip in an obstacle, or in the stock, which a program may cut; a start in an obstacle.
#[test]
fn obstacles_at_both_ends_are_named() {
    let machine = vice("");
    // The holder is 40 mm wide, 35 mm above the tip.
    for (from, part) in [([250.0, 170.0, -15.0], "moving jaw"), ([250.0, 130.0, -5.0], "stock")] {
        let error = planned(&machine, from, [250.0, 60.0, 20.0]).unwrap_err();
        let ApproachError::Inside { other, depth_mm, .. } = &error else { panic!("{error:?}") };
        assert_eq!((other.as_str(), (depth_mm - 5.0).abs() < 1e-3), (part, true), "{error}");
    }
    let machine = vice("");
    let error = planned(&machine, [0.0, 0.0, 40.0], [250.0, 170.0, -15.0]).unwrap_err();
    let ApproachError::Collision { leg: Leg::Down, other, tip_mm, .. } = &error else {
        panic!("{error:?}")
    };
    assert_eq!((other.as_str(), (tip_mm[2] + 10.0).abs() < 0.1), ("moving jaw", true), "{error}");
}

/// A wall that no height of the axis gets over.
#[test]
fn without_a_clear_height_it_is_refused() {
    // To Z65; the tip comes to Z60.
    let wall = VICE.replace("size_mm = [140.0, 20.0, 50.0]", "size_mm = [140.0, 20.0, 200.0]");
    let error = planned(&machine(&wall), [250.0, 230.0, 20.0], [250.0, 0.0, 20.0]).unwrap_err();
    let ApproachError::Collision { leg: Leg::Across, other, .. } = &error else {
        panic!("{error:?}")
    };
    assert_eq!(other, "moving jaw");
    assert!(error.to_string().starts_with("on the way across, "), "{error}");
}

#[test]
fn a_height_beyond_the_axis_is_refused() {
    let machine = vice("safe_z_mm = 70");
    let error = planned(&machine, [0.0; 3], [250.0, 60.0, 20.0]).unwrap_err();
    let said = "on the way up, axis Z would go to 120.0";
    assert!(error.to_string().starts_with(said), "{error}");
}

/// Every set-point keeps the limits, the first and the last rest, and each follows the one before.
#[test]
fn setpoints_keep_the_limits_of_the_axes() {
    let files = ["gantry3_vice", "gantry3", "scara2", "scara3", "tripod", "gantry_h2"];
    for file in files {
        let path = format!("../machines/{file}.toml");
        let machine = Machine::load(Path::new(&path)).unwrap();
        let start = machine.start_without_slaves().unwrap();
        let mut from = start;
        for (axis, position) in machine.axes.iter().zip(from.iter_mut()) {
            let [low, high] = axis.position_limits;
            *position += 0.05 * (high - low).min(3.0);
        }
        let way = Approach::plan(&machine, None, [&from, &start], 0.25).unwrap_or_else(|error| {
            panic!("{file}: {error}");
        });
        let setpoints: Vec<_> = way.setpoints(&machine).collect();
        let ends = [setpoints[0], setpoints[setpoints.len() - 1]];
        for (end, expected) in ends.iter().zip([&from, &start]) {
            for (position, expected) in end.axes.position.iter().zip(expected.iter()) {
                assert!((position - expected).abs() < 1e-9, "{file}: {position} {expected}");
            }
            assert!(end.axes.velocity.iter().all(|velocity| velocity.abs() < 1e-9), "{file}");
        }
        for pair in setpoints.windows(2) {
            let [before, now] = [&pair[0].axes, &pair[1].axes];
            for (index, axis) in machine.axes.iter().enumerate() {
                let step = (now.position[index] - before.position[index]) / 1e-3;
                let change = (now.velocity[index] - before.velocity[index]) / 1e-3;
                let slack = 1.0 + 1e-6;
                assert!(step.abs() <= 0.25 * axis.max_velocity * slack, "{file} {}", axis.name);
                let most = axis.max_acceleration.max(axis.max_deceleration);
                assert!(change.abs() <= most * slack, "{file} {}: {change}", axis.name);
                let mean = now.velocity[index].midpoint(before.velocity[index]);
                assert!((step - mean).abs() <= 1e-3 * most, "{file} {}: {step} {mean}", axis.name);
            }
        }
    }
}

/// The tool of a tripod, which no axis lifts alone, goes straight up, across at one height and straight down.
#[test]
fn a_tripod_lifts_its_tool_straight() {
    let text = std::fs::read_to_string("../machines/tripod.toml").unwrap();
    let text = text.replace("[program]\n", "[program]\nsafe_z_mm = 80\n");
    let machine = machine(&text);
    let at = |x: f64, y: f64, z: f64| {
        let pose = twin_kinematics::Pose::at(x * 1e-3, y * 1e-3, z * 1e-3);
        machine.kinematics.inverse(&pose, &machine.middle()).unwrap()
    };
    let way = Approach::plan(&machine, None, [&at(40.0, 0.0, 20.0), &at(-30.0, 50.0, 40.0)], 0.25)
        .unwrap();
    let mut heights = Vec::new();
    for setpoint in way.setpoints(&machine) {
        let tip = machine.kinematics.forward(&setpoint.axes.position).unwrap().position * 1e3;
        heights.push(tip.z);
        let aside = (tip.x - 40.0).hypot(tip.y).min((tip.x + 30.0).hypot(tip.y - 50.0));
        assert!(aside < 1e-6 || (tip.z - 80.0).abs() < 1e-6, "{tip}");
    }
    assert!((heights[0] - 20.0).abs() < 1e-6 && (heights[heights.len() - 1] - 40.0).abs() < 1e-6);
    assert!(heights.iter().any(|height| (height - 80.0).abs() < 1e-6));
}
