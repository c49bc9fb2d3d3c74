//! Tests of ellipses and cubics, and of extra axes along a path.

#![expect(clippy::float_cmp, reason = "exact at the ends, or halves")]

use super::*;
use crate::{
    AxisMask, Cubic, Details, Ellipse, EllipseError, ExtraAxes, cardinal_tangent, end_tangent,
};
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

/// Vector `cnc-ellipse-G8`: manual 3.2.5; R is used, since start and end are alike in the axes of the ellipse.
#[test]
fn ellipse_by_ratio() {
    let direction = 45f64.to_radians();
    let made = Ellipse::through(
        mm(100.0, 100.0),
        mm(200.0, 100.0),
        Point2::new(0.15, 0.1),
        direction,
        Some(0.5),
        true,
    )
    .unwrap();
    near(made.major().x * 1e3, 55.901_699_437);
    near(made.major().y * 1e3, 55.901_699_437);
    near(made.major().norm() * 1e3, 79.056_941_504);
    near(made.minor() * 1e3, 39.528_470_752);
    near(made.start_angle().to_degrees(), 116.565_051_177);
    near(made.sweep().to_degrees(), -180.0);
    near(made.length() * 1e3, 191.484_771_06);
    // The middle of the angle; of the length it is, too, as the arc is symmetric about the centre: no, an ellipse is
    // symmetric under a half turn, so the first quarter of the angle is as long as the third, not as the second.
    let shape = ellipse(made);
    let middle = Point2::new(0.1875, 0.1625);
    let nearest = (0..=20_000)
        .map(|step| f64::from(step) / 20_000.0 * shape.length())
        .map(|s| (shape.at(s).position.xy() - middle).norm())
        .fold(f64::INFINITY, f64::min);
    assert!(nearest < 1e-5, "{nearest}");
}

/// Vector `cnc-ellipse-G9`: a quarter, 20 by 10.
#[test]
fn quarter_of_an_ellipse() {
    let made =
        Ellipse::through(mm(20.0, 0.0), mm(0.0, 10.0), Point2::origin(), 0.0, Some(0.5), false)
            .unwrap();
    near(made.major().x * 1e3, 20.0);
    near(made.minor() * 1e3, 10.0);
    near(made.sweep().to_degrees(), 90.0);
    near(made.length() * 1e3, 24.221_120_551);
    assert_at(&ellipse(made), 0.5, [11.889_437_83, 8.041_163_91, 0.0]);
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

/// Vector `cnc-parabola`.
#[test]
fn parabola() {
    let made = Cubic::parabola(mm(0.0, 0.0), Point2::new(0.05, 0.1), mm(100.0, 0.0));
    assert!(made.is_parabola());
    for (found, expected) in made.x().iter().zip([0.0, 0.1, 0.0, 0.0]) {
        near(*found, expected);
    }
    for (found, expected) in made.y().iter().zip([0.0, 0.2, -0.2, 0.0]) {
        near(*found, expected);
    }
    near(made.length() * 1e3, 147.894_285_754);
    assert_at(&cubic(made), 0.5, [50.0, 50.0, 0.0]);
}

/// The point at the parameter t.
fn at_parameter(cubic: &Cubic, t: f64) -> Point2<f64> {
    let value = |[a, b, c, d]: [f64; 4]| a + t * (b + t * (c + t * d));
    Point2::new(value(cubic.x()), value(cubic.y())) * 1e3
}

#[track_caller]
fn assert_point(found: Point2<f64>, x: f64, y: f64) {
    assert!((found - Point2::new(x, y)).norm() < 1e-8, "{found}, expected {x} {y}");
}

/// Vector `cnc-spline-stairs`.
#[test]
fn spline_over_stairs() {
    let points =
        [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (40.0, 20.0), (40.0, 40.0)].map(|(x, y)| mm(x, y));
    let inner = |i: usize| cardinal_tangent(points[i - 1].xy(), points[i + 1].xy());
    let chord = |i: usize| end_tangent((points[i + 1] - points[i]).xy(), None);
    let first = Cubic::hermite(points[0], points[1], chord(0), inner(1));
    assert_point(at_parameter(&first, 0.5), 11.25, -1.25);
    let second = Cubic::hermite(points[1], points[2], inner(1), inner(2));
    for (found, expected) in second.x().iter().zip([20.0, 10.0, -30.0, 20.0]) {
        near(found * 1e3, expected);
    }
    for (found, expected) in second.y().iter().zip([0.0, 10.0, 30.0, -20.0]) {
        near(found * 1e3, expected);
    }
    assert_point(at_parameter(&second, 0.5), 20.0, 10.0);
    near(second.length() * 1e3, 20.608_482_053);
    let last = Cubic::hermite(points[3], points[4], inner(3), chord(3));
    assert_point(at_parameter(&last, 0.5), 41.25, 28.75);
}

/// Vector `cnc-spline-between-lines`.
#[test]
fn spline_between_lines() {
    let [a, b, c] = [mm(5.0, 0.0), mm(20.0, 0.0), mm(20.0, 20.0)];
    let middle = cardinal_tangent(a.xy(), c.xy());
    let first = Cubic::hermite(a, b, end_tangent((b - a).xy(), Some(Vector2::x())), middle);
    assert_point(at_parameter(&first, 0.5), 13.4375, -1.25);
    near(first.length() * 1e3, 15.547_492_284);
    let second = Cubic::hermite(b, c, middle, end_tangent((c - b).xy(), Some(Vector2::y())));
    assert_point(at_parameter(&second, 0.5), 20.9375, 8.75);
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

/// Vector `cnc-S-profile`, and the same axis without it.
#[test]
fn extra_axes_go_along() {
    let mut element =
        PathElement::new(Place::default(), ElementKind::Cut, line([0.0; 3], [100.0, 0.0, 0.0]));
    assert!(element.extra_at(0.0).is_none());
    let extra = ExtraAxes { start: [0.0; 5], end: [40.0, 0.0, 0.0, 0.0, 0.0] };
    let mut details = Details { extra: Some(extra), ..Details::default() };
    element.details = Some(Box::new(details.clone()));
    let p = |element: &PathElement, mm: f64| element.extra_at(mm / 1e3).unwrap().position[0];
    near(p(&element, 25.0), 10.0);
    near(p(&element, 50.0), 20.0);
    details.s_profile = AxisMask::from_s_number(7).unwrap();
    element.details = Some(Box::new(details));
    near(p(&element, 25.0), 4.140_625);
    near(p(&element, 50.0), 20.0);
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
