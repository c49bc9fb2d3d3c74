//! Tests of collision checks against closed forms.

use crate::check::{CheckOptions, Outcome, check};
use crate::finding::{Finding, Rule, Severity};
use crate::limit::Limits;
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use twin_machine::Machine;

/// Jaws with their tops at Z−10, the fixed one from Y−20 to Y0, stock from Z−30 to Z0; a tool of 6 mm, a holder 35 mm above its tip.
const VICE: &str = include_str!("../../machines/gantry3_vice.toml");

/// Tools: thin, thick, long, longer.
const TOOLS: &str = "\
[[tools]]
number = 1
diameter_mm = 3
[[tools]]
number = 2
diameter_mm = 16
[[tools]]
number = 3
length_mm = 20
[[tools]]
number = 4
length_mm = 60
";

/// `machine` with these tools.
fn with_tools(machine: &str) -> String {
    machine.replace("[rs274]\n", "[rs274]\ntool_table = \"tools.toml\"\n")
}

fn checked(machine: &str, program: &str, physics: bool) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tools.toml"), TOOLS).unwrap();
    let machine = Machine::parse(&folder.path().join("machine.toml"), machine)
        .unwrap_or_else(|problems| panic!("{problems:#?}"));
    let path = folder.path().join("program.ngc");
    std::fs::write(&path, program).unwrap();
    let program = ProgramFile::new(&path, Some(Dialect::Rs274), ReadSettings::default()).unwrap();
    let options = CheckOptions { limits: Limits::Programmed, physics, ..CheckOptions::default() };
    check(&machine, &program, options, &mut |_| {}).unwrap()
}

fn collisions(outcome: &Outcome, severity: Severity) -> Vec<&Finding> {
    let fits = |finding: &&Finding| finding.rule == Rule::Collision && finding.severity == severity;
    outcome.findings.iter().filter(fits).collect()
}

/// A slot across the fixed jaw, so deep.
fn slot(z: f64) -> String {
    format!("G0 Z30\nG0 X50 Y-40\nG0 Z5\nG1 Z{z} F600\nG1 Y10 F900\nG0 Z30\nM2\n")
}

#[test]
fn depth_and_line_are_reported() {
    let outcome = checked(VICE, &slot(-12.0), false);
    let [hit] = collisions(&outcome, Severity::Error)[..] else { panic!("{outcome:#?}") };
    assert_eq!((hit.line, hit.unit), (5, Some("mm")));
    assert!((hit.value.unwrap() + 2.0).abs() < 1e-6, "{hit:?}");
    assert!(hit.message.starts_with("the tool is 2.000 mm deep in fixed jaw, at X 25"), "{hit:?}");
    let least = outcome.clearances.least.unwrap();
    assert_eq!(least.place.line, 5);
    assert!((least.nearest.distance + 2e-3).abs() < 1e-9, "{least:?}");
    // Blocks in their order, each with its own: 30 mm up it is 40 mm above the jaw, and the tool is 17 mm next to it.
    let lines: Vec<_> = outcome.clearances.blocks.iter().map(|block| block.place.line).collect();
    assert_eq!(lines, [1, 2, 3, 4, 5, 6]);
}

#[test]
fn what_is_too_near_is_a_warning() {
    let outcome = checked(VICE, &slot(-9.0), false);
    assert!(collisions(&outcome, Severity::Error).is_empty(), "{outcome:#?}");
    let [near] = collisions(&outcome, Severity::Warning)[..] else { panic!("{outcome:#?}") };
    assert_eq!(near.line, 5);
    assert!((near.value.unwrap() - 1.0).abs() < 1e-6, "{near:?}");
    let outcome = checked(VICE, &slot(-7.0), false);
    assert!(outcome.findings.is_empty(), "{outcome:#?}");
    let least = outcome.clearances.least.unwrap().nearest.distance;
    assert!((least - 3e-3).abs() < 1e-9, "{least}");
}

/// Stock is cut by the tool alone: the holder must not come down on it.
#[test]
fn a_holder_must_not_touch_the_stock() {
    let deep = "G0 Z30\nG0 X50 Y30\nG1 Z-37 F300\nG0 Z30\nM2\n";
    let outcome = checked(VICE, deep, false);
    let hits = collisions(&outcome, Severity::Error);
    assert!(!hits.is_empty() && hits.iter().all(|hit| hit.message.starts_with("holder is ")));
    // In the last cycle of its line it has not quite come down.
    assert!((hits[0].value.unwrap() + 2.0).abs() < 1e-3, "{hits:?}");
    assert!(checked(VICE, &deep.replace("-37", "-32"), false).findings.is_empty());
}

