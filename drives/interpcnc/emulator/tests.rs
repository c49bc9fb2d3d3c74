//! The emulated board against the digest's vectors and the behaviour that digest and manual describe.

use proptest::prelude::*;

use super::{rtu::seal, *};
use crate::interpcnc::{
    MoveProfile,
    vectors::{VECTORS, bytes, vector},
};

fn unlocked() -> Board {
    let mut board = Board::new(&BoardOptions::default());
    assert_eq!(board.handle(&vector(1)), Some(vector(2)));
    board
}

/// Sends a command from station 1 and expects it to be accepted.
fn send(board: &mut Board, command: Command) {
    assert_eq!(write(board, &command.registers()), None, "{command:?}");
}

/// Writes command registers; the exception code, if there is one.
fn write(board: &mut Board, registers: &[u16]) -> Option<u8> {
    let count = u8::try_from(registers.len()).unwrap();
    let mut frame = vec![1, 16, 0x10, 0, 0, count, 2 * count];
    frame.extend(registers.iter().flat_map(|register| register.to_be_bytes()));
    let answer = board.handle(&seal(frame)).unwrap();
    (answer[1] != 16).then_some(answer[2])
}

/// The exception code that a request from station 1 gets.
fn refusal(board: &mut Board, request: &str) -> Option<u8> {
    let answer = board.handle(&seal(bytes(request))).unwrap();
    (answer[1] & 0x80 != 0).then(|| answer[2])
}

fn go(axis: BoardAxis, target: i32) -> Command {
    let profile = MoveProfile {
        start_stop_hz: 200,
        acceleration_khz_per_s: 50,
        speed_hz: 20_000,
        deceleration_khz_per_s: 40,
        target,
    };
    Command::Move { axis, profile }
}

const MS: i64 = 1_000_000;

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
    assert!((board.velocity(BoardAxis::X) - 20_000.0).abs() < 1e-6);
    board.handle(&vector(9)).unwrap();
    board.advance(1000 * MS);
    assert!((board.velocity(BoardAxis::X) - 10_000.0).abs() < 1e-6);
    board.advance(20_000 * MS);
    assert_eq!(board.counters()[0], 100_000);
}

#[test]
fn vectors_11_and_12_move_and_retarget_in_flight() {
    let mut board = unlocked();
    board.handle(&vector(11)).unwrap();
    // Closed form of the trapezoid: 200 Hz → 20 kHz at 50 kHz/s, then cruise.
    board.advance(396 * MS);
    assert_eq!(f64::from(board.counters()[0]), (10_100.0_f64 * 0.396).round());
    board.advance(1000 * MS);
    assert_eq!(f64::from(board.counters()[0]), (10_100.0_f64 * 0.396 + 20_000.0).round());
    assert_eq!(board.status().moving().bits(), 1);

    board.handle(&vector(12)).unwrap();
    let turned = 10_100.0_f64 * 0.396 + 20_000.0 + 10_100.0 * 0.495;
    board.advance(495 * MS);
    assert_eq!(f64::from(board.counters()[0]), turned.round());
    let before = board.counters()[0];
    board.advance(100 * MS);
    assert!(board.counters()[0] < before && board.velocity(BoardAxis::X) < 0.0);
    board.advance(60_000 * MS);
    assert_eq!(board.counters()[0], -5000);
    assert!(board.status().moving().is_empty());
}

#[test]
fn vectors_3_to_5_and_13_to_15_are_not_done_and_say_so() {
    let mut board = unlocked();
    for number in [3, 4, 5, 13, 14, 15] {
        let answer = board.handle(&vector(number)).unwrap();
        assert_eq!(answer, seal(vec![1, 0x90, 3]), "vector {number}");
    }
    board.advance(1000 * MS);
    assert_eq!(board.counters(), [0; 5]);
}

#[test]
fn vector_16_stops_two_axes_on_their_ramps() {
    let mut board = unlocked();
    for axis in [BoardAxis::X, BoardAxis::Y, BoardAxis::Z] {
        send(&mut board, go(axis, 1_000_000));
    }
    board.advance(1000 * MS);
    board.handle(&vector(16)).unwrap();
    board.advance(494 * MS);
    assert_eq!(board.status().moving().bits(), 0b111);
    board.advance(2 * MS);
    assert_eq!(board.status().moving().bits(), 0b100);
    // Ramp up, cruise, and (20000² − 200²) / (2 · 40000) steps of ramp down.
    let end = 10_100.0_f64 * 0.396 + 20_000.0 * 0.604 + 4999.5;
    assert_eq!(f64::from(board.counters()[0]), end.round());
    assert!(!board.status().locked());
}

