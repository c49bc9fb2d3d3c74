//! Tests of axis states, power and errors.

use super::*;

/// The diagram is that of the invariants, which has every state of every block sequence.
#[test]
fn the_transitions_are_plcopens() {
    for from in AxisState::ALL {
        for next in AxisState::ALL.into_iter().filter(|next| *next != from) {
            assert_eq!(from.leads_to(next), is_arrow(from, next), "{from:?} to {next:?}");
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
    // Not without a cycle time.
    let mut axis = Axis::new(AxisConfig { cycle: 0.0, ..AxisConfig::default() });
    let shown = on.call(true, &mut axis);
    assert_eq!(shown.error, Some(SmcError::PFtaskcycleEmpty));
}

#[test]
fn without_power_or_with_the_brake_on_nothing_moves() {
    for (regulator_on, drive_start) in [(false, true), (true, false)] {
        let mut rig = linear();
        rig.power = Power { regulator_on, drive_start };
        rig.run(2, |_| ());
        let shown = rig.call(&mut endless(10.0), true);
        assert_eq!(shown.error, Some(SmcError::RegulatorOrStartNotSet));
        assert_eq!((rig.axis.state(), rig.axis.set_velocity()), (AxisState::PowerOff, 0.0));
    }
    // Lost in motion.
    let (mut rig, mut block) = (linear(), endless(10.0));
    rig.calls(30, &mut block);
    rig.power.regulator_on = false;
    rig.call(&mut block, true);
    assert_eq!(rig.call(&mut block, true).error, Some(SmcError::RegulatorOrStartNotSet));
    assert_eq!(rig.axis.state(), AxisState::PowerOff);
}

#[test]
fn a_block_that_is_not_called_is_an_error_30_and_the_axis_brakes() {
    let (mut rig, mut block) = (linear(), endless(10.0));
    rig.calls(30, &mut block);
    assert_eq!(rig.axis.set_velocity(), 10.0);
    let at = rig.axis.set_position();
    rig.cycle(|_| ());
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(30)));
    // It brakes from the same cycle on, with fSWMaxDeceleration of 100 u/s²: 10 u/s take 0.1 s and 0.5 u.
    assert!((rig.axis.set_velocity() - 9.0).abs() < 1e-9);
    rig.run(9, |_| ());
    assert!((rig.axis.set_position() - at - 0.5).abs() < 1e-9, "{}", rig.axis.set_position() - at);
    assert!(rig.axis.set_velocity().abs() < 1e-9);
    // The block shows the error, and so does another one that asks for motion now.
    for block in [&mut block, &mut endless(10.0)] {
        let shown = rig.call(block, true);
        assert_eq!(shown.error, Some(SmcError::FbWasntCalledDuringMotion));
    }
}

#[test]
fn leaving_the_software_limits_is_an_error_10() {
    let config = AxisConfig { software_limits: Some([-1.0, 5.0]), ..AxisConfig::default() };
    let (mut rig, mut block) = (Rig::new(config), endless(10.0));
    rig.until(|axis| {
        block.call(true, axis);
        axis.state() == AxisState::ErrorStop
    });
    assert_eq!(rig.axis.error_id(), Some(10));
    let over = rig.axis.set_position() - 5.0;
    assert!(over > 0.0 && over < 10.0 * CYCLE * 2.0, "{over}");
    // A rotary axis has no limits (manual 2.1.3).
    let mut rig = Rig::new(AxisConfig { movement: Movement::Rotary { period: 360.0 }, ..config });
    rig.calls(200, &mut endless(10.0));
    assert_eq!(rig.axis.state(), AxisState::ContinuousMotion);
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
fn the_drives_own_error_stops_the_axis_and_a_reset_waits_for_it() {
    let keeps = |rig: &mut Rig| rig.drive.feedback_mut().error = Some(4711);
    let mut rig = linear();
    keeps(&mut rig);
    rig.cycle(|_| ());
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(4711)));
    assert_eq!(rig.call(&mut stop(10.0), true).error, Some(SmcError::MsAxisInErrorstop));
    // The virtual drive clears its error at a reset.
    rig.done(&mut Reset::default());
    assert_eq!(rig.axis.state(), AxisState::Standstill);
    // A drive that keeps its error.
    keeps(&mut rig);
    rig.cycle(|_| ());
    keeps(&mut rig);
    let (_, shown) = rig.fails(&mut Reset::default(), keeps);
    assert_eq!(shown.error, Some(SmcError::RDriveDoesntAnswer));
}

#[test]
fn a_drive_that_falls_silent_is_an_error_1_and_a_reset_waits_for_it() {
    let (mut rig, mut block) = (linear(), endless(10.0));
    rig.calls(20, &mut block);
    rig.drive.feedback_mut().communicating = false;
    let shown = rig.call(&mut block, true);
    assert_eq!(shown.error, Some(SmcError::DiGeneralCommunicationError));
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(1)));
    assert!(!rig.axis.values.communication);
    let mut reset = Reset::default();
    let (cycles, shown) = rig.fails(&mut reset, |_| ());
    assert_eq!(shown.error, Some(SmcError::RDriveDoesntAnswerInTime));
    assert!(f64::from(cycles) * CYCLE > 1.0, "it waits a second");
    rig.drive.feedback_mut().communicating = true;
    rig.call(&mut reset, false);
    rig.done(&mut reset);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

#[test]
fn an_error_that_cannot_be_reset_is_122() {
    let (mut rig, mut reset) = (linear(), Reset::default());
    let feedback = rig.drive.feedback_mut();
    (feedback.error, feedback.resettable) = (Some(9), false);
    rig.cycle(|_| ());
    assert_eq!(rig.axis.error_id(), Some(9));
    assert_eq!(rig.call(&mut reset, true).error, Some(SmcError::RErrorNotResettable));
    assert_eq!(rig.axis.state(), AxisState::ErrorStop);
    // The drive has been repaired.
    rig.drive.feedback_mut().error = None;
    rig.call(&mut reset, false);
    rig.done(&mut reset);
}
