//! Frames against the digest's vectors, by number, in both directions.

use std::collections::BTreeSet;

use super::*;
use crate::{
    Alarms, Init, IoUpdate, LoadSource, Mode, TagLayout, TrajectoryFlags,
    protocol::vectors::{VECTORS, vector},
};

/// The vectors that are commands.
pub(crate) fn commands() -> Vec<(usize, u8, Command)> {
    let go_to = |target, profile| Command::GoTo { target, profile };
    let step = |distance| Command::Step { distance, profile: None };
    let set = |parameter, value| Command::Set { parameter, value };
    let io = IoUpdate { set: 0b100, clear_active: 0b1000, ..IoUpdate::default() };
    vec![
        (1, 1, Command::Ping),
        (4, 1, Command::Mode(Some(Mode::Remote))),
        (6, 1, Command::TrajectoryInit(Init::Position)),
        (7, 1, Command::TrajectoryInit(Init::Homing)),
        (9, 1, go_to(3200, None)),
        (11, 1, go_to(-6400, Some((300, 1000)))),
        (13, 1, step(200)),
        (14, 1, Command::Start { speed: 600, rate: 0 }),
        (15, 1, Command::Start { speed: -600, rate: 500 }),
        (16, 1, Command::Stop { rate: 0 }),
        (17, 1, Command::Stop { rate: 2000 }),
        (18, 0, Command::Stop { rate: 0 }),
        (19, 1, Command::Read { variable: 75 }),
        (21, 1, Command::Write { variable: 130, value: 0xFFFF }),
        (22, 1, set(30, 600)),
        // Low and high word of −100000 in two's complement.
        (24, 1, set(26, 0x7960)),
        (25, 1, set(27, 0xFFFE)),
        (26, 1, set(66, 9830)),
        (27, 1, Command::Get { parameter: 0 }),
        (29, 1, Command::IoUpdate(io)),
        (31, 1, Command::Save),
        (32, 1, Command::Load(LoadSource::Factory)),
        (33, 1, Command::Reset { bootloader: false }),
    ]
}

/// The vectors that are answers.
pub(crate) fn answers() -> Vec<(usize, Answer)> {
    let done = TrajectoryFlags::DONE.tag(TagLayout::Diagram);
    let in_motion = TrajectoryFlags::IN_MOTION.tag(TagLayout::Diagram);
    let remote = Status::new(1, 3);
    let answer = |status, number: i32, tag| Answer { status, data: number.to_le_bytes(), tag };
    let words = |low: u16, high: u16| i32::from(high) << 16 | i32::from(low);
    let alarm = Status::new(1, 0).with(Status::ALARM, true);
    let homing = remote.with(Status::SEQUENCE_BUSY, true);
    let refused = |mode| Status::new(1, mode).with(Status::REJECT, true);
    vec![
        (2, answer(remote, 0, done)),
        (3, answer(alarm, 0, Alarms::UNDERVOLTAGE.0)),
        (5, answer(Status::new(1, Mode::Changing.number()), 0, 0)),
        (8, answer(homing, -123, in_motion)),
        (10, answer(remote, 0, 0)),
        (12, answer(remote, 1600, in_motion)),
        (20, answer(remote, -1000, 0)),
        (23, answer(remote, words(500, 600), 500)),
        (28, answer(remote, words(0x1020, 0x1020), 0x1020)),
        (30, answer(remote, 0x0008_000C, 0)),
        (34, answer(refused(0), 0, RejectCode::BadMode.number())),
        (35, answer(refused(31), 0, RejectCode::Working.number())),
    ]
}

#[test]
fn every_vector_is_a_command_or_an_answer() {
    let numbers: BTreeSet<usize> = commands()
        .iter()
        .map(|(number, ..)| *number)
        .chain(answers().iter().map(|(number, _)| *number))
        .collect();
    assert_eq!(numbers, (1..=VECTORS.len()).collect());
    assert_eq!(VECTORS.len(), 35);
}

