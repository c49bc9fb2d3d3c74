//! The encoder against the counter, on a pseudo-terminal: 4 points for 3 steps of X.

use super::{
    common::{WallClock, wall_clock},
    emulated, switch,
    terminal::{follow_to_end, open, options, rests, to_and_fro},
};
use crate::{
    BoardAxis, EncoderOptions, Following, InterpCncDrive, InterpCncOptions,
    emulator::{Bench, BoardOptions, Control, EmulatedBoard, EmulatorOptions, EncoderLink, Event},
};
use twin_drives::{
    Axes, Direction, Drive, DriveError, FaultRule, ParameterId, SetpointStream, When, WireFault,
};

const LINK: EncoderLink =
    EncoderLink { axis: BoardAxis::X, counts: 4, steps: 3, counts_per_revolution: 0 };
const FAST: [f64; 5] = [100_000.0; 5];

/// X and Y, and an encoder on X that is allowed nothing but a step and a point.
fn strict() -> InterpCncOptions {
    let (axis, points, increments, tolerance) = (BoardAxis::X, 4, 3, 0);
    let encoder = Some(EncoderOptions { axis, points, increments, tolerance });
    InterpCncOptions { encoder, ..options(&[BoardAxis::X, BoardAxis::Y]) }
}

/// A board with that encoder, and a home switch of X at −500.
fn started(link: EncoderLink) -> EmulatedBoard {
    let cams = vec![switch(1, BoardAxis::X, i32::MIN, -500)];
    let bench = Bench { cams, encoder: Some(link) };
    emulated(&EmulatorOptions { bench, ..EmulatorOptions::default() })
}

fn enabled(board: &EmulatedBoard, options: &InterpCncOptions) -> InterpCncDrive {
    let mut drive = open(board, options);
    drive.probe(&WallClock::new()).unwrap();
    drive.enable().unwrap();
    drive
}

/// Homing of X: input 1, speed, acceleration, start and stop frequency, speed off the switch, and the counter to 0.
const HOMING: [(u16, i64); 6] = [(29, 1), (12, 5000), (13, 500), (14, 400), (15, 500), (128, 1)];

fn set_parameters(drive: &mut InterpCncDrive, values: &[(u16, i64)]) {
    for (number, value) in values.iter().copied() {
        drive.set_parameter(ParameterId { address: 0, number }, value).unwrap();
    }
}

fn stall(board: &EmulatedBoard, on: bool) {
    board.control(Control::Event(Event::Stall(BoardAxis::X, on))).unwrap();
}

/// What the counter shows, and the encoder in steps.
fn differs(told: &DriveError) -> (i64, i64) {
    match told {
        DriveError::EncoderDiffers {
            axis: Axes::Letters(1),
            counter,
            encoder,
            unit: "steps",
            points: Some(_),
            ..
        } => (*counter, *encoder),
        other => panic!("{other:?}"),
    }
}

/// Full speed, both ways, turns in flight, plans by both ways of following, homing and another zero; then with answers that come
/// late.
#[test]
fn a_shaft_that_follows_is_never_doubted() {
    let clock = wall_clock();
    let down = EncoderLink { counts: -4, ..LINK };
    for (link, late) in [(LINK, false), (down, true)] {
        let board = started(link);
        let mut options = strict();
        options.encoder.iter_mut().for_each(|encoder| encoder.points = link.counts);
        let mut drive = enabled(&board, &options);
        if late {
            let fault = WireFault::Delay { ns: 20_000_000 };
            let rule = FaultRule { direction: Direction::Answer, when: When::Every(3), fault };
            board.control(Control::Fault(rule)).unwrap();
        }
        let mut stream = to_and_fro(clock, i64::MAX / 2);
        for target in [60_000, -300, 7] {
            drive.move_to(&[target, -target, 0, 0, 0], &FAST).unwrap();
            assert_eq!(rests(&mut drive, &stream).unwrap()[0], target);
        }
        // It turns round on its way.
        drive.move_to(&[60_000, 0, 0, 0, 0], &FAST).unwrap();
        while drive.sample(&stream).unwrap().position[0] < 10_000 {}
        drive.move_to(&[0; 5], &FAST).unwrap();
        rests(&mut drive, &stream).unwrap();

        set_parameters(&mut drive, &HOMING);
        drive.begin_homing(&[Some(20_000), None, None, None, None]).unwrap();
        assert_eq!(rests(&mut drive, &stream).unwrap()[0], 0);
        assert_eq!(drive.homed().unwrap()[0], Some(true));
        let begins = drive.sample(&stream).unwrap();
        drive.set_position(&[0; 5]).unwrap();
        assert_eq!(begins.position[0], 0);
        stream.start_ns = clock() + 100_000_000;
        follow_to_end(&mut drive, &stream).unwrap();
        drive.move_to(&[100_000, 0, 0, 0, 0], &FAST).unwrap();
        drive.sample(&stream).unwrap();
        drive.soft_stop().unwrap();
        rests(&mut drive, &stream).unwrap();
        board.stop().unwrap();
    }
}

#[test]
fn a_shaft_that_follows_segments_is_never_doubted() {
    let clock = wall_clock();
    let board = started(LINK);
    let following = Following::Buffered { start_stop_hz: 2000, acceleration_khz_per_s: 1000 };
    let mut options = InterpCncOptions { following, ..strict() };
    // The ramps of segments are the board's (parameters 4 and 5).
    options.axes.iter_mut().for_each(|axis| axis.start_stop_hz = 2000);
    let mut drive = open(&board, &options);
    set_parameters(&mut drive, &[(4, 1000), (5, 2000)]);
    drive.enable().unwrap();
    let stream = to_and_fro(clock, clock() + 100_000_000);
    follow_to_end(&mut drive, &stream).unwrap();
    stall(&board, true);
    let stream = to_and_fro(clock, clock() + 100_000_000);
    differs(&follow_to_end(&mut drive, &stream).unwrap_err());
    drive.soft_stop().unwrap();
    board.stop().unwrap();
}

