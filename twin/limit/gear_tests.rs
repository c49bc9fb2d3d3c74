//! Programs on machines with gears, within the limits of all axes, against closed forms.

use crate::check::{CheckOptions, check};
use crate::limit::Limits;
use crate::machine::Machine;
use crate::program::{Dialect, ProgramFile};
use crate::settings::ReadSettings;
use std::path::Path;

fn gantry(gears: &str) -> Machine {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines/gantry3.toml");
    let text = std::fs::read_to_string(shipped).unwrap();
    let mut machine = Machine::parse(Path::new("gantry3.toml"), &[&text, gears].concat()).unwrap();
    for (axis, [velocity, acceleration]) in
        machine.axes.iter_mut().zip([[0.4, 3.0], [0.3, 2.0], [0.06, 0.3]])
    {
        axis.max_velocity = velocity;
        axis.max_acceleration = acceleration;
        axis.max_jerk = None;
        axis.simulated.effort_limit = f64::INFINITY;
    }
    machine
}

const TO_Y: &str =
    "\n[[gears]]\naxis = \"Y\"\nmaster = \"X\"\nratio_numerator = 3\nratio_denominator = 1\n";
const TO_Z: &str =
    "[[gears]]\naxis = \"Z\"\nmaster = \"Y\"\nratio_numerator = -1\nratio_denominator = 5\n";

/// X goes 60 mm; how long that takes, s. Nothing may be found wrong with it.
fn seconds(machine: &Machine, limits: Limits) -> Result<f64, Vec<String>> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("along.cnc");
    std::fs::write(&path, "% along\nN10 G1 X60 F1000 E9000 E-9000\n").unwrap();
    let program =
        ProgramFile::new(&path, Some(Dialect::Din66025), ReadSettings::default()).unwrap();
    let options = CheckOptions { limits, ..CheckOptions::default() };
    let outcome = check(machine, &program, options, &mut |_| {}).unwrap();
    let errors = outcome.findings.iter().filter(|one| one.rule.name() != "feed-reduced");
    let errors: Vec<_> = errors.map(|one| one.message.clone()).collect();
    if errors.is_empty() { Ok(crate::report::seconds(outcome.duration_ns)) } else { Err(errors) }
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

/// Alone X has 400 mm/s and 3000 mm/s²; with Y three times as fast, whose limits are 300 and 2000, it has 100 and 667; with Z at
/// −3/5 of it behind that, 60 and 300, it is 100 and 500.
#[test]
fn a_program_is_slowed_to_what_slaves_in_gear_bear() {
    near(&gantry(""), trapezoid(400.0, 3000.0));
    near(&gantry(TO_Y), trapezoid(100.0, 2000.0 / 3.0));
    near(&gantry(&[TO_Y, TO_Z].concat()), trapezoid(100.0, 500.0));
}

/// The controller's own planning asks X for 1000 mm/s and the slave for three times that, which the check refuses.
#[test]
fn otherwise_the_check_refuses_it() {
    let told = seconds(&gantry(TO_Y), Limits::Softmotion).unwrap_err();
    assert!(told.iter().any(|message| message.contains('Y')), "{told:?}");
}
