//! The driver against frames computed elsewhere, and against the emulator on a pseudo-terminal.

#[path = "../../tests/common.rs"]
#[allow(dead_code, reason = "each family uses a part")]
mod common;
#[path = "../../tests/peer.rs"]
#[allow(dead_code, reason = "each family uses a part")]
mod peer;

mod assumptions;
mod faults;
mod in_step;
mod requests;
mod terminal;
mod wire;
mod witness;

use std::{fmt::Debug, sync::Arc, time::Duration};

use tokio::io::{DuplexStream, duplex};

use self::common::{WallClock, fault_of};
use crate::{
    Alarms, AxisOptions, Fault, RejectCode, SmartDrive, SmartDriveBus, SmartDriveOptions,
    StepsPerTurn,
    emulator::{DeviceOptions, EmulatedBus, EmulatorOptions, Wire},
};
use twin_drives::{DriveError, no_clock};

/// A drive of 3200 µsteps a turn, with its factory's ceilings.
fn axis(address: u8) -> AxisOptions {
    AxisOptions {
        address,
        turn: StepsPerTurn::new(200, 16).unwrap(),
        velocity_rpm: 500,
        acceleration_rpm_per_s: 2000,
        deceleration_rpm_per_s: 0,
    }
}

/// Options of a master of drive 1, in milliseconds.
fn options(deadline_ms: u64, worst_latency_ms: u64) -> SmartDriveOptions {
    let mut options = SmartDriveOptions::new(vec![axis(1)]);
    options.deadline = Duration::from_millis(deadline_ms);
    options.turnaround = Duration::ZERO;
    options.worst_latency = Duration::from_millis(worst_latency_ms);
    options
}

/// Options of a master of these drives for real time: other tests and builds may keep the emulator waiting.
fn patient(addresses: impl Iterator<Item = u8>) -> SmartDriveOptions {
    let mut options = SmartDriveOptions::new(addresses.map(axis).collect());
    options.deadline = Duration::from_secs(5);
    options.mode_change = Duration::from_secs(10);
    options
}

/// A master and the other end of its wire.
fn attached(options: &SmartDriveOptions) -> (SmartDrive, DuplexStream) {
    let (near, far) = duplex(4096);
    (SmartDrive::attach(Arc::from("wire"), near, options), far)
}

/// Devices with addresses from 1 on.
fn devices(count: u8) -> Vec<DeviceOptions> {
    (1..=count).map(|address| DeviceOptions { address, ..DeviceOptions::default() }).collect()
}

/// Devices on a pseudo-terminal in real time.
fn emulated(devices: Vec<DeviceOptions>, wire: Wire) -> (EmulatedBus, WallClock) {
    let options = EmulatorOptions { devices, wire, ..EmulatorOptions::default() };
    let clock = WallClock::new();
    (EmulatedBus::start(&options, move || clock.now()).unwrap(), clock)
}

/// The driver of emulated devices.
fn open(bus: &EmulatedBus, options: &SmartDriveOptions) -> SmartDriveBus {
    SmartDriveBus::open(bus.path().to_str().unwrap(), options).unwrap()
}

/// Position of drive 1 when it is at rest.
async fn rest(driver: &mut SmartDrive) -> i32 {
    loop {
        let (state, _) = driver.state(1, &no_clock).await.unwrap();
        if !state.moving() {
            return state.position;
        }
    }
}

/// Reason of a refusal.
#[track_caller]
fn refusal<T: Debug>(outcome: &Result<T, DriveError>) -> RejectCode {
    match fault_of(outcome) {
        Some(Fault::Rejected(reason)) => *reason,
        _ => panic!("{outcome:?}"),
    }
}

/// Alarms that have ended a request.
#[track_caller]
fn alarm<T: Debug>(outcome: &Result<T, DriveError>) -> Alarms {
    match fault_of(outcome) {
        Some(Fault::Alarm(alarms)) => *alarms,
        _ => panic!("{outcome:?}"),
    }
}
