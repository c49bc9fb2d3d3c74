//! Tests of the assumptions about what the manual leaves open: every alternative differs from the default.

use super::*;
use crate::{
    AccCurrent, AnswerLength, BadFrame, BothBits, HomePosition, IoUpdate, LimitStop, SetEffect,
    StepFrom, ZeroRate,
};

fn assuming(change: impl FnOnce(&mut Assumptions)) -> Device {
    let mut options = DeviceOptions::default();
    change(&mut options.assumptions);
    remote_with(&options)
}

/// At rest where the next moment leads to.
#[track_caller]
fn rest(device: &mut Device) {
    let mut most = 100;
    while device.motion().1 != 0.0 || !flags(device).contains(TrajectoryFlags::DONE) {
        device.advance(100 * MS);
        most -= 1;
        assert!(most > 0, "it never rests");
    }
}

#[test]
fn frames_that_are_spoilt_may_be_refused() {
    let good = encode(1, &Command::Ping);
    let mut wrong = good.clone();
    wrong[6] ^= 1;
    let mut usual = assuming(|_| {});
    assert_eq!((usual.handle(&wrong), usual.handle(&good[..6])), (None, None));
    let refused = BadFrame::Refused(RejectCode::Generic);
    let mut device = assuming(|assumed| assumed.bad_frame = refused);
    let handled = device.frames_handled();
    for bad in [&wrong[..], &good[..6]] {
        let answer = Answer::decode(&device.handle(bad).unwrap().try_into().unwrap()).unwrap();
        assert_eq!((answer.status.rejected(), answer.tag, answer.status.address()), (true, 0, 1));
    }
    assert_eq!(device.frames_handled(), handled);
    // Those of others, and what nobody answers.
    for address in [0, 2] {
        let mut other = encode(address, &Command::Ping);
        other[6] ^= 1;
        assert_eq!(device.handle(&other), None);
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

#[test]
fn codes_and_lengths_may_be_refused_otherwise() {
    let mut device = assuming(|assumed| {
        assumed.unknown_code = RejectCode::Generic;
        assumed.wrong_length = RejectCode::NotAvailable;
    });
    for (code, expected) in [(0x25, 0), (0x41, 4)] {
        let mut frame = vec![1, code];
        frame.extend(vec![0; 4 << (code >> 6)]);
        let answer = device.handle(&frame::seal(frame)).unwrap();
        let answer = Answer::decode(&answer.try_into().unwrap()).unwrap();
        assert_eq!((answer.status.rejected(), answer.tag), (true, expected), "{code:x}");
    }
    // A variable that does not exist is not an unknown code.
    let missing = Command::Get { parameter: 1 };
    assert_eq!(refusal(&mut device, missing), Some(RejectCode::NotAvailable));
}

#[test]
fn a_bit_in_both_bytes_of_ioupdate_sets_or_clears() {
    let update = |set, clear| Command::IoUpdate(IoUpdate { clear, set, ..IoUpdate::default() });
    for (both_bits, expected) in
        [(BothBits::Unchanged, [0, 4]), (BothBits::Set, [4, 4]), (BothBits::Clear, [0, 0])]
    {
        for (before, after) in [(0, expected[0]), (4, expected[1])] {
            let mut device = assuming(|assumed| assumed.both_bits = both_bits);
            ask(&mut device, update(before, 0));
            ask(&mut device, update(4 | 2, 4));
            assert_eq!(device.outputs(), after | 2, "{both_bits:?} from {before}");
        }
    }
}

#[test]
fn steps_add_up_from_the_target() {
    let step = |distance| Command::Step { distance, profile: None };
    for (step_from, under_way) in [(StepFrom::Setpoint, None), (StepFrom::Target, Some(10_100))] {
        let mut device = assuming(|assumed| assumed.step_from = step_from);
        ask(&mut device, go_to(10_000, 300, 0));
        device.advance(300 * MS);
        let expected = under_way.unwrap_or(device.counter() + 100);
        ask(&mut device, step(100));
        rest(&mut device);
        assert_eq!(device.counter(), expected, "{step_from:?}");
        // At rest there is no difference, nor after a STOP.
        ask(&mut device, step(-100));
        rest(&mut device);
        assert_eq!(device.counter(), expected - 100);
        ask(&mut device, go_to(100_000, 0, 0));
        device.advance(300 * MS);
        ask(&mut device, Command::Stop { rate: 0 });
        let here = device.counter();
        ask(&mut device, step(7));
        rest(&mut device);
        assert_eq!(device.counter(), here + 7, "{step_from:?}");
        // Two in a row.
        let twice = if step_from == StepFrom::Target { 2000 } else { 1000 };
        ask(&mut device, step(1000));
        ask(&mut device, step(1000));
        rest(&mut device);
        assert_eq!(device.counter(), here + 7 + twice);
    }
}

#[test]
fn a_limit_switch_stops_by_another_rate() {
    // 300 rpm are 16000 µsteps/s: 30 ms at 10000 rpm/s, 300 ms at 1000 rpm/s, or none.
    for (limit_stop, way) in
        [(LimitStop::Emergency, 240.0), (LimitStop::Deceleration, 2400.0), (LimitStop::AtOnce, 0.0)]
    {
        let mut device = assuming(|assumed| assumed.limit_stop = limit_stop);
        set(&mut device, 32, 1000);
        ask(&mut device, go_to(1_000_000, 300, 0));
        device.advance(1000 * MS);
        let before = device.motion().0;
        device.set_input(Input::LimP, true);
        device.advance(310 * MS);
        near(device.motion().0 - before, way, 0.5);
        let limited = TrajectoryFlags::LIMITED_P.union(TrajectoryFlags::LIMITED);
        assert_eq!(flags(&mut device), limited);
    }
}

#[test]
fn homing_may_go_on_by_the_offset() {
    for (home_position, position, mechanical) in
        [(HomePosition::IsOffset, 500, -2000.0), (HomePosition::GoesOffset, 0, -1500.0)]
    {
        let mut options = DeviceOptions {
            cams: vec![Cam { input: Input::Dir, from: -4000.0, to: -2000.0 }],
            homing: HomingOptions { input: Input::Dir, ..HomingOptions::default() },
            ..DeviceOptions::default()
        };
        options.assumptions.home_position = home_position;
        let mut device = remote_with(&options);
        set(&mut device, 100, 500);
        ask(&mut device, Command::TrajectoryInit(Init::Homing));
        let mut most = 600;
        while ask(&mut device, Command::Ping).status.sequence_busy() {
            assert!(!flags(&mut device).contains(TrajectoryFlags::DONE));
            device.advance(100 * MS);
            most -= 1;
            assert!(most > 0, "homing never ends");
        }
        assert_eq!((device.counter(), flags(&mut device)), (position, TrajectoryFlags::DONE));
        near(device.mechanical(), mechanical, 1.0);
    }
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
        ask(&mut device, Command::Start { speed: 400, rate: 0 });
        device.advance(1000 * MS);
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
    ask(&mut device, go_to(5000, 0, 0));
    rest(&mut device);
    assert_eq!(device.counter(), 5000);
    ask(&mut device, go_to(1_000_000, 0, 0));
    device.advance(1000 * MS);
    let before = device.motion().0;
    device.set_input(Input::LimP, true);
    device.advance(MS);
    near(device.motion().0 - before, 0.0, 0.5);
}

#[test]
fn set_may_wait_for_the_mode() {
    let mut device = assuming(|assumed| assumed.set_effect = SetEffect::WithMode);
    set(&mut device, 30, 100);
    assert_eq!(ask(&mut device, Command::Get { parameter: 30 }).words(), (500, 100));
    ask(&mut device, Command::Start { speed: 400, rate: 0 });
    device.advance(1000 * MS);
    assert_eq!(read(&mut device, 79), 400);
    ask(&mut device, Command::Mode(Some(Mode::Remote)));
    device.advance(250 * MS);
    ask(&mut device, Command::Start { speed: 400, rate: 0 });
    device.advance(1000 * MS);
    assert_eq!(read(&mut device, 79), 100);
}

#[test]
fn set_may_begin_the_mode_anew() {
    let mut device = assuming(|assumed| assumed.set_effect = SetEffect::RestartsMode);
    ask(&mut device, go_to(300, 0, 0));
    rest(&mut device);
    let answer = ask(&mut device, Command::Set { parameter: 30, value: 100 });
    assert_eq!((answer.status.mode(), answer.words()), (31, (500, 100)));
    assert_eq!(refusal(&mut device, go_to(1, 0, 0)), Some(RejectCode::Working));
    device.advance(250 * MS);
    assert_eq!((device.mode(), device.counter()), (Mode::Remote, 0));
    ask(&mut device, Command::Start { speed: 400, rate: 0 });
    device.advance(1000 * MS);
    assert_eq!(read(&mut device, 79), 100);
    // Of two words, the low one alone begins nothing.
    let answer = ask(&mut device, Command::Set { parameter: 28, value: 7 });
    assert_eq!(answer.status.mode(), 3);
    let answer = ask(&mut device, Command::Set { parameter: 29, value: 0 });
    assert_eq!(answer.status.mode(), 31);
}

#[test]
fn the_present_acceleration_may_be_variable_85() {
    for acc_current in [AccCurrent::At86, AccCurrent::At85] {
        let mut device = assuming(|assumed| assumed.acc_current = acc_current);
        set(&mut device, 32, 1000);
        ask(&mut device, go_to(1_000_000, 0, 0));
        // Up to 500 rpm at 2000 rpm/s for 250 ms, and steady then.
        device.advance(100 * MS);
        assert_eq!((read(&mut device, 84), read(&mut device, acc_current.index())), (2000, 2000));
        device.advance(500 * MS);
        assert_eq!(read(&mut device, acc_current.index()), 0);
        let next = Command::Read { variable: 86 };
        match acc_current {
            AccCurrent::At86 => assert_eq!(read(&mut device, 85), 1000),
            AccCurrent::At85 => {
                assert_eq!(refusal(&mut device, next), Some(RejectCode::NotAvailable));
            }
        }
    }
}
