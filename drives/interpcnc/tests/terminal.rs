//! The driver against the emulator, on a pseudo-terminal and in real time.

use std::{
    f64::consts::TAU,
    io::{Read, Write},
    time::Duration,
};

use serialport::TTYPort;

use crate::protocol::frame::seal;
use crate::tests::common::wall_clock;
use crate::{
    AxisOptions, BoardAxis, InterpCncDrive, InterpCncOptions, Line, Parity,
    emulator::{Bench, BoardOptions, Cam, Control, EmulatedBoard, EmulatorOptions, Event, Wire},
    protocol::{
        parameters,
        vectors::{bytes, vector},
    },
};
use twin_drives::{
    Direction, Drive, DriveError, FaultRule, IncrementMotion, MAX_DRIVE_AXES, SetpointStream, When,
    WireFault,
};

/// A plan of two axes: to and fro, at rest before and after.
pub(super) struct Plan<C> {
    pub(super) clock: C,
    pub(super) start_ns: i64,
}

/// Stroke of the first axis, increments; the second makes half of it.
const STROKE: f64 = 8000.0;
const PERIOD_S: f64 = 1.0;

#[expect(clippy::cast_precision_loss, reason = "seconds")]
impl<C: Fn() -> i64 + Sync> SetpointStream for Plan<C> {
    fn now_ns(&self) -> i64 {
        (self.clock)() - self.start_ns
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        let time = (time_ns as f64 * 1e-9).clamp(0.0, 1.5 * PERIOD_S);
        let mut motion = IncrementMotion::default();
        for axis in 0..2 {
            let (half, angle) = (STROKE / [2.0, 4.0][axis], TAU / PERIOD_S);
            motion.position[axis] = half * (1.0 - (angle * time).cos());
            motion.velocity[axis] = half * angle * (angle * time).sin();
        }
        motion
    }

    fn horizon_ns(&self) -> i64 {
        250_000_000
    }
}

pub(super) fn options(axes: &[BoardAxis]) -> InterpCncOptions {
    let axis = |axis: &BoardAxis| AxisOptions {
        acceleration_khz_per_s: 1000,
        deceleration_khz_per_s: 1000,
        max_speed_hz: 100_000,
        ..AxisOptions::new(*axis)
    };
    let mut options = InterpCncOptions::new(axes.iter().map(axis).collect());
    // Other tests and builds may keep the emulator waiting.
    options.deadline = Duration::from_secs(2);
    options
}

pub(super) fn open(board: &EmulatedBoard, options: &InterpCncOptions) -> InterpCncDrive {
    InterpCncDrive::open(board.path().to_str().unwrap(), options).unwrap()
}

