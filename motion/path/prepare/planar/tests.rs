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
    found
        .iter()
        .map(|crossing| {
            let point = a.at(crossing.u);
            [point.x, point.y].map(|x| (x * 1e9).round() / 1e9 + 0.0)
        })
        .collect()
}

#[test]
fn lines_cross() {
    let cross = |end| points(&line([0.0, 0.0], [2.0, 2.0]), &line([0.0, 2.0], end));
    assert_eq!(cross([2.0, 0.0]), [[1.0, 1.0]]);
    assert_eq!(cross([0.5, 1.5]), [] as [[f64; 2]; 0]);
    assert_eq!(cross([2.0, 4.0]), [] as [[f64; 2]; 0], "parallel");
    // Ends that just touch.
    assert_eq!(points(&line([0.0, 0.0], [1.0, 0.0]), &line([1.0, 0.0], [1.0, 1.0])), [[1.0, 0.0]]);
}

#[test]
fn lines_and_arcs_cross() {
    let circle = arc([0.0, 0.0], 5.0, 0.0, TAU);
    assert_eq!(points(&line([-6.0, 3.0], [6.0, 3.0]), &circle), [[-4.0, 3.0], [4.0, 3.0]]);
    let upper_right = arc([0.0, 0.0], 5.0, FRAC_PI_2, -FRAC_PI_2);
    assert_eq!(points(&upper_right, &line([-6.0, 3.0], [6.0, 3.0])), [[4.0, 3.0]]);
    assert_eq!(points(&line([-6.0, 5.1], [6.0, 5.1]), &circle), [] as [[f64; 2]; 0]);
    // At the ends of both.
    assert_eq!(points(&line([5.0, 0.0], [9.0, 0.0]), &upper_right), [[5.0, 0.0]]);
}

#[test]
fn arcs_cross() {
    let one = arc([-3.0, 0.0], 5.0, 0.0, TAU);
    let other = arc([3.0, 0.0], 5.0, PI, TAU);
    let mut found = points(&one, &other);
    found.sort_by(|a, b| a[1].total_cmp(&b[1]));
    assert_eq!(found, [[0.0, -4.0], [0.0, 4.0]]);
    assert_eq!(points(&one, &arc([3.0, 0.0], 5.0, PI, -FRAC_PI_2)), [[0.0, 4.0]]);
    assert_eq!(points(&one, &arc([9.0, 0.0], 5.0, 0.0, TAU)), [] as [[f64; 2]; 0]);
    assert_eq!(points(&one, &arc([-3.0, 0.0], 4.0, 0.0, TAU)), [] as [[f64; 2]; 0]);
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
    let coordinate = || -1.0..1.0;
    prop_oneof![
        (coordinate(), coordinate(), coordinate(), coordinate())
            .prop_map(|(a, b, c, d)| line([a, b], [c, d])),
        (coordinate(), coordinate(), 0.1..1.0, -PI..PI, 0.2..TAU, any::<bool>()).prop_map(
            |(x, y, radius, start, sweep, left)| {
                arc([x, y], radius, start, if left { sweep } else { -sweep })
            }
        ),
    ]
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

    /// The offset is everywhere at the distance asked for, on the side asked for.
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
    let start = Point3::new(0.05, 0.0, 0.0);
    let ellipse =
        Ellipse::new(start, start, Point2::new(0.0, 0.0), Vector2::new(0.05, 0.0), 0.02, TAU);
    assert_fits(&Shape::Ellipse(Box::new(ellipse)), 1e-6, 130);
    let s_bend = Cubic::hermite(
        Point3::new(0.0, 0.0, 0.0),
        Point3::new(0.1, 0.0, 0.0),
        Vector2::new(0.1, 0.2),
        Vector2::new(0.1, 0.2),
    );
    assert_fits(&Shape::Cubic(Box::new(s_bend)), 1e-6, 130);
    let parabola = Cubic::parabola(
        Point3::new(0.0, 0.0, 0.0),
        Point2::new(0.05, 0.1),
        Point3::new(0.1, 0.0, 0.0),
    );
    assert_fits(&Shape::Cubic(Box::new(parabola)), 1e-5, 70);
}

/// Straight curves, and those of length zero, are not arcs.
#[test]
fn degenerate_curves() {
    let straight = Cubic::parabola(
        Point3::new(0.0, 0.0, 0.0),
        Point2::new(0.05, 0.0),
        Point3::new(0.1, 0.0, 0.0),
    );
    let pieces = fit(&Shape::Cubic(Box::new(straight)), 1e-6);
    assert!(pieces.iter().all(|piece| matches!(piece.curve, Curve::Line { .. })));
    let nothing = Cubic::new([0.1, 0.0, 0.0, 0.0], [0.0; 4], 0.0, 0.0);
    assert!(!fit(&Shape::Cubic(Box::new(nothing)), 1e-6).is_empty());
}
