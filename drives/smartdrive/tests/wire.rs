//! The driver's bytes against the digest's vectors, and what it makes of answers that are late, cut or wrong.

use std::{
    collections::BTreeSet,
    sync::atomic::{AtomicI64, Ordering},
    time::Duration,
};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, DuplexStream},
    time::{sleep, timeout},
};

use super::{attached, options, refusal};
use crate::{
    Command, Execution, Init, IoUpdate, LoadSource, RejectCode, SmartDrive, SmartDriveOptions,
    TrajectoryFlags,
    protocol::{
        frame::{
            Answer, encode,
            tests::{answers, commands},
        },
        vectors::vector,
    },
};
use twin_drives::{Action, DriveError, ProtocolFault, exchanges::ATTEMPTS, no_clock};

/// The next command but GET of PID and CID, which every drive answers the same; the driver writes each in one piece. Empty
/// if the driver is gone.
async fn received(far: &mut DuplexStream) -> Vec<u8> {
    let mut buffer = [0; 256];
    loop {
        let count = far.read(&mut buffer).await.unwrap();
        let known: [u8; 2] = match &buffer[..count] {
            [1, 0x12, 12, 0, 0, 0, _] => [0x42, 0x53],
            [1, 0x12, 13, 0, 0, 0, _] => [0x01, 0x01],
            command => return command.to_vec(),
        };
        let [low, high] = known;
        let mut answer = vec![0x86, 0x01, low, high, low, high, low, high];
        answer.push(answer.iter().fold(0, |sum, byte| sum ^ byte));
        far.write_all(&answer).await.unwrap();
    }
}

/// Sends `command` to address 1, answered with `answer`; the bytes sent and what the answer shows.
async fn exchange(command: Command, answer: &[u8]) -> (Vec<u8>, Result<Answer, DriveError>) {
    let (mut driver, mut far) = attached(&options(200, 1));
    let device = async {
        let sent = received(&mut far).await;
        far.write_all(answer).await.unwrap();
        sent
    };
    let (sent, outcome) = tokio::join!(device, driver.send(1, &command, &no_clock));
    (sent, outcome.map(|(answer, _)| answer))
}

/// A vector that is not exercised is a failure.
#[tokio::test(start_paused = true)]
async fn the_driver_produces_every_command_and_understands_every_answer() {
    let mut understood = BTreeSet::new();
    for (number, address, command) in commands() {
        // Vectors of answers that it may get.
        let answers: &[usize] = match number {
            1 => &[2, 3, 8],
            4 => &[5],
            7 => &[8],
            9 => &[10, 34, 35],
            11..=17 => &[12],
            // A broadcast: sent, and no answer waited for.
            18 => &[],
            19 | 21 => &[20],
            22..=26 => &[23],
            27 => &[28],
            29 => &[30],
            _ => &[2],
        };
        if answers.is_empty() {
            assert_eq!(address, 0);
            let (mut driver, mut far) = attached(&options(1000, 1));
            driver.broadcast(&command).await.unwrap();
            assert_eq!(received(&mut far).await, vector(number));
        }
        for answer in answers {
            let (bytes, outcome) = exchange(command, &vector(*answer)).await;
            assert_eq!(bytes, vector(number), "vector {number}");
            let reason = match answer {
                34 => Some(RejectCode::BadMode),
                35 => Some(RejectCode::Working),
                _ => None,
            };
            if let Some(reason) = reason {
                assert_eq!(refusal(&outcome), reason, "vector {answer}");
                let error = outcome.unwrap_err();
                assert_eq!(error.at().address, 1, "vector {answer}");
                assert_eq!(error.at().action, Action::Atb { code: 0x23, name: "GOTO" });
            } else {
                let shown = outcome.unwrap().encode();
                assert_eq!(shown.to_vec(), vector(*answer), "vector {answer}");
            }
            understood.insert(*answer);
        }
    }
    assert_eq!(understood, answers().into_iter().map(|(number, _)| number).collect());
}

