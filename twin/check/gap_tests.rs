//! Tests of jumps that the axes bridge, against closed forms (manual 2.2.5, 3.2, 11.7.1).

use super::tests::checked;
use super::{CheckOptions, check};
use crate::finding::{Finding, Rule, Severity};
use crate::limit::Limits;
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use std::path::Path;
use twin_machine::Machine;
use twin_number::seconds;

/// X: 400 mm/s, 3000 mm/s².
const GANTRY3: &str = include_str!("../../tests/data/machines/gantry3.toml");
/// A: 240 deg/s, B: 300 deg/s, both 1500 deg/s²; arms of 250 and 200 mm.
const SCARA2: &str = include_str!("../../tests/data/machines/scara2.toml");

/// The example of manual 3.2: the zero-length G1 puts the first position out for a cycle.
const MANUAL: &str = "% example\nN10 G92 X100 Y100\nN20 G1 X100 Y100 F100 E1000 E-1000\nN30 G92 X50 Y100\nN40 G1 X60\n";

#[track_caller]
fn only_note(findings: &[Finding]) -> &Finding {
    let [note] = findings else { panic!("{findings:#?}") };
    assert_eq!((note.rule, note.severity), (Rule::Gap, Severity::Note));
    note
}

/// From X 100 to X 50 with 3000 mm/s² and without reaching 400 mm/s: 2·√(50/3000) s, at √(50·3000) mm/s in the middle. Then 10 mm
/// with F100 and E1000: 0.1 s up and 0.1 s down.
#[test]
fn the_manuals_example_is_bridged() {
    let bridge = 2.0 * (50.0_f64 / 3000.0).sqrt();
    let outcome = checked(GANTRY3, MANUAL);
    let note = only_note(&outcome.findings);
    assert_eq!((note.line, note.block), (4, Some(30)));
    assert!(note.message.contains("X by -50.000 mm, in 0.258 s"), "{}", note.message);
    let takes = seconds(outcome.duration_ns);
    // The G1 and the jump take a cycle each, and the ends of both motions are rounded up to cycles.
    assert!((bridge + 0.2..=bridge + 0.2 + 4.1e-3).contains(&takes), "{takes}");
    let [x, y, _] = &outcome.peaks[..] else { panic!("three axes") };
    let fastest = (50.0_f64 * 3000.0).sqrt() * 1e-3;
    assert!((x.velocity.value.abs() - fastest).abs() < 2e-3, "{x:?}");
    assert!((x.acceleration.value.abs() - 3.0).abs() < 1e-6, "{x:?}");
    assert_eq!(x.velocity.place.line, 4);
    assert!(y.velocity.value.abs() <= 0.0 && x.position == Some([0.05, 0.1]), "{x:?}");
}

/// Within the limits of the axes the bridge is the same; 10 mm with F100 take 0.1 s and ramps of 100/3000 s.
#[test]
fn it_is_bridged_within_the_limits_of_the_axes_too() {
    let machine = Machine::parse(Path::new("machine.toml"), GANTRY3).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.cnc");
    std::fs::write(&path, MANUAL).unwrap();
    let program =
        ProgramFile::new(&path, Some(Dialect::Din66025), ReadSettings::default()).unwrap();
    let options = CheckOptions { limits: Limits::Axes, ..CheckOptions::default() };
    let outcome = check(&machine, &program, options, &mut |_| {}).unwrap();
    assert_eq!(only_note(&outcome.findings).line, 4);
    let bridge = 2.0 * (50.0_f64 / 3000.0).sqrt();
    let takes = seconds(outcome.duration_ns);
    // E1000 counts as well.
    assert!((bridge + 0.1..=bridge + 0.2 + 5.1e-3).contains(&takes), "{takes}");
}

/// Each axis goes on its own: from stretched at 90° to stretched at 0° less a bit, A turns by 90° at 240 deg/s, B stays.
#[test]
fn each_axis_goes_on_its_own() {
    let program =
        "% turn\nN10 G92 X0 Y449 Z20\nN20 G1 X0 Y449 F100\nN30 G92 X449 Y0\nN40 G1 X440\n";
    let outcome = checked(SCARA2, program);
    let note = only_note(&outcome.findings);
    assert!(note.message.contains("A by -90.000 deg"), "{}", note.message);
    assert!(!note.message.contains("B by"), "{}", note.message);
    let a = &outcome.peaks[0];
    assert!((a.velocity.value.abs().to_degrees() - 240.0).abs() < 1e-6, "{a:?}");
}

