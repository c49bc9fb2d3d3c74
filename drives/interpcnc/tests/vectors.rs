//! The vectors of the digest in both directions, by number: the driver produces its requests and understands their
//! answers, the emulated board takes the requests and gives the answers. A vector that is not exercised is a failure.

use std::collections::BTreeSet;

use super::{
    common::fault_of,
    go, profile, unlocked,
    wire::{answered, attached, run},
    x_only,
};
use crate::{
    AxisMask, AxisValues, BoardAxis, Command, Exception, InterpCnc, MoveProfile,
    protocol::{
        frame::seal,
        registers::Status,
        vectors::{VECTORS, bytes, frame, vector},
    },
};
use twin_drives::{DriveError, ProtocolFault, no_clock};

/// Vectors that masters send; 19 and 24 are also their own answers.
const REQUESTS: [usize; 23] =
    [1, 3, 4, 5, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 22, 24, 25, 26, 27];
/// Vectors that boards send.
const ANSWERS: [usize; 10] = [2, 6, 19, 21, 23, 24, 28, 29, 30, 31];

/// Vectors of masters that write single registers (function 6) and several coils (15) and read status and lock bit by bit (2, 1):
/// the driver does none of it.
const UNSENT: [usize; 5] = [19, 22, 23, 25, 26];

/// Vectors that have passed.
#[derive(Debug, Default)]
struct Ledger {
    requests: BTreeSet<usize>,
    answers: BTreeSet<usize>,
}

impl Ledger {
    /// Notes which vectors an exchange is.
    fn note(&mut self, request: &[u8], answer: &[u8]) {
        let numbers = |frame: &[u8]| {
            let same = |number: &usize| vector(*number) == frame;
            (1..=VECTORS.len()).filter(same).collect::<Vec<_>>()
        };
        self.requests.extend(numbers(request));
        self.answers.extend(numbers(answer));
    }

    fn assert_complete(&self, who: &str, unsent: &[usize]) {
        let left = |all: &[usize], done: &BTreeSet<usize>| {
            let open = |number: &usize| !done.contains(number) && !unsent.contains(number);
            all.iter().copied().filter(open).collect::<Vec<_>>()
        };
        let left = (left(&REQUESTS, &self.requests), left(&ANSWERS, &self.answers));
        assert_eq!(left, (vec![], vec![]), "{who}: requests and answers not exercised");
    }
}

/// A write is confirmed with its address and value or count.
fn confirmed(request: &[u8]) -> Vec<u8> {
    seal(request[..6].to_vec())
}

/// Lets the driver do something and answers as scripted; its requests must be these.
fn drive<T>(
    ledger: &mut Ledger,
    script: &[(Vec<u8>, Vec<u8>)],
    call: impl AsyncFnOnce(&mut InterpCnc) -> T,
) -> T {
    run(async {
        let (mut driver, mut far) = attached(1000, 1);
        let board = async {
            for (expected, answer) in script {
                assert_eq!(answered(&mut far, answer).await, *expected);
                ledger.note(expected, answer);
            }
        };
        tokio::join!(board, call(&mut driver)).1
    })
}

fn two(second: BoardAxis, x: i32, other: i32) -> AxisValues {
    let mut values = x_only(x);
    values[second.index()] = Some(other);
    values
}

pub(super) fn slow_home(axis: BoardAxis, final_position: i32) -> Command {
    Command::HomeAxis {
        axis,
        input: 5,
        contact: 0,
        acceleration_khz_per_s: 20,
        fast_hz: 4000,
        deceleration_khz_per_s: 40,
        max_stroke: -60_000,
        slow_hz: 300,
        final_position,
    }
}

/// The commands and their vectors.
pub(super) fn commands() -> Vec<(usize, Command)> {
    let fast = MoveProfile { speed_hz: 150_000, ..profile(-5000) };
    let all = [Some(1), Some(2), Some(3), Some(4), Some(-5)];
    let probe = Command::Probe {
        axes: BoardAxis::Z.mask(),
        positive: false,
        input: 3,
        level: 1,
        max_stroke: 10_000,
        speed_hz: 1000,
        start_stop_hz: 100,
        acceleration_khz_per_s: 50,
        deceleration_khz_per_s: 100,
    };
    vec![
        (1, Command::Reset { unlock: true, homing_error: false, probe_error: false }),
        (3, Command::HomeMachine { max_strokes: two(BoardAxis::Y, 10_000, 20_000) }),
        (4, Command::HomeMachine { max_strokes: two(BoardAxis::Z, 10_000, 20_000) }),
        (5, probe),
        (7, Command::WritePosition { positions: x_only(1000) }),
        (8, Command::WritePosition { positions: two(BoardAxis::Z, 1000, 0) }),
        (9, Command::ChangeSpeed { axes: BoardAxis::X.mask(), speed_hz: 10_000 }),
        // Vector 10, the manual's example of 96 as printed, sets a counter: no other command makes it.
        (10, Command::WritePosition { positions: x_only(10_000) }),
        (11, go(BoardAxis::X, 100_000)),
        (12, Command::Move { axis: BoardAxis::X, profile: fast }),
        (13, Command::Interpolated { speed_hz: 5000, targets: two(BoardAxis::Z, 1000, -2000) }),
        (14, Command::Interpolated { speed_hz: 5000, targets: all }),
        (15, slow_home(BoardAxis::X, 0)),
        (16, Command::RampStopAxes { axes: AxisMask::from_bits(0b11) }),
        (17, Command::RampStop),
        (18, Command::Stop),
    ]
}

