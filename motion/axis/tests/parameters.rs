//! Tests of the parameters of axis and drive, by blocks and by number (manual 2.4, 5.3).

use super::rig::{CYCLE, Rig, endless, endless_in, linear, to};
use crate::{
    Answer, AxisConfig, AxisState, Block, ControllerMode, Direction, MoveVelocity, ParameterNumber,
    ReadParameter, SetControllerMode, SmcError, TouchProbe, Transfer, Trigger, WriteParameter,
};
use twin_profile::RampType;

#[test]
fn blocks_read_and_write_by_number() {
    let mut rig = linear();
    // A BOOL is 0 or 1.
    for (number, value) in [(1113, 7.0), (1205, 1.0)] {
        let shown = rig.call(&mut WriteParameter::new(ParameterNumber::Axis(number), value), true);
        assert!(shown.done && shown.error.is_none());
        let mut read = ReadParameter::new(ParameterNumber::Axis(number));
        assert_eq!(rig.cycle(|axis| read.call(true, axis)), Ok(Some(value)));
        assert_eq!(rig.cycle(|axis| read.call(false, axis)), Ok(None));
    }
    let mut read = ReadParameter::new(ParameterNumber::Axis(999));
    assert_eq!(rig.cycle(|axis| read.call(true, axis)), Err(SmcError::RpParamUnknown));
    let shown = rig.call(&mut WriteParameter::new(ParameterNumber::Axis(1100), 1.0), true);
    assert_eq!(shown.error, Some(SmcError::WpParamInvalid), "the set position is protected");
    assert_eq!(rig.axis.read_fb_error(), Some(SmcError::WpParamInvalid));
}

/// A cycle with a drive whose parameter 3 is `memory`, and that knows no other.
fn with_drive<T>(rig: &mut Rig, memory: &mut f64, blocks: impl FnOnce(&mut crate::Axis) -> T) -> T {
    let mut asked = None;
    rig.axis.begin_cycle(&rig.drive.feedback());
    rig.power.call(true, &mut rig.axis);
    let shown = blocks(&mut rig.axis);
    let command = rig.axis.end_cycle();
    rig.drive.follow(&command);
    if let Some(Transfer { number: 3, write }) = command.transfer {
        *memory = write.unwrap_or(*memory);
        asked = Some(Answer::Value(*memory));
    }
    let feedback = rig.drive.feedback_mut();
    feedback.answer = asked.or(feedback.answer);
    shown
}

#[test]
fn parameters_of_the_drive_are_asked_of_it_one_after_the_other() {
    let (mut rig, mut memory) = (linear(), 5.0);
    let mut read = ReadParameter::new(ParameterNumber::Drive(3));
    let mut write = WriteParameter::new(ParameterNumber::Drive(3), 8.0);
    let mut shown = Vec::new();
    for _ in 0..8 {
        shown.push(with_drive(&mut rig, &mut memory, |axis| {
            (read.call(true, axis).expect("an answer"), write.call(true, axis).done)
        }));
    }
    // Asked in the first cycle, there in the second; then the bus is free for the other one.
    assert_eq!(shown[..2], [(None, false), (Some(5.0), false)]);
    assert!(shown[7].1 && memory == 8.0, "{shown:?}");
    let mut last = None;
    for _ in 0..4 {
        last = with_drive(&mut rig, &mut memory, |axis| read.call(true, axis)).expect("an answer");
    }
    assert_eq!(last, Some(8.0));
    // A block that is not called any more does not keep the bus.
    for _ in 0..3 {
        rig.cycle(|_| ());
    }
    let mut other = ReadParameter::new(ParameterNumber::Drive(3));
    with_drive(&mut rig, &mut memory, |axis| other.call(true, axis)).expect("waits");
    let found = with_drive(&mut rig, &mut memory, |axis| other.call(true, axis));
    assert_eq!(found, Ok(Some(8.0)));
}

#[test]
fn what_the_drive_refuses_or_does_not_answer_is_131_and_141() {
    let write = |value| WriteParameter::new(ParameterNumber::Drive(3), value);
    let refuses: fn(&mut Rig) = |_| ();
    // The virtual drive has no parameters; a silent drive gives no answer; a bus may be down.
    let silent: fn(&mut Rig) = |rig| rig.drive.feedback_mut().answer = None;
    // A second is 100 cycles.
    for (change, cycles) in [(refuses, 2..=2), (silent, 101..=102)] {
        let mut rig = linear();
        let mut read = ReadParameter::new(ParameterNumber::Drive(3));
        let mut count = 0;
        let error = loop {
            let shown = rig.cycle(|axis| read.call(true, axis));
            change(&mut rig);
            count += 1;
            if let Err(error) = shown {
                break error;
            }
        };
        assert!(cycles.contains(&count), "{count}");
        assert_eq!((error, error.number()), (SmcError::RpRequestingError, 131));
        let shown = linear().fails(&mut write(1.0), change);
        assert!(!shown.busy);
        assert_eq!(shown.error, Some(SmcError::WpSendingError));
        assert_eq!(shown.error.map(SmcError::number), Some(141));
    }
    let mut rig = linear();
    rig.drive.feedback_mut().communicating = false;
    assert_eq!(rig.call(&mut write(1.0), true).error, Some(SmcError::WpSendingError));
    assert_eq!(rig.call(&mut write(f64::NAN), true).error, Some(SmcError::WpParamInvalid));
}

