//! Offsets and scalings with the smallest peak: where that is known in closed form, and against grids.

use super::{PEAK, Random, VELOCITY, lift};
use crate::tune::{Bound, Constrained, ConstraintError, Constraints, Objective, constrained_fit};
use crate::{Curve, Knot, MasterMotion, Quantity, SlaveLimits};

/// The quintic of two points at rest: y, y″ and y‴ at a part of the way.
fn rest_to_rest(rise: f64, width: f64, s: f64) -> [f64; 3] {
    [
        rise * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s),
        rise / width.powi(2) * (60.0 * s - 180.0 * s * s + 120.0 * s.powi(3)),
        rise / width.powi(3) * (60.0 - 360.0 * s + 360.0 * s * s),
    ]
}

fn wish() -> Constraints {
    let master = MasterMotion { velocity: VELOCITY, acceleration: 0.0, jerk: 0.0 };
    let wish = Constraints::new([0.0, 1.0, 0.0, 1.0], master, true);
    Constraints { tappet_tolerance: [0.0, 0.0], ..wish }
}

fn least(
    curve: &Curve,
    quantity: Quantity,
    wish: &Constraints,
) -> Result<Constrained, ConstraintError> {
    constrained_fit(curve, Objective::Peak(quantity), wish)
}

/// The largest y″ of the lift is 10/√3 · 100/180², its largest y‴ 60 · 100/180³; the slave's peaks grow with the scaling of the
/// slave, and with the square and the cube of the master's.
#[test]
fn intervals_hold_what_nothing_else_holds() {
    let peaks = [PEAK, 60.0 * 100.0 / 180.0_f64.powi(3)];
    for (quantity, peak, power) in
        [(Quantity::Acceleration, peaks[0], 2), (Quantity::Jerk, peaks[1], 3)]
    {
        for sign in [1.0, -1.0] {
            let sought = [None, Some([0.9, 1.1]), None, Some([0.8 * sign, 1.2 * sign])];
            let sought =
                sought.map(|interval| interval.map(|[a, b]: [f64; 2]| [a.min(b), a.max(b)]));
            let from = [5.0, 1.0, 3.0, sign];
            let found = least(&lift(), quantity, &Constraints { from, sought, ..wish() });
            let found = found.expect("scalings");
            assert_eq!(found.values, [5.0, 0.9, 3.0, 0.8 * sign]);
            let before = peak * VELOCITY.powi(power);
            assert!((found.before / before - 1.0).abs() < 1e-12, "{found:?} {before}");
            let after = before * 0.8 * 0.9_f64.powi(power);
            assert!((found.after / after - 1.0).abs() < 1e-12, "{found:?} {after}");
            assert_eq!(found.held[1], [Bound::Interval { end: 0.9 }]);
            assert_eq!(found.held[3], [Bound::Interval { end: 0.8 * sign }]);
        }
    }
}

/// Tappets at 50 and 200 that may move by 2: over these 150 of the cam the master goes 154 at most. Where the slave may be 1
/// from where it is at both of them, it is 2 less apart.
#[test]
fn tappets_hold_scalings() {
    let any = Some([f64::NEG_INFINITY, f64::INFINITY]);
    let tappets = vec![50.0, 120.0, 200.0];
    let held = |tappet_tolerance, from| Constraints {
        from,
        sought: [any; 4],
        tappets: tappets.clone(),
        tappet_tolerance,
        ..wish()
    };
    // At rest at 180: 20 of the way down are the same as 20 of the way up from 0.
    let y = [50.0, 120.0, 20.0].map(|x| rest_to_rest(100.0, 180.0, x / 180.0)[0]);
    let [low, high] = [y[0], y[1].max(100.0 - y[2])];
    let found = least(&lift(), Quantity::Acceleration, &held([2.0, 1.0], [0.0, 1.0, 0.0, 1.0]))
        .expect("scalings");
    let scaling = 1.0 - 2.0 / (high - low);
    let expected = [50.0 - 48.0 * 150.0 / 154.0, 150.0 / 154.0, low + 1.0 - scaling * low, scaling];
    for (found, expected) in found.values.into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    assert_eq!(found.held[1].len(), 2, "{found:?}");
    // A master that goes backwards, and one that is ahead.
    let found = least(&lift(), Quantity::Acceleration, &held([2.0, 1.0], [70.0, -1.0, 0.0, 1.0]))
        .expect("scalings");
    assert!((found.values[1] + 150.0 / 154.0).abs() < 1e-12, "{found:?}");
    for tappet in [50.0, 200.0] {
        let [now, then] =
            [[70.0, -1.0], [found.values[0], found.values[1]]].map(|[o, s]| (tappet - o) / s);
        assert!((now - then).abs() < 2.0 + 1e-9, "{now} {then}");
    }
    // Without a tolerance everything stays.
    let found = least(&lift(), Quantity::Acceleration, &held([0.0, 0.0], [0.0, 1.0, 0.0, 1.0]))
        .expect("scalings");
    assert_eq!(found.values, [0.0, 1.0, 0.0, 1.0]);
}

