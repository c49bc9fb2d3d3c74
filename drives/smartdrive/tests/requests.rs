//! Every call of the driver against emulated devices, over memory and at the devices' own time.

use std::{
    sync::Arc,
    sync::atomic::{AtomicI64, Ordering},
    time::Duration,
};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, duplex},
    sync::mpsc,
};

use super::wire::{axis, no_clock, run};
use crate::Fault;
use crate::tests::common::fault_of;
use crate::{
    Assumptions, Command, Init, IoUpdate, LoadSource, Mode, RejectCode, SmartDrive,
    SmartDriveOptions, TagLayout, TrajectoryFlags,
    emulator::{Cam, Condition, Device, DeviceOptions, Event, HomingOptions, Input, Wire, serve},
    protocol::frame::command_length,
};
use twin_drives::DriveError;

/// Runs `test` with a master of devices whose time passes by 25 ms with every command they hear.
fn with_devices(devices: &[DeviceOptions], test: impl AsyncFnOnce(&mut SmartDrive)) {
    with_spoilt(devices, Assumptions::default(), |_| {}, test);
}

/// The same with a master that assumes something, and commands that are spoilt on their way.
pub(super) fn with_spoilt(
    devices: &[DeviceOptions],
    assumptions: Assumptions,
    mut spoil: impl FnMut(&mut [u8]),
    test: impl AsyncFnOnce(&mut SmartDrive),
) {
    run(async {
        let (near, mut far) = duplex(4096);
        let mut options = SmartDriveOptions::new(vec![axis(1)]);
        options.assumptions = assumptions;
        options.worst_latency = Duration::from_millis(1);
        options.deadline = Duration::from_millis(200);
        let mut driver = SmartDrive::attach(Arc::from("wire"), near, &options);
        let mut devices: Vec<Device> = devices.iter().map(Device::new).collect();
        let serving = async {
            let mut buffer = [0; 256];
            loop {
                let count = far.read(&mut buffer).await.unwrap();
                if count == 0 {
                    return;
                }
                assert_eq!(command_length(&buffer), Some(count));
                spoil(&mut buffer[..count]);
                for device in &mut devices {
                    device.advance(25_000_000);
                    if let Some(answer) = device.handle(&buffer[..count]) {
                        far.write_all(&answer).await.unwrap();
                    }
                }
            }
        };
        let testing = async {
            test(&mut driver).await;
            drop(driver);
        };
        tokio::join!(serving, testing);
    });
}

fn one() -> [DeviceOptions; 1] {
    [DeviceOptions::default()]
}

#[test]
fn modes_change_and_alarms_are_told() {
    with_devices(&one(), async |bus| {
        for mode in Mode::ALL {
            bus.set_mode(1, Some(mode)).await.unwrap();
            assert_eq!(bus.state(1, &no_clock).await.unwrap().0.mode, mode.number());
        }
        bus.set_mode(1, None).await.unwrap();
        assert_eq!(bus.state(1, &no_clock).await.unwrap().0.mode, 0);
    });
    // A supply too low from the start: the alarm is there when a mode begins.
    run(async {
        let mut device = Device::new(&DeviceOptions::default());
        device.set_supply(12);
        let (near, far) = duplex(4096);
        let clock = Arc::new(AtomicI64::new(0));
        let passing = Arc::clone(&clock);
        let clock = move || passing.fetch_add(1_000_000, Ordering::Relaxed);
        let (control, messages) = mpsc::channel(1);
        let mut options = SmartDriveOptions::new(vec![axis(1)]);
        options.deadline = Duration::from_secs(2);
        let mut bus = SmartDrive::attach(Arc::from("wire"), near, &options);
        let wire = Wire::default();
        let serving = serve(far, vec![device], &wire, &clock, messages);
        let testing = async {
            let refused = bus.set_mode(1, Some(Mode::Remote)).await;
            let Some(Fault::Alarm(alarms)) = fault_of(&refused) else { panic!("{refused:?}") };
            assert_eq!(alarms.to_string(), "undervoltage");
            control.send(Event::Supply(24).to(0)).await.unwrap();
            bus.set_mode(1, Some(Mode::Remote)).await.unwrap();
            drop(control);
        };
        let (devices, ()) = tokio::join!(serving, testing);
        assert_eq!(devices.unwrap()[0].mode(), Mode::Remote);
    });
}

