//! Offsets and scalings of a cam from a recorded run.
//!
//! slave = `SlaveScaling` · y(master · `MasterScaling` + `MasterOffset`) + `SlaveOffset`. For given values of the master
//! the other two follow from a line, so these are looked for on a grid first; the best of every valley is then improved by
//! Gauss and Newton's method with exact derivatives, all together. Which of several bottoms is taken that fit alike is in
//! `motion/cam/tune/fit/choice.rs`.

mod choice;
mod correlation;
mod growth;
mod outliers;
mod over;
mod refuse;
mod rounding;
mod search;
mod step;
mod width;

use super::super::curve::Curve;
use super::chance::correlation_exceeds;
use super::{Estimate, FitError};
use choice::Fitted;
use nalgebra::{DMatrix, DVector};
use width::Widths;

/// A sample of a recorded run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Position of the master, u.
    pub master: f64,
    /// Position of the slave, u.
    pub slave: f64,
    /// Its weight: 1 over the variance of the slave's position, up to a common factor.
    pub weight: f64,
}

/// What is looked for; the others stay as they are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "one for each input of the block")]
pub struct Free {
    /// `MasterOffset`.
    pub master_offset: bool,
    /// `MasterScaling`.
    pub master_scaling: bool,
    /// `SlaveOffset`.
    pub slave_offset: bool,
    /// `SlaveScaling`.
    pub slave_scaling: bool,
}

impl Free {
    /// Everything.
    pub const ALL: Self =
        Self { master_offset: true, master_scaling: true, slave_offset: true, slave_scaling: true };

    fn list(self) -> [bool; 4] {
        [self.master_offset, self.master_scaling, self.slave_offset, self.slave_scaling]
    }
}

/// Names of the unknowns, in their order.
const NAMES: [&str; 4] = ["MasterOffset", "MasterScaling", "SlaveOffset", "SlaveScaling"];

/// What a fit begins with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// What is looked for.
    pub free: Free,
    /// `MasterOffset`, u: the value if it is not looked for; else the nearest of those that fit alike is taken.
    pub master_offset: f64,
    /// `MasterScaling`: the value, or about which it is looked for.
    pub master_scaling: f64,
    /// By which part of itself `MasterScaling` may differ.
    pub scaling_range: f64,
    /// `SlaveOffset`, u: the value if it is not looked for.
    pub slave_offset: f64,
    /// `SlaveScaling`: the value if it is not looked for; else its sign is taken where both fit alike.
    pub slave_scaling: f64,
    /// Whether the cam is put end to end.
    pub repeated: bool,
    /// Between what `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling` are where one is meant of several answers that
    /// fit alike; offsets of the master are so but for whole passes of a cam that is put end to end. `MasterScaling` is looked for
    /// there instead of within its range.
    pub between: [Option<[f64; 2]>; 4],
}

impl Default for FitOptions {
    /// Both offsets are looked for, the scalings are 1.
    fn default() -> Self {
        Self {
            free: Free { master_scaling: false, slave_scaling: false, ..Free::ALL },
            master_offset: 0.0,
            master_scaling: 1.0,
            scaling_range: 0.05,
            slave_offset: 0.0,
            slave_scaling: 1.0,
            repeated: true,
            between: [None; 4],
        }
    }
}

/// What a recorded run tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// `MasterOffset`, u; of a cam that is put end to end, the one next to 0, or to the middle of where it is looked for.
    pub master_offset: Estimate,
    /// `MasterScaling`.
    pub master_scaling: Estimate,
    /// `SlaveOffset`, u.
    pub slave_offset: Estimate,
    /// `SlaveScaling`.
    pub slave_scaling: Estimate,
    /// What is left over, weighted root mean square, u.
    pub rms: f64,
    /// Correlation of what is left over from one sample to the next; of positions that are rounded, of what rounding does not
    /// explain, 0 if nothing. If it is far from 0, what is left over is not noise and the intervals are too narrow.
    pub correlation: f64,
    /// What the slave's positions are rounded to, u; 0 if they are not, or noise hides it.
    pub quantum: f64,
    /// Whether the samples show how noise goes on from one to the next: [`Fit::SAMPLES`] do, of positions that are rounded if the
    /// slave moves by [`Fit::STEPS`] steps. If not, the intervals hold for noise that is independent from sample to sample only.
    pub shows_correlation: bool,
    /// The largest part that the bias of noise in the master's positions may have in a half width; the widths hold it.
    pub bias: f64,
    /// Another answer that the samples do not tell from this one: `MasterOffset`, `MasterScaling`, `SlaveOffset` and
    /// `SlaveScaling`. That of this one has the sign of the one that the fit began with, and its `MasterOffset` is clearly nearer to
    /// that; the other one is the next repeat of the cam, or the cam with a mirrored slave.
    pub other: Option<[f64; 4]>,
}

