//! Tests of inputs that change while a program runs, against closed forms (manual 6.2.9, 6.6).

use super::{CheckOptions, Outcome, check};
use crate::finding::{Rule, Severity};
use crate::limit::Limits;
use crate::program::inputs::{InputAt, Workpiece};
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use std::path::Path;
use twin_machine::Machine;
use twin_number::seconds;
use twin_planner::controller::XDirection;

const GANTRY3: &str = include_str!("../../tests/data/machines/gantry3.toml");

pub(super) fn checked(text: &str, settings: ReadSettings) -> Outcome {
    let machine = Machine::parse(Path::new("machine.toml"), GANTRY3).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.cnc");
    std::fs::write(&path, text).unwrap();
    let program = ProgramFile::new(&path, Some(Dialect::Din66025), settings).unwrap();
    let options = CheckOptions { limits: Limits::Programmed, ..CheckOptions::default() };
    check(&machine, &program, options, &mut |_| {}).unwrap()
}

fn duration(text: &str, changes: &[&str]) -> f64 {
    let changes: Vec<InputAt> = changes.iter().map(|change| change.parse().unwrap()).collect();
    let outcome = checked(text, ReadSettings { changes, ..ReadSettings::default() });
    assert!(outcome.findings.is_empty(), "{:#?}", outcome.findings);
    seconds(outcome.duration_ns)
}

#[track_caller]
fn near(found: f64, wanted: f64) {
    // Ends are rounded up to cycles.
    assert!((wanted - 1e-9..=wanted + 2e-3).contains(&found), "{found} is not {wanted}");
}

/// Twice 10 mm on a line, at 100 mm/s with 1000 mm/s²: 0.3 s in one go. In single step every element ends at rest, 0.2 s each,
/// and the path rests for a cycle between them; asked for on the way, from the first end that can be stopped at.
#[test]
fn single_step_rests_for_a_cycle_at_every_transition() {
    let line = "% line\nN10 G92 X0 Y0\nN20 G1 X10 F100 E1000 E-1000\nN30 G1 X20\n";
    near(duration(line, &[]), 0.3);
    near(duration(line, &["0:single-step=on"]), 0.401);
    near(duration(line, &["0.05:single-step=on"]), 0.401);
    // 5 mm before its end the first element can no longer be stopped at: it goes on to the second.
    near(duration(line, &["0.14:single-step=on"]), 0.3);
    near(duration(line, &["0:single-step=on", "0.1:single-step=off"]), 0.3);
}

/// A corner after 0.2 s is a natural stop: there the path waits until the input falls.
#[test]
fn the_path_waits_at_its_next_stop() {
    let corner = "% corner\nN10 G92 X0 Y0\nN20 G1 X10 F100 E1000 E-1000\nN30 G1 Y10\n";
    near(duration(corner, &[]), 0.4);
    near(duration(corner, &["0.1:wait-at-next-stop=on", "1.5:wait-at-next-stop=off"]), 1.7);
    near(duration(corner, &["0.1:wait-at-next-stop=on", "0.15:wait-at-next-stop=off"]), 0.4);
    // A slow stop after 15 mm takes 0.1 s and 5 mm; the 20 mm that are left take 0.3 s from rest.
    let long = "% long\nN10 G92 X0 Y0\nN20 G1 X40 F100 E1000 E-1000\n";
    near(duration(long, &["0.2:slow-stop=on", "1:slow-stop=off"]), 1.3);
}

/// The workpiece comes to 100 mm/s with 1000 mm/s² in 0.1 s and 5 mm, and passes on; on the path Y goes twice as far as X.
/// Every set-point is the point of the path at the measured X (manual 6.6).
#[test]
fn the_path_follows_a_workpiece() {
    let contour = "% contour\nN10 G92 X0 Y0\nN20 G1 X20 Y40 F50 E5000 E-5000\n";
    let run = |at: &dyn Fn(f64) -> f64, offset| {
        let positions = (0..=400).map(|cycle| at(f64::from(cycle) * 1e-3)).collect();
        let workpiece = Workpiece { positions, offset, direction: XDirection::Positive };
        checked(contour, ReadSettings { workpiece: Some(workpiece), ..ReadSettings::default() })
    };
    let speeds_up = |time: f64| if time < 0.1 { 0.5 * time * time } else { 0.1 * time - 0.005 };
    // 15 mm at 100 mm/s are left.
    let outcome = run(&speeds_up, 0.0);
    near(seconds(outcome.duration_ns), 0.25);
    let [x, y, _] = &outcome.peaks[..] else { panic!("three axes") };
    assert!((x.velocity.value - 0.1).abs() < 1e-6 && (y.velocity.value - 0.2).abs() < 1e-6);
    assert!((x.acceleration.value - 1.0).abs() < 1e-3 && (y.acceleration.value - 2.0).abs() < 2e-3);
    // It does not stop where the path ends.
    let [ends] = &outcome.findings[..] else { panic!("{:#?}", outcome.findings) };
    assert_eq!(
        (ends.rule, ends.severity, ends.line),
        (Rule::AxisAcceleration, Severity::Warning, 3)
    );
    // One that does, 0.05 s later.
    let stops = |time: f64| {
        let left = (0.3 - time).max(0.0);
        if time < 0.2 { speeds_up(time) } else { 0.02 - 0.5 * left * left }
    };
    let outcome = run(&stops, 0.0);
    assert!(outcome.findings.is_empty(), "{:#?}", outcome.findings);
    near(seconds(outcome.duration_ns), 0.3);
    // With an offset the path begins when its zero is there: 5 mm after 0.1 s.
    let outcome = run(&|time| speeds_up(time), 5e-3);
    near(seconds(outcome.duration_ns), 0.3);
}
