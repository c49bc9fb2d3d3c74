//! Answers that come late or twice must not be taken for those to the next questions: nothing in them tells.

use std::{sync::Arc, time::Duration};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, DuplexStream},
    sync::Mutex,
    time::sleep,
};

use super::{attached, options};
use crate::{
    emulator::{Device, DeviceOptions},
    protocol::parameters::PARAMETERS,
};
use twin_drives::{DriveError, ProtocolFault};

/// Between a command and its answer.
const RESPONSE: Duration = Duration::from_millis(2);

/// What becomes of an answer: how much later it comes, and how much later than that it comes once more.
type Fate = (Duration, Option<Duration>);

/// A device whose answers, counted from 0, come as `fate` says, each in a write of its own.
async fn serve(far: DuplexStream, fate: impl Fn(u64) -> Fate) {
    let mut device = Device::new(&DeviceOptions::default());
    let (mut from, to) = tokio::io::split(far);
    let to = Arc::new(Mutex::new(to));
    let mut buffer = [0; 256];
    for count in 0.. {
        let length = from.read(&mut buffer).await.unwrap();
        if length == 0 {
            return;
        }
        let Some(answer) = device.handle(&buffer[..length]) else { continue };
        let (later, again) = fate(count);
        for wait in [Some(later), again.map(|again| later + again)].into_iter().flatten() {
            let (to, answer) = (Arc::clone(&to), answer.clone());
            tokio::spawn(async move {
                sleep(RESPONSE + wait).await;
                // The driver may be gone by then.
                drop(to.lock().await.write_all(&answer).await);
            });
        }
    }
}

/// Reads all parameters over such a wire, `times` times over, and holds them against the factory's values, which the device has
/// in use; how many are missing, each because answers were out of step or did not come.
async fn missing(fate: impl Fn(u64) -> Fate, times: usize, what: &str) -> usize {
    // As `twin drive` has them.
    let (mut driver, far) = attached(&options(100, 100));
    let reading = async {
        let mut missing = 0;
        for entry in std::iter::repeat_n(&PARAMETERS, times).flatten() {
            match driver.parameter(1, entry.index).await {
                Ok(value) => assert_eq!(value.working, entry.factory, "{}, {what}", entry.name),
                Err(
                    DriveError::Protocol { fault: ProtocolFault::OutOfStep, .. }
                    | DriveError::Timeout { .. },
                ) => missing += 1,
                Err(other) => panic!("{}, {what}: {other}", entry.name),
            }
        }
        drop(driver);
        missing
    };
    tokio::join!(serve(far, fate), reading).1
}

#[tokio::test(start_paused = true)]
async fn an_answer_beyond_the_latency_leaves_no_value_in_the_place_of_another() {
    for ms in (20..=500).step_by(10) {
        for place in [0, 1, 12, 13] {
            let late = Duration::from_millis(ms);
            let fate = |count| (if count == place { late } else { Duration::ZERO }, None);
            let what = format!("answer {place} late by {ms} ms");
            assert_eq!(missing(fate, 1, &what).await, 0, "{what}");
        }
    }
}

#[tokio::test(start_paused = true)]
async fn answers_that_all_come_too_late_are_not_taken_for_others() {
    // Beyond deadline and latency; the manual allows 50 ms.
    for ms in [105, 150, 210, 290, 410] {
        let late = Duration::from_millis(ms);
        let fate = |count| (if count >= 12 { late } else { Duration::ZERO }, None);
        missing(fate, 1, &format!("all late by {ms} ms")).await;
    }
}

#[tokio::test(start_paused = true)]
async fn copies_of_answers_are_not_taken_for_others() {
    // Some copies, however late: everything is read, and right. Of very many all that is read is.
    for us in (0..12_000).step_by(500) {
        for every in [5, 7, 20] {
            let copy = Some(Duration::from_micros(us));
            let fate = |count: u64| (Duration::ZERO, copy.filter(|_| count % every == 3));
            let what = format!("each {every}th again after {us} µs");
            let missing = missing(fate, 3, &what).await;
            assert!(missing == 0 || every < 20, "{what}: {missing}");
        }
    }
    // Every answer twice, the copy right behind.
    let at_once = |_| (Duration::ZERO, Some(Duration::ZERO));
    assert_eq!(missing(at_once, 3, "all again at once").await, 0);
    // The copy of each in the answer to the next: what can be read is right.
    for ms in [1, 3, 5, 8] {
        let fate = |_| (Duration::ZERO, Some(Duration::from_millis(ms)));
        missing(fate, 1, &format!("all again after {ms} ms")).await;
    }
}
