//! Tests of further single-axis blocks (manual 2.2.4, 5.3).

use super::rig::{CYCLE, Rig, endless, home, linear, on_top, rotary, to};
use crate::{
    AbortTrigger, AxisConfig, AxisState, Block, Direction, Homing, MoveContinuousAbsolute, Reset,
    SmcError, TouchProbe, Trigger,
};

#[test]
fn a_superimposed_distance_adds_to_the_motion_below() {
    let (mut rig, mut below, mut on_top) = (linear(), to(20.0), on_top(3.0, 5.0, 100.0));
    rig.calls(20, &mut below);
    let mut fastest = 0.0_f64;
    rig.until(|axis| {
        let lower = below.call(true, axis);
        assert!(!lower.command_aborted && lower.error.is_none());
        let upper = on_top.call(true, axis);
        fastest = fastest.max(axis.set_velocity());
        assert!(!upper.command_aborted);
        upper.done
    });
    assert!((fastest - 15.0).abs() < 1e-9, "{fastest}");
    rig.until(|axis| [below.call(true, axis), on_top.call(true, axis)][0].done);
    assert_eq!(rig.axis.set_position(), 23.0);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

#[test]
fn a_superimposed_motion_outlives_one_that_ends_and_dies_with_one_that_is_aborted() {
    let (mut rig, mut below, mut above) = (linear(), to(1.0), on_top(5.0, 2.0, 100.0));
    rig.cycle(|axis| (below.call(true, axis), above.call(true, axis)));
    rig.until(|axis| [below.call(true, axis), above.call(true, axis)][0].done);
    assert_eq!(rig.axis.state(), AxisState::DiscreteMotion, "still moving");
    rig.done(&mut above);
    assert!((rig.axis.set_position() - 6.0).abs() < 1e-12);
    assert_eq!(rig.axis.state(), AxisState::Standstill);

    let (mut below, mut above, mut other) = (to(50.0), on_top(5.0, 2.0, 100.0), to(0.0));
    rig.run(20, |axis| (below.call(true, axis), above.call(true, axis)));
    let velocity = rig.axis.set_velocity();
    let shown = rig.cycle(|axis| {
        other.call(true, axis);
        [below.call(true, axis), above.call(true, axis)]
    });
    assert_eq!(shown.map(|shown| shown.command_aborted), [true, true]);
    assert!((velocity - rig.axis.set_velocity() - 1.0).abs() < 1e-9, "it brakes from both");
    rig.done(&mut other);
    assert_eq!(rig.axis.set_position(), 0.0);
}

#[test]
fn a_continuous_move_has_its_end_velocity_at_the_position() {
    for (end_velocity, end_velocity_direction, expected) in [
        (4.0, Direction::Positive, 4.0),
        (4.0, Direction::Negative, -4.0),
        (0.0, Direction::Current, 0.0),
    ] {
        let inputs = MoveContinuousAbsolute {
            position: 5.0,
            velocity: 10.0,
            end_velocity,
            end_velocity_direction,
            acceleration: 100.0,
            deceleration: 100.0,
            direction: Direction::Shortest,
        };
        let (mut rig, mut block) = (linear(), Block::new(inputs));
        rig.done(&mut block);
        assert_eq!(rig.axis.set_velocity(), expected);
        assert_eq!(rig.axis.state(), AxisState::ContinuousMotion);
        // Within a cycle after the position, and on with the velocity.
        let past = (rig.axis.set_position() - 5.0) * expected.signum();
        assert!((-1e-9..=end_velocity * CYCLE + 1e-9).contains(&past), "{past}");
        let before = rig.axis.set_position();
        assert!(rig.call(&mut block, true).done);
        assert!((rig.axis.set_position() - before - expected * CYCLE).abs() < 1e-9);
    }
}

#[test]
fn the_drive_homes_itself() {
    let (mut rig, mut homing) = (linear().at(3.0), home(-7.0, 0.0));
    rig.call(&mut homing, true);
    assert_eq!(rig.axis.state(), AxisState::Homing);
    assert_eq!(rig.axis.home, Some(-7.0));
    rig.done(&mut homing);
    assert_eq!((rig.axis.set_position(), rig.axis.act_position()), (-7.0, -7.0));
    assert_eq!(rig.axis.home, None);
    // Not from motion.
    let mut moving = endless(5.0);
    rig.call(&mut moving, true);
    let shown = rig.cycle(|axis| [moving.call(true, axis), home(0.0, 0.0).call(true, axis)]);
    assert_eq!(shown[1].error, Some(SmcError::HAxisWasntStandstill));
}

#[test]
fn a_drive_that_does_not_home_is_an_error() {
    for (homing, expected) in [
        (Homing::Idle, SmcError::HAxisDidntStartHoming),
        (Homing::StopFailed, SmcError::HErrorWhenStopping),
    ] {
        let mut rig = linear();
        let shown = rig.fails(&mut home(0.0, 0.0), |rig| rig.drive.feedback_mut().homing = homing);
        assert_eq!(shown.error, Some(expected));
        assert_eq!(rig.axis.state(), AxisState::ErrorStop);
    }
}

#[test]
fn shifting_the_zero_moves_no_axis() {
    let (mut rig, mut block) = (linear(), to(10.0));
    rig.calls(50, &mut block);
    let (position, velocity) = (rig.axis.set_position(), rig.axis.set_velocity());
    let driven = rig.drive.feedback().position;
    rig.axis.shift_zero(100.0, true).expect("a number");
    assert!((rig.axis.set_position() - position - 100.0).abs() < 1e-12);
    rig.call(&mut block, true);
    assert!((rig.drive.feedback().position - driven - velocity * CYCLE).abs() < 1e-9);
    rig.done(&mut block);
    assert!((rig.axis.set_position() - 110.0).abs() < 1e-9, "the target moves with the zero");
    assert_eq!(rig.drive.feedback().position, 10.0);
    rig.axis.shift_zero(-2.0, false).expect("a number");
    assert_eq!(rig.axis.set_position(), -2.0);
    rig.cycle(|_| ());
    assert_eq!(rig.axis.act_position(), -2.0);
    assert_eq!(rig.axis.shift_zero(f64::NAN, false), Err(SmcError::WpParamInvalid));
}

#[test]
fn a_reset_leaves_errorstop_when_the_axis_rests() {
    let (mut rig, mut reset) = (linear(), Reset::default());
    assert_eq!(rig.call(&mut reset, true).error, Some(SmcError::RNoErrorToReset));
    rig.call(&mut reset, false);
    rig.calls(20, &mut endless(10.0));
    rig.cycle(|_| ());
    assert_eq!(rig.axis.state(), AxisState::ErrorStop);
    // 10 u/s with 100 u/s²: ten cycles, the first of which has passed.
    assert_eq!(rig.done(&mut reset), 10);
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::Standstill, None));
    rig.done(&mut to(20.0));
}

