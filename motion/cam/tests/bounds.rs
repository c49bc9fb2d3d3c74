//! Tests of extremes, bounds and the maximum master velocity, against sampling and closed forms.

use super::{curve, knots, samples};
use crate::{Curve, Factors, Knot, LimitError, MasterMotion, Quantity, SlaveLimits};
use proptest::prelude::*;

/// 0 to 180, 0 to 100, at rest at both ends.
fn rest_to_rest() -> Curve {
    curve(&[Knot::at_rest(0.0, 0.0), Knot::at_rest(180.0, 100.0)])
}

/// The polynomial 10·s³ − 15·s⁴ + 6·s⁵: s″ is greatest at (3 − √3)/6, s‴ at both ends is 60, at the middle −30.
#[test]
fn extremes_of_the_rest_to_rest_quintic() {
    let found = rest_to_rest().extremes();
    let peak = 100.0 / (180.0 * 180.0) * 10.0 / 3.0_f64.sqrt();
    assert!((found.velocity.max - 100.0 / 180.0 * 1.875).abs() < 1e-12);
    assert!((found.velocity.at_max - 90.0).abs() < 1e-6);
    assert!((found.acceleration.max - peak).abs() < 1e-14);
    assert!((found.acceleration.at_max - 180.0 * (3.0 - 3.0_f64.sqrt()) / 6.0).abs() < 1e-6);
    assert!((found.acceleration.min + peak).abs() < 1e-14);
    let jerk = 100.0 / 180.0_f64.powi(3);
    assert!((found.jerk.max - 60.0 * jerk).abs() < 1e-15);
    assert!(
        (found.jerk.min + 30.0 * jerk).abs() < 1e-15 && (found.jerk.at_min - 90.0).abs() < 1e-6
    );
}

/// With the master at v, a and j either way: y‴ is 60·h/w³ at both ends and −30·h/w³ in the middle, where y″ is 0 and y′
/// 15/8·h/w; the least jerk of the slave is not its greatest with the other sign.
#[test]
fn jerks_have_a_least_and_a_greatest() {
    let (h, w, v, j) = (100.0, 180.0_f64, 40.0_f64, 5000.0);
    let still = MasterMotion { velocity: v, acceleration: 0.0, jerk: 0.0 };
    let found = rest_to_rest().bounds(&still, Factors::default()).jerk;
    let unit = h / w.powi(3) * v.powi(3);
    assert!((found.max - 60.0 * unit).abs() < 1e-12 && (found.min + 30.0 * unit).abs() < 1e-12);
    assert!((found.at_min - 90.0).abs() < 1e-6);
    // Backwards, as far below as above before.
    let found = rest_to_rest().bounds(&still, Factors { master: -1.0, slave: 1.0 }).jerk;
    assert!((found.max - 30.0 * unit).abs() < 1e-12 && (found.min + 60.0 * unit).abs() < 1e-12);
    // The jerk of the master counts where the slave is fastest: so much that nothing else does.
    let jolted = MasterMotion { jerk: j, ..still };
    let found = rest_to_rest().bounds(&jolted, Factors::default()).jerk;
    let middle = -30.0 * unit - 15.0 / 8.0 * h / w * j;
    assert!((found.min / middle - 1.0).abs() < 1e-12 && (found.at_min - 90.0).abs() < 1e-6);
    assert!(found.max < -middle && found.max > 0.0);
}

/// What is left where a pass ends: y′ and y″ there, and nothing where the curve comes to rest.
#[test]
fn what_stops_where_a_pass_ends() {
    assert_eq!(rest_to_rest().stop_jumps(false), [None, None]);
    let end = Knot { master: 90.0, slave: 50.0, velocity: 1.5, acceleration: -0.25 };
    let cam = curve(&[Knot::at_rest(0.0, 0.0), end]);
    let [velocity, acceleration] = cam.stop_jumps(false).map(|jump| jump.expect("a jump"));
    assert!((velocity.by + 1.5).abs() < 1e-12 && (acceleration.by - 0.25).abs() < 1e-12);
    assert_eq!((velocity.master, acceleration.master), (90.0, 90.0));
    // Backwards it ends where it is at rest.
    assert_eq!(cam.stop_jumps(true), [None, None]);
}

