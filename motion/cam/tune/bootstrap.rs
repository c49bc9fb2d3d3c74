//! Moving-block bootstrap: 95 % intervals of a fit.
//!
//! Residuals are divided by their scale and whitened as noise of the first order; blocks of the innovations are drawn anew,
//! coloured again and led through the fit, which is linear at its optimum (Künsch, Annals of Statistics 17, 1989; whitened
//! first, as in Andrews and Monahan, Econometrica 60, 1992). Variance and correlation of the noise are known from the samples only,
//! so each replicate draws its own. Rounded positions are rounded again in each replicate, as noise and quantum leave them.

use super::fit::{Fit, Problem};
use super::residuals::Residual;
use nalgebra::Vector4;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{ChiSquared, Distribution, StandardNormal, Uniform};

/// Replicates of an interval, and of an estimate of what rounding leaves over.
const REPLICATES: usize = 799;
const FEW: usize = 48;
/// The quantile of |error| that is the half width.
const INSIDE: f64 = 0.95;
/// The strongest correlation of noise.
const STRONGEST: f64 = 0.95;
/// The estimate of a correlation is too small by this part over the number of samples (Marriott and Pope, Biometrika 41, 1954).
const BIAS: f64 = 4.0;
/// Width grows faster than correlation. Replicates therefore draw correlations that scatter by this many standard errors, and lie above
/// the estimate by this part over the number of samples.
const SPREAD: f64 = 1.25;
const ABOVE: f64 = 3.5;
/// The fit takes away up to this many times more of correlated noise than of white noise.
const MOST_TAKEN: f64 = 4.0;
/// Noise of more than this part of a quantum makes rounding part of the noise; up to the smaller part the quantum is reported.
const HIDDEN: f64 = 0.5;
const TOLD: f64 = 0.35;
/// Noise is certain beyond this many deviations of what rounding leaves over, and so is its correlation.
const CERTAIN: f64 = 1.4;
const CERTAIN_PRODUCTS: f64 = 5.0;
/// A sum of products of noise above rounding is divided by at least this part of the squares, times 1/√n.
const STANDS_OUT: f64 = 7.0;

/// Intervals, and what the residuals show of noise and rounding.
#[derive(Debug)]
pub(super) struct Bootstrap {
    /// Half widths.
    pub(super) half: [f64; 4],
    /// Correlation of the noise from sample to sample, beyond what rounding explains.
    pub(super) correlation: f64,
    /// Quantum that noise does not hide; 0 without one.
    pub(super) quantum: f64,
}

/// Noise before rounding: its variance as a part of the squared scales, the part of it that is certain to be there when positions
/// are rounded, and its correlation from sample to sample.
#[derive(Clone, Copy, Debug)]
struct Noise {
    variance: f64,
    dither: f64,
    correlation: f64,
}

/// What replicates come to.
#[derive(Default)]
struct Replicates {
    errors: Vec<Vector4<f64>>,
    /// Sum of the squares of the scaled residuals, and of their products with the next one: each with its mean and deviation.
    squares: [f64; 2],
    products: [f64; 2],
}

struct Sampler<'a> {
    residuals: &'a [Residual],
    free: [bool; 4],
    freedom: f64,
    /// Whitened residuals of mean 0 and variance 1.
    innovations: Vec<f64>,
}

#[expect(clippy::cast_precision_loss, reason = "a count of samples")]
fn count(samples: usize) -> f64 {
    samples as f64
}

/// Length of the blocks.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the cube root of a count"
)]
fn block(samples: usize) -> usize {
    count(samples).cbrt().round() as usize
}

impl Bootstrap {
    pub(super) fn new(problem: &Problem<'_>, residuals: &[Residual], step: Option<f64>) -> Self {
        let mut sampler = Sampler::new(problem, residuals);
        let noise = sampler.whitened();
        if let Some(found) = step.and_then(|step| sampler.rounded(step, noise.correlation)) {
            return found;
        }
        let scaled: Vec<f64> = residuals.iter().map(|r| r.value / r.scale).collect();
        let square = sum_products(&scaled, 0);
        let correlation = if square > 0.0 { sum_products(&scaled, 1) / square } else { 0.0 };
        let half = sampler.replicates(noise, None, REPLICATES).half();
        Self { half, correlation, quantum: 0.0 }
    }
}

/// Σ vᵢ·vᵢ₊ₗ.
fn sum_products(values: &[f64], lag: usize) -> f64 {
    values.iter().zip(values.iter().skip(lag)).map(|(a, b)| a * b).sum()
}

impl<'a> Sampler<'a> {
    fn new(problem: &Problem<'_>, residuals: &'a [Residual]) -> Self {
        let freedom = count(residuals.len() - problem.unknowns());
        Self { residuals, free: problem.free, freedom, innovations: Vec::new() }
    }

