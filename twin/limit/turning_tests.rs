//! Tests of tools that turn with the path: closed forms, and every cycle against the limits of all axes.

use super::effort_tests::{Limited, edited, limited};
use super::*;
use crate::setpoint::Transformer;
use std::f64::consts::{FRAC_PI_2, PI};
use twin_kinematics::AxisVector;
use twin_machine::Machine;
use twin_planner::time_optimal::AxisPath;

/// R: 1080 deg/s, 20000 deg/s²; the edge of the knife is 2 mm behind it.
const CUTTER: &str = include_str!("../../machines/gantry_cutter3.toml");
const SCARA3: &str = include_str!("../../machines/scara3.toml");
const VELOCITY: f64 = 18.849_555_921_538_76;
const ACCELERATION: f64 = 349.065_850_398_865_9;
/// rad/s³: the acceleration of R builds up in 20 ms.
const JERK: f64 = ACCELERATION / 0.02;
const R: usize = 3;
const CYCLE: f64 = 1e-3;

/// The knife, its axes with limited jerk.
fn cutter() -> Machine {
    edited(
        CUTTER,
        &[
            ("name = \"X\"\n", "name = \"X\"\nmax_jerk_mm_per_s3 = 150000.0\n"),
            ("name = \"Y\"\n", "name = \"Y\"\nmax_jerk_mm_per_s3 = 150000.0\n"),
            ("name = \"Z\"\n", "name = \"Z\"\nmax_jerk_mm_per_s3 = 100000.0\n"),
            ("name = \"R\"\n", "name = \"R\"\nmax_jerk_deg_per_s3 = 1000000.0\n"),
        ],
    )
}

/// The largest velocity, acceleration and jerk of any axis, as parts of the limits, by differences of positions.
fn by_differences(machine: &Machine, samples: &[ProfileSample]) -> [f64; 3] {
    let limits = MachinePath::new(machine, AxisRules::default()).unwrap().limits().to_vec();
    let mut worst = [0.0_f64; 3];
    for four in samples.windows(4) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|index| four[index].position);
        for (axis, limit) in limits.iter().enumerate() {
            let of = |vector: &AxisVector| vector[axis];
            let [a, b, c, d] = [&a, &b, &c, &d].map(of);
            let jerk = limit.jerk.unwrap_or(f64::INFINITY);
            let found = [
                (d - c) / CYCLE / limit.velocity,
                (d - 2.0 * c + b) / CYCLE.powi(2) / limit.acceleration,
                (d - 3.0 * c + 3.0 * b - a) / CYCLE.powi(3) / jerk,
            ];
            for (worst, found) in worst.iter_mut().zip(found) {
                *worst = worst.max(found.abs());
            }
        }
    }
    worst
}

#[track_caller]
fn within_limits(machine: &Machine, found: &Limited) {
    assert!(found.findings.is_empty(), "{:?}", found.findings);
    let [velocity, acceleration, jerk] = by_differences(machine, &found.samples);
    assert!(velocity <= 1.001 && acceleration <= 1.001, "{velocity} {acceleration}");
    assert!(jerk <= 1.05, "{jerk}");
}

fn peak(found: &Limited, of: impl Fn(&ProfileSample) -> &AxisVector) -> f64 {
    let values = found.samples.iter().map(|sample| of(sample)[R].abs());
    values.fold(0.0, f64::max)
}

/// Rest to rest by `turn`, rad, where the acceleration is reached and the velocity may be.
fn rest_to_rest(turn: f64) -> f64 {
    let build_up = ACCELERATION / JERK;
    let ramp = VELOCITY / ACCELERATION + build_up;
    if turn >= VELOCITY * ramp {
        return ramp + turn / VELOCITY;
    }
    let half = 0.5 * build_up;
    let top = ACCELERATION * ((half * half + turn / ACCELERATION).sqrt() - half);
    assert!(top >= ACCELERATION * build_up);
    2.0 * (top / ACCELERATION + build_up)
}

/// At a corner the knife turns at rest, the tip stays where it is, and the time counts for the line that follows.
#[test]
fn a_knife_turns_at_a_corner() {
    let machine = cutter();
    let line = "% line\nN10 G92 X0 Y0 Z20\nN20 G1 X50 F50 E1000 E-1000\n";
    let one = limited(&machine, line, LimitRules::default()).duration;
    for (turn, next) in [(FRAC_PI_2, "Y50"), (-FRAC_PI_2, "Y-50"), (PI, "X0")] {
        let found = limited(&machine, &format!("{line}N30 G1 {next}\n"), LimitRules::default());
        within_limits(&machine, &found);
        let expected = 2.0 * one + rest_to_rest(turn.abs());
        assert!((found.duration - expected).abs() < 1e-3, "{turn}: {} {expected}", found.duration);
        let last = found.samples.last().unwrap().position;
        assert!((last[R] - turn).abs() < 1e-9);
        let turning: Vec<_> = found
            .samples
            .iter()
            .filter(|sample| sample.velocity.get(R).unwrap().abs() > 1e-6)
            .collect();
        assert!(turning.len() > 130);
        for sample in &turning {
            assert!(sample.place.line == 4 && sample.path_velocity.abs() <= 0.0);
            assert!((sample.way - 0.05).abs() < 1e-12);
        }
        let held = turning
            .iter()
            .filter(|sample| matches!(sample.binding, Some(Binding::Axis { axis: R, .. })));
        assert!(held.count() * 10 > turning.len() * 8);
        // The feed of the line is what its lines allow.
        assert!(
            found.lines.iter().all(|line| (line.feed - 0.05).abs() < 1e-12),
            "{:?}",
            found.lines
        );
    }
}

