//! Lock, ENABLE, broadcasts and motion.

use proptest::prelude::*;

use super::*;

#[test]
fn a_broadcast_is_executed_and_not_answered() {
    let mut board = unlocked();
    assert_eq!(board.handle(&seal(bytes("00 05 01 00 FF 00"))), None);
    assert_eq!(board.outputs(), 1);
    assert_eq!(board.handle(&seal(bytes("00 10 10 00 00 01 02 00 2B"))), None);
    assert!(board.status().locked());
    assert_eq!(board.handle(&seal(bytes("00 04 04 00 00 0C"))), None);
}

#[test]
fn absent_arguments_keep_their_last_value() {
    let mut board = unlocked();
    board.handle(&vector(11)).unwrap();
    board.advance(20_000 * MS);
    // A master with function 6 only: arguments first, the command last.
    assert_eq!(refusal(&mut board, "01 06 10 07 00 00"), None);
    assert_eq!(refusal(&mut board, "01 06 10 08 00 05"), None);
    board.advance(1000 * MS);
    assert_eq!(board.counters()[0], 100_000);
    assert_eq!(refusal(&mut board, "01 06 10 00 00 50"), None);
    board.advance(20_000 * MS);
    assert_eq!(board.counters()[0], 5);
}

#[test]
fn losing_enable_locks_after_the_filter_and_only_a_command_unlocks() {
    let mut board = unlocked();
    send_for(&mut board, go(BoardAxis::X, 1_000_000), 1000);
    board.set_enable(false);
    board.advance(99 * MS);
    assert!(!board.status().enable_open() && !board.status().locked());
    board.advance(50 * MS);
    assert!(board.status().enable_open() && board.status().locked());
    // Stopped when the filter passed the loss on: 100 ms at 20 kHz after it, not 149.
    let start = (10_100.0_f64 * 0.396 + 20_000.0 * 0.604).round();
    same(x(&board), start + 2000.0);
    // Command 66 is answered and does nothing while ENABLE is open; its return alone does nothing either.
    assert_eq!(board.handle(&vector(1)), Some(vector(2)));
    assert!(board.status().locked());
    board.set_enable(true);
    assert!(!board.status().enable_open() && board.status().locked());
    board.handle(&vector(1)).unwrap();
    assert!(!board.status().locked());
    board.advance(1000 * MS);
    same(x(&board), start + 2000.0);
}

#[test]
fn a_short_loss_of_enable_is_filtered_out() {
    let mut board = unlocked();
    for _ in 0..5 {
        board.set_enable(false);
        board.advance(90 * MS);
        board.set_enable(true);
        board.advance(50 * MS);
    }
    assert!(!board.status().locked());
}

#[test]
fn parameters_88_and_89_unlock_by_input_or_automatically() {
    let mut board = Board::new(&BoardOptions { enable: false, ..BoardOptions::default() });
    // Parameter 89 (4530, 4531) = 1 with parameter 88 = 0: unlocked as soon as ENABLE is there.
    assert_eq!(refusal(&mut board, "01 10 11 B2 00 02 04 00 00 00 01"), None);
    board.set_enable(true);
    assert!(!board.status().locked());
    // Parameter 88 (4528, 4529) = 3, polarity NO: IN3 unlocks.
    assert_eq!(refusal(&mut board, "01 10 11 B0 00 04 08 00 00 00 03 00 00 00 00"), None);
    board.handle(&vector(18)).unwrap();
    board.set_input(2, true);
    assert!(board.status().locked());
    board.set_input(3, true);
    assert!(!board.status().locked());
    // IN1 to IN16 as a word.
    answers(&mut board, "01 04 04 0D 00 01", "01 04 02 00 06");
}

#[test]
fn a_moving_axis_keeps_its_counter_and_a_standing_one_ignores_speed() {
    let mut board = unlocked();
    board.handle(&vector(9)).unwrap();
    board.advance(100 * MS);
    assert_eq!(board.counters()[0], 0);
    send_for(&mut board, go(BoardAxis::X, 1_000_000), 1000);
    let before = board.counters()[0];
    board.handle(&vector(7)).unwrap();
    assert_eq!(board.counters()[0], before);
}

