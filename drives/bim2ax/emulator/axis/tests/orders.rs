//! Orders that are refused, manual moves, phases.

use super::*;
use crate::protocol::bits::{bloc, message};

#[test]
fn an_order_during_a_move_is_refused_and_the_move_goes_on() {
    let mut axis = usual();
    axis.order(&programmed(0, 1000, 0));
    axis.advance(50 * MS);
    axis.order(&programmed(0, -500, 0));
    assert_eq!(
        (axis.ack_uc(), axis.messages()),
        (uc::PROGRAMMED, message::MOVING | message::REFUSED)
    );
    finish(&mut axis);
    assert_eq!((axis.counter(), axis.messages()), (1000, message::REFUSED));
    // The next correct order clears the bit.
    axis.order(&programmed(0, 1001, 0));
    assert_eq!(axis.messages(), message::MOVING);
}

#[test]
fn two_orders_at_a_time_are_refused() {
    let mut axis = usual();
    axis.order(&simple(uc::MANUAL_PLUS | uc::MANUAL_MINUS));
    assert_eq!((axis.moving(), axis.ack_uc()), (false, 0));
    assert_eq!(axis.messages(), message::REFUSED | message::PHASES_OFF);
}

#[test]
fn a_manual_move_runs_at_the_start_stop_speed_until_zero_is_written() {
    for (order, sense) in [(uc::MANUAL_PLUS, 1), (uc::MANUAL_MINUS, -1)] {
        let mut axis = axis(&with(coefficient::HOMING_MANDATORY), &Bench::default());
        axis.order(&simple(order));
        assert_eq!((axis.ack_uc(), axis.messages()), (order, message::MOVING));
        axis.advance(1000 * MS);
        // Repeated, it goes on.
        axis.order(&simple(order));
        axis.advance(2000 * MS);
        assert_eq!(axis.counter(), sense * 2000);
        axis.order(&simple(0));
        close(finish(&mut axis), 0.0, 1e-9);
        assert_eq!((axis.counter(), axis.ack_uc(), axis.messages()), (sense * 2000, 0, 0));
    }
}

#[test]
fn zero_ends_no_other_move() {
    let mut axis = usual();
    axis.order(&programmed(0, 1000, 0));
    axis.advance(10 * MS);
    axis.order(&simple(0));
    finish(&mut axis);
    assert_eq!((axis.counter(), axis.messages()), (1000, 0));
}

#[test]
fn programmed_moves_wait_for_mandatory_homing() {
    let mut axis = axis(&with(coefficient::HOMING_MANDATORY), &Bench::default());
    axis.order(&programmed(0, 1000, 0));
    assert!(!axis.moving());
    axis.order(&programmed(bloc::ZERO, 0, 0));
    axis.order(&programmed(0, 1000, 0));
    assert!(axis.moving());
}

#[test]
fn an_axis_that_is_not_declared_does_nothing() {
    let mut axis = axis(&without(coefficient::PRESENT), &Bench::default());
    for order in [uc::HOME, uc::PROGRAMMED, uc::MANUAL_PLUS, uc::PHASES_ON, uc::MOTOR_TEST] {
        axis.order(&simple(order));
        assert_eq!(
            (axis.moving(), axis.ack_uc(), axis.messages()),
            (false, 0, message::PHASES_OFF)
        );
    }
}

#[test]
fn phases_go_off_and_on_at_standstill_only() {
    let mut axis = usual();
    assert_eq!(axis.messages(), message::PHASES_OFF);
    axis.order(&simple(uc::PHASES_ON));
    assert_eq!((axis.ack_uc(), axis.messages()), (0, 0));
    axis.order(&simple(uc::PHASES_OFF));
    assert_eq!((axis.ack_uc(), axis.messages()), (uc::PHASES_OFF, message::PHASES_OFF));
    axis.order(&programmed(0, 1000, 0));
    assert_eq!((axis.ack_uc(), axis.messages()), (uc::PROGRAMMED, message::MOVING));
    axis.order(&simple(uc::PHASES_OFF));
    assert_eq!(axis.messages(), message::MOVING);
    axis.order(&simple(uc::ABANDON));
    finish(&mut axis);
    axis.order(&simple(uc::ABANDON | uc::HARD_STOP));
    assert_eq!(axis.messages() & message::HARD_STOPPED, 0, "stops are for moving axes");
}

