//! Parameters, EEPROM, RESET and encoders, through the driver in virtual time.

use super::*;
use crate::Fault;
use crate::{
    Corrections, EncoderBench, EncoderKind, Start,
    protocol::bits::{card, definition, encoder_message, message},
};
use twin_drives::DriveError;

fn axis_1(parameter: AxisParameter) -> Parameter {
    Parameter::Axis(parameter, ModuleAxis::One)
}

#[track_caller]
fn messages(error: &DriveError) -> u32 {
    match error.fault() {
        Some(Fault::CardMessages { messages }) => *messages,
        _ => panic!("{error}"),
    }
}

#[tokio::test(start_paused = true)]
async fn every_parameter_is_written_and_read_back_or_refused() {
    let mut rig = Rig::usual().await;
    let clock = &clock();
    for number in (0..=0x41).chain([0x62, 0x63]) {
        let parameter = Parameter::from_number(number).unwrap();
        let read = rig.driver.parameter(parameter, clock).await.unwrap();
        // 3.1.20: from $38 on they are for maintenance, read-only.
        let written = rig.driver.set_parameter(parameter, read, clock).await;
        if number < 0x38 {
            // What the EEPROM of these tests leaves at 0 is out of range for nothing.
            written.unwrap_or_else(|error| panic!("{number:02X} := {read}: {error}"));
            let back = rig.driver.parameter(parameter, clock).await.unwrap();
            assert_eq!(back, read);
        } else {
            assert_eq!(messages(&written.unwrap_err()), card::BAD_WRITE, "{number:02X}");
        }
    }
    let rating = rig.driver.parameter(Parameter::Rating, clock).await.unwrap();
    let version = rig.driver.parameter(Parameter::Version, clock).await.unwrap();
    assert_eq!((rating, version), (2000, 15));
}

#[tokio::test(start_paused = true)]
async fn refusals_are_those_of_chapter_8_and_fall_with_the_next_correct_operation() {
    let mut rig = Rig::usual().await;
    let clock = &clock();
    let fast = axis_1(AxisParameter::FastSpeed);
    let refused = rig.driver.set_parameter(fast, 0, clock).await.unwrap_err();
    assert_eq!(messages(&refused), card::BAD_WRITE);
    let text = refused.to_string();
    assert!(text.starts_with("/dev/uio0: writing parameter $0A (fast speed): "), "{text}");
    assert_eq!(rig.driver.parameter(fast, clock).await.unwrap(), 10_000, "and the bit is gone");

    let none = axis_1(AxisParameter::Reference(11));
    assert_eq!(messages(&rig.driver.parameter(none, clock).await.unwrap_err()), card::BAD_READ);

    // 8.5: during a move parameters can be read and not written.
    rig.driver.start([None, Some(Start::to(2000))], clock).await.unwrap();
    let moving = rig.driver.set_parameter(fast, 500, clock).await.unwrap_err();
    assert_eq!(messages(&moving), card::MOVING);
    assert_eq!(rig.driver.parameter(fast, clock).await.unwrap(), 10_000);
    rig.driver.rested(seconds(5), clock).await.unwrap();
    rig.driver.set_parameter(fast, 500, clock).await.unwrap();
}

#[test]
fn a_parameter_order_that_does_not_exist_is_told() {
    // 8.6, and the digest: $1000, $2000, $4000 and $8000 exist.
    let options = ModuleOptions { boot_ns: 0, ..ModuleOptions::default() };
    for (order, wrong) in [(0x0000_u16, true), (0x3000, true), (0x0001, true), (0x2000, false)] {
        let mut module = Module::new(&options, &eeprom(), &surroundings());
        module.advance(1);
        let [high, low] = order.to_be_bytes();
        for (offset, byte) in
            [(0xFD, 7), (0x00, 0x32), (0x26, high), (0x27, low), (0x29, 0x0A), (0x01, 1), (0x7F, 1)]
        {
            module.bus_write(offset, byte);
        }
        module.advance(1_000_000);
        module.bus_write(0xFD, 6);
        let bit = u8::try_from(card::BAD_ORDER).unwrap();
        assert_eq!(module.bus_read(0x25), if wrong { bit | 6 } else { 6 }, "{order:04X}");
    }
}

