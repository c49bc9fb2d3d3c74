//! Ramps: closed forms, the coupling itself, an independent search, and a brute witness with the exact evaluation.

use super::super::ramp_in::Problem;
use super::{Random, cases, long};
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
        cycle_s: 1e-3,
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

/// `examples/cams/pick_and_place.toml`.
fn pick_and_place() -> [Knot; 7] {
    let at = [(0.0, 0.0), (40.0, 0.0), (140.0, 80.0), (180.0, 80.0), (260.0, 12.0), (300.0, 12.0)];
    let [a, b, c, d, e, f] = at.map(|(master, slave)| Knot::at_rest(master, slave));
    [a, b, c, d, e, f, Knot::at_rest(360.0, 0.0)]
}

fn gentlest(within_s: f64, least: Quantity) -> RampGoal {
    RampGoal::Gentlest { within_s, least }
}

/// What a ramp is judged by; infinite if it comes too late.
fn score(goal: RampGoal, ramp: &RampIn) -> f64 {
    match goal {
        RampGoal::Soonest => ramp.duration_s,
        RampGoal::Gentlest { within_s, .. } if ramp.duration_s > within_s => FREE,
        RampGoal::Gentlest { least, .. } => ramp.peak(least),
    }
}

/// Onto a dwell at 10 from rest, in closed form.
///
/// As soon as can be: a trapezoid of 10 u at 2 u/s and 1 u/s² takes 10/2 + 2/1 s, and a triangle of 1 u 2·√(1/1) s. With steps of
/// the acceleration of a = J·t at most that are a cycle t apart at least, 1 u takes √(t² + 4/a): without the cycle between them up
/// and down were one step of 2·a. With 10 u/s² and 100 u/s³ the peak v has v²/10 + v/10 = 10. Two half sines of π·v/(2·10) s go v
/// each time, so π·v²/20 = 10, and the jerk is â·ω with ω·T = π.
///
/// In T s over d no motion has a smaller peak of the acceleration than 4·d/T²; with the velocity limited to w it is w²/(w·T − d),
/// and with the jerk j limited a has (T/2 − a/j)·a·T/2 = d. With parabolic ramps the least jerk is +J, −J, +J for T/4, T/2 and
/// T/4, which goes J·T³/32; with sigmoid ones J = 4·π²·d/T³; with trapezoid ones steps of a go a·(T² − t²)/4, a jerk of a/t.
#[test]
fn ramps_onto_a_dwell_are_known() {
    let v_parabolic = (-0.1 + (0.01_f64 + 4.0).sqrt()) * 5.0;
    let v_sigmoid = (200.0 / PI).sqrt();
    let steps = |cycle_s: f64| (cycle_s * cycle_s + 4.0 / (4000.0 * cycle_s)).sqrt();
    let a = 50.0 * (2.0 - (4.0 - 4.0 * 5.0 / 100.0_f64).sqrt());
    let soonest = RampGoal::Soonest;
    let gentle = |within_s| gentlest(within_s, Quantity::Acceleration);
    let of_jerk = [100.0, 10.0, 100.0];
    let of_sines = [100.0, 10.0, 1000.0];
    let of_steps = [100.0, 50.0, 4000.0];
    // Kind, where the slave is, limits, goal, cycle; then duration or any of the peaks, and how exact they are.
    let mut rows = vec![
        (Trapezoid, 0.0, [2.0, 1.0, FREE], soonest, 1e-3, [7.0, 2.0, 1.0, 0.0], 1e-6),
        (Trapezoid, 9.0, [2.0, 1.0, FREE], soonest, 1e-3, [2.0, 0.0, 1.0, 0.0], 1e-6),
        (Trapezoid, 20.0, [2.0, 1.0, FREE], soonest, 1e-3, [7.0, 2.0, 1.0, 0.0], 1e-6),
        (Trapezoid, 9.0, of_steps, soonest, 1e-3, [steps(1e-3), 0.0, 0.0, 4000.0], 1e-3),
        (Trapezoid, 9.0, of_steps, soonest, 1e-2, [steps(1e-2), 0.0, 0.0, 4000.0], 1e-3),
        (
            Parabolic,
            0.0,
            of_jerk,
            soonest,
            1e-3,
            [2.0 * (v_parabolic / 10.0 + 0.1), v_parabolic, 10.0, 100.0],
            1e-6,
        ),
        (
            Sigmoid,
            0.0,
            of_sines,
            soonest,
            1e-3,
            [PI * v_sigmoid / 10.0, v_sigmoid, 10.0, 200.0 / v_sigmoid],
            1e-5,
        ),
        (
            Trapezoid,
            0.0,
            [100.0, 1000.0, FREE],
            gentle(4.0),
            1e-3,
            [0.0, 0.0, 4.0 * 10.0 / 16.0, 0.0],
            1e-5,
        ),
        (Trapezoid, 0.0, [3.0, 1000.0, FREE], gentle(4.0), 1e-3, [0.0, 0.0, 9.0 / 2.0, 0.0], 1e-5),
        (Parabolic, 0.0, of_jerk, gentle(4.0), 1e-3, [0.0, 0.0, a, 0.0], 1e-4),
    ];
    for t in cases([2.0, 0.5, 7.0_f64], 1) {
        for (kind, jerk) in [
            (Parabolic, 32.0 * 10.0 / t.powi(3)),
            (Sigmoid, 4.0 * PI * PI * 10.0 / t.powi(3)),
            (Trapezoid, 4.0 * 10.0 / (t * t - 1e-6) / 1e-3),
        ] {
            let goal = gentlest(t, Quantity::Jerk);
            rows.push((kind, 0.0, [1e3, 1e4, 1e7], goal, 1e-3, [0.0, 0.0, 0.0, jerk], 1e-5));
        }
    }
    for (ramp, slave, most, goal, cycle_s, expected, exact) in rows {
        let slave = moving(slave, 0.0);
        let wish = wish(&dwell(), moving(5.0, 3.0), slave, limits(most));
        let wish = RampWish { ramp, cycle_s, goal, ..wish };
        let found = ramp_in(&wish).expect("a ramp");
        let RampIn { duration_s, peak_velocity, peak_acceleration, peak_jerk, .. } = found;
        let all = [duration_s, peak_velocity, peak_acceleration, peak_jerk];
        for (found_of, expected) in all.into_iter().zip(expected).filter(|(_, of)| *of > 0.0) {
            let off = found_of / expected - 1.0;
            assert!(off.abs() < exact, "{ramp:?} {most:?} {goal:?}: {expected}, not {found:?}");
        }
        for (peak, most) in all[1..].iter().zip(most) {
            assert!(*peak <= most * (1.0 + 1e-9), "{ramp:?} {goal:?}: {found:?}");
        }
        assert!(found.acceleration.max(found.deceleration) <= most[1] * (1.0 + 1e-9), "{found:?}");
        let [least, greatest] = found.positions;
        let ends = [slave.position.min(10.0), slave.position.max(10.0)];
        assert!((least - ends[0]).abs() < 1e-9 && (greatest - ends[1]).abs() < 1e-9, "{found:?}");
        if let RampGoal::Gentlest { within_s, least } = goal {
            assert!(duration_s <= within_s, "{found:?}");
            // The jerk of the axis is the least one that is enough.
            let own = ramp == Trapezoid || least != Quantity::Jerk;
            assert!(own || (found.ramp_jerk / expected[3] - 1.0).abs() < 1e-5, "{found:?}");
        }
    }
    // Half a metre at 1 mm/s is not a sensible ramp, and a longer one may be wished.
    let slow = wish(&dwell(), moving(5.0, 3.0), moving(0.0, 0.0), limits([1e-3, 10.0, 1e3]));
    let slow = RampWish { ramp: Sigmoid, ..slow };
    let error = ramp_in(&slow).expect_err("hours");
    assert!(matches!(error, RampError::TooLong { soonest_s, .. } if soonest_s > 9999.0), "{error}");
    let goal = gentlest(11_000.0, Quantity::Acceleration);
    ramp_in(&RampWish { goal, ..slow }).expect("a ramp");
}