/// F200 on a radius of 5 mm: 40 rad/s would be too much for R, which goes round at its limit.
#[test]
fn a_knife_limits_the_feed_on_a_circle() {
    let machine = cutter();
    let text = "% circle\nN10 G92 X100 Y0 Z20\nN20 G3 X100 Y0 I0 J5 F200 E5000 E-5000\n\
                N30 G3 X100 Y0 I0 J5\nN40 G3 X100 Y0 I0 J5\n";
    let found = limited(&machine, text, LimitRules::default());
    within_limits(&machine, &found);
    assert!((peak(&found, |sample| &sample.velocity) / VELOCITY - 1.0).abs() < 1e-3);
    let least = 6.0 * PI / VELOCITY;
    assert!(found.duration > least && found.duration < least + 0.15, "{}", found.duration);
    for line in &found.lines {
        assert!((line.feed / (0.005 * VELOCITY) - 1.0).abs() < 1e-9, "{line:?}");
    }
}

/// The set-points lead to the same axes: those that a check and a run move.
#[test]
fn set_points_turn_as_planned() {
    let machine = cutter();
    let text = "% all\nN10 G92 X0 Y0 Z20 F150 E2000 E-2000\nN20 G0 X20 Y10\nN30 G1 Z0 F30\nN40 G1 X60 Y10 F100\n\
                N50 G3 X60 Y40 I0 J15\nN60 G1 X30\nN70 G5 X20 Y50\nN80 G5 X0 Y30\nN90 G1 Z20\nN100 G0 X0 Y0\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.cnc");
    std::fs::write(&path, text).unwrap();
    let dialect = Some(crate::program::Dialect::Din66025);
    let settings = crate::program::settings::ReadSettings::default();
    let program = crate::program::ProgramFile::new(&path, dialect, settings).unwrap();
    let mut profile = Profile::new(&program, &machine, LimitRules::default()).unwrap();
    let mut transformer = Transformer::new(&machine);
    let mut count = 0;
    while let Some(item) = profile.next() {
        let ProfileItem::Sample(sample) = item else { panic!("{item:?}") };
        let tool = *profile.tool().unwrap();
        let axes = transformer.axes(&tool, None).unwrap().axes;
        let near = |a: &AxisVector, b: &AxisVector, most: f64| {
            a.iter().zip(b.iter()).all(|(a, b)| (a - b).abs() <= most * (1.0 + b.abs()))
        };
        let turned = |axes: &AxisVector| {
            let mut axes = *axes;
            axes.iter_mut().skip(R).for_each(|angle| *angle = angle.sin());
            axes
        };
        assert!(near(&turned(&axes.position), &turned(&sample.position), 1e-9), "{sample:?}");
        assert!(near(&axes.velocity, &sample.velocity, 1e-6), "{sample:?} {axes:?}");
        assert!(near(&axes.acceleration, &sample.acceleration, 1e-5), "{sample:?} {axes:?}");
        count += 1;
    }
    assert!(count > 1000, "{count}");
    let found = limited(&machine, text, LimitRules::default());
    within_limits(&machine, &found);
}

/// Rounded corners within a micrometre, and without jerk limits.
#[test]
fn corners_that_are_passed() {
    let passed = ("angle_tolerance_deg = 2.0", "angle_tolerance_deg = 179.0");
    let text = "% zigzag\nN10 G92 X0 Y0 Z20\nN20 G1 X20 F200 E2000 E-2000\nN30 G1 X40 Y20\nN40 G1 X60 Y0\nN50 G1 X60 Y30\n";
    for blend in ["0.001", "0.05"] {
        let blended = format!("[path]\nblend_tolerance_mm = {blend}\n\n[[drives]]");
        let plain = edited(CUTTER, &[passed, ("[[drives]]", &blended)]);
        let found = limited(&plain, text, LimitRules::default());
        within_limits(&plain, &found);
        let mut machine = plain;
        for (axis, jerk) in machine.axes.iter_mut().zip([150.0, 150.0, 100.0, JERK]) {
            axis.max_jerk = Some(jerk);
        }
        let smooth = limited(&machine, text, LimitRules::default());
        within_limits(&machine, &smooth);
        assert!(smooth.duration > found.duration, "{} {}", smooth.duration, found.duration);
    }
}

/// The hand of a SCARA that follows the path.
#[test]
fn a_hand_that_follows_the_path() {
    let mut machine = edited(SCARA3, &[("direction = \"fixed\"", "direction = \"left\"")]);
    for axis in &mut machine.axes {
        axis.max_jerk = Some(axis.max_acceleration / 0.02);
    }
    let text = "% path\nN10 G92 X300 Y-40 Z20\nN20 G1 X340 Y-40 F200 E3000 E-3000\nN30 G3 X340 Y40 I0 J40\nN40 G1 X300\nN50 G1 Y-40\n";
    let found = limited(&machine, text, LimitRules::default());
    within_limits(&machine, &found);
}
