//! Ramps of all kinds against a brute witness: ramps tried at random, and then nearer and nearer to the best of them, each by
//! the exact evaluation; and what must not change the answer.

use super::super::ramp_in::Problem;
use super::Random;
use crate::tune::{RampGoal, RampIn, RampWish, ramp_in};
use crate::{Quantity, SlaveLimits};
use twin_profile::RampType;

/// Harder by this part is worse than the witness.
const WORSE: f64 = 0.01;
/// Harder by this part is another answer.
const OTHER: f64 = 0.005;
const LEAST: [Quantity; 3] = [Quantity::Velocity, Quantity::Acceleration, Quantity::Jerk];

/// A start onto one of both cams that random numbers make: some with positions that hold the slave, and some trapezoid ones
/// with a limit of the jerk of their steps.
fn start(seed: u64, ramp: RampType) -> RampWish {
    let mut wish = super::ramp_best::start(seed, ramp);
    if ramp == RampType::Trapezoid && seed % 5 == 2 {
        wish.limits.jerk = 1000.0 * wish.limits.acceleration;
    }
    if seed % 7 == 3 {
        wish.position = [-1.0, 90.0];
    }
    wish
}

/// What a ramp is judged by; infinite if it comes too late.
pub(super) fn score(goal: RampGoal, ramp: &RampIn) -> f64 {
    match goal {
        RampGoal::Soonest => ramp.duration_s,
        RampGoal::Gentlest { within_s, .. } if ramp.duration_s > within_s => f64::INFINITY,
        RampGoal::Gentlest { least, .. } => ramp.peak(least),
    }
}

/// The best of `count` values, half of them anywhere, half of them nearer and nearer to the best.
pub(super) fn witness(wish: &RampWish, count: u32, seed: u64) -> Option<RampIn> {
    let problem = Problem::new(wish).expect("a start");
    let mut random = Random(seed);
    let mut best: Option<RampIn> = None;
    let limits = wish.limits;
    let most = match wish.goal {
        RampGoal::Soonest => f64::INFINITY,
        RampGoal::Gentlest { .. } => limits.velocity,
    };
    for index in 0..count {
        let near = best.filter(|_| index > count / 2);
        let values = match near {
            None => {
                let mut two = |low, high| random.between(low, high).exp2();
                let pull = limits.acceleration;
                let jerk = if limits.jerk.is_finite() {
                    limits.jerk * two(-8.0, 0.0)
                } else {
                    f64::INFINITY
                };
                [
                    limits.velocity * two(-5.0, 2.0),
                    pull * two(-8.0, 1.0),
                    pull * two(-8.0, 1.0),
                    jerk,
                ]
            }
            Some(best) => {
                let left = 1.0 - f64::from(index) / f64::from(count);
                [best.velocity_difference, best.acceleration, best.deceleration, best.ramp_jerk]
                    .map(|value| value * (random.normal() * (0.002 + left * left)).exp())
            }
        };
        let [velocity, up, down, jerk] = values;
        let values = [velocity.min(most), up, down, jerk.min(limits.jerk)];
        let Ok(found) = problem.ramp(values) else { continue };
        let now = score(wish.goal, &found);
        let better = best.is_none_or(|best| now < score(wish.goal, &best));
        if better && now.is_finite() && problem.keeps(&found) {
            best = Some(found);
        }
    }
    best
}

/// The wishes of a start: the soonest ramp, and the gentlest ones in a time that is a little or much longer.
fn wishes(seed: u64, ramp: RampType) -> Vec<RampWish> {
    let wish = start(seed, ramp);
    let mut wishes = vec![wish.clone()];
    if let Ok(soonest) = ramp_in(&wish) {
        let more = 1.02 + 0.4 * f64::from(u32::try_from(seed % 7).expect("small"));
        let within_s = more * soonest.duration_s;
        wishes.extend(LEAST.map(|least| RampWish {
            goal: RampGoal::Gentlest { within_s, least },
            ..wish.clone()
        }));
    }
    wishes
}

