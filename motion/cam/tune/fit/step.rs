//! The step to which positions are rounded: counts of an encoder, and the decimals of a file.
//!
//! Steps of an encoder are no short decimals (2·π/n, a gear's), and files print their multiples with few digits. So looked for
//! is an approximate common divisor: all differences are whole multiples k·q but for the error of print. Each difference d
//! allows the intervals |d/q − k| ≤ error/q of 1/q; those that all differences allow, from the least difference on, are what is
//! left. Nothing that fits is missed so, and what fits by chance is known.

/// So many decimals are looked at.
const DECIMALS: i32 = 9;
/// So far beside a multiple is the same.
const BESIDE: f64 = 1e-4;
/// What double and single precision make of a position, as a part of the largest one.
const PRECISIONS: [f64; 2] = [1e-12, 1.2e-7];
/// A step has at least so many times the error of a position, so that a position says something of it.
const ABOVE: f64 = 6.0;
/// So many times the step fits into the least difference at most.
const FINEST: f64 = 1e4;
/// No more intervals than this are looked at.
const MOST: usize = 200_000;
/// What fits by chance in more than one of so many recordings is no step.
const CHANCE: f64 = 1e-6;

/// The step to whose multiples, and something that they have in common, all values are rounded, if they are. Steps below
/// `least` need not be found.
pub(super) fn step(values: &[f64], least: f64) -> Option<f64> {
    let printed = decimal(values);
    let size = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let print = printed.unwrap_or_default() * (0.5 + BESIDE);
    let coarse = PRECISIONS.iter().find_map(|part| common(values, least, print.max(part * size)));
    coarse.or(printed)
}

/// The largest decimal step, of at least two different values.
fn decimal(values: &[f64]) -> Option<f64> {
    let first = *values.first()?;
    let size = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    (0..=DECIMALS).find_map(|decimals| {
        let scale = 10_f64.powi(decimals);
        // Beyond that there are no decimals.
        if size * scale > 1e11 {
            return None;
        }
        let mut common: u64 = 0;
        for value in values {
            let scaled = value * scale;
            if (scaled - scaled.round()).abs() > BESIDE {
                return None;
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "whole, and limited above"
            )]
            let steps = (scaled.round() - (first * scale).round()).abs() as u64;
            common = divisor(common, steps);
        }
        #[expect(clippy::cast_precision_loss, reason = "limited above")]
        (common > 0).then(|| common as f64 / scale)
    })
}

fn divisor(mut one: u64, mut other: u64) -> u64 {
    while other != 0 {
        (one, other) = (other, one % other);
    }
    one
}

/// The largest step of at least `least` that all values are multiples of, each known to ± `error`, but for what they have in
/// common.
fn common(values: &[f64], least: f64, error: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    // What is nearer than a step can be is the same.
    sorted.dedup_by(|next, kept| *next - *kept <= 2.0 * error);
    let (first, last) = (*sorted.first()?, *sorted.last()?);
    let mut gaps: Vec<f64> = sorted.iter().zip(sorted.iter().skip(1)).map(|(a, b)| b - a).collect();
    gaps.sort_by(f64::total_cmp);
    let (gap, reach) = (*gaps.first()?, last - first);
    let finest = (1.0 / (ABOVE * error)).min(1.0 / least).min(FINEST / gap);
    // What is left of 1/q, in ascending order.
    let mut left = vec![[2.0 / reach, finest]];
    for difference in gaps.iter().copied().chain(sorted.iter().skip(1).map(|value| value - first)) {
        left = left.iter().flat_map(|range| allowed(*range, difference, 2.0 * error)).collect();
        if left.is_empty() || left.len() > MOST {
            return None;
        }
    }
    let [low, high] = *left.first()?;
    let inverse = f64::midpoint(low, high);
    // The first two values fix the step and its place; each other one fits by chance with a part of 4·error/q.
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let others = sorted.len() as f64 - 2.0;
    let chance = others * (4.0 * error * inverse).ln() + (reach * finest).max(1.0).ln();
    (chance < CHANCE.ln()).then(|| slope(&sorted, first, inverse))
}

/// The parts of a range of 1/q in which a difference that is known to ± `error` is a multiple of q.
fn allowed([low, high]: [f64; 2], difference: f64, error: f64) -> impl Iterator<Item = [f64; 2]> {
    let (short, long) = (difference - error, difference + error);
    let mut multiple = (low * short).ceil().max(1.0);
    std::iter::from_fn(move || {
        let part = [low.max(multiple / long), high.min(multiple / short)];
        multiple += 1.0;
        (part[0] <= part[1]).then_some(part)
    })
}

/// The step by least squares of values over their multiples.
fn slope(values: &[f64], first: f64, inverse: f64) -> f64 {
    let [mut count, mut k, mut v, mut kk, mut kv] = [0.0; 5];
    for value in values {
        let by = value - first;
        let multiple = (by * inverse).round();
        count += 1.0;
        k += multiple;
        v += by;
        kk += multiple * multiple;
        kv += multiple * by;
    }
    (kv - k * v / count) / (kk - k * k / count)
}
