//! Regression tests of takeovers that once made the set position or its velocity step; random sequences found them.

use super::blocks::endless;
use super::framework::to;
use super::rig::{self, CYCLE, Rig, linear, rotary};
use crate::{
    AxisConfig, AxisState, Block, CamIn, ControlAxisBy, ControllerMode, Follow, GearIn, GearInPos,
    GearInPosRun, Home, MoveVelocity, SetControllerMode, Watched,
};
use std::sync::Arc;
use twin_cam::{Cam, CamInput, CamTable, Knot, Shape, StartMode};
use twin_profile::RampType;

fn gear() -> Block<GearIn> {
    Block::new(GearIn {
        ratio_numerator: 1,
        ratio_denominator: 1,
        acceleration: 100.0,
        deceleration: 100.0,
    })
}

/// Beside a gear goes its own way, and the motion on top comes once.
#[test]
fn a_motion_on_top_of_a_gear_comes_once() {
    let (mut master, mut slave) = (linear(), linear());
    let (mut lead, mut block) = (endless(10.0), gear());
    let mut on_top = rig::on_top(7.0, 5.0, 50.0, 50.0);
    let mut done = false;
    let mut before = 0.0;
    for cycle in 0..500 {
        master.cycle(|axis| lead.call(true, axis));
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

/// Two axes that go alike are coupled; while the master accelerates, a slave with limited jerk that has its velocity but
/// no acceleration yet is not.
#[test]
fn a_gear_with_limited_jerk_takes_up_no_step_of_acceleration() {
    // 1000 u/s³ for a cycle of 10 ms, and as much where one ramp is given up for another.
    const MOST: f64 = 20.0;
    for ramp in [RampType::Sigmoid, RampType::Parabolic] {
        let config = AxisConfig { ramp, jerk: 1_000.0, ..AxisConfig::default() };
        let (mut master, mut slave) = (linear(), Rig::new(config));
        let (mut lead, mut alone, mut block) = (endless(10.0), endless(5.0), gear());
        for _ in 0..100 {
            slave.cycle(|axis| alone.call(true, axis));
        }
        // 100 u/s² of the master: 5 u/s after 5 cycles, where the slave is already.
        let (mut before, mut coupled) = (0.0, false);
        for cycle in 0..200 {
            master.cycle(|axis| lead.call(true, axis));
            slave.cycle(|axis| {
                alone.call(true, axis);
                if cycle >= 4 {
                    coupled = block.follow(true, &master.axis, axis).done;
                }
            });
            let acceleration = slave.axis.set_acceleration();
            let change = (acceleration - before).abs();
            assert!(change <= MOST + 1e-9, "{ramp:?}, cycle {cycle}: {before} to {acceleration}");
            before = acceleration;
        }
        assert!(coupled && (slave.axis.set_velocity() - 10.0).abs() < 1e-9);
    }
}

/// The same of set-points that a program gives: they are below it.
#[test]
fn a_motion_on_top_of_direct_set_points_comes_once() {
    let mut rig = linear();
    let mut block = Block::new(Follow::Position(0.0));
    let mut on_top = rig::on_top(2.0, 5.0, 50.0, 50.0);
    let mut place = 0.0;
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
    Block::new(ControlAxisBy {
        setpoint,
        avoid_gaps: true,
        gap_velocity: 10.0,
        gap_acceleration: 70.0,
        gap_deceleration: 70.0,
    })
}

/// 5 u/s with 70 u/s² are reached in the middle of the eighth cycle; the rest of it the axis goes on.
#[test]
fn a_bridged_velocity_goes_on_for_the_rest_of_the_cycle() {
    let mut rig = linear();
    let mut block = control(Follow::Velocity(5.0));
    for _ in 0..8 {
        rig.cycle(|axis| block.call(true, axis));
    }
    let ramp = 5.0 / 70.0;
    let expected = 5.0 * (8.0 * CYCLE - 0.5 * ramp);
    assert!((rig.axis.set_position() - expected).abs() < 1e-9, "{}", rig.axis.set_position());
}

/// A place and a velocity that do not fit each other are a jump, however near the place is.
#[test]
fn a_position_beside_its_velocity_is_bridged() {
    let mut rig = linear();
    let mut block = control(Follow::PositionVelocity(0.0, 0.0));
    rig.cycle(|axis| block.call(true, axis));
    // 0.1 u in a cycle of 10 ms are 10 u/s: no velocity that is too much, but the axis rests before and after.
    block.inputs.setpoint = Follow::PositionVelocity(0.1, 0.0);
    rig.cycle(|axis| block.call(true, axis));
    let bridging = block.running().map(Watched::stop_ipo);
    assert_eq!(bridging, Some(true));
    assert!((rig.axis.set_position() - 0.5 * 70.0 * CYCLE * CYCLE).abs() < 1e-12);
    rig.until(|axis| {
        block.call(true, axis);
        axis.set_velocity() == 0.0
    });
    assert!((rig.axis.set_position() - 0.1).abs() < 1e-12);
}

/// The end of the period is no jump, and a jump over it is bridged the short way, to a set-point that moves on over it.
#[test]
fn set_points_go_over_the_end_of_the_period() {
    let mut rig = rotary();
    let mut block = control(Follow::Position(0.0));
    rig.cycle(|axis| block.call(true, axis));
    // 5 u/s from 355 on; the axis is 5 u ahead of it.
    let (mut place, mut met, mut way) = (355.0, None, 0.0);
    for cycle in 0..300 {
        place += 5.0 * CYCLE;
        block.inputs.setpoint = Follow::Position(place % 360.0);
        let before = rig.axis.set_position();
        rig.cycle(|axis| block.call(true, axis));
        let step = rig.axis.set_position() - before;
        way += step - 360.0 * (step / 360.0).round();
        let bridging = block.running().is_some_and(Watched::stop_ipo);
        if !bridging {
            met.get_or_insert(cycle);
        }
        assert_eq!(bridging, met.is_none(), "no jump after it has been met");
        if met.is_some_and(|met| cycle > met) {
            let off = rig.axis.set_position() - place;
            assert!((off - 360.0 * (off / 360.0).round()).abs() < 1e-9, "{off}");
        }
    }
    // It is met before the end, which it passes at 1 s; all in all from 0 to 370.
    assert!(met.is_some_and(|met| met < 100), "{met:?}");
    assert!((way - 10.0).abs() < 1e-9, "{way}");
}

/// Set-points that run away faster than the axis may go are followed with the gap values until they stand; then they are
/// met, and the interpolator goes on.
#[test]
fn set_points_that_run_away_are_met_when_they_stand() {
    let mut rig = linear();
    let mut block = control(Follow::Position(0.0));
    rig.cycle(|axis| block.call(true, axis));
    let mut count = 0;
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

/// Homing by the drive that is left off keeps the axis where the drive says it is by then.
#[test]
fn homing_that_is_left_off_does_not_go_back() {
    let mut rig = linear();
    rig.drive.feedback_mut().position = 33.0;
    rig.power.regulator_on = false;
    rig.cycle(|_| ());
    rig.cycle(|_| ());
    rig.power.regulator_on = true;
    rig.cycle(|_| ());
    rig.cycle(|_| ());
    let mut home = Block::new(Home { position: 5.0, deceleration: 0.0 });
    rig.cycle(|axis| home.call(true, axis));
    // The drive counts from its reference by now: 33 is 5. The program does not call the block any more.
    rig.cycle(|_| ());
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(30)));
    assert_eq!((rig.axis.set_position(), rig.drive.feedback().position), (5.0, 5.0));
}

/// Over the positions of a master that starts from rest a moving slave would be infinitely fast: it goes on until the
/// master's velocity is steady.
#[test]
fn a_moving_slave_waits_for_a_steady_master() {
    let (mut master, mut slave) = (linear(), Rig::new(AxisConfig::default()));
    let mut alone = endless(8.0);
    for _ in 0..50 {
        master.cycle(|_| ());
        slave.cycle(|axis| alone.call(true, axis));
    }
    let mut lead = Block::new(MoveVelocity { acceleration: 40.0, ..endless(10.0).inputs });
    let mut block = Block::new(GearInPos {
        ratio_numerator: 1,
        ratio_denominator: 1,
        master_sync_position: 20.0,
        slave_sync_position: slave.axis.set_position() + 25.0,
        master_start_distance: 0.0,
    });
    let (mut began, mut before) = (None, slave.axis.set_velocity());
    for cycle in 0..400 {
        master.cycle(|axis| lead.call(true, axis));
        let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
        let velocity = slave.axis.set_velocity();
        if block.running().is_some_and(GearInPosRun::is_coupling) && began.is_none() {
            began = Some(cycle);
            // A quarter more than 8 u/s at most, as the master's.
            assert!((velocity - before).abs() <= 0.25 * 8.0 + 1e-9, "{velocity}");
        }
        assert_eq!(shown.done, master.axis.set_position() >= 20.0 - 1e-9);
        before = velocity;
    }
    // 0.4 u/s more each cycle: the fifth is a quarter more than the fourth.
    assert_eq!(began, Some(4));
    let behind = slave.axis.set_position() - block.inputs.slave_sync_position;
    assert!((behind - (master.axis.set_position() - 20.0)).abs() < 1e-9);
}

/// Half the master from 0 to 100, come onto with a ramp.
fn cam_in() -> Block<CamIn> {
    let knot = |x: f64| Knot { velocity: 0.5, ..Knot::at_rest(x, 0.5 * x) };
    let shape = Shape::Polynomial(vec![knot(0.0), knot(100.0)]);
    let cam = Cam::new("half", shape, Vec::new()).expect("a cam");
    let input = CamInput {
        start_mode: StartMode::RampIn,
        velocity_difference: 20.0,
        acceleration: 50.0,
        deceleration: 50.0,
        ..CamInput::default()
    };
    Block::new(CamIn { table: Some(CamTable::new(Arc::new(cam))), input })
}

/// Where the master was a cycle ago there was no cam yet.
#[test]
fn a_master_that_comes_onto_the_cam_in_the_cycle_of_the_start() {
    let (mut master, mut slave) = (linear(), linear());
    let (mut back, mut lead) = (to(-1.0), endless(10.0));
    master.until(|axis| back.call(true, axis).done);
    let (mut alone, mut block) = (endless(8.0), cam_in());
    let (mut before, mut began) = (0.0, false);
    for _ in 0..200 {
        master.cycle(|axis| lead.call(true, axis));
        let on_it = master.axis.set_position() >= 0.0;
        slave.cycle(|axis| {
            if on_it {
                assert!(block.follow(true, &master.axis, axis).error.is_none());
            } else {
                alone.call(true, axis);
            }
        });
        let way = slave.axis.set_position() - before;
        before = slave.axis.set_position();
        if on_it && !began {
            began = true;
            assert!(master.axis.set_position() < 10.0 * CYCLE);
            assert!((way - 8.0 * CYCLE).abs() < 1e-9, "{way}");
        }
    }
    assert!(began);
}

/// The block below has been called in this cycle already, the one on top has not.
#[test]
fn a_cam_takes_over_both_motions_that_there_are() {
    let (master, mut slave) = (linear(), linear());
    let (mut below, mut block) = (endless(5.0), cam_in());
    let mut on_top = rig::on_top(50.0, 3.0, 100.0, 100.0);
    for _ in 0..50 {
        slave.cycle(|axis| (below.call(true, axis), on_top.call(true, axis)));
    }
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

/// A drive without control of its position is where it is, and the set-point with it; but not under what moves the axis.
#[test]
fn a_motion_on_top_alone_goes_its_way_in_torque_mode() {
    let mut rig = linear();
    let mut mode = SetControllerMode::new(ControllerMode::Torque);
    rig.until(|axis| mode.call(true, axis).done);
    let mut block = rig::on_top(10.0, 20.0, 100.0, 100.0);
    // 10 u with 20 u/s and 100 u/s²: 0.2 s up and down each with 2 u, 6 u between in 0.3 s.
    let cycles = rig.until(|axis| block.call(true, axis).done);
    assert!((70..=71).contains(&cycles), "{cycles}");
    assert!((rig.axis.set_position() - 10.0).abs() < 1e-9, "{}", rig.axis.set_position());
}
