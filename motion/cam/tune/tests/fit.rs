//! Offsets, scalings and dead times from made-up runs.

use super::{Random, at_rest, right, trials};
use crate::tune::{FitError, FitOptions, Free, Sample, fit};
use crate::{Curve, Knot};

/// Of which 95 % hit.
const TRIALS: u64 = 1000;

/// A lift with a rest, one turn.
fn lift() -> Curve {
    at_rest(&[(0.0, 0.0), (110.0, 80.0), (160.0, 80.0), (230.0, 30.0), (360.0, 0.0)])
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
    for seed in 0..trials(TRIALS) {
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
        let all = found.estimates;
        for ((hits, estimate), truth) in hits.iter_mut().zip(all).zip(truth) {
            *hits += usize::from(estimate.holds(truth));
        }
        assert!((found.estimates[0].value - truth[0]).abs() < 3.0, "{seed}");
        assert!(found.estimates[0].half_width < 1.0, "{seed}");
    }
    for hits in hits {
        assert!(right(trials(TRIALS)).contains(&hits), "{hits} of {}", trials(TRIALS));
    }
}

#[test]
fn without_noise_the_truth_is_found() {
    let curve = lift();
    let samples = run(&mut Random(1), &curve, [42.0, 1.0, -3.0, 1.0], 0.0, 50);
    let found = fit(&curve, &samples, &FitOptions::default()).expect("a fit");
    assert!((found.estimates[0].value - 42.0).abs() < 1e-6);
    assert!((found.estimates[2].value + 3.0).abs() < 1e-6);
    assert_eq!((found.estimates[1].value, found.estimates[1].half_width), (1.0, 0.0));
}

/// Fourteen samples of two turns, two unknowns: of 1,000 runs of noise two at most are taken for a contradiction, an outlier or
/// no noise (each is so in one of ten thousand at most), and 95 % of the others hit.
#[test]
fn few_samples_raise_no_false_alarms() {
    let curve = lift();
    let (mut hits, mut alarms) = ([0_usize; 2], 0);
    for seed in 0..trials(TRIALS) {
        let mut random = Random(seed + 90_000);
        let truth = [random.between(-170.0, 170.0), 1.0, random.between(-50.0, 50.0), 1.0];
        let samples = run(&mut random, &curve, truth, 0.1, 14);
        match fit(&curve, &samples, &FitOptions::default()) {
            Ok(found) => {
                alarms += usize::from(!found.is_noise(samples.len()));
                hits[0] += usize::from(found.estimates[0].holds(truth[0]));
                hits[1] += usize::from(found.estimates[2].holds(truth[2]));
            }
            Err(FitError::Contradictory { .. } | FitError::Outliers { .. }) => alarms += 1,
            Err(error) => panic!("{seed}: {error}"),
        }
    }
    assert!(alarms <= 2, "{alarms} of {}", trials(TRIALS));
    assert!(
        hits.iter().all(|hits| right(trials(TRIALS)).contains(hits)),
        "{hits:?} of {}",
        trials(TRIALS)
    );
}

/// A coupling that slipped half way, and a slave that drifts away, in as few as 14 samples.
#[test]
fn few_samples_contradict_each_other_too() {
    let curve = lift();
    let (mut slips, mut drifts) = (0, 0);
    for seed in 0..100 {
        let mut random = Random(seed + 600);
        let truth = [10.0, 1.0, 0.0, 1.0];
        let mut slipped = run(&mut random, &curve, truth, 0.1, 14);
        let rest = run(&mut random, &curve, [22.0, 1.0, 0.0, 1.0], 0.1, 14);
        slipped[7..].copy_from_slice(&rest[7..]);
        let found = fit(&curve, &slipped, &FitOptions::default());
        slips += usize::from(match found {
            Err(FitError::Contradictory { .. } | FitError::Outliers { .. }) => true,
            Ok(found) => !found.is_noise(14),
            Err(error) => panic!("{seed}: {error}"),
        });
        // By 12 u over the run: what is left over of a line goes on from sample to sample.
        let mut drifting = run(&mut random, &curve, truth, 0.1, 20);
        for (sample, by) in drifting.iter_mut().zip(0..) {
            sample.slave += 0.6 * f64::from(by);
        }
        let found = fit(&curve, &drifting, &FitOptions::default());
        drifts += usize::from(match found {
            Err(FitError::Contradictory { .. } | FitError::Outliers { .. }) => true,
            Ok(found) => !found.is_noise(20),
            Err(error) => panic!("{seed}: {error}"),
        });
    }
    assert!(slips >= 95 && drifts >= 95, "{slips} {drifts}");
}

