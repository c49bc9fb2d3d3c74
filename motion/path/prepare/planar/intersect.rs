//! Intersections of two planar curves.

use super::{Curve, Round};
use nalgebra::{Matrix2, Point2, Vector2};

/// How far beyond its ends a curve may be met, m: rounding must not let a path slip through its own corner.
const SLACK: f64 = 1e-10;
/// Steps of Newton's method from the point where the mean circles meet, which is off by what the radii grow.
const STEPS: usize = 4;

/// A common point of two curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::prepare) struct Crossing {
    /// Parameter on the first.
    pub(in crate::prepare) u: f64,
    /// Parameter on the second.
    pub(in crate::prepare) v: f64,
}

/// The common points of two curves, in no particular order. Curves that run along each other have none.
pub(in crate::prepare) fn crossings(a: &Curve, b: &Curve) -> Vec<Crossing> {
    let mut found = Vec::new();
    match (a, b) {
        (Curve::Line { .. }, Curve::Line { .. }) => lines(a, b, &mut found),
        (Curve::Line { start, end }, Curve::Arc(arc)) => {
            line_and_arc([start, end], arc, &mut |u, v| found.push(Crossing { u, v }));
        }
        (Curve::Arc(arc), Curve::Line { start, end }) => {
            line_and_arc([start, end], arc, &mut |v, u| found.push(Crossing { u, v }));
        }
        (Curve::Arc(first), Curve::Arc(second)) => arcs(first, second, &mut found),
    }
    found.retain_mut(|crossing| refine(a, b, crossing));
    found
}

fn slack(curve: &Curve) -> f64 {
    SLACK / curve.length().max(SLACK)
}

fn lines(a: &Curve, b: &Curve, found: &mut Vec<Crossing>) {
    let (along_a, along_b) = (a.end() - a.start(), b.end() - b.start());
    let area = along_a.perp(&along_b);
    // Parallel but for rounding.
    if area.abs() <= 4.0 * f64::EPSILON * along_a.norm() * along_b.norm() {
        return;
    }
    let way = b.start() - a.start();
    let (u, v) = (way.perp(&along_b) / area, way.perp(&along_a) / area);
    let within = |u: f64, slack: f64| u >= -slack && u <= 1.0 + slack;
    if within(u, slack(a)) && within(v, slack(b)) {
        found.push(Crossing { u: u.clamp(0.0, 1.0), v: v.clamp(0.0, 1.0) });
    }
}

fn line_and_arc([start, end]: [&Point2<f64>; 2], arc: &Round, found: &mut impl FnMut(f64, f64)) {
    let along = end - start;
    let length = along.norm();
    if length <= 0.0 {
        return;
    }
    let direction = along / length;
    let to_center = arc.center - start;
    let (foot, height) = (to_center.dot(&direction), direction.perp(&to_center));
    let radius = arc.mean_radius();
    let square = (radius - height) * (radius + height);
    if square < 0.0 {
        return;
    }
    let reach = square.sqrt();
    for s in [foot - reach, foot + reach] {
        if s < -SLACK || s > length + SLACK {
            continue;
        }
        let seen = direction * s - to_center;
        for v in arc.parameters_at(seen.y.atan2(seen.x), slack(&Curve::Arc(*arc))) {
            found((s / length).clamp(0.0, 1.0), v);
        }
    }
}

fn arcs(a: &Round, b: &Round, found: &mut Vec<Crossing>) {
    let between = b.center - a.center;
    let distance = between.norm();
    if distance <= 0.0 {
        return;
    }
    let (radius_a, radius_b) = (a.mean_radius(), b.mean_radius());
    // Along the line of centres from a, and across it.
    let along = 0.5 * (distance + (radius_a - radius_b) * (radius_a + radius_b) / distance);
    let square = (radius_a - along) * (radius_a + along);
    if square < 0.0 {
        return;
    }
    let across = square.sqrt();
    let direction = between / distance;
    for side in [across, -across] {
        let from_a: Vector2<f64> = direction * along + super::left(&direction) * side;
        let from_b = from_a - between;
        for u in a.parameters_at(from_a.y.atan2(from_a.x), slack(&Curve::Arc(*a))) {
            for v in b.parameters_at(from_b.y.atan2(from_b.x), slack(&Curve::Arc(*b))) {
                found.push(Crossing { u, v });
            }
        }
    }
}

/// Moves a crossing of the mean circles to that of the curves as they are; false if it is none of theirs.
fn refine(a: &Curve, b: &Curve, crossing: &mut Crossing) -> bool {
    for _ in 0..STEPS {
        let gap = b.at(crossing.v) - a.at(crossing.u);
        let slopes = Matrix2::from_columns(&[a.derivative(crossing.u), -b.derivative(crossing.v)]);
        let Some(inverse) = slopes.try_inverse() else { break };
        let step = inverse * gap;
        crossing.u = (crossing.u + step.x).clamp(0.0, 1.0);
        crossing.v = (crossing.v + step.y).clamp(0.0, 1.0);
    }
    (b.at(crossing.v) - a.at(crossing.u)).norm() <= 2.0 * SLACK
}
