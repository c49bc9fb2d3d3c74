//! Tests of isolation: blocks leave probes, axes and values of other blocks alone.

use super::direct::control_by_position;
use super::gears::pair;
use super::rig::{Rig, gear, home, in_pos, linear, on_top, phasing, stop, to};
use crate::{
    AbortTrigger, AxisConfig, AxisState, ControlAxis, ControlOutputs, SmcError, TouchProbe, Trigger,
};
use twin_profile::RampType;

/// A trigger is released and taken by another probe within a cycle: the latch then is for that probe, in any call order.
#[test]
fn a_probe_whose_trigger_another_one_has_is_aborted() {
    for fast in [false, true] {
        for first in [false, true] {
            let mut rig = linear();
            let mut trigger = if fast { Trigger::of_drive(1) } else { Trigger::of_program() };
            let (mut old, mut new) = (TouchProbe::new(None), TouchProbe::new(None));
            let mut abort = AbortTrigger::default();
            rig.cycle(|axis| old.call(true, axis, &mut trigger));
            rig.cycle(|axis| {
                abort.call(true, axis, &mut trigger);
                new.call(true, axis, &mut trigger)
            });
            if fast {
                rig.drive.feedback_mut().captured = Some(2.5);
            } else {
                trigger.input = true;
            }
            let [old, new] = rig.cycle(|axis| {
                let mut call = |probe: &mut TouchProbe| probe.call(true, axis, &mut trigger);
                if first {
                    let old = call(&mut old);
                    [old, call(&mut new)]
                } else {
                    let new = call(&mut new);
                    [call(&mut old), new]
                }
            });
            assert!(old.outputs.command_aborted && !old.outputs.done, "{fast} {first}: {old:?}");
            assert!(new.outputs.done, "{fast} {first}: {new:?}");
            assert!(!trigger.is_active());
        }
    }
}

/// A block that gets another axis, on which another block has the same owner number, takes nothing from that block.
#[test]
fn a_new_edge_on_another_axis_takes_nothing_from_a_stop() {
    let rig = |drive_id| Rig::new(AxisConfig { drive_id, ..AxisConfig::default() });
    let (mut one, mut other, mut block, mut stop) = (rig(1), rig(2), to(10.0), stop(50.0));
    one.call(&mut block, true);
    other.call(&mut stop, true);
    assert_eq!(one.axis.owner(), other.axis.owner());
    other.cycle(|axis| [stop.call(true, axis), block.call(false, axis)]);
    let [_, shown] = other.cycle(|axis| [stop.call(true, axis), block.call(true, axis)]);
    assert!(shown.command_aborted && !shown.busy, "{shown:?}");
    assert_eq!(other.axis.state(), AxisState::Stopping);
    // A superimposed motion likewise: error 32.
    let (mut on_top, mut third) = (on_top(5.0, 1.0, 10.0), rig(3));
    one.call(&mut on_top, true);
    let shown = third.call(&mut on_top, true);
    assert_eq!(shown.error, Some(SmcError::AxisRefChangedDuringOperation));
}

/// The method and the block both refuse a position that is not a number.
#[test]
fn positions_that_are_no_numbers_are_refused() {
    let mut rig = linear();
    assert_eq!(rig.axis.shift_zero(f64::NAN, false), Err(SmcError::WpParamInvalid));
    let shown = rig.call(&mut home(f64::NAN, 0.0), true);
    assert_eq!(shown.error, Some(SmcError::WpParamInvalid));
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

/// A move ends at its target, also when a block that goes on from the last set-point begins in that cycle (`Execute`
/// wired to `Done`): this cycle's set-point is the move's, and the slave of a master at rest stays there.
#[test]
fn what_begins_at_the_end_of_a_move_leaves_it_at_its_target() {
    for ramp in [RampType::Trapezoid, RampType::Sigmoid, RampType::Parabolic] {
        for kind in 0..3 {
            let config = AxisConfig { ramp, jerk: 900.0, ..AxisConfig::default() };
            let (mut axes, mut first) = ([linear(), Rig::new(config)], to(7.3));
            let mut gear = gear(1, 1);
            let mut in_pos = in_pos([1, 1], [50.0, 200.0], 20.0);
            let mut phasing = phasing(0.0, 10.0, 50.0);
            let mut ended = false;
            for _ in 0..300 {
                pair(
                    &mut axes,
                    |_| (),
                    |master, axis| {
                        ended |= first.call(true, axis).done;
                        match kind {
                            0 => gear.follow(ended, master, axis),
                            1 => in_pos.follow(ended, master, axis),
                            _ => phasing.follow(ended, master, axis),
                        }
                    },
                );
                let slave = &axes[1].axis;
                if ended {
                    assert_eq!(slave.set_position(), 7.3, "{ramp:?} {kind}");
                    assert_eq!(slave.set_velocity(), 0.0, "{ramp:?} {kind}");
                    assert_eq!(slave.state(), AxisState::SynchronizedMotion);
                }
            }
            assert!(ended);
        }
    }
}

/// Another block moves the axis: `bEnable` of the control block falls and rises meanwhile.
#[test]
fn a_control_block_is_enabled_anew_while_another_one_moves_the_axis() {
    let mut rig = linear();
    let mut control = control_by_position(0.0);
    let mut move_away = to(50.0);
    rig.cycle(|axis| control.call(true, axis));
    rig.run(5, |axis| (move_away.call(true, axis), control.call(true, axis)));
    let mut shown = |rig: &mut Rig, block: &mut ControlAxis, enable, moves: bool| {
        rig.cycle(|axis| {
            let shown = block.call(enable, axis);
            if moves {
                move_away.call(true, axis);
            }
            shown
        })
    };
    assert!(shown(&mut rig, &mut control, true, true).command_aborted);
    assert!(rig.axis.set_velocity() > 0.0);
    assert_eq!(shown(&mut rig, &mut control, false, true), ControlOutputs::default());
    // The edge takes the axis, in motion, and bridges to its set-point.
    let taken = shown(&mut rig, &mut control, true, true);
    assert!(!taken.command_aborted && taken.stop_ipo, "{taken:?}");
    assert_eq!(rig.axis.state(), AxisState::SynchronizedMotion);
    assert!(rig.axis.owner() != 0 && rig.axis.error_id().is_none());
}