/// Two sensors' slips among sixty samples, one hiding behind the other; one among twelve; and none in clean data.
#[test]
fn outliers_are_named() {
    let curve = lift();
    let truth = [42.0, 1.0, -3.0, 1.0];
    for seed in 0..50 {
        let mut samples = run(&mut Random(seed + 70), &curve, truth, 0.2, 60);
        samples[20].slave += 9.0;
        samples[43].slave -= 8.0;
        let error = fit(&curve, &samples, &FitOptions::default()).expect_err("two");
        let FitError::Outliers { outliers } = &error else { panic!("{seed}: {error}") };
        let named: Vec<_> = outliers.iter().map(|(index, _)| *index).collect();
        assert_eq!(named, [21, 44], "{seed}: {error}");
        assert!((outliers[0].1 - 9.0).abs() < 2.0 && (outliers[1].1 + 8.0).abs() < 2.0);
    }
    // Exact but for one: the others say it alone.
    let mut samples = run(&mut Random(1), &curve, truth, 0.0, 12);
    samples[4].slave += 0.01;
    let error = fit(&curve, &samples, &FitOptions::default()).expect_err("one");
    let FitError::Outliers { outliers } = &error else { panic!("{error}") };
    assert_eq!((outliers.len(), outliers[0].0), (1, 5));
    // A position that is not a position at all.
    let mut samples = run(&mut Random(2), &curve, truth, 0.2, 60);
    samples[30].slave = 1e6;
    let error = fit(&curve, &samples, &FitOptions::default()).expect_err("one");
    assert!(matches!(&error, FitError::Outliers { outliers } if outliers[0].0 == 31), "{error}");
}

/// A master at rest, and one that stays where the cam rests.
#[test]
fn rests_are_reported() {
    let curve = lift();
    let mut random = Random(3);
    let still: Vec<_> = (0..40)
        .map(|_| Sample { master: 50.0, slave: 20.0 + 0.1 * random.normal(), weight: 1.0 })
        .collect();
    let error = fit(&curve, &still, &FitOptions::default()).expect_err("it stands");
    let said = "the master is at 50 in all 40 samples, which does not determine MasterOffset and SlaveOffset";
    assert_eq!(error.to_string(), said);
    for noise in [0.0, 0.05] {
        let dwell: Vec<_> = (0..40)
            .map(|index| Sample {
                master: 112.0 + f64::from(index),
                slave: 80.0 + noise * random.normal(),
                weight: 1.0,
            })
            .collect();
        let error = fit(&curve, &dwell, &FitOptions::default()).expect_err("it rests");
        assert!(
            matches!(error, FitError::Undetermined { .. } | FitError::Unexplained { .. }),
            "{noise}: {error}"
        );
    }
    // A master in radians for a cam in degrees.
    let other: Vec<_> = (0..600)
        .map(|index| 1.5 * f64::from(index))
        .map(|at| Sample {
            master: at.to_radians(),
            slave: curve.repeated(at).position,
            weight: 1.0,
        })
        .collect();
    let error = fit(&curve, &other, &FitOptions::default()).expect_err("other units");
    assert!(error.to_string().contains("check that master and slave are in the cam"), "{error}");
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
    // On a straight cam both offsets are one.
    let line = |master: f64| Knot { velocity: 0.5, ..Knot::at_rest(master, master / 2.0) };
    let straight = Curve::polynomial(&[line(0.0), line(360.0)]).expect("a curve");
    let samples = run(&mut random, &straight, truth, 0.1, 100);
    let error = fit(&straight, &samples, &FitOptions::default()).expect_err("one of two");
    assert_eq!(error, FitError::Undetermined { unknowns: vec!["MasterOffset", "SlaveOffset"] });
    // A master at rest.
    let still: Vec<_> = (0..100)
        .map(|_| Sample { master: 50.0, slave: 20.0 + 0.1 * random.normal(), weight: 1.0 })
        .collect();
    assert!(fit(&curve, &still, &free(true, true, false, false)).is_err());
    // A cam of two equal halves fits twice: 10 and 190, and 95 is as good as half-way between them.
    let twice = at_rest(&[(0.0, 0.0), (90.0, 50.0), (180.0, 0.0), (270.0, 50.0), (360.0, 0.0)]);
    let samples = run(&mut random, &twice, truth, 0.1, 100);
    let half_way = FitOptions { from: [95.0, 1.0, 0.0, 1.0], ..FitOptions::default() };
    let error = fit(&twice, &samples, &half_way).expect_err("two answers");
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
