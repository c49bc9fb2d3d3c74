//! Reshaped cams: faster, within their tolerances, and as fast as can be.

use super::Random;
use crate::tune::{ReshapeError, Tolerance, Wish, reshape, soften};
use crate::{Curve, Factors, Knot, LimitError, MasterMotion, Quantity, SlaveLimits};

fn wish(tolerances: Vec<Tolerance>, limits: SlaveLimits) -> Wish {
    Wish {
        tolerances,
        held: Vec::new(),
        limits,
        position: [f64::NEG_INFINITY, f64::INFINITY],
        master_acceleration: 0.0,
        master_jerk: 0.0,
        repeated: false,
    }
}

fn acceleration(acceleration: f64) -> SlaveLimits {
    SlaveLimits { acceleration, ..SlaveLimits::NONE }
}

/// From rest to rest through a point half way: whatever that point does, the peak of the acceleration over 2 · 90 is at
/// least that of two parabolas, 4 · 100 / 180²; the best two quintics have to be above.
#[test]
fn a_free_middle_point() {
    let knots = [Knot::at_rest(0.0, 0.0), Knot::at_rest(90.0, 50.0), Knot::at_rest(180.0, 100.0)];
    let free = Tolerance { slave: 0.0, velocity: 10.0, acceleration: 0.0 };
    let none = Tolerance::default();
    let limits = acceleration(100.0);
    let found = reshape(&knots, &wish(vec![none, free, none], limits)).expect("a shape");
    let bound = (100.0 / (4.0 * 100.0 / (180.0 * 180.0_f64))).sqrt();
    assert!(found.after.value > found.before.value, "{found:?}");
    assert!(found.after.value < bound);
    // One unknown: the peak over all velocities of the middle point, one by one.
    let speed = |velocity: f64| {
        let mut moved = knots;
        moved[1].velocity = velocity;
        let curve = Curve::polynomial(&moved).expect("a curve");
        let master = MasterMotion::default();
        curve
            .largest_master_velocity(&limits, &master, Factors::default(), false)
            .expect("a velocity")
    };
    let best = (0..20_000_i32).map(|i| speed(f64::from(i) * 1e-4).value).fold(0.0, f64::max);
    assert!((found.after.value / best - 1.0).abs() < 1e-5, "{} {best}", found.after.value);
    assert_eq!(
        speed(found.knots[1].velocity).value,
        found.after.value,
        "the reported value is exact"
    );
}

/// Tolerances, tappets and the ends of periodic cams are kept; nothing gets slower.
#[test]
fn random_cams_get_faster_within_their_tolerances() {
    for seed in 0..25 {
        let mut random = Random(seed);
        let mut knots = Vec::new();
        for index in 0..7_i32 {
            knots.push(Knot {
                master: 60.0 * f64::from(index),
                slave: random.between(0.0, 100.0),
                velocity: random.between(-1.0, 1.0),
                acceleration: random.between(-0.02, 0.02),
            });
        }
        knots[6] = Knot { master: 360.0, ..knots[0] };
        let tolerances: Vec<_> = (0..7)
            .map(|_| Tolerance {
                slave: if random.share() < 0.5 { 0.0 } else { random.between(0.0, 5.0) },
                velocity: random.between(0.0, 0.5),
                acceleration: random.between(0.0, 0.02),
            })
            .collect();
        let limits = SlaveLimits {
            velocity: 500.0,
            acceleration: 2000.0,
            jerk: if seed % 2 == 0 { f64::INFINITY } else { 1e5 },
        };
        let held = vec![100.0, 215.5];
        let pull = if seed % 3 == 0 { 5.0 } else { 0.0 };
        let jolt = if seed % 5 < 2 { 2000.0 } else { 0.0 };
        let wish = Wish {
            held: held.clone(),
            master_acceleration: pull,
            master_jerk: jolt,
            repeated: true,
            ..wish(tolerances.clone(), limits)
        };
        // With jerk limits the points have to join with one jerk limit only, which quintics do.
        let found = reshape(&knots, &wish).unwrap_or_else(|error| panic!("{seed}: {error}"));
        assert!(found.after.value > found.before.value, "{seed}: {found:?}");
        let [old, new] =
            [&knots, &found.knots].map(|knots| Curve::polynomial(knots).expect("a curve"));
        for master in held {
            let [a, b] = [&old, &new].map(|curve| curve.at(master).position);
            assert!((a - b).abs() < 1e-5, "{seed}: {a} {b}");
        }
        for ((before, after), tolerance) in knots.iter().zip(&found.knots).zip(&tolerances).take(6)
        {
            assert_eq!(before.master, after.master);
            assert!((before.slave - after.slave).abs() <= tolerance.slave + 1e-12);
            assert!((before.velocity - after.velocity).abs() <= tolerance.velocity + 1e-12);
            assert!(
                (before.acceleration - after.acceleration).abs() <= tolerance.acceleration + 1e-12
            );
        }
        let jumps = new.jumps(true);
        assert!(jumps.velocity.by.abs() < 1e-9 && jumps.acceleration.by.abs() < 1e-9, "C2");
        assert!((new.rise()).abs() < 1e-9);
        let master = MasterMotion { velocity: found.after.value, acceleration: pull, jerk: jolt };
        for (quantity, limit) in
            Quantity::ALL.into_iter().zip([limits.velocity, limits.acceleration, limits.jerk])
        {
            let peak = new.peak(quantity, &master, Factors::default());
            assert!(peak.value <= limit * (1.0 + 1e-12), "{seed}: {quantity} {peak:?}");
        }
    }
}

