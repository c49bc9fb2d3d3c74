//! The driver against the emulator, on a pseudo-terminal and in real time.

use std::{
    io::{Read, Write},
    time::Duration,
};

use serialport::TTYPort;

use super::{
    ENABLE_OPEN, LOCKED, Plan, TIMEOUT,
    common::{WallClock, wall_clock},
    emulated, fails, sines, steep, switch,
};
use crate::{
    AxisOptions, BoardAxis, Following, InterpCncDrive, InterpCncOptions, Line, Parity,
    emulator::{Bench, BoardOptions, Control, EmulatedBoard, EmulatorOptions, Event, Wire},
    protocol::{
        frame::seal,
        parameters,
        vectors::{bytes, vector},
    },
};
use twin_drives::{
    Direction, Drive, DriveError, FaultRule, IncrementMotion, MAX_DRIVE_AXES, ParameterId, Sample,
    SetpointStream, When, WireFault,
};

/// Strokes of two axes, increments, at 1 Hz.
const STROKES: [f64; 2] = [8000.0, 4000.0];

/// A plan of two axes: to and fro, and to its far end.
pub(super) fn to_and_fro<C>(
    clock: C,
    start_ns: i64,
) -> Plan<C, impl Fn(f64) -> IncrementMotion + Sync> {
    let waves = STROKES.map(|stroke| (stroke / 2.0, 1.0)).to_vec();
    Plan::new(clock, start_ns, 1.5, sines(waves))
}

pub(super) fn options(axes: &[BoardAxis]) -> InterpCncOptions {
    let axis = |axis: &BoardAxis| AxisOptions { max_speed_hz: 100_000, ..steep(*axis) };
    let mut options = InterpCncOptions::new(axes.iter().map(axis).collect());
    // Other tests and builds may keep the emulator waiting.
    options.deadline = Duration::from_secs(2);
    options
}

pub(super) fn open(board: &EmulatedBoard, options: &InterpCncOptions) -> InterpCncDrive {
    InterpCncDrive::open(board.path().to_str().unwrap(), options).unwrap()
}

/// A driver of some axes of a board, unlocked.
fn enabled(board: &EmulatedBoard, axes: &[BoardAxis]) -> InterpCncDrive {
    let mut drive = open(board, &options(axes));
    drive.enable().unwrap();
    drive
}

pub(super) fn rests(
    drive: &mut InterpCncDrive,
    stream: &dyn SetpointStream,
) -> Result<[i64; MAX_DRIVE_AXES], DriveError> {
    loop {
        let sample = drive.sample(stream)?;
        if !sample.moving {
            return Ok(sample.position);
        }
    }
}

/// Follows a plan of 1.5 s. On a busy machine the last commands come after its end: a few cycles at rest show that none is
/// left.
pub(super) fn follow_to_end(
    drive: &mut InterpCncDrive,
    stream: &dyn SetpointStream,
) -> Result<Vec<Sample>, DriveError> {
    let (mut samples, mut resting) = (Vec::new(), 0);
    while resting < 20 {
        let sample = drive.follow(stream)?;
        samples.push(sample);
        let over = sample.time_ns > 1_600_000_000 && !sample.moving;
        resting = if over { resting + 1 } else { 0 };
    }
    Ok(samples)
}

