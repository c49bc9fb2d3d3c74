//! The emulated board against the digest's vectors and the behaviour that digest and manual describe.

mod behaviour;
mod frames;
mod homing;
mod limits;
mod map;
mod power;
mod probe;
mod segments;

use super::*;
use crate::{
    BoardStop, Command, MoveProfile,
    protocol::{
        frame::seal,
        parameters,
        vectors::{bytes, vector},
    },
    tests::{MS, assumed, go, home, segment_of_x, switch, unlocked, x_only},
};

/// An unlocked board between switches.
fn on_bench(cams: Vec<Cam>) -> Board {
    let mut board = unlocked();
    board.set_bench(Bench { cams, encoder: None });
    board
}

/// Extended B18 to B27: homing under way and failed per axis.
fn homing_bits(board: &Board) -> u32 {
    board.extended_status() & 0x0FFC_0000
}

/// True if no probe is under way and none has failed.
fn found(board: &Board) -> bool {
    !board.status().probing() && !board.status().probe_failed()
}

/// Sends a command from address 1 and expects it to be accepted.
fn send(board: &mut Board, command: Command) {
    assert_eq!(write(board, &command.registers()), None, "{command:?}");
}

/// Sends a command and lets time pass.
fn send_for(board: &mut Board, command: Command, ms: i64) {
    send(board, command);
    board.advance(ms * MS);
}

/// Writes a parameter as a master does.
fn set_parameter(board: &mut Board, number: u16, value: u32) {
    let mut frame = vec![1, 16];
    frame.extend((4352 + 2 * number).to_be_bytes());
    frame.extend([0, 2, 4]);
    frame.extend(value.to_be_bytes());
    assert_eq!(board.handle(&seal(frame)).unwrap()[1], 16);
}

/// Writes command registers; the exception code, if there is one.
fn write(board: &mut Board, registers: &[u16]) -> Option<u8> {
    let count = u8::try_from(registers.len()).unwrap();
    let mut frame = vec![1, 16, 0x10, 0, 0, count, 2 * count];
    frame.extend(registers.iter().flat_map(|register| register.to_be_bytes()));
    let answer = board.handle(&seal(frame)).unwrap();
    (answer[1] != 16).then_some(answer[2])
}

/// The exception code that a request from address 1 gets.
fn refusal(board: &mut Board, request: &str) -> Option<u8> {
    let answer = board.handle(&seal(bytes(request))).unwrap();
    (answer[1] & 0x80 != 0).then(|| answer[2])
}

/// Checks the answer to a request; both without their check sums.
#[track_caller]
fn answers(board: &mut Board, request: &str, answer: &str) {
    assert_eq!(board.handle(&seal(bytes(request))), Some(seal(bytes(answer))), "{request}");
}

/// The X counter.
fn x(board: &Board) -> f64 {
    f64::from(board.counters()[0])
}

/// Compares whole numbers.
#[track_caller]
fn same(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
}
