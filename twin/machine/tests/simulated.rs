//! Tests of motors, transmissions and drives of the simulated machine in machine files.

use super::{SHORT, edited, load};
use crate::{FeedForward, Machine, SimulatedAxis, SimulatedMotor};
use std::f64::consts::TAU;
use twin_physics::{AxisDriveParameters, EffortFeedForward, EncoderSide, Motor};

fn near(one: f64, other: f64) {
    assert!((one - other).abs() <= 1e-12 * other.abs(), "{one} is not {other}");
}

/// [`SHORT`] with these lines behind its X axis: 400 mm/s.
pub(super) fn text(lines: &str) -> String {
    edited(SHORT, "per_mm = 10\n", &format!("per_mm = 10\n{lines}\n"))
}

fn with(lines: &str) -> (Machine, SimulatedAxis) {
    let machine = load(&text(lines));
    let simulated = machine.axes[0].simulated.clone();
    (machine, simulated)
}

pub(super) const SERVO: &str = include_str!("servo.toml");

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

#[test]
fn a_step_motor_needs_no_largest_force() {
    let (_, alone) = with(
        "[axes.physics.transmission]\npitch_mm = 10\n[axes.physics.stepper]\nholding_torque_nm = 2\nrotor_inertia_kg_m2 = 1e-5\n",
    );
    assert!(alone.steps());
}