#[test]
fn largest_velocities_in_closed_form() {
    let cam = rest_to_rest();
    let find = |limits: SlaveLimits, factors| {
        cam.largest_master_velocity(&limits, &MasterMotion::default(), factors, true)
            .expect("a velocity")
    };
    let one = Factors::default();
    let none = SlaveLimits::NONE;
    let velocity = find(SlaveLimits { velocity: 50.0, ..none }, one);
    assert!((velocity.value - 50.0 / (100.0 / 180.0 * 1.875)).abs() < 1e-10);
    assert_eq!(velocity.limited.map(|(quantity, _)| quantity), Some(Quantity::Velocity));
    let peak = 100.0 / (180.0 * 180.0) * 10.0 / 3.0_f64.sqrt();
    let acceleration = find(SlaveLimits { acceleration: 30.0, ..none }, one);
    assert!((acceleration.value - (30.0 / peak).sqrt()).abs() < 1e-10);
    let jerk = 60.0 * 100.0 / 180.0_f64.powi(3);
    // The seam: acceleration 0 on both sides, so the jerk may be bounded there, too.
    let found = find(SlaveLimits { jerk: 1000.0, ..none }, one);
    assert!((found.value - (1000.0 / jerk).cbrt()).abs() < 1e-10);
    // Twice the master and half the slave.
    let scaled =
        find(SlaveLimits { acceleration: 30.0, ..none }, Factors { master: -2.0, slave: 0.5 });
    assert!((scaled.value - (60.0 / peak).sqrt() / 2.0).abs() < 1e-10);
    // However little it is, it is not lost next to 1.
    for master in [1e15, -1e20] {
        let found = find(SlaveLimits { velocity: 1.0, ..none }, Factors { master, slave: 1.0 });
        let expected = 1.0 / (100.0 / 180.0 * 1.875) / master.abs();
        assert!((found.value / expected - 1.0).abs() < 1e-12, "{}", found.value);
        let (_, place) = found.limited.expect("a limit");
        assert!((place - 90.0).abs() < 1e-6, "{place}");
        let found = find(SlaveLimits { acceleration: 1.0, ..none }, Factors { master, slave: 1.0 });
        let expected = (1.0 / peak).sqrt() / master.abs();
        assert!((found.value / expected - 1.0).abs() < 1e-12, "{}", found.value);
    }
    let free = find(none, one);
    assert!(free.value.is_infinite() && free.limited.is_none());
}

#[test]
fn what_cannot_be_limited() {
    let find = |cam: &Curve, limits: SlaveLimits, master: MasterMotion, repeated| {
        cam.largest_master_velocity(&limits, &master, Factors::default(), repeated)
    };
    let none = SlaveLimits::NONE;
    let fast = MasterMotion { acceleration: 20.0, ..MasterMotion::default() };
    // y′ of 1.0417 times 20 is more than 15 already at rest.
    let limits = SlaveLimits { acceleration: 15.0, ..none };
    let Err(LimitError::TooMuch { quantity, peak, limit }) =
        find(&rest_to_rest(), limits, fast, false)
    else {
        panic!("too fast")
    };
    assert_eq!((quantity, limit), (Quantity::Acceleration, 15.0));
    assert!((peak.value - 1.875 * 100.0 / 180.0 * 20.0).abs() < 1e-9);
    assert!((peak.master - 90.0).abs() < 1e-6);
    // A saw tooth: the velocity of its seam jumps.
    let tooth =
        curve(&[Knot::at_rest(0.0, 0.0), Knot { velocity: 1.0, ..Knot::at_rest(90.0, 50.0) }]);
    let limits = SlaveLimits { acceleration: 1.0, ..none };
    assert!(find(&tooth, limits, MasterMotion::default(), false).is_ok());
    let Err(LimitError::Unbounded { quantity, jump }) =
        find(&tooth, limits, MasterMotion::default(), true)
    else {
        panic!("jumps")
    };
    assert_eq!((quantity, jump.master), (Quantity::Acceleration, 90.0));
    assert!((jump.by + 1.0).abs() < 1e-12);
    let negative = SlaveLimits { jerk: -1.0, ..none };
    let refused = find(&tooth, negative, MasterMotion::default(), false);
    assert_eq!(refused, Err(LimitError::NoMagnitude { name: "the limit of jerk", value: -1.0 }));
}

