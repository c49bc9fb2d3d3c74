//! Tests of the cycle in which a coupling or a probe begins.

use super::tests::{job, machine, near, run};
use crate::check::{CheckOptions, Outcome, check};
use crate::finding::{Finding, Rule, Severity};
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use std::path::Path;
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

/// The shipped gantry, on which Z follows X by the cam, with these keys.
fn coupled(keys: &str) -> (TempDir, Machine) {
    let folder = tempfile::tempdir().unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines/gantry3.toml");
    let shipped = std::fs::read_to_string(shipped).unwrap();
    let cams = format!(
        "\n[[cams]]\naxis = \"Z\"\nmaster = \"X\"\ncam = \"hill.toml\"\nperiodic = false\n{keys}"
    );
    std::fs::write(folder.path().join("hill.toml"), CAM).unwrap();
    let path = folder.path().join("machine.toml");
    std::fs::write(&path, [shipped, cams].concat()).unwrap();
    let machine = Machine::load(&path).unwrap();
    (folder, machine)
}

fn to(position: f64, keys: &str) -> String {
    format!(
        "[[blocks]]\nblock = \"MC_MoveAbsolute\"\naxis = \"X\"\nposition_mm = {position:?}\nvelocity_mm_per_s = 50\n\
         acceleration_mm_per_s2 = 500\n{keys}"
    )
}

fn errors(findings: &[Finding]) -> Vec<&Finding> {
    findings.iter().filter(|finding| finding.severity == Severity::Error).collect()
}

/// X moves off its cam at once, as a CNC program may: it was on it, and Z stays at the cam's end.
#[test]
fn a_master_may_leave_its_cam_at_once() {
    let (_folder, machine) = coupled("");
    for blocks in [to(-30.0, ""), to(-30.0, "at_s = 1\n"), to(10.0, "") + &to(-30.0, "")] {
        let (setpoints, findings) = run(&job(&blocks), &machine);
        assert_eq!(errors(&findings), [] as [&Finding; 0], "{blocks}");
        let last = setpoints.last().unwrap().axes.position;
        near(last[0], -0.03, 1e-9);
        near(last[2], 0.0, 1e-9);
    }
    // Of the job itself, too.
    let cam_in = "[[blocks]]\nblock = \"MC_CamIn\"\naxis = \"Z\"\nmaster = \"X\"\ncam = \"hill.toml\"\nperiodic = false\n";
    let head = "[[start]]\naxis = \"Z\"\nposition_mm = 0\n";
    let job = job(&[head, cam_in, &to(-30.0, "with_previous = true\n")].concat());
    std::fs::write(job.folder.path().join("hill.toml"), CAM).unwrap();
    let (setpoints, findings) = run(&job, &super::tests::machine());
    assert_eq!(errors(&findings), [] as [&Finding; 0]);
    near(setpoints.last().unwrap().axes.position[0], -0.03, 1e-9);
    assert!(setpoints.iter().all(|one| one.axes.position[2].abs() < 1e-12));
}

fn checked(machine: &Machine, name: &str, text: &str) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    let dialect = if path.extension().is_some_and(|ending| ending == "toml") {
        Dialect::Job
    } else {
        Dialect::Din66025
    };
    let program = ProgramFile::new(&path, Some(dialect), ReadSettings::default()).unwrap();
    check(machine, &program, CheckOptions::default(), &mut |_| {}).unwrap()
}

