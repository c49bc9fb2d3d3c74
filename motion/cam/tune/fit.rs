//! Offsets and scalings of a cam from a recorded run.
//!
//! slave = `SlaveScaling` · y(master · `MasterScaling` + `MasterOffset`) + `SlaveOffset`. For given values of the master
//! the other two follow from a line, so these are looked for on a grid first; the best of every valley is then improved by
//! Gauss and Newton's method with exact derivatives, all together.

use super::super::curve::Curve;
use super::student::student_975;
use super::{Estimate, FitError};
use nalgebra::{DMatrix, DVector};

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
    /// `MasterOffset`, u: the value if it is not looked for.
    pub master_offset: f64,
    /// `MasterScaling`: the value, or about which it is looked for.
    pub master_scaling: f64,
    /// By which part of itself `MasterScaling` may differ.
    pub scaling_range: f64,
    /// `SlaveOffset`, u: the value if it is not looked for.
    pub slave_offset: f64,
    /// `SlaveScaling`: the value if it is not looked for.
    pub slave_scaling: f64,
    /// Whether the cam is put end to end.
    pub repeated: bool,
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
        }
    }
}

/// What a recorded run tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// `MasterOffset`, u; of a cam that is put end to end, the one next to 0.
    pub master_offset: Estimate,
    /// `MasterScaling`.
    pub master_scaling: Estimate,
    /// `SlaveOffset`, u.
    pub slave_offset: Estimate,
    /// `SlaveScaling`.
    pub slave_scaling: Estimate,
    /// What is left over, weighted root mean square, u.
    pub rms: f64,
    /// Correlation of what is left over from one sample to the next. If it is far from 0, what is left over is not noise
    /// and the intervals are too narrow.
    pub correlation: f64,
}

impl Fit {
    /// Whether what is left over looks like noise that is independent from sample to sample, as the intervals need it.
    pub fn is_noise(&self, samples: usize) -> bool {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let chance = 1.0 / (samples.max(1) as f64).sqrt();
        self.correlation.abs() <= 5.0 * chance
    }
}

