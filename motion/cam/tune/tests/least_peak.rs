//! Offsets and scalings with the smallest peak, in closed form.

use super::{PEAK, VELOCITY, lift};
use crate::tune::{Bound, Constrained, ConstraintError, Constraints, Objective, constrained_fit};
use crate::{Curve, Knot, MasterMotion, Quantity, SlaveLimits};

/// The quintic of two points at rest, at a part of the way.
fn rest_to_rest(rise: f64, s: f64) -> f64 {
    rise * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s)
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
    let y = [50.0, 120.0, 20.0].map(|x| rest_to_rest(100.0, x / 180.0));
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

/// Demands that no scaling fulfils are reported, and no place is taken where they are not fulfilled.
#[test]
fn demands_that_no_scaling_fulfils() {
    let any = Some([f64::NEG_INFINITY, f64::INFINITY]);
    let lifts = {
        let knots = [(0.0, 0.0), (40.0, 0.0), (140.0, 80.0), (360.0, 0.0)];
        Curve::polynomial(&knots.map(|(x, y)| Knot::at_rest(x, y))).expect("a cam")
    };
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
