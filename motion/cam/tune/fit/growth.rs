//! Noise that grows with the slope of the cam: jitter of the master, or of the time at which both were recorded.

use super::{Parameters, Problem, Sample};
use nalgebra::DMatrix;

/// Samples are laid into so many bins by the slope.
const BINS: usize = 8;
/// Of fewer samples nothing is said.
const LEAST: usize = 80;
/// Growth is seen if it is so many times its standard deviation.
const SEEN: f64 = 4.0;
/// The median of |e| of normal noise, in standard deviations.
pub(super) const MEDIAN: f64 = 0.6745;
/// By how much the variance of rounding, 1/12, is less than what its median makes of it, in steps.
const UNIFORM: f64 = 0.25 * 0.25 / (MEDIAN * MEDIAN) - 1.0 / 12.0;
/// Standard deviation of a variance from the median of n samples, times √n, as a part of it: the median has 37 % of the
/// efficiency that the squares have.
const COARSE: f64 = 2.33;
/// Bins without noise at all have this part of the usual variance.
const FLOOR: f64 = 0.05;

/// Noise of the master and the slope where it is taken to be differ by the bend: so many times its square.
const BENT: f64 = 9.0;

/// weight · e² is `base` + `slope` · weight · y′².
#[derive(Clone, Copy, Debug)]
pub(super) struct Growth {
    base: f64,
    /// The variance of the master's positions, if it is these that are noisy, u².
    pub(super) slope: f64,
}

impl Growth {
    /// The variance of a sample as a part of what noise without growth has.
    pub(super) fn relative(&self, weight: f64, slope: f64) -> f64 {
        1.0 + self.slope * weight * slope * slope / self.base
    }
}

impl Problem<'_> {
    /// dy/dm of the model.
    pub(super) fn slope(&self, p: Parameters, sample: &Sample) -> f64 {
        let (_, [slope, ..]) = self.model(p, sample.master);
        slope * p[1]
    }

    /// How noise grows with the slope, if it does. By medians, so that samples that are far off do not count. What rounding to
    /// `step` leaves over is taken for the same everywhere: where the slave dwells, fitting has taken it away.
    pub(super) fn growth(&self, p: Parameters, step: f64) -> Option<Growth> {
        if self.samples.len() < LEAST {
            return None;
        }
        // The median of the magnitudes of rounding.
        let rounding = step.abs() / 4.0;
        let mut both: Vec<(f64, f64)> = self
            .samples
            .iter()
            .map(|s| {
                let over = (s.slave - self.model(p, s.master).0).abs().max(rounding);
                (s.weight * self.slope(p, s).powi(2), s.weight.sqrt() * over)
            })
            .collect();
        both.sort_by(|a, b| a.0.total_cmp(&b.0));
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let weight = self.samples.iter().map(|s| s.weight).sum::<f64>() / self.samples.len() as f64;
        let size = both.len().div_ceil(BINS);
        let mut bins: Vec<[f64; 2]> = Vec::new();
        for bin in both.chunks_mut(size) {
            #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
            let steep = bin.iter().map(|(steep, _)| steep).sum::<f64>() / bin.len() as f64;
            let middle = bin.len() / 2;
            let (_, (_, median), _) =
                bin.select_nth_unstable_by(middle, |a, b| a.1.total_cmp(&b.1));
            let excess = weight * step * step * UNIFORM;
            bins.push([steep, (*median / MEDIAN).powi(2) - excess]);
        }
        #[expect(clippy::cast_precision_loss, reason = "a few")]
        let count = bins.len() as f64;
        let mean = |index: usize| bins.iter().filter_map(|bin| bin.get(index)).sum::<f64>() / count;
        let (steep, variance) = (mean(0), mean(1));
        let spread: f64 = bins.iter().map(|[x, _]| (x - steep).powi(2)).sum();
        let both: f64 = bins.iter().map(|[x, v]| (x - steep) * (v - variance)).sum();
        if spread <= 0.0 || variance <= 0.0 {
            return None;
        }
        let slope = both / spread;
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let deviation = COARSE * variance / (size as f64).sqrt() / spread.sqrt();
        let usual = variance - slope * steep;
        // Rounding is what there is at least, and the quietest samples show what else.
        let least = weight * step * step / 12.0;
        let base = match bins.first() {
            Some([_, quiet]) if step > 0.0 => usual.min(*quiet).max(least),
            _ => usual.max(FLOOR * variance),
        };
        (slope > SEEN * deviation).then_some(Growth { base, slope })
    }

    /// The same samples with weights by which the noise is the same everywhere. Where the cam is bent, noise of the master
    /// counts by the slopes beside as well.
    pub(super) fn evened(&self, p: Parameters, growth: &Growth) -> Vec<Sample> {
        let even = |sample: &Sample| {
            let slope = self.slope(p, sample);
            let bent = self.bent(p, sample).powi(2) * growth.slope * BENT;
            let weight = sample.weight / growth.relative(sample.weight, slope.hypot(bent.sqrt()));
            Sample { weight, ..*sample }
        };
        self.samples.iter().map(even).collect()
    }

    /// A step of the master for differences.
    fn step(&self, p: Parameters) -> f64 {
        1e-4 * self.width() / p[1].abs().max(f64::MIN_POSITIVE)
    }

    /// d²y/dm² of the model.
    fn bent(&self, p: Parameters, sample: &Sample) -> f64 {
        let step = self.step(p);
        let at = |by: f64| self.slope(p, &Sample { master: sample.master + by, ..*sample });
        (at(step) - at(-step)) / (2.0 * step)
    }

    /// By how much the unknowns are shifted if all of the growth is noise of the master's positions: the second order of what
    /// least squares make of errors in the variables (Carroll, Ruppert, Stefanski and Crainiceanu, Measurement Error in
    /// Nonlinear Models, 2006, §3), −Σ (½·y″·J + J′·y′)·σ² through the normal equations.
    pub(super) fn attenuation(
        &self,
        p: Parameters,
        inverse: &DMatrix<f64>,
        variance: f64,
    ) -> Vec<f64> {
        let step = self.step(p);
        let mut sum = DMatrix::zeros(self.free.len(), 1);
        for sample in self.samples {
            let beside = |by: f64| Sample { master: sample.master + by, ..*sample };
            let [before, after] = [beside(-step), beside(step)];
            let (slope, bent) = (self.slope(p, sample), self.bent(p, sample));
            let turned = (self.row(p, &after) - self.row(p, &before)) / (2.0 * step);
            sum -= sample.weight * variance * (self.row(p, sample) * (0.5 * bent) + turned * slope);
        }
        (inverse * sum).iter().copied().collect()
    }
}
