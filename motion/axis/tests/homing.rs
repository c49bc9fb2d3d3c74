//! Tests of homing onto a switch (manual 2.2.7), and by the drive (5.3).

use super::rig::{CYCLE, Rig, home, linear};
use crate::{
    AxisConfig, AxisState, Block, Direction, Home, Homing, HomingBySwitch, HomingMode, SmcError,
};
use twin_profile::RampType;

/// The switch is closed below this drive position, u.
const SWITCH: f64 = -2.0;

pub(super) fn homing(mode: HomingMode) -> Block<HomingBySwitch> {
    Block::new(HomingBySwitch {
        home_position: 10.0,
        velocity_slow: 1.0,
        velocity_fast: 10.0,
        acceleration: 100.0,
        deceleration: 100.0,
        direction: Direction::Negative,
        end_switch: true,
        signal_delay: 0.0,
        mode,
        return_to_zero: false,
        index_occurred: false,
        index_position: 0.0,
        ignore_hw_limit: false,
    })
}

/// Runs it with a switch that is closed between two drive positions. Returns the drive position of the home position.
fn run(
    rig: &mut Rig,
    block: &mut Block<HomingBySwitch>,
    closed: [f64; 2],
    index: Option<f64>,
) -> f64 {
    for _ in 0..10_000 {
        let at = rig.drive.feedback().position;
        let offset = rig.axis.values.offset_position;
        block.inputs.end_switch = !(closed[0]..closed[1]).contains(&at);
        if let Some(index) = index {
            block.inputs.index_occurred = at >= index;
            block.inputs.index_position = index + offset;
        }
        let shown = rig.cycle(|axis| block.call(true, axis));
        assert!(shown.error.is_none() && !shown.command_aborted, "{shown:?}");
        if shown.done {
            assert_eq!(rig.axis.state(), AxisState::Standstill);
            assert_eq!(rig.axis.set_velocity(), 0.0);
            let offset = rig.axis.values.offset_position;
            return block.inputs.home_position - offset;
        }
        assert_eq!(rig.axis.state(), AxisState::Homing);
    }
    panic!("it does not come to an end");
}

#[test]
fn off_the_switch_again_is_the_reference() {
    let mut rig = linear();
    let place = run(&mut rig, &mut homing(HomingMode::FastBackSlowSetStop), [-100.0, SWITCH], None);
    // The slow velocity is 0.01 u a cycle.
    assert!((place - SWITCH).abs() <= 0.0101, "{place}");
    // Braking from 1 u/s with 100 u/s² takes 5 mm beyond.
    assert!(rig.axis.set_position() > 10.0 && rig.axis.set_position() < 10.03);
}

#[test]
fn stop_first_sets_the_reference_at_rest() {
    for (mode, begin) in
        [(HomingMode::FastBackSlowStopSet, -100.0), (HomingMode::FastSlowStopSet, -3.0)]
    {
        let mut rig = linear();
        run(&mut rig, &mut homing(mode), [begin, SWITCH], None);
        assert!((rig.axis.set_position() - 10.0).abs() < 1e-12);
    }
}

/// Back off the switch, or across a switch from 2 to 3 and on to the pulse behind it.
#[test]
fn the_index_pulse_is_the_reference() {
    for (mode, direction, closed, index) in [
        (HomingMode::FastBackSlowIndexSetStop, Direction::Negative, [-100.0, SWITCH], -1.2345),
        (HomingMode::FastSlowIndexSetStop, Direction::Positive, [2.0, 3.0], 3.4567),
    ] {
        let mut block = homing(mode);
        block.inputs.direction = direction;
        let place = run(&mut linear(), &mut block, closed, Some(index));
        assert!((place - index).abs() < 1e-9, "{place}");
    }
}

#[test]
fn without_turning_it_goes_across_the_switch() {
    let mut block = homing(HomingMode::FastSlowSetStop);
    let place = run(&mut linear(), &mut block, [-3.0, SWITCH], None);
    assert!((place + 3.0).abs() <= 0.0101, "{place}");
}

#[test]
fn a_late_signal_is_made_up_for() {
    let mut rig = linear();
    let mut block = homing(HomingMode::FastBackSlowSetStop);
    block.inputs.signal_delay = 0.1;
    // What the program reads is 10 cycles old.
    let mut was = std::collections::VecDeque::from(vec![0.0; 10]);
    let mut place = f64::NAN;
    for _ in 0..10_000 {
        was.push_back(rig.drive.feedback().position);
        let old = was.pop_front().expect("ten");
        block.inputs.end_switch = old >= SWITCH;
        if rig.cycle(|axis| block.call(true, axis)).done {
            place = 10.0 - rig.axis.values.offset_position;
            break;
        }
    }
    assert!((place - SWITCH).abs() <= 0.0101, "{place}");
}

