//! Tests of the third and fourth derivative of the position by path length.

use super::*;
use crate::{Cubic, Ellipse, PathPoint, Plane};
use nalgebra::{Point2, Vector2};

/// Weights of the central difference of eighth order.
const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];

/// The derivative of the curvature at `s`, m, by differences over `h`, m.
fn difference(at: impl Fn(f64) -> PathPoint, s: f64, h: f64) -> Vector3<f64> {
    let mut sum = Vector3::zeros();
    for (weight, step) in WEIGHTS.iter().zip(1..) {
        let by = h * f64::from(step);
        sum += (at(s + by).curvature - at(s - by).curvature) * *weight;
    }
    sum / h
}

/// Over the whole shape but its ends.
#[track_caller]
fn assert_by_differences(name: &str, shape: &Shape) {
    let length = shape.length();
    let whole = (5..96).map(|part| shape.at(f64::from(part) * 1e-2 * length).curvature_rate.norm());
    let most = whole.fold(0.0, f64::max);
    assert!(most > 0.0, "{name}");
    assert_fourth(name, shape);
    for part in 5..96 {
        let s = f64::from(part) * 1e-2 * length;
        let expected = difference(|s| shape.at(s), s, 2e-3 * length);
        let found = shape.at(s).curvature_rate;
        assert!((found - expected).norm() < 1e-8 * most, "{name} at {part} %: {found} {expected}");
    }
}

/// The fourth derivative of X and Y, by differences of the third.
#[track_caller]
fn assert_fourth(name: &str, shape: &Shape) {
    let length = shape.length();
    let whole = (5..96).map(|part| shape.fourth_at(f64::from(part) * 1e-2 * length).norm());
    let most = whole.fold(0.0, f64::max);
    assert!(most > 0.0, "{name}");
    for part in 5..96 {
        let s = f64::from(part) * 1e-2 * length;
        let h = 2e-3 * length;
        let mut expected = Vector3::zeros();
        for (weight, step) in WEIGHTS.iter().zip(1..) {
            let by = h * f64::from(step);
            let [right, left] = [s + by, s - by].map(|s| shape.at(s).curvature_rate);
            expected += (right - left) * (*weight / h);
        }
        let found = shape.fourth_at(s);
        let off = (found - expected.xy()).norm();
        assert!(off < 1e-7 * most, "{name} at {part} %: {found} {expected}");
    }
}

#[test]
fn none_on_lines() {
    let shape = line([1.0, 2.0, 3.0], [4.0, -5.0, 6.0]);
    for part in [0.0, 0.3, 1.0] {
        assert_eq!(shape.at(part * shape.length()).curvature_rate, Vector3::zeros());
        assert_eq!(shape.fourth_at(part * shape.length()), Vector2::zeros());
    }
}

/// x‴ = −κ²·x′ on a circle; on a helix so for the part around, whose turn per length is φ/L.
#[test]
fn circles_and_helices() {
    for rise in [0.0, 30.0] {
        for sweep in [-1.5 * PI, 0.5 * PI] {
            let end = [20.0 * sweep.cos(), 20.0 * sweep.sin(), rise];
            let shape = arc([20.0, 0.0, 0.0], end, [0.0, 0.0], sweep);
            let turn = sweep / (0.02 * sweep).hypot(1e-3 * rise);
            for part in [0.0, 0.25, 0.6, 1.0] {
                let point = shape.at(part * shape.length());
                let around = Vector3::new(point.tangent.x, point.tangent.y, 0.0);
                let expected = around * (-turn * turn);
                assert!((point.curvature_rate - expected).norm() < 1e-9 * expected.norm());
            }
        }
    }
}

/// In every plane, with a radius that grows much more than by rounding.
#[test]
fn arcs_whose_radius_grows() {
    for plane in [Plane::Xy, Plane::Zx, Plane::Yz] {
        let [start, end, center] =
            [[0.02, 0.0, 0.0], [0.0, 0.03, 0.005], [0.0; 3]].map(|at| Point3::from(plane.join(at)));
        let shape = Shape::Arc(Arc::in_plane(plane, start, end, center, 2.5 * PI));
        assert_by_differences("arc", &shape);
    }
}

#[test]
fn ellipses_parabolas_and_cubics() {
    let at = |angle: f64, size: f64, z: f64| {
        Point3::new(0.02 * angle.cos() * size, 0.01 * angle.sin() * size, z)
    };
    for (growth, rise) in [(1.0, 0.0), (1.0, 0.02), (1.2, 0.01)] {
        for sweep in [2.5, -4.0] {
            let (start, end) = (at(0.4, 1.0, 0.0), at(0.4 + sweep, growth, rise));
            let made = Ellipse::new(start, end, Point2::origin(), Vector2::x() * 0.02, 0.01, sweep);
            assert_by_differences("ellipse", &Shape::Ellipse(Box::new(made)));
        }
    }
    let (start, end) = (Point3::origin(), Point3::new(0.1, 0.0, 0.03));
    let parabola = Cubic::parabola(start, Point2::new(0.05, 0.05), end);
    assert_by_differences("parabola", &Shape::Cubic(Box::new(parabola)));
    let cubic = Cubic::hermite(start, end, Vector2::new(0.1, 0.06), Vector2::new(0.12, 0.05));
    assert_by_differences("cubic", &Shape::Cubic(Box::new(cubic)));
}

