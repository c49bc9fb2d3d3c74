//! The digest's vectors, by number.

use super::*;

#[test]
fn vectors_7_to_10_write_counters_and_change_speed() {
    let mut board = unlocked();
    board.handle(&vector(7)).unwrap();
    assert_eq!(board.counters(), [1000, 0, 0, 0, 0]);
    send(&mut board, Command::WritePosition { positions: [Some(5), None, Some(7), None, None] });
    board.handle(&vector(8)).unwrap();
    assert_eq!(board.counters(), [1000, 0, 0, 0, 0]);
    // The example of command 96 as printed sets the counter instead.
    board.handle(&vector(10)).unwrap();
    assert_eq!(board.counters()[0], 10_000);

    board.handle(&vector(11)).unwrap();
    board.advance(1000 * MS);
    same(board.velocity(BoardAxis::X), 20_000.0);
    board.handle(&vector(9)).unwrap();
    board.advance(1000 * MS);
    same(board.velocity(BoardAxis::X), 10_000.0);
    board.advance(20_000 * MS);
    assert_eq!(board.counters()[0], 100_000);
}

#[test]
fn vectors_11_and_12_move_and_retarget_in_flight() {
    let mut board = unlocked();
    board.handle(&vector(11)).unwrap();
    // Closed form of the trapezoid: 200 Hz → 20 kHz at 50 kHz/s, then cruise.
    board.advance(396 * MS);
    same(x(&board), (10_100.0_f64 * 0.396).round());
    board.advance(1000 * MS);
    same(x(&board), (10_100.0_f64 * 0.396 + 20_000.0).round());
    assert_eq!(board.status().moving().bits(), 1);

    board.handle(&vector(12)).unwrap();
    let turned = 10_100.0_f64 * 0.396 + 20_000.0 + 10_100.0 * 0.495;
    board.advance(495 * MS);
    same(x(&board), turned.round());
    let before = board.counters()[0];
    board.advance(100 * MS);
    assert!(board.counters()[0] < before && board.velocity(BoardAxis::X) < 0.0);
    board.advance(60_000 * MS);
    assert_eq!(board.counters()[0], -5000);
    assert!(board.status().moving().is_empty());
}

#[test]
fn vectors_3_and_4_home_the_axes_of_their_mask() {
    for (number, second) in [(3, BoardAxis::Y), (4, BoardAxis::Z)] {
        // X has its switch 9000 steps away; that of the other axis is at the end of its 20000 steps.
        let mut board = on_bench(vec![
            switch(1, BoardAxis::X, -50_000, -9000),
            switch(2, second, -50_000, -19_990),
        ]);
        for (axis, input) in [(BoardAxis::X, 1), (second, 2)] {
            set_parameter(&mut board, parameters::home_input(axis), input);
        }
        board.handle(&vector(number)).unwrap();
        assert!(board.status().has(Status::HOMING_IN_PROGRESS));
        assert_eq!(board.status().moving(), BoardAxis::X.mask().union(second.mask()));
        board.advance(20_000 * MS);
        assert!(!board.status().has(Status::HOMING_IN_PROGRESS | Status::HOMING_ERROR));
        // Both rest where they left their switches, and count from there.
        assert_eq!(board.counters(), [0; 5]);
        assert!((board.mechanical(BoardAxis::X) + 9000.0).abs() <= 1.0);
        assert!((board.mechanical(second) + 19_990.0).abs() <= 1.0);
    }
}

#[test]
fn vectors_13_and_14_move_several_axes_at_once() {
    let mut board = unlocked();
    board.handle(&vector(13)).unwrap();
    // Z has the longer way: 2000 steps at 5000 Hz from 200 Hz with 50 kHz/s take 2 · 4800 / 50000 s for the ramps,
    // which are 2 · 249.6 steps, and the rest at full speed. X makes half of it at every instant.
    let ramp: f64 = 4800.0 / 50_000.0;
    let total = 2.0 * ramp + (2000.0 - 2.0 * 2600.0 * ramp) / 5000.0;
    assert_eq!(board.status().interpolating().bits(), 0b101);
    assert!(board.status().independent().is_empty() && board.status().has(Status::BUFFER_EMPTY));
    board.advance(100 * MS);
    same(board.counters()[2].into(), -(2600.0 * ramp + 5000.0 * 0.004).round());
    same(board.velocity(BoardAxis::Z), -5000.0);
    same(board.velocity(BoardAxis::X), 2500.0);
    same(2.0 * board.position(BoardAxis::X), -board.position(BoardAxis::Z));
    let left = twin_drives::ramp::nanoseconds(total) - 100 * MS;
    board.advance(left - MS);
    assert!(!board.status().segments_finished());
    board.advance(2 * MS);
    assert!(board.status().segments_finished());
    assert_eq!(board.counters(), [1000, 0, -2000, 0, 0]);

    board.handle(&vector(14)).unwrap();
    assert_eq!(board.status().interpolating().bits(), 0b1_1111);
    board.advance(1000 * MS);
    assert_eq!(board.counters(), [1, 2, 3, 4, -5]);
}

