//! Least-squares fit of a cam to a recorded run: offsets and scalings of master and slave.
//!
//! slave = `SlaveScaling` · y(master · `MasterScaling` + `MasterOffset`) + `SlaveOffset`. For given values of the master the fit
//! is linear, so these are tried on a grid; Gauss–Newton steps lead from the best places of the grid to their minima. Of minima
//! that fit alike the one next to the coupling in effect is taken, with its sign of `SlaveScaling`.

use super::super::curve::Curve;
use super::bootstrap::Bootstrap;
use super::distributions::correlation_exceeds;
use super::{Estimate, FitError};
use nalgebra::{Matrix4, Vector4};

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

/// The unknowns of a fit; other values stay as they are given.
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

    /// Nothing.
    pub const NONE: Self = Self {
        master_offset: false,
        master_scaling: false,
        slave_offset: false,
        slave_scaling: false,
    };
    /// Both offsets.
    pub const OFFSETS: Self = Self { master_offset: true, slave_offset: true, ..Self::NONE };

    /// In the order of the inputs.
    pub fn list(self) -> [bool; 4] {
        [self.master_offset, self.master_scaling, self.slave_offset, self.slave_scaling]
    }
}

/// Names of the unknowns, in their order.
pub(super) const NAMES: [&str; 4] =
    ["MasterOffset", "MasterScaling", "SlaveOffset", "SlaveScaling"];

/// What a fit begins with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// The unknowns.
    pub free: Free,
    /// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling` in effect. Values that are not looked for stay; of
    /// several answers that fit alike the one with the sign of this `SlaveScaling` and the nearest `MasterOffset` is taken.
    pub from: [f64; 4],
    /// Whether the cam is periodic.
    pub repeated: bool,
    /// Intervals of the four values, where the user says which of several answers is meant; `MasterOffset` but for whole passes
    /// of a periodic cam. `MasterScaling` is looked for in its interval, or within 5 % of itself.
    pub between: [Option<[f64; 2]>; 4],
}

impl Default for FitOptions {
    /// Both offsets are looked for, the scalings are 1.
    fn default() -> Self {
        Self { free: Free::OFFSETS, from: [0.0, 1.0, 0.0, 1.0], repeated: true, between: [None; 4] }
    }
}

/// Offsets and scalings that a recorded run determines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// `MasterOffset` (u; of a periodic cam the one next to 0, or to the middle of its interval), `MasterScaling`,
    /// `SlaveOffset` (u) and `SlaveScaling`.
    pub estimates: [Estimate; 4],
    /// Weighted root mean square of the residuals, u.
    pub rms: f64,
    /// Correlation of the residuals from sample to sample, beyond what rounding explains.
    pub correlation: f64,
    /// Quantum of the slave's positions, u; 0 if they are not rounded, or noise hides it.
    pub quantum: f64,
}

impl Fit {
    /// From this number of samples on the correlation of their noise is estimated; intervals of fewer hold for independent noise.
    pub const SAMPLES: usize = 50;

    /// Whether the residuals look like noise for which the intervals hold.
    ///
    /// Of few samples the correlation is too strong if independent noise has it in less than one run of ten thousand.
    pub fn is_noise(&self, samples: usize) -> bool {
        if samples < Self::SAMPLES {
            return correlation_exceeds(self.correlation, samples) > CHANCE;
        }
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let by_chance = BY_CHANCE * ((1.0 - STRONG * STRONG) / samples as f64).sqrt();
        self.correlation.abs() <= (STRONG + by_chance).min(STRONGEST)
    }
}

/// The largest correlation of noise, the standard deviations that an estimate may exceed it by, and the largest estimate.
const STRONG: f64 = 0.6;
const BY_CHANCE: f64 = 1.645;
const STRONGEST: f64 = 0.7;
/// Probability with which independent noise is refused.
pub(super) const CHANCE: f64 = 1e-4;
/// Part of itself within which `MasterScaling` is looked for.
const SCALING_RANGE: f64 = 0.05;
/// Samples that the grid search looks at.
const SEARCHED: usize = 256;
/// Minima that are followed for each sign of `SlaveScaling`: the best ones, and those next to the coupling in effect.
const VALLEYS: usize = 6;
const NEAREST: usize = 3;
/// Two answers fit alike if the worse one leaves over less than this many times what chance does.
pub(super) const ALIKE: f64 = 25.0;
/// Answers differ if they are apart by more than this part of the cam, or by as much in `MasterScaling`.
const APART: f64 = 1e-3;
/// The nearest answer is clear if it is no farther than this part of the distance between it and the next one.
const CLEARLY: f64 = 0.25;
/// This part of the squares of the slave's positions is rounding.
pub(super) const ROUNDING: f64 = 1e-18;