/// Nothing that the witness finds is better.
fn against_the_witness(ramp: RampType, seeds: u64, count: u32) {
    let (mut worse, mut compared) = (Vec::new(), 0);
    for seed in 0..seeds {
        for wish in wishes(seed, ramp) {
            let Some(other) = witness(&wish, count, 900 + seed) else { continue };
            compared += 1;
            match ramp_in(&wish) {
                Ok(found) => {
                    assert!(
                        Problem::new(&wish).expect("a start").keeps(&found),
                        "{seed}: {found:?}"
                    );
                    let [now, best] = [found, other].map(|ramp| score(wish.goal, &ramp));
                    if now > best * (1.0 + WORSE) {
                        worse.push(format!("{seed} {:?}: {found:?}, but {other:?}", wish.goal));
                    }
                }
                Err(error) => worse.push(format!("{seed} {:?}: {error}, but {other:?}", wish.goal)),
            }
        }
    }
    assert!(worse.is_empty(), "{ramp:?}: {} of {compared}: {worse:#?}", worse.len());
    assert!(compared >= 3 * seeds, "{ramp:?}: {compared}");
}

#[test]
fn no_trapezoid_ramp_that_is_tried_is_better() {
    against_the_witness(RampType::Trapezoid, 18, 5000);
}

#[test]
fn no_parabolic_ramp_that_is_tried_is_better() {
    against_the_witness(RampType::Parabolic, 10, 5000);
}

#[test]
fn no_sigmoid_ramp_that_is_tried_is_better() {
    against_the_witness(RampType::Sigmoid, 8, 4000);
}

const KINDS: [(RampType, u64); 3] =
    [(RampType::Trapezoid, 4), (RampType::Parabolic, 1), (RampType::Sigmoid, 1)];

/// Who has more time is never harder: what was found in less is there still.
#[test]
fn more_time_is_never_harder() {
    for (ramp, seeds) in KINDS {
        for wish in (0..seeds).chain([8]).flat_map(|seed| wishes(seed, ramp)) {
            let RampGoal::Gentlest { within_s, least } = wish.goal else { continue };
            let Ok(found) = ramp_in(&wish) else { continue };
            let mut before = score(wish.goal, &found);
            for more in [1.3, 2.0, 4.0, 8.0] {
                let goal = RampGoal::Gentlest { within_s: more * within_s, least };
                let other = ramp_in(&RampWish { goal, ..wish.clone() });
                let other = other.unwrap_or_else(|error| panic!("{ramp:?} {goal:?}: {error}"));
                let now = score(goal, &other);
                assert!(now <= before * (1.0 + OTHER), "{ramp:?} {goal:?}: {found:?} {other:?}");
                before = before.min(now);
            }
        }
    }
}

/// A limit that a ramp does not come near does not change it, if it is ten times as large.
#[test]
fn limits_that_hold_nothing_change_nothing() {
    let mut changed = 0;
    for (ramp, seeds) in KINDS {
        for wish in (0..seeds).flat_map(|seed| wishes(seed, ramp)) {
            let Ok(found) = ramp_in(&wish) else { continue };
            let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
            let far = |reached: f64, limit: f64| if reached < 0.99 * limit { 10.0 } else { 1.0 };
            let limits = SlaveLimits {
                velocity: velocity
                    * far(found.peak_velocity.max(found.velocity_difference), velocity),
                acceleration: acceleration * far(found.peak_acceleration, acceleration),
                jerk: jerk * far(found.peak_jerk.max(found.ramp_jerk), jerk),
            };
            if limits == wish.limits {
                continue;
            }
            changed += 1;
            let other = ramp_in(&RampWish { limits, ..wish.clone() });
            let other = other.unwrap_or_else(|error| panic!("{ramp:?} {:?}: {error}", wish.goal));
            let [before, now] = [found, other].map(|ramp| score(wish.goal, &ramp));
            assert!(now <= before * (1.0 + OTHER), "{:?}: {found:?} {other:?}", wish.goal);
            // Where it is better, it uses what it was given.
            let kept = Problem::new(&wish).expect("a start").keeps(&other);
            assert!(!kept || now >= before * (1.0 - OTHER), "{:?}: {found:?} {other:?}", wish.goal);
        }
    }
    assert!(changed >= 15, "{changed}");
}
