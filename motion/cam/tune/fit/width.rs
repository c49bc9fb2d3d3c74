//! How wide the intervals are: so that they hold the truth in 95 % of all runs, whatever the noise is like.
//!
//! A covariance between that of the normal equations twice (the sandwich): HC3 of `MacKinnon` and White (Journal of
//! Econometrics 29, 1985), which each sample enters with what is left over of it without itself, so that noise may grow with
//! the slope; made larger for correlation from sample to sample (`motion/cam/tune/fit/correlation.rs`), or for rounding, which
//! is correlated by where the slave is (`motion/cam/tune/fit/rounding.rs`); and wider by what noise of the master may have
//! shifted (`motion/cam/tune/fit/growth.rs`).

use super::super::student::student_975;
use super::correlation::{correlations, inflation};
use super::rounding::{noise_before, quantum, shared};
use super::{FEW, Parameters, Problem};
use nalgebra::{DMatrix, DVector};

/// Lags at which covariances are reckoned.
const LAGS: usize = 8;
/// Rounds in which these are corrected by what they say themselves, and by how much at most.
const ROUNDS: usize = 2;
const MOST_TAKEN: f64 = 4.0;
/// Rounding may be more even than chance, but no more than this part of the variance is counted on.
const EVEN: f64 = 0.5;

pub(super) struct Widths {
    /// Of each unknown.
    pub(super) half: Vec<f64>,
    /// As [`super::Fit::quantum`].
    pub(super) quantum: f64,
    /// As [`super::Fit::bias`].
    pub(super) bias: f64,
}

/// What is known of a sample.
struct Known {
    row: DVector<f64>,
    weight: f64,
    /// What is left over of it.
    over: f64,
    /// How much of it the sample itself has made small.
    leverage: f64,
    /// Where the model has the slave.
    position: f64,
    /// Deviation of its noise, up to a common factor.
    deviation: f64,
}

impl Problem<'_> {
    /// `inverse` is that of the normal matrix at `p`.
    pub(super) fn widths(&self, p: Parameters, inverse: &DMatrix<f64>) -> Widths {
        let growth = self.growth(p);
        let known: Vec<Known> = self
            .samples
            .iter()
            .map(|s| {
                let (position, row) = (self.model(p, s.master).0, self.row(p, s));
                let leverage = s.weight * row.dot(&(inverse * &row));
                let grown = growth.map_or(1.0, |g| g.relative(s.weight, self.slope(p, s)));
                let deviation = (grown / s.weight).sqrt();
                let (weight, over) = (s.weight, s.slave - position);
                Known { row, weight, over, leverage, position, deviation }
            })
            .collect();
        let samples = known.len();
        #[expect(clippy::cast_precision_loss, reason = "counts of samples and unknowns")]
        let (freedom, count) = ((samples - self.free.len()) as f64, samples as f64);
        let squares: f64 = known.iter().map(|k| k.weight * k.over * k.over).sum();
        let variance = squares / freedom;
        let weights: f64 = known.iter().map(|k| k.weight).sum();
        let slaves: Vec<f64> = self.samples.iter().map(|s| s.slave).collect();
        let step = quantum(&slaves)
            .and_then(|step| Some((step, noise_before(variance * count / weights, step)?)));
        // What goes on from sample to sample is fitted away by more than independent noise.
        let (mut taken, mut found) = (1.0, Vec::new());
        let rounds = if step.is_some() || samples < FEW { 0 } else { ROUNDS };
        for _ in 0..rounds {
            found = correlations(&covariances(&known, inverse, variance * taken), samples);
            taken = (1.0 + 2.0 * found.iter().sum::<f64>()).clamp(1.0, MOST_TAKEN);
        }
        let correlations = found;
        let shifts = match growth {
            Some(growth) if step.is_none() => self.attenuation(p, inverse, growth.slope),
            _ => vec![0.0; self.free.len()],
        };
        let positions: Vec<f64> = known.iter().map(|k| k.position).collect();
        let mut bias: f64 = 0.0;
        let mut half = Vec::with_capacity(self.free.len());
        for (index, shift) in shifts.iter().enumerate() {
            let way = inverse.column(index).into_owned();
            let shares: Vec<f64> = known.iter().map(|k| k.weight * k.row.dot(&way)).collect();
            let without = |k: &Known| {
                k.over / (1.0 - (taken * k.leverage).min(k.leverage.max(0.5))).max(1e-6)
            };
            let own: f64 =
                shares.iter().zip(&known).map(|(share, k)| (share * without(k)).powi(2)).sum();
            let by_noise: Vec<f64> =
                shares.iter().zip(&known).map(|(share, k)| share * k.deviation).collect();
            // Of few samples that says too little by chance.
            let usual = variance * inverse.get((index, index)).copied().unwrap_or_default();
            let own = if samples < FEW { own.max(usual) } else { own };
            let more = inflation(&by_noise, &correlations);
            let rounded =
                step.map_or(0.0, |(step, noise)| shared(&shares, &positions, step, noise));
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "1 to a count of samples"
            )]
            let free = (freedom / (more * more)).max(1.0) as usize;
            let width =
                student_975(free) * (own * more + rounded).max(own * EVEN).sqrt() + shift.abs();
            if width > 0.0 {
                bias = bias.max(shift.abs() / width);
            }
            half.push(width);
        }
        Widths { half, quantum: step.map_or(0.0, |(step, _)| step), bias }
    }
}

/// Covariances of what is left over, by weight, at the lags 0, 1, …
///
/// Fitting takes s² · Σ h away at each lag, with h from the hat matrix, where the noise is independent: that is added again.
fn covariances(known: &[Known], inverse: &DMatrix<f64>, variance: f64) -> Vec<f64> {
    let mut found = Vec::with_capacity(LAGS + 1);
    for lag in 0..=LAGS {
        let pairs = known.iter().zip(known.iter().skip(lag));
        let sum: f64 = pairs
            .map(|(one, other)| {
                let weight = (one.weight * other.weight).sqrt();
                // Noise that grows is to count alike everywhere.
                let hat = weight * one.row.dot(&(inverse * &other.row));
                weight * one.over * other.over + variance * hat
            })
            .sum();
        found.push(sum);
    }
    found
}
