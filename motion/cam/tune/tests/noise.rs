//! Intervals hold for noise as recordings have it: rounded, growing with the slope, of the master, and going on from sample to
//! sample.

use super::{Random, trials};
use crate::tune::{Fit, FitError, FitOptions, Free, Sample, fit};
use crate::{Curve, Knot};

/// 300 trials of which 95 % should hit: 92 to 98 %, within 2.4 standard deviations (seeds are fixed).
const TRIALS: u64 = 300;
const HITS: [f64; 2] = [0.92, 0.98];
const AND_MORE: [f64; 2] = [0.92, 1.0];

/// Goes up in another way than down, with a velocity at one point.
fn lift() -> Curve {
    Curve::polynomial(&[
        Knot::at_rest(0.0, 0.0),
        Knot { velocity: 0.1, ..Knot::at_rest(150.0, 80.0) },
        Knot::at_rest(230.0, 40.0),
        Knot::at_rest(360.0, 0.0),
    ])
    .expect("a curve")
}

struct Truth {
    offset: f64,
    shift: f64,
    factor: f64,
}

impl Truth {
    fn slave(&self, curve: &Curve, master: f64) -> f64 {
        self.factor * curve.repeated(master + self.offset).position + self.shift
    }
}

const FREE: Free = Free { master_scaling: false, ..Free::ALL };

/// A sample of the master's place and what is true.
type Make<'a> = dyn FnMut(&mut Random, &dyn Fn(f64) -> f64, f64) -> Sample + 'a;

/// What is found in trials of `count` samples in `turns` turns, of which this part is to hit each unknown; `sample` makes one
/// of the master's place and what is true.
fn tried(
    name: &str,
    [count, turns]: [u32; 2],
    [least, most]: [f64; 2],
    sample: &mut Make<'_>,
) -> Vec<Fit> {
    let curve = lift();
    let mut hits = [0_usize; 3];
    let mut all = Vec::new();
    let trials = trials(TRIALS);
    for seed in 0..trials {
        let mut random = Random(seed + 40_000);
        let truth = Truth {
            offset: random.between(-3.0, 3.0),
            shift: random.between(-1.0, 1.0),
            factor: random.between(0.97, 1.03),
        };
        let samples: Vec<_> = (0..count)
            .map(|index| {
                let master = 360.0 * f64::from(turns) * f64::from(index) / f64::from(count);
                sample(&mut random, &|master| truth.slave(&curve, master), master)
            })
            .collect();
        let options = FitOptions { free: FREE, ..FitOptions::default() };
        let found = fit(&curve, &samples, &options);
        let found = found.unwrap_or_else(|error| panic!("{name} {seed}: {error}"));
        assert!(found.is_noise(samples.len()), "{name} {seed}: {found:?}");
        let estimates = [found.estimates[0], found.estimates[2], found.estimates[3]];
        let truths = [truth.offset, truth.shift, truth.factor];
        for ((hits, estimate), truth) in hits.iter_mut().zip(estimates).zip(truths) {
            *hits += usize::from(estimate.holds(truth));
        }
        all.push(found);
    }
    // Of fewer trials chance has more.
    let count = f64::from(u32::try_from(trials).expect("a count"));
    let room = 2.4 * (0.0475_f64 / count).sqrt() - 0.03;
    for hits in hits {
        let part = f64::from(u32::try_from(hits).expect("a count")) / count;
        assert!((least - room..=most + room).contains(&part), "{name}: {hits} of {trials}");
    }
    all
}

fn at(master: f64, slave: f64) -> Sample {
    Sample { master, slave, weight: 1.0 }
}