impl Fit {
    /// So many samples show how noise goes on; of fewer, what is by chance is asked of the distribution itself.
    pub const SAMPLES: usize = 50;
    /// Of positions that are rounded and change by fewer steps, noise is seen where they go from one to the next only.
    pub const STEPS: u32 = 100;

    /// Whether what is left over looks like noise for which the intervals hold: one whose correlation from sample to sample is
    /// weak enough to be known from the samples themselves.
    ///
    /// Of few samples no correlation is known: there it is one that independent noise has in one run of ten thousand.
    pub fn is_noise(&self, samples: usize) -> bool {
        if samples < FEW {
            return correlation_exceeds(self.correlation, samples) > CHANCE;
        }
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let by_chance = BY_CHANCE * ((1.0 - STRONG * STRONG) / samples as f64).sqrt();
        // What rounding may have by chance is none of it already.
        let by_chance = if self.quantum > 0.0 { 0.0 } else { by_chance };
        self.correlation.abs() <= (STRONG + by_chance).min(STRONGEST)
    }
}

/// Noise with a correlation beyond this is none: that of so many samples and more of independent noise is 4 standard deviations
/// less.
const STRONG: f64 = 0.6;
/// So many standard deviations (Bartlett's) more are by chance, in all but one run of twenty, but never so much as this.
const BY_CHANCE: f64 = 1.645;
const STRONGEST: f64 = 0.7;
const FEW: usize = Fit::SAMPLES;
/// What is told of few samples noise does in one run of so many.
const CHANCE: f64 = 1e-4;

/// One in so many samples is among the quietest, and so many are at least.
const QUIET: usize = 8;

type Parameters = [f64; 4];

/// Finds offsets and scalings.
///
/// # Errors
/// [`FitError`] if the data do not say what is asked for, or contradict it.
pub fn fit(curve: &Curve, samples: &[Sample], options: &FitOptions) -> Result<Fit, FitError> {
    let free: Vec<usize> =
        options.free.list().iter().enumerate().filter_map(|(i, free)| free.then_some(i)).collect();
    let unknowns = free.len();
    if unknowns == 0 {
        return Err(FitError::NothingFree);
    }
    let needed = 4 * unknowns + 4;
    if samples.len() < needed {
        return Err(FitError::TooFew { found: samples.len(), needed, unknowns });
    }
    check(samples)?;
    let problem = Problem { curve, samples, free: &free, repeated: options.repeated };
    problem.refuse_still(options.free)?;
    let Some(fitted) = problem.solved(options) else {
        return Err(FitError::Undetermined { unknowns: problem.names() });
    };
    problem.report(&fitted, options).map_err(|error| match error {
        FitError::Undetermined { .. } | FitError::Unexplained { .. } => {
            problem.resting(options).or_else(|| problem.too_far(options)).unwrap_or(error)
        }
        other => other,
    })
}

fn check(samples: &[Sample]) -> Result<(), FitError> {
    for (index, sample) in (1..).zip(samples) {
        for (what, value) in [("master", sample.master), ("slave", sample.slave)] {
            if !value.is_finite() {
                return Err(FitError::NoNumber { index, what, value });
            }
        }
        if !(sample.weight.is_finite() && sample.weight > 0.0) {
            return Err(FitError::NoNumber { index, what: "weight", value: sample.weight });
        }
    }
    Ok(())
}

struct Problem<'a> {
    curve: &'a Curve,
    samples: &'a [Sample],
    free: &'a [usize],
    repeated: bool,
}

