//! Tests of `[[obstacles]]`, `[collision]` and tool shapes.

use super::*;
use nalgebra::Point3;
use twin_physics::{ObstacleKind, Part};
use twin_urdf::SolidShape;

const VICE: &str = include_str!("../../../machines/gantry3_vice.toml");

/// The start is at X0 Y0 Z40 of the work, which is at X200 Y100 Z0 of the machine.
fn nearest(machine: &Machine, work_mm: [f64; 3]) -> twin_physics::Clearance {
    let place = Pose { position: (Point3::from(work_mm) * 1e-3), direction: 0.0 };
    let axes =
        machine.kinematics.inverse(&machine.frame.pose_to_machine(&place), &machine.middle());
    let mut scan = machine.clearance_scan().unwrap().expect("there is something in the way");
    scan.nearest(&axes.unwrap()).unwrap().unwrap()
}

/// What is nearest at `work_mm` are these parts, so many mm apart.
#[track_caller]
fn assert_nearest(machine: &Machine, work_mm: [f64; 3], parts: [&str; 2], mm: f64) {
    let found = nearest(machine, work_mm);
    assert_eq!(found.parts.map(|part| machine.part_name(part)), parts);
    assert!((found.distance - mm * 1e-3).abs() < 1e-9, "{found:?}, not {mm} mm");
}

#[test]
fn the_shipped_vice_is_where_it_should_be() {
    let machine = load(VICE);
    // A tool of 6 mm, 5 mm from the fixed jaw (y −20 to 0, x −20 to 120, top at −10).
    assert_nearest(&machine, [50.0, -28.0, -30.0], ["the tool", "fixed jaw"], 5.0);
    // A holder of 40 mm ends 35 mm above the tip: 4 mm above the stock with the tip 31 mm below its top.
    assert_nearest(&machine, [50.0, 30.0, -31.0], ["holder", "stock"], 4.0);
    // The tool may be in the stock and comes near to the table: top at −60.
    assert_nearest(&machine, [300.0, 150.0, -55.0], ["the tool", "table"], 5.0);
    // And the screw is left out.
    let [_, part] = nearest(&machine, [50.0, 120.0, -45.0]).parts;
    assert_ne!(machine.part_name(part), "screw");

    let collision = machine.collision.as_ref().unwrap();
    assert_eq!(collision.clearance, 2e-3);
    assert_eq!(collision.surroundings.stiffness, 1e8);
    let kinds: Vec<_> = collision.surroundings.obstacles.iter().map(|one| one.kind).collect();
    assert_eq!(kinds.iter().filter(|kind| **kind == ObstacleKind::Stock).count(), 1);
    assert_eq!(collision.surroundings.left_out.first(), Some(&[Part::Tool, Part::Obstacle(3)]));
}

/// A file that says nothing of what is around it is not looked at.
#[test]
fn nothing_is_looked_for_unasked() {
    assert!(load(GANTRY3).collision.is_none());
    assert!(load(GANTRY3).clearance_scan().unwrap().is_none());
    let alone = load(&format!("{GANTRY3}\n[collision]\n"));
    let collision = alone.collision.as_ref().unwrap();
    assert!(collision.surroundings.among_links && collision.surroundings.obstacles.is_empty());
    assert_eq!(collision.clearance, 0.0);
    let off = load(&format!("{GANTRY3}\n[collision]\nself_collision = false\n"));
    assert!(off.clearance_scan().unwrap().is_none());
}

/// Every shipped machine may be looked at: none of its links is in another where programs start.
#[test]
fn shipped_machines_do_not_run_into_themselves() {
    let folder = workspace().join("machines");
    let files = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let mut looked = 0;
    for path in files.filter(|path| path.extension().is_some_and(|end| end == "toml")) {
        let mut text = std::fs::read_to_string(&path).unwrap();
        if !text.contains("[collision]") {
            text.push_str("\n[collision]\n");
        }
        let machine =
            Machine::parse(&path, &text).unwrap_or_else(|problems| panic!("{problems:#?}"));
        let Some(mut scan) = machine.clearance_scan().unwrap() else { continue };
        let start = machine.start_axes().unwrap();
        let overlapping = scan.overlapping(&start).unwrap();
        let overlapping: Vec<_> =
            overlapping.iter().map(|pair| pair.map(|part| machine.part_name(part))).collect();
        assert!(overlapping.is_empty(), "{}: {overlapping:?}", path.display());
        let mut physics = machine.physics(&start).unwrap();
        let rest = twin_kinematics::AxisMotion::at_rest(start);
        for _ in 0..50 {
            physics.step(&rest).unwrap();
            assert!(physics.contacts().is_empty(), "{}", path.display());
        }
        looked += 1;
    }
    assert!(looked >= 6, "{looked}");
}

