//! Samples that have nothing to do with the others.

use super::super::FitError;
use super::super::chance::student_exceeds;
use super::{FitOptions, Fitted, Parameters, Problem, Sample};

/// A sample is told as an outlier if no more than one run in a million has one as far by chance.
const CHANCE: f64 = 1e-6;
/// What is farther than so many times the usual is looked at at all.
const SUSPECT: f64 = 4.0;
/// One in so many samples may be an outlier: more of them are no exceptions.
const ONE_IN: usize = 10;
/// More of them are not looked for.
const MOST: usize = 20;
/// Of the size of the slave's positions this part is rounding.
const ROUNDING: f64 = 1e-9;

impl Problem<'_> {
    /// Takes out the sample that is farthest off, fits the others again, and so on, as far as there may be outliers; all up
    /// to the last one that is too far off by its own studentized residual (Rosner's procedure, with Bonferroni's bound for
    /// the largest of so many) are told. So one of them does not hide another.
    pub(super) fn refuse_outliers(
        &self,
        fitted: &Fitted,
        options: &FitOptions,
    ) -> Result<(), FitError> {
        let most = (self.samples.len() / ONE_IN).clamp(1, MOST);
        let floor = ROUNDING * self.size();
        if !self.has_suspects(fitted.best, floor) {
            return Ok(());
        }
        let mut left: Vec<(usize, Sample)> = (0..).zip(self.samples.iter().copied()).collect();
        let mut best = fitted.best;
        let mut taken: Vec<Far> = Vec::new();
        let mut told = 0;
        for _ in 0..most {
            let samples: Vec<_> = left.iter().map(|(_, sample)| *sample).collect();
            let some = Problem { samples: &samples, ..*self };
            let Some(mut far) = some.farthest(best, floor) else { break };
            let (index, _) = left.remove(far.index);
            far.index = index;
            let chance = far.chance;
            taken.push(far);
            if chance <= CHANCE {
                told = taken.len();
            }
            let samples: Vec<_> = left.iter().map(|(_, sample)| *sample).collect();
            let rest = Problem { samples: &samples, ..*self };
            let Some(Fitted { best: again, .. }) = rest.solved(options) else { break };
            best = again;
        }
        taken.truncate(told);
        if taken.is_empty() {
            return Ok(());
        }
        // How far each is from where the others have it.
        let found = |far: &Far| {
            let sample = self.samples.get(far.index).copied();
            let by = sample.map_or(0.0, |s| s.slave - self.model(best, s.master).0);
            (far.index + 1, by)
        };
        let mut outliers: Vec<_> = taken.iter().map(found).collect();
        outliers.sort_unstable_by_key(|(index, _)| *index);
        Err(FitError::Outliers { outliers })
    }

    /// Whether anything is far off of what is usual, the median.
    fn has_suspects(&self, p: Parameters, floor: f64) -> bool {
        let mut off: Vec<_> = self.samples.iter().map(|s| self.over(p, s).abs()).collect();
        let middle = off.len() / 2;
        let largest = off.iter().copied().fold(0.0, f64::max);
        off.select_nth_unstable_by(middle, f64::total_cmp);
        // Of normal noise the median is 0.6745 standard deviations.
        let usual = off.get(middle).copied().unwrap_or_default() / 0.6745;
        largest > SUSPECT * usual && largest > floor
    }

    /// What is left over of a sample, by its weight.
    fn over(&self, p: Parameters, sample: &Sample) -> f64 {
        sample.weight.sqrt() * (sample.slave - self.model(p, sample.master).0)
    }

    /// The largest position: what rounding is measured against.
    fn size(&self) -> f64 {
        self.samples.iter().map(|s| s.weight.sqrt() * s.slave.abs()).fold(0.0, f64::max)
    }

    /// The sample with the largest studentized residual, of those that are off by more than `floor`; none if there are too few.
    fn farthest(&self, p: Parameters, floor: f64) -> Option<Far> {
        let (matrix, _) = self.normal(p, self.samples);
        let inverse = matrix.try_inverse()?;
        let freedom = self.samples.len().checked_sub(self.free.len() + 1).filter(|n| *n > 0)?;
        let square: f64 = self.samples.iter().map(|s| self.over(p, s).powi(2)).sum();
        #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
        let (freedom, count) = (freedom as f64, self.samples.len() as f64);
        let mut farthest: Option<(usize, f64)> = None;
        for (index, sample) in self.samples.iter().enumerate() {
            let residual = self.over(p, sample);
            if residual.abs() <= floor {
                continue;
            }
            let row = self.row(p, sample);
            let leverage = sample.weight * (row.transpose() * &inverse * &row).sum();
            let free = 1.0 - leverage;
            // A sample that alone says something cannot contradict the others.
            if free <= 1e-9 {
                continue;
            }
            // With its own part of what is left over taken out.
            let rest = (square - residual * residual / free).max(0.0) / freedom;
            let t = residual.abs() / (rest * free).sqrt();
            if farthest.is_none_or(|(_, other)| t > other) {
                farthest = Some((index, t));
            }
        }
        let (index, t) = farthest?;
        Some(Far { index, chance: count * student_exceeds(t, freedom) })
    }
}

/// A sample and how likely one of all is as far off by chance.
struct Far {
    index: usize,
    chance: f64,
}