/// From 9 at −4 u/s onto a dwell at 10 with d it turns at 9 − 16/(2·d): with a limit of 8 d has to be 8 u/s² or more; and no
/// deceleration keeps 8.99 with 50 u/s².
#[test]
fn positions_on_the_way_are_kept() {
    let wish = wish(&dwell(), moving(5.0, 3.0), moving(9.0, -4.0), limits([100.0, 50.0, FREE]));
    let within = |low: f64, goal| RampWish { position: [low, 20.0], goal, ..wish.clone() };
    let gentle = gentlest(5.0, Quantity::Acceleration);
    let found = ramp_in(&within(8.0, gentle)).expect("a ramp");
    assert!(found.positions[0] >= 8.0 - 1e-9, "{found:?}");
    assert!(found.deceleration >= 8.0 - 1e-6 || found.acceleration >= 8.0 - 1e-6, "{found:?}");
    let free = ramp_in(&within(0.0, gentle)).expect("a ramp");
    assert!(free.positions[0] < 8.0, "{free:?}");
    let error = ramp_in(&within(8.99, RampGoal::Soonest)).expect_err("no room");
    assert!(matches!(error, RampError::Beyond { what: "position", .. }), "{error}");
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
    // A cam that always goes at half of the master's velocity.
    let rises = |master: f64, slave: f64| Knot { velocity: 0.5, ..Knot::at_rest(master, slave) };
    let rising = [rises(0.0, 0.0), rises(360.0, 180.0)];
    let error = refused(&rising, [49.0, 1e6, FREE], Trapezoid, soonest);
    let RampError::NoRoom { what: "velocity", peak, limit: 49.0 } = error else {
        panic!("{error}")
    };
    assert!((peak - 50.0).abs() < 1e-9, "{error}");
    // A cam whose own jerk is more: nothing helps.
    let error = refused(&lift(), [1e4, 1e6, 10.0], Trapezoid, soonest);
    assert!(matches!(error, RampError::Beyond { what: "jerk", .. }), "{error}");
    let soon = gentlest(0.01, Quantity::Acceleration);
    let error = refused(&lift(), [500.0, 1e4, FREE], Trapezoid, soon);
    assert!(matches!(error, RampError::TooLate { soonest_s, .. } if soonest_s > 0.01), "{error}");
    let outside = wish(&lift(), moving(400.0, 1.0), moving(0.0, 0.0), limits([1.0, 1.0, FREE]));
    assert!(matches!(ramp_in(&outside), Err(RampError::Coupling(_))));
    // In the middle of the lift the cam asks for 1.875 · 100/180 u/s per u/s of the master, but a ramp that comes late onto it,
    // where it is slow, keeps half of that.
    let late = wish(&lift(), moving(90.0, 100.0), moving(0.0, 0.0), limits([50.0, 1e6, FREE]));
    let found = ramp_in(&late).expect("a ramp");
    let Driven { seconds, peaks: [velocity, ..], .. } = driven(&late, &found, 1e-4);
    assert!((seconds - found.duration_s).abs() <= 1.1e-4 && velocity <= 50.0 * (1.0 + 1e-9));
}

