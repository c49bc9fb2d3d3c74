//! Command 6: the buffer, and what stops it.

use super::*;

fn segment(speed_hz: u32, x: Option<i32>, y: Option<i32>) -> Command {
    Command::Interpolated { speed_hz, targets: [x, y, None, None, None] }
}

/// Exception code of a command, sent as a master does.
fn refused(board: &mut Board, command: &Command) -> Option<u8> {
    write(board, &command.registers())
}

#[test]
fn segments_are_carried_out_one_after_the_other_and_stop_in_between() {
    let mut board = unlocked();
    send(&mut board, segment(5000, Some(3000), Some(1000)));
    send(&mut board, segment(5000, Some(3000), Some(4000)));
    assert!(!board.status().has(Status::BUFFER_EMPTY));
    // Each ramps from 200 to 5000 Hz and back: 96 ms and 249.6 steps per ramp, the rest at 5000 Hz.
    let each = twin_drives::ramp::nanoseconds(1e-3 * (2.0 * 96.0 + (3000.0 - 2.0 * 249.6) / 5.0));
    board.advance(each - MS / 10);
    // At the end of the first segment both are as slow as the start frequency of the major axis allows.
    assert!(board.velocity(BoardAxis::X) < 206.0 && board.velocity(BoardAxis::Y) < 69.0);
    assert!(board.velocity(BoardAxis::X) >= 200.0);
    board.advance(MS / 5);
    assert_eq!(board.counters()[0], 3000);
    assert_eq!(board.status().interpolating(), BoardAxis::Y.mask());
    assert!(board.status().has(Status::BUFFER_EMPTY) && !board.status().segments_finished());
    board.advance(each - MS);
    assert!(!board.status().segments_finished());
    board.advance(2 * MS);
    assert!(board.status().segments_finished());
    assert_eq!(board.counters()[..2], [3000, 4000]);
}

#[test]
fn parameters_4_and_5_are_its_ramp() {
    let usual = Assumptions::default();
    let others = Assumptions { segment_acceleration: 200, segment_start_stop: 201, ..usual };
    for (assumptions, acceleration, start_stop) in [
        (usual, parameters::DEFAULT_ACCELERATION, parameters::DEFAULT_START_STOP),
        (others, 200, 201),
    ] {
        let mut board = assumed(assumptions);
        set_parameter(&mut board, acceleration, 10);
        set_parameter(&mut board, start_stop, 1000);
        send_for(&mut board, segment_of_x(5000, 100_000), 200);
        same(board.velocity(BoardAxis::X), 3000.0);
        board.advance(200 * MS);
        same(board.velocity(BoardAxis::X), 5000.0);
    }
}

#[test]
fn the_buffer_holds_64_segments_and_refuses_the_next_with_exception_4() {
    let usual = Assumptions::default();
    for (assumptions, size) in [(usual, 64), (Assumptions { buffer_segments: 1, ..usual }, 1)] {
        let mut board = assumed(assumptions);
        // One is carried out, the others wait.
        for target in 1..=size + 1 {
            assert_eq!(refused(&mut board, &segment_of_x(5000, 1000 * target)), None);
        }
        assert_eq!(refused(&mut board, &segment_of_x(5000, 0)), Some(4), "{size}");
        board.advance(400 * MS);
        let last = 1000 * (size + 2);
        assert_eq!(refused(&mut board, &segment_of_x(5000, last)), None);
        assert_eq!(refused(&mut board, &segment_of_x(5000, 0)), Some(4), "{size}");
        board.advance(60_000 * MS);
        assert_eq!(board.counters()[0], last);
    }
}

#[test]
fn axes_in_a_move_of_the_other_kind_are_refused() {
    let mut board = unlocked();
    send(&mut board, go(BoardAxis::X, 1000));
    assert_eq!(refused(&mut board, &segment(5000, Some(0), Some(50))), Some(4));
    // Others are free.
    assert_eq!(refused(&mut board, &segment(5000, None, Some(5000))), None);
    assert_eq!(board.status().interpolating(), BoardAxis::Y.mask());
    assert_eq!(board.status().independent(), BoardAxis::X.mask());
    assert_eq!(refused(&mut board, &go(BoardAxis::Y, 0)), Some(4));
    board.advance(10_000 * MS);
    assert_eq!(board.counters()[..2], [1000, 5000]);
}

