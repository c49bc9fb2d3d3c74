//! Tests of velocity limits on curves, [`LimitCircularVelocities`].

use super::{Error, arc, cut, element, line};
use crate::prepare::{CircularLimits, LimitCircularVelocities};
use crate::{Arc, Cubic, ElementKind, Ellipse, PathElement, Plane, Shape};
use nalgebra::{Point2, Point3, Vector2};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn limit<const N: usize>(elements: [PathElement; N], limits: CircularLimits) -> Vec<PathElement> {
    let elements = elements.into_iter().map(Ok::<_, Error>);
    LimitCircularVelocities::new(elements, limits).map(Result::unwrap).collect()
}

fn close_mm_per_s(velocity: f64, expected: f64) -> bool {
    (velocity * 1e3 - expected).abs() <= 1e-8
}

/// 200 mm/s² on arcs, jumps of 100 mm/s².
const LIMITS: CircularLimits = CircularLimits { acceleration: 0.2, acceleration_jump: 0.1 };

/// Line along +X into counter-clockwise r 50 mm, into `second` of 25 mm, in either sense.
fn vector_path(second: f64) -> [PathElement; 3] {
    let r = 0.05;
    let end_of_first = arc([0.1, r, 0.0], r, -FRAC_PI_2, FRAC_PI_2, 1.0);
    let center = [0.1 + r - second * 0.025, r, 0.0];
    let start_angle = if second > 0.0 { 0.0 } else { PI };
    [
        cut([0.0; 3], [0.1, 0.0, 0.0], 1.0),
        end_of_first,
        arc(center, 0.025, start_angle, second * FRAC_PI_2, 1.0),
    ]
}

#[test]
fn zero_switches_off() {
    for path in [vector_path(1.0), vector_path(-1.0)] {
        assert_eq!(limit(path.clone(), CircularLimits::default()), path);
        let only_arcs = CircularLimits { acceleration_jump: 0.0, ..LIMITS };
        let limited = limit(path.clone(), only_arcs);
        assert!(limited.iter().all(|element| element.end_velocity.is_infinite()));
        assert!(close_mm_per_s(limited[1].feed, 100.0));
        let only_jumps = CircularLimits { acceleration: 0.0, ..LIMITS };
        let limited = limit(path.clone(), only_jumps);
        assert!(limited.iter().zip(&path).all(|(after, before)| after.feed == before.feed));
        assert!(close_mm_per_s(limited[0].end_velocity, 70.710_678_119));
    }
}

#[test]
fn slower_feeds_and_limits_stay() {
    let mut path = vector_path(1.0);
    path[1].feed = 0.01;
    path[0].end_velocity = 0.02;
    let limited = limit(path, LIMITS);
    assert_eq!((limited[1].feed, limited[0].end_velocity), (0.01, 0.02));
}

#[test]
fn no_change_of_curvature() {
    let path = [cut([0.0; 3], [0.1, 0.0, 0.0], 1.0), cut([0.1, 0.0, 0.0], [0.2, 0.0, 0.0], 1.0)];
    assert!(limit(path, LIMITS)[0].end_velocity.is_infinite());
    let path = [arc([0.0; 3], 0.05, 0.0, 1.0, 1.0), arc([0.0; 3], 0.05, 1.0, 1.0, 1.0)];
    assert!(limit(path, LIMITS)[0].end_velocity > 1e3);
}

/// The radius of a helix is that of its projection (`dP3`), as the manual has it.
#[test]
fn helices_and_other_planes() {
    let [a, b, top] = [[0.05, 0.0, 0.0], [0.0, 0.05, 0.0], [-0.05, 0.0, 0.1]].map(Point3::from);
    let helix = Arc::new(a, top, Point3::origin(), PI);
    let upright = Arc::in_plane(Plane::Yz, b, -b, Point3::origin(), PI);
    for shape in [helix, upright] {
        let (transition, feed) = limited_by(Shape::Arc(shape));
        assert!((feed - 100.0).abs() < 1e-8 && (transition - 70.710_678_119).abs() < 1e-8);
    }
}

