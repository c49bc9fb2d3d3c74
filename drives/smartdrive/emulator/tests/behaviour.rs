//! Modes, limits, alarms, resets, and faults of devices and their line.

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, duplex},
    sync::mpsc,
    time::{Duration, Instant},
};

use super::*;
use crate::{Execution, TagLayout, protocol::vectors::vector};

/// MODE: "le mode", 12 modes and 255; activating one makes the position 0 and cancels moves.
#[test]
fn every_mode_can_be_chosen_and_loses_the_position() {
    let options = DeviceOptions { configured_mode: Mode::Custom, ..DeviceOptions::default() };
    for mode in Mode::ALL {
        let mut device = remote_with(&options);
        ask_and_wait(&mut device, go_to(100_000, 300, 0), 500);
        let answer = ask(&mut device, Command::Mode(Some(mode)));
        assert_eq!(answer.status.mode(), 31);
        let stood = device.mechanical();
        device.advance(250 * MS);
        let answer = ask(&mut device, Command::Ping);
        assert_eq!((answer.status.mode(), answer.number()), (mode.number(), 0), "{mode:?}");
        near(device.mechanical(), stood, 1e-9);
    }
    let mut device = remote_with(&options);
    ask_and_wait(&mut device, Command::Mode(None), 250);
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
    for (command, sense) in [
        (go_to(1_000_000, 0, 0), 1),
        (go_to(1_000_000, 32_767, 32_767), 1),
        (Command::Start { speed: 600, rate: 0 }, 1),
        (Command::Start { speed: -600, rate: 0 }, -1),
    ] {
        let mut device = remote();
        set(&mut device, 32, 1000);
        // 500 rpm at 2000 rpm/s.
        ask_and_wait(&mut device, command, 249);
        assert!(sense * read(&mut device, 79) < 500);
        assert_eq!((read(&mut device, 84), read(&mut device, 85)), (2000, 1000));
        assert_eq!(read(&mut device, 86), sense * 2000);
        device.advance(2 * MS);
        assert_eq!(read(&mut device, 79), sense * 500);
        assert_eq!(read(&mut device, 86), 0);
        ask_and_wait(&mut device, Command::Stop { rate: 0 }, 499);
        assert!(f64::from(sense) * device.motion().1 > 0.0);
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
        ask_and_wait(&mut device, Command::Start { speed, rate: 0 }, 5000);
        assert_eq!(device.counter(), end);
        assert_eq!(flags(&mut device), TrajectoryFlags::NONE);
    }
    // A START with speed 0 is rest, not the largest speed.
    ask_and_wait(&mut device, Command::Start { speed: 0, rate: 0 }, 1000);
    assert_eq!((device.counter(), flags(&mut device)), (-5000, TrajectoryFlags::DONE));
}

#[test]
fn a_limit_switch_stops_with_the_emergency_deceleration() {
    for (input, flag, sense) in [
        (Input::LimP, TrajectoryFlags::LIMITED_P, 1),
        (Input::LimN, TrajectoryFlags::LIMITED_N, -1),
    ] {
        let mut device = remote();
        ask_and_wait(&mut device, go_to(sense * 1_000_000, 300, 0), 1000);
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
        ask_and_wait(&mut device, go_to(sense * 1_000_000, 0, 0), 1000);
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
        ask_and_wait(&mut device, go_to(100_000, 300, 0), 500);
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
        ask_and_wait(&mut device, Command::Start { speed: 300, rate: 0 }, 500);
        device.set_fault(alarm, true);
        let answer = ask(&mut device, Command::Ping);
        assert_eq!((answer.status.alarm(), answer.tag), (true, alarm.0), "{name}");
        near(device.motion().1, 0.0, 0.0);
        device.set_fault(alarm, false);
        ask_and_wait(&mut device, Command::Mode(Some(Mode::Remote)), 250);
        assert!(!ask(&mut device, Command::Ping).status.alarm(), "{name}");
    }
}

