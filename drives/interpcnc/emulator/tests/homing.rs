//! Commands 71 and 78: what makes them fail, what they need, and how they run side by side.

use super::*;

#[test]
fn axes_home_side_by_side_each_with_its_own_bits() {
    let mut board = on_bench(vec![
        switch(1, BoardAxis::X, -9000, -4000),
        switch(2, BoardAxis::B, 20_000, 30_000),
    ]);
    send_for(&mut board, home(BoardAxis::X, (1, 1), -10_000, -50), 300);
    send(&mut board, home(BoardAxis::B, (2, 1), 25_000, 7777));
    assert_eq!(homing_bits(&board), 1 << 18 | 1 << 26);
    board.advance(3000 * MS);
    assert_eq!(homing_bits(&board), 1 << 26);
    assert_eq!(board.counters()[0], -50);
    board.advance(10_000 * MS);
    assert_eq!(homing_bits(&board), 0);
    assert_eq!(board.counters(), [-50, 0, 0, 0, 7777]);
    assert!((board.mechanical(BoardAxis::B) - 20_000.0).abs() <= 1.0);
}

#[test]
fn a_switch_beyond_the_stroke_is_a_failure_of_that_axis() {
    let mut board = on_bench(vec![switch(3, BoardAxis::Y, 5001, 6000)]);
    send_for(&mut board, home(BoardAxis::Y, (3, 1), 5000, 0), 5000);
    assert_eq!(homing_bits(&board), 1 << 21);
    assert_eq!(board.counters()[1], 5000);
    // A new homing clears it; this one comes to the switch.
    send(&mut board, home(BoardAxis::Y, (3, 1), 5000, 12));
    assert_eq!(homing_bits(&board), 1 << 20);
    board.advance(5000 * MS);
    assert_eq!((homing_bits(&board), board.counters()[1]), (0, 12));
}

#[test]
fn an_axis_on_its_switch_goes_off_it_at_once() {
    let mut board = on_bench(vec![switch(3, BoardAxis::Y, -100, 400)]);
    send_for(&mut board, home(BoardAxis::Y, (3, 1), -5000, 0), 100);
    same(board.velocity(BoardAxis::Y), 500.0);
    board.advance(1000 * MS);
    assert_eq!((homing_bits(&board), board.counters()[1]), (0, 0));
    assert!((board.mechanical(BoardAxis::Y) - 400.0).abs() <= 1.0);
}

#[test]
fn a_switch_that_is_never_left_is_a_failure() {
    let mut board = on_bench(vec![]);
    board.set_input(3, true);
    send_for(&mut board, home(BoardAxis::Y, (3, 1), -1000, 0), 5000);
    assert_eq!((homing_bits(&board), board.counters()[1]), (1 << 21, 1000));
}

#[test]
fn arguments_without_sense_fail_at_once() {
    for (input, stroke) in [(0, 1000), (33, 1000), (1, 0)] {
        let mut board = unlocked();
        send(&mut board, home(BoardAxis::A, (input, 1), stroke, 0));
        assert_eq!(homing_bits(&board), 1 << 25, "input {input}, stroke {stroke}");
        assert!(board.status().moving().is_empty());
    }
    // Axis 6 is none; exception 3.
    assert_eq!(write(&mut unlocked(), &[78, 6]), Some(3));
}

#[test]
fn what_else_moves_or_stops_the_axis_fails_its_homing() {
    let others = [
        (go(BoardAxis::X, 100), 100),
        (Command::RampStop, -1),
        (Command::Stop, -1),
        (Command::RampStopAxes { axes: BoardAxis::X.mask() }, -1),
    ];
    for (command, end) in others {
        let mut board = on_bench(vec![switch(1, BoardAxis::X, -9000, -4000)]);
        send_for(&mut board, home(BoardAxis::X, (1, 1), -10_000, 0), 300);
        send(&mut board, command);
        assert_eq!(homing_bits(&board), 1 << 19, "{command:?}");
        board.advance(5000 * MS);
        // It has not gone on by itself.
        let counter = board.counters()[0];
        assert!(if end == 100 { counter == 100 } else { counter > -2000 }, "{command:?}");
        // Command 66 b1 clears it.
        send(&mut board, Command::Reset { unlock: false, homing_error: true, probe_error: false });
        assert_eq!(homing_bits(&board), 0);
    }
}

