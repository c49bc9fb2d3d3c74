//! The driver's bytes against the digest's vectors, and what it makes of answers that are late, cut or wrong.

use std::{future::Future, sync::Arc, time::Duration};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex},
    time::sleep,
};

use super::{LOCKED, LOST, RANGE, TIMEOUT, common::fault_of, fails, go, profile};
use crate::{
    AxisMask, AxisOptions, BoardAxis, Command, Exception, InterpCnc, InterpCncOptions, MoveProfile,
    protocol::{
        frame::seal,
        registers::Status,
        vectors::{bytes, vector},
    },
};
use twin_drives::{Action, DriveError, ProtocolFault, no_clock};

pub(super) fn run<T>(test: impl Future<Output = T>) -> T {
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(test)
}

/// A driver of address 1 and the other end of its wire.
pub(super) fn attached(deadline_ms: u64, worst_latency_ms: u64) -> (InterpCnc, DuplexStream) {
    let (near, far) = duplex(4096);
    let mut options = InterpCncOptions::new(vec![AxisOptions::new(BoardAxis::X)]);
    options.deadline = Duration::from_millis(deadline_ms);
    options.turnaround = Duration::ZERO;
    options.worst_latency = Duration::from_millis(worst_latency_ms);
    (InterpCnc::attach(Arc::from("wire"), near, &options), far)
}

/// The next request; the driver writes each in one piece. Empty if the driver is gone.
async fn request(far: &mut DuplexStream) -> Vec<u8> {
    let mut buffer = [0; 256];
    let count = far.read(&mut buffer).await.unwrap();
    buffer[..count].to_vec()
}

/// All requests, none answered, until the driver is gone.
async fn unanswered(mut far: DuplexStream) -> Vec<Vec<u8>> {
    let mut requests = Vec::new();
    loop {
        match request(&mut far).await {
            bytes if bytes.is_empty() => return requests,
            bytes => requests.push(bytes),
        }
    }
}

/// Answers the next request, which it gives.
pub(super) async fn answered(far: &mut DuplexStream, answer: &[u8]) -> Vec<u8> {
    let request = request(far).await;
    far.write_all(answer).await.unwrap();
    request
}

/// Sends `command`, answered with `answer`.
fn exchange(command: &Command, answer: &[u8]) -> Result<(), DriveError> {
    run(async {
        let (mut driver, mut far) = attached(1000, 1);
        let board = answered(&mut far, answer);
        tokio::join!(board, driver.send(command, &no_clock)).1.map(|_| ())
    })
}

/// Sent at 0, 8 bytes until 0.694 ms, 29 of an answer from 3.483 ms on, there at 6 ms: executed in the middle.
#[test]
fn exchanges_are_stamped_in_their_middle() {
    use std::sync::atomic::{AtomicI64, Ordering};
    run(async {
        let (mut driver, mut far) = attached(1000, 1);
        let now = AtomicI64::new(0);
        let clock = || now.load(Ordering::Relaxed);
        let board = async {
            assert_eq!(request(&mut far).await, vector(20));
            now.store(6_000_000, Ordering::Relaxed);
            far.write_all(&vector(21)).await.unwrap();
        };
        let ((), answer) = tokio::join!(board, driver.state(&clock));
        let (_, stamp) = answer.unwrap();
        assert_eq!((stamp.sent_ns, stamp.answered_ns), (0, 6_000_000));
        // (694 444 + 6 000 000 − 2 517 361) / 2, and half their difference.
        assert!((stamp.executed_ns - 2_088_541).abs() <= 2, "{stamp:?}");
        assert!((stamp.uncertainty_ns - 1_394_097).abs() <= 2, "{stamp:?}");
    });
}

#[test]
fn an_exception_is_an_error_with_its_code_and_command() {
    let outcome = exchange(&go(BoardAxis::X, 5), &vector(29));
    assert_eq!(fault_of(&outcome), Some(&Exception(2)));
    let error = outcome.unwrap_err();
    let action = Action::Command { number: 80, name: "independent move" };
    assert_eq!((error.at().address, error.at().action), (1, action));
    assert_eq!(
        error.to_string(),
        "wire, address 1: command 80 (independent move): refused with exception 2, invalid address"
    );
}

/// The answer to a question for the state.
fn state(status: u32, x: i32) -> Vec<u8> {
    read(&[1, 4, 4, 0, 0, 12], status, x)
}

/// Answer to a read of this number of registers from the status on.
fn read(asked: &[u8], status: u32, x: i32) -> Vec<u8> {
    assert_eq!(asked[..5], [1, 4, 4, 0, 0]);
    let mut answer = vec![1, 4, 2 * asked[5]];
    answer.extend(status.to_be_bytes());
    answer.extend(x.to_be_bytes());
    answer.resize(3 + 2 * usize::from(asked[5]), 0);
    seal(answer)
}

