//! Tests of gears and cams of the machine file, and of the motion of their slaves.

use super::{Machine, SHORT, load};
use crate::CoupledBy;
use crate::axis_couplings::{AxesError, AxisCouplings};
use twin_kinematics::{AxisMotion, AxisVector};

fn near(one: f64, other: f64) {
    assert!((one - other).abs() <= 1e-12, "{one} is not {other}");
}

fn with(text: &str) -> String {
    format!("{SHORT}{text}")
}

const GEAR: &str =
    "[[gears]]\naxis = \"Y\"\nmaster = \"X\"\nratio_numerator = -3\nratio_denominator = 2\n";

fn at(position: [f64; 3], velocity: [f64; 3], acceleration: [f64; 3]) -> AxisMotion {
    let [position, velocity, acceleration] =
        [position, velocity, acceleration].map(AxisVector::from_values);
    AxisMotion { position, velocity, acceleration }
}

#[test]
fn a_gear_counts_from_where_both_start() {
    let machine = load(&with(GEAR));
    assert!(matches!(machine.couplings[0].by, CoupledBy::Gear(-3, 2)));
    let mut coupled = AxisCouplings::new(&machine);
    let mut axes = at([0.1, 0.2, 0.0], [0.0; 3], [0.0; 3]);
    coupled.apply(&mut axes, 0).unwrap();
    near(axes.position[1], 0.2);
    let mut axes = at([0.14, 0.2, 0.0], [0.5, 0.0, 0.0], [2.0, 0.0, 0.0]);
    coupled.apply(&mut axes, 1_000_000).unwrap();
    near(axes.position[1], 0.2 - 0.06);
    near(axes.velocity[1], -0.75);
    near(axes.acceleration[1], -3.0);
}

#[test]
fn the_program_must_not_move_a_slave() {
    let machine = load(&with(GEAR));
    let mut coupled = AxisCouplings::new(&machine);
    coupled.apply(&mut at([0.0; 3], [0.0; 3], [0.0; 3]), 0).unwrap();
    let moved = coupled.apply(&mut at([0.0, 0.001, 0.0], [0.0; 3], [0.0; 3]), 1_000_000);
    let said = moved.unwrap_err();
    assert!(matches!(said, AxesError::Moved { .. }));
    assert_eq!(
        said.to_string(),
        "axis Y follows X by a gear of the machine file, but the program moves it from 0.000 to 1.000 mm"
    );
}

/// A straight cam of 2 mm per mm with an offset of 5 mm, so that everything is known in closed form; and a gear behind it.
#[test]
fn a_cam_drives_an_axis_that_drives_another() {
    let folder = tempfile::tempdir().unwrap();
    let cam = "master = { min = 0, max = 100 }\nelements = [{ from = [0, 0], to = [100, 200] }]\n";
    std::fs::write(folder.path().join("ramp.toml"), cam).unwrap();
    // The gear is written before the cam whose slave is its master.
    let text = with(
        "[[gears]]\naxis = \"Z\"\nmaster = \"Y\"\nratio_numerator = 1\nratio_denominator = 10\n[[cams]]\naxis = \"Y\"\n\
         master = \"X\"\ncam = \"ramp.toml\"\nperiodic = false\nslave_offset_mm = 5\n",
    );
    let machine = Machine::parse(&folder.path().join("machine.toml"), &text).unwrap();
    let rest = AxisVector::from_values([0.01, 0.0, 0.0]);
    let rest = AxisCouplings::at_rest(&machine, rest).unwrap();
    near(rest[1], 0.025);
    near(rest[2], 0.0);
    let mut coupled = AxisCouplings::new(&machine);
    coupled.apply(&mut at([0.01, 0.0, 0.0], [0.0; 3], [0.0; 3]), 0).unwrap();
    let mut axes = at([0.05, 0.0, 0.0], [0.1, 0.0, 0.0], [1.0, 0.0, 0.0]);
    coupled.apply(&mut axes, 1_000_000).unwrap();
    near(axes.position[1], 0.105);
    near(axes.velocity[1], 0.2);
    near(axes.acceleration[1], 2.0);
    near(axes.position[2], 0.008);
    near(axes.velocity[2], 0.02);
}

/// A modulo axis that has gone round is where it shows itself to be, as for the blocks on axes.
#[test]
fn a_cam_knows_the_period_of_its_master() {
    let folder = tempfile::tempdir().unwrap();
    let cam = "master = { min = 0, max = 360 }\nelements = [{ from = [0, 0], to = [360, 36] }]\n";
    std::fs::write(folder.path().join("turn.toml"), cam).unwrap();
    let text = format!(
        "{}[[axes]]\nname = \"C\"\nrole = \"P\"\nkind = \"rotary\"\nperiod_deg = 360\nmax_velocity_deg_per_s = 360\n\
         max_acceleration_deg_per_s2 = 3600\n[[cams]]\naxis = \"Y\"\nmaster = \"C\"\ncam = \"turn.toml\"\nperiodic = false\n",
        super::programs::without_drive()
    );
    let machine = Machine::parse(&folder.path().join("machine.toml"), &text).unwrap();
    let at = |degrees: f64| {
        let values = [0.0, 0.0, 0.0, degrees.to_radians()];
        AxisMotion::at_rest(AxisVector::from_values(values))
    };
    let mut coupled = AxisCouplings::new(&machine);
    let mut axes = at(400.0);
    coupled.apply(&mut axes, 0).unwrap();
    near(axes.position[1], 4e-3);
    let mut axes = at(410.0);
    coupled.apply(&mut axes, 1_000_000).unwrap();
    near(axes.position[1], 5e-3);
}

/// What `[coupling]` of a cam's file and `--master-scaling` refuse, `[[cams]]` refuse at the same key.
#[test]
fn scalings_of_nothing_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("machine.toml");
    let cam = "master = { min = 0, max = 9 }\nelements = [{ from = [0, 0], to = [9, 9] }]\n";
    std::fs::write(folder.path().join("c.toml"), cam).unwrap();
    let cams = "[[cams]]\naxis = \"X\"\nmaster = \"Y\"\ncam = \"c.toml\"\n";
    for key in ["master_scaling", "slave_scaling"] {
        for (value, said) in [
            ("0", "is 0; nothing would move"),
            ("-0.0", "is 0; nothing would move"),
            ("-9e-16", "is -9e-16; 1e-15 is the least scaling"),
            ("inf", "is inf"),
            ("nan", "is nan"),
        ] {
            let text = with(&format!("{cams}{key} = {value}\n"));
            let found = Machine::parse(&path, &text).expect_err("no machine");
            let [problem] = found.as_slice() else { panic!("{found:?}") };
            assert!(problem.message.starts_with(&format!("`{key}` {said}")), "{problem:?}");
            let found_text = text.get(problem.span.clone()).unwrap();
            assert!(found_text.contains(key) || found_text.contains(value), "{found_text}");
        }
        for value in ["1e-15", "-1e-15"] {
            assert!(Machine::parse(&path, &with(&format!("{cams}{key} = {value}\n"))).is_ok());
        }
    }
}
