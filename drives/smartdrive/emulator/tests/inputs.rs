//! Inputs, their captures, encoders, and the modes that move by inputs.

use super::*;
use crate::IoUpdate;

fn captures(device: &mut Device) -> (u8, u8) {
    let [_, _, active, reverse] = ask(device, Command::IoUpdate(IoUpdate::default())).data;
    (active, reverse)
}

/// "Pour qu'un pulse soit capturé sa durée doit être supérieure à 100 µs".
#[test]
fn pulses_longer_than_100_us_are_caught() {
    for (length_ns, caught) in [(50_000, 0), (100_000, 0), (150_000, 0b1000)] {
        let mut device = remote();
        device.set_input(Input::Go, true);
        device.advance(length_ns);
        switch(&mut device, Input::Go, false, 1);
        assert_eq!(captures(&mut device), (caught, caught), "{length_ns} ns");
    }
}

#[test]
fn every_input_has_its_bits_and_variables() {
    for (place, input) in (0_u16..).zip(Input::ALL) {
        let mut device = remote();
        let bit = 1 << (3 + place);
        let variables =
            |device: &mut Device| [0, 1, 2, 3].map(|k| read(device, 136 + 4 * place + k));
        switch(&mut device, input, true, 1);
        assert_eq!(ask(&mut device, Command::IoUpdate(IoUpdate::default())).data[0], bit);
        assert_eq!(captures(&mut device), (bit, 0));
        assert_eq!(variables(&mut device), [0xFFFF, 0xFFFF, 0xFFFF, 0]);
        switch(&mut device, input, false, 1);
        assert_eq!(captures(&mut device), (bit, bit));
        ask(&mut device, Command::IoUpdate(IoUpdate { clear_active: bit, ..IoUpdate::default() }));
        assert_eq!(captures(&mut device), (0, bit));
        assert_eq!(variables(&mut device), [0, 0xFFFF, 0, 0xFFFF]);
        ask(&mut device, Command::IoUpdate(IoUpdate { clear_reverse: bit, ..IoUpdate::default() }));
        assert_eq!(captures(&mut device), (0, 0));
    }
}

#[test]
fn outputs_are_set_and_cleared_and_left_alone() {
    let mut device = remote();
    let mut update = |clear, set| {
        ask(&mut device, Command::IoUpdate(IoUpdate { clear, set, ..IoUpdate::default() })).data[0]
    };
    assert_eq!(update(0, 0b011), 0b011);
    assert_eq!(update(0b001, 0b100), 0b110);
    // In both, and the bits of inputs: nothing happens.
    assert_eq!(update(0b011, 0b011), 0b110);
    assert_eq!(update(0, 0b1111_1000), 0b110);
    for (variable, on) in [(128, 0), (129, 0xFFFF), (130, 0xFFFF)] {
        assert_eq!(read(&mut device, variable), on);
    }
}

/// 4000 increments a turn of 3200 µsteps.
#[test]
fn encoders_count_and_are_zeroed_one_by_one() {
    let mut device = remote();
    set(&mut device, 50, 1000);
    ask_and_wait(&mut device, go_to(1600, 0, 0), 2000);
    let both = |device: &mut Device| [44, 45].map(|variable| read(device, variable));
    assert_eq!(both(&mut device), [2000, 500]);
    ask(&mut device, Command::TrajectoryInit(Init::Encoder1));
    assert_eq!(both(&mut device), [0, 500]);
    ask(&mut device, Command::TrajectoryInit(Init::Position));
    ask(&mut device, Command::TrajectoryInit(Init::Encoder2));
    ask_and_wait(&mut device, go_to(-3200, 0, 0), 2000);
    assert_eq!(both(&mut device), [-4000, -1000]);
    ask(&mut device, Command::TrajectoryInit(Init::Encoders));
    assert_eq!((both(&mut device), device.counter()), ([0, 0], -3200));
    let mut old = remote_with(&DeviceOptions { build: 309, ..DeviceOptions::default() });
    let refused = refusal(&mut old, Command::TrajectoryInit(Init::Encoders));
    assert_eq!(refused, Some(RejectCode::BadParams));
}

#[test]
fn analog_inputs_are_read() {
    let mut device = remote();
    device.set_analog(1, 1234);
    device.set_analog(2, 40_000);
    assert_eq!((read(&mut device, 42), read(&mut device, 43)), (1234, 32_767));
}

/// A device in a mode that moves by inputs.
fn in_mode(mode: Mode) -> Device {
    let mut device = remote();
    set(&mut device, 26, -1000);
    set(&mut device, 28, 9000);
    ask_and_wait(&mut device, Command::Mode(Some(mode)), 251);
    device
}

fn pulse(device: &mut Device, input: Input) {
    switch(device, input, true, 1);
    switch(device, input, false, 2000);
}

#[test]
fn modes_of_speed_follow_their_inputs() {
    for mode in [Mode::Velocity, Mode::VelocityDirection] {
        let mut device = in_mode(mode);
        switch(&mut device, Input::Go, true, 200);
        assert!(device.motion().1 > 0.0, "{mode:?}");
        switch(&mut device, Input::Go, false, 1000);
        near(device.motion().1, 0.0, 0.0);
        device.set_input(Input::Dir, true);
        switch(&mut device, Input::Go, mode == Mode::VelocityDirection, 20);
        assert!(device.motion().1 < 0.0, "{mode:?}");
        assert_eq!(refusal(&mut device, go_to(0, 0, 0)), Some(RejectCode::BadMode));
    }
    for mode in [Mode::VelocityStartStop, Mode::VelocityStartStopDirection] {
        let mut device = in_mode(mode);
        switch(&mut device, Input::Go, true, 1);
        switch(&mut device, Input::Go, false, 100);
        assert!(device.motion().1 > 0.0, "{mode:?}");
        pulse(&mut device, Input::Go);
        near(device.motion().1, 0.0, 0.0);
        assert!(device.counter() < 9000);
    }
}

#[test]
fn modes_of_distance_and_position_go_there() {
    let mut device = in_mode(Mode::Advance);
    pulse(&mut device, Input::Go);
    pulse(&mut device, Input::Go);
    assert_eq!(device.counter(), 6400);
    pulse(&mut device, Input::Dir);
    assert_eq!(device.counter(), 3200);
    let mut device = in_mode(Mode::AdvanceDirection);
    pulse(&mut device, Input::Go);
    assert_eq!(device.counter(), 3200);
    let mut device = in_mode(Mode::PushPull);
    switch(&mut device, Input::Go, true, 2000);
    assert_eq!(device.counter(), 3200);
    switch(&mut device, Input::Go, false, 2000);
    assert_eq!(device.counter(), 0);
    let mut device = in_mode(Mode::Position);
    device.set_analog(1, 16_384);
    device.advance(2000 * MS);
    // −1000 + 10000 · 16384 / 32767.
    assert_eq!(device.counter(), 4000);
}

#[test]
fn push_pull_with_a_home_switch_begins_with_homing() {
    let mut device = in_mode(Mode::PushPullHome);
    assert!(ask(&mut device, Command::Ping).status.sequence_busy());
    switch(&mut device, Input::Go, true, 500);
    switch(&mut device, Input::Go, false, 100);
    let answer = ask(&mut device, Command::Ping);
    assert!(!answer.status.sequence_busy());
    assert_eq!(answer.number(), 0);
}