#[test]
fn the_driver_produces_its_requests_and_understands_their_answers() {
    let mut ledger = Ledger::default();
    let mut sent = |number, command: &Command, answer| {
        let script = [(vector(number), answer)];
        drive(&mut ledger, &script, async |driver| driver.send(command, &no_clock).await)
    };
    for (number, command) in commands() {
        let done = sent(number, &command, confirmed(&vector(number)));
        assert!(done.is_ok(), "vector {number}: {done:?}");
    }
    // 29: a refused write.
    let command = go(BoardAxis::X, 100_000);
    assert_eq!(fault_of(&sent(11, &command, vector(29))), Some(&Exception(2)));
    // 30: refuses a function that this driver never sends; it is not an answer to another.
    let foreign = sent(11, &command, vector(30));
    let Err(DriveError::Protocol { fault, .. }) = foreign else { panic!("{foreign:?}") };
    assert_eq!(fault, ProtocolFault::Function { sent: 16, received: 0x17 });
    // 20, 21: state; 31: a refused read.
    let mut state = |answer| {
        let script = [(vector(20), vector(answer))];
        drive(&mut ledger, &script, async |driver| driver.state(&no_clock).await)
    };
    let (shown, _) = state(21).unwrap();
    assert_eq!(shown.positions, [100_000, -1, 0, 0, 0]);
    assert_eq!(shown.status, Status(0x0040_0020));
    assert_eq!(shown.status.moving(), BoardAxis::X.mask());
    assert_eq!(fault_of(&state(31)), Some(&Exception(3)));
    // 24: OUT1 on, read back.
    let read = seal(bytes("01 01 01 00 00 01"));
    let script = [(vector(24), vector(24)), (read, seal(bytes("01 01 01 01")))];
    drive(&mut ledger, &script, async |driver| driver.set_output(1, true, &no_clock).await)
        .unwrap();
    // 27, 28: parameter 101.
    let script = [(vector(27), vector(28))];
    let speed = drive(&mut ledger, &script, async |driver| driver.parameter(101, &no_clock).await);
    assert_eq!(speed.unwrap(), 115_200);
    ledger.assert_complete("driver", &UNSENT);
}

#[test]
fn the_board_takes_every_request_and_gives_every_answer() {
    let mut ledger = Ledger::default();
    // Each command on a board of its own; the emulator's own tests assert what it does.
    for (number, command) in commands() {
        let request = vector(number);
        assert_eq!(frame(&command), request, "vector {number}");
        let answer = unlocked().handle(&request).unwrap();
        assert_eq!(answer, confirmed(&request), "vector {number}");
        ledger.note(&request, &answer);
    }
    let mut board = unlocked();
    let positions = [Some(100_000), Some(-1), Some(0), Some(0), Some(0)];
    board.send(&Command::WritePosition { positions }).unwrap();
    board.send(&go(BoardAxis::X, 200_000)).unwrap();
    for (request, expected) in [
        (vector(20), vector(21)),
        (vector(22), vector(23)),
        (vector(24), vector(24)),
        (vector(25), confirmed(&vector(25))),
        (vector(26), seal(bytes("01 01 01 00"))),
        (vector(27), vector(28)),
        (seal(bytes("01 10 1B 58 00 01 02 00 00")), vector(29)),
        (seal(bytes("01 17 10 00 00 01 10 00 00 01 02 00 00")), vector(30)),
        (seal(bytes("01 04 04 00 00 00")), vector(31)),
        (vector(19), vector(19)),
    ] {
        let answer = board.handle(&request).unwrap();
        assert_eq!(answer, expected);
        ledger.note(&request, &answer);
    }
    assert_eq!(board.outputs(), 0x0A5);
    ledger.assert_complete("board", &[]);
}

#[test]
fn every_vector_is_a_request_or_an_answer() {
    let named: BTreeSet<usize> = REQUESTS.into_iter().chain(ANSWERS).collect();
    assert_eq!(named, (1..=VECTORS.len()).collect());
}