/// The cam comes towards the slave with 50 u/s, which may go 100: 100 u lie between them, and with a `VelocityDiff` of 150 they are
/// gone after 2/3 s. A ramp in a given time has 100 at most, and takes a second.
#[test]
fn a_gentle_ramp_has_no_velocity_beyond_the_axis() {
    let falls = |master: f64, slave: f64| Knot { velocity: -0.5, ..Knot::at_rest(master, slave) };
    let falling = [falls(0.0, 100.0), falls(400.0, -100.0)];
    let most = limits([100.0, 1e6, FREE]);
    let towards = wish(&falling, moving(0.0, 100.0), moving(0.0, 0.0), most);
    let soonest = ramp_in(&towards).expect("a ramp");
    assert!((soonest.duration_s - 2.0 / 3.0).abs() < 1e-3, "{soonest:?}");
    let within = |within_s| {
        ramp_in(&RampWish { goal: gentlest(within_s, Quantity::Acceleration), ..towards.clone() })
    };
    assert!(within(1.1).expect("a ramp").velocity_difference <= 100.0);
    let error = within(0.6).expect_err("later");
    let said = error.to_string();
    assert!(matches!(error, RampError::TooLate { within_s: 0.6, .. }), "{said}");
    assert!(said.ends_with("at the earliest, not within 0.6 s"), "{said}");
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

/// What is reported of a ramp is what it does, cycle by cycle; the limits hold, and no others, near or far, are better by driving
/// them: the soonest, and the one with the least jerk.
#[test]
fn ramps_are_what_they_do_and_none_is_better() {
    for (seed, ramp) in cases(0..40, 4).flat_map(|seed| KINDS.map(|ramp| (seed, ramp))) {
        let mut wish = onto_lift(seed, ramp);
        let mut random = Random(seed + 9000);
        let soonest = ramp_in(&wish).unwrap_or_else(|error| panic!("{seed}: {error}"));
        let within_s = soonest.duration_s * random.between(1.2, 3.0);
        let gentle = ramp != Trapezoid && seed % 3 == 0;
        let mut found = soonest;
        if gentle {
            wish.goal = gentlest(within_s, Quantity::Jerk);
            found = ramp_in(&wish).unwrap_or_else(|error| panic!("{seed}: {error}"));
            assert!(found.duration_s <= within_s && found.peak_jerk <= soonest.peak_jerk, "{seed}");
        }
        let cycle_s = 1e-4;
        let Driven { seconds, peaks, reached } = driven(&wish, &found, cycle_s);
        let case = format!("{seed} {ramp:?}: {seconds} {peaks:?} {reached:?} {found:?}");
        assert!((seconds - found.duration_s).abs() <= 1.1 * cycle_s, "{case}");
        // Samples do not exceed what is exact, and come near it; the jerk of steps is one of the time of a cycle.
        let counts = if ramp == Trapezoid { 2 } else { 3 };
        let reported = [found.peak_velocity, found.peak_acceleration, found.peak_jerk];
        for (peak, reported) in peaks.into_iter().zip(reported).take(counts) {
            assert!(peak <= reported * (1.0 + 1e-6) && peak >= 0.95 * reported, "{case}");
        }
        let [least, greatest] = found.positions;
        assert!(least <= reached[0] + 1e-6 && greatest >= reached[1] - 1e-6, "{case}");
        assert!(reached[0] - least < 0.05 && greatest - reached[1] < 0.05, "{case}");
        let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
        for (reported, limit) in reported.into_iter().zip([velocity, acceleration, jerk]) {
            assert!(reported <= limit * (1.0 + 1e-9), "{case}");
        }
        for _ in 0..100 {
            let far = random.between(0.0, 1.0) < 0.5;
            let ends = if far { [-2.0, 1.5] } else { [-0.1, 0.1] };
            let mut other = |value: f64| value * random.between(ends[0], ends[1]).exp();
            let other = RampIn {
                velocity_difference: other(found.velocity_difference),
                acceleration: other(found.acceleration),
                deceleration: other(found.deceleration),
                ramp_jerk: other(found.ramp_jerk).min(jerk),
                ..found
            };
            let Driven { seconds, peaks, .. } =
                driven(&wish, &other, if gentle { cycle_s } else { 1e-3 });
            let kept = peaks[0] < 399.0
                && peaks[1] < 3990.0
                && (ramp == Trapezoid || peaks[2] < 0.99 * jerk);
            let better = if gentle {
                seconds < within_s - cycle_s && peaks[2] < found.peak_jerk * 0.97
            } else {
                seconds < found.duration_s * 0.98 - 1e-3
            };
            assert!(!(kept && better), "{case}, but {seconds} {peaks:?} of {other:?}");
        }
    }
}

/// The limit of the jerk is one of ramp and cam together: where the cam takes more than half of it the ramp has the rest, by
/// driving it. With all of it both together would be beyond.
#[test]
fn ramp_and_cam_keep_the_jerk_together() {
    let mut beyond = 0;
    for (seed, ramp) in cases(0..8, 1).flat_map(|seed| [(seed, Parabolic), (seed, Sigmoid)]) {
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
    assert!(beyond >= if long() { 8 } else { 1 }, "{beyond}");
}

/// What a search found that knows nothing of this one, with the limits of velocity and acceleration and the time that it had. A job
/// with these values was on its cam after the given time, as far as its samples show a ramp that comes onto it slower and slower.
#[test]
fn no_ramp_is_worse_than_one_that_is_known() {
    for (start, most, within_s, by) in [
        ([330.0, 160.0, 74.0, 0.0], [165.0, 4000.0], 0.544, Some([162.76, 1094.01, 2825.94])),
        ([68.0, 160.0, 7.0, 0.0], [285.0, 2600.0], 0.341, Some([115.65, 698.74, 1412.57])),
        ([32.0, 180.0, 35.0, 0.0], [265.0, 3000.0], 0.263, Some([311.52, 2993.99, 1498.2])),
        ([355.0, 150.0, 72.0, 0.0], [270.0, 1750.0], 0.539, Some([261.18, 1746.23, 710.35])),
        ([30.0, 160.0, 45.0, 0.0], [390.0, 2300.0], 0.344, Some([2480.57, 2295.27, 1112.98])),
        ([100.0, 100.0, 35.0, 0.0], [300.0, 1027.0], 0.5, Some([103.29, 1466.9, 1027.0])),
        ([100.0, 100.0, 35.0, 50.0], [300.0, 799.0], 0.5, None),
        ([30.0, 200.0, 20.0, 0.0], [300.0, 1420.0], 0.6, None),
        ([60.0, 100.0, 35.0, 0.0], [300.0, 742.6], 0.4, None),
    ] {
        let [master, turns, slave, moves] = start;
        let (master, slave) = (moving(master, turns), moving(slave, moves));
        // The last ones are the least peaks of the acceleration in their time.
        let soonest = most[1] > 1500.0;
        let within = limits([most[0], if soonest { most[1] } else { 2e4 }, FREE]);
        let goal =
            if soonest { RampGoal::Soonest } else { gentlest(within_s, Quantity::Acceleration) };
        let wish = RampWish { goal, ..wish(&pick_and_place(), master, slave, within) };
        let problem = Problem::new(&wish).expect("a start");
        let mut known = if soonest { within_s } else { most[1] };
        if let Some([v, up, down]) = by {
            let other = problem.ramp([v, up, down, FREE]).expect("a ramp");
            assert!(problem.keeps(&other), "{start:?}: {other:?}");
            assert!(soonest || other.duration_s <= within_s, "{start:?}: {other:?}");
            let said = score(wish.goal, &other);
            assert!(!soonest || (said - known).abs() < 3e-3, "{start:?}: {other:?}");
            known = if soonest { said } else { known.max(said) };
        }
        let found = ramp_in(&wish).unwrap_or_else(|error| panic!("{start:?}: {error}"));
        assert!(problem.keeps(&found), "{start:?}: {found:?}");
        assert!(score(wish.goal, &found) <= known * 1.0002, "{start:?}: {known} {found:?}");
    }
}

/// A start onto one of both cams that random numbers make: some with positions that hold the slave, and some trapezoid ones with a
/// limit of the jerk of their steps.
fn start(seed: u64, ramp: RampType) -> RampWish {
    let mut random = Random(seed + 4100);
    let sign = if seed.is_multiple_of(4) { -1.0 } else { 1.0 };
    let master = moving(random.between(0.0, 360.0), sign * random.between(40.0, 220.0));
    let moves = if seed.is_multiple_of(3) { random.between(-40.0, 40.0) } else { 0.0 };
    let slave = moving(random.between(0.0, 80.0), moves);
    let [velocity, acceleration] = [random.between(200.0, 500.0), random.between(2000.0, 6000.0)];
    let jerk = match (ramp, seed % 5) {
        (Trapezoid, 2) => 1000.0 * acceleration,
        (Trapezoid, _) => FREE,
        _ => acceleration * random.between(10.0, 60.0),
    };
    let knots: &[Knot] = if seed.is_multiple_of(2) { &pick_and_place() } else { &lift() };
    let mut wish = wish(knots, master, slave, limits([velocity, acceleration, jerk]));
    if seed % 7 == 3 {
        wish.position = [-1.0, 90.0];
    }
    RampWish { ramp, ..wish }
}

/// The best of `count` values, half of them anywhere, half of them nearer and nearer to the best.
fn witness(wish: &RampWish, count: u32, seed: u64) -> Option<RampIn> {
    let problem = Problem::new(wish).expect("a start");
    let mut random = Random(seed);
    let mut best: Option<RampIn> = None;
    let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
    let most = if wish.goal == RampGoal::Soonest { FREE } else { velocity };
    for index in 0..count {
        let values = if let Some(best) = best.filter(|_| index > count / 2) {
            let left = 1.0 - f64::from(index) / f64::from(count);
            [best.velocity_difference, best.acceleration, best.deceleration, best.ramp_jerk]
                .map(|value| value * (random.normal() * (0.002 + left * left)).exp())
        } else {
            let mut two = |of: f64, low, high| of * random.between(low, high).exp2();
            let [up, down] = [(); 2].map(|()| two(acceleration, -8.0, 1.0));
            [
                two(velocity, -5.0, 2.0),
                up,
                down,
                if jerk < FREE { two(jerk, -8.0, 0.0) } else { jerk },
            ]
        };
        let [velocity, up, down, own] = values;
        let Ok(found) = problem.ramp([velocity.min(most), up, down, own.min(jerk)]) else {
            continue;
        };
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
        let goals = Quantity::ALL.map(|least| gentlest(more * soonest.duration_s, least));
        wishes.extend(goals.map(|goal| RampWish { goal, ..wish.clone() }));
    }
    wishes
}

/// Of trapezoid ramps, and of some parabolic ones, nothing of 20,000 that are tried is sooner, or gentler in the same time, by more
/// than two thousandths.
#[test]
fn no_ramp_of_many_is_better() {
    let mut worse = Vec::new();
    let mut compare = |wish: &RampWish, seed: u64| {
        let Some(other) = witness(wish, 20_000, 77) else { return };
        match ramp_in(wish) {
            Ok(found) if score(wish.goal, &found) > score(wish.goal, &other) * 1.002 => {
                worse.push(format!("{seed} {:?}: {found:?}, but {other:?}", wish.goal));
            }
            Ok(_) => {}
            Err(error) => worse.push(format!("{seed} {:?}: {error}, but {other:?}", wish.goal)),
        }
    };
    for seed in cases(0..40, 4) {
        compare(&start(seed, Trapezoid), seed);
    }
    let trapezoids = cases(0..24, 4).map(|seed| (seed, Trapezoid));
    for (seed, ramp) in trapezoids.chain(cases(12..18, 1).map(|seed| (seed, Parabolic))) {
        let wish = start(seed, ramp);
        let Ok(soonest) = ramp_in(&wish) else { continue };
        let more = 1.2 + 0.2 * f64::from(u32::try_from(seed % 5).expect("small"));
        let goal = gentlest(more * soonest.duration_s, Quantity::Acceleration);
        compare(&RampWish { goal, ..wish }, seed);
    }
    assert!(worse.is_empty(), "{}: {worse:#?}", worse.len());
}

/// Nothing that the witness finds is better than by one percent.
#[test]
fn no_ramp_that_is_tried_is_better() {
    let (mut worse, mut compared) = (Vec::new(), 0);
    let starts = [(Trapezoid, 24, 4), (Parabolic, 12, 2), (Sigmoid, 8, 1)];
    let starts = starts
        .into_iter()
        .flat_map(|(ramp, seeds, usual)| cases(0..seeds, usual).map(move |seed| (seed, ramp)));
    for wish in starts.flat_map(|(seed, ramp)| wishes(seed, ramp)) {
        let Some(other) = witness(&wish, if long() { 20_000 } else { 5000 }, 77) else { continue };
        compared += 1;
        match ramp_in(&wish) {
            Ok(found) => {
                assert!(Problem::new(&wish).expect("a start").keeps(&found), "{found:?}");
                let [now, best] = [found, other].map(|ramp| score(wish.goal, &ramp));
                if now > best * 1.01 {
                    worse
                        .push(format!("{:?} {:?}: {found:?}, but {other:?}", wish.ramp, wish.goal));
                }
            }
            Err(error) => worse.push(format!("{:?}: {error}, but {other:?}", wish.goal)),
        }
    }
    assert!(worse.is_empty(), "{} of {compared}: {worse:#?}", worse.len());
    assert!(compared >= if long() { 100 } else { 14 }, "{compared}");
}

/// Who has more time is never harder, and a limit that a ramp does not come near does not change it, if it is ten times as large.
#[test]
fn more_time_and_limits_that_hold_nothing_make_nothing_harder() {
    let (mut changed, harder) = (0, 1.005);
    let starts = KINDS.into_iter().flat_map(|ramp| cases(0..4, 1).map(move |seed| (seed, ramp)));
    for wish in starts.flat_map(|(seed, ramp)| wishes(seed, ramp)) {
        let Ok(found) = ramp_in(&wish) else { continue };
        let before = score(wish.goal, &found);
        if let RampGoal::Gentlest { within_s, least } = wish.goal {
            let mut before = before;
            for more in if long() { vec![1.3, 2.0, 4.0, 8.0] } else { vec![3.0] } {
                let goal = gentlest(more * within_s, least);
                let other = ramp_in(&RampWish { goal, ..wish.clone() }).expect("a ramp");
                let now = score(goal, &other);
                assert!(now <= before * harder, "{:?} {goal:?}: {found:?} {other:?}", wish.ramp);
                before = before.min(now);
            }
        }
        let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
        let far =
            |reached: f64, limit: f64| if reached < 0.99 * limit { 10.0 * limit } else { limit };
        let limits = limits([
            far(found.peak_velocity.max(found.velocity_difference), velocity),
            far(found.peak_acceleration, acceleration),
            far(found.peak_jerk.max(found.ramp_jerk), jerk),
        ]);
        if limits != wish.limits {
            changed += 1;
            let other = ramp_in(&RampWish { limits, ..wish.clone() }).expect("a ramp");
            let now = score(wish.goal, &other);
            assert!(now <= before * harder, "{:?}: {found:?} {other:?}", wish.goal);
            // Where it is better, it uses what it was given.
            let kept = Problem::new(&wish).expect("a start").keeps(&other);
            assert!(!kept || now * harder >= before, "{:?}: {found:?} {other:?}", wish.goal);
        }
    }
    assert!(changed >= if long() { 15 } else { 4 }, "{changed}");
}
