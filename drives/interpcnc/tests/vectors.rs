//! The vectors of the digest in both directions, by number: the driver produces its requests and understands their
//! answers, the emulated board takes the requests and gives the answers. A vector that is not exercised is a failure.

use std::{collections::BTreeSet, sync::Arc};

use tokio::io::{AsyncReadExt, AsyncWriteExt, duplex};

use crate::Exception;
use crate::protocol::frame::seal;
use crate::tests::common::fault_of;
use crate::{
    AxisMask, AxisOptions, BoardAxis, Command, InterpCnc, InterpCncOptions, MoveProfile,
    emulator::{Board, BoardOptions},
    protocol::{
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
            let left = all.iter().copied().filter(|number| !done.contains(number));
            left.filter(|number| !unsent.contains(number)).collect::<Vec<_>>()
        };
        let requests = left(&REQUESTS, &self.requests);
        let answers = left(&ANSWERS, &self.answers);
        assert!(
            requests.is_empty() && answers.is_empty(),
            "{who}: requests {requests:?} and answers {answers:?} have not been exercised"
        );
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
    let runtime =
        tokio::runtime::Builder::new_current_thread().enable_time().start_paused(true).build();
    runtime.unwrap().block_on(async {
        let (near, mut far) = duplex(4096);
        let options = InterpCncOptions::new(vec![AxisOptions::new(BoardAxis::X)]);
        let mut driver = InterpCnc::attach(Arc::from("wire"), near, &options);
        let board = async {
            for (expected, answer) in script {
                let mut buffer = [0; 256];
                let count = far.read(&mut buffer).await.unwrap();
                assert_eq!(buffer[..count], expected[..]);
                far.write_all(answer).await.unwrap();
            }
        };
        let ((), outcome) = tokio::join!(board, call(&mut driver));
        for (request, answer) in script {
            ledger.note(request, answer);
        }
        outcome
    })
}

fn two(second: BoardAxis, x: i32, other: i32) -> [Option<i32>; 5] {
    let mut values = [None; 5];
    values[0] = Some(x);
    values[second.index()] = Some(other);
    values
}

fn x_only(value: i32) -> [Option<i32>; 5] {
    [Some(value), None, None, None, None]
}

fn go_x(speed_hz: u32, target: i32) -> Command {
    let profile = MoveProfile {
        start_stop_hz: 200,
        acceleration_khz_per_s: 50,
        speed_hz,
        deceleration_khz_per_s: 40,
        target,
    };
    Command::Move { axis: BoardAxis::X, profile }
}

fn probe() -> Command {
    Command::Probe {
        axes: BoardAxis::Z.mask(),
        positive: false,
        input: 3,
        level: 1,
        max_stroke: 10_000,
        speed_hz: 1000,
        start_stop_hz: 100,
        acceleration_khz_per_s: 50,
        deceleration_khz_per_s: 100,
    }
}

fn home_x() -> Command {
    Command::HomeAxis {
        axis: BoardAxis::X,
        input: 5,
        contact: 0,
        acceleration_khz_per_s: 20,
        fast_hz: 4000,
        deceleration_khz_per_s: 40,
        max_stroke: -60_000,
        slow_hz: 300,
        final_position: 0,
    }
}

/// The commands and their vectors.
fn commands() -> Vec<(usize, Command)> {
    let stop = AxisMask::from_bits(0b11);
    let all = [Some(1), Some(2), Some(3), Some(4), Some(-5)];
    vec![
        (1, Command::Reset { unlock: true, homing_error: false, probe_error: false }),
        (3, Command::HomeMachine { max_strokes: two(BoardAxis::Y, 10_000, 20_000) }),
        (4, Command::HomeMachine { max_strokes: two(BoardAxis::Z, 10_000, 20_000) }),
        (5, probe()),
        (7, Command::WritePosition { positions: x_only(1000) }),
        (8, Command::WritePosition { positions: two(BoardAxis::Z, 1000, 0) }),
        (9, Command::ChangeSpeed { axes: BoardAxis::X.mask(), speed_hz: 10_000 }),
        // Vector 10, the manual's example of 96 as printed, sets a counter: no other command makes it.
        (10, Command::WritePosition { positions: x_only(10_000) }),
        (11, go_x(20_000, 100_000)),
        (12, go_x(150_000, -5000)),
        (13, Command::Interpolated { speed_hz: 5000, targets: two(BoardAxis::Z, 1000, -2000) }),
        (14, Command::Interpolated { speed_hz: 5000, targets: all }),
        (15, home_x()),
        (16, Command::RampStopAxes { axes: stop }),
        (17, Command::RampStop),
        (18, Command::Stop),
    ]
}

