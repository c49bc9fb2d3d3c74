//! `twin check` as a process within the limits of the axes, its default, and by F and E alone.

use crate::desk::{Desk, number};
use serde_json::Value;

/// Z does 200 mm/s; N30 asks for twice of that.
const LINES: &str = "\
% lines
N10 G92 X300 Y100 Z60 F100 E2000 E-2000
N20 G1 X340 F150
N30 G1 Z0 F400
";

const AXES: &str = "--limits axes";

fn check(desk: &Desk, program: &str, options: &str, status: i32) -> Value {
    let done = desk.twin(&format!("check {program} -m machine.toml --format json {options}"));
    done.ended(status, "").object()
}

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("lines.cnc", LINES);
    desk
}

#[test]
fn a_program_too_fast_for_an_axis_is_fit_and_its_lines_are_noted() {
    let desk = desk();
    check(&desk, "lines.cnc", "--limits programmed", 1);
    let report = check(&desk, "lines.cnc", AXES, 0);
    let line = |length: f64, velocity: f64| length / velocity + velocity / 2000.0;
    let expected = line(40.0, 150.0) + line(60.0, 200.0);
    assert!((number(&report["duration_s"]) - expected).abs() < 2e-3, "{report:#}");
    assert!((number(&report["length_mm"]) - 100.0).abs() < 1e-9, "{report:#}");
    let peak = &report["peak"]["Z"]["velocity"];
    assert!(number(&peak["value"]) <= 200.2 && number(&peak["value"]) > 199.5, "{peak}");
    let findings = report["findings"].as_array().expect("a list");
    let [warning, note] = &findings[..] else { panic!("{findings:#?}") };
    assert_eq!((&warning["rule"], &warning["line"]), (&"programmed-plan".into(), &4.into()));
    let said = warning["message"].as_str().expect("text");
    assert!(said.contains("by a factor of 1.73: axis Z: velocity 346.41 mm/s"), "{said}");
    for (key, value) in [
        ("rule", Value::from("feed-reduced")),
        ("severity", "note".into()),
        ("line", 4.into()),
        ("block", 30.into()),
        ("axis", "Z".into()),
        ("unit", "mm/s".into()),
    ] {
        assert_eq!(note[key], value, "{note}");
    }
    for (key, value) in [("value", 200.0), ("limit", 400.0), ("largest_feed_mm_per_s", 200.0)] {
        assert!((number(&note[key]) - value).abs() < 1e-9, "{note}");
    }
    desk.twin("check lines.cnc -m machine.toml -v")
        .ended(0, "the programmed feed of 400 mm/s cannot be held: velocity of Z allows 200 mm/s")
        .says("fit: 0 errors, 1 warning");
}

/// The simulated machine follows what it is given.
#[test]
fn physics_follows_the_limited_path() {
    let desk = desk();
    let report = check(&desk, "lines.cnc", "--limits axes --physics", 0);
    let error = number(&report["peak"]["Z"]["following_error"]["value"]);
    assert!(error > 0.0 && error < 0.5, "{error} mm");
}

/// M functions take the time that the machine file or `--m-ack` gives them.
#[test]
fn waiting_takes_as_long_as_in_the_controllers_planning() {
    let desk = desk();
    desk.write(
        "waits.cnc",
        "% waits\nN10 G92 X300 Y100 Z60 F100 E2000 E-2000\nN20 G1 X340\nN30 M3\nN50 M7\nN60 G1 X300\n",
    );
    desk.add_to_machine("\n[[m_functions]]\nm = 3\ntime_ms = 500\n");
    let [own, axes] = ["--m-ack 30ms --limits programmed", "--m-ack 30ms"]
        .map(|options| number(&check(&desk, "waits.cnc", options, 0)["duration_s"]));
    assert!((own - axes).abs() < 3e-3, "{own} s and {axes} s");
    assert!(own > 2.0 * 0.45 + 0.5 + 0.03, "{own} s");
}

#[test]
fn what_is_wrong_stays_wrong() {
    let desk = desk();
    // X ends at 650 mm.
    desk.write("far.cnc", "% far\nN10 G92 X600 Y0 Z0 F100 E1000 E-1000\nN20 G1 X660\n");
    let report = check(&desk, "far.cnc", AXES, 1);
    let findings = report["findings"].as_array().expect("a list");
    let [finding] = &findings[..] else { panic!("{findings:#?}") };
    assert_eq!((&finding["rule"], &finding["line"]), (&"axis-position".into(), &3.into()));
    let arguments = "check lines.cnc -m machine.toml --limits axes";
    desk.twin(&format!("{arguments} --profile sigmoid")).ended(2, "--limits programmed");
}

/// At corners a knife would have to turn at once; within the limits of the axes it takes its time.
#[test]
fn a_knife_turns_in_time() {
    let desk = desk();
    let cutter = "machines/gantry_cutter3.toml";
    desk.twin(&format!("check lines.cnc -m {cutter} --format json --limits programmed"))
        .ended(1, "")
        .says("axis-velocity");
    desk.write("corner.cnc", "% c\nN10 G92 X0 Y0 Z20\nN20 G1 X50 F50 E2000 E-2000\nN30 G1 Y50\n");
    let done = desk.twin(&format!("check corner.cnc -m {cutter} --format json --limits axes"));
    let report = done.ended(0, "").object();
    // R: 1080 deg/s are reached with 20000 deg/s² after 54 ms.
    let expected = 2.0 * (50.0 / 50.0 + 50.0 / 2000.0) + 90.0 / 1080.0 + 1080.0 / 20000.0;
    assert!((number(&report["duration_s"]) - expected).abs() < 2e-3, "{report:#}");
    let peak = &report["peak"]["R"]["velocity"];
    assert!(number(&peak["value"]) <= 1081.0 && number(&peak["value"]) > 1075.0, "{peak}");
    assert_eq!(peak["line"], 4, "{peak}");
}

/// What is shipped is fit within the limits of the axes, on the machines it is for.
#[test]
fn shipped_programs_are_fit() {
    Desk::new()
        .twin("check examples/plate.cnc -m machines/scara2.toml")
        .ended(0, "")
        .says("fit: 0 errors, 0 warnings");
}

/// The largest feed of a line that passes the inner edge of a SCARA's reach is that of its worst set-point, whether a table of all
/// of them is written or not.
#[test]
fn a_table_does_not_change_what_limit_finds() {
    let desk = Desk::new();
    let largest = |options: &str| {
        let program = "examples/tutorial/bracket.cnc -m machines/scara2.toml";
        let done = desk.twin(&format!("limit {program} --format json {options}"));
        let report = done.ended(1, "").object();
        let lines = report["slowest_lines"].as_array().expect("a list").clone();
        let line = lines.iter().find(|line| line["line"] == 10).expect("it loses time");
        number(&line["largest_feed_mm_per_s"])
    };
    let (alone, with_table) = (largest(""), largest("-o bracket.csv"));
    assert!((alone - with_table).abs() < 1e-9, "{alone} {with_table}");
}
