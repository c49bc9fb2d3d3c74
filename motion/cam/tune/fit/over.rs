//! What is left over of the samples: how it grows with the slope, goes on from sample to sample, and what of it is rounding.

use super::correlation::{correlations, first_order};
use super::growth::Growth;
use super::rounding::{Noise, Steps, Tried, clear, dot, far, tried};
use super::{FEW, Parameters, Problem};
use nalgebra::{DMatrix, DVector};

/// Lags at which covariances are reckoned.
pub(super) const LAGS: usize = 8;
/// Rounds in which these are corrected by what they say themselves, and by how much at most.
const ROUNDS: usize = 2;
const MOST_TAKEN: f64 = 4.0;
/// Recordings that are tried in each round: in the first one with truths that may be anywhere, in the others with those of the
/// one before.
const TRIED: [usize; 3] = [32, 32, 64];
/// With more noise, in steps, rounding is noise, too: of what is the same in all samples of a dwell, exp(−(2·π·s/q)²), nothing is
/// left that counts. With less than the other one it is told.
const HIDDEN: f64 = 0.5;
const TOLD: f64 = 0.35;
/// Noise and rounding are told apart badly. Reckoned with is less noise, which hides less of rounding, by so many times what
/// rounding scatters.
const SCATTER: f64 = 1.0;
/// Samples that are clear of rounding of their neighbours tell noise from rounding, if there are so many.
const CLEAR: usize = 30;
/// The correlation of noise that stands out of rounding so little that chance has more than 4 standard deviations of it is
/// reckoned by so much of all, times 1/√n.
const STANDS_OUT: f64 = 7.0;

/// What is known of a sample.
#[derive(Debug)]
pub(super) struct Known {
    /// How many unknowns there are; the others have 0.
    pub(super) unknowns: usize,
    /// Derivatives of the model by the unknowns.
    pub(super) row: [f64; 4],
    /// By how much an error of it moves what is found.
    pub(super) share: [f64; 4],
    pub(super) weight: f64,
    /// What is left over of it.
    pub(super) over: f64,
    /// How much of it the sample itself has made small.
    pub(super) leverage: f64,
    /// Where the model has the slave.
    pub(super) position: f64,
    /// Deviation of its noise, up to a common factor.
    pub(super) deviation: f64,
    /// Whether rounding of it has nothing to do with that of its neighbours: they are half a step off and more. Where too few
    /// are so, all are taken.
    pub(super) clear: bool,
}

/// What is known of what is left over.
pub(super) struct Over {
    pub(super) known: Vec<Known>,
    pub(super) growth: Option<Growth>,
    /// Correlations at the lags 1, 2, …, of the order that the samples choose, and of the first one.
    pub(super) correlations: Vec<f64>,
    pub(super) first: Vec<f64>,
    /// By how much more of it is fitted away than of noise that is independent.
    pub(super) taken: f64,
    /// As [`super::Fit::correlation`].
    pub(super) correlation: f64,
    /// As [`super::Fit::quantum`].
    pub(super) quantum: f64,
    /// The step to which positions are rounded, where noise does not hide it, and what that does.
    pub(super) rounded: Option<(f64, Tried)>,
}

