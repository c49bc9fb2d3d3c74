//! The digest's vectors, by number, as the device takes and gives them.

use std::collections::BTreeSet;

use super::*;
use crate::protocol::{
    frame::tests::{answers, commands},
    vectors::vector,
};

/// Gives the device a vector, which it answers, and waits for the number of milliseconds.
#[track_caller]
fn take(device: &mut Device, number: usize, ms: i64) {
    device.handle(&vector(number)).unwrap();
    device.advance(ms * MS);
}

/// Numbers of commands, that of their answer if it is a vector, and what has been before with a drive in mode remote.
type Row = (&'static [usize], Option<usize>, fn(&mut Device));

/// A vector that is not exercised is a failure.
#[test]
fn the_device_takes_every_command_and_gives_every_answer() {
    const NOTHING: fn(&mut Device) = |_| {};
    const ROWS: [Row; 14] = [
        (&[1, 6, 16, 17], Some(2), NOTHING),
        (&[1], Some(3), |device| device.set_supply(12)),
        (&[4, 31, 32], Some(5), NOTHING),
        // 120 rpm backwards are 6400 µsteps/s, reached after 3.66 ms and 11.7 µsteps: at −123 after 21 ms.
        (&[1], Some(8), |device| {
            set(device, 118, 32_767);
            set(device, 31, 32_767);
            take(device, 7, 21);
        }),
        (&[9, 11, 13, 14, 15], Some(10), NOTHING),
        // On the way to +3200 at 300 rpm and 1000 rpm/s, 1600 µsteps from the start: ½ · 53333 · t² = 1600.
        (&[1], Some(12), |device| {
            ask(device, go_to(3200, 300, 1000));
            device.advance(244_948_974);
        }),
        (&[19], Some(20), |device| ask_and_wait(device, go_to(-1000, 0, 0), 5000)),
        (&[22], Some(23), NOTHING),
        (&[27], Some(28), NOTHING),
        (&[29], Some(30), |device| switch(device, Input::Go, true, 1)),
        (&[6, 7, 9, 11, 13, 14, 16], Some(34), |device| {
            ask_and_wait(device, Command::Mode(Some(Mode::Off)), 250);
        }),
        (&[9], Some(35), |device| ask_and_wait(device, Command::Save, 0)),
        (&[7, 21, 24, 25, 26, 33], None, NOTHING),
        (&[18], None, NOTHING),
    ];
    let (mut taken, mut given) = (BTreeSet::new(), BTreeSet::new());
    for (numbers, answer, before) in ROWS {
        for number in numbers {
            let mut device = remote();
            before(&mut device);
            let answered = device.handle(&vector(*number));
            assert_eq!(answered.is_some(), *number != 18, "vector {number}");
            if let Some(answer) = answer {
                assert_eq!(answered, Some(vector(answer)), "vector {number}");
            }
            taken.insert(*number);
            given.extend(answer);
        }
    }
    assert_eq!(taken, commands().into_iter().map(|(number, ..)| number).collect());
    assert_eq!(given, answers().into_iter().map(|(number, _)| number).collect());
}

#[test]
fn vector_3_shows_an_alarm_in_answers_to_ping_only() {
    let mut device = remote();
    device.set_supply(12);
    assert_eq!(device.handle(&vector(1)), Some(vector(3)));
    assert!(!ask(&mut device, Command::Read { variable: 68 }).status.alarm());
    assert_eq!(read(&mut device, 68), 1 << 3);
    // The cause is still there: choosing a mode does not help.
    take(&mut device, 4, 250);
    assert_eq!(device.handle(&vector(1)), Some(vector(3)));
    device.set_supply(24);
    assert_eq!(device.handle(&vector(1)), Some(vector(3)));
    take(&mut device, 4, 250);
    assert_eq!(device.handle(&vector(1)), Some(vector(2)));
}

#[test]
fn vectors_4_and_5_change_the_mode_in_250_ms() {
    let mut device = Device::new(&DeviceOptions::default());
    assert_eq!(device.handle(&vector(4)), Some(vector(5)));
    device.advance(250 * MS - 1);
    assert_eq!(device.handle(&vector(1)), Some(vector(5)));
    device.advance(1);
    assert_eq!(device.handle(&vector(1)), Some(vector(2)));
}

#[test]
fn vector_6_makes_the_present_position_0() {
    let mut device = remote();
    ask_and_wait(&mut device, go_to(1000, 0, 0), 5000);
    assert_eq!(device.counter(), 1000);
    assert_eq!(device.handle(&vector(6)), Some(vector(2)));
    near(device.mechanical(), 1000.0, 1e-9);
}

#[test]
fn vectors_9_and_10_go_to_a_position_as_fast_as_they_may() {
    let mut device = remote();
    assert_eq!(device.handle(&vector(9)), Some(vector(10)));
    // Factory: 500 rpm, 2000 rpm/s: 0.25 s and 3333.3 µsteps up, so the peak is half way, at √(3200 · 106667).
    let half = (3200.0_f64 / (2000.0 * 3200.0 / 60.0)).sqrt();
    #[expect(clippy::cast_possible_truncation, reason = "a time")]
    let half_ns = (half * 1e9) as i64;
    device.advance(half_ns);
    near(device.motion().0, 1600.0, 1e-3);
    device.advance(half_ns - 10_000);
    assert!(!flags(&mut device).contains(TrajectoryFlags::DONE));
    device.advance(20_000);
    assert_eq!(device.counter(), 3200);
    assert_eq!(flags(&mut device), TrajectoryFlags::DONE);
}

#[test]
fn vector_11_goes_with_speed_and_acceleration() {
    let mut device = remote();
    // 300 rpm = 16000 µsteps/s, 1000 rpm/s = 53333 µsteps/s²: 0.3 s, 2400 µsteps.
    take(&mut device, 11, 300);
    near(device.motion().0, -2400.0, 1e-6);
    near(device.motion().1, -16_000.0, 1e-6);
    assert_eq!(read(&mut device, 79), -300);
    device.advance(400 * MS);
    assert_eq!(device.counter(), -6400);
}

#[test]
fn vectors_14_to_17_start_and_stop() {
    let mut device = remote();
    set(&mut device, 30, 1000);
    // 600 rpm at 2000 rpm/s.
    take(&mut device, 14, 299);
    assert_eq!(flags(&mut device), TrajectoryFlags::IN_MOTION);
    device.advance(2 * MS);
    let done = TrajectoryFlags::IN_MOTION.union(TrajectoryFlags::DONE);
    assert_eq!(flags(&mut device), done);
    assert_eq!(read(&mut device, 78), 600);
    // 1200 rpm less at 500 rpm/s.
    take(&mut device, 15, 1200);
    near(device.motion().1, 0.0, 1e-6);
    device.advance(1200 * MS);
    assert_eq!(read(&mut device, 79), -600);
    assert_eq!(flags(&mut device), done);
    take(&mut device, 17, 0);
    assert_eq!(read(&mut device, 85), 2000);
    device.advance(299 * MS);
    assert_eq!(flags(&mut device), TrajectoryFlags::IN_MOTION);
    device.advance(2 * MS);
    assert_eq!(flags(&mut device), TrajectoryFlags::DONE);
    take(&mut device, 14, 300);
    let before = device.motion().0;
    take(&mut device, 16, 300);
    // v²/2a = 32000² / 213333 µsteps.
    near(device.motion().0 - before, 32_000.0 * 32_000.0 / (2.0 * 320_000.0 / 3.0), 0.5);
}

#[test]
fn vector_18_stops_every_device_and_nobody_answers() {
    let mut device = remote();
    ask_and_wait(&mut device, Command::Start { speed: 300, rate: 0 }, 500);
    assert_eq!(device.handle(&vector(18)), None);
    device.advance(200 * MS);
    assert_eq!(flags(&mut device), TrajectoryFlags::DONE);
}

#[test]
fn vectors_21_29_and_30_switch_outputs_and_show_inputs() {
    let mut device = remote();
    take(&mut device, 21, 0);
    assert_eq!(read(&mut device, 130), 0xFFFF);
    assert_eq!(device.outputs(), 0b100);
    ask(&mut device, Command::Write { variable: 130, value: 0 });
    assert_eq!(device.outputs(), 0);
    switch(&mut device, Input::Go, true, 1);
    // The capture is shown once more as it is cleared.
    assert_eq!(device.handle(&vector(29)), Some(vector(30)));
    let shown = ask(&mut device, Command::IoUpdate(crate::IoUpdate::default()));
    assert_eq!(shown.data, [0x0C, 0, 0, 0]);
}

#[test]
fn vectors_22_to_26_set_parameters() {
    let mut device = remote();
    assert_eq!(device.handle(&vector(22)), Some(vector(23)));
    take(&mut device, 24, 0);
    take(&mut device, 25, 0);
    set(&mut device, 28, 100_000);
    assert_eq!(refusal(&mut device, go_to(-100_001, 0, 0)), Some(RejectCode::BadParams));
    assert_eq!(refusal(&mut device, go_to(-100_000, 0, 0)), None);
    take(&mut device, 26, 0);
    assert_eq!(ask(&mut device, Command::Get { parameter: 66 }).words().1, 9830);
}

#[test]
fn vector_33_resets() {
    let mut device = remote();
    set(&mut device, 30, 600);
    take(&mut device, 33, 250);
    assert_eq!(device.handle(&vector(1)), None);
    device.advance(50 * MS);
    assert_eq!(ask(&mut device, Command::Ping).status.mode(), 0);
    assert_eq!(ask(&mut device, Command::Get { parameter: 30 }).words(), (500, 500));
}
