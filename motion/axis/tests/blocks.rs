//! Tests of further single-axis blocks (manual 2.2.4, 5.3).

use super::framework::to;
use super::rig::{self, CYCLE, Rig, linear, rotary};
use crate::{
    AbortTrigger, AxisConfig, AxisState, Block, ControllerMode, Direction, Home, Homing,
    MoveContinuousAbsolute, MoveContinuousRelative, MoveVelocity, Reset, SetControllerMode,
    SmcError, TouchProbe, Trigger,
};

pub(super) fn endless(velocity: f64) -> Block<MoveVelocity> {
    Block::new(MoveVelocity {
        velocity: velocity.abs(),
        acceleration: 100.0,
        deceleration: 100.0,
        direction: if velocity < 0.0 { Direction::Negative } else { Direction::Positive },
    })
}

#[test]
fn a_superimposed_distance_adds_to_the_motion_below() {
    let mut rig = linear();
    let (mut below, mut on_top) = (to(20.0), rig::on_top(3.0, 5.0, 100.0, 100.0));
    for _ in 0..20 {
        rig.cycle(|axis| below.call(true, axis));
    }
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
    rig.until(|axis| {
        let done = below.call(true, axis).done;
        on_top.call(true, axis);
        done
    });
    assert_eq!(rig.axis.set_position(), 23.0);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

#[test]
fn a_superimposed_motion_outlives_one_that_ends_and_dies_with_one_that_is_aborted() {
    let mut rig = linear();
    let (mut below, mut on_top) = (to(1.0), rig::on_top(5.0, 2.0, 100.0, 100.0));
    rig.cycle(|axis| (below.call(true, axis), on_top.call(true, axis)));
    rig.until(|axis| {
        let done = below.call(true, axis).done;
        on_top.call(true, axis);
        done
    });
    assert_eq!(rig.axis.state(), AxisState::DiscreteMotion, "still moving");
    rig.until(|axis| on_top.call(true, axis).done);
    assert!((rig.axis.set_position() - 6.0).abs() < 1e-12);
    assert_eq!(rig.axis.state(), AxisState::Standstill);

    let (mut below, mut on_top) = (to(50.0), rig::on_top(5.0, 2.0, 100.0, 100.0));
    for _ in 0..20 {
        rig.cycle(|axis| (below.call(true, axis), on_top.call(true, axis)));
    }
    let velocity = rig.axis.set_velocity();
    let mut other = to(0.0);
    let shown = rig.cycle(|axis| {
        other.call(true, axis);
        [below.call(true, axis), on_top.call(true, axis)]
    });
    assert_eq!(shown.map(|shown| shown.command_aborted), [true, true]);
    assert!((velocity - rig.axis.set_velocity() - 1.0).abs() < 1e-9, "it brakes from both");
    rig.until(|axis| other.call(true, axis).done);
    assert_eq!(rig.axis.set_position(), 0.0);
}

#[test]
fn a_continuous_move_has_its_end_velocity_at_the_position() {
    for (end, direction, expected) in [
        (4.0, Direction::Positive, 4.0),
        (4.0, Direction::Negative, -4.0),
        (0.0, Direction::Current, 0.0),
    ] {
        let mut rig = linear();
        let mut block = Block::new(MoveContinuousAbsolute {
            position: 5.0,
            velocity: 10.0,
            end_velocity: end,
            end_velocity_direction: direction,
            acceleration: 100.0,
            deceleration: 100.0,
            direction: Direction::Shortest,
        });
        rig.until(|axis| block.call(true, axis).done);
        assert_eq!(rig.axis.set_velocity(), expected);
        assert_eq!(rig.axis.state(), AxisState::ContinuousMotion);
        // Within a cycle after the position, and on with the velocity.
        let past = (rig.axis.set_position() - 5.0) * expected.signum();
        assert!((-1e-9..=end * CYCLE + 1e-9).contains(&past), "{past}");
        let before = rig.axis.set_position();
        assert!(rig.cycle(|axis| block.call(true, axis)).done);
        assert!((rig.axis.set_position() - before - expected * CYCLE).abs() < 1e-9);
    }
}

#[test]
fn continuous_moves_refuse_what_is_no_direction() {
    let relative = MoveContinuousRelative {
        distance: 5.0,
        velocity: 10.0,
        end_velocity: 4.0,
        end_velocity_direction: Direction::Shortest,
        acceleration: 100.0,
        deceleration: 100.0,
    };
    let absolute = MoveContinuousAbsolute {
        position: 5.0,
        velocity: 10.0,
        end_velocity: 4.0,
        end_velocity_direction: Direction::Positive,
        acceleration: 100.0,
        deceleration: 100.0,
        direction: Direction::Fastest,
    };
    let mut rig = linear();
    let mut error =
        |block: MoveContinuousRelative| rig.cycle(|axis| Block::new(block).call(true, axis)).error;
    assert_eq!(error(relative), Some(SmcError::McrInvalidDirection));
    let faster = MoveContinuousRelative {
        end_velocity: 11.0,
        end_velocity_direction: Direction::Positive,
        ..relative
    };
    assert_eq!(error(faster), Some(SmcError::McrInvalidVelaccValues));
    let mut error =
        |block: MoveContinuousAbsolute| rig.cycle(|axis| Block::new(block).call(true, axis)).error;
    assert_eq!(error(absolute), Some(SmcError::McaDirectionNotApplicable));
    let no_end = MoveContinuousAbsolute {
        direction: Direction::Positive,
        end_velocity_direction: Direction::Fastest,
        ..absolute
    };
    assert_eq!(error(no_end), Some(SmcError::McaInvalidDirection));
}

#[test]
fn the_drive_homes_itself() {
    let mut rig = linear();
    let mut there = to(3.0);
    rig.until(|axis| there.call(true, axis).done);
    let mut home = Block::new(Home { position: -7.0, deceleration: 0.0 });
    rig.cycle(|axis| home.call(true, axis));
    assert_eq!(rig.axis.state(), AxisState::Homing);
    assert_eq!(rig.axis.read_bool_parameter(1210), Ok(true));
    rig.until(|axis| home.call(true, axis).done);
    assert_eq!((rig.axis.set_position(), rig.axis.act_position()), (-7.0, -7.0));
    assert_eq!(rig.axis.read_bool_parameter(1210), Ok(false));
    // Not from motion.
    let mut moving = endless(5.0);
    rig.cycle(|axis| moving.call(true, axis));
    let shown = rig.cycle(|axis| {
        moving.call(true, axis);
        Block::new(Home { position: 0.0, deceleration: 0.0 }).call(true, axis)
    });
    assert_eq!(shown.error, Some(SmcError::HAxisWasntStandstill));
}

#[test]
fn a_drive_that_does_not_home_is_an_error() {
    for (homing, expected) in [
        (Homing::Idle, SmcError::HAxisDidntStartHoming),
        (Homing::StopFailed, SmcError::HErrorWhenStopping),
    ] {
        let mut rig = linear();
        let mut home = Block::new(Home { position: 0.0, deceleration: 0.0 });
        let mut shown = rig.cycle(|axis| home.call(true, axis));
        for _ in 0..200 {
            rig.drive.feedback_mut().homing = homing;
            if shown.error.is_none() {
                shown = rig.cycle(|axis| home.call(true, axis));
            }
        }
        assert_eq!(shown.error, Some(expected));
        assert_eq!(rig.axis.state(), AxisState::ErrorStop);
    }
}

#[test]
fn shifting_the_zero_moves_no_axis() {
    let mut rig = linear();
    let mut block = to(10.0);
    for _ in 0..50 {
        rig.cycle(|axis| block.call(true, axis));
    }
    let (position, velocity) = (rig.axis.set_position(), rig.axis.set_velocity());
    let driven = rig.drive.feedback().position;
    rig.axis.shift_zero(100.0, true).expect("a number");
    assert!((rig.axis.set_position() - position - 100.0).abs() < 1e-12);
    rig.cycle(|axis| block.call(true, axis));
    assert!((rig.drive.feedback().position - driven - velocity * CYCLE).abs() < 1e-9);
    rig.until(|axis| block.call(true, axis).done);
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
    let mut rig = linear();
    let mut reset = Reset::default();
    let shown = rig.cycle(|axis| reset.call(true, axis));
    assert_eq!(shown.error, Some(SmcError::RNoErrorToReset));
    rig.cycle(|axis| reset.call(false, axis));
    let mut moving = endless(10.0);
    for _ in 0..20 {
        rig.cycle(|axis| moving.call(true, axis));
    }
    rig.cycle(|_| ());
    assert_eq!(rig.axis.state(), AxisState::ErrorStop);
    // 10 u/s with 100 u/s²: ten cycles, the first of which has passed.
    assert_eq!(rig.until(|axis| reset.call(true, axis).done), 10);
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::Standstill, None));
    let mut block = to(20.0);
    rig.until(|axis| block.call(true, axis).done);
}

