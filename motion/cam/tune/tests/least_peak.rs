//! Offsets and scalings with the smallest peak, in closed form.

use super::{PEAK, VELOCITY, lift};
use crate::tune::{Bound, Constrained, ConstraintError, Constraints, Objective, constrained_fit};
use crate::{Curve, Knot, MasterMotion, Quantity, SlaveLimits};

fn wish() -> Constraints {
    let master = MasterMotion { velocity: VELOCITY, acceleration: 0.0, jerk: 0.0 };
    Constraints::new([0.0, 1.0, 0.0, 1.0], master, true)
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

#[test]
fn an_interval_and_limits_hold_a_scaling() {
    let any = Some([f64::NEG_INFINITY, f64::INFINITY]);
    let base = Constraints { sought: [None, None, any, any], ..wish() };
    let error = least(&lift(), Quantity::Jerk, &base).expect_err("nothing holds it");
    assert_eq!(error, ConstraintError::Unconstrained { unknown: "SlaveScaling" });
    let interval = Constraints {
        sought: [None, None, any, Some([0.9, 1.1])],
        position: [20.0, 115.0],
        ..base.clone()
    };
    let found = least(&lift(), Quantity::Jerk, &interval).expect("a scaling");
    let [.., offset, scaling] = found.values;
    assert!((scaling - 0.9).abs() < 1e-12 && (offset - 20.0).abs() < 1e-9, "{found:?}");
    let end = Bound::Interval { end: 0.9 };
    assert_eq!(found.held[3], [end]);
    assert_eq!(found.held[2], [Bound::Position { limit: 20.0 }]);
    let error =
        least(&lift(), Quantity::Jerk, &Constraints { position: [0.0, 80.0], ..interval.clone() });
    let error = error.expect_err("too high").to_string();
    assert!(error.contains("interval") || error.contains("position"), "{error}");
    let limits = SlaveLimits { acceleration: 1000.0, ..SlaveLimits::NONE };
    let error =
        least(&lift(), Quantity::Jerk, &Constraints { limits, ..interval }).expect_err("too much");
    // 0.9 · 10/√3 · 100/180² · 300² are 1443.
    let ConstraintError::Contradictory { one, other, .. } = error else { panic!("{error}") };
    let limit = Bound::Limit { quantity: Quantity::Acceleration, limit: 1000.0 };
    assert!([one, other] == [end, limit], "{error}");
    // A table with corners.
    let corners =
        Curve::linear(&[(0.0, 0.0), (5.0, 5.0), (10.0, 0.0)].map(|(x, y)| Knot::at_rest(x, y)));
    let error = least(&corners.expect("a cam"), Quantity::Jerk, &base).expect_err("corners");
    assert!(error.to_string().contains("has no bound"), "{error}");
}

/// A cam that begins at 0 is there with every scaling: without its offset none brings it to 10.
#[test]
fn a_position_that_no_scaling_keeps_is_reported() {
    let sought = [None, None, None, Some([0.9, 1.1])];
    let position = [10.0, 200.0];
    let task = Constraints { sought, position, ..wish() };
    let found = least(&lift(), Quantity::Acceleration, &task);
    let Err(ConstraintError::Contradictory { unknown, one, other }) = found else {
        panic!("{found:?}");
    };
    assert_eq!(unknown, "SlaveScaling");
    assert!([one, other].contains(&Bound::Position { limit: 10.0 }), "{one} {other}");
}