#[test]
fn a_waiting_segment_waits_for_an_axis_that_was_started_meanwhile() {
    let mut board = unlocked();
    send(&mut board, segment(5000, None, Some(5000)));
    send(&mut board, segment(5000, Some(100), Some(0)));
    send_for(&mut board, go(BoardAxis::X, 100_000), 2000);
    // Y has arrived; X moves for 5.45 s: the buffer is held and not empty.
    assert_eq!(board.counters()[1], 5000);
    assert!(board.status().has(Status::BUFFER_FROZEN) && !board.status().has(Status::BUFFER_EMPTY));
    board.advance(60_000 * MS);
    assert!(board.status().segments_finished() && !board.status().has(Status::BUFFER_FROZEN));
    assert_eq!(board.counters()[..2], [100, 0]);
}

#[test]
fn a_ramp_stop_brakes_along_the_line_and_clears_the_buffer() {
    for command in [Command::RampStop, Command::Stop] {
        let mut board = unlocked();
        send(&mut board, segment(5000, Some(60_000), Some(20_000)));
        send_for(&mut board, segment(5000, Some(0), Some(0)), 1000);
        // The ramp stop of axes is for independent moves only.
        send_for(&mut board, Command::RampStopAxes { axes: AxisMask::ALL }, 100);
        same(board.velocity(BoardAxis::X), 5000.0);
        let before = x(&board);
        send(&mut board, command);
        assert!(board.status().has(Status::BUFFER_EMPTY));
        board.advance(1000 * MS);
        assert!(board.status().segments_finished());
        // 249.6 steps of ramp down, or none; X and Y keep their proportion.
        let way = if command == Command::RampStop { 249.6 } else { 0.0 };
        assert!((x(&board) - before - way).abs() <= 1.0);
        assert!((x(&board) - 3.0 * f64::from(board.counters()[1])).abs() <= 3.0);
    }
}

#[test]
fn the_bench_can_freeze_the_buffer() {
    let mut board = unlocked();
    board.set_condition(Condition::BufferFrozen, true);
    send_for(&mut board, segment(5000, Some(1000), None), 1000);
    assert!(board.status().has(Status::BUFFER_FROZEN) && !board.status().has(Status::BUFFER_EMPTY));
    assert_eq!(board.counters()[0], 0);
    board.set_condition(Condition::BufferFrozen, false);
    board.advance(1000 * MS);
    assert_eq!(board.counters()[0], 1000);
}

#[test]
fn a_segment_without_way_is_over_at_once_and_a_locked_board_queues_nothing() {
    let mut board = unlocked();
    for _ in 0..200 {
        send(&mut board, segment(5000, Some(0), Some(0)));
    }
    assert!(board.status().segments_finished());
    board.handle(&vector(18)).unwrap();
    send(&mut board, segment(5000, Some(10), None));
    board.handle(&vector(1)).unwrap();
    board.advance(1000 * MS);
    assert_eq!(board.counters()[0], 0);
}

proptest::proptest! {
    #[test]
    fn every_segment_ends_on_its_target_and_keeps_to_the_line(
        ways in proptest::collection::vec((-3000_i32..3000, -3000_i32..3000), 1..5),
        speed_hz in 1_u32..20_000,
    ) {
        let mut board = unlocked();
        let mut at = (0, 0);
        for (dx, dy) in ways {
            let to = (at.0 + dx, at.1 + dy);
            send(&mut board, segment(speed_hz, Some(to.0), Some(to.1)));
            let mut left = 100_000;
            while !board.status().segments_finished() {
                board.advance(37 * MS);
                // Position relative to the start is in proportion to the way at every instant.
                let x = board.position(BoardAxis::X) - f64::from(at.0);
                let y = board.position(BoardAxis::Y) - f64::from(at.1);
                let across = x * f64::from(dy) - y * f64::from(dx);
                proptest::prop_assert!(across.abs() < 1e-3, "{across}");
                left -= 1;
                proptest::prop_assert!(left > 0);
            }
            proptest::prop_assert_eq!((board.counters()[0], board.counters()[1]), to);
            at = to;
        }
    }
}

/// The manual only asks to take care: such a command may also be answered as usual and do nothing.
#[test]
fn axes_in_a_move_of_the_other_kind_may_do_nothing_more() {
    let mut board = assumed(Assumptions { busy_axis_refuses: false, ..Assumptions::default() });
    send_for(&mut board, segment(2000, Some(20_000), None), 500);
    send(&mut board, go(BoardAxis::X, -500));
    send(&mut board, Command::HomeMachine { max_strokes: x_only(400) });
    assert_eq!(board.status().interpolating(), BoardAxis::X.mask());
    assert_eq!(board.status().independent(), AxisMask::NONE);
    // Another axis is free, and then not for segments.
    send(&mut board, go(BoardAxis::Y, 90_000));
    send(&mut board, segment(2000, None, Some(7)));
    assert_eq!(board.waiting_segments(), 0);
    board.advance(60_000 * MS);
    assert_eq!(board.counters()[..2], [20_000, 90_000]);
}
