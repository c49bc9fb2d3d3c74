//! Tests of programs on machines with gears and cams, within the limits of all axes, against closed forms.

use crate::check::{CheckOptions, check};
use crate::limit::Limits;
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use std::path::Path;
use twin_machine::Machine;

fn gantry(gears: &str) -> Machine {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/machines/gantry3.toml");
    let text = std::fs::read_to_string(shipped).unwrap();
    let mut machine = Machine::parse(Path::new("gantry3.toml"), &[&text, gears].concat()).unwrap();
    for axis in &mut machine.axes {
        axis.simulated.effort_limit = f64::INFINITY;
    }
    machine
}

/// Y follows X by the ratio `y`, and Z follows Y by the ratio `z`.
fn gears(y: [u32; 2], z: Option<[u32; 2]>) -> String {
    let gear = |slave: &str, master: &str, [numerator, denominator]: [u32; 2]| {
        format!(
            "\n[[gears]]\naxis = \"{slave}\"\nmaster = \"{master}\"\nratio_numerator = {numerator}\n\
             ratio_denominator = {denominator}\n"
        )
    };
    let behind = z.map(|ratio| gear("Z", "Y", ratio));
    [gear("Y", "X", y), behind.unwrap_or_default()].concat()
}

/// X goes 60 mm; how long that takes, s. Nothing may be found wrong with it.
fn seconds(machine: &Machine, limits: Limits) -> Result<f64, Vec<String>> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("along.cnc");
    std::fs::write(&path, "% along\nN10 G1 X60 F1000 E9000 E-9000\n").unwrap();
    let program =
        ProgramFile::new(&path, Some(Dialect::Din66025), ReadSettings::default()).unwrap();
    let options = CheckOptions { limits, ..CheckOptions::default() };
    let outcome = check(machine, &program, options, &mut |_| {}).unwrap();
    let expected = ["feed-reduced", "programmed-plan"];
    let errors = outcome.findings.iter().filter(|one| !expected.contains(&one.rule.name()));
    let errors: Vec<_> = errors.map(|one| one.message.clone()).collect();
    if errors.is_empty() { Ok(twin_number::seconds(outcome.duration_ns)) } else { Err(errors) }
}

/// From rest to rest over 60 mm with this velocity and acceleration of X, mm/s and mm/s².
fn trapezoid(velocity: f64, acceleration: f64) -> f64 {
    60.0 / velocity + velocity / acceleration
}

#[track_caller]
fn near(machine: &Machine, expected: f64) {
    let found = seconds(machine, Limits::Axes).unwrap();
    assert!((found - expected).abs() <= 0.003 * expected + 2e-3, "{found} s, not {expected} s");
}

/// X and Y have 400 mm/s and 3000 mm/s², Z has 200 and 2000. With Y three times as fast, X has a third; with Z, behind Y, as fast as
/// X, it has what Z has.
#[test]
fn a_program_is_slowed_to_what_slaves_in_gear_bear() {
    near(&gantry(""), trapezoid(400.0, 3000.0));
    near(&gantry(&gears([3, 1], None)), trapezoid(400.0 / 3.0, 1000.0));
    near(&gantry(&gears([1, 2], None)), trapezoid(400.0, 3000.0));
    near(&gantry(&gears([1, 2], Some([2, 1]))), trapezoid(200.0, 2000.0));
}

/// The controller's own planning asks X for 1000 mm/s and the slave for three times that, which the check refuses.
#[test]
fn otherwise_the_check_refuses_it() {
    let messages = seconds(&gantry(&gears([3, 1], None)), Limits::Programmed).unwrap_err();
    assert!(messages.iter().any(|message| message.contains('Y')), "{messages:?}");
}

/// Y on a cam behind X.
fn on_cam(cam: &str, keys: &str) -> Machine {
    let folder = tempfile::tempdir().unwrap();
    let head = "name = \"cam\"\nmaster = { min = 0, max = 120, unit = \"mm\" }\nslave = { min = 0, max = 400, unit = \"mm\" }\n";
    std::fs::write(folder.path().join("cam.toml"), [head, cam].concat()).unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/machines/gantry3.toml");
    let text = std::fs::read_to_string(shipped).unwrap();
    let cams = format!("\n[[cams]]\naxis = \"Y\"\nmaster = \"X\"\ncam = \"cam.toml\"\n{keys}");
    let path = folder.path().join("gantry3.toml");
    let mut machine = Machine::parse(&path, &[text, cams].concat()).unwrap();
    for axis in &mut machine.axes {
        axis.simulated.effort_limit = f64::INFINITY;
    }
    machine
}

/// A cam that is a straight line is a gear, wherever it begins and however it is scaled.
#[test]
fn a_straight_cam_is_a_gear() {
    let line = "elements = [{ master = 0, slave = 0, velocity = 3 }, { master = 120, slave = 360, velocity = 3 }]\n";
    let third = trapezoid(400.0 / 3.0, 1000.0);
    near(&on_cam(line, ""), third);
    near(&on_cam(line, "slave_absolute = false\nslave_offset_mm = 20\n"), third);
    near(&on_cam(line, "master_absolute = false\nmaster_offset_mm = 10\n"), third);
    near(&on_cam(line, "slave_scaling = -0.5\n"), trapezoid(400.0 / 1.5, 2000.0));
    near(
        &on_cam(line, "master_scaling = 0.5\nmaster_offset_mm = 30\n"),
        trapezoid(400.0 / 1.5, 2000.0),
    );
}

/// 80 mm over 120 mm from rest to rest: its slope is 15/8 · 80/120 = 1.25 at most, its curvature 5.774 · 80/120² = 0.0321/mm. No
/// motion is faster than X alone would be; with 200 mm/s and 1370 mm/s² of X the slave has 0.0321 · 200² + 1.25 · 1370 = 2996
/// mm/s² at most, so that the fastest motion is at least as fast as that. The check looks at every set-point.
#[test]
fn a_program_is_slowed_to_what_slaves_on_cams_bear() {
    let lift = "elements = [{ master = 0, slave = 0 }, { master = 120, slave = 80 }]\n";
    let machine = on_cam(lift, "");
    let found = seconds(&machine, Limits::Axes).unwrap();
    assert!(found > trapezoid(400.0, 3000.0) * 1.02, "{found}");
    assert!(found < trapezoid(200.0, 1370.0), "{found}");
    let messages = seconds(&machine, Limits::Programmed).unwrap_err();
    assert!(messages.iter().any(|message| message.contains('Y')), "{messages:?}");
}