#[tokio::test(start_paused = true)]
async fn parameters_that_need_a_reset_act_after_it_and_others_at_once() {
    let mut rig = Rig::usual().await;
    let clock = &clock();
    rig.driver.set_parameter(axis_1(AxisParameter::FastSpeed), 1000, clock).await.unwrap();
    rig.driver.set_parameter(axis_1(AxisParameter::SoftPlus), 500, clock).await.unwrap();
    rig.driver.start([Some(Start::to(2000)), None], clock).await.unwrap();
    sleep(Duration::from_millis(250)).await;
    // Half a second of ramp leads to 10000; at 1000 it would be at 250.
    assert!(rig.module.module().velocity(ModuleAxis::One) > 5000.0);
    rig.driver.rested(seconds(5), clock).await.unwrap();
    rig.driver.zero(ModuleAxis::One, clock).await.unwrap();
    rig.driver.start([Some(Start::to(700)), None], clock).await.unwrap();
    let (seen, _) = rig.driver.rested(seconds(5), clock).await.unwrap();
    assert_eq!(seen.messages[0] & message::PLUS_LIMIT, message::PLUS_LIMIT);

    assert!(rig.module.module().watchdog());
    rig.driver.reset().await.unwrap();
    let (seen, _) = rig.driver.positions(clock).await.unwrap();
    assert_eq!((seen.positions, seen.messages), ([0; 2], [message::PHASES_OFF; 2]));
    rig.driver.start([Some(Start::to(-2000)), None], clock).await.unwrap();
    sleep(Duration::from_millis(250)).await;
    assert!((rig.module.module().velocity(ModuleAxis::One) + 1000.0).abs() < 1e-6);
    rig.driver.rested(seconds(5), clock).await.unwrap();

    // 7.6: writing the holding current switches the phases on at once.
    rig.driver.reset().await.unwrap();
    rig.driver.set_parameter(axis_1(AxisParameter::HoldingCurrent), 300, clock).await.unwrap();
    let (seen, _) = rig.driver.positions(clock).await.unwrap();
    assert_eq!(seen.messages, [0, message::PHASES_OFF]);
}

#[tokio::test(start_paused = true)]
async fn with_a_wrong_check_sum_only_parameters_can_be_written() {
    let module = Module::new(&ModuleOptions::default(), &Eeprom::blank(), &surroundings());
    let module = SharedModule::new(module, clock());
    let mut driver = Bim2Ax::new("module", module.clone(), &Bim2AxOptions::default());
    sleep(seconds(1)).await;
    let clock = &clock();
    assert!(!module.module().watchdog(), "8.1: the relay has dropped");
    let error = driver.identify(clock).await.unwrap_err();
    assert_eq!(messages(&error), card::CHECKSUM);
    assert!(error.takes_writes_only());
    assert_eq!(driver.identify_any(clock).await.unwrap(), None);
    assert!(driver.start([Some(Start::to(5)), None], clock).await.is_err());
    let fast = axis_1(AxisParameter::FastSpeed);
    assert!(driver.parameter(fast, clock).await.is_err());
    driver.set_parameter(fast, 5000, clock).await.unwrap();
    driver.reset().await.unwrap();
    driver.identify(clock).await.unwrap();
    assert_eq!(driver.parameter(fast, clock).await.unwrap(), 5000);
    assert!(module.module().watchdog());
}

