//! The emulated device against the digest's vectors and the behaviour that digest and manual describe.

mod assumptions;
mod behaviour;
mod frames;
mod homing;
mod inputs;
mod memory;

use super::*;
use crate::{
    Assumptions, Command, Init, RejectCode,
    protocol::frame::{Answer, encode},
};

const MS: i64 = 1_000_000;

/// A device in mode remote.
fn remote_with(options: &DeviceOptions) -> Device {
    let mut device = Device::new(options);
    ask_and_wait(&mut device, Command::Mode(Some(Mode::Remote)), 250);
    assert_eq!(device.mode(), Mode::Remote);
    device
}

fn remote() -> Device {
    remote_with(&DeviceOptions::default())
}

/// The same where something is assumed otherwise.
fn assuming(change: impl FnOnce(&mut Assumptions)) -> Device {
    let mut options = DeviceOptions::default();
    change(&mut options.assumptions);
    remote_with(&options)
}

#[track_caller]
fn decode(bytes: Vec<u8>) -> Answer {
    Answer::decode(&bytes.try_into().unwrap()).unwrap()
}

/// Sends a command to address 1 and expects it to be accepted.
#[track_caller]
fn ask(device: &mut Device, command: Command) -> Answer {
    let answer = asked(device, command);
    assert!(!answer.status.rejected(), "{command:?}: {answer:?}");
    answer
}

/// The same, and waits for the number of milliseconds.
#[track_caller]
fn ask_and_wait(device: &mut Device, command: Command, ms: i64) {
    ask(device, command);
    device.advance(ms * MS);
}

/// Sends a command to address 1.
#[track_caller]
fn asked(device: &mut Device, command: Command) -> Answer {
    decode(device.handle(&encode(1, &command)).unwrap())
}

/// Why a command to address 1 is refused.
#[track_caller]
fn refusal(device: &mut Device, command: Command) -> Option<RejectCode> {
    let answer = asked(device, command);
    answer.status.rejected().then(|| RejectCode::from_number(answer.tag).unwrap())
}

/// The trajectory flags.
#[track_caller]
fn flags(device: &mut Device) -> TrajectoryFlags {
    TrajectoryFlags::from_tag(ask(device, Command::Ping).tag)
}

/// Sets a parameter of one word, or both of two.
#[track_caller]
fn set(device: &mut Device, parameter: u16, value: i32) {
    let [a, b, c, d] = value.to_le_bytes();
    let low = u16::from_le_bytes([a, b]);
    ask(device, Command::Set { parameter, value: low });
    let entry = crate::protocol::parameters::parameter_at(parameter).unwrap().0;
    if entry.kind.is_long() {
        let high = u16::from_le_bytes([c, d]);
        ask(device, Command::Set { parameter: parameter + 1, value: high });
    }
}

/// Switches an input, and waits for the number of milliseconds.
fn switch(device: &mut Device, input: Input, level: bool, ms: i64) {
    device.set_input(input, level);
    device.advance(ms * MS);
}

#[track_caller]
fn read(device: &mut Device, variable: u16) -> i32 {
    ask(device, Command::Read { variable }).number()
}

fn go_to(target: i32, speed: u16, rate: u16) -> Command {
    Command::GoTo { target, profile: Some((speed, rate)) }
}

/// Compares whole numbers and others.
#[track_caller]
fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} is not {expected} ± {within}");
}
