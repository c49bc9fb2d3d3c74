//! End switches, soft limits, stops, faults.

use super::*;
use crate::{
    Contact,
    protocol::bits::{bloc, message},
};

fn switches() -> Bench {
    let (plus, minus) = (Some(Contact::above(3000, true)), Some(Contact::below(-3000, true)));
    Bench { plus, minus, ..Bench::default() }
}

#[test]
fn a_switch_brakes_with_the_ramp_and_forbids_its_direction() {
    let mut axis = axis(&settings(), &switches());
    axis.order(&programmed(0, 20_000, 0));
    let duration = finish(&mut axis);
    // Full speed after 2475 µsteps in 0.45 s; the counter shows 3000 at 2999.5. The ramp down takes 2475 and 0.45 s.
    close(duration, 0.45 + 524.5e-4 + 0.45, 1e-8);
    assert_eq!((axis.counter(), axis.ack_uc()), (5475, 0));
    assert_eq!(axis.messages(), message::PLUS_SWITCH);
    axis.order(&programmed(0, 6000, 0));
    assert!(!axis.moving());
    axis.order(&simple(uc::MANUAL_PLUS));
    assert!(!axis.moving());
    axis.order(&programmed(0, 0, 0));
    finish(&mut axis);
    assert_eq!((axis.counter(), axis.messages()), (0, 0));
}

#[test]
fn a_brutal_stop_stands_on_the_switch_and_loses_homing() {
    let mut axis = axis(&with(coefficient::BRUTAL_STOP), &switches());
    axis.order(&programmed(bloc::ZERO, 0, 0));
    axis.order(&programmed(0, -20_000, 0));
    finish(&mut axis);
    assert_eq!(axis.counter(), -3000);
    assert_eq!(axis.messages(), message::MINUS_SWITCH | message::HARD_STOPPED);
}

#[test]
fn a_move_to_the_switch_ends_on_it_ignores_limits_and_keeps_homing() {
    for brutal in [0, coefficient::BRUTAL_STOP] {
        let settings = with(brutal | coefficient::HOMING_MANDATORY);
        let settings = AxisSettings { soft_plus: 1000, soft_minus: -1000, ..settings };
        for (order, end, reported) in [
            (uc::TO_PLUS_SWITCH, 3000, message::PLUS_SWITCH | message::PLUS_LIMIT),
            (uc::TO_MINUS_SWITCH, -3000, message::MINUS_SWITCH | message::MINUS_LIMIT),
        ] {
            let mut axis = axis(&settings, &switches());
            axis.order(&programmed(bloc::ZERO, 0, 0));
            axis.order(&simple(order));
            assert_eq!(axis.ack_uc(), order);
            close(finish(&mut axis), 2.9995, 2e-9);
            let hard = if brutal == 0 { 0 } else { message::HARD_STOPPED };
            let ended = reported | message::HOMED | hard;
            assert_eq!((axis.counter(), axis.messages(), axis.ack_uc()), (end, ended, 0));
            axis.order(&simple(order));
            assert!(!axis.moving(), "it is there");
        }
    }
}

#[test]
fn swapped_and_reversed_switches_are_the_other_ones() {
    for (bits, minus_first) in [
        (coefficient::SWAP_SWITCHES, false),
        (coefficient::REVERSE, false),
        (coefficient::SWAP_SWITCHES | coefficient::REVERSE, true),
    ] {
        let mut axis = axis(&with(bits), &switches());
        axis.order(&simple(uc::TO_PLUS_SWITCH));
        axis.advance(3100 * MS);
        // The switch that is met first counts only if it is the one of the direction.
        assert_eq!(!axis.moving(), minus_first, "{bits:04X}");
        let other = if minus_first {
            message::PLUS_SWITCH
        } else {
            message::MINUS_SWITCH | message::MOVING
        };
        assert_eq!(axis.messages(), other);
    }
}

#[test]
fn inputs_that_are_not_wired_are_open() {
    // Opening contacts: an open input is an actuated switch.
    let opening = without(coefficient::SWITCHES_CLOSE);
    let mut axis = axis(&opening, &Bench::default());
    assert_eq!(axis.messages(), message::PLUS_SWITCH | message::MINUS_SWITCH | message::PHASES_OFF);
    axis.order(&programmed(0, 100, 0));
    assert!(!axis.moving());
    let coefficient = opening.coefficient | coefficient::IGNORE_SWITCHES;
    axis.set_settings(&AxisSettings { coefficient, ..opening });
    axis.order(&programmed(0, 100, 0));
    assert!(axis.moving());
}

