//! Programmed moves: durations, speeds, references, approach.

use super::*;
use crate::protocol::bits::{bloc, message};

/// Duration of a way d at v with ramps from u: d/v + (v − u)²/(a·v).
fn trapezoid(way: f64, speed: f64, start_stop: f64, rate: f64) -> f64 {
    way / speed + (speed - start_stop).powi(2) / (rate * speed)
}

#[test]
fn an_absolute_move_at_the_fast_speed_has_the_duration_of_its_trapezoid() {
    let mut axis = usual();
    axis.set_settings(&with(coefficient::IGNORE_SWITCHES));
    axis.order(&programmed(0, 20_000, 3));
    assert_eq!((axis.ack_uc(), axis.messages()), (uc::PROGRAMMED, message::MOVING));
    // 2 s at 10000 µsteps/s and 0.405 s for the ramps.
    close(finish(&mut axis), 2.405, 2e-9);
    assert_eq!((axis.counter(), axis.ack_uc(), axis.messages()), (20_000, 0, 0));
    assert_eq!(axis.stored(), 20_000);
}

#[test]
fn the_ramp_goes_from_the_start_stop_speed() {
    let mut axis = usual();
    axis.order(&programmed(0, -20_000, 0));
    for (time_ns, position, velocity) in [
        (1, 0.0, -1000.0),
        (100 * MS, -200.0, -3000.0),
        // 0.45 s of ramp over (10000² − 1000²)/(2 · 20000) = 2475 µsteps.
        (450 * MS, -2475.0, -10_000.0),
        (1450 * MS, -12_475.0, -10_000.0),
    ] {
        axis.advance(time_ns);
        close(axis.state().position, position, 1e-4);
        close(axis.state().velocity, velocity, 1e-4);
    }
}

#[test]
fn a_way_too_short_for_the_speed_is_a_triangle() {
    let mut axis = usual();
    axis.order(&programmed(0, 750, 0));
    // Peak² = 1000² + 20000 · 750 = 4000²; up and down 0.15 s each.
    close(finish(&mut axis), 0.3, 2e-9);
}

#[test]
fn a_relative_move_at_a_programmed_speed() {
    // 6.4.1: 400 relative from 1000 at 200 ends at $578; the bit of the legacy acceleration changes nothing.
    for legacy in [0, 0x200] {
        let mut axis = usual();
        axis.order(&programmed(0, 1000, 0));
        finish(&mut axis);
        axis.order(&programmed(bloc::RELATIVE | bloc::PROGRAMMED_SPEED | legacy, 400, 200));
        // Below the start-stop speed there is no ramp.
        close(finish(&mut axis), 2.0, 2e-9);
        assert_eq!(axis.counter(), 0x578);
    }
}

#[test]
fn speeds_are_capped_by_the_fast_speed_and_in_the_unit_of_the_mode() {
    let per_step = AxisSettings {
        mode: DriveMode::from_code(0x0600).unwrap(),
        start_stop_speed: 100,
        fast_speed: 500,
        acceleration: 1000,
        ..settings()
    };
    for (programmed_speed, steps_per_s) in [(250, 250.0), (65_535, 500.0), (0, 1.0)] {
        let mut axis = axis(&per_step, &Bench::default());
        axis.order(&programmed(bloc::PROGRAMMED_SPEED, 64_000, programmed_speed));
        let start_stop = 100.0_f64.min(steps_per_s);
        close(finish(&mut axis), trapezoid(1000.0, steps_per_s, start_stop, 1000.0), 1e-6);
    }
}

#[test]
fn reference_positions_are_absolute_and_acknowledged_at_the_end() {
    let mut references = [0; 10];
    references[4] = -700;
    let settings = AxisSettings { references, ..settings() };
    let mut axis = axis(&settings, &Bench::default());
    axis.order(&programmed(5, 99, 0));
    assert_eq!((axis.ack_uc(), axis.ack_bloc()), (uc::PROGRAMMED, 0));
    finish(&mut axis);
    // 6.1.1: zone Acquittement holds 0 and 5 at the end.
    assert_eq!((axis.counter(), axis.ack_uc(), axis.ack_bloc()), (-700, 0, 5));
    for number in 11..=15 {
        axis.order(&programmed(number, 0, 0));
        assert_eq!((axis.moving(), axis.ack_bloc()), (false, bloc::BAD_REFERENCE));
    }
}

/// Start is 0; the lowest and the highest place on the way.
#[test]
fn moves_against_the_approach_overshoot_and_return() {
    let plus = coefficient::APPROACH_PLUS;
    for (sense, bloc, target, lowest, highest) in [
        (plus, 0, 500, 0, 500),
        (plus, 0, -500, -564, 0),
        (plus, bloc::WITHOUT_APPROACH, -500, -500, 0),
        (0, 0, 500, 0, 564),
        (0, 0, -500, -500, 0),
    ] {
        let settings = AxisSettings { approach: 64, ..with(coefficient::APPROACH | sense) };
        let mut axis = axis(&settings, &Bench::default());
        axis.order(&programmed(bloc, target, 0));
        let (mut low, mut high) = (0, 0);
        while axis.moving() {
            axis.advance(axis.now_ns() + MS);
            (low, high) = (low.min(axis.counter()), high.max(axis.counter()));
        }
        let found = (axis.counter(), low, high);
        assert_eq!(found, (target, lowest, highest), "{sense:04X} {bloc:X}");
    }
}

#[test]
fn zero_and_force_declare_the_position_without_motion() {
    let mut axis = usual();
    axis.order(&programmed(0, 2000, 0));
    finish(&mut axis);
    axis.order(&programmed(bloc::ZERO, 0, 0));
    // 6.2.1
    assert_eq!((axis.counter(), axis.messages()), (0, message::HOMED));
    assert_eq!((axis.ack_uc(), axis.ack_bloc()), (0, 0x10));
    axis.order(&programmed(bloc::FORCE, 77, 0));
    // 6.3.1: the last stored position is $7D0.
    assert_eq!((axis.counter(), axis.ack_bloc()), (0x7D0, 0x20));
    axis.order(&programmed(bloc::FORCE | bloc::PRESET, 12_345, 0));
    assert_eq!((axis.counter(), axis.shaft()), (12_345, 2000));
    axis.order(&programmed(bloc::FORCE | bloc::PRESET, 0xC0DE, 0));
    assert_eq!((axis.counter(), axis.messages() & message::REFUSED), (12_345, message::REFUSED));
}

#[test]
fn when_time_is_looked_at_does_not_matter() {
    let mut once = usual();
    once.order(&programmed(0, 5000, 4321));
    let mut often = once;
    for _ in 0..1000 {
        often.advance(often.now_ns() + 777_777);
    }
    once.advance(often.now_ns());
    assert_eq!(once.state(), often.state());
}
