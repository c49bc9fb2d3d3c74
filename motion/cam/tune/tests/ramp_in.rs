//! Ramps: as soon as can be where that is known in closed form, and held against the coupling itself.

use super::Random;
use crate::cam::tune::{RampError, RampGoal, RampIn, RampWish, ramp_in};
use crate::cam::{
    AxisState, Cam, CamCoupling, CamInput, CamTable, Knot, Shape, SlaveLimits, StartMode,
};
use std::sync::Arc;

fn limits(velocity: f64, acceleration: f64) -> SlaveLimits {
    SlaveLimits { velocity, acceleration, ..SlaveLimits::NONE }
}

fn moving(position: f64, velocity: f64) -> AxisState {
    AxisState { position, velocity, acceleration: 0.0 }
}

fn wish(knots: &[Knot], master: AxisState, slave: AxisState, limits: SlaveLimits) -> RampWish {
    let shape = Shape::Polynomial(knots.to_vec());
    let cam = Arc::new(Cam::new("cam", shape, Vec::new()).expect("a cam"));
    RampWish {
        table: CamTable::new(cam),
        input: CamInput { start_mode: StartMode::RampIn, ..CamInput::default() },
        master,
        slave,
        limits,
        goal: RampGoal::Soonest,
    }
}

/// A dwell at 10.
fn dwell() -> [Knot; 2] {
    [Knot::at_rest(0.0, 10.0), Knot::at_rest(360.0, 10.0)]
}

/// A lift and its return.
fn lift() -> [Knot; 3] {
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
        let goal = RampGoal::Gentlest { within_s };
        let slave = moving(0.0, 0.0);
        let wish = wish(&dwell(), moving(5.0, 3.0), slave, limits(velocity, 1000.0));
        let found = ramp_in(&RampWish { goal, ..wish }).expect("a ramp");
        assert!((found.peak_acceleration / expected - 1.0).abs() < 1e-5, "{found:?}");
        assert!(found.duration_s <= within_s);
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
    // In the middle of the lift the cam asks for 1.875 · 100/180 u/s per u/s of the master.
    let error = refused(&lift(), limits(50.0, 1e6), soonest);
    assert!(matches!(error, RampError::NoRoom { what: "velocity", .. }), "{error}");
    let error = refused(&lift(), limits(500.0, 1e4), RampGoal::Gentlest { within_s: 0.01 });
    let RampError::TooLate { soonest_s, .. } = error else { panic!("{error}") };
    assert!(soonest_s > 0.01);
    let outside = wish(&lift(), moving(400.0, 1.0), rest, limits(1.0, 1.0));
    assert!(matches!(ramp_in(&outside), Err(RampError::Coupling(_))));
}

/// What the coupling does with a ramp, cycle by cycle: when it is over, largest velocity and acceleration.
fn driven(wish: &RampWish, ramp: &RampIn, cycle_ns: i64) -> [f64; 3] {
    let input = CamInput {
        velocity_difference: ramp.velocity_difference,
        acceleration: ramp.acceleration,
        deceleration: ramp.deceleration,
        ..wish.input
    };
    let (master, slave) = (&wish.master, &wish.slave);
    let mut coupling =
        CamCoupling::start(wish.table.clone(), input, master, slave, 0).expect("a start");
    let mut peaks = [0.0_f64; 2];
    for cycle in 0.. {
        let now_ns = cycle * cycle_ns;
        #[expect(clippy::cast_precision_loss, reason = "seconds")]
        let seconds = now_ns as f64 * 1e-9;
        let at = moving(master.position + master.velocity * seconds, master.velocity);
        let coupled = coupling.step(&at, now_ns).expect("a master");
        if coupled.in_sync {
            return [seconds, peaks[0], peaks[1]];
        }
        peaks[0] = peaks[0].max(coupled.slave.velocity.abs());
        peaks[1] = peaks[1].max(coupled.slave.acceleration.abs());
        assert!(cycle < 10_000_000, "it never ends");
    }
    unreachable!("a ramp ends")
}

/// On moving cams, forwards and backwards, from rest and in motion: what is told is what the coupling does, the limits
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
