//! Tests of the cycle in which a coupling or a probe begins.

use super::{at, block, job, machine, machine_file, near, only, run, virtual_axis};
use crate::check::{CheckOptions, Outcome, check};
use crate::finding::{Finding, Rule, Severity};
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use tempfile::TempDir;
use twin_machine::Machine;

/// 0 to 60 mm and back over 0 to 100 mm of the master; outside there is nothing.
const CAM: &str = r#"
name = "hill"
master = { min = 0, max = 100, unit = "mm" }
slave = { min = 0, max = 60, unit = "mm" }
elements = [{ master = 0, slave = 0 }, { master = 50, slave = 60 }, { master = 100, slave = 0 }]
tappets = [
  { group = 1, master = 0, action = "on" },
  { group = 2, master = 25, action = "on" },
]
"#;

/// The shipped gantry, on which an axis follows X by a cam, with these keys.
pub(super) fn coupled_by(axis: &str, keys: &str, cam: &str) -> (TempDir, Machine) {
    let folder = tempfile::tempdir().unwrap();
    let shipped = std::fs::read_to_string(machine_file("gantry3.toml")).unwrap();
    let cams = format!("\n[[cams]]\naxis = \"{axis}\"\nmaster = \"X\"\ncam = \"c.toml\"\n{keys}");
    std::fs::write(folder.path().join("c.toml"), cam).unwrap();
    let path = folder.path().join("machine.toml");
    std::fs::write(&path, [shipped, cams].concat()).unwrap();
    let machine = Machine::load(&path).unwrap();
    (folder, machine)
}

fn coupled(keys: &str) -> (TempDir, Machine) {
    coupled_by("Z", &format!("periodic = false\n{keys}"), CAM)
}

fn to(position: f64, keys: &str) -> String {
    let rates = "velocity_mm_per_s = 50; acceleration_mm_per_s2 = 500";
    block("MC_MoveAbsolute", "X", &format!("position_mm = {position:?}; {rates}{keys}"))
}

fn start(axis: &str, position: f64) -> String {
    format!("[[start]]\naxis = \"{axis}\"\nposition_mm = {position:?}\n")
}

#[track_caller]
fn no_errors(findings: &[Finding]) {
    assert!(findings.iter().all(|one| one.severity != Severity::Error), "{findings:?}");
}

/// X moves off its cam at once, as a CNC program may: it was on the cam, and Z stays at the cam's end.
#[test]
fn a_master_may_leave_its_cam_at_once() {
    let (_folder, machine) = coupled("");
    for blocks in [to(-30.0, ""), to(-30.0, "; at_s = 1"), to(10.0, "") + &to(-30.0, "")] {
        let (setpoints, findings) = run(&job(&blocks), &machine);
        no_errors(&findings);
        let last = setpoints.last().unwrap().axes.position;
        near(last[0], -0.03, 1e-9);
        near(last[2], 0.0, 1e-9);
    }
    // Of the job itself, too.
    let cam_in = block("MC_CamIn", "Z", "master = \"X\"; cam = \"hill.toml\"; periodic = false");
    let job = job(&[start("Z", 0.0), cam_in, to(-30.0, "; with_previous = true")].concat());
    let (setpoints, findings) = run(&job.with("hill.toml", CAM), &super::machine());
    no_errors(&findings);
    near(setpoints.last().unwrap().axes.position[0], -0.03, 1e-9);
    assert!(setpoints.iter().all(|one| one.axes.position[2].abs() < 1e-12));
}

fn checked(machine: &Machine, name: &str, text: &str) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    let dialect = if name.ends_with("toml") { Dialect::Job } else { Dialect::Din66025 };
    let program = ProgramFile::new(&path, Some(dialect), ReadSettings::default()).unwrap();
    check(machine, &program, CheckOptions::default(), &mut |_| {}).unwrap()
}

