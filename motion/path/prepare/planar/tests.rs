//! Tests of intersections, distances and biarcs, against closed forms and dense samples.

use super::{Crossing, Curve, Round, crossings, distance, fit};
use crate::{Cubic, Ellipse, Shape};
use nalgebra::{Point2, Point3, Vector2};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn line(start: [f64; 2], end: [f64; 2]) -> Curve {
    Curve::Line { start: start.into(), end: end.into() }
}

fn arc(center: [f64; 2], radius: f64, start_angle: f64, sweep: f64) -> Curve {
    let center = Point2::from(center);
    let on = |angle: f64| center + Vector2::new(angle.cos(), angle.sin()) * radius;
    Curve::Arc(Round::new(on(start_angle), on(start_angle + sweep), center, sweep))
}

/// The points of the crossings, in order of the parameter on the first.
fn points(a: &Curve, b: &Curve) -> Vec<[f64; 2]> {
    let mut found = crossings(a, b);
    found.sort_by(|a, b| a.u.total_cmp(&b.u));
    for Crossing { u, v } in &found {
        assert!((a.at(*u) - b.at(*v)).norm() < 1e-9);
    }
    let places = found.iter().map(|crossing| a.at(crossing.u));
    places.map(|point| [point.x, point.y].map(|x| (x * 1e9).round() / 1e9 + 0.0)).collect()
}

#[test]
fn lines_and_arcs_cross() {
    let diagonal = || line([0.0, 0.0], [2.0, 2.0]);
    let high = |y: f64| line([-6.0, y], [6.0, y]);
    let circle = |x: f64, start_angle: f64| arc([x, 0.0], 5.0, start_angle, TAU);
    let upper_right = || arc([0.0, 0.0], 5.0, FRAC_PI_2, -FRAC_PI_2);
    let upper_left = || arc([3.0, 0.0], 5.0, PI, -FRAC_PI_2);
    for (name, one, other, expected) in [
        ("lines", diagonal(), line([0.0, 2.0], [2.0, 0.0]), &[[1.0, 1.0]][..]),
        ("a line too short", diagonal(), line([0.0, 2.0], [0.5, 1.5]), &[]),
        ("parallels", diagonal(), line([0.0, 2.0], [2.0, 4.0]), &[]),
        ("ends that touch", diagonal(), line([2.0, 2.0], [2.0, 3.0]), &[[2.0, 2.0]]),
        ("line and circle", high(3.0), circle(0.0, 0.0), &[[-4.0, 3.0], [4.0, 3.0]]),
        ("quarter and line", upper_right(), high(3.0), &[[4.0, 3.0]]),
        ("line above a circle", high(5.1), circle(0.0, 0.0), &[]),
        ("ends of both", line([5.0, 0.0], [9.0, 0.0]), upper_right(), &[[5.0, 0.0]]),
        ("circles", circle(-3.0, 0.0), circle(3.0, PI), &[[0.0, 4.0], [0.0, -4.0]]),
        ("circle and quarter", circle(-3.0, 0.0), upper_left(), &[[0.0, 4.0]]),
        ("circles apart", circle(-3.0, 0.0), circle(9.0, 0.0), &[]),
        ("circles in each other", circle(-3.0, 0.0), arc([-3.0, 0.0], 4.0, 0.0, TAU), &[]),
    ] {
        assert_eq!(points(&one, &other), expected, "{name}");
    }
}

/// More than one turn passes the same place more than once.
#[test]
fn turns_count() {
    let twice = arc([0.0, 0.0], 5.0, 0.0, 2.0 * TAU);
    assert_eq!(crossings(&twice, &line([0.0, 1.0], [0.0, 9.0])).len(), 2);
}

/// Arcs of programs with rounded numbers end at another radius than they start; the crossing is on what they are.
#[test]
fn growing_radii() {
    let center = Point2::new(0.0, 0.0);
    let growing =
        Curve::Arc(Round::new(Point2::new(5.0, 0.0), Point2::new(-5.000_5, 0.0), center, PI));
    let found = crossings(&growing, &line([0.0, 1.0], [0.0, 9.0]));
    let [Crossing { u, .. }] = found[..] else { panic!("{found:?}") };
    assert!((growing.at(u) - Point2::new(0.0, 5.000_25)).norm() < 1e-9);
}

