//! Tests of the assumptions about what the manual leaves open: alternatives differ from the default.

use super::*;
use crate::{AnswerLength, BadFrame, SetEffect, ZeroRate};

/// Waits until it is at rest after a command.
#[track_caller]
fn ask_and_rest(device: &mut Device, command: Command) {
    ask(device, command);
    let mut most = 100;
    while device.motion().1 != 0.0 || !flags(device).contains(TrajectoryFlags::DONE) {
        device.advance(100 * MS);
        most -= 1;
        assert!(most > 0, "it never rests");
    }
}

#[test]
fn frames_of_others_get_silence_and_spoilt_ones_may_be_refused() {
    let good = encode(1, &Command::Ping);
    let spoilt = |address| {
        let mut frame = encode(address, &Command::Ping);
        frame[6] ^= 1;
        frame
    };
    let refused = BadFrame::Refused(RejectCode::Generic);
    for (bad_frame, refusal) in [(BadFrame::Silent, None), (refused, Some((true, 0, 1)))] {
        let mut device = assuming(|assumed| assumed.bad_frame = bad_frame);
        let handled = device.frames_handled();
        for bad in [&spoilt(1)[..], &good[..6]] {
            let answer = device.handle(bad).map(decode);
            let shown = answer
                .map(|answer| (answer.status.rejected(), answer.tag, answer.status.address()));
            assert_eq!(shown, refusal, "{bad:02X?}, {bad_frame:?}");
        }
        for frame in [spoilt(0), spoilt(2), encode(2, &Command::Ping)] {
            assert_eq!(device.handle(&frame), None, "{frame:02X?}, {bad_frame:?}");
        }
        assert_eq!(device.frames_handled(), handled);
        assert!(device.handle(&good).is_some());
    }
}

/// RR: nine bytes in any case, or 5 and as many as the command has data.
#[test]
fn answers_may_have_as_many_data_as_commands() {
    let far = Command::GoTo { target: 3200, profile: Some((300, 1000)) };
    for (answer_length, lengths) in
        [(AnswerLength::Four, [9, 9]), (AnswerLength::AsCommand, [9, 13])]
    {
        let mut device = assuming(|assumed| assumed.answer_length = answer_length);
        let frames = [encode(1, &Command::Ping), encode(1, &far)];
        for (frame, length) in frames.iter().zip(lengths) {
            let answer = device.handle(frame).unwrap();
            assert_eq!(answer.len(), length, "{answer_length:?}");
            assert_eq!(frame::check_sum(&answer), 0);
            // STA as ever: mode 3 of address 1, and nothing between the position and TAG.
            assert_eq!((answer[1] & 0x1F, answer[0] & 0xBE), (1, 0x86), "{answer:02X?}");
            assert!(answer[6..length - 3].iter().all(|byte| *byte == 0), "{answer:02X?}");
        }
    }
}

/// PING with eight bytes of data, and codes that do not exist: those are that, whatever their length.
#[test]
fn codes_and_lengths_are_refused() {
    use RejectCode::{BadParams, NotAvailable};
    let mut device = remote();
    for (code, expected) in [(0x25, NotAvailable), (0x3F, NotAvailable), (0x41, BadParams)] {
        let mut frame = vec![1, code];
        frame.extend(vec![0; 4 << (code >> 6)]);
        let answer = decode(device.handle(&frame::seal(frame)).unwrap());
        let shown = (answer.status.rejected(), RejectCode::from_number(answer.tag));
        assert_eq!(shown, (true, Some(expected)), "{code:x}");
    }
}

#[test]
fn steps_count_from_the_setpoint() {
    let step = |distance| Command::Step { distance, profile: None };
    let mut device = remote();
    ask_and_wait(&mut device, go_to(10_000, 300, 0), 300);
    let expected = device.counter() + 100;
    ask_and_rest(&mut device, step(100));
    assert_eq!(device.counter(), expected);
    // At rest, and two in a row.
    ask_and_rest(&mut device, step(-100));
    assert_eq!(device.counter(), expected - 100);
    ask(&mut device, step(1000));
    ask_and_rest(&mut device, step(1000));
    assert_eq!(device.counter(), expected + 900);
}

#[test]
fn a_deceleration_of_0_may_be_none_at_all() {
    // From 400 rpm: 200 ms with AccMax, 400 ms with 1000 rpm/s, 133.3 ms with 3000 rpm/s.
    let acceleration = ZeroRate::AsAcceleration;
    for (zero_rate, rate, rests_ms) in [
        (acceleration, 0, 200),
        (acceleration, 3000, 200),
        (ZeroRate::Unlimited, 0, 1),
        (ZeroRate::Unlimited, 1000, 400),
        (ZeroRate::Unlimited, 3000, 134),
    ] {
        let mut device = assuming(|assumed| assumed.zero_rate = zero_rate);
        set(&mut device, 32, 0);
        ask_and_wait(&mut device, Command::Start { speed: 400, rate: 0 }, 1000);
        ask(&mut device, Command::Stop { rate });
        device.advance((rests_ms - 1) * MS);
        let early = device.motion().1;
        assert!(rests_ms == 1 || early > 0.0, "{zero_rate:?} {rate}");
        device.advance(2 * MS);
        near(device.motion().1, 0.0, 0.0);
    }
    // A GOTO ends on its target, and a limit switch stops at once.
    let mut device = assuming(|assumed| assumed.zero_rate = ZeroRate::Unlimited);
    set(&mut device, 32, 0);
    set(&mut device, 33, 0);
    ask_and_rest(&mut device, go_to(5000, 0, 0));
    assert_eq!(device.counter(), 5000);
    ask_and_wait(&mut device, go_to(1_000_000, 0, 0), 1000);
    let before = device.motion().0;
    switch(&mut device, Input::LimP, true, 1);
    near(device.motion().0 - before, 0.0, 0.5);
}

#[test]
fn set_may_wait_for_the_mode() {
    let mut device = assuming(|assumed| assumed.set_effect = SetEffect::WithMode);
    set(&mut device, 30, 100);
    assert_eq!(ask(&mut device, Command::Get { parameter: 30 }).words(), (500, 100));
    ask_and_wait(&mut device, Command::Start { speed: 400, rate: 0 }, 1000);
    assert_eq!(read(&mut device, 79), 400);
    ask_and_wait(&mut device, Command::Mode(Some(Mode::Remote)), 250);
    ask_and_wait(&mut device, Command::Start { speed: 400, rate: 0 }, 1000);
    assert_eq!(read(&mut device, 79), 100);
}

#[test]
fn set_may_begin_the_mode_anew() {
    let mut device = assuming(|assumed| assumed.set_effect = SetEffect::RestartsMode);
    ask_and_rest(&mut device, go_to(300, 0, 0));
    let answer = ask(&mut device, Command::Set { parameter: 30, value: 100 });
    assert_eq!((answer.status.mode(), answer.words()), (31, (500, 100)));
    assert_eq!(refusal(&mut device, go_to(1, 0, 0)), Some(RejectCode::Working));
    device.advance(250 * MS);
    assert_eq!((device.mode(), device.counter()), (Mode::Remote, 0));
    ask_and_wait(&mut device, Command::Start { speed: 400, rate: 0 }, 1000);
    assert_eq!(read(&mut device, 79), 100);
    // Of two words, the low one alone begins nothing.
    let answer = ask(&mut device, Command::Set { parameter: 28, value: 7 });
    assert_eq!(answer.status.mode(), 3);
    let answer = ask(&mut device, Command::Set { parameter: 29, value: 0 });
    assert_eq!(answer.status.mode(), 31);
}