#[tokio::test(start_paused = true)]
async fn the_last_position_is_stored_and_recalled_after_a_brown_out() {
    let mut rig = Rig::usual().await;
    let clock = &clock();
    rig.driver.start([Some(Start::to(123)), Some(Start::to(-77))], clock).await.unwrap();
    rig.driver.rested(seconds(5), clock).await.unwrap();
    rig.module.module().brown_out(0);
    sleep(seconds(1)).await;
    let (seen, _) = rig.driver.positions(clock).await.unwrap();
    assert_eq!(seen.positions, [0, 0]);
    for axis in BOTH {
        rig.driver.recall(axis, clock).await.unwrap();
    }
    let (seen, _) = rig.driver.positions(clock).await.unwrap();
    assert_eq!(seen.positions, [123, -77]);
    assert_eq!(rig.module.module().shaft(ModuleAxis::Two), -77);
}

/// A rig whose first axis has an encoder with the manual's 200 µsteps and 2000 points per turn.
async fn with_encoder(bench: EncoderBench, bits: u16, offset: i64) -> Rig {
    encoded(bench, (bits, offset), &ModuleOptions::default()).await
}

/// The same of a module with these options.
async fn encoded(bench: EncoderBench, (bits, offset): (u16, i64), options: &ModuleOptions) -> Rig {
    let mut eeprom = eeprom();
    for (parameter, value) in [
        (AxisParameter::Dividend, 200),
        (AxisParameter::Divisor, 2000),
        (AxisParameter::EncoderOffset, offset),
        (AxisParameter::EncoderBits, 24),
        (AxisParameter::EncoderDefinition, i64::from(definition::PRESENT | bits)),
    ] {
        set(&mut eeprom, ModuleAxis::One, parameter, value);
    }
    let mut surroundings = surroundings();
    surroundings.encoders[0] = Some(bench);
    Rig::new(options, &Bim2AxOptions::default(), &eeprom, &surroundings).await
}

#[tokio::test(start_paused = true)]
async fn points_and_steps_are_those_of_the_manuals_examples() {
    let mut rig = with_encoder(EncoderBench::default(), 0, 0).await;
    let clock = &clock();
    // 6.4.1: dividend 200, divisor 2000.
    for (steps, points) in [(0x7D0, 0x4E20), (0x578, 0x36B0), (0x708, 0x4650)] {
        rig.driver.start([Some(Start::to(steps)), None], clock).await.unwrap();
        rig.driver.rested(seconds(5), clock).await.unwrap();
        let (found, _) = rig.driver.encoder_points(clock).await.unwrap();
        assert_eq!(found.positions, [points, 0]);
        let (found, _) = rig.driver.encoder_steps(clock).await.unwrap();
        assert_eq!(found.positions, [steps, 0]);
        // There is no plug in either place, and no encoder on axis 2.
        let plug = encoder_message::PLUG;
        assert_eq!(found.messages, [encoder_message::INCREMENTAL | plug, plug]);
    }
}

/// The motor is held for 0.3 s of 1000 µsteps/s: what it has lost then is left as it is by a module that never corrects, and by
/// one that lets so much pass.
#[tokio::test(start_paused = true)]
async fn moves_are_corrected_as_often_and_from_the_difference_on_that_is_assumed() {
    let usual = Corrections::default();
    for (corrections, corrected) in [
        (usual, true),
        (Corrections { most: 1, ..usual }, true),
        (Corrections { most: 0, ..usual }, false),
        (Corrections { tolerance: 1999, ..usual }, false),
    ] {
        let options = ModuleOptions { corrections, ..ModuleOptions::default() };
        let mut rig = encoded(EncoderBench::default(), (0, 0), &options).await;
        let clock = &clock();
        let start = Start { speed: Some(1000), ..Start::to(2000) };
        rig.driver.start([Some(start), None], clock).await.unwrap();
        sleep(Duration::from_millis(500)).await;
        rig.rewire(|surroundings| surroundings.benches[0].stalled = true);
        sleep(Duration::from_millis(300)).await;
        rig.rewire(|surroundings| surroundings.benches[0].stalled = false);
        let (seen, _) = rig.driver.rested(seconds(10), clock).await.unwrap();
        assert_eq!(seen.positions[0], 2000, "{corrections:?}");
        let (found, _) = rig.driver.encoder_steps(clock).await.unwrap();
        let lack = (found.positions[0] - 2000).abs();
        assert_eq!(lack <= 2, corrected, "{corrections:?}: {lack}");
        assert!(corrected || (250..1999).contains(&lack), "{corrections:?}: {lack}");
        let shown = found.messages[0] & encoder_message::CORRECTED != 0;
        assert_eq!(shown, corrected, "{corrections:?}");
        // The message is about the last move.
        rig.driver.start([Some(Start::to(1900)), None], clock).await.unwrap();
        rig.driver.rested(seconds(10), clock).await.unwrap();
        let (found, _) = rig.driver.encoder_steps(clock).await.unwrap();
        let shown = found.messages[0] & encoder_message::CORRECTED != 0;
        assert!(!corrected || !shown, "{corrections:?}");
    }
}