/// The velocity into a shape, of a line along +X, and on it, mm/s.
fn limited_by(shape: Shape) -> (f64, f64) {
    let start = shape.start();
    let lead = cut([start.x - 0.1, start.y, start.z], start.into(), 1.0);
    let limited = limit([lead, element(ElementKind::Cut, shape, 1.0)], LIMITS);
    (limited[0].end_velocity * 1e3, limited[1].feed * 1e3)
}

/// Curvature of an ellipse: a/b² at the ends of its main axis, b/a² at those of the other.
#[test]
fn ellipses() {
    let (a, b) = (0.05, 0.02);
    let on = |angle: f64| Point3::new(a * angle.cos(), b * angle.sin(), 0.0);
    let ellipse = |from: f64, to: f64| {
        let major = Vector2::new(a, 0.0);
        let ellipse = Ellipse::new(on(from), on(to), Point2::origin(), major, b, to - from);
        Shape::Ellipse(Box::new(ellipse))
    };
    let close = |(transition, feed): (f64, f64), [at_start, largest]: [f64; 2]| {
        let expected = [(0.1 / at_start).sqrt() * 1e3, (0.2 / largest).sqrt() * 1e3];
        (transition - expected[0]).abs() < 1e-5 && (feed - expected[1]).abs() < 1e-5
    };
    let [sharp, blunt] = [a / (b * b), b / (a * a)];
    assert!(close(limited_by(ellipse(FRAC_PI_2, FRAC_PI_2 + TAU)), [blunt, sharp]));
    assert!(close(limited_by(ellipse(0.0, -1.0)), [sharp, sharp]));
    // Of a piece without such an end its own largest, at 1 rad: a·b / (a² sin² + b² cos²)^(3/2).
    let end = a * b / ((a * 1.0_f64.sin()).powi(2) + (b * 1.0_f64.cos()).powi(2)).powf(1.5);
    assert!(close(limited_by(ellipse(FRAC_PI_2, 1.0)), [blunt, end]));
}

/// y = x²/(2p) has the curvature 1/p at its vertex.
#[test]
fn splines() {
    // From −20 to 60 mm with p = 40 mm, tangents meeting at x = 20 mm.
    let (from, to, p) = (-0.02, 0.06, 0.04);
    let y = |x: f64| x * x / (2.0 * p);
    let start = Point3::new(from, y(from), 0.0);
    let control = Point2::new(0.02, from * to / (2.0 * p));
    let parabola = Cubic::parabola(start, control, Point3::new(to, y(to), 0.01));
    let (transition, feed) = limited_by(Shape::Cubic(Box::new(parabola)));
    assert!((feed - (0.2 * p).sqrt() * 1e3).abs() < 1e-5, "{feed}");
    let at_start = (1.0 + (from / p).powi(2)).powf(-1.5) / p;
    assert!((transition - (0.1 / at_start).sqrt() * 1e3).abs() < 1e-5);
}

#[test]
fn rapids_keep_their_feed_and_errors_their_place() {
    let path = vec![
        Err(Error::Upstream(1)),
        Ok(line(ElementKind::Rapid, [0.0; 3], [0.1, 0.0, 0.0], 9.0)),
        Err(Error::Upstream(2)),
        Ok(arc([0.0; 3], 0.05, 0.0, 1.0, 1.0)),
    ];
    let limited: Vec<_> = LimitCircularVelocities::new(path.into_iter(), LIMITS).collect();
    assert_eq!(limited.len(), 4);
    assert_eq!(limited[0], Err(Error::Upstream(1)));
    assert!(limited[1].as_ref().is_ok_and(|rapid| rapid.feed == 9.0));
    assert_eq!(limited[2], Err(Error::Upstream(2)));
    assert!(limited[3].as_ref().is_ok_and(|arc| close_mm_per_s(arc.feed, 100.0)));
}
