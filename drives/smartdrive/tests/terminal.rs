//! The driver against the emulator, on a pseudo-terminal and in real time.

use std::{
    f64::consts::TAU,
    io::{Read, Write},
    time::Duration,
};

use serialport::TTYPort;

use super::wire::axis;
use crate::Fault;
use crate::tests::common::fault_of;
use crate::tests::common::wall_clock;
use crate::{
    Alarms, Command, Mode, SmartDriveBus, SmartDriveOptions,
    emulator::{
        Cam, Device, DeviceOptions, EmulatedBus, EmulatorOptions, Event, HomingOptions, Input, Wire,
    },
    protocol::{frame::encode, vectors::vector},
};
use twin_drives::{Axes, Drive, DriveError, IncrementMotion, MAX_DRIVE_AXES, SetpointStream};

/// A plan of two axes: to and fro, at rest before and after, from 500 and −500 on.
struct Plan<C> {
    clock: C,
    start_ns: i64,
}

/// Stroke of the first axis, increments; the second makes half of it.
const STROKE: f64 = 4000.0;
const PERIOD_S: f64 = 1.0;
const STARTS: [i64; MAX_DRIVE_AXES] = [500, -500, 0, 0, 0];

#[expect(clippy::cast_precision_loss, reason = "seconds and small positions")]
impl<C: Fn() -> i64 + Sync> SetpointStream for Plan<C> {
    fn now_ns(&self) -> i64 {
        (self.clock)() - self.start_ns
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        let time = (time_ns as f64 * 1e-9).clamp(0.0, 1.5 * PERIOD_S);
        let mut motion = IncrementMotion::default();
        for axis in 0..2 {
            let (half, angle) = (STROKE / [2.0, 4.0][axis], TAU / PERIOD_S);
            motion.position[axis] = STARTS[axis] as f64 + half * (1.0 - (angle * time).cos());
            motion.velocity[axis] = half * angle * (angle * time).sin();
        }
        motion
    }

    fn horizon_ns(&self) -> i64 {
        250_000_000
    }
}

/// Drives with addresses 1 and 2.
fn devices(count: u8) -> Vec<DeviceOptions> {
    (1..=count).map(|address| DeviceOptions { address, ..DeviceOptions::default() }).collect()
}

fn start(
    devices: Vec<DeviceOptions>,
    wire: Wire,
    clock: impl Fn() -> i64 + Send + Sync + 'static,
) -> EmulatedBus {
    let options = EmulatorOptions { devices, wire, ..EmulatorOptions::default() };
    EmulatedBus::start(&options, clock).unwrap()
}

fn open(bus: &EmulatedBus, count: u8) -> SmartDriveBus {
    let mut options = SmartDriveOptions::new((1..=count).map(axis).collect());
    // Other tests and builds may keep the emulator waiting.
    options.deadline = Duration::from_secs(2);
    options.mode_change = Duration::from_secs(10);
    SmartDriveBus::open(bus.path().to_str().unwrap(), &options).unwrap()
}

fn wait_until_rest(
    drive: &mut SmartDriveBus,
    stream: &dyn SetpointStream,
) -> [i64; MAX_DRIVE_AXES] {
    loop {
        let sample = drive.sample(stream).unwrap();
        if !sample.moving {
            return sample.position;
        }
    }
}

#[test]
fn drives_are_enabled_moved_and_stopped() {
    let clock = wall_clock();
    let bus = start(devices(2), Wire::default(), clock);
    let stream = Plan { clock, start_ns: 0 };
    let mut drive = open(&bus, 2);
    assert_eq!(drive.axis_count(), 2);
    let name = format!("SmartDRIVE at {}, addresses 1, 2", bus.path().display());
    assert_eq!(drive.describe(), name);

    let before = clock();
    let sample = drive.probe(&stream).unwrap();
    assert_eq!((sample.position, sample.moving), ([0; 5], false));
    assert!(sample.time_ns > before && sample.time_ns < clock());
    let off = drive.sample(&stream);
    assert!(matches!(off, Err(DriveError::Mode { expected: 3, found: 0, .. })), "{off:?}");

    drive.enable().unwrap();
    drive.set_position(&STARTS).unwrap();
    drive.move_to(&[4000, -3000, 0, 0, 0], &[16e3, 8e3, 0.0, 0.0, 0.0]).unwrap();
    assert!(drive.sample(&stream).unwrap().moving);
    let moving = drive.set_position(&[0; 5]);
    assert!(matches!(moving, Err(DriveError::Moving { .. })), "{moving:?}");
    assert_eq!(wait_until_rest(&mut drive, &stream), [4000, -3000, 0, 0, 0]);
    // Enabled once more they keep their positions.
    drive.enable().unwrap();
    assert_eq!(drive.sample(&stream).unwrap().position, [4000, -3000, 0, 0, 0]);
    // 53.33 µsteps/s are one rpm.
    let slow = drive.move_to(&[0; 5], &[50.0; 5]);
    assert!(matches!(slow, Err(DriveError::Value { what: "speed", .. })), "{slow:?}");
    let far = drive.move_to(&[i64::from(i32::MAX) + 501, 0, 0, 0, 0], &[1e3; 5]);
    assert!(matches!(far, Err(DriveError::Value { what: "target", .. })), "{far:?}");

    drive.move_to(&[1_000_000, -3000, 0, 0, 0], &[16e3, 8e3, 0.0, 0.0, 0.0]).unwrap();
    drive.soft_stop().unwrap();
    let sample = drive.sample(&stream).unwrap();
    assert!(
        !sample.moving && sample.position[0] > 4000 && sample.position[0] < 1_000_000,
        "{sample:?}"
    );
    drive.set_output(6, true).unwrap();
    let none = drive.set_output(7, true);
    assert!(matches!(none, Err(DriveError::Value { what: "output", .. })), "{none:?}");

    drive.move_to(&[1_000_000, 0, 0, 0, 0], &[16e3, 8e3, 0.0, 0.0, 0.0]).unwrap();
    drive.hard_stop().unwrap();
    assert!(matches!(drive.sample(&stream), Err(DriveError::Mode { .. })));
    let devices = bus.stop().unwrap();
    for device in &devices {
        assert_eq!((device.mode(), device.motion().1.to_bits()), (Mode::Off, 0));
    }
    assert_eq!((devices[0].outputs(), devices[1].outputs()), (0, 0b100));
}