#[test]
fn a_stroke_and_limits_hold_a_scaling() {
    let any = Some([f64::NEG_INFINITY, f64::INFINITY]);
    let base = Constraints { sought: [None, None, any, any], ..wish() };
    let stroke = Constraints { stroke: 90.0, position: [20.0, 115.0], ..base.clone() };
    let found = least(&lift(), Quantity::Jerk, &stroke).expect("a scaling");
    let [.., offset, scaling] = found.values;
    assert!((scaling - 0.9).abs() < 1e-12 && (offset - 20.0).abs() < 1e-9, "{found:?}");
    assert_eq!(found.held[3], [Bound::Stroke]);
    assert_eq!(found.held[2], [Bound::Position { limit: 20.0 }]);
    let error = least(&lift(), Quantity::Jerk, &base).expect_err("nothing holds it");
    assert_eq!(error, ConstraintError::Unconstrained { unknown: "SlaveScaling" });
    let error =
        least(&lift(), Quantity::Jerk, &Constraints { position: [0.0, 80.0], ..stroke.clone() });
    let error = error.expect_err("too high").to_string();
    assert!(error.contains("stroke") || error.contains("position"), "{error}");
    let limits = SlaveLimits { acceleration: 1000.0, ..SlaveLimits::NONE };
    let error =
        least(&lift(), Quantity::Jerk, &Constraints { limits, ..stroke }).expect_err("too much");
    // 0.9 · 10/√3 · 100/180² · 300² are 1443.
    let ConstraintError::Contradictory { one, other, .. } = error else { panic!("{error}") };
    let limit = Bound::Limit { quantity: Quantity::Acceleration, limit: 1000.0 };
    assert!([one, other] == [Bound::Stroke, limit], "{error}");
    // A table with corners.
    let corners =
        Curve::linear(&[(0.0, 0.0), (5.0, 5.0), (10.0, 0.0)].map(|(x, y)| Knot::at_rest(x, y)));
    let error = least(&corners.expect("a cam"), Quantity::Jerk, &base).expect_err("corners");
    assert!(error.to_string().contains("has no bound"), "{error}");
}

/// Over 40 of the way up the acceleration is smallest in its middle, where it is 0 and falls by 30 · 100/180³: a master that goes
/// from 100 to 140 gets there with −30, or with 150 in the middle of the way down.
#[test]
fn a_part_of_the_cam_is_passed_where_it_is_gentlest() {
    for (interval, expected) in [([-40.0, 40.0], -30.0), ([100.0, 200.0], 150.0)] {
        let wish = Constraints {
            sought: [Some(interval), None, None, None],
            travel: Some([100.0, 140.0]),
            ..wish()
        };
        let found = least(&lift(), Quantity::Acceleration, &wish).expect("an offset");
        assert!((found.values[0] - expected).abs() < 1e-5, "{found:?}");
        let peak = rest_to_rest(100.0, 180.0, 0.5 - 20.0 / 180.0)[1] * VELOCITY * VELOCITY;
        assert!((found.after / peak - 1.0).abs() < 1e-6, "{found:?} {peak}");
        assert!(found.held[0].is_empty() && found.before > found.after, "{found:?}");
    }
}