#[test]
fn limits_with_which_nothing_could_brake_are_refused() {
    let mut rig = linear();
    for number in [1112, 1113, 1122, 1123, 1132, 1133, 1142, 1143, 9, 13, 15, 16] {
        for value in [0.0, -1.0] {
            let written = rig.axis.write_parameter(number, value);
            assert_eq!(written, Err(SmcError::WpParamInvalid), "{number}");
        }
        assert_eq!(rig.axis.write_parameter(number, 50.0), Ok(()));
    }
    assert_eq!(rig.axis.write_parameter(1051, 0.0), Err(SmcError::WpParamInvalid));
    // It brakes with the written value: 10 u/s with 50 u/s² take 0.2 s.
    rig.calls(50, &mut endless(10.0));
    let cycles = rig.until(|axis| axis.set_velocity() == 0.0);
    assert!((20..=22).contains(&cycles), "{cycles}");
}

/// An axis configured without a jerk brakes in errorstop all the same, with constant deceleration.
#[test]
fn without_a_jerk_it_brakes_with_constant_deceleration() {
    let config = AxisConfig { ramp: RampType::Parabolic, jerk: 1000.0, ..AxisConfig::default() };
    let mut rig = Rig::new(config);
    rig.calls(50, &mut endless(10.0));
    rig.axis.values.sw_max_jerk = 0.0;
    let before = rig.axis.set_position();
    rig.until(|axis| axis.set_velocity() == 0.0);
    assert!((rig.axis.set_position() - before - 0.5).abs() < 1e-9, "0.5 u from 10 u/s");
}

#[test]
fn the_largest_torque_is_kept() {
    let mut rig = linear();
    rig.axis.write_parameter(1162, 4.0).expect("fMaxTorque");
    rig.done(&mut SetControllerMode::new(ControllerMode::Torque));
    for (wanted, set) in [(3.0, 3.0), (5.0, 4.0), (-5.0, -4.0)] {
        rig.axis.set_torque(wanted).expect("torque mode");
        assert_eq!(rig.axis.read_parameter(1160), Ok(set));
    }
    rig.axis.write_parameter(1162, 0.0).expect("no limit");
    rig.axis.set_torque(5.0).expect("torque mode");
    assert_eq!(rig.axis.read_parameter(1160), Ok(5.0));
}

/// Set values of this cycle, of the one before, and at the begin of the block.
#[test]
fn what_moves_is_in_the_parameters() {
    let mut rig = linear();
    let read = |rig: &Rig, number: u16| rig.axis.read_parameter(number).expect("a number");
    let mut block = endless(10.0);
    let mut states = Vec::new();
    for _ in 0..30 {
        rig.call(&mut block, true);
        states.push([1100, 1110, 1120].map(|number| read(&rig, number)));
        let cycle = states.len();
        if cycle < 2 {
            continue;
        }
        // fSave…: of the cycle before. The virtual drive is there by now: fAct….
        let [position, velocity, acceleration] = states[cycle - 2];
        assert_eq!(
            [1107, 1117, 1127].map(|number| read(&rig, number)),
            [position, velocity, acceleration]
        );
        assert_eq!([1101, 1111].map(|number| read(&rig, number)), [position, velocity]);
        let jerk = (states[cycle - 1][2] - acceleration) / CYCLE;
        assert!((read(&rig, 1140) - jerk).abs() < 1e-9, "fSetJerk");
    }
    // 100 u/s² for 10 cycles: so the drive did 10 cycles before the last twenty.
    assert_eq!(read(&rig, 1121), 0.0);
    assert_eq!([1106, 1116, 1126].map(|number| read(&rig, number)), [0.0; 3], "fMark…: from rest");
    // A block that brakes from there, with 50 u/s².
    let at = read(&rig, 1100);
    let mut slower = Block::new(MoveVelocity { deceleration: 50.0, ..endless(4.0).inputs });
    rig.call(&mut slower, true);
    assert_eq!([1106, 1116, 1126].map(|number| read(&rig, number)), [at, 10.0, 0.0]);
    assert_eq!(read(&rig, 1146), 0.0);
    assert_eq!((read(&rig, 1120), read(&rig, 1130), read(&rig, 1137)), (-50.0, 50.0, 0.0));
    rig.call(&mut slower, true);
    assert_eq!(read(&rig, 1137), 50.0, "fSaveDeceleration");
    // The drive's velocity has fallen by 0.5 u/s in the cycle before, and did not fall before that.
    assert!((read(&rig, 1121) + 50.0).abs() < 1e-9 && (read(&rig, 1131) - 50.0).abs() < 1e-9);
    assert!((read(&rig, 1141) + 50.0 / CYCLE).abs() < 1e-6, "fActJerk");
    // A block from within that jerk: fMarkJerk.
    rig.call(&mut slower, true);
    rig.call(&mut endless(10.0), true);
    assert_eq!((read(&rig, 1126), read(&rig, 1146)), (-50.0, 0.0));
    rig.call(&mut to(0.0), true);
    assert!((read(&rig, 1146) - 150.0 / CYCLE).abs() < 1e-6, "from −50 to 100 u/s²");
    assert_eq!(read(&rig, 1105), 0.0, "fAimPosition");
}

