//! Parameters, EEPROM, RESET and encoders, through the driver in virtual time.

use super::*;
use crate::Fault;
use crate::{
    Corrections, EncoderBench, EncoderKind,
    protocol::bits::{card, definition, encoder_message, message},
};
use twin_drives::DriveError;

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
        let read = rig.get(parameter).await;
        // 3.1.20: from $38 on they are for maintenance, read-only.
        let written = rig.driver.set_parameter(parameter, read, clock).await;
        if number < 0x38 {
            // What the EEPROM of these tests leaves at 0 is out of range for nothing.
            written.unwrap_or_else(|error| panic!("{number:02X} := {read}: {error}"));
            assert_eq!(rig.get(parameter).await, read);
        } else {
            assert_eq!(messages(&written.unwrap_err()), card::BAD_WRITE, "{number:02X}");
        }
    }
    assert_eq!(rig.get(Parameter::Rating).await, 2000);
    assert_eq!(rig.get(Parameter::Version).await, 15);
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
    assert_eq!(rig.get(fast).await, 10_000, "and the bit is gone");

    let none = axis_1(AxisParameter::Reference(11));
    assert_eq!(messages(&rig.driver.parameter(none, clock).await.unwrap_err()), card::BAD_READ);

    // 8.5: during a move parameters can be read and not written.
    rig.start([None, Some(2000)]).await;
    let moving = rig.driver.set_parameter(fast, 500, clock).await.unwrap_err();
    assert_eq!(messages(&moving), card::MOVING);
    assert_eq!(rig.get(fast).await, 10_000);
    rig.rest().await;
    rig.set(AxisParameter::FastSpeed, 500).await;
}

