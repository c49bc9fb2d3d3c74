//! Every vector of the digest in both directions, by number: the driver produces the commands and understands the
//! answers, the emulated device takes the commands and gives the answers. A vector that is not exercised is a failure.

use std::collections::BTreeSet;

use super::wire::{attached, exchange, received, run};
use crate::Fault;
use crate::tests::common::fault_of;
use crate::{
    Command, Init, IoUpdate, LoadSource, Mode, RejectCode,
    emulator::{Device, DeviceOptions, Input},
    protocol::{
        frame::encode,
        vectors::{VECTORS, vector},
    },
};
use twin_drives::Action;

/// Vectors that masters send.
const COMMANDS: [usize; 23] =
    [1, 4, 6, 7, 9, 11, 13, 14, 15, 16, 17, 18, 19, 21, 22, 24, 25, 26, 27, 29, 31, 32, 33];
/// Vectors that drives send.
const ANSWERS: [usize; 12] = [2, 3, 5, 8, 10, 12, 20, 23, 28, 30, 34, 35];

/// Vectors that have passed.
#[derive(Debug, Default)]
struct Ledger {
    commands: BTreeSet<usize>,
    answers: BTreeSet<usize>,
}

impl Ledger {
    /// Notes which vectors frames are that have really been sent.
    fn note(&mut self, command: &[u8], answer: Option<&[u8]>) {
        let numbers = |frame: &[u8]| {
            let same = |number: &usize| vector(*number) == frame;
            (1..=VECTORS.len()).filter(same).collect::<Vec<_>>()
        };
        self.commands.extend(numbers(command));
        self.answers.extend(answer.map(numbers).unwrap_or_default());
    }

    #[track_caller]
    fn assert_complete(&self) {
        assert_eq!(self.commands, COMMANDS.into(), "commands that have been exercised");
        assert_eq!(self.answers, ANSWERS.into(), "answers that have been exercised");
    }
}

#[test]
fn every_vector_is_a_command_or_an_answer() {
    let named: BTreeSet<usize> = COMMANDS.into_iter().chain(ANSWERS).collect();
    assert_eq!(named, (1..=VECTORS.len()).collect());
}

#[test]
fn the_driver_produces_every_command_and_understands_every_answer() {
    let mut ledger = Ledger::default();
    let go_to = |target, profile| Command::GoTo { target, profile };
    let io = IoUpdate { set: 4, clear_active: 8, ..IoUpdate::default() };
    // Command, its vector, the vector of an answer it may get.
    let exchanges = [
        (Command::Ping, 1, 2),
        (Command::Ping, 1, 3),
        (Command::Ping, 1, 8),
        (Command::Mode(Some(Mode::Remote)), 4, 5),
        (Command::TrajectoryInit(Init::Position), 6, 2),
        (Command::TrajectoryInit(Init::Homing), 7, 8),
        (go_to(3200, None), 9, 10),
        (go_to(-6400, Some((300, 1000))), 11, 12),
        (Command::Step { distance: 200, profile: None }, 13, 12),
        (Command::Start { speed: 600, rate: 0 }, 14, 12),
        (Command::Start { speed: -600, rate: 500 }, 15, 12),
        (Command::Stop { rate: 0 }, 16, 12),
        (Command::Stop { rate: 2000 }, 17, 12),
        (Command::Read { variable: 75 }, 19, 20),
        (Command::Write { variable: 130, value: 0xFFFF }, 21, 20),
        (Command::Set { parameter: 30, value: 600 }, 22, 23),
        (Command::Set { parameter: 26, value: 0x7960 }, 24, 23),
        (Command::Set { parameter: 27, value: 0xFFFE }, 25, 23),
        (Command::Set { parameter: 66, value: 9830 }, 26, 23),
        (Command::Get { parameter: 0 }, 27, 28),
        (Command::IoUpdate(io), 29, 30),
        (Command::Save, 31, 2),
        (Command::Load(LoadSource::Factory), 32, 2),
        (Command::Reset { bootloader: false }, 33, 2),
    ];
    for (command, sent, answer) in exchanges {
        let (bytes, outcome) = exchange(command, &vector(answer));
        assert_eq!(bytes, vector(sent), "vector {sent}");
        let understood = outcome.unwrap().encode();
        assert_eq!(understood.to_vec(), vector(answer), "vector {answer}");
        ledger.note(&bytes, Some(&understood));
    }
    for (number, expected) in [(34, RejectCode::BadMode), (35, RejectCode::Working)] {
        let (bytes, outcome) = exchange(go_to(3200, None), &vector(number));
        let Some(Fault::Rejected(reason)) = fault_of(&outcome) else { panic!("{outcome:?}") };
        let Err(error) = &outcome else { panic!("{outcome:?}") };
        assert_eq!((*reason, error.at().address), (expected, 1));
        assert_eq!(error.at().action, Action::Atb { code: 0x23, name: "GOTO" });
        ledger.note(&bytes, Some(&vector(number)));
    }
    // 18: sent, and no answer waited for.
    run(async {
        let (mut driver, mut far) = attached(1000, 1);
        driver.broadcast(&Command::Stop { rate: 0 }).await.unwrap();
        let bytes = received(&mut far).await;
        assert_eq!(bytes, vector(18));
        ledger.note(&bytes, None);
    });
    ledger.assert_complete();
}

const MS: i64 = 1_000_000;

/// A device at the end of no wire, and what it has been asked.
struct Bench {
    device: Device,
    ledger: Ledger,
}