#[test]
fn a_reset_waits_for_the_drive() {
    let mut rig = linear();
    rig.drive.feedback_mut().error = Some(4711);
    rig.cycle(|_| ());
    // The virtual drive clears its error at a reset.
    rig.done(&mut Reset::default());
    assert_eq!(rig.axis.state(), AxisState::Standstill);
    // A drive that keeps its error.
    rig.drive.feedback_mut().error = Some(4711);
    rig.cycle(|_| ());
    let keeps = |rig: &mut Rig| rig.drive.feedback_mut().error = Some(4711);
    keeps(&mut rig);
    let shown = rig.fails(&mut Reset::default(), keeps);
    assert_eq!(shown.error, Some(SmcError::RDriveDoesntAnswer));
}

#[test]
fn a_probe_of_the_program_latches_within_its_window() {
    let (mut rig, mut moving) = (linear(), endless(10.0));
    let (mut trigger, mut probe) = (Trigger::of_program(), TouchProbe::new(Some([2.0, 3.0])));
    rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    let (mut early, mut at) = (false, f64::NAN);
    rig.until(|axis| {
        moving.call(true, axis);
        at = axis.act_position();
        // Before the window, and then within.
        trigger.input = (0.5..1.0).contains(&at) || at > 2.5;
        early |= trigger.input && at < 2.0;
        let shown = probe.call(true, axis, &mut trigger);
        assert!(!shown.outputs.done || shown.recorded_position == at);
        shown.outputs.done
    });
    assert!(early && at > 2.5 && at < 2.7, "{at}");
    assert!(!trigger.is_active());
}