#[test]
fn a_held_shaft_is_told_on_its_way_and_where_it_is_stopped() {
    let clock = wall_clock();
    let board = started(LINK);
    let mut options = strict();
    options.encoder.iter_mut().for_each(|encoder| encoder.tolerance = 30);
    let mut drive = enabled(&board, &options);
    let mut stream = to_and_fro(clock, i64::MAX / 2);
    drive.sample(&stream).unwrap();
    stall(&board, true);
    drive.move_to(&[400, 400, 0, 0, 0], &FAST).unwrap();
    let told = rests(&mut drive, &stream).unwrap_err();
    let (counter, encoder) = differs(&told);
    assert!(encoder == 0 && (32..=400).contains(&counter), "{told}");
    let said = told.to_string();
    let name = board.path().display().to_string();
    for part in [&name, "address 1", "axis X", "steps by its encoder", "(0 points)", "30 steps"] {
        assert!(said.contains(part), "{said}");
    }
    // What has been told is not told again: the axis can be stopped.
    drive.soft_stop().unwrap();
    stall(&board, false);
    drive.move_to(&[0; 5], &FAST).unwrap();
    rests(&mut drive, &stream).unwrap();

    // One that is stopped right away, (50000² − 200²)/2000000 are 1250 steps of ramp.
    drive.move_to(&[500_000, 0, 0, 0, 0], &[50_000.0; 5]).unwrap();
    while board.look().unwrap().velocity(BoardAxis::X) < 49_000.0 {}
    stall(&board, true);
    let told = drive.soft_stop().unwrap_err();
    differs(&told);
    assert!(board.look().unwrap().velocity(BoardAxis::X).abs() < 1e-9, "it stands");
    stall(&board, false);

    // Following a plan, whatever the other axis does.
    drive.set_position(&[0; 5]).unwrap();
    stream.start_ns = clock() + 100_000_000;
    let mut held = false;
    let told = loop {
        match drive.follow(&stream) {
            Ok(_) if stream.now_ns() > 400_000_000 && !held => {
                held = true;
                stall(&board, true);
            }
            Ok(_) => {}
            Err(error) => break error,
        }
        assert!(stream.now_ns() < 10_000_000_000, "nothing is said");
    };
    assert!(held);
    differs(&told);
    drive.soft_stop().unwrap();
    board.stop().unwrap();
}

/// The switch is farther away than it takes to see that the shaft does not turn.
#[test]
fn a_held_shaft_is_told_while_it_homes_and_is_not_home() {
    let clock = wall_clock();
    let board = started(LINK);
    let mut options = strict();
    options.axes.iter_mut().for_each(|axis| axis.max_speed_hz = 5000);
    let mut drive = enabled(&board, &options);
    let stream = to_and_fro(clock, i64::MAX / 2);
    set_parameters(&mut drive, &HOMING);
    stall(&board, true);
    drive.begin_homing(&[Some(200_000), None, None, None, None]).unwrap();
    let told = rests(&mut drive, &stream).unwrap_err();
    let (counter, encoder) = differs(&told);
    assert!(encoder == 0 && counter < 0, "{told}");
    drive.soft_stop().unwrap();
    assert_eq!(drive.homed().unwrap()[0], Some(false));
    board.stop().unwrap();
}

#[test]
fn an_encoder_that_counts_the_wrong_way_or_is_broken_is_told() {
    let clock = wall_clock();
    let stream = to_and_fro(clock, i64::MAX / 2);
    let board = started(EncoderLink { counts: -4, ..LINK });
    let mut drive = enabled(&board, &strict());
    drive.move_to(&[3000, 0, 0, 0, 0], &FAST).unwrap();
    let (counter, encoder) = differs(&rests(&mut drive, &stream).unwrap_err());
    assert!(counter > 0 && encoder < 0, "{counter} {encoder}");
    drive.soft_stop().unwrap();

    // Its plug comes off: it counts no more.
    let board = started(LINK);
    let mut drive = enabled(&board, &strict());
    drive.move_to(&[3000, 0, 0, 0, 0], &FAST).unwrap();
    rests(&mut drive, &stream).unwrap();
    let bench = Bench { encoder: None, ..board.look().unwrap().bench().clone() };
    board.control(Control::Event(Event::Bench(bench))).unwrap();
    differs(&drive.sample(&stream).unwrap_err());
}

/// "Lecture position codeur (à partir de V2.1D)": an older board has no such registers.
#[test]
fn an_older_board_is_refused_with_an_encoder_alone() {
    let board = BoardOptions { counts: false, ..BoardOptions::default() };
    let options = EmulatorOptions { board, ..EmulatorOptions::default() };
    let (board, stream) = (emulated(&options), WallClock::new());
    let told = open(&board, &strict()).probe(&stream).unwrap_err();
    let said = told.to_string();
    assert!(matches!(told, DriveError::Unsupported { .. }), "{said}");
    assert!(said.contains("no encoder: boards have one from V2.1D on"), "{said}");
    let without = InterpCncOptions { encoder: None, ..strict() };
    open(&board, &without).probe(&stream).unwrap();
}
