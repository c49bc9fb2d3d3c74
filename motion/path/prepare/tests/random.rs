//! Random paths of lines, arcs and splines.

use super::{cut, element, numbered};
use crate::{Arc, Cubic, ElementKind, PathElement, Shape};
use nalgebra::{Point3, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

/// One more element from where the path is: a line; or an arc, or a spline.
#[derive(Clone, Copy, Debug)]
enum Step {
    Line { way: [f64; 3] },
    Arc { to_center: [f64; 2], sweep: f64, rise: f64 },
    Spline { way: [f64; 2], start: [f64; 2], end: [f64; 2] },
}

fn step(curves: bool) -> impl Strategy<Value = Step> {
    let way = || -0.1..0.1;
    let line = (way(), way(), -0.01..0.01).prop_map(|(x, y, z)| Step::Line { way: [x, y, z] });
    let arc = (way(), way(), -1.9 * PI..1.9 * PI, -0.01..0.01)
        .prop_map(|(x, y, sweep, rise)| Step::Arc { to_center: [x, y], sweep, rise });
    let spline = (way(), way(), way(), way(), way(), way())
        .prop_map(|(a, b, c, d, e, f)| Step::Spline { way: [a, b], start: [c, d], end: [e, f] });
    if curves {
        prop_oneof![3 => line, 2 => arc, 1 => spline].boxed()
    } else {
        prop_oneof![3 => line, 1 => arc].boxed()
    }
}

fn walk(steps: Vec<Step>) -> Vec<PathElement> {
    let mut at = Point3::origin();
    let mut path = Vec::new();
    for step in steps {
        let next = match step {
            Step::Line { way } => cut(at.into(), (at + Vector3::from(way)).into(), 0.05),
            Step::Arc { to_center: [x, y], sweep, rise } => {
                let center = at + Vector3::new(x, y, 0.0);
                let spoke = nalgebra::Rotation2::new(sweep) * Vector2::new(-x, -y);
                let end = center + Vector3::new(spoke.x, spoke.y, rise);
                element(ElementKind::Cut, Shape::Arc(Arc::new(at, end, center, sweep)), 0.05)
            }
            Step::Spline { way: [x, y], start, end } => {
                let to = at + Vector3::new(x, y, 0.0);
                let cubic = Cubic::hermite(at, to, start.into(), end.into());
                element(ElementKind::Cut, Shape::Cubic(Box::new(cubic)), 0.05)
            }
        };
        // Too short to have a direction that means anything.
        if next.length() > 1e-4 {
            at = next.end();
            path.push(next);
        }
    }
    numbered(path)
}

/// A path of lines and arcs, with `curves` of more arcs and of splines too, within some decimetres.
pub(super) fn random_path(curves: bool) -> impl Strategy<Value = Vec<PathElement>> {
    prop::collection::vec(step(curves), 1..12).prop_map(walk)
}
