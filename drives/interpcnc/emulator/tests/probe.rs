//! Command 40 by the manual's example: Z−, IN3 to 1, 10000 steps at most, 1000 Hz from 100 Hz with 50 kHz/s, 100 kHz/s.

use super::*;

/// Steps that the ramp up to 1000 Hz takes, and its seconds: (1000² − 100²) / (2 · 50000), 900 / 50000.
const UP: (f64, f64) = (9.9, 0.018);
/// Those of the ramp down with 100 kHz/s.
const DOWN: f64 = 4.95;

/// Registers 1044 and 1045.
fn result(board: &mut Board) -> i32 {
    let answer = board.handle(&seal(bytes("01 04 04 14 00 02"))).unwrap();
    i32::from_be_bytes([answer[3], answer[4], answer[5], answer[6]])
}

/// Vector 5 with other bytes at some places.
fn search(others: &[(usize, u8)]) -> Vec<u8> {
    let mut frame = vector(5);
    frame.truncate(frame.len() - 2);
    for (place, byte) in others {
        frame[*place] = *byte;
    }
    seal(frame)
}

/// True if the search is over and has failed.
fn failed(board: &Board) -> bool {
    !board.status().probing() && board.status().probe_failed()
}

fn probing() -> Board {
    let mut board = unlocked();
    assert_eq!(board.handle(&vector(5)), Some(vector(6)));
    assert!(board.status().probing());
    board
}

#[test]
fn vector_5_stops_at_the_edge_of_its_input() {
    let mut board = probing();
    assert_eq!(board.status().moving(), BoardAxis::Z.mask());
    board.advance(500 * MS);
    board.set_input(3, true);
    let edge = UP.0 + (0.5 - UP.1) * 1000.0;
    assert_eq!(f64::from(result(&mut board)).to_bits(), (-edge).round().to_bits());
    // The ramp down takes 9 ms and goes on behind the edge; what was latched stays.
    assert!(board.status().probing());
    board.advance(10 * MS);
    assert!(found(&board) && board.status().moving().is_empty());
    let rest = f64::from(board.counters()[2]);
    assert!((rest + edge + DOWN).abs() <= 1.0, "{rest}");
    assert_eq!(f64::from(result(&mut board)).to_bits(), (-edge).round().to_bits());
    // The input goes back: nothing moves any more.
    board.set_input(3, false);
    board.advance(500 * MS);
    assert_eq!(f64::from(board.counters()[2]).to_bits(), rest.to_bits());
}

#[test]
fn the_end_of_the_stroke_is_a_failure() {
    let mut board = probing();
    // Another input, and the wrong edge of the same one, are nothing to it.
    board.set_input(4, true);
    board.set_input(3, false);
    board.advance(11_000 * MS);
    assert!(failed(&board));
    assert_eq!(board.counters(), [0, 0, -10_000, 0, 0]);
    // What was found before is not found now.
    assert_eq!(result(&mut board), 0);
    // Command 66 b2 clears it, and so does another probing move.
    send(&mut board, Command::Reset { unlock: false, homing_error: true, probe_error: false });
    assert!(board.status().probe_failed());
    send(&mut board, Command::Reset { unlock: false, homing_error: false, probe_error: true });
    assert!(!board.status().probe_failed());
}

#[test]
fn an_input_that_has_the_level_already_is_a_failure() {
    let mut board = unlocked();
    board.set_input(3, true);
    board.handle(&vector(5)).unwrap();
    assert!(failed(&board) && board.status().moving().is_empty());
    // A normally closed contact: the level that is awaited is 0.
    board.handle(&search(&[(16, 0)])).unwrap();
    assert!(board.status().probing() && !board.status().probe_failed());
    board.advance(300 * MS);
    board.set_input(3, false);
    board.advance(100 * MS);
    assert!(found(&board));
    assert!(result(&mut board) < -250);
}

#[test]
fn arguments_without_sense_are_a_failure() {
    // Input 0, input 33, level 2, stroke 0.
    for others in [&[(14, 0)][..], &[(14, 33)], &[(16, 2)], &[(19, 0), (20, 0)]] {
        let mut board = unlocked();
        board.handle(&search(others)).unwrap();
        let status = board.status();
        assert!(status.probe_failed() && status.moving().is_empty(), "{others:?}");
    }
}

#[test]
fn what_else_stops_the_axis_fails_the_probe() {
    for (command, ms, end) in [
        (Command::RampStop, 100, None),
        (Command::Stop, 100, None),
        (go(BoardAxis::Z, 500), 0, Some(500)),
    ] {
        let mut board = probing();
        board.advance(200 * MS);
        send_for(&mut board, command, ms);
        assert!(failed(&board), "{command:?}");
        // The input is nothing to a new move.
        board.set_input(3, true);
        board.advance(1000 * MS);
        assert!(end.is_none_or(|end| board.counters()[2] == end), "{command:?}");
        assert!(failed(&board), "{command:?}");
    }
}

#[test]
fn a_locked_board_does_not_probe() {
    let mut board = Board::new(&BoardOptions::default());
    assert_eq!(board.handle(&vector(5)), Some(vector(6)));
    assert!(found(&board) && board.status().moving().is_empty());
}

#[test]
fn there_is_one_search_at_a_time() {
    // One with a wrong argument changes nothing of it but B13.
    let mut board = probing();
    board.advance(200 * MS);
    board.handle(&search(&[(10, 1), (14, 40)])).unwrap();
    assert!(board.status().probing() && board.status().probe_failed());
    assert_eq!(board.status().moving(), BoardAxis::Z.mask());
    // Another axis takes its place.
    board.handle(&search(&[(10, 1), (14, 4)])).unwrap();
    board.advance(100 * MS);
    assert_eq!(board.status().moving(), BoardAxis::X.mask());
    board.set_input(3, true);
    assert!(board.status().probing());
    board.set_input(4, true);
    board.advance(100 * MS);
    assert!(found(&board));
}