/// Samples that the search looks at; the fit then takes them all.
const SEARCHED: usize = 256;
/// Valleys that are gone down.
const VALLEYS: usize = 6;
/// Of the spread of the slave this part at most may be left over.
const UNEXPLAINED: f64 = 0.5;
/// Two answers fit alike if the worse one leaves over less than this many times what chance does.
const ALIKE: f64 = 25.0;

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
    let mut answers: Vec<(f64, Parameters)> = Vec::new();
    for start in problem.valleys(options) {
        if let Some(answer) = problem.descend(start) {
            answers.push(answer);
        }
    }
    answers.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some((left, best)) = answers.first().copied() else {
        return Err(FitError::Undetermined { unknowns: problem.names() });
    };
    problem.report(left, best, &answers)
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

    /// Starts at the bottom of the best valleys of a grid over what concerns the master.
    fn valleys(&self, options: &FitOptions) -> Vec<Parameters> {
        let stride = self.samples.len().div_ceil(SEARCHED);
        let some: Vec<_> = self.samples.iter().step_by(stride).copied().collect();
        let few = Problem { samples: &some, ..*self };
        let Free { master_offset, master_scaling, .. } = options.free;
        let masters = some.iter().map(|sample| sample.master);
        let (low, high) =
            masters.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), m| (a.min(m), b.max(m)));
        let scalings = if master_scaling {
            // So fine that the ends of the run differ by a small part of the cam.
            let range = options.scaling_range.abs() * options.master_scaling.abs();
            let step = self.width() / 24.0 / (high - low).max(f64::MIN_POSITIVE);
            steps(options.master_scaling - range, options.master_scaling + range, step, 60)
        } else {
            vec![options.master_scaling]
        };
        let mut found: Vec<(f64, Parameters)> = Vec::new();
        for scaling in scalings {
            let offsets = if master_offset {
                let half = self.width() / 2.0;
                // Without an end to end cam the run may lie anywhere on it.
                let middle = if self.repeated {
                    0.0
                } else {
                    self.curve.start() + half - f64::midpoint(low, high) * scaling
                };
                let reach = if self.repeated { half } else { 2.0 * half };
                let pieces = self.curve.pieces().len();
                steps(middle - reach, middle + reach, self.width() / 64.0, 8 * pieces.clamp(16, 64))
            } else {
                vec![options.master_offset]
            };
            let row: Vec<_> = offsets
                .into_iter()
                .map(|offset| {
                    let given = [offset, scaling, options.slave_offset, options.slave_scaling];
                    few.project(given, options.free)
                })
                .collect();
            for (index, (left, start)) in row.iter().enumerate() {
                let beside = |index: Option<usize>| {
                    index.and_then(|index| row.get(index)).is_none_or(|(other, _)| left <= other)
                };
                if beside(index.checked_sub(1)) && beside(Some(index + 1)) {
                    found.push((*left, *start));
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().take(VALLEYS).map(|(_, start)| start).collect()
    }

    /// The best slave offset and scaling for given values of the master.
    fn project(&self, mut p: Parameters, free: Free) -> (f64, Parameters) {
        let [mut w, mut wy, mut wyy, mut ws, mut wys] = [0.0; 5];
        for sample in self.samples {
            let y = self.model([p[0], p[1], 0.0, 1.0], sample.master).0;
            w += sample.weight;
            wy += sample.weight * y;
            wyy += sample.weight * y * y;
            ws += sample.weight * sample.slave;
            wys += sample.weight * y * sample.slave;
        }
        let spread = wyy - wy * wy / w;
        match (free.slave_offset, free.slave_scaling) {
            (true, true) if spread > 1e-12 * wyy => {
                p[3] = (wys - wy * ws / w) / spread;
                p[2] = (ws - p[3] * wy) / w;
            }
            (true, _) => p[2] = (ws - p[3] * wy) / w,
            (false, true) if wyy > 0.0 => p[3] = (wys - p[2] * wy) / wyy,
            (false, _) => {}
        }
        (self.left(p), p)
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
            let (value, all) = self.model(p, sample.master);
            let pick = |index: &usize| all.get(*index).copied().unwrap_or(0.0);
            let row = DVector::from_iterator(n, self.free.iter().map(pick));
            right.axpy(sample.weight * (sample.slave - value), &row, 1.0);
            matrix.ger(sample.weight, &row, &row, 1.0);
        }
        (matrix, right)
    }

    fn moved(&self, mut p: Parameters, by: &DVector<f64>) -> Parameters {
        for (index, by) in self.free.iter().zip(by.iter()) {
            if let Some(value) = p.get_mut(*index) {
                *value += by;
            }
        }
        p
    }

    /// Down to the bottom, with steps damped where they do not lead down.
    fn descend(&self, start: Parameters) -> Option<(f64, Parameters)> {
        let (mut p, mut left) = (start, self.left(start));
        let mut damping = 1e-6;
        for _ in 0..100 {
            let (matrix, right) = self.normal(p, self.samples);
            let mut damped = matrix.clone();
            for index in 0..self.free.len() {
                if let Some(value) = damped.get_mut((index, index)) {
                    *value *= 1.0 + damping;
                }
            }
            let step = damped.cholesky()?.solve(&right);
            let next = self.moved(p, &step);
            let after = self.left(next);
            if after.is_finite() && after <= left {
                let gained = left - after;
                (p, left) = (next, after);
                damping = (damping * 0.1).max(1e-12);
                if gained <= 1e-13 * left {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        Some((left, p))
    }

    fn report(
        &self,
        left: f64,
        mut best: Parameters,
        answers: &[(f64, Parameters)],
    ) -> Result<Fit, FitError> {
        let unknowns = self.free.len();
        let freedom = self.samples.len() - unknowns;
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let variance = left / freedom as f64;
        let (matrix, _) = self.normal(best, self.samples);
        let inverse = self.invert(&matrix)?;
        self.refuse_unexplained(left)?;
        self.refuse_contradiction(best, left)?;
        self.refuse_second(left, &best, answers, variance)?;
        if self.repeated && self.free.contains(&0) {
            // Whole passes are the same cam, up to what it gains.
            let passes = (best[0] / self.width()).round();
            if passes != 0.0 && (self.curve.rise() == 0.0 || self.free.contains(&2)) {
                best[0] -= passes * self.width();
                best[2] += best[3] * passes * self.curve.rise();
            }
        }
        let t = student_975(freedom);
        let mut estimates = best.map(Estimate::given);
        for (row, index) in self.free.iter().enumerate() {
            if let (Some(estimate), Some(share)) =
                (estimates.get_mut(*index), inverse.get((row, row)))
            {
                estimate.half_width = t * (variance * share).sqrt();
            }
        }
        let [master_offset, master_scaling, slave_offset, slave_scaling] = estimates;
        let weights: f64 = self.samples.iter().map(|sample| sample.weight).sum();
        let rms = (left / weights).sqrt();
        let correlation = self.correlation(best);
        Ok(Fit { master_offset, master_scaling, slave_offset, slave_scaling, rms, correlation })
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

    fn refuse_unexplained(&self, left: f64) -> Result<(), FitError> {
        let sum = |of: &dyn Fn(&Sample) -> f64| {
            self.samples.iter().map(|s| s.weight * of(s)).sum::<f64>()
        };
        let weights = sum(&|_| 1.0);
        let mean = sum(&|s| s.slave) / weights;
        let spread = (sum(&|s| (s.slave - mean).powi(2)) / weights).sqrt();
        let rms = (left / weights).sqrt();
        if rms > UNEXPLAINED * spread { Err(FitError::Unexplained { rms, spread }) } else { Ok(()) }
    }

    /// Lets both halves have their own answers and looks whether that leaves over much less.
    fn refuse_contradiction(&self, p: Parameters, left: f64) -> Result<(), FitError> {
        let unknowns = self.free.len();
        let Some(freedom) = self.samples.len().checked_sub(2 * unknowns + 20) else {
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
        let (freedom, unknowns) = ((freedom + 20) as f64, unknowns as f64);
        let rest = (left - gained).max(f64::MIN_POSITIVE);
        let f = (gained / unknowns) / (rest / freedom);
        // Rounding of data without noise is not a contradiction.
        let size: f64 = self.samples.iter().map(|s| s.weight * s.slave.powi(2)).sum();
        if f > ALIKE && gained > 1e-18 * size { Err(FitError::Contradictory { f }) } else { Ok(()) }
    }

    /// Whether another valley is as deep as the best one.
    fn refuse_second(
        &self,
        left: f64,
        best: &Parameters,
        answers: &[(f64, Parameters)],
        variance: f64,
    ) -> Result<(), FitError> {
        for (other_left, other) in answers {
            for index in self.free {
                let (Some(one), Some(two)) = (best.get(*index), other.get(*index)) else {
                    continue;
                };
                let scale = [self.width(), 1.0, f64::INFINITY, f64::INFINITY];
                let scale = scale.get(*index).copied().unwrap_or(1.0);
                let mut apart = (one - two).abs() / scale;
                if self.repeated && *index == 0 {
                    apart = (apart - apart.round()).abs();
                }
                if apart > 1e-3 && other_left - left <= ALIKE * variance {
                    let unknown = NAMES.get(*index).copied().unwrap_or_default();
                    return Err(FitError::Ambiguous { unknown, one: *one, other: *two });
                }
            }
        }
        Ok(())
    }

    fn correlation(&self, p: Parameters) -> f64 {
        let over = |s: &Sample| s.weight.sqrt() * (s.slave - self.model(p, s.master).0);
        let rest: Vec<_> = self.samples.iter().map(over).collect();
        let square: f64 = rest.iter().map(|r| r * r).sum();
        let beside: f64 = rest.iter().zip(rest.iter().skip(1)).map(|(a, b)| a * b).sum();
        if square > 0.0 { beside / square } else { 0.0 }
    }
}

/// Values from one to another, both included, so many at most.
fn steps(from: f64, to: f64, step: f64, most: usize) -> Vec<f64> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "saturates, and is limited at once"
    )]
    let count = (((to - from) / step).ceil() as usize).clamp(1, most);
    #[expect(clippy::cast_precision_loss, reason = "a few hundred")]
    let at = |index: usize| from + (to - from) * index as f64 / count as f64;
    (0..=count).map(at).collect()
}
