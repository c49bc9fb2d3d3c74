//! Tests of the transforms, and the numerical differentiation that several of them share.

mod direction;
mod frame;
mod linuxcnc;
mod machine_axes;
mod machines;
mod measures;
mod scara;
mod transforms;

use proptest::test_runner::{Config as ProptestConfig, RngSeed};

/// The same cases in every run; `PROPTEST_CASES` sets their number.
pub(crate) fn seeded() -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// First, second and third derivative of `f` at 0 by central differences of tenth order (third: eighth) with step `h`.
pub(crate) fn differences<const N: usize>(f: impl Fn(f64) -> [f64; N], h: f64) -> [[f64; N]; 3] {
    const FIRST: [f64; 5] = [5.0 / 6.0, -5.0 / 21.0, 5.0 / 84.0, -5.0 / 504.0, 1.0 / 1260.0];
    const SECOND: [f64; 5] = [5.0 / 3.0, -5.0 / 21.0, 5.0 / 126.0, -5.0 / 1008.0, 1.0 / 3150.0];
    const THIRD: [f64; 5] =
        [-1669.0 / 720.0, 4369.0 / 2520.0, -541.0 / 1120.0, 1261.0 / 15120.0, -41.0 / 6048.0];
    let middle = f(0.0);
    let mut found = [[0.0; N]; 3];
    found[1] = middle.map(|value| -5269.0 / 1800.0 * value);
    let mut step = 0.0;
    for ((first, second), third) in FIRST.into_iter().zip(SECOND).zip(THIRD) {
        step += h;
        let (after, before) = (f(step), f(-step));
        for index in 0..N {
            found[0][index] += first * (after[index] - before[index]);
            found[1][index] += second * (after[index] + before[index]);
            found[2][index] += third * (after[index] - before[index]);
        }
    }
    let [first, second, third] = found;
    [
        first.map(|value| value / h),
        second.map(|value| value / (h * h)),
        third.map(|value| value / (h * h * h)),
    ]
}

#[test]
fn differences_of_known_functions() {
    let found = differences(|x| [x.exp(), x.sin()], 0.05);
    for (found, expected) in found.iter().zip([[1.0, 1.0], [1.0, 0.0], [1.0, -1.0]]) {
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-10, "{found} {expected}");
        }
    }
}
