//! Outputs that switch at random, and few switchings that do not.

use super::found::Random;
use super::outputs::{VELOCITY, message, output_error, recorded};
use crate::cam::run::RecordedRun;
use crate::cam::tune::TuneError;

/// From one switching on to the next of group 1, and when its tappets are passed first, s.
const EVERY: f64 = 360.0 / VELOCITY;
const FIRST: [f64; 2] = [60.0 / VELOCITY, 200.0 / VELOCITY];

/// A run of group 1, whose output switches at these times, with samples that begin anywhere.
fn switched(times: &[f64], between: f64, random: &mut Random, noise: f64) -> RecordedRun {
    let begin = between * random.share();
    let end = times.last().copied().unwrap_or_default() + 0.2;
    let mut samples = 0;
    while begin + f64::from(samples) * between < end {
        samples += 1;
    }
    let mut run = recorded(&[1], between, samples, |_| vec![false]);
    for sample in &mut run.samples {
        sample.time_s += begin;
        sample.master = VELOCITY * sample.time_s + noise * random.normal();
        let before = times.iter().filter(|time| **time <= sample.time_s).count();
        sample.outputs = vec![before % 2 == 1];
    }
    run
}

/// On in the first half of every turn and off in the second, anywhere.
#[test]
fn switchings_anywhere_are_random() {
    for seed in 0..50 {
        let mut random = Random(seed + 40);
        let half = EVERY / 2.0;
        let times: Vec<_> =
            (0..160).map(|index| half * (f64::from(index) + random.share())).collect();
        let error = output_error(&switched(&times, 0.002, &mut random, 0.0));
        let TuneError::Scattered { group: 1, count, scatter_s, every_s } = error else {
            panic!("{seed}: {error}")
        };
        assert!((150.0..=160.0).contains(&count), "{seed}: {count}");
        assert!((every_s - EVERY).abs() < 1e-9);
        // Anywhere in half a turn, by edges that are 140° apart, 40° behind the begins of these halves.
        assert!(scatter_s > 0.15 && scatter_s < 0.25, "{scatter_s}");
        let said = error.to_string();
        assert!(said.contains("an output that switches at random looks the same"), "{said}");
    }
}

/// Four and six switchings of tappets that scatter by what the samples, noise of the master and a hundredth of a turn make of
/// them are refused in one run of 10,000 at most.
#[test]
fn few_switchings_that_are_right_are_taken() {
    let mut refused = Vec::new();
    for (between, scatter, noise) in [
        (0.1, 0.0, 0.0),
        (0.05, 0.0, 0.0),
        (0.02, 0.004, 1.0),
        (0.02, 0.0, 2.0),
        (0.002, 0.01, 0.0),
    ] {
        for count in [4, 6] {
            for seed in 0..1000 {
                let mut random = Random(seed + 7000);
                let mut place = |index: usize| {
                    let turn = f64::from(u32::try_from(index / 2).expect("a few"));
                    FIRST[index % 2] + turn * EVERY + 0.03 + scatter * random.normal()
                };
                let times: Vec<_> = (0..count).map(&mut place).collect();
                let run = switched(&times, between, &mut random, noise);
                if let Err(error) = message(&run) {
                    refused
                        .push(format!("{count} with {between} s, {scatter} s, {noise}: {error}"));
                }
            }
        }
    }
    assert!(refused.len() <= 1, "{} of 10,000: {refused:#?}", refused.len());
}

/// Four at random are fitted no oftener than by chance: all of them lie within w of a turn with a chance of 4·w³, and a scatter of
/// 0.05 turns has a range of 0.05·√6 at most, next to what the samples leave open.
#[test]
fn few_switchings_at_random_are_not() {
    for between in [0.002, 0.05] {
        let mut fitted = 0;
        for seed in 0..4000 {
            let mut random = Random(seed + 90_000);
            let mut times: Vec<_> = (0..4).map(|_| 0.1 + 2.0 * EVERY * random.share()).collect();
            times.sort_by(f64::total_cmp);
            fitted += u32::from(message(&switched(&times, between, &mut random, 0.0)).is_ok());
        }
        let within: f64 = 0.05 * 6.0_f64.sqrt() + between / EVERY;
        let most = 4000.0 * 4.0 * within.powi(3);
        assert!(f64::from(fitted) <= most, "{between} s: {fitted}, {most}");
    }
}
