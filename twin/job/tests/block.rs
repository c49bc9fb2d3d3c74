//! Tests of blocks that set zeros, follow profiles or go on with an end velocity, against closed forms.

#![expect(clippy::float_cmp, reason = "what must not move at all")]

use super::{START, block, findings, finds, moves, near, time, x, x_at};
use crate::setpoint::AxisSetpoint;

const RATES: &str = "velocity_mm_per_s = 200; acceleration_mm_per_s2 = 1000";

fn to(position: f64, more: &str) -> String {
    block("MC_MoveAbsolute", "X", &format!("position_mm = {position:?}; {RATES}{more}"))
}

/// No step is farther than 200 mm/s make it.
fn without_jumps(setpoints: &[AxisSetpoint]) {
    for pair in setpoints.windows(2) {
        assert!((x(&pair[1])[0] - x(&pair[0])[0]).abs() <= 0.2 + 1e-9);
    }
}

/// The position 100 mm becomes 0, then 50 mm of that become 60: targets count from there, and nothing jumps.
#[test]
fn a_zero_is_moved_and_not_the_axis() {
    let set = |keys: &str| block("MC_SetPosition", "X", keys);
    let (zero, shift) = (set("position_mm = 0"), set("position_mm = 10; relative = true"));
    let setpoints = moves(&[START, &zero, &to(50.0, ""), &shift, &to(0.0, "")].concat());
    let most = setpoints.iter().map(|one| x(one)[0]).fold(0.0, f64::max);
    near(most, 150.0, 1e-9);
    // 60 mm back from there.
    near(x(setpoints.last().unwrap())[0], 90.0, 1e-9);
    without_jumps(&setpoints);
}

/// `MC_Home` takes the present position for the reference: 100 mm are 20 from now on.
#[test]
fn homing_gives_the_place_another_name() {
    let home = |more: &str| block("MC_Home", "X", &format!("position_mm = 20{more}"));
    let setpoints = moves(&[START, &home(""), &to(70.0, "")].concat());
    near(x(&setpoints[1])[0], 100.0, 0.0);
    near(x(setpoints.last().unwrap())[0], 150.0, 1e-9);
    without_jumps(&setpoints);
    // An axis in motion cannot home (170).
    let found = findings(&[START, &to(150.0, ""), &home("; at_s = 0.1")].concat());
    finds(&found[..1], 14, "SMC_H_AXIS_WASNT_STANDSTILL");
}

/// Points over time as a key of a block.
fn points(name: &str, values: &[(f64, f64)]) -> String {
    let point =
        |(time, value): &(f64, f64)| format!("{{ delta_s = {time:?}, {name} = {value:?} }}");
    format!("points = [{}]", values.iter().map(point).collect::<Vec<_>>().join(", "))
}

/// Through 120 mm after half a second, back and at rest after one.
#[test]
fn positions_over_time_are_followed() {
    let keys = points("position_mm", &[(0.5, 60.0), (0.5, 50.0)]) + "; scale = 2";
    let setpoints = moves(&[START, &block("MC_PositionProfile", "X", &keys)].concat());
    near(x_at(&setpoints, 0.5)[0], 120.0, 1e-9);
    // By symmetry it turns there.
    near(x_at(&setpoints, 0.5)[1], 0.0, 1e-6);
    near(x_at(&setpoints, 1.0)[0], 100.0, 1e-9);
    let last = x(setpoints.last().unwrap());
    near(last[0], 100.0, 1e-9);
    assert_eq!(last[1], 0.0);
    near(time(setpoints.last().unwrap()), 1.0, 3e-3);
}

/// Accelerations on straight lines, 0 → 500 → 0 → −500 → 0 mm/s² in 0.1 s each: 50 mm/s after 0.2 s, and by symmetry 50 · 0.2 =
/// 10 mm in all. Velocities through points, and on with the last one until the axis is halted.
#[test]
fn accelerations_and_velocities_over_time_are_followed() {
    let values = [(0.1, 500.0), (0.1, 0.0), (0.1, -500.0), (0.1, 0.0)];
    let keys = points("acceleration_mm_per_s2", &values);
    let setpoints = moves(&[START, &block("MC_AccelerationProfile", "X", &keys)].concat());
    near(x_at(&setpoints, 0.1)[2], 500.0, 1e-6);
    near(x_at(&setpoints, 0.2)[1], 50.0, 1e-6);
    near(x(setpoints.last().unwrap())[0], 110.0, 1e-6);
    assert_eq!(x(setpoints.last().unwrap())[1], 0.0);

    let keys = points("velocity_mm_per_s", &[(0.2, 100.0), (0.3, 100.0)]);
    let halt = block("MC_Halt", "X", "deceleration_mm_per_s2 = 1000; after_s = 0.1");
    let setpoints = moves(&[START, &block("MC_VelocityProfile", "X", &keys), &halt].concat());
    near(x_at(&setpoints, 0.2)[1], 100.0, 1e-6);
    near(x_at(&setpoints, 0.55)[1], 100.0, 1e-6);
    assert_eq!(x(setpoints.last().unwrap())[1], 0.0);
    // 0.5 s of the profile, 0.1 s on, 0.1 s to rest.
    near(time(setpoints.last().unwrap()), 0.7, 5e-3);
}

/// At 150 mm with 100 mm/s, and on with that; halted 0.2 s later it comes 20 mm and 5 mm further.
#[test]
fn a_move_goes_on_with_its_end_velocity() {
    for (name, key) in [
        ("SMC_MoveContinuousAbsolute", "position_mm = 150"),
        ("SMC_MoveContinuousRelative", "distance_mm = 50"),
    ] {
        let end = "end_velocity_mm_per_s = 100; end_direction = \"positive\"";
        let move_on = block(name, "X", &format!("{key}; {RATES}; {end}"));
        let halt = block("MC_Halt", "X", "deceleration_mm_per_s2 = 1000; after_s = 0.2");
        let setpoints = moves(&[START, &move_on, &halt].concat());
        let passes = setpoints.iter().find(|one| x(one)[0] >= 150.0).unwrap();
        near(x(passes)[1], 100.0, 1e-6);
        near(x(setpoints.last().unwrap())[0], 175.0, 0.3);
        assert_eq!(x(setpoints.last().unwrap())[1], 0.0);
    }
}