#[test]
fn a_plan_is_followed_to_its_end() {
    let clock = wall_clock();
    let bus = start(devices(2), Wire::default(), clock);
    let mut drive = open(&bus, 2);
    drive.enable().unwrap();
    drive.set_position(&STARTS).unwrap();
    let stream = Plan { clock, start_ns: clock() + 100_000_000 };
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
        let positions =
            || samples.iter().map(move |sample| (sample.time_ns, sample.position[axis]));
        #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
        let error =
            |(time_ns, position): (i64, i64)| position as f64 - stream.at(time_ns).position[axis];
        let squares: f64 = positions().map(|seen| error(seen).powi(2)).sum();
        let count = f64::from(u32::try_from(samples.len()).unwrap());
        println!("axis {axis}: {count} samples, error rms {:.1} µsteps", (squares / count).sqrt());
        // Both axes have really gone there; accuracy is asserted where time is not real.
        let (_, last) = positions().next_back().unwrap();
        assert_eq!(last.to_string(), format!("{:.0}", end[axis]));
        assert!(positions().any(|(_, position)| position > start && position < last));
    }
}

#[test]
fn drives_that_stop_obeying_say_why() {
    let clock = wall_clock();
    let stream = Plan { clock, start_ns: 0 };
    let bus = start(devices(2), Wire::default(), clock);
    let mut drive = open(&bus, 2);
    drive.enable().unwrap();
    let lost = |drive: &mut SmartDriveBus| loop {
        match drive.sample(&stream) {
            Ok(_) => {}
            Err(error) => break error,
        }
    };
    drive.move_to(&[-1_000_000, 0, 0, 0, 0], &[8e3; 5]).unwrap();
    bus.control(Event::Input { input: Input::LimN, level: true }.to(0)).unwrap();
    let limit = lost(&mut drive);
    assert!(matches!(limit, DriveError::LimitSwitch { axes: Axes::Only, .. }), "{limit:?}");
    // At rest it can be moved away from the switch.
    while drive.run(async |bus| bus.state(1, &clock).await).unwrap().0.moving() {}
    drive.move_to(&[100, 0, 0, 0, 0], &[8e3; 5]).unwrap();
    drive.sample(&stream).unwrap();
    bus.control(Event::Input { input: Input::LimN, level: false }.to(0)).unwrap();

    drive.move_to(&[100, 1_000_000, 0, 0, 0], &[8e3; 5]).unwrap();
    let fault = Alarms::OVERTEMPERATURE;
    bus.control(Event::Fault { alarms: fault, present: true }.to(1)).unwrap();
    let alarm = lost(&mut drive);
    assert_eq!(alarm.fault(), Some(&Fault::Alarm(fault)));
    assert_eq!(alarm.at().address, 2);
    // A move is refused for the mode, which is for the alarm.
    let refused = drive.move_to(&[0; 5], &[8e3; 5]);
    assert!(matches!(fault_of(&refused), Some(Fault::Alarm(_))), "{refused:?}");
    let refused = drive.enable();
    assert!(matches!(fault_of(&refused), Some(Fault::Alarm(_))), "{refused:?}");
    bus.control(Event::Fault { alarms: fault, present: false }.to(1)).unwrap();
    drive.enable().unwrap();
    assert_eq!(drive.sample(&stream).unwrap().position[1], 0);
}