#[test]
fn a_reset_waits_for_the_drive() {
    let mut rig = linear();
    rig.drive.feedback_mut().error = Some(4711);
    rig.cycle(|_| ());
    // The virtual drive lets go of its error when told.
    let mut reset = Reset::default();
    rig.until(|axis| reset.call(true, axis).done);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
    // One that keeps it.
    let mut reset = Reset::default();
    let mut shown = reset.call(false, &mut rig.axis);
    for _ in 0..200 {
        rig.drive.feedback_mut().error = Some(4711);
        if shown.error.is_none() {
            shown = rig.cycle(|axis| {
                let failed = axis.state() == AxisState::ErrorStop;
                reset.call(failed, axis)
            });
        }
    }
    assert_eq!(shown.error, Some(SmcError::RDriveDoesntAnswer));
}

#[test]
fn a_probe_of_the_program_latches_within_its_window() {
    let mut rig = linear();
    let mut moving = endless(10.0);
    let mut trigger = Trigger::of_program();
    let mut probe = TouchProbe::new(Some([2.0, 3.0]));
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
    assert_eq!(rig.axis.read_parameter(1202), Ok(at));
    assert_eq!(rig.axis.read_bool_parameter(1207), Ok(true));
    assert!(!trigger.is_active());
}

/// Over the end of the period, and all the way round: 1 u beside the end of the window nothing counts.
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
    let mut rig = linear();
    let mut trigger = Trigger::of_drive(2);
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

