//! Auxiliary functions: sign, modulo and arc tangent (manual 2.2.1).

use std::f64::consts::TAU;

/// −1, 0 or 1: the sign of `x` (`SMC_sgn`).
#[doc(alias = "SMC_sgn")]
#[must_use]
pub fn sgn(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// `x` modulo the period `m`, in [0, m) (`SMC_fmod`).
#[doc(alias = "SMC_fmod")]
#[must_use]
pub fn fmod(x: f64, m: f64) -> f64 {
    let rest = x.rem_euclid(m);
    // A tiny negative x plus m rounds to m itself.
    if rest < m { rest } else { 0.0 }
}

/// The angle of this sine and cosine, radians in [0, 2π) (`SMC_atan2`).
#[doc(alias = "SMC_atan2")]
#[must_use]
pub fn atan2(sine: f64, cosine: f64) -> f64 {
    fmod(sine.atan2(cosine), TAU)
}
