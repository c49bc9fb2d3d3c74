//! The driver against the emulator, on a pseudo-terminal and in real time.

use std::{
    f64::consts::TAU,
    io::{Read, Write},
    time::Duration,
};

use serialport::TTYPort;
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    runtime::Builder,
};

use super::{
    alarm, attached, axis,
    common::{Plan, WallClock},
    devices, emulated, open, options, patient,
};
use crate::{
    Alarms, Command, Fault, Mode, SmartDriveBus, SmartDriveOptions,
    emulator::{
        Cam, Device, DeviceOptions, EmulatedBus, EmulatorOptions, Event, HomingOptions, Input, Wire,
    },
    protocol::{frame::encode, vectors::vector},
};
use twin_drives::{
    Axes, Drive, DriveError, IncrementMotion, MAX_DRIVE_AXES, SetpointStream, no_clock,
};

/// Positions at the start of the plan, µsteps.
const STARTS: [i64; MAX_DRIVE_AXES] = [500, -500, 0, 0, 0];

/// To, fro and to once more in 1.5 s, the first axis by 4000 µsteps, the second by half of that; at rest before and after.
fn to_and_fro(time: f64) -> IncrementMotion {
    let angle = TAU * time.clamp(0.0, 1.5);
    let axis =
        |(from, half): (f64, f64)| (from + half * (1.0 - angle.cos()), half * TAU * angle.sin());
    IncrementMotion::of([(500.0, 2000.0), (-500.0, 1000.0)].into_iter().map(axis))
}

/// Drives with addresses from 1 on, and their driver.
fn drives(count: u8) -> (EmulatedBus, SmartDriveBus, WallClock) {
    let (bus, clock) = emulated(devices(count), Wire::default());
    let drive = open(&bus, &patient(1..=count));
    (bus, drive, clock)
}

fn wait_until_rest(drive: &mut SmartDriveBus, clock: WallClock) -> [i64; MAX_DRIVE_AXES] {
    loop {
        let sample = drive.sample(&clock).unwrap();
        if !sample.moving {
            return sample.position;
        }
    }
}

#[test]
fn drives_are_enabled_moved_and_stopped() {
    let (bus, mut drive, clock) = drives(2);
    assert_eq!(drive.axis_count(), 2);
    let name = format!("SmartDRIVE at {}, addresses 1, 2", bus.path().display());
    assert_eq!(drive.describe(), name);

    let before = clock.now();
    let sample = drive.probe(&clock).unwrap();
    assert_eq!((sample.position, sample.moving), ([0; 5], false));
    assert!(sample.time_ns > before && sample.time_ns < clock.now());
    let off = drive.sample(&clock);
    assert!(matches!(off, Err(DriveError::Mode { expected: 3, found: 0, .. })), "{off:?}");

    drive.enable().unwrap();
    drive.set_position(&STARTS).unwrap();
    drive.move_to(&[4000, -3000, 0, 0, 0], &[16e3, 8e3, 0.0, 0.0, 0.0]).unwrap();
    assert!(drive.sample(&clock).unwrap().moving);
    let moving = drive.set_position(&[0; 5]);
    assert!(matches!(moving, Err(DriveError::Moving { .. })), "{moving:?}");
    assert_eq!(wait_until_rest(&mut drive, clock), [4000, -3000, 0, 0, 0]);
    // Enabled once more they keep their positions.
    drive.enable().unwrap();
    assert_eq!(drive.sample(&clock).unwrap().position, [4000, -3000, 0, 0, 0]);
    // 53.33 µsteps/s are one rpm.
    let slow = drive.move_to(&[0; 5], &[50.0; 5]);
    assert!(matches!(slow, Err(DriveError::Value { what: "speed", .. })), "{slow:?}");
    let far = drive.move_to(&[i64::from(i32::MAX) + 501, 0, 0, 0, 0], &[1e3; 5]);
    assert!(matches!(far, Err(DriveError::Value { what: "target", .. })), "{far:?}");

    drive.move_to(&[1_000_000, -3000, 0, 0, 0], &[16e3, 8e3, 0.0, 0.0, 0.0]).unwrap();
    drive.soft_stop().unwrap();
    let sample = drive.sample(&clock).unwrap();
    assert!(!sample.moving && (4001..1_000_000).contains(&sample.position[0]), "{sample:?}");
    drive.set_output(6, true).unwrap();
    let none = drive.set_output(7, true);
    assert!(matches!(none, Err(DriveError::Value { what: "output", .. })), "{none:?}");

    drive.move_to(&[1_000_000, 0, 0, 0, 0], &[16e3, 8e3, 0.0, 0.0, 0.0]).unwrap();
    drive.hard_stop().unwrap();
    assert!(matches!(drive.sample(&clock), Err(DriveError::Mode { .. })));
    let devices = bus.stop().unwrap();
    for device in &devices {
        assert_eq!((device.mode(), device.motion().1.to_bits()), (Mode::Off, 0));
    }
    assert_eq!((devices[0].outputs(), devices[1].outputs()), (0, 0b100));
}

