//! Ramps: closed forms, and the coupling and the axis themselves, cycle by cycle.

use super::{Random, cases};
use crate::tune::{RampError, RampGoal, RampIn, RampWish, ramp_in};
use crate::{Approach, Cam, CamCoupling, CamInput, CamTable, Gap, Knot, Quantity, Shape};
use crate::{SlaveLimits, StartMode};
use RampType::{Parabolic, Sigmoid, Trapezoid};
use std::f64::consts::PI;
use std::sync::Arc;
use twin_profile::{AxisLimits, RampType, State};

const FREE: f64 = f64::INFINITY;
const KINDS: [RampType; 3] = [Trapezoid, Parabolic, Sigmoid];

fn limits([velocity, acceleration, jerk]: [f64; 3]) -> SlaveLimits {
    SlaveLimits { velocity, acceleration, jerk }
}

fn moving(position: f64, velocity: f64) -> State {
    State { position, velocity, acceleration: 0.0 }
}

fn wish(knots: &[Knot], master: State, slave: State, limits: SlaveLimits) -> RampWish {
    let shape = Shape::Polynomial(knots.to_vec());
    let cam = Arc::new(Cam::new("cam", shape, Vec::new()).expect("a cam"));
    RampWish {
        table: CamTable::new(cam),
        input: CamInput { start_mode: StartMode::RampIn, ..CamInput::default() },
        master,
        slave,
        ramp: Trapezoid,
        limits,
        position: [-FREE, FREE],
        goal: RampGoal::Soonest,
    }
}

/// A dwell at 10.
fn dwell() -> [Knot; 2] {
    [0.0, 360.0].map(|master| Knot::at_rest(master, 10.0))
}

/// A lift and its return.
fn lift() -> [Knot; 3] {
    [(0.0, 0.0), (180.0, 100.0), (360.0, 0.0)].map(|(master, slave)| Knot::at_rest(master, slave))
}

/// A cam that always goes at this part of the master's velocity.
fn line(slope: f64) -> [Knot; 2] {
    [0.0, 360.0].map(|master| Knot { velocity: slope, ..Knot::at_rest(master, slope * master) })
}

fn gentlest(within_s: f64, least: Quantity) -> RampGoal {
    RampGoal::Gentlest { within_s, least }
}

