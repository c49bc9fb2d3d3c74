//! Ramps against the best that others found: an independent search, and a brute one with the exact evaluation.

use super::super::ramp_in::Problem;
use super::Random;
use super::ramp_in::{lift, limits, moving, wish};
use super::ramp_witness::witness;
use crate::tune::{RampGoal, RampWish, ramp_in};
use crate::{Knot, Quantity, SlaveLimits};
use twin_profile::RampType;

/// `examples/cams/pick_and_place.toml`.
fn pick_and_place() -> [Knot; 7] {
    [
        (0.0, 0.0),
        (40.0, 0.0),
        (140.0, 80.0),
        (180.0, 80.0),
        (260.0, 12.0),
        (300.0, 12.0),
        (360.0, 0.0),
    ]
    .map(|(master, slave)| Knot::at_rest(master, slave))
}

/// A start onto it from rest, or with a velocity: master and its velocity, slave and its velocity.
fn pick([master, turns, slave, moves]: [f64; 4], limits: SlaveLimits) -> RampWish {
    wish(&pick_and_place(), moving(master, turns), moving(slave, moves), limits)
}

fn within(within_s: f64) -> RampGoal {
    RampGoal::Gentlest { within_s, least: Quantity::Acceleration }
}

/// What a search of its own found that knows nothing of this one. A job with these values was on its cam after `measured` seconds,
/// as far as its samples show a ramp that comes onto it slower and slower, and kept the limits.
#[test]
fn no_ramp_is_longer_than_one_that_is_known() {
    for (start, velocity, acceleration, measured, by) in [
        ([330.0, 160.0, 74.0, 0.0], 165.0, 4000.0, 0.544, [162.76, 1094.01, 2825.94]),
        ([68.0, 160.0, 7.0, 0.0], 285.0, 2600.0, 0.341, [115.65, 698.74, 1412.57]),
        ([32.0, 180.0, 35.0, 0.0], 265.0, 3000.0, 0.263, [311.52, 2993.99, 1498.2]),
        ([355.0, 150.0, 72.0, 0.0], 270.0, 1750.0, 0.539, [261.18, 1746.23, 710.35]),
        ([30.0, 160.0, 45.0, 0.0], 390.0, 2300.0, 0.344, [2480.57, 2295.27, 1112.98]),
    ] {
        let wish = pick(start, limits(velocity, acceleration));
        // The known one is within the limits, and as quick as it was measured.
        let [v, up, down] = by;
        let problem = Problem::new(&wish).expect("a start");
        let other = problem.ramp([v, up, down, f64::INFINITY]).expect("a ramp");
        assert!(problem.keeps(&other), "{start:?}: {other:?}");
        assert!((other.duration_s - measured).abs() < 3e-3, "{start:?}: {other:?}");
        let found = ramp_in(&wish).unwrap_or_else(|error| panic!("{start:?}: {error}"));
        assert!(found.duration_s <= other.duration_s * 1.0002, "{start:?}: {found:?} {other:?}");
        assert!(found.peak_velocity <= velocity * (1.0 + 1e-9), "{start:?}: {found:?}");
        assert!(found.peak_acceleration <= acceleration * (1.0 + 1e-9), "{start:?}: {found:?}");
    }
}

/// The same search with a time: the peaks that it found, and once the values with the peak that is theirs exactly.
#[test]
fn no_ramp_is_harder_than_one_that_is_known() {
    for (start, within_s, known, by) in [
        ([100.0, 100.0, 35.0, 0.0], 0.5, 1027.0, Some([103.29, 1466.9, 1027.0])),
        ([100.0, 100.0, 35.0, 50.0], 0.5, 799.0, None),
        ([30.0, 200.0, 20.0, 0.0], 0.6, 1420.0, None),
        ([60.0, 100.0, 35.0, 0.0], 0.4, 742.6, None),
    ] {
        let wish = pick(start, limits(300.0, 20_000.0));
        let wish = RampWish { goal: within(within_s), ..wish };
        let mut known: f64 = known;
        if let Some([v, up, down]) = by {
            let problem = Problem::new(&wish).expect("a start");
            let other = problem.ramp([v, up, down, f64::INFINITY]).expect("a ramp");
            assert!(other.duration_s <= within_s && problem.keeps(&other), "{other:?}");
            known = known.max(other.peak_acceleration);
        }
        let found = ramp_in(&wish).unwrap_or_else(|error| panic!("{start:?}: {error}"));
        assert!(found.duration_s <= within_s, "{start:?}: {found:?}");
        assert!(found.peak_acceleration <= known * 1.0002, "{start:?}: {known} {found:?}");
    }
}

