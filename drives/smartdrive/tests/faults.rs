//! Every fault of a wire in every state of a drive: the error of the caller, that the drive goes on, and that the bus
//! can be used afterwards. Shown as a table with `cargo test faults -- --nocapture`.

use std::{
    cell::{Cell, RefCell},
    rc::Rc,
    sync::Arc,
    time::Duration,
};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex},
    task::LocalSet,
    time::sleep,
};

use super::wire::{axis, no_clock, run};
use crate::{
    Init, IoUpdate, Mode, SmartDrive, SmartDriveOptions, TrajectoryFlags,
    emulator::{Cam, Device, DeviceOptions, Input},
};
use twin_drives::DriveError;

/// What happens to one exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    CommandLost,
    CommandCorrupt,
    CommandCut,
    AnswerLost,
    AnswerLate,
    AnswerCorrupt,
    AnswerCut,
    AnswerTwice,
    Noise,
    Echo,
}

impl Fault {
    const ALL: [Self; 10] = [
        Self::CommandLost,
        Self::CommandCorrupt,
        Self::CommandCut,
        Self::AnswerLost,
        Self::AnswerLate,
        Self::AnswerCorrupt,
        Self::AnswerCut,
        Self::AnswerTwice,
        Self::Noise,
        Self::Echo,
    ];

    /// Whether the exchange succeeds all the same.
    fn is_harmless(self) -> bool {
        matches!(self, Self::AnswerTwice | Self::Noise | Self::Echo)
    }

    /// Whether the drive has executed the command.
    fn is_executed(self) -> bool {
        !matches!(self, Self::CommandLost | Self::CommandCorrupt | Self::CommandCut)
    }
}

/// What the drive is doing meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Doing {
    Resting,
    Homing,
    Moving,
    Stopping,
}

/// Far longer than anything takes here, and waited for only where no answer comes; all lines run at the same time.
const DEADLINE: Duration = Duration::from_millis(250);

/// A device whose time passes by 5 ms with every command, at the end of a wire with one fault in it.
async fn serve(mut far: DuplexStream, device: Rc<RefCell<Device>>, fault: Rc<Cell<Option<Fault>>>) {
    let mut buffer = [0; 256];
    loop {
        let count = far.read(&mut buffer).await.unwrap();
        if count == 0 {
            return;
        }
        let mut command = buffer[..count].to_vec();
        let fault = fault.take();
        match fault {
            Some(Fault::CommandLost) => command.clear(),
            Some(Fault::CommandCorrupt) => command[2] ^= 0x04,
            Some(Fault::CommandCut) => command.truncate(4),
            Some(Fault::Echo) => far.write_all(&command).await.unwrap(),
            Some(Fault::Noise) => far.write_all(&[0x00, 0x7F, 0xC3]).await.unwrap(),
            _ => {}
        }
        device.borrow_mut().advance(5_000_000);
        let answer = device.borrow_mut().handle(&command);
        let Some(mut answer) = answer else { continue };
        match fault {
            Some(Fault::AnswerLost) => continue,
            // After the deadline, and before the driver speaks again.
            Some(Fault::AnswerLate) => sleep(2 * DEADLINE).await,
            Some(Fault::AnswerCorrupt) => answer[3] ^= 0x20,
            Some(Fault::AnswerCut) => answer.truncate(7),
            Some(Fault::AnswerTwice) => answer = [answer.clone(), answer].concat(),
            _ => {}
        }
        far.write_all(&answer).await.unwrap();
    }
}

/// A line of the table.
async fn one(fault: Fault, doing: Doing) -> String {
    let options = DeviceOptions {
        cams: vec![Cam { input: Input::Go, from: -9000.0, to: -500.0 }],
        configured_mode: Mode::Remote,
        ..DeviceOptions::default()
    };
    let device = Rc::new(RefCell::new(Device::new(&options)));
    let armed = Rc::new(Cell::new(None));
    let (near, far) = duplex(4096);
    let serving = tokio::task::spawn_local(serve(far, Rc::clone(&device), Rc::clone(&armed)));
    let mut options = SmartDriveOptions::new(vec![axis(1)]);
    (options.deadline, options.worst_latency) = (DEADLINE, 2 * DEADLINE);
    let mut bus = SmartDrive::attach(Arc::from("wire"), near, &options);
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
    // What may be repeated succeeds, and shows where the drive is.
    armed.set(Some(fault));
    let (state, _) = bus.state(1, &no_clock).await.unwrap();
    assert_eq!(state.position, device.borrow().counter(), "{fault:?}, {doing:?}");
    assert_eq!(state.moving(), doing != Doing::Resting, "{fault:?}, {doing:?}");
    // What may not be repeated fails with its cause, and has been executed once at most.
    armed.set(Some(fault));
    let switched = bus.io(1, IoUpdate { set: 0b100, ..IoUpdate::default() }).await;
    let told = match &switched {
        Ok(_) => "none".to_owned(),
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with("wire, address 1: command 05h (IOUPDATE): "), "{text}");
            assert!(matches!(error, DriveError::Timeout { .. } | DriveError::Protocol { .. }));
            text.rsplit(": ").next().unwrap_or_default().to_owned()
        }
    };
    assert_eq!(switched.is_ok(), fault.is_harmless(), "{fault:?}, {doing:?}");
    assert_eq!(device.borrow().outputs() != 0, fault.is_executed(), "{fault:?}, {doing:?}");
    // Afterwards everything is in order, and what was begun ends as it should.
    let mut last = bus.state(1, &no_clock).await.unwrap().0;
    assert_eq!(last.position, device.borrow().counter(), "{fault:?}, {doing:?}");
    while last.moving() {
        last = bus.state(1, &no_clock).await.unwrap().0;
    }
    assert_eq!(last.flags, TrajectoryFlags::DONE, "{fault:?}, {doing:?}");
    match doing {
        Doing::Resting | Doing::Homing => assert_eq!(last.position, 0),
        Doing::Moving => assert_eq!(last.position, 3200),
        Doing::Stopping => assert!(last.position > 0),
    }
    drop(bus);
    serving.await.unwrap();
    format!("{:<16} {:<9} PING: none  IOUPDATE: {told}", format!("{fault:?}"), format!("{doing:?}"))
}

#[test]
fn every_fault_in_every_state_is_survived_and_told() {
    let lines = run(LocalSet::new().run_until(async {
        let states = [Doing::Resting, Doing::Homing, Doing::Moving, Doing::Stopping];
        let all = Fault::ALL.into_iter().flat_map(|fault| states.map(|doing| (fault, doing)));
        let running: Vec<_> =
            all.map(|(fault, doing)| tokio::task::spawn_local(one(fault, doing))).collect();
        let mut lines = Vec::new();
        for line in running {
            lines.push(line.await.unwrap());
        }
        lines
    }));
    assert_eq!(lines.len(), 40);
    println!("{}", lines.join("\n"));
}