/// The slave of an absolute cam has to begin at the position of the cam, in jobs and programs; a relative cam, or one with a
/// ramp-in, takes it from anywhere.
#[test]
fn a_slave_that_begins_elsewhere_is_told() {
    let begin = |z: f64| start("Z", z) + &to(25.0, "");
    // The tool's tip is 40 mm below.
    let zeroed = |z: f64| format!("% begin\nN10 G92 Z{:?}\nN20 G1 X25 F50 E500 E-500\n", z - 40.0);
    let along = "% along\nN20 G1 X25 F50 E500 E-500\n";
    let (_folder, machine) = coupled("");
    for (name, text, line) in [("job.toml", begin(100.0), 3), ("begin.cnc", zeroed(100.0), 3)] {
        let mut found = checked(&machine, name, &text).findings;
        found.retain(|one| one.severity == Severity::Error);
        let one = only(&found);
        assert_eq!((one.rule, one.line, one.axis.as_deref()), (Rule::Coupling, line, Some("Z")));
        assert_eq!((one.value, one.limit, one.unit), (Some(100.0), Some(0.0), Some("mm")));
        assert!(one.message.contains("has it at 0.000 mm"), "{}", one.message);
    }
    // At the position of the cam, and without a start position, there is no finding.
    for (name, text) in
        [("job.toml", begin(0.0)), ("begin.cnc", zeroed(0.0)), ("along.cnc", along.to_owned())]
    {
        no_errors(&checked(&machine, name, &text).findings);
    }
    let ramp = "start_mode = \"ramp_in\"\nvelocity_difference_mm_per_s = 50\nacceleration_mm_per_s2 = 500\n\
                deceleration_mm_per_s2 = 500\n";
    for keys in ["slave_absolute = false\n", ramp] {
        let (_folder, machine) = coupled(&format!("slave_scaling = 0.5\n{keys}"));
        for (name, text) in [("job.toml", begin(100.0)), ("begin.cnc", zeroed(100.0))] {
            let outcome = checked(&machine, name, &text);
            no_errors(&outcome.findings);
            near(outcome.start.unwrap()[2], 0.1, 1e-9);
        }
    }
}

/// A cam that adds to the position of Z has 30 mm at 25 mm of X, half way up: Z begins there above its 60 mm, in a job as in a
/// program, and comes back to 60 mm with the end of the cam.
#[test]
fn a_relative_cam_adds_once() {
    let (_folder, machine) = coupled("slave_absolute = false\nslave_scaling = 0.5\n");
    let job = start("X", 25.0) + &to(100.0, "");
    let program = "% along\nN10 G92 X25\nN20 G1 X100 F50 E500 E-500\n".to_owned();
    for (name, text) in [("job.toml", job), ("along.cnc", program)] {
        let outcome = checked(&machine, name, &text);
        no_errors(&outcome.findings);
        near(outcome.start.unwrap()[2], 0.06 + 0.015, 1e-9);
        let [least, most] = outcome.peaks[2].position.unwrap();
        near(least, 0.06, 1e-9);
        near(most, 0.06 + 0.03, 1e-6);
    }
}

/// X starts on the first tappet, which does not act; that is reported. The other one, 25 mm on, acts.
#[test]
fn a_tappet_on_which_the_master_starts_is_told() {
    let (_folder, machine) = coupled("");
    for (name, text) in [
        ("job.toml", to(40.0, "")),
        ("along.cnc", "% along\nN20 G1 X40 F50 E500 E-500\n".to_owned()),
    ] {
        let outcome = checked(&machine, name, &text);
        let note = only(&outcome.findings);
        assert_eq!((note.severity, note.line), (Severity::Note, 2), "{name}: {note:?}");
        let words = "axis X is at the tappet of group 1 when the cam of Z";
        assert!(note.message.starts_with(words), "{}", note.message);
        assert_eq!(outcome.tappets.counts, [0, 1], "{name}");
    }
    // Next to it there is no finding.
    let next_to_it = start("X", 1.0) + &to(40.0, "");
    assert_eq!(checked(&machine, "job.toml", &next_to_it).findings, []);
}

