//! Tests of direct set-points, diagnosis and auxiliary functions (manual 2.2).

use super::*;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// A cycle with another set-point: true while the interpolator has to wait.
fn stops(rig: &mut Rig, block: &mut ControlAxis, setpoint: Follow) -> bool {
    block.inputs().setpoint = setpoint;
    rig.cycle(|axis| block.call(true, axis)).stop_ipo
}

#[test]
fn followed_set_points_are_not_checked() {
    let (mut rig, mut block) = (linear(), Block::new(Follow::Position(0.0)));
    rig.call(&mut block, true);
    assert_eq!(rig.axis.state(), AxisState::SynchronizedMotion);
    block.inputs = Follow::Position(50.0);
    rig.call(&mut block, true);
    assert_eq!(rig.axis.set_position(), 50.0);
    assert_eq!(rig.axis.set_velocity(), 50.0 / CYCLE);
    assert!(rig.axis.exceeds_limits(true, false) && rig.axis.exceeds_limits(false, true));
    assert!(!rig.axis.exceeds_limits(false, false));
    block.inputs = Follow::PositionVelocity(50.0, 0.0);
    rig.call(&mut block, true);
    block.inputs = Follow::Velocity(10.0);
    rig.calls(2, &mut block);
    // The mean of 0 and 10 u/s for a cycle, then 10 u/s.
    assert!((rig.axis.set_position() - 50.15).abs() < 1e-9);
    let mut halt = Block::new(Halt { deceleration: 100.0 });
    rig.call(&mut halt, true);
    assert!(rig.cycle(|axis| (halt.call(true, axis), block.call(true, axis)).1).command_aborted);
}

#[test]
fn without_a_number_a_moving_axis_brakes() {
    for is_watched in [false, true] {
        let mut rig = linear();
        let mut followed = Block::new(Follow::Velocity(0.0));
        let mut controlled = Block::new(watched(Follow::Velocity(0.0), 10.0, 100.0));
        let mut cycle = |rig: &mut Rig, setpoint| {
            (followed.inputs, controlled.inputs.setpoint) = (setpoint, setpoint);
            let call = |axis: &mut Axis| {
                if is_watched { controlled.call(true, axis) } else { followed.call(true, axis) }
            };
            rig.cycle(call).error
        };
        // At rest it just stays.
        assert_eq!(cycle(&mut rig, Follow::Position(f64::NAN)), None);
        assert_eq!(rig.axis.set_position(), 0.0);
        for velocity in 1..=5_u8 {
            cycle(&mut rig, Follow::Velocity(f64::from(velocity)));
        }
        assert!((rig.axis.set_velocity() - 5.0).abs() < 1e-9);
        let error = cycle(&mut rig, Follow::PositionVelocity(1.0, f64::INFINITY));
        assert_eq!(error, Some(SmcError::FbWasntCalledDuringMotion));
        // 100 u/s² in the same cycle already.
        assert!((rig.axis.set_velocity() - 4.0).abs() < 1e-9);
        assert_eq!(rig.axis.state(), AxisState::ErrorStop);
    }
}

#[test]
fn a_jump_is_bridged_while_the_interpolator_waits() {
    let mut rig = Rig::new(AxisConfig {
        max_velocity: 20.0,
        max_acceleration: 1e4,
        max_deceleration: 1e4,
        ..AxisConfig::default()
    });
    let mut block = ControlAxis::new(watched(Follow::Position(0.0), 10.0, 100.0));
    for index in 0..10_u8 {
        let setpoint = Follow::Position(0.1 * f64::from(index));
        assert!(!stops(&mut rig, &mut block, setpoint), "10 u/s are allowed");
    }
    // The next program begins elsewhere.
    block.inputs().setpoint = Follow::Position(5.0);
    let mut before = rig.axis.set_position();
    let count = rig.until(|axis| {
        let held = block.call(true, axis).stop_ipo;
        assert!((axis.set_position() - before).abs() <= 10.0 * CYCLE + 1e-9);
        assert!(axis.set_velocity() <= 10.0 + 1e-9, "{}", axis.set_velocity());
        before = axis.set_position();
        !held
    });
    assert!(count > 10, "{count}");
    assert!((rig.axis.set_position() - 5.0).abs() < 1e-9);
    assert_eq!(rig.axis.set_velocity(), 0.0);
    // Without bAvoidGaps it jumps.
    block.inputs().avoid_gaps = false;
    assert!(!stops(&mut rig, &mut block, Follow::Position(0.0)));
    assert_eq!(rig.axis.set_position(), 0.0);
}