#[test]
fn what_is_captured_and_how_is_in_the_parameters() {
    let mut rig = linear();
    rig.drive.feedback_mut().current = 1.5;
    let mut trigger = Trigger::of_drive(2);
    let mut probe = TouchProbe::new(Some([3.0, 9.0]));
    rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    let read = |rig: &Rig, number: u16| rig.axis.read_parameter(number).expect("a number");
    let flag = |rig: &Rig, number: u16| rig.axis.read_bool_parameter(number).expect("a BOOL");
    assert_eq!([1220, 1221, 1222].map(|number| read(&rig, number)), [3.0, 9.0, 2.0]);
    assert_eq!([1208, 1223, 1207].map(|number| flag(&rig, number)), [true, true, false]);
    rig.drive.feedback_mut().captured = Some(4.0);
    rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    assert_eq!([1208, 1207].map(|number| flag(&rig, number)), [false, true]);
    assert_eq!(read(&rig, 1202), 4.0);
    assert_eq!((read(&rig, 1151), read(&rig, 1150)), (1.5, 0.0), "nothing sets a current");
    // The drive answers, and the axis is one of the configuration.
    assert_eq!([1012, 1026].map(|number| flag(&rig, number)), [true, true]);
    assert!(!flag(&Rig::new(AxisConfig { real_drive: false, ..AxisConfig::default() }), 1026));
    // The last actual position.
    rig.drive.feedback_mut().position = 6.0;
    rig.power.regulator_on = false;
    rig.cycle(|_| ());
    rig.drive.feedback_mut().position = 8.0;
    rig.cycle(|_| ());
    assert_eq!((read(&rig, 1232), read(&rig, 1101)), (6.0, 8.0));
    assert_eq!(rig.axis.state(), AxisState::PowerOff);
}

/// −1 while fSetVelocity is below 0, else 1 (manual 2.4), also at rest; a motion in the current direction still goes on in
/// the direction of the last one.
#[test]
fn the_direction_is_that_of_the_set_velocity() {
    let mut rig = linear();
    let direction = |rig: &Rig| rig.axis.values.direction;
    assert_eq!(direction(&rig), 1);
    let mut back = to(-5.0);
    let mut seen = [0_u32; 2];
    rig.until(|axis| {
        let shown = back.call(true, axis);
        let expected = if axis.set_velocity() < 0.0 { -1 } else { 1 };
        seen[usize::from(expected > 0)] += 1;
        assert_eq!(axis.values.direction, expected);
        shown.done
    });
    assert!(seen[0] > 20, "{seen:?}");
    assert_eq!((direction(&rig), rig.axis.set_velocity()), (1, 0.0));
    rig.done(&mut endless_in(Direction::Current, 5.0));
    assert_eq!((direction(&rig), rig.axis.set_velocity()), (-1, -5.0));
}

/// `SMC_CONTROLLER_MODE` (manual 2.2.4).
#[test]
fn controller_modes_have_the_manuals_numbers() {
    use ControllerMode::{Current, Position, Torque, Velocity};
    for (number, mode) in (1..).zip([Torque, Velocity, Position, Current]) {
        assert_eq!((mode.number(), ControllerMode::from_number(number)), (number, Some(mode)));
    }
    assert_eq!([0, 5].map(ControllerMode::from_number), [None, None]);
    assert_eq!(ControllerMode::default(), ControllerMode::Position);
}
