//! Intervals of noise that goes on from sample to sample: many samples and few, alone and before rounding.

use super::intervals::{Case, OFFSETS, Right, SLAVE, STILL, TRIALS};

#[test]
fn noise_that_goes_on() {
    for (correlation, samples) in [(0.3, 400), (0.5, 600)] {
        for free in [OFFSETS, SLAVE] {
            Case { free, noise: 0.1, correlation, samples, ..STILL }.holds(Right::Hits);
        }
    }
}

/// Few samples show little of the correlation of noise. The estimate is rather too large, so that fewer than 93 % never hit,
/// while intervals of white noise of as many are no more than 15 % wider than its scatter asks for.
#[test]
fn few_samples_of_noise_that_goes_on() {
    for samples in [60, 100, 150, 300] {
        for correlation in [0.0, 0.3, 0.5, 0.6] {
            let case = Case { noise: 0.1, correlation, samples, ..STILL };
            for free in [OFFSETS, SLAVE] {
                let (hits, refused, wide) = Case { free, ..case }.tried();
                let name =
                    format!("{samples} {correlation} {free:?}: {hits:?} of {}", TRIALS - refused);
                println!("{name}, refused {refused}, wide {wide:?}");
                // One in twenty of those at the limit itself may be reported.
                assert!(refused <= if correlation < 0.6 { 5 } else { 60 }, "{name}: {refused}");
                let hit = hits.into_iter().all(|part| (0.93..=0.97).contains(&part));
                assert!(hit, "{name}");
                let white = wide.into_iter().all(|wide| wide < 1.15);
                assert!(correlation > 0.0 || white, "{name}: {wide:?}");
            }
        }
    }
}

/// Weak noise that goes on with steps that are coarse for it.
#[test]
fn coarse_steps_and_weak_noise_that_goes_on() {
    for (noise, correlation) in [(0.03, 0.3), (0.03, 0.5), (0.06, 0.3), (0.06, 0.5)] {
        for samples in [150, 300] {
            let case = Case { noise, correlation, samples, step: 0.1, ..STILL };
            for free in [OFFSETS, SLAVE] {
                let (hits, refused, wide) = Case { free, ..case }.tried();
                println!(
                    "{noise} {correlation} {samples} {free:?}: {hits:?}, refused {refused}, wide {wide:?}"
                );
                let hit = hits.into_iter().all(|part| part >= 0.93);
                assert!(
                    hit && refused <= 5,
                    "{noise} {correlation} {samples}: {hits:?}, refused {refused}"
                );
            }
        }
    }
}
