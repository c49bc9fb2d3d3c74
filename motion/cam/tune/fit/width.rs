//! How wide the intervals are: so that they hold the truth in 95 % of all runs, whatever the noise is like.
//!
//! A covariance between that of the normal equations twice (the sandwich): HC3 of `MacKinnon` and White (Journal of
//! Econometrics 29, 1985), which each sample enters with what is left over of it without itself, so that noise may grow with
//! the slope; made larger for correlation from sample to sample (`motion/cam/tune/fit/correlation.rs`) and for rounding, which
//! is correlated by where the slave is (`motion/cam/tune/fit/rounding.rs`); and wider by what noise of the master may have
//! shifted (`motion/cam/tune/fit/growth.rs`).

use super::super::student::student_975;
use super::correlation::inflation;
use super::over::{Known, Over};
use super::{FEW, Parameters, Problem};
use nalgebra::DMatrix;

/// Rounding may be more even than chance, but no more than this part of the variance is counted on.
const EVEN: f64 = 0.5;

pub(super) struct Widths {
    /// Of each unknown.
    pub(super) half: Vec<f64>,
    /// As [`super::Fit::bias`].
    pub(super) bias: f64,
}

impl Problem<'_> {
    /// `inverse` is that of the normal matrix at `p`.
    pub(super) fn widths(&self, p: Parameters, inverse: &DMatrix<f64>, over: &Over) -> Widths {
        let Over { known, growth, correlations, first, taken, rounded, .. } = over;
        let samples = known.len();
        #[expect(clippy::cast_precision_loss, reason = "counts of samples and unknowns")]
        let freedom = (samples - self.free.len()) as f64;
        let squares: f64 = known.iter().map(|k| k.weight * k.over * k.over).sum();
        let weights: f64 = known.iter().map(|k| k.weight).sum();
        // Rounding has at least this, what fitting has taken of it included.
        let rounding = rounded.as_ref().map_or(0.0, |(step, _)| step * step / 12.0);
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let variance = (squares / freedom).max(rounding * weights / samples as f64);
        let shifts = match growth {
            Some(growth) => self.attenuation(p, inverse, growth.slope),
            None => vec![0.0; self.free.len()],
        };
        let mut bias: f64 = 0.0;
        let mut half = Vec::with_capacity(self.free.len());
        for (index, shift) in shifts.iter().enumerate() {
            let shares = || known.iter().map(|k| k.share.get(index).copied().unwrap_or_default());
            let without = |k: &Known| {
                k.over / (1.0 - (taken * k.leverage).min(k.leverage.max(0.5))).max(1e-6)
            };
            let square: f64 = shares().map(|share| share * share).sum();
            let own: f64 = shares().zip(known).map(|(share, k)| (share * without(k)).powi(2)).sum();
            let by_noise: Vec<f64> =
                shares().zip(known).map(|(share, k)| share * k.deviation).collect();
            // Of few samples that says too little by chance.
            let usual = variance * inverse.get((index, index)).copied().unwrap_or_default();
            let own = if samples < FEW { own.max(usual) } else { own };
            let own = own.max(rounding * square);
            let more = inflation(&by_noise, correlations).max(inflation(&by_noise, first));
            // What rounding adds beyond errors that are independent.
            let shared = rounded.as_ref().map_or(0.0, |(_, tried)| {
                tried.variances.get(index).copied().unwrap_or_default() - rounding * square
            });
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "1 to a count of samples"
            )]
            let free = (freedom / (more * more)).max(1.0) as usize;
            let width =
                student_975(free) * (own * more + shared).max(own * EVEN).sqrt() + shift.abs();
            if width > 0.0 {
                bias = bias.max(shift.abs() / width);
            }
            half.push(width);
        }
        Widths { half, bias }
    }
}
