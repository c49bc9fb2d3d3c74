//! Offsets, scalings and dead times from made-up runs.

use super::Random;
use crate::cam::tune::{FitError, FitOptions, Free, Sample, Switching, dead_time, fit};
use crate::cam::{Curve, Knot};

/// 1,000 trials of which 95 % should hit: within 4 standard deviations, 27.6 trials (one test in 16,000 fails by chance,
/// but seeds are fixed).
const TRIALS: u64 = 1000;
const HITS: std::ops::RangeInclusive<usize> = 922..=978;

/// A lift with a rest, one turn.
fn lift() -> Curve {
    Curve::polynomial(&[
        Knot::at_rest(0.0, 0.0),
        Knot::at_rest(110.0, 80.0),
        Knot::at_rest(160.0, 80.0),
        Knot::at_rest(230.0, 30.0),
        Knot::at_rest(360.0, 0.0),
    ])
    .expect("a curve")
}

fn run(random: &mut Random, curve: &Curve, truth: [f64; 4], noise: f64, count: u32) -> Vec<Sample> {
    let [offset, scaling, shift, factor] = truth;
    (0..count)
        .map(|index| {
            let master = 700.0 * f64::from(index) / f64::from(count);
            // Every other sample is twice as noisy, and says so.
            let worse = if index % 2 == 0 { 1.0 } else { 2.0 };
            let slave = factor * curve.repeated(master * scaling + offset).position + shift;
            let slave = slave + noise * worse * random.normal();
            Sample { master, slave, weight: 1.0 / (worse * worse) }
        })
        .collect()
}

#[test]
fn true_values_lie_in_their_intervals() {
    let curve = lift();
    let mut hits = [0_usize; 4];
    for seed in 0..TRIALS {
        let mut random = Random(seed);
        let truth = [
            random.between(-170.0, 170.0),
            random.between(0.97, 1.03),
            random.between(-50.0, 50.0),
            random.between(0.5, 2.0),
        ];
        let samples = run(&mut random, &curve, truth, 0.3, 120);
        let options = FitOptions { free: Free::ALL, ..FitOptions::default() };
        let found =
            fit(&curve, &samples, &options).unwrap_or_else(|error| panic!("{seed}: {error}"));
        assert!(found.is_noise(samples.len()), "{seed}");
        let all =
            [found.master_offset, found.master_scaling, found.slave_offset, found.slave_scaling];
        for ((hits, estimate), truth) in hits.iter_mut().zip(all).zip(truth) {
            *hits += usize::from(estimate.holds(truth));
        }
        assert!((found.master_offset.value - truth[0]).abs() < 3.0, "{seed}");
        assert!(found.master_offset.half_width < 1.0, "{seed}");
    }
    for hits in hits {
        assert!(HITS.contains(&hits), "{hits} of {TRIALS}");
    }
}

#[test]
fn without_noise_the_truth_is_found() {
    let curve = lift();
    let samples = run(&mut Random(1), &curve, [42.0, 1.0, -3.0, 1.0], 0.0, 50);
    let found = fit(&curve, &samples, &FitOptions::default()).expect("a fit");
    assert!((found.master_offset.value - 42.0).abs() < 1e-6);
    assert!((found.slave_offset.value + 3.0).abs() < 1e-6);
    assert_eq!((found.master_scaling.value, found.master_scaling.half_width), (1.0, 0.0));
}