#[test]
fn a_plan_is_followed_to_its_end() {
    let (_bus, mut drive, clock) = drives(2);
    drive.enable().unwrap();
    drive.set_position(&STARTS).unwrap();
    let start_ns = clock.now() + 100_000_000;
    let stream = Plan { clock: move || clock.now(), start_ns, of: to_and_fro };
    let mut samples = Vec::new();
    loop {
        let sample = drive.follow(&stream).unwrap();
        samples.push(sample);
        if sample.time_ns > 1_600_000_000 && !sample.moving {
            break;
        }
    }
    let end = stream.at(i64::MAX).position;
    for (axis, start) in STARTS.into_iter().enumerate().take(2) {
        // Both axes have really gone there; accuracy is asserted where time is not real.
        let last = samples.last().unwrap().position[axis];
        assert_eq!(last.to_string(), format!("{:.0}", end[axis]));
        let between = |position: i64| position > start && position < last;
        assert!(samples.iter().any(|sample| between(sample.position[axis])));
    }
}

#[test]
fn drives_that_stop_obeying_say_why() {
    let (bus, mut drive, clock) = drives(2);
    drive.enable().unwrap();
    let lost = |drive: &mut SmartDriveBus| loop {
        match drive.sample(&clock) {
            Ok(_) => {}
            Err(error) => break error,
        }
    };
    drive.move_to(&[-1_000_000, 0, 0, 0, 0], &[8e3; 5]).unwrap();
    bus.control(Event::Input { input: Input::LimN, level: true }.to(0)).unwrap();
    let limit = lost(&mut drive);
    assert!(matches!(limit, DriveError::LimitSwitch { axes: Axes::Only, .. }), "{limit:?}");
    // At rest it can be moved away from the switch.
    while drive.run(async |bus| bus.state(1, &no_clock).await).unwrap().0.moving() {}
    drive.move_to(&[100, 0, 0, 0, 0], &[8e3; 5]).unwrap();
    drive.sample(&clock).unwrap();
    bus.control(Event::Input { input: Input::LimN, level: false }.to(0)).unwrap();

    drive.move_to(&[100, 1_000_000, 0, 0, 0], &[8e3; 5]).unwrap();
    let fault = Alarms::OVERTEMPERATURE;
    bus.control(Event::Fault { alarms: fault, present: true }.to(1)).unwrap();
    let error = lost(&mut drive);
    assert_eq!((error.fault(), error.at().address), (Some(&Fault::Alarm(fault)), 2));
    // A move is refused for the mode, which is for the alarm.
    assert_eq!(alarm(&drive.move_to(&[0; 5], &[8e3; 5])), fault);
    assert_eq!(alarm(&drive.enable()), fault);
    bus.control(Event::Fault { alarms: fault, present: false }.to(1)).unwrap();
    drive.enable().unwrap();
    assert_eq!(drive.sample(&clock).unwrap().position[1], 0);
}