/// A rise of 50 to a free point and back, both ends at rest and fixed, wherever the point is: limits of the position that the
/// slave does not come near to, and tappets where the ends hold it anyway, change nothing of what is found.
#[test]
fn what_the_ends_hold_is_no_condition() {
    for place in 1..36_i32 {
        let middle = 10.0 * f64::from(place);
        let knots =
            [Knot::at_rest(0.0, 0.0), Knot::at_rest(middle, 50.0), Knot::at_rest(360.0, 0.0)];
        let free = Tolerance { slave: 1.0, velocity: 0.2, acceleration: 0.01 };
        let none = Tolerance::default();
        let plain = wish(vec![none, free, none], SlaveLimits::NONE);
        let found = |wish: &Wish| {
            let found = soften(&knots, wish, Quantity::Acceleration, 100.0);
            found.unwrap_or_else(|error| panic!("{middle}: {error}")).after.value
        };
        let best = found(&plain);
        for (position, held) in [
            ([-1000.0, 1000.0], vec![]),
            ([f64::NEG_INFINITY, 1000.0], vec![]),
            ([f64::NEG_INFINITY, f64::INFINITY], vec![0.0]),
            ([f64::NEG_INFINITY, f64::INFINITY], vec![360.0]),
            ([-1000.0, 1000.0], vec![0.0, 360.0]),
        ] {
            let with = found(&Wish { position, held: held.clone(), ..plain.clone() });
            let apart = (with / best - 1.0).abs();
            assert!(apart < 1e-6, "{middle} {position:?} {held:?}: {with} {best}");
        }
        // A tappet at the free point holds it.
        let held = found(&Wish { held: vec![middle], ..plain.clone() });
        assert!(held > best * (1.0 + 1e-3), "{middle}: {held} {best}");
    }
}

/// A point that is free in its height, between two that stay at rest: the faster, the higher it goes, and beyond 60 it may not.
/// From rest to rest over a free middle the slave overshoots, too: exactly its greatest position is kept.
#[test]
fn positions_are_kept() {
    let knots = [
        Knot::at_rest(0.0, 0.0),
        Knot { velocity: 0.9, ..Knot::at_rest(90.0, 55.0) },
        Knot::at_rest(180.0, 58.0),
        Knot::at_rest(300.0, 0.0),
    ];
    let none = Tolerance::default();
    let free = Tolerance { slave: 20.0, velocity: 2.0, acceleration: 0.05 };
    let tolerances = vec![none, free, free, none];
    let greatest = |knots: &[Knot]| Curve::polynomial(knots).expect("a curve").extremes().position;
    let loose = wish(tolerances.clone(), acceleration(100.0));
    let far = greatest(&reshape(&knots, &loose).expect("a shape").knots);
    let before = greatest(&knots);
    // As it is it leaves 60; with 60 as its limit it has to be changed.
    assert!(before.max > 60.0, "{before:?}");
    let kept = Wish { position: [-1e-3, 60.0], ..loose.clone() };
    let found = reshape(&knots, &kept).expect("a shape");
    let reached = greatest(&found.knots);
    assert!(reached.max <= 60.0 + 1e-9 && reached.min >= -1e-3 - 1e-9, "{reached:?}");
    assert!(
        found.after.value <= reshape(&knots, &loose).expect("a shape").after.value * (1.0 + 1e-6)
    );
    // Where the limits are never reached, they change nothing.
    let wide = Wish { position: [far.min - 1.0, far.max + 1.0], ..loose.clone() };
    let (one, other) = (reshape(&knots, &wide), reshape(&knots, &loose));
    let [one, other] = [one, other].map(|found| found.expect("a shape").after.value);
    assert!((one / other - 1.0).abs() < 1e-5, "{one} {other}");
    let soft = soften(&knots, &kept, Quantity::Acceleration, 50.0).expect("a shape");
    assert!(greatest(&soft.knots).max <= 60.0 + 1e-9);
    // A point that stays at 58 does not keep 50.
    let none = Wish { position: [-1.0, 30.0], ..loose };
    assert_eq!(reshape(&knots, &none), Err(ReshapeError::NoShape));
}

