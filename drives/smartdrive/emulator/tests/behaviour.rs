//! Modes, limits, alarms, resets.

use super::*;
use crate::TagLayout;

#[test]
fn other_addresses_and_broken_frames_get_silence() {
    let mut device = remote();
    let handled = device.frames_handled();
    let good = encode(1, &Command::Ping);
    assert_eq!(device.handle(&encode(2, &Command::Ping)), None);
    assert_eq!(device.handle(&good[..6]), None);
    let mut wrong = good.clone();
    wrong[6] ^= 1;
    assert_eq!(device.handle(&wrong), None);
    assert_eq!(device.frames_handled(), handled);
    assert!(device.handle(&good).is_some());
}

#[test]
fn unknown_codes_are_not_available_and_wrong_lengths_bad_parameters() {
    let mut device = remote();
    for (code, expected) in [(0x25, RejectCode::NotAvailable), (0x41, RejectCode::BadParams)] {
        let mut frame = vec![1, code];
        frame.extend(vec![0; 4 << (code >> 6)]);
        let answer = device.handle(&frame::seal(frame)).unwrap();
        let answer = Answer::decode(&answer.try_into().unwrap()).unwrap();
        assert!(answer.status.rejected());
        assert_eq!(answer.tag, expected.number());
    }
}

/// MODE: "le mode", 12 modes and 255; activating one makes the position 0 and cancels moves.
#[test]
fn every_mode_can_be_chosen_and_loses_the_position() {
    let options = DeviceOptions { configured_mode: Mode::Custom, ..DeviceOptions::default() };
    for mode in Mode::ALL {
        let mut device = remote_with(&options);
        ask(&mut device, go_to(100_000, 300, 0));
        device.advance(500 * MS);
        let answer = ask(&mut device, Command::Mode(Some(mode)));
        assert_eq!(answer.status.mode(), 31);
        let stood = device.mechanical();
        device.advance(250 * MS);
        let answer = ask(&mut device, Command::Ping);
        assert_eq!((answer.status.mode(), answer.number()), (mode.number(), 0), "{mode:?}");
        near(device.mechanical(), stood, 1e-9);
    }
    let mut device = remote_with(&options);
    ask(&mut device, Command::Mode(None));
    device.advance(250 * MS);
    assert_eq!(device.mode(), Mode::Custom);
}

#[test]
fn while_the_mode_changes_only_looking_is_allowed() {
    let mut device = remote();
    ask(&mut device, Command::Mode(Some(Mode::Remote)));
    ask(&mut device, Command::Ping);
    ask(&mut device, Command::Read { variable: 75 });
    ask(&mut device, Command::Get { parameter: 30 });
    let others = [
        Command::Mode(None),
        Command::Save,
        Command::Set { parameter: 30, value: 1 },
        go_to(1, 0, 0),
        Command::Reset { bootloader: false },
        Command::IoUpdate(crate::IoUpdate::default()),
    ];
    for command in others {
        assert_eq!(refusal(&mut device, command), Some(RejectCode::Working), "{command:?}");
    }
}

/// One ACC for both ramps; 0 and more than the ceilings are the ceilings.
#[test]
fn speeds_and_rates_end_at_their_ceilings() {
    for command in [go_to(1_000_000, 0, 0), go_to(1_000_000, 32_767, 32_767)] {
        let mut device = remote();
        set(&mut device, 32, 1000);
        ask(&mut device, command);
        // 500 rpm at 2000 rpm/s.
        device.advance(249 * MS);
        assert!(read(&mut device, 79) < 500);
        assert_eq!((read(&mut device, 84), read(&mut device, 85)), (2000, 1000));
        assert_eq!(read(&mut device, 86), 2000);
        device.advance(2 * MS);
        assert_eq!(read(&mut device, 79), 500);
        assert_eq!(read(&mut device, 86), 0);
        ask(&mut device, Command::Stop { rate: 0 });
        device.advance(499 * MS);
        assert!(device.motion().1 > 0.0);
        device.advance(2 * MS);
        near(device.motion().1, 0.0, 0.0);
    }
}

#[test]
fn a_start_ends_on_the_position_limit() {
    let mut device = remote();
    set(&mut device, 26, -5000);
    set(&mut device, 28, 7000);
    for (speed, end) in [(300, 7000), (-300, -5000)] {
        ask(&mut device, Command::Start { speed, rate: 0 });
        device.advance(5000 * MS);
        assert_eq!(device.counter(), end);
        assert_eq!(flags(&mut device), TrajectoryFlags::NONE);
    }
    // A START with speed 0 is rest, not the largest speed.
    ask(&mut device, Command::Start { speed: 0, rate: 0 });
    device.advance(1000 * MS);
    assert_eq!((device.counter(), flags(&mut device)), (-5000, TrajectoryFlags::DONE));
}

