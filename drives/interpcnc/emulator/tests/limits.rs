//! Limit switches, coupled axes and the bench.

use super::*;

/// X with normally closed limit switches at −1000 (IN7) and 2000 (IN8), Y with an open one at 500 (IN9).
fn limited(assumptions: Assumptions) -> Board {
    let mut board = assumed(assumptions);
    let closed =
        |input, from, to| Cam { normally_closed: true, ..switch(input, BoardAxis::X, from, to) };
    let open = switch(9, BoardAxis::Y, 500, 900);
    let cams = vec![closed(7, -9000, -1000), closed(8, 2000, 9000), open];
    board.set_bench(Bench { cams, encoder: None });
    for (number, value) in [(104, 7), (105, 1), (106, 8), (107, 1), (110, 9), (111, 0)] {
        set_parameter(&mut board, number, value);
    }
    board
}

#[test]
fn an_axis_stops_at_its_switch_and_goes_away_from_it() {
    let mut board = limited(Assumptions::default());
    assert!(board.status().on_limit_switch().is_empty());
    for (target, edge) in [(5000, 2000), (-5000, -1001)] {
        send_for(&mut board, go(BoardAxis::X, target), 3000);
        assert_eq!(board.counters()[0], edge);
        assert_eq!(board.status().on_limit_switch(), BoardAxis::X.mask());
        assert!(board.status().moving().is_empty() && !board.status().locked());
        // Farther it does not go.
        send_for(&mut board, go(BoardAxis::X, target), 1000);
        assert_eq!(board.counters()[0], edge);
    }
    send_for(&mut board, go(BoardAxis::X, 0), 1000);
    assert_eq!(board.counters()[0], 0);
    assert!(board.status().on_limit_switch().is_empty());
}

#[test]
fn the_stop_may_be_assumed_to_have_a_ramp() {
    let assumptions = Assumptions { limit_stop: BoardStop::OnRamp, ..Assumptions::default() };
    let mut board = limited(assumptions);
    send_for(&mut board, go(BoardAxis::X, 8000), 3000);
    // Step 2000 begins at 1999.5. From 200 Hz with 50 kHz/s, v² = 200² + 2·50000·1999.5; from there it is
    // (v² − 200²) / (2·40000) steps.
    same(x(&board), (1999.5 + 2.0 * 50_000.0 * 1999.5 / 80_000.0_f64).round());
}

#[test]
fn an_axis_that_reverses_on_its_switch_is_stopped() {
    let mut board = limited(Assumptions::default());
    send_for(&mut board, go(BoardAxis::X, 5000), 3000);
    // Away, and while still on the cam back again.
    board.set_input(8, false);
    send_for(&mut board, go(BoardAxis::X, -500), 50);
    assert!(board.velocity(BoardAxis::X) < 0.0);
    send_for(&mut board, go(BoardAxis::X, 5000), 3000);
    assert!(x(&board) < 2000.0 && board.status().moving().is_empty());
}

#[test]
fn an_interpolated_move_stops_as_a_whole() {
    let mut board = limited(Assumptions::default());
    let targets = [Some(1500), Some(1500), Some(1500), None, None];
    send(&mut board, Command::Interpolated { speed_hz: 5000, targets });
    send_for(&mut board, Command::Interpolated { speed_hz: 5000, targets: [Some(0); 5] }, 3000);
    assert_eq!(board.counters()[..3], [500; 3]);
    assert!(board.status().segments_finished());
    assert_eq!(board.status().on_limit_switch(), BoardAxis::Y.mask());
}

#[test]
fn a_limit_switch_may_be_the_home_switch() {
    let mut board = limited(Assumptions::default());
    send_for(&mut board, home(BoardAxis::X, (7, 0), -5000, 0), 5000);
    assert_eq!((board.counters()[0], homing_bits(&board)), (0, 0));
    assert!((board.mechanical(BoardAxis::X) + 1000.0).abs() <= 1.0);
    // Another switch: the limit stops it, and the homing has failed.
    send_for(&mut board, home(BoardAxis::X, (1, 1), 9000, 0), 5000);
    assert_eq!(homing_bits(&board), 1 << 19);
    assert!((board.mechanical(BoardAxis::X) - 2000.0).abs() <= 1.0);
}

#[test]
fn parameter_86_makes_an_axis_go_along_with_x() {
    for (value, coupled) in [(1, BoardAxis::A), (2, BoardAxis::B)] {
        let mut board = unlocked();
        set_parameter(&mut board, parameters::COUPLING, value);
        let mut positions = [None; 5];
        positions[coupled.index()] = Some(300);
        send(&mut board, Command::WritePosition { positions });
        send_for(&mut board, go(BoardAxis::X, 100_000), 1000);
        assert_eq!(board.status().independent(), BoardAxis::X.mask().union(coupled.mask()));
        // Command 96 on X changes the speed of both.
        send(&mut board, Command::ChangeSpeed { axes: BoardAxis::X.mask(), speed_hz: 10_000 });
        board.advance(1000 * MS);
        same(board.velocity(coupled), 10_000.0);
        send_for(&mut board, Command::RampStopAxes { axes: BoardAxis::X.mask() }, 1000);
        assert!(board.status().moving().is_empty());
        assert_eq!(board.counters()[coupled.index()], board.counters()[0] + 300);
        send_for(&mut board, segment_of_x(20_000, 0), 10_000);
        assert_eq!((board.counters()[0], board.counters()[coupled.index()]), (0, 300));
    }
}