/// The master's acceleration and jerk count as the check has them: what was and what is are its largest velocities, the slave
/// keeps its jerk at every place with every sign of both, and trying the velocities of the middle point one by one finds
/// nothing faster.
#[test]
fn the_jerk_of_the_master_counts() {
    let knots = [Knot::at_rest(0.0, 0.0), Knot::at_rest(90.0, 50.0), Knot::at_rest(180.0, 100.0)];
    let free = Tolerance { slave: 0.0, velocity: 10.0, acceleration: 0.0 };
    let none = Tolerance::default();
    let limits = SlaveLimits { jerk: 60_000.0, ..SlaveLimits::NONE };
    // The greatest y′ of the cam is 1.875 · 50/90: with the last of them 57,292 of the limit are the master's jerk alone.
    for (pull, jolt) in [(0.0, 0.0), (0.0, 20_000.0), (500.0, 0.0), (500.0, 55_000.0)] {
        let wish = Wish {
            master_acceleration: pull,
            master_jerk: jolt,
            ..wish(vec![none, free, none], limits)
        };
        let found = reshape(&knots, &wish).expect("a shape");
        let master = MasterMotion { velocity: 0.0, acceleration: pull, jerk: jolt };
        let speed = |knots: &[Knot]| {
            let curve = Curve::polynomial(knots).expect("a curve");
            curve.largest_master_velocity(&limits, &master, Factors::default(), false)
        };
        assert_eq!(Ok(found.before), speed(&knots), "{pull} {jolt}");
        assert_eq!(Ok(found.after), speed(&found.knots), "{pull} {jolt}");
        let try_one = |velocity: f64| {
            let mut moved = knots;
            moved[1].velocity = velocity;
            speed(&moved).map_or(0.0, |found| found.value)
        };
        // The best is where two peaks meet, so that a coarse grid misses it: a fine one follows.
        let mut best = (0.0, 0.0);
        for (step, count) in [(1e-3, 2000_i32), (1e-6, 1000)] {
            let middle = if count == 2000 { 1.0 } else { best.1 };
            for i in -count..=count {
                let at = middle + f64::from(i) * step;
                let reached = try_one(at);
                if reached > best.0 {
                    best = (reached, at);
                }
            }
        }
        let (before, after) = (found.before.value, found.after.value);
        assert!(after > before, "{pull} {jolt}: {before} {after}");
        assert!((after / best.0 - 1.0).abs() < 1e-5, "{pull} {jolt}: {after} {best:?}");
        let curve = Curve::polynomial(&found.knots).expect("a curve");
        for place in 0..=18_000_i32 {
            let d = curve.at(f64::from(place) * 0.01);
            for (a, j) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                let pulled = a * 3.0 * d.acceleration * after * pull + j * d.velocity * jolt;
                let reached = (d.jerk * after.powi(3) + pulled).abs();
                assert!(reached <= 60_000.0 * (1.0 + 1e-9), "{place}: {reached}");
            }
        }
        // At that velocity the gentlest jerk is the limit that was reached: the peak counts all three as well.
        let soft = soften(&knots, &wish, Quantity::Jerk, after).expect("a shape");
        assert!((soft.after.value / 60_000.0 - 1.0).abs() < 1e-5, "{pull} {jolt}: {soft:?}");
        let all = MasterMotion { velocity: after, ..master };
        let peak = |knots: &[Knot]| {
            let curve = Curve::polynomial(knots).expect("a curve");
            curve.peak(Quantity::Jerk, &all, Factors::default())
        };
        assert_eq!((soft.before, soft.after), (peak(&knots), peak(&soft.knots)));
    }
    // 1.875 · 50/90 · 200,000: more than the slave's jerk may be, however slow the master is.
    let wish = Wish { master_jerk: 200_000.0, ..wish(vec![none, free, none], limits) };
    let Err(ReshapeError::Limit(LimitError::TooMuch { quantity, peak, limit })) =
        reshape(&knots, &wish)
    else {
        panic!("it is too much")
    };
    assert_eq!((quantity, limit), (Quantity::Jerk, 60_000.0));
    assert!((peak.value / (1.875 * 50.0 / 90.0 * 200_000.0) - 1.0).abs() < 1e-12, "{peak:?}");
    let soft = soften(&knots, &wish, Quantity::Acceleration, 1.0);
    assert_eq!(soft, Err(ReshapeError::NoShape));
    for master_jerk in [-1.0, f64::NAN, f64::INFINITY] {
        let wish = Wish { master_jerk, ..wish.clone() };
        for error in [
            reshape(&knots, &wish).expect_err("no magnitude"),
            soften(&knots, &wish, Quantity::Jerk, 1.0).expect_err("no magnitude"),
        ] {
            let said = format!("the master's jerk is {master_jerk}, which is not a magnitude");
            assert_eq!(error.to_string(), said);
        }
    }
}

