//! Ramps with limited jerk, and those that are gentlest by their jerk.

use super::Random;
use super::ramp_in::{dwell, lift, moving, wish};
use crate::tune::{RampError, RampGoal, RampIn, RampWish, ramp_in};
use crate::{Approach, Gap};
use crate::{Knot, Quantity, SlaveLimits, StartMode};
use std::f64::consts::PI;
use twin_profile::{AxisLimits, RampType, State};

fn least_jerk(within_s: f64) -> RampGoal {
    RampGoal::Gentlest { within_s, least: Quantity::Jerk }
}

/// In T s over d from rest to rest: with parabolic ramps the jerk is +J, −J, +J for T/4, T/2 and T/4, which goes J·T³/32; with
/// sigmoid ones two half sines take T/2 each, π·√(v/2J), and go v·T/2, so that J = 4·π²·d/T³. With trapezoid ones steps of a
/// that are a cycle t apart at least go a·(T² − t²)/4, and one step in a cycle is a jerk of a/t.
#[test]
fn the_least_jerk_onto_a_dwell_is_known() {
    let (d, t) = (10.0, 1e-3);
    for within_s in [0.5, 2.0, 7.0_f64] {
        for (ramp, expected) in [
            (RampType::Parabolic, 32.0 * d / within_s.powi(3)),
            (RampType::Sigmoid, 4.0 * PI * PI * d / within_s.powi(3)),
            (RampType::Trapezoid, 4.0 * d / (within_s * within_s - t * t) / t),
        ] {
            let limits = SlaveLimits { velocity: 1e3, acceleration: 1e4, jerk: 1e7 };
            let wish = wish(&dwell(), moving(5.0, 3.0), moving(0.0, 0.0), limits);
            let wish = RampWish { ramp, goal: least_jerk(within_s), ..wish };
            let found = ramp_in(&wish).expect("a ramp");
            assert!(found.duration_s <= within_s, "{ramp:?}: {found:?}");
            let off = found.peak_jerk / expected - 1.0;
            assert!(off.abs() < 1e-5, "{ramp:?} in {within_s} s: {expected}, not {found:?}");
            assert!(found.acceleration.max(found.deceleration) <= 1e4, "{found:?}");
            if ramp != RampType::Trapezoid {
                assert!((found.ramp_jerk / expected - 1.0).abs() < 1e-5, "{found:?}");
            }
        }
    }
}

/// 10 u from rest to rest: two half sines of π·v/(2·10) s go v each time, so π·v²/20 = 10.
#[test]
fn a_dwell_is_reached_by_sines() {
    let limits = SlaveLimits { velocity: 100.0, acceleration: 10.0, jerk: 1000.0 };
    let wish = wish(&dwell(), moving(5.0, 3.0), moving(0.0, 0.0), limits);
    let found = ramp_in(&RampWish { ramp: RampType::Sigmoid, ..wish.clone() }).expect("a ramp");
    let v = (200.0 / PI).sqrt();
    assert!((found.duration_s - PI * v / 10.0).abs() < 1e-6, "{found:?}");
    assert!((found.peak_velocity - v).abs() < 1e-5, "{found:?} {v}");
    assert!((found.peak_acceleration - 10.0).abs() < 1e-9, "{found:?}");
    // â·ω, and ω·T = π.
    assert!((found.peak_jerk - 10.0 * 20.0 / v).abs() < 1e-3, "{found:?}");
    let [least, greatest] = found.positions;
    assert!(least.abs() < 1e-9 && (greatest - 10.0).abs() < 1e-9, "{found:?}");
    // Half a metre at 1 mm/s is not a sensible ramp, and a longer one may be wished.
    let slow = SlaveLimits { velocity: 1e-3, ..limits };
    let error = ramp_in(&RampWish { limits: slow, ..wish.clone() }).expect_err("hours");
    assert!(matches!(error, RampError::TooLong { soonest_s, .. } if soonest_s > 9999.0), "{error}");
    let goal = RampGoal::Gentlest { within_s: 11_000.0, least: Quantity::Acceleration };
    ramp_in(&RampWish { limits: slow, goal, ..wish }).expect("a ramp");
}

