//! Faults of wire and board, and what the driver makes of them: done, or an error that names the cause; and the bus
//! is usable again afterwards.

use std::time::Duration;

use tokio::time::{Instant, sleep};

use super::{
    ENABLE_OPEN, Kind, LOCKED, LOST, TIMEOUT, UNFINISHED,
    board::{LONG, Rig, happen, no_clock, usual},
    common::fault_of,
    fails, go, home, profile,
};
use crate::{
    AxisMask, BoardAxis, Command, Exception, InterpCnc, Line,
    emulator::{BoardOptions, Control, Event},
};
use twin_drives::{Direction, FaultRule, When, WireFault};

/// Every fault of a wire, each so that a frame of this board cannot pass unharmed where it harms at all.
const FAULTS: [WireFault; 12] = [
    WireFault::Drop,
    WireFault::Delay { ns: 100_000_000 },
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

/// Work of the board meanwhile: commands, the first of them half a second ago.
fn doings() -> [(&'static str, Vec<Command>); 4] {
    let far = go(BoardAxis::X, 1_000_000);
    [
        ("idle", vec![]),
        ("homing", vec![home(BoardAxis::X, (1, 1), -1_000_000, 0)]),
        ("moving", vec![far]),
        ("stopping", vec![far, Command::RampStop]),
    ]
}

async fn begin(driver: &mut InterpCnc, commands: &[Command]) {
    driver.unlock(&no_clock).await.unwrap();
    for (index, command) in commands.iter().enumerate() {
        driver.send(command, &no_clock).await.unwrap();
        if index == 0 {
            sleep(Duration::from_millis(500)).await;
        }
    }
}

/// The bus and the board are usable.
async fn works(driver: &mut InterpCnc, case: &str) {
    driver.move_axis(BoardAxis::Z, &profile(-77), LONG, &no_clock).await.unwrap();
    assert_eq!(driver.state(&no_clock).await.unwrap().0.positions[2], -77, "{case}");
}

/// A frame is harmed while the board does something: a question is answered in the end, a stop stops, a move that may
/// have been lost is an error that says so; after that the bus works and tells the truth.
#[test]
fn one_harmed_frame_is_survived_or_named() {
    for fault in FAULTS {
        for direction in [Direction::Request, Direction::Answer] {
            for (doing, commands) in doings() {
                let case = format!("{fault}, {direction:?}, {doing}");
                one_harmed_frame(fault, direction, commands, &case);
            }
        }
    }
}

fn one_harmed_frame(fault: WireFault, direction: Direction, doing: Vec<Command>, case: &str) {
    let rule = FaultRule { direction, when: When::Next(1), fault };
    let ((), board) = usual().run(|mut driver, hand| async move {
        begin(&mut driver, &doing).await;

        // A question: asked again, unless the board itself has refused.
        let refused = matches!(fault, WireFault::Refuse { .. }) && direction == Direction::Request;
        let due = refused.then_some(&Exception(4));
        hand.send(Control::Fault(rule)).await.unwrap();
        let asked = driver.state(&no_clock).await;
        assert!(asked.is_ok() != refused && fault_of(&asked) == due, "{case}: {asked:?}");
        hand.send(Control::NoFaults).await.unwrap();
        driver.state(&no_clock).await.unwrap();

        // A move: sent again where no answer comes, and done, or an error.
        hand.send(Control::Fault(rule)).await.unwrap();
        let moved = driver.send(&go(BoardAxis::Y, 300), &no_clock).await;
        hand.send(Control::NoFaults).await.unwrap();
        let (state, _) = driver.state(&no_clock).await.unwrap();
        let executed =
            state.status.independent().contains(BoardAxis::Y) || state.positions[1] == 300;
        if moved.is_ok() {
            assert!(executed, "{case}: a move is lost unnoticed");
        } else {
            let refused = fault_of(&moved) == Some(&Exception(4));
            assert!(refused || moved.as_ref().is_err_and(LOST), "{case}: {moved:?}");
        }

        // A stop: stops.
        hand.send(Control::Fault(rule)).await.unwrap();
        let stopped = driver.ramp_stop(LONG, &no_clock).await;
        hand.send(Control::NoFaults).await.unwrap();
        assert!(stopped.is_ok() != refused && fault_of(&stopped) == due, "{case}: {stopped:?}");
        if refused {
            driver.ramp_stop(LONG, &no_clock).await.unwrap();
        }
        works(&mut driver, case).await;
    });
    assert!(board.status().moving().is_empty(), "{case}");
}

/// 125 registers are 255 bytes, which take 266 ms at 9600 baud; the turnaround of the board is known by then.
#[test]
fn a_long_answer_on_a_slow_line_has_its_time() {
    let line = Line { baud: 9600, ..Line::default() };
    Rig::new(BoardOptions { line, ..BoardOptions::default() }).run(
        |mut driver, _hand| async move {
            for _ in 0..20 {
                driver.state(&no_clock).await.unwrap();
            }
            assert_eq!(driver.parameters(0, 63, &no_clock).await.unwrap().len(), 63);
            assert_eq!(driver.exchanges().losses().total, 0);
        },
    );
}

/// Nine answers in a row are lost or spoilt: the tenth attempt succeeds. One more is too many, and the first loss is the cause.
#[test]
fn nine_losses_in_a_row_are_survived() {
    for fault in [WireFault::Drop, WireFault::WrongCheck] {
        for (lost, survived) in [(9, true), (10, false)] {
            usual().run(|mut driver, hand| async move {
                driver.unlock(&no_clock).await.unwrap();
                for _ in 0..6 {
                    driver.state(&no_clock).await.unwrap();
                }
                let (direction, when) = (Direction::Answer, When::Next(lost));
                hand.send(Control::Fault(FaultRule { direction, when, fault })).await.unwrap();
                let begun = Instant::now();
                let moved = driver.send(&go(BoardAxis::X, 300), &no_clock).await;
                assert_eq!(moved.is_ok(), survived, "{fault} {lost}: {moved:?}");
                // 20 ms to spare, 4 ms of bytes, the turnaround of 2 ms and two silences.
                let most = u64::from(lost) * 45;
                assert!(
                    begun.elapsed() < Duration::from_millis(most + 20),
                    "{:?}",
                    begun.elapsed()
                );
                assert_eq!(driver.exchanges().losses().total, lost);
            });
        }
    }
}

/// A wire that harms one frame in four for a while: whatever succeeds is true.
#[test]
fn nothing_false_comes_over_a_bad_wire() {
    for (seed, fault) in (0_u16..).zip(FAULTS) {
        if matches!(fault, WireFault::Delay { .. } | WireFault::Echo | WireFault::Refuse { .. }) {
            continue;
        }
        usual().run(|mut driver, hand| async move {
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

#[test]
fn an_echo_is_cancelled_where_it_is_expected() {
    let (direction, when) = (Direction::Request, When::Always);
    let echo = FaultRule { direction, when, fault: WireFault::Echo };
    for cancelling in [true, false] {
        let mut rig = usual();
        rig.settings.echo = cancelling;
        rig.run(|mut driver, hand| async move {
            hand.send(Control::Fault(echo)).await.unwrap();
            let unlocked = driver.unlock(&no_clock).await;
            if !cancelling {
                fails(&unlocked, LOST);
                return;
            }
            unlocked.unwrap();
            driver.move_axis(BoardAxis::X, &profile(99), LONG, &no_clock).await.unwrap();
            assert_eq!(driver.state(&no_clock).await.unwrap().0.positions[0], 99);
            // One that is lost is not awaited for ever.
            hand.send(Control::Disconnect(true)).await.unwrap();
            fails(&driver.send(&go(BoardAxis::X, 9), &no_clock).await, TIMEOUT);
            hand.send(Control::Disconnect(false)).await.unwrap();
            // Its own echo, and not another, is taken away.
            driver.send(&go(BoardAxis::X, 9), &no_clock).await.unwrap();
        });
    }
}

#[test]
fn a_pulled_plug_is_a_timeout_until_it_is_back() {
    usual().run(|mut driver, hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        driver.send(&go(BoardAxis::X, 30_000), &no_clock).await.unwrap();
        hand.send(Control::Disconnect(true)).await.unwrap();
        fails(&driver.state(&no_clock).await, TIMEOUT);
        fails(&driver.ramp_stop(LONG, &no_clock).await, TIMEOUT);
        hand.send(Control::Disconnect(false)).await.unwrap();
        // No watchdog is documented: the axis has gone on to its target.
        driver.wait_for_rest(AxisMask::ALL, LONG, &no_clock).await.unwrap();
        assert_eq!(driver.state(&no_clock).await.unwrap().0.positions[0], 30_000);
    });
}

#[test]
fn a_brown_out_in_a_move_is_found_out_by_the_lock() {
    let ((), board) = usual().run(|mut driver, hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        let brown_out = async {
            sleep(Duration::from_millis(700)).await;
            happen(&hand, Event::BrownOut { off_ns: 100_000_000 }).await;
        };
        let far = profile(100_000);
        let moves = driver.move_axis(BoardAxis::X, &far, LONG, &no_clock);
        let ((), moved) = tokio::join!(brown_out, moves);
        fails(&moved, LOCKED);
    });
    assert!(board.mechanical(BoardAxis::X) > 1000.0);
    assert_eq!(board.counters(), [0; 5]);
}

#[test]
fn a_status_that_is_stuck_is_a_move_that_does_not_end() {
    usual().run(|mut driver, hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        driver.send(&go(BoardAxis::X, 1000), &no_clock).await.unwrap();
        happen(&hand, Event::StuckStatus(true)).await;
        let patience = Duration::from_secs(5);
        fails(&driver.wait_for_rest(AxisMask::ALL, patience, &no_clock).await, UNFINISHED);
        happen(&hand, Event::StuckStatus(false)).await;
        driver.wait_for_rest(AxisMask::ALL, patience, &no_clock).await.unwrap();
    });
}

#[test]
fn a_stall_shows_only_at_the_next_homing() {
    let (before, board) = usual().run(|mut driver, hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        happen(&hand, Event::Stall(BoardAxis::X, true)).await;
        // Without encoder the board cannot know.
        driver.move_axis(BoardAxis::X, &profile(2000), LONG, &no_clock).await.unwrap();
        driver.state(&no_clock).await.unwrap().0.positions[0]
    });
    assert_eq!(before, 2000);
    assert!(board.mechanical(BoardAxis::X).abs() < 0.5);
}

/// Faults of the board itself, and what becomes of a move of another axis.
#[test]
fn faults_of_the_board_are_found_whatever_it_is_doing() {
    let event = Control::Event;
    let stall = |on| event(Event::Stall(BoardAxis::X, on));
    let faults: [(Control, Control, Option<Kind>); 5] = [
        (event(Event::BrownOut { off_ns: 1 }), Control::NoFaults, Some(LOCKED)),
        (event(Event::Enable(false)), event(Event::Enable(true)), Some(ENABLE_OPEN)),
        (Control::Disconnect(true), Control::Disconnect(false), Some(TIMEOUT)),
        // Without encoder nothing of the board shows a stall, and the move was not the stalled axis'.
        (stall(true), stall(false), None),
        // A status that is stuck shows none of the moves begun later: the counter has arrived, and that is true.
        (event(Event::StuckStatus(true)), event(Event::StuckStatus(false)), None),
    ];
    for (begins, ends, kind) in faults {
        for (doing, commands) in doings() {
            let case = &format!("{begins:?}, {doing}");
            let (begins, ends) = (begins.clone(), ends.clone());
            let ((), board) = usual().run(|mut driver, hand| async move {
                begin(&mut driver, &commands).await;
                hand.send(begins).await.unwrap();
                // Longer than the filter of the ENABLE input.
                sleep(Duration::from_millis(150)).await;
                let moved = driver.move_axis(BoardAxis::Y, &profile(200), LONG, &no_clock).await;
                let found = kind.map_or(moved.is_ok(), |kind| moved.as_ref().is_err_and(kind));
                assert!(found, "{case}: {moved:?}");
                hand.send(ends).await.unwrap();
                // Unlocked anew where that is due, and stopped.
                driver.unlock(&no_clock).await.unwrap();
                driver.ramp_stop(LONG, &no_clock).await.unwrap();
                works(&mut driver, case).await;
            });
            assert!(board.status().moving().is_empty(), "{case}");
        }
    }
}