/// Onto a dwell at 10 from rest, in closed form.
///
/// As soon as can be: a trapezoid of 10 u at 2 u/s and 1 u/s² takes 10/2 + 2/1 s, and a triangle of 1 u 2·√(1/1) s. With 10 u/s² and
/// 100 u/s³ the peak v has v²/10 + v/10 = 10. Two half sines of π·v/(2·10) s go v each time, so π·v²/20 = 10, and the jerk is â·ω
/// with ω·T = π.
///
/// In T s over d no motion has a smaller peak of the acceleration than 4·d/T²; with the velocity limited to w it is w²/(w·T − d),
/// and with the jerk j limited a has (T/2 − a/j)·a·T/2 = d. With parabolic ramps the least jerk is +J, −J, +J for T/4, T/2 and
/// T/4, which goes J·T³/32; with sigmoid ones J = 4·π²·d/T³.
#[test]
fn ramps_onto_a_dwell_are_known() {
    let v_parabolic = (-0.1 + (0.01_f64 + 4.0).sqrt()) * 5.0;
    let v_sigmoid = (200.0 / PI).sqrt();
    let a = 50.0 * (2.0 - (4.0 - 4.0 * 5.0 / 100.0_f64).sqrt());
    let soonest = RampGoal::Soonest;
    let gentle = gentlest(4.0, Quantity::Acceleration);
    let parabolic = [2.0 * (v_parabolic / 10.0 + 0.1), v_parabolic, 10.0, 100.0];
    let sigmoid = [PI * v_sigmoid / 10.0, v_sigmoid, 10.0, 0.0];
    // Kind, where the slave is, limits, goal; then duration or any of the peaks of velocity, acceleration and jerk.
    let mut rows = vec![
        (Trapezoid, 0.0, [2.0, 1.0, FREE], soonest, [7.0, 2.0, 1.0, 0.0]),
        (Trapezoid, 9.0, [2.0, 1.0, FREE], soonest, [2.0, 0.0, 1.0, 0.0]),
        (Trapezoid, 20.0, [2.0, 1.0, FREE], soonest, [7.0, 2.0, 1.0, 0.0]),
        (Parabolic, 0.0, [100.0, 10.0, 100.0], soonest, parabolic),
        (Sigmoid, 0.0, [100.0, 10.0, 1000.0], soonest, sigmoid),
        (Trapezoid, 0.0, [100.0, 1000.0, FREE], gentle, [4.0, 0.0, 4.0 * 10.0 / 16.0, 0.0]),
        (Trapezoid, 0.0, [3.0, 1000.0, FREE], gentle, [4.0, 0.0, 9.0 / 2.0, 0.0]),
        (Parabolic, 0.0, [100.0, 10.0, 100.0], gentle, [4.0, 0.0, a, 0.0]),
    ];
    for t in [2.0, 0.5, 7.0_f64] {
        for (kind, jerk) in
            [(Parabolic, 32.0 * 10.0 / t.powi(3)), (Sigmoid, 4.0 * PI * PI * 10.0 / t.powi(3))]
        {
            let goal = gentlest(t, Quantity::Jerk);
            rows.push((kind, 0.0, [1e3, 1e4, 1e7], goal, [t, 0.0, 0.0, jerk]));
        }
    }
    for (ramp, slave, most, goal, expected) in rows {
        let slave = moving(slave, 0.0);
        let wish = wish(&dwell(), moving(5.0, 3.0), slave, limits(most));
        let found = ramp_in(&RampWish { ramp, goal, ..wish }).expect("a ramp");
        let RampIn { duration_s, peak_velocity, peak_acceleration, peak_jerk, .. } = found;
        let all = [duration_s, peak_velocity, peak_acceleration, peak_jerk];
        for (found_of, expected) in all.into_iter().zip(expected).filter(|(_, of)| *of > 0.0) {
            let off = found_of / expected - 1.0;
            assert!(off.abs() < 1e-6, "{ramp:?} {most:?} {goal:?}: {expected}, not {found:?}");
        }
        let [least, greatest] = found.positions;
        let ends = [slave.position.min(10.0), slave.position.max(10.0)];
        assert!((least - ends[0]).abs() < 1e-9 && (greatest - ends[1]).abs() < 1e-9, "{found:?}");
        if let RampGoal::Gentlest { within_s, .. } = goal {
            assert!(duration_s <= within_s, "{found:?}");
        }
    }
    // Who is on the cam already has nothing to go.
    let there = wish(&dwell(), moving(5.0, 3.0), moving(10.0, 0.0), limits([2.0, 1.0, FREE]));
    assert!(ramp_in(&there).expect("a ramp").duration_s == 0.0);
    // Half a metre at 1 mm/s is not a sensible ramp, and a longer one may be wished.
    let slow = wish(&dwell(), moving(5.0, 3.0), moving(0.0, 0.0), limits([1e-3, 10.0, 1e3]));
    let slow = RampWish { ramp: Sigmoid, ..slow };
    let error = ramp_in(&slow).expect_err("hours");
    assert!(matches!(error, RampError::TooLong { soonest_s, .. } if soonest_s > 9999.0), "{error}");
    let goal = gentlest(11_000.0, Quantity::Acceleration);
    ramp_in(&RampWish { goal, ..slow }).expect("a ramp");
}

/// A cam at half of the master's 100 u/s leaves 60 of 110 u/s: 60 u at 60 u/s and 100 u/s² take 60/60 + 60/100 s, whether the cam
/// flees or comes.
#[test]
fn a_ramp_has_what_the_cam_leaves() {
    for (slope, slave) in [(0.5, -60.0), (-0.5, -60.0)] {
        let wish = wish(
            &line(slope),
            moving(0.0, 100.0),
            moving(slave, slope * 100.0),
            limits([110.0, 100.0, FREE]),
        );
        let found = ramp_in(&wish).expect("a ramp");
        assert!((found.velocity_difference - 60.0).abs() < 1e-9, "{found:?}");
        assert!((found.duration_s - 1.6).abs() < 1e-9, "{found:?}");
        let peak = if slope > 0.0 { 110.0 } else { 50.0 };
        assert!((found.peak_velocity - peak).abs() < 1e-9, "{found:?}");
    }
}

/// From 9 at −4 u/s onto a dwell at 10 with 50 u/s² it turns at 9 − 16/100; with d it does at 9 − 16/(2·d), so that a limit of 8 asks
/// for 8 u/s² or more of a gentle one.
#[test]
fn positions_on_the_way_are_kept() {
    let wish = wish(&dwell(), moving(5.0, 3.0), moving(9.0, -4.0), limits([100.0, 50.0, FREE]));
    let within = |low: f64, goal| RampWish { position: [low, 20.0], goal, ..wish.clone() };
    let gentle = gentlest(5.0, Quantity::Acceleration);
    let found = ramp_in(&within(8.0, gentle)).expect("a ramp");
    assert!((found.deceleration - 8.0).abs() < 1e-3, "{found:?}");
    let free = ramp_in(&within(0.0, gentle)).expect("a ramp");
    assert!(free.positions[0] < 8.0, "{free:?}");
    let error = ramp_in(&within(8.99, RampGoal::Soonest)).expect_err("no room");
    let RampError::Beyond { what: "position", reached, limit: 8.99 } = error else {
        panic!("{error}")
    };
    assert!((reached - 8.84).abs() < 1e-6, "{error}");
}

