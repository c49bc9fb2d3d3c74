//! Smallest distance between two planar curves.

use super::{Curve, Round, crossings};
use nalgebra::{Point2, Vector2};

/// The smallest distance between two curves, m.
pub(in crate::prepare) fn distance(a: &Curve, b: &Curve) -> f64 {
    if !crossings(a, b).is_empty() {
        return 0.0;
    }
    let mut least = f64::INFINITY;
    for (curve, other) in [(a, b), (b, a)] {
        for point in [curve.start(), curve.end()] {
            least = least.min(to_point(other, &point));
        }
    }
    // Between the ends, where a common normal meets both.
    match (a, b) {
        (Curve::Line { .. }, Curve::Line { .. }) => {}
        (Curve::Line { start, end }, Curve::Arc(arc))
        | (Curve::Arc(arc), Curve::Line { start, end }) => {
            if let Some(foot) = foot(start, end, &arc.center) {
                least = least.min(across(&foot, arc, &(foot - arc.center)));
                // The far side of the circle.
                least = least.min(across(&foot, arc, &(arc.center - foot)));
            }
        }
        (Curve::Arc(first), Curve::Arc(second)) => {
            let between = second.center - first.center;
            for direction in [between, -between] {
                for point in on(first, &direction) {
                    least = least.min(across(&point, second, &direction));
                    least = least.min(across(&point, second, &-direction));
                }
            }
        }
    }
    least
}

/// Distance of a point from a curve, m.
pub(super) fn to_point(curve: &Curve, point: &Point2<f64>) -> f64 {
    let ends = (curve.start() - point).norm().min((curve.end() - point).norm());
    match curve {
        Curve::Line { start, end } => {
            foot(start, end, point).map_or(ends, |foot| ends.min((foot - point).norm()))
        }
        Curve::Arc(arc) => ends.min(across(point, arc, &(point - arc.center))),
    }
}

/// The point of a line nearest to `point`, if it lies between the ends.
fn foot(start: &Point2<f64>, end: &Point2<f64>, point: &Point2<f64>) -> Option<Point2<f64>> {
    let along = end - start;
    let u = (point - start).dot(&along) / along.norm_squared();
    (0.0..=1.0).contains(&u).then(|| start + along * u)
}

/// The points of an arc in `direction` as seen from its centre.
fn on(arc: &Round, direction: &Vector2<f64>) -> impl Iterator<Item = Point2<f64>> + use<> {
    let curve = Curve::Arc(*arc);
    arc.parameters_at(direction.y.atan2(direction.x), 0.0).map(move |u| curve.at(u))
}

/// Distance of `point` from the arc's points in `direction`; infinite if it has none there.
fn across(point: &Point2<f64>, arc: &Round, direction: &Vector2<f64>) -> f64 {
    on(arc, direction).map(|found| (found - point).norm()).fold(f64::INFINITY, f64::min)
}
