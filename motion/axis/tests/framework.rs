//! Tests of the block framework: Execute, Done, `CommandAborted`, Error and the owner (manual 5.2).

use super::rig::{Rig, by, endless, home, linear, on_top, stop, to};
use crate::{AxisConfig, AxisState, Block, Halt, Outputs, Reset, SmcError};

#[test]
fn done_stays_while_execute_does() {
    let (mut rig, mut block) = (linear(), to(1.0));
    // 1 u under 10 u/s and 100 u/s²: 0.1 s up and 0.1 s down, 20 cycles.
    assert_eq!(rig.done(&mut block), 20);
    assert_eq!(rig.axis.set_position(), 1.0);
    let shown = [true, true, false, false].map(|execute| rig.call(&mut block, execute));
    assert_eq!(shown.map(|shown| shown.done), [true, true, false, false]);
    assert_eq!(shown.map(|shown| shown.busy), [false; 4]);
}

#[test]
fn done_shows_for_one_cycle_if_execute_fell_earlier() {
    let (mut rig, mut block) = (linear(), to(1.0));
    rig.call(&mut block, true);
    assert_eq!(rig.until(|axis| block.call(false, axis).done), 19);
    assert!(!rig.call(&mut block, false).done);
}

#[test]
fn inputs_count_at_the_rising_edge_only() {
    let (mut rig, mut block) = (linear(), to(1.0));
    rig.call(&mut block, true);
    block.inputs.position = 50.0;
    rig.done(&mut block);
    assert_eq!(rig.axis.set_position(), 1.0);
    rig.call(&mut block, false);
    rig.done(&mut block);
    assert_eq!(rig.axis.set_position(), 50.0);
}

#[test]
fn a_new_block_takes_the_axis_and_the_old_one_is_aborted() {
    let (mut rig, mut first, mut second) = (linear(), to(100.0), to(-1.0));
    rig.calls(30, &mut first);
    let owners = rig.axis.values.owners;
    // The old block, called first, still moves the axis in this cycle; the new one replaces its set-point.
    let before = rig.axis.set_position();
    let shown = rig.cycle(|axis| [first.call(true, axis), second.call(true, axis)]);
    assert!(shown.iter().all(|shown| !shown.command_aborted && shown.busy));
    assert_eq!(rig.axis.owner(), 2);
    assert_eq!(rig.axis.values.owners, owners + 1);
    // From 10 u/s it brakes with 100 u/s²: one cycle of 10 ms is 0.095 u.
    assert!((rig.axis.set_position() - before - 0.095).abs() < 1e-9);
    // CommandAborted stays until Execute falls.
    for (execute, aborted) in [(true, true), (true, true), (false, false)] {
        let shown = rig.cycle(|axis| [first.call(execute, axis), second.call(true, axis)]);
        assert_eq!(shown.map(|shown| shown.command_aborted), [aborted, false]);
        assert!(!shown[0].busy);
    }
    rig.done(&mut second);
    assert_eq!(rig.axis.set_position(), -1.0);
    assert_eq!((rig.axis.owner(), rig.axis.state()), (0, AxisState::Standstill));
}

#[test]
fn aborted_shows_for_one_cycle_if_execute_fell_earlier() {
    let (mut rig, mut first, mut second) = (linear(), to(100.0), to(-1.0));
    rig.call(&mut first, true);
    rig.call(&mut first, false);
    rig.call(&mut second, true);
    for aborted in [true, false] {
        let shown = rig.cycle(|axis| [first.call(false, axis), second.call(true, axis)]);
        assert_eq!(shown[0].command_aborted, aborted);
    }
}

#[test]
fn a_new_edge_of_the_same_block_begins_anew() {
    let (mut rig, mut block) = (linear(), by(10.0));
    rig.calls(50, &mut block);
    let before = rig.axis.set_position();
    rig.call(&mut block, false);
    let after = rig.axis.set_position();
    assert!(after > before);
    rig.until(|axis| {
        let shown = block.call(true, axis);
        assert!(!shown.command_aborted);
        shown.done
    });
    assert!((rig.axis.set_position() - after - 10.0).abs() < 1e-9, "counted from the edge");
}

#[test]
fn a_refused_block_does_not_disturb_the_running_one() {
    let (mut rig, mut running, mut wrong) = (linear(), to(1.0), to(5.0));
    wrong.inputs.acceleration = 0.0;
    rig.call(&mut running, true);
    let shown = rig.cycle(|axis| [running.call(true, axis), wrong.call(true, axis)]);
    assert_eq!(shown[1].error, Some(SmcError::MaInvalidVelaccValues));
    let shown = rig.cycle(|axis| [running.call(true, axis), wrong.call(false, axis)]);
    assert_eq!(shown[1], Outputs::default());
    rig.done(&mut running);
    assert_eq!(rig.axis.set_position(), 1.0);
}

#[test]
fn a_block_may_begin_in_the_cycle_another_ends() {
    let (mut rig, mut first, mut second) = (linear(), by(1.0), by(1.0));
    let count = rig.until(|axis| {
        let done = first.call(true, axis).done;
        second.call(done, axis).done
    });
    // Exactly two ways; the second begins in the cycle in which the first ends.
    assert_eq!((rig.axis.set_position(), count), (2.0, 40));
}

