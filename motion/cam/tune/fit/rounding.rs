//! What rounding of the slave's positions does to what is found.
//!
//! What rounding leaves over is no noise: on a dwell it is the same in all samples, and so it is in every turn that comes to
//! the same places; fitting takes part of it away; and noise before rounding makes it less (Widrow and Kollár, Quantization
//! Noise, 2008, ch. 5 to 7). What that comes to is tried: recordings of truths that are as far from what was found as truths
//! are, with noise as there is, are rounded and fitted (a parametric bootstrap: Efron and Tibshirani, An Introduction to the
//! Bootstrap, 1993, §6.5). Where the steps lie is not known, nor how far they are from one dwell to another, but by what the
//! run tells itself.

use super::draws::Draws;
use super::over::{Known, LAGS};
use nalgebra::{DMatrix, DVector};

/// Recordings that are tried.
const TRIED: u32 = 64;
/// Truths of the first round are so many steps off, so that nothing is known from one dwell to another.
const FAR: f64 = 30.0;
/// Samples after which noise no longer knows how it began.
const BEGINS: usize = 40;

/// How positions are rounded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    pub(super) step: f64,
    /// Where one of them lies, as a part of the step, if that is known: with an offset of the slave that is looked for, steps
    /// may lie anywhere on the cam.
    pub(super) place: Option<f64>,
}

/// Noise before rounding: the deviation of what is left over with rounding, as a part of that of each sample, and the
/// correlation of noise from sample to sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noise {
    pub(super) deviation: f64,
    pub(super) correlation: f64,
}

impl Noise {
    /// The deviation of a sample before rounding.
    pub(super) fn before(self, of: &Known, step: f64) -> f64 {
        ((self.deviation * of.deviation).powi(2) - step * step / 12.0).max(0.0).sqrt()
    }
}

/// What came of it.
#[derive(Debug)]
pub(super) struct Tried {
    /// How far what was found is from the truths.
    pub(super) off: Vec<[f64; 4]>,
    /// The variances that rounding alone gives it.
    pub(super) variances: [f64; 4],
    /// Covariances of what rounding leaves over, at the lags 0, 1, …, by the deviation of each sample.
    pub(super) left: [f64; LAGS + 1],
    /// By how much that at lag 0 scatters, standard deviation.
    pub(super) scatter: f64,
    /// The least and the greatest one at lag 1 among them.
    pub(super) next: [f64; 2],
    /// What the squares fall by if both halves have their own answers, on an average.
    pub(super) gained: f64,
}

/// Truths that are so far off that all steps lie anywhere.
pub(super) fn far(known: &[Known], step: f64) -> Vec<[f64; 4]> {
    let mut squares = [0.0; 4];
    for k in known {
        for (square, value) in squares.iter_mut().zip(k.row) {
            *square += value * value;
        }
    }
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let count = known.len() as f64;
    let scales = squares.map(|square| {
        if square > 0.0 { FAR * step / (square / count).sqrt() } else { 0.0 }
    });
    let mut draws = Draws::new(0);
    (0..TRIED)
        .map(|_| {
            let ([a, b], [c, d]) = (draws.normals(), draws.normals());
            let [offset, scaling, shift, factor] = scales;
            [a * offset, b * scaling, c * shift, d * factor]
        })
        .collect()
}