#[test]
fn what_data_do_not_say_is_not_fitted() {
    let curve = lift();
    let free = |master_offset, master_scaling, slave_offset, slave_scaling| FitOptions {
        free: Free { master_offset, master_scaling, slave_offset, slave_scaling },
        ..FitOptions::default()
    };
    let mut random = Random(3);
    let truth = [10.0, 1.0, 0.0, 1.0];
    let few = run(&mut random, &curve, truth, 0.1, 7);
    let too_few = FitError::TooFew { found: 7, needed: 12, unknowns: 2 };
    assert_eq!(fit(&curve, &few, &FitOptions::default()), Err(too_few));
    assert_eq!(fit(&curve, &few, &free(false, false, false, false)), Err(FitError::NothingFree));
    // On a straight cam both offsets are one.
    let line = |master: f64| Knot { velocity: 0.5, ..Knot::at_rest(master, master / 2.0) };
    let straight = Curve::polynomial(&[line(0.0), line(360.0)]).expect("a curve");
    let samples = run(&mut random, &straight, truth, 0.1, 100);
    let error = fit(&straight, &samples, &FitOptions::default()).expect_err("one of two");
    assert_eq!(error, FitError::Undetermined { unknowns: vec!["MasterOffset", "SlaveOffset"] });
    // A master that stands.
    let still: Vec<_> = (0..100)
        .map(|_| Sample { master: 50.0, slave: 20.0 + 0.1 * random.normal(), weight: 1.0 })
        .collect();
    assert!(fit(&curve, &still, &free(true, true, false, false)).is_err());
    // A cam of two equal halves fits twice.
    let twice = Curve::polynomial(&[
        Knot::at_rest(0.0, 0.0),
        Knot::at_rest(90.0, 50.0),
        Knot::at_rest(180.0, 0.0),
        Knot::at_rest(270.0, 50.0),
        Knot::at_rest(360.0, 0.0),
    ])
    .expect("a curve");
    let samples = run(&mut random, &twice, truth, 0.1, 100);
    let error = fit(&twice, &samples, &FitOptions::default()).expect_err("two answers");
    assert!(matches!(error, FitError::Ambiguous { unknown: "MasterOffset", .. }), "{error}");
    // Noise alone.
    let noise: Vec<_> = (0..100)
        .map(|i| Sample { master: f64::from(i) * 3.6, slave: 50.0 * random.normal(), weight: 1.0 })
        .collect();
    let error = fit(&curve, &noise, &FitOptions::default()).expect_err("noise");
    assert!(matches!(error, FitError::Unexplained { .. } | FitError::Ambiguous { .. }), "{error}");
    // The coupling slipped by 5 half way.
    let mut slipped = run(&mut random, &curve, truth, 0.1, 100);
    let rest = run(&mut random, &curve, [15.0, 1.0, 0.0, 1.0], 0.1, 100);
    slipped[50..].copy_from_slice(&rest[50..]);
    let error = fit(&curve, &slipped, &FitOptions::default()).expect_err("slipped");
    assert!(matches!(error, FitError::Contradictory { .. }), "{error}");
    // Nonsense.
    let mut wrong = run(&mut random, &curve, truth, 0.1, 100);
    wrong[3].weight = 0.0;
    let refused = FitError::NoNumber { index: 4, what: "weight", value: 0.0 };
    assert_eq!(fit(&curve, &wrong, &FitOptions::default()), Err(refused));
}

#[test]
fn dead_times_lie_in_their_intervals() {
    for with_offset in [false, true] {
        let mut hits = [0_usize; 2];
        for seed in 0..TRIALS {
            let mut random = Random(seed + 7_000_000);
            let truth = [random.between(0.0, 0.05), random.between(-1.0, 1.0)];
            let seen: Vec<_> = (0..12)
                .map(|_| {
                    let velocity = random.between(-300.0, 500.0);
                    let deviation = random.between(0.05, 0.5);
                    let offset = if with_offset { truth[1] } else { 0.0 };
                    let distance = velocity * truth[0] + offset + deviation * random.normal();
                    Switching { velocity, distance, weight: 1.0 / (deviation * deviation) }
                })
                .collect();
            let found = dead_time(&seen, with_offset).expect("a dead time");
            hits[0] += usize::from(found.dead_time_s.holds(truth[0]));
            hits[1] += usize::from(found.offset.holds(if with_offset { truth[1] } else { 0.0 }));
        }
        assert!(HITS.contains(&hits[0]), "{hits:?}");
        assert!(if with_offset { HITS.contains(&hits[1]) } else { hits[1] == 1000 }, "{hits:?}");
    }
    let at = |velocity| Switching { velocity, distance: 1.0, weight: 1.0 };
    let same = dead_time(&[at(100.0); 9], true);
    assert_eq!(same, Err(FitError::Undetermined { unknowns: vec!["dead time", "offset"] }));
    assert_eq!(dead_time(&[at(100.0); 9], false).expect("a time").dead_time_s.value, 0.01);
    let few = FitError::TooFew { found: 3, needed: 4, unknowns: 2 };
    assert_eq!(dead_time(&[at(1.0), at(2.0), at(3.0)], true), Err(few));
}