#[test]
fn a_board_is_enabled_moved_and_stopped() {
    let board = emulated(&EmulatorOptions::default());
    let stream = WallClock::new();
    // Axes Y and B only: the first and second entry of every array.
    let mut drive = open(&board, &options(&[BoardAxis::Y, BoardAxis::B]));
    assert_eq!(drive.axis_count(), 2);
    assert_eq!(drive.describe(), format!("InterpCNC at {}, address 1", board.path().display()));

    let before = stream.now();
    let sample = drive.probe(&stream).unwrap();
    assert_eq!((sample.position, sample.moving), ([0; 5], false));
    assert!(sample.time_ns > before && sample.time_ns < stream.now());

    fails(&drive.sample(&stream), LOCKED);
    drive.enable().unwrap();
    drive.set_position(&[1000, -500, 0, 0, 0]).unwrap();
    let speeds = [20e3, 10e3, 0.0, 0.0, 0.0];
    drive.move_to(&[4000, -3000, 0, 0, 0], &speeds).unwrap();
    assert!(drive.sample(&stream).unwrap().moving);
    fails(&drive.set_position(&[0; 5]), |error| matches!(error, DriveError::Moving { .. }));
    assert_eq!(rests(&mut drive, &stream).unwrap(), [4000, -3000, 0, 0, 0]);

    drive.move_to(&[1_000_000, -3000, 0, 0, 0], &speeds).unwrap();
    drive.soft_stop().unwrap();
    let sample = drive.sample(&stream).unwrap();
    assert!(!sample.moving && (4001..1_000_000).contains(&sample.position[0]), "{sample:?}");

    drive.move_to(&[1_000_000, 0, 0, 0, 0], &speeds).unwrap();
    drive.hard_stop().unwrap();
    fails(&drive.sample(&stream), LOCKED);
    let end = board.stop().unwrap();
    assert!(end.status().locked() && end.status().moving().is_empty());
    assert_eq!((end.counters()[0], end.counters()[2], end.counters()[3]), (0, 0, 0));
}

#[test]
fn a_plan_is_followed_to_its_end() {
    let clock = wall_clock();
    let segments = Following::Buffered { start_stop_hz: 200, acceleration_khz_per_s: 1000 };
    for following in [Following::Retargeted, segments] {
        let board = emulated(&EmulatorOptions::default());
        let settings = InterpCncOptions { following, ..options(&[BoardAxis::X, BoardAxis::Y]) };
        let mut drive = open(&board, &settings);
        if following == segments {
            // The board has other ramps: the drive says so instead of following badly.
            let other = drive.enable();
            let Err(DriveError::ParameterDiffers { number, expected, found, .. }) = other else {
                panic!("{other:?}")
            };
            assert_eq!((number, expected, found), (4, 1000, 50));
            drive.set_parameter(ParameterId { address: 0, number: 4 }, 1000).unwrap();
        }
        drive.enable().unwrap();
        let stream = to_and_fro(clock, clock() + 100_000_000);
        let samples = follow_to_end(&mut drive, &stream).unwrap();
        // Both axes have really gone there (1.5 periods end at the far end); accuracy is asserted where time is not real.
        for axis in 0..2 {
            let end = stream.at(i64::MAX).position[axis];
            let last = samples.last().unwrap().position[axis];
            assert_eq!(last.to_string(), format!("{end:.0}"), "{following:?}");
            assert!(samples.iter().any(|sample| (1..last).contains(&sample.position[axis])));
        }
        drive.soft_stop().unwrap();
    }
}

#[test]
fn an_open_enable_input_is_an_error_of_its_own() {
    let stream = WallClock::new();
    let board = emulated(&EmulatorOptions::default());
    let mut drive = enabled(&board, &[BoardAxis::X]);
    drive.move_to(&[1_000_000, 0, 0, 0, 0], &[5000.0; 5]).unwrap();
    board.happen(Event::Enable(false)).unwrap();
    let lost = loop {
        if let Err(error) = drive.sample(&stream) {
            break error;
        }
    };
    assert!(ENABLE_OPEN(&lost), "{lost:?}");
    fails(&drive.probe(&stream), ENABLE_OPEN);
    fails(&drive.enable(), ENABLE_OPEN);
    board.happen(Event::Enable(true)).unwrap();
    drive.enable().unwrap();
    assert!(!drive.sample(&stream).unwrap().moving);
}

#[test]
fn a_board_slower_than_the_deadline_is_a_timeout_and_no_wrong_answer() {
    let stream = WallClock::new();
    let wire = Wire { turnaround: Duration::from_millis(150), ..Wire::default() };
    let board = emulated(&EmulatorOptions { wire, ..EmulatorOptions::default() });
    let mut hasty = options(&[BoardAxis::X]);
    hasty.deadline = Duration::from_millis(40);
    hasty.turnaround = Duration::ZERO;
    let mut drive = open(&board, &hasty);
    fails(&drive.probe(&stream), TIMEOUT);
    drop(drive);
    // The late answer is still in the terminal when a patient driver opens it.
    let mut drive = enabled(&board, &[BoardAxis::X]);
    drive.set_position(&[77, 0, 0, 0, 0]).unwrap();
    assert_eq!(drive.sample(&stream).unwrap().position[0], 77);
}