#[test]
fn vectors_17_and_19_stop_everything_on_its_ramp() {
    for number in [17, 19] {
        let mut board = unlocked();
        send(&mut board, go(BoardAxis::X, 1_000_000));
        send(&mut board, go(BoardAxis::B, -1_000_000));
        board.advance(1000 * MS);
        let answer = board.handle(&vector(number)).unwrap();
        if number == 19 {
            assert_eq!(answer, vector(19));
        }
        board.advance(496 * MS);
        assert!(board.status().moving().is_empty() && !board.status().locked());
    }
}

#[test]
fn vector_18_stops_at_once_and_locks() {
    let mut board = unlocked();
    send(&mut board, go(BoardAxis::X, 1_000_000));
    board.advance(1000 * MS);
    let before = board.counters();
    board.handle(&vector(18)).unwrap();
    assert!(board.status().locked() && !board.status().enable_open());
    board.advance(1000 * MS);
    assert_eq!(board.counters(), before);
    // Locked, a move is accepted and does nothing.
    send(&mut board, go(BoardAxis::X, 0));
    board.advance(1000 * MS);
    assert_eq!(board.counters(), before);
}

#[test]
fn vectors_20_to_23_show_status_and_positions() {
    let mut board = unlocked();
    let positions = [Some(100_000), Some(-1), Some(0), Some(0), Some(0)];
    send(&mut board, Command::WritePosition { positions });
    send(&mut board, go(BoardAxis::X, 200_000));
    assert_eq!(board.handle(&vector(20)), Some(vector(21)));
    assert_eq!(board.handle(&vector(22)), Some(vector(23)));
}

#[test]
fn vectors_24_and_25_switch_outputs_unless_locked() {
    let mut board = unlocked();
    assert_eq!(board.handle(&vector(24)), Some(vector(24)));
    assert_eq!(board.outputs(), 1);
    assert_eq!(board.handle(&vector(25)), Some(seal(bytes("01 0F 01 00 00 0C"))));
    assert_eq!(board.outputs(), 0x0A5);
    // OUT1 to OUT16 as a word: written at 4149, read there and at 1039.
    assert_eq!(refusal(&mut board, "01 06 10 35 80 01"), None);
    assert_eq!(
        board.handle(&seal(bytes("01 04 04 0F 00 01"))),
        Some(seal(bytes("01 04 02 80 01")))
    );
    assert_eq!(
        board.handle(&seal(bytes("01 03 10 35 00 01"))),
        Some(seal(bytes("01 03 02 80 01")))
    );
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

#[test]
fn vectors_27_and_28_read_the_speed_parameter() {
    assert_eq!(unlocked().handle(&vector(27)), Some(vector(28)));
}

#[test]
fn vectors_29_to_31_are_exceptions() {
    let mut board = unlocked();
    assert_eq!(board.handle(&seal(bytes("01 10 1B 58 00 01 02 00 00"))), Some(vector(29)));
    let read_write = "01 17 10 00 00 01 10 00 00 01 02 00 00";
    assert_eq!(board.handle(&seal(bytes(read_write))), Some(vector(30)));
    assert_eq!(board.handle(&seal(bytes("01 04 04 00 00 00"))), Some(vector(31)));
}

#[test]
fn addresses_outside_the_map_reserved_or_read_only_get_exception_2() {
    let mut board = unlocked();
    for request in [
        "01 01 00 FF 00 01",                // coil 255
        "01 01 01 FF 00 02",                // coils 511, 512
        "01 02 08 FF 00 02",                // inputs 2303, 2304
        "01 04 04 1F 00 02",                // input registers 1055, 1056
        "01 03 0F FF 00 02",                // holding 4095, 4096
        "01 05 01 21 FF 00",                // reserved coil 289
        "01 06 10 7A 00 01",                // 4218, encoder
        "01 06 10 80 00 01",                // 4224, reserved
        "01 06 19 ED 00 01",                // 6637
        "01 03 FF FF 00 02",                // beyond 65535
        "01 10 10 79 00 02 04 00 01 00 01", // 4217 may be written, 4218 not
    ] {
        assert_eq!(refusal(&mut board, request), Some(2), "{request}");
    }
    // The refused pair has left 4217 alone.
    assert_eq!(
        board.handle(&seal(bytes("01 03 10 79 00 01"))),
        Some(seal(bytes("01 03 02 00 00")))
    );
}

#[test]
fn wrong_values_get_exception_3() {
    let mut board = unlocked();
    assert_eq!(write(&mut board, &[5]), Some(3), "unknown command");
    assert_eq!(write(&mut board, &[41, 0]), Some(3), "mask 0");
    assert_eq!(write(&mut board, &[67, 32]), Some(3), "mask above 31");
    assert_eq!(write(&mut board, &[80, 3]), Some(3), "two axes");
    assert_eq!(write(&mut board, &[80, 1, 200, 50, 0, 0, 40, 0, 9]), Some(3), "no speed");
    assert_eq!(refusal(&mut board, "01 05 01 00 12 34"), Some(3));
    assert_eq!(refusal(&mut board, "01 06 10 32 04 00"), Some(3), "analog output 1024");
}

#[test]
fn every_truncation_wrong_check_sum_and_wrong_station_gets_silence() {
    let mut board = unlocked();
    let handled = board.frames_handled();
    for text in VECTORS {
        let frame = bytes(text);
        for length in 0..frame.len() {
            assert_eq!(board.handle(&frame[..length]), None, "{length} bytes of {text}");
        }
        for place in 0..frame.len() {
            let mut wrong = frame.clone();
            wrong[place] ^= 0x10;
            assert_eq!(board.handle(&wrong), None, "byte {place} of {text}");
        }
        let mut foreign = frame[..frame.len() - 2].to_vec();
        foreign[0] = 2;
        assert_eq!(board.handle(&seal(foreign)), None);
    }
    assert_eq!(board.frames_handled(), handled);
    assert_eq!((board.counters(), board.outputs()), ([0; 5], 0));
}

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
    send(&mut board, go(BoardAxis::X, 1_000_000));
    board.advance(1000 * MS);
    board.set_enable(false);
    board.advance(99 * MS);
    assert!(!board.status().enable_open() && !board.status().locked());
    board.advance(50 * MS);
    assert!(board.status().enable_open() && board.status().locked());
    // Stopped when the filter passed the loss on: 100 ms at 20 kHz after it, not 149.
    let start = (10_100.0_f64 * 0.396 + 20_000.0 * 0.604).round();
    assert_eq!(f64::from(board.counters()[0]), start + 2000.0);
    // Command 66 is answered and does nothing while ENABLE is open; its return alone does nothing either.
    assert_eq!(board.handle(&vector(1)), Some(vector(2)));
    assert!(board.status().locked());
    board.set_enable(true);
    assert!(!board.status().enable_open() && board.status().locked());
    board.handle(&vector(1)).unwrap();
    assert!(!board.status().locked());
    board.advance(1000 * MS);
    assert_eq!(f64::from(board.counters()[0]), start + 2000.0);
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
    assert_eq!(
        board.handle(&seal(bytes("01 04 04 0D 00 01"))),
        Some(seal(bytes("01 04 02 00 06")))
    );
}

