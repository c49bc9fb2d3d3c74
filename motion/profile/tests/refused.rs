//! Tests of refused motions and their messages.

use super::*;

const GOOD: AxisLimits =
    AxisLimits { velocity: 10.0, acceleration: 20.0, deceleration: 30.0, jerk: 400.0 };

#[test]
fn numbers_that_are_none() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let ways = |from: State, target: f64, end: f64| {
            Profile::to_position(from, target, end, GOOD, RampType::Trapezoid)
        };
        let rest = State::resting(0.0);
        for refused in [
            ways(State { position: bad, ..rest }, 1.0, 0.0),
            ways(State { velocity: bad, ..rest }, 1.0, 0.0),
            ways(State { acceleration: bad, ..rest }, 1.0, 0.0),
            ways(rest, bad, 0.0),
            ways(rest, 1.0, bad),
            Profile::to_velocity(rest, bad, GOOD, RampType::Trapezoid),
            Profile::halt(State { velocity: bad, ..rest }, GOOD, RampType::Trapezoid),
        ] {
            assert!(matches!(refused, Err(ProfileError::NotFinite { .. })), "{refused:?}");
        }
    }
}

#[test]
fn limits_that_allow_nothing() {
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        for (quantity, limits) in [
            ("velocity", AxisLimits { velocity: bad, ..GOOD }),
            ("acceleration", AxisLimits { acceleration: bad, ..GOOD }),
            ("deceleration", AxisLimits { deceleration: bad, ..GOOD }),
        ] {
            let refused =
                Profile::to_position(State::resting(0.0), 1.0, 0.0, limits, RampType::Trapezoid);
            let Err(ProfileError::NotPositive { quantity: found, .. }) = refused else {
                panic!("{refused:?}");
            };
            assert_eq!(found, quantity);
        }
        // The trapezoid has no use for a jerk, the others cannot do without.
        let limits = AxisLimits { jerk: bad, ..GOOD };
        let ask = |ramp| Profile::to_velocity(State::resting(0.0), 1.0, limits, ramp);
        assert!(ask(RampType::Trapezoid).is_ok());
        for ramp in [RampType::Sigmoid, RampType::Parabolic] {
            assert!(matches!(ask(ramp), Err(ProfileError::NotPositive { quantity: "jerk", .. })));
        }
    }
}

#[test]
fn messages_give_value_and_limit() {
    let fast = Profile::to_velocity(State::resting(0.0), -11.0, GOOD, RampType::Trapezoid);
    let message = fast.map_err(|error| error.to_string()).expect_err("too fast");
    assert_eq!(message, "the velocity at the end is -11 u/s, the largest is 10 u/s");
    let slow = AxisLimits { velocity: 1e-300, ..GOOD };
    let far = Profile::to_position(State::resting(0.0), 1e300, 0.0, slow, RampType::Trapezoid);
    assert_eq!(far, Err(ProfileError::TooLarge { target: 1e300 }));
}
