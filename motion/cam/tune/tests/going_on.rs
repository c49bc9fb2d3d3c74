//! Intervals of noise that goes on from sample to sample: many samples and few, alone and before rounding.

use super::intervals::{Case, OFFSETS, Right, SLAVE, STILL, TRIALS};
use super::{right, trials};

#[test]
fn noise_that_goes_on() {
    for (correlation, samples) in [(0.3, 400), (0.5, 600)] {
        for free in [OFFSETS, SLAVE] {
            Case { free, noise: 0.1, correlation, samples, ..STILL }.holds(Right::Hits);
        }
    }
}

/// The least part of the trials that hits.
fn low(trials: u64) -> f64 {
    let part = |count: usize| f64::from(u32::try_from(count).expect("a count"));
    part(*right(trials).start()) / part(usize::try_from(trials).expect("a count"))
}

/// Few samples tell little of how noise goes on. What is reckoned with is rather too much, so that fewer than 93 % never hit,
/// while intervals of white noise of as many are no more than 15 % wider than its scatter asks for.
#[test]
fn few_samples_of_noise_that_goes_on() {
    for samples in [60, 100, 150, 300] {
        for correlation in [0.0, 0.3, 0.5, 0.6] {
            let case = Case { noise: 0.1, correlation, samples, ..STILL };
            for free in [OFFSETS, SLAVE] {
                let (hits, told, wide) = Case { free, ..case }.tried();
                let trials = trials(TRIALS);
                let name =
                    format!("{samples} {correlation} {free:?}: {hits:?} of {}", trials - told);
                println!("{name}, told {told}, wide {wide:?}");
                // One in twenty of those at the limit itself may be told.
                assert!(
                    told <= if correlation < 0.6 { 5 } else { trials * 6 / 100 },
                    "{name}: {told}"
                );
                let hit = hits.into_iter().all(|part| (low(trials)..=0.985).contains(&part));
                assert!(hit, "{name}");
                // The scatter of fewer trials is known to a few per cent.
                let most = if trials < 1000 { 1.25 } else { 1.15 };
                let white = wide.into_iter().all(|wide| wide < most);
                assert!(correlation > 0.0 || white, "{name}: {wide:?}");
            }
        }
    }
}

/// Weak noise that goes on beside steps that are coarse for it.
#[test]
fn coarse_steps_and_weak_noise_that_goes_on() {
    for (noise, correlation) in [(0.03, 0.3), (0.03, 0.5), (0.06, 0.3), (0.06, 0.5)] {
        for samples in [150, 300] {
            let case = Case { noise, correlation, samples, step: 0.1, ..STILL };
            for free in [OFFSETS, SLAVE] {
                let (hits, told, wide) = Case { free, ..case }.tried();
                println!(
                    "{noise} {correlation} {samples} {free:?}: {hits:?}, told {told}, wide {wide:?}"
                );
                let hit = hits.into_iter().all(|part| part >= low(trials(TRIALS)));
                assert!(hit && told <= 5, "{noise} {correlation} {samples}: {hits:?}, told {told}");
            }
        }
    }
}