#[test]
fn a_limit_switch_stops_with_the_emergency_deceleration() {
    for (input, flag, sense) in [
        (Input::LimP, TrajectoryFlags::LIMITED_P, 1),
        (Input::LimN, TrajectoryFlags::LIMITED_N, -1),
    ] {
        let mut device = remote();
        ask(&mut device, go_to(sense * 1_000_000, 300, 0));
        device.advance(1000 * MS);
        let before = device.motion().0;
        device.set_input(input, true);
        // 300 rpm at 10000 rpm/s: 30 ms, 240 µsteps.
        device.advance(29 * MS);
        assert!(flags(&mut device).contains(TrajectoryFlags::IN_MOTION));
        device.advance(2 * MS);
        near(device.motion().0 - before, f64::from(sense) * 240.0, 0.5);
        let limited = flag.union(TrajectoryFlags::LIMITED);
        assert_eq!(flags(&mut device), limited);
        // Not any farther, but back; a new move clears the flags.
        let rest = device.counter();
        ask(&mut device, go_to(sense * 1_000_000, 0, 0));
        device.advance(1000 * MS);
        assert_eq!((device.counter(), flags(&mut device)), (rest, limited));
        ask(&mut device, go_to(0, 0, 0));
        assert_eq!(flags(&mut device), TrajectoryFlags::NONE);
        device.advance(5000 * MS);
        assert_eq!((device.counter(), flags(&mut device)), (0, TrajectoryFlags::DONE));
    }
}

#[test]
fn a_stall_ends_the_motion_and_is_an_alarm_if_it_is_one() {
    for is_alarm in [true, false] {
        let options = DeviceOptions { stall_is_alarm: is_alarm, ..DeviceOptions::default() };
        let mut device = remote_with(&options);
        device.stall();
        assert_eq!(flags(&mut device), TrajectoryFlags::DONE);
        ask(&mut device, go_to(100_000, 300, 0));
        device.advance(500 * MS);
        device.stall();
        let rest = device.counter();
        device.advance(500 * MS);
        assert_eq!(device.counter(), rest);
        let answer = ask(&mut device, Command::Ping);
        if is_alarm {
            assert!(answer.status.alarm() && answer.status.mode() == 0);
            assert_eq!(answer.tag, Alarms::STALL.0);
            assert_eq!(refusal(&mut device, go_to(0, 0, 0)), Some(RejectCode::BadMode));
        } else {
            assert_eq!(TrajectoryFlags::from_tag(answer.tag), TrajectoryFlags::STALLED);
        }
    }
}

#[test]
fn every_alarm_switches_off_and_a_mode_clears_it() {
    for (alarm, name) in Alarms::NAMES {
        let mut device = remote();
        ask(&mut device, Command::Start { speed: 300, rate: 0 });
        device.advance(500 * MS);
        device.set_fault(alarm, true);
        let answer = ask(&mut device, Command::Ping);
        assert_eq!((answer.status.alarm(), answer.tag), (true, alarm.0), "{name}");
        near(device.motion().1, 0.0, 0.0);
        device.set_fault(alarm, false);
        ask(&mut device, Command::Mode(Some(Mode::Remote)));
        device.advance(250 * MS);
        assert!(!ask(&mut device, Command::Ping).status.alarm(), "{name}");
    }
}

#[test]
fn a_brown_out_stops_everything_and_boots() {
    let options = DeviceOptions { configured_mode: Mode::Remote, ..DeviceOptions::default() };
    let mut device = Device::new(&options);
    ask(&mut device, Command::Start { speed: 300, rate: 0 });
    device.advance(500 * MS);
    let before = device.mechanical();
    device.set_supply(3);
    device.advance(1000 * MS);
    assert_eq!(device.handle(&encode(1, &Command::Ping)), None);
    device.set_supply(24);
    device.advance(299 * MS);
    assert_eq!(device.handle(&encode(1, &Command::Ping)), None);
    device.advance(MS);
    let answer = ask(&mut device, Command::Ping);
    assert_eq!((answer.status.mode(), answer.number(), answer.status.alarm()), (3, 0, false));
    near(device.mechanical(), before, 0.5);
    assert_eq!(read(&mut device, 67), 24);
}

#[test]
fn a_device_in_its_bootloader_is_silent_until_its_power_comes_back() {
    let mut device = remote();
    ask(&mut device, Command::Reset { bootloader: true });
    device.advance(10_000 * MS);
    assert_eq!(device.handle(&encode(1, &Command::Ping)), None);
    device.set_supply(0);
    device.set_supply(24);
    device.advance(300 * MS);
    ask(&mut device, Command::Ping);
}

#[test]
fn the_other_layout_of_the_flags_is_to_be_had() {
    let options = DeviceOptions { layout: TagLayout::Table, ..DeviceOptions::default() };
    let mut device = remote_with(&options);
    ask(&mut device, Command::Start { speed: 300, rate: 0 });
    device.advance(500 * MS);
    assert_eq!(ask(&mut device, Command::Ping).tag, 0b11);
    assert_eq!(flags(&mut device), TrajectoryFlags::IN_MOTION.union(TrajectoryFlags::DONE));
}

