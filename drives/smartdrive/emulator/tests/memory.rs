//! Parameters: three copies, words, ranges, and what survives.

use super::*;
use crate::{
    LoadSource,
    protocol::parameters::{PARAMETERS, VARIABLES},
};

/// Saved, working and factory value of a word.
fn copies(device: &mut Device, parameter: u16) -> (u16, u16, u16) {
    let answer = ask(device, Command::Get { parameter });
    let (saved, working) = answer.words();
    (saved, working, answer.tag)
}

#[test]
fn there_are_three_copies_of_every_parameter() {
    let mut device = remote();
    for entry in PARAMETERS.iter().filter(|entry| entry.writable && entry.index != 2) {
        let [a, b, ..] = entry.factory.to_le_bytes();
        let factory = u16::from_le_bytes([a, b]);
        let other = if factory == 1024 { 512 } else { 1024 };
        set(&mut device, entry.index, i32::from(other));
        assert_eq!(copies(&mut device, entry.index), (factory, other, factory), "{}", entry.name);
        let [load_factory, load_saved] =
            [LoadSource::Factory, LoadSource::Saved].map(Command::Load);
        let steps = [
            (Command::Save, other),
            (load_factory, factory),
            (load_saved, other),
            (load_factory, factory),
        ];
        for (command, working) in steps {
            ask_and_wait(&mut device, command, 250);
            let expected = (other, working, factory);
            assert_eq!(copies(&mut device, entry.index), expected, "{}, {command:?}", entry.name);
        }
    }
}

#[test]
fn ranges_are_kept() {
    let mut device = remote();
    let set = |parameter, value| Command::Set { parameter, value };
    let (bad, none) = (Some(RejectCode::BadParams), Some(RejectCode::NotAvailable));
    for entry in &PARAMETERS {
        let before = copies(&mut device, entry.index);
        let wrong = if !entry.writable {
            vec![1]
        } else if entry.kind.is_long() {
            Vec::new()
        } else {
            let below = (entry.low == 1).then_some(0);
            u16::try_from(entry.high + 1).into_iter().chain(below).collect()
        };
        for value in wrong {
            assert_eq!(refusal(&mut device, set(entry.index, value)), bad, "{}", entry.name);
        }
        assert_eq!(copies(&mut device, entry.index), before, "{}", entry.name);
    }
    // Not negative: the high word of 32 bits.
    assert_eq!(refusal(&mut device, set(107, 0x8000)), bad);
    for missing in [1, 45, 121, 0xFFFF] {
        assert_eq!(refusal(&mut device, Command::Get { parameter: missing }), none);
        assert_eq!(refusal(&mut device, set(missing, 0)), none);
    }
}

#[test]
fn a_32_bit_value_changes_with_its_high_word() {
    let mut device = remote();
    set(&mut device, 26, -1);
    set(&mut device, 28, 0x0001_FFFF);
    ask(&mut device, Command::Set { parameter: 28, value: 5 });
    // The limit still is 131071, not 65541.
    assert_eq!(refusal(&mut device, go_to(131_071, 0, 0)), None);
    assert_eq!(refusal(&mut device, go_to(131_072, 0, 0)), Some(RejectCode::BadParams));
    ask(&mut device, Command::Set { parameter: 29, value: 0 });
    assert_eq!(refusal(&mut device, go_to(5, 0, 0)), None);
    assert_eq!(refusal(&mut device, go_to(6, 0, 0)), Some(RejectCode::BadParams));
}

#[test]
fn what_is_saved_survives_as_an_image() {
    let mut device = remote();
    set(&mut device, 30, 777);
    set(&mut device, 100, -100_000);
    ask_and_wait(&mut device, Command::Save, 250);
    set(&mut device, 31, 5);
    let image = device.flash();
    let mut again = Device::with_flash(&DeviceOptions::default(), &image).unwrap();
    assert_eq!(copies(&mut again, 30), (777, 777, 500));
    assert_eq!(copies(&mut again, 101), (0xFFFE, 0xFFFE, 0));
    assert_eq!(copies(&mut again, 31), (2000, 2000, 2000));
    for length in 0..image.len() {
        assert!(Device::with_flash(&DeviceOptions::default(), &image[..length]).is_none());
    }
    for place in 0..image.len() {
        let mut wrong = image.clone();
        wrong[place] ^= 0x10;
        assert!(Device::with_flash(&DeviceOptions::default(), &wrong).is_none(), "byte {place}");
    }
}

#[test]
fn power_lost_while_saving_leaves_what_was_saved() {
    let mut device = remote();
    set(&mut device, 30, 777);
    ask_and_wait(&mut device, Command::Save, 100);
    device.set_supply(0);
    device.set_supply(24);
    device.advance(300 * MS);
    assert_eq!(copies(&mut device, 30), (500, 500, 500));
}

#[test]
fn a_new_address_counts_from_the_next_command() {
    let mut device = remote();
    let answer = ask(&mut device, Command::Set { parameter: 2, value: 7 });
    assert_eq!(answer.status.address(), 1);
    assert_eq!(device.handle(&encode(1, &Command::Ping)), None);
    let answer = decode(device.handle(&encode(7, &Command::Ping)).unwrap());
    assert_eq!(answer.status.address(), 7);
}

#[test]
fn every_variable_is_read_and_only_outputs_are_written() {
    let mut device = remote();
    for entry in &VARIABLES {
        read(&mut device, entry.index);
        let write = Command::Write { variable: entry.index, value: 0xFFFF };
        let expected = (!entry.writable).then_some(RejectCode::BadParams);
        assert_eq!(refusal(&mut device, write), expected, "{}", entry.name);
    }
    for missing in [0, 41, 46, 80, 127, 131, 156] {
        let unknown = Command::Read { variable: missing };
        assert_eq!(refusal(&mut device, unknown), Some(RejectCode::NotAvailable));
    }
}

#[test]
fn another_divisor_makes_other_speeds() {
    let mut device = remote();
    set(&mut device, 44, 64);
    ask_and_wait(&mut device, Command::Start { speed: 60, rate: 0 }, 1000);
    // One turn a second: 200 · 64 µsteps.
    near(device.motion().1, 12_800.0, 1e-6);
}
