//! Answers that are none: the data contradict the cam, or themselves.

use super::super::super::curve::Range;
use super::super::FitError;
use super::super::chance::fisher_exceeds;
use super::over::Over;
use super::{CHANCE, FitOptions, Free, Parameters, Problem, Sample};

/// Of the spread of the slave this part at most may be left over.
const UNEXPLAINED: f64 = 0.5;
/// Two answers fit alike if the worse one leaves over less than this many times what chance does.
pub(super) const ALIKE: f64 = 25.0;
/// With so many degrees of freedom what is left over is known well enough for that.
const MANY: f64 = 20.0;
/// A slave that moves by no more than this part of what it does on the cam rests, but for noise.
const RESTING: f64 = 0.05;
/// A slave that moves by so many times what the cam allows on the way of the master does not follow it in these units.
const TOO_FAR: f64 = 1.5;

impl Problem<'_> {
    pub(super) fn refuse_unexplained(&self, p: Parameters, left: f64) -> Result<(), FitError> {
        let sum = |of: &dyn Fn(&Sample) -> f64| {
            self.samples.iter().map(|s| s.weight * of(s)).sum::<f64>()
        };
        let weights = sum(&|_| 1.0);
        let mean = sum(&|s| s.slave) / weights;
        let spread = (sum(&|s| (s.slave - mean).powi(2)) / weights).sqrt();
        let rms = (left / weights).sqrt();
        // One line of the slave is told where it rests as well: noise is all that is to be seen of its spread there.
        let spread = if self.is_line() { spread.max(self.seen_at_rest(p)) } else { spread };
        if rms > UNEXPLAINED * spread { Err(FitError::Unexplained { rms, spread }) } else { Ok(()) }
    }

    /// Whether offset or scaling of the slave alone is looked for.
    fn is_line(&self) -> bool {
        matches!(self.free, [2 | 3])
    }

    /// The spread of a slave that follows the cam, where the cam has it rest and noise hides it: so that the noise which is allowed
    /// there is the same part of the cam's height as that of a slave that counts as resting. 0 where the cam moves it.
    fn seen_at_rest(&self, p: Parameters) -> f64 {
        let Range { min, max, .. } = self.curve.extremes().position;
        let height = (max - min) * p[3].abs();
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let model = self.samples.iter().map(|sample| self.model(p, sample.master).0);
        let (low, high) = model.fold(ends, |(a, b), y| (a.min(y), b.max(y)));
        if high - low <= RESTING * height { RESTING * height / UNEXPLAINED } else { 0.0 }
    }

    /// Lets both halves have their own answers and looks whether that leaves over much less.
    pub(super) fn refuse_contradiction(
        &self,
        p: Parameters,
        left: f64,
        over: &Over,
    ) -> Result<(), FitError> {
        let unknowns = self.free.len();
        let Some(freedom) = self.samples.len().checked_sub(2 * unknowns).filter(|n| *n > 0) else {
            return Ok(());
        };
        let (first, second) = self.samples.split_at(self.samples.len() / 2);
        let mut gained = 0.0;
        for half in [first, second] {
            let (matrix, right) = self.normal(p, half);
            let Some(factors) = matrix.cholesky() else { return Ok(()) };
            gained += right.dot(&factors.solve(&right));
        }
        #[expect(clippy::cast_precision_loss, reason = "counts of samples and unknowns")]
        let (freedom, unknowns) = (freedom as f64, unknowns as f64);
        let rest = (left - gained).max(f64::MIN_POSITIVE);
        let chance = match &over.rounded {
            // The halves see the same error of rounding wherever the slave dwells, each its own one.
            Some((step, tried)) => {
                let weights: f64 = self.samples.iter().map(|s| s.weight).sum();
                let least = step * step / 12.0 * weights / (freedom + 2.0 * unknowns);
                unknowns * (rest / freedom).max(least) + tried.gained
            }
            None => unknowns * rest / freedom,
        };
        let f = gained / chance;
        // Rounding of data without noise is not a contradiction.
        let size: f64 = self.samples.iter().map(|s| s.weight * s.slave.powi(2)).sum();
        // Where what is left over is known from few samples, F is often large by chance: its own distribution says how often.
        let beyond =
            if freedom < MANY { fisher_exceeds(f, unknowns, freedom) < CHANCE } else { f > ALIKE };
        if beyond && gained > 1e-18 * size { Err(FitError::Contradictory { f }) } else { Ok(()) }
    }

    /// Nothing but the slave's offset is told by a master that stands.
    pub(super) fn refuse_still(&self, free: Free) -> Result<(), FitError> {
        let masters = self.samples.iter().map(|sample| sample.master);
        let (low, high) =
            masters.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), m| (a.min(m), b.max(m)));
        let still = high - low <= 1e-12 * low.abs().max(high.abs()).max(self.width());
        let both = free.slave_offset && free.slave_scaling;
        let asked = free.master_offset || free.master_scaling || both;
        if still && asked {
            let (samples, unknowns) = (self.samples.len(), self.names());
            return Err(FitError::Still { master: low, samples, unknowns });
        }
        Ok(())
    }

    /// What to say if the slave rests, so that nothing was found.
    pub(super) fn resting(&self, options: &FitOptions) -> Option<FitError> {
        // Where it rests tells one line of it.
        if self.is_line() {
            return None;
        }
        let slaves = self.samples.iter().map(|sample| sample.slave);
        let (low, high) =
            slaves.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(s), b.max(s)));
        let Range { min, max, .. } = self.curve.extremes().position;
        let (moved, height) = (high - low, (max - min) * options.slave_scaling.abs());
        let rests = height > 0.0 && moved <= RESTING * height;
        rests.then(|| FitError::Resting { moved, height, unknowns: self.names() })
    }

    /// What to say if the slave moves by more than it can on so short a way of the master, wherever on the cam: the greatest
    /// slope holds for all of it.
    pub(super) fn too_far(&self, options: &FitOptions) -> Option<FitError> {
        let reach = |of: fn(&Sample) -> f64| {
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            let (low, high) =
                self.samples.iter().map(of).fold(ends, |(a, b), v| (a.min(v), b.max(v)));
            high - low
        };
        let (moved, way) = (reach(|s| s.slave), reach(|s| s.master));
        let scaling = options.master_scaling.abs() * (1.0 + options.scaling_range.abs());
        let slope = self.curve.extremes().velocity.magnitude() * options.slave_scaling.abs();
        let most = slope * scaling * way;
        (moved > TOO_FAR * most).then(|| FitError::TooFar { moved, way, most, width: self.width() })
    }
}
