//! Positions that are rounded: to what, and what that does to a sum of them.
//!
//! What rounding leaves over is no noise: on a dwell it is the same in all samples, and so it is in every turn that comes to
//! the same places. Taken is that the place of the steps is not known. Then errors at positions that are x steps apart have
//! the covariance q²/2 · B₂(x), B₂ = x² − x + 1/6 between 0 and 1, whose Fourier series is q²/(2·π²) · Σ cos(2·π·m·x)/m²
//! (Widrow and Kollár, Quantization Noise, 2008, ch. 5 and 6). Noise before rounding, of deviation s, makes its terms smaller
//! by exp(−(2·π·m·s/q)²), so that beyond a part of a step nothing is left of them.

/// Terms of the series.
const TERMS: i32 = 12;
/// With more noise, in steps, rounding is noise, too.
const HIDDEN: f64 = 0.35;
/// So many decimals are looked at.
const DECIMALS: i32 = 9;
/// So far beside a multiple is the same.
const BESIDE: f64 = 1e-4;

/// The step to whose multiples all values are rounded, if they are; at least two different values.
pub(super) fn quantum(values: &[f64]) -> Option<f64> {
    let first = *values.first()?;
    let size = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    (0..=DECIMALS).find_map(|decimals| {
        let scale = 10_f64.powi(decimals);
        // Beyond that there are no decimals.
        if size * scale > 1e11 {
            return None;
        }
        let mut common: u64 = 0;
        for value in values {
            let scaled = value * scale;
            if (scaled - scaled.round()).abs() > BESIDE {
                return None;
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "whole, and limited above"
            )]
            let steps = (scaled.round() - (first * scale).round()).abs() as u64;
            common = divisor(common, steps);
        }
        #[expect(clippy::cast_precision_loss, reason = "limited above")]
        (common > 0).then(|| common as f64 / scale)
    })
}

fn divisor(mut one: u64, mut other: u64) -> u64 {
    while other != 0 {
        (one, other) = (other, one % other);
    }
    one
}

/// The deviation of the noise before rounding to steps of `quantum`, if it leaves over a variance of `variance` with it and
/// does not hide the steps.
pub(super) fn noise_before(variance: f64, quantum: f64) -> Option<f64> {
    // A tenth is what a variance is known to.
    let noise = (0.9 * variance - quantum * quantum / 12.0).max(0.0).sqrt();
    (noise <= HIDDEN * quantum).then_some(noise)
}

/// What rounding adds to the variance of Σ share · error at these positions beyond errors that are independent; less than 0 where they are
/// more even than by chance.
pub(super) fn shared(shares: &[f64], positions: &[f64], quantum: f64, noise: f64) -> f64 {
    let square: f64 = shares.iter().map(|share| share * share).sum();
    let mut sum = 0.0;
    for term in 1..=TERMS {
        let turn = std::f64::consts::TAU * f64::from(term) / quantum;
        let (mut real, mut other) = (0.0, 0.0);
        for (share, position) in shares.iter().zip(positions) {
            let (sin, cos) = (turn * position).sin_cos();
            real += share * cos;
            other += share * sin;
        }
        let less = (-(turn * noise).powi(2)).exp();
        sum += less * (real * real + other * other - square) / f64::from(term * term);
    }
    quantum * quantum / (2.0 * std::f64::consts::PI.powi(2)) * sum
}

#[cfg(test)]
mod tests {
    use super::{quantum, shared};

    #[test]
    fn steps_are_seen() {
        let of = |values: &[f64]| quantum(values);
        assert_eq!(of(&[0.3, 0.1 + 0.2, 12.7, -4.0]), Some(0.1));
        assert_eq!(of(&[0.05, 1.0, 7.15, 7.2]), Some(0.05));
        assert_eq!(of(&[3.0, 15.0, -9.0]), Some(12.0));
        assert_eq!(of(&[0.087_890_625, 0.263_671_875, 1.757_812_5]), Some(0.087_890_625));
        assert_eq!(of(&[1.234_567_890_123, 2.2, 9.1]), None);
        assert_eq!(of(&[5.0, 5.0]), None);
    }

    /// The mean of n samples at one place has all of q²/12; two places half a step apart have q²/12 · (1 − ½)/2 = q²/48.
    #[test]
    fn covariances_in_closed_form() {
        let q: f64 = 0.2;
        let whole = q * q / 12.0;
        let one = shared(&[0.01; 100], &[3.03; 100], q, 0.0) + whole / 100.0;
        assert!((one / whole - 1.0).abs() < 0.06, "{one} {whole}");
        let places: Vec<_> = (0..100).map(|i| 3.03 + f64::from(i % 2) * q / 2.0).collect();
        let two = shared(&[0.01; 100], &places, q, 0.0) + whole / 100.0;
        assert!((two / (whole / 4.0) - 1.0).abs() < 0.12, "{two} {whole}");
        // Noise of half a step leaves nothing of it.
        assert!(shared(&[0.01; 100], &[3.03; 100], q, 0.1) < 1e-3 * whole);
    }
}
