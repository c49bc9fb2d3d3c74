//! The driver with devices that do what the manual leaves open in every way that is known.

use std::{cell::Cell, time::Duration};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, duplex},
    sync::mpsc,
    time::{Instant, sleep, timeout},
};

use super::{
    axis, common::WallClock, emulated, open, options, patient, refusal, requests::with_spoilt, rest,
};
use crate::{
    AnswerLength, Assumptions, AxisOptions, BadFrame, HomePosition, IoUpdate, Mode, RejectCode,
    SetEffect, SmartDriveBus, SmartDriveOptions, StepFrom, TagLayout, TrajectoryFlags, ZeroRate,
    emulator::{Cam, Device, DeviceOptions, EmulatedBus, HomingOptions, Input, Wire, serve},
    protocol::{frame::Answer, vectors::vector},
};
use twin_drives::{Assumed, Drive, DriveError, ParameterId, no_clock};

/// Every alternative, one at a time.
fn alternatives() -> Vec<Assumptions> {
    let mut all = Vec::new();
    for name in Assumptions::NAMES {
        for value in Assumptions::values(name).unwrap().allowed.split(" or ") {
            let mut assumed = Assumptions::default();
            assumed.set(name, value).unwrap();
            all.push(assumed);
        }
    }
    all
}

/// A device with a home switch and one at its end, which changes its mode quickly.
fn device(assumptions: Assumptions) -> DeviceOptions {
    DeviceOptions {
        assumptions,
        cams: vec![
            Cam { input: Input::Dir, from: -4000.0, to: -1000.0 },
            Cam { input: Input::LimP, from: 75_000.0, to: 1e6 },
        ],
        homing: HomingOptions { input: Input::Dir, ..HomingOptions::default() },
        mode_change: Duration::from_millis(50),
        ..DeviceOptions::default()
    }
}

#[tokio::test(start_paused = true)]
async fn the_driver_copes_with_every_alternative() {
    let usual = Assumptions::default();
    let known = alternatives().into_iter().map(|assumed| (device(assumed), assumed));
    // Several at a time, of which the driver does not know.
    let several = Assumptions {
        extends_signs: false,
        silent_while_changing: true,
        applies_words_at_once: true,
        ..usual
    };
    let unknown = DeviceOptions { layout: TagLayout::Table, ..device(several) };
    for (device, assumed) in known.chain([(unknown, usual)]) {
        let name = format!("{:?}, {assumed:?}", device.layout);
        with_spoilt(
            &[device],
            assumed,
            |_| {},
            async |bus| {
                bus.set_mode(1, Some(Mode::Remote)).await.unwrap();
                // Among them 32-bit ones, with signs.
                for (index, value) in [(26, -100_000), (28, 70_000), (32, 1500), (100, -50)] {
                    let set = bus.set_parameter(1, index, value).await.unwrap();
                    assert_eq!(set.working, value, "{name}");
                }
                bus.set_mode(1, Some(Mode::Remote)).await.unwrap();
                bus.go_to(1, 3000, None).await.unwrap();
                assert_eq!(rest(bus).await, 3000, "{name}");
                bus.step(1, -100, None).await.unwrap();
                assert_eq!(rest(bus).await, 2900, "{name}");
                // From the target under way, or from somewhere before it.
                bus.go_to(1, 8000, None).await.unwrap();
                bus.step(1, 100, None).await.unwrap();
                let stepped = rest(bus).await;
                assert_eq!(stepped == 8100, assumed.step_from == StepFrom::Target, "{name}");
                // LED on, BRK as it is.
                let both = IoUpdate { set: 4 | 2, clear: 2, ..IoUpdate::default() };
                assert_eq!(bus.io(1, both).await.unwrap().levels & 7, 4, "{name}");
                bus.start(1, -300, 0).await.unwrap();
                while bus.read(1, 79).await.unwrap() != -300 {}
                let (state, _) = bus.state(1, &no_clock).await.unwrap();
                assert!(state.flags.contains(TrajectoryFlags::IN_MOTION), "{name}");
                bus.stop(1, 0).await.unwrap();
                rest(bus).await;
                // Outside the limits it goes as far as the limit, or not at all.
                let beyond = bus.go_to(1, 70_001, None).await;
                if assumed.clamps_targets {
                    assert_eq!(rest(bus).await, 70_000, "{name}");
                } else {
                    assert_eq!(refusal(&beyond), RejectCode::BadParams);
                }
                let home = if assumed.home_position == HomePosition::IsOffset { -50 } else { 0 };
                assert_eq!(bus.home(1).await.unwrap(), home, "{name}");
                // Onto the limit switch and back.
                bus.set_parameter(1, 28, -100_000).await.unwrap();
                bus.set_mode(1, Some(Mode::Remote)).await.unwrap();
                bus.start(1, 500, 0).await.unwrap();
                let place = rest(bus).await;
                let (state, _) = bus.state(1, &no_clock).await.unwrap();
                assert!(state.flags.contains(TrajectoryFlags::LIMITED_P), "{name}");
                bus.go_to(1, place - 500, None).await.unwrap();
                assert_eq!(rest(bus).await, place - 500, "{name}");
            },
        )
        .await;
    }
}

