//! Quanta of recorded positions.

use super::super::quantum::quantum;
use super::Random;

#[test]
fn decimal_steps_are_seen() {
    let of = |values: &[f64]| quantum(values, 0.0);
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
                        let value = 80.0 * (pi * random.share()).sin() + 0.1 * q * random.normal();
                        let value = (value / q).round() * q + place;
                        let value = decimals.map_or(value, |decimals| {
                            let scale = 10_f64.powi(decimals);
                            (value * scale).round() / scale
                        });
                        #[expect(clippy::cast_possible_truncation, reason = "as it is recorded")]
                        if single && decimals.is_none() { f64::from(value as f32) } else { value }
                    })
                    .collect();
                let found = quantum(&values, 0.7 * q).expect("a step");
                // Printed with two digits nothing is left of it in few of them.
                let print =
                    if decimals == Some(2) && (found - 0.01).abs() < 1e-9 { 0.01 } else { q };
                assert!((found / print - 1.0).abs() < 1e-3, "{q} {decimals:?} {count}: {found}");
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
            assert_eq!(quantum(&values, least), None, "{seed}");
            for (scale, print) in [(10.0, 0.1), (100.0, 0.01)] {
                let printed: Vec<_> = values.iter().map(|v| (v * scale).round() / scale).collect();
                let found = quantum(&printed, least).expect("the print's");
                // By chance a few are even.
                assert!(found < 2.5 * print, "{seed} {count}: {found} {print}");
            }
        }
    }
}

/// Samples just next to dwells have gaps far below the others: they have no step, which is found at once.
#[test]
fn gaps_of_all_sizes_have_no_step() {
    let lift = |s: f64| 80.0 * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
    for begin in [0.1, 1e-3, 1e-2] {
        let values: Vec<f64> =
            (0..72).map(|i| lift((f64::from(i) * 0.125 + begin / 180.0) % 1.0)).collect();
        assert_eq!(quantum(&values, 1e-9), None, "{begin}");
    }
    let values: Vec<f64> =
        (0..32).map(|i| lift([0.0, 0.5 / 180.0, 70.0 / 180.0, 1.0][i % 4])).collect();
    assert_eq!(quantum(&values, 1e-9), None);
}