/// Shapes of all kinds, turned, in both frames, and a mesh next to the file.
#[test]
fn obstacles_have_any_shape() {
    let folder = tempfile::tempdir().unwrap();
    // A wedge of 20 × 10 × 10 mm: a box, cut in half.
    let [a, b, c] = ["0 0 0", "20 0 0", "0 0 10"];
    let [d, e, f] = ["0 10 0", "20 10 0", "0 10 10"];
    let faces =
        [[a, b, c], [d, f, e], [a, d, e], [a, e, b], [a, c, f], [a, f, d], [b, e, f], [b, f, c]];
    let facet = |[a, b, c]: [&str; 3]| {
        format!(
            "facet normal 0 0 0\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n"
        )
    };
    let stl = format!("solid wedge\n{}endsolid wedge\n", faces.map(facet).concat());
    std::fs::write(folder.path().join("wedge.stl"), stl).unwrap();
    let file = folder.path().join("machine.toml");
    let text = edited(
        &edited(GANTRY3, "mass_kg = 0.3", "mass_kg = 0.3\ndiameter_mm = 8"),
        "[rs274]",
        "[work_frame]\ntranslation_mm = [100.0, 0.0, 0.0]\n[rs274]",
    );
    let text = text + "\n" + include_str!("obstacles.toml");
    let machine = Machine::parse(&file, &text).unwrap_or_else(|problems| panic!("{problems:#?}"));
    // In the machine frame.
    let at = |[x, y, z]: [f64; 3], part, mm| {
        assert_nearest(&machine, [x - 100.0, y, z], ["the tool", part], mm);
    };
    // Straight above the slope of the wedge, which goes from z 20 at x 100 down to 0 at x 140 and is 20 wide: to the rim of the tool.
    let (run, rise) = (40.0_f64, 20.0_f64);
    let height = 30.0 - 20.0 * (140.0 - (120.0 - 4.0)) / 40.0;
    at([120.0, 10.0, 30.0], "wedge", height * run / run.hypot(rise));
    // Above the pipe, which lies along x.
    at([30.0, 100.0, 0.0], "pipe", 15.0);
    // Next to the pill and its end: the tool is a cylinder, too.
    at([20.0, -100.0, 0.0], "pill", 12.0);
    at([400.0, 0.0, 20.0], "ball", 8.0);
    let solid = &machine.collision.as_ref().unwrap().surroundings.obstacles[0].solids[0];
    assert!(matches!(solid.shape, SolidShape::Mesh { .. }));
}

/// Links that are drawn into each other are not looked at, and named.
#[test]
fn what_is_drawn_into_each_other_is_left_out() {
    let machine = load(&format!("{SCARA2}\n[collision]\n"));
    let collision = machine.collision.as_ref().unwrap();
    let named: Vec<_> =
        collision.overlapping.iter().map(|pair| pair.map(|part| machine.part_name(part))).collect();
    // The quill runs through its arm, to which a joint joins it: that is not an overlap.
    assert!(named.is_empty(), "{named:?}");
    // A holder as wide as a house meets all next to the quill.
    let wide =
        edited(GANTRY3, "[tool]", "[tool]\nholder_diameter_mm = 5000\nholder_length_mm = 30");
    let machine = load(&format!("{wide}\n[collision]\n"));
    let collision = machine.collision.as_ref().unwrap();
    assert!(!collision.overlapping.is_empty());
    for pair in &collision.overlapping {
        assert!(pair.iter().any(|part| machine.part_name(*part) == "holder"), "{pair:?}");
        assert!(collision.surroundings.left_out.contains(pair));
    }
}

/// Depth is the distance to the nearest way out, at any place.
#[test]
fn depths_are_those_to_the_nearest_way_out() {
    let machine = load(VICE);
    let depth = |work_mm: [f64; 3]| -nearest(&machine, work_mm).distance * 1e3;
    // Straight down into the fixed jaw, 20 mm thick with its top at -10: a tool of 6 mm in its middle comes out 13 mm to a side.
    for (z, expected) in [(-12.0, 2.0), (-15.0, 5.0), (-20.0, 10.0), (-25.0, 13.0), (-40.0, 13.0)] {
        let found = depth([50.0, -10.0, z]);
        assert!((found - expected).abs() < 1e-6, "Z{z}: {found} mm, not {expected} mm");
    }
    // The holder, 40 mm wide, comes down on the stock with the tip at Z-35.
    for (z, expected) in [(-36.0, 1.0), (-40.0, 5.0), (-50.0, 15.0)] {
        let found = depth([50.0, 30.0, z]);
        assert!((found - expected).abs() < 1e-6, "Z{z}: {found} mm, not {expected} mm");
    }
    // A flank that just touches and a tool that just rests on something do not penetrate.
    assert!(depth([50.0, -23.0, -20.0]).abs() < 1e-6);
    assert!(depth([50.0, -10.0, -10.0]).abs() < 1e-6);
}
