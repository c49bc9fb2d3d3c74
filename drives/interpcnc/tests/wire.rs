//! The driver's bytes against the digest's vectors, and what it makes of answers that are late, cut or wrong.

use std::{future::Future, sync::Arc, time::Duration};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex},
    time::sleep,
};

use crate::Exception;
use crate::tests::common::fault_of;
use crate::{
    AxisMask, AxisOptions, BoardAxis, Command, InterpCnc, InterpCncOptions, MoveProfile,
    protocol::frame::seal,
    protocol::{
        registers::Status,
        vectors::{bytes, vector},
    },
};
use twin_drives::{Action, DriveError, ProtocolFault, no_clock};

fn run<T>(test: impl Future<Output = T>) -> T {
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(test)
}

/// A driver of address 1 and the other end of its wire.
fn attached(deadline_ms: u64, worst_latency_ms: u64) -> (InterpCnc, DuplexStream) {
    let (near, far) = duplex(4096);
    let mut options = InterpCncOptions::new(vec![AxisOptions::new(BoardAxis::X)]);
    options.deadline = Duration::from_millis(deadline_ms);
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

/// Sends `command`, answered with `answer`; the request and the outcome.
fn exchange(command: Command, answer: &[u8]) -> (Vec<u8>, Result<(), DriveError>) {
    run(async {
        let (mut driver, mut far) = attached(1000, 1);
        let board = async {
            let request = request(&mut far).await;
            far.write_all(answer).await.unwrap();
            request
        };
        let (request, outcome) = tokio::join!(board, driver.send(&command, &no_clock));
        (request, outcome.map(|_| ()))
    })
}

fn move_x(speed_hz: u32, target: i32) -> Command {
    let profile = MoveProfile {
        start_stop_hz: 200,
        acceleration_khz_per_s: 50,
        speed_hz,
        deceleration_khz_per_s: 40,
        target,
    };
    Command::Move { axis: BoardAxis::X, profile }
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
    let (_, outcome) = exchange(move_x(20_000, 5), &vector(29));
    assert_eq!(fault_of(&outcome), Some(&Exception(2)));
    let error = outcome.unwrap_err();
    let at = error.at();
    assert_eq!(
        (at.address, at.action),
        (1, Action::Command { number: 80, name: "independent move" })
    );
    assert_eq!(
        error.to_string(),
        "wire, address 1: command 80 (independent move): refused with exception 2, invalid address"
    );
}

/// The answer to a question for the state, all axes at 0.
fn state_with(status: u32) -> Vec<u8> {
    let mut answer = vec![1, 4, 24];
    answer.extend(status.to_be_bytes());
    answer.extend([0; 20]);
    seal(answer)
}

/// A move that was given up may be heard after the stop that follows: the stop is sent once more when nothing can.
#[test]
fn a_stop_by_hand_outlasts_a_move_that_arrives_late() {
    run(async {
        let (mut driver, mut far) = attached(1000, 30);
        {
            let command = move_x(20_000, 5);
            let moving = driver.send(&command, &no_clock);
            tokio::select! {
                _ = moving => panic!("nobody answers"),
                () = sleep(Duration::from_millis(10)) => {}
            }
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
                    state_with(Status::BUFFER_EMPTY)
                };
                far.write_all(&answer).await.unwrap();
            }
        };
        let stopping = async {
            driver.ramp_stop(Duration::from_secs(1), &no_clock).await.unwrap();
            drop(driver);
        };
        let (heard, ()) = tokio::join!(board, stopping);
        // Stop, a look when nothing can arrive any more, stop, and whether it rests.
        assert_eq!(heard[..4], [42, 0, 42, 0], "{heard:?}");
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
        let told = run(async {
            let (near, mut far) = duplex(4096);
            let mut options = InterpCncOptions::new(vec![AxisOptions::new(BoardAxis::X)]);
            options.assumptions.locked_exception = known;
            let mut driver = InterpCnc::attach(Arc::from("wire"), near, &options);
            let command = move_x(20_000, 5);
            let board = async {
                request(&mut far).await;
                far.write_all(&seal(refused.to_vec())).await.unwrap();
                if known == Some(6) {
                    assert_eq!(request(&mut far).await[1], 4);
                    far.write_all(&state_with(status)).await.unwrap();
                }
            };
            tokio::join!(driver.send(&command, &no_clock), board).0.unwrap_err()
        });
        let as_locked = matches!(told, DriveError::Locked { .. });
        let as_refused = matches!(told.fault(), Some(Exception(6)));
        assert_eq!((as_locked, as_refused), (locked, !locked), "{known:?}: {told}");
    }
}