/// A straight cam has no acceleration but that of its master, whatever the rounding of its coefficients.
#[test]
fn a_line_is_as_fast_as_its_limit() {
    let line = |master: f64| Knot { velocity: 0.3, ..Knot::at_rest(master, master * 0.3) };
    let cam = curve(&[line(0.1), line(33.3), line(90.0)]);
    let limits = SlaveLimits { velocity: 6.0, acceleration: 1.0, jerk: f64::INFINITY };
    let found =
        cam.largest_master_velocity(&limits, &MasterMotion::default(), Factors::default(), false);
    assert!((found.expect("a velocity").value - 20.0).abs() < 1e-9);
    let found = cam
        .largest_master_acceleration(&limits, &MasterMotion::default(), Factors::default(), false)
        .expect("an acceleration");
    assert!((found.value - 1.0 / 0.3).abs() < 1e-9);
}

fn motion() -> impl Strategy<Value = MasterMotion> {
    (0.01..20.0_f64, prop_oneof![Just(0.0), 0.0..50.0_f64], prop_oneof![Just(0.0), 0.0..50.0_f64])
        .prop_map(|(velocity, acceleration, jerk)| MasterMotion { velocity, acceleration, jerk })
}

fn factors() -> impl Strategy<Value = Factors> {
    (prop_oneof![Just(1.0), -3.0..-0.1_f64, 0.1..3.0_f64], prop_oneof![Just(1.0), -3.0..3.0_f64])
        .prop_map(|(master, slave)| Factors { master, slave })
}