#[test]
fn vector_15_homes_one_axis() {
    // IN5 is a normally closed contact, which opens 30000 steps away and stays so for 10000.
    let contact = switch(5, BoardAxis::X, -40_000, -30_000);
    let mut board = on_bench(vec![Cam { normally_closed: true, ..contact }]);
    assert_eq!(board.inputs(), 1 << 4);
    board.handle(&vector(15)).unwrap();
    // Extended B18, not B10: the homing of X is under way.
    assert_eq!(homing_bits(&board), 1 << 18);
    assert!(!board.status().has(Status::HOMING_IN_PROGRESS));
    // 200 to 4000 Hz with 20 kHz/s; then at 4000 Hz to the switch.
    let up: (f64, f64) = (0.19, 2100.0 * 0.19);
    board.advance(1000 * MS);
    same(x(&board), -(up.1 + 4000.0 * (1.0 - up.0)).round());
    // There after 0.19 s and 29601 steps, in all 7.59 s.
    board.advance(6589 * MS);
    assert_eq!(board.inputs(), 1 << 4);
    board.advance(2 * MS);
    assert_eq!(board.inputs(), 0);
    // Braked with 40 kHz/s to 200 Hz in 95 ms, and back at 300 Hz.
    board.advance(95 * MS);
    same(board.velocity(BoardAxis::X), 300.0);
    board.advance(3000 * MS);
    assert_eq!(homing_bits(&board), 0);
    assert_eq!((board.counters()[0], board.inputs()), (0, 1 << 4));
    assert!((board.mechanical(BoardAxis::X) + 30_000.0).abs() <= 1.0);
}

#[test]
fn vectors_16_17_and_19_stop_on_their_ramps() {
    // 16 stops X and Y, 17 and 19 all.
    for (number, left) in [(16, 0b1_0100), (17, 0), (19, 0)] {
        let mut board = unlocked();
        for axis in [BoardAxis::X, BoardAxis::Y, BoardAxis::Z] {
            send(&mut board, go(axis, 1_000_000));
        }
        send_for(&mut board, go(BoardAxis::B, -1_000_000), 1000);
        board.handle(&vector(number)).unwrap();
        board.advance(494 * MS);
        assert_eq!(board.status().moving().bits(), 0b1_0111, "vector {number}");
        board.advance(2 * MS);
        assert_eq!(board.status().moving().bits(), left, "vector {number}");
        // Ramp up, cruise, and (20000² − 200²) / (2 · 40000) steps of ramp down.
        same(x(&board), (10_100.0_f64 * 0.396 + 20_000.0 * 0.604 + 4999.5).round());
        assert!(!board.status().locked());
    }
}

#[test]
fn vector_18_stops_at_once_and_locks() {
    let mut board = unlocked();
    send_for(&mut board, go(BoardAxis::X, 1_000_000), 1000);
    let before = board.counters();
    board.handle(&vector(18)).unwrap();
    assert!(board.status().locked() && !board.status().enable_open());
    board.advance(1000 * MS);
    assert_eq!(board.counters(), before);
    // Locked, a move is accepted and does nothing.
    send_for(&mut board, go(BoardAxis::X, 0), 1000);
    assert_eq!(board.counters(), before);
}

#[test]
fn vectors_24_and_25_switch_outputs_unless_locked() {
    let mut board = unlocked();
    board.handle(&vector(24)).unwrap();
    assert_eq!(board.outputs(), 1);
    board.handle(&vector(25)).unwrap();
    assert_eq!(board.outputs(), 0x0A5);
    // OUT1 to OUT16 as a word: written at 4149, read there and at 1039.
    assert_eq!(refusal(&mut board, "01 06 10 35 80 01"), None);
    answers(&mut board, "01 04 04 0F 00 01", "01 04 02 80 01");
    answers(&mut board, "01 03 10 35 00 01", "01 03 02 80 01");
    board.handle(&vector(18)).unwrap();
    board.handle(&vector(25)).unwrap();
    assert_eq!(board.outputs(), 0x8001);
}

#[test]
fn vector_26_reads_the_lock_which_writing_0_opens() {
    let mut board = Board::new(&BoardOptions::default());
    assert_eq!(board.handle(&vector(26)), Some(seal(bytes("01 01 01 01"))));
    board.handle(&seal(bytes("01 05 01 20 00 00"))).unwrap();
    assert_eq!(board.handle(&vector(26)), Some(seal(bytes("01 01 01 00"))));
    board.handle(&seal(bytes("01 05 01 20 FF 00"))).unwrap();
    assert!(board.status().locked());
}
