//! Tests of inputs that change while a program runs, against closed forms (manual 6.2.9, 6.6).

use super::{CheckOptions, Outcome, check};
use crate::finding::{Rule, Severity};
use crate::machine::Machine;
use crate::number::seconds;
use crate::program::inputs::{InputAt, Workpiece};
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use std::path::Path;
use twin_planner::controller::XDirection;

const GANTRY3: &str = include_str!("../../machines/gantry3.toml");

fn checked(text: &str, settings: ReadSettings) -> Outcome {
    let machine = Machine::parse(Path::new("machine.toml"), GANTRY3).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.cnc");
    std::fs::write(&path, text).unwrap();
    let program = ProgramFile::new(&path, Some(Dialect::Din66025), settings).unwrap();
    check(&machine, &program, CheckOptions::default(), &mut |_| {}).unwrap()
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

/// The workpiece passes with 100 mm/s; on the first element Y goes twice as far as X. At 20 mm the path is over, after 0.2 s.
#[test]
fn the_path_follows_a_workpiece() {
    let contour = "% contour\nN10 G92 X0 Y0\nN20 G1 X10 Y20 F50 E1000 E-1000\nN30 G1 X20\n";
    let run = |positions: Vec<f64>, offset| {
        let workpiece =
            Workpiece { positions: positions.into(), offset, direction: XDirection::Positive };
        checked(contour, ReadSettings { workpiece: Some(workpiece), ..ReadSettings::default() })
    };
    let outcome = run((0..=300).map(|cycle| f64::from(cycle) * 1e-4).collect(), 0.0);
    near(seconds(outcome.duration_ns), 0.2);
    assert!((outcome.peaks[0].velocity.value - 0.1).abs() < 1e-6, "{:?}", outcome.peaks[0]);
    assert!((outcome.peaks[1].velocity.value - 0.2).abs() < 1e-6, "{:?}", outcome.peaks[1]);
    let ends = outcome.findings.iter().find(|one| one.severity == Severity::Warning).unwrap();
    assert_eq!((ends.rule, ends.line), (Rule::AxisAcceleration, 4));
    // With an offset of 5 mm it is 0.05 s later at every point.
    let outcome = run((0..=300).map(|cycle| f64::from(cycle) * 1e-4).collect(), 5e-3);
    near(seconds(outcome.duration_ns), 0.25);
}
