//! `twin run --limits axes` as a process: the run moves exactly as the check within the limits of the axes.

use crate::desk::{Desk, number};

/// 40 mm of X at 150 mm/s, then 60 mm of Z, which does 200 mm/s and is asked for twice of that.
const LINES: &str = "\
% lines
N10 G92 X0 Y0 Z-40 F100 E2000 E-2000
N20 G1 X40 F150
N30 G1 Z20 F400
";
const CIRCLES: &str = "% circles\nN10 G2 I30 J0 F100 E500 E-500\nN20 G2 I30 J0\nN30 G2 I30 J0\n";

const RUN: &str = "-m machine.toml --report r.json --limits axes";

#[test]
fn what_is_too_fast_for_an_axis_runs_within_its_limits() {
    let desk = Desk::new();
    desk.allow_late_drives();
    desk.write("lines.cnc", LINES);
    desk.twin("run lines.cnc -m machine.toml --limits programmed").ended(1, "axis-velocity");
    let expected: f64 =
        [(40.0, 150.0), (60.0, 200.0)].iter().map(|(length, v)| length / v + v / 2000.0).sum();
    let mut errors = Vec::new();
    for drives in ["none", "emulated"] {
        desk.twin(&format!("run lines.cnc {RUN} --drives {drives} --tolerance 5"))
            .ended(0, "the programmed feed of 400 mm/s cannot be held");
        let report = desk.read("r.json");
        assert_eq!(report["completed"], true);
        assert_eq!(report["executed_s"], report["duration_s"]);
        assert!((number(&report["executed_s"]) - expected).abs() < 2e-3, "{report:#}");
        assert!(number(&report["peak"]["Z"]["velocity"]["value"]) <= 200.2, "{report:#}");
        errors.push(report["tool_error_mm"]["twin"].clone());
        let heard = report["tool_error_mm"]["drives"]["max"].as_f64();
        assert_eq!(heard.is_some_and(|error| error > 0.0), drives == "emulated");
    }
    assert_eq!(errors[0], errors[1], "the same set-points");
    // As `twin check` says it.
    let checked = desk.twin("check lines.cnc -m machine.toml --limits axes --format json").object();
    for key in ["duration_s", "length_mm", "peak", "findings"] {
        assert_eq!(checked[key], desk.read("r.json")[key], "{key}");
    }
}

/// Two lines of 50 mm at F50 and E2000, and between them a quarter of a turn of the knife: 1080 deg/s, 20000 deg/s².
#[test]
fn a_knife_turns_where_the_path_rests() {
    let desk = Desk::new();
    desk.write("corner.cnc", "% c\nN10 G92 X0 Y0 Z20\nN20 G1 X50 F50 E2000 E-2000\nN30 G1 Y50\n");
    let run = "run corner.cnc -m machines/gantry_cutter3.toml --drives none --report r.json";
    desk.twin(&format!("{run} --limits axes")).ended(0, "");
    let report = desk.read("r.json");
    assert_eq!(report["completed"], true);
    let expected = 2.0 * (50.0 / 50.0 + 50.0 / 2000.0) + 90.0 / 1080.0 + 1080.0 / 20000.0;
    assert!((number(&report["executed_s"]) - expected).abs() < 2e-3, "{report:#}");
}

#[test]
fn an_override_from_the_start_scales_what_is_programmed() {
    let desk = Desk::new();
    desk.write("lines.cnc", LINES);
    // 75 mm/s, and 200 mm/s, which is all that Z can do and now also what it is asked for.
    let expected: f64 =
        [(40.0, 75.0), (60.0, 200.0)].iter().map(|(length, v)| length / v + v / 2000.0).sum();
    desk.twin(&format!("run lines.cnc {RUN} --drives none --override 50%")).ended(0, "");
    let report = desk.read("r.json");
    assert_eq!(report["executed_s"], report["duration_s"]);
    assert!((number(&report["executed_s"]) - expected).abs() < 2e-3, "{report:#} {expected}");
}

#[test]
fn what_says_nothing_within_the_limits_of_the_axes_is_refused() {
    let desk = Desk::new();
    desk.write("lines.cnc", LINES);
    for (options, message) in [
        ("--profile sigmoid", "--profile is for the plan by F and E alone"),
        ("--override 201%", "within the limits of the axes --override is 200 at most"),
        ("--override-at 1s=0", "the path would be held for ever"),
        ("--override-at 1s=300", "overrides go from 1 % to 200 %"),
    ] {
        desk.twin(&format!("run lines.cnc {options} {RUN}")).ended(2, message);
    }
}

#[test]
fn the_override_changes_while_a_program_runs() {
    let desk = Desk::new();
    desk.write("circles.cnc", CIRCLES);
    for limits in ["axes", "programmed"] {
        let run = format!("run circles.cnc -m machine.toml --limits {limits} --drives none");
        desk.twin(&format!("{run} --report plain.json")).ended(0, "");
        let changes = "--override-at 0.5s=50%,1s=0 --override-at 2s=100";
        desk.twin(&format!("{run} {changes} --report r.json"))
            .ended(0, "")
            .says("feed hold asked for at 1.000 s");
        let (plain, report) = (desk.read("plain.json"), desk.read("r.json"));
        assert!(plain.get("override_changes").is_none());
        let changes = report["override_changes"].as_array().expect("changes");
        let asked: Vec<_> = changes
            .iter()
            .map(|change| (number(&change["asked_s"]), number(&change["override_percent"])))
            .collect();
        assert_eq!(asked, [(0.5, 50.0), (1.0, 0.0), (2.0, 100.0)]);
        for change in changes {
            assert!((0.0..=0.12).contains(&number(&change["followed_after_s"])), "{report:#}");
        }
        // Half a second at half the feed, and a second of rest; what it takes to slow down and speed up has no bearing on a
        // tenth of a second.
        let later = number(&report["executed_s"]) - number(&plain["executed_s"]);
        assert!((later - 1.25).abs() < 0.15, "{later}");
    }
}

#[test]
fn ctrl_c_brakes_on_the_path() {
    let desk = Desk::new();
    desk.write("circles.cnc", CIRCLES);
    desk.interrupted("-INT", "emulated InterpCNC", &format!("run circles.cnc {RUN}"))
        .ended(2, "stopped by the user at line 2 (N10)");
    let report = desk.read("r.json");
    assert_eq!(report["completed"], false);
    let reason = report["stopped_because"].as_str().expect("a reason");
    assert!(!reason.contains("left the path"), "{reason}");
    let (executed, duration) = (number(&report["executed_s"]), number(&report["duration_s"]));
    assert!(executed > 0.1 && executed < duration - 1.0, "{executed} s of {duration} s");
}
