//! What rounding of the slave's positions does to what is found.
//!
//! What rounding leaves over is no noise: on a dwell it is the same in all samples, and so it is in every turn that comes to
//! the same places; fitting takes part of it away; and noise before rounding makes it less (Widrow and Kollár, Quantization
//! Noise, 2008, ch. 5 to 7). What that comes to is tried: recordings of truths that are as far from what was found as truths
//! are, with noise as there is, are rounded and fitted (a parametric bootstrap: Efron and Tibshirani, An Introduction to the
//! Bootstrap, 1993, §6.5). Where the steps lie is not known, nor how far they are from one dwell to another, but by what the
//! run tells itself.

use super::super::draws::Draws;
use super::over::{Known, LAGS};
use nalgebra::{DMatrix, DVector};

/// Truths that are far off.
const TRUTHS: u32 = 32;
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
    /// The sums of squares of all and of those that are clear, and by how much these scatter, standard deviations.
    pub(super) squares: [f64; 2],
    pub(super) scatter: [f64; 2],
    /// The least and the greatest sum of products of neighbours that are clear.
    pub(super) beside: [f64; 2],
    /// What the squares fall by through rounding if both halves have their own answers, on an average.
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
    let scales =
        squares.map(|square| if square > 0.0 { FAR * step / (square / count).sqrt() } else { 0.0 });
    let mut draws = Draws::new(0);
    (0..TRUTHS)
        .map(|_| {
            let ([a, b], [c, d]) = (draws.normals(), draws.normals());
            let [offset, scaling, shift, factor] = scales;
            [a * offset, b * scaling, c * shift, d * factor]
        })
        .collect()
}

/// Rounds and fits so many recordings of truths that are so far off, each with other noise and steps elsewhere.
pub(super) fn tried(
    known: &[Known],
    (off, recordings): (&[[f64; 4]], usize),
    steps: Steps,
    noise: Noise,
) -> Tried {
    let Steps { step, place } = steps;
    let unknowns = known.first().map_or(0, |k| k.unknowns);
    let halves = halves(known, unknowns);
    let mut all = Tried {
        off: Vec::new(),
        variances: [0.0; 4],
        left: [0.0; LAGS + 1],
        squares: [0.0; 2],
        scatter: [0.0; 2],
        beside: [f64::INFINITY, f64::NEG_INFINITY],
        gained: 0.0,
    };
    let (mut rounding, mut noises) = (vec![0.0; known.len()], vec![0.0; known.len()]);
    let before: Vec<f64> = known.iter().map(|k| noise.before(k, step)).collect();
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    for (index, off) in (1_u32..).zip(off.iter().cycle().take(recordings)) {
        fill(&mut noises, &before, noise.correlation, u64::from(index));
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
            for (k, error) in known.iter().zip(&rounding).skip(from).take(*count) {
                add(&mut right, &k.row, k.weight * (error - dot(&k.row, &by_rounding)));
            }
            from += count;
            let right = DVector::from_iterator(unknowns, right.into_iter().take(unknowns));
            all.gained += right.dot(&(inverse * &right));
        }
        for (k, error) in known.iter().zip(&mut rounding) {
            *error = (*error - dot(&k.row, &by_rounding)) / k.deviation;
        }
        for (lag, sum) in all.left.iter_mut().enumerate() {
            *sum += rounding.iter().zip(rounding.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>();
        }
        let [square, beside] = clear(known, &rounding);
        let squares = [rounding.iter().map(|value| value * value).sum(), square];
        for ((sum, scatter), square) in all.squares.iter_mut().zip(&mut all.scatter).zip(squares) {
            *sum += square;
            *scatter += square * square;
        }
        all.beside = [all.beside[0].min(beside), all.beside[1].max(beside)];
        all.off.push(both);
    }
    #[expect(clippy::cast_precision_loss, reason = "a few")]
    let count = all.off.len().max(1) as f64;
    all.variances = all.variances.map(|sum| sum / count);
    all.left = all.left.map(|sum| sum / count);
    all.gained /= count;
    all.squares = all.squares.map(|sum| sum / count);
    for (scatter, square) in all.scatter.iter_mut().zip(all.squares) {
        *scatter = (*scatter / count - square * square).max(0.0).sqrt();
    }
    all
}

