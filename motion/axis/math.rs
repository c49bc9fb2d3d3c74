//! Auxiliary functions: modulo and arc tangent (manual 2.2.1).

use std::f64::consts::TAU;

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