#[test]
fn what_cannot_be_reshaped() {
    let knots = [Knot::at_rest(0.0, 0.0), Knot::at_rest(90.0, 50.0)];
    let none = vec![Tolerance::default(); 2];
    let fixed = reshape(&knots, &wish(none.clone(), acceleration(1.0))).expect("as it was");
    assert_eq!((fixed.knots.as_slice(), fixed.before), (&knots[..], fixed.after));
    let free = reshape(&knots, &wish(none, SlaveLimits::NONE));
    assert_eq!(free, Err(ReshapeError::NoLimit));
    let one = reshape(&knots, &wish(vec![Tolerance::default()], acceleration(1.0)));
    assert_eq!(one, Err(ReshapeError::Tolerances { found: 1, expected: 2 }));
    let negative = Tolerance { slave: -1.0, ..Tolerance::default() };
    let wrong = reshape(&knots, &wish(vec![Tolerance::default(), negative], acceleration(1.0)));
    assert_eq!(wrong, Err(ReshapeError::NoMagnitude { index: 2, value: -1.0 }));
}

/// The most gentle lift through a middle point that may have any velocity: by the symmetry of the closed form above, and
/// never above what trying velocities one by one finds.
#[test]
fn gentle_at_a_given_velocity() {
    let knots = [Knot::at_rest(0.0, 0.0), Knot::at_rest(90.0, 50.0), Knot::at_rest(180.0, 100.0)];
    let free = Tolerance { slave: 0.0, velocity: 10.0, acceleration: 0.0 };
    let none = Tolerance::default();
    let wish = wish(vec![none, free, none], SlaveLimits::NONE);
    let found = soften(&knots, &wish, Quantity::Acceleration, 100.0).expect("a shape");
    let master = MasterMotion { velocity: 100.0, ..MasterMotion::default() };
    let peak = |velocity: f64| {
        let mut moved = knots;
        moved[1].velocity = velocity;
        let curve = Curve::polynomial(&moved).expect("a curve");
        curve.peak(Quantity::Acceleration, &master, Factors::default()).value
    };
    let best = (0..20_000_i32).map(|i| peak(f64::from(i) * 1e-4)).fold(f64::INFINITY, f64::min);
    assert!(found.after.value < found.before.value);
    assert!((found.after.value / best - 1.0).abs() < 1e-5, "{} {best}", found.after.value);
    assert_eq!(peak(found.knots[1].velocity), found.after.value, "the reported value is exact");
    // With the velocity limited the peak is larger, and the limit kept.
    let reached = |knots: &[Knot], quantity| {
        let curve = Curve::polynomial(knots).expect("a curve");
        curve.peak(quantity, &master, Factors::default()).value
    };
    let fastest = reached(&found.knots, Quantity::Velocity);
    let limited = SlaveLimits { velocity: fastest * 0.97, ..SlaveLimits::NONE };
    let wish = Wish { limits: limited, ..wish };
    let slower = soften(&knots, &wish, Quantity::Acceleration, 100.0).expect("a shape");
    assert!(reached(&slower.knots, Quantity::Velocity) <= limited.velocity * (1.0 + 1e-6));
    assert!(slower.after.value > found.after.value);
    // No lift over 180 is slower than evenly: 100/180 · 100 u/s.
    let limited = SlaveLimits { velocity: 50.0, ..SlaveLimits::NONE };
    let wish = Wish { limits: limited, ..wish };
    let none = soften(&knots, &wish, Quantity::Acceleration, 100.0);
    assert_eq!(none, Err(ReshapeError::NoShape));
}