/// A STEP that is spoilt on its way has not been executed where the drive says so, and only then it is sent again.
#[tokio::test(start_paused = true)]
async fn what_a_drive_has_not_heard_is_sent_again_where_it_says_so() {
    let usual = Assumptions::default();
    let refuses = Assumptions { bad_frame: BadFrame::Refused(RejectCode::Generic), ..usual };
    for (of_device, of_driver, end) in
        [(refuses, refuses, 100), (refuses, usual, 0), (usual, usual, 0)]
    {
        let spoilt = Cell::new(false);
        let spoil = |frame: &mut [u8]| {
            if frame[1] == 0x24 && !spoilt.replace(true) {
                frame[2] ^= 1;
            }
        };
        with_spoilt(&[device(of_device)], of_driver, spoil, async |bus| {
            bus.set_mode(1, Some(Mode::Remote)).await.unwrap();
            let stepped = bus.step(1, 100, None).await;
            match (of_device == refuses, of_driver == refuses) {
                (true, true) => assert!(stepped.is_ok(), "{stepped:?}"),
                (true, false) => assert_eq!(refusal(&stepped), RejectCode::Generic),
                _ => assert!(matches!(stepped, Err(DriveError::Timeout { .. })), "{stepped:?}"),
            }
            assert_eq!(rest(bus).await, end);
        })
        .await;
        assert!(spoilt.get());
    }
}

/// A drive on a pseudo-terminal, and the driver that assumes the same.
fn on_terminal(
    assumptions: Assumptions,
    deceleration_rpm_per_s: u16,
) -> (EmulatedBus, SmartDriveBus, WallClock) {
    let (bus, clock) = emulated(vec![device(assumptions)], Wire::default());
    let axes = vec![AxisOptions { deceleration_rpm_per_s, ..axis(1) }];
    let drive = open(&bus, &SmartDriveOptions { axes, assumptions, ..patient(1..=1) });
    (bus, drive, clock)
}

#[test]
fn parameters_take_effect_when_the_drive_is_enabled() {
    let here = |drive: &mut SmartDriveBus| {
        let (state, _) = drive.run(async |bus| bus.state(1, &no_clock).await).unwrap();
        (state.position, state.mode, state.moving())
    };
    let highest = ParameterId { address: 1, number: 28 };
    for set_effect in [SetEffect::AtOnce, SetEffect::WithMode, SetEffect::RestartsMode] {
        let (_emulator, mut drive, _) =
            on_terminal(Assumptions { set_effect, ..Assumptions::default() }, 0);
        drive.enable().unwrap();
        drive.move_to(&[300; 5], &[8e3; 5]).unwrap();
        while here(&mut drive).2 {}
        // A drive that obeys is left alone.
        drive.enable().unwrap();
        assert_eq!(here(&mut drive), (300, 3, false));
        drive.set_parameter(highest, 100_000).unwrap();
        let after = if set_effect == SetEffect::RestartsMode { 0 } else { 300 };
        assert_eq!(here(&mut drive), (after, 3, false), "{set_effect:?}");
        drive.enable().unwrap();
        let after = if set_effect == SetEffect::AtOnce { 300 } else { 0 };
        assert_eq!(here(&mut drive), (after, 3, false), "{set_effect:?}");
        drive.enable().unwrap();
        // What loses the position is not done on the way.
        drive.run(async |bus| bus.start(1, 100, 0).await).unwrap();
        let set = drive.set_parameter(highest, 90_000);
        let enabled = drive.enable();
        let moving = |done: &Result<(), DriveError>| matches!(done, Err(DriveError::Moving { .. }));
        assert_eq!(moving(&set), set_effect == SetEffect::RestartsMode, "{set:?}");
        assert_eq!(moving(&enabled), set_effect == SetEffect::WithMode, "{enabled:?}");
        drive.soft_stop().unwrap();
    }
}

