//! Tests of tool directions and their rates (`SMC_CalcDirectionFromVector`).

use super::{differences, seeded};
use crate::{ToPath, direction_rates};
use nalgebra::Vector2;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const ALL: [ToPath; 4] = [ToPath::Tangential, ToPath::Opposite, ToPath::Right, ToPath::Left];

/// Along the axes the four are exact, and never a whole turn or −0.
#[test]
fn quarter_turns_are_exact() {
    let quarters = [0.0, FRAC_PI_2, PI, 3.0 * FRAC_PI_2];
    let axes = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
    for (index, (x, y)) in axes.into_iter().enumerate() {
        for (to_path, more) in ALL.into_iter().zip([0, 2, 3, 1]) {
            for length in [1e-300, 1.0, 1e300] {
                let found = to_path.direction(Vector2::new(x, y) * length).unwrap();
                let expected = quarters[(index + more) % 4];
                assert!(found.to_bits() == expected.to_bits(), "{to_path:?} ({x}, {y}) {found:e}");
            }
        }
    }
    // Just below the x axis the angle is a whole turn in numbers.
    let found = ToPath::Tangential.direction(Vector2::new(1.0, -1e-20)).unwrap();
    assert!(found.to_bits() == 0.0_f64.to_bits(), "{found:e}");
    assert!(ToPath::Left.direction(Vector2::new(f64::NAN, 1.0)).is_some_and(f64::is_nan));
}

/// On a circle of any radius, run through with angle a·t + b·t² + c·t³, the rates at 0 are a, 2b and 6c.
#[test]
fn rates_on_a_circle() {
    let [a, b, c] = [0.5, -1.5, 4.0];
    for length in [1e-200, 1e-3, 1.0, 1e200] {
        // exp(iφ) = 1 + iat + (ib − a²/2)t² + (ic − ab − ia³/6)t³ + …
        let derivatives =
            [[0.0, a], [-a * a, 2.0 * b], [-6.0 * a * b, 6.0 * c - a * a * a]].map(Vector2::from);
        let scaled = derivatives.map(|value| value * length);
        let found = direction_rates(Vector2::x() * length, scaled).unwrap();
        for (found, expected) in found.into_iter().zip([a, 2.0 * b, 6.0 * c]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }
}

#[test]
fn rates_on_a_line_are_zero() {
    let along = Vector2::new(3.0, -4.0);
    let found = direction_rates(along, [along * -2.0, along * 7.0, along * 0.5]).unwrap();
    assert!(found.iter().all(|rate| rate.abs() < 1e-14), "{found:?}");
    // No vector, no rates.
    assert_eq!(direction_rates(Vector2::zeros(), [Vector2::x(), Vector2::y(), Vector2::x()]), None);
}

/// A vector as a polynomial of third degree: value and derivatives at `t`.
fn polynomial(c: &[Vector2<f64>; 4], t: f64) -> (Vector2<f64>, [Vector2<f64>; 3]) {
    (
        c[0] + (c[1] + (c[2] + c[3] * t) * t) * t,
        [c[1] + (c[2] * 2.0 + c[3] * (3.0 * t)) * t, c[2] * 2.0 + c[3] * (6.0 * t), c[3] * 6.0],
    )
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn the_direction_is_that_of_the_vector(x in -5.0..5.0, y in -5.0..5.0) {
        let vector = Vector2::new(x, y);
        for to_path in ALL {
            let found = to_path.direction(vector).unwrap();
            prop_assert!((0.0..TAU).contains(&found));
            let expected = y.atan2(x) + to_path.offset();
            prop_assert!((found - expected).sin().abs() < 4.0 * f64::EPSILON * PI && (found - expected).cos() > 0.0, "{found} {expected}");
        }
    }

    #[test]
    fn rates_are_derivatives(
        angle in -PI..PI,
        values in prop::array::uniform6(-1.0..1.0),
    ) {
        let coefficients = [
            Vector2::new(angle.cos(), angle.sin()),
            Vector2::new(values[0], values[1]),
            Vector2::new(values[2], values[3]),
            Vector2::new(values[4], values[5]),
        ];
        let rates = |t: f64| {
            let (vector, derivatives) = polynomial(&coefficients, t);
            direction_rates(vector, derivatives).unwrap()
        };
        let all = |t: f64| {
            let (vector, _) = polynomial(&coefficients, t);
            let start = coefficients[0];
            let [rate, acceleration, _] = rates(t);
            [start.perp(&vector).atan2(start.dot(&vector)), rate, acceleration]
        };
        let [first, second, _] = differences(all, 2e-3);
        let found = rates(0.0);
        for ((found, expected), power) in found.into_iter().zip(first).zip(1..) {
            prop_assert!((found - expected).abs() < 1e-8 * found.abs().max(f64::from(power)), "{found} {expected}");
        }
        prop_assert!((found[1] - second[0]).abs() < 1e-8 * found[1].abs().max(1.0), "{found:?} {second:?}");
        prop_assert!((found[2] - second[1]).abs() < 1e-8 * found[2].abs().max(1.0), "{found:?} {second:?}");
    }
}
