//! "Modules auxiliaires mathématiques" (2.2.1).

use std::f64::consts::TAU;

/// `SMC_sgn`: −1, 0 or 1. 0 for what is no number.
pub fn sgn(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// `SMC_fmod`: `x` modulo `m`, always in [0, m[. `None` if `x` is not finite or `m` not finite and above 0.
pub fn fmod(x: f64, m: f64) -> Option<f64> {
    if !x.is_finite() || !m.is_finite() || m <= 0.0 {
        return None;
    }
    let rest = x.rem_euclid(m);
    // A little below 0 is a little below m, which rounds to m.
    Some(if rest >= m { m.next_down() } else { rest + 0.0 })
}

/// `SMC_atan2`: the angle, rad in [0, 2π[, whose sine and cosine are in the same ratio as these and of the same signs.
/// The manual prints [0; 2π]; 2π is 0. `None` if both are 0 or one is not finite.
pub fn atan2(sine: f64, cosine: f64) -> Option<f64> {
    let angle = sine.atan2(cosine);
    if !sine.is_finite() || !cosine.is_finite() || (sgn(sine), sgn(cosine)) == (0, 0) {
        return None;
    }
    fmod(angle, TAU)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn signs() {
        assert_eq!([-3.0, -0.0, 0.0, 1e-300, f64::NAN].map(sgn), [-1, 0, 0, 1, 0]);
    }

    #[test]
    fn remainders_are_never_negative_and_never_the_period() {
        let cases = [
            (370.0, 360.0, 10.0),
            (-10.0, 360.0, 350.0),
            (360.0, 360.0, 0.0),
            (-720.0, 360.0, 0.0),
        ];
        for (x, m, expected) in cases {
            let found = fmod(x, m).unwrap();
            assert!((found - expected).abs() < 1e-12 && found.is_sign_positive(), "{x}: {found}");
        }
        let below = fmod(-1e-20, 360.0).unwrap();
        assert!(below < 360.0 && below > 359.999, "{below}");
        for (x, m) in [(1.0, 0.0), (1.0, -5.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
            assert_eq!(fmod(x, m), None);
        }
    }

    #[test]
    fn angles_cover_the_whole_turn() {
        let cases = [
            (0.0, 1.0, 0.0),
            (2.0, 2.0, FRAC_PI_4),
            (1.0, 0.0, FRAC_PI_2),
            (0.0, -1.0, PI),
            (-1.0, 0.0, 3.0 * FRAC_PI_2),
            (-3.0, 3.0, 7.0 * FRAC_PI_4),
        ];
        for (sine, cosine, expected) in cases {
            let found = atan2(sine, cosine).unwrap();
            assert!((found - expected).abs() < 1e-12, "{sine}, {cosine}: {found}");
        }
        assert_eq!(atan2(-0.0, 1.0), Some(0.0));
        assert!(atan2(-1e-300, 1.0).unwrap() < TAU);
        assert_eq!((atan2(0.0, 0.0), atan2(f64::NAN, 1.0)), (None, None));
    }

    proptest! {
        /// sin(α)·f and cos(α)·f are what was given.
        #[test]
        fn angles_solve_the_manuals_equation(sine in -1e3..1e3, cosine in -1e3..1e3) {
            let factor = f64::hypot(sine, cosine);
            prop_assume!(factor > 1e-3);
            let angle = atan2(sine, cosine).unwrap();
            prop_assert!((0.0..TAU).contains(&angle));
            prop_assert!((angle.sin() * factor - sine).abs() < 1e-9);
            prop_assert!((angle.cos() * factor - cosine).abs() < 1e-9);
        }
    }
}
