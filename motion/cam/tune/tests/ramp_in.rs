//! Ramps: as soon as can be where that is known in closed form, and compared with the coupling itself.

use super::Random;
use crate::tune::{RampError, RampGoal, RampIn, RampWish, ramp_in};
use crate::{Cam, CamCoupling, CamInput, CamTable, Knot, Quantity, Shape, SlaveLimits, StartMode};
use std::sync::Arc;
use twin_profile::{RampType, State};

pub(super) fn limits(velocity: f64, acceleration: f64) -> SlaveLimits {
    SlaveLimits { velocity, acceleration, ..SlaveLimits::NONE }
}

pub(super) fn moving(position: f64, velocity: f64) -> State {
    State { position, velocity, acceleration: 0.0 }
}

pub(super) fn wish(knots: &[Knot], master: State, slave: State, limits: SlaveLimits) -> RampWish {
    let shape = Shape::Polynomial(knots.to_vec());
    let cam = Arc::new(Cam::new("cam", shape, Vec::new()).expect("a cam"));
    RampWish {
        table: CamTable::new(cam),
        input: CamInput { start_mode: StartMode::RampIn, ..CamInput::default() },
        master,
        slave,
        ramp: RampType::Trapezoid,
        limits,
        position: [f64::NEG_INFINITY, f64::INFINITY],
        cycle_s: 1e-3,
        goal: RampGoal::Soonest,
    }
}

/// A dwell at 10.
pub(super) fn dwell() -> [Knot; 2] {
    [Knot::at_rest(0.0, 10.0), Knot::at_rest(360.0, 10.0)]
}

/// A lift and its return.
pub(super) fn lift() -> [Knot; 3] {
    [Knot::at_rest(0.0, 0.0), Knot::at_rest(180.0, 100.0), Knot::at_rest(360.0, 0.0)]
}

/// Onto a cam that rests: 10 u at 2 u/s and 1 u/s² take 10/2 + 2/1 s; 1 u takes two parabolas, 2·√(1/1) s.
#[test]
fn a_dwell_is_reached_as_a_trapezoid_and_a_triangle_are() {
    for (slave, expected) in [(0.0, 7.0), (9.0, 2.0), (20.0, 7.0)] {
        let wish = wish(&dwell(), moving(5.0, 3.0), moving(slave, 0.0), limits(2.0, 1.0));
        let found = ramp_in(&wish).expect("a ramp");
        assert!((found.duration_s - expected).abs() < 1e-6, "{slave}: {found:?}");
        assert!(found.peak_velocity <= 2.0 && found.peak_acceleration <= 1.0 + 1e-12);
    }
}

/// In T seconds over d from rest to rest no motion has a smaller peak of the acceleration than 4·d/T²; with the velocity
/// limited to w it is w²/(w·T − d).
#[test]
fn the_gentlest_ramp_onto_a_dwell_is_known() {
    for (velocity, within_s, expected) in [(100.0, 4.0, 4.0 * 10.0 / 16.0), (3.0, 4.0, 9.0 / 2.0)] {
        let goal = RampGoal::Gentlest { within_s, least: Quantity::Acceleration };
        let slave = moving(0.0, 0.0);
        let wish = wish(&dwell(), moving(5.0, 3.0), slave, limits(velocity, 1000.0));
        let found = ramp_in(&RampWish { goal, ..wish }).expect("a ramp");
        assert!((found.peak_acceleration / expected - 1.0).abs() < 1e-5, "{found:?}");
        assert!(found.duration_s <= within_s);
    }
}

/// Onto a dwell 1 u away with steps of the acceleration of a = J·T at most, a cycle T apart at least: up for v/a, T at v, and
/// down; v²/a + v·T = 1, which takes 2·v/a + T = √(T² + 4/a). Without the T between them up and down were one step of 2·a.
#[test]
fn the_jerk_of_a_ramp_is_its_steps() {
    let limits = SlaveLimits { velocity: 100.0, acceleration: 50.0, jerk: 4000.0 };
    let wish = wish(&dwell(), moving(5.0, 3.0), moving(9.0, 0.0), limits);
    for cycle_s in [1e-3, 1e-2] {
        let found = ramp_in(&RampWish { cycle_s, ..wish.clone() }).expect("a ramp");
        assert!(found.peak_jerk <= 4000.0 * (1.0 + 1e-9), "{found:?}");
        assert!(found.peak_jerk >= 4000.0 * (1.0 - 1e-3), "{found:?}");
        let expected = (cycle_s * cycle_s + 4.0 / (4000.0 * cycle_s)).sqrt();
        assert!((found.duration_s / expected - 1.0).abs() < 1e-3, "{found:?} {expected}");
    }
    // A cam whose own jerk is more: nothing helps.
    let limits = SlaveLimits { velocity: 1e4, acceleration: 1e6, jerk: 10.0 };
    let wish = RampWish { limits, ..wish_on_lift(moving(90.0, 300.0), moving(0.0, 0.0)) };
    let error = ramp_in(&wish).expect_err("jerk");
    assert!(matches!(error, RampError::Beyond { what: "jerk", .. }), "{error}");
}