#[test]
fn drives_are_homed_together() {
    let with_switch = |mut device: DeviceOptions| {
        device.cams = vec![Cam { input: Input::Dir, from: 600.0, to: 5000.0 }];
        device.homing = HomingOptions { input: Input::Dir, positive: true, ..device.homing };
        device
    };
    let with_switches = devices(2).into_iter().map(with_switch).collect();
    let (bus, clock) = emulated(with_switches, Wire::default());
    let mut drive = open(&bus, &patient(1..=2));
    drive.enable().unwrap();
    drive.run(async |bus| bus.set_parameter(2, 100, 250).await).unwrap();
    drive.set_position(&[77; 5]).unwrap();
    drive.home(&[0, 1]).unwrap();
    assert_eq!(drive.sample(&clock).unwrap().position, [0, 250, 0, 0, 0]);
    let devices = bus.stop().unwrap();
    for device in devices {
        assert!((device.mechanical() - 600.0).abs() < 2.0);
    }
}

#[test]
fn a_drive_that_is_set_otherwise_is_found_out() {
    let (_bus, mut drive, clock) = drives(1);
    for (index, value, good) in [(43, 400, 200), (30, 499, 500), (31, 1999, 2000), (32, 5, 2000)] {
        drive.run(async |bus| bus.set_parameter(1, index, value).await).unwrap();
        let found = drive.probe(&clock);
        assert!(matches!(found, Err(DriveError::Parameter { .. })), "{index}: {found:?}");
        drive.run(async |bus| bus.set_parameter(1, index, good).await).unwrap();
    }
    drive.probe(&clock).unwrap();
}

#[test]
fn an_adapter_with_echo_and_drives_that_take_50_ms_work() {
    let wire = Wire { response: Duration::from_millis(50), echo: true, ..Wire::default() };
    let (bus, clock) = emulated(devices(1), wire);
    let mut drive = open(&bus, &patient(1..=1));
    drive.enable().unwrap();
    drive.move_to(&[300, 0, 0, 0, 0], &[16e3; 5]).unwrap();
    assert_eq!(wait_until_rest(&mut drive, clock)[0], 300);
    drive.soft_stop().unwrap();
    drive.hard_stop().unwrap();
}

#[test]
fn a_drive_that_is_not_there_is_a_timeout() {
    let (bus, clock) = emulated(devices(1), Wire::default());
    let mut nobody = open(&bus, &SmartDriveOptions { axes: vec![axis(9)], ..options(30, 5) });
    let lost = nobody.sample(&clock);
    let Err(DriveError::Timeout { at, .. }) = lost else { panic!("{lost:?}") };
    assert_eq!(at.address, 9);
    assert_eq!(at.to_string(), format!("{}, address 9: command 01h (PING)", bus.path().display()));
}

#[test]
fn a_port_that_is_not_there_is_named() {
    let missing = SmartDriveBus::open("/dev/no-such-port", &SmartDriveOptions::new(vec![axis(3)]));
    let Err(error @ DriveError::Transport { .. }) = missing else { panic!("{missing:?}") };
    let text = error.to_string();
    assert!(text.starts_with("/dev/no-such-port, address 3: opening the port: "), "{text}");
}

#[test]
fn noise_and_frames_in_pieces_leave_the_drives_answering() {
    let (bus, _) = emulated(devices(2), Wire::default());
    let port = serialport::new(bus.path().to_str().unwrap(), 115_200);
    let mut port = TTYPort::open(&port.timeout(Duration::from_secs(5))).unwrap();
    // Silence ends what is no frame; without it the next frame would belong to it.
    let silence = || std::thread::sleep(Duration::from_millis(100));
    let expect = |port: &mut TTYPort, answer: &[u8]| {
        let mut received = vec![0; answer.len()];
        port.read_exact(&mut received).unwrap();
        assert_eq!(received, answer);
    };
    port.write_all(&[0x55; 30]).unwrap();
    silence();
    port.write_all(&vector(1)[..4]).unwrap();
    silence();
    // A wrong check sum and a broadcast get no answer, the command after them does.
    let mut wrong = vector(1);
    wrong[6] ^= 1;
    let off = encode(0, &Command::Mode(Some(Mode::Remote)));
    port.write_all(&[wrong, off, vector(1)].concat()).unwrap();
    expect(&mut port, &vector(5));
    // The second drive has heard the broadcast too.
    port.write_all(&encode(2, &Command::Ping)).unwrap();
    let mut received = [0; 9];
    port.read_exact(&mut received).unwrap();
    assert_eq!(received[..2], [0xBE, 0x02]);
    drop(port);
    let handled: Vec<u64> = bus.stop().unwrap().iter().map(Device::frames_handled).collect();
    assert_eq!(handled, [2, 2]);
}

