//! Tests of motors, transmissions and drives of the simulated machine in machine files.

use super::{SHORT, edited, load, problems};
use crate::{FeedForward, Machine, SimulatedAxis, SimulatedMotor};
use std::f64::consts::TAU;
use twin_physics::{AxisDriveParameters, EffortFeedForward, EncoderSide, Motor};

fn near(one: f64, other: f64) {
    assert!((one - other).abs() <= 1e-12 * other.abs(), "{one} is not {other}");
}

/// What is wrong with `text` says, somewhere, each of `words`.
#[track_caller]
fn refused_text(text: &str, words: &[&str]) {
    let said: Vec<String> = problems(text)
        .into_iter()
        .map(|(_, message, help)| format!("{message}; {}", help.unwrap_or_default()))
        .collect();
    for word in words {
        assert!(said.iter().any(|said| said.contains(word)), "{said:#?} lack {word}");
    }
}

/// [`SHORT`] with these lines behind its X axis: 400 mm/s.
fn text(lines: &str) -> String {
    edited(SHORT, "per_mm = 10\n", &format!("per_mm = 10\n{lines}\n"))
}

fn with(lines: &str) -> (Machine, SimulatedAxis) {
    let machine = load(&text(lines));
    let simulated = machine.axes[0].simulated.clone();
    (machine, simulated)
}

const SERVO: &str = r#"
[axes.physics]
coulomb_friction_n = 20
breakaway_friction_n = 30
stribeck_velocity_mm_per_s = 2
[axes.physics.transmission]
gear_ratio = 2
pitch_mm = 10
inertia_kg_m2 = 1e-5
stiffness_n_per_mm = 20000
damping_ratio = 0.03
backlash_mm = 0.01
[axes.physics.servo]
rotor_inertia_kg_m2 = 3e-5
peak_torque_nm = 4
continuous_torque_nm = 1.3
thermal_time_constant_s = 20
torque_rpm_nm = [[0, 4], [3000, 4], [6000, 1]]
friction_nm = 0.05
viscous_friction_nm_s_per_rad = 1e-4
position_gain_per_s = 60
integral_time_ms = 12
velocity_feed_forward_percent = 90
torque_feed_forward = "dynamics"
current_loop_bandwidth_hz = 900
position_loop_period_us = 500
velocity_loop_period_us = 125
delay_periods = 2
[axes.physics.encoder]
on = "axis"
resolution_mm = 0.001
[axes.physics.brake]
torque_nm = 2
closing_time_ms = 30
[axes.physics.switches]
lower_mm = -55
upper_mm = 655
home_mm = [-52, -51]
"#;

/// Everything is said at the shaft: 2 turns in 10 mm are 400·π rad in a metre.
#[test]
fn a_servo_motor_at_its_shaft() {
    let (_, axis) = with(SERVO);
    let ratio = 2.0 * TAU / 0.01;
    near(axis.armature, 4e-5 * ratio * ratio);
    // At 400 mm/s the motor turns 4800 times a minute, where 2.2 Nm are left.
    near(axis.effort_limit, 2.2 * ratio);
    near(axis.motor_friction.coulomb, 0.05 * ratio);
    near(axis.motor_friction.viscous, 1e-4 * ratio * ratio);
    near(axis.dry_friction(), 20.0 + 0.05 * ratio);
    near(axis.friction.breakaway, 30.0);
    near(axis.friction.stribeck_velocity, 2e-3);
    let overload = axis.overload.unwrap();
    near(overload.continuous_effort, 1.3 * ratio);
    near(overload.time_constant, 20.0);
    let brake = axis.brake.unwrap();
    near(brake.effort, 2.0 * ratio);
    near(brake.closing_time, 0.03);
    near(axis.switches.lower.unwrap(), -0.055);
    near(axis.switches.upper.unwrap(), 0.655);
    let [from, to] = axis.switches.home.unwrap();
    near(from, -0.052);
    near(to, -0.051);

    let AxisDriveParameters { motor: Motor::Servo(servo), transmission, .. } = axis.drive(25.0)
    else {
        panic!("a servo drive")
    };
    near(servo.position_gain, 60.0);
    near(servo.integral_time, 0.012);
    near(servo.velocity_feed_forward, 0.9);
    assert_eq!(servo.effort_feed_forward, EffortFeedForward::Dynamics(1.0));
    near(servo.velocity_gain, (25.0 + axis.armature) * TAU * 50.0);
    near(servo.effort_limit, 4.0 * ratio);
    near(servo.effort_curve.at(0.375), 2.5 * ratio);
    near(servo.current_bandwidth, TAU * 900.0);
    assert_eq!((servo.position_passes, servo.velocity_passes, servo.delay), (2, 8, 2));
    assert_eq!(servo.encoder.side, EncoderSide::Axis);
    near(servo.encoder.resolution, 1e-6);
    let elastic = transmission.unwrap();
    near(elastic.stiffness, 2e7);
    near(elastic.backlash, 1e-5);
    let reduced = 25.0 * axis.armature / (25.0 + axis.armature);
    near(elastic.damping, 2.0 * 0.03 * (2e7 * reduced).sqrt());
}

