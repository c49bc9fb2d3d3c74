//! Tests of the third and fourth derivative of the position by path length.

use super::*;
use crate::Plane;
use nalgebra::SVector;

/// Weights of the central difference of eighth order.
const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];

/// The derivative of `of` at `s`, m, by differences over `h`, m.
fn difference<const N: usize>(
    of: impl Fn(f64) -> SVector<f64, N>,
    s: f64,
    h: f64,
) -> SVector<f64, N> {
    let mut sum = SVector::zeros();
    for (weight, step) in WEIGHTS.iter().zip(1..) {
        let by = h * f64::from(step);
        sum += (of(s + by) - of(s - by)) * *weight;
    }
    sum / h
}

/// Over the whole length but its ends `found` is the derivative of `of`, to a part of its largest.
#[track_caller]
fn assert_derivative<const N: usize>(
    name: &str,
    length: f64,
    found: impl Fn(f64) -> SVector<f64, N>,
    of: impl Fn(f64) -> SVector<f64, N>,
    tolerance: f64,
) {
    let places = (5..96).map(|part| f64::from(part) * 1e-2 * length);
    let most = places.clone().map(|s| found(s).norm()).fold(0.0, f64::max);
    assert!(most > 0.0, "{name}");
    for s in places {
        let (found, expected) = (found(s), difference(&of, s, 2e-3 * length));
        let off = (found - expected).norm();
        assert!(off < tolerance * most, "{name} at {s} of {length} m: {found} {expected}");
    }
}

/// The third derivative, and the fourth of X and Y.
#[track_caller]
fn assert_by_differences(name: &str, shape: &Shape) {
    let (length, third) = (shape.length(), |s| shape.at(s).curvature_rate);
    assert_derivative(name, length, third, |s| shape.at(s).curvature, 1e-8);
    assert_derivative(name, length, |s| shape.fourth_at(s), |s| third(s).xy(), 1e-7);
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
            assert_by_differences("ellipse", &ellipse(made));
        }
    }
    let (start, end) = (Point3::origin(), Point3::new(0.1, 0.0, 0.03));
    let parabola = Cubic::parabola(start, Point2::new(0.05, 0.05), end);
    assert_by_differences("parabola", &cubic(parabola));
    let hermite = Cubic::hermite(start, end, Vector2::new(0.1, 0.06), Vector2::new(0.12, 0.05));
    assert_by_differences("cubic", &cubic(hermite));
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

/// The factors of the third derivative, of z = Z·(10w³ − 15w⁴ + 6w⁵): it is 60·Z/L³·(1 − 6w + 6w²), also at the ends.
const S_PROFILE: [(f64, f64); 5] = [(0.0, 1.0), (0.1, 0.46), (0.5, -0.5), (0.9, 0.46), (1.0, 1.0)];

/// It leaves and arrives level.
#[test]
fn z_with_the_s_profile() {
    let details = Details { s_profile: AxisMask::Z, ..Details::default() };
    let element = detailed(line([0.0; 3], [40.0, 0.0, 30.0]), details);
    for (part, factor) in S_PROFILE {
        let found = element.at(part * 0.05).curvature_rate;
        let expected = 60.0 * 0.03 / 0.05_f64.powi(3) * factor;
        assert!((found.z - expected).abs() < 1e-9 * expected.abs(), "{found}");
        assert_eq!(found.xy(), Vector2::zeros());
    }
    for s in [0.005, 0.025, 0.04] {
        let found = element.at(s).curvature_rate;
        let expected = difference(|s| element.at(s).curvature, s, 5e-4);
        assert!((found - expected).norm() < 1e-8 * expected.norm());
    }
    assert_eq!((element.start_tangent().z, element.end_tangent().z), (0.0, 0.0));
    near(element.at(0.0125).position.z * 1e3, 30.0 * 0.103_515_625);
    near(element.at(0.05).position.z * 1e3, 30.0);
}

/// The same for an extra axis (that of vector `cnc-S-profile`), next to one that moves linearly.
#[test]
fn extra_axes() {
    let shape = || line([0.0; 3], [50.0, 0.0, 0.0]);
    assert!(element(shape()).extra_at(0.0).is_none());
    let extra = Some(ExtraAxes { start: [1.0; 5], end: [4.0, 5.0, 1.0, 1.0, 1.0] });
    let s_profile = AxisMask::from_s_number(7).unwrap();
    let element = detailed(shape(), Details { extra, s_profile, ..Details::default() });
    for (part, factor) in S_PROFILE {
        let [p, others @ ..] = element.extra_at(part * 0.05).unwrap().third;
        let expected = 60.0 * 3.0 / 0.05_f64.powi(3) * factor;
        assert!((p - expected).abs() < 1e-9 * expected.abs(), "{p}");
        assert!(others.iter().all(|third| third.abs() < 1e-300), "{others:?}");
    }
    for end in [0.0, 0.05] {
        let at = element.extra_at(end).unwrap();
        assert_eq!((at.first[0], at.second[0]), (0.0, 0.0));
    }
    let at = |s| element.extra_at(s).unwrap();
    let slope: SVector<_, 5> = difference(|s| at(s).position.into(), 0.015, 5e-6);
    let bend: SVector<_, 5> = difference(|s| at(s).first.into(), 0.015, 5e-6);
    for (found, expected) in [(at(0.015).first, slope), (at(0.015).second, bend)] {
        assert!((found[0] - expected[0]).abs() < 1e-4 * expected[0].abs(), "{found:?} {expected}");
    }
}

/// Elements of which a queue file may speak (found by fuzzing): their derivatives were NaN.
#[test]
fn elements_too_small_for_derivatives_have_none() {
    let sizes = [1e-60, 1e-100, 1e-120, 1e-155, 1e-200, 1e-300].map(|size| (size, 0.5 * size));
    let extra = Some(ExtraAxes { start: [0.0; 5], end: [1.0, 2.0, 0.0, 0.0, 0.0] });
    let both = AxisMask(AxisMask::Z.0 | AxisMask::extra(0).0);
    for (size, rise) in [(1e-161, 1e-313)].into_iter().chain(sizes) {
        let [start, end] = [Point3::origin(), Point3::new(0.0, size, rise)];
        let [center, apex] = [0.0, size].map(|x| Point2::new(x, 0.5 * size));
        let major = Vector2::y() * (0.5 * size);
        for shape in [
            Shape::Line { start, end },
            Shape::Arc(Arc::new(start, end, center.coords.push(0.0).into(), PI)),
            cubic(Cubic::parabola(start, apex, end)),
            ellipse(Ellipse::new(start, end, center, major, 0.2 * size, PI)),
        ] {
            assert!(shape.length() > 0.0 || size < 1e-161, "{shape:?}");
            for (s_profile, extra) in [(AxisMask(0), None), (AxisMask::Z, None), (both, extra)] {
                let details = Details { extra, s_profile, ..Details::default() };
                let element = detailed(shape.clone(), details);
                for part in [0.0, 0.25, 0.3, 0.5, 1.0] {
                    let point = element.at(part * shape.length());
                    let derivatives = [point.tangent, point.curvature, point.curvature_rate];
                    assert!(derivatives.iter().flatten().all(|d| d.is_finite()), "{point:?}");
                    let Some(extra) = element.extra_at(part * shape.length()) else { continue };
                    let derivatives = [extra.first, extra.second, extra.third];
                    assert!(derivatives.iter().flatten().all(|d| d.is_finite()), "{extra:?}");
                }
            }
        }
    }
}