#[tokio::test(start_paused = true)]
async fn absolute_encoders_have_an_offset_which_zeroing_stores() {
    for (kind, bit, gray) in [
        (EncoderKind::EnDat, encoder_message::ENDAT, false),
        (EncoderKind::Ssi, encoder_message::SSI, false),
        (EncoderKind::Ssi, encoder_message::SSI, true),
    ] {
        let bench =
            EncoderBench { kind: Some(kind), origin: 5000, gray, ..EncoderBench::default() };
        let bits = if gray { definition::GRAY } else { 0 };
        let mut rig = with_encoder(bench, bits, -1000).await;
        let clock = &clock();
        // 5000 at the origin and −1000 of offset are 400 µsteps at the start.
        let (seen, _) = rig.driver.positions(clock).await.unwrap();
        assert_eq!(seen.positions[0], 400);
        rig.driver.start([Some(Start::to(100)), None], clock).await.unwrap();
        rig.driver.rested(seconds(5), clock).await.unwrap();
        let (found, _) = rig.driver.encoder_points(clock).await.unwrap();
        assert_eq!((found.positions[0], found.messages[0] & bit), (1000, bit));
        assert_eq!(rig.module.module().shaft(ModuleAxis::One), -300);
        rig.driver.zero(ModuleAxis::One, clock).await.unwrap();
        let (found, _) = rig.driver.encoder_points(clock).await.unwrap();
        assert_eq!(found.positions[0], 0);
        let offset = axis_1(AxisParameter::EncoderOffset);
        let stored = rig.driver.parameter(offset, clock).await.unwrap();
        assert_eq!(stored.cast_signed(), -2000);
        rig.driver.reset().await.unwrap();
        let (found, _) = rig.driver.encoder_points(clock).await.unwrap();
        assert_eq!(found.positions[0], 0, "an absolute encoder knows where it is");
    }
}

#[tokio::test(start_paused = true)]
async fn encoder_faults_are_latched_until_reset() {
    let alarm =
        EncoderBench { kind: Some(EncoderKind::EnDat), alarm: true, ..EncoderBench::default() };
    let mut rig = with_encoder(alarm, 0, 0).await;
    let clock = &clock();
    let (found, _) = rig.driver.encoder_points(clock).await.unwrap();
    assert_eq!(found.messages[0] & encoder_message::ALARM, encoder_message::ALARM);

    // Wires A and B alone where complements are declared, parity that is not sent, a cut cable.
    let single = EncoderBench { complemented: false, ..EncoderBench::default() };
    let ssi = EncoderBench { kind: Some(EncoderKind::Ssi), ..EncoderBench::default() };
    let cut = EncoderBench { disconnected: true, ..EncoderBench::default() };
    for (bench, bits, cured) in
        [(single, 0, definition::SINGLE_ENDED), (ssi, definition::PARITY, 0), (cut, 0, 0)]
    {
        let mut rig = with_encoder(bench, bits, 0).await;
        let faulty = |found: crate::protocol::zone::Positions| {
            found.messages[0] & encoder_message::FAULT != 0
        };
        assert!(faulty(rig.driver.encoder_points(clock).await.unwrap().0), "{bench:?}");
        rig.rewire(|surroundings| {
            surroundings.encoders[0] = Some(EncoderBench { disconnected: false, ..bench });
        });
        assert!(faulty(rig.driver.encoder_points(clock).await.unwrap().0), "latched");
        let definition = u32::from(definition::PRESENT | cured);
        let parameter = axis_1(AxisParameter::EncoderDefinition);
        rig.driver.set_parameter(parameter, definition, clock).await.unwrap();
        rig.driver.reset().await.unwrap();
        assert!(!faulty(rig.driver.encoder_points(clock).await.unwrap().0), "{bench:?}");
    }
}

