//! Tests of faults of devices and their line, and of what the manual leaves open about both.

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, duplex},
    sync::mpsc,
    time::{Duration, Instant},
};

use super::*;
use crate::{Execution, protocol::vectors::vector};

#[test]
fn a_length_that_is_not_that_of_its_code_is_refused_as_chosen() {
    // PING with eight bytes of data: CMD 41h.
    let mut frame = vec![0x01, 0x41, 0, 0, 0, 0, 0, 0, 0, 0];
    frame.push(0x40);
    for reason in [RejectCode::BadParams, RejectCode::NotAvailable, RejectCode::Generic] {
        let assumptions = Assumptions { wrong_length: reason, ..Assumptions::default() };
        let mut device = remote_with(&DeviceOptions { assumptions, ..DeviceOptions::default() });
        let answer = device.handle(&frame).unwrap();
        let answer = Answer::decode(&answer.try_into().unwrap()).unwrap();
        assert!(answer.status.rejected());
        assert_eq!(RejectCode::from_number(answer.tag), Some(reason));
        // A code that does not exist is that, whatever its length.
        let unknown = Answer::decode(
            &device.handle(&[0x01, 0x3F, 0, 0, 0, 0, 0x3E]).unwrap().try_into().unwrap(),
        );
        assert_eq!(unknown.map(|answer| answer.tag), Some(4));
    }
}

#[test]
fn a_refusal_is_answered_and_nothing_is_done() {
    let device = remote();
    // STA: mode 3, response, reject, address 1; TAG 4; XOR of 86h, 81h and 04h.
    let refused = [0x86, 0x81, 0, 0, 0, 0, 4, 0, 0x03];
    assert_eq!(device.refusal(&vector(9), 4).as_deref(), Some(refused.as_slice()));
    assert!(!device.generator.is_under_way(device.now_ns()));
    // Broadcasts and foreign addresses are not answered.
    assert_eq!(device.refusal(&vector(18), 4), None);
    assert_eq!(device.refusal(&[2, 1, 0, 0, 0, 0, 3], 4), None);
}

#[test]
fn a_brown_out_is_silent_for_its_time_and_the_boot() {
    let mut device = remote();
    ask(&mut device, go_to(100_000, 0, 0));
    device.advance(500 * MS);
    let stands = device.mechanical();
    assert!(stands > 1000.0);
    device.happen(Event::BrownOut { off_ns: 100 * MS });
    device.advance(400 * MS - 1);
    assert_eq!(device.handle(&vector(1)), None);
    device.advance(1);
    let answer = Answer::decode(&device.handle(&vector(1)).unwrap().try_into().unwrap()).unwrap();
    assert_eq!((answer.status.mode(), answer.number()), (Mode::Off.number(), 0));
    near(device.mechanical(), stands, 0.5);
}

#[test]
fn a_stuck_status_shows_what_was() {
    let mut device = remote();
    ask(&mut device, go_to(100_000, 0, 0));
    device.advance(500 * MS);
    let before = device.handle(&vector(1));
    device.happen(Event::StuckStatus(true));
    device.advance(20_000 * MS);
    assert_eq!(device.handle(&vector(1)), before);
    assert_eq!(device.counter(), 100_000);
    device.happen(Event::StuckStatus(false));
    assert_eq!(ask(&mut device, Command::Ping).number(), 100_000);
}

/// How far a drive at 500 rpm has gone when it answers a PING that is sent now, with 50 ms to answer.
async fn gone_at_ping(execution: Execution) -> f64 {
    let mut device = remote();
    ask(&mut device, Command::Start { speed: 500, rate: 0 });
    device.advance(1000 * MS);
    let before = device.counter();
    let (mut near, far) = duplex(64);
    let (control, messages) = mpsc::channel(1);
    let wire = Wire { response: Duration::from_millis(50), execution, ..Wire::default() };
    let zero = Instant::now();
    let clock = move || i64::try_from(zero.elapsed().as_nanos()).unwrap();
    let asking = async {
        near.write_all(&vector(1)).await.unwrap();
        let mut answer = [0; 9];
        near.read_exact(&mut answer).await.unwrap();
        drop(control);
        Answer::decode(&answer).unwrap().number()
    };
    let (served, position) =
        tokio::join!(serve(far, vec![device], &wire, &clock, messages), asking);
    served.unwrap();
    f64::from(position - before)
}

#[tokio::test(start_paused = true)]
async fn a_command_is_carried_out_when_it_is_said_to_be() {
    // 500 rpm are 26667 µsteps/s; seven bytes take 0.608 ms.
    for (execution, seconds) in [
        (Execution::OnArrival, 0.000_608),
        (Execution::Between, 0.025_608),
        (Execution::BeforeAnswer, 0.050_608),
    ] {
        near(gone_at_ping(execution).await, 500.0 * 3200.0 / 60.0 * seconds, 1.0);
    }
}
