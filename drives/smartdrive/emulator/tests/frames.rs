//! The digest's vectors, by number, as the device takes and gives them.

use super::*;
use crate::protocol::vectors::vector;

#[test]
fn vectors_1_and_2_ping_a_device_in_mode_remote() {
    assert_eq!(remote().handle(&vector(1)), Some(vector(2)));
}

#[test]
fn vector_3_shows_an_alarm_in_answers_to_ping_only() {
    let mut device = remote();
    device.set_supply(12);
    assert_eq!(device.handle(&vector(1)), Some(vector(3)));
    assert!(!ask(&mut device, Command::Read { variable: 68 }).status.alarm());
    assert_eq!(read(&mut device, 68), 1 << 3);
    // The cause is still there: choosing a mode does not help.
    device.handle(&vector(4)).unwrap();
    device.advance(250 * MS);
    assert_eq!(device.handle(&vector(1)), Some(vector(3)));
    device.set_supply(24);
    assert_eq!(device.handle(&vector(1)), Some(vector(3)));
    device.handle(&vector(4)).unwrap();
    device.advance(250 * MS);
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
    ask(&mut device, go_to(1000, 0, 0));
    device.advance(5000 * MS);
    assert_eq!(device.counter(), 1000);
    assert_eq!(device.handle(&vector(6)), Some(vector(2)));
    near(device.mechanical(), 1000.0, 1e-9);
}

