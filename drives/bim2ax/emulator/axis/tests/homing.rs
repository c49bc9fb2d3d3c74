//! Homing on cam and index.

use super::*;
use crate::{
    Assumptions, CamStart, Contact, EncoderBench,
    emulator::axis::Encoder,
    protocol::bits::{definition, message},
};

/// Ends if the edge of the cam counts as taken, and if homing that begins on the cam crosses it; the time, s.
#[test]
fn homing_ends_where_cam_and_parameters_say() {
    use coefficient::{CAM_CLOSES, HOME_PLUS, REVERSE, STAY_ON_CAM};
    // Out at 200.5 (counter 201), on by 50 to 251, back to 200.5 (counter 200), on by 20 to 180.
    let back = 0.2005 + 0.050 + 0.0505 + 0.020;
    for (about, changed, [stop, hysteresis], [low, high], ends, duration) in [
        // At 1000 µsteps/s: −399.5, where the counter changes to −400, and 150 more from there.
        ("to the edge and on", 0, [150, 0], [-900, -400], [-550; 2], Some([0.3995 + 0.150, 2e-9])),
        ("towards +", HOME_PLUS, [150, 0], [400, 900], [550; 2], None),
        ("out and back", 0, [20, 50], [-300, 200], [180; 2], Some([back, 5e-9])),
        ("without clearing", STAY_ON_CAM, [20, 50], [-300, 200], [-20, -321], None),
        ("the same on another cam", STAY_ON_CAM, [20, 0], [-100, 300], [-20, -121], None),
        ("a cam that opens", CAM_CLOSES, [0, 0], [-900, -400], [-400; 2], None),
        ("a motor that turns the other way", REVERSE, [0, 0], [400, 900], [400; 2], None),
    ] {
        for (cam_start, end) in [CamStart::EdgeTaken, CamStart::FarEdge].into_iter().zip(ends) {
            let coefficient = with(coefficient::IGNORE_SWITCHES).coefficient ^ changed;
            let settings =
                AxisSettings { coefficient, origin_stop: stop, hysteresis, ..settings() };
            let cam = Some(Contact::between(low, high, changed & CAM_CLOSES == 0));
            let mut axis = axis(&settings, &Bench { cam, ..Bench::default() });
            axis.set_assumptions(Assumptions { cam_start, ..Assumptions::default() });
            axis.order(&simple(uc::HOME));
            assert_eq!(axis.ack_uc(), uc::HOME, "{about}");
            let homing = message::HOMED | message::MOVING;
            assert_eq!(axis.messages() & homing, message::MOVING, "{about}");
            let took = finish(&mut axis);
            assert_eq!((axis.shaft(), axis.counter(), axis.ack_uc()), (end, 0, 0), "{about}");
            assert_eq!(axis.messages() & homing, message::HOMED, "{about}");
            if let Some([expected, tolerance]) = duration {
                close(took, expected, tolerance);
            }
        }
    }
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
    let settings = with(coefficient::IGNORE_SWITCHES | coefficient::HOME_PLUS);
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
    let mut axis = axis(&with(coefficient::IGNORE_SWITCHES), &bench);
    axis.order(&programmed(crate::protocol::bits::bloc::ZERO, 0, 0));
    assert_eq!(axis.messages(), message::HOMED | message::PHASES_OFF);
    axis.order(&simple(uc::HOME));
    assert_eq!(axis.messages(), message::MOVING);
    axis.advance(100 * MS);
    axis.order(&simple(uc::HARD_STOP));
    assert_eq!((axis.counter(), axis.messages()), (-100, message::HARD_STOPPED));
    assert_eq!(axis.ack_uc(), uc::HARD_STOP);
}