impl Problem<'_> {
    fn names(&self) -> Vec<&'static str> {
        self.free.iter().filter_map(|index| NAMES.get(*index).copied()).collect()
    }

    /// Down into all valleys, and the answer among their bottoms.
    fn solved(&self, options: &FitOptions) -> Option<Fitted> {
        let bottoms = self.valleys(options).into_iter().filter_map(|start| self.descend(start));
        self.chosen(bottoms.collect(), options)
    }

    fn width(&self) -> f64 {
        self.curve.end() - self.curve.start()
    }

    /// Model and its derivatives by all four.
    fn model(
        &self,
        [offset, scaling, shift, factor]: Parameters,
        master: f64,
    ) -> (f64, Parameters) {
        let x = master * scaling + offset;
        let d = if self.repeated { self.curve.repeated(x) } else { self.curve.at(x) };
        let slope = factor * d.velocity;
        (factor * d.position + shift, [slope, slope * master, 1.0, d.position])
    }

    /// Weighted sum of the squares of what is left over.
    fn left(&self, p: Parameters) -> f64 {
        let square = |s: &Sample| s.weight * (s.slave - self.model(p, s.master).0).powi(2);
        self.samples.iter().map(square).sum()
    }

    /// Normal equations of some samples: matrix and right side.
    fn normal(&self, p: Parameters, samples: &[Sample]) -> (DMatrix<f64>, DVector<f64>) {
        let n = self.free.len();
        let (mut matrix, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for sample in samples {
            let (value, _) = self.model(p, sample.master);
            let row = self.row(p, sample);
            right.axpy(sample.weight * (sample.slave - value), &row, 1.0);
            matrix.ger(sample.weight, &row, &row, 1.0);
        }
        (matrix, right)
    }

    /// Derivatives of the model by what is looked for.
    fn row(&self, p: Parameters, sample: &Sample) -> DVector<f64> {
        let (_, all) = self.model(p, sample.master);
        let pick = |index: &usize| all.get(*index).copied().unwrap_or(0.0);
        DVector::from_iterator(self.free.len(), self.free.iter().map(pick))
    }

    fn moved(&self, mut p: Parameters, by: &DVector<f64>) -> Parameters {
        for (index, by) in self.free.iter().zip(by.iter()) {
            if let Some(value) = p.get_mut(*index) {
                *value += by;
            }
        }
        p
    }

    fn report(&self, fitted: &Fitted, options: &FitOptions) -> Result<Fit, FitError> {
        let Fitted { left, best, other, .. } = *fitted;
        let (matrix, _) = self.normal(best, self.samples);
        let inverse = self.invert(&matrix)?;
        let step = self.rounded_to(best);
        self.refuse_outliers(fitted, options, step)?;
        self.refuse_unexplained(best, left)?;
        let over = self.left_over(best, &inverse, step);
        self.refuse_contradiction(best, left, &over)?;
        if let Some(refused) = &fitted.refused {
            return Err(refused.clone());
        }
        let best = self.folded(best, options);
        let Widths { half, bias } = self.widths(best, &inverse, &over);
        let quantum = over.quantum;
        let mut estimates = best.map(Estimate::given);
        for (index, half) in self.free.iter().zip(half) {
            if let Some(estimate) = estimates.get_mut(*index) {
                estimate.half_width = half;
            }
        }
        let [master_offset, master_scaling, slave_offset, slave_scaling] = estimates;
        let weights: f64 = self.samples.iter().map(|sample| sample.weight).sum();
        let rms = (left / weights).sqrt();
        let correlation = over.correlation;
        Ok(Fit {
            master_offset,
            master_scaling,
            slave_offset,
            slave_scaling,
            rms,
            correlation,
            quantum,
            shows_correlation: self.shows_correlation(quantum),
            bias,
            other: other.map(|other| self.folded(other, options)),
        })
    }

    /// The inverse of the normal matrix, if all unknowns are told apart.
    fn invert(&self, matrix: &DMatrix<f64>) -> Result<DMatrix<f64>, FitError> {
        let scale = matrix.diagonal().map(f64::sqrt);
        if scale.iter().any(|scale| !scale.is_finite() || *scale <= 0.0) {
            return Err(FitError::Undetermined { unknowns: self.names() });
        }
        let outer = &scale * scale.transpose();
        let even = matrix.component_div(&outer).symmetric_eigen();
        let (worst, least) = even.eigenvalues.argmin();
        if least < 1e-9 {
            let parts = even.eigenvectors.column(worst).into_owned();
            let names = self.names();
            let large = parts.iter().zip(names).filter(|(part, _)| part.abs() > 0.2);
            return Err(FitError::Undetermined { unknowns: large.map(|(_, name)| name).collect() });
        }
        matrix
            .clone()
            .try_inverse()
            .ok_or_else(|| FitError::Undetermined { unknowns: self.names() })
    }

    /// As [`Fit::shows_correlation`].
    fn shows_correlation(&self, quantum: f64) -> bool {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) =
            self.samples.iter().fold(ends, |(a, b), s| (a.min(s.slave), b.max(s.slave)));
        self.samples.len() >= FEW && high - low >= f64::from(Fit::STEPS) * quantum
    }

    /// The step to which the slave's positions are rounded, if it is not far below what is left over: where the slave is
    /// quietest that is least, as rounding shows there most.
    fn rounded_to(&self, p: Parameters) -> Option<f64> {
        let mut over: Vec<(f64, f64)> = self
            .samples
            .iter()
            .map(|s| (self.slope(p, s).abs(), (s.slave - self.model(p, s.master).0).abs()))
            .collect();
        over.sort_by(|a, b| a.0.total_cmp(&b.0));
        let quiet = (over.len() / QUIET).max(QUIET).min(over.len());
        let deviation = |part: &mut [(f64, f64)]| {
            let middle = part.len() / 2;
            part.select_nth_unstable_by(middle, |a, b| a.1.total_cmp(&b.1)).1.1 / growth::MEDIAN
        };
        let least = deviation(over.get_mut(..quiet)?).min(deviation(&mut over));
        let slaves: Vec<f64> = self.samples.iter().map(|s| s.slave).collect();
        // Noise that hides a step, and what is left over with it, is known to a part of itself only.
        step::step(&slaves, 1.5 * least).filter(|step| *step > least)
    }
}