fn wait_until_rest(
    drive: &mut InterpCncDrive,
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
fn a_board_is_enabled_moved_and_stopped() {
    let clock = wall_clock();
    let board = EmulatedBoard::start(&EmulatorOptions::default(), clock).unwrap();
    let stream = Plan { clock, start_ns: 0 };
    // Axes Y and B only: the first and second entry of every array.
    let mut drive = open(&board, &options(&[BoardAxis::Y, BoardAxis::B]));
    assert_eq!(drive.axis_count(), 2);
    assert_eq!(drive.describe(), format!("InterpCNC at {}, address 1", board.path().display()));

    let before = clock();
    let sample = drive.probe(&stream).unwrap();
    assert_eq!((sample.position, sample.moving), ([0; 5], false));
    assert!(sample.time_ns > before && sample.time_ns < clock());

    let locked = drive.sample(&stream);
    assert!(matches!(locked, Err(DriveError::Locked { .. })), "{locked:?}");
    drive.enable().unwrap();
    drive.set_position(&[1000, -500, 0, 0, 0]).unwrap();
    drive.move_to(&[4000, -3000, 0, 0, 0], &[20e3, 10e3, 0.0, 0.0, 0.0]).unwrap();
    assert!(drive.sample(&stream).unwrap().moving);
    let moving = drive.set_position(&[0; 5]);
    assert!(matches!(moving, Err(DriveError::Moving { .. })), "{moving:?}");
    assert_eq!(wait_until_rest(&mut drive, &stream), [4000, -3000, 0, 0, 0]);

    drive.move_to(&[1_000_000, -3000, 0, 0, 0], &[20e3, 10e3, 0.0, 0.0, 0.0]).unwrap();
    drive.soft_stop().unwrap();
    let sample = drive.sample(&stream).unwrap();
    assert!(
        !sample.moving && sample.position[0] > 4000 && sample.position[0] < 1_000_000,
        "{sample:?}"
    );

    drive.move_to(&[1_000_000, 0, 0, 0, 0], &[20e3, 10e3, 0.0, 0.0, 0.0]).unwrap();
    drive.hard_stop().unwrap();
    assert!(matches!(drive.sample(&stream), Err(DriveError::Locked { .. })));
    let end = board.stop().unwrap();
    assert!(end.status().locked() && end.status().moving().is_empty());
    assert_eq!((end.counters()[0], end.counters()[2], end.counters()[3]), (0, 0, 0));
}

#[test]
fn a_plan_is_followed_to_its_end() {
    let clock = wall_clock();
    let board = EmulatedBoard::start(&EmulatorOptions::default(), clock).unwrap();
    let mut drive = open(&board, &options(&[BoardAxis::X, BoardAxis::Y]));
    drive.enable().unwrap();
    let stream = Plan { clock, start_ns: clock() + 100_000_000 };
    let mut samples = Vec::new();
    // On a busy machine the last commands come after the end of the plan: a few cycles at rest show that none is left.
    let mut resting = 0;
    while resting < 20 {
        let sample = drive.follow(&stream).unwrap();
        samples.push(sample);
        let over = sample.time_ns > 1_600_000_000 && !sample.moving;
        resting = if over { resting + 1 } else { 0 };
    }
    for axis in 0..2 {
        #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
        let errors = samples
            .iter()
            .map(|sample| sample.position[axis] as f64 - stream.at(sample.time_ns).position[axis]);
        let (mut squares, mut largest) = (0.0, 0.0_f64);
        errors.for_each(|error| {
            squares += error * error;
            largest = largest.max(error.abs());
        });
        let count = f64::from(u32::try_from(samples.len()).unwrap());
        let (rms, fastest) = ((squares / count).sqrt(), STROKE / [2.0, 4.0][axis] * TAU / PERIOD_S);
        println!(
            "axis {axis}: {count} samples, {fastest:.0} Hz at most; error rms {rms:.1}, max {largest:.1} increments \
             = {:.2}, {:.2} ms",
            1e3 * rms / fastest,
            1e3 * largest / fastest
        );
        // Both axes have really gone there (1.5 periods end at the far end); accuracy is asserted where time is not real.
        let end = stream.at(i64::MAX).position[axis];
        let last = samples.last().unwrap().position[axis];
        assert_eq!(last.to_string(), format!("{end:.0}"));
        assert!(
            samples.iter().any(|sample| sample.position[axis] > 0 && sample.position[axis] < last)
        );
    }
}

#[test]
fn an_open_enable_input_is_an_error_of_its_own() {
    let clock = wall_clock();
    let stream = Plan { clock, start_ns: 0 };
    let board = EmulatedBoard::start(&EmulatorOptions::default(), clock).unwrap();
    let mut drive = open(&board, &options(&[BoardAxis::X]));
    drive.enable().unwrap();
    drive.move_to(&[1_000_000, 0, 0, 0, 0], &[5000.0; 5]).unwrap();
    board.happen(Event::Enable(false)).unwrap();
    let lost = loop {
        match drive.sample(&stream) {
            Ok(_) => {}
            Err(error) => break error,
        }
    };
    assert!(matches!(lost, DriveError::EnableOpen { .. }), "{lost:?}");
    assert!(matches!(drive.probe(&stream), Err(DriveError::EnableOpen { .. })));
    assert!(matches!(drive.enable(), Err(DriveError::EnableOpen { .. })));
    board.happen(Event::Enable(true)).unwrap();
    drive.enable().unwrap();
    assert!(!drive.sample(&stream).unwrap().moving);
}

#[test]
fn a_board_slower_than_the_deadline_is_a_timeout_and_no_wrong_answer() {
    let clock = wall_clock();
    let stream = Plan { clock, start_ns: 0 };
    let wire = Wire { turnaround: Duration::from_millis(150), ..Wire::default() };
    let board =
        EmulatedBoard::start(&EmulatorOptions { wire, ..EmulatorOptions::default() }, clock)
            .unwrap();
    let mut hasty = options(&[BoardAxis::X]);
    hasty.deadline = Duration::from_millis(40);
    hasty.worst_latency = Duration::from_millis(300);
    let mut drive = open(&board, &hasty);
    let late = drive.probe(&stream);
    assert!(matches!(late, Err(DriveError::Timeout { .. })), "{late:?}");
    drop(drive);
    // The late answer is still in the terminal when a patient driver opens it.
    let mut drive = open(&board, &options(&[BoardAxis::X]));
    drive.enable().unwrap();
    drive.set_position(&[77, 0, 0, 0, 0]).unwrap();
    assert_eq!(drive.sample(&stream).unwrap().position[0], 77);
}

#[test]
fn another_station_and_other_line_settings_work() {
    let clock = wall_clock();
    let stream = Plan { clock, start_ns: 0 };
    let line = Line { baud: 19_200, parity: Parity::Even };
    let emulator = EmulatorOptions {
        board: BoardOptions { address: 42, line, ..BoardOptions::default() },
        wire: Wire { line, ..Wire::default() },
        ..EmulatorOptions::default()
    };
    let board = EmulatedBoard::start(&emulator, clock).unwrap();
    let right = InterpCncOptions { address: 42, line, ..options(&[BoardAxis::X]) };
    open(&board, &right).probe(&stream).unwrap();
    let wrong = InterpCncOptions { address: 41, deadline: Duration::from_millis(60), ..right };
    let wrong = InterpCncOptions { worst_latency: Duration::from_millis(10), ..wrong };
    let nobody = open(&board, &wrong).probe(&stream);
    assert!(matches!(nobody, Err(DriveError::Timeout { .. })), "{nobody:?}");
    // At another speed nothing is understood, and nothing is left of it for who speaks as the board does.
    let line = Line { baud: 38_400, ..line };
    let fast = InterpCncOptions { address: 42, line, ..wrong.clone() };
    let nobody = open(&board, &fast).probe(&stream);
    assert!(matches!(nobody, Err(DriveError::Timeout { .. })), "{nobody:?}");
    let right = InterpCncOptions { address: 42, ..wrong };
    open(&board, &right).probe(&stream).unwrap();
    // Unless the wire lets all speeds pass.
    let emulator = EmulatorOptions { any_speed: true, ..emulator };
    let board = EmulatedBoard::start(&emulator, clock).unwrap();
    open(&board, &fast).probe(&stream).unwrap();
}

#[test]
fn a_port_that_is_not_there_is_named() {
    let missing = InterpCncDrive::open("/dev/no-such-port", &options(&[BoardAxis::X]));
    let Err(error @ DriveError::Transport { .. }) = missing else { panic!("{missing:?}") };
    assert!(
        error.to_string().starts_with("/dev/no-such-port, address 1: opening the port: "),
        "{error}"
    );
}

#[test]
fn noise_and_unknown_functions_leave_the_board_answering() {
    let board = EmulatedBoard::start(&EmulatorOptions::default(), wall_clock()).unwrap();
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
    let clock = wall_clock();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("board.eeprom");
    let emulator = EmulatorOptions { eeprom: Some(file.clone()), ..EmulatorOptions::default() };
    let patience = Duration::from_secs(20);
    for round in 0..2_u32 {
        let board = EmulatedBoard::start(&emulator, clock).unwrap();
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
    let refused = EmulatedBoard::start(&emulator, clock);
    assert!(matches!(refused, Err(twin_drives::EmulatorError::File { .. })), "{refused:?}");
}

/// Parameter 101 counts from the next start on (an assumption, `line_at_restart`): until then the old speed holds, then the new one
/// alone, whether the board has lost its supply or all of it was started anew.
#[test]
fn a_speed_that_is_stored_holds_from_the_next_start_on() {
    let clock = wall_clock();
    let stream = Plan { clock, start_ns: 0 };
    let folder = tempfile::tempdir().unwrap();
    let eeprom = Some(folder.path().join("board.eeprom"));
    let emulator = EmulatorOptions { eeprom, ..EmulatorOptions::default() };
    let first = EmulatedBoard::start(&emulator, clock).unwrap();
    let at = |baud| {
        let line = Line { baud, ..Line::default() };
        InterpCncOptions { line, ..options(&[BoardAxis::X]) }
    };
    let hears = |board: &EmulatedBoard, baud| open(board, &at(baud)).probe(&stream).is_ok();
    let deaf = |board: &EmulatedBoard, baud| {
        let hasty = InterpCncOptions {
            deadline: Duration::from_millis(60),
            worst_latency: Duration::from_millis(10),
            ..at(baud)
        };
        matches!(open(board, &hasty).probe(&stream), Err(DriveError::Timeout { .. }))
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
    let second = EmulatedBoard::start(&emulator, clock).unwrap();
    assert!(deaf(&second, 115_200) && hears(&second, 19_200), "powered up with its EEPROM");
    store(&second, 19_200, 57_600);
    assert!(deaf(&second, 57_600) && hears(&second, 19_200), "before it starts anew");
    second.control(Control::Event(Event::BrownOut { off_ns: 0 })).unwrap();
    assert!(deaf(&second, 19_200) && hears(&second, 57_600), "after another power failure");
}

#[test]
fn a_bench_presses_switches_and_faults_come_on_demand() {
    let clock = wall_clock();
    let stream = Plan { clock, start_ns: 0 };
    let cam = Cam { input: 5, axis: BoardAxis::X, from: 500, to: 900, normally_closed: false };
    let bench = Bench { cams: vec![cam], encoder: None };
    let emulator = EmulatorOptions { bench, ..EmulatorOptions::default() };
    let board = EmulatedBoard::start(&emulator, clock).unwrap();
    let mut drive = open(&board, &options(&[BoardAxis::X]));
    drive.enable().unwrap();
    drive.move_to(&[700, 0, 0, 0, 0], &[5000.0; 5]).unwrap();
    assert_eq!(wait_until_rest(&mut drive, &stream)[0], 700);
    let (driver, runtime) = drive.board();
    assert_eq!(runtime.block_on(driver.snapshot(&|| 0)).unwrap().inputs, 1 << 4);
    // A garbled answer: asked again, and nothing is to be seen of it.
    let rule = FaultRule {
        direction: Direction::Answer,
        when: When::Next(1),
        fault: WireFault::WrongCheck,
    };
    board.control(Control::Fault(rule)).unwrap();
    assert_eq!(drive.sample(&stream).unwrap().position[0], 700);
    board.control(Control::Event(Event::BrownOut { off_ns: 0 })).unwrap();
    assert!(matches!(drive.sample(&stream), Err(DriveError::Locked { .. })));
    let end = board.stop().unwrap();
    assert_eq!((end.counters()[0], end.inputs()), (0, 1 << 4));
}
