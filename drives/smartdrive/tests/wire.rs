//! The driver's bytes against the digest's vectors, and what it makes of answers that are late, cut or wrong.

use std::{future::Future, sync::Arc, time::Duration};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex},
    time::sleep,
};

use crate::{
    AxisOptions, Command, Execution, Init, IoUpdate, LoadSource, SmartDrive, SmartDriveOptions,
    StepsPerTurn, TrajectoryFlags, protocol::vectors::vector,
};
pub(super) use twin_drives::no_clock;
use twin_drives::{DriveError, ProtocolFault};

pub(super) fn run<T>(test: impl Future<Output = T>) -> T {
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(test)
}

pub(super) fn axis(address: u8) -> AxisOptions {
    AxisOptions {
        address,
        turn: StepsPerTurn::new(200, 16).unwrap(),
        velocity_rpm: 500,
        acceleration_rpm_per_s: 2000,
        deceleration_rpm_per_s: 0,
    }
}

/// A master and the other end of its wire.
pub(super) fn attached(deadline_ms: u64, worst_latency_ms: u64) -> (SmartDrive, DuplexStream) {
    let (near, far) = duplex(4096);
    let mut options = SmartDriveOptions::new(vec![axis(1)]);
    options.deadline = Duration::from_millis(deadline_ms);
    options.worst_latency = Duration::from_millis(worst_latency_ms);
    (SmartDrive::attach(Arc::from("wire"), near, &options), far)
}

