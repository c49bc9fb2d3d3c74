//! The driver against the emulated board, in simulated time: what each call makes the board do, and what it says of
//! what the board has done.

use std::{future::Future, sync::Arc, time::Duration};

use tokio::{
    io::duplex,
    sync::mpsc,
    time::{Instant, sleep},
};

use super::{
    EEPROM_FAILED, LOCKED, RANGE, UNFINISHED, assuming, fails, go, profile, segment_of_x, switch,
    x_only,
};
use crate::{
    Assumptions, AxisMask, AxisOptions, BoardAxis, InterpCnc, InterpCncOptions, Line,
    emulator::{Bench, Board, BoardOptions, Condition, Control, EncoderLink, Event, Wire, serve},
    protocol::{parameters, registers::Status},
};
pub(super) use twin_drives::no_clock;
use twin_drives::{Axes, DriveError};

/// Longer than anything here takes.
pub(super) const LONG: Duration = Duration::from_mins(1);

/// The board's end of a rig.
pub(super) type Hand = mpsc::Sender<Control>;

pub(super) async fn happen(hand: &Hand, event: Event) {
    hand.send(Control::Event(event)).await.unwrap();
}

/// A board, its bench, and a driver of all its axes.
pub(super) struct Rig {
    board: BoardOptions,
    bench: Bench,
    pub(super) settings: InterpCncOptions,
}

impl Rig {
    /// A driver that knows its board, and nothing around them.
    pub(super) fn new(board: BoardOptions) -> Self {
        let axes = BoardAxis::ALL.into_iter().map(AxisOptions::new).collect();
        let mut settings = InterpCncOptions::new(axes);
        (settings.address, settings.line) = (board.address, board.line);
        settings.assumptions = board.assumptions;
        Self { board, bench: Bench::default(), settings }
    }

    /// Runs a test on the driver and the board, which is served at the other end of its wire, all in simulated time; the
    /// outcome, and the board as it was at the end.
    pub(super) fn run<T, F: Future<Output = T>>(
        self,
        test: impl FnOnce(InterpCnc, Hand) -> F,
    ) -> (T, Board) {
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_time().start_paused(true).build();
        runtime.unwrap().block_on(async {
            let (near, far) = duplex(4096);
            let driver = InterpCnc::attach(Arc::from("wire"), near, &self.settings);
            let mut board = Board::new(&self.board);
            board.set_bench(self.bench);
            let (hand, control) = mpsc::channel(64);
            let wire = Wire { line: self.settings.line, ..Wire::default() };
            let served = tokio::spawn(async move {
                let zero = Instant::now();
                let clock = move || i64::try_from(zero.elapsed().as_nanos()).unwrap();
                serve(far, board, &wire, &clock, control).await
            });
            let outcome = test(driver, hand.clone()).await;
            drop(hand);
            (outcome, served.await.unwrap().unwrap())
        })
    }
}

/// The usual board, without anything around it.
pub(super) fn usual() -> Rig {
    Rig::new(BoardOptions::default())
}

#[test]
fn a_move_is_over_when_the_axis_stands_on_its_target() {
    let ((), board) = usual().run(|mut driver, _hand| async move {
        // Locked, the board accepts the move and does nothing: that is said.
        fails(&driver.move_axis(BoardAxis::Y, &profile(5000), LONG, &no_clock).await, LOCKED);
        driver.unlock(&no_clock).await.unwrap();
        driver.move_axis(BoardAxis::Y, &profile(5000), LONG, &no_clock).await.unwrap();
        assert_eq!(driver.state(&no_clock).await.unwrap().0.positions, [0, 5000, 0, 0, 0]);
        // Too little time: said, and the axis goes on.
        let short = Duration::from_millis(50);
        fails(&driver.move_axis(BoardAxis::Y, &profile(0), short, &no_clock).await, UNFINISHED);
        driver.wait_for_rest(AxisMask::ALL, LONG, &no_clock).await.unwrap();
    });
    assert_eq!(board.counters(), [0; 5]);
}

#[test]
fn the_instant_of_reversal_is_not_taken_for_the_end() {
    // The board shows no motion for 20 ms when the move reverses, which is more than an exchange.
    let assumptions = Assumptions { reversal_gap_ns: 20_000_000, ..Assumptions::default() };
    Rig::new(assuming(assumptions)).run(|mut driver, _hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        driver.send(&go(BoardAxis::X, 1_000_000), &no_clock).await.unwrap();
        sleep(Duration::from_secs(1)).await;
        driver.move_axis(BoardAxis::X, &profile(-500), LONG, &no_clock).await.unwrap();
        assert_eq!(driver.state(&no_clock).await.unwrap().0.positions[0], -500);
    });
}

