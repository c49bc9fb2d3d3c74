//! Tests of the block framework: Execute, Done, `CommandAborted`, Error and the owner (manual 5.2).

use super::blocks::endless;
use super::rig::{Rig, linear, on_top};
use crate::{
    Axis, AxisConfig, AxisState, Block, Direction, Halt, Home, MoveAbsolute, MoveRelative,
    MoveVelocity, Outputs, Reset, SmcError, Stop,
};

pub(super) fn to(position: f64) -> Block<MoveAbsolute> {
    Block::new(MoveAbsolute {
        position,
        velocity: 10.0,
        acceleration: 100.0,
        deceleration: 100.0,
        direction: Direction::Shortest,
    })
}

fn by(distance: f64) -> Block<MoveRelative> {
    Block::new(MoveRelative { distance, velocity: 10.0, acceleration: 100.0, deceleration: 100.0 })
}

fn cycles<const N: usize>(
    rig: &mut Rig,
    execute: [bool; N],
    mut call: impl FnMut(bool, &mut Axis) -> Outputs,
) -> [Outputs; N] {
    execute.map(|execute| rig.cycle(|axis| call(execute, axis)))
}

#[test]
fn done_stays_while_execute_does() {
    let mut rig = linear();
    let mut block = to(1.0);
    // 1 u under 10 u/s and 100 u/s²: 0.1 s up and 0.1 s down, 20 cycles.
    let count = rig.until(|axis| block.call(true, axis).done);
    assert_eq!(count, 20);
    assert_eq!(rig.axis.set_position(), 1.0);
    let shown =
        cycles(&mut rig, [true, true, false, false], |execute, axis| block.call(execute, axis));
    assert_eq!(shown.map(|shown| shown.done), [true, true, false, false]);
    assert_eq!(shown.map(|shown| shown.busy), [false; 4]);
}

#[test]
fn done_shows_for_one_cycle_if_execute_fell_earlier() {
    let mut rig = linear();
    let mut block = to(1.0);
    rig.cycle(|axis| block.call(true, axis));
    let count = rig.until(|axis| block.call(false, axis).done);
    assert_eq!(count, 19);
    assert!(!rig.cycle(|axis| block.call(false, axis)).done);
}

#[test]
fn inputs_count_at_the_rising_edge_only() {
    let mut rig = linear();
    let mut block = to(1.0);
    rig.cycle(|axis| block.call(true, axis));
    block.inputs.position = 50.0;
    rig.until(|axis| block.call(true, axis).done);
    assert_eq!(rig.axis.set_position(), 1.0);
    rig.cycle(|axis| block.call(false, axis));
    rig.until(|axis| block.call(true, axis).done);
    assert_eq!(rig.axis.set_position(), 50.0);
}

#[test]
fn a_new_block_takes_the_axis_and_the_old_one_is_aborted() {
    let mut rig = linear();
    let (mut first, mut second) = (to(100.0), to(-1.0));
    for _ in 0..30 {
        rig.cycle(|axis| first.call(true, axis));
    }
    let owners = rig.axis.read_parameter(1023).expect("iNoOwner");
    // Called before the new one, the old one still moves in this cycle; the new one gives the set-point anew.
    let before = rig.axis.set_position();
    let shown = rig.cycle(|axis| [first.call(true, axis), second.call(true, axis)]);
    assert!(shown.iter().all(|shown| !shown.command_aborted && shown.busy));
    assert_eq!(rig.axis.owner(), 2);
    assert_eq!(rig.axis.read_parameter(1023), Ok(owners + 1.0));
    // From 10 u/s it brakes with 100 u/s²: one cycle of 10 ms is 0.095 u.
    assert!((rig.axis.set_position() - before - 0.095).abs() < 1e-9);
    let shown = rig.cycle(|axis| [first.call(true, axis), second.call(true, axis)]);
    assert_eq!(shown.map(|shown| shown.command_aborted), [true, false]);
    // It stays until Execute falls.
    let shown = rig.cycle(|axis| [first.call(true, axis), second.call(true, axis)]);
    assert!(shown[0].command_aborted && !shown[0].busy);
    let shown = rig.cycle(|axis| [first.call(false, axis), second.call(true, axis)]);
    assert!(!shown[0].command_aborted);
    rig.until(|axis| second.call(true, axis).done);
    assert_eq!(rig.axis.set_position(), -1.0);
    assert_eq!((rig.axis.owner(), rig.axis.state()), (0, AxisState::Standstill));
}

#[test]
fn aborted_shows_for_one_cycle_if_execute_fell_earlier() {
    let mut rig = linear();
    let (mut first, mut second) = (to(100.0), to(-1.0));
    rig.cycle(|axis| first.call(true, axis));
    rig.cycle(|axis| first.call(false, axis));
    rig.cycle(|axis| second.call(true, axis));
    let shown = [(); 2].map(|()| {
        rig.cycle(|axis| {
            let shown = first.call(false, axis);
            second.call(true, axis);
            shown.command_aborted
        })
    });
    assert_eq!(shown, [true, false]);
}

