//! Every fault of a wire in every state of a drive: the error of the caller, that the drive goes on, and that the bus
//! can be used afterwards. Shown as a table with `cargo test faults -- --nocapture`.

use std::{
    cell::{Cell, RefCell},
    time::Duration,
};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, DuplexStream},
    time::sleep,
};

use super::{attached, options};
use crate::{
    Init, IoUpdate, Mode, TrajectoryFlags,
    emulator::{Cam, Device, DeviceOptions, Input},
};
use twin_drives::{
    Direction::{self, Answer, Request},
    DriveError, FaultRule, FaultyWire, When, WireFault, no_clock,
};

const DEADLINE_MS: u64 = 250;

/// Fault of one exchange; whether it succeeds all the same, and whether the drive has executed the command.
type Fault = (Direction, WireFault, bool, bool);

const FAULTS: [Fault; 10] = [
    (Request, WireFault::Drop, false, false),
    (Request, WireFault::Corrupt { bytes: 1 }, false, false),
    (Request, WireFault::Truncate { keep: 4 }, false, false),
    (Answer, WireFault::Drop, false, true),
    // After the deadline, and before the driver speaks again.
    (Answer, WireFault::Delay { ns: 500_000_000 }, false, true),
    (Answer, WireFault::Corrupt { bytes: 1 }, false, true),
    (Answer, WireFault::Truncate { keep: 7 }, false, true),
    (Answer, WireFault::Duplicate, true, true),
    (Answer, WireFault::Noise { bytes: 3 }, true, true),
    (Request, WireFault::Echo, true, true),
];

/// What the drive is doing meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Doing {
    Resting,
    Homing,
    Moving,
    Stopping,
}

/// A device whose time passes by 5 ms with every command, at the end of a wire with a fault in the next exchange.
async fn serve(mut far: DuplexStream, device: &RefCell<Device>, armed: &Cell<Option<Fault>>) {
    let mut buffer = [0; 256];
    loop {
        let count = far.read(&mut buffer).await.unwrap();
        if count == 0 {
            return;
        }
        let mut wire = FaultyWire::new(0);
        if let Some((direction, fault, ..)) = armed.take() {
            wire.add(FaultRule { direction, when: When::Always, fault });
        }
        device.borrow_mut().advance(5_000_000);
        let passed = wire.pass(Request, &buffer[..count]);
        if passed.echo {
            far.write_all(&buffer[..count]).await.unwrap();
        }
        for (_, command) in passed.pieces {
            let answer = device.borrow_mut().handle(&command).unwrap_or_default();
            for (late_ns, piece) in wire.pass(Answer, &answer).pieces {
                sleep(Duration::from_nanos(late_ns.unsigned_abs())).await;
                far.write_all(&piece).await.unwrap();
            }
        }
    }
}

#[tokio::test(start_paused = true)]
async fn every_fault_in_every_state_is_survived_and_told() {
    let device_options = DeviceOptions {
        cams: vec![Cam { input: Input::Go, from: -9000.0, to: -500.0 }],
        configured_mode: Mode::Remote,
        ..DeviceOptions::default()
    };
    for fault in FAULTS {
        let (direction, of_wire, is_harmless, is_executed) = fault;
        for doing in [Doing::Resting, Doing::Homing, Doing::Moving, Doing::Stopping] {
            let device = RefCell::new(Device::new(&device_options));
            let armed = Cell::new(None);
            let (mut bus, far) = attached(&options(DEADLINE_MS, 2 * DEADLINE_MS));
            let testing = async {
                match doing {
                    Doing::Resting => {}
                    Doing::Homing => drop(bus.init(1, Init::Homing).await.unwrap()),
                    Doing::Moving => drop(bus.go_to(1, 3200, None).await.unwrap()),
                    Doing::Stopping => {
                        bus.start(1, 300, 0).await.unwrap();
                        for _ in 0..40 {
                            bus.state(1, &no_clock).await.unwrap();
                        }
                        bus.stop(1, 500).await.unwrap();
                    }
                }
                let name = format!("{direction:?}: {of_wire}, {doing:?}");
                // What may be repeated succeeds, and shows where the drive is.
                armed.set(Some(fault));
                let (state, _) = bus.state(1, &no_clock).await.unwrap();
                assert_eq!(state.position, device.borrow().counter(), "{name}");
                assert_eq!(state.moving(), doing != Doing::Resting, "{name}");
                // What may not be repeated fails with its cause, and has been executed once at most.
                armed.set(Some(fault));
                let switched = bus.io(1, IoUpdate { set: 0b100, ..IoUpdate::default() }).await;
                let message = match &switched {
                    Ok(_) => "none".to_owned(),
                    Err(error @ (DriveError::Timeout { .. } | DriveError::Protocol { .. })) => {
                        let text = error.to_string();
                        let message =
                            text.strip_prefix("wire, address 1: command 05h (IOUPDATE): ");
                        message.unwrap_or_else(|| panic!("{name}: {text}")).to_owned()
                    }
                    Err(error) => panic!("{name}: {error}"),
                };
                assert_eq!(switched.is_ok(), is_harmless, "{name}: {message}");
                assert_eq!(device.borrow().outputs() != 0, is_executed, "{name}");
                // Afterwards everything is in order, and what was begun ends as it should.
                let mut last = bus.state(1, &no_clock).await.unwrap().0;
                assert_eq!(last.position, device.borrow().counter(), "{name}");
                while last.moving() {
                    last = bus.state(1, &no_clock).await.unwrap().0;
                }
                assert_eq!(last.flags, TrajectoryFlags::DONE, "{name}");
                match doing {
                    Doing::Resting | Doing::Homing => assert_eq!(last.position, 0, "{name}"),
                    Doing::Moving => assert_eq!(last.position, 3200, "{name}"),
                    Doing::Stopping => assert!(last.position > 0, "{name}"),
                }
                println!("{name:<40} PING: none  IOUPDATE: {message}");
                drop(bus);
            };
            tokio::join!(serve(far, &device, &armed), testing);
        }
    }
}