#[test]
fn targets_beyond_the_range_are_refused() {
    let mut axis = usual();
    for target in [4_194_304, -4_194_304, i32::MAX, i32::MIN] {
        axis.order(&programmed(0, target, 0));
        assert_eq!((axis.moving(), axis.messages() & message::REFUSED), (false, message::REFUSED));
    }
    for target in [4_194_303, -4_194_303] {
        axis.order(&programmed(0, target, 0));
        assert!(axis.moving());
        finish(&mut axis);
        assert_eq!(axis.counter(), target);
    }
}

#[test]
fn what_the_manual_does_not_say_can_be_otherwise() {
    use crate::{Assumptions, Contact};
    use message::{HOMED, REFUSED};
    let started = |assumptions| {
        let cam = Some(Contact::between(-900, -400, true));
        let bench = Bench { cam, ..Bench::default() };
        let mut axis = axis(&with(coefficient::IGNORE_SWITCHES), &bench);
        axis.set_assumptions(assumptions);
        axis.order(&programmed(bloc::ZERO, 0, 0));
        axis.order(&programmed(0, 5000, 0));
        axis.advance(100 * MS);
        axis
    };
    // After 0.1 s it has gone 200 µsteps and has 3000 µsteps/s, which take 200 more to stop from.
    let usual = Assumptions::default();
    for (assumptions, order, messages) in [
        (Assumptions { refusal_stops: true, ..usual }, programmed(0, 0, 0), HOMED | REFUSED),
        (Assumptions { zero_ends_every_move: true, ..usual }, simple(0), HOMED),
        (Assumptions { abandon_loses_homing: true, ..usual }, simple(uc::ABANDON), 0),
    ] {
        let mut axis = started(assumptions);
        axis.order(&order);
        finish(&mut axis);
        assert_eq!((axis.counter(), axis.messages()), (400, messages), "{assumptions:?}");
    }
    let mut axis = started(Assumptions { homing_keeps_position: true, ..Assumptions::default() });
    finish(&mut axis);
    axis.order(&simple(uc::HOME));
    finish(&mut axis);
    assert_eq!((axis.counter(), axis.messages()), (-400, message::HOMED | message::ON_CAM));
}

#[test]
fn a_manual_move_that_is_repeated_may_be_refused_and_goes_on() {
    for refuses_repeats in [false, true] {
        let mut axis = usual();
        axis.set_assumptions(crate::Assumptions { refuses_repeats, ..Default::default() });
        axis.order(&simple(uc::MANUAL_PLUS));
        axis.advance(100 * MS);
        axis.order(&simple(uc::MANUAL_PLUS));
        assert_eq!(axis.messages() & message::REFUSED != 0, refuses_repeats);
        axis.advance(200 * MS);
        // 1000 µsteps/s all the time.
        assert_eq!((axis.moving(), axis.counter()), (true, 200));
    }
}

#[test]
fn reserved_bits_have_no_effect() {
    // Order bits 2 and 11 to 14, bloc bits 9, 10 and 12 up, coefficient bits 5 and 13.
    let (mut plain, mut odd) = (usual(), axis(&with(0x2020), &Bench::default()));
    odd.order(&simple(0x7804));
    assert_eq!((odd.moving(), odd.ack_uc(), odd.messages()), (false, 0, message::PHASES_OFF));
    plain.order(&programmed(0, 1234, 0));
    odd.order(&AxisOrder { uc: uc::PROGRAMMED | 0x7804, ..programmed(0xFEFF_F600, 1234, 0) });
    for _ in 0..100 {
        plain.advance(plain.now_ns() + 10 * MS);
        odd.advance(odd.now_ns() + 10 * MS);
        assert_eq!((plain.state(), plain.messages()), (odd.state(), odd.messages()));
    }
    assert_eq!((plain.counter(), odd.ack_uc(), odd.ack_bloc()), (1234, 0, 0));
}