    /// Whitens the residuals; what the fit has taken away of squares and of products of neighbours is added again.
    fn whitened(&mut self) -> Noise {
        let n = count(self.residuals.len());
        let scaled: Vec<f64> = self.residuals.iter().map(|r| r.value / r.scale).collect();
        let [square, product] = [0, 1].map(|lag| sum_products(&scaled, lag));
        let [hat, next] = [0, 1].map(|lag| self.hat(lag));
        let (mut correlation, mut taken) = (0.0, 1.0);
        if self.residuals.len() >= Fit::SAMPLES && square > 0.0 {
            for _ in 0..2 {
                let variance = square / self.freedom * taken;
                correlation = (product + variance * next) / (square + variance * hat);
                correlation = (correlation * (1.0 + BIAS / n)).clamp(0.0, STRONGEST);
                taken = ((1.0 + correlation) / (1.0 - correlation)).clamp(1.0, MOST_TAKEN);
            }
        }
        let own = |r: &Residual| {
            let leverage = r.share.dot(&r.row);
            let free = 1.0 - (taken * leverage).min(leverage.max(0.5));
            r.value / r.scale / free.max(1e-6).sqrt()
        };
        let whole: Vec<f64> = self.residuals.iter().map(own).collect();
        let variance = sum_products(&whole, 0) / n;
        let before = std::iter::once(0.0).chain(whole.iter().copied());
        let mut innovations: Vec<f64> =
            whole.iter().zip(before).map(|(now, before)| now - correlation * before).collect();
        let mean = innovations.iter().sum::<f64>() / n;
        for value in &mut innovations {
            *value -= mean;
        }
        // Residuals of neighbours lack what the fit has taken away of both, and so do blocks of them.
        let length = count(block(self.residuals.len()));
        let lost = |lag: usize| 2.0 * (1.0 - count(lag) / length) * self.hat(lag) / n;
        let lost: f64 = (1..block(self.residuals.len())).map(lost).sum();
        let size = (sum_products(&innovations, 0) / n * (1.0 - lost).clamp(0.5, 1.0)).sqrt();
        let size = size.max(f64::MIN_POSITIVE);
        for value in &mut innovations {
            *value /= size;
        }
        self.innovations = innovations;
        Noise { variance, dither: 1.0, correlation }
    }

    /// Sum of the hat matrix at a lag: how much of white noise the fit takes away there.
    fn hat(&self, lag: usize) -> f64 {
        let pairs = self.residuals.iter().zip(self.residuals.iter().skip(lag));
        pairs.map(|(one, other)| one.share.dot(&other.row) * one.scale / other.scale).sum()
    }

    /// Intervals of rounded positions; none if noise hides the quantum.
    fn rounded(&self, step: f64, correlation: f64) -> Option<Bootstrap> {
        let n = count(self.residuals.len());
        let scaled: Vec<f64> = self.residuals.iter().map(|r| r.value / r.scale).collect();
        let [square, product] = [0, 1].map(|lag| sum_products(&scaled, lag));
        let [hat, next] = [n - self.freedom, self.hat(1)];
        let mut noise = Noise { variance: 0.0, dither: 0.0, correlation: 0.0 };
        let mut left = 0.0;
        // What rounding leaves over depends on the noise, so noise is estimated twice. Noise makes the errors of rounding less alike,
        // so only as much of it counts there as is certain.
        for round in 0..2 {
            let tried = self.replicates(noise, Some(step), FEW);
            let variance = noise.variance;
            let of_noise = (square - tried.squares[0]) / self.freedom + variance;
            let least = (square * (STANDS_OUT / n.sqrt()).min(1.0)).max(f64::MIN_POSITIVE);
            if round > 0 {
                let excess = product - tried.products[0];
                let share = excess + variance.max(of_noise.max(0.0)) * next;
                noise.correlation = (share / (of_noise * (n - hat)).max(least) * (1.0 + BIAS / n))
                    .clamp(0.0, STRONGEST.min(correlation.max(0.9)));
                if excess > CERTAIN_PRODUCTS * tried.products[1] {
                    // Less what noise and rounding together have by chance.
                    let by_chance = CERTAIN * square / n.sqrt();
                    left = (excess - by_chance).max(0.0) / (of_noise * self.freedom).max(least);
                }
            }
            noise.variance = of_noise.max(0.0);
            let certain = (of_noise - CERTAIN * tried.squares[1] / self.freedom).max(0.0);
            noise.dither = (certain / noise.variance.max(f64::MIN_POSITIVE)).sqrt();
        }
        let least = self.deviations(noise, Some(step)).into_iter().fold(f64::INFINITY, f64::min);
        let hidden = least * noise.dither / step;
        if hidden > HIDDEN {
            return None;
        }
        Some(Bootstrap {
            half: self.replicates(noise, Some(step), REPLICATES).half(),
            correlation: left,
            quantum: if hidden <= TOLD { step } else { 0.0 },
        })
    }