#[test]
fn it_may_return_to_zero() {
    let mut rig = linear();
    let mut block = homing(HomingMode::FastBackSlowSetStop);
    block.inputs.return_to_zero = true;
    run(&mut rig, &mut block, [-100.0, SWITCH], None);
    assert!(rig.axis.set_position().abs() < 1e-12);
}

#[test]
fn the_limit_switch_may_be_the_same_one() {
    for (ignore, expected) in [(true, None), (false, Some(10))] {
        let mut rig = Rig::new(AxisConfig { hardware_limits: true, ..AxisConfig::default() });
        let mut block = homing(HomingMode::FastBackSlowSetStop);
        block.inputs.ignore_hw_limit = ignore;
        for _ in 0..2_000 {
            let closed = rig.drive.feedback().position < SWITCH;
            block.inputs.end_switch = !closed;
            rig.drive.feedback_mut().limit_switch = closed;
            if rig.cycle(|axis| block.call(true, axis)).done {
                break;
            }
        }
        assert_eq!(rig.axis.error_id(), expected);
        // Afterwards it is watched again.
        rig.drive.feedback_mut().limit_switch = true;
        rig.cycle(|_| ());
        assert_eq!(rig.axis.error_id(), Some(10));
    }
}

/// A drive that reports its reference, 5 u, while it still goes back with 10 u/s.
fn found_in_motion(rig: &mut Rig, home: &mut Block<Home>) {
    rig.call(home, true);
    for way in [0.3, 0.2, 0.1] {
        let feedback = rig.drive.feedback_mut();
        (feedback.homing, feedback.position, feedback.velocity) = (Homing::Busy, 5.0 + way, -10.0);
        let shown = rig.call(home, true);
        assert!(shown.busy && !shown.done && shown.error.is_none(), "{shown:?}");
    }
    let feedback = rig.drive.feedback_mut();
    (feedback.homing, feedback.position, feedback.velocity) = (Homing::Done, 5.0, -10.0);
}

/// From 10 u/s with 20 u/s² it takes half a second and 2.5 u; with the other ramps longer, and no step of the velocity either.
#[test]
fn an_axis_that_still_moves_at_its_reference_is_brought_to_rest() {
    for ramp in [RampType::Trapezoid, RampType::Sigmoid, RampType::Parabolic] {
        let mut rig = Rig::new(AxisConfig { ramp, jerk: 100.0, ..AxisConfig::default() });
        let mut home = home(5.0, 20.0);
        found_in_motion(&mut rig, &mut home);
        let (mut before, mut cycles) = (-10.0, 0);
        loop {
            let shown = rig.call(&mut home, true);
            let velocity = rig.axis.set_velocity();
            assert!(
                (velocity - before).abs() <= 20.0 * CYCLE + 1e-9,
                "{ramp:?}: {before} {velocity}"
            );
            before = velocity;
            if shown.done {
                break;
            }
            assert!(shown.busy && shown.error.is_none(), "{shown:?}");
            assert_eq!(rig.axis.state(), AxisState::Homing);
            cycles += 1;
        }
        assert_eq!((rig.axis.state(), rig.axis.set_velocity()), (AxisState::Standstill, 0.0));
        let place = rig.axis.set_position();
        if ramp == RampType::Trapezoid {
            assert!(cycles == 50 && (place - 2.5).abs() < 1e-9, "{place} after {cycles} cycles");
        } else {
            assert!(cycles > 50 && place < 2.5, "{ramp:?}: {place} after {cycles} cycles");
        }
    }
}

/// "Is a deceleration defined?" (173, manual 9.3): an axis that has to stop without a deceleration.
#[test]
fn stopping_behind_homing_without_a_deceleration_is_173() {
    for deceleration in [0.0, -1.0, f64::NAN] {
        let (mut rig, mut block) = (linear(), home(5.0, deceleration));
        found_in_motion(&mut rig, &mut block);
        let shown = rig.call(&mut block, true);
        assert_eq!(shown.error.map(SmcError::number), Some(173));
        assert_eq!(rig.axis.state(), AxisState::ErrorStop);
        // With the drive at rest nothing has to stop.
        let mut rig = linear();
        rig.done(&mut home(5.0, deceleration));
        assert_eq!(rig.axis.set_position(), 5.0);
    }
}