#[test]
fn parameters_are_read_set_saved_and_loaded() {
    with_devices(&one(), async |bus| {
        let now = bus.set_parameter(1, 30, 600).await.unwrap();
        assert_eq!((now.saved, now.working, now.factory), (500, 600, 500));
        // Two words and a sign.
        let now = bus.set_parameter(1, 26, -100_000).await.unwrap();
        assert_eq!((now.saved, now.working, now.factory), (0, -100_000, 0));
        assert_eq!(bus.parameter(1, 26).await.unwrap(), now);
        bus.save(1).await.unwrap();
        assert_eq!(bus.parameter(1, 26).await.unwrap().saved, -100_000);
        bus.load(1, LoadSource::Factory).await.unwrap();
        assert_eq!(bus.parameter(1, 30).await.unwrap().working, 500);
        bus.load(1, LoadSource::Saved).await.unwrap();
        assert_eq!(bus.parameter(1, 30).await.unwrap().working, 600);
        // What cannot be is not sent, what the drive does not have it refuses.
        for (index, value) in [(30, 0), (30, 32_768), (44, 3), (2, 32), (106, -1), (26, 1 << 31)] {
            let refused = bus.set_parameter(1, index, value).await;
            assert!(matches!(refused, Err(DriveError::Value { .. })), "{index}: {refused:?}");
        }
        let missing = bus.parameter(1, 45).await;
        let Some(Fault::Rejected(reason)) = fault_of(&missing) else { panic!("{missing:?}") };
        assert_eq!(*reason, RejectCode::NotAvailable);
    });
}

#[test]
fn variables_and_outputs_are_read_and_written() {
    with_devices(&one(), async |bus| {
        assert_eq!(bus.read(1, 67).await.unwrap(), 24);
        assert_eq!(bus.write_variable(1, 129, 0xFFFF).await.unwrap(), 0xFFFF);
        let update = IoUpdate { set: 0b100, ..IoUpdate::default() };
        assert_eq!(bus.io(1, update).await.unwrap().levels, 0b110);
        let refused = bus.write_variable(1, 75, 0).await;
        assert!(matches!(fault_of(&refused), Some(Fault::Rejected(_))), "{refused:?}");
    });
}

#[test]
fn every_motion_is_made() {
    let boot = Duration::from_millis(50);
    with_devices(&[DeviceOptions { boot, ..DeviceOptions::default() }], async |bus| {
        bus.set_mode(1, Some(Mode::Remote)).await.unwrap();
        let rest = async |bus: &mut SmartDrive| loop {
            let (state, _) = bus.state(1, &no_clock).await.unwrap();
            if !state.moving() {
                return state.position;
            }
        };
        assert!(bus.go_to(1, 3200, None).await.unwrap().moving());
        assert_eq!(rest(bus).await, 3200);
        bus.go_to(1, 1000, Some((300, 1000))).await.unwrap();
        assert_eq!(rest(bus).await, 1000);
        bus.step(1, -200, Some((60, 1000))).await.unwrap();
        assert_eq!(rest(bus).await, 800);
        bus.start(1, -300, 0).await.unwrap();
        for _ in 0..100 {
            bus.state(1, &no_clock).await.unwrap();
        }
        assert_eq!(bus.read(1, 79).await.unwrap(), -300);
        bus.stop(1, 1000).await.unwrap();
        assert!(rest(bus).await < -1000);
        let state = bus.init(1, Init::Position).await.unwrap();
        assert_eq!((state.position, state.flags), (0, TrajectoryFlags::DONE));
        bus.reset(1, false).await.unwrap();
        // The device's time passes with what it hears, 25 ms with each: the first that it answers is the second.
        let silent = bus.step(1, 0, None).await;
        assert!(matches!(silent, Err(DriveError::Timeout { .. })), "{silent:?}");
        assert_eq!(bus.state(1, &no_clock).await.unwrap().0.mode, 0);
        let refused = bus.go_to(1, 0, None).await;
        let Some(Fault::Rejected(reason)) = fault_of(&refused) else { panic!("{refused:?}") };
        assert_eq!(*reason, RejectCode::BadMode);
        let Err(error) = &refused else { panic!("{refused:?}") };
        assert_eq!(error.at().action, Command::GoTo { target: 0, profile: None }.action());
    });
}