#[test]
fn another_station_and_other_line_settings_work() {
    let stream = WallClock::new();
    let line = Line { baud: 19_200, parity: Parity::Even };
    let emulator = EmulatorOptions {
        board: BoardOptions { address: 42, line, ..BoardOptions::default() },
        wire: Wire { line, ..Wire::default() },
        ..EmulatorOptions::default()
    };
    let board = emulated(&emulator);
    let right = InterpCncOptions { address: 42, line, ..options(&[BoardAxis::X]) };
    open(&board, &right).probe(&stream).unwrap();
    let (deadline, turnaround) = (Duration::from_millis(60), Duration::ZERO);
    let wrong = InterpCncOptions { address: 41, deadline, turnaround, ..right };
    fails(&open(&board, &wrong).probe(&stream), TIMEOUT);
    // At another speed nothing is understood, and nothing is left of it for who speaks as the board does.
    let line = Line { baud: 38_400, ..line };
    let fast = InterpCncOptions { address: 42, line, ..wrong.clone() };
    fails(&open(&board, &fast).probe(&stream), TIMEOUT);
    let right = InterpCncOptions { address: 42, ..wrong };
    open(&board, &right).probe(&stream).unwrap();
    // Unless the wire lets all speeds pass.
    let emulator = EmulatorOptions { any_speed: true, ..emulator };
    let board = emulated(&emulator);
    open(&board, &fast).probe(&stream).unwrap();
}

#[test]
fn a_port_that_is_not_there_is_named() {
    let missing = InterpCncDrive::open("/dev/no-such-port", &options(&[BoardAxis::X]));
    let Err(error @ DriveError::Transport { .. }) = missing else { panic!("{missing:?}") };
    let said = error.to_string();
    assert!(said.starts_with("/dev/no-such-port, address 1: opening the port: "), "{said}");
}

#[test]
fn noise_and_unknown_functions_leave_the_board_answering() {
    let board = emulated(&EmulatorOptions::default());
    let port = serialport::new(board.path().to_str().unwrap(), 115_200);
    let mut port = TTYPort::open(&port.timeout(Duration::from_secs(5))).unwrap();
    // Silence ends noise and frames of unknown length; without it the next frame would belong to the noise.
    let silence = || std::thread::sleep(Duration::from_millis(100));
    let expect = |port: &mut TTYPort, answer: &[u8]| {
        let mut received = vec![0; answer.len()];
        port.read_exact(&mut received).unwrap();
        assert_eq!(received, answer);
    };
    port.write_all(&[0x55; 30]).unwrap();
    silence();
    port.write_all(&seal(bytes("01 17 10 00 00 01 10 00 00 01 02 00 00"))).unwrap();
    expect(&mut port, &vector(30));
    // A foreign frame is not answered; two frames at once are answered one after the other.
    port.write_all(&seal(bytes("02 04 04 00 00 0C"))).unwrap();
    silence();
    port.write_all(&[vector(1), vector(26)].concat()).unwrap();
    expect(&mut port, &[vector(2), seal(bytes("01 01 01 00"))].concat());
    drop(port);
    assert_eq!(board.stop().unwrap().frames_handled(), 3);
}

#[test]
fn the_eeprom_survives_a_restart_in_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("board.eeprom");
    let emulator = EmulatorOptions { eeprom: Some(file.clone()), ..EmulatorOptions::default() };
    let patience = Duration::from_secs(20);
    for round in 0..2_u32 {
        let board = emulated(&emulator);
        let mut drive = open(&board, &options(&[BoardAxis::X]));
        let (driver, runtime) = drive.board();
        runtime.block_on(async {
            let before = driver.parameter(4, &|| 0).await.unwrap();
            assert_eq!(before, if round == 0 { 50 } else { 1234 });
            driver.set_parameter(4, 1234, patience, &|| 0).await.unwrap();
        });
        // It is in the file when B14 is clear, whatever becomes of the emulator; the file is replaced as a whole.
        while round == 0 && !file.exists() {
            std::thread::yield_now();
        }
        drop(drive);
        board.stop().unwrap();
    }
    std::fs::write(&file, b"something else").unwrap();
    let refused = EmulatedBoard::start(&emulator, wall_clock());
    assert!(matches!(refused, Err(twin_drives::EmulatorError::File { .. })), "{refused:?}");
}