proptest! {
    /// No sample lies beyond the bounds, and samples come as near to them as their distance allows.
    #[test]
    fn bounds_are_exact(knots in knots(), master in motion(), factors in factors()) {
        let cam = curve(&knots);
        let found = cam.bounds(&master, factors);
        let mut sampled = [(f64::INFINITY, f64::NEG_INFINITY); 4];
        for x in samples(&cam, 200) {
            let d = cam.at(x);
            let v = master.velocity * factors.master;
            let a = master.acceleration * factors.master;
            let jolt = (3.0 * d.acceleration * v * a).abs() + (d.velocity * master.jerk * factors.master).abs();
            let values = [
                (d.position, d.position),
                (d.velocity * v, d.velocity * v),
                (d.acceleration * v * v + d.velocity * a, d.acceleration * v * v - d.velocity * a),
                (d.jerk * v * v * v + jolt, d.jerk * v * v * v - jolt),
            ];
            for (range, (one, other)) in sampled.iter_mut().zip(values) {
                for value in [one * factors.slave, other * factors.slave] {
                    *range = (range.0.min(value), range.1.max(value));
                }
            }
        }
        let all = [found.position, found.velocity, found.acceleration, found.jerk];
        for (index, (range, (min, max))) in all.iter().zip(sampled).enumerate() {
            let size = range.magnitude();
            prop_assert!(min >= range.min - 1e-9 * size && max <= range.max + 1e-9 * size);
            if index == 3 {
                // Jerks jump between pieces, and have kinks: as near as a step of 1/200 of a piece comes.
                prop_assert!(range.max - max <= 5e-2 * size && min - range.min <= 5e-2 * size, "{range:?} {min} {max}");
                continue;
            }
            // Half a step from a smooth extreme of at most degree 5.
            prop_assert!(range.max - max <= 2e-3 * size && min - range.min <= 2e-3 * size, "{range:?} {min} {max}");
        }
    }

    /// At the largest velocity no sample exceeds a limit, and just above it the peak does.
    #[test]
    fn the_largest_velocity_is_the_largest(knots in knots(), master in motion(), factors in factors(), limits in prop::array::uniform3(0.1..100.0_f64)) {
        let cam = curve(&knots);
        // So that the master's own motion leaves room.
        let floor = |quantity, limit: f64| {
            limit + cam.peak(quantity, &MasterMotion { velocity: 0.0, ..master }, factors).value
        };
        let limits = SlaveLimits {
            velocity: limits[0],
            acceleration: floor(Quantity::Acceleration, limits[1]),
            jerk: f64::INFINITY,
        };
        let found = cam.largest_master_velocity(&limits, &master, factors, false);
        let found = found.expect("smooth enough");
        let (quantity, _) = found.limited.expect("limited");
        let limit = |quantity| if quantity == Quantity::Velocity { limits.velocity } else { limits.acceleration };
        for each in [Quantity::Velocity, Quantity::Acceleration] {
            let peak = cam.peak(each, &MasterMotion { velocity: found.value, ..master }, factors);
            prop_assert!(peak.value <= limit(each) * (1.0 + 1e-14), "{each:?} {peak:?}");
        }
        let above = MasterMotion { velocity: found.value * (1.0 + 1e-9), ..master };
        prop_assert!(cam.peak(quantity, &above, factors).value > limit(quantity) * (1.0 - 1e-14));
    }

    /// The same of jerks, on one piece, where nothing jumps; and of accelerations of the master.
    #[test]
    fn jerks_and_accelerations(ends in knots(), master in motion(), limit in 0.1..100.0_f64) {
        let cam = curve(&ends[..2]);
        let one = Factors::default();
        let rest = MasterMotion { velocity: 0.0, ..master };
        let jerk = limit + cam.peak(Quantity::Jerk, &rest, one).value;
        let limits = SlaveLimits { jerk, ..SlaveLimits::NONE };
        let found = cam.largest_master_velocity(&limits, &master, one, false).expect("smooth");
        let at = |velocity| cam.peak(Quantity::Jerk, &MasterMotion { velocity, ..master }, one).value;
        prop_assert!(at(found.value) <= jerk * (1.0 + 1e-14));
        prop_assert!(at(found.value * (1.0 + 1e-9)) > jerk * (1.0 - 1e-14));
        let still = MasterMotion { acceleration: 0.0, ..master };
        let acceleration = limit + cam.peak(Quantity::Acceleration, &still, one).value;
        let limits = SlaveLimits { acceleration, ..SlaveLimits::NONE };
        let found = cam.largest_master_acceleration(&limits, &master, one, false).expect("smooth");
        let at = |acceleration| {
            cam.peak(Quantity::Acceleration, &MasterMotion { acceleration, ..master }, one).value
        };
        prop_assert!(at(found.value) <= acceleration * (1.0 + 1e-14));
        prop_assert!(at(found.value * (1.0 + 1e-9)) > acceleration * (1.0 - 1e-14));
        // The peak of a jerk is that of all signs: sampled.
        let sum = samples(&cam, 500).into_iter().map(|x| {
            let d = cam.at(x);
            let MasterMotion { velocity: v, acceleration: a, jerk: j } = master;
            d.jerk.abs() * v * v * v + 3.0 * d.acceleration.abs() * v * a + d.velocity.abs() * j
        }).fold(0.0, f64::max);
        let peak = cam.peak(Quantity::Jerk, &master, one).value;
        prop_assert!(sum <= peak * (1.0 + 1e-9) && sum >= peak * (1.0 - 5e-2), "{sum} {peak}");
    }
}
