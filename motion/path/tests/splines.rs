//! Tests of B-splines against the recursion of Cox and de Boor.

#![expect(clippy::cast_precision_loss, reason = "few")]

use crate::BSpline;
use nalgebra::{Point3, Vector3};

/// Basis function number `index` of `degree`.
fn basis(knots: &[f64], index: usize, degree: usize, t: f64) -> f64 {
    if degree == 0 {
        return if (knots[index]..knots[index + 1]).contains(&t) { 1.0 } else { 0.0 };
    }
    let part = |from: usize, to: usize, length: f64| {
        let width = knots[to] - knots[from];
        if width > 0.0 { length / width } else { 0.0 }
    };
    let rising = part(index, index + degree, t - knots[index]);
    let falling = part(index + 1, index + degree + 1, knots[index + degree + 1] - t);
    rising * basis(knots, index, degree - 1, t) + falling * basis(knots, index + 1, degree - 1, t)
}

fn corners(count: u32) -> Vec<(Point3<f64>, f64)> {
    let corner = |n: u32| {
        let at = f64::from(n);
        let weight = 1.0 + 3.0 * (at * 2.3).sin().abs();
        (Point3::new((at * 1.7).sin(), (at * 2.9).cos() + at / 5.0, 0.25), weight)
    };
    (0..count).map(corner).collect()
}

fn naive(knots: &[f64], points: &[(Point3<f64>, f64)], degree: usize, t: f64) -> Point3<f64> {
    let (mut sum, mut weights) = (Vector3::zeros(), 0.0);
    for (index, (point, weight)) in points.iter().enumerate() {
        let value = basis(knots, index, degree, t) * weight;
        sum += point.coords * value;
        weights += value;
    }
    Point3::from(sum / weights)
}

#[test]
fn points_are_those_of_the_recursion() {
    for degree in 1..7 {
        let points = corners(9);
        let last = (points.len() - degree) as f64;
        let knots: Vec<f64> = (0..=points.len() + degree)
            .map(|n| (n as f64 - degree as f64).clamp(0.0, last))
            .collect();
        let spline = BSpline::clamped(degree, &points).unwrap();
        assert!(spline.is_rational() && spline.is_level() && spline.degree() == degree);
        let spans: Vec<_> = spline.spans().collect();
        assert_eq!(spans.len(), points.len() - degree);
        for (span, from, to) in spans {
            for t in (0..10).map(|n| from + (to - from) * f64::from(n) / 10.0) {
                let off = spline.at(span, t) - naive(&knots, &points, degree, t);
                assert!(off.norm() < 1e-13, "degree {degree}, {t}: {off}");
            }
        }
    }
}

/// The cubics are on the curve: exact, or within the tolerance.
#[test]
fn cubics_are_the_curve() {
    for (degree, weighted, tolerance) in
        [(1, false, 1e-14), (2, false, 1e-14), (3, false, 1e-14), (3, true, 1e-7), (5, false, 1e-7)]
    {
        let mut points = corners(8);
        if !weighted {
            points = points.iter().map(|(point, _)| (*point, 2.0)).collect();
        }
        let spline = BSpline::clamped(degree, &points).unwrap();
        let cubics = spline.cubics(points[0].0, points[7].0, tolerance);
        if degree <= 3 && !weighted {
            assert_eq!(cubics.len(), points.len() - degree);
        }
        assert_eq!((cubics[0].start(), cubics.last().unwrap().end()), (points[0].0, points[7].0));
        let fine: Vec<_> = spline
            .spans()
            .flat_map(|(span, from, to)| {
                let at = move |n: u32| from + (to - from) * f64::from(n) / 5000.0;
                (0..=5000).map(at).map(move |t| (span, t))
            })
            .map(|(span, t)| spline.at(span, t))
            .collect();
        for (cubic, next) in cubics.iter().zip(&cubics[1..]) {
            assert_eq!(cubic.end(), next.start());
        }
        for cubic in &cubics {
            let point = cubic.at(cubic.length() * 0.4).position;
            let (index, _) = fine
                .iter()
                .enumerate()
                .min_by(|a, b| (a.1 - point).norm().total_cmp(&(b.1 - point).norm()))
                .unwrap();
            let ends = [fine[index.saturating_sub(1)], fine[(index + 1).min(fine.len() - 1)]];
            let chord = ends[1] - ends[0];
            let off = (point - ends[0]).cross(&chord).norm() / chord.norm();
            // The chord of the fine points is that far from the curve.
            assert!(off < tolerance + 2e-6, "degree {degree}: {off:e}");
        }
    }
}

#[test]
fn what_does_not_fit_is_none() {
    let (points, knots) = (corners(4), vec![0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0]);
    assert!(BSpline::new(2, knots.clone(), &points).is_some());
    assert!(BSpline::new(3, knots.clone(), &points).is_none());
    assert!(BSpline::new(0, vec![0.0; 5], &points).is_none());
    assert!(BSpline::new(2, vec![0.0, 0.0, 0.0, 2.0, 1.0, 2.0, 2.0], &points).is_none());
    for weight in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut points = points.clone();
        points[2].1 = weight;
        assert!(BSpline::new(2, knots.clone(), &points).is_none(), "{weight}");
    }
    assert!(BSpline::clamped(4, &points).is_none());
    assert!(BSpline::clamped(3, &[]).is_none());
}
