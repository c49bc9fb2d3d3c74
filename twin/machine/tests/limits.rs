//! Tests of the limits of axes and path in machine files.

use super::{GANTRY3, SCARA2, SHORT, edited, load, near};
use crate::{AxisLimit, Machine, VelocitySource};
use twin_kinematics::AxisVector;

const TRIPOD: &str = include_str!("../../../machines/tripod.toml");
const GANTRY_H2: &str = include_str!("../../../machines/gantry_h2.toml");

/// [`SHORT`] with `line` behind the increments of its X axis: 400 mm/s, 3000 mm/s², 320 increments per mm.
fn with(lines: &str) -> Machine {
    load(&edited(SHORT, "per_mm = 10\n", &format!("per_mm = 10\n{lines}\n")))
}

fn x(machine: &Machine) -> AxisLimit {
    machine.axis_limits()[0]
}

#[test]
fn the_smallest_velocity_binds_and_is_known() {
    let plain = with("");
    assert_eq!(x(&plain).velocity.source, VelocitySource::Axis);
    near(x(&plain).velocity.value, 0.4);
    // The board makes 200 kHz: 625 mm/s.
    near(plain.axes[0].velocity_limits.step_frequency.unwrap(), 0.625);
    assert_eq!(plain.axes[0].velocity_limits.motor_speed, None);

    // 96 kHz are 300 mm/s.
    let slow = with("max_step_frequency_khz = 96");
    assert_eq!(x(&slow).velocity.source, VelocitySource::StepFrequency);
    near(x(&slow).velocity.value, 0.3);
    near(slow.axes[0].max_velocity, 0.3);
    near(slow.axes[0].velocity_limits.axis, 0.4);
    // 1500 turns a minute of a screw of 10 mm are 250 mm/s.
    let turning = "max_motor_rpm = 1500\nmotor_turns_per_mm = 0.1";
    let motor = with(&format!("max_step_frequency_khz = 96\n{turning}"));
    assert_eq!(x(&motor).velocity.source, VelocitySource::MotorSpeed);
    near(x(&motor).velocity.value, 0.25);
    let fast = with("max_motor_rpm = 3000\nmotor_turns_per_mm = 0.1");
    assert_eq!(x(&fast).velocity.source, VelocitySource::Axis);
    // Of equal ones that of the axis, regardless of rounding: 128 kHz, 2400 turns a minute.
    let equal =
        with("max_step_frequency_khz = 128\nmax_motor_rpm = 2400\nmotor_turns_per_mm = 0.1");
    assert_eq!(x(&equal).velocity.source, VelocitySource::Axis);
    assert_eq!(VelocitySource::StepFrequency.name(), "step frequency");

    // A gear of 50:1 makes 50 turns in 360 degrees; 1000 a minute are 120 deg/s.
    let gear = "max_velocity_deg_per_s = 240.0\nmax_motor_rpm = 1000\nmotor_turns_per_deg = 0.1388888888888889";
    let scara = load(&edited(SCARA2, "max_velocity_deg_per_s = 240.0", gear));
    near(x(&scara).velocity.value, 120f64.to_radians());
    // A drive that reverses is as fast.
    let reversed = edited(SHORT, "= 3200\nper_mm = 10", "= -3200\nper_mm = 10");
    near(load(&reversed).axes[0].velocity_limits.step_frequency.unwrap(), 0.625);
}

/// What the board cannot step is an error, unless the file says that the axis is to be kept within it.
#[test]
fn a_given_step_frequency_keeps_the_axis_within_the_drive() {
    let kept = edited(SHORT, "= 3200\n", "= 6400\nmax_step_frequency_khz = 200\n");
    near(load(&kept).axes[0].max_velocity, 0.3125);
    // A motor that is slow enough keeps it within, too.
    let turning = "= 6400\nmax_motor_rpm = 1500\nmotor_turns_per_mm = 0.1\n";
    near(load(&edited(SHORT, "= 3200\n", turning)).axes[0].max_velocity, 0.25);
}

/// A plan at these limits, run 1 / (1 − h) times as fast, is at the limits of the axis.
#[test]
fn headroom_is_left_to_the_override() {
    let jerk = "max_jerk_mm_per_s3 = 50000\nheadroom_percent = 20";
    let machine = with(jerk);
    let AxisLimit { velocity, acceleration, deceleration, jerk, headroom } = x(&machine);
    near(headroom, 0.2);
    let faster = 1.0 / 0.8f64;
    near(velocity.value * faster, 0.4);
    near(acceleration * faster.powi(2), 3.0);
    near(deceleration * faster.powi(2), 3.0);
    near(jerk.unwrap() * faster.powi(3), 50.0);
    // What the axis can do is what it was, and the other axes have no headroom.
    near(machine.axes[0].max_velocity, 0.4);
    let y = machine.axis_limits()[1];
    assert_eq!((y.headroom, y.jerk), (0.0, None));
    near(y.acceleration, 3.0);
}