#[test]
fn jumps_of_velocity_and_of_position_with_velocity_are_bridged() {
    // 5 u/s with 20 u/s² take 25 cycles; 2 u with 20 u/s² take 2·√(2/20) s, 64 cycles.
    for (setpoint, gap, cycles, velocity) in [
        (Follow::Velocity(0.0), Follow::Velocity(5.0), 25, 5.0),
        (Follow::PositionVelocity(0.0, 0.0), Follow::PositionVelocity(2.0, 0.0), 64, 0.0),
    ] {
        let mut rig = Rig::new(AxisConfig { max_acceleration: 50.0, ..AxisConfig::default() });
        let mut block = ControlAxis::new(watched(setpoint, 10.0, 20.0));
        assert!(!rig.cycle(|axis| block.call(true, axis)).stop_ipo);
        block.inputs().setpoint = gap;
        let count = rig.until(|axis| {
            let held = block.call(true, axis).stop_ipo;
            assert!(axis.set_acceleration().abs() <= 20.0 + 1e-9);
            !held
        });
        assert_eq!(count, cycles);
        assert!((rig.axis.set_velocity() - velocity).abs() < 1e-9);
    }
}

/// A line of 10 u/s from rest is a step of 1000 u/s², ten times the limit; the manual watches the velocity.
#[test]
fn a_step_of_the_velocity_is_no_jump_of_positions() {
    let (mut rig, mut block) =
        (linear(), ControlAxis::new(watched(Follow::Position(0.0), 50.0, 80.0)));
    assert!(!rig.cycle(|axis| block.call(true, axis)).stop_ipo);
    for index in 1..=50_u8 {
        let place = 10.0 * CYCLE * f64::from(index);
        assert!(!stops(&mut rig, &mut block, Follow::Position(place)));
        assert!((rig.axis.set_position() - place).abs() < 1e-9, "not behind");
        // The step is reported in the first cycle only.
        assert_eq!(rig.axis.exceeds_limits(false, true), index == 1);
    }
    // The axis may go 1 u in a cycle of 10 ms; a little more is a jump.
    let place = 10.0 * CYCLE * 50.0;
    assert!(!stops(&mut rig, &mut block, Follow::Position(place + 1.0)));
    assert!(stops(&mut rig, &mut block, Follow::Position(place + 2.001)));
}

/// It jumps by 20 u and moves on with 30 u/s, so that relative to it 20 u/s of the gap velocity are left: from −30 u/s to
/// 20 u/s in 50/80 s (3.125 u further behind), from there to 0 in 0.25 s (2.5 u), and 20 + 3.125 − 2.5 u at 20 u/s between.
#[test]
fn a_bridge_meets_a_set_point_that_moves_on() {
    for sign in [1.0, -1.0] {
        let (mut rig, mut block) =
            (linear(), ControlAxis::new(watched(Follow::Position(0.0), 20.0, 80.0)));
        rig.cycle(|axis| block.call(true, axis));
        let (mut place, mut before, mut fastest) = (20.0, 0.0, 0.0_f64);
        let count = rig.until(|axis| {
            block.inputs().setpoint = Follow::Position(sign * place);
            place += 30.0 * CYCLE;
            let held = block.call(true, axis).stop_ipo;
            let velocity = axis.set_velocity();
            assert!((velocity - before).abs() <= 80.0 * CYCLE + 1e-9, "{velocity} {before}");
            fastest = fastest.max(velocity.abs());
            before = velocity;
            !held
        });
        let expected = 50.0 / 80.0 + 0.25 + (20.0 + 3.125 - 2.5) / 20.0;
        assert!((f64::from(count) * CYCLE - expected).abs() <= 3.0 * CYCLE, "{count}");
        assert!((fastest - 50.0).abs() < 1e-6, "{fastest}");
        assert!((before - sign * 30.0).abs() < 1e-9, "{before}");
        // And then it is followed without a step.
        for _ in 0..10 {
            assert!(!stops(&mut rig, &mut block, Follow::Position(sign * place)));
            assert!((rig.axis.set_position() - sign * place).abs() < 1e-9);
            assert!((rig.axis.set_velocity() - sign * 30.0).abs() < 1e-9);
            place += 30.0 * CYCLE;
        }
    }
}