#[test]
fn a_new_edge_of_the_same_block_begins_anew() {
    let mut rig = linear();
    let mut block = by(10.0);
    for _ in 0..50 {
        rig.cycle(|axis| block.call(true, axis));
    }
    let before = rig.axis.set_position();
    rig.cycle(|axis| block.call(false, axis));
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
    let mut rig = linear();
    let mut running = to(1.0);
    let mut wrong = to(5.0);
    wrong.inputs.acceleration = 0.0;
    rig.cycle(|axis| running.call(true, axis));
    let shown = rig.cycle(|axis| [running.call(true, axis), wrong.call(true, axis)]);
    assert_eq!(shown[1].error, Some(SmcError::MaInvalidVelaccValues));
    let shown = rig.cycle(|axis| [running.call(true, axis), wrong.call(false, axis)]);
    assert_eq!(shown[1], Outputs::default());
    rig.until(|axis| running.call(true, axis).done);
    assert_eq!(rig.axis.set_position(), 1.0);
    assert!(rig.axis.fb_error_occurred());
    assert_eq!(rig.axis.read_fb_error(), Some(SmcError::MaInvalidVelaccValues));
    assert_eq!(rig.axis.clear_fb_error(), Some(SmcError::MaInvalidVelaccValues));
    assert!(!rig.axis.fb_error_occurred());
}

#[test]
fn a_block_may_begin_in_the_cycle_another_ends() {
    let mut rig = linear();
    let (mut first, mut second) = (by(1.0), by(1.0));
    let mut count = 0;
    rig.until(|axis| {
        count += 1;
        let done = first.call(true, axis).done;
        second.call(done, axis).done
    });
    // Exactly two ways, and no cycle lost but the one in which the second stands where the first ends.
    assert_eq!(rig.axis.set_position(), 2.0);
    assert_eq!(count, 40);
}

#[test]
fn a_stop_cannot_be_interrupted_and_locks_the_axis() {
    let mut rig = linear();
    let mut moving = Block::new(MoveVelocity {
        velocity: 10.0,
        acceleration: 100.0,
        deceleration: 100.0,
        direction: Direction::Positive,
    });
    for _ in 0..20 {
        rig.cycle(|axis| moving.call(true, axis));
    }
    let mut stop = Block::new(Stop { deceleration: 50.0 });
    let mut other = to(3.0);
    let mut second_stop = Block::new(Stop { deceleration: 50.0 });
    rig.cycle(|axis| stop.call(true, axis));
    let shown =
        rig.cycle(|axis| [moving.call(false, axis), stop.call(true, axis), other.call(true, axis)]);
    assert_eq!(shown.map(|shown| shown.command_aborted), [true, false, true]);
    let shown = rig.cycle(|axis| [stop.call(true, axis), second_stop.call(true, axis)]);
    assert_eq!(shown[1].error, Some(SmcError::MsUnknownStoppingError));
    // 10 u/s with 50 u/s²: 20 cycles, three of which have passed.
    assert_eq!(rig.until(|axis| stop.call(true, axis).done), 17);
    assert_eq!(rig.axis.state(), AxisState::Stopping);
    let shown = rig.cycle(|axis| [stop.call(true, axis), to(3.0).call(true, axis)]);
    assert!(shown[0].done && shown[1].command_aborted);
    rig.cycle(|axis| stop.call(false, axis));
    assert_eq!(rig.axis.state(), AxisState::Standstill);
    rig.until(|axis| other.call(false, axis).command_aborted || other.call(true, axis).done);
    assert_eq!(rig.axis.set_position(), 3.0);
}