#[test]
fn values_beyond_the_board_are_not_sent() {
    run(async {
        let (mut driver, far) = attached(1000, 1);
        let too_fast = driver.send(&move_x(200_001, 5), &no_clock).await;
        assert!(matches!(too_fast, Err(DriveError::Range { register: 4100, .. })), "{too_fast:?}");
        let standing = driver
            .send(&Command::ChangeSpeed { axes: AxisMask::ALL, speed_hz: 0 }, &no_clock)
            .await;
        assert!(matches!(standing, Err(DriveError::Range { register: 4098, .. })), "{standing:?}");
        drop(driver);
        assert!(unanswered(far).await.is_empty());
    });
}

/// Answers every request for the state with `answer` and gives the outcome.
async fn state_from(answer: &[u8], deadline_ms: u64) -> Result<Status, DriveError> {
    let (mut driver, mut far) = attached(deadline_ms, 1);
    let board = async {
        loop {
            request(&mut far).await;
            far.write_all(answer).await.unwrap();
        }
    };
    tokio::select! {
        outcome = driver.state(&no_clock) => outcome.map(|(state, _)| state.status),
        () = board => unreachable!(),
    }
}

#[test]
fn every_truncated_answer_is_a_timeout() {
    run(async {
        let answer = vector(21);
        for length in 0..answer.len() {
            let outcome = state_from(&answer[..length], 5).await;
            assert!(
                matches!(outcome, Err(DriveError::Timeout { .. } | DriveError::Protocol { .. })),
                "{length} bytes: {outcome:?}"
            );
        }
    });
}

#[test]
fn every_corrupted_answer_is_refused() {
    run(async {
        let answer = vector(21);
        for place in 0..answer.len() {
            for bit in [0x01, 0x80] {
                let mut wrong = answer.clone();
                wrong[place] ^= bit;
                let outcome = state_from(&wrong, 5).await;
                assert!(
                    matches!(
                        outcome,
                        Err(DriveError::Timeout { .. } | DriveError::Protocol { .. })
                    ),
                    "byte {place} ^ {bit}: {outcome:?}"
                );
            }
        }
    });
}

#[test]
fn an_answer_from_elsewhere_is_named() {
    run(async {
        let foreign = seal([&[2], &vector(21)[1..27]].concat());
        let outcome = state_from(&foreign, 1000).await;
        let fault = |outcome: Result<Status, DriveError>| match outcome {
            Err(DriveError::Protocol { fault, .. }) => fault,
            other => panic!("{other:?}"),
        };
        assert_eq!(fault(outcome), ProtocolFault::Station);
        let outcome = state_from(&vector(2), 1000).await;
        assert_eq!(fault(outcome), ProtocolFault::Function { sent: 4, received: 16 });
        let short = seal(bytes("01 04 02 00 40"));
        assert_eq!(
            fault(state_from(&short, 1000).await),
            ProtocolFault::Length { expected: 12, received: 1 }
        );
    });
    // Two registers are confirmed where nine were written.
    let (_, outcome) = exchange(move_x(20_000, 5), &vector(2));
    let fault = match outcome {
        Err(DriveError::Protocol { fault, .. }) => fault,
        other => panic!("{other:?}"),
    };
    let expected = ProtocolFault::Confirmation {
        address: 4096,
        count: 9,
        confirmed_address: 4096,
        confirmed_count: 2,
    };
    assert_eq!(fault, expected);
}

