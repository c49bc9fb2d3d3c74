//! Angles and their sines, without a call.
//!
//! The library's `atan2` is as exact as can be and takes most of the time of a SCARA's transform. This one is within three units in
//! the last place of it and is a straight run of arithmetic that overlaps with what is around it.
//!
//! With a the smaller and b the larger of |x| and |y|, a/b is the tangent of an angle up to 45°, and
//! (a − b)/(a + b) that of the angle less 45°, so one of the two lies within tan 22.5° of 0. There
//! atan z = z + z³·P(z²) with the polynomial P of degree 10 that meets (atan z / z − 1)/z² at the eleven Chebyshev nodes
//! of 0 ≤ z² ≤ tan² 22.5°; it is off by less than 5·10⁻¹⁸ of z.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI};

/// tan 22.5°.
const STEEP: f64 = 0.414_213_562_373_095_03;
/// What π/4 has beyond its 53 bits; π/2 and π have twice and four times that.
const FRAC_PI_4_LOW: f64 = 3.061_616_997_868_383e-17;
/// Beyond these a sum might overflow, or a quotient lose its digits.
const ORDINARY: std::ops::Range<f64> = 1e-290..1e290;

/// From the constant term up.
const P: [f64; 11] = [
    -0.333_333_333_333_333_3,
    0.199_999_999_999_955_2,
    -0.142_857_142_846_665_42,
    0.111_111_110_152_563_61,
    -0.090_909_045_781_239_03,
    0.076_921_831_908_260_87,
    -0.066_645_114_473_819_48,
    0.058_581_489_128_022_1,
    -0.050_854_497_379_402_6,
    0.039_231_658_295_587_19,
    -0.019_176_887_119_062_26,
];

/// The angle of (x, y) from +x, −π to π, as `y.atan2(x)` has it.
#[inline]
pub(crate) fn angle(y: f64, x: f64) -> f64 {
    let (width, height) = (x.abs(), y.abs());
    let (small, large) = (width.min(height), width.max(height));
    // Also for what is not a number, which the minimum leaves out.
    if !ORDINARY.contains(&(width + height)) {
        return y.atan2(x);
    }
    // Poses come from everywhere: numbers that are 0 or 1 cost less than branches that nobody can foresee.
    let [steep, upright, back] =
        [small > STEEP * large, height > width, x < 0.0].map(|is| f64::from(u8::from(is)));
    let (over, under) = (small - steep * large, large + steep * small);
    let z = over / under;
    let t = z * z;
    let (t2, t4) = (t * t, t * t * (t * t));
    let pair = |low: f64, high: f64| low + high * t;
    let [p0, p1, p2, p3, p4, p5, p6, p7, p8, p9, p10] = P;
    let low = pair(p0, p1) + pair(p2, p3) * t2;
    let middle = pair(p4, p5) + pair(p6, p7) * t2;
    let high = pair(p8, p9) + p10 * t2;
    let turn = z * t * (low + (middle + high * t4) * t4) + z;
    let first = steep * FRAC_PI_4 + (turn + steep * FRAC_PI_4_LOW);
    let quarter =
        upright * FRAC_PI_2 + ((1.0 - 2.0 * upright) * first + upright * (2.0 * FRAC_PI_4_LOW));
    let half = back * PI + ((1.0 - 2.0 * back) * quarter + back * (4.0 * FRAC_PI_4_LOW));
    half.copysign(y)
}

