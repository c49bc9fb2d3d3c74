//! EEPROM, power failures, what locking does to outputs, and assumptions that can be chosen otherwise.

use super::*;

/// Reads parameter 4, the default acceleration.
const PARAMETER_4: &str = "01 03 11 08 00 02";

#[test]
fn a_write_to_the_eeprom_takes_its_time_and_survives() {
    let mut board = unlocked();
    assert!(!board.status().has(Status::EEPROM_BUSY));
    set_parameter(&mut board, parameters::DEFAULT_ACCELERATION, 77);
    assert!(board.status().has(Status::EEPROM_BUSY));
    // Two registers, 5 ms each.
    board.advance(9 * MS);
    assert!(board.status().has(Status::EEPROM_BUSY));
    board.advance(2 * MS);
    assert!(!board.status().has(Status::EEPROM_BUSY | Status::EEPROM_ERROR));
    assert_eq!(board.eeprom_generation(), 1);
    // User memory and recipes too; RAM does not.
    for request in ["01 06 14 00 BE EF", "01 06 16 05 12 34", "01 06 10 36 AB CD"] {
        assert_eq!(refusal(&mut board, request), None);
    }
    board.advance(100 * MS);
    let mut again = Board::with_eeprom(&BoardOptions::default(), &board.eeprom()).unwrap();
    for (read, expected) in [
        (PARAMETER_4, "01 03 04 00 00 00 4D"),
        ("01 03 14 00 00 01", "01 03 02 BE EF"),
        ("01 03 16 05 00 01", "01 03 02 12 34"),
        ("01 03 10 36 00 01", "01 03 02 00 00"),
    ] {
        answers(&mut again, read, expected);
    }
}

#[test]
fn what_is_being_written_when_the_supply_fails_is_lost() {
    let mut board = unlocked();
    set_parameter(&mut board, parameters::DEFAULT_ACCELERATION, 77);
    board.advance(5 * MS);
    board.brown_out(0);
    answers(&mut board, PARAMETER_4, "01 03 04 00 00 00 32");
    assert!(!board.status().has(Status::EEPROM_BUSY));
}

#[test]
fn a_broken_eeprom_says_so_in_b15_and_by_exception_4() {
    for refuses in [true, false] {
        let assumptions = Assumptions { eeprom_refuses: refuses, ..Assumptions::default() };
        let mut board = assumed(assumptions);
        board.set_eeprom_broken(true);
        let code = refusal(&mut board, "01 10 11 08 00 02 04 00 00 00 4D");
        assert_eq!(code, refuses.then_some(4));
        assert!(board.status().has(Status::EEPROM_BUSY));
        board.advance(20 * MS);
        assert!(board.status().has(Status::EEPROM_ERROR) && board.eeprom_generation() == 0);
        // RAM has it, the EEPROM has not.
        answers(&mut board, PARAMETER_4, "01 03 04 00 00 00 4D");
        // A write that succeeds clears it.
        board.set_eeprom_broken(false);
        assert_eq!(refusal(&mut board, "01 10 11 08 00 02 04 00 00 00 4D"), None);
        board.advance(20 * MS);
        assert!(!board.status().has(Status::EEPROM_ERROR));
    }
}

#[test]
fn images_that_are_none_are_refused() {
    let options = BoardOptions::default();
    let image = Board::new(&options).eeprom();
    assert_eq!(Board::with_eeprom(&options, &[]).err(), Some(BadImage::Kind));
    assert_eq!(Board::with_eeprom(&options, b"something else").err(), Some(BadImage::Kind));
    let expected = image.len();
    for wrong in [&image[..expected - 1], &[image.as_slice(), &[0]].concat()] {
        let bad = BadImage::Length { expected, found: wrong.len() };
        assert_eq!(Board::with_eeprom(&options, wrong).err(), Some(bad));
    }
}

#[test]
fn a_power_failure_in_a_move_loses_the_counters_and_locks() {
    let mut board = on_bench(vec![switch(5, BoardAxis::X, 500, 900_000)]);
    send(&mut board, go(BoardAxis::X, 100_000));
    board.handle(&vector(24)).unwrap();
    assert_eq!(refusal(&mut board, "01 05 01 40 FF 00"), None);
    board.advance(1000 * MS);
    let place = board.mechanical(BoardAxis::X).round();
    assert!(place > 1000.0);
    board.brown_out(300 * MS);
    // Without supply it says nothing.
    board.advance(299 * MS);
    assert_eq!(board.handle(&vector(20)), None);
    board.advance(MS);
    let status = board.status();
    assert!(status.locked() && status.moving().is_empty() && status.has(Status::BUFFER_EMPTY));
    assert_eq!((board.counters(), board.outputs(), board.inputs()), ([0; 5], 0, 1 << 4));
    answers(&mut board, "01 01 01 40 00 01", "01 01 01 00");
    // The mechanics are where they were, on a whole step.
    same(board.mechanical(BoardAxis::X), place);
    board.handle(&vector(1)).unwrap();
    send_for(&mut board, go(BoardAxis::X, 500), 5000);
    same(board.mechanical(BoardAxis::X), place + 500.0);
}