/// Over the end of the period, and all the way round: 1 u outside the window nothing counts.
#[test]
fn a_window_of_a_rotary_axis_may_reach_over_the_end() {
    for (window, inside, outside) in [
        ([350.0, 10.0], vec![350.0, 359.0, 0.0, 10.0], vec![11.0, 180.0, 349.0]),
        ([10.0, 350.0], vec![10.0, 180.0, 350.0], vec![351.0, 0.0, 9.0]),
        ([0.0, 360.0], vec![0.0, 1.0, 180.0, 359.0], vec![]),
        ([90.0, 500.0], vec![0.0, 1.0, 89.0, 180.0, 359.0], vec![]),
    ] {
        let latches = |place: f64| {
            let mut rig = rotary();
            rig.axis.shift_zero(place, false).expect("a number");
            let (mut trigger, mut probe) = (Trigger::of_program(), TouchProbe::new(Some(window)));
            rig.cycle(|axis| probe.call(true, axis, &mut trigger));
            trigger.input = true;
            let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger));
            assert!(!shown.outputs.done || shown.recorded_position == place);
            shown.outputs.done
        };
        assert!(inside.iter().all(|place| latches(*place)), "{window:?}");
        assert!(!outside.iter().any(|place| latches(*place)), "{window:?}");
    }
}

#[test]
fn a_probe_of_the_drive_takes_what_it_captured() {
    let (mut rig, mut trigger) = (linear(), Trigger::of_drive(2));
    let (mut probe, mut other) = (TouchProbe::new(None), TouchProbe::new(None));
    rig.axis.shift_zero(100.0, true).expect("a number");
    rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    let shown = rig.cycle(|axis| other.call(true, axis, &mut trigger));
    assert_eq!(shown.outputs.error, Some(SmcError::TpTriggeroccupied));
    rig.drive.feedback_mut().captured = Some(1.234);
    let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    assert!(shown.outputs.done);
    assert!((shown.recorded_position - 101.234).abs() < 1e-12);
}

/// The drive gets a window in its own positions; in the program's it stays where it is when the zero moves.
#[test]
fn a_window_of_the_drive_moves_with_the_zero() {
    let mut rig = linear();
    let (mut trigger, mut probe) = (Trigger::of_drive(2), TouchProbe::new(Some([102.0, 103.0])));
    rig.axis.shift_zero(100.0, true).expect("a number");
    rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    let window = |rig: &mut Rig| rig.axis.end_cycle().capture.and_then(|capture| capture.window);
    assert_eq!(window(&mut rig), Some([2.0, 3.0]));
    rig.axis.shift_zero(40.0, true).expect("a number");
    assert_eq!(window(&mut rig), Some([-38.0, -37.0]));
}

#[test]
fn an_aborted_trigger_ends_the_probe() {
    let (mut rig, mut trigger) = (linear(), Trigger::of_program());
    let (mut probe, mut abort) = (TouchProbe::new(None), AbortTrigger::default());
    let shown = rig.cycle(|axis| abort.call(true, axis, &mut trigger));
    assert_eq!(shown.error, Some(SmcError::AtTriggernotoccupied));
    rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    rig.cycle(|axis| abort.call(false, axis, &mut trigger));
    assert!(rig.cycle(|axis| abort.call(true, axis, &mut trigger)).done);
    assert!(rig.cycle(|axis| probe.call(true, axis, &mut trigger)).outputs.command_aborted);
}

#[test]
fn a_drive_without_windows_refuses_one() {
    let mut rig = Rig::new(AxisConfig { capture_window: false, ..AxisConfig::default() });
    let (mut trigger, mut probe) = (Trigger::of_drive(1), TouchProbe::new(Some([0.0, 1.0])));
    let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    assert_eq!(shown.outputs.error, Some(SmcError::TpCouldntSetWindow));
}
