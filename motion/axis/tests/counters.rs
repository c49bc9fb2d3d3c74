//! Tests of the auxiliary functions (manual 2.2.1) and of wrapping encoder counters (2.1.4), for any numbers.

use super::*;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

#[test]
fn remainders_are_never_negative_and_never_the_period() {
    let found = [370.0, -10.0, -30.0, 360.0, -720.0, -1e-20].map(|x| fmod(x, 360.0));
    assert_eq!(found, [10.0, 350.0, 330.0, 0.0, 0.0, 0.0]);
}

#[test]
fn angles_cover_the_whole_turn() {
    for (sine, cosine, angle) in [
        (0.0, 1.0, 0.0),
        (2.0, 2.0, FRAC_PI_4),
        (1.0, 0.0, FRAC_PI_2),
        (0.0, -1.0, PI),
        (-1.0, 0.0, 3.0 * FRAC_PI_2),
        (-3.0, 3.0, 7.0 * FRAC_PI_4),
    ] {
        assert!((atan2(sine, cosine) - angle).abs() < 1e-15, "{sine}, {cosine}");
    }
    assert!((0.0..TAU).contains(&atan2(-1e-300, 1.0)));
}

proptest! {
    /// sin(α)·f and cos(α)·f are the given values.
    #[test]
    fn angles_solve_the_manuals_equation(sine in -1e3..1e3, cosine in -1e3..1e3) {
        let factor = f64::hypot(sine, cosine);
        prop_assume!(factor > 1e-3);
        let angle = atan2(sine, cosine);
        prop_assert!((0.0..TAU).contains(&angle));
        prop_assert!((angle.sin() * factor - sine).abs() < 1e-9);
        prop_assert!((angle.cos() * factor - cosine).abs() < 1e-9);
    }

    /// By a counter of 12 bits, 4096 increments a turn, that is read often enough.
    #[test]
    fn a_walk_is_followed(steps in proptest::collection::vec(-2047_i64..2048, 1..200)) {
        let mut counter = encoder(Movement::Rotary { period: 360.0 }, 0x1000, [360, 4096]);
        counter.call(0, None);
        let mut position = 0_i64;
        for step in steps {
            position += step;
            let shown = u32::try_from(position.rem_euclid(0x1000)).unwrap();
            prop_assert!(counter.call(shown, None).valid);
            let turn = f64::from(shown) * 360.0 / 4096.0;
            prop_assert!((counter.axis().act_position() - turn).abs() < 1e-9);
            // The unwound way is the drive's position.
            let whole = counter.axis().last_setpoint().position;
            #[expect(clippy::cast_precision_loss, reason = "small")]
            let expected = position as f64 * 360.0 / 4096.0;
            prop_assert!((whole - expected).abs() < 1e-6, "{} {}", whole, expected);
        }
    }
}