fn any_curve() -> impl Strategy<Value = Curve> {
    let coordinate = || -1.0..1.0_f64;
    let point = || [coordinate(), coordinate()];
    let sweep = prop_oneof![-TAU..-0.2, 0.2..TAU];
    let arcs = (point(), 0.1..1.0, -PI..PI, sweep)
        .prop_map(|(center, radius, start, sweep)| arc(center, radius, start, sweep));
    prop_oneof![(point(), point()).prop_map(|(start, end)| line(start, end)), arcs]
}

/// The smallest distance of dense samples.
fn sampled_distance(a: &Curve, b: &Curve) -> f64 {
    let samples =
        |curve: &Curve| -> Vec<_> { (0..=300).map(|i| curve.at(f64::from(i) / 300.0)).collect() };
    let (a, b) = (samples(a), samples(b));
    a.iter().flat_map(|p| b.iter().map(move |q| (p - q).norm())).fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn distances(a in any_curve(), b in any_curve()) {
        let (exact, sampled) = (distance(&a, &b), sampled_distance(&a, &b));
        // Samples lie up to half a step from the nearest points.
        let step = (a.length() + b.length()) / 300.0;
        prop_assert!(exact <= sampled + 1e-9 && sampled <= exact + step, "{exact}, {sampled}");
        prop_assert_eq!(exact == 0.0, !crossings(&a, &b).is_empty());
    }

    #[test]
    fn offsets(curve in any_curve(), by in -0.09..0.09) {
        let (offset, inside_out) = curve.offset(by);
        prop_assert!(!inside_out);
        for u in [0.0, 0.3, 1.0] {
            let shift = offset.at(u) - curve.at(u);
            prop_assert!((super::left(&curve.direction(u)) * by - shift).norm() < 1e-12);
        }
    }
}

/// Arcs stay within the tolerance, meet without a kink and have the curve's ends.
fn assert_fits(shape: &Shape, tolerance: f64, most: usize) {
    let pieces = fit(shape, tolerance);
    assert!(pieces.len() <= most, "{} pieces", pieces.len());
    for pair in pieces.windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        assert_eq!((a.to, a.curve.end()), (b.from, b.curve.start()));
        assert!((a.curve.direction(1.0) - b.curve.direction(0.0)).norm() < 1e-7);
    }
    let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { panic!() };
    assert_eq!(first.curve.start(), shape.start().xy());
    assert_eq!((last.to, last.curve.end()), (shape.length(), shape.end().xy()));
    for sample in 0..=1000 {
        let point = shape.at(shape.length() * f64::from(sample) / 1000.0).position.xy();
        let here = Curve::Line { start: point, end: point };
        let least = pieces.iter().map(|p| distance(&p.curve, &here)).fold(f64::INFINITY, f64::min);
        assert!(least <= 1.1 * tolerance, "{least} at sample {sample}");
    }
}

#[test]
fn ellipses_and_splines_as_arcs() {
    let (apex, half) = (Point3::new(0.05, 0.0, 0.0), Vector2::new(0.05, 0.0));
    let ellipse = Ellipse::new(apex, apex, Point2::origin(), half, 0.02, TAU);
    assert_fits(&Shape::Ellipse(Box::new(ellipse)), 1e-6, 130);
    let (start, end, direction) = (Point3::origin(), apex * 2.0, Vector2::new(0.1, 0.2));
    let s_bend = Cubic::hermite(start, end, direction, direction);
    assert_fits(&Shape::Cubic(Box::new(s_bend)), 1e-6, 130);
    let parabola = Cubic::parabola(start, Point2::new(0.05, 0.1), end);
    assert_fits(&Shape::Cubic(Box::new(parabola)), 1e-5, 70);
}

/// Straight curves, and those of length zero, are not arcs.
#[test]
fn degenerate_curves() {
    let end = Point3::new(0.1, 0.0, 0.0);
    let straight = Cubic::parabola(Point3::origin(), Point2::new(0.05, 0.0), end);
    let pieces = fit(&Shape::Cubic(Box::new(straight)), 1e-6);
    assert!(pieces.iter().all(|piece| matches!(piece.curve, Curve::Line { .. })));
    let nothing = Cubic::new([0.1, 0.0, 0.0, 0.0], [0.0; 4], 0.0, 0.0);
    assert!(!fit(&Shape::Cubic(Box::new(nothing)), 1e-6).is_empty());
}
