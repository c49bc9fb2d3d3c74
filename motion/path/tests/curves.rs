//! Tests of ellipses and cubics, and of extra axes along a path.

#![expect(clippy::float_cmp, reason = "exact at the ends, or halves")]

use super::*;
use crate::EllipseError;

fn mm(x: f64, y: f64) -> Point3<f64> {
    Point3::new(x, y, 0.0) / 1e3
}

#[test]
fn ellipses_that_cannot_be() {
    let through = |start, end, ratio| {
        Ellipse::through(start, end, Point2::origin(), 0.0, ratio, false).map(|_| ())
    };
    // The same point twice leaves the ratio open.
    let (a, b) = (mm(20.0, 5.0), mm(-20.0, 5.0));
    assert_eq!(through(a, b, None), Err(EllipseError::RatioNeeded));
    assert_eq!(through(a, b, Some(0.0)), Err(EllipseError::RatioNeeded));
    assert_eq!(through(a, b, Some(0.5)), Ok(()));
    assert_eq!(through(a, a * 2.0, Some(0.5)), Err(EllipseError::EndMissed));
    // A hyperbola.
    assert_eq!(through(mm(20.0, 0.0), mm(30.0, 10.0), None), Err(EllipseError::NoEllipse));
}

/// A full turn has the circumference of Ramanujan's second formula, here exact to 1e-9 of it.
#[test]
fn a_whole_ellipse() {
    let (end, center) = (mm(30.0, 0.0), Point2::origin());
    let made = Ellipse::through(end, end, center, 0.0, Some(0.8), true).unwrap();
    near(made.sweep(), -TAU);
    let (a, b) = (30.0, 24.0);
    let h = (6.0_f64 / (a + b)).powi(2);
    let around = PI * (a + b) * (1.0 + 3.0 * h / (10.0 + (4.0 - 3.0 * h).sqrt()));
    assert!((made.length() * 1e3 / around - 1.0).abs() < 1e-9);
}

#[test]
fn curves_without_length_and_with_cusps_stay_finite() {
    let point = mm(10.0, 10.0);
    let still = Cubic::parabola(point, point.xy(), point);
    let cusp = Cubic::hermite(mm(0.0, 0.0), mm(10.0, 0.0), Vector2::zeros(), Vector2::zeros());
    let there_and_back = Cubic::parabola(mm(0.0, 0.0), Point2::new(0.02, 0.0), mm(0.0, 0.0));
    let (ends, major) = ([mm(10.0, 0.0), mm(-10.0, 0.0)], Vector2::x() / 100.0);
    let flat = Ellipse::new(ends[0], ends[1], Point2::origin(), major, 0.0, PI);
    let upright = Cubic::hermite(point, point + Vector3::z(), Vector2::zeros(), Vector2::zeros());
    for (shape, length) in [
        (cubic(still), 0.0),
        (cubic(cusp), 0.01),
        (cubic(there_and_back), 0.02),
        (ellipse(flat), 0.02),
        (cubic(upright), 1.0),
    ] {
        near(shape.length(), length);
        for part in [0.0, 1e-12, 0.3, 0.5, 0.7, 1.0 - 1e-12, 1.0] {
            let at = shape.at(part * shape.length());
            let numbers = [at.position.coords, at.tangent, at.curvature, at.curvature_rate];
            assert!(numbers.iter().flatten().all(|number| number.is_finite()), "{at:?}");
            assert!(at.tangent.norm() < 1.0 + 1e-9, "{at:?}");
        }
    }
}

#[test]
fn extra_axes_alone_have_a_length_of_their_own() {
    let extra = Some(ExtraAxes { start: [0.0; 5], end: [3.0, 0.0, 4.0, 0.0, 0.0] });
    let element = detailed(line([0.0; 3], [0.0; 3]), Details { extra, ..Details::default() });
    near(element.length(), 0.005);
    let middle = element.extra_at(0.0025).unwrap();
    assert_eq!(middle.position, [1.5, 0.0, 2.0, 0.0, 0.0]);
    assert_eq!(element.start_tangent(), Vector3::zeros());
}

fn curves() -> impl Strategy<Value = Shape> {
    let center = [-0.3..0.3, -0.3..0.3, -0.1..0.1_f64].prop_map(Point3::from);
    let sweep = (-TAU..TAU).prop_filter("turns", |sweep| sweep.abs() > 0.05);
    let arcs = (center, 0.01..0.3_f64, 0.05..1.0_f64, -PI..PI, -PI..PI, sweep, -0.1..0.1_f64)
        .prop_map(|(center, a, ratio, direction, from, sweep, rise)| {
            let major = Vector2::new(f64::cos(direction), f64::sin(direction)) * a;
            let side = Vector2::new(-major.y, major.x) * ratio;
            let on = |angle: f64, z| {
                let flat = center.xy() + major * angle.cos() + side * angle.sin();
                Point3::from(flat.coords.push(z))
            };
            let (start, end) = (on(from, center.z), on(from + sweep, center.z + rise));
            ellipse(Ellipse::new(start, end, center.xy(), major, a * ratio, sweep))
        });
    prop_oneof![arcs, cubics()]
}

proptest! {
    #[test]
    fn curve_ends_are_exact_and_approached(shape in curves()) {
        prop_assert_eq!(shape.at(0.0).position, shape.start());
        prop_assert_eq!(shape.at(shape.length()).position, shape.end());
        let (length, near) = (shape.length(), 1e-9);
        prop_assert!((shape.at(length * near).position - shape.start()).norm() < 2e-9 * length + 1e-15);
        prop_assert!((shape.at(length * (1.0 - near)).position - shape.end()).norm() < 2e-9 * length + 1e-15);
    }

    /// Path length: the tangent has length one and is the derivative of the position.
    #[test]
    fn curves_are_travelled_by_length(shape in curves(), at in 0.001..0.999) {
        let length = shape.length();
        let (s, h) = (at * length, 1e-6 * length);
        let [before, here, after] = [s - h, s, s + h].map(|s| shape.at(s));
        prop_assert!((here.tangent.norm() - 1.0).abs() < 1e-9, "{here:?}");
        // Where it bends on the scale of h (near a cusp) differences say nothing.
        let bend = here.curvature.norm().max(before.curvature.norm()).max(after.curvature.norm());
        prop_assume!(bend * h < 1e-3);
        let chord = (after.position - before.position) / (2.0 * h);
        prop_assert!((chord - here.tangent).norm() < 1e-3 * bend * h + 1e-8, "{chord} {here:?}");
    }

    /// The sum of short chords comes near the length from below.
    #[test]
    fn curve_lengths(shape in curves()) {
        let steps = 4000;
        let point = |step: i32| shape.at(f64::from(step) / f64::from(steps) * shape.length()).position;
        let sum: f64 = (0..steps).map(|step| (point(step + 1) - point(step)).norm()).sum();
        prop_assert!(sum <= shape.length() * (1.0 + 1e-12));
        prop_assert!(sum >= shape.length() * (1.0 - 1e-3), "{} {}", sum, shape.length());
    }
}