/// A move that was given up may be heard after the stop that follows: the stop is sent once more when nothing can.
#[test]
fn a_stop_by_hand_outlasts_a_move_that_arrives_late() {
    run(async {
        let (mut driver, mut far) = attached(1000, 30);
        let command = go(BoardAxis::X, 5);
        tokio::select! {
            _ = driver.send(&command, &no_clock) => panic!("nobody answers"),
            () = sleep(Duration::from_millis(10)) => {}
        }
        assert_eq!(request(&mut far).await[8], 80);
        let board = async {
            let mut heard = Vec::new();
            loop {
                let asked = request(&mut far).await;
                if asked.is_empty() {
                    return heard;
                }
                let answer = if asked[1] == 16 {
                    heard.push(asked[8]);
                    seal(asked[..6].to_vec())
                } else {
                    heard.push(0);
                    read(&asked, Status::BUFFER_EMPTY, 0)
                };
                far.write_all(&answer).await.unwrap();
            }
        };
        let stopping = async {
            driver.ramp_stop(Duration::from_secs(1), &no_clock).await.unwrap();
            drop(driver);
        };
        let (heard, ()) = tokio::join!(board, stopping);
        // Stop, and again when nothing can arrive any more; what is known, and whether it rests.
        assert_eq!(heard[..4], [42, 42, 0, 0], "{heard:?}");
    });
}

#[test]
fn the_exception_of_a_locked_board_is_told_as_such_where_it_is_known() {
    let refused = [1, 0x90, 6];
    // Also where another refusal has the same number, the board says itself whether it is locked.
    let cases = [
        (None, 0, false),
        (Some(6), Status::BOARD_LOCKED, true),
        (Some(6), 0, false),
        (Some(4), 0, false),
    ];
    for (known, status, locked) in cases {
        let said = run(async {
            let (near, mut far) = duplex(4096);
            let mut options = InterpCncOptions::new(vec![AxisOptions::new(BoardAxis::X)]);
            options.assumptions.locked_exception = known;
            let mut driver = InterpCnc::attach(Arc::from("wire"), near, &options);
            let command = go(BoardAxis::X, 5);
            let board = async {
                answered(&mut far, &seal(refused.to_vec())).await;
                if known == Some(6) {
                    assert_eq!(answered(&mut far, &state(status, 0)).await[1], 4);
                }
            };
            tokio::join!(driver.send(&command, &no_clock), board).0.unwrap_err()
        });
        let as_refused = said.fault() == Some(&Exception(6));
        assert_eq!((LOCKED(&said), as_refused), (locked, !locked), "{known:?}: {said}");
    }
}

#[test]
fn values_beyond_the_board_are_not_sent() {
    let profile = MoveProfile { speed_hz: 200_001, ..profile(5) };
    let too_fast = Command::Move { axis: BoardAxis::X, profile };
    let at_rest = Command::ChangeSpeed { axes: AxisMask::ALL, speed_hz: 0 };
    run(async {
        let (mut driver, far) = attached(1000, 1);
        for (command, expected) in [(too_fast, 4100), (at_rest, 4098)] {
            let Err(DriveError::Range { register, .. }) = driver.send(&command, &no_clock).await
            else {
                panic!("{command:?}")
            };
            assert_eq!(register, expected);
        }
        for output in [0, 33, 255] {
            fails(&driver.set_output(output, true, &no_clock).await, RANGE);
        }
        drop(driver);
        assert!(unanswered(far).await.is_empty());
    });
}

/// Answers every request for the state with `answer` and gives the outcome.
async fn state_from(answer: &[u8], deadline_ms: u64) -> Result<Status, DriveError> {
    let (mut driver, mut far) = attached(deadline_ms, 1);
    let board = async {
        loop {
            answered(&mut far, answer).await;
        }
    };
    tokio::select! {
        outcome = driver.state(&no_clock) => outcome.map(|(state, _)| state.status),
        () = board => unreachable!(),
    }
}

#[test]
fn every_truncated_or_corrupted_answer_is_refused() {
    let answer = vector(21);
    let cut = |length: usize| (format!("{length} bytes"), answer[..length].to_vec());
    let corrupted = |place: usize| {
        [0x01, 0x80].map(|bit| {
            let mut wrong = answer.clone();
            wrong[place] ^= bit;
            (format!("byte {place} ^ {bit}"), wrong)
        })
    };
    let places = 0..answer.len();
    for (name, wrong) in places.clone().map(cut).chain(places.flat_map(corrupted)) {
        let outcome = run(state_from(&wrong, 5));
        assert!(outcome.as_ref().is_err_and(LOST), "{name}: {outcome:?}");
    }
}

#[test]
fn an_answer_from_elsewhere_is_named() {
    let asked = |answer: &[u8]| run(state_from(answer, 50)).map(|_| ());
    let foreign = seal([&[2], &vector(21)[1..27]].concat());
    let short = seal(bytes("01 04 02 00 40"));
    // Two registers are confirmed where nine were written.
    let confirmed = exchange(&go(BoardAxis::X, 5), &vector(2));
    let confirmation = ProtocolFault::Confirmation {
        address: 4096,
        count: 9,
        confirmed_address: 4096,
        confirmed_count: 2,
    };
    for (outcome, expected) in [
        (asked(&foreign), ProtocolFault::Station),
        (asked(&vector(2)), ProtocolFault::Function { sent: 4, received: 16 }),
        (asked(&short), ProtocolFault::Length { expected: 12, received: 1 }),
        (confirmed, confirmation),
    ] {
        let Err(DriveError::Protocol { fault, .. }) = outcome else { panic!("{outcome:?}") };
        assert_eq!(fault, expected);
    }
}

