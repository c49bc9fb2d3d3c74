//! Collisions with obstacles, reported by the binary as a process.

use crate::desk::{Desk, number, shipped};
use serde_json::Value;

/// Down next to the fixed jaw, up, and across it: 6 mm above it, since its top is at Z−10.
const ACROSS: &str = "\
G21 G90
G0 Z30
G0 X50 Y-40
G0 Z-20
G0 Z-4
G1 Y10 F1200
G0 Z30
M2
";

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("vice.toml", &shipped("machines/gantry3_vice.toml"));
    desk.write("across.ngc", ACROSS);
    desk.write("through.ngc", &ACROSS.replace("G0 Z-4", "G0 Z-12.5"));
    desk
}

#[test]
fn what_is_in_the_way_is_reported_with_its_line() {
    let desk = desk();
    desk.twin("check across.ngc -m vice.toml")
        .ended(0, "")
        .says("least clearance: 6.000 mm between the tool and fixed jaw, line 6");
    let done = desk.twin("check through.ngc -m vice.toml");
    done.ended(1, "collision").says("least clearance: none");
    let deep = "line 6: the tool is 2.500 mm deep in fixed jaw";
    assert!(done.stderr.contains(deep), "{}", done.stderr);
    let done = desk.twin("check through.ngc -m vice.toml --physics --format json");
    let report = done.ended(1, "").object();
    let clearance = &report["clearance"];
    assert!((number(&clearance["least_mm"]) + 2.5).abs() < 1e-6, "{clearance}");
    assert_eq!(clearance["between"], serde_json::json!(["the tool", "fixed jaw"]));
    assert_eq!(clearance["line"], 6);
    let findings = report["findings"].as_array().expect("a list");
    let is_hit = |one: &&Value| one["rule"] == "collision" && one["unit"] == "N";
    let hit = findings.iter().find(is_hit).expect("a blow");
    assert_eq!(hit["line"], 6, "{hit}");
    // What moves along Y weighs 13.5 kg with its rotor and stops from 20 mm/s: v·√(k·m) at 100000 N/mm.
    let peak = 0.02 * (1e8_f64 * 13.5).sqrt();
    assert!((number(&hit["value"]) / peak - 1.0).abs() < 0.2, "{hit}, not {peak} N");
}

/// The plan is free of collisions; the machine is not, since its Z jams on the way up.
#[test]
fn a_run_stops_where_the_machine_runs_into_something() {
    let desk = desk();
    desk.write("jam.toml", "[[faults]]\nkind = \"jam\"\naxis = \"Z\"\nat_line = 5\n");
    desk.twin("run across.ngc -m vice.toml --drives none --faults jam.toml --report run.json")
        .ended(2, "the tool ran into fixed jaw with");
    let report = desk.read("run.json");
    assert_eq!(report["completed"], false);
    let why = report["stopped_because"].as_str().expect("it says why");
    assert!(why.contains("the tool ran into fixed jaw with") && why.contains("line 6"), "{why}");
}

/// What `leave_out` may name is said.
#[test]
fn the_machine_says_what_is_in_the_way() {
    desk().twin("machine vice.toml").ended(0, "").says_all(&[
        "in the way: table, fixed jaw, moving jaw, screw, stock; links are looked at against each other; wanted clearance 2 mm",
        "links: base, bridge, carriage, quill, holder",
    ]);
}