#[test]
fn a_control_block_that_is_not_enabled_gives_the_axis_back() {
    let mut rig = linear();
    let mut block = ControlAxis::new(watched(Follow::Position(0.0), 0.0, 0.0));
    rig.cycle(|axis| block.call(true, axis));
    assert!(rig.axis.owner() != 0);
    rig.cycle(|axis| block.call(false, axis));
    assert_eq!((rig.axis.owner(), rig.axis.state()), (0, AxisState::Standstill));
    // Gap values of 0: the axis's own are used.
    block.inputs().setpoint = Follow::Position(5.0);
    rig.until(|axis| {
        block.call(true, axis);
        axis.set_position() == 5.0
    });
    assert_eq!(rig.axis.error_id(), None);
}

#[test]
fn the_largest_values_are_kept_with_their_times() {
    let (mut rig, mut block) = (linear(), endless(-10.0));
    let (mut velocity, mut acceleration) = (Largest::default(), Largest::default());
    let (mut with, mut without) = (TrackingError::new(1), TrackingError::new(0));
    for time in 0..50 {
        rig.call(&mut block, true);
        velocity.set_velocity(&rig.axis, false, time);
        acceleration.set_acceleration(&rig.axis, false, time);
        with.call(&rig.axis, false, time);
        without.call(&rig.axis, false, time);
    }
    // 10 u/s are reached in the tenth cycle.
    assert!((velocity.value - 10.0).abs() < 1e-9 && velocity.time == 9);
    assert_eq!(acceleration, Largest { value: 100.0, time: 0 });
    velocity.set_velocity(&rig.axis, true, 50);
    assert_eq!(velocity, Largest::default());
    // The virtual drive is one cycle behind; the tracking error leaves the bus out.
    assert!(with.error.abs() < 1e-12, "{}", with.error);
    assert!((without.error + 0.1).abs() < 1e-12);
    assert!((without.largest.value - 0.1).abs() < 1e-12);
}

#[test]
fn a_control_block_is_enabled_anew_while_another_one_moves_the_axis() {
    let mut rig = linear();
    let mut control = ControlAxis::new(watched(Follow::Position(0.0), 0.0, 80.0));
    let mut move_away = to(50.0);
    rig.cycle(|axis| control.call(true, axis));
    rig.run(5, |axis| (move_away.call(true, axis), control.call(true, axis)));
    let mut shown = |rig: &mut Rig, enable| {
        rig.cycle(|axis| (control.call(enable, axis), move_away.call(true, axis)).0)
    };
    assert!(shown(&mut rig, true).command_aborted);
    assert!(rig.axis.set_velocity() > 0.0);
    assert_eq!(shown(&mut rig, false), ControlOutputs::default());
    // The edge takes the axis, in motion, and bridges to its set-point.
    let taken = shown(&mut rig, true);
    assert!(!taken.command_aborted && taken.stop_ipo, "{taken:?}");
    assert_eq!(rig.axis.state(), AxisState::SynchronizedMotion);
    assert!(rig.axis.owner() != 0 && rig.axis.error_id().is_none());
}

#[test]
fn a_motion_on_top_of_direct_set_points_comes_once() {
    let (mut rig, mut block) = (linear(), Block::new(Follow::Position(0.0)));
    let (mut on_top, mut place) = (on_top(2.0, 5.0, 50.0), 0.0);
    rig.until(|axis| {
        place += 0.01;
        block.inputs = Follow::Position(place);
        block.call(true, axis);
        let done = on_top.call(true, axis).done;
        let velocity = axis.set_velocity();
        assert!((1.0 - 1e-9..=6.0 + 1e-9).contains(&velocity), "{velocity}");
        done
    });
    assert!((rig.axis.set_position() - place - 2.0).abs() < 1e-9);
}

fn control(setpoint: Follow) -> Block<ControlAxisBy> {
    Block::new(watched(setpoint, 10.0, 70.0))
}

/// 5 u/s with 70 u/s² are reached in the middle of the eighth cycle; for the rest of it the axis goes on.
#[test]
fn a_bridged_velocity_goes_on_for_the_rest_of_the_cycle() {
    let mut rig = linear();
    rig.calls(8, &mut control(Follow::Velocity(5.0)));
    let ramp = 5.0 / 70.0;
    let expected = 5.0 * (8.0 * CYCLE - 0.5 * ramp);
    assert!((rig.axis.set_position() - expected).abs() < 1e-9, "{}", rig.axis.set_position());
}