#[test]
fn an_axis_that_something_else_stops_has_not_arrived() {
    let bench = Bench { cams: vec![switch(8, BoardAxis::X, 3000, 9000)], encoder: None };
    usual().run(|mut driver, hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        driver.set_parameter(106, 8, LONG, &no_clock).await.unwrap();
        happen(&hand, Event::Bench(bench)).await;
        fails(&driver.move_axis(BoardAxis::X, &profile(8000), LONG, &no_clock).await, |error| {
            matches!(error, DriveError::LimitSwitch { axes: Axes::Letters(1), .. })
        });
        // A ramp stop that another master has sent: the axis is elsewhere.
        let elsewhere = go(BoardAxis::Z, 100_000);
        driver.send(&elsewhere, &no_clock).await.unwrap();
        sleep(Duration::from_millis(500)).await;
        driver.ramp_stop(LONG, &no_clock).await.unwrap();
        let targets = [None, None, Some(100_000), None, None];
        fails(&driver.wait_for_targets(&elsewhere, &targets, LONG, &no_clock).await, |error| {
            matches!(error, DriveError::NotArrived { axis: Axes::Letters(4), target: 100_000, .. })
        });
    });
}

#[test]
fn stops_are_waited_for() {
    let ((), board) = usual().run(|mut driver, _hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        for axis in [BoardAxis::X, BoardAxis::Y] {
            driver.send(&go(axis, 1_000_000), &no_clock).await.unwrap();
        }
        sleep(Duration::from_secs(1)).await;
        let state = driver.ramp_stop(LONG, &no_clock).await.unwrap();
        assert!(state.status.moving().is_empty() && !state.status.locked());
        driver.send(&go(BoardAxis::X, 0), &no_clock).await.unwrap();
        assert!(driver.stop_and_lock(&no_clock).await.unwrap().status.locked());
    });
    assert!(board.status().locked());
}

#[test]
fn a_stop_is_not_over_while_segments_wait() {
    let ((), board) = usual().run(|mut driver, hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        // The buffer is frozen: no axis moves, and one will as soon as it is not.
        happen(&hand, Event::Condition(Condition::BufferFrozen, true)).await;
        driver.send(&segment_of_x(1000, 5000), &no_clock).await.unwrap();
        // As if the board had kept it.
        happen(&hand, Event::StuckStatus(true)).await;
        let patience = Duration::from_secs(1);
        fails(&driver.ramp_stop(patience, &no_clock).await, UNFINISHED);
        happen(&hand, Event::StuckStatus(false)).await;
        let state = driver.ramp_stop(patience, &no_clock).await.unwrap();
        assert!(state.status.has(Status::BUFFER_EMPTY));
    });
    assert_eq!((board.waiting_segments(), board.counters()[0]), (0, 0));
}

#[test]
fn homing_ends_well_or_says_which_axes_failed() {
    let bench = Bench { cams: vec![switch(1, BoardAxis::X, -9000, -4000)], encoder: None };
    let ((), board) = Rig { bench, ..usual() }.run(|mut driver, _hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        for (number, value) in [(parameters::home_input(BoardAxis::X), 1), (14, 500)] {
            driver.set_parameter(number, value, LONG, &no_clock).await.unwrap();
        }
        let state = driver.home_machine(&x_only(20_000), LONG, &no_clock).await.unwrap();
        assert_eq!(state.positions[0], 0);
        let y = [None, Some(1000), None, None, None];
        fails(&driver.home_machine(&y, LONG, &no_clock).await, |error| {
            matches!(error, DriveError::HomingFailed { axes: Axes::Letters(2), .. })
        });
        assert!(driver.state(&no_clock).await.unwrap().0.status.has(Status::HOMING_ERROR));
        driver.clear_errors(true, false, &no_clock).await.unwrap();
        assert!(!driver.state(&no_clock).await.unwrap().0.status.has(Status::HOMING_ERROR));
    });
    assert!((board.mechanical(BoardAxis::X) + 4000.0).abs() <= 1.0);
}

#[test]
fn parameters_are_kept_and_checked() {
    let (all, board) = usual().run(|mut driver, _hand| async move {
        driver.set_parameter(4, 77, LONG, &no_clock).await.unwrap();
        driver.set_parameter(383, u32::MAX, LONG, &no_clock).await.unwrap();
        // As it is already: nothing is written.
        driver.set_parameter(4, 77, LONG, &no_clock).await.unwrap();
        assert_eq!(driver.parameter(4, &no_clock).await.unwrap(), 77);
        fails(&driver.parameter(384, &no_clock).await, RANGE);
        driver.parameters(0, 384, &no_clock).await.unwrap()
    });
    assert_eq!((all.len(), all[4], all[101], all[383]), (384, 77, 115_200, u32::MAX));
    assert_eq!(board.eeprom_generation(), 2);
    let again = Board::with_eeprom(&BoardOptions::default(), &board.eeprom()).unwrap();
    assert_eq!(again.eeprom(), board.eeprom());
}