/// However time is cut into pieces, the same happens.
#[test]
fn pieces_of_time_do_not_matter() {
    let options = DeviceOptions {
        cams: vec![Cam { input: Input::LimP, from: 5000.0, to: 9000.0 }],
        ..DeviceOptions::default()
    };
    let ends = [MS, 7 * MS, 333_333, 2000 * MS].map(|piece| {
        let mut device = remote_with(&options);
        ask(&mut device, go_to(20_000, 300, 0));
        let end_ns = device.now_ns() + 2000 * MS;
        while device.now_ns() < end_ns {
            device.advance(piece.min(end_ns - device.now_ns()));
        }
        (device.motion().0.to_bits(), ask(&mut device, Command::Ping).tag)
    });
    assert!(ends.iter().all(|end| *end == ends[0]), "{ends:?}");
    assert!(TrajectoryFlags::from_tag(ends[0].1).contains(TrajectoryFlags::LIMITED_P));
}

fn assuming(assumptions: Assumptions) -> Device {
    remote_with(&DeviceOptions { assumptions, ..DeviceOptions::default() })
}

#[test]
fn what_the_manual_does_not_say_can_be_otherwise() {
    let usual = Assumptions::default();
    // Requests beyond the ceilings, 500 rpm and 2000 rpm/s.
    for refuses_beyond_ceilings in [true, false] {
        let mut device = assuming(Assumptions { refuses_beyond_ceilings, ..usual });
        let expected = refuses_beyond_ceilings.then_some(RejectCode::BadParams);
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
    let mut device = assuming(Assumptions { clamps_targets: true, ..usual });
    set(&mut device, 26, -100);
    set(&mut device, 28, 200);
    for (target, end) in [(201, 200), (-5000, -100), (7, 7)] {
        ask(&mut device, go_to(target, 0, 0));
        device.advance(2000 * MS);
        assert_eq!((device.counter(), flags(&mut device)), (end, TrajectoryFlags::DONE));
    }
    // Signs of 16-bit variables.
    let mut device = assuming(Assumptions { extends_signs: false, ..usual });
    ask(&mut device, Command::Start { speed: -300, rate: 0 });
    device.advance(1000 * MS);
    assert_eq!(read(&mut device, 79), 0xFED4);
    assert!(read(&mut device, 75) < 0);
    // Words of 32 bits.
    let mut device = assuming(Assumptions { applies_words_at_once: true, ..usual });
    set(&mut device, 28, 0x0001_FFFF);
    ask(&mut device, Command::Set { parameter: 28, value: 5 });
    assert_eq!(refusal(&mut device, go_to(0x0001_0006, 0, 0)), Some(RejectCode::BadParams));
    assert_eq!(refusal(&mut device, go_to(0x0001_0005, 0, 0)), None);
    // Silence while the mode changes.
    let mut device = assuming(Assumptions { silent_while_changing: true, ..usual });
    ask(&mut device, Command::Mode(Some(Mode::Off)));
    assert_eq!(device.handle(&encode(1, &Command::Ping)), None);
    device.advance(250 * MS);
    ask(&mut device, Command::Ping);
}

/// Bits of "STA" and of the TAG that the manual only names: 14 SIGNALLED, 6 BUSY, TRIGGERED (bit 9 of the diagram), which a new
/// motion command clears.
#[test]
fn conditions_show_in_their_bits() {
    let mut device = remote();
    let before = ask(&mut device, Command::Ping);
    for (condition, status, tag) in [
        (Condition::Signalled, 1 << 14, 0),
        (Condition::Busy, 1 << 6, 0),
        (Condition::Triggered, 0, 1 << 9),
    ] {
        device.happen(Event::Condition(condition, true));
        let shown = ask(&mut device, Command::Ping);
        let expected = (before.status.0 | status, before.tag | tag);
        assert_eq!((shown.status.0, shown.tag), expected, "{condition:?}");
        device.happen(Event::Condition(condition, false));
        assert_eq!(ask(&mut device, Command::Ping), before, "{condition:?}");
    }
    let all = [Condition::Signalled, Condition::Busy, Condition::Triggered];
    for condition in all {
        device.happen(Event::Condition(condition, true));
    }
    let moving = ask(&mut device, go_to(1000, 0, 0));
    assert_eq!(moving.tag & 1 << 9, 0, "a new motion");
    assert_eq!(moving.status.0 & (1 << 14 | 1 << 6), 1 << 14 | 1 << 6);
    // In flight, and then stopped by a switch: it stays.
    device.happen(Event::Condition(Condition::Triggered, true));
    device.set_input(Input::LimP, true);
    device.advance(2000 * MS);
    assert!(
        flags(&mut device).contains(TrajectoryFlags::TRIGGERED.union(TrajectoryFlags::LIMITED_P))
    );
    device.brown_out(MS);
    device.advance(2000 * MS);
    let again = ask(&mut device, Command::Ping);
    assert_eq!((again.status.0 & (1 << 14 | 1 << 6), again.tag & 1 << 9), (0, 0));
}