/// Where job or program begin with the slave of an absolute cam elsewhere than the cam has it, that is told; a cam that is laid
/// where the slave stands, or comes to it, takes it from anywhere.
#[test]
fn a_slave_that_begins_elsewhere_is_told() {
    let start = |z: f64| format!("[[start]]\naxis = \"Z\"\nposition_mm = {z:?}\n{}", to(25.0, ""));
    // The tool's tip is 40 mm below.
    let zeroed = |z: f64| format!("% begin\nN10 G92 Z{:?}\nN20 G1 X25 F50 E500 E-500\n", z - 40.0);
    let along = "% along\nN20 G1 X25 F50 E500 E-500\n";
    let (_folder, machine) = coupled("");
    for (name, text, line) in [("job.toml", start(100.0), 3), ("begin.cnc", zeroed(100.0), 3)] {
        let found = checked(&machine, name, &text).findings;
        let [one] = errors(&found)[..] else { panic!("{name}: {found:?}") };
        assert_eq!((one.rule, one.line, one.axis.as_deref()), (Rule::Coupling, line, Some("Z")));
        assert_eq!((one.value, one.limit, one.unit), (Some(100.0), Some(0.0), Some("mm")));
        assert!(one.message.contains("has it at 0.000 mm"), "{}", one.message);
    }
    // Where the cam has it, and where nobody says anything, there is nothing to tell.
    for (name, text) in
        [("job.toml", start(0.0)), ("begin.cnc", zeroed(0.0)), ("along.cnc", along.to_owned())]
    {
        assert_eq!(errors(&checked(&machine, name, &text).findings), [] as [&Finding; 0], "{name}");
    }
    let ramp = "start_mode = \"ramp_in\"\nvelocity_difference_mm_per_s = 50\nacceleration_mm_per_s2 = 500\n\
                deceleration_mm_per_s2 = 500\n";
    for keys in ["slave_absolute = false\n", ramp] {
        let (_folder, machine) = coupled(&format!("slave_scaling = 0.5\n{keys}"));
        for (name, text) in [("job.toml", start(100.0)), ("begin.cnc", zeroed(100.0))] {
            let outcome = checked(&machine, name, &text);
            assert_eq!(errors(&outcome.findings), [] as [&Finding; 0], "{name}, {keys}");
            let start = outcome.start.unwrap();
            near(start[2], 0.1, 1e-9);
        }
    }
}

/// A cam that adds to where Z stands has 30 mm at 25 mm of X, half way up: Z begins there above its 60 mm, in a job as in a
/// program, and comes back to 60 mm with the end of the cam.
#[test]
fn a_relative_cam_adds_once() {
    let (_folder, machine) = coupled("slave_absolute = false\nslave_scaling = 0.5\n");
    let job = "[[start]]\naxis = \"X\"\nposition_mm = 25\n".to_owned() + &to(100.0, "");
    let program = "% along\nN10 G92 X25\nN20 G1 X100 F50 E500 E-500\n".to_owned();
    for (name, text) in [("job.toml", job), ("along.cnc", program)] {
        let outcome = checked(&machine, name, &text);
        assert_eq!(errors(&outcome.findings), [] as [&Finding; 0], "{name}");
        near(outcome.start.unwrap()[2], 0.06 + 0.015, 1e-9);
        let [least, most] = outcome.peaks[2].position.unwrap();
        near(least, 0.06, 1e-9);
        near(most, 0.06 + 0.03, 1e-6);
    }
}

/// X starts on the first tappet, which does not act, as is told; the other one, 25 mm on, does.
#[test]
fn a_tappet_on_which_the_master_starts_is_told() {
    let (_folder, machine) = coupled("");
    for (name, text, line) in [
        ("job.toml", to(40.0, ""), 2),
        ("along.cnc", "% along\nN20 G1 X40 F50 E500 E-500\n".to_owned(), 2),
    ] {
        let outcome = checked(&machine, name, &text);
        let notes: Vec<_> = outcome.findings.iter().map(|one| (one.severity, one.line)).collect();
        assert_eq!(notes, [(Severity::Note, line)], "{name}: {:?}", outcome.findings);
        let said = &outcome.findings[0].message;
        assert!(
            said.starts_with("axis X stands on the tappet of group 1 when the cam of Z"),
            "{said}"
        );
        assert_eq!(outcome.tappets.counts, [0, 1], "{name}");
    }
    // Beside it there is nothing to tell.
    let beside = "[[start]]\naxis = \"X\"\nposition_mm = 1\n".to_owned() + &to(40.0, "");
    assert_eq!(checked(&machine, "job.toml", &beside).findings, []);
}