/// A step motor with 200 full steps on a screw of 5 mm.
#[test]
fn a_step_motor_at_its_shaft() {
    let (_, axis) = with(
        "[axes.physics.transmission]\npitch_mm = 5\n[axes.physics.stepper]\nmicrosteps = 8\nrotor_inertia_kg_m2 = 5e-5\npull_out_rpm_nm = [[0, 2], [600, 1.8], [6000, 0.3]]\ndetent_torque_nm = 0.05\n",
    );
    let SimulatedMotor::Stepper(stepper) = &axis.motor else { panic!("a step motor") };
    let ratio = TAU / 0.005;
    near(stepper.full_step, 25e-6);
    assert_eq!(stepper.microsteps, 8);
    near(stepper.pull_out.at(0.0), 2.0 * ratio);
    // 600/min are 50 mm/s.
    near(stepper.pull_out.at(-0.05), 1.8 * ratio);
    near(stepper.detent, 0.05 * ratio);
    near(axis.armature, 5e-5 * ratio * ratio);
    // At 400 mm/s, 4800/min.
    near(axis.effort_limit, (1.8 - 1.5 * 4200.0 / 5400.0) * ratio);
}

/// What is not said: a rigid, ideal servo drive.
#[test]
fn what_is_not_said_is_ideal() {
    let (_, axis) = with("");
    let SimulatedMotor::Servo(servo) = &axis.motor else { panic!("a servo drive") };
    assert_eq!(servo.effort_feed_forward, FeedForward::Inertia);
    near(servo.velocity_feed_forward, 1.0);
    assert!(axis.effort_limit.is_infinite() && servo.parameters.current_bandwidth.is_infinite());
    assert!(axis.transmission.is_none() && axis.brake.is_none() && axis.overload.is_none());
    near(axis.dry_friction() + axis.viscous_friction() + axis.armature, 0.0);
    // The turns of the motor may be said where its speed is.
    let (_, known) = with(
        "max_motor_rpm = 3000\nmotor_turns_per_mm = 0.1\n[axes.physics.servo]\npeak_torque_nm = 1\n",
    );
    near(known.effort_limit, 100.0 * TAU);
    // What an axis may have at most binds plan and drive.
    let (_, limited) = with("[axes.physics]\nmax_force_n = 50\n");
    let Motor::Servo(drive) = limited.drive(10.0).motor else { panic!("a servo drive") };
    near(limited.effort_limit, 50.0);
    near(drive.effort_limit, 50.0);
}

/// [`SERVO`] with `line` in place of the one with its key.
fn servo(line: &str) -> String {
    let (key, _) = line.split_once(" = ").unwrap();
    let key = format!("{key} = ");
    let old = SERVO.lines().find(|old| old.starts_with(&key)).unwrap();
    text(&edited(SERVO, &format!("\n{old}\n"), &format!("\n{line}\n")))
}

#[test]
fn what_makes_no_sense_is_said() {
    for (line, said) in [
        ("peak_torque_nm = \"4\"", "`peak_torque_nm` is a string"),
        ("torque_rpm_nm = [[0, 4], [6000, 4], [3000, 1]]", "do not rise from pair to pair"),
        ("torque_rpm_nm = [[0, 4], [3000]]", "`torque_rpm_nm` has 1 entries; expected 2 numbers"),
        (
            "breakaway_friction_n = 3",
            "`breakaway_friction_n` is 3; it is at least the Coulomb friction, 20",
        ),
        (
            "position_loop_period_us = 300",
            "`position_loop_period_us` is 300; a millisecond is a whole number of periods",
        ),
        (
            "velocity_loop_period_us = 1000",
            "`position_loop_period_us` is not a multiple of `velocity_loop_period_us`",
        ),
        ("delay_periods = 9", "`delay_periods` is 9; it must lie between 0 and 8"),
        ("home_mm = [-51, -52]", "`home_mm` goes from -51 down to -52"),
        ("on = \"load\"", "`on` is \"load\"; expected \"motor\" or \"axis\""),
    ] {
        refused_text(&servo(line), &[said]);
    }
    for (line, said) in [
        ("pitch_mm = 10\n", "`gear_ratio` has no effect without `pitch_mm`"),
        (
            "stiffness_n_per_mm = 20000\n",
            "`backlash_mm` has no effect without `stiffness_n_per_mm`",
        ),
        ("torque_nm = 2\nclosing_time_ms", "[brake] lacks `torque_nm`"),
    ] {
        let (_, rest) = line.split_once('\n').unwrap();
        refused_text(&edited(&text(SERVO), line, rest), &[said]);
    }
    let unknown = text(SERVO).replace("rotor_inertia_kg_m2", "rotor_inertia_kg_m3");
    let meant = "did you mean `rotor_inertia_kg_m2`";
    refused_text(&unknown, &["unknown key `rotor_inertia_kg_m3`", meant]);
    let pitch = "[axes.physics.transmission]\npitch_mm = 5\n";
    let stepper = "[axes.physics.stepper]\n";
    let peak = "`peak_torque_nm` is of the motor's shaft and needs `pitch_mm`";
    refused_text(&text("[axes.physics.servo]\npeak_torque_nm = 4"), &[peak]);
    for (motor, said) in [
        ("stiffness_n_per_mm = 1000".to_owned(), "needs the inertia of its motor"),
        (format!("{stepper}microsteps = 8"), "[stepper] needs `holding_torque_nm`"),
        (
            format!("{stepper}holding_torque_nm = 2\n[axes.physics.servo]\n"),
            "an axis has a servo or a step motor",
        ),
    ] {
        refused_text(&text(&format!("{pitch}{motor}")), &[said]);
    }
}

/// The pull-out torque is what a step motor gives; what limits a servo would be ignored.
#[test]
fn a_largest_force_is_no_business_of_step_motors() {
    let stepper = "[axes.physics]\nmax_force_n = 50\n[axes.physics.transmission]\npitch_mm = 10\n[axes.physics.stepper]\n\
                   holding_torque_nm = 2\nrotor_inertia_kg_m2 = 1e-5\n";
    refused_text(&text(stepper), &["`max_force_n` does not apply to a step motor"]);
    let (_, alone) = with(&stepper.replace("max_force_n = 50\n", ""));
    assert!(alone.steps());
}