#[test]
fn vectors_7_and_8_home() {
    let mut device = remote();
    set(&mut device, 118, 32_767);
    set(&mut device, 31, 32_767);
    let answer = device.handle(&vector(7)).unwrap();
    let answer = Answer::decode(&answer.try_into().unwrap()).unwrap();
    assert!(answer.status.sequence_busy() && answer.tag & 1 == 0);
    // 120 rpm backwards are 6400 µsteps/s, reached after 3.66 ms and 11.7 µsteps: at −123 after 21 ms.
    device.advance(21 * MS);
    assert_eq!(device.handle(&vector(1)), Some(vector(8)));
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
fn vectors_11_and_12_go_with_speed_and_acceleration() {
    let mut device = remote();
    device.handle(&vector(11)).unwrap();
    // 300 rpm = 16000 µsteps/s, 1000 rpm/s = 53333 µsteps/s²: 0.3 s, 2400 µsteps.
    device.advance(300 * MS);
    near(device.motion().0, -2400.0, 1e-6);
    near(device.motion().1, -16_000.0, 1e-6);
    assert_eq!(read(&mut device, 79), -300);
    device.advance(400 * MS);
    assert_eq!(device.counter(), -6400);
    // On the way to +3200 at 300 rpm, 1600 µsteps from the start.
    ask(&mut device, Command::TrajectoryInit(Init::Position));
    ask(&mut device, go_to(3200, 300, 1000));
    // ½ · 53333 · t² = 1600.
    device.advance(244_948_974);
    assert_eq!(device.handle(&vector(1)), Some(vector(12)));
}

#[test]
fn vector_13_is_relative() {
    let mut device = remote();
    for expected in [200, 400] {
        device.handle(&vector(13)).unwrap();
        device.advance(1000 * MS);
        assert_eq!(device.counter(), expected);
    }
    ask(&mut device, Command::Step { distance: -100, profile: Some((60, 500)) });
    device.advance(1000 * MS);
    assert_eq!(device.counter(), 300);
}

#[test]
fn vectors_14_to_17_start_and_stop() {
    let mut device = remote();
    set(&mut device, 30, 1000);
    device.handle(&vector(14)).unwrap();
    // 600 rpm at 2000 rpm/s.
    device.advance(299 * MS);
    assert_eq!(flags(&mut device), TrajectoryFlags::IN_MOTION);
    device.advance(2 * MS);
    let done = TrajectoryFlags::IN_MOTION.union(TrajectoryFlags::DONE);
    assert_eq!(flags(&mut device), done);
    assert_eq!(read(&mut device, 78), 600);
    device.handle(&vector(15)).unwrap();
    // 1200 rpm less at 500 rpm/s.
    device.advance(1200 * MS);
    near(device.motion().1, 0.0, 1e-6);
    device.advance(1200 * MS);
    assert_eq!(read(&mut device, 79), -600);
    assert_eq!(flags(&mut device), done);
    device.handle(&vector(17)).unwrap();
    assert_eq!(read(&mut device, 85), 2000);
    device.advance(299 * MS);
    assert_eq!(flags(&mut device), TrajectoryFlags::IN_MOTION);
    device.advance(2 * MS);
    assert_eq!(flags(&mut device), TrajectoryFlags::DONE);
    device.handle(&vector(14)).unwrap();
    device.advance(300 * MS);
    let before = device.motion().0;
    device.handle(&vector(16)).unwrap();
    device.advance(300 * MS);
    // v²/2a = 32000² / 213333 µsteps.
    near(device.motion().0 - before, 32_000.0 * 32_000.0 / (2.0 * 320_000.0 / 3.0), 0.5);
}

#[test]
fn vector_18_stops_every_device_and_nobody_answers() {
    let mut device = remote();
    ask(&mut device, Command::Start { speed: 300, rate: 0 });
    device.advance(500 * MS);
    assert_eq!(device.handle(&vector(18)), None);
    device.advance(200 * MS);
    assert_eq!(flags(&mut device), TrajectoryFlags::DONE);
}

#[test]
fn vectors_21_29_and_30_switch_outputs_and_show_inputs() {
    let mut device = remote();
    device.handle(&vector(21)).unwrap();
    assert_eq!(read(&mut device, 130), 0xFFFF);
    assert_eq!(device.outputs(), 0b100);
    ask(&mut device, Command::Write { variable: 130, value: 0 });
    assert_eq!(device.outputs(), 0);
    device.set_input(Input::Go, true);
    device.advance(MS);
    // The capture is shown once more as it is cleared.
    assert_eq!(device.handle(&vector(29)), Some(vector(30)));
    assert_eq!(
        ask(&mut device, Command::IoUpdate(crate::IoUpdate::default())).data,
        [0x0C, 0, 0, 0]
    );
}

#[test]
fn vectors_22_to_26_set_parameters() {
    let mut device = remote();
    assert_eq!(device.handle(&vector(22)), Some(vector(23)));
    device.handle(&vector(24)).unwrap();
    device.handle(&vector(25)).unwrap();
    set(&mut device, 28, 100_000);
    assert_eq!(refusal(&mut device, go_to(-100_001, 0, 0)), Some(RejectCode::BadParams));
    assert_eq!(refusal(&mut device, go_to(-100_000, 0, 0)), None);
    device.handle(&vector(26)).unwrap();
    assert_eq!(ask(&mut device, Command::Get { parameter: 66 }).words().1, 9830);
}

#[test]
fn vectors_31_and_35_save_and_refuse_the_rest_meanwhile() {
    let mut device = remote();
    set(&mut device, 30, 600);
    assert!(device.handle(&vector(31)).is_some());
    assert_eq!(device.handle(&vector(9)), Some(vector(35)));
    device.advance(250 * MS);
    let saved = ask(&mut device, Command::Get { parameter: 30 });
    assert_eq!((saved.words(), saved.tag), ((600, 600), 500));
    assert_eq!(device.handle(&vector(1)), Some(vector(2)));
}

#[test]
fn vector_32_loads_what_the_factory_set() {
    let mut device = remote();
    set(&mut device, 30, 600);
    device.handle(&vector(32)).unwrap();
    device.advance(250 * MS);
    assert_eq!(ask(&mut device, Command::Get { parameter: 30 }).words(), (500, 500));
}

#[test]
fn vector_33_resets() {
    let mut device = remote();
    set(&mut device, 30, 600);
    assert!(device.handle(&vector(33)).is_some());
    device.advance(250 * MS);
    assert_eq!(device.handle(&vector(1)), None);
    device.advance(50 * MS);
    assert_eq!(ask(&mut device, Command::Ping).status.mode(), 0);
    assert_eq!(ask(&mut device, Command::Get { parameter: 30 }).words(), (500, 500));
}

#[test]
fn vector_34_is_the_answer_in_another_mode() {
    let mut device = Device::new(&DeviceOptions::default());
    for number in [6, 7, 9, 11, 13, 14, 16] {
        assert_eq!(device.handle(&vector(number)), Some(vector(34)), "vector {number}");
    }
}
