//! Residuals of a fit: how their noise grows with the slope, and which of them refuse the fit.
//!
//! Refused are samples far from the others, residuals as large as the data, halves of a run that contradict each other, and a master
//! at rest.

use super::FitError;
use super::distributions::{fisher_exceeds, student_exceeds};
use super::fit::{ALIKE, CHANCE, FitOptions, Problem, ROUNDING, Sample, Values};
use super::quantum::quantum;
use nalgebra::{Matrix4, Vector4};

/// A residual, and how an error of its sample moves the estimates.
#[derive(Debug)]
pub(super) struct Residual {
    pub(super) value: f64,
    /// Position of the model.
    pub(super) position: f64,
    /// Standard deviation of its noise, up to a common factor.
    pub(super) scale: f64,
    /// Derivatives of the model, and of the estimates by the sample.
    pub(super) row: Vector4<f64>,
    pub(super) share: Vector4<f64>,
}

/// Noise that grows with the slope of the cam, as jitter of the master makes it: weight · e² is `base` + `master` · weight · y′².
#[derive(Clone, Copy)]
struct Growth {
    base: f64,
    /// Variance of the master's positions, u².
    master: f64,
}

/// Bins of slopes, and the fewest samples that show a growth.
const BINS: usize = 8;
const GROWS: usize = 80;
/// Growth is accepted from this many standard deviations on; one of a variance from a median of n samples is 2.33/√n of it.
const SEEN: f64 = 4.0;
const COARSE: f64 = 2.33;
/// The median of |e| of normal noise, in standard deviations.
const MEDIAN: f64 = 0.6745;
/// The variance of rounding is less than its median suggests by this, in squared quanta.
const UNIFORM: f64 = 0.25 * 0.25 / (MEDIAN * MEDIAN) - 1.0 / 12.0;
/// Bins without noise count with this part of the mean variance.
const FLOOR: f64 = 0.05;
/// Jitter of the master moves the slope itself by the bend of the cam: its square counts this many times.
const BENT: f64 = 9.0;
/// An outlier exceeds this many times the usual residual, and one run in a million has one by chance.
const SUSPECT: f64 = 4.0;
const OUTLIER: f64 = 1e-6;
/// One in this many samples may be an outlier, and at most this many.
const ONE_IN: usize = 10;
const MOST: usize = 20;
/// A residual of less than this part of the largest position, or this many quanta, is not an outlier.
const NEGLIGIBLE: f64 = 1e-9;
const QUANTA: f64 = 1.5;
/// Residuals of more than this part of the spread of the data leave it unexplained.
const UNEXPLAINED: f64 = 0.5;
/// From this many degrees of freedom on the variance of residuals is known well enough for a plain ratio.
const MANY: f64 = 20.0;