/// A trigger that comes in the cycle in which its probe begins counts: at 0.5 s of a move to 200 mm at 100 mm/s, with 1000 mm/s²
/// 5 mm behind a move without ramp. Both probes of a line, and the assumed jerk, are reported.
#[test]
fn probes_begin_with_their_trigger() {
    let text = r#"
ramp = "sigmoid"
triggers = [{ name = "t", at_s = 0.5 }, { name = "u", at_s = 1 }]
blocks = [
  { block = "MC_TouchProbe", axis = "X", trigger = "t", at_s = 0.5 }, { block = "MC_TouchProbe", axis = "X", trigger = "u", at_s = 1 },
  { block = "MC_MoveAbsolute", axis = "X", position_mm = 200, velocity_mm_per_s = 100, acceleration_mm_per_s2 = 1000, at_s = 0 },
]
"#;
    let mut found = checked(&machine(), "job.toml", text).findings;
    found.retain(|one| one.severity == Severity::Note);
    assert_eq!(found.len(), 3, "{found:?}");
    super::finds(&found, 5, "needs a jerk");
    let recorded = found.iter().filter_map(|Finding { line, message, .. }| {
        let place = message.strip_prefix("MC_TouchProbe has recorded axis X at ")?;
        Some((*line, place.strip_suffix(" mm")?.parse::<f64>().ok()?))
    });
    let recorded: Vec<_> = recorded.collect();
    // Ramps of sigmoid: π/2 times as long as without a jerk, 7.85 mm behind; within two cycles of 0.1 mm.
    let behind = 100.0 * 0.5 * std::f64::consts::FRAC_PI_2 * 0.1;
    for (line, expected) in [(5, 50.0 - behind), (5, 100.0 - behind)] {
        let is_there = |(at, place): &(u32, f64)| *at == line && (place - expected).abs() < 0.21;
        assert!(recorded.iter().any(is_there), "{expected}: {recorded:?}");
    }
}

/// Findings of X on a cam whose master is a web.
fn on_a_web(cam: &str, keys: &str) -> Vec<Finding> {
    let web = "[[virtual_axes]]\nname = \"web\"\nkind = \"linear\"\n";
    let cam_in = block("MC_CamIn", "X", &format!("master = \"web\"; cam = \"c.toml\"{keys}"));
    let job = job(&[web, &start("X", 0.0), &cam_in].concat());
    run(&job.with("c.toml", cam), &machine()).1
}

/// A group with a tappet at the end and one at the begin of a periodic cam is named once.
#[test]
fn groups_that_the_master_stands_on_are_named_once() {
    let found = on_a_web(&CAM.replace("group = 2, master = 25", "group = 1, master = 100"), "");
    let note = only(&found);
    assert_eq!(note.severity, Severity::Note);
    assert!(note.message.contains("is at the tappet of group 1 when"), "{}", note.message);
}

/// From half the velocity of its master X comes to all of it, 50 mm/s, within 25/500 s, in which it falls back by 0.625 mm; then it leads
/// by 5 mm more. The end of its gear is reported.
#[test]
fn phasing_ends_a_gear_and_leads() {
    let keys = "master = \"web\"; phase_shift_mm = 5; velocity_mm_per_s = 10; acceleration_mm_per_s2 = 500; at_s = 0.5";
    let text = [
        "duration_s = 3\n",
        &virtual_axis("web", "linear", "max_acceleration_mm_per_s2 = 500"),
        &block("MC_GearIn", "X", "master = \"web\"; ratio_numerator = 1; ratio_denominator = 2"),
        &block("MC_MoveVelocity", "web", "velocity_mm_per_s = 50"),
        &block("MC_Phasing", "X", keys),
    ];
    let (setpoints, findings) = run(&job(&text.concat()), &machine());
    let note = only(&findings);
    assert_eq!((note.severity, note.line), (Severity::Note, 17));
    let words = "MC_Phasing ends MC_GearIn of axis X (line 7) and couples the axis 1:1 with web";
    assert!(note.message.starts_with(words), "{}", note.message);
    let lead = |seconds: f64| at(&setpoints, seconds).axes.position[0] * 1e3 - 50.0 * seconds;
    near(lead(2.0) - lead(0.5), 5.0 - 0.625, 0.06);
}

/// Twice 60 mm backwards in every pass of a cam that is periodic by default.
#[test]
fn what_a_cam_gains_because_nothing_is_said_is_told() {
    let cam = "name = \"g\"\nmaster = { min = 0, max = 100, unit = \"mm\" }\nslave = { min = 0, max = 60, unit = \"mm\" }\n\
               elements = [{ master = 0, slave = 0 }, { master = 100, slave = 60 }]\n";
    for keys in ["; periodic = true", "; periodic = false"] {
        assert_eq!(on_a_web(cam, &format!("; slave_scaling = -2{keys}")), []);
    }
    let found = on_a_web(cam, "; slave_scaling = -2");
    let note = only(&found);
    assert_eq!((note.severity, note.line), (Severity::Note, 8));
    assert!(note.message.ends_with("the slave gains -120 mm in every pass"), "{note:?}");
}