/// A window is told to the drive in its own positions, and stays at the program's where the zero moves.
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
    let mut rig = linear();
    let mut trigger = Trigger::of_program();
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
    let mut trigger = Trigger::of_drive(1);
    let mut probe = TouchProbe::new(Some([0.0, 1.0]));
    let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    assert_eq!(shown.outputs.error, Some(SmcError::TpCouldntSetWindow));
}

#[test]
fn torque_needs_torque_mode() {
    let mut rig = linear();
    assert_eq!(rig.axis.set_torque(1.5), Err(SmcError::StWrongControllerMode));
    let mut mode = SetControllerMode::new(ControllerMode::Torque);
    rig.until(|axis| mode.call(true, axis).done);
    assert_eq!(rig.axis.set_torque(1.5), Ok(()));
    rig.cycle(|_| ());
    rig.cycle(|_| ());
    assert_eq!(rig.axis.act_torque(), 1.5);
    // A drive that stays in its mode.
    let mut mode = SetControllerMode::new(ControllerMode::Current);
    let mut shown = rig.cycle(|axis| mode.call(true, axis));
    for _ in 0..200 {
        rig.drive.feedback_mut().mode = ControllerMode::Torque;
        if shown.error.is_none() {
            shown = rig.cycle(|axis| mode.call(true, axis));
        }
    }
    assert_eq!(shown.error, Some(SmcError::ScmNotSupported));
}

#[test]
fn the_status_says_how_the_axis_moves() {
    let mut rig = linear();
    let mut block = to(3.0);
    let mut seen = Vec::new();
    rig.until(|axis| {
        let done = block.call(true, axis).done;
        let status = axis.status();
        let how = [status.accelerating, status.constant_velocity, status.decelerating];
        if seen.last() != Some(&how) {
            seen.push(how);
        }
        done
    });
    let only = |index| [0, 1, 2].map(|other| other == index);
    assert_eq!(seen, [only(0), only(1), only(2), [false; 3]]);
}
