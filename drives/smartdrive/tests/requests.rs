//! Every call of the driver against emulated devices, over memory and at the devices' own time.

use std::{
    sync::atomic::{AtomicI64, Ordering},
    time::Duration,
};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    sync::mpsc::{self, Sender},
};

use super::{alarm, attached, options, refusal, rest};
use crate::{
    Assumptions, Command, Init, IoUpdate, LoadSource, Mode, RejectCode, SmartDrive,
    SmartDriveOptions, TrajectoryFlags,
    emulator::{
        Cam, Condition, Control, Device, DeviceOptions, Event, HomingOptions, Input, Wire, serve,
    },
    protocol::frame::command_length,
};
use twin_drives::{DriveError, no_clock};

/// Runs `test` with a master of devices whose time passes by 25 ms with every command they hear.
async fn with_devices(devices: &[DeviceOptions], test: impl AsyncFnOnce(&mut SmartDrive)) {
    with_spoilt(devices, Assumptions::default(), |_| {}, test).await;
}

/// The same with a master that assumes something, and commands that are spoilt on their way.
pub(super) async fn with_spoilt(
    devices: &[DeviceOptions],
    assumptions: Assumptions,
    mut spoil: impl FnMut(&mut [u8]),
    test: impl AsyncFnOnce(&mut SmartDrive),
) {
    let (mut driver, mut far) = attached(&SmartDriveOptions { assumptions, ..options(200, 1) });
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
}

/// Runs `test` with the master of a device to which events can be sent; the device afterwards.
async fn with_events(
    device: Device,
    test: impl AsyncFnOnce(&mut SmartDrive, &Sender<Control>),
) -> Device {
    let (mut driver, far) = attached(&options(2000, 100));
    let clock = AtomicI64::new(0);
    let clock = || clock.fetch_add(1_000_000, Ordering::Relaxed);
    let (control, messages) = mpsc::channel(4);
    let wire = Wire::default();
    let testing = async {
        test(&mut driver, &control).await;
        drop((driver, control));
    };
    let serving = serve(far, vec![device], &wire, &clock, messages);
    let (devices, ()) = tokio::join!(serving, testing);
    devices.unwrap().remove(0)
}

#[tokio::test(start_paused = true)]
async fn modes_change_and_alarms_are_told() {
    with_devices(&[DeviceOptions::default()], async |bus| {
        for mode in Mode::ALL {
            bus.set_mode(1, Some(mode)).await.unwrap();
            assert_eq!(bus.state(1, &no_clock).await.unwrap().0.mode, mode.number());
        }
        bus.set_mode(1, None).await.unwrap();
        assert_eq!(bus.state(1, &no_clock).await.unwrap().0.mode, 0);
    })
    .await;
    // A supply too low from the start: the alarm is there when a mode begins.
    let mut device = Device::new(&DeviceOptions::default());
    device.set_supply(12);
    let device = with_events(device, async |bus, control| {
        let refused = bus.set_mode(1, Some(Mode::Remote)).await;
        assert_eq!(alarm(&refused).to_string(), "undervoltage");
        control.send(Event::Supply(24).to(0)).await.unwrap();
        bus.set_mode(1, Some(Mode::Remote)).await.unwrap();
    });
    assert_eq!(device.await.mode(), Mode::Remote);
}

#[tokio::test(start_paused = true)]
async fn parameters_are_read_set_saved_and_loaded() {
    with_devices(&[DeviceOptions::default()], async |bus| {
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
        assert_eq!(refusal(&bus.parameter(1, 45).await), RejectCode::NotAvailable);
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn variables_and_outputs_are_read_and_written() {
    with_devices(&[DeviceOptions::default()], async |bus| {
        assert_eq!(bus.read(1, 67).await.unwrap(), 24);
        assert_eq!(bus.write_variable(1, 129, 0xFFFF).await.unwrap(), 0xFFFF);
        let update = IoUpdate { set: 0b100, ..IoUpdate::default() };
        assert_eq!(bus.io(1, update).await.unwrap().levels, 0b110);
        assert_eq!(refusal(&bus.write_variable(1, 75, 0).await), RejectCode::BadParams);
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn every_motion_is_made() {
    let boot = Duration::from_millis(50);
    with_devices(&[DeviceOptions { boot, ..DeviceOptions::default() }], async |bus| {
        bus.set_mode(1, Some(Mode::Remote)).await.unwrap();
        assert!(bus.go_to(1, 1000, Some((300, 1000))).await.unwrap().moving());
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
        assert_eq!(refusal(&refused), RejectCode::BadMode);
        let action = Command::GoTo { target: 0, profile: None }.action();
        assert_eq!(refused.unwrap_err().at().action, action);
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn homing_ends_at_home_or_says_why_not() {
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
        assert_eq!(alarm(&bus.home(2).await).to_string(), "homing timeout");
    })
    .await;
    with_devices(&[lost(314)], async |bus| {
        bus.set_mode(2, Some(Mode::Remote)).await.unwrap();
        let refused = bus.home(2).await;
        assert!(matches!(refused, Err(DriveError::NotHomed { .. })), "{refused:?}");
    })
    .await;
}

/// STA bits 14 and 6 and the flag TRIGGERED reach whoever asks how a drive is.
#[tokio::test(start_paused = true)]
async fn conditions_are_told() {
    let reported = async |bus: &mut SmartDrive| {
        let (state, _) = bus.state(1, &no_clock).await.unwrap();
        let triggered = state.flags.contains(TrajectoryFlags::TRIGGERED);
        [state.signalled, state.busy, triggered]
    };
    let device = Device::new(&DeviceOptions::default());
    let served = with_events(device, async |bus, control| {
        assert_eq!(reported(bus).await, [false; 3]);
        let all = [Condition::Signalled, Condition::Busy, Condition::Triggered];
        for (place, condition) in all.into_iter().enumerate() {
            for on in [true, false] {
                control.send(Event::Condition(condition, on).to(0)).await.unwrap();
                // What is served next may have been asked before.
                reported(bus).await;
                let mut expected = [false; 3];
                expected[place] = on;
                assert_eq!(reported(bus).await, expected, "{condition:?}");
            }
        }
    });
    served.await;
}