#[tokio::test(start_paused = true)]
async fn incremental_encoders_reload_what_their_definition_says() {
    // 3.1.19.9, with 300 µsteps and, after a slip of 20 that the encoder alone has seen, 3200 points stored.
    for (bits, motor, points) in [
        (0x0000, 0, 0),
        (0x2000, 300, 0),
        (0x1000, 0, 3200),
        (0x3000, 320, 3200),
        (0x0800, 300, 3000),
        (0x2800, 300, 3200),
    ] {
        let mut eeprom = eeprom();
        for (parameter, value) in [
            (AxisParameter::Dividend, 200),
            (AxisParameter::Divisor, 2000),
            (AxisParameter::EncoderDefinition, i64::from(definition::PRESENT | bits)),
            (AxisParameter::LastPosition, 300),
            (AxisParameter::LastEncoderPosition, 3200),
        ] {
            set(&mut eeprom, ModuleAxis::One, parameter, value);
        }
        let mut surroundings = surroundings();
        surroundings.encoders[0] = Some(EncoderBench::default());
        let options = ModuleOptions::default();
        let mut rig = Rig::new(&options, &Bim2AxOptions::default(), &eeprom, &surroundings).await;
        let (seen, _) = rig.driver.positions(&clock()).await.unwrap();
        let (found, _) = rig.driver.encoder_points(&clock()).await.unwrap();
        assert_eq!((seen.positions[0], found.positions[0]), (motor, points), "{bits:04X}");
    }
}

#[tokio::test(start_paused = true)]
async fn currents_are_those_of_the_parameters_and_act_after_reset() {
    let mut rig = Rig::usual().await;
    let clock = &clock();
    let one = ModuleAxis::One;
    let current = |rig: &Rig| rig.module.module().current_ma(one);
    let test_current = |rig: &Rig| rig.module.module().test_current_ma(one);
    assert_eq!(current(&rig), 0, "phases are off");
    for (parameter, value) in [
        (AxisParameter::MotorCurrent, 1200),
        (AxisParameter::HoldingCurrent, 1500),
        (AxisParameter::Coefficient, 0xD011),
    ] {
        rig.driver.set_parameter(axis_1(parameter), value, clock).await.unwrap();
    }
    // As set up: a quarter of the rating of 2000 mA; writing has switched the phases on.
    assert_eq!((current(&rig), test_current(&rig)), (500, 500));
    rig.driver.reset().await.unwrap();
    rig.driver.set_phases(&[one], true, clock).await.unwrap();
    // 3.1.4: the holding current is limited by the motor current.
    assert_eq!((current(&rig), test_current(&rig)), (1200, 60));
    rig.driver.set_parameter(axis_1(AxisParameter::HoldingCurrent), 200, clock).await.unwrap();
    rig.driver.reset().await.unwrap();
    rig.driver.start([Some(Start::to(500)), None], clock).await.unwrap();
    assert_eq!(current(&rig), 1200);
    rig.driver.rested(seconds(5), clock).await.unwrap();
    assert_eq!(current(&rig), 200);
}