#[test]
fn what_is_saved_is_there_at_the_next_start() {
    let (bus, mut drive, clock) = drives(1);
    drive.run(async |bus| bus.set_parameter(1, 30, 777).await).unwrap();
    drive.run(async |bus| bus.save(1).await).unwrap();
    drop(drive);
    let flash = bus.stop().unwrap().iter().map(Device::flash).collect();
    let options = EmulatorOptions { devices: devices(1), flash, ..EmulatorOptions::default() };
    let bus = EmulatedBus::start(&options, move || clock.now()).unwrap();
    let mut drive = open(&bus, &patient(1..=1));
    let value = drive.run(async |bus| bus.parameter(1, 30).await).unwrap();
    assert_eq!((value.saved, value.working, value.factory), (777, 777, 500));
}

#[test]
fn a_drive_that_does_not_answer_does_not_cost_the_others_their_current() {
    let (bus, _) = emulated(devices(2), Wire::default());
    // The deadlines of the silent one are waited for.
    let axes = vec![axis(1), axis(2)];
    let mut drive = open(&bus, &SmartDriveOptions { axes, ..options(300, 0) });
    while drive.enable().is_err() {}
    for silent in [1, 0] {
        while drive.move_to(&[1_000_000, 1_000_000, 0, 0, 0], &[8e3; 5]).is_err() {}
        // The supply of one fails, for so long that it is not back.
        bus.control(Event::BrownOut { off_ns: 1_000_000_000_000 }.to(silent)).unwrap();
        let other = 1 - silent;
        let address = |place: usize| u8::try_from(place + 1).unwrap();
        let mode = |place: usize| bus.look().unwrap()[place].mode();
        let error = drive.soft_stop().unwrap_err();
        assert_eq!(error.at().address, address(silent), "{error}");
        assert_eq!(bus.look().unwrap()[other].motion().1.to_bits(), 0, "the other one stands");
        let error = drive.hard_stop().unwrap_err();
        assert_eq!(error.at().address, address(silent), "{error}");
        assert_eq!(mode(other), Mode::Remote, "what has stopped keeps its current");
        // Asked to stop at once without having been asked to stop: everything is switched off.
        let error = drive.hard_stop().unwrap_err();
        assert_eq!(error.at().address, address(silent), "{error}");
        while mode(other) == Mode::Changing {}
        assert_eq!(mode(other), Mode::Off);
        bus.control(Event::BrownOut { off_ns: 0 }.to(silent)).unwrap();
        while drive.enable().is_err() {}
    }
}

#[test]
fn a_drive_that_does_not_show_that_it_is_off_is_told_by_its_mode() {
    let (bus, mut drive, _) = drives(1);
    while drive.enable().is_err() {}
    bus.control(Event::StuckStatus(true).to(0)).unwrap();
    // It is switching off and refuses to be told again, which is not what is wrong.
    let error = drive.hard_stop().unwrap_err();
    let remote = Mode::Remote.number();
    assert!(matches!(error, DriveError::Mode { found, .. } if found == remote), "{error}");
    while bus.look().unwrap()[0].mode() == Mode::Changing {}
    assert_eq!(bus.look().unwrap()[0].mode(), Mode::Off);
}

#[test]
fn an_output_that_is_not_switched_is_told_as_such() {
    let runtime = Builder::new_current_thread().enable_all().build().unwrap();
    let (bus, mut far) = attached(&patient(1..=1));
    let _line = runtime.spawn(async move {
        far.read_exact(&mut [0; 7]).await.unwrap();
        // GO and LED are on.
        far.write_all(&vector(30)).await.unwrap();
        far
    });
    let mut drive = SmartDriveBus::on(runtime, bus, &patient(1..=1));
    let error = drive.set_output(3, false).unwrap_err();
    let text = error.to_string();
    let said = "address 1: switching output 3 off: the output is still on, although the drive has confirmed the command";
    assert!(text.ends_with(said), "{text}");
}