impl Problem<'_> {
    /// `inverse` is that of the normal matrix at `p`; positions may be rounded to `step`.
    pub(super) fn left_over(
        &self,
        p: Parameters,
        inverse: &DMatrix<f64>,
        step: Option<f64>,
    ) -> Over {
        let growth = self.growth(p, step.unwrap_or_default());
        let unknowns = self.free.len();
        let known: Vec<Known> = self
            .samples
            .iter()
            .map(|s| {
                let (position, derivatives) = (self.model(p, s.master).0, self.row(p, s));
                let moves = inverse * &derivatives * s.weight;
                let leverage = derivatives.dot(&moves);
                let padded = |of: &DVector<f64>| {
                    std::array::from_fn(|i| of.get(i).copied().unwrap_or_default())
                };
                let (row, share) = (padded(&derivatives), padded(&moves));
                let grown = growth.map_or(1.0, |g| g.relative(s.weight, self.slope(p, s)));
                let deviation = (grown / s.weight).sqrt();
                let (weight, over) = (s.weight, s.slave - position);
                let clear = true;
                Known { unknowns, row, share, weight, over, leverage, position, deviation, clear }
            })
            .collect();
        let mut over = Over {
            known,
            growth,
            correlations: Vec::new(),
            first: Vec::new(),
            taken: 1.0,
            correlation: 0.0,
            quantum: 0.0,
            rounded: None,
        };
        if let Some(step) = step {
            let place = || {
                let turns = self.samples.iter().map(|s| std::f64::consts::TAU * s.slave / step);
                let (sin, cos) = turns
                    .fold((0.0, 0.0), |(sin, cos), turn: f64| (sin + turn.sin(), cos + turn.cos()));
                f64::atan2(sin, cos) / std::f64::consts::TAU
            };
            let place = (!self.free.contains(&2)).then(place);
            over.beyond_rounding(Steps { step, place });
        }
        if over.rounded.is_none() {
            over.plain();
        }
        over
    }
}

impl Over {
    /// Without rounding.
    fn plain(&mut self) {
        let samples = self.known.len();
        let covariances = covariances(&self.known);
        let hats = hats(&self.known);
        #[expect(clippy::cast_precision_loss, reason = "counts of samples and unknowns")]
        let freedom = (samples - self.known.first().map_or(0, |k| k.unknowns)) as f64;
        let [square, beside, ..] = covariances;
        self.correlation = if square > 0.0 { beside / square } else { 0.0 };
        let rounds = if samples < FEW { 0 } else { ROUNDS };
        for _ in 0..rounds {
            let variance = square / freedom * self.taken;
            let mended: Vec<f64> =
                covariances.iter().zip(hats).map(|(c, hat)| c + variance * hat).collect();
            self.found(correlations(&mended, samples));
            #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
            let count = samples as f64;
            self.first = match mended.as_slice() {
                [square, beside, ..] => first_order(beside / square, count),
                _ => Vec::new(),
            };
        }
    }

    fn found(&mut self, correlations: Vec<f64>) {
        self.correlations = correlations;
        self.taken = (1.0 + 2.0 * self.correlations.iter().sum::<f64>()).clamp(1.0, MOST_TAKEN);
    }

    /// Looks which samples are clear, and how many.
    fn clear(&mut self, step: f64) -> usize {
        let positions: Vec<f64> = self.known.iter().map(|k| k.position).collect();
        let apart = |a: f64, b: f64| (a - b).abs() > step / 2.0;
        let mut before = f64::INFINITY;
        for (index, k) in self.known.iter_mut().enumerate() {
            let after = positions.get(index + 1).copied().unwrap_or(f64::INFINITY);
            k.clear = apart(before, k.position) && apart(k.position, after);
            before = k.position;
        }
        let clear = self.known.iter().filter(|k| k.clear).count();
        if clear >= CLEAR {
            return clear;
        }
        self.known.iter_mut().for_each(|k| k.clear = true);
        self.known.len()
    }