#[test]
fn a_new_speed_has_no_effect_in_the_final_deceleration() {
    let mut board = unlocked();
    send(&mut board, go(BoardAxis::X, 100_000));
    let mut other = board.clone();
    board.advance(5200 * MS);
    other.advance(5200 * MS);
    let speed = board.velocity(BoardAxis::X);
    assert!(speed < 19_000.0 && speed > 1000.0, "not in the final deceleration: {speed}");
    send(&mut board, Command::ChangeSpeed { axes: AxisMask::ALL, speed_hz: 500 });
    for _ in 0..50 {
        board.advance(10 * MS);
        other.advance(10 * MS);
        assert_eq!(board.counters(), other.counters());
    }
}

#[test]
fn speed_is_clamped_to_200_khz() {
    let mut board = unlocked();
    // 0003 D090h = 250000 Hz at the steepest ramps.
    assert_eq!(write(&mut board, &[80, 1, 200, 65_535, 0x3, 0xD090, 65_535, 0x0100, 0]), None);
    board.advance(100 * MS);
    same(board.velocity(BoardAxis::X), 200_000.0);
}

fn orders() -> impl Strategy<Value = Vec<(MoveProfile, i64)>> {
    let profile = (0_u16..2000, 1_u16..500, 1_u32..250_000, 1_u16..500, -50_000..50_000);
    let profile = profile.prop_map(
        |(start_stop_hz, acceleration_khz_per_s, speed_hz, deceleration_khz_per_s, target)| {
            MoveProfile {
                start_stop_hz,
                acceleration_khz_per_s,
                speed_hz,
                deceleration_khz_per_s,
                target,
            }
        },
    );
    prop::collection::vec((profile, 1..400 * MS), 1..6)
}

proptest! {
    #[test]
    fn chunks_of_time_do_not_matter(orders in orders(), cuts in prop::collection::vec(0..50 * MS, 1..20)) {
        let (mut whole, mut chunked) = (unlocked(), unlocked());
        for (profile, wait) in orders {
            for board in [&mut whole, &mut chunked] {
                send(board, Command::Move { axis: BoardAxis::Y, profile });
            }
            whole.advance(wait);
            let mut left = wait;
            for cut in &cuts {
                let chunk = left.min(*cut);
                chunked.advance(chunk);
                left -= chunk;
            }
            chunked.advance(left);
            prop_assert_eq!(whole.handle(&vector(20)), chunked.handle(&vector(20)));
            prop_assert_eq!(whole.velocity(BoardAxis::Y).to_bits(), chunked.velocity(BoardAxis::Y).to_bits());
        }
        // Also across the loss of ENABLE, which happens at an instant of its own.
        for board in [&mut whole, &mut chunked] {
            board.set_enable(false);
        }
        whole.advance(1000 * MS);
        for cut in &cuts {
            chunked.advance(*cut);
        }
        chunked.advance(1000 * MS - cuts.iter().sum::<i64>().min(1000 * MS));
        prop_assert_eq!(whole.counters(), chunked.counters());
    }

    #[test]
    fn counters_step_within_the_speed_and_end_on_the_target(orders in orders()) {
        let mut board = unlocked();
        let mut fastest = 0.0_f64;
        let mut last = 0;
        for (profile, wait) in orders {
            send(&mut board, Command::Move { axis: BoardAxis::A, profile });
            fastest = fastest.max(f64::from(profile.speed_hz.min(200_000)));
            let steps = 100;
            for _ in 0..steps {
                let before = board.counters()[3];
                board.advance(wait / steps);
                let stepped = f64::from((board.counters()[3] - before).abs());
                #[expect(clippy::cast_precision_loss, reason = "less than a second")]
                let seconds = (wait / steps) as f64 * 1e-9;
                prop_assert!(stepped <= fastest * seconds + 1.0 + 1e-6);
            }
            last = profile.target;
        }
        board.advance(3_600_000 * MS * 24);
        prop_assert_eq!(board.counters()[3], last);
        prop_assert!(board.status().moving().is_empty());
    }
}