#[tokio::test(start_paused = true)]
async fn an_echo_is_skipped_however_it_is_cut() {
    // With data that look like the beginning of an answer: −6400 is 00 E7 FF FF.
    let command = Command::GoTo { target: -6400, profile: Some((300, 1000)) };
    let both = [vector(11), vector(12)].concat();
    for cut in 0..both.len() {
        let (mut driver, mut far) = attached(&options(1000, 1));
        let device = async {
            received(&mut far).await;
            far.write_all(&both[..cut]).await.unwrap();
            tokio::task::yield_now().await;
            sleep(Duration::from_millis(1)).await;
            far.write_all(&both[cut..]).await.unwrap();
        };
        let ((), answer) = tokio::join!(device, driver.send(1, &command, &no_clock));
        assert_eq!(answer.unwrap().0.number(), 1600, "cut at {cut}");
    }
}

#[tokio::test(start_paused = true)]
async fn noise_before_an_answer_is_skipped() {
    for noise in
        [&[0x00][..], &[0x7F, 0x20], &[0x80], &[0xFF; 5], &[0x86, 0x01, 0x00], &[0x01, 0x55]]
    {
        let answer = [noise, &vector(2)].concat();
        let (_, outcome) = exchange(Command::Ping, &answer).await;
        assert_eq!(outcome.unwrap().encode().to_vec(), vector(2), "after {noise:?}");
    }
}

#[tokio::test(start_paused = true)]
async fn an_answer_of_another_drive_is_not_taken() {
    // Address 2 in the place of 1, check sum accordingly.
    let mut foreign = vector(2);
    foreign[1] ^= 3;
    foreign[8] ^= 3;
    let step = Command::Step { distance: 200, profile: None };
    let (_, outcome) = exchange(step, &foreign).await;
    let Err(DriveError::Protocol { fault, .. }) = outcome else { panic!("{outcome:?}") };
    assert_eq!(fault, ProtocolFault::Station);
    // Followed by the right one it is skipped.
    let (_, outcome) = exchange(step, &[foreign, vector(12)].concat()).await;
    assert_eq!(outcome.unwrap().number(), 1600);
}

#[tokio::test(start_paused = true)]
async fn a_garbled_or_cut_answer_is_told() {
    let garbled = (0..9).map(|place| {
        let mut wrong = vector(12);
        wrong[place] ^= 0x10;
        wrong
    });
    let cut = (1..9).map(|length| vector(12)[..length].to_vec());
    for answer in garbled.chain(cut) {
        let (_, outcome) = exchange(Command::Step { distance: 200, profile: None }, &answer).await;
        let Err(DriveError::Protocol { fault, .. }) = outcome else {
            panic!("{answer:02X?}: {outcome:?}")
        };
        assert_eq!(fault, ProtocolFault::Garbled, "{answer:02X?}");
    }
}

#[tokio::test(start_paused = true)]
async fn only_what_may_be_repeated_is() {
    let commands = [
        (Command::Ping, ATTEMPTS),
        (Command::Read { variable: 75 }, ATTEMPTS),
        (Command::Get { parameter: 30 }, ATTEMPTS),
        (Command::GoTo { target: 5, profile: None }, ATTEMPTS),
        (Command::GoTo { target: 5, profile: Some((1, 1)) }, ATTEMPTS),
        // Nobody has answered before a stop, which asks nothing else.
        (Command::Stop { rate: 0 }, 3),
        (Command::Step { distance: 5, profile: None }, 1),
        (Command::Start { speed: 5, rate: 0 }, 1),
        (Command::TrajectoryInit(Init::Position), 1),
        (Command::Mode(None), 1),
        (Command::Set { parameter: 30, value: 1 }, 1),
        (Command::Write { variable: 128, value: 1 }, 1),
        (Command::IoUpdate(IoUpdate::default()), 1),
        (Command::Save, 1),
        (Command::Load(LoadSource::Saved), 1),
        (Command::Reset { bootloader: false }, 1),
    ];
    for (command, times) in commands {
        let (mut driver, mut far) = attached(&options(20, 1));
        let driving = async move {
            let outcome = driver.send(1, &command, &no_clock).await;
            assert!(matches!(outcome, Err(DriveError::Timeout { .. })), "{outcome:?}");
        };
        let listening = async {
            let mut sent = received(&mut far).await;
            // Until the driver is gone.
            loop {
                match received(&mut far).await {
                    bytes if bytes.is_empty() => return sent,
                    bytes => sent.extend(bytes),
                }
            }
        };
        let (sent, ()) = tokio::join!(listening, driving);
        let times = usize::try_from(times).unwrap();
        assert_eq!(sent, encode(1, &command).repeat(times), "{command:?}");
    }
}