#[test]
fn the_line_parameters_count_from_the_next_start_on() {
    let mut board = unlocked();
    set_parameter(&mut board, parameters::MODBUS_ADDRESS, 9);
    set_parameter(&mut board, parameters::MODBUS_SPEED, 19_200);
    set_parameter(&mut board, parameters::MODBUS_PARITY, 1);
    board.advance(1000 * MS);
    assert!(board.handle(&vector(20)).is_some());
    board.brown_out(0);
    assert_eq!(board.handle(&vector(20)), None);
    assert!(board.handle(&seal(bytes("09 04 04 00 00 0C"))).is_some());
    assert_eq!(board.line(), Line { baud: 19_200, parity: crate::Parity::Even });

    let mut board = assumed(Assumptions { line_at_restart: false, ..Assumptions::default() });
    let mut frame = bytes("01 10 11 CE 00 02 04 00 00 00 09");
    assert!(board.handle(&seal(frame.clone())).is_some());
    frame[0] = 9;
    assert!(board.handle(&seal(frame)).is_some());
}

#[test]
fn locking_and_unlocking_switch_the_outputs_of_their_parameters() {
    let mut board = unlocked();
    for (number, value) in [
        (parameters::SET_WHEN_UNLOCKED, 0b0001),
        (parameters::RESET_WHEN_UNLOCKED, 0b0010),
        (parameters::SET_WHEN_LOCKED, 0b0010),
        (parameters::RESET_WHEN_LOCKED, 0b0001),
        (parameters::OUTPUTS_AT_START, 0b1000),
        (parameters::ANALOG_LOCKED, 200),
        (parameters::ANALOG_LOCKED + 1, 5000),
    ] {
        set_parameter(&mut board, number, value);
    }
    assert_eq!(refusal(&mut board, "01 10 10 32 00 02 04 00 64 03 FF"), None);
    assert_eq!(board.analog_outputs(), [100, 1023]);
    board.handle(&vector(18)).unwrap();
    assert_eq!((board.outputs(), board.analog_outputs()), (0b0010, [200, 1023]));
    // Locked, they keep these values.
    assert_eq!(refusal(&mut board, "01 06 10 32 00 07"), None);
    assert_eq!(board.analog_outputs(), [200, 1023]);
    board.handle(&vector(1)).unwrap();
    assert_eq!(board.outputs(), 0b0001);
    board.advance(1000 * MS);
    board.brown_out(0);
    assert_eq!((board.outputs(), board.analog_outputs()), (0b1000, [200, 1023]));
}

#[test]
fn the_emergency_stop_input_acts_like_enable() {
    let mut board = unlocked();
    set_parameter(&mut board, parameters::EMERGENCY_STOP_INPUT, 6);
    set_parameter(&mut board, parameters::SPECIAL_POLARITY, 0);
    send_for(&mut board, go(BoardAxis::X, 100_000), 500);
    board.set_input(6, true);
    board.advance(99 * MS);
    assert!(!board.status().enable_open());
    board.advance(2 * MS);
    assert!(board.status().enable_open() && board.status().locked());
    assert!(board.status().moving().is_empty());
    board.set_input(6, false);
    assert!(!board.status().enable_open() && board.status().locked());
    board.handle(&vector(1)).unwrap();
    assert!(!board.status().locked());
    // A normally closed one is pressed while it reads 0.
    set_parameter(&mut board, parameters::SPECIAL_POLARITY, 1);
    board.advance(101 * MS);
    assert!(board.status().enable_open());
}

#[test]
fn a_status_that_is_stuck_says_what_it_said() {
    let mut board = unlocked();
    send(&mut board, go(BoardAxis::X, 100_000));
    board.set_stuck_status(true);
    let before = board.handle(&seal(bytes("01 04 04 00 00 02")));
    board.advance(60_000 * MS);
    assert!(board.status().moving().is_empty());
    assert_eq!(board.handle(&seal(bytes("01 04 04 00 00 02"))), before);
    board.set_stuck_status(false);
    assert_ne!(board.handle(&seal(bytes("01 04 04 00 00 02"))), before);
}

