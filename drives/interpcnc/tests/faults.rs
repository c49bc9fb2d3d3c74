//! Faults of wire and board, and what the driver makes of them: done, or an error that names the cause; and the bus
//! is usable again afterwards.

use std::time::Duration;

use tokio::time::sleep;

use super::board::{Hand, no_clock, profile, with_board, with_usual};
use crate::Exception;
use crate::tests::common::fault_of;
use crate::{
    AxisMask, BoardAxis, Command, InterpCnc, InterpCncOptions,
    emulator::{Bench, Board, BoardOptions, Control, Event},
};
use twin_drives::{Direction, DriveError, FaultRule, When, WireFault};

const LONG: Duration = Duration::from_mins(1);

/// Every fault of a wire, each so that a frame of this board cannot pass unharmed where it harms at all.
const FAULTS: [WireFault; 12] = [
    WireFault::Drop,
    WireFault::Delay { ns: 400_000_000 },
    WireFault::Corrupt { bytes: 1 },
    WireFault::Lose { bytes: 1 },
    WireFault::Double { bytes: 1 },
    WireFault::Truncate { keep: 3 },
    WireFault::Duplicate,
    WireFault::Reorder,
    WireFault::WrongCheck,
    WireFault::Noise { bytes: 4 },
    WireFault::Refuse { code: 4 },
    WireFault::Echo,
];

/// What the board is doing meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Doing {
    Idle,
    Homing,
    Moving,
    Stopping,
}

async fn begin(driver: &mut InterpCnc, hand: &Hand, doing: Doing) {
    driver.unlock(&no_clock).await.unwrap();
    let far = Command::Move { axis: BoardAxis::X, profile: profile(1_000_000) };
    match doing {
        Doing::Idle => {}
        Doing::Homing => {
            let home = Command::HomeAxis {
                axis: BoardAxis::X,
                input: 1,
                contact: 1,
                acceleration_khz_per_s: 50,
                fast_hz: 5000,
                deceleration_khz_per_s: 50,
                max_stroke: -1_000_000,
                slow_hz: 500,
                final_position: 0,
            };
            driver.send(&home, &no_clock).await.unwrap();
        }
        Doing::Moving | Doing::Stopping => {
            driver.send(&far, &no_clock).await.unwrap();
            sleep(Duration::from_millis(500)).await;
        }
    }
    if doing == Doing::Stopping {
        driver.send(&Command::RampStop, &no_clock).await.unwrap();
    }
    // The wire is sound until here.
    hand.send(Control::NoFaults).await.unwrap();
}

/// A frame is harmed while the board does something: a question is answered in the end, a stop stops, a move that may
/// have been lost is an error that says so; after that the bus works and tells the truth.
#[test]
fn one_harmed_frame_is_survived_or_named() {
    for fault in FAULTS {
        for direction in [Direction::Request, Direction::Answer] {
            for doing in [Doing::Idle, Doing::Homing, Doing::Moving, Doing::Stopping] {
                one_harmed_frame(fault, direction, doing);
            }
        }
    }
}

fn one_harmed_frame(fault: WireFault, direction: Direction, doing: Doing) {
    let rule = FaultRule { direction, when: When::Next(1), fault };
    let case = format!("{fault}, {direction:?}, {doing:?}");
    let name = case.clone();
    let ((), board) = with_usual(|mut driver, hand| async move {
        begin(&mut driver, &hand, doing).await;

        // A question: asked again, unless the board itself has refused.
        hand.send(Control::Fault(rule)).await.unwrap();
        let asked = driver.state(&no_clock).await;
        let refused = matches!(fault, WireFault::Refuse { .. }) && direction == Direction::Request;
        if refused {
            assert!(matches!(fault_of(&asked), Some(Exception(4))), "{case}: {asked:?}");
        } else {
            assert!(asked.is_ok(), "{case}: {asked:?}");
        }
        hand.send(Control::NoFaults).await.unwrap();
        driver.state(&no_clock).await.unwrap();

        // A move, which is never sent twice: done, or an error.
        hand.send(Control::Fault(rule)).await.unwrap();
        let command = Command::Move { axis: BoardAxis::Y, profile: profile(300) };
        let moved = driver.send(&command, &no_clock).await;
        hand.send(Control::NoFaults).await.unwrap();
        let (state, _) = driver.state(&no_clock).await.unwrap();
        let executed =
            state.status.independent().contains(BoardAxis::Y) || state.positions[1] == 300;
        if moved.is_ok() {
            assert!(executed, "{case}: a move is lost unnoticed");
        } else {
            assert!(
                fault_of(&moved) == Some(&Exception(4))
                    || matches!(
                        moved,
                        Err(DriveError::Timeout { .. } | DriveError::Protocol { .. })
                    ),
                "{case}: {moved:?}"
            );
        }

        // A stop: stops.
        hand.send(Control::Fault(rule)).await.unwrap();
        let stopped = driver.ramp_stop(LONG, &no_clock).await;
        hand.send(Control::NoFaults).await.unwrap();
        if refused {
            assert!(matches!(fault_of(&stopped), Some(Exception(4))), "{case}");
            driver.ramp_stop(LONG, &no_clock).await.unwrap();
        } else {
            assert!(stopped.is_ok(), "{case}: {stopped:?}");
        }

        // Afterwards everything works.
        driver.move_axis(BoardAxis::Z, &profile(-77), LONG, &no_clock).await.unwrap();
        let (state, _) = driver.state(&no_clock).await.unwrap();
        assert_eq!(state.positions[2], -77, "{case}");
    });
    assert!(board.status().moving().is_empty(), "{name}");
}