/// Random cams, intervals, ways and strokes against a grid on which y″ or y‴ is sampled.
#[test]
fn no_place_of_a_grid_is_gentler() {
    const PLACES: u32 = 60;
    const SAMPLES: u32 = 120;
    let (mut found_some, mut none) = (0, 0);
    for seed in 0..40 {
        let mut random = Random(seed);
        let mut knots: Vec<_> = (0..6_u32)
            .map(|index| {
                let (x, y) = (f64::from(index) * 60.0, random.between(0.0, 50.0));
                Knot { velocity: random.between(-0.5, 0.5), ..Knot::at_rest(x, y) }
            })
            .collect();
        knots.push(Knot { master: 360.0, ..knots[0] });
        let curve = Curve::polynomial(&knots).expect("a cam");
        let quantity = if seed % 2 == 0 { Quantity::Acceleration } else { Quantity::Jerk };
        let begin = random.between(-200.0, 200.0);
        let travel = [begin, begin + random.between(20.0, 150.0)];
        let [offset, scaling, factor] =
            [random.between(-100.0, 100.0), random.between(0.7, 1.4), random.between(0.7, 1.4)];
        let between =
            [random.between(10.0, 80.0), random.between(0.05, 0.3), random.between(0.1, 0.5)];
        let offsets = [offset - between[0], offset + between[0]];
        let scalings = [scaling - between[1], scaling + between[1]];
        let factors = [factor - between[2], factor + between[2]];
        let stroke = random.between(0.0, 30.0);
        let wish = Constraints {
            from: [offset, scaling, 0.0, factor],
            sought: [Some(offsets), Some(scalings), None, Some(factors)],
            travel: Some(travel),
            stroke,
            ..wish()
        };
        // Least factor and peak, sampled.
        let sampled = |offset: f64, scaling: f64| {
            let (mut least, mut greatest, mut peak) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
            let [from, to] = travel.map(|master| master * scaling + offset);
            let even = (0..=SAMPLES)
                .map(|sample| from + f64::from(sample) / f64::from(SAMPLES) * (to - from));
            // The jerk steps where pieces meet: on both sides of there.
            let joints = (-20..=20)
                .flat_map(|joint| [-1e-6, 1e-6].map(|side| 60.0 * f64::from(joint) + side))
                .filter(|x| (from..=to).contains(x));
            for x in even.chain(joints) {
                let at = curve.repeated(x);
                (least, greatest) = (least.min(at.position), greatest.max(at.position));
                let v = VELOCITY * scaling;
                peak = peak.max(match quantity {
                    Quantity::Jerk => at.jerk.abs() * v.powi(3),
                    _ => at.acceleration.abs() * v * v,
                });
            }
            (greatest - least, peak)
        };
        let mut best = f64::INFINITY;
        for one in 0..=PLACES {
            for other in 0..=PLACES {
                let at = |[low, high]: [f64; 2], index| {
                    low + (high - low) * f64::from(index) / f64::from(PLACES)
                };
                let (height, peak) = sampled(at(offsets, one), at(scalings, other));
                let factor = factors[0].max(stroke / height);
                if factor <= factors[1] {
                    best = best.min(factor * peak);
                }
            }
        }
        let found = match least(&curve, quantity, &wish) {
            Ok(found) => found,
            Err(error) => {
                assert!(best.is_infinite(), "{seed}: {error}, and the grid has {best}");
                none += 1;
                continue;
            }
        };
        found_some += 1;
        // Between samples the peak may be a little more.
        assert!(found.after <= best * 1.02, "{seed}: {best} {found:?}");
        let [offset, scaling, _, factor] = found.values;
        let (height, peak) = sampled(offset, scaling);
        assert!(height * factor >= stroke * 0.999, "{seed}: {found:?}");
        let reported = found.after / factor.abs();
        assert!(
            peak <= reported * (1.0 + 1e-9) && peak >= reported * 0.95,
            "{seed}: {peak} {found:?}"
        );
        for (value, [low, high]) in [(offset, offsets), (scaling, scalings), (factor, factors)] {
            assert!(value >= low - 1e-9 && value <= high + 1e-9, "{seed}: {found:?}");
        }
    }
    assert!(found_some >= 20 && none < 20, "{found_some} {none}");
}

