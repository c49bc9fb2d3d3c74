//! Homing on cam and index.

use super::*;
use crate::{
    Assumptions, CamStart, Contact, EncoderBench,
    emulator::axis::Encoder,
    protocol::bits::{definition, message},
};

/// Homes and gives where the shaft is at the end and how long it took, s.
fn home(settings: &AxisSettings, bench: &Bench) -> (i64, f64) {
    let mut axis = axis(settings, bench);
    axis.order(&simple(uc::HOME));
    assert_eq!(axis.ack_uc(), uc::HOME);
    assert_eq!(axis.messages() & (message::HOMED | message::MOVING), message::MOVING);
    let duration = finish(&mut axis);
    assert_eq!((axis.counter(), axis.ack_uc()), (0, 0));
    assert_eq!(axis.messages() & (message::HOMED | message::MOVING), message::HOMED);
    (axis.shaft(), duration)
}

#[test]
fn off_the_cam_it_runs_to_the_edge_and_on_by_the_stop_distance() {
    let cam = Some(Contact::between(-900, -400, true));
    let bench = Bench { cam, ..Bench::default() };
    let settings = AxisSettings { origin_stop: 150, ..settings() };
    let settings = AxisSettings {
        coefficient: settings.coefficient | coefficient::IGNORE_SWITCHES,
        ..settings
    };
    let (shaft, duration) = home(&settings, &bench);
    assert_eq!(shaft, -550);
    // At 1000 µsteps/s: −399.5, where the counter changes to −400, and 150 more from there.
    close(duration, 0.3995 + 0.150, 2e-9);
    // Towards + there is another cam.
    let plus =
        AxisSettings { coefficient: settings.coefficient | coefficient::HOME_PLUS, ..settings };
    let cam = Some(Contact::between(400, 900, true));
    assert_eq!(home(&plus, &Bench { cam, ..bench }).0, 550);
}

#[test]
fn on_the_cam_it_backs_out_clears_by_the_hysteresis_and_comes_back() {
    let cam = Some(Contact::between(-300, 200, true));
    let bench = Bench { cam, ..Bench::default() };
    let settings = AxisSettings { origin_stop: 20, hysteresis: 50, ..settings() };
    let settings = AxisSettings {
        coefficient: settings.coefficient | coefficient::IGNORE_SWITCHES,
        ..settings
    };
    let (shaft, duration) = home(&settings, &bench);
    assert_eq!(shaft, 180);
    // Out at 200.5 (counter 201), on by 50 to 251, back to 200.5 (counter 200), on by 20 to 180.
    close(duration, 0.2005 + 0.050 + 0.0505 + 0.020, 5e-9);
}

#[test]
fn without_clearing_the_edge_counts_as_taken() {
    let cam = Some(Contact::between(-300, 200, true));
    let coefficient =
        settings().coefficient | coefficient::STAY_ON_CAM | coefficient::IGNORE_SWITCHES;
    let settings = AxisSettings { coefficient, origin_stop: 20, hysteresis: 50, ..settings() };
    assert_eq!(home(&settings, &Bench { cam, ..Bench::default() }).0, -20);
}

#[test]
fn a_cam_that_is_not_cleared_may_be_crossed() {
    let cam = Some(Contact::between(-100, 300, true));
    let coefficient =
        settings().coefficient | coefficient::STAY_ON_CAM | coefficient::IGNORE_SWITCHES;
    let settings = AxisSettings { coefficient, origin_stop: 20, ..settings() };
    for (cam_start, end) in [(CamStart::EdgeTaken, -20), (CamStart::FarEdge, -121)] {
        let mut axis = axis(&settings, &Bench { cam, ..Bench::default() });
        axis.set_assumptions(Assumptions { cam_start, ..Assumptions::default() });
        axis.order(&simple(uc::HOME));
        finish(&mut axis);
        assert_eq!((axis.shaft(), axis.counter()), (end, 0), "{cam_start:?}");
        assert_ne!(axis.messages() & message::HOMED, 0);
    }
}

#[test]
fn a_cam_that_opens_is_read_by_bit_7() {
    // The same place, by a contact that opens.
    let cam = Some(Contact::between(-900, -400, false));
    let coefficient =
        (settings().coefficient | coefficient::IGNORE_SWITCHES) & !coefficient::CAM_CLOSES;
    let settings = AxisSettings { coefficient, ..settings() };
    assert_eq!(home(&settings, &Bench { cam, ..Bench::default() }).0, -400);
}

#[test]
fn a_motor_that_turns_the_other_way_round_finds_the_cam_on_the_other_side() {
    let cam = Some(Contact::between(400, 900, true));
    let coefficient = settings().coefficient | coefficient::IGNORE_SWITCHES | coefficient::REVERSE;
    let settings = AxisSettings { coefficient, ..settings() };
    assert_eq!(home(&settings, &Bench { cam, ..Bench::default() }).0, 400);
}

#[test]
fn an_end_switch_ends_homing_without_success() {
    let minus = Some(Contact::below(-300, true));
    let cam = Some(Contact::between(-900, -400, true));
    let mut axis = axis(&settings(), &Bench { minus, cam, ..Bench::default() });
    axis.order(&simple(uc::HOME));
    finish(&mut axis);
    assert_eq!((axis.counter(), axis.ack_uc()), (-300, 0));
    assert_eq!(axis.messages(), message::MINUS_SWITCH);
}

#[test]
fn homing_on_the_index_of_an_incremental_encoder() {
    let coefficient =
        settings().coefficient | coefficient::IGNORE_SWITCHES | coefficient::HOME_PLUS;
    let settings = AxisSettings { coefficient, ..settings() };
    let mut axis = Axis::power_up(0, &settings, &Bench::default(), 70, 0, 0);
    let bench = EncoderBench::default();
    let bits = definition::PRESENT | definition::HOME_ON_INDEX;
    *axis.encoder_mut() = Encoder::reset(Some(bench), 200, 2000, 0, 0, bits);
    assert_eq!(axis.encoder().points(70), 700);
    axis.order(&simple(uc::HOME));
    finish(&mut axis);
    // 200 µsteps per turn: the next index after 70. 5.1: the encoder is 0 at the end.
    assert_eq!((axis.shaft(), axis.counter(), axis.encoder().points(200)), (200, 0, 0));
}

#[test]
fn homing_is_lost_while_it_runs_and_by_a_hard_stop() {
    let cam = Some(Contact::between(-900, -400, true));
    let bench = Bench { cam, ..Bench::default() };
    let coefficient = settings().coefficient | coefficient::IGNORE_SWITCHES;
    let mut axis = axis(&AxisSettings { coefficient, ..settings() }, &bench);
    axis.order(&programmed(crate::protocol::bits::bloc::ZERO, 0, 0));
    assert_eq!(axis.messages(), message::HOMED | message::PHASES_OFF);
    axis.order(&simple(uc::HOME));
    assert_eq!(axis.messages(), message::MOVING);
    axis.advance(100 * MS);
    axis.order(&simple(uc::HARD_STOP));
    assert_eq!((axis.counter(), axis.messages()), (-100, message::HARD_STOPPED));
    assert_eq!(axis.ack_uc(), uc::HARD_STOP);
}