fn wish_on_lift(master: State, slave: State) -> RampWish {
    wish(&lift(), master, slave, limits(1e4, 1e6))
}

/// From 9 at −4 u/s onto a dwell at 10 with d it turns at 9 − 16/(2·d): with a limit of 8 d has to be 8 u/s² or more; and no
/// deceleration keeps 8.99 with 50 u/s².
#[test]
fn positions_on_the_way_are_kept() {
    let limits = SlaveLimits { velocity: 100.0, acceleration: 50.0, ..SlaveLimits::NONE };
    let wish = wish(&dwell(), moving(5.0, 3.0), moving(9.0, -4.0), limits);
    let within = |low: f64| RampWish { position: [low, 20.0], ..wish.clone() };
    let gentle = RampWish {
        goal: RampGoal::Gentlest { within_s: 5.0, least: Quantity::Acceleration },
        ..within(8.0)
    };
    let found = ramp_in(&gentle).expect("a ramp");
    assert!(found.positions[0] >= 8.0 - 1e-9, "{found:?}");
    assert!(found.deceleration >= 8.0 - 1e-6 || found.acceleration >= 8.0 - 1e-6, "{found:?}");
    let free = ramp_in(&RampWish { position: [0.0, 20.0], ..gentle }).expect("a ramp");
    assert!(free.positions[0] < 8.0, "{free:?}");
    let error = ramp_in(&within(8.99)).expect_err("no room");
    assert!(matches!(error, RampError::Beyond { what: "position", .. }), "{error}");
    // The positions are those of the coupling: on a moving cam, by driving it.
    for seed in 0..20 {
        let mut random = Random(seed);
        let sign = if seed % 2 == 0 { -1.0 } else { 1.0 };
        let master = moving(random.between(0.0, 360.0), sign * random.between(20.0, 300.0));
        let slave = moving(random.between(-50.0, 150.0), random.between(-20.0, 20.0));
        let wish = wish_on_lift(master, slave);
        let values = [random.between(50.0, 300.0), random.between(300.0, 3000.0)];
        let limits = SlaveLimits {
            velocity: values[0] + 400.0,
            acceleration: values[1] + 4000.0,
            ..SlaveLimits::NONE
        };
        let wish = RampWish { limits, ..wish };
        let found = ramp_in(&wish).expect("a ramp");
        let [mut low, mut high] = [slave.position; 2];
        drive(&wish, &found, 100_000, &mut |slave| {
            (low, high) = (low.min(slave.position), high.max(slave.position));
        });
        let [least, greatest] = found.positions;
        assert!(least <= low + 1e-6 && greatest >= high - 1e-6, "{seed}: {low} {high} {found:?}");
        assert!(
            (least - low).abs() < 0.05 && (greatest - high).abs() < 0.05,
            "{seed}: {low} {high} {found:?}"
        );
    }
}