#[test]
fn only_what_may_be_repeated_is_repeated() {
    for (command, times) in [
        (move_x(20_000, 5), 1),
        (Command::WritePosition { positions: [Some(1); 5] }, 1),
        (Command::ChangeSpeed { axes: AxisMask::ALL, speed_hz: 9 }, 1),
        (Command::Reset { unlock: true, homing_error: false, probe_error: false }, 2),
        (Command::RampStop, 3),
        (Command::Stop, 3),
    ] {
        run(async {
            let (mut driver, far) = attached(10, 1);
            let sending = async move {
                let outcome = driver.send(&command, &no_clock).await;
                assert!(matches!(outcome, Err(DriveError::Timeout { .. })), "{outcome:?}");
            };
            let ((), requests) = tokio::join!(sending, unanswered(far));
            assert_eq!(requests.len(), times, "{command:?}");
        });
    }
}

/// The answer to vector 20 with `x` on axis X.
fn state_answer(x: u8) -> Vec<u8> {
    let mut body = vector(21)[..27].to_vec();
    body[7..11].copy_from_slice(&[0, 0, 0, x]);
    seal(body)
}

#[test]
fn a_late_answer_is_not_taken_for_the_next() {
    run(async {
        let (mut driver, mut far) = attached(30, 120);
        let board = async {
            // The first answer comes after the deadline; those after it, which count on, in time.
            request(&mut far).await;
            sleep(Duration::from_millis(80)).await;
            far.write_all(&state_answer(1)).await.unwrap();
            for x in 2..=5 {
                request(&mut far).await;
                far.write_all(&state_answer(x)).await.unwrap();
            }
        };
        let asking = async {
            for x in 2..=5 {
                let (state, _) = driver.state(&no_clock).await.unwrap();
                assert_eq!(state.positions[0], x);
            }
        };
        tokio::join!(board, asking);
    });
}

#[test]
fn a_stop_waits_for_no_late_answer() {
    run(async {
        // Were the worst latency waited for, this test would take an hour.
        let (mut driver, mut far) = attached(50, 3_600_000);
        let board = async {
            request(&mut far).await;
            let stop = request(&mut far).await;
            // First the answer to the move that the driver has given up, then nothing; the stop comes again.
            far.write_all(&seal(vector(11)[..6].to_vec())).await.unwrap();
            let again = request(&mut far).await;
            far.write_all(&seal(stop[..6].to_vec())).await.unwrap();
            (stop, again)
        };
        let driving = async {
            let lost = driver.send(&move_x(20_000, 100_000), &no_clock).await;
            assert!(matches!(lost, Err(DriveError::Timeout { .. })), "{lost:?}");
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
        far.write_all(&state_answer(1)).await.unwrap();
        let board = async {
            request(&mut far).await;
            far.write_all(&state_answer(2)).await.unwrap();
        };
        let ((), state) = tokio::join!(board, driver.state(&no_clock));
        assert_eq!(state.unwrap().0.positions[0], 2);
    });
}

/// Vector 24 switches OUT1 on and its answer is the same; that it is on is read back.
#[test]
fn vector_24_switches_an_output_and_a_locked_board_is_found_out() {
    for (state, locked) in [("01 01 01 01", false), ("01 01 01 00", true)] {
        run(async {
            let (mut driver, mut far) = attached(1000, 1);
            let board = async {
                let write = request(&mut far).await;
                far.write_all(&write).await.unwrap();
                let read = request(&mut far).await;
                far.write_all(&seal(bytes(state))).await.unwrap();
                (write, read)
            };
            let ((write, read), outcome) =
                tokio::join!(board, driver.set_output(1, true, &no_clock));
            assert_eq!(write, vector(24));
            assert_eq!(read, seal(bytes("01 01 01 00 00 01")));
            assert_eq!(matches!(outcome, Err(DriveError::Locked { .. })), locked, "{outcome:?}");
            assert_eq!(outcome.is_ok(), !locked);
        });
    }
}

#[test]
fn there_are_outputs_1_to_32() {
    run(async {
        let (mut driver, _far) = attached(1000, 1);
        for output in [0, 33, 255] {
            let refused = driver.set_output(output, true, &no_clock).await;
            assert!(matches!(refused, Err(DriveError::Range { .. })), "{refused:?}");
        }
    });
}