#[test]
fn only_what_may_be_repeated_is_repeated() {
    for (command, times) in [
        (go(BoardAxis::X, 5), 1),
        (Command::WritePosition { positions: [Some(1); 5] }, 1),
        (Command::ChangeSpeed { axes: AxisMask::ALL, speed_hz: 9 }, 1),
        // What may be repeated is, once the line is in step, which it never is here.
        (Command::Reset { unlock: true, homing_error: false, probe_error: false }, 1),
        (Command::RampStop, 3),
        (Command::Stop, 3),
    ] {
        run(async {
            let (mut driver, far) = attached(10, 1);
            let sending = async move {
                fails(&driver.send(&command, &no_clock).await, TIMEOUT);
            };
            let ((), mut requests) = tokio::join!(sending, unanswered(far));
            requests.retain(|request| request[1] == 16);
            assert_eq!(requests.len(), times, "{command:?}");
        });
    }
}

#[test]
fn a_late_answer_is_not_taken_for_the_next() {
    run(async {
        let (mut driver, mut far) = attached(30, 1);
        let board = async {
            for x in 1..=4 {
                answered(&mut far, &state(0, x)).await;
            }
            // An answer comes after the deadline, and those after it, which count on, behind it.
            request(&mut far).await;
            sleep(Duration::from_millis(80)).await;
            far.write_all(&state(0, 5)).await.unwrap();
            for x in 6.. {
                for asked in request(&mut far).await.chunks(8) {
                    far.write_all(&read(asked, 0, x)).await.unwrap();
                }
            }
        };
        let asking = async {
            let mut found = vec![];
            for _ in 0..8 {
                found.push(driver.state(&no_clock).await.unwrap().0.positions[0]);
            }
            found
        };
        let found = tokio::select! { found = asking => found, () = board => vec![] };
        assert_eq!(found[..4], [1, 2, 3, 4]);
        assert!(found[4] > 5 && found.is_sorted_by(|one, next| one < next), "{found:?}");
    });
}

/// The confirmation of a move is late or spoilt: the move is sent again as soon as an answer comes that only a question
/// from after it has.
#[test]
fn a_move_without_answer_is_sent_again_when_the_line_is_in_step() {
    for is_late in [true, false] {
        run(async {
            // Were a spoilt answer waited for, this test would take an hour.
            let (mut driver, mut far) = attached(if is_late { 30 } else { 3_600_000 }, 1);
            let command = go(BoardAxis::X, 5);
            let board = async {
                let first = request(&mut far).await;
                let confirmed = seal(first[..6].to_vec());
                if !is_late {
                    let mut spoilt = confirmed.clone();
                    spoilt[3] ^= 1;
                    far.write_all(&spoilt).await.unwrap();
                }
                let witness = request(&mut far).await;
                if is_late {
                    far.write_all(&confirmed).await.unwrap();
                }
                far.write_all(&read(&witness, 0, 0)).await.unwrap();
                let again = answered(&mut far, &confirmed).await;
                (first, witness[5], again)
            };
            let sending = driver.send(&command, &no_clock);
            let ((first, registers, again), sent) = tokio::join!(board, sending);
            sent.unwrap();
            assert_eq!(first, again);
            // Nothing else reads as many: 2, 12 and 32 belong to status and state.
            assert!((3..12).contains(&registers), "{registers}");
            assert_eq!((driver.exchanges().losses().total, driver.is_late()), (1, false));
        });
    }
}

#[test]
fn a_stop_waits_for_no_late_answer() {
    run(async {
        // Were the worst latency waited for, this test would take an hour.
        let (mut driver, mut far) = attached(50, 3_600_000);
        let board = async {
            request(&mut far).await;
            // What would show that the line is in step is not answered either.
            for _ in 0..2 {
                assert_eq!(request(&mut far).await[1], 4);
            }
            let stop = request(&mut far).await;
            // First the answer to the move that the driver has given up, then nothing; the stop comes again.
            far.write_all(&seal(vector(11)[..6].to_vec())).await.unwrap();
            let again = answered(&mut far, &seal(stop[..6].to_vec())).await;
            (stop, again)
        };
        let driving = async {
            fails(&driver.send(&go(BoardAxis::X, 100_000), &no_clock).await, TIMEOUT);
            driver.send(&Command::RampStop, &no_clock).await.unwrap();
        };
        let ((stop, again), ()) = tokio::join!(board, driving);
        assert_eq!((stop, again), (vector(17), vector(17)));
    });
}

#[test]
fn what_lies_in_the_input_from_before_is_nobodys_answer() {
    run(async {
        let (mut driver, mut far) = attached(1000, 1);
        far.write_all(&state(0, 1)).await.unwrap();
        let due = state(0, 2);
        let (_, state) = tokio::join!(answered(&mut far, &due), driver.state(&no_clock));
        assert_eq!(state.unwrap().0.positions[0], 2);
    });
}