#[test]
fn what_leaves_no_ramp_is_refused() {
    let rest = moving(0.0, 0.0);
    let refused = |knots: &[Knot], limits, goal| {
        ramp_in(&RampWish { goal, ..wish(knots, moving(90.0, 100.0), rest, limits) })
            .expect_err("no ramp")
    };
    let soonest = RampGoal::Soonest;
    let none = refused(&lift(), SlaveLimits::NONE, soonest);
    assert_eq!(none, RampError::NoLimit { what: "velocity", value: f64::INFINITY });
    // A cam that always goes at half of the master's velocity.
    let rises = |master: f64, slave: f64| Knot { velocity: 0.5, ..Knot::at_rest(master, slave) };
    let error = refused(&[rises(0.0, 0.0), rises(360.0, 180.0)], limits(49.0, 1e6), soonest);
    let RampError::NoRoom { what: "velocity", peak, limit: 49.0 } = error else {
        panic!("{error}")
    };
    assert!((peak - 50.0).abs() < 1e-9, "{error}");
    // In the middle of the lift the cam asks for 1.875 · 100/180 u/s per u/s of the master, but a ramp that comes late onto it,
    // where it is slow, keeps half of that.
    let late = wish(&lift(), moving(90.0, 100.0), rest, limits(50.0, 1e6));
    let found = ramp_in(&late).expect("a ramp");
    let [seconds, velocity, _] = driven(&late, &found, 100_000);
    assert!((seconds - found.duration_s).abs() <= 1.1e-4 && velocity <= 50.0 * (1.0 + 1e-9));
    let error = refused(
        &lift(),
        limits(500.0, 1e4),
        RampGoal::Gentlest { within_s: 0.01, least: Quantity::Acceleration },
    );
    let RampError::TooLate { soonest_s, held: None, .. } = error else { panic!("{error}") };
    assert!(soonest_s > 0.01);
    assert!(!error.to_string().contains("VelocityDiff"), "{error}");
    let outside = wish(&lift(), moving(400.0, 1.0), rest, limits(1.0, 1.0));
    assert!(matches!(ramp_in(&outside), Err(RampError::Coupling(_))));
}

/// The cam comes towards the slave with 50 u/s, which may go 100: 100 u lie between them, and with a `VelocityDiff` of 150 they are
/// gone after 2/3 s. A ramp in a given time has 100 at most, takes a second, and says so.
#[test]
fn a_ramp_in_a_given_time_says_what_makes_it_late() {
    let falls = |master: f64, slave: f64| Knot { velocity: -0.5, ..Knot::at_rest(master, slave) };
    let falling = [falls(0.0, 100.0), falls(400.0, -100.0)];
    let wish = |goal| RampWish {
        goal,
        ..wish(&falling, moving(0.0, 100.0), moving(0.0, 0.0), limits(100.0, 1e6))
    };
    let soonest = ramp_in(&wish(RampGoal::Soonest)).expect("a ramp");
    assert!((soonest.duration_s - 2.0 / 3.0).abs() < 1e-3, "{soonest:?}");
    let within = |within_s| RampGoal::Gentlest { within_s, least: Quantity::Acceleration };
    let error = ramp_in(&wish(within(0.8))).expect_err("a second is needed");
    let RampError::TooLate { soonest_s, within_s: 0.8, held: Some(held) } = error else {
        panic!("{error}")
    };
    assert!((soonest_s - 1.0).abs() < 1e-3, "{error}");
    assert!((held.free_s - 2.0 / 3.0).abs() < 1e-3 && (held.velocity - 100.0).abs() < 1e-9);
    let said = error.to_string();
    assert!(said.contains("`VelocityDiff` of at most the axis's velocity, 100, "), "{said}");
    assert!(said.ends_with(", not within 0.8 s"), "{said}");
    ramp_in(&wish(within(1.1))).expect("a ramp");
}

/// Drives the coupling with a ramp, cycle by cycle, until the slave is on its cam: when that is, s.
fn drive(wish: &RampWish, ramp: &RampIn, cycle_ns: i64, visit: &mut dyn FnMut(State)) -> f64 {
    let input = CamInput {
        velocity_difference: ramp.velocity_difference,
        acceleration: ramp.acceleration,
        deceleration: ramp.deceleration,
        ..wish.input
    };
    let (master, slave) = (&wish.master, &wish.slave);
    let mut coupling =
        CamCoupling::start(wish.table.clone(), input, master, slave, 0).expect("a start");
    for cycle in 0..10_000_000 {
        let now_ns = cycle * cycle_ns;
        #[expect(clippy::cast_precision_loss, reason = "seconds")]
        let seconds = now_ns as f64 * 1e-9;
        let at = moving(master.position + master.velocity * seconds, master.velocity);
        let coupled = coupling.step(&at, now_ns).expect("a master");
        if coupled.in_sync {
            return seconds;
        }
        visit(coupled.slave);
    }
    panic!("it never ends")
}

/// When a ramp is over, and the largest velocity and acceleration.
fn driven(wish: &RampWish, ramp: &RampIn, cycle_ns: i64) -> [f64; 3] {
    let mut peaks = [0.0_f64; 2];
    let seconds = drive(wish, ramp, cycle_ns, &mut |slave| {
        peaks = [peaks[0].max(slave.velocity.abs()), peaks[1].max(slave.acceleration.abs())];
    });
    [seconds, peaks[0], peaks[1]]
}