/// Rounds and fits recordings of truths that are so far off.
pub(super) fn tried(known: &[Known], off: &[[f64; 4]], steps: Steps, noise: Noise) -> Tried {
    let Steps { step, place } = steps;
    let unknowns = known.first().map_or(0, |k| k.unknowns);
    let halves = halves(known, unknowns);
    let mut all = Tried { off: Vec::new(), variances: [0.0; 4], left: [0.0; LAGS + 1], scatter: 0.0, next: [f64::INFINITY, f64::NEG_INFINITY], gained: 0.0 };
    let (mut rounding, mut noises) = (vec![0.0; known.len()], vec![0.0; known.len()]);
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    for (index, off) in (1_u32..).zip(off) {
        fill(&mut noises, known, noise, step, u64::from(index));
        let place = place.unwrap_or(f64::from(index) * golden).fract();
        let (mut by_rounding, mut by_noise) = ([0.0; 4], [0.0; 4]);
        for ((k, error), noise) in known.iter().zip(&mut rounding).zip(&noises) {
            let steps = (k.position - dot(&k.row, off) + noise) / step - place;
            *error = (steps.round() - steps) * step;
            add(&mut by_rounding, &k.share, *error);
            add(&mut by_noise, &k.share, *noise);
        }
        let mut both = by_rounding;
        add(&mut both, &by_noise, 1.0);
        for (variance, by) in all.variances.iter_mut().zip(by_rounding) {
            *variance += by * by;
        }
        // What each half would move by.
        let mut from = 0;
        for (count, inverse) in &halves {
            let mut right = [0.0; 4];
            let part = known.iter().zip(rounding.iter().zip(&noises)).skip(from).take(*count);
            for (k, (rounding, noise)) in part {
                add(&mut right, &k.row, k.weight * (rounding + noise - dot(&k.row, &both)));
            }
            from += count;
            let right = DVector::from_iterator(unknowns, right.into_iter().take(unknowns));
            all.gained += right.dot(&(inverse * &right));
        }
        for (k, error) in known.iter().zip(&mut rounding) {
            *error = (*error - dot(&k.row, &by_rounding)) / k.deviation;
        }
        for (lag, sum) in all.left.iter_mut().enumerate() {
            let one: f64 =
                rounding.iter().zip(rounding.iter().skip(lag)).map(|(a, b)| a * b).sum();
            *sum += one;
            if lag == 0 {
                all.scatter += one * one;
            }
            if lag == 1 {
                all.next = [all.next[0].min(one), all.next[1].max(one)];
            }
        }
        all.off.push(both);
    }
    let count = f64::from(TRIED);
    all.variances = all.variances.map(|sum| sum / count);
    all.left = all.left.map(|sum| sum / count);
    all.gained /= count;
    all.scatter = (all.scatter / count - all.left[0].powi(2)).max(0.0).sqrt();
    all
}

/// How many samples each half has, and the inverse of its normal matrix; none if a half does not tell the unknowns apart.
fn halves(known: &[Known], unknowns: usize) -> Vec<(usize, DMatrix<f64>)> {
    let (first, second) = known.split_at(known.len() / 2);
    [first, second]
        .into_iter()
        .filter_map(|half| {
            let mut matrix = DMatrix::zeros(unknowns, unknowns);
            for k in half {
                let row = DVector::from_iterator(unknowns, k.row.into_iter().take(unknowns));
                matrix.ger(k.weight, &row, &row, 1.0);
            }
            Some((half.len(), matrix.try_inverse()?))
        })
        .collect()
}

/// Noise of the first order, as much of it as is left over beside rounding.
fn fill(noises: &mut [f64], known: &[Known], noise: Noise, step: f64, stream: u64) {
    let mut draws = Draws::new(stream);
    let fresh = (1.0 - noise.correlation * noise.correlation).sqrt();
    let mut value = 0.0;
    let mut spare = None;
    let mut next = || {
        let normal = spare.take().unwrap_or_else(|| {
            let [one, other] = draws.normals();
            spare = Some(other);
            one
        });
        value = noise.correlation * value + fresh * normal;
        value
    };
    for _ in 0..BEGINS {
        next();
    }
    for (noise_of, k) in noises.iter_mut().zip(known) {
        let deviation = noise.before(k, step);
        *noise_of = if deviation > 0.0 { deviation * next() } else { 0.0 };
    }
}

pub(super) fn dot(one: &[f64; 4], other: &[f64; 4]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64; 4], what: &[f64; 4], times: f64) {
    for (to, what) in to.iter_mut().zip(what) {
        *to += what * times;
    }
}