/// Where accelerations say how gentle a ramp is, jerk is left over that nothing needs: the least one is reported. With less of it
/// the slave is late, or its jerk is larger.
#[test]
fn the_jerk_of_the_axis_is_the_least_one() {
    let knots = [
        Knot::at_rest(0.0, 0.0),
        Knot { velocity: 0.1, ..Knot::at_rest(150.0, 80.0) },
        Knot::at_rest(230.0, 40.0),
        Knot::at_rest(360.0, 0.0),
    ];
    let limits = SlaveLimits { velocity: 900.0, acceleration: 20_000.0, jerk: 2e6 };
    let wish = wish(&knots, moving(0.0, 200.0), moving(35.0, 0.0), limits);
    for ramp in [RampType::Sigmoid, RampType::Parabolic] {
        let wish = RampWish { ramp, goal: least_jerk(0.3), ..wish.clone() };
        let found = ramp_in(&wish).expect("a ramp");
        assert!(found.duration_s <= 0.3 && found.ramp_jerk < 60_000.0, "{found:?}");
        let reported = driven(&wish, &found);
        let with = |part: f64| RampIn { ramp_jerk: found.ramp_jerk * part, ..found };
        for part in [0.8, 0.95] {
            let Driven { seconds, peaks, .. } = driven(&wish, &with(part));
            let worse =
                seconds > reported.seconds + CYCLE_S || peaks[2] > reported.peaks[2] * 1.001;
            assert!(worse, "{ramp:?} {part}: {seconds} {peaks:?} {found:?}");
        }
    }
}

/// A ramp of these values in steps of 0.1 ms: when it is over, the largest velocity, acceleration and jerk, and how far it
/// goes.
struct Driven {
    seconds: f64,
    peaks: [f64; 3],
    reached: [f64; 2],
}

const CYCLE_S: f64 = 1e-4;

fn driven(wish: &RampWish, ramp: &RampIn) -> Driven {
    let curve = wish.table.cam.curve();
    let master = wish.master;
    let on_cam = |time: f64| {
        let at = curve.repeated(master.position + master.velocity * time);
        let v = master.velocity;
        State {
            position: at.position,
            velocity: at.velocity * v,
            acceleration: at.acceleration * v * v,
        }
    };
    let from = on_cam(0.0);
    let gap = Gap {
        distance: from.position - wish.slave.position,
        velocity: wish.slave.velocity - from.velocity,
        acceleration: -from.acceleration,
        period: None,
        mode: StartMode::RampIn,
    };
    let with = AxisLimits {
        velocity: ramp.velocity_difference,
        acceleration: ramp.acceleration,
        deceleration: ramp.deceleration,
        jerk: ramp.ramp_jerk,
    };
    let (approach, _) = Approach::new(gap, with, wish.ramp).expect("a way");
    let (mut peaks, mut reached, mut before) = ([0.0_f64; 3], [wish.slave.position; 2], 0.0);
    for cycle in 0..1_000_000 {
        let time = f64::from(cycle) * CYCLE_S;
        let Some(state) = approach.at(time, on_cam(time)) else {
            return Driven { seconds: time, peaks, reached };
        };
        let jerk = (state.acceleration - before) / CYCLE_S;
        let now = [state.velocity, state.acceleration, jerk].map(f64::abs);
        for (peak, now) in peaks.iter_mut().zip(now) {
            *peak = peak.max(now);
        }
        reached = [reached[0].min(state.position), reached[1].max(state.position)];
        before = state.acceleration;
    }
    unreachable!("a ramp ends")
}