#[test]
fn what_leaves_no_ramp_is_refused() {
    let refused = |knots: &[Knot], most, ramp, goal| {
        let wish = wish(knots, moving(90.0, 100.0), moving(0.0, 0.0), limits(most));
        ramp_in(&RampWish { ramp, goal, ..wish }).expect_err("no ramp")
    };
    let soonest = RampGoal::Soonest;
    for (ramp, most, what) in [
        (Trapezoid, [FREE; 3], "velocity"),
        (Parabolic, [1.0, 1.0, FREE], "jerk"),
        (Sigmoid, [1.0, 1.0, FREE], "jerk"),
    ] {
        let none = RampError::NoLimit { what, value: FREE };
        assert_eq!(refused(&lift(), most, ramp, soonest), none);
    }
    for (jerk, goal) in [(1e9, soonest), (FREE, gentlest(1.0, Quantity::Jerk))] {
        assert_eq!(refused(&lift(), [500.0, 1e4, jerk], Trapezoid, goal), RampError::Steps);
    }
    let error = refused(&line(0.5), [49.0, 1e6, FREE], Trapezoid, soonest);
    let RampError::NoRoom { what: "velocity", peak, limit: 49.0 } = error else {
        panic!("{error}")
    };
    assert!((peak - 50.0).abs() < 1e-9, "{error}");
    // In the middle of the lift y‴ is 30·100/180³ and more before and behind.
    let error = refused(&lift(), [1e4, 1e6, 10.0], Parabolic, soonest);
    assert!(matches!(error, RampError::NoRoom { what: "jerk", .. }), "{error}");
    let soon = gentlest(0.01, Quantity::Acceleration);
    let error = refused(&lift(), [500.0, 1e4, FREE], Trapezoid, soon);
    assert!(matches!(error, RampError::TooLate { soonest_s, .. } if soonest_s > 0.01), "{error}");
    assert!(error.to_string().ends_with("at the earliest, not within 0.01 s"), "{error}");
    let outside = wish(&lift(), moving(400.0, 1.0), moving(0.0, 0.0), limits([1.0, 1.0, FREE]));
    assert!(matches!(ramp_in(&outside), Err(RampError::Coupling(_))));
}

/// When a ramp is over, the largest velocity, acceleration and jerk, and from where to where it goes.
struct Driven {
    seconds: f64,
    peaks: [f64; 3],
    reached: [f64; 2],
}

/// Drives a ramp cycle by cycle until the slave is on its cam: with the coupling itself, or, with limited jerk, as an axis does.
fn driven(wish: &RampWish, ramp: &RampIn, cycle_s: f64) -> Driven {
    let RampIn { velocity_difference, acceleration, deceleration, ramp_jerk, .. } = *ramp;
    let input = CamInput { velocity_difference, acceleration, deceleration, ..wish.input };
    let (master, from) = (wish.master, wish.slave);
    let mut coupling =
        CamCoupling::start(wish.table.clone(), input, &master, &from, 0).expect("a start");
    let on_cam = |time: f64| {
        let curve = wish.table.cam.curve();
        let (at, v) = (curve.repeated(master.position + master.velocity * time), master.velocity);
        let [velocity, acceleration] = [at.velocity * v, at.acceleration * v * v];
        State { position: at.position, velocity, acceleration }
    };
    let cam = on_cam(0.0);
    let gap = Gap {
        distance: cam.position - from.position,
        velocity: from.velocity - cam.velocity,
        acceleration: -cam.acceleration,
        period: None,
        mode: StartMode::RampIn,
    };
    let with =
        AxisLimits { velocity: velocity_difference, acceleration, deceleration, jerk: ramp_jerk };
    let approach =
        (wish.ramp != Trapezoid).then(|| Approach::new(gap, with, wish.ramp).expect("a way").0);
    let (mut peaks, mut reached, mut before) = ([0.0_f64; 3], [from.position; 2], 0.0);
    for cycle in 0..10_000_000 {
        let seconds = f64::from(cycle) * cycle_s;
        let state = if let Some(approach) = &approach {
            approach.at(seconds, on_cam(seconds))
        } else {
            let at = moving(master.position + master.velocity * seconds, master.velocity);
            #[expect(clippy::cast_possible_truncation, reason = "seconds")]
            let coupled = coupling.step(&at, (seconds * 1e9).round() as i64).expect("a master");
            (!coupled.in_sync).then_some(coupled.slave)
        };
        let Some(state) = state else { return Driven { seconds, peaks, reached } };
        let jerk = (state.acceleration - before) / cycle_s;
        let now = [state.velocity, state.acceleration, jerk].map(f64::abs);
        peaks = std::array::from_fn(|index| peaks[index].max(now[index]));
        reached = [reached[0].min(state.position), reached[1].max(state.position)];
        before = state.acceleration;
    }
    unreachable!("a ramp ends")
}