    /// Deviation of the noise of each sample: of rounded positions what their scale has beyond rounding.
    fn deviations(&self, noise: Noise, step: Option<f64>) -> Vec<f64> {
        let rounding = step.map_or(0.0, |step| step * step / 12.0);
        let mean: f64 = self.residuals.iter().map(|r| rounding / (r.scale * r.scale)).sum();
        let variance = noise.variance + mean / count(self.residuals.len());
        let own = |r: &Residual| (variance * r.scale * r.scale - rounding).max(0.0).sqrt();
        // Without noise the scales differ by rounding alone.
        self.residuals.iter().map(|r| if noise.variance > 0.0 { own(r) } else { 0.0 }).collect()
    }

    /// Draws runs with such noise, rounded to a step if there is one, and fits each.
    fn replicates(&self, noise: Noise, step: Option<f64>, replicates: usize) -> Replicates {
        let mut random = ChaCha8Rng::seed_from_u64(20_040_117);
        let samples = self.residuals.len();
        let n = count(samples);
        let block = block(samples);
        let deviations = self.deviations(noise, step);
        let rho = noise.correlation;
        let freedom = self.freedom * (1.0 - rho * rho) / (1.0 + rho * rho);
        let (Ok(variance), Ok(place), Ok(begins)) =
            (ChiSquared::new(freedom.max(1.0)), Uniform::new(-0.5, 0.5), Uniform::new(0, samples))
        else {
            return Replicates::default();
        };
        let spread = SPREAD * ((1.0 - rho * rho) / n).sqrt();
        let above = ABOVE * rho / n;
        let anchor = self.residuals.first().map_or(0.0, |r| r.position + r.value);
        // Changes of the unknowns that move positions by about a quantum.
        let sizes = Vector4::from_fn(|index, _| {
            let square: f64 = self.residuals.iter().map(|r| r.row[index].powi(2)).sum();
            if self.free[index] { (square / n).sqrt().recip() } else { 0.0 }
        });
        let mut found = Replicates::default();
        let mut sums = [[0.0; 2]; 2];
        let mut errors = vec![0.0; samples];
        for _ in 0..replicates {
            let by: f64 = StandardNormal.sample(&mut random);
            let known = samples >= Fit::SAMPLES;
            let rho = if known { (rho + above + spread * by).clamp(0.0, STRONGEST) } else { rho };
            let size = (freedom.max(1.0) / variance.sample(&mut random)).sqrt();
            let moved = step.map(|step| {
                let part = if self.free[2] { 1.0 } else { 2.0 };
                let drawn = Vector4::from_fn(|_, _| place.sample(&mut random));
                drawn.component_mul(&sizes) * (step * part)
            });
            let fresh = (1.0 - rho * rho).sqrt();
            let mut from = begins.sample(&mut random);
            let mut coloured = self.innovations[from];
            let mut error = Vector4::zeros();
            let samples_of = self.residuals.iter().zip(&deviations).zip(&mut errors);
            for (index, ((r, deviation), slot)) in samples_of.enumerate() {
                if index % block == 0 {
                    from = begins.sample(&mut random);
                }
                coloured = rho * coloured + fresh * self.innovations[from];
                from = if from + 1 == samples { 0 } else { from + 1 };
                let mut value = deviation * size * coloured;
                if let (Some(step), Some(moved)) = (step, &moved) {
                    let position = r.position + r.row.dot(moved);
                    let dithered = position + noise.dither * value - anchor;
                    value +=
                        anchor + (dithered / step).round() * step - position - noise.dither * value;
                }
                error += r.share * value;
                *slot = value;
            }
            if replicates <= FEW {
                self.add_residuals(&errors, error, &mut sums);
            }
            found.errors.push(error);
        }
        let count = count(replicates);
        for (slot, [sum, squares]) in
            [&mut found.squares, &mut found.products].into_iter().zip(sums)
        {
            *slot = [sum / count, (squares / count - (sum / count).powi(2)).max(0.0).sqrt()];
        }
        found
    }

    fn add_residuals(&self, errors: &[f64], error: Vector4<f64>, sums: &mut [[f64; 2]; 2]) {
        let left =
            self.residuals.iter().zip(errors).map(|(r, e)| (e - r.row.dot(&error)) / r.scale);
        let left: Vec<f64> = left.collect();
        for (lag, [sum, squares]) in sums.iter_mut().enumerate() {
            let value = sum_products(&left, lag);
            *sum += value;
            *squares += value * value;
        }
    }
}

impl Replicates {
    /// The half widths: the quantile of the errors' magnitudes.
    fn half(mut self) -> [f64; 4] {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "a place among the replicates"
        )]
        let place = ((self.errors.len() + 1) as f64 * INSIDE) as usize - 1;
        std::array::from_fn(|index| {
            let by = |error: &Vector4<f64>| error[index].abs();
            self.errors.select_nth_unstable_by(place, |a, b| by(a).total_cmp(&by(b)));
            self.errors.get(place).map_or(f64::INFINITY, by)
        })
    }
}
