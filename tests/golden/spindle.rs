//! The tool in the spindle: in sequences, on the simulated machine, when probing, on the way to the start, and in messages.
//!
//! The fixed jaw of the vice has its top at Z-10. The tip of a tool of the table is below the controlled point by its length.

use crate::desk::{Desk, Done, number, shipped};
use serde_json::Value;

/// A short, a long and an even tool; tool 5 is 20 mm shorter than that of the machine file.
const TOOLS: &str = "\
[[tools]]
number = 3
length_mm = 20
[[tools]]
number = 4
length_mm = 0
diameter_mm = 6
[[tools]]
number = 5
length_mm = -20
";

/// Above the fixed jaw down to a height, with 10 mm/s.
fn down(z_mm: f64) -> String {
    format!("G0 X50 Y-10\nG1 Z{z_mm} F600\nG0 Z30\nM2\n")
}

fn desk() -> Desk {
    let desk = Desk::new();
    let machine = shipped("machines/gantry3_vice.toml");
    let with_tools = machine.replace("[rs274]\n", "[rs274]\ntool_table = \"tools.toml\"\n");
    desk.write("vice.toml", &with_tools);
    desk.write("long.toml", &with_tools.replace("[rs274]\n", "[rs274]\ntool = 3\n"));
    desk.write("tools.toml", TOOLS);
    desk
}

/// Reports of all programs of a check.
fn reports(done: &Done) -> Vec<Value> {
    let lines = done.stdout.lines();
    lines.map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}"))).collect()
}

/// Least clearance, mm, and what is near to what.
fn least(report: &Value) -> (f64, [&str; 2]) {
    let clearance = &report["clearance"];
    let name = |index: usize| clearance["between"][index].as_str().unwrap_or_default();
    (number(&clearance["least_mm"]), [name(0), name(1)])
}

fn messages(report: &Value) -> Vec<&str> {
    let findings = report["findings"].as_array().map_or(&[][..], Vec::as_slice);
    findings.iter().filter_map(|one| one["message"].as_str()).collect()
}

#[track_caller]
fn assert_least(report: &Value, mm: f64, parts: [&str; 2]) {
    let (found, names) = least(report);
    assert!((found - mm).abs() < 1e-3 && names == parts, "{found} mm, {names:?}: {report:#}");
}

/// At M2 LinuxCNC keeps the tool and its offset: #5400 is 3 and #5403 20 in the next program, whose Z8 is 20 mm higher.
#[test]
fn a_sequence_keeps_tool_and_offset() {
    let desk = desk();
    desk.write("with.ngc", "T3 M6\nG43\nG0 Z30\nM2\n");
    desk.write("without.ngc", "T3 M6\nG0 Z30\nM2\n");
    desk.write("down.ngc", &down(8.0));
    desk.write("kept.ngc", "G0 Z[#5400+#5403+10]\nM2\n");
    let check = "check --sequence -m vice.toml --format json";
    let done = desk.twin(&format!("{check} without.ngc down.ngc"));
    let [_, second] = &reports(done.ended(1, ""))[..] else { panic!("{}", done.stdout) };
    assert_least(second, -2.0, ["tool 3", "fixed jaw"]);
    let deep = "tool 3 is 2.000 mm deep in fixed jaw";
    assert!(messages(second).iter().any(|one| one.starts_with(deep)), "{second:#}");
    let done = desk.twin(&format!("{check} with.ngc down.ngc kept.ngc"));
    let [_, second, third] = &reports(done.ended(0, ""))[..] else { panic!("{}", done.stdout) };
    assert_least(second, 18.0, ["tool 3", "fixed jaw"]);
    // Z33, 20 mm higher by the offset; the axis is at 60 mm where the tool of the machine file has its tip at 0.
    let z = &third["peak"]["Z"]["position"];
    assert!((number(&z["max"]) - (60.0 + 33.0 + 20.0)).abs() < 1e-6, "{third:#}");
    // Each by itself begins with `tool` of the machine file, as the first of a sequence does.
    let alone = "check -m vice.toml --format json";
    let done = desk.twin(&format!("{alone} without.ngc down.ngc"));
    let [_, second] = &reports(done.ended(0, ""))[..] else { panic!("{}", done.stdout) };
    assert_least(second, 18.0, ["the tool", "fixed jaw"]);
    let done = desk.twin("check --sequence -m long.toml --format json down.ngc");
    assert_least(&done.ended(1, "").object(), -2.0, ["tool 3", "fixed jaw"]);
}

/// The same in a run, which moves nothing.
#[test]
fn a_run_of_several_programs_keeps_the_tool() {
    let desk = desk();
    desk.write("without.ngc", "T3 M6\nG0 Z30\nM2\n");
    desk.write("down.ngc", &down(8.0));
    desk.twin("run without.ngc down.ngc -m vice.toml --drives none")
        .ended(1, "tool 3 is 2.000 mm deep in fixed jaw");
    desk.write("down.ngc", &down(12.0));
    desk.twin("run without.ngc down.ngc -m vice.toml --drives none").ended(0, "");
}