#[test]
fn drives_are_homed_together() {
    let clock = wall_clock();
    let stream = Plan { clock, start_ns: 0 };
    let with_switch = |mut device: DeviceOptions| {
        device.cams = vec![Cam { input: Input::Dir, from: 600.0, to: 5000.0 }];
        device.homing = HomingOptions { input: Input::Dir, positive: true, ..device.homing };
        device
    };
    let bus = start(devices(2).into_iter().map(with_switch).collect(), Wire::default(), clock);
    let mut drive = open(&bus, 2);
    drive.enable().unwrap();
    drive.run(async |bus| bus.set_parameter(2, 100, 250).await).unwrap();
    drive.set_position(&[77; 5]).unwrap();
    drive.home(&[0, 1]).unwrap();
    assert_eq!(drive.sample(&stream).unwrap().position, [0, 250, 0, 0, 0]);
    let devices = bus.stop().unwrap();
    for device in devices {
        assert!((device.mechanical() - 600.0).abs() < 2.0);
    }
}

#[test]
fn a_drive_that_is_set_otherwise_is_found_out() {
    let clock = wall_clock();
    let stream = Plan { clock, start_ns: 0 };
    let bus = start(devices(1), Wire::default(), clock);
    let mut drive = open(&bus, 1);
    for (index, value, good) in [(43, 400, 200), (30, 499, 500), (31, 1999, 2000), (32, 5, 2000)] {
        drive.run(async |bus| bus.set_parameter(1, index, value).await).unwrap();
        let found = drive.probe(&stream);
        assert!(matches!(found, Err(DriveError::Parameter { .. })), "{index}: {found:?}");
        drive.run(async |bus| bus.set_parameter(1, index, good).await).unwrap();
    }
    drive.probe(&stream).unwrap();
}

#[test]
fn an_adapter_with_echo_and_drives_that_take_50_ms_work() {
    let clock = wall_clock();
    let wire = Wire { response: Duration::from_millis(50), echo: true, ..Wire::default() };
    let bus = start(devices(1), wire, clock);
    let stream = Plan { clock, start_ns: 0 };
    let mut drive = open(&bus, 1);
    drive.enable().unwrap();
    drive.move_to(&[300, 0, 0, 0, 0], &[16e3; 5]).unwrap();
    assert_eq!(wait_until_rest(&mut drive, &stream)[0], 300);
    drive.soft_stop().unwrap();
    drive.hard_stop().unwrap();
}

#[test]
fn a_drive_that_is_not_there_is_a_timeout() {
    let clock = wall_clock();
    let stream = Plan { clock, start_ns: 0 };
    let bus = start(devices(1), Wire::default(), clock);
    let mut options = SmartDriveOptions::new(vec![axis(9)]);
    options.deadline = Duration::from_millis(30);
    options.worst_latency = Duration::from_millis(5);
    let mut nobody = SmartDriveBus::open(bus.path().to_str().unwrap(), &options).unwrap();
    let lost = nobody.sample(&stream);
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
    let bus = start(devices(2), Wire::default(), wall_clock());
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
    let clock = wall_clock();
    let bus = start(devices(1), Wire::default(), clock);
    let mut drive = open(&bus, 1);
    drive.run(async |bus| bus.set_parameter(1, 30, 777).await).unwrap();
    drive.run(async |bus| bus.save(1).await).unwrap();
    drop(drive);
    let flash = bus.stop().unwrap().iter().map(Device::flash).collect();
    let options = EmulatorOptions { devices: devices(1), flash, ..EmulatorOptions::default() };
    let bus = EmulatedBus::start(&options, clock).unwrap();
    let mut drive = open(&bus, 1);
    let value = drive.run(async |bus| bus.parameter(1, 30).await).unwrap();
    assert_eq!((value.saved, value.working, value.factory), (777, 777, 500));
}

#[test]
fn a_drive_that_does_not_answer_does_not_cost_the_others_their_current() {
    let clock = wall_clock();
    let bus = start(devices(2), Wire::default(), clock);
    let mut options = SmartDriveOptions::new(vec![axis(1), axis(2)]);
    // The deadlines of the silent one are waited for.
    (options.deadline, options.worst_latency) = (Duration::from_millis(300), Duration::ZERO);
    options.mode_change = Duration::from_secs(1);
    let mut drive = SmartDriveBus::open(bus.path().to_str().unwrap(), &options).unwrap();
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
    let clock = wall_clock();
    let bus = start(devices(1), Wire::default(), clock);
    let mut drive = open(&bus, 1);
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
    let (mut device, terminal) = TTYPort::pair().unwrap();
    let name = serialport::SerialPort::name(&terminal).unwrap();
    let mut options = SmartDriveOptions::new(vec![axis(1)]);
    options.deadline = Duration::from_secs(5);
    let mut drive = SmartDriveBus::open(&name, &options).unwrap();
    let answer = move || {
        serialport::SerialPort::set_timeout(&mut device, Duration::from_secs(5)).unwrap();
        device.read_exact(&mut [0; 7]).unwrap();
        // GO and LED are on.
        device.write_all(&vector(30)).unwrap();
        device
    };
    let answering = std::thread::Builder::new().name("drive".to_owned()).spawn(answer).unwrap();
    let error = drive.set_output(3, false).unwrap_err();
    drop(answering.join().unwrap());
    let text = error.to_string();
    let said = "address 1: switching output 3 off: the output is still on, although the drive has confirmed the command";
    assert!(text.ends_with(said), "{text}");
}
