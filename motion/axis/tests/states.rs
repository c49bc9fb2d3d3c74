//! Tests of axis states, power and errors.

use super::rig::{CYCLE, linear};
use crate::{
    Axis, AxisConfig, AxisState, Block, Direction, MoveVelocity, Power, SmcError, Stop,
    VirtualDrive,
};

fn endless() -> Block<MoveVelocity> {
    Block::new(MoveVelocity {
        velocity: 10.0,
        acceleration: 100.0,
        deceleration: 100.0,
        direction: Direction::Positive,
    })
}

#[test]
fn the_transitions_are_plcopens() {
    use AxisState::{
        ContinuousMotion, DiscreteMotion, ErrorStop, Homing, PowerOff, Standstill, Stopping,
        SynchronizedMotion,
    };
    // Every pair that PLCopen's diagram has no arrow for (staying is no arrow).
    let forbidden = [
        (PowerOff, vec![Stopping, DiscreteMotion, ContinuousMotion, SynchronizedMotion, Homing]),
        (ErrorStop, vec![Stopping, DiscreteMotion, ContinuousMotion, SynchronizedMotion, Homing]),
        (Stopping, vec![DiscreteMotion, ContinuousMotion, SynchronizedMotion, Homing]),
        (Standstill, vec![]),
        (DiscreteMotion, vec![Homing]),
        (ContinuousMotion, vec![Homing]),
        (SynchronizedMotion, vec![Homing]),
        (Homing, vec![DiscreteMotion, ContinuousMotion, SynchronizedMotion]),
    ];
    for (from, never) in forbidden {
        for next in AxisState::ALL.into_iter().filter(|next| *next != from) {
            assert_eq!(from.leads_to(next), !never.contains(&next), "{from:?} to {next:?}");
        }
    }
    let numbers = AxisState::ALL.map(AxisState::number);
    assert_eq!(numbers, [0, 1, 2, 3, 4, 5, 6, 7]);
}

#[test]
fn power_comes_and_goes() {
    let mut axis = Axis::new(AxisConfig { cycle: CYCLE, ..AxisConfig::default() });
    let mut drive = VirtualDrive::new(7.0);
    assert_eq!(axis.state(), AxisState::Standstill, "the manual's initial value");
    let on = Power { regulator_on: true, drive_start: true };
    let brake_on = Power { regulator_on: true, drive_start: false };
    let expected = [
        (brake_on, AxisState::PowerOff, false),
        (brake_on, AxisState::PowerOff, false),
        (on, AxisState::PowerOff, false),
        (on, AxisState::Standstill, true),
        (on, AxisState::Standstill, true),
    ];
    for (power, state, status) in expected {
        axis.begin_cycle(&drive.feedback());
        let shown = power.call(true, &mut axis);
        assert_eq!((axis.state(), shown.status, shown.error), (state, status, None));
        drive.follow(&axis.end_cycle());
    }
    assert_eq!(axis.set_position(), 7.0, "the set position is the actual one");
}

#[test]
fn an_axis_without_a_cycle_time_gets_no_power() {
    let mut axis = Axis::new(AxisConfig { cycle: 0.0, ..AxisConfig::default() });
    let shown = Power { regulator_on: true, drive_start: true }.call(true, &mut axis);
    assert_eq!(shown.error, Some(SmcError::PFtaskcycleEmpty));
    assert_eq!(shown.error.map(SmcError::number), Some(110));
}

#[test]
fn without_power_or_with_the_brake_on_nothing_moves() {
    for power in [
        Power { regulator_on: false, drive_start: true },
        Power { regulator_on: true, drive_start: false },
    ] {
        let mut rig = linear();
        rig.power = power;
        rig.cycle(|_| ());
        rig.cycle(|_| ());
        let mut block = endless();
        let shown = rig.cycle(|axis| block.call(true, axis));
        assert_eq!(shown.error, Some(SmcError::RegulatorOrStartNotSet));
        assert_eq!((rig.axis.state(), rig.axis.set_velocity()), (AxisState::PowerOff, 0.0));
    }
}

#[test]
fn losing_power_ends_the_motion_with_20() {
    let mut rig = linear();
    let mut block = endless();
    for _ in 0..30 {
        rig.cycle(|axis| block.call(true, axis));
    }
    rig.power.regulator_on = false;
    rig.cycle(|axis| block.call(true, axis));
    let shown = rig.cycle(|axis| block.call(true, axis));
    assert_eq!(shown.error, Some(SmcError::RegulatorOrStartNotSet));
    assert_eq!(rig.axis.state(), AxisState::PowerOff);
}

#[test]
fn a_block_that_is_not_called_is_an_error_30_and_the_axis_brakes() {
    let mut rig = linear();
    let mut block = endless();
    for _ in 0..30 {
        rig.cycle(|axis| block.call(true, axis));
    }
    assert_eq!(rig.axis.set_velocity(), 10.0);
    let at = rig.axis.set_position();
    rig.cycle(|_| ());
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(30)));
    // It brakes from the same cycle on, with fSWMaxDeceleration of 100 u/s²: 10 u/s take 0.1 s and 0.5 u.
    assert!((rig.axis.set_velocity() - 9.0).abs() < 1e-9);
    for _ in 0..9 {
        rig.cycle(|_| ());
    }
    assert!((rig.axis.set_position() - at - 0.5).abs() < 1e-9, "{}", rig.axis.set_position() - at);
    assert!(rig.axis.set_velocity().abs() < 1e-9);
    // The block learns of it, and so does who asks for motion now.
    let shown = rig.cycle(|axis| block.call(true, axis));
    assert_eq!(shown.error, Some(SmcError::FbWasntCalledDuringMotion));
    let shown = rig.cycle(|axis| endless().call(true, axis));
    assert_eq!(shown.error, Some(SmcError::FbWasntCalledDuringMotion));
}

#[test]
fn leaving_the_software_limits_is_an_error_10() {
    let mut rig = super::rig::Rig::new(AxisConfig {
        software_limits: Some([-1.0, 5.0]),
        ..AxisConfig::default()
    });
    let mut block = endless();
    rig.until(|axis| {
        block.call(true, axis);
        axis.state() == AxisState::ErrorStop
    });
    assert_eq!(rig.axis.error_id(), Some(10));
    assert_eq!(rig.axis.read_bool_parameter(1204), Ok(true));
    let over = rig.axis.set_position() - 5.0;
    assert!(over > 0.0 && over < 10.0 * CYCLE * 2.0, "{over}");
    // A rotary axis has no limits (manual 2.1.3).
    let mut rig = super::rig::Rig::new(AxisConfig {
        software_limits: Some([-1.0, 5.0]),
        movement: crate::Movement::Rotary { period: 360.0 },
        ..AxisConfig::default()
    });
    let mut block = endless();
    for _ in 0..200 {
        rig.cycle(|axis| block.call(true, axis));
    }
    assert_eq!(rig.axis.state(), AxisState::ContinuousMotion);
}

#[test]
fn the_drives_own_error_stops_the_axis() {
    let mut rig = linear();
    rig.drive.feedback_mut().error = Some(4711);
    rig.cycle(|_| ());
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(4711)));
    let shown = rig.cycle(|axis| Block::new(Stop { deceleration: 10.0 }).call(true, axis));
    assert_eq!(shown.error, Some(SmcError::MsAxisInErrorstop));
}