#[test]
fn what_limits_the_path() {
    let plain = load(SHORT).path_limits;
    near(plain.blend_tolerance, 1e-6);
    assert_eq!(plain.tool_acceleration, None);
    assert_eq!((plain.centripetal_acceleration, plain.centripetal_jump), (None, None));
    let path = "[path]\nblend_tolerance_mm = 0.05\nmax_tool_acceleration_mm_per_s2 = 1500\n";
    let jump = "[preparation]\nmax_circular_acceleration_jump_mm_per_s2 = 700\n";
    let given = load(&format!("{SHORT}{path}{jump}")).path_limits;
    near(given.blend_tolerance, 5e-5);
    near(given.tool_acceleration.unwrap(), 1.5);
    assert_eq!(given.centripetal_acceleration, None);
    near(given.centripetal_jump.unwrap(), 0.7);
    let none = load(&format!("{SHORT}[path]\nblend_tolerance_mm = 0\n")).path_limits;
    assert_eq!(none.blend_tolerance, 0.0);
}

/// What moves with X of the portal: bridge 18, carriage 6, quill 3, tool 0.3 and rotor 6 kg; with Z the last two, and a
/// rotor of 3 kg, against gravity.
#[test]
fn motors_move_the_masses_of_the_file() {
    let mut dynamics = load(GANTRY3).path_dynamics().unwrap().unwrap();
    let at = AxisVector::from_values([0.1, 0.2, 0.05]);
    let along = AxisVector::from_values([0.6, 0.0, 0.8]);
    let torque = dynamics.at(&at, &along, &AxisVector::zeros(3)).unwrap();
    let [x, y, z] = torque.axes() else { panic!("three axes") };
    let close = |one: f64, other: f64| assert!((one - other).abs() < 1e-12, "{one} {other}");
    close(x.inertia, 33.3 * 0.6);
    close(x.weight, 0.0);
    close(y.inertia, 0.0);
    close(z.inertia, 6.3 * 0.8);
    close(z.weight, 3.3 * 9.81);
    close(z.viscous, 30.0 * 0.8);
    for axis in [x, y, z] {
        close(axis.centrifugal, 0.0);
    }
    assert_eq!(
        [x, y, z].map(|axis| (axis.limit, axis.dry)),
        [(600.0, 20.0), (400.0, 12.0), (300.0, 8.0)]
    );
    assert_eq!(torque.overloaded(), None);
}

#[test]
fn motors_of_every_machine_with_limits_have_torques() {
    assert!(load(SHORT).path_dynamics().unwrap().is_none());
    assert!(load(SCARA2).path_dynamics().unwrap().is_some());
    for text in [TRIPOD, GANTRY_H2] {
        let machine = load(text);
        assert!(machine.axes.iter().any(|axis| axis.simulated.effort_limit.is_finite()));
        assert!(machine.path_dynamics().unwrap().is_some(), "{}", machine.name);
    }
}

/// `fSWMaxDeceleration` is a limit of its own (manual 2.1.3): it limits the fall of the speed, in either direction.
#[test]
fn decelerations_have_a_limit_of_their_own() {
    const CYCLE: f64 = 1e-3;
    let plain = with("");
    assert_eq!(plain.axes[0].own_deceleration(), None);
    near(plain.axes[0].max_deceleration, 3.0);
    assert!(!plain.axes[0].slows(0.4, -3.0, CYCLE));

    let gentle = with("max_deceleration_mm_per_s2 = 1500");
    let axis = &gentle.axes[0];
    near(axis.own_deceleration().unwrap(), 1.5);
    for (velocity, acceleration, limit) in
        [(0.1, 1.0, 3.0), (-0.1, -1.0, 3.0), (0.1, -1.0, 1.5), (-0.1, 1.0, 1.5), (0.0, 1.0, 3.0)]
    {
        near(axis.acceleration_limit(axis.slows(velocity, acceleration, CYCLE)), limit);
    }
    near(x(&gentle).acceleration, 3.0);
    near(x(&gentle).deceleration, 1.5);
    let strong = with("max_deceleration_mm_per_s2 = 6000");
    near(x(&strong).acceleration, 3.0);
    near(x(&strong).deceleration, 6.0);
    let axis = &strong.axes[0];
    near(axis.acceleration_limit(axis.slows(0.1, -5.0, CYCLE)), 6.0);
    // In the last cycle before a standstill the velocity may be nothing already.
    near(axis.acceleration_limit(axis.slows(0.0, -5.0, CYCLE)), 6.0);
}