/// Parameter 101 counts from the next start on (an assumption, `line_at_restart`): until then the old speed holds, then the new one
/// alone, whether the board has lost its supply or all of it was started anew.
#[test]
fn a_speed_that_is_stored_holds_from_the_next_start_on() {
    let stream = WallClock::new();
    let folder = tempfile::tempdir().unwrap();
    let eeprom = Some(folder.path().join("board.eeprom"));
    let emulator = EmulatorOptions { eeprom, ..EmulatorOptions::default() };
    let first = emulated(&emulator);
    let at = |baud| {
        let line = Line { baud, ..Line::default() };
        InterpCncOptions { line, ..options(&[BoardAxis::X]) }
    };
    let hears = |board: &EmulatedBoard, baud| open(board, &at(baud)).probe(&stream).is_ok();
    let deaf = |board: &EmulatedBoard, baud| {
        let hasty = InterpCncOptions {
            deadline: Duration::from_millis(60),
            turnaround: Duration::ZERO,
            ..at(baud)
        };
        open(board, &hasty).probe(&stream).is_err_and(|error| TIMEOUT(&error))
    };
    let store = |board: &EmulatedBoard, old: u32, new: u32| {
        let mut drive = open(board, &at(old));
        let (driver, runtime) = drive.board();
        let written =
            driver.set_parameter(parameters::MODBUS_SPEED, new, Duration::from_secs(20), &|| 0);
        runtime.block_on(written).unwrap();
    };
    store(&first, 115_200, 19_200);
    assert!(deaf(&first, 19_200) && hears(&first, 115_200), "before it starts anew");
    first.control(Control::Event(Event::BrownOut { off_ns: 0 })).unwrap();
    assert!(deaf(&first, 115_200) && hears(&first, 19_200), "after a power failure");
    assert_eq!(first.look().unwrap().line(), Line { baud: 19_200, parity: Parity::None });
    first.stop().unwrap();
    // Of the options of the second only the EEPROM counts.
    let second = emulated(&emulator);
    assert!(deaf(&second, 115_200) && hears(&second, 19_200), "powered up with its EEPROM");
    store(&second, 19_200, 57_600);
    assert!(deaf(&second, 57_600) && hears(&second, 19_200), "before it starts anew");
    second.control(Control::Event(Event::BrownOut { off_ns: 0 })).unwrap();
    assert!(deaf(&second, 19_200) && hears(&second, 57_600), "after another power failure");
}

#[test]
fn a_bench_presses_switches_and_faults_come_on_demand() {
    let stream = WallClock::new();
    let bench = Bench { cams: vec![switch(5, BoardAxis::X, 500, 900)], encoder: None };
    let board = emulated(&EmulatorOptions { bench, ..EmulatorOptions::default() });
    let mut drive = enabled(&board, &[BoardAxis::X]);
    drive.move_to(&[700, 0, 0, 0, 0], &[5000.0; 5]).unwrap();
    assert_eq!(rests(&mut drive, &stream).unwrap()[0], 700);
    let (driver, runtime) = drive.board();
    assert_eq!(runtime.block_on(driver.snapshot(&|| 0)).unwrap().inputs, 1 << 4);
    // A garbled answer: asked again, and nothing is to be seen of it.
    let (direction, when, fault) = (Direction::Answer, When::Next(1), WireFault::WrongCheck);
    board.control(Control::Fault(FaultRule { direction, when, fault })).unwrap();
    assert_eq!(drive.sample(&stream).unwrap().position[0], 700);
    board.control(Control::Event(Event::BrownOut { off_ns: 0 })).unwrap();
    fails(&drive.sample(&stream), LOCKED);
    let end = board.stop().unwrap();
    assert_eq!((end.counters()[0], end.inputs()), (0, 1 << 4));
}
