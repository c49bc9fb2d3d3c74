//! Residuals of a fit: their correlation, and which of them refuse the fit.
//!
//! Refused are samples far from the others, residuals as large as the data, halves of a run that contradict each other, and a master
//! at rest.

use super::FitError;
use super::distributions::{fisher_exceeds, student_exceeds};
use super::fit::{ALIKE, CHANCE, FitOptions, Problem, ROUNDING, Sample, Values};
use nalgebra::Vector4;

/// The median of |e| of normal noise, in standard deviations.
const MEDIAN: f64 = 0.6745;
/// Positions that differ by less than this part of the largest one are the same.
const FINEST: f64 = 1e-6;
/// A multiple of a step is exact to this part of it.
const MULTIPLE: f64 = 1e-3;
/// An outlier exceeds this many times the usual residual, and one run in a million has one by chance.
const SUSPECT: f64 = 4.0;
const OUTLIER: f64 = 1e-6;
/// It is this many times as far as the next one: noise that grows with the slope has no such gaps.
const APART: f64 = 2.0;
/// One in this many samples may be an outlier, and at most this many.
const ONE_IN: usize = 10;
const MOST: usize = 20;
/// A residual of less than this part of the largest position, or this many steps of rounding, is not an outlier.
const NEGLIGIBLE: f64 = 1e-9;
const STEPS: f64 = 1.5;
/// Residuals of more than this part of the spread of the data leave it unexplained.
const UNEXPLAINED: f64 = 0.5;
/// From this many degrees of freedom on the variance of residuals is known well enough for a plain ratio.
const MANY: f64 = 20.0;

