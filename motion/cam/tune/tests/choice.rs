//! Tests of the choice between equally good fits: by the sign of the slave scaling, and by distance from the start
//! values.

use super::{Random, at_rest};
use crate::Curve;
use crate::tune::{Fit, FitError, FitOptions, Free, Sample, fit};

const SLAVE: Free = Free { master_scaling: false, ..Free::ALL };
const OFFSETS: Free = Free { slave_scaling: false, ..SLAVE };

/// So many equal lifts of 50 one behind the other on 360.
fn lifts(count: i32) -> Curve {
    let half = 180.0 / f64::from(count);
    let point = |index: i32| (half * f64::from(index), if index % 2 == 0 { 0.0 } else { 50.0 });
    at_rest(&(0..=2 * count).map(point).collect::<Vec<_>>())
}

/// Up in a third of the cam, down in the rest: nothing but itself fits it.
fn slanting() -> Curve {
    at_rest(&[(0.0, 0.0), (120.0, 100.0), (360.0, 0.0)])
}

/// Two turns; the truth is `MasterOffset`, `SlaveOffset` and `SlaveScaling`.
fn run(curve: &Curve, seed: u64, [offset, shift, factor]: [f64; 3], noise: f64) -> Vec<Sample> {
    let mut random = Random(seed);
    (0..200)
        .map(|index| {
            let master = 3.6 * f64::from(index);
            let slave = factor * curve.repeated(master + offset).position + shift;
            Sample { master, slave: slave + noise * random.normal(), weight: 1.0 }
        })
        .collect()
}

fn begun(free: Free, master_offset: f64, slave_scaling: f64) -> FitOptions {
    FitOptions { free, from: [master_offset, 1.0, 0.0, slave_scaling], ..FitOptions::default() }
}

/// How far two offsets are apart on a cam of 360.
fn apart(one: f64, other: f64) -> f64 {
    let by = (one - other).rem_euclid(360.0);
    by.min(360.0 - by)
}

fn is(found: &Fit, [offset, shift, factor]: [f64; 3], within: f64) {
    let by = [
        apart(found.estimates[0].value, offset),
        found.estimates[2].value - shift,
        found.estimates[3].value - factor,
    ];
    assert!(by.iter().all(|by| by.abs() < within), "{found:?}");
}

/// A lift that its mirror fits, too, half a cam on: 50 − y(x + 180) = y(x). With noise and without it the sign in effect is kept,
/// wherever the offset in effect is.
#[test]
fn the_sign_of_the_scaling_is_kept() {
    let curve = lifts(1);
    for noise in [0.0, 0.05] {
        for (seed, offset) in (0..).zip([0.0, 1.8, 90.0, 170.0, -178.2]) {
            for sign in [1.0, -1.0] {
                let truth = [-1.8, 0.3, sign * 1.02];
                let samples = run(&curve, seed, truth, noise);
                let found = fit(&curve, &samples, &begun(SLAVE, offset, sign)).expect("a fit");
                is(&found, truth, 0.1);
            }
        }
    }
}

/// What fits mirrored alone is found so, whatever is in effect, and nothing competes with it.
#[test]
fn a_mirrored_slave_that_alone_fits_is_found() {
    let curve = slanting();
    let truth = [-1.8, 0.3, -1.02];
    let samples = run(&curve, 4, truth, 0.05);
    let found = fit(&curve, &samples, &begun(SLAVE, 0.0, 1.0)).expect("a fit");
    is(&found, truth, 0.1);
}

/// Up to a quarter of the repeat from what is in effect, the answer there is taken, whatever
/// pass the offset is counted on; half-way between two repeats none is. With more repeats than valleys are gone down into, too.
#[test]
fn the_nearest_repeat_is_taken() {
    for count in [2, 3, 8, 12] {
        let curve = lifts(count);
        let repeat = 360.0 / f64::from(count);
        for (seed, at) in (0..).zip([7.0, 100.0, 200.0, -130.0, 355.0]) {
            let truth = [at, 0.3, 1.0];
            let samples = run(&curve, seed + 30, truth, 0.05);
            for (part, taken) in
                [(0.0, true), (0.2, true), (-0.22, true), (0.3, false), (-0.5, false)]
            {
                for passes in [0.0, 360.0] {
                    let options = begun(OFFSETS, at + part * repeat + passes, 1.0);
                    let found = fit(&curve, &samples, &options);
                    if taken {
                        let found = found.unwrap_or_else(|e| panic!("{count} {at} {part}: {e}"));
                        is(&found, truth, 0.1);
                    } else {
                        let error = found.expect_err("none is nearer");
                        let FitError::Ambiguous { unknown, one, other, .. } = error else {
                            panic!("{count} {at} {part}: {error}")
                        };
                        assert_eq!(unknown, "MasterOffset");
                        assert!((apart(one, other) - repeat).abs() < 0.1, "{count} {one} {other}");
                    }
                }
            }
        }
    }
}

/// A cam that is mirrored and repeats itself: the sign comes first, then the nearest.
#[test]
fn repeats_that_are_mirrored_too() {
    let curve = lifts(2);
    let truth = [8.0, 0.3, 0.98];
    let samples = run(&curve, 9, truth, 0.05);
    // The mirrored answers are at −82 and 98: nearer to 70 than any other.
    let near = fit(&curve, &samples, &begun(SLAVE, 30.0, 1.0)).expect("a fit");
    is(&near, truth, 0.1);
    let error = fit(&curve, &samples, &begun(SLAVE, 70.0, 1.0)).expect_err("8 or 188");
    assert!(matches!(error, FitError::Ambiguous { .. }), "{error}");
    let mirrored = fit(&curve, &samples, &begun(SLAVE, 90.0, -1.0)).expect("a fit");
    is(&mirrored, [98.0, 0.3 + 50.0 * 0.98, -0.98], 0.1);
}

/// An interval says which is meant: half-way between two repeats, of the other sign, or on another pass than the one next to 0;
/// and where nothing that fits lies in it, that is reported.
#[test]
fn an_interval_says_which_is_meant() {
    let curve = lifts(2);
    let truth = [8.0, 0.3, 1.0];
    let samples = run(&curve, 11, truth, 0.05);
    let half_way = begun(SLAVE, 98.0, 1.0);
    assert!(matches!(fit(&curve, &samples, &half_way), Err(FitError::Ambiguous { .. })));
    let within = |offset: Option<[f64; 2]>, factor: Option<[f64; 2]>| {
        let between = [offset, None, None, factor];
        fit(&curve, &samples, &FitOptions { between, ..half_way })
    };
    for (interval, at) in [([-20.0, 20.0], 8.0), ([170.0, 200.0], 188.0), ([350.0, 380.0], 368.0)] {
        let found = within(Some(interval), None).expect("a fit");
        assert!((found.estimates[0].value - at).abs() < 0.1, "{interval:?} {found:?}");
        assert!((found.estimates[3].value - 1.0).abs() < 0.01, "{found:?}");
    }
    let mirrored = within(Some([80.0, 120.0]), Some([-1.1, -0.9])).expect("a fit");
    is(&mirrored, [98.0, 50.3, -1.0], 0.1);
    let error = within(Some([20.0, 60.0]), None).expect_err("none there");
    let FitError::Beyond { unknown: "MasterOffset", between: [20.0, 60.0], .. } = error else {
        panic!("{error}")
    };
    let error = within(None, Some([1.1, 1.2])).expect_err("none there");
    assert!(matches!(error, FitError::Beyond { unknown: "SlaveScaling", .. }), "{error}");
}