#[test]
fn a_parameter_order_that_does_not_exist_is_told() {
    // 8.6, and the digest: $1000, $2000, $4000 and $8000 exist.
    let options = ModuleOptions { boot_ns: 0, ..ModuleOptions::default() };
    for (order, wrong) in [(0x0000_u16, true), (0x3000, true), (0x0001, true), (0x2000, false)] {
        let mut module = Module::new(&options, &eeprom(), &surroundings());
        module.advance(1);
        let [high, low] = order.to_be_bytes();
        write(&mut module, &[(0xFD, 7), (0x00, 0x32), (0x26, high), (0x27, low)]);
        write(&mut module, &[(0x29, 0x0A), (0x01, 1), (0x7F, 1)]);
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
    rig.set(AxisParameter::FastSpeed, 1000).await;
    rig.set(AxisParameter::SoftPlus, 500).await;
    rig.start([Some(2000), None]).await;
    sleep(Duration::from_millis(250)).await;
    // Half a second of ramp leads to 10000; at 1000 it would be at 250.
    assert!(rig.module.module().velocity(ModuleAxis::One) > 5000.0);
    rig.rest().await;
    rig.driver.zero(ModuleAxis::One, clock).await.unwrap();
    let seen = rig.go([Some(700), None]).await;
    assert_eq!(seen.messages[0] & message::PLUS_LIMIT, message::PLUS_LIMIT);

    assert!(rig.module.module().watchdog());
    rig.driver.reset().await.unwrap();
    let seen = rig.seen().await;
    assert_eq!((seen.positions, seen.messages), ([0; 2], [message::PHASES_OFF; 2]));
    rig.start([Some(-2000), None]).await;
    sleep(Duration::from_millis(250)).await;
    assert!((rig.module.module().velocity(ModuleAxis::One) + 1000.0).abs() < 1e-6);
    rig.rest().await;

    // 7.6: writing the holding current switches the phases on at once.
    rig.driver.reset().await.unwrap();
    rig.set(AxisParameter::HoldingCurrent, 300).await;
    assert_eq!(rig.seen().await.messages, [0, message::PHASES_OFF]);
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
    rig.go([Some(123), Some(-77)]).await;
    rig.module.module().brown_out(0);
    sleep(seconds(1)).await;
    assert_eq!(rig.seen().await.positions, [0, 0]);
    for axis in BOTH {
        rig.driver.recall(axis, clock).await.unwrap();
    }
    assert_eq!(rig.seen().await.positions, [123, -77]);
    assert_eq!(rig.module.module().shaft(ModuleAxis::Two), -77);
}

/// A rig whose first axis has an encoder with the manual's 200 µsteps and 2000 points per turn, but for `changed`
/// parameters.
async fn encoded(
    bench: EncoderBench,
    changed: &[(AxisParameter, i64)],
    options: &ModuleOptions,
) -> Rig {
    let mut eeprom = eeprom();
    let usual = [
        (AxisParameter::Dividend, 200),
        (AxisParameter::Divisor, 2000),
        (AxisParameter::EncoderBits, 24),
        (AxisParameter::EncoderDefinition, definition::PRESENT.into()),
    ];
    for (parameter, value) in usual.iter().chain(changed) {
        set(&mut eeprom, ModuleAxis::One, *parameter, *value);
    }
    let mut surroundings = surroundings();
    surroundings.encoders[0] = Some(bench);
    Rig::new(options, &Bim2AxOptions::default(), &eeprom, &surroundings).await
}

/// The same of the usual module, with bits in the definition of the encoder.
async fn with_encoder(bench: EncoderBench, bits: u16) -> Rig {
    let bits = i64::from(definition::PRESENT | bits);
    let definition = [(AxisParameter::EncoderDefinition, bits)];
    encoded(bench, &definition, &ModuleOptions::default()).await
}

#[tokio::test(start_paused = true)]
async fn points_and_steps_are_those_of_the_manuals_examples() {
    let mut rig = with_encoder(EncoderBench::default(), 0).await;
    // 6.4.1: dividend 200, divisor 2000.
    for (steps, points) in [(0x7D0, 0x4E20), (0x578, 0x36B0), (0x708, 0x4650)] {
        rig.go([Some(steps), None]).await;
        assert_eq!(rig.points().await.positions, [points, 0]);
        let found = rig.steps().await;
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
        let mut rig = encoded(EncoderBench::default(), &[], &options).await;
        let start = Start { speed: Some(1000), ..Start::to(2000) };
        rig.driver.start([Some(start), None], &clock()).await.unwrap();
        sleep(Duration::from_millis(500)).await;
        rig.rewire(|surroundings| surroundings.benches[0].stalled = true);
        sleep(Duration::from_millis(300)).await;
        rig.rewire(|surroundings| surroundings.benches[0].stalled = false);
        assert_eq!(rig.rest().await.positions[0], 2000, "{corrections:?}");
        let found = rig.steps().await;
        let lack = (found.positions[0] - 2000).abs();
        assert_eq!(lack <= 2, corrected, "{corrections:?}: {lack}");
        assert!(corrected || (250..1999).contains(&lack), "{corrections:?}: {lack}");
        let shown = found.messages[0] & encoder_message::CORRECTED != 0;
        assert_eq!(shown, corrected, "{corrections:?}");
        // The message is about the last move.
        rig.go([Some(1900), None]).await;
        let shown = rig.steps().await.messages[0] & encoder_message::CORRECTED != 0;
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
        let bits = definition::PRESENT | if gray { definition::GRAY } else { 0 };
        let offset = AxisParameter::EncoderOffset;
        let changed = [(offset, -1000), (AxisParameter::EncoderDefinition, bits.into())];
        let mut rig = encoded(bench, &changed, &ModuleOptions::default()).await;
        // 5000 at the origin and −1000 of offset are 400 µsteps at the start.
        assert_eq!(rig.seen().await.positions[0], 400);
        rig.go([Some(100), None]).await;
        let found = rig.points().await;
        assert_eq!((found.positions[0], found.messages[0] & bit), (1000, bit));
        assert_eq!(rig.module.module().shaft(ModuleAxis::One), -300);
        rig.driver.zero(ModuleAxis::One, &clock()).await.unwrap();
        assert_eq!(rig.points().await.positions[0], 0);
        assert_eq!(rig.get(axis_1(offset)).await.cast_signed(), -2000);
        rig.driver.reset().await.unwrap();
        assert_eq!(rig.points().await.positions[0], 0, "an absolute encoder knows where it is");
    }
}

#[tokio::test(start_paused = true)]
async fn encoder_faults_are_latched_until_reset() {
    let usual = EncoderBench::default();
    let alarm = EncoderBench { kind: Some(EncoderKind::EnDat), alarm: true, ..usual };
    let found = with_encoder(alarm, 0).await.points().await;
    assert_eq!(found.messages[0] & encoder_message::ALARM, encoder_message::ALARM);

    // Wires A and B alone where complements are declared, parity that is not sent, a cut cable.
    for (bench, bits, cured) in [
        (EncoderBench { complemented: false, ..usual }, 0, definition::SINGLE_ENDED),
        (EncoderBench { kind: Some(EncoderKind::Ssi), ..usual }, definition::PARITY, 0),
        (EncoderBench { disconnected: true, ..usual }, 0, 0),
    ] {
        let mut rig = with_encoder(bench, bits).await;
        let faulty = |found: Positions| found.messages[0] & encoder_message::FAULT != 0;
        assert!(faulty(rig.points().await), "{bench:?}");
        rig.rewire(|surroundings| {
            surroundings.encoders[0] = Some(EncoderBench { disconnected: false, ..bench });
        });
        assert!(faulty(rig.points().await), "latched");
        rig.set(AxisParameter::EncoderDefinition, (definition::PRESENT | cured).into()).await;
        rig.driver.reset().await.unwrap();
        assert!(!faulty(rig.points().await), "{bench:?}");
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
        let changed = [
            (AxisParameter::EncoderDefinition, i64::from(definition::PRESENT | bits)),
            (AxisParameter::LastPosition, 300),
            (AxisParameter::LastEncoderPosition, 3200),
        ];
        let options = ModuleOptions::default();
        let mut rig = encoded(EncoderBench::default(), &changed, &options).await;
        let (seen, found) = (rig.seen().await, rig.points().await);
        assert_eq!((seen.positions[0], found.positions[0]), (motor, points), "{bits:04X}");
    }
}

#[tokio::test(start_paused = true)]
async fn currents_are_those_of_the_parameters_and_act_after_reset() {
    let mut rig = Rig::usual().await;
    let one = ModuleAxis::One;
    let current = |rig: &Rig| rig.module.module().current_ma(one);
    let test_current = |rig: &Rig| rig.module.module().test_current_ma(one);
    assert_eq!(current(&rig), 0, "phases are off");
    rig.set(AxisParameter::MotorCurrent, 1200).await;
    rig.set(AxisParameter::HoldingCurrent, 1500).await;
    rig.set(AxisParameter::Coefficient, 0xD011).await;
    // As set up: a quarter of the rating of 2000 mA; writing has switched the phases on.
    assert_eq!((current(&rig), test_current(&rig)), (500, 500));
    rig.driver.reset().await.unwrap();
    rig.driver.set_phases(&[one], true, &clock()).await.unwrap();
    // 3.1.4: the holding current is limited by the motor current.
    assert_eq!((current(&rig), test_current(&rig)), (1200, 60));
    rig.set(AxisParameter::HoldingCurrent, 200).await;
    rig.driver.reset().await.unwrap();
    rig.start([Some(500), None]).await;
    assert_eq!(current(&rig), 1200);
    rig.rest().await;
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
            with_encoder(EncoderBench { inverted, ..EncoderBench::default() }, bits).await;
        // A manual move is not corrected.
        rig.manual([0x10, 0]).await;
        sleep(Duration::from_millis(100)).await;
        rig.manual([0, 0]).await;
        let (seen, found) = (rig.seen().await, rig.points().await);
        // 2000 points and 200 µsteps per turn.
        assert!(seen.positions[0] >= 100);
        assert_eq!(found.positions[0], points / 100 * seen.positions[0], "{inverted} {bits:X}");
    }
    let no_divisor = [(AxisParameter::Divisor, 0)];
    let mut rig = encoded(EncoderBench::default(), &no_divisor, &ModuleOptions::default()).await;
    let messages =
        async |rig: &mut Rig| rig.steps().await.messages[0] & encoder_message::DIVISOR_ZERO;
    assert_eq!(messages(&mut rig).await, encoder_message::DIVISOR_ZERO);
    rig.set(AxisParameter::Divisor, 2000).await;
    rig.driver.reset().await.unwrap();
    assert_eq!(messages(&mut rig).await, 0);
    // The quotient cannot be computed, whether an encoder is there or not (2.2.4).
    let neither = [no_divisor[0], (AxisParameter::EncoderDefinition, 0)];
    let mut rig = encoded(EncoderBench::default(), &neither, &ModuleOptions::default()).await;
    assert_eq!(messages(&mut rig).await, encoder_message::DIVISOR_ZERO);
}

