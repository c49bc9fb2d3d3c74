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
        // A wide range and a large difference have more parts than can be held: no more than is asked for is taken.
        let parts = left.iter().flat_map(|range| allowed(*range, difference, 2.0 * error));
        left = parts.take(MOST + 1).collect();
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

#[cfg(test)]
mod tests {
    use super::super::super::tests::Random;
    use super::step;

    #[test]
    fn decimal_steps_are_seen() {
        let of = |values: &[f64]| step(values, 0.0);
        assert_eq!(of(&[0.3, 0.1 + 0.2, 12.7, -4.0]), Some(0.1));
        assert_eq!(of(&[0.05, 1.0, 7.15, 7.2]), Some(0.05));
        assert_eq!(of(&[3.0, 15.0, -9.0]), Some(12.0));
        assert_eq!(of(&[0.087_890_625, 0.263_671_875, 1.757_812_5]), Some(0.087_890_625));
        assert_eq!(of(&[1.234_567_890_123, 2.2, 9.1]), None);
        assert_eq!(of(&[5.0, 5.0]), None);
        assert_eq!(of(&[]), None);
    }

    /// A sine of 80 with noise of a tenth of a step, to steps that begin anywhere, as a double, as a single, or printed: few
    /// samples of it, and many.
    #[test]
    fn any_steps_are_seen() {
        let pi = std::f64::consts::TAU;
        for (q, decimals) in [
            (pi / 100.0, None),
            (pi / 4096.0, None),
            (0.031_415_9, Some(3)),
            (0.031_415_9, Some(5)),
            (0.031_415_9, Some(2)),
            (80.0 / 65_536.0 / 1.3, None),
            (80.0 / 65_536.0 / 1.3, Some(5)),
            (8.3, Some(1)),
        ] {
            for count in [40_u32, 400, 3000] {
                for single in [false, true] {
                    let mut random = Random(u64::from(count));
                    let place = random.share() * q;
                    let values: Vec<_> = (0..count)
                        .map(|_| {
                            let value =
                                80.0 * (pi * random.share()).sin() + 0.1 * q * random.normal();
                            let value = (value / q).round() * q + place;
                            let value = decimals.map_or(value, |decimals| {
                                let scale = 10_f64.powi(decimals);
                                (value * scale).round() / scale
                            });
                            #[expect(
                                clippy::cast_possible_truncation,
                                reason = "as it is recorded"
                            )]
                            if single && decimals.is_none() {
                                f64::from(value as f32)
                            } else {
                                value
                            }
                        })
                        .collect();
                    let found = step(&values, 0.7 * q).expect("a step");
                    // Printed with two digits nothing is left of it in few of them.
                    let print =
                        if decimals == Some(2) && (found - 0.01).abs() < 1e-9 { 0.01 } else { q };
                    assert!(
                        (found / print - 1.0).abs() < 1e-3,
                        "{q} {decimals:?} {count}: {found}"
                    );
                    assert!(
                        (print - q).abs() < 1e-12 || count < 3000,
                        "{q} {decimals:?} {count}: {found}"
                    );
                }
            }
        }
    }

    /// Of 1,000 recordings that are not rounded, noise alone or a sine with noise, in none; of those that are printed, the
    /// print's.
    #[test]
    fn no_steps_are_seen_in_noise() {
        for seed in 0..1000 {
            let mut random = Random(seed + 3_000_000);
            let count = [12, 20, 60, 300][usize::try_from(seed % 4).expect("small")];
            let sine = [0.0, 30.0, 1000.0][usize::try_from(seed % 3).expect("small")];
            let values: Vec<_> = (0..count)
                .map(|index| sine * (f64::from(index) / 11.0).sin() + random.normal())
                .collect();
            for least in [0.5, 1.5] {
                assert_eq!(step(&values, least), None, "{seed}");
                for (scale, print) in [(10.0, 0.1), (100.0, 0.01)] {
                    let printed: Vec<_> =
                        values.iter().map(|v| (v * scale).round() / scale).collect();
                    let found = step(&printed, least).expect("the print's");
                    // By chance a few are even.
                    assert!(found < 2.5 * print, "{seed} {count}: {found} {print}");
                }
            }
        }
    }

    /// Samples just beside dwells have gaps far below all others: there is no step then, and that is known at once.
    #[test]
    fn gaps_of_all_sizes_have_no_step() {
        let lift = |s: f64| 80.0 * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
        for begin in [0.1, 1e-3, 1e-2] {
            let values: Vec<f64> =
                (0..72).map(|i| lift((f64::from(i) * 0.125 + begin / 180.0) % 1.0)).collect();
            assert_eq!(step(&values, 1e-9), None, "{begin}");
        }
        let values: Vec<f64> =
            (0..32).map(|i| lift([0.0, 0.5 / 180.0, 70.0 / 180.0, 1.0][i % 4])).collect();
        assert_eq!(step(&values, 1e-9), None);
    }
}
