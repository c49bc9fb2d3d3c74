//! Tests of the register map: exceptions, requests without an answer, and register contents.

use super::*;
use crate::protocol::vectors::VECTORS;

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
    answers(&mut board, "01 03 10 79 00 01", "01 03 02 00 00");
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
    // Whole frames for another address are seen and not handled.
    assert_eq!(board.frames_seen(), handled + u64::try_from(VECTORS.len()).unwrap());
    assert_eq!((board.counters(), board.outputs()), ([0; 5], 0));
}

#[test]
fn recipes_show_their_registers_on_the_pages() {
    let mut board = unlocked();
    // Recipes of 100 registers; page 1 shows recipe 2, page 0 recipe 0.
    assert_eq!(refusal(&mut board, "01 10 16 00 00 03 06 00 64 00 00 00 02"), None);
    assert_eq!(refusal(&mut board, "01 06 16 FF 12 34"), None); // 5887, first of page 1
    assert_eq!(refusal(&mut board, "01 06 16 01 00 02"), None); // page 0 shows recipe 2 too
    answers(&mut board, "01 03 16 05 00 01", "01 03 02 12 34");
    // Offset 100 is beyond the recipe; recipe 50 is beyond the 5000 registers.
    assert_eq!(refusal(&mut board, "01 03 16 69 00 01"), Some(2));
    assert_eq!(refusal(&mut board, "01 06 16 01 00 32"), None);
    assert_eq!(refusal(&mut board, "01 03 16 05 00 01"), Some(2));
    // A new size erases all.
    assert_eq!(refusal(&mut board, "01 10 16 00 00 02 04 00 C8 00 01"), None);
    answers(&mut board, "01 03 16 05 00 01", "01 03 02 00 00");
    assert_eq!(refusal(&mut board, "01 06 16 00 00 FB"), Some(3));
}

#[test]
fn user_bits_and_registers_hold_what_is_written() {
    let mut board = unlocked();
    assert_eq!(refusal(&mut board, "01 0F 01 9E 00 02 01 03"), None); // 414, 415
    answers(&mut board, "01 01 01 9D 00 03", "01 01 01 06");
    for address in ["10 36", "10 64", "10 66", "14 00"] {
        assert_eq!(refusal(&mut board, &format!("01 06 {address} BE EF")), None);
        answers(&mut board, &format!("01 03 {address} 00 01"), "01 03 02 BE EF");
    }
}

#[test]
fn reserved_addresses_within_the_tables_read_0() {
    let mut board = unlocked();
    // Everything around them that can be set is.
    for input in 1..=32 {
        board.set_input(input, true);
    }
    assert_eq!(refusal(&mut board, "01 0F 01 00 00 20 04 FF FF FF FF"), None);
    for number in 1..=4 {
        board.set_analog_input(number, 1023);
    }
    for (request, answer) in [
        ("01 02 08 10 00 10", "01 02 02 00 00"), // inputs 2064 to 2079
        ("01 02 08 48 00 08", "01 02 01 00"),    // inputs 2120 to 2127
        ("01 01 01 21 00 08", "01 01 01 00"),    // coils 289 to 296
        ("01 01 01 A0 00 08", "01 01 01 00"),    // coils 416 to 423
        ("01 04 04 16 00 08", "01 04 10 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00"), // 1046 to 1053
        ("01 03 10 80 00 02", "01 03 04 00 00 00 00"), // 4224, 4225
    ] {
        answers(&mut board, request, answer);
    }
}

#[test]
fn address_2087_is_1_while_enable_is_off() {
    let mut board = unlocked();
    answers(&mut board, "01 02 08 27 00 01", "01 02 01 00");
    board.set_enable(false);
    board.advance(101 * MS);
    answers(&mut board, "01 02 08 27 00 01", "01 02 01 01");
}