pub(super) type Values = [f64; 4];

/// Finds offsets and scalings.
///
/// # Errors
/// [`FitError`] if the data do not determine the unknowns, or contradict the cam.
pub fn fit(curve: &Curve, samples: &[Sample], options: &FitOptions) -> Result<Fit, FitError> {
    let free = options.free.list();
    let unknowns = free.iter().filter(|free| **free).count();
    let needed = 4 * unknowns + 4;
    if samples.len() < needed {
        return Err(FitError::TooFew { found: samples.len(), needed, unknowns });
    }
    for (index, sample) in (1..).zip(samples) {
        let weight = if sample.weight > 0.0 { 1.0 / sample.weight } else { f64::NAN };
        for (what, value, check) in [
            ("master", sample.master, sample.master),
            ("slave", sample.slave, sample.slave),
            ("weight", sample.weight, weight),
        ] {
            if !check.is_finite() {
                return Err(FitError::NoNumber { index, what, value });
            }
        }
    }
    let problem = Problem { curve, samples, free, repeated: options.repeated };
    problem.refuse_still()?;
    problem.judged(&problem.solved(options)?, options)
}

/// Samples of a run, and which of the four values are looked for.
#[derive(Clone, Copy)]
pub(super) struct Problem<'a> {
    pub(super) curve: &'a Curve,
    pub(super) samples: &'a [Sample],
    pub(super) free: [bool; 4],
    pub(super) repeated: bool,
}

/// The answer that is taken.
pub(super) struct Answer {
    /// Weighted sum of the squares of its residuals.
    pub(super) left: f64,
    pub(super) values: Values,
    /// Why it is refused, if the data and the noise are sound otherwise.
    refused: Option<FitError>,
}