/// 300 ms after the supply is back, of which an event may say after what time that is.
#[test]
fn a_brown_out_stops_everything_and_boots() {
    let by_supply = |device: &mut Device| {
        device.set_supply(3);
        device.advance(1000 * MS);
        assert_eq!(device.handle(&encode(1, &Command::Ping)), None);
        device.set_supply(24);
    };
    let by_event = |device: &mut Device| device.happen(Event::BrownOut { off_ns: 100 * MS });
    let ways: [fn(&mut Device); 2] = [by_supply, by_event];
    for (brown_out, silent_ms) in ways.into_iter().zip([300, 400]) {
        let options = DeviceOptions { configured_mode: Mode::Remote, ..DeviceOptions::default() };
        let mut device = Device::new(&options);
        ask_and_wait(&mut device, Command::Start { speed: 300, rate: 0 }, 500);
        let before = device.mechanical();
        assert!(before > 1000.0);
        brown_out(&mut device);
        device.advance(silent_ms * MS - 1);
        assert_eq!(device.handle(&encode(1, &Command::Ping)), None, "{silent_ms} ms");
        device.advance(1);
        let answer = ask(&mut device, Command::Ping);
        assert_eq!((answer.status.mode(), answer.number(), answer.status.alarm()), (3, 0, false));
        near(device.mechanical(), before, 0.5);
        assert_eq!(read(&mut device, 67), 24);
    }
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
    ask_and_wait(&mut device, Command::Start { speed: 300, rate: 0 }, 500);
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
    for condition in [Condition::Signalled, Condition::Busy, Condition::Triggered] {
        device.happen(Event::Condition(condition, true));
    }
    let moving = ask(&mut device, go_to(1000, 0, 0));
    assert_eq!(moving.tag & 1 << 9, 0, "a new motion");
    assert_eq!(moving.status.0 & (1 << 14 | 1 << 6), 1 << 14 | 1 << 6);
    // In flight, and then stopped by a switch: it stays.
    device.happen(Event::Condition(Condition::Triggered, true));
    switch(&mut device, Input::LimP, true, 2000);
    let both = TrajectoryFlags::TRIGGERED.union(TrajectoryFlags::LIMITED_P);
    assert!(flags(&mut device).contains(both));
    device.brown_out(MS);
    device.advance(2000 * MS);
    let again = ask(&mut device, Command::Ping);
    assert_eq!((again.status.0 & (1 << 14 | 1 << 6), again.tag & 1 << 9), (0, 0));
}

#[test]
fn a_refusal_is_answered_and_nothing_is_done() {
    let device = remote();
    // STA: mode 3, response, reject, address 1; TAG 4; XOR of 86h, 81h and 04h.
    let refused = [0x86, 0x81, 0, 0, 0, 0, 4, 0, 0x03];
    assert_eq!(device.refusal(&vector(9), 4).as_deref(), Some(refused.as_slice()));
    assert!(!device.generator.is_under_way(device.now_ns()));
    // Broadcasts and foreign addresses are not answered.
    assert_eq!(device.refusal(&vector(18), 4), None);
    assert_eq!(device.refusal(&[2, 1, 0, 0, 0, 0, 3], 4), None);
}

#[test]
fn a_stuck_status_shows_what_was() {
    let mut device = remote();
    ask_and_wait(&mut device, go_to(100_000, 0, 0), 500);
    let before = device.handle(&vector(1));
    device.happen(Event::StuckStatus(true));
    device.advance(20_000 * MS);
    assert_eq!(device.handle(&vector(1)), before);
    assert_eq!(device.counter(), 100_000);
    device.happen(Event::StuckStatus(false));
    assert_eq!(ask(&mut device, Command::Ping).number(), 100_000);
}

/// Way of a drive at 500 rpm until it answers a PING that is sent now, with 50 ms to answer.
async fn gone_at_ping(execution: Execution) -> f64 {
    let mut device = remote();
    ask_and_wait(&mut device, Command::Start { speed: 500, rate: 0 }, 1000);
    let before = device.counter();
    let (mut near, far) = duplex(64);
    let (control, messages) = mpsc::channel(1);
    let wire = Wire { response: Duration::from_millis(50), execution, ..Wire::default() };
    let zero = Instant::now();
    let clock = move || i64::try_from(zero.elapsed().as_nanos()).unwrap();
    let asking = async {
        near.write_all(&vector(1)).await.unwrap();
        let mut answer = [0; 9];
        near.read_exact(&mut answer).await.unwrap();
        drop(control);
        Answer::decode(&answer).unwrap().number()
    };
    let (served, position) =
        tokio::join!(serve(far, vec![device], &wire, &clock, messages), asking);
    served.unwrap();
    f64::from(position - before)
}

#[tokio::test(start_paused = true)]
async fn a_command_is_carried_out_when_it_is_said_to_be() {
    // 500 rpm are 26667 µsteps/s; seven bytes take 0.608 ms.
    for (execution, seconds) in [
        (Execution::OnArrival, 0.000_608),
        (Execution::Between, 0.025_608),
        (Execution::BeforeAnswer, 0.050_608),
    ] {
        near(gone_at_ping(execution).await, 500.0 * 3200.0 / 60.0 * seconds, 1.0);
    }
}