/// How many characters a value takes.
fn digits(value: f64) -> usize {
    value.to_string().trim_start_matches('-').replace('.', "").trim_start_matches('0').len()
}

/// Points are short decimals: those that go as far as they may are at the end of their tolerance, the others have no more digits
/// than limits and tappets ask for; and with them nothing is exceeded, not in the last digit.
#[test]
fn points_are_short() {
    let knots = [
        Knot::at_rest(0.0, 0.0),
        Knot::at_rest(120.0, 70.0),
        Knot::at_rest(180.0, 100.0),
        Knot::at_rest(360.0, 0.0),
    ];
    let none = Tolerance::default();
    let free = Tolerance { slave: 1.0, velocity: 0.1, acceleration: 0.0 };
    let found = reshape(&knots, &wish(vec![none, free, none, none], acceleration(5000.0)));
    let found = found.expect("a shape");
    assert_eq!((found.knots[1].slave, found.knots[1].velocity), (71.0, 0.1), "{found:?}");
    let mut most = [0; 2];
    for seed in 0..40_u64 {
        let mut random = Random(seed + 900);
        let round = |value: f64, unit: f64| (value / unit).round() * unit;
        let knots: Vec<_> = (0..6_i32)
            .map(|index| Knot {
                master: 60.0 * f64::from(index),
                slave: round(random.between(0.0, 100.0), 1.0),
                velocity: round(random.between(-1.0, 1.0), 0.25),
                acceleration: 0.0,
            })
            .collect();
        let tolerances: Vec<_> = (0..6)
            .map(|_| Tolerance {
                slave: if random.share() < 0.4 { 0.0 } else { 2.0 },
                velocity: 0.5,
                acceleration: 0.03125,
            })
            .collect();
        let held = if seed % 2 == 0 { vec![] } else { vec![100.0, 215.5] };
        let fastest = Curve::polynomial(&knots).expect("a curve").extremes().velocity.magnitude();
        // At 100 u/s the velocity may not grow.
        let limits = SlaveLimits { velocity: 100.0 * fastest, ..SlaveLimits::NONE };
        let wish = Wish { held: held.clone(), ..wish(tolerances.clone(), limits) };
        let found = soften(&knots, &wish, Quantity::Acceleration, 100.0);
        let found = found.unwrap_or_else(|error| panic!("{seed}: {error}"));
        let [old, new] =
            [&knots, &found.knots].map(|knots| Curve::polynomial(knots).expect("a curve"));
        let master = MasterMotion { velocity: 100.0, ..MasterMotion::default() };
        let reached = new.peak(Quantity::Velocity, &master, Factors::default()).value;
        assert!(reached <= limits.velocity * (1.0 + 1e-12), "{seed}: {reached} {limits:?}");
        assert_eq!(found.after, new.peak(Quantity::Acceleration, &master, Factors::default()));
        for at in &held {
            let [a, b] = [&old, &new].map(|curve| curve.at(*at).position);
            assert!((a - b).abs() < 1e-6, "{seed}: {a} {b}");
        }
        for ((before, after), tolerance) in knots.iter().zip(&found.knots).zip(&tolerances) {
            for (before, after, tolerance) in [
                (before.slave, after.slave, tolerance.slave),
                (before.velocity, after.velocity, tolerance.velocity),
                (before.acceleration, after.acceleration, tolerance.acceleration),
            ] {
                assert!((after - before).abs() <= tolerance, "{seed}: {before} {after}");
                let most = &mut most[usize::from(seed % 2 == 1)];
                *most = (*most).max(digits(after));
            }
        }
    }
    // Seven say an optimum that is known to 1e-7; tappets that are held to 1e-9 of the height ask for more.
    assert!(most[0] <= 10 && most[1] <= 14, "{most:?}");
}
