//! Homing on a switch, and what ends it.

use std::time::Duration;

use super::*;
use crate::HomePosition;

/// A home switch on DIR, 4000 to 2000 µsteps behind the start.
fn options() -> DeviceOptions {
    DeviceOptions {
        cams: vec![Cam { input: Input::Dir, from: -4000.0, to: -2000.0 }],
        homing: HomingOptions { input: Input::Dir, ..HomingOptions::default() },
        ..DeviceOptions::default()
    }
}

fn home(device: &mut Device) -> Answer {
    let begun = ask(device, Command::TrajectoryInit(Init::Homing));
    assert!(begun.status.sequence_busy() && begun.tag & 1 == 0, "{begun:?}");
    let mut most = 600;
    loop {
        let answer = ask(device, Command::Ping);
        if !answer.status.sequence_busy() {
            return answer;
        }
        assert!(answer.tag & 1 == 0, "DONE while homing");
        most -= 1;
        assert!(most > 0, "homing never ends");
        device.advance(100 * MS);
    }
}

#[test]
fn the_position_is_the_offset_where_the_switch_releases() {
    for (home_position, offset, position, mechanical) in [
        (HomePosition::IsOffset, -777, -777, -2000.0),
        (HomePosition::IsOffset, 500, 500, -2000.0),
        // It goes on by the offset.
        (HomePosition::GoesOffset, 500, 0, -1500.0),
    ] {
        let mut options = options();
        options.assumptions.home_position = home_position;
        let mut device = remote_with(&options);
        set(&mut device, 100, offset);
        let done = home(&mut device);
        assert_eq!(done.number(), position, "{home_position:?}");
        assert_eq!(TrajectoryFlags::from_tag(done.tag), TrajectoryFlags::DONE);
        // 15 rpm are 800 µsteps/s: within the 100 µs between two looks less than a step.
        near(device.mechanical(), mechanical, 1.0);
        // A move afterwards counts from there.
        ask_and_wait(&mut device, go_to(position + 100, 0, 0), 2000);
        near(device.mechanical(), mechanical + 100.0, 1.0);
    }
}

#[test]
fn an_axis_on_the_switch_only_leaves_it() {
    let mut device = remote_with(&options());
    ask_and_wait(&mut device, go_to(-3000, 0, 0), 3000);
    assert_eq!(home(&mut device).number(), 0);
    near(device.mechanical(), -2000.0, 1.0);
}

#[test]
fn a_limit_switch_can_be_the_home_switch() {
    let options = DeviceOptions {
        cams: vec![Cam { input: Input::LimP, from: 3000.0, to: 9000.0 }],
        homing: HomingOptions { input: Input::LimP, positive: true, ..HomingOptions::default() },
        ..DeviceOptions::default()
    };
    let mut device = remote_with(&options);
    assert_eq!(home(&mut device).number(), 0);
    near(device.mechanical(), 3000.0, 1.0);
}

#[test]
fn a_switch_that_is_not_found_is_an_alarm_on_releases_that_have_it() {
    for (build, alarm) in [(315, true), (314, false)] {
        let options = DeviceOptions {
            cams: Vec::new(),
            homing: HomingOptions { timeout: Duration::from_secs(5), ..HomingOptions::default() },
            build,
            ..DeviceOptions::default()
        };
        let mut device = remote_with(&options);
        let end = home(&mut device);
        assert_eq!(end.status.alarm(), alarm);
        if alarm {
            assert_eq!((end.tag, end.status.mode()), (Alarms::HOMING.0, 0));
        }
        device.advance(1000 * MS);
        near(device.motion().1, 0.0, 0.0);
    }
}

#[test]
fn a_stop_ends_homing_and_other_moves_are_refused() {
    let mut device = remote_with(&options());
    ask_and_wait(&mut device, Command::TrajectoryInit(Init::Homing), 100);
    for command in [
        go_to(0, 0, 0),
        Command::TrajectoryInit(Init::Position),
        Command::Start { speed: 1, rate: 0 },
    ] {
        assert_eq!(refusal(&mut device, command), Some(RejectCode::Working));
    }
    let stopped = ask(&mut device, Command::Stop { rate: 0 });
    assert!(!stopped.status.sequence_busy());
    device.advance(500 * MS);
    assert_eq!(flags(&mut device), TrajectoryFlags::DONE);
    assert!(device.mechanical() > -2000.0);
}

#[test]
fn homing_without_a_speed_is_refused() {
    for parameter in [116, 117] {
        let mut device = remote_with(&options());
        set(&mut device, parameter, 0);
        let homing = Command::TrajectoryInit(Init::Homing);
        assert_eq!(refusal(&mut device, homing), Some(RejectCode::BadParams));
    }
}
