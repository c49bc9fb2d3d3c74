//! Tests of drives that stop answering, and of errors that cannot be reset.

use super::blocks::endless;
use super::rig::{CYCLE, linear, rotary};
use crate::{
    AxisState, Block, Encoder, EncoderConfig, Home, Homing, Movement, Reset, SmcError, TouchProbe,
    Trigger,
};

#[test]
fn a_drive_that_falls_silent_is_an_error_1_and_a_reset_waits_for_it() {
    let mut rig = linear();
    let mut block = endless(10.0);
    for _ in 0..20 {
        rig.cycle(|axis| block.call(true, axis));
    }
    rig.drive.feedback_mut().communicating = false;
    let shown = rig.cycle(|axis| block.call(true, axis));
    assert_eq!(shown.error, Some(SmcError::DiGeneralCommunicationError));
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(1)));
    assert_eq!(rig.axis.read_bool_parameter(1012), Ok(false), "bCommunication");
    let mut reset = Reset::default();
    let mut cycles = 0;
    let error = loop {
        let shown = rig.cycle(|axis| reset.call(true, axis));
        cycles += 1;
        if let Some(error) = shown.error {
            break error;
        }
    };
    assert_eq!((error, error.number()), (SmcError::RDriveDoesntAnswerInTime, 123));
    assert!(f64::from(cycles) * CYCLE > 1.0, "it waits a second");
    rig.drive.feedback_mut().communicating = true;
    rig.cycle(|axis| reset.call(false, axis));
    rig.until(|axis| reset.call(true, axis).done);
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
    let shown = rig.cycle(|axis| reset.call(true, axis));
    assert_eq!(shown.error, Some(SmcError::RErrorNotResettable));
    assert_eq!(shown.error.map(SmcError::number), Some(122));
    assert_eq!(rig.axis.state(), AxisState::ErrorStop);
    // Somebody has repaired it.
    rig.drive.feedback_mut().error = None;
    rig.cycle(|axis| reset.call(false, axis));
    rig.until(|axis| reset.call(true, axis).done);
}

#[test]
fn homing_without_an_answer_is_172() {
    let mut rig = linear();
    let mut home = Block::new(Home { position: 5.0, deceleration: 0.0 });
    rig.cycle(|axis| home.call(true, axis));
    let feedback = rig.drive.feedback_mut();
    (feedback.homing, feedback.communicating) = (Homing::Busy, false);
    let shown = rig.cycle(|axis| home.call(true, axis));
    assert_eq!(shown.error, Some(SmcError::HAxisDidntAnswer));
    assert_eq!(shown.error.map(SmcError::number), Some(172));
    assert_eq!(rig.axis.error_id(), Some(1), "the axis's own error");
    // Another block that is lost that way shows the axis's.
    let mut rig = linear();
    let mut home = Block::new(Home { position: 5.0, deceleration: 0.0 });
    rig.cycle(|axis| home.call(true, axis));
    rig.drive.feedback_mut().error = Some(9);
    let shown = rig.cycle(|axis| home.call(true, axis));
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
    let mut encoder = Encoder::new(EncoderConfig {
        id: 1,
        ratio: [1, 1],
        movement: Movement::Linear,
        software_limits: None,
        modulo: 0,
        cycle: CYCLE,
    });
    assert!(encoder.call(3, None).valid);
    // Blocks take axes with power only; one that has it by mistake is told.
    encoder.axis_mut().values.regulator_real_state = true;
    encoder.axis_mut().values.drive_start_real_state = true;
    endless(1.0).call(true, encoder.axis_mut());
    let shown = encoder.call(4, None);
    assert!(!shown.valid);
    assert_eq!(shown.error, Some(SmcError::EncAxisusedbyotherfb));
    assert_eq!(encoder.axis().act_position(), 3.0);
}

/// Limit switches are for linear axes (manual 2.1.3).
#[test]
fn a_rotary_axis_has_no_limit_switches() {
    for (mut rig, error) in [(linear(), Some(10)), (rotary(), None)] {
        rig.axis.write_bool_parameter(1206, true).expect("bHWLimitEnable");
        rig.drive.feedback_mut().limit_switch = true;
        rig.cycle(|_| ());
        assert_eq!(rig.axis.error_id(), error);
    }
}
