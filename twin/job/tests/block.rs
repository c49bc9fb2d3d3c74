//! Tests of blocks that set zeros, follow profiles or go on with an end velocity, against closed forms.

#![expect(clippy::float_cmp, reason = "what must not move at all")]

use super::tests::{START, job, machine, moves, near, run, time};
use crate::setpoint::AxisSetpoint;

fn x(setpoint: &AxisSetpoint) -> [f64; 3] {
    let motion = &setpoint.axes;
    [motion.position[0], motion.velocity[0], motion.acceleration[0]].map(|value| value * 1e3)
}

fn at(setpoints: &[AxisSetpoint], seconds: f64) -> [f64; 3] {
    x(setpoints.iter().find(|one| (time(one) - seconds).abs() < 1e-9).unwrap())
}

fn to(position: f64) -> String {
    format!(
        "[[blocks]]\nblock = \"MC_MoveAbsolute\"\naxis = \"X\"\nposition_mm = {position:?}\nvelocity_mm_per_s = 200\n\
         acceleration_mm_per_s2 = 1000\n"
    )
}

/// What stands at 100 mm is called 0, then 50 mm of that are 60: targets count from there, and nothing jumps.
#[test]
fn a_zero_is_moved_and_not_the_axis() {
    let set =
        |keys: &str| format!("[[blocks]]\nblock = \"MC_SetPosition\"\naxis = \"X\"\n{keys}\n");
    let setpoints = moves(
        &[
            START.to_owned(),
            set("position_mm = 0"),
            to(50.0),
            set("position_mm = 10\nrelative = true"),
            to(0.0),
        ]
        .concat(),
    );
    let most = setpoints.iter().map(|one| x(one)[0]).fold(0.0, f64::max);
    near(most, 150.0, 1e-9);
    // 60 mm back from there.
    near(x(setpoints.last().unwrap())[0], 90.0, 1e-9);
    for pair in setpoints.windows(2) {
        assert!((x(&pair[1])[0] - x(&pair[0])[0]).abs() <= 0.2 + 1e-9);
    }
}

/// `MC_Home` takes where the axis stands for the reference: 100 mm are 20 from now on.
#[test]
fn homing_gives_the_place_another_name() {
    let home = "[[blocks]]\nblock = \"MC_Home\"\naxis = \"X\"\nposition_mm = 20\n";
    let setpoints = moves(&[START, home, &to(70.0)].concat());
    near(x(&setpoints[1])[0], 100.0, 0.0);
    near(x(setpoints.last().unwrap())[0], 150.0, 1e-9);
    for pair in setpoints.windows(2) {
        assert!((x(&pair[1])[0] - x(&pair[0])[0]).abs() <= 0.2 + 1e-9);
    }
    // An axis that moves is not at its reference (170).
    let moving = [START, &to(150.0), home, "at_s = 0.1\n"].concat();
    let (_, findings) = run(&job(&moving), &machine());
    assert!(findings[0].message.contains("SMC_H_AXIS_WASNT_STANDSTILL"), "{findings:?}");
    assert_eq!(findings[0].line, 14);
}

/// Through 120 mm after half a second, back and at rest after one.
#[test]
fn positions_over_time_are_followed() {
    let setpoints = moves(&format!(
        "{START}[[blocks]]\nblock = \"MC_PositionProfile\"\naxis = \"X\"\n\
         points = [{{ delta_s = 0.5, position_mm = 60 }}, {{ delta_s = 0.5, position_mm = 50 }}]\nscale = 2\n"
    ));
    near(at(&setpoints, 0.5)[0], 120.0, 1e-9);
    // By symmetry it turns there.
    near(at(&setpoints, 0.5)[1], 0.0, 1e-6);
    near(at(&setpoints, 1.0)[0], 100.0, 1e-9);
    let last = x(setpoints.last().unwrap());
    near(last[0], 100.0, 1e-9);
    assert_eq!(last[1], 0.0);
    near(time(setpoints.last().unwrap()), 1.0, 3e-3);
}

/// Accelerations on straight lines, 0 → 500 → 0 → −500 → 0 mm/s² in 0.1 s each: 50 mm/s after 0.2 s, and by symmetry 50 · 0.2 =
/// 10 mm in all. Velocities through points, and on with the last one until the axis is halted.
#[test]
fn accelerations_and_velocities_over_time_are_followed() {
    let points = |name: &str, values: &[(f64, f64)]| {
        let points: Vec<_> = values
            .iter()
            .map(|(time, value)| format!("{{ delta_s = {time:?}, {name} = {value:?} }}"))
            .collect();
        format!("points = [{}]\n", points.join(", "))
    };
    let values = [(0.1, 500.0), (0.1, 0.0), (0.1, -500.0), (0.1, 0.0)];
    let setpoints = moves(&format!(
        "{START}[[blocks]]\nblock = \"MC_AccelerationProfile\"\naxis = \"X\"\n{}",
        points("acceleration_mm_per_s2", &values)
    ));
    near(at(&setpoints, 0.1)[2], 500.0, 1e-6);
    near(at(&setpoints, 0.2)[1], 50.0, 1e-6);
    near(x(setpoints.last().unwrap())[0], 110.0, 1e-6);
    assert_eq!(x(setpoints.last().unwrap())[1], 0.0);

    let values = [(0.2, 100.0), (0.3, 100.0)];
    let setpoints = moves(&format!(
        "{START}[[blocks]]\nblock = \"MC_VelocityProfile\"\naxis = \"X\"\n{}[[blocks]]\nblock = \"MC_Halt\"\naxis = \"X\"\n\
         deceleration_mm_per_s2 = 1000\nafter_s = 0.1\n",
        points("velocity_mm_per_s", &values)
    ));
    near(at(&setpoints, 0.2)[1], 100.0, 1e-6);
    near(at(&setpoints, 0.55)[1], 100.0, 1e-6);
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
        let setpoints = moves(&format!(
            "{START}[[blocks]]\nblock = \"{name}\"\naxis = \"X\"\n{key}\nvelocity_mm_per_s = 200\nacceleration_mm_per_s2 = 1000\n\
             end_velocity_mm_per_s = 100\nend_direction = \"positive\"\n[[blocks]]\nblock = \"MC_Halt\"\naxis = \"X\"\n\
             deceleration_mm_per_s2 = 1000\nafter_s = 0.2\n"
        ));
        let passes = setpoints.iter().find(|one| x(one)[0] >= 150.0).unwrap();
        near(x(passes)[1], 100.0, 1e-6);
        near(x(setpoints.last().unwrap())[0], 175.0, 0.3);
        assert_eq!(x(setpoints.last().unwrap())[1], 0.0);
    }
}

#[test]
fn mistakes_in_points_are_told() {
    for (points, line, said) in [
        ("", 1, "1 to 100 `points`"),
        ("points = [{ delta_s = 0.1 }]\n", 4, "position_mm"),
        ("points = [{ delta_s = 0.1, position_mm = 1, speed = 2 }]\n", 4, "unknown key"),
    ] {
        let text = format!("[[blocks]]\nblock = \"MC_PositionProfile\"\naxis = \"X\"\n{points}");
        let (setpoints, findings) = run(&job(&text), &machine());
        assert_eq!(setpoints, []);
        let found = findings.iter().find(|one| one.message.contains(said) && one.line == line);
        assert!(found.is_some(), "{points}: {findings:?}");
    }
}