/// y = x²/2p with s(x) of the parabola: κ = p²/(p² + x²)^{3/2}, so dκ/ds = −3·x·p³/(p² + x²)³
/// across the path, and −κ² along it.
#[test]
fn parabola_in_closed_form() {
    let p = 0.04_f64;
    let y = |x: f64| x * x / (2.0 * p);
    let (from, to) = (-0.03, 0.06);
    // The tangents of two points of a parabola meet half-way between them in x.
    let control = Point2::new(f64::midpoint(from, to), from * to / (2.0 * p));
    let made =
        Cubic::parabola(Point3::new(from, y(from), 0.0), control, Point3::new(to, y(to), 0.0));
    for part in [0.0, 0.2, 0.5, 0.9, 1.0] {
        let point = made.at(part * made.length());
        let x = point.position.x;
        let slope = p * p + x * x;
        let (curvature, rate) = (p * p / slope.powf(1.5), -3.0 * x * p.powi(3) / slope.powi(3));
        let along = Vector3::new(p, x, 0.0) / slope.sqrt();
        let across = Vector3::new(-along.y, along.x, 0.0);
        let expected = across * rate - along * (curvature * curvature);
        assert!((point.curvature - across * curvature).norm() < 1e-9 * curvature);
        let error = (point.curvature_rate - expected).norm();
        assert!(error < 1e-9 / (p * p), "{error}");
    }
}

/// z = Z·(10w³ − 15w⁴ + 6w⁵): the third derivative is 60·Z/L³·(1 − 6w + 6w²), also at the ends.
#[test]
fn z_with_the_s_profile() {
    let shape = line([0.0; 3], [40.0, 0.0, 30.0]);
    let mut element = PathElement::new(Place::default(), ElementKind::Cut, shape);
    element.details = Some(Box::new(Details { s_profile: AxisMask::Z, ..Details::default() }));
    for (part, factor) in [(0.0, 1.0), (0.1, 0.46), (0.5, -0.5), (0.9, 0.46), (1.0, 1.0)] {
        let found = element.at(part * 0.05).curvature_rate;
        let expected = 60.0 * 0.03 / 0.05_f64.powi(3) * factor;
        assert!((found.z - expected).abs() < 1e-9 * expected.abs(), "{found}");
        assert_eq!(found.xy(), Vector2::zeros());
    }
    for part in [0.1, 0.5, 0.8] {
        let (s, found) = (part * 0.05, element.at(part * 0.05).curvature_rate);
        let expected = difference(|s| element.at(s), s, 5e-4);
        assert!((found - expected).norm() < 1e-8 * expected.norm());
    }
}

/// The same for an extra axis, next to one that moves linearly.
#[test]
fn extra_axes() {
    let shape = line([0.0; 3], [50.0, 0.0, 0.0]);
    let mut element = PathElement::new(Place::default(), ElementKind::Cut, shape);
    let extra = ExtraAxes { start: [1.0; 5], end: [4.0, 5.0, 1.0, 1.0, 1.0] };
    let s_profile = AxisMask::extra(0);
    element.details =
        Some(Box::new(Details { extra: Some(extra), s_profile, ..Details::default() }));
    for (part, factor) in [(0.0, 1.0), (0.1, 0.46), (0.5, -0.5), (0.9, 0.46), (1.0, 1.0)] {
        let [p, others @ ..] = element.extra_at(part * 0.05).unwrap().third;
        let expected = 60.0 * 3.0 / 0.05_f64.powi(3) * factor;
        assert!((p - expected).abs() < 1e-9 * expected.abs(), "{p}");
        assert!(others.iter().all(|third| third.abs() < 1e-300), "{others:?}");
    }
}

/// Elements of which a queue file may speak.
#[test]
fn absurd_elements_have_none() {
    for size in [1e-60, 1e-100, 1e-120, 1e-155, 1e-200, 1e-300] {
        let [start, end] = [0.0, size].map(|x| Point3::new(x, 0.0, 0.5 * x));
        let middle = Point2::new(0.5 * size, size);
        let shapes = [
            Shape::Line { start, end },
            Shape::Arc(Arc::new(start, end, Point3::new(0.5 * size, 0.0, 0.0), PI)),
            Shape::Cubic(Box::new(Cubic::parabola(start, middle, end))),
            Shape::Ellipse(Box::new(Ellipse::new(
                start,
                end,
                Point2::new(0.5 * size, 0.0),
                Vector2::x() * (0.5 * size),
                0.2 * size,
                PI,
            ))),
        ];
        for shape in shapes {
            let mut element = PathElement::new(Place::default(), ElementKind::Cut, shape);
            for s_profile in [AxisMask::default(), AxisMask::Z] {
                element.details = Some(Box::new(Details { s_profile, ..Details::default() }));
                for part in [0.0, 0.3, 1.0] {
                    let point = element.at(part * element.length());
                    assert!(
                        point.curvature_rate.iter().all(|value| value.is_finite()),
                        "{point:?}"
                    );
                }
            }
        }
    }
}