#[tokio::test(start_paused = true)]
async fn an_inverted_encoder_is_turned_round_and_a_divisor_of_0_is_told() {
    for (inverted, bits, points) in [
        (false, 0, 1000),
        (true, 0, -1000),
        (false, definition::INVERT, -1000),
        (true, definition::INVERT, 1000),
    ] {
        let mut rig =
            with_encoder(EncoderBench { inverted, ..EncoderBench::default() }, bits, 0).await;
        let clock = &clock();
        // A manual move is not corrected.
        rig.manual([0x10, 0]).await;
        sleep(Duration::from_millis(100)).await;
        rig.manual([0, 0]).await;
        let (seen, _) = rig.driver.positions(clock).await.unwrap();
        let (found, _) = rig.driver.encoder_points(clock).await.unwrap();
        // 2000 points and 200 µsteps per turn.
        assert!(seen.positions[0] >= 100);
        assert_eq!(found.positions[0], points / 100 * seen.positions[0], "{inverted} {bits:X}");
    }
    let mut eeprom = eeprom();
    set(&mut eeprom, ModuleAxis::One, AxisParameter::Divisor, 0);
    set(&mut eeprom, ModuleAxis::One, AxisParameter::EncoderDefinition, 1);
    let mut surroundings = surroundings();
    surroundings.encoders[0] = Some(EncoderBench::default());
    let options = ModuleOptions::default();
    let mut rig = Rig::new(&options, &Bim2AxOptions::default(), &eeprom, &surroundings).await;
    let (found, _) = rig.driver.encoder_steps(&clock()).await.unwrap();
    assert_eq!(found.messages[0] & encoder_message::DIVISOR_ZERO, encoder_message::DIVISOR_ZERO);
    let divisor = axis_1(AxisParameter::Divisor);
    rig.driver.set_parameter(divisor, 2000, &clock()).await.unwrap();
    rig.driver.reset().await.unwrap();
    let (found, _) = rig.driver.encoder_steps(&clock()).await.unwrap();
    assert_eq!(found.messages[0] & encoder_message::DIVISOR_ZERO, 0);
}

#[tokio::test(start_paused = true)]
async fn the_crc_of_an_axis_changes_with_its_own_parameters_only() {
    let mut rig = Rig::usual().await;
    let clock = &clock();
    let crc = |axis| Parameter::Axis(AxisParameter::ParameterCrc, axis);
    let mut before = [0; 2];
    for (before, axis) in before.iter_mut().zip(BOTH) {
        *before = rig.driver.parameter(crc(axis), clock).await.unwrap();
    }
    rig.driver.set_parameter(axis_1(AxisParameter::Reference(7)), 9, clock).await.unwrap();
    let one = rig.driver.parameter(crc(ModuleAxis::One), clock).await.unwrap();
    let two = rig.driver.parameter(crc(ModuleAxis::Two), clock).await.unwrap();
    assert!(one != before[0] && two == before[1] && one <= 0xFFFF);
    // A move stores its end, which is no parameter of the axis.
    rig.driver.start([Some(Start::to(5)), None], clock).await.unwrap();
    rig.driver.rested(seconds(5), clock).await.unwrap();
    assert_eq!(rig.driver.parameter(crc(ModuleAxis::One), clock).await.unwrap(), one);
}

#[tokio::test(start_paused = true)]
async fn a_gray_encoder_read_as_binary_is_somewhere_else() {
    let bench =
        EncoderBench { kind: Some(EncoderKind::Ssi), gray: true, ..EncoderBench::default() };
    for (bits, origin, points) in
        [(definition::GRAY, 5, 5), (0, 5, 7), (0, 4, 6), (definition::GRAY, 4, 4)]
    {
        // In Gray code 5 is 111 and 4 is 110.
        let mut rig = with_encoder(EncoderBench { origin, ..bench }, bits, 0).await;
        let (found, _) = rig.driver.encoder_points(&clock()).await.unwrap();
        assert_eq!(found.positions[0], points);
    }
}
