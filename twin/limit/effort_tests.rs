//! Tests of programs that motor efforts slow down: closed forms of straight lines, and every set-point against inverse
//! dynamics.

use super::*;
use crate::finding::{Finding, Rule};
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use std::path::Path;
use twin_gcode::refeed::LineLimit;
use twin_kinematics::AxisMotion;
use twin_machine::Machine;
use twin_physics::motion_effort;

/// With X bridge 18, carriage 6, quill 3, tool 0.3 and rotor 6 kg move; with Z the quill, the tool and a rotor of 3 kg.
pub(super) const GANTRY3: &str = include_str!("../../tests/data/machines/gantry3.toml");
const SCARA2: &str = include_str!("../../tests/data/machines/scara2.toml");

pub(super) fn edited(text: &str, edits: &[(&str, &str)]) -> Machine {
    let mut text = text.to_owned();
    for (from, to) in edits {
        assert!(text.contains(from), "{from} is not in the file");
        text = text.replacen(from, to, 1);
    }
    Machine::parse(Path::new("machine.toml"), &text)
        .unwrap_or_else(|problems| panic!("{problems:#?}"))
}

pub(super) struct Limited {
    pub(super) duration: f64,
    pub(super) samples: Vec<ProfileSample>,
    pub(super) findings: Vec<Finding>,
    pub(super) changes: Vec<Change>,
    pub(super) lines: Vec<LineLimit>,
}

pub(super) fn limited(machine: &Machine, text: &str, rules: LimitRules) -> Limited {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.cnc");
    std::fs::write(&path, text).unwrap();
    let program =
        ProgramFile::new(&path, Some(Dialect::Din66025), ReadSettings::default()).unwrap();
    let mut profile = Profile::new(&program, machine, rules).unwrap();
    let (mut samples, mut findings) = (Vec::new(), Vec::new());
    for item in &mut profile {
        match item {
            ProfileItem::Sample(sample) => samples.push(*sample),
            ProfileItem::Finding(finding) => findings.push(finding),
            ProfileItem::Io(error) => panic!("{error}"),
        }
    }
    let effort = profile.effort();
    assert_eq!((effort.failed, effort.exceeded), (0, 0));
    let (duration, changes) = (profile.duration(), profile.changes());
    Limited { duration, samples, findings, changes, lines: profile.line_limits() }
}

#[track_caller]
pub(super) fn near(found: f64, expected: f64, part: f64) {
    assert!((found - expected).abs() <= part * expected.abs(), "{found} is not {expected}");
}

/// Rest to rest over `length` with these accelerations at first and at last.
pub(super) fn rest_to_rest(length: f64, up: f64, down: f64) -> f64 {
    let top = (2.0 * length * up * down / (up + down)).sqrt();
    top / up + top / down
}

const MOTOR_OF_X: Binding = Binding::Axis { axis: 0, quantity: Quantity::Effort };

/// 100 N less 20 N of dry friction move 33.3 kg.
#[test]
fn a_motor_speeds_its_mass_up() {
    let edits = [
        ("max_force_n = 600.0", "max_force_n = 100.0"),
        ("viscous_friction_n_s_per_m = 60.0", "viscous_friction_n_s_per_m = 0.0"),
    ];
    let machine = edited(GANTRY3, &edits);
    let text = "% line\nN10 G92 X0 Y0 Z0 F400 E9000 E-9000\nN20 G1 X50\n";
    let found = limited(&machine, text, LimitRules::default());
    let acceleration = 80.0 / 33.3;
    near(found.duration, rest_to_rest(0.05, acceleration, acceleration), 1e-4);
    assert!(found.findings.is_empty(), "{:?}", found.findings);
    // √2 of it would be gained by twice the acceleration; 20 % more force are 25 % more acceleration.
    let [first, ..] = &found.changes[..] else { panic!("no changes") };
    assert_eq!(first.binding, MOTOR_OF_X);
    assert!(first.gain_s > 0.05 * found.duration && first.gain_s < 0.2 * found.duration);
    let most = found.samples.iter().filter_map(|sample| sample.effort.unwrap().first().copied());
    // Dry friction counts against the motor all the way, and helps to brake.
    near(most.clone().fold(0.0, f64::max), 100.0, 1e-3);
    near(most.fold(0.0, f64::min), -60.0, 1e-3);
    let held = |sample: &&ProfileSample| sample.binding == Some(MOTOR_OF_X);
    assert!(found.samples.iter().filter(held).count() * 10 > found.samples.len() * 9);

    let mut rules = LimitRules::default();
    rules.axes.effort = false;
    let free = limited(&machine, text, rules);
    near(free.duration, rest_to_rest(0.05, 3.0, 3.0), 1e-4);
    assert!(free.samples.iter().any(|sample| sample.effort.unwrap().first() > Some(&110.0)));
    // Half kept back for the override: a quarter of the acceleration.
    let machine = edited(
        GANTRY3,
        &[
            edits[0],
            edits[1],
            (
                "max_acceleration_mm_per_s2 = 3000.0",
                "max_acceleration_mm_per_s2 = 30000.0\nheadroom_percent = 50.0",
            ),
        ],
    );
    let slow = limited(&machine, text, LimitRules::default());
    near(slow.duration, rest_to_rest(0.05, acceleration / 4.0, acceleration / 4.0), 1e-4);
}

