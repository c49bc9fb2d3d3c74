//! Tests of what needs no file of its own beside the code, and what several tests share.

mod direction;
mod frame;
mod machine_axes;

use proptest::test_runner::{Config as ProptestConfig, RngSeed};

/// The same cases in every run; `PROPTEST_CASES` sets their number.
pub(crate) fn seeded() -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// First and second derivative of `f` at 0 by central differences of eighth order with step `h`.
pub(crate) fn differences<const N: usize>(
    f: impl Fn(f64) -> [f64; N],
    h: f64,
) -> ([f64; N], [f64; N]) {
    const FIRST: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    const SECOND: [f64; 4] = [8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0];
    let middle = f(0.0);
    let (mut first, mut second) = ([0.0; N], middle.map(|value| -205.0 / 72.0 * value));
    let mut step = 0.0;
    for (odd, even) in FIRST.into_iter().zip(SECOND) {
        step += h;
        let (after, before) = (f(step), f(-step));
        for index in 0..N {
            first[index] += odd * (after[index] - before[index]);
            second[index] += even * (after[index] + before[index]);
        }
    }
    (first.map(|value| value / h), second.map(|value| value / (h * h)))
}

/// x⁵ + e^x at 0: 1 and 1.
#[test]
fn differences_of_a_known_function() {
    let ([first], [second]) = differences(|x| [x.powi(5) + x.exp()], 1e-2);
    assert!((first - 1.0).abs() < 1e-13, "{first}");
    assert!((second - 1.0).abs() < 1e-11, "{second}");
}
