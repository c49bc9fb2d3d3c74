//! Quantum of recorded positions: the step to which an encoder or the decimals of a file round them.
//!
//! Encoder steps are rarely short decimals (2·π/n), and files print their multiples with few digits. The search therefore looks
//! for an approximate common divisor q: each difference d is a multiple k·q to within the print error and so allows the intervals
//! |d/q − k| ≤ error/q of 1/q. The intervals that all differences allow remain.

/// Decimals that are tried.
const DECIMALS: i32 = 9;
/// A scaled value this close to a whole number is whole.
const WHOLE: f64 = 1e-4;
/// Relative error of a position in double and in single precision.
const PRECISIONS: [f64; 2] = [1e-12, 1.2e-7];
/// A quantum is at least this many times the error of a position.
const ABOVE: f64 = 6.0;
/// A quantum is at least the smallest difference divided by this.
const FINEST: f64 = 1e4;
/// Most intervals that are followed.
const MOST: usize = 200_000;
/// A quantum that random values show in more than one of a million recordings is not accepted.
const CHANCE: f64 = 1e-6;

/// The quantum of some values, which may all have a common offset. Quanta below `least` need not be found.
pub(super) fn quantum(values: &[f64], least: f64) -> Option<f64> {
    let printed = decimal(values);
    let size = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let print = printed.unwrap_or_default() * (0.5 + WHOLE);
    let coarse = PRECISIONS.iter().find_map(|part| common(values, least, print.max(part * size)));
    coarse.or(printed)
}

/// The largest decimal quantum of at least two different values.
fn decimal(values: &[f64]) -> Option<f64> {
    let first = *values.first()?;
    let size = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    (0..=DECIMALS).find_map(|decimals| {
        let scale = 10_f64.powi(decimals);
        // Larger numbers have no such decimals.
        if size * scale > 1e11 {
            return None;
        }
        let mut common = 0.0;
        for value in values {
            let scaled = value * scale;
            if (scaled - scaled.round()).abs() > WHOLE {
                return None;
            }
            common = divisor(common, (scaled.round() - (first * scale).round()).abs());
        }
        (common > 0.0).then(|| common / scale)
    })
}

/// Greatest common divisor of two whole numbers.
fn divisor(mut one: f64, mut other: f64) -> f64 {
    while other > 0.0 {
        (one, other) = (other, one % other);
    }
    one
}

/// The largest common divisor of at least `least` of all differences; each value is known to ± `error`.
fn common(values: &[f64], least: f64, error: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup_by(|next, kept| *next - *kept <= 2.0 * error);
    let (first, last) = (*sorted.first()?, *sorted.last()?);
    let mut gaps: Vec<f64> = sorted.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_by(f64::total_cmp);
    let (gap, reach) = (*gaps.first()?, last - first);
    let finest = (1.0 / (ABOVE * error)).min(1.0 / least).min(FINEST / gap);
    // Intervals of 1/q, in ascending order.
    let mut left = vec![[2.0 / reach, finest]];
    for difference in gaps.iter().copied().chain(sorted.iter().skip(1).map(|value| value - first)) {
        let parts = left.iter().flat_map(|range| allowed(*range, difference, 2.0 * error));
        left = parts.take(MOST + 1).collect();
        if left.is_empty() || left.len() > MOST {
            return None;
        }
    }
    let [low, high] = *left.first()?;
    let inverse = f64::midpoint(low, high);
    // Two values fix q and the offset; each further one fits by chance with probability 4·error/q.
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

/// Least-squares quantum of values over their multiples.
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