#[test]
fn commands_are_the_bytes_of_their_vectors_and_back() {
    for (number, address, command) in commands() {
        let bytes = vector(number);
        assert_eq!(encode(address, &command), bytes, "vector {number}");
        assert_eq!(decode(&bytes), Some((address, Ok(command))), "vector {number}");
        assert_eq!(command_length(&bytes[..2]), Some(bytes.len()), "vector {number}");
    }
}

#[test]
fn answers_are_the_bytes_of_their_vectors_and_back() {
    for (number, answer) in answers() {
        let bytes: [u8; 9] = vector(number).try_into().unwrap();
        assert_eq!(answer.encode(), bytes, "vector {number}");
        assert_eq!(Answer::decode(&bytes), Some(answer), "vector {number}");
    }
    // Values as the digest has them, read without the fields that made them.
    let read = |number: usize| Answer::decode(&vector(number).try_into().unwrap()).unwrap();
    assert_eq!(read(8).number(), -123);
    assert_eq!(read(23).words(), (500, 600));
    assert_eq!(read(12).status.mode(), 3);
}

#[test]
fn every_changed_bit_and_every_truncation_is_noticed() {
    for number in 1..=VECTORS.len() {
        let bytes = vector(number);
        for place in 0..8 * bytes.len() {
            let mut wrong = bytes.clone();
            wrong[place / 8] ^= 1 << (place % 8);
            assert_eq!(decode(&wrong), None, "vector {number}, bit {place}");
            let answer: Result<[u8; 9], _> = wrong.try_into();
            assert!(answer.is_err() || Answer::decode(&answer.unwrap()).is_none());
        }
        for length in 0..bytes.len() {
            assert_eq!(decode(&bytes[..length]), None, "vector {number}, {length} bytes");
        }
    }
}

/// "Trame de commande": 7, 11, 19 and 35 bytes for EE 0 to 3; a length that does not belong to the code and unknown
/// codes are refused, addresses above 31 are none.
#[test]
fn lengths_and_codes_that_do_not_belong_together_are_refused() {
    for (ee, length) in [(0_u8, 7_usize), (1, 11), (2, 19), (3, 35)] {
        assert_eq!(command_length(&[1, ee << 6 | 1]), Some(length));
        let mut frame = vec![0; length - 1];
        frame[0] = 1;
        frame[1] = ee << 6 | 0x12;
        let expected =
            if ee == 0 { Ok(Command::Get { parameter: 0 }) } else { Err(RejectCode::BadParams) };
        assert_eq!(decode(&seal(frame.clone())), Some((1, expected)));
        frame[1] = ee << 6 | 0x25;
        assert_eq!(decode(&seal(frame.clone())), Some((1, Err(RejectCode::NotAvailable))));
        frame[0] = 0x20;
        assert_eq!(decode(&seal(frame)), None);
    }
    // WRITE without its value, a mode and an operation that do not exist, LOAD from nowhere.
    for frame in [
        [1, 0x0E, 130, 0, 0, 0],
        [1, 4, 2, 0, 0, 0],
        [1, 4, 31, 0, 0, 0],
        [1, 0x20, 6, 0, 0, 0],
        [1, 0x14, 1, 0, 0, 0],
    ] {
        assert_eq!(decode(&seal(frame.to_vec())), Some((1, Err(RejectCode::BadParams))));
    }
    assert_eq!(decode(&seal(vec![1, 4, 255, 0, 0, 0])), Some((1, Ok(Command::Mode(None)))));
}

/// STEP with speed and acceleration is 64h, as GOTO with them is 63h.
#[test]
fn a_step_with_a_profile_has_eight_bytes() {
    let step = Command::Step { distance: 200, profile: Some((300, 1000)) };
    let bytes = [1, 0x64, 0xC8, 0, 0, 0, 0x2C, 0x01, 0xE8, 0x03];
    assert_eq!(encode(1, &step), seal(bytes.to_vec()));
    assert_eq!(decode(&encode(1, &step)), Some((1, Ok(step))));
}
