//! Random paths of lines, arcs and splines.

use super::{cut, element, numbered};
use crate::{Arc, Cubic, ElementKind, PathElement, Shape};
use nalgebra::{Point3, Rotation2, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

#[derive(Clone, Copy, Debug)]
enum Step {
    Line,
    Arc,
    Spline,
}

/// One more element from `at`, by numbers up to 0.1 m: two lead to its end or, of an arc, to its centre.
fn next(at: Point3<f64>, step: Step, [x, y, a, b, c, d]: [f64; 6]) -> PathElement {
    let shape = match step {
        Step::Line => {
            return cut(at.into(), (at + Vector3::new(x, y, a * 0.1)).into(), 0.05);
        }
        Step::Arc => {
            let (center, sweep) = (at + Vector3::new(x, y, 0.0), 19.0 * PI * a);
            let spoke = Rotation2::new(sweep) * Vector2::new(-x, -y);
            Shape::Arc(Arc::new(at, center + spoke.push(b * 0.1), center, sweep))
        }
        Step::Spline => {
            let to = at + Vector3::new(x, y, 0.0);
            let [from, into] = [Vector2::new(a, b), Vector2::new(c, d)];
            Shape::Cubic(Box::new(Cubic::hermite(at, to, from, into)))
        }
    };
    element(ElementKind::Cut, shape, 0.05)
}

fn walk(steps: Vec<(Step, [f64; 6])>) -> Vec<PathElement> {
    let mut at = Point3::origin();
    let mut path = Vec::new();
    for (step, numbers) in steps {
        let next = next(at, step, numbers);
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
    let [line, arc, spline] = [Step::Line, Step::Arc, Step::Spline];
    let steps = [line, line, line, arc, arc, spline];
    let step = prop::sample::select(if curves { &steps[..] } else { &steps[..4] }.to_vec());
    prop::collection::vec((step, prop::array::uniform6(-0.1..0.1)), 1..12).prop_map(walk)
}