/// A wire that harms one frame in four for a while: whatever succeeds is true.
#[test]
fn nothing_false_comes_over_a_bad_wire() {
    for (seed, fault) in (0_u16..).zip(FAULTS) {
        if matches!(fault, WireFault::Delay { .. } | WireFault::Echo | WireFault::Refuse { .. }) {
            continue;
        }
        with_usual(|mut driver, hand| async move {
            driver.unlock(&no_clock).await.unwrap();
            for direction in [Direction::Request, Direction::Answer] {
                let rule = FaultRule { direction, when: When::PerMillion(125_000), fault };
                hand.send(Control::Fault(rule)).await.unwrap();
            }
            let mut compared = 0;
            for round in 0..40_u16 {
                let value = 40 * seed + round;
                let written = driver.set_analog_output(2, value, &no_clock).await;
                let read = driver.analog_outputs(&no_clock).await;
                if let (Ok(()), Ok([_, second])) = (written, read) {
                    assert_eq!(second, value, "{fault}, round {round}");
                    compared += 1;
                }
            }
            // Each exchange is tried twice: most get through.
            assert!(compared > 20, "{fault}: {compared}");
        });
    }
}

fn with_settings<T, F: Future<Output = T>>(
    options: impl FnOnce(&mut InterpCncOptions),
    test: impl FnOnce(InterpCnc, Hand) -> F,
) -> (T, Board) {
    with_board(&BoardOptions::default(), Bench::default(), options, test)
}

#[test]
fn an_echo_is_cancelled_where_it_is_expected() {
    let echo =
        FaultRule { direction: Direction::Request, when: When::Always, fault: WireFault::Echo };
    for cancelling in [true, false] {
        with_settings(
            |options| options.echo = cancelling,
            |mut driver, hand| async move {
                hand.send(Control::Fault(echo)).await.unwrap();
                let unlocked = driver.unlock(&no_clock).await;
                if cancelling {
                    unlocked.unwrap();
                    driver.move_axis(BoardAxis::X, &profile(99), LONG, &no_clock).await.unwrap();
                    assert_eq!(driver.state(&no_clock).await.unwrap().0.positions[0], 99);
                } else {
                    assert!(
                        matches!(
                            unlocked,
                            Err(DriveError::Timeout { .. } | DriveError::Protocol { .. })
                        ),
                        "{unlocked:?}"
                    );
                }
            },
        );
    }
}

#[test]
fn a_pulled_plug_is_a_timeout_until_it_is_back() {
    let ((), _) = with_usual(|mut driver, hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        let command = Command::Move { axis: BoardAxis::X, profile: profile(30_000) };
        driver.send(&command, &no_clock).await.unwrap();
        hand.send(Control::Disconnect(true)).await.unwrap();
        let lost = driver.state(&no_clock).await;
        assert!(matches!(lost, Err(DriveError::Timeout { .. })), "{lost:?}");
        let lost = driver.ramp_stop(LONG, &no_clock).await;
        assert!(matches!(lost, Err(DriveError::Timeout { .. })), "{lost:?}");
        hand.send(Control::Disconnect(false)).await.unwrap();
        // No watchdog is documented: the axis has gone on to its target.
        driver.wait_for_rest(AxisMask::ALL, LONG, &no_clock).await.unwrap();
        assert_eq!(driver.state(&no_clock).await.unwrap().0.positions[0], 30_000);
    });
}

#[test]
fn a_brown_out_in_a_move_is_found_out_by_the_lock() {
    let ((), board) = with_usual(|mut driver, hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        let later = hand.clone();
        let fails = async {
            sleep(Duration::from_millis(700)).await;
            later.send(Control::Event(Event::BrownOut { off_ns: 100_000_000 })).await.unwrap();
        };
        let far = profile(100_000);
        let moves = driver.move_axis(BoardAxis::X, &far, LONG, &no_clock);
        let ((), moved) = tokio::join!(fails, moves);
        assert!(matches!(moved, Err(DriveError::Locked { .. })), "{moved:?}");
    });
    assert!(board.mechanical(BoardAxis::X) > 1000.0);
    assert_eq!(board.counters(), [0; 5]);
}