/// What encoders and files do: to tenths and hundredths of a millimetre, without other noise and
/// with a little.
#[test]
fn rounded_positions() {
    for (step, noise) in [(0.1, 0.0), (0.01, 0.0), (0.1, 0.02), (0.1, 0.04), (0.1, 0.1)] {
        let name = format!("rounded to {step}, noise of {noise}");
        let found = tried(&name, [1200, 2], HITS, &mut |random, slave, master| {
            let slave = slave(master) + noise * random.normal();
            at(master, (slave / step).round() * step)
        });
        let seen = found.iter().filter(|found| (found.quantum - step).abs() < 1e-9).count();
        // Between, the step may be seen or not.
        assert!(
            if noise < 0.3 * step { seen == found.len() } else { 3 * seen < found.len() },
            "{name}: {seen}"
        );
    }
}

/// Of the master's encoder: what is left over grows with the slope.
#[test]
fn noise_of_the_master() {
    tried("master 0.3, slave 0.02", [1200, 2], HITS, &mut |random, slave, master| {
        at(master + 0.3 * random.normal(), slave(master) + 0.02 * random.normal())
    });
    tried("master 0.05, slave 0.005", [1200, 2], HITS, &mut |random, slave, master| {
        at(master + 0.05 * random.normal(), slave(master) + 0.005 * random.normal())
    });
}

/// So much jitter of the master that it flattens what is fitted: the intervals hold that. With a bias of one
/// sign they hold more than 95 %.
#[test]
fn jitter_that_shifts_is_held() {
    tried("master 1.5", [2400, 4], AND_MORE, &mut |random, slave, master| {
        at(master + 1.5 * random.normal(), slave(master) + 0.02 * random.normal())
    });
}

#[test]
fn noise_that_grows_with_the_slope() {
    let curve = lift();
    tried("grows", [1200, 2], HITS, &mut |random, slave, master| {
        let slope = curve.repeated(master).velocity;
        at(master, slave(master) + (0.02 + 0.3 * slope.abs()) * random.normal())
    });
}

#[test]
fn noise_that_goes_on_from_sample_to_sample() {
    for (rho, count) in [(0.3, 400), (0.3, 1200), (0.5, 800)] {
        let mut before = 0.0;
        tried(
            &format!("correlation {rho} of {count}"),
            [count, 2],
            HITS,
            &mut |random, slave, master| {
                let fresh = 0.1 * random.normal();
                // The first one of a run has the variance of all.
                let noise = if master == 0.0 {
                    fresh
                } else {
                    rho * before + fresh * (1.0_f64 - rho * rho).sqrt()
                };
                before = noise;
                at(master, slave(master) + noise)
            },
        );
    }
}

/// What goes on too strongly is not noise, and is reported.
#[test]
fn strong_correlation_is_reported() {
    let curve = lift();
    let mut random = Random(17);
    let mut noise = 0.0;
    let samples: Vec<_> = (0..400)
        .map(|index| {
            noise = 0.8 * noise + 0.06 * random.normal();
            let master = 1.8 * f64::from(index);
            at(master, curve.repeated(master).position + noise)
        })
        .collect();
    match fit(&curve, &samples, &FitOptions::default()) {
        Ok(found) => assert!(!found.is_noise(samples.len()), "{found:?}"),
        Err(error) => assert!(matches!(error, FitError::Contradictory { .. }), "{error}"),
    }
}

/// A master in radians for a cam in degrees: the slave moves, and that is not rest.
#[test]
fn other_units_of_the_master_are_reported() {
    let curve = lift();
    let samples: Vec<_> = (0..600)
        .map(|index| {
            let master = 1.5 * f64::from(index);
            at(master.to_radians(), curve.repeated(master).position)
        })
        .collect();
    for free in [FREE, Free { slave_scaling: false, ..FREE }] {
        let options = FitOptions { free, ..FitOptions::default() };
        let error = fit(&curve, &samples, &options).expect_err("other units");
        let FitError::TooFar { moved, way, .. } = error else { panic!("{error}") };
        assert!((moved - 80.0).abs() < 1.0 && (way - 15.7).abs() < 0.1, "{moved} {way}");
        assert!(error.to_string().contains("in the units of the cam"), "{error}");
    }
}