#[test]
fn soft_limits_brake_after_homing_only() {
    let settings = AxisSettings { soft_plus: 3000, soft_minus: -10, ..settings() };
    let mut axis = axis(&settings, &Bench::default());
    axis.order(&programmed(0, 4000, 0));
    finish(&mut axis);
    assert_eq!((axis.counter(), axis.messages()), (4000, 0));
    axis.order(&programmed(bloc::ZERO, 0, 0));
    axis.order(&programmed(0, 20_000, 0));
    finish(&mut axis);
    assert_eq!((axis.counter(), axis.messages()), (5475, message::HOMED | message::PLUS_LIMIT));
    axis.order(&simple(uc::MANUAL_PLUS));
    assert!(!axis.moving());
    axis.order(&simple(uc::MANUAL_MINUS));
    finish(&mut axis);
    assert_eq!((axis.counter(), axis.messages()), (-10, message::HOMED | message::MINUS_LIMIT));
}

/// An axis that is homed and at full speed since 0.45 s: at 2475 + 5500.
fn at_full_speed() -> Axis {
    let mut axis = usual();
    axis.order(&programmed(bloc::ZERO, 0, 0));
    axis.order(&programmed(0, 20_000, 0));
    axis.advance(1000 * MS);
    axis
}

#[test]
fn abandoning_keeps_the_ramp_and_homing() {
    let mut axis = at_full_speed();
    // The ramp adds 2475.
    axis.order(&simple(uc::ABANDON));
    assert_eq!(axis.ack_uc(), uc::ABANDON);
    close(finish(&mut axis), 0.45, 2e-9);
    assert_eq!((axis.counter(), axis.ack_uc()), (10_450, uc::ABANDON));
    assert_eq!(axis.messages(), message::HOMED);
}

#[test]
fn a_hard_stop_has_no_ramp_and_the_next_move_clears_it() {
    let mut axis = at_full_speed();
    axis.order(&simple(uc::HARD_STOP));
    assert_eq!((axis.counter(), axis.state().velocity.to_bits()), (7975, 0));
    assert_eq!((axis.ack_uc(), axis.messages()), (uc::HARD_STOP, message::HARD_STOPPED));
    axis.order(&programmed(0, 8000, 0));
    assert_eq!((axis.ack_uc(), axis.messages()), (uc::PROGRAMMED, message::MOVING));
}

#[test]
fn power_lost_in_motion_is_a_hard_stop() {
    let mut axis = at_full_speed();
    axis.set_bench(&Bench { power: false, ..Bench::default() });
    assert_eq!((axis.counter(), axis.ack_uc()), (7975, uc::HARD_STOP));
    assert_eq!(axis.messages(), message::HARD_STOPPED | message::POWER_ABSENT);
    axis.order(&programmed(0, 0, 0));
    assert!(!axis.moving());
}

#[test]
fn phase_faults_are_found_by_tests_and_cleared_by_ordered_ones() {
    let broken = Bench { phase_open: true, ..Bench::default() };
    let mut axis = axis(&without(coefficient::NO_MOTOR_TEST), &broken);
    axis.order(&programmed(0, 100, 0));
    assert!(!axis.moving());
    assert_eq!(axis.messages() & message::PHASE_OPEN, message::PHASE_OPEN);
    axis.set_bench(&Bench { phase_short: true, ..Bench::default() });
    axis.order(&simple(uc::MOTOR_TEST));
    assert_eq!((axis.ack_uc(), axis.messages()), (uc::MOTOR_TEST, message::PHASE_SHORT));
    axis.set_bench(&Bench::default());
    axis.order(&programmed(0, 100, 0));
    assert!(!axis.moving(), "repaired, but not tested");
    axis.order(&simple(uc::MOTOR_TEST));
    axis.order(&programmed(0, 100, 0));
    assert_eq!(axis.messages(), message::MOVING);
    // One that appears on the way is found at the end.
    axis.set_bench(&broken);
    finish(&mut axis);
    assert_eq!((axis.counter(), axis.messages()), (100, message::PHASE_OPEN));
}
