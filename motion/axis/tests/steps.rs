//! Regression tests of takeovers that once made the set position or its velocity step; random sequences found them.

use super::*;

#[test]
fn a_motion_on_top_of_a_gear_comes_once() {
    let (mut master, mut slave) = (linear(), linear());
    let (mut lead, mut on_top) = (endless(10.0), on_top(7.0, 5.0, 50.0));
    let (acceleration, deceleration) = (100.0, 100.0);
    let mut block = Block::new(GearIn { acceleration, deceleration, ..gear(1, 1).inputs });
    let (mut done, mut before) = (false, 0.0);
    for cycle in 0..500 {
        master.call(&mut lead, true);
        done |= slave.cycle(|axis| {
            block.follow(true, &master.axis, axis);
            on_top.call(cycle > 100, axis).done
        });
        let position = slave.axis.set_position();
        assert!((0.0..=15.0 * CYCLE + 1e-9).contains(&(position - before)), "{cycle}: {position}");
        before = position;
    }
    assert!(done);
    // 10 u/s are reached together; then the master's way and 7 u.
    assert!((before - master.axis.set_position() - 7.0).abs() < 1e-9, "{before}");
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

/// A position and a velocity that do not fit each other are a jump, however near the position is.
#[test]
fn a_position_beside_its_velocity_is_bridged() {
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

/// Over the positions of one that starts from rest it would be infinitely fast.
#[test]
fn a_moving_slave_waits_for_a_steady_master() {
    let (mut axes, mut alone) = ([linear(), linear()], endless(8.0));
    axes[0].run(50, |_| ());
    axes[1].calls(50, &mut alone);
    let mut lead = Block::new(MoveVelocity { acceleration: 40.0, ..endless(10.0).inputs });
    let mut block = in_pos([1, 1], [20.0, axes[1].axis.set_position() + 25.0], 0.0);
    let (mut began, mut before) = (None, axes[1].axis.set_velocity());
    for cycle in 0..400 {
        let shown = follow(&mut axes, &mut lead, &mut block);
        let velocity = axes[1].axis.set_velocity();
        if block.running().is_some_and(GearInPosRun::is_coupling) && began.is_none() {
            began = Some(cycle);
            // A quarter more than 8 u/s at most, as the master's.
            assert!((velocity - before).abs() <= 0.25 * 8.0 + 1e-9, "{velocity}");
        }
        assert_eq!(shown.done, axes[0].axis.set_position() >= 20.0 - 1e-9);
        before = velocity;
    }
    // 0.4 u/s more each cycle: the fifth is a quarter more than the fourth.
    assert_eq!(began, Some(4));
    let behind = axes[1].axis.set_position() - block.inputs.slave_sync_position;
    assert!((behind - (axes[0].axis.set_position() - 20.0)).abs() < 1e-9);
}

/// The block below has been called in this cycle already, the superimposed one has not.
#[test]
fn a_cam_takes_over_both_motions_that_there_are() {
    let (master, mut slave) = (linear(), linear());
    let mut block = cam_in(straight(100.0, 0.5), ramp_in(20.0, 50.0));
    let (mut below, mut on_top) = (endless(5.0), on_top(50.0, 3.0, 100.0));
    slave.run(50, |axis| (below.call(true, axis), on_top.call(true, axis)));
    assert!((slave.axis.set_velocity() - 8.0).abs() < 1e-9);
    let before = slave.axis.set_position();
    slave.cycle(|axis| {
        below.call(true, axis);
        block.follow(true, &master.axis, axis);
        on_top.call(true, axis);
    });
    let way = slave.axis.set_position() - before;
    assert!((way - 8.0 * CYCLE).abs() < 1e-9, "{way}");
    assert!((slave.axis.set_velocity() - 8.0).abs() < 1e-9);
}