    /// Positions that are rounded: what rounding explains is taken away, what remains is noise.
    fn beyond_rounding(&mut self, steps: Steps) {
        let step = steps.step;
        let samples = self.known.len();
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = samples as f64;
        let covariances = covariances(&self.known);
        let hats = hats(&self.known);
        let even: Vec<f64> = self.known.iter().map(|k| k.over / k.deviation).collect();
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let part = self.clear(step) as f64 / count;
        let [square, beside] = clear(&self.known, &even);
        // Of rounding, if nothing of it were fitted away.
        let rounding: f64 = self.known.iter().map(|k| (step / k.deviation).powi(2) / 12.0).sum();
        let least = covariances.first().copied().unwrap_or_default().min(square / part);
        let mut variance = (least - rounding).max(0.0) / count;
        let mut noise = Noise { deviation: (least.max(rounding) / count).sqrt(), correlation: 0.0 };
        let mut off = far(&self.known, step);
        let mut last = None;
        for recordings in TRIED {
            let now = tried(&self.known, (&off, recordings), steps, noise);
            let mended: Vec<f64> = covariances
                .iter()
                .zip(hats)
                .zip(now.left)
                .map(|((c, hat), left)| c - left + variance * hat)
                .collect();
            let (of_noise, next) = match mended.as_slice() {
                [of_noise, next, ..] => (of_noise.max(0.0), *next),
                _ => (0.0, 0.0),
            };
            let all = of_noise + rounding;
            if samples >= FEW {
                self.found(with_rounding(&mended, of_noise, all, count));
            }
            // What goes on is fitted away by more than independent noise.
            let goes_on = (self.taken - 1.0) * all;
            variance = (of_noise + goes_on).min(MOST_TAKEN * of_noise) / count;
            let least = all * (STANDS_OUT / (count * part).sqrt()).min(1.0);
            let ([_, rounded], [all_scatter, clear_scatter]) = (now.squares, now.scatter);
            let by_all = of_noise - SCATTER * all_scatter;
            let by_clear = (square - rounded - SCATTER * clear_scatter) / part;
            let rather = by_all.min(by_clear).max(0.0);
            noise = Noise {
                deviation: ((rather + rounding) / count).sqrt(),
                correlation: (next / of_noise.max(least)).clamp(0.0, 0.9),
            };
            // Rounding hides its part of it.
            let part_of_noise = if all > 0.0 { of_noise / all } else { 0.0 };
            self.first =
                if samples < FEW { Vec::new() } else { first_order(noise.correlation, count) };
            self.first.iter_mut().for_each(|value| *value *= part_of_noise);
            // What no recording that was tried has; less is no harm.
            let [low, high] = now.beside;
            let beyond = (beside - high - (high - low) / 2.0).max(0.0);
            self.correlation = beyond / (square - rounded).max(least * part);
            off.clone_from(&now.off);
            last = Some((step, now));
        }
        // Where there is least.
        let before = self.known.iter().map(|k| noise.before(k, step));
        let hidden = before.fold(f64::INFINITY, f64::min) / step;
        if hidden <= HIDDEN {
            self.rounded = last;
            self.quantum = if hidden <= TOLD { step } else { 0.0 };
        } else {
            (self.correlations, self.first, self.taken) = (Vec::new(), Vec::new(), 1.0);
        }
    }
}

/// Correlations of noise with these covariances together with rounding, which has none; both have `all` as their sum of squares.
///
/// Rounding makes correlations of noise worse known, as so much fewer samples would: if these leave none, those of both
/// together are taken.
fn with_rounding(covariances: &[f64], of_noise: f64, all: f64, count: f64) -> Vec<f64> {
    let part = if all > 0.0 { of_noise / all } else { 0.0 };
    let fitted = |first: f64, count: f64| {
        let mut covariances = covariances.to_vec();
        if let Some(square) = covariances.first_mut() {
            *square = first;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        correlations(&covariances, count as usize)
    };
    let mut of_both = fitted(of_noise, count * part * part);
    for value in &mut of_both {
        *value *= part;
    }
    let coarse = fitted(all, count);
    let sum = |of: &[f64]| of.iter().sum::<f64>();
    if sum(&of_both) > sum(&coarse) { of_both } else { coarse }
}

/// Sums of what is left over times what is at the lags 0, 1, … behind it, by deviation: noise that grows is to count alike
/// everywhere.
fn covariances(known: &[Known]) -> [f64; LAGS + 1] {
    let even: Vec<f64> = known.iter().map(|k| k.over / k.deviation).collect();
    std::array::from_fn(|lag| even.iter().zip(even.iter().skip(lag)).map(|(a, b)| a * b).sum())
}

/// What fitting takes of them, as a part of the variance, where the noise is independent: Σ h at each lag, with h from the hat
/// matrix.
fn hats(known: &[Known]) -> [f64; LAGS + 1] {
    std::array::from_fn(|lag| {
        let pairs = known.iter().zip(known.iter().skip(lag));
        pairs
            .map(|(one, other)| dot(&one.share, &other.row) * (other.weight / one.weight).sqrt())
            .sum()
    })
}