#[test]
fn a_deceleration_of_0_is_checked_as_it_is_assumed() {
    for zero_rate in [ZeroRate::AsAcceleration, ZeroRate::Unlimited] {
        let (_emulator, mut drive, clock) =
            on_terminal(Assumptions { zero_rate, ..Assumptions::default() }, 3000);
        drive.run(async |bus| bus.set_parameter(1, 32, 0).await).unwrap();
        let limits = drive.limits().unwrap()[0];
        let found = drive.probe(&clock);
        match zero_rate {
            // 3000 rpm/s are more than AccMax, 2000.
            ZeroRate::AsAcceleration => {
                assert_eq!(limits.deceleration, limits.acceleration);
                let Err(DriveError::Parameter { name, expected, found, .. }) = found else {
                    panic!("{found:?}")
                };
                assert_eq!((name, expected, found), ("Trj_DecMax", 3000, 2000));
            }
            ZeroRate::Unlimited => {
                assert_eq!(limits.deceleration, None);
                found.unwrap();
            }
        }
    }
}

/// Answers as long as their commands (RR, §5), on a pseudo-terminal: the drive is enabled, moved by GOTO with and
/// without ceilings, sets and reads variables; and a driver that awaits the other length understands nothing.
#[test]
fn answers_may_be_as_long_as_their_commands() {
    let long = AnswerLength::AsCommand;
    let (emulator, mut drive, _) =
        on_terminal(Assumptions { answer_length: long, ..Assumptions::default() }, 0);
    drive.enable().unwrap();
    drive.move_to(&[300; 5], &[8e3; 5]).unwrap();
    drive.run(async |bus| {
        assert_eq!(rest(bus).await, 300);
        // 11 bytes and 13 of the answer; 7 and 9.
        bus.go_to(1, 500, Some((300, 1000))).await.unwrap();
        assert_eq!(rest(bus).await, 500);
        bus.go_to(1, 400, None).await.unwrap();
        assert_eq!(rest(bus).await, 400);
        assert_eq!(bus.write_variable(1, 130, 0xFFFF).await.unwrap(), 0xFFFF);
    });
    drop(drive);
    let mut other = open(&emulator, &options(100, 20));
    let written = other.run(async |bus| bus.write_variable(1, 130, 0).await);
    assert!(matches!(written, Err(DriveError::Protocol { .. })), "{written:?}");
}

#[tokio::test(start_paused = true)]
async fn the_silence_that_ends_a_frame_can_be_chosen() {
    for (silence_ms, answers) in [(5, false), (20, true)] {
        let wire = Wire { frame_timeout: Duration::from_millis(silence_ms), ..Wire::default() };
        let (mut near, far) = duplex(4096);
        let (_hand, control) = mpsc::channel(1);
        let served = tokio::spawn(async move {
            let zero = Instant::now();
            let clock = move || i64::try_from(zero.elapsed().as_nanos()).unwrap();
            serve(far, vec![Device::new(&DeviceOptions::default())], &wire, &clock, control).await
        });
        // A PING in two pieces.
        near.write_all(&vector(1)[..3]).await.unwrap();
        sleep(Duration::from_millis(10)).await;
        near.write_all(&vector(1)[3..]).await.unwrap();
        let mut answer = [0; 9];
        let answered = timeout(Duration::from_secs(1), near.read_exact(&mut answer)).await;
        served.abort();
        assert_eq!(answered.is_ok(), answers, "{silence_ms} ms");
        assert!(!answers || Answer::decode(&answer).is_some(), "{silence_ms} ms: {answer:02X?}");
    }
}
