//! Tests of path preparation, one file per adapter.

#![expect(clippy::float_cmp, reason = "what an adapter leaves alone stays the same to the bit")]

mod avoid_loops;
mod check_velocities;
mod corner;
mod limit_circular;
mod preparation;
mod random;
mod tool_radius;

use random::random_path;

use crate::Place;
use crate::prepare::{CheckError, CornerError, Notice, Notices, ToolRadiusError};
use crate::{Arc, ElementKind, PathElement, ProbeOutcome, Probing, Shape};
use nalgebra::{Point3, Vector3};

/// Errors of the adapters and of a test's stream.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
enum Error {
    #[error(transparent)]
    Check(#[from] CheckError),
    #[error(transparent)]
    Corner(#[from] CornerError),
    #[error(transparent)]
    ToolRadius(#[from] ToolRadiusError),
    #[error("upstream")]
    Upstream(u32),
}

/// The tolerance of the vectors, 1e-8 mm, in m.
const VECTOR_TOLERANCE: f64 = 1e-11;

fn element(kind: ElementKind, shape: Shape, feed: f64) -> PathElement {
    let place = Place { line: 1, block: Some(10) };
    PathElement {
        feed,
        acceleration: 0.1,
        deceleration: 0.1,
        ..PathElement::new(place, kind, shape)
    }
}

/// A move that a probe has ended.
const PROBE: ElementKind =
    ElementKind::Probe { probing: Probing::TOUCH, outcome: ProbeOutcome::Tripped };

fn line(kind: ElementKind, start: [f64; 3], end: [f64; 3], feed: f64) -> PathElement {
    element(kind, Shape::Line { start: start.into(), end: end.into() }, feed)
}

fn cut(start: [f64; 3], end: [f64; 3], feed: f64) -> PathElement {
    line(ElementKind::Cut, start, end, feed)
}

fn arc(center: [f64; 3], radius: f64, start_angle: f64, sweep: f64, feed: f64) -> PathElement {
    let center = Point3::from(center);
    let on = |angle: f64| center + Vector3::new(angle.cos(), angle.sin(), 0.0) * radius;
    let arc = Arc::new(on(start_angle), on(start_angle + sweep), center, sweep);
    element(ElementKind::Cut, Shape::Arc(arc), feed)
}

/// A line per pair of neighbouring points (mm, in X and Y), on lines 1, 2, 3 … of the program.
fn polyline(points_mm: &[[f64; 2]]) -> Vec<PathElement> {
    let at = |[x, y]: [f64; 2]| [x * 1e-3, y * 1e-3, 0.0];
    numbered(points_mm.windows(2).map(|pair| cut(at(pair[0]), at(pair[1]), 0.05)).collect())
}

/// The elements on lines 1, 2, 3 … of the program.
fn numbered(mut elements: Vec<PathElement>) -> Vec<PathElement> {
    for (number, element) in (1..).zip(&mut elements) {
        element.place = Place { line: number, block: None };
    }
    elements
}

fn m_function(at: Point3<f64>) -> PathElement {
    element(ElementKind::MFunction { number: 8 }, Shape::Line { start: at, end: at }, 0.05)
}

/// Every element joins the one before, to the bit.
fn assert_continuous(elements: &[PathElement]) {
    for pair in elements.windows(2) {
        assert_eq!(pair[0].end(), pair[1].start(), "between {:?} and {:?}", pair[0], pair[1]);
        // What names no extra axes has them at 0.
        let end = pair[0].extra().map_or([0.0; 5], |extra| extra.end);
        let start = pair[1].extra().map_or([0.0; 5], |extra| extra.start);
        assert_eq!(end, start, "between {:?} and {:?}", pair[0], pair[1]);
    }
}

fn close(a: Point3<f64>, b_mm: [f64; 3]) -> bool {
    (a - Point3::from(b_mm) * 1e-3).norm() <= VECTOR_TOLERANCE
}

/// Asserts that the elements lead through these points, mm in X and Y.
fn assert_points(path: &[PathElement], points_mm: &[[f64; 2]]) {
    let found: Vec<_> =
        path.iter().map(|element| (element.start() * 1e3, element.end() * 1e3)).collect();
    assert_eq!(path.len() + 1, points_mm.len(), "{found:?}");
    for (element, ends) in path.iter().zip(points_mm.windows(2)) {
        let [from, to] = [ends[0], ends[1]].map(|[x, y]| [x, y, 0.0]);
        assert!(close(element.start(), from) && close(element.end(), to), "{found:?}");
    }
}

fn taken(notices: &Notices) -> Vec<Notice> {
    std::iter::from_fn(|| notices.take()).collect()
}