#[test]
fn homing_ends_at_home_or_says_why_not() {
    let cams = vec![Cam { input: Input::Go, from: -9000.0, to: -500.0 }];
    let found = DeviceOptions { cams, ..DeviceOptions::default() };
    let lost = |build| DeviceOptions {
        address: 2,
        build,
        homing: HomingOptions { timeout: Duration::from_secs(1), ..HomingOptions::default() },
        ..DeviceOptions::default()
    };
    with_devices(&[found, lost(315)], async |bus| {
        for address in [1, 2] {
            bus.set_mode(address, Some(Mode::Remote)).await.unwrap();
        }
        bus.set_parameter(1, 100, -777).await.unwrap();
        assert_eq!(bus.home(1).await.unwrap(), -777);
        let alarm = bus.home(2).await;
        let Some(Fault::Alarm(alarms)) = fault_of(&alarm) else { panic!("{alarm:?}") };
        assert_eq!(alarms.to_string(), "homing timeout");
    });
    with_devices(&[lost(314)], async |bus| {
        bus.set_mode(2, Some(Mode::Remote)).await.unwrap();
        let refused = bus.home(2).await;
        assert!(matches!(refused, Err(DriveError::NotHomed { .. })), "{refused:?}");
    });
}

#[test]
fn what_the_manual_does_not_say_does_not_matter() {
    let assumptions = Assumptions {
        extends_signs: false,
        silent_while_changing: true,
        applies_words_at_once: true,
        ..Assumptions::default()
    };
    let layout = TagLayout::Table;
    let device = DeviceOptions {
        assumptions,
        layout,
        mode_change: Duration::from_millis(50),
        ..DeviceOptions::default()
    };
    with_devices(&[device], async |bus| {
        bus.set_mode(1, Some(Mode::Remote)).await.unwrap();
        bus.set_parameter(1, 26, -100_000).await.unwrap();
        assert_eq!(bus.parameter(1, 26).await.unwrap().working, -100_000);
        bus.start(1, -300, 0).await.unwrap();
        for _ in 0..20 {
            bus.state(1, &no_clock).await.unwrap();
        }
        assert_eq!(bus.read(1, 79).await.unwrap(), -300);
        let (state, _) = bus.state(1, &no_clock).await.unwrap();
        assert!(state.flags.contains(TrajectoryFlags::IN_MOTION));
    });
}

/// STA bits 14 and 6 and the flag TRIGGERED reach whoever asks how a drive is.
#[test]
fn conditions_are_told() {
    run(async {
        let (near, far) = duplex(4096);
        let clock = Arc::new(AtomicI64::new(0));
        let clock = move || clock.fetch_add(1_000_000, Ordering::Relaxed);
        let (control, messages) = mpsc::channel(4);
        let mut options = SmartDriveOptions::new(vec![axis(1)]);
        options.deadline = Duration::from_secs(2);
        let mut bus = SmartDrive::attach(Arc::from("wire"), near, &options);
        let (wire, device) = (Wire::default(), Device::new(&DeviceOptions::default()));
        let serving = serve(far, vec![device], &wire, &clock, messages);
        let testing = async {
            let told = async |bus: &mut SmartDrive| {
                let (state, _) = bus.state(1, &no_clock).await.unwrap();
                let triggered = state.flags.contains(TrajectoryFlags::TRIGGERED);
                [state.signalled, state.busy, triggered]
            };
            assert_eq!(told(&mut bus).await, [false; 3]);
            let all = [Condition::Signalled, Condition::Busy, Condition::Triggered];
            for (place, condition) in all.into_iter().enumerate() {
                for on in [true, false] {
                    control.send(Event::Condition(condition, on).to(0)).await.unwrap();
                    // What is served next may have been asked before.
                    told(&mut bus).await;
                    let mut expected = [false; 3];
                    expected[place] = on;
                    assert_eq!(told(&mut bus).await, expected, "{condition:?}");
                }
            }
            drop((bus, control));
        };
        let (devices, ()) = tokio::join!(serving, testing);
        devices.unwrap();
    });
}