#[test]
fn a_moving_axis_keeps_its_counter_and_a_standing_one_ignores_speed() {
    let mut board = unlocked();
    board.handle(&vector(9)).unwrap();
    board.advance(100 * MS);
    assert_eq!(board.counters()[0], 0);
    send(&mut board, go(BoardAxis::X, 1_000_000));
    board.advance(1000 * MS);
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
    assert!((board.velocity(BoardAxis::X) - 200_000.0).abs() < 1e-6);
}

#[test]
fn recipes_show_their_registers_on_the_pages() {
    let mut board = unlocked();
    // Recipes of 100 registers; page 1 shows recipe 2, page 0 recipe 0.
    assert_eq!(refusal(&mut board, "01 10 16 00 00 03 06 00 64 00 00 00 02"), None);
    assert_eq!(refusal(&mut board, "01 06 16 FF 12 34"), None); // 5887, first of page 1
    assert_eq!(refusal(&mut board, "01 06 16 01 00 02"), None); // page 0 shows recipe 2 too
    assert_eq!(
        board.handle(&seal(bytes("01 03 16 05 00 01"))),
        Some(seal(bytes("01 03 02 12 34")))
    );
    // Offset 100 is beyond the recipe; recipe 50 is beyond the 5000 registers.
    assert_eq!(refusal(&mut board, "01 03 16 69 00 01"), Some(2));
    assert_eq!(refusal(&mut board, "01 06 16 01 00 32"), None);
    assert_eq!(refusal(&mut board, "01 03 16 05 00 01"), Some(2));
    // A new size erases all.
    assert_eq!(refusal(&mut board, "01 10 16 00 00 02 04 00 C8 00 01"), None);
    assert_eq!(
        board.handle(&seal(bytes("01 03 16 05 00 01"))),
        Some(seal(bytes("01 03 02 00 00")))
    );
    assert_eq!(refusal(&mut board, "01 06 16 00 00 FB"), Some(3));
}

#[test]
fn user_bits_and_registers_hold_what_is_written() {
    let mut board = unlocked();
    assert_eq!(refusal(&mut board, "01 0F 01 9E 00 02 01 03"), None); // 414, 415
    assert_eq!(board.handle(&seal(bytes("01 01 01 9D 00 03"))), Some(seal(bytes("01 01 01 06"))));
    for address in ["10 36", "10 64", "10 66", "14 00"] {
        assert_eq!(refusal(&mut board, &format!("01 06 {address} BE EF")), None);
        let read = board.handle(&seal(bytes(&format!("01 03 {address} 00 01"))));
        assert_eq!(read, Some(seal(bytes("01 03 02 BE EF"))));
    }
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
        cuts.iter().for_each(|cut| chunked.advance(*cut));
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