/// The simulated machine runs into it, says how fast and how hard, and goes no further.
#[test]
fn a_crash_is_reported_with_its_force() {
    let outcome = checked(VICE, &slot(-12.0), true);
    // In addition to what the plan does.
    let hits = collisions(&outcome, Severity::Error);
    let [hit] = hits.iter().filter(|hit| hit.unit == Some("N")).collect::<Vec<_>>()[..] else {
        panic!("{outcome:#?}")
    };
    assert_eq!((hits.len(), hit.line), (2, 5));
    // 900 mm/min.
    assert!(hit.message.contains("the tool ran into fixed jaw with 15.0 mm/s"), "{hit:?}");
    // What moves along Y (13.5 kg with its rotor) stops in a millisecond, and its motor has 400 N.
    let force = hit.value.unwrap();
    assert!(force > 13.5 * 0.015 / 1e-3 && force < 13.5 * 0.015 / 1e-3 + 400.0, "{force} N");
    assert!(checked(VICE, &slot(-7.0), true).findings.is_empty());
}

/// A machine that starts in an obstacle is reported, with or without physics.
#[test]
fn a_machine_may_start_in_something() {
    let low = VICE.replace("start_mm = [0.0, 0.0, 40.0]", "start_mm = [50.0, -10.0, -15.0]");
    for physics in [false, true] {
        let outcome = checked(&low, "G1 X55 F600\nG0 Z30\nM2\n", physics);
        let hits = collisions(&outcome, Severity::Error);
        assert!(hits.iter().any(|hit| hit.line == 1), "{physics}: {outcome:#?}");
        let notes = collisions(&outcome, Severity::Note);
        assert_eq!(notes.len(), usize::from(physics), "{outcome:#?}");
        assert!(notes.iter().all(|note| note.message.starts_with("not simulated: ")));
    }
}

/// The tool 6 mm in front of the fixed jaw, whose top is 5 mm above the tip.
#[test]
fn the_tool_in_the_spindle_counts() {
    let down = "G1 Z-15 F600\nG0 Z30\n";
    let program = format!("G0 X50 Y-26\nT1 M6\n{down}T2 M6\n{down}M61 Q1\n{down}M2\n");
    let outcome = checked(&with_tools(VICE), &program, false);
    let hits = collisions(&outcome, Severity::Error);
    let lines: Vec<_> = hits.iter().map(|hit| hit.line).collect();
    assert_eq!(lines, [6, 7], "{outcome:#?}");
    assert!(hits[0].message.starts_with("tool 2 is 2.000 mm deep in fixed jaw"), "{hits:?}");
    assert!(collisions(&outcome, Severity::Warning).is_empty(), "{outcome:#?}");
    let least = |line: u32| {
        let blocks = outcome.clearances.blocks.iter();
        let of_line = blocks.filter(|block| block.place.line == line);
        of_line.map(|block| block.nearest.distance).fold(f64::INFINITY, f64::min)
    };
    for (line, distance) in [(3, 4.5e-3), (6, -2e-3), (9, 4.5e-3)] {
        assert!((least(line) - distance).abs() < 1e-9, "line {line}: {} m", least(line));
    }
    // From the beginning, where nothing changes it.
    let thick = with_tools(VICE).replace("[rs274]\n", "[rs274]\ntool = 2\n");
    let outcome = checked(&thick, &format!("G0 X50 Y-26\n{down}M2\n"), false);
    assert_eq!(collisions(&outcome, Severity::Error)[0].line, 2, "{outcome:#?}");
    // Of tools that are not in the table, the machine file has the only dimensions.
    let outcome = checked(VICE, &program, false);
    assert!(outcome.findings.is_empty(), "{outcome:#?}");
}

/// The jaw's top is at Z−10. The tip of tool 3 is 20 mm below the controlled point, also before G43 makes up for it.
#[test]
fn a_long_tool_reaches_lower() {
    let down = "G0 X50 Y-10\nG1 Z8 F600\nG0 Z30\nM2\n";
    let outcome = checked(&with_tools(VICE), &format!("T3 M6\n{down}"), false);
    let hits = collisions(&outcome, Severity::Error);
    assert_eq!(hits[0].line, 3, "{outcome:#?}");
    assert!(hits[0].message.starts_with("tool 3 is 2.000 mm deep in fixed jaw"), "{hits:?}");
    let outcome = checked(&with_tools(VICE), &format!("T3 M6 G43\n{down}"), false);
    assert!(outcome.findings.is_empty(), "{outcome:#?}");
    let least = outcome.clearances.blocks.iter().find(|block| block.place.line == 3).unwrap();
    assert!((least.nearest.distance - 18e-3).abs() < 1e-6, "{least:?}");
}

/// The table of a generated gantry is a picture just below the lowest tip of the machine file.
#[test]
fn a_long_tool_does_not_touch_the_generated_table() {
    let portal = include_str!("../../machines/gantry3.toml");
    let machine = with_tools(portal).replace("length_mm = 40.0", "length_mm = 0.0");
    let machine = format!("{machine}\n[collision]\nclearance_mm = 1.0\n");
    let outcome = checked(&machine, "T4 M6\nG1 X50 Y20 Z-59 F600\nM2\n", false);
    assert!(collisions(&outcome, Severity::Error).is_empty(), "{outcome:#?}");
}