/// A start onto the lift that random numbers make, with these ramps.
fn start(seed: u64, ramp: RampType) -> RampWish {
    let mut random = Random(seed + 700);
    let sign = if seed.is_multiple_of(3) { -1.0 } else { 1.0 };
    let master = moving(random.between(0.0, 360.0), sign * random.between(20.0, 300.0));
    let slave = moving(random.between(-50.0, 150.0), random.between(-20.0, 20.0));
    let limits = SlaveLimits { velocity: 400.0, acceleration: 4000.0, jerk: 200_000.0 };
    RampWish { ramp, ..wish(&lift(), master, slave, limits) }
}

/// What is reported of a ramp with limited jerk is what its motion and the cam's make together, cycle by cycle; its acceleration
/// begins with that of the slave and ends with that of the cam.
#[test]
fn what_ramps_with_limited_jerk_reach_is_what_they_do() {
    for (seed, ramp) in
        (0..40).flat_map(|seed| [RampType::Parabolic, RampType::Sigmoid].map(|ramp| (seed, ramp)))
    {
        let wish = start(seed, ramp);
        let found = ramp_in(&wish).unwrap_or_else(|error| panic!("{seed}: {error}"));
        let Driven { seconds, peaks, reached } = driven(&wish, &found);
        assert!((seconds - found.duration_s).abs() <= 1.1 * CYCLE_S, "{seed}: {seconds} {found:?}");
        let reported = [found.peak_velocity, found.peak_acceleration, found.peak_jerk];
        for (peak, reported) in peaks.into_iter().zip(reported) {
            assert!(
                peak <= reported * (1.0 + 1e-6) && peak >= 0.95 * reported,
                "{seed}: {peaks:?} {found:?}"
            );
        }
        for (reached, reported) in reached.into_iter().zip(found.positions) {
            assert!((reached - reported).abs() < 0.05, "{seed}: {reached} {found:?}");
        }
        assert!(
            reported[0] <= 400.0 * (1.0 + 1e-9) && reported[1] <= 4000.0 * (1.0 + 1e-9),
            "{seed}: {found:?}"
        );
        // The ramp's own jerk and the cam's.
        assert!(reported[2] <= 200_000.0 + found.peak_cam_jerk * (1.0 + 1e-9), "{seed}: {found:?}");
    }
}

/// On a moving cam no other values, near or far, get there in time with a jerk that is smaller, by driving them; and what is
/// found gets there in time, and has the jerk that is reported.
#[test]
fn no_other_ramp_has_less_jerk() {
    for (seed, ramp) in
        (0..8).flat_map(|seed| [RampType::Parabolic, RampType::Sigmoid].map(|ramp| (seed, ramp)))
    {
        let wish = start(seed, ramp);
        let soonest = ramp_in(&wish).unwrap_or_else(|error| panic!("{seed}: {error}"));
        let mut random = Random(seed + 9000);
        let within_s = soonest.duration_s * random.between(1.2, 3.0);
        let wish = RampWish { goal: least_jerk(within_s), ..wish };
        let found = ramp_in(&wish).unwrap_or_else(|error| panic!("{seed}: {error}"));
        let Driven { seconds, peaks, .. } = driven(&wish, &found);
        assert!(seconds <= within_s + 1.1 * CYCLE_S && found.duration_s <= within_s, "{seed}");
        assert!((peaks[2] / found.peak_jerk - 1.0).abs() < 0.05, "{seed}: {peaks:?} {found:?}");
        assert!(found.peak_jerk <= soonest.peak_jerk, "{seed}: {soonest:?} {found:?}");
        for _ in 0..150 {
            let far = random.between(0.0, 1.0) < 0.5;
            let mut other = |value: f64| {
                value
                    * if far {
                        random.between(-2.0, 1.5).exp()
                    } else {
                        random.between(-0.1, 0.1).exp()
                    }
            };
            let other = RampIn {
                velocity_difference: other(found.velocity_difference),
                acceleration: other(found.acceleration),
                deceleration: other(found.deceleration),
                ramp_jerk: other(found.ramp_jerk),
                ..found
            };
            let Driven { seconds, peaks, .. } = driven(&wish, &other);
            let kept = peaks[0] < 399.0 && peaks[1] < 3990.0 && other.ramp_jerk <= 200_000.0;
            if kept && seconds < within_s - CYCLE_S {
                assert!(
                    peaks[2] > found.peak_jerk * 0.97,
                    "{seed} {ramp:?}: {peaks:?} of {other:?}, not {found:?} in {within_s}"
                );
            }
        }
    }
}