/// A jump to where the set-point is already, and one at the beginning, which says where the path begins, move nothing.
#[test]
fn a_jump_of_nothing_is_none() {
    let program = "% none\nN10 G92 X10 Y10\nN20 G1 X20 F100\nN30 G92 X20 Y10\nN40 G1 X30\n";
    let outcome = checked(GANTRY3, program);
    assert!(outcome.findings.is_empty(), "{:#?}", outcome.findings);
}

/// Behind the gap everything is as without it: an M function right behind the jump waits its time.
#[test]
fn what_follows_is_later_by_the_bridge() {
    let without = "% m\nN10 G92 X50 Y100\nN20 M5\nN30 G1 X60 F100 E1000 E-1000\n";
    let with = "% m\nN5 G92 X100 Y100\nN6 G1 X100 F100\nN10 G92 X50 Y100\nN20 M5\nN30 G1 X60 F100 E1000 E-1000\n";
    let bridge = 2.0 * (50.0_f64 / 3000.0).sqrt();
    let times = [without, with].map(|text| seconds(checked(GANTRY3, text).duration_ns));
    let later = times[1] - times[0];
    assert!((bridge..=bridge + 3.1e-3).contains(&later), "{times:?}");
}

/// The program before ended at X 100: the axes bridge the 50 mm to the start of this one, as inside a program.
#[test]
fn a_program_continues_where_the_one_before_ended() {
    let machine = Machine::parse(Path::new("machine.toml"), GANTRY3).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.cnc");
    std::fs::write(&path, "% next\nN10 G92 X50 Y100\nN20 G1 X60 F100 E1000 E-1000\n").unwrap();
    let program =
        ProgramFile::new(&path, Some(Dialect::Din66025), ReadSettings::default()).unwrap();
    let bridge = 2.0 * (50.0_f64 / 3000.0).sqrt();
    let first = checked(GANTRY3, "% first\nN10 G92 X90 Y100\nN20 G1 X100 F100 E1000 E-1000\n");
    for limits in [Limits::Programmed, Limits::Axes] {
        let options = CheckOptions { limits, continues: first.end, ..CheckOptions::default() };
        let outcome = check(&machine, &program, options, &mut |_| {}).unwrap();
        let note = only_note(&outcome.findings);
        assert_eq!((note.line, note.block), (3, Some(20)));
        let moved = "the one before ended: each axis moves there at its own limits, X by -50.000 mm, in 0.258 s";
        assert!(note.message.contains(moved), "{}", note.message);
        assert_eq!(outcome.start, first.end);
        let takes = seconds(outcome.duration_ns);
        assert!((bridge + 0.1..=bridge + 0.2 + 5.1e-3).contains(&takes), "{takes}");
        assert!((outcome.peaks[0].acceleration.value.abs() - 3.0).abs() < 1e-6);
    }
    // One that begins there bridges nothing.
    let near = checked(GANTRY3, "% near\nN10 G92 X40 Y100\nN20 G1 X50 F100\n");
    let options =
        CheckOptions { limits: Limits::Programmed, continues: near.end, ..CheckOptions::default() };
    let outcome = check(&machine, &program, options, &mut |_| {}).unwrap();
    assert!(outcome.findings.is_empty(), "{:#?}", outcome.findings);
}

/// An additional axis that the machine does not have is named with its own line, though the axis moves in the blend at the end
/// of the line before, within the limits of the axes.
#[test]
fn an_additional_axis_is_named_with_its_line() {
    let machine = Machine::parse(Path::new("machine.toml"), GANTRY3).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.cnc");
    let text = "% P\nN20 G1 X200 F50 E500 E-500\nN30 G1 X100\nN40 G1 X50\nN50 G1 X20 P3\n";
    std::fs::write(&path, text).unwrap();
    let program =
        ProgramFile::new(&path, Some(Dialect::Din66025), ReadSettings::default()).unwrap();
    for limits in [Limits::Programmed, Limits::Axes] {
        let options = CheckOptions { limits, ..CheckOptions::default() };
        let outcome = check(&machine, &program, options, &mut |_| {}).unwrap();
        let mut errors = outcome.findings.iter().filter(|one| one.severity == Severity::Error);
        let error = errors.next().unwrap();
        assert_eq!((error.rule, error.line), (Rule::UnsupportedWord, 5), "{limits:?}");
    }
}
