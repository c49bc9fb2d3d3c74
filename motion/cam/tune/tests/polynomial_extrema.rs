//! Extremes of a polynomial and a sine together.

use super::super::polynomial_extrema::Swing;
use std::f64::consts::{FRAC_PI_2, PI};

/// u/2 + sin u is greatest where cos u = −1/2: at 2π/3, and least at 4π/3; on [0, 2π] that is π/3 + √3/2 and 2π/3 − √3/2.
#[test]
fn a_line_and_a_sine() {
    let swing = Swing { amplitude: 1.0, phase: 0.0, angular: 1.0 };
    let found = swing.extremes(&[1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0], 5.0);
    let root = 3.0_f64.sqrt() / 2.0;
    assert!((found.max - (1.0 + PI / 3.0 + root)).abs() < 1e-11, "{found:?}");
    assert!((found.at_max - 2.0 * PI / 3.0).abs() < 1e-5, "{found:?}");
    // The begin is lower than the dip behind the top.
    assert!((found.min - 1.0).abs() < 1e-11 && found.at_min == 0.0, "{found:?}");
}

/// 3 u² − 2 u³ beside its own size as a sine of the other sign, against ten thousand places each.
#[test]
fn no_place_is_beyond() {
    for step in 0..200_u32 {
        let share = f64::from(step) / 200.0;
        let swing =
            Swing { amplitude: 2.0 * share - 1.0, phase: 7.0 * share, angular: 1.0 + 9.0 * share };
        let c = [share, -1.0, 3.0, -2.0, share, -0.5, 0.25];
        let found = swing.extremes(&c, 1.5);
        let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
        for place in 0..=10_000 {
            let at = swing.value(&c, 1.5 * f64::from(place) / 10_000.0);
            (least, greatest) = (least.min(at), greatest.max(at));
        }
        assert!(least >= found.min - 1e-11 && greatest <= found.max + 1e-11, "{step}: {found:?}");
        assert!((least - found.min).abs() < 1e-6 && (greatest - found.max).abs() < 1e-6, "{step}");
    }
    let still = Swing { amplitude: 2.0, phase: FRAC_PI_2, angular: 0.0 };
    assert!((still.extremes(&[1.0; 7].map(|c| c * 0.0), 3.0).max - 2.0).abs() < 1e-15);
}