#[test]
fn a_stop_whose_execute_fell_frees_the_axis_when_it_stands() {
    let mut rig = linear();
    let mut moving = to(100.0);
    for _ in 0..20 {
        rig.cycle(|axis| moving.call(true, axis));
    }
    let mut stop = Block::new(Stop { deceleration: 100.0 });
    rig.cycle(|axis| stop.call(true, axis));
    rig.until(|axis| stop.call(false, axis).done);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

#[test]
fn an_axis_swapped_for_another_is_an_error_32() {
    let (mut rig, mut other) =
        (linear(), Rig::new(AxisConfig { drive_id: 7, ..AxisConfig::default() }));
    let (mut block, mut others) = (to(5.0), to(9.0));
    rig.cycle(|axis| block.call(true, axis));
    other.cycle(|axis| others.call(true, axis));
    let shown = other.cycle(|axis| [others.call(true, axis), block.call(true, axis)]);
    assert_eq!(shown[1].error, Some(SmcError::AxisRefChangedDuringOperation));
    // The other axis is not disturbed; the block's own one is left alone.
    other.until(|axis| others.call(true, axis).done);
    assert_eq!(other.axis.set_position(), 9.0);
    rig.cycle(|_| ());
    assert_eq!(rig.axis.error_id(), Some(30));
}

#[test]
fn a_halt_may_be_aborted() {
    let mut rig = linear();
    let mut moving = to(100.0);
    for _ in 0..20 {
        rig.cycle(|axis| moving.call(true, axis));
    }
    let mut halt = Block::new(Halt { deceleration: 50.0 });
    rig.cycle(|axis| halt.call(true, axis));
    assert_eq!(rig.axis.state(), AxisState::DiscreteMotion);
    let mut back = to(0.0);
    rig.cycle(|axis| back.call(true, axis));
    assert!(
        rig.cycle(|axis| {
            back.call(true, axis);
            halt.call(true, axis)
        })
        .command_aborted
    );
    let mut halt = Block::new(Halt { deceleration: 50.0 });
    rig.until(|axis| halt.call(true, axis).done);
    assert_eq!((rig.axis.state(), rig.axis.set_velocity()), (AxisState::Standstill, 0.0));
}

/// A new edge ends what the block does (manual 5.2 b). With inputs that are not valid nothing begins: the axis brakes in
/// errorstop with the error of the block, which has been called. An edge of another block ends nothing.
#[test]
fn a_new_edge_with_invalid_inputs_ends_the_motion_with_its_error() {
    let mut rig = linear();
    let (mut endless, mut other, mut reset) = (endless(10.0), by(1.0), Reset::default());
    for _ in 0..20 {
        rig.cycle(|axis| endless.call(true, axis));
    }
    other.inputs.velocity = -1.0;
    let shown = rig.cycle(|axis| [endless.call(true, axis), other.call(true, axis)]);
    assert!(shown[0].busy && shown[1].error == Some(SmcError::MrInvalidVelaccValues), "{shown:?}");
    assert_eq!(rig.axis.error_id(), None, "it goes on");
    rig.cycle(|axis| endless.call(false, axis));
    endless.inputs.velocity = -1.0;
    let shown = rig.cycle(|axis| endless.call(true, axis));
    assert_eq!((shown.error, shown.busy), (Some(SmcError::MvInvalidAccdecValues), false));
    assert_eq!(rig.axis.state(), AxisState::ErrorStop);
    rig.until(|axis| {
        let shown = endless.call(true, axis);
        assert_eq!(shown.error, Some(SmcError::MvInvalidAccdecValues));
        assert_eq!(axis.error_id(), Some(301), "not 30: it has been called");
        axis.set_velocity() == 0.0
    });
    rig.until(|axis| reset.call(true, axis).done);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

/// Whoever it is: a stop that holds the axis, and what is on top of a motion.
#[test]
fn nobody_is_left_with_an_axis_that_nothing_moves() {
    let (mut rig, mut stop) = (linear(), Block::new(Stop { deceleration: 100.0 }));
    rig.until(|axis| stop.call(true, axis).done);
    // It has taken the axis again before it gave it back.
    let mut endless = endless(10.0);
    rig.cycle(|axis| stop.call(false, axis));
    for _ in 0..20 {
        rig.cycle(|axis| endless.call(true, axis));
    }
    rig.cycle(|axis| stop.call(true, axis));
    rig.cycle(|axis| stop.call(false, axis));
    stop.inputs.deceleration = 0.0;
    let shown = rig.cycle(|axis| stop.call(true, axis));
    assert_eq!(shown.error, Some(SmcError::MsInvalidAccdecValues));
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(181)));

    let (mut rig, mut below, mut above) = (linear(), to(50.0), on_top(5.0, 2.0, 100.0, 100.0));
    for _ in 0..20 {
        rig.cycle(|axis| (below.call(true, axis), above.call(true, axis)));
    }
    rig.cycle(|axis| (below.call(true, axis), above.call(false, axis)));
    above.inputs.velocity_diff = 0.0;
    let shown = rig.cycle(|axis| [below.call(true, axis), above.call(true, axis)]);
    assert_eq!(shown[1].error, Some(SmcError::MsiInvalidVelaccValues));
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(276)));
}

/// A homing that is begun again goes on to its end.
#[test]
fn homing_can_be_begun_again() {
    let (mut rig, mut home) = (linear(), Block::new(Home { position: 3.0, deceleration: 0.0 }));
    rig.cycle(|axis| home.call(true, axis));
    rig.cycle(|axis| home.call(false, axis));
    let count = rig.until(|axis| {
        let shown = home.call(true, axis);
        assert_eq!((shown.error, shown.command_aborted), (None, false), "{shown:?}");
        shown.done
    });
    assert!(count < 100 && rig.axis.set_position() == 3.0, "{count}");
}
