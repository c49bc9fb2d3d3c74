//! Tests of ellipses and cubics, and of extra axes along a path.

#![expect(clippy::float_cmp, reason = "exact at the ends, or halves")]

use super::*;
use crate::{AxisMask, Cubic, Details, Ellipse, EllipseError, ExtraAxes};
use nalgebra::{Point2, Vector2};

fn mm(x: f64, y: f64) -> Point3<f64> {
    Point3::new(x, y, 0.0) / 1e3
}

fn ellipse(ellipse: Ellipse) -> Shape {
    Shape::Ellipse(Box::new(ellipse))
}

fn cubic(cubic: Cubic) -> Shape {
    Shape::Cubic(Box::new(cubic))
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-8, "{found}, expected {expected}");
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
    let made =
        Ellipse::through(mm(30.0, 0.0), mm(30.0, 0.0), Point2::origin(), 0.0, Some(0.8), true)
            .unwrap();
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
    let flat = Ellipse::new(
        mm(10.0, 0.0),
        mm(-10.0, 0.0),
        Point2::origin(),
        Vector2::x() / 100.0,
        0.0,
        PI,
    );
    let upright = Cubic::hermite(point, point + Vector3::z(), Vector2::zeros(), Vector2::zeros());
    near(cusp.length(), 0.01);
    near(there_and_back.length(), 0.02);
    near(flat.length(), 0.02);
    near(upright.length(), 1.0);
    for shape in [cubic(still), cubic(cusp), cubic(there_and_back), ellipse(flat), cubic(upright)] {
        for part in [0.0, 1e-12, 0.3, 0.5, 0.7, 1.0 - 1e-12, 1.0] {
            let at = shape.at(part * shape.length());
            let numbers = [at.position.coords, at.tangent, at.curvature, at.curvature_rate];
            assert!(numbers.iter().flatten().all(|number| number.is_finite()), "{at:?}");
            assert!(at.tangent.norm() < 1.0 + 1e-9, "{at:?}");
        }
    }
}

/// The axis of vector `cnc-S-profile`.
#[test]
fn extra_axes_go_along() {
    let mut element =
        PathElement::new(Place::default(), ElementKind::Cut, line([0.0; 3], [100.0, 0.0, 0.0]));
    assert!(element.extra_at(0.0).is_none());
    let extra = Some(ExtraAxes { start: [0.0; 5], end: [40.0, 0.0, 0.0, 0.0, 0.0] });
    let s_profile = AxisMask::from_s_number(7).unwrap();
    element.details = Some(Box::new(Details { extra, s_profile, ..Details::default() }));
    for end in [0.0, 0.1] {
        let at = element.extra_at(end).unwrap();
        assert_eq!((at.first[0], at.second[0]), (0.0, 0.0));
    }
    // Derivatives are those of the polynomial.
    let h = 1e-5;
    let [before, here, after] = [0.03 - h, 0.03, 0.03 + h].map(|s| element.extra_at(s).unwrap());
    let slope = (after.position[0] - before.position[0]) / (2.0 * h);
    assert!((slope - here.first[0]).abs() < 1e-4 * slope.abs());
    let bend = (after.first[0] - before.first[0]) / (2.0 * h);
    assert!((bend - here.second[0]).abs() < 1e-4 * bend.abs());
}

#[test]
fn extra_axes_alone_have_a_length_of_their_own() {
    let mut element =
        PathElement::new(Place::default(), ElementKind::Cut, line([0.0; 3], [0.0; 3]));
    let extra = ExtraAxes { start: [0.0; 5], end: [3.0, 0.0, 4.0, 0.0, 0.0] };
    element.details = Some(Box::new(Details { extra: Some(extra), ..Details::default() }));
    near(element.length(), 0.005);
    let middle = element.extra_at(0.0025).unwrap();
    assert_eq!(middle.position, [1.5, 0.0, 2.0, 0.0, 0.0]);
    assert_eq!(element.start_tangent(), Vector3::zeros());
}

/// Z with the S profile leaves and arrives level.
#[test]
fn z_with_the_s_profile() {
    let mut element =
        PathElement::new(Place::default(), ElementKind::Cut, line([0.0; 3], [40.0, 0.0, 30.0]));
    element.details = Some(Box::new(Details { s_profile: AxisMask::Z, ..Details::default() }));
    assert_eq!(element.start_tangent().z, 0.0);
    assert_eq!(element.end_tangent().z, 0.0);
    near(element.at(0.0125).position.z * 1e3, 30.0 * 0.103_515_625);
    near(element.at(0.05).position.z * 1e3, 30.0);
}

fn curves() -> impl Strategy<Value = Shape> {
    let point = || [-0.3..0.3, -0.3..0.3, -0.1..0.1_f64].prop_map(Point3::from);
    let vector = || [-0.5..0.5, -0.5..0.5_f64].prop_map(Vector2::from);
    let arcs = (point(), 0.01..0.3, 0.05..1.0, -PI..PI, -PI..PI, -TAU..TAU, -0.1..0.1)
        .prop_filter_map(
            "turns",
            |(center, a, ratio, direction, from, sweep, rise): (
                Point3<f64>,
                f64,
                f64,
                f64,
                f64,
                f64,
                f64,
            )| {
                let (major, minor) =
                    (Vector2::new(f64::cos(direction), f64::sin(direction)) * a, a * ratio);
                let side = Vector2::new(-major.y, major.x) * ratio;
                let on = |angle: f64, z| {
                    let flat = center.xy() + major * angle.cos() + side * angle.sin();
                    Point3::new(flat.x, flat.y, z)
                };
                (sweep.abs() > 0.05).then(|| {
                    let (start, end) = (on(from, center.z), on(from + sweep, center.z + rise));
                    ellipse(Ellipse::new(start, end, center.xy(), major, minor, sweep))
                })
            },
        );
    let cubics = (point(), point(), vector(), vector())
        .prop_map(|(start, end, from, to)| cubic(Cubic::hermite(start, end, from, to)));
    prop_oneof![arcs, cubics]
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