/// Demands that no scaling fulfils are reported, and no place is taken where they are not fulfilled.
#[test]
fn demands_that_no_scaling_fulfils() {
    let any = Some([f64::NEG_INFINITY, f64::INFINITY]);
    let lifts = {
        let knots = [(0.0, 0.0), (40.0, 0.0), (140.0, 80.0), (360.0, 0.0)];
        Curve::polynomial(&knots.map(|(x, y)| Knot::at_rest(x, y))).expect("a cam")
    };
    // On a dwell there is no stroke.
    let still = Constraints {
        sought: [None, None, None, Some([0.8, 1.2])],
        travel: Some([0.0, 40.0]),
        stroke: 36.0,
        ..wish()
    };
    match least(&lifts, Quantity::Acceleration, &still) {
        Err(ConstraintError::Contradictory {
            unknown: "SlaveScaling", one: Bound::Stroke, ..
        }) => {}
        other => panic!("{other:?}"),
    }
    // Where the master may go elsewhere, it does not stay there: of half the lift, the middle has the least peak.
    let elsewhere = Constraints {
        sought: [Some([-60.0, 60.0]), None, None, Some([0.8, 1.2])],
        travel: Some([65.0, 105.0]),
        tappet_tolerance: [f64::INFINITY; 2],
        ..still.clone()
    };
    let found = least(&lifts, Quantity::Acceleration, &elsewhere).expect("a place");
    let [offset, scaling, _, factor] = found.values;
    let reach = |master: f64| factor * lifts.repeated(master * scaling + offset).position;
    assert!((reach(105.0) - reach(65.0)).abs() >= 36.0 - 1e-9 && found.after > 0.0, "{found:?}");
    // A tappet on the dwell keeps the slave at 0, below the least position, whatever the scaling.
    let below = Constraints {
        sought: [None, None, any, Some([0.8, 1.2])],
        tappets: vec![20.0],
        position: [5.0, f64::INFINITY],
        ..wish()
    };
    match least(&lifts, Quantity::Acceleration, &below) {
        Err(ConstraintError::Contradictory { unknown: "SlaveScaling", one, other }) => {
            let bounds = [Bound::Tappet { place: 20.0 }, Bound::Position { limit: 5.0 }];
            let both = bounds.contains(&one) && bounds.contains(&other) && one != other;
            assert!(both, "{one} {other}");
        }
        other => panic!("{other:?}"),
    }
}

/// A cam that begins at 0 is there with every scaling: without its offset none brings it to 10.
#[test]
fn a_position_that_no_scaling_keeps_is_reported() {
    let sought = [None, None, None, Some([0.9, 1.1])];
    let tappet_tolerance = [f64::INFINITY; 2];
    let position = [10.0, 200.0];
    let task = Constraints { sought, position, tappet_tolerance, ..wish() };
    let found = least(&lift(), Quantity::Acceleration, &task);
    let Err(ConstraintError::Contradictory { unknown, one, other }) = found else {
        panic!("{found:?}");
    };
    assert_eq!(unknown, "SlaveScaling");
    assert!([one, other].contains(&Bound::Position { limit: 10.0 }), "{one} {other}");
}

/// The master is at 20 when the slave is coupled, which has to be on the cam, 0 to 360: with half the scaling an offset of −10 to 350.
/// Of the smallest scaling the nearest offset is the answer; where the offset stays, the scaling is held.
#[test]
fn the_master_starts_on_the_cam() {
    let sought = [Some([-100.0, 100.0]), Some([0.5, 1.0]), None, None];
    let start = |start, from| Constraints { sought, from, start: Some(start), ..wish() };
    let held = Bound::Start { master: 20.0 };
    for (from, expected, by) in
        [(-30.0, -10.0, vec![held]), (-5.0, -5.0, vec![]), (7.0, 7.0, vec![])]
    {
        let found = least(&lift(), Quantity::Acceleration, &start(20.0, [from, 1.0, 0.0, 1.0]))
            .expect("a place");
        assert_eq!(found.values, [expected, 0.5, 0.0, 1.0]);
        assert_eq!(found.held[0], by);
    }
    // 20 · s − 12 is not less than 0.
    let mut task = start(20.0, [-12.0, 1.0, 0.0, 1.0]);
    task.sought[0] = None;
    let found = least(&lift(), Quantity::Acceleration, &task).expect("a place");
    assert!(
        (found.values[1] - 0.6).abs() < 1e-15 && 20.0 * found.values[1] - 12.0 >= 0.0,
        "{found:?}"
    );
    assert_eq!(found.held[1], vec![held]);
    task.from[0] = -25.0;
    let error = least(&lift(), Quantity::Acceleration, &task).expect_err("beyond").to_string();
    assert!(error.contains("the start with the master at 20"), "{error}");
}
