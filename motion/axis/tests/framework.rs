//! Tests of the block framework: Execute, Done, `CommandAborted`, Error and the owner (manual 5.2).

use super::*;

#[test]
fn done_stays_while_execute_does() {
    let (mut rig, mut block) = (linear(), to(1.0));
    // 1 u under 10 u/s and 100 u/s²: 0.1 s up and 0.1 s down, 20 cycles.
    assert_eq!(rig.done(&mut block), 20);
    assert_eq!(rig.axis.set_position(), 1.0);
    for execute in [true, true, false, false] {
        let shown = rig.call(&mut block, execute);
        assert_eq!((shown.done, shown.busy), (execute, false));
    }
    // For one cycle if Execute fell earlier.
    block.inputs.position = 0.0;
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
    // For one cycle if Execute fell earlier.
    rig.call(&mut second, false);
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
    let (mut rig, mut moving, mut other, mut held) = (linear(), endless(10.0), to(3.0), stop(50.0));
    rig.calls(20, &mut moving);
    rig.call(&mut held, true);
    let shown =
        rig.cycle(|axis| [moving.call(false, axis), held.call(true, axis), other.call(true, axis)]);
    assert_eq!(shown.map(|shown| shown.command_aborted), [true, false, true]);
    let shown = rig.cycle(|axis| [held.call(true, axis), stop(50.0).call(true, axis)]);
    assert_eq!(shown[1].error, Some(SmcError::MsUnknownStoppingError));
    // 10 u/s with 50 u/s²: 20 cycles, three of which have passed.
    assert_eq!(rig.done(&mut held), 17);
    assert_eq!(rig.axis.state(), AxisState::Stopping);
    let shown = rig.cycle(|axis| [held.call(true, axis), to(3.0).call(true, axis)]);
    assert!(shown[0].done && shown[1].command_aborted);
    rig.call(&mut held, false);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
    rig.until(|axis| other.call(false, axis).command_aborted || other.call(true, axis).done);
    assert_eq!(rig.axis.set_position(), 3.0);
    // If Execute fell earlier, the axis is free as soon as it is at rest.
    rig.calls(20, &mut to(100.0));
    rig.call(&mut held, true);
    rig.until(|axis| held.call(false, axis).done);
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

/// Manual 5.2 b; an edge of another block ends nothing.
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

/// A block that gets another axis, on which another block has the same owner number, takes nothing from that block.
#[test]
fn a_new_edge_on_another_axis_takes_nothing_from_a_stop() {
    let rig = |drive_id| Rig::new(AxisConfig { drive_id, ..AxisConfig::default() });
    let (mut one, mut other, mut block, mut stop) = (rig(1), rig(2), to(10.0), stop(50.0));
    one.call(&mut block, true);
    other.call(&mut stop, true);
    assert_eq!(one.axis.owner(), other.axis.owner());
    one.call(&mut block, false);
    let [_, shown] = other.cycle(|axis| [stop.call(true, axis), block.call(true, axis)]);
    assert!(shown.command_aborted && !shown.busy, "{shown:?}");
    assert_eq!(other.axis.state(), AxisState::Stopping);
    // A superimposed motion likewise: error 32.
    let (mut on_top, mut third) = (on_top(5.0, 1.0, 10.0), rig(3));
    one.call(&mut on_top, true);
    let shown = third.call(&mut on_top, true);
    assert_eq!(shown.error, Some(SmcError::AxisRefChangedDuringOperation));
}

/// Also a block that goes on from the last set-point (`Execute` wired to `Done`).
#[test]
fn what_begins_at_the_end_of_a_move_leaves_it_at_its_target() {
    for ramp in [RampType::Trapezoid, RampType::Sigmoid, RampType::Parabolic] {
        begins_at_the_end(ramp, gear(1, 1));
        begins_at_the_end(ramp, in_pos([1, 1], [50.0, 200.0], 20.0));
        begins_at_the_end(ramp, phasing(0.0, 10.0, 50.0));
    }
}

fn begins_at_the_end<M: Motion<With = Master> + Clone>(ramp: RampType, mut block: Block<M>) {
    let slave = Rig::new(AxisConfig { ramp, jerk: 900.0, ..AxisConfig::default() });
    let (mut axes, mut first, mut ended) = ([linear(), slave], to(7.3), false);
    let synchronized = AxisState::SynchronizedMotion;
    for _ in 0..300 {
        let follow = |master: &Axis, axis: &mut Axis| {
            ended |= first.call(true, axis).done;
            block.follow(ended, master, axis);
            (axis.set_position(), axis.set_velocity(), axis.state())
        };
        let shown = pair(&mut axes, |_| (), follow);
        let name = std::any::type_name::<M>();
        assert!(!ended || shown == (7.3, 0.0, synchronized), "{name} {ramp:?}: {shown:?}");
    }
    assert!(ended);
}