/// The answer to a command that was given up must not be taken for that to the next.
#[tokio::test(start_paused = true)]
async fn a_late_answer_is_not_taken_for_the_next() {
    let (mut driver, mut far) = attached(&options(30, 100));
    let device = async {
        received(&mut far).await;
        sleep(Duration::from_millis(60)).await;
        far.write_all(&vector(12)).await.unwrap();
        received(&mut far).await;
        far.write_all(&vector(2)).await.unwrap();
    };
    let driving = async {
        let step = Command::Step { distance: 200, profile: None };
        let lost = driver.send(1, &step, &no_clock).await;
        assert!(matches!(lost, Err(DriveError::Timeout { .. })), "{lost:?}");
        driver.state(1, &no_clock).await.unwrap().0
    };
    let ((), state) = tokio::join!(device, driving);
    assert_eq!((state.position, state.flags), (0, TrajectoryFlags::DONE));
}

/// Asks for the position, which is 0.
async fn ask(driver: &mut SmartDrive, far: &mut DuplexStream) {
    let device = async {
        received(far).await;
        far.write_all(&vector(2)).await.unwrap();
    };
    let ((), state) = tokio::join!(device, driver.state(1, &no_clock));
    assert_eq!(state.unwrap().0.position, 0);
}

#[tokio::test(start_paused = true)]
async fn what_lies_in_the_input_from_before_is_nobodys_answer() {
    let (mut driver, mut far) = attached(&options(1000, 1));
    far.write_all(&vector(12)).await.unwrap();
    ask(&mut driver, &mut far).await;
}

#[tokio::test(start_paused = true)]
async fn a_caller_who_gives_up_leaves_the_bus_in_order() {
    let (mut driver, mut far) = attached(&options(1000, 20));
    let asking = driver.send(1, &Command::Ping, &no_clock);
    assert!(timeout(Duration::from_millis(10), asking).await.is_err(), "nobody answers");
    far.write_all(&vector(12)).await.unwrap();
    received(&mut far).await;
    ask(&mut driver, &mut far).await;
}

#[tokio::test]
async fn a_port_that_ends_is_a_transport_error() {
    let (mut driver, far) = attached(&options(1000, 1));
    drop(far);
    let gone = driver.state(1, &no_clock).await;
    assert!(matches!(gone, Err(DriveError::Transport { .. })), "{gone:?}");
}

#[tokio::test]
async fn there_are_addresses_1_to_31() {
    let (mut driver, _far) = attached(&options(1000, 1));
    for address in [0, 32, 255] {
        let refused = driver.send(address, &Command::Ping, &no_clock).await;
        assert!(matches!(refused, Err(DriveError::Value { .. })), "{refused:?}");
    }
}

/// Sent at 0; the answer, which takes 0.781 ms, is there at 3.781 ms. Executed when the 7 or 11 bytes are there, in the middle
/// of that and the answer's first byte, or at that byte.
#[tokio::test]
async fn exchanges_are_stamped_when_drives_are_said_to_execute() {
    let far_away = Command::GoTo { target: -6400, profile: Some((300, 1000)) };
    // (954 861 + 3 781 250 − 781 250) / 2, and half their difference.
    for (execution, command, answer, executed_ns, uncertainty_ns) in [
        (Execution::Between, far_away, 12, 1_977_430, Some(1_022_569)),
        (Execution::OnArrival, Command::Ping, 2, 607_639, None),
        (Execution::BeforeAnswer, Command::Ping, 2, 3_000_000, None),
    ] {
        let (mut driver, mut far) = attached(&SmartDriveOptions { execution, ..options(1000, 1) });
        let now = AtomicI64::new(0);
        let clock = || now.load(Ordering::Relaxed);
        let device = async {
            received(&mut far).await;
            now.store(3_781_250, Ordering::Relaxed);
            far.write_all(&vector(answer)).await.unwrap();
        };
        let ((), answer) = tokio::join!(device, driver.send(1, &command, &clock));
        let (_, stamp) = answer.unwrap();
        assert_eq!((stamp.sent_ns, stamp.answered_ns), (0, 3_781_250), "{execution:?}");
        assert!((stamp.executed_ns - executed_ns).abs() <= 2, "{execution:?}: {stamp:?}");
        let uncertainty_ns = uncertainty_ns.unwrap_or(stamp.uncertainty_ns);
        assert!((stamp.uncertainty_ns - uncertainty_ns).abs() <= 2, "{execution:?}: {stamp:?}");
    }
}