/// A board whose parameters home X towards − with IN1 and Z towards + with IN2, normally closed.
fn parametrised(assumptions: Assumptions) -> Board {
    let mut board = assumed(assumptions);
    let closed = Cam { normally_closed: true, ..switch(2, BoardAxis::Z, 3000, 50_000) };
    let cams = vec![switch(1, BoardAxis::X, -50_000, -2000), closed];
    board.set_bench(Bench { cams, encoder: None });
    for (number, value) in [
        (parameters::home_input(BoardAxis::X), 1),
        (parameters::home_input(BoardAxis::Z), 2),
        (parameters::home_direction(BoardAxis::Z), 1),
        (parameters::HOME_POLARITY, 0b100),
        (parameters::home_speed(BoardAxis::Z), 2000),
    ] {
        set_parameter(&mut board, number, value);
    }
    board
}

const BOTH: Command =
    Command::HomeMachine { max_strokes: [Some(10_000), None, Some(-10_000), None, None] };

#[test]
fn the_machine_homes_by_its_parameters() {
    for zeroed in [true, false] {
        let mut board = parametrised(Assumptions::default());
        if !zeroed {
            set_parameter(&mut board, parameters::ZERO_AFTER_HOMING, 0);
        }
        send_for(&mut board, BOTH, 400);
        same(board.velocity(BoardAxis::X), -5000.0);
        same(board.velocity(BoardAxis::Z), 2000.0);
        // B10; the extended bits belong to command 78.
        assert!(board.status().has(Status::HOMING_IN_PROGRESS));
        assert_eq!(homing_bits(&board), 0);
        board.advance(10_000 * MS);
        assert!(!board.status().has(Status::HOMING_IN_PROGRESS | Status::HOMING_ERROR));
        assert!((board.mechanical(BoardAxis::Z) - 3000.0).abs() <= 1.0);
        // Parameter 128 may leave the counters alone.
        if zeroed {
            assert_eq!(board.counters(), [0; 5]);
        } else {
            assert!((x(&board) + 2000.0).abs() <= 1.0);
        }
    }
}

#[test]
fn axes_may_be_assumed_to_home_one_by_one() {
    let mut board = parametrised(Assumptions { home_one_by_one: true, ..Assumptions::default() });
    send_for(&mut board, BOTH, 300);
    assert_eq!(board.status().moving(), BoardAxis::X.mask());
    // X: 0.4 s to its switch, half a second off it, with ramps.
    board.advance(1500 * MS);
    assert_eq!(board.status().moving(), BoardAxis::Z.mask());
    assert!(board.status().has(Status::HOMING_IN_PROGRESS));
    board.advance(10_000 * MS);
    assert!(!board.status().has(Status::HOMING_IN_PROGRESS | Status::HOMING_ERROR));
    assert_eq!(board.counters(), [0; 5]);
}

#[test]
fn a_machine_without_switch_fails_with_b11() {
    let mut board = parametrised(Assumptions::default());
    let max_strokes = [None, Some(1000), None, None, None];
    send(&mut board, Command::HomeMachine { max_strokes });
    let status = board.status();
    assert!(status.has(Status::HOMING_ERROR) && !status.has(Status::HOMING_IN_PROGRESS));
    assert!(status.moving().is_empty());
    // A new one clears it, and a stroke that is too short sets it again.
    send(&mut board, Command::HomeMachine { max_strokes: x_only(1000) });
    assert!(!board.status().has(Status::HOMING_ERROR));
    board.advance(5000 * MS);
    assert!(board.status().has(Status::HOMING_ERROR));
    assert_eq!(board.counters()[0], -1000);
    send(&mut board, Command::Reset { unlock: false, homing_error: true, probe_error: false });
    assert!(!board.status().has(Status::HOMING_ERROR));
}