#[test]
fn a_stop_cannot_be_interrupted_and_locks_the_axis() {
    let (mut rig, mut moving, mut other) = (linear(), endless(10.0), to(3.0));
    let (mut first, mut second) = (stop(50.0), stop(50.0));
    rig.calls(20, &mut moving);
    rig.call(&mut first, true);
    let shown = rig
        .cycle(|axis| [moving.call(false, axis), first.call(true, axis), other.call(true, axis)]);
    assert_eq!(shown.map(|shown| shown.command_aborted), [true, false, true]);
    let shown = rig.cycle(|axis| [first.call(true, axis), second.call(true, axis)]);
    assert_eq!(shown[1].error, Some(SmcError::MsUnknownStoppingError));
    // 10 u/s with 50 u/s²: 20 cycles, three of which have passed.
    assert_eq!(rig.done(&mut first), 17);
    assert_eq!(rig.axis.state(), AxisState::Stopping);
    let shown = rig.cycle(|axis| [first.call(true, axis), to(3.0).call(true, axis)]);
    assert!(shown[0].done && shown[1].command_aborted);
    rig.call(&mut first, false);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
    rig.until(|axis| other.call(false, axis).command_aborted || other.call(true, axis).done);
    assert_eq!(rig.axis.set_position(), 3.0);
}

#[test]
fn a_stop_whose_execute_fell_frees_the_axis_when_it_stands() {
    let (mut rig, mut stop) = (linear(), stop(100.0));
    rig.calls(20, &mut to(100.0));
    rig.call(&mut stop, true);
    rig.until(|axis| stop.call(false, axis).done);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

#[test]
fn an_axis_swapped_for_another_is_an_error_32() {
    let mut rig = linear();
    let mut other = Rig::new(AxisConfig { drive_id: 7, ..AxisConfig::default() });
    let (mut block, mut others) = (to(5.0), to(9.0));
    rig.call(&mut block, true);
    other.call(&mut others, true);
    let shown = other.cycle(|axis| [others.call(true, axis), block.call(true, axis)]);
    assert_eq!(shown[1].error, Some(SmcError::AxisRefChangedDuringOperation));
    // The other axis is not disturbed; the block's own axis is no longer moved.
    other.done(&mut others);
    assert_eq!(other.axis.set_position(), 9.0);
    rig.cycle(|_| ());
    assert_eq!(rig.axis.error_id(), Some(30));
}

#[test]
fn a_halt_may_be_aborted() {
    let halt = || Block::new(Halt { deceleration: 50.0 });
    let (mut rig, mut first, mut back) = (linear(), halt(), to(0.0));
    rig.calls(20, &mut to(100.0));
    rig.call(&mut first, true);
    assert_eq!(rig.axis.state(), AxisState::DiscreteMotion);
    rig.call(&mut back, true);
    assert!(rig.cycle(|axis| [back.call(true, axis), first.call(true, axis)])[1].command_aborted);
    rig.done(&mut halt());
    assert_eq!((rig.axis.state(), rig.axis.set_velocity()), (AxisState::Standstill, 0.0));
}

/// A new edge ends the motion of the block (manual 5.2 b). With invalid inputs nothing begins: the axis brakes in
/// errorstop with the error of the block. An edge of another block ends nothing.
#[test]
fn a_new_edge_with_invalid_inputs_ends_the_motion_with_its_error() {
    let (mut rig, mut endless, mut other) = (linear(), endless(10.0), by(1.0));
    rig.calls(20, &mut endless);
    other.inputs.velocity = -1.0;
    let shown = rig.cycle(|axis| [endless.call(true, axis), other.call(true, axis)]);
    assert!(shown[0].busy && shown[1].error == Some(SmcError::MrInvalidVelaccValues), "{shown:?}");
    assert_eq!(rig.axis.error_id(), None, "it goes on");
    rig.call(&mut endless, false);
    endless.inputs.velocity = -1.0;
    let shown = rig.call(&mut endless, true);
    assert_eq!((shown.error, shown.busy), (Some(SmcError::MvInvalidAccdecValues), false));
    assert_eq!(rig.axis.state(), AxisState::ErrorStop);
    rig.until(|axis| {
        let shown = endless.call(true, axis);
        assert_eq!(shown.error, Some(SmcError::MvInvalidAccdecValues));
        assert_eq!(axis.error_id(), Some(301), "not 30: it has been called");
        axis.set_velocity() == 0.0
    });
    rig.done(&mut Reset::default());
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

/// The same for a stop that holds the axis, and for a superimposed motion.
#[test]
fn nobody_is_left_with_an_axis_that_nothing_moves() {
    let (mut rig, mut stop, mut endless) = (linear(), stop(100.0), endless(10.0));
    rig.done(&mut stop);
    // The stop takes the axis again before it has released it.
    rig.call(&mut stop, false);
    rig.calls(20, &mut endless);
    rig.call(&mut stop, true);
    rig.call(&mut stop, false);
    stop.inputs.deceleration = 0.0;
    assert_eq!(rig.call(&mut stop, true).error, Some(SmcError::MsInvalidAccdecValues));
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(181)));

    let (mut rig, mut below, mut above) = (linear(), to(50.0), on_top(5.0, 2.0, 100.0));
    rig.run(20, |axis| (below.call(true, axis), above.call(true, axis)));
    rig.cycle(|axis| (below.call(true, axis), above.call(false, axis)));
    above.inputs.velocity_diff = 0.0;
    let shown = rig.cycle(|axis| [below.call(true, axis), above.call(true, axis)]);
    assert_eq!(shown[1].error, Some(SmcError::MsiInvalidVelaccValues));
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(276)));
}

/// A homing that is begun again goes on to its end.
#[test]
fn homing_can_be_begun_again() {
    let (mut rig, mut home) = (linear(), home(3.0, 0.0));
    rig.call(&mut home, true);
    rig.call(&mut home, false);
    let count = rig.until(|axis| {
        let shown = home.call(true, axis);
        assert_eq!((shown.error, shown.command_aborted), (None, false), "{shown:?}");
        shown.done
    });
    assert!(count < 100 && rig.axis.set_position() == 3.0, "{count}");
}