#[test]
fn the_driver_produces_its_requests_and_understands_their_answers() {
    let mut ledger = Ledger::default();
    for (number, command) in commands() {
        let request = vector(number);
        let script = [(request.clone(), confirmed(&request))];
        let sent =
            drive(&mut ledger, &script, async |driver| driver.send(&command, &no_clock).await);
        assert!(sent.is_ok(), "vector {number}: {sent:?}");
    }
    // 20, 21: state.
    let script = [(vector(20), vector(21))];
    let state = drive(&mut ledger, &script, async |driver| driver.state(&no_clock).await);
    let (state, _) = state.unwrap();
    assert_eq!(state.positions, [100_000, -1, 0, 0, 0]);
    assert_eq!(state.status, Status(0x0040_0020));
    assert_eq!(state.status.moving(), BoardAxis::X.mask());
    // 24: OUT1 on, read back.
    let read = seal(bytes("01 01 01 00 00 01"));
    let script = [(vector(24), vector(24)), (read, seal(bytes("01 01 01 01")))];
    drive(&mut ledger, &script, async |driver| driver.set_output(1, true, &no_clock).await)
        .unwrap();
    // 27, 28: parameter 101.
    let script = [(vector(27), vector(28))];
    let speed = drive(&mut ledger, &script, async |driver| driver.parameter(101, &no_clock).await);
    assert_eq!(speed.unwrap(), 115_200);
    // 29: a refused write.
    let script = [(vector(11), vector(29))];
    let command = go_x(20_000, 100_000);
    let refused =
        drive(&mut ledger, &script, async |driver| driver.send(&command, &no_clock).await);
    assert!(matches!(fault_of(&refused), Some(Exception(2))), "{refused:?}");
    // 30: refuses a function that this driver never sends; it is no answer to another.
    let script = [(vector(11), vector(30))];
    let foreign =
        drive(&mut ledger, &script, async |driver| driver.send(&command, &no_clock).await);
    let fault = ProtocolFault::Function { sent: 16, received: 0x17 };
    assert!(
        matches!(&foreign, Err(DriveError::Protocol { fault: found, .. }) if *found == fault),
        "{foreign:?}"
    );
    // 31: a refused read.
    let script = [(vector(20), vector(31))];
    let refused = drive(&mut ledger, &script, async |driver| driver.state(&no_clock).await);
    assert!(matches!(fault_of(&refused), Some(Exception(3))), "{refused:?}");
    ledger.assert_complete("driver", &UNSENT);
}

#[test]
fn the_board_takes_every_request_and_gives_every_answer() {
    let mut ledger = Ledger::default();
    let unlocked = || {
        let mut board = Board::new(&BoardOptions::default());
        assert_eq!(board.handle(&vector(1)), Some(vector(2)));
        board
    };
    // Each command on a board of its own; what it does is asserted here or, at length, in the emulator's own tests.
    for (number, command) in commands() {
        let request = vector(number);
        assert_eq!(frame(&command), request, "vector {number}");
        let mut board = if number == 1 { Board::new(&BoardOptions::default()) } else { unlocked() };
        let running = matches!(number, 9 | 12 | 16..=18);
        if running {
            board.handle(&vector(11)).unwrap();
            board.advance(1_000_000_000);
        }
        let answer = board.handle(&request).unwrap();
        assert_eq!(answer, confirmed(&request), "vector {number}");
        ledger.note(&request, &answer);
        // 60000 steps at 300 Hz off a switch that is never left take 200 s.
        board.advance(400_000_000_000);
        let (status, counters) = (board.status(), board.counters());
        let x = counters[0];
        let homing = board.extended_status() >> 18;
        let done = match number {
            1 => !status.locked(),
            // No switch is connected: homing fails.
            3 | 4 => status.has(Status::HOMING_ERROR) && counters == [0; 5],
            5 => status.probe_failed() && counters == [0, 0, -10_000, 0, 0],
            7 | 8 => counters == [1000, 0, 0, 0, 0],
            9 | 11 => x == 100_000,
            10 => x == 10_000,
            12 => x == -5000,
            13 => counters == [1000, 0, -2000, 0, 0],
            14 => counters == [1, 2, 3, 4, -5],
            // A normally closed contact that nothing closes: the axis is on its switch, and never leaves it.
            15 => homing == 0b10 && x == 60_000,
            16 | 17 => x > 16_000 && x < 22_000 && !status.locked(),
            18 => x > 16_000 && x < 17_000 && status.locked(),
            _ => false,
        };
        assert!(done, "vector {number}: {status:?} {counters:?} {homing:b}");
        assert!(status.moving().is_empty(), "vector {number}");
    }
    let mut exchange = |board: &mut Board, request: &[u8], expected: &[u8]| {
        let answer = board.handle(request).unwrap();
        assert_eq!(answer, expected);
        ledger.note(request, &answer);
    };
    let mut board = unlocked();
    exchange(&mut board, &vector(19), &vector(19));
    let positions = [Some(100_000), Some(-1), Some(0), Some(0), Some(0)];
    board.send(&Command::WritePosition { positions }).unwrap();
    board.send(&go_x(20_000, 200_000)).unwrap();
    exchange(&mut board, &vector(20), &vector(21));
    exchange(&mut board, &vector(22), &vector(23));
    exchange(&mut board, &vector(24), &vector(24));
    exchange(&mut board, &vector(25), &confirmed(&vector(25)));
    assert_eq!(board.outputs(), 0x0A5);
    exchange(&mut board, &vector(26), &seal(bytes("01 01 01 00")));
    exchange(&mut board, &vector(27), &vector(28));
    exchange(&mut board, &seal(bytes("01 10 1B 58 00 01 02 00 00")), &vector(29));
    let read_write = seal(bytes("01 17 10 00 00 01 10 00 00 01 02 00 00"));
    exchange(&mut board, &read_write, &vector(30));
    exchange(&mut board, &seal(bytes("01 04 04 00 00 00")), &vector(31));
    ledger.assert_complete("board", &[]);
}

#[test]
fn every_vector_is_a_request_or_an_answer() {
    let named: BTreeSet<usize> = REQUESTS.into_iter().chain(ANSWERS).collect();
    assert_eq!(named, (1..=VECTORS.len()).collect());
}