/// ∓1/n! for odd n from 3.
const SINE: [f64; 8] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];
/// ∓1/n! for even n from 2.
const COSINE: [f64; 8] = [
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// Half of π in three parts; the first two have 33 bits, so that a multiple of them by less than 2²⁰ is exact.
const HALF_TURNS: [f64; 3] =
    [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// 1.5·2⁵².
const ROUNDS: f64 = 6_755_399_441_055_744.0;

/// Sine and cosine of an angle (rad), within 2⁻⁵¹: a quarter turn to the nearest of four directions, and the series from there.
#[inline]
pub(crate) fn sin_cos(angle: f64) -> (f64, f64) {
    // Beyond a million quarter turns, and for what is not a number.
    if angle.abs() > 1e6 || angle.is_nan() {
        return angle.sin_cos();
    }
    // Numbers of this size have no places after the point, so adding it rounds; the last two bits are the quarter.
    let shifted = angle * FRAC_2_PI + ROUNDS;
    let (quarters, bits) = (shifted - ROUNDS, shifted.to_bits());
    let [first, second, third] = HALF_TURNS;
    let r = angle - quarters * first - quarters * second - quarters * third;
    let t = r * r;
    let (t2, t4) = (t * t, t * t * (t * t));
    // 1/3!, 1/5! … and 1/2!, 1/4! … with their signs: |r| ≤ 45°, so what follows is below 10⁻¹⁷.
    let [s3, s5, s7, s9, s11, s13, s15, s17] = SINE;
    let sine = (s3 + s5 * t + (s7 + s9 * t) * t2) + (s11 + s13 * t + (s15 + s17 * t) * t2) * t4;
    let sine = r + r * t * sine;
    let [c2, c4, c6, c8, c10, c12, c14, c16] = COSINE;
    let cosine = (c2 + c4 * t + (c6 + c8 * t) * t2) + (c10 + c12 * t + (c14 + c16 * t) * t2) * t4;
    let cosine = 1.0 + t * cosine;
    let [odd, down, back] = [bits & 1, (bits >> 1) & 1, (bits ^ (bits >> 1)) & 1]
        .map(|bit| if bit == 1 { 1.0 } else { 0.0 });
    let (up, along) = (sine + odd * (cosine - sine), cosine + odd * (sine - cosine));
    (up * (1.0 - 2.0 * down), along * (1.0 - 2.0 * back))
}

#[cfg(test)]
mod tests {
    use super::{angle, sin_cos};
    use crate::tests::seeded;
    use proptest::prelude::*;

    fn agrees(y: f64, x: f64) {
        let (found, expected) = (angle(y, x), y.atan2(x));
        assert!(
            (found - expected).abs() <= 3.0 * f64::EPSILON * expected.abs(),
            "({x:e}, {y:e}): {found:e} {expected:e}"
        );
        assert_eq!(found.is_sign_negative(), expected.is_sign_negative(), "({x:e}, {y:e})");
    }

    #[test]
    fn corners() {
        let values = [
            0.0,
            1e-300,
            1e-20,
            1e-8,
            0.414_213_562_373_095,
            0.414_213_562_373_095_1,
            0.5,
            1.0,
            1.0 + 1e-15,
            2.0,
            1e8,
            1e300,
            f64::MIN_POSITIVE,
            f64::MAX,
            f64::INFINITY,
        ];
        for (x, y) in values.iter().flat_map(|x| values.iter().map(move |y| (*x, *y))) {
            for (x, y) in [(x, y), (-x, y), (x, -y), (-x, -y)] {
                agrees(y, x);
            }
        }
        assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(f64::INFINITY).1.is_nan());
        assert!(angle(f64::NAN, 1.0).is_nan() && angle(1.0, f64::NAN).is_nan());
    }

    proptest! {
        #![proptest_config(seeded())]

        #[test]
        fn it_is_the_librarys(turn in -3.2..3.2, size in -200.0..200.0) {
            let (sin, cos) = f64::sin_cos(turn);
            let size = 10_f64.powf(size);
            agrees(sin * size, cos * size);
        }

        #[test]
        fn sines_are_the_librarys(angle in prop_oneof![-7.0..7.0, -2e6..2e6], quarters in -9..9) {
            for angle in [angle, f64::from(quarters) * std::f64::consts::FRAC_PI_2] {
                let ((sin, cos), (expected_sin, expected_cos)) = (sin_cos(angle), angle.sin_cos());
                prop_assert!((sin - expected_sin).abs() <= 2.0 * f64::EPSILON, "{angle}: {sin} {expected_sin}");
                prop_assert!((cos - expected_cos).abs() <= 2.0 * f64::EPSILON, "{angle}: {cos} {expected_cos}");
            }
        }

        #[test]
        fn of_any_numbers(y in any::<f64>(), x in any::<f64>()) {
            agrees(y, x);
        }
    }
}
