//! Tests of the assumptions about what the manual leaves open: every alternative differs from the default.

use super::*;
use crate::{
    AccCurrent, AnswerLength, BadFrame, BothBits, IoUpdate, LimitStop, SetEffect, StepFrom,
    ZeroRate,
};

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
fn codes_and_lengths_may_be_refused_otherwise() {
    use RejectCode::{BadParams, Generic, NotAvailable};
    let usual = Assumptions::default();
    assert_eq!((usual.unknown_code, usual.wrong_length), (NotAvailable, BadParams));
    for (unknown_code, wrong_length) in [
        (NotAvailable, BadParams),
        (NotAvailable, NotAvailable),
        (NotAvailable, Generic),
        (Generic, NotAvailable),
    ] {
        let mut device = assuming(|assumed| {
            (assumed.unknown_code, assumed.wrong_length) = (unknown_code, wrong_length);
        });
        for (code, expected) in [(0x25, unknown_code), (0x3F, unknown_code), (0x41, wrong_length)] {
            let mut frame = vec![1, code];
            frame.extend(vec![0; 4 << (code >> 6)]);
            let answer = decode(device.handle(&frame::seal(frame)).unwrap());
            let shown = (answer.status.rejected(), RejectCode::from_number(answer.tag));
            assert_eq!(shown, (true, Some(expected)), "{code:x}");
        }
        // A variable that does not exist is not an unknown code.
        let missing = Command::Get { parameter: 1 };
        assert_eq!(refusal(&mut device, missing), Some(NotAvailable));
    }
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
        ask_and_wait(&mut device, go_to(10_000, 300, 0), 300);
        let expected = under_way.unwrap_or(device.counter() + 100);
        ask_and_rest(&mut device, step(100));
        assert_eq!(device.counter(), expected, "{step_from:?}");
        // At rest both are the same, and after a STOP.
        ask_and_rest(&mut device, step(-100));
        assert_eq!(device.counter(), expected - 100);
        ask_and_wait(&mut device, go_to(100_000, 0, 0), 300);
        ask(&mut device, Command::Stop { rate: 0 });
        let here = device.counter();
        ask_and_rest(&mut device, step(7));
        assert_eq!(device.counter(), here + 7, "{step_from:?}");
        // Two in a row.
        let twice = if step_from == StepFrom::Target { 2000 } else { 1000 };
        ask(&mut device, step(1000));
        ask_and_rest(&mut device, step(1000));
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
        ask_and_wait(&mut device, go_to(1_000_000, 300, 0), 1000);
        let before = device.motion().0;
        switch(&mut device, Input::LimP, true, 310);
        near(device.motion().0 - before, way, 0.5);
        let limited = TrajectoryFlags::LIMITED_P.union(TrajectoryFlags::LIMITED);
        assert_eq!(flags(&mut device), limited);
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

#[test]
fn what_the_manual_does_not_say_can_be_otherwise() {
    // Requests beyond the ceilings, 500 rpm and 2000 rpm/s.
    for refuses in [true, false] {
        let mut device = assuming(|assumed| assumed.refuses_beyond_ceilings = refuses);
        let expected = refuses.then_some(RejectCode::BadParams);
        let beyond = [
            go_to(0, 501, 0),
            go_to(0, 0, 2001),
            Command::Step { distance: 1, profile: Some((501, 1)) },
            Command::Start { speed: -501, rate: 0 },
            Command::Stop { rate: 2001 },
        ];
        for command in beyond {
            assert_eq!(refusal(&mut device, command), expected, "{command:?}");
        }
        assert_eq!(refusal(&mut device, go_to(0, 500, 2000)), None);
    }
    // Targets outside the limits.
    let mut device = assuming(|assumed| assumed.clamps_targets = true);
    set(&mut device, 26, -100);
    set(&mut device, 28, 200);
    for (target, end) in [(201, 200), (-5000, -100), (7, 7)] {
        ask_and_wait(&mut device, go_to(target, 0, 0), 2000);
        assert_eq!((device.counter(), flags(&mut device)), (end, TrajectoryFlags::DONE));
    }
    // Signs of 16-bit variables.
    let mut device = assuming(|assumed| assumed.extends_signs = false);
    ask_and_wait(&mut device, Command::Start { speed: -300, rate: 0 }, 1000);
    assert_eq!(read(&mut device, 79), 0xFED4);
    assert!(read(&mut device, 75) < 0);
    // Words of 32 bits.
    let mut device = assuming(|assumed| assumed.applies_words_at_once = true);
    set(&mut device, 28, 0x0001_FFFF);
    ask(&mut device, Command::Set { parameter: 28, value: 5 });
    assert_eq!(refusal(&mut device, go_to(0x0001_0006, 0, 0)), Some(RejectCode::BadParams));
    assert_eq!(refusal(&mut device, go_to(0x0001_0005, 0, 0)), None);
    // Silence while the mode changes.
    let mut device = assuming(|assumed| assumed.silent_while_changing = true);
    ask(&mut device, Command::Mode(Some(Mode::Off)));
    assert_eq!(device.handle(&encode(1, &Command::Ping)), None);
    device.advance(250 * MS);
    ask(&mut device, Command::Ping);
}