#[test]
fn a_probe_touches_what_lies_along_its_axis() {
    let mut board = on_bench(vec![switch(3, BoardAxis::Z, i32::MIN, -4321)]);
    board.handle(&vector(5)).unwrap();
    board.advance(60_000 * MS);
    assert!(found(&board));
    assert!((f64::from(board.probe_position()) + 4321.0).abs() <= 1.0);
    // Counters may be written: the piece stays where it is.
    let positions = [None, None, Some(0), None, None];
    send(&mut board, Command::WritePosition { positions });
    send_for(&mut board, go(BoardAxis::Z, 1000), 5000);
    assert_eq!(board.inputs(), 0);
    board.handle(&vector(5)).unwrap();
    board.advance(60_000 * MS);
    assert!(found(&board));
    let rest = board.mechanical(BoardAxis::Z) - f64::from(board.counters()[2]);
    let place = f64::from(board.probe_position()) + rest;
    assert!((place + 4321.0).abs() <= 1.0, "{place}");
}

#[test]
fn a_stalled_motor_leaves_its_mechanics_behind() {
    let mut board = unlocked();
    send_for(&mut board, go(BoardAxis::X, 1000), 5000);
    board.set_stalled(BoardAxis::X, true);
    send_for(&mut board, go(BoardAxis::X, 3000), 5000);
    assert_eq!(board.counters()[0], 3000);
    same(board.mechanical(BoardAxis::X), 1000.0);
    board.set_stalled(BoardAxis::X, false);
    send_for(&mut board, go(BoardAxis::X, 3500), 5000);
    same(board.mechanical(BoardAxis::X), 1500.0);
}

#[test]
fn encoder_counters_and_analog_inputs_are_those_of_the_bench() {
    let mut board = unlocked();
    let link = EncoderLink { axis: BoardAxis::Y, counts: -4, steps: 2, counts_per_revolution: 100 };
    board.set_bench(Bench { cams: vec![], encoder: Some(link) });
    // Count 0 is an index; A and B are 0 there.
    answers(&mut board, "01 02 08 45 00 03", "01 02 01 04");
    send_for(&mut board, go(BoardAxis::Y, 51), 5000);
    // 51 steps are −102 counts; −102 mod 4 = 2, both inputs are 1, and no index.
    answers(&mut board, "01 03 10 7A 00 02", "01 03 04 FF FF FF 9A");
    answers(&mut board, "01 02 08 45 00 03", "01 02 01 03");
    board.add_pulses(false, 0x0001_0002);
    board.add_pulses(true, 5);
    board.add_pulses(true, u32::MAX);
    answers(&mut board, "01 03 10 7C 00 04", "01 03 08 00 01 00 02 00 00 00 04");
    board.set_analog_input(1, 17);
    board.set_analog_input(4, 5000);
    answers(&mut board, "01 04 04 10 00 04", "01 04 08 00 11 00 00 00 00 03 FF");
}

#[test]
fn inputs_are_bits_from_2048_and_registers_1036_and_1037() {
    let mut board = unlocked();
    board.set_input(17, true);
    board.set_input(32, true);
    board.set_input(2, true);
    answers(&mut board, "01 04 04 0C 00 02", "01 04 04 80 01 00 02");
    // The first 16 bit by bit, from 2048 on.
    answers(&mut board, "01 02 08 00 00 10", "01 02 02 02 00");
    // A hand against a cam, and off it.
    let cams = vec![switch(2, BoardAxis::X, 5, 9)];
    board.set_bench(Bench { cams, encoder: None });
    assert_eq!(board.inputs() & 2, 2);
    board.release_input(2);
    assert_eq!(board.inputs() & 2, 0);
}

#[test]
fn conditions_show_in_their_bits() {
    let mut board = unlocked();
    let rest = (board.status().0, board.extended_status());
    for (condition, bit, extended) in [
        (Condition::Overridden, 1 << 17, 0),
        (Condition::OverrideAllowed, 1 << 18, 0),
        (Condition::WaitingForInput, 1 << 19, 0),
        (Condition::WaitTimeout, 1 << 20, 0),
        (Condition::HeightControl, 1 << 21, 0),
        (Condition::BasicTxOverrun, 0, 1 << 5),
        (Condition::BasicRxOverrun, 0, 1 << 6),
        (Condition::BasicRunning, 0, 1 << 7),
        (Condition::RecipesChanged, 0, 1 << 9),
    ] {
        board.set_condition(condition, true);
        let expected = (rest.0 | bit, rest.1 | extended);
        assert_eq!((board.status().0, board.extended_status()), expected, "{condition:?}");
        board.set_condition(condition, false);
    }
    // Writing recipe data sets the last; writing an index does not.
    assert_eq!(refusal(&mut board, "01 06 16 01 00 01"), None);
    assert_eq!(board.extended_status() & 1 << 9, 0);
    assert_eq!(refusal(&mut board, "01 06 16 05 00 07"), None);
    assert_eq!(board.extended_status() & 1 << 9, 1 << 9);
}