#[test]
fn assumptions_can_be_others() {
    let usual = Assumptions::default();
    // Absent arguments are 0: command 80 without target goes to 0.
    let mut board = assumed(Assumptions { arguments_stay: false, ..usual });
    board.handle(&vector(11)).unwrap();
    board.advance(20_000 * MS);
    assert_eq!(write(&mut board, &[80, 1, 200, 50, 0, 20_000, 40]), None);
    board.advance(20_000 * MS);
    assert_eq!(board.counters()[0], 0);
    // The lock coil reads 1 when unlocked.
    let mut board = assumed(Assumptions { lock_coil: false, ..usual });
    assert_eq!(board.handle(&vector(26)), Some(seal(bytes("01 01 01 01"))));
    board.handle(&seal(bytes("01 05 01 20 00 00"))).unwrap();
    assert!(board.status().locked());
    // Broadcasts are ignored.
    let mut board = assumed(Assumptions { broadcasts: false, ..usual });
    assert_eq!(board.handle(&seal(bytes("00 05 01 00 FF 00"))), None);
    assert_eq!(board.outputs(), 0);
    // A locked board refuses motion and outputs, and nothing else.
    let mut board = assumed(Assumptions { locked_exception: Some(6), ..usual });
    board.handle(&vector(18)).unwrap();
    assert_eq!(write(&mut board, &go(BoardAxis::X, 5).registers()), Some(6));
    assert_eq!(refusal(&mut board, "01 05 01 00 FF 00"), Some(6));
    assert_eq!(refusal(&mut board, "01 06 10 35 00 01"), Some(6));
    assert_eq!(refusal(&mut board, "01 05 01 40 FF 00"), None);
    assert_eq!(board.handle(&vector(1)), Some(vector(2)));
    // ENABLE is lost with a ramp.
    let mut board = assumed(Assumptions { enable_loss: BoardStop::OnRamp, ..usual });
    send_for(&mut board, go(BoardAxis::X, 100_000), 1000);
    board.set_enable(false);
    board.advance(101 * MS);
    assert!(board.status().locked() && !board.status().moving().is_empty());
    // Segments that wait are kept over the loss of ENABLE.
    for (keeps, end) in [(false, 0), (true, 7000)] {
        let mut board = assumed(Assumptions { enable_loss_keeps_segments: keeps, ..usual });
        for target in [100_000, 7000] {
            send(&mut board, segment_of_x(5000, target));
        }
        board.advance(1000 * MS);
        board.set_enable(false);
        board.advance(1000 * MS);
        let stands = board.counters()[0];
        board.set_enable(true);
        board.advance(1000 * MS);
        assert_eq!((board.counters()[0], board.status().locked()), (stands, true));
        assert_eq!(board.status().has(Status::BUFFER_EMPTY), !keeps);
        board.handle(&vector(1)).unwrap();
        board.advance(10_000 * MS);
        assert_eq!(board.counters()[0], if keeps { end } else { stands });
    }
    // Codes of one's own.
    let mut board = assumed(Assumptions {
        exceptions_address: 11,
        exceptions_value: 12,
        exceptions_failure: 13,
        buffer_segments: 0,
        ..usual
    });
    assert_eq!(refusal(&mut board, "01 06 19 ED 00 01"), Some(11));
    assert_eq!(write(&mut board, &[5]), Some(12));
    assert_eq!(write(&mut board, &[6, 1, 0, 5000, 0, 9]), Some(13));
    // Shorter frames.
    let mut board = assumed(Assumptions { most_read: 10, most_written: 8, ..usual });
    assert_eq!(refusal(&mut board, "01 04 04 00 00 0B"), Some(3));
    assert_eq!(refusal(&mut board, "01 03 10 36 00 0B"), Some(3));
    assert_eq!(refusal(&mut board, "01 03 10 36 00 0A"), None);
    assert_eq!(write(&mut board, &[42, 0, 0, 0, 0, 0, 0, 0, 0]), Some(3));
    // Firmware before 5.31: no axis moves at the instant of reversal.
    let mut board = assumed(Assumptions { reversal_gap_ns: MS, ..usual });
    board.handle(&vector(11)).unwrap();
    board.advance(1000 * MS);
    board.handle(&vector(12)).unwrap();
    // 20000 to 200 Hz with 40 kHz/s.
    board.advance(494 * MS);
    assert!(!board.status().independent().is_empty());
    board.advance(MS + MS / 2);
    assert!(board.status().independent().is_empty());
    board.advance(MS);
    assert!(!board.status().independent().is_empty());
}