/// The number of the exception says nothing: a board that is not locked says so.
#[test]
fn a_broken_eeprom_is_no_lock_and_stays_broken_when_asked_again() {
    let usual = Assumptions::default();
    for (locked_exception, eeprom_refuses) in [(Some(4), true), (None, true), (None, false)] {
        let assumptions = Assumptions { locked_exception, eeprom_refuses, ..usual };
        Rig::new(assuming(assumptions)).run(|mut driver, hand| async move {
            let clock = &no_clock;
            fails(&driver.set_output(3, true, clock).await, LOCKED);
            for unlocked in [false, true] {
                if unlocked {
                    driver.unlock(clock).await.unwrap();
                }
                happen(&hand, Event::BreakEeprom(true)).await;
                // The first leaves the value in RAM, where it reads back.
                for _ in 0..3 {
                    fails(&driver.set_parameter(4, 78, LONG, clock).await, EEPROM_FAILED);
                }
                happen(&hand, Event::BreakEeprom(false)).await;
                driver.set_parameter(4, 78, LONG, clock).await.unwrap();
                driver.set_parameter(4, 77, LONG, clock).await.unwrap();
            }
        });
    }
}

#[test]
fn inputs_and_outputs_are_those_of_the_board() {
    let link = EncoderLink { axis: BoardAxis::A, counts: 2, steps: 1, counts_per_revolution: 7 };
    let bench = Bench { cams: vec![], encoder: Some(link) };
    let ((), board) = Rig { bench, ..usual() }.run(|mut driver, hand| async move {
        let clock = &no_clock;
        fails(&driver.set_output(1, true, clock).await, LOCKED);
        fails(&driver.set_analog_output(1, 100, clock).await, LOCKED);
        driver.unlock(clock).await.unwrap();
        for (output, on) in [(1, true), (2, true), (3, true), (3, false), (32, true)] {
            driver.set_output(output, on, clock).await.unwrap();
        }
        assert_eq!(driver.outputs(clock).await.unwrap(), 0x8000_0003);
        driver.set_analog_output(2, 1023, clock).await.unwrap();
        assert_eq!(driver.analog_outputs(clock).await.unwrap(), [0, 1023]);
        for (output, value) in [(2, 1024), (3, 1), (0, 1)] {
            fails(&driver.set_analog_output(output, value, clock).await, RANGE);
        }
        for event in [
            Event::Input { number: 3, level: true },
            Event::Input { number: 20, level: true },
            Event::AnalogInput { number: 2, value: 512 },
            Event::Pulses { second: true, count: 70_000 },
        ] {
            happen(&hand, event).await;
        }
        driver.move_axis(BoardAxis::A, &profile(11), LONG, clock).await.unwrap();
        let all = driver.snapshot(clock).await.unwrap();
        assert_eq!((all.inputs, all.outputs), (0x0008_0004, 0x8000_0003));
        assert_eq!((all.analog_inputs, all.state.positions[3]), ([0, 512, 0, 0], 11));
        assert_eq!(all.extended.positive(), BoardAxis::A.mask());
        assert_eq!(driver.counters(clock).await.unwrap(), (22, [0, 70_000]));
    });
    assert_eq!(board.analog_outputs(), [0, 1023]);
}

#[test]
fn a_board_is_identified_by_its_parameters() {
    let line = Line { baud: 19_200, ..Line::default() };
    let assumptions = Assumptions { baud_code: crate::BaudCode::Index, ..Assumptions::default() };
    let options = BoardOptions { address: 9, line, assumptions, ..BoardOptions::default() };
    let (identity, _) = Rig::new(options)
        .run(|mut driver, _hand| async move { driver.identify(&no_clock).await.unwrap() });
    assert_eq!((identity.address, identity.speed, identity.parity), (9, 2, 0));
    assert_eq!((identity.line, identity.has_recipes), (Some(line), true));
}

#[test]
fn a_board_with_short_frames_and_long_silence_is_read_piece_by_piece() {
    let silence = Some(Duration::from_millis(5));
    let assumptions =
        Assumptions { most_read: 32, most_written: 40, silence, ..Assumptions::default() };
    let ((), board) = Rig::new(assuming(assumptions)).run(|mut driver, _hand| async move {
        driver.set_parameter(383, 1234, LONG, &no_clock).await.unwrap();
        let all = driver.parameters(0, 384, &no_clock).await.unwrap();
        assert_eq!((all.len(), all[101], all[383]), (384, 115_200, 1234));
    });
    // 24 reads of 16 parameters.
    assert!(board.frames_handled() >= 24);
}