#[test]
fn a_position_that_does_not_fit_its_velocity_is_bridged() {
    let (mut rig, mut block) = (linear(), control(Follow::PositionVelocity(0.0, 0.0)));
    rig.call(&mut block, true);
    // 0.1 u in a cycle of 10 ms are 10 u/s: within the limit, but the axis rests before and after.
    block.inputs.setpoint = Follow::PositionVelocity(0.1, 0.0);
    rig.call(&mut block, true);
    assert_eq!(block.running().map(Watched::stop_ipo), Some(true));
    assert!((rig.axis.set_position() - 0.5 * 70.0 * CYCLE * CYCLE).abs() < 1e-12);
    rig.until(|axis| {
        block.call(true, axis);
        axis.set_velocity() == 0.0
    });
    assert!((rig.axis.set_position() - 0.1).abs() < 1e-12);
}

/// The end of the period is not a jump, and a jump over it is bridged the short way, to a set-point that moves on over it.
#[test]
fn set_points_go_over_the_end_of_the_period() {
    let (mut rig, mut block) = (rotary(), control(Follow::Position(0.0)));
    rig.call(&mut block, true);
    // 5 u/s from 355 on; the axis is 5 u ahead of it.
    let (mut place, mut met, mut way) = (355.0, None, 0.0);
    for cycle in 0..300 {
        place += 5.0 * CYCLE;
        block.inputs.setpoint = Follow::Position(place % 360.0);
        let before = rig.axis.set_position();
        rig.call(&mut block, true);
        way += short(&rig.axis, rig.axis.set_position() - before);
        let bridging = block.running().is_some_and(Watched::stop_ipo);
        if !bridging {
            met.get_or_insert(cycle);
        }
        assert_eq!(bridging, met.is_none(), "no jump after it has been met");
        if met.is_some_and(|met| cycle > met) {
            let off = short(&rig.axis, rig.axis.set_position() - place);
            assert!(off.abs() < 1e-9, "{off}");
        }
    }
    // It is met before the end, which it passes at 1 s; all in all from 0 to 370.
    assert!(met.is_some_and(|met| met < 100), "{met:?}");
    assert!((way - 10.0).abs() < 1e-9, "{way}");
}

/// Faster than the axis may go they are followed with the gap values.
#[test]
fn set_points_that_run_away_are_met_when_they_stand() {
    let (mut rig, mut block, mut count) = (linear(), control(Follow::Position(0.0)), 0);
    rig.call(&mut block, true);
    let met = rig.until(|axis| {
        count += 1;
        // 150 u/s, to 15 u; the axis may go 100 u/s, and bridges with 10 u/s.
        block.inputs.setpoint = Follow::Position(15.0_f64.min(1.5 * f64::from(count)));
        block.call(true, axis);
        assert!(axis.set_velocity() <= 10.0 + 1e-9, "{}", axis.set_velocity());
        !block.running().is_some_and(Watched::stop_ipo)
    });
    assert_eq!((rig.axis.set_position(), rig.axis.set_velocity()), (15.0, 0.0));
    // 15 u with 10 u/s and 70 u/s² take 1.643 s.
    assert_eq!(met, 165);
}

#[test]
fn remainders_are_never_negative_and_never_the_period() {
    let found = [370.0, -10.0, -30.0, 360.0, -720.0, -1e-20].map(|x| fmod(x, 360.0));
    assert_eq!(found, [10.0, 350.0, 330.0, 0.0, 0.0, 0.0]);
}

#[test]
fn angles_cover_the_whole_turn() {
    for (sine, cosine, angle) in [
        (0.0, 1.0, 0.0),
        (2.0, 2.0, FRAC_PI_4),
        (1.0, 0.0, FRAC_PI_2),
        (0.0, -1.0, PI),
        (-1.0, 0.0, 3.0 * FRAC_PI_2),
        (-3.0, 3.0, 7.0 * FRAC_PI_4),
    ] {
        assert!((atan2(sine, cosine) - angle).abs() < 1e-15, "{sine}, {cosine}");
    }
    assert!((0.0..TAU).contains(&atan2(-1e-300, 1.0)));
}

proptest! {
    /// sin(α)·f and cos(α)·f are the given values.
    #[test]
    fn angles_solve_the_manuals_equation(sine in -1e3..1e3, cosine in -1e3..1e3) {
        let factor = f64::hypot(sine, cosine);
        prop_assume!(factor > 1e-3);
        let angle = atan2(sine, cosine);
        prop_assert!((0.0..TAU).contains(&angle));
        prop_assert!((angle.sin() * factor - sine).abs() < 1e-9);
        prop_assert!((angle.cos() * factor - cosine).abs() < 1e-9);
    }
}
