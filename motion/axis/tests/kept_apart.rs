//! Tests of isolation: blocks leave probes, axes and values of other blocks alone.

use super::direct::control_by_position;
use super::framework::to;
use super::gears::{gear, pair};
use super::rig::{Rig, linear};
use crate::{
    AbortTrigger, AxisConfig, AxisState, Block, ControlAxis, ControlOutputs, GearInPos, Home,
    Phasing, SmcError, Stop, TouchProbe, Trigger,
};
use twin_profile::RampType;

/// A trigger is let go of and taken by another probe within a cycle: what comes then is for that one, whoever is called first.
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

/// An axis that is swapped for another one, as which another block has the same number: nobody's business but its own.
#[test]
fn a_new_edge_on_another_axis_takes_nothing_from_a_stop() {
    let config = |drive_id| AxisConfig { drive_id, ..AxisConfig::default() };
    let (mut one, mut other) = (Rig::new(config(1)), Rig::new(config(2)));
    let mut block = to(10.0);
    let mut stop = Block::new(Stop { deceleration: 50.0 });
    one.cycle(|axis| block.call(true, axis));
    other.cycle(|axis| stop.call(true, axis));
    assert_eq!(one.axis.owner(), other.axis.owner());
    other.cycle(|axis| {
        stop.call(true, axis);
        block.call(false, axis)
    });
    let shown = other.cycle(|axis| {
        stop.call(true, axis);
        block.call(true, axis)
    });
    assert!(shown.command_aborted && !shown.busy, "{shown:?}");
    assert_eq!(other.axis.state(), AxisState::Stopping);
    // On top of nothing likewise: error 32.
    let mut on_top = super::rig::on_top(5.0, 1.0, 10.0, 10.0);
    let mut third = Rig::new(config(3));
    one.cycle(|axis| on_top.call(true, axis));
    let shown = third.cycle(|axis| on_top.call(true, axis));
    assert_eq!(shown.error, Some(SmcError::AxisRefChangedDuringOperation));
}

/// What methods refuse is a block's error like any other (manual 9.1).
#[test]
fn refusals_are_kept_with_the_errors_of_blocks() {
    let mut rig = linear();
    assert_eq!(rig.axis.set_torque(1.0), Err(SmcError::StWrongControllerMode));
    assert_eq!(rig.axis.read_fb_error(), Some(SmcError::StWrongControllerMode));
    assert_eq!(rig.axis.shift_zero(f64::NAN, false), Err(SmcError::WpParamInvalid));
    assert_eq!(rig.axis.read_fb_error(), Some(SmcError::WpParamInvalid));
    let mut home = Block::new(Home { position: f64::NAN, deceleration: 0.0 });
    assert_eq!(rig.cycle(|axis| home.call(true, axis)).error, Some(SmcError::WpParamInvalid));
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

/// A move that ends stands at its target, also where a block begins in that cycle that goes on from the last set-point (`Execute`
/// wired to `Done`): it has this cycle's set-point from the move, and the slave of a master at rest stays there.
#[test]
fn what_begins_at_the_end_of_a_move_leaves_it_at_its_target() {
    for ramp in [RampType::Trapezoid, RampType::Sigmoid, RampType::Parabolic] {
        for kind in 0..3 {
            let config = AxisConfig { ramp, jerk: 900.0, ..AxisConfig::default() };
            let (mut master, mut slave) = (linear(), Rig::new(config));
            let mut first = to(7.3);
            let mut gear = gear(1, 1);
            let mut in_pos = Block::new(GearInPos {
                ratio_numerator: 1,
                ratio_denominator: 1,
                master_sync_position: 50.0,
                slave_sync_position: 200.0,
                master_start_distance: 20.0,
            });
            let mut phasing = Block::new(Phasing {
                phase_shift: 0.0,
                velocity: 10.0,
                acceleration: 50.0,
                deceleration: 50.0,
            });
            let mut ended = false;
            for _ in 0..300 {
                pair(
                    &mut master,
                    &mut slave,
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
                if ended {
                    assert_eq!(slave.axis.set_position(), 7.3, "{ramp:?} {kind}");
                    assert_eq!(slave.axis.set_velocity(), 0.0, "{ramp:?} {kind}");
                    assert_eq!(slave.axis.state(), AxisState::SynchronizedMotion);
                }
            }
            assert!(ended);
        }
    }
}

/// Another block has the axis, and moves it: `bEnable` is taken from the control block and given to it again meanwhile.
#[test]
fn a_control_block_is_enabled_anew_while_another_one_moves_the_axis() {
    let mut rig = linear();
    let mut control = control_by_position(0.0);
    let mut move_away = to(50.0);
    rig.cycle(|axis| control.call(true, axis));
    for _ in 0..5 {
        rig.cycle(|axis| {
            move_away.call(true, axis);
            control.call(true, axis)
        });
    }
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