/// A long tool runs into the jaw 20 mm higher than that of the machine file, and a short one does not reach it.
#[test]
fn the_simulated_machine_changes_its_tool() {
    let desk = desk();
    let check = "check down.ngc -m vice.toml --physics --format json --limits programmed";
    desk.write("down.ngc", &format!("T3 M6\n{}", down(8.0)));
    let report = desk.twin(check).ended(1, "").object();
    let ran = "tool 3 ran into fixed jaw with 10.0 mm/s in the simulated machine";
    assert!(messages(&report).iter().any(|one| one.starts_with(ran)), "{report:#}");
    // 2 mm above the jaw.
    desk.write("down.ngc", &format!("T3 M6\n{}", down(12.0)));
    let report = desk.twin(check).ended(0, "").object();
    assert_least(&report, 2.0, ["tool 3", "fixed jaw"]);
    // Z-12 is 8 mm above it with the short tool.
    desk.write("down.ngc", &format!("M61 Q5\n{}", down(-12.0)));
    let report = desk.twin(check).ended(0, "").object();
    assert_least(&report, 18.0, ["tool 5", "fixed jaw"]);
    // And with that in the spindle at the beginning, until M6 puts in the other.
    let long = check.replace("vice", "long");
    desk.write("down.ngc", &format!("{}T4 M6\n{}", down(12.0).replace("M2\n", ""), down(-7.0)));
    let report = desk.twin(&long).ended(0, "").object();
    assert_least(&report, 2.0, ["tool 3", "fixed jaw"]);
    desk.write("down.ngc", &down(8.0));
    let report = desk.twin(&long).ended(1, "").object();
    assert!(messages(&report).iter().any(|one| one.starts_with(ran)), "{report:#}");
}

/// A tool that is too long for the place where it is put in ends the simulation there.
#[test]
fn a_tool_change_in_an_obstacle_is_reported() {
    let desk = desk();
    desk.write("low.ngc", "G0 X50 Y-10\nG0 Z5\nT3 M6\nG0 Z30\nM2\n");
    let done = desk.twin("check low.ngc -m vice.toml --physics --format json");
    let report = done.ended(1, "").object();
    // 5 - 20 mm is 5 mm below the top of the jaw.
    let found = messages(&report);
    assert!(found.iter().any(|one| one.starts_with("tool 3 is 5.000 mm deep in")), "{report:#}");
    let note = "not simulated from here on: tool 3 and fixed jaw overlap after the tool change";
    assert!(found.contains(&note), "{report:#}");
}

/// A probe ends where the tip of the tool in the spindle touches, with G43 or without.
#[test]
fn the_tool_in_the_spindle_probes() {
    let desk = desk();
    for (tool, z_mm, controlled_mm) in [
        ("", -10.0, -10.0),
        ("T3 M6", 10.0, 10.0),
        ("T3 M6 G43", -10.0, 10.0),
        ("M61 Q5", -30.0, -30.0),
    ] {
        let from = z_mm + 20.0;
        let to = z_mm - 20.0;
        let program = format!("G0 X50 Y-10\n{tool}\nG0 Z{from}\nG38.2 Z{to} F60\nG0 Z30\nM2\n");
        desk.write("probe.ngc", &program);
        let done = desk.twin("check probe.ngc -m vice.toml --physics --format json");
        let report = done.ended(0, "").object();
        let touches = format!("probe touches at X 50.000 Y -10.000 Z {controlled_mm:.3} mm");
        let found = messages(&report);
        assert!(found.contains(&touches.as_str()), "{tool}: {report:#}");
        let felt = "in the simulated machine the probe touched at X 50.000 Y -10.000 Z ";
        let felt_mm = found.iter().find_map(|one| one.strip_prefix(felt)?.strip_suffix(" mm"));
        let felt_mm: f64 = felt_mm.and_then(|mm| mm.parse().ok()).unwrap_or(f64::NAN);
        assert!((felt_mm - controlled_mm).abs() < 0.05, "{tool}: {report:#}");
    }
}

/// Emulated drives begin with every axis at 0: the tool of the machine file stands on the table, tool 3 would be 20 mm in it.
#[test]
fn the_way_to_the_start_has_the_tool() {
    let desk = desk();
    desk.write("part.ngc", "G0 Z41\nM2\n");
    for (machine, status, expected) in [
        ("vice.toml", 0, "least clearance 0.0 mm, between the tool and table"),
        ("long.toml", 2, "tool 3 is 20.000 mm deep in table where the axes are now"),
    ] {
        let text = desk.text(machine);
        let late = text.replace("following_error_mm = 0.5", "following_error_mm = 100.0");
        desk.write(machine, &late);
        desk.twin(&format!("run part.ngc -m {machine} --drives emulated")).ended(status, expected);
    }
}

/// A diameter without a length is of use to the tools of a table alone.
#[test]
fn a_tool_without_length_needs_a_table() {
    let desk = desk();
    let bare = |name: &str| desk.text(name).replace("length_mm = 60.0\nmass_kg", "mass_kg");
    let in_table = bare("vice.toml");
    assert!(in_table != desk.text("vice.toml"));
    desk.write("bare.toml", &in_table.replace("tool_table = \"tools.toml\"\n", ""));
    desk.twin("machine bare.toml")
        .ended(2, "the tool has a diameter and no length: add `length_mm`");
    desk.write("table.toml", &in_table.replace("holder_", "# holder_"));
    desk.twin("machine table.toml").ended(0, "");
}
