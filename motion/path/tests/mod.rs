//! Tests of path elements, their shapes and lengths.

mod curves;
mod derivatives;
mod operations;
mod splines;

use super::{
    Arc, AxisMask, Cubic, Details, ElementKind, Ellipse, ExtraAxes, PathElement, Place, Shape,
};
use nalgebra::{Point2, Point3, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A line between points in mm.
fn line(start: [f64; 3], end: [f64; 3]) -> Shape {
    Shape::Line { start: (Point3::from(start) / 1e3), end: (Point3::from(end) / 1e3) }
}

/// An arc between points in mm.
fn arc(start: [f64; 3], end: [f64; 3], center: [f64; 2], sweep: f64) -> Shape {
    let [x, y] = center;
    Shape::Arc(Arc::new(
        Point3::from(start) / 1e3,
        Point3::from(end) / 1e3,
        Point3::new(x, y, 0.0) / 1e3,
        sweep,
    ))
}

fn ellipse(ellipse: Ellipse) -> Shape {
    Shape::Ellipse(Box::new(ellipse))
}

fn cubic(cubic: Cubic) -> Shape {
    Shape::Cubic(Box::new(cubic))
}

fn element(shape: Shape) -> PathElement {
    PathElement::new(Place { block: Some(30), ..Place::at(3) }, ElementKind::Cut, shape)
}

fn detailed(shape: Shape, details: Details) -> PathElement {
    PathElement { details: Some(Box::new(details)), ..element(shape) }
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-8, "{found}, expected {expected}");
}

#[track_caller]
fn assert_mm(found: Point3<f64>, x: f64, y: f64, z: f64) {
    assert!((found * 1e3 - Point3::new(x, y, z)).norm() < 1e-8, "{found}, expected {x} {y} {z}");
}

#[test]
fn space_diagonal() {
    let shape = line([1.0, 2.0, 3.0], [3.0, 5.0, 9.0]);
    near(shape.length() * 1e3, 7.0);
    assert_mm(shape.at(shape.length() / 2.0).position, 2.0, 3.5, 6.0);
    assert!((shape.start_tangent() - Vector3::new(2.0, 3.0, 6.0) / 7.0).norm() < 1e-12);
    for s in [0.0, 0.001, 0.002, 0.007] {
        let point = shape.at(s);
        assert_eq!([point.curvature, point.curvature_rate], [Vector3::zeros(); 2]);
        assert_eq!(shape.fourth_at(s), Vector2::zeros());
    }
}