impl Problem<'_> {
    pub(super) fn residuals(&self, p: Values, inverse: &Matrix4<f64>, step: f64) -> Vec<Residual> {
        let samples = self.evened(p, self.growth(p, step));
        let residual = |(sample, even): (&Sample, Sample)| {
            let (position, row) = self.model(p, sample.master);
            let Sample { slave, weight, .. } = *sample;
            let (value, scale) = (slave - position, even.weight.sqrt().recip());
            Residual { value, position, scale, row, share: inverse * row * weight }
        };
        self.samples.iter().zip(samples).map(residual).collect()
    }

    /// Quantum of the slave's positions, unless it is far below the noise.
    pub(super) fn quantum(&self, p: Values) -> Option<f64> {
        let mut over: Vec<(f64, f64)> =
            self.samples.iter().map(|s| (self.slope(p, s).abs(), self.over(p, s).abs())).collect();
        // Rounding shows most where the slave is slow.
        over.sort_by(|a, b| a.0.total_cmp(&b.0));
        let slow = (over.len() / 8).max(8).min(over.len());
        let deviation = |part: &[(f64, f64)]| median(part.iter().map(|(_, over)| *over)) / MEDIAN;
        let least = deviation(&over[..slow]).min(deviation(&over));
        let slaves: Vec<f64> = self.samples.iter().map(|s| s.slave).collect();
        quantum(&slaves, 1.5 * least).filter(|step| *step > least)
    }

    /// dy/dm of the model.
    fn slope(&self, p: Values, sample: &Sample) -> f64 {
        let all = Problem { free: [true; 4], ..*self };
        all.model(p, sample.master).1[0] * p[1]
    }

    /// A step of the master for differences, and d²y/dm² of the model.
    fn bend(&self, p: Values, sample: &Sample) -> (f64, f64) {
        let step = 1e-4 * self.width() / p[1].abs().max(f64::MIN_POSITIVE);
        let at = |by: f64| self.slope(p, &Sample { master: sample.master + by, ..*sample });
        (step, (at(step) - at(-step)) / (2.0 * step))
    }

    /// How noise grows with the slope, if it does: a line through the medians of bins of slopes.
    fn growth(&self, p: Values, step: f64) -> Option<Growth> {
        if self.samples.len() < GROWS {
            return None;
        }
        let both = |s: &Sample| {
            // Rounding counts alike everywhere: where the slave rests the fit has taken it away.
            let over = self.over(p, s).abs().max(step / 4.0);
            (s.weight * self.slope(p, s).powi(2), s.weight.sqrt() * over)
        };
        let mut both: Vec<(f64, f64)> = self.samples.iter().map(both).collect();
        both.sort_by(|a, b| a.0.total_cmp(&b.0));
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = |n: usize| n as f64;
        let weight = self.sum(|s| s.weight) / count(self.samples.len());
        let size = both.len().div_ceil(BINS);
        let bin = |bin: &[(f64, f64)]| {
            let steep = bin.iter().map(|(steep, _)| steep).sum::<f64>() / count(bin.len());
            let usual = median(bin.iter().map(|(_, over)| *over)) / MEDIAN;
            [steep, usual * usual - weight * step * step * UNIFORM]
        };
        let bins: Vec<[f64; 2]> = both.chunks(size).map(bin).collect();
        let mean =
            |index: usize| bins.iter().map(|bin| bin[index]).sum::<f64>() / count(bins.len());
        let (steep, variance) = (mean(0), mean(1));
        let spread: f64 = bins.iter().map(|[x, _]| (x - steep).powi(2)).sum();
        let product: f64 = bins.iter().map(|[x, v]| (x - steep) * (v - variance)).sum();
        if spread <= 0.0 || variance <= 0.0 {
            return None;
        }
        let master = product / spread;
        let deviation = COARSE * variance / count(size).sqrt() / spread.sqrt();
        let usual = variance - master * steep;
        let base = if step > 0.0 {
            usual.min(bins[0][1]).max(weight * step * step / 12.0)
        } else {
            usual.max(FLOOR * variance)
        };
        (master > SEEN * deviation).then_some(Growth { base, master })
    }

    /// The same samples with weights by which the noise is the same everywhere.
    fn evened(&self, p: Values, growth: Option<Growth>) -> Vec<Sample> {
        let Some(Growth { base, master }) = growth else { return self.samples.to_vec() };
        let even = |sample: &Sample| {
            let bent = BENT * master * self.bend(p, sample).1.powi(2);
            let square = self.slope(p, sample).powi(2) + bent;
            let weight = sample.weight / (1.0 + master * sample.weight * square / base);
            Sample { weight, ..*sample }
        };
        self.samples.iter().map(even).collect()
    }

    /// By how much the unknowns are shifted if all growth is jitter of the master: the second order of errors in the variables,
    /// −Σ (½·y″·J + J′·y′)·σ² through the normal equations (Carroll et al., Measurement Error in Nonlinear Models, 2006, §3).
    pub(super) fn attenuation(&self, p: Values, inverse: &Matrix4<f64>, step: f64) -> Vector4<f64> {
        let Some(Growth { master, .. }) = self.growth(p, step) else { return Vector4::zeros() };
        let mut sum = Vector4::zeros();
        for sample in self.samples {
            let (step, bend) = self.bend(p, sample);
            let row = |by: f64| self.model(p, sample.master + by).1;
            let turned = (row(step) - row(-step)) / (2.0 * step);
            sum -= (row(0.0) * (0.5 * bend) + turned * self.slope(p, sample))
                * (sample.weight * master);
        }
        inverse * sum
    }

    /// Refuses samples that are far from where all others have the slave: the suspects are left out, the others fitted again, and
    /// each suspect is compared with that fit by Student's t (Bonferroni's bound for the largest of all).
    pub(super) fn refuse_outliers(
        &self,
        p: Values,
        options: &FitOptions,
        step: f64,
    ) -> Result<(), FitError> {
        let growth = self.growth(p, step);
        let samples = self.evened(p, growth);
        let even = Problem { samples: &samples, ..*self };
        let p = if growth.is_some() { even.solved(options)?.values } else { p };
        let weighted = |s: &Sample| s.weight.sqrt() * even.over(p, s).abs();
        let weight = even.ends(|s| s.weight)[1];
        let size = even.ends(|s| s.weight.sqrt() * s.slave.abs())[1];
        let floor = (NEGLIGIBLE * size).max(QUANTA * step * weight.sqrt());
        let bound = floor.max(SUSPECT * median(samples.iter().map(weighted)) / MEDIAN);
        let all = samples.iter().map(weighted).enumerate();
        let mut suspects: Vec<(usize, f64)> = all.filter(|(_, over)| *over > bound).collect();
        suspects.sort_by(|a, b| b.1.total_cmp(&a.1));
        suspects.truncate((samples.len() / ONE_IN).clamp(1, MOST));
        if suspects.is_empty() {
            return Ok(());
        }
        let suspected = |index: usize| suspects.iter().any(|(suspect, _)| *suspect == index);
        let all = samples.iter().enumerate();
        let others: Vec<Sample> =
            all.filter(|(index, _)| !suspected(*index)).map(|(_, sample)| *sample).collect();
        let rest = Problem { samples: &others, ..*self };
        let Ok(answer) = rest.solved(options) else { return Ok(()) };
        let Some(inverse) = rest.normal(answer.values).0.try_inverse() else { return Ok(()) };
        #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
        let (freedom, count) = ((others.len() - self.unknowns()) as f64, samples.len() as f64);
        // Where the cam hardly moves the slave there may be far less noise than where it is steep.
        let least = growth.map_or(0.0, |_| even.steep_variance(p));
        let variance = (answer.left / freedom).max(least);
        let far = |(index, _): &(usize, f64)| {
            let sample = samples[*index];
            let (value, row) = self.model(answer.values, sample.master);
            let by = sample.slave - value;
            let over = sample.weight.sqrt() * by;
            let free = 1.0 + sample.weight * row.dot(&(inverse * row));
            let chance = count * student_exceeds(over / (variance * free).sqrt(), freedom);
            (over.abs() > floor && chance <= OUTLIER).then_some((index + 1, by))
        };
        let mut outliers: Vec<_> = suspects.iter().filter_map(far).collect();
        outliers.sort_unstable_by_key(|(index, _)| *index);
        if outliers.is_empty() { Ok(()) } else { Err(FitError::Outliers { outliers }) }
    }

    /// Variance of the residuals of the steeper half, by weight and median.
    fn steep_variance(&self, p: Values) -> f64 {
        let mut both: Vec<(f64, f64)> = self
            .samples
            .iter()
            .map(|s| (self.slope(p, s).abs(), s.weight.sqrt() * self.over(p, s).abs()))
            .collect();
        both.sort_by(|a, b| b.0.total_cmp(&a.0));
        both.truncate(both.len().div_ceil(2));
        (median(both.into_iter().map(|(_, over)| over)) / MEDIAN).powi(2)
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