impl Problem<'_> {
    pub(super) fn names(&self) -> Vec<&'static str> {
        NAMES.into_iter().zip(self.free).filter_map(|(name, free)| free.then_some(name)).collect()
    }

    pub(super) fn unknowns(&self) -> usize {
        self.free.iter().filter(|free| **free).count()
    }

    pub(super) fn width(&self) -> f64 {
        self.curve.end() - self.curve.start()
    }

    /// Sum over all samples.
    pub(super) fn sum(&self, of: impl Fn(&Sample) -> f64) -> f64 {
        self.samples.iter().map(of).sum()
    }

    /// Least and greatest value of a sample.
    pub(super) fn ends(&self, of: impl Fn(&Sample) -> f64) -> [f64; 2] {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        self.samples.iter().map(of).fold(ends, |[low, high], v| [low.min(v), high.max(v)])
    }

    /// Position of the slave and its derivatives by the values that are looked for; 0 by the others.
    pub(super) fn model(&self, p: Values, master: f64) -> (f64, Vector4<f64>) {
        let [offset, scaling, shift, factor] = p;
        let x = master * scaling + offset;
        let d = if self.repeated { self.curve.repeated(x) } else { self.curve.at(x) };
        let slope = factor * d.velocity;
        let all = [slope, slope * master, 1.0, d.position];
        let row = Vector4::from_fn(|index, _| if self.free[index] { all[index] } else { 0.0 });
        (factor * d.position + shift, row)
    }

    /// The residual of a sample.
    pub(super) fn over(&self, p: Values, sample: &Sample) -> f64 {
        sample.slave - self.model(p, sample.master).0
    }

    pub(super) fn left(&self, p: Values) -> f64 {
        self.sum(|s| s.weight * self.over(p, s).powi(2))
    }

    /// Normal equations: matrix, with 1 on the diagonal for given values, and right side.
    pub(super) fn normal(&self, p: Values) -> (Matrix4<f64>, Vector4<f64>) {
        let fixed = self.free.map(|free| if free { 0.0 } else { 1.0 });
        let mut matrix = Matrix4::from_diagonal(&Vector4::from(fixed));
        let mut right = Vector4::zeros();
        for sample in self.samples {
            let (value, row) = self.model(p, sample.master);
            right += row * (sample.weight * (sample.slave - value));
            matrix += row * row.transpose() * sample.weight;
        }
        (matrix, right)
    }

    /// The inverse of the normal matrix, if the data determine all unknowns.
    fn inverse(&self, p: Values) -> Result<Matrix4<f64>, FitError> {
        let (matrix, _) = self.normal(p);
        let all = || FitError::Undetermined { unknowns: self.names() };
        let scale = matrix.diagonal().map(f64::sqrt);
        if scale.iter().any(|scale| !scale.is_finite() || *scale <= 0.0) {
            return Err(all());
        }
        let even = matrix.component_div(&(scale * scale.transpose())).symmetric_eigen();
        let (worst, least) = even.eigenvalues.argmin();
        if least < 1e-9 {
            let parts = even.eigenvectors.column(worst).into_owned();
            let large = NAMES.into_iter().zip(parts.iter()).filter(|(_, part)| part.abs() > 0.2);
            return Err(FitError::Undetermined { unknowns: large.map(|(name, _)| name).collect() });
        }
        matrix.try_inverse().ok_or_else(all)
    }

    fn judged(&self, answer: &Answer, options: &FitOptions) -> Result<Fit, FitError> {
        let Answer { left, values, refused } = answer;
        let inverse = self.inverse(*values)?;
        let step = self.quantum(*values);
        self.refuse_outliers(*values, options, step.unwrap_or_default())?;
        self.refuse_unexplained(*left)?;
        let residuals = self.residuals(*values, &inverse, step.unwrap_or_default());
        let found = Bootstrap::new(self, &residuals, step);
        self.refuse_contradiction(*values, *left, step.unwrap_or_default())?;
        if let Some(refused) = refused {
            return Err(refused.clone());
        }
        let shift = self.attenuation(*values, &inverse, step.unwrap_or_default());
        let values = self.folded(*values, options);
        let estimates = std::array::from_fn(|index| {
            let half_width =
                if self.free[index] { found.half[index] + shift[index].abs() } else { 0.0 };
            Estimate { value: values[index], half_width }
        });
        let rms = (left / self.sum(|s| s.weight)).sqrt();
        let Bootstrap { correlation, quantum, .. } = found;
        Ok(Fit { estimates, rms, correlation, quantum })
    }

    /// The answer among the minima of the best places of the grid.
    pub(super) fn solved(&self, options: &FitOptions) -> Result<Answer, FitError> {
        let minima: Vec<_> =
            self.starts(options).into_iter().filter_map(|start| self.descend(start)).collect();
        self.chosen(minima, options)
            .ok_or_else(|| FitError::Undetermined { unknowns: self.names() })
    }

    /// The best places of a grid over the values of the master.
    fn starts(&self, options: &FitOptions) -> Vec<Values> {
        let stride = self.samples.len().div_ceil(SEARCHED);
        let some: Vec<_> = self.samples.iter().step_by(stride).copied().collect();
        let few = Problem { samples: &some, ..*self };
        let [low, high] = few.ends(|sample| sample.master);
        let from = options.from;
        let scalings = if self.free[1] {
            // So fine that the ends of the run move by a small part of the cam.
            let range = SCALING_RANGE * from[1].abs();
            let given = options.between[1].filter(|ends| ends.iter().all(|end| end.is_finite()));
            let ends = given.unwrap_or([from[1] - range, from[1] + range]);
            grid(ends, self.width() / 24.0 / (high - low).max(f64::MIN_POSITIVE), 60)
        } else {
            vec![from[1]]
        };
        let mut found: Vec<(f64, Values)> = Vec::new();
        for scaling in scalings {
            let offsets = if self.free[0] {
                let half = self.width() / 2.0;
                // The run may lie anywhere on a cam that is passed once.
                let (middle, reach) = if self.repeated {
                    (0.0, half)
                } else {
                    (self.curve.start() + half - f64::midpoint(low, high) * scaling, 2.0 * half)
                };
                let most = 8 * self.curve.pieces().len().clamp(16, 64);
                grid([middle - reach, middle + reach], self.width() / 64.0, most)
            } else {
                vec![from[0]]
            };
            let at = |offset| few.project([offset, scaling, from[2], from[3]]);
            let row: Vec<_> = offsets.into_iter().map(at).collect();
            let left = |index: usize| row.get(index).map_or(f64::INFINITY, |(left, _)| *left);
            for (index, place) in row.iter().enumerate() {
                if place.0 <= left(index.wrapping_sub(1)) && place.0 <= left(index + 1) {
                    found.push(*place);
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let near = options.between[0].map_or(from[0], |[low, high]| f64::midpoint(low, high));
        let far = |p: &Values| self.apart(p[0], near);
        let mut starts = Vec::new();
        for mirrored in [false, true] {
            let same = |(_, p): &&(f64, Values)| (p[3] * from[3] < 0.0) == mirrored;
            let mut best: Vec<Values> = found.iter().filter(same).map(|(_, p)| *p).collect();
            let mut rest = best.split_off(VALLEYS.min(best.len()));
            rest.sort_by(|a, b| far(a).total_cmp(&far(b)));
            starts.extend(best.into_iter().chain(rest.into_iter().take(NEAREST)));
        }
        starts
    }

    /// The best `SlaveOffset` and `SlaveScaling` for given values of the master.
    fn project(&self, mut p: Values) -> (f64, Values) {
        let [mut w, mut wy, mut wyy, mut ws, mut wys] = [0.0; 5];
        for Sample { master, slave, weight } in self.samples {
            let y = self.model([p[0], p[1], 0.0, 1.0], *master).0;
            w += weight;
            wy += weight * y;
            wyy += weight * y * y;
            ws += weight * slave;
            wys += weight * y * slave;
        }
        let spread = wyy - wy * wy / w;
        match (self.free[2], self.free[3]) {
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

    /// Damped Gauss–Newton steps to a minimum.
    fn descend(&self, start: Values) -> Option<(f64, Values)> {
        let (mut p, mut left) = (start, self.left(start));
        let mut damping = 1e-6;
        for _ in 0..100 {
            let (mut matrix, right) = self.normal(p);
            for index in 0..4 {
                matrix[(index, index)] *= 1.0 + damping;
            }
            let step = matrix.cholesky()?.solve(&right);
            let next = std::array::from_fn(|index| p[index] + step[index]);
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

    /// The answer among minima, each with the squares that it leaves over.
    fn chosen(&self, mut minima: Vec<(f64, Values)>, options: &FitOptions) -> Option<Answer> {
        minima.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (least, _) = *minima.first()?;
        let freedom = self.samples.len().saturating_sub(self.unknowns()).max(1);
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let room = (ALIKE * least / freedom as f64)
            .max(ROUNDING * self.sum(|s| s.weight * s.slave.powi(2)));
        let mut alike: Vec<(f64, Values)> = Vec::new();
        for (left, p) in minima {
            let differs = |(_, other): &(f64, Values)| {
                self.apart(p[0], other[0]) > APART * self.width() || (p[1] - other[1]).abs() > APART
            };
            if left - least <= room && alike.iter().all(differs) {
                alike.push((left, p));
            }
        }
        let mut refused = self.beyond(&alike.first()?.1, options);
        if alike.iter().any(|(_, p)| self.beyond(p, options).is_none()) {
            refused = None;
            alike.retain(|(_, p)| self.beyond(p, options).is_none());
        }
        let far = |p: &Values| self.apart(p[0], options.from[0]);
        let mirrored = |p: &Values| p[3] * options.from[3] < 0.0;
        alike.sort_by(|(_, a), (_, b)| {
            mirrored(a).cmp(&mirrored(b)).then(far(a).total_cmp(&far(b)))
        });
        let ((left, best), others) = alike.split_first()?;
        let same = || others.iter().map(|(_, p)| p).filter(|p| mirrored(p) == mirrored(best));
        let apart = |p: &Values| self.apart(p[0], best[0]);
        let scaled = same().find(|p| (p[1] - best[1]).abs() > APART).map(|p| (1, p));
        let next = same().min_by(|a, b| apart(a).total_cmp(&apart(b))).map(|p| (0, p));
        let ambiguous = scaled.or(next.filter(|(_, p)| far(best) > CLEARLY * apart(p)));
        let ambiguous = ambiguous.map(|(index, p)| {
            let [one, other] = [best, p].map(|p| self.folded(*p, options)[index]);
            let (unknown, begun) = (NAMES[index], options.from[index]);
            FitError::Ambiguous { unknown, one, other, begun }
        });
        Some(Answer { left: *left, values: *best, refused: refused.or(ambiguous) })
    }

    /// How far apart offsets of the master are on the cam, whole passes of a periodic cam aside.
    fn apart(&self, one: f64, other: f64) -> f64 {
        let by = one - other;
        let passes = if self.repeated { (by / self.width()).round() } else { 0.0 };
        (by - passes * self.width()).abs()
    }

    /// The same motion with the `MasterOffset` next to 0, or to the middle of its interval, by whole passes of a periodic cam.
    fn folded(&self, mut p: Values, options: &FitOptions) -> Values {
        if self.repeated && self.free[0] {
            let middle = options.between[0].map(|[low, high]| f64::midpoint(low, high));
            let near = middle.filter(|middle| middle.is_finite()).unwrap_or(0.0);
            let passes = ((p[0] - near) / self.width()).round();
            if passes != 0.0 && (self.curve.rise() == 0.0 || self.free[2]) {
                p[0] -= passes * self.width();
                p[2] += p[3] * passes * self.curve.rise();
            }
        }
        p
    }

    /// The value of an answer that is outside of its interval.
    fn beyond(&self, p: &Values, options: &FitOptions) -> Option<FitError> {
        let p = self.folded(*p, options);
        (0..4).filter(|index| self.free[*index]).find_map(|index| {
            let (value, between) = (p[index], options.between[index]?);
            let outside = !(between[0]..=between[1]).contains(&value);
            outside.then_some(FitError::Beyond { unknown: NAMES[index], value, between })
        })
    }
}

/// Values from one end to the other, both included, of at most this step unless they would be more than `most`.
fn grid([from, to]: [f64; 2], step: f64, most: usize) -> Vec<f64> {
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