/// The sums of squares, and of products of neighbours, of those that are clear.
pub(super) fn clear(known: &[Known], values: &[f64]) -> [f64; 2] {
    let (mut square, mut beside, mut before) = (0.0, 0.0, 0.0);
    for (k, value) in known.iter().zip(values) {
        let value = if k.clear { *value } else { 0.0 };
        square += value * value;
        beside += value * before;
        before = value;
    }
    [square, beside]
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

/// Noise of the first order with these deviations.
fn fill(noises: &mut [f64], deviations: &[f64], correlation: f64, stream: u64) {
    let mut draws = Draws::new(stream);
    let fresh = (1.0 - correlation * correlation).sqrt();
    let mut value = 0.0;
    let mut spare = None;
    let mut next = || {
        let normal = spare.take().unwrap_or_else(|| {
            let [one, other] = draws.normals();
            spare = Some(other);
            one
        });
        value = correlation * value + fresh * normal;
        value
    };
    for _ in 0..BEGINS {
        next();
    }
    for (noise, deviation) in noises.iter_mut().zip(deviations) {
        *noise = if *deviation > 0.0 { deviation * next() } else { 0.0 };
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

#[cfg(test)]
mod tests {
    use super::{Known, Noise, Steps, far, tried};

    const Q: f64 = 0.2;

    /// The mean of so many positions, its variance by rounding, with so much noise.
    fn variance(positions: &[f64], off: &[[f64; 4]], noise: f64) -> f64 {
        let share = 1.0 / f64::from(u32::try_from(positions.len()).expect("few"));
        let known: Vec<_> = positions
            .iter()
            .map(|position| Known {
                unknowns: 1,
                row: [1.0, 0.0, 0.0, 0.0],
                share: [share, 0.0, 0.0, 0.0],
                weight: 1.0,
                over: 0.0,
                leverage: share,
                position: *position,
                deviation: 1.0,
                clear: true,
            })
            .collect();
        let off = if off.is_empty() { far(&known, Q) } else { off.to_vec() };
        let noise = Noise { deviation: noise.hypot(Q / 12.0_f64.sqrt()), correlation: 0.0 };
        let found = tried(&known, (&off, 64), Steps { step: Q, place: None }, noise);
        assert_eq!(found.off.len(), 64);
        // What is left over of a mean is what its own rounding does not explain.
        let whole = Q * Q / 12.0 * f64::from(u32::try_from(positions.len()).expect("few"));
        assert!(found.left[0] <= whole * 1.3, "{:?}", found.left);
        found.variances[0]
    }

    /// The mean of n samples at one place has all of q²/12; two places half a step apart have q²/12 · (1 − ½)/2 = q²/48, and two
    /// that may be anywhere q²/24.
    #[test]
    fn variances_in_closed_form() {
        let whole = Q * Q / 12.0;
        let there = [[0.0; 4]];
        let one = variance(&[3.03; 100], &there, 0.0);
        assert!((one / whole - 1.0).abs() < 0.06, "{one} {whole}");
        let places: Vec<_> = (0..100).map(|i| 3.03 + f64::from(i % 2) * Q / 2.0).collect();
        let two = variance(&places, &there, 0.0);
        assert!((two / (whole / 4.0) - 1.0).abs() < 0.12, "{two} {whole}");
        // Noise of half a step leaves independent errors.
        let noisy = variance(&[3.03; 100], &there, Q / 2.0);
        assert!(noisy < 1.5 * whole / 100.0, "{noisy} {whole}");
        // Truths that are far off in common change nothing.
        let far = variance(&[3.03; 100], &[], 0.0);
        assert!((far / whole - 1.0).abs() < 0.3, "{far} {whole}");
    }

    /// Two dwells, and what is known of how far they are from each other: nothing, and so each has its own error.
    #[test]
    fn dwells_are_independent_where_nothing_is_known() {
        let known: Vec<_> = (0..100)
            .map(|index| {
                let level = f64::from(index % 2);
                Known {
                    unknowns: 2,
                    row: [1.0, level, 0.0, 0.0],
                    // The level of the second one from the first.
                    share: [(1.0 - level) / 50.0, (2.0 * level - 1.0) / 50.0, 0.0, 0.0],
                    weight: 1.0,
                    over: 0.0,
                    leverage: 0.02,
                    position: 80.0 * level,
                    deviation: 1.0,
                    clear: true,
                }
            })
            .collect();
        let noise = Noise { deviation: Q / 12.0_f64.sqrt(), correlation: 0.0 };
        let steps = Steps { step: Q, place: None };
        let first = tried(&known, (&far(&known, Q), 64), steps, noise);
        let second = tried(&known, (&first.off, 64), steps, noise);
        for found in [first, second] {
            let [one, both, ..] = found.variances.map(|variance| variance / (Q * Q / 12.0));
            assert!((one - 1.0).abs() < 0.3 && (both - 2.0).abs() < 0.7, "{one} {both}");
            // All of it is fitted away.
            assert!(found.left[0] < 1e-9, "{:?}", found.left);
        }
    }
}