/// A start onto one of both cams that random numbers make.
pub(super) fn start(seed: u64, ramp: RampType) -> RampWish {
    let mut random = Random(seed + 4100);
    let sign = if seed.is_multiple_of(4) { -1.0 } else { 1.0 };
    let master = moving(random.between(0.0, 360.0), sign * random.between(40.0, 220.0));
    let moves = if seed.is_multiple_of(3) { random.between(-40.0, 40.0) } else { 0.0 };
    let slave = moving(random.between(0.0, 80.0), moves);
    let most = limits(random.between(200.0, 500.0), random.between(2000.0, 6000.0));
    let jerk = most.acceleration * random.between(10.0, 60.0);
    let trapezoid = ramp == RampType::Trapezoid;
    let most = SlaveLimits { jerk: if trapezoid { f64::INFINITY } else { jerk }, ..most };
    let knots: &[Knot] = if seed.is_multiple_of(2) { &pick_and_place() } else { &lift() };
    RampWish { ramp, ..wish(knots, master, slave, most) }
}

const TRIALS: u32 = 20_000;

/// Nothing that is tried at random, and then nearer and nearer to the best of it, is sooner.
#[test]
fn no_ramp_of_many_is_sooner() {
    let mut worse = Vec::new();
    for seed in 0..40 {
        let wish = start(seed, RampType::Trapezoid);
        let other = witness(&wish, TRIALS, 77);
        match (ramp_in(&wish), other) {
            (Ok(found), Some(other)) if found.duration_s > other.duration_s * 1.002 => {
                worse.push(format!("{seed}: {found:?}, but {other:?}"));
            }
            (Err(error), Some(other)) => worse.push(format!("{seed}: {error}, but {other:?}")),
            _ => {}
        }
    }
    assert!(worse.is_empty(), "{} {worse:#?}", worse.len());
}

/// Nor is anything gentler in the same time.
#[test]
fn no_ramp_of_many_is_gentler() {
    let mut worse = Vec::new();
    let trapezoids = (0..24).map(|seed| (seed, RampType::Trapezoid));
    let parabolic = (12..18).map(|seed| (seed, RampType::Parabolic));
    for (seed, ramp) in trapezoids.chain(parabolic) {
        let wish = start(seed, ramp);
        let Ok(soonest) = ramp_in(&wish) else { continue };
        let within_s =
            soonest.duration_s * (1.2 + 0.2 * f64::from(u32::try_from(seed % 5).unwrap()));
        let wish = RampWish { goal: within(within_s), ..wish };
        let other = witness(&wish, TRIALS, 77);
        match (ramp_in(&wish), other) {
            (Ok(found), Some(other))
                if found.peak_acceleration > other.peak_acceleration * 1.002 =>
            {
                worse.push(format!("{seed} {ramp:?}: {found:?}, but {other:?}"));
            }
            (Err(error), Some(other)) => worse.push(format!("{seed}: {error}, but {other:?}")),
            _ => {}
        }
    }
    assert!(worse.is_empty(), "{} {worse:#?}", worse.len());
}

/// With the same limits an acceleration that grows by the jerk at once is there before one that grows as a sine, which has that
/// jerk at its begin only.
#[test]
fn parabolic_ramps_are_never_slower_than_sigmoid_ones() {
    let known = SlaveLimits { velocity: 300.0, acceleration: 4000.0, jerk: 60_000.0 };
    let mut wishes =
        vec![pick([354.83, 153.24, 72.41, 0.0], known), pick([193.67, 116.71, 8.52, 0.0], known)];
    wishes.extend((0..12).map(|seed| start(seed, RampType::Sigmoid)));
    let mut compared = 0_u64;
    for wish in wishes {
        let with = |ramp| ramp_in(&RampWish { ramp, ..wish.clone() });
        let (parabolic, sigmoid) = (with(RampType::Parabolic), with(RampType::Sigmoid));
        let Ok(sigmoid) = sigmoid else { continue };
        let parabolic = parabolic.unwrap_or_else(|error| panic!("{error}, but {sigmoid:?}"));
        compared += 1;
        assert!(
            parabolic.duration_s <= sigmoid.duration_s * 1.0005,
            "{:?}: {parabolic:?}, but {sigmoid:?}",
            wish.master
        );
    }
    assert!(compared >= 10, "{compared}");
}