/// The next command but GET of PID and CID, which every drive answers the same; the driver writes each in one piece. Empty
/// if the driver is gone.
pub(super) async fn received(far: &mut DuplexStream) -> Vec<u8> {
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

/// All commands, none answered, until the driver is gone.
async fn unanswered(mut far: DuplexStream) -> Vec<Vec<u8>> {
    let mut commands = Vec::new();
    loop {
        match received(&mut far).await {
            bytes if bytes.is_empty() => return commands,
            bytes => commands.push(bytes),
        }
    }
}

/// Sends `command` to address 1, answered with `answer`; the bytes sent and what the answer shows.
pub(super) fn exchange(
    command: Command,
    answer: &[u8],
) -> (Vec<u8>, Result<crate::protocol::frame::Answer, DriveError>) {
    run(async {
        let (mut driver, mut far) = attached(200, 1);
        let device = async {
            let sent = received(&mut far).await;
            far.write_all(answer).await.unwrap();
            sent
        };
        let (sent, outcome) = tokio::join!(device, driver.send(1, &command, &no_clock));
        (sent, outcome.map(|(answer, _)| answer))
    })
}

#[test]
fn an_echo_is_skipped_however_it_is_cut() {
    // With data that look like the beginning of an answer: −6400 is 00 E7 FF FF.
    let command = Command::GoTo { target: -6400, profile: Some((300, 1000)) };
    let both = [vector(11), vector(12)].concat();
    for cut in 0..both.len() {
        run(async {
            let (mut driver, mut far) = attached(1000, 1);
            let device = async {
                received(&mut far).await;
                far.write_all(&both[..cut]).await.unwrap();
                tokio::task::yield_now().await;
                sleep(Duration::from_millis(1)).await;
                far.write_all(&both[cut..]).await.unwrap();
            };
            let ((), answer) = tokio::join!(device, driver.send(1, &command, &no_clock));
            assert_eq!(answer.unwrap().0.number(), 1600, "cut at {cut}");
        });
    }
}

#[test]
fn noise_before_an_answer_is_skipped() {
    for noise in
        [&[0x00][..], &[0x7F, 0x20], &[0x80], &[0xFF; 5], &[0x86, 0x01, 0x00], &[0x01, 0x55]]
    {
        let answer = [noise, &vector(2)].concat();
        let (_, outcome) = exchange(Command::Ping, &answer);
        assert_eq!(outcome.unwrap().encode().to_vec(), vector(2), "after {noise:?}");
    }
}

#[test]
fn an_answer_of_another_drive_is_not_taken() {
    // Address 2 in the place of 1, check sum accordingly.
    let mut foreign = vector(2);
    foreign[1] ^= 3;
    foreign[8] ^= 3;
    let step = Command::Step { distance: 200, profile: None };
    let (_, outcome) = exchange(step, &foreign);
    let Err(DriveError::Protocol { fault, .. }) = outcome else { panic!("{outcome:?}") };
    assert_eq!(fault, ProtocolFault::Station);
    // Followed by the right one it is skipped.
    let (_, outcome) = exchange(step, &[foreign, vector(12)].concat());
    assert_eq!(outcome.unwrap().number(), 1600);
}

#[test]
fn a_garbled_or_cut_answer_is_told() {
    let step = Command::Step { distance: 200, profile: None };
    for place in 0..9 {
        let mut wrong = vector(12);
        wrong[place] ^= 0x10;
        let (_, outcome) = exchange(step, &wrong);
        assert!(
            matches!(outcome, Err(DriveError::Protocol { fault: ProtocolFault::Garbled, .. })),
            "byte {place}: {outcome:?}"
        );
    }
    for length in 1..9 {
        let (_, outcome) = exchange(step, &vector(12)[..length]);
        assert!(
            matches!(outcome, Err(DriveError::Protocol { fault: ProtocolFault::Garbled, .. })),
            "{length} bytes: {outcome:?}"
        );
    }
}

#[test]
fn only_what_may_be_repeated_is() {
    let commands = [
        (Command::Ping, 2),
        (Command::Read { variable: 75 }, 2),
        (Command::Get { parameter: 30 }, 2),
        (Command::GoTo { target: 5, profile: None }, 2),
        (Command::GoTo { target: 5, profile: Some((1, 1)) }, 2),
        (Command::Stop { rate: 0 }, 2),
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
        let sent = run(async {
            let (mut driver, far) = attached(20, 1);
            let driving = async move {
                let outcome = driver.send(1, &command, &no_clock).await;
                assert!(matches!(outcome, Err(DriveError::Timeout { .. })), "{outcome:?}");
            };
            tokio::join!(unanswered(far), driving).0
        });
        assert_eq!(sent.len(), times, "{command:?}");
        assert!(sent.windows(2).all(|pair| pair[0] == pair[1]));
    }
}

/// The answer to a command that was given up must not be taken for that to the next.
#[test]
fn a_late_answer_is_not_taken_for_the_next() {
    run(async {
        let (mut driver, mut far) = attached(30, 100);
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
    });
}

#[test]
fn what_lies_in_the_input_from_before_is_nobodys_answer() {
    run(async {
        let (mut driver, mut far) = attached(1000, 1);
        far.write_all(&vector(12)).await.unwrap();
        let device = async {
            received(&mut far).await;
            far.write_all(&vector(2)).await.unwrap();
        };
        let ((), state) = tokio::join!(device, driver.state(1, &no_clock));
        assert_eq!(state.unwrap().0.position, 0);
    });
}

#[test]
fn a_caller_who_gives_up_leaves_the_bus_in_order() {
    run(async {
        let (mut driver, mut far) = attached(1000, 20);
        {
            let asking = driver.send(1, &Command::Ping, &no_clock);
            tokio::select! {
                _ = asking => panic!("nobody answers"),
                () = sleep(Duration::from_millis(10)) => {}
            }
        }
        far.write_all(&vector(12)).await.unwrap();
        received(&mut far).await;
        let device = async {
            received(&mut far).await;
            far.write_all(&vector(2)).await.unwrap();
        };
        let ((), state) = tokio::join!(device, driver.state(1, &no_clock));
        assert_eq!(state.unwrap().0.position, 0);
    });
}

#[test]
fn a_port_that_ends_is_a_transport_error() {
    run(async {
        let (mut driver, far) = attached(1000, 1);
        drop(far);
        let gone = driver.state(1, &no_clock).await;
        assert!(matches!(gone, Err(DriveError::Transport { .. })), "{gone:?}");
    });
}

#[test]
fn there_are_addresses_1_to_31() {
    run(async {
        let (mut driver, _far) = attached(1000, 1);
        for address in [0, 32, 255] {
            let refused = driver.send(address, &Command::Ping, &no_clock).await;
            assert!(matches!(refused, Err(DriveError::Value { .. })), "{refused:?}");
        }
    });
}

/// Sent at 0, 11 bytes until 0.955 ms, answer's first byte at 3 ms, there at 3.781 ms: executed in the middle.
#[test]
fn exchanges_are_stamped_in_their_middle() {
    use std::sync::atomic::{AtomicI64, Ordering};
    run(async {
        let (mut driver, mut far) = attached(1000, 1);
        let now = AtomicI64::new(0);
        let clock = || now.load(Ordering::Relaxed);
        let device = async {
            received(&mut far).await;
            now.store(3_781_250, Ordering::Relaxed);
            far.write_all(&vector(12)).await.unwrap();
        };
        let command = Command::GoTo { target: -6400, profile: Some((300, 1000)) };
        let ((), answer) = tokio::join!(device, driver.send(1, &command, &clock));
        let (_, stamp) = answer.unwrap();
        assert_eq!((stamp.sent_ns, stamp.answered_ns), (0, 3_781_250));
        // (954 861 + 3 781 250 − 781 250) / 2, and half their difference.
        assert!((stamp.executed_ns - 1_977_430).abs() <= 2, "{stamp:?}");
        assert!((stamp.uncertainty_ns - 1_022_569).abs() <= 2, "{stamp:?}");
    });
}

/// Whoever knows when drives carry commands out stamps with that: here 0.608 ms after the begin, or 0.781 ms before the end.
#[test]
fn exchanges_are_stamped_when_drives_are_said_to_execute() {
    use std::sync::atomic::{AtomicI64, Ordering};
    for (execution, expected) in
        [(Execution::OnArrival, 607_639), (Execution::BeforeAnswer, 3_000_000)]
    {
        run(async {
            let (near, mut far) = duplex(4096);
            let mut options = SmartDriveOptions::new(vec![axis(1)]);
            options.execution = execution;
            let mut driver = SmartDrive::attach(Arc::from("wire"), near, &options);
            let now = AtomicI64::new(0);
            let clock = || now.load(Ordering::Relaxed);
            let device = async {
                received(&mut far).await;
                now.store(3_781_250, Ordering::Relaxed);
                far.write_all(&vector(2)).await.unwrap();
            };
            let ((), answer) = tokio::join!(device, driver.send(1, &Command::Ping, &clock));
            let (_, stamp) = answer.unwrap();
            assert!((stamp.executed_ns - expected).abs() <= 2, "{stamp:?}");
        });
    }
}
