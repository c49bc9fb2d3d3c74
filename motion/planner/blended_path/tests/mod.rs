//! Tests of the blended path.

#![expect(clippy::float_cmp, reason = "what a course leaves alone stays the same to the bit")]

mod joints;
mod random;
mod stream;
mod turning;

use super::{Blend, BlendOptions, BlendedElement, BlendedPath, BlendedPoint, Joint, Order};
use nalgebra::{Point3, SVector, Vector3};
use std::f64::consts::PI;
use twin_path::Place;
use twin_path::prepare::{CheckError, CheckVelocities};
use twin_path::{Arc, Details, ElementKind, ExtraAxes, PathElement, Plane, Shape};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Error {
    Check(CheckError),
    Upstream(u32),
}

impl From<CheckError> for Error {
    fn from(error: CheckError) -> Self {
        Error::Check(error)
    }
}

fn element(kind: ElementKind, shape: Shape) -> PathElement {
    let limits = PathElement::new(Place::default(), kind, shape);
    PathElement { feed: 0.05, acceleration: 0.1, deceleration: 0.2, ..limits }
}

fn line(start: [f64; 3], end: [f64; 3]) -> PathElement {
    element(ElementKind::Cut, Shape::Line { start: start.into(), end: end.into() })
}

/// From `start` about `center`, both in the coordinates of `plane`.
fn arc(plane: Plane, start: [f64; 3], center: [f64; 2], sweep: f64, rise: f64) -> PathElement {
    let [x, y, z] = start;
    let [cx, cy] = center;
    let (sin, cos) = sweep.sin_cos();
    let spoke = [x - cx, y - cy];
    let end =
        [cx + spoke[0] * cos - spoke[1] * sin, cy + spoke[0] * sin + spoke[1] * cos, z + rise];
    let [start, end, center] = [start, end, [cx, cy, 0.0]].map(|at| Point3::from(plane.join(at)));
    element(ElementKind::Cut, Shape::Arc(Arc::in_plane(plane, start, end, center, sweep)))
}

/// Whose extra axis P moves, too, u.
fn with_p(mut element: PathElement, start: f64, end: f64) -> PathElement {
    let at = |p: f64| [p, 0.0, 0.0, 0.0, 0.0];
    let extra = Some(ExtraAxes { start: at(start), end: at(end) });
    element.details = Some(Box::new(Details { extra, ..Details::default() }));
    element
}

/// The course along `path`, on which no corner is too sharp to be passed.
fn course(path: Vec<PathElement>, options: BlendOptions) -> Vec<BlendedElement> {
    let checked = CheckVelocities::new(path.into_iter().map(Ok::<_, Error>), PI);
    BlendedPath::new(checked, options).map(Result::unwrap).collect()
}

/// That of the original path.
fn original(element: &BlendedElement, s: f64) -> BlendedPoint {
    BlendedPoint::of(element.element(), s)
}

/// How far two points are apart, and their derivatives: space first.
fn steps(a: &BlendedPoint, b: &BlendedPoint) -> ([f64; 4], [f64; 4]) {
    let space =
        [a.position - b.position, a.first - b.first, a.second - b.second, a.third - b.third];
    let [from, to] = [a.extra.unwrap_or_default(), b.extra.unwrap_or_default()]
        .map(|p| [p.position, p.first, p.second, p.third].map(SVector::from));
    let extra = [0, 1, 2, 3].map(|order| (from[order] - to[order]).amax());
    (space.map(|step| step.norm()), extra)
}

/// The largest deviation of the course from the path, m and u, at `count` points of each element.
fn deviation(course: &[BlendedElement], count: u32) -> [f64; 2] {
    let mut largest = [0.0_f64; 2];
    for element in course {
        for part in 0..=count {
            let s = element.length() * f64::from(part) / f64::from(count);
            let (space, extra) = steps(&element.at(s), &original(element, s));
            // Before the first block that names an extra axis the path does not say where they are.
            let known = original(element, s).extra.is_some();
            let found = [space[0], if known { extra[0] } else { 0.0 }];
            largest = [largest[0].max(found[0]), largest[1].max(found[1])];
        }
    }
    largest
}

/// Two unit vectors that differ by `turn`, rad, at a right angle to Z.
fn turned(turn: f64) -> [Vector3<f64>; 2] {
    [Vector3::x(), Vector3::new(turn.cos(), turn.sin(), 0.0)]
}

/// Two lines that turn by `turn`, rad, of these lengths, m.
fn corner(turn: f64, lengths: [f64; 2]) -> Vec<PathElement> {
    let [along, away] = turned(turn);
    let middle = Point3::new(0.3, -0.2, 0.1);
    let [start, end] = [middle - along * lengths[0], middle + away * lengths[1]];
    vec![line(start.into(), middle.into()), line(middle.into(), end.into())]
}

/// Blends within `tolerance`, m, and the same number of mm of u.
fn within(tolerance: f64) -> BlendOptions {
    BlendOptions::new(tolerance)
}

fn only_velocity(tolerance: f64) -> BlendOptions {
    BlendOptions { order: Order::Velocity, ..within(tolerance) }
}