#[test]
fn a_status_that_is_stuck_is_a_move_that_does_not_end() {
    let ((), _) = with_usual(|mut driver, hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        let command = Command::Move { axis: BoardAxis::X, profile: profile(1000) };
        driver.send(&command, &no_clock).await.unwrap();
        hand.send(Control::Event(Event::StuckStatus(true))).await.unwrap();
        let patience = Duration::from_secs(5);
        let stuck = driver.wait_for_rest(AxisMask::ALL, patience, &no_clock).await;
        assert!(matches!(stuck, Err(DriveError::Unfinished { .. })), "{stuck:?}");
        hand.send(Control::Event(Event::StuckStatus(false))).await.unwrap();
        driver.wait_for_rest(AxisMask::ALL, patience, &no_clock).await.unwrap();
    });
}

#[test]
fn a_stall_shows_only_at_the_next_homing() {
    let (before, board) = with_usual(|mut driver, hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        hand.send(Control::Event(Event::Stall(BoardAxis::X, true))).await.unwrap();
        // Without encoder the board cannot know.
        driver.move_axis(BoardAxis::X, &profile(2000), LONG, &no_clock).await.unwrap();
        driver.state(&no_clock).await.unwrap().0.positions[0]
    });
    assert_eq!(before, 2000);
    assert!(board.mechanical(BoardAxis::X).abs() < 0.5);
}

/// Faults of the board itself, whatever it is doing.
#[derive(Clone, Copy, Debug)]
enum BoardFault {
    BrownOut,
    EnableLost,
    Disconnected,
    Stalled,
    Stuck,
}

#[test]
fn faults_of_the_board_are_found_whatever_it_is_doing() {
    for fault in [
        BoardFault::BrownOut,
        BoardFault::EnableLost,
        BoardFault::Disconnected,
        BoardFault::Stalled,
        BoardFault::Stuck,
    ] {
        for doing in [Doing::Idle, Doing::Homing, Doing::Moving, Doing::Stopping] {
            fault_of_the_board(fault, doing);
        }
    }
}

fn fault_of_the_board(fault: BoardFault, doing: Doing) {
    let case = format!("{fault:?}, {doing:?}");
    let name = case.clone();
    let ((), board) = with_usual(|mut driver, hand| async move {
        begin(&mut driver, &hand, doing).await;
        let (before, after) = match fault {
            BoardFault::BrownOut => {
                (Control::Event(Event::BrownOut { off_ns: 1 }), Control::NoFaults)
            }
            BoardFault::EnableLost => {
                (Control::Event(Event::Enable(false)), Control::Event(Event::Enable(true)))
            }
            BoardFault::Disconnected => (Control::Disconnect(true), Control::Disconnect(false)),
            BoardFault::Stalled => (
                Control::Event(Event::Stall(BoardAxis::X, true)),
                Control::Event(Event::Stall(BoardAxis::X, false)),
            ),
            BoardFault::Stuck => (
                Control::Event(Event::StuckStatus(true)),
                Control::Event(Event::StuckStatus(false)),
            ),
        };
        hand.send(before).await.unwrap();
        // Longer than the filter of the ENABLE input.
        sleep(Duration::from_millis(150)).await;
        let moved = driver.move_axis(BoardAxis::Y, &profile(200), LONG, &no_clock).await;
        match (fault, &moved) {
                (BoardFault::BrownOut, Err(DriveError::Locked { .. }))
                | (BoardFault::EnableLost, Err(DriveError::EnableOpen { .. }))
                | (BoardFault::Disconnected, Err(DriveError::Timeout { .. }))
                // Without encoder nothing of the board shows a stall, and the move was not the stalled axis'. A status
                // that is stuck shows none of the moves begun later: the counter has arrived, and that is true.
                | (BoardFault::Stalled | BoardFault::Stuck, Ok(())) => {}
                _ => panic!("{case}: {moved:?}"),
            }
        hand.send(after).await.unwrap();
        // The bus and the board are usable again: unlocked anew where that is due, stopped, moved.
        driver.unlock(&no_clock).await.unwrap();
        driver.ramp_stop(LONG, &no_clock).await.unwrap();
        driver.move_axis(BoardAxis::Z, &profile(-77), LONG, &no_clock).await.unwrap();
        let (state, _) = driver.state(&no_clock).await.unwrap();
        assert_eq!(state.positions[2], -77, "{case}");
    });
    assert!(board.status().moving().is_empty(), "{name}");
}

#[test]
fn an_echo_that_was_lost_is_not_awaited_for_ever() {
    with_settings(
        |options| options.echo = true,
        |mut driver, hand| async move {
            let (direction, when) = (Direction::Request, When::Always);
            let echo = FaultRule { direction, when, fault: WireFault::Echo };
            hand.send(Control::Fault(echo)).await.unwrap();
            driver.unlock(&no_clock).await.unwrap();
            hand.send(Control::Disconnect(true)).await.unwrap();
            let command = Command::Move { axis: BoardAxis::X, profile: profile(99) };
            let lost = driver.send(&command, &no_clock).await;
            assert!(matches!(lost, Err(DriveError::Timeout { .. })), "{lost:?}");
            hand.send(Control::Disconnect(false)).await.unwrap();
            // A move is sent once only: its own echo, and no other, is taken away.
            driver.send(&command, &no_clock).await.unwrap();
        },
    );
}