/// On moving cams, forwards and backwards, from rest and in motion: the reported value is what the coupling does, the limits
/// hold, and no other values near or far are better.
#[test]
fn random_ramps_are_what_the_coupling_does_and_none_is_sooner() {
    for seed in 0..40 {
        let mut random = Random(seed);
        let sign = if seed % 3 == 0 { -1.0 } else { 1.0 };
        let master = moving(random.between(0.0, 360.0), sign * random.between(20.0, 300.0));
        let slave = moving(random.between(-50.0, 150.0), random.between(-20.0, 20.0));
        let wish = wish(&lift(), master, slave, limits(400.0, 4000.0));
        let found = ramp_in(&wish).unwrap_or_else(|error| panic!("{seed}: {error}"));
        let [seconds, velocity, acceleration] = driven(&wish, &found, 100_000);
        assert!((seconds - found.duration_s).abs() <= 1.1e-4, "{seed}: {seconds} {found:?}");
        assert!(found.peak_velocity <= 400.0 * (1.0 + 1e-9), "{seed}: {found:?}");
        assert!(found.peak_acceleration <= 4000.0 * (1.0 + 1e-9), "{seed}: {found:?}");
        // Samples do not exceed what is exact, and come near it.
        assert!(velocity <= found.peak_velocity * (1.0 + 1e-9), "{seed}: {velocity} {found:?}");
        assert!(acceleration <= found.peak_acceleration * (1.0 + 1e-9), "{seed}: {found:?}");
        assert!(velocity >= found.peak_velocity * 0.98, "{seed}: {velocity} {found:?}");
        assert!(acceleration >= found.peak_acceleration * 0.95, "{seed}: {found:?}");
        // A hundred others that keep the limits, by driving them.
        for _ in 0..100 {
            let other = RampIn {
                velocity_difference: random.between(10.0, 500.0),
                acceleration: random.between(100.0, 5000.0),
                deceleration: random.between(100.0, 5000.0),
                ..found
            };
            let [seconds, velocity, acceleration] = driven(&wish, &other, 1_000_000);
            if velocity < 399.0 && acceleration < 3990.0 {
                assert!(seconds > found.duration_s * 0.98 - 1e-3, "{seed}: {other:?} {found:?}");
            }
        }
    }
}

/// 10 u from rest to rest with 10 u/s² and 100 u/s³: the peak v has v²/10 + v/10 = 10, and the way takes 2·(v/10 + 0.1) s. No
/// motion is gentler in 4 s than one that is at its least acceleration for as long as the jerk allows.
#[test]
fn a_dwell_is_reached_within_the_jerk() {
    let limits = SlaveLimits { velocity: 100.0, acceleration: 10.0, jerk: 100.0 };
    let wish = wish(&dwell(), moving(5.0, 3.0), moving(0.0, 0.0), limits);
    let wish = RampWish { ramp: RampType::Parabolic, ..wish };
    let found = ramp_in(&wish).expect("a ramp");
    let v = (-0.1 + (0.01_f64 + 4.0).sqrt()) * 5.0;
    assert!((found.duration_s - 2.0 * (v / 10.0 + 0.1)).abs() < 1e-6, "{found:?}");
    assert!((found.peak_velocity - v).abs() < 1e-5, "{found:?} {v}");
    assert!((found.peak_jerk - 100.0).abs() < 1e-6 && found.peak_cam_jerk == 0.0, "{found:?}");
    // In T s over d, up, at once down again: with acceleration a, (T/2 − a/j)·a·T/2 = d.
    let gentle = ramp_in(&RampWish {
        goal: RampGoal::Gentlest { within_s: 4.0, least: Quantity::Acceleration },
        ..wish.clone()
    });
    let gentle = gentle.expect("a ramp");
    let a = 50.0 * (2.0 - (4.0 - 4.0 * 5.0 / 100.0_f64).sqrt());
    assert!((gentle.peak_acceleration - a).abs() < 1e-4 * a, "{gentle:?} {a}");

    let refused = |wish: &RampWish| ramp_in(wish).expect_err("no ramp");
    let endless = SlaveLimits { jerk: f64::INFINITY, ..limits };
    let none = refused(&RampWish { limits: endless, ..wish.clone() });
    assert_eq!(none, RampError::NoLimit { what: "jerk", value: f64::INFINITY });
    let sigmoid = RampWish { ramp: RampType::Sigmoid, limits: endless, ..wish };
    assert_eq!(refused(&sigmoid), none);
}