impl Bench {
    /// A device in mode remote.
    fn remote(ledger: Ledger) -> Self {
        let mut bench = Self { device: Device::new(&DeviceOptions::default()), ledger };
        // 4, 5: the mode changes.
        assert_eq!(bench.play(4), Some(vector(5)));
        bench.device.advance(250 * MS);
        assert_eq!(bench.device.mode(), Mode::Remote);
        bench
    }

    /// A command, and the answer.
    fn play(&mut self, number: usize) -> Option<Vec<u8>> {
        let answer = self.device.handle(&vector(number));
        self.ledger.note(&vector(number), answer.as_deref());
        answer
    }

    fn say(&mut self, command: Command) {
        self.device.handle(&encode(1, &command)).unwrap();
    }

    fn counter_after(&mut self, ms: i64) -> i32 {
        self.device.advance(ms * MS);
        self.device.counter()
    }

    /// Two words of a parameter: saved, working.
    fn parameter(&mut self, parameter: u16) -> (u16, u16) {
        let answer = self.device.handle(&encode(1, &Command::Get { parameter })).unwrap();
        (u16::from_le_bytes([answer[2], answer[3]]), u16::from_le_bytes([answer[4], answer[5]]))
    }
}

/// What each command does is asserted here in a word, and at length in the emulator's own tests.
#[test]
fn the_device_takes_every_command_and_gives_every_answer() {
    let mut ledger = Ledger::default();
    // 34: another mode.
    let mut bench = Bench { device: Device::new(&DeviceOptions::default()), ledger };
    assert_eq!(bench.play(9), Some(vector(34)));
    ledger = bench.ledger;

    let mut bench = Bench::remote(ledger);
    assert_eq!(bench.play(1), Some(vector(2)));
    assert_eq!(bench.play(9), Some(vector(10)));
    assert_eq!(bench.counter_after(5000), 3200);
    assert_eq!(bench.play(6), Some(vector(2)));
    bench.play(11).unwrap();
    assert_eq!(bench.counter_after(5000), -6400);
    bench.play(6).unwrap();
    let profile = Some((300, 1000));
    bench.say(Command::GoTo { target: 3200, profile });
    // ½ · 53333 µsteps/s² · t² = 1600.
    bench.device.advance(244_948_974);
    assert_eq!(bench.play(1), Some(vector(12)));
    assert_eq!(bench.counter_after(5000), 3200);
    bench.play(13).unwrap();
    assert_eq!(bench.counter_after(1000), 3400);

    bench.play(14).unwrap();
    bench.device.advance(1000 * MS);
    // The factory's ceiling of 500 rpm: 26667 µsteps/s.
    assert!((bench.device.motion().1 - 500.0 * 3200.0 / 60.0).abs() < 1.0);
    bench.play(15).unwrap();
    bench.device.advance(3000 * MS);
    assert!((bench.device.motion().1 + 500.0 * 3200.0 / 60.0).abs() < 1.0);
    for stop in [16, 17, 18] {
        let answered = bench.play(stop).is_some();
        assert_eq!(answered, stop != 18, "broadcasts are not answered");
        bench.device.advance(1000 * MS);
        assert_eq!(bench.device.motion().1.to_bits(), 0, "vector {stop}");
        bench.say(Command::Start { speed: 300, rate: 0 });
        bench.device.advance(1000 * MS);
    }
    let Bench { ledger, .. } = bench;

    let mut bench = Bench::remote(ledger);
    bench.say(Command::GoTo { target: -1000, profile: None });
    bench.device.advance(5000 * MS);
    assert_eq!(bench.play(19), Some(vector(20)));
    bench.play(21).unwrap();
    assert_eq!(bench.device.outputs(), 0b100);
    bench.say(Command::Write { variable: 130, value: 0 });
    bench.device.set_input(Input::Go, true);
    bench.device.advance(MS);
    assert_eq!(bench.play(29), Some(vector(30)));
    assert_eq!(bench.play(27), Some(vector(28)));
    assert_eq!(bench.play(22), Some(vector(23)));
    for (number, parameter, value) in [(24, 26, 0x7960), (25, 27, 0xFFFE), (26, 66, 9830)] {
        bench.play(number).unwrap();
        assert_eq!(bench.parameter(parameter).1, value, "vector {number}");
    }
    assert!(bench.play(6).is_some(), "refusals show the position");
    bench.play(31).unwrap();
    assert_eq!(bench.play(9), Some(vector(35)));
    bench.device.advance(250 * MS);
    assert_eq!(bench.parameter(30), (600, 600));
    bench.play(32).unwrap();
    bench.device.advance(250 * MS);
    assert_eq!(bench.parameter(30), (600, 500));
    bench.play(33).unwrap();
    bench.device.advance(250 * MS);
    assert_eq!(bench.play(1), None, "it restarts");
    let Bench { ledger, .. } = bench;

    // 120 rpm backwards as fast as it may: at −123 after 21 ms.
    let mut bench = Bench::remote(ledger);
    for parameter in [118, 31] {
        bench.say(Command::Set { parameter, value: 32_767 });
    }
    bench.play(7).unwrap();
    bench.device.advance(21 * MS);
    assert_eq!(bench.play(1), Some(vector(8)));
    let Bench { ledger, .. } = bench;

    let mut bench = Bench::remote(ledger);
    bench.device.set_supply(12);
    assert_eq!(bench.play(1), Some(vector(3)));
    bench.ledger.assert_complete();
}