#[tokio::test(start_paused = true)]
async fn the_crc_of_an_axis_changes_with_its_own_parameters_only() {
    let mut rig = Rig::usual().await;
    let crc = |axis| Parameter::Axis(AxisParameter::ParameterCrc, axis);
    let [one, two] = BOTH.map(crc);
    let before = [rig.get(one).await, rig.get(two).await];
    rig.set(AxisParameter::Reference(7), 9).await;
    let after = [rig.get(one).await, rig.get(two).await];
    assert!(after[0] != before[0] && after[1] == before[1] && after[0] <= 0xFFFF);
    // A move stores its end, which is no parameter of the axis.
    rig.go([Some(5), None]).await;
    assert_eq!(rig.get(one).await, after[0]);
}

#[tokio::test(start_paused = true)]
async fn a_gray_encoder_read_as_binary_is_somewhere_else() {
    let bench =
        EncoderBench { kind: Some(EncoderKind::Ssi), gray: true, ..EncoderBench::default() };
    for (bits, origin, points) in
        [(definition::GRAY, 5, 5), (0, 5, 7), (0, 4, 6), (definition::GRAY, 4, 4)]
    {
        // In Gray code 5 is 111 and 4 is 110.
        let mut rig = with_encoder(EncoderBench { origin, ..bench }, bits).await;
        assert_eq!(rig.points().await.positions[0], points);
    }
}