impl Problem<'_> {
    /// The step to which the slave's positions are rounded: their smallest difference, if all others are multiples of it; else 0.
    pub(super) fn step(&self) -> f64 {
        let mut slaves: Vec<f64> = self.samples.iter().map(|s| s.slave).collect();
        slaves.sort_by(f64::total_cmp);
        let least = FINEST * self.ends(|s| s.slave.abs())[1];
        let gaps = slaves.windows(2).map(|pair| pair[1] - pair[0]);
        let step = gaps.filter(|gap| *gap > least).min_by(f64::total_cmp).unwrap_or_default();
        let is_multiple = |gap: f64| (gap / step - (gap / step).round()).abs() < MULTIPLE;
        let first = slaves.first().copied().unwrap_or_default();
        if slaves.iter().all(|slave| is_multiple(slave - first)) { step } else { 0.0 }
    }

    /// Lag-1 correlation of the residuals.
    pub(super) fn correlation(&self, p: Values) -> f64 {
        let e: Vec<f64> = self.samples.iter().map(|s| s.weight.sqrt() * self.over(p, s)).collect();
        let square: f64 = e.iter().map(|e| e * e).sum();
        let product: f64 = e.iter().zip(e.iter().skip(1)).map(|(one, next)| one * next).sum();
        if square > 0.0 { product / square } else { 0.0 }
    }

    /// Refuses samples that are far from where all others have the slave: the suspects are left out, the others fitted again, and
    /// each suspect is compared with that fit and the lesser suspects by Student's t (Rosner's generalised test, Technometrics 25,
    /// 1983, with Bonferroni's bound for the largest of all).
    pub(super) fn refuse_outliers(
        &self,
        p: Values,
        options: &FitOptions,
        step: f64,
    ) -> Result<(), FitError> {
        let weighted = |s: &Sample| s.weight.sqrt() * self.over(p, s).abs();
        let weight = self.ends(|s| s.weight)[1];
        let size = self.ends(|s| s.weight.sqrt() * s.slave.abs())[1];
        let floor = (NEGLIGIBLE * size).max(STEPS * step * weight.sqrt());
        let bound = floor.max(SUSPECT * median(self.samples.iter().map(weighted)) / MEDIAN);
        let all = self.samples.iter().map(weighted).enumerate();
        let mut suspects: Vec<(usize, f64)> = all.filter(|(_, over)| *over > bound).collect();
        suspects.sort_by(|a, b| b.1.total_cmp(&a.1));
        suspects.truncate((self.samples.len() / ONE_IN).clamp(1, MOST));
        if suspects.is_empty() {
            return Ok(());
        }
        let suspected = |index: usize| suspects.iter().any(|(suspect, _)| *suspect == index);
        let all = self.samples.iter().enumerate();
        let others: Vec<Sample> =
            all.filter(|(index, _)| !suspected(*index)).map(|(_, sample)| *sample).collect();
        let rest = Problem { samples: &others, ..*self };
        let Ok(answer) = rest.solved(options) else { return Ok(()) };
        let Some(inverse) = rest.normal(answer.values).0.try_inverse() else { return Ok(()) };
        #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
        let (mut freedom, count) =
            ((others.len() - self.unknowns()) as f64, self.samples.len() as f64);
        let (mut left, mut outliers) = (answer.left, Vec::new());
        let mut next = rest.ends(|s| s.weight * rest.over(answer.values, s).powi(2))[1];
        for (index, _) in suspects.into_iter().rev() {
            let sample = self.samples[index];
            let (value, row) = self.model(answer.values, sample.master);
            let by = sample.slave - value;
            let square = sample.weight * by * by;
            let free = 1.0 + sample.weight * row.dot(&(inverse * row));
            let t = (square / (left / freedom * free)).sqrt();
            let far = square > (floor * floor).max(APART * APART * next)
                && count * student_exceeds(t, freedom) <= OUTLIER;
            // What is farther than an outlier is one, too.
            if far || !outliers.is_empty() {
                outliers.push((index + 1, by));
            }
            (left, next) = (left + square, next.max(square));
            freedom += 1.0;
        }
        outliers.sort_unstable_by_key(|(index, _)| *index);
        if outliers.is_empty() { Ok(()) } else { Err(FitError::Outliers { outliers }) }
    }

    pub(super) fn refuse_unexplained(&self, left: f64) -> Result<(), FitError> {
        let weights = self.sum(|s| s.weight);
        let mean = self.sum(|s| s.weight * s.slave) / weights;
        let spread = (self.sum(|s| s.weight * (s.slave - mean).powi(2)) / weights).sqrt();
        let rms = (left / weights).sqrt();
        if rms > UNEXPLAINED * spread { Err(FitError::Unexplained { rms, spread }) } else { Ok(()) }
    }

    /// Refuses halves of the run that leave over much less with answers of their own, if these differ by more than rounding.
    pub(super) fn refuse_contradiction(
        &self,
        p: Values,
        left: f64,
        step: f64,
    ) -> Result<(), FitError> {
        let Some(freedom) = self.samples.len().checked_sub(2 * self.unknowns()) else {
            return Ok(());
        };
        let (first, second) = self.samples.split_at(self.samples.len() / 2);
        let (mut gained, mut apart) = (0.0, Vector4::zeros());
        for (samples, sign) in [(first, 1.0), (second, -1.0)] {
            let (matrix, right) = Problem { samples, ..*self }.normal(p);
            let Some(factors) = matrix.cholesky() else { return Ok(()) };
            let own = factors.solve(&right);
            gained += right.dot(&own);
            apart += own * sign;
        }
        #[expect(clippy::cast_precision_loss, reason = "counts of samples and unknowns")]
        let (freedom, unknowns) = (freedom as f64, self.unknowns() as f64);
        let f = gained / (unknowns * ((left - gained).max(f64::MIN_POSITIVE) / freedom));
        let beyond =
            if freedom < MANY { fisher_exceeds(f, unknowns, freedom) < CHANCE } else { f > ALIKE };
        let [low, high] = self.ends(|s| self.model(p, s.master).1.dot(&apart));
        // The last digits of exact data do not count.
        let size = self.sum(|s| s.weight * s.slave.powi(2));
        let differ = high.max(-low) > step && gained > ROUNDING * size;
        if beyond && differ { Err(FitError::Contradictory { f }) } else { Ok(()) }
    }

    /// Refuses a master at rest.
    pub(super) fn refuse_still(&self) -> Result<(), FitError> {
        let [low, high] = self.ends(|sample| sample.master);
        if high - low > 1e-12 * low.abs().max(high.abs()).max(self.width()) {
            return Ok(());
        }
        Err(FitError::Still { master: low, samples: self.samples.len(), unknowns: self.names() })
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