/// Z carries 3.3 kg, its motor moves 6.3 kg: with 50 N, of which dry friction takes 8 N, it rises slowly and sinks fast.
#[test]
fn weight_counts_up_and_down() {
    let machine = edited(
        GANTRY3,
        &[
            ("max_force_n = 300.0", "max_force_n = 50.0"),
            ("viscous_friction_n_s_per_m = 30.0", "viscous_friction_n_s_per_m = 0.0"),
        ],
    );
    let weight = 3.3 * 9.81;
    let (with, against) = ((42.0 + weight) / 6.3, (42.0 - weight) / 6.3);
    // The axis itself does 2 m/s².
    let with = 2.0_f64.min(with);
    for (end, up, down) in [(20, against, with), (-20, with, against)] {
        let text = format!("% lift\nN10 G92 X0 Y0 Z0 F200 E9000 E-9000\nN20 G1 Z{end}\n");
        let found = limited(&machine, &text, LimitRules::default());
        near(found.duration, rest_to_rest(0.02, up, down), 1e-4);
        assert!(found.findings.is_empty(), "{:?}", found.findings);
    }
}

/// (26 − 20) N are 60 N·s/m at 100 mm/s: no feed beyond that can be kept.
#[test]
fn friction_limits_the_feed_of_a_line() {
    let machine = edited(GANTRY3, &[("max_force_n = 600.0", "max_force_n = 26.0")]);
    let text = "% line\nN10 G92 X0 Y0 Z0 F400 E9000 E-9000\nN20 G1 X300\n";
    let found = limited(&machine, text, LimitRules::default());
    let line = found.lines.iter().find(|line| line.line == 3).unwrap();
    near(line.feed, 0.1, 1e-9);
    let top = found.samples.iter().map(|sample| sample.path_velocity).fold(0.0, f64::max);
    assert!(top > 0.09 && top <= 0.1 * (1.0 + 1e-9), "{top} m/s");
}

#[test]
fn a_motor_too_weak_to_hold_its_axis_is_an_error() {
    let machine = edited(GANTRY3, &[("max_force_n = 300.0", "max_force_n = 30.0")]);
    let text = "% weak\nN10 G92 X0 Y0 Z0 F100 E1000 E-1000\nN20 G1 X50\n";
    let found = limited(&machine, text, LimitRules::default());
    let [finding] = &found.findings[..] else { panic!("{:?}", found.findings) };
    assert_eq!(
        (finding.rule, finding.line, finding.axis.as_deref()),
        (Rule::AxisEffort, 3, Some("Z"))
    );
    near(finding.value.unwrap(), 3.3 * 9.81 + 8.0, 1e-9);
    near(finding.limit.unwrap(), 30.0, 1e-12);
    assert!(finding.message.contains("force of 40.3730 N"), "{}", finding.message);
}

/// Lines, an arc and a corner far out and close to the column, much faster than the motors can.
const SCARA_PROGRAM: &str = "\
% scara
N10 G92 X300 Y0 Z20 F900 E20000 E-20000
N20 G1 X150 Y150
N30 G1 X-100 Y250 Z40
N40 G2 X100 Y250 I100 J0
N50 G1 X400 Y100 Z0
N60 G1 X300 Y0
";

/// Every set-point against the inverse dynamics of the machine, which know no path; with and without limited jerk.
#[test]
fn no_motor_of_a_scara_gives_more_than_it_can() {
    let weak = [
        ("max_torque_nm = 120.0", "max_torque_nm = 14.0"),
        ("max_torque_nm = 50.0", "max_torque_nm = 4.0"),
        ("max_force_n = 400.0", "max_force_n = 36.0"),
    ];
    let jerk = (
        "max_acceleration_deg_per_s2 = 1500.0",
        "max_acceleration_deg_per_s2 = 1500.0\nmax_jerk_deg_per_s3 = 60000.0",
    );
    let jerk_of_b = (
        "max_acceleration_deg_per_s2 = 2500.0",
        "max_acceleration_deg_per_s2 = 2500.0\nmax_jerk_deg_per_s3 = 90000.0",
    );
    let mut with_jerk = weak.to_vec();
    with_jerk.extend([jerk, jerk_of_b]);
    for edits in [&weak[..], &with_jerk] {
        let machine = edited(SCARA2, edits);
        let found = limited(&machine, SCARA_PROGRAM, LimitRules::default());
        assert!(found.findings.is_empty(), "{:?}", found.findings);
        let axes = machine.axes.iter();
        let armature: Vec<f64> = axes.map(|axis| axis.simulated.armature).collect();
        let mut most = [0.0_f64; 3];
        for sample in &found.samples {
            let motion = AxisMotion {
                position: sample.position,
                velocity: sample.velocity,
                acceleration: sample.acceleration,
            };
            let effort =
                motion_effort(&machine.model, machine.gravity, &armature, &motion).unwrap();
            for (index, axis) in machine.axes.iter().enumerate() {
                let v = sample.velocity[index];
                let dry = if v == 0.0 { 0.0 } else { axis.simulated.dry_friction() * v.signum() };
                let effort = effort[index] + axis.simulated.viscous_friction() * v + dry;
                let reported = sample.effort.unwrap()[index];
                assert!((effort - reported).abs() < 1e-9, "{}: {effort} and {reported}", axis.name);
                most[index] = most[index].max(effort.abs() / axis.simulated.effort_limit);
            }
        }
        println!("{most:?} of the limits in {:.3} s", found.duration);
        assert!(most.iter().all(|most| *most <= 1.001), "{most:?}");
        assert!(most[0] > 0.95 && most[1] > 0.95, "{most:?}");
        let mut rules = LimitRules::default();
        rules.axes.effort = false;
        let free = limited(&machine, SCARA_PROGRAM, rules);
        assert!(free.duration < 0.98 * found.duration, "{} {}", free.duration, found.duration);
    }
}