/// A start onto the lift that random numbers make, forwards and backwards, from rest and in motion.
fn onto_lift(seed: u64, ramp: RampType) -> RampWish {
    let mut random = Random(seed + 700);
    let sign = if seed.is_multiple_of(3) { -1.0 } else { 1.0 };
    let master = moving(random.between(0.0, 360.0), sign * random.between(20.0, 300.0));
    let slave = moving(random.between(-50.0, 150.0), random.between(-20.0, 20.0));
    let jerk = if ramp == Trapezoid { FREE } else { 200_000.0 };
    RampWish { ramp, ..wish(&lift(), master, slave, limits([400.0, 4000.0, jerk])) }
}

/// What is reported of a ramp is what it does, cycle by cycle, and the limits hold for ramp and cam together: the soonest, and the
/// one with the least acceleration or jerk, which is no harder than the soonest one.
#[test]
fn ramps_are_what_they_do_and_keep_the_limits() {
    for (seed, ramp) in cases(0..40, 12).flat_map(|seed| KINDS.map(|ramp| (seed, ramp))) {
        let mut wish = onto_lift(seed, ramp);
        let soonest = ramp_in(&wish).unwrap_or_else(|error| panic!("{seed}: {error}"));
        let within_s = soonest.duration_s * Random(seed + 9000).between(1.2, 3.0);
        let mut found = vec![soonest];
        for least in [Quantity::Acceleration, Quantity::Jerk] {
            if ramp != Trapezoid || least == Quantity::Acceleration {
                wish.goal = gentlest(within_s, least);
                let gentle = ramp_in(&wish).unwrap_or_else(|error| panic!("{seed}: {error}"));
                assert!(gentle.duration_s <= within_s, "{seed}: {gentle:?}");
                let own = |ramp: &RampIn| match least {
                    Quantity::Jerk => ramp.ramp_jerk,
                    _ => ramp.acceleration,
                };
                assert!(own(&gentle) <= own(&soonest), "{seed}: {gentle:?}");
                found.push(gentle);
            }
        }
        for found in found {
            let cycle_s = 1e-4;
            let Driven { seconds, peaks, reached } = driven(&wish, &found, cycle_s);
            let case = format!("{seed} {ramp:?}: {seconds} {peaks:?} {reached:?} {found:?}");
            assert!((seconds - found.duration_s).abs() <= 1.1 * cycle_s, "{case}");
            let reported = [found.peak_velocity, found.peak_acceleration];
            for (peak, reported) in peaks.into_iter().zip(reported) {
                assert!((peak / reported - 1.0).abs() < 0.01, "{case}");
            }
            for (reached, reported) in reached.into_iter().zip(found.positions) {
                assert!((reached - reported).abs() < 0.05, "{case}");
            }
            let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
            for (peak, limit) in peaks.into_iter().zip([velocity, acceleration, jerk]) {
                let steps = ramp == Trapezoid && limit == FREE;
                assert!(steps || peak <= limit * (1.0 + 1e-9), "{case}");
            }
            assert!(ramp == Trapezoid || peaks[2] <= found.peak_jerk * (1.0 + 1e-6), "{case}");
        }
    }
}

/// Where the cam needs more than half of the limit of the jerk the ramp has the rest: both together keep it, by driving them, and with
/// all of it they would be beyond.
#[test]
fn ramp_and_cam_keep_the_jerk_together() {
    let mut beyond = 0;
    for (seed, ramp) in (0..8).flat_map(|seed| [(seed, Parabolic), (seed, Sigmoid)]) {
        let wish = onto_lift(seed, ramp);
        // y = 100·(10·u³ − 15·u⁴ + 6·u⁵), u = x/180, has its largest jerk, 60·100/180³, at its ends.
        let of_cam = 6000.0 * (wish.master.velocity / 180.0).abs().powi(3);
        let jerk = (1.7 * of_cam).max(2000.0);
        let wish = RampWish { limits: SlaveLimits { jerk, ..wish.limits }, ..wish };
        for goal in [RampGoal::Soonest, gentlest(6.0, Quantity::Acceleration)] {
            let wish = RampWish { goal, ..wish.clone() };
            let found = ramp_in(&wish).unwrap_or_else(|error| panic!("{seed} {ramp:?}: {error}"));
            let [reached, with_all] = [found, RampIn { ramp_jerk: jerk, ..found }]
                .map(|ramp| driven(&wish, &ramp, 1e-4).peaks[2]);
            assert!(reached <= jerk * (1.0 + 1e-6), "{seed} {ramp:?}: {reached} {found:?}");
            beyond += u32::from(with_all > 1.01 * jerk);
        }
    }
    assert!(beyond >= 8, "{beyond}");
}
