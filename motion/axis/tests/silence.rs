//! Tests of drives that stop answering, and of errors that cannot be reset.

use super::rig::{CYCLE, encoder, endless, home, linear};
use crate::{AxisState, Homing, Movement, Reset, SmcError, TouchProbe, Trigger};

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
    let mut error = None;
    let cycles = rig.until(|axis| {
        error = reset.call(true, axis).error;
        error.is_some()
    });
    assert_eq!(error, Some(SmcError::RDriveDoesntAnswerInTime));
    assert_eq!(error.map(SmcError::number), Some(123));
    assert!(f64::from(cycles) * CYCLE > 1.0, "it waits a second");
    rig.drive.feedback_mut().communicating = true;
    rig.call(&mut reset, false);
    rig.done(&mut reset);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

#[test]
fn an_error_that_cannot_be_reset_is_122() {
    let mut rig = linear();
    let feedback = rig.drive.feedback_mut();
    (feedback.error, feedback.resettable) = (Some(9), false);
    rig.cycle(|_| ());
    assert_eq!(rig.axis.error_id(), Some(9));
    let mut reset = Reset::default();
    let shown = rig.call(&mut reset, true);
    assert_eq!(shown.error, Some(SmcError::RErrorNotResettable));
    assert_eq!(shown.error.map(SmcError::number), Some(122));
    assert_eq!(rig.axis.state(), AxisState::ErrorStop);
    // The drive has been repaired.
    rig.drive.feedback_mut().error = None;
    rig.call(&mut reset, false);
    rig.done(&mut reset);
}

#[test]
fn homing_without_an_answer_is_172() {
    let (mut rig, mut block) = (linear(), home(5.0, 0.0));
    rig.call(&mut block, true);
    let feedback = rig.drive.feedback_mut();
    (feedback.homing, feedback.communicating) = (Homing::Busy, false);
    let shown = rig.call(&mut block, true);
    assert_eq!(shown.error, Some(SmcError::HAxisDidntAnswer));
    assert_eq!(shown.error.map(SmcError::number), Some(172));
    assert_eq!(rig.axis.error_id(), Some(1), "the axis's own error");
    // After an error of the drive the block shows the axis's.
    let (mut rig, mut block) = (linear(), home(5.0, 0.0));
    rig.call(&mut block, true);
    rig.drive.feedback_mut().error = Some(9);
    let shown = rig.call(&mut block, true);
    assert_eq!(shown.error, Some(SmcError::DiGeneralCommunicationError));
}

#[test]
fn a_probe_without_an_answer_is_402() {
    for before in [true, false] {
        let mut rig = linear();
        let mut trigger = Trigger::of_drive(1);
        let mut probe = TouchProbe::new(None);
        if !before {
            rig.cycle(|axis| probe.call(true, axis, &mut trigger));
        }
        rig.drive.feedback_mut().communicating = false;
        let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger)).outputs;
        assert_eq!(shown.error, Some(SmcError::TpCommError));
        assert!(!trigger.is_active());
    }
}

#[test]
fn an_encoder_that_a_block_moves_is_5001() {
    let mut encoder = encoder(Movement::Linear, 0, [1, 1]);
    assert!(encoder.call(3, None).valid);
    // Blocks take axes with power only; here the encoder has it by mistake.
    encoder.axis_mut().values.regulator_real_state = true;
    encoder.axis_mut().values.drive_start_real_state = true;
    endless(1.0).call(true, encoder.axis_mut());
    let shown = encoder.call(4, None);
    assert!(!shown.valid);
    assert_eq!(shown.error, Some(SmcError::EncAxisusedbyotherfb));
    assert_eq!(encoder.axis().act_position(), 3.0);
}