/// `VelocityDiff` of a gentle ramp is never beyond the axis's velocity, where the cam comes towards the slave, either, so that the
/// slave itself would stay below its limit: a cam that goes down at 40 to 62 mm/s from 9 cm above it.
#[test]
fn no_gentle_ramp_has_a_velocity_beyond_the_axis() {
    for (ramp, jerk) in [(RampType::Trapezoid, f64::INFINITY), (RampType::Parabolic, 9e4)] {
        let limits = SlaveLimits { velocity: 60.0, acceleration: 3000.0, jerk };
        let wish = wish(&lift(), moving(230.0, 60.0), moving(-10.0, 0.0), limits);
        let wish = RampWish { ramp, ..wish };
        let soonest = ramp_in(&wish).expect("a ramp");
        let mut gentle = 0;
        for (least, more) in [
            (Quantity::Velocity, 1.2),
            (Quantity::Velocity, 2.0),
            (Quantity::Acceleration, 2.0),
            (Quantity::Jerk, 1.5),
            (Quantity::Jerk, 2.0),
        ] {
            let goal = RampGoal::Gentlest { within_s: more * soonest.duration_s, least };
            match ramp_in(&RampWish { goal, ..wish.clone() }) {
                Ok(found) => {
                    gentle += 1;
                    assert!(found.velocity_difference <= limits.velocity, "{least}: {found:?}");
                }
                Err(error) => assert!(matches!(error, RampError::TooLate { .. }), "{error}"),
            }
        }
        assert!(gentle >= 2, "{ramp:?}: {gentle}");
    }
}

/// The limit of the jerk is one of ramp and cam together: where the cam takes more than half of it the ramp has the rest, by
/// driving it. With all of it both together would be beyond.
#[test]
fn ramp_and_cam_keep_the_jerk_together() {
    let mut beyond = 0;
    for (seed, ramp) in
        (0..8).flat_map(|seed| [RampType::Parabolic, RampType::Sigmoid].map(|ramp| (seed, ramp)))
    {
        let wish = start(seed, ramp);
        // y = 100·(10·u³ − 15·u⁴ + 6·u⁵), u = x/180, has its largest jerk, 60·100/180³, at its ends.
        let of_cam = 6000.0 * (wish.master.velocity / 180.0).abs().powi(3);
        let jerk = (1.7 * of_cam).max(2000.0);
        let wish = RampWish { limits: SlaveLimits { jerk, ..wish.limits }, ..wish };
        let goal = RampGoal::Gentlest { within_s: 6.0, least: Quantity::Acceleration };
        for goal in [RampGoal::Soonest, goal] {
            let wish = RampWish { goal, ..wish.clone() };
            let found = ramp_in(&wish).unwrap_or_else(|error| panic!("{seed} {ramp:?}: {error}"));
            assert!(found.peak_jerk <= jerk * (1.0 + 1e-9), "{seed} {ramp:?}: {found:?}");
            let Driven { peaks: [.., reached], .. } = driven(&wish, &found);
            assert!(reached <= jerk * (1.0 + 1e-6), "{seed} {ramp:?}: {reached} {found:?}");
            let Driven { peaks: [.., with_all], .. } =
                driven(&wish, &RampIn { ramp_jerk: jerk, ..found });
            beyond += u32::from(with_all > 1.01 * jerk);
        }
    }
    assert!(beyond >= 8, "{beyond}");
}