/// A trigger that comes in the cycle in which its probe begins is seen: at 0.5 s of a move to 200 mm at 100 mm/s, with 1000 mm/s²
/// 5 mm behind where it would be without coming to speed. Both probes of a line, and what is assumed of a jerk, are told.
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
    let found = checked(&machine(), "job.toml", text).findings;
    let notes: Vec<_> = found.iter().filter(|one| one.severity == Severity::Note).collect();
    let said: Vec<_> = notes.iter().map(|one| (one.line, one.message.as_str())).collect();
    assert_eq!(said.len(), 3, "{said:?}");
    assert!(
        said.iter().any(|(line, said)| *line == 5 && said.contains("needs a jerk")),
        "{said:?}"
    );
    let recorded = said.iter().filter_map(|(line, said)| {
        let place = said.strip_prefix("MC_TouchProbe has recorded axis X at ")?;
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

/// A group with a tappet at the end and one at the begin of a periodic cam is named once.
#[test]
fn groups_that_the_master_stands_on_are_named_once() {
    let cam = CAM.replace("group = 2, master = 25", "group = 1, master = 100");
    let job = job(
        "[[virtual_axes]]\nname = \"web\"\nkind = \"linear\"\n[[start]]\naxis = \"X\"\nposition_mm = 0\n\
                   [[blocks]]\nblock = \"MC_CamIn\"\naxis = \"X\"\nmaster = \"web\"\ncam = \"hill.toml\"\n",
    );
    std::fs::write(job.folder.path().join("hill.toml"), cam).unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines/gantry3.toml");
    let (_, findings) = run(&job, &Machine::load(&shipped).unwrap());
    let [note] = findings.as_slice() else { panic!("{findings:?}") };
    assert_eq!(note.severity, Severity::Note);
    assert!(note.message.contains("stands on the tappet of group 1 when"), "{}", note.message);
}

/// From half the velocity of its master X comes to all of it, 50 mm/s, within 25/500 s, in which it falls back by 0.625 mm; then it leads
/// by 5 mm more. That its gear has ended is told.
#[test]
fn phasing_ends_a_gear_and_leads() {
    let text = "duration_s = 3\n[[virtual_axes]]\nname = \"web\"\nkind = \"linear\"\nmax_acceleration_mm_per_s2 = 500\n\
                [[blocks]]\nblock = \"MC_GearIn\"\naxis = \"X\"\nmaster = \"web\"\nratio_numerator = 1\nratio_denominator = 2\n\
                [[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"web\"\nvelocity_mm_per_s = 50\n\
                [[blocks]]\nblock = \"MC_Phasing\"\naxis = \"X\"\nmaster = \"web\"\nphase_shift_mm = 5\nvelocity_mm_per_s = 10\n\
                acceleration_mm_per_s2 = 500\nat_s = 0.5\n";
    let (setpoints, findings) = run(&job(text), &machine());
    let [note] = findings.as_slice() else { panic!("{findings:?}") };
    assert_eq!((note.severity, note.line), (Severity::Note, 17));
    let words = "MC_Phasing ends MC_GearIn of axis X (line 7) and couples it 1:1 with web";
    assert!(note.message.starts_with(words), "{}", note.message);
    let at = |seconds: f64| {
        let one = setpoints.iter().find(|one| one.time_ns >= nanoseconds(seconds)).unwrap();
        one.axes.position[0] * 1e3 - 50.0 * seconds
    };
    near(at(2.0) - at(0.5), 5.0 - 0.625, 0.06);
}

#[expect(clippy::cast_possible_truncation, reason = "some seconds")]
fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

/// Twice 60 mm backwards in every pass of a cam that goes on because nothing is said.
#[test]
fn what_a_cam_gains_because_nothing_is_said_is_told() {
    let cam = "name = \"g\"\nmaster = { min = 0, max = 100, unit = \"mm\" }\nslave = { min = 0, max = 60, unit = \"mm\" }\n\
               elements = [{ master = 0, slave = 0 }, { master = 100, slave = 60 }]\n";
    for (keys, told) in [("", true), ("periodic = true\n", false), ("periodic = false\n", false)] {
        let job = job(&format!(
            "[[virtual_axes]]\nname = \"web\"\nkind = \"linear\"\n[[start]]\naxis = \"X\"\nposition_mm = 0\n[[blocks]]\n\
             block = \"MC_CamIn\"\naxis = \"X\"\nmaster = \"web\"\ncam = \"g.toml\"\nslave_scaling = -2\n{keys}"
        ));
        std::fs::write(job.folder.path().join("g.toml"), cam).unwrap();
        let (_, findings) = run(&job, &machine());
        assert_eq!(findings.len(), usize::from(told), "{findings:?}");
        for note in findings {
            assert_eq!((note.severity, note.line), (Severity::Note, 8));
            assert!(note.message.ends_with("the slave gains -120 mm in every pass"), "{note:?}");
        }
    }
}