#[test]
fn without_length() {
    for shape in [
        line([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),
        arc([1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [1.0, 2.0], TAU),
    ] {
        assert!(shape.length() == 0.0);
        assert_eq!(shape.at(0.0).position, Point3::new(1.0, 2.0, 3.0) / 1e3);
        assert_eq!([shape.start_tangent(), shape.end_tangent()], [Vector3::zeros(); 2]);
    }
    // A jump has none.
    let shape = line([0.0; 3], [1.0, 0.0, 0.0]);
    let of = |kind| PathElement { kind, ..element(shape.clone()) }.length();
    assert!(of(ElementKind::Jump) == 0.0);
    assert!((of(ElementKind::Rapid) - 1e-3).abs() < 1e-18);
}

/// Arcs as real programs have them: the end is up to 5 µm off the circle.
fn arcs() -> impl Strategy<Value = Arc> {
    let sweep = prop_oneof![-TAU..-0.01, 0.01..TAU, Just(TAU), Just(-TAU)];
    let center = [-1.0..1.0, -1.0..1.0, 0.0..1e-9];
    (center, 1e-4..2.0, -PI..PI, sweep, -0.1..0.1, -1.0..1.0).prop_map(
        |(center, radius, start_angle, sweep, rise, error)| {
            let center = Point3::from(center);
            let on = |angle: f64, radius: f64, z| {
                center + Vector3::new(angle.cos() * radius, angle.sin() * radius, z)
            };
            // Of what the decoder lets pass, 5 µm, no more than would matter here for the smallest radii.
            let off = error * 5e-6_f64.min(radius * sweep.abs() * 1e-3);
            Arc::new(
                on(start_angle, radius, 0.0),
                on(start_angle + sweep, radius + off, rise),
                center,
                sweep,
            )
        },
    )
}

fn cubics() -> impl Strategy<Value = Shape> {
    let point = || [-0.3..0.3, -0.3..0.3, -0.1..0.1_f64].prop_map(Point3::from);
    let vector = || [-0.5..0.5, -0.5..0.5_f64].prop_map(Vector2::from);
    (point(), point(), vector(), vector())
        .prop_map(|(start, end, from, to)| cubic(Cubic::hermite(start, end, from, to)))
}

fn shapes() -> impl Strategy<Value = Shape> {
    let point = || [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64].prop_map(Point3::from);
    prop_oneof![
        arcs().prop_map(Shape::Arc),
        (point(), point()).prop_map(|(start, end)| Shape::Line { start, end }),
    ]
}

proptest! {
    #[test]
    fn ends_are_exact(shape in shapes()) {
        prop_assert_eq!(shape.at(0.0).position, shape.start());
        prop_assert_eq!(shape.at(shape.length()).position, shape.end());
    }

    /// No step at the exact ends: the formula in between leads there.
    #[test]
    fn ends_are_approached(shape in shapes()) {
        let (length, near) = (shape.length(), 1e-9);
        let from_start = shape.at(length * near).position - shape.start();
        let to_end = shape.end() - shape.at(length * (1.0 - near)).position;
        prop_assert!((from_start - shape.start_tangent() * length * near).norm() < 1e-12);
        prop_assert!((to_end - shape.end_tangent() * length * near).norm() < 1e-12);
    }

    /// The tangent is the derivative of the position and of unit length, the curvature the derivative of the tangent.
    #[test]
    fn derivatives_are_differences(shape in shapes(), at in 0.01..0.99) {
        let length = shape.length();
        let (s, h) = (at * length, 1e-3 * length);
        let [before, here, after] = [s - h, s, s + h].map(|s| shape.at(s));
        let velocity = (after.position - before.position) / (2.0 * h);
        // Each further derivative brings another factor of the turn per length; the first has at most length 1.
        let turn = match &shape {
            Shape::Arc(arc) => arc.sweep() / length,
            _ => 0.0,
        };
        let scale = turn.abs() * h;
        prop_assert!((velocity - here.tangent).norm() <= scale * scale + 1e-9, "{velocity} {here:?}");
        let turning = (after.tangent - before.tangent) * 0.5;
        prop_assert!((turning - here.curvature * h).norm() <= scale * scale + 1e-12, "{turning} {here:?}");
        // Where the two radii differ the speed differs by no more than they do.
        let uneven = match &shape {
            Shape::Arc(arc) => (arc.end_radius() / arc.radius() - 1.0).abs(),
            _ => 0.0,
        };
        prop_assert!((here.tangent.norm() - 1.0).abs() <= uneven + 1e-12, "{here:?}");
    }

    #[test]
    fn unit_tangent_on_true_circles(start in [-1.0..1.0, -1.0..1.0, -1.0..1.0], half in [0.01..1.0, -1.0..1.0], rise in -1.0..1.0, at in 0.0..1.0) {
        let start = Point3::from(start);
        let half = Vector3::new(half[0], half[1], 0.0);
        let arc = Arc::new(start, start + half * 2.0 + Vector3::z() * rise, start + half, PI);
        let shape = Shape::Arc(arc);
        prop_assert!((shape.at(at * shape.length()).tangent.norm() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn arcs_stay_on_their_radius(arc in arcs(), at in 0.0..=1.0_f64) {
        let shape = Shape::Arc(arc.clone());
        let position = shape.at(at * shape.length()).position;
        let distance = (position - arc.center()).xy().norm();
        let (least, most) = (arc.radius().min(arc.end_radius()), arc.radius().max(arc.end_radius()));
        prop_assert!(distance >= least - 1e-14 && distance <= most + 1e-14);
        let height = position.z - arc.start().z;
        prop_assert!((height - at * arc.rise()).abs() < 1e-14);
    }
}
