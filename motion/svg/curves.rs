//! Shapes as commands of SVG paths, in mm and with Y upwards: the page turns it over.

use crate::path::{Cubic, Plane, Shape};
use nalgebra::Point3;
use std::f64::consts::FRAC_PI_2;
use std::fmt;

/// Upright arcs are drawn as so many lines per quarter.
const LINES_PER_QUARTER: f64 = 16.0;

/// A point of the picture, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) x: f64,
    pub(super) y: f64,
}

pub(super) fn point(at: &Point3<f64>) -> Point {
    Point { x: at.x * 1e3, y: at.y * 1e3 }
}

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", number(self.x), number(self.y))
    }
}

/// `value` to a tenth of a micrometre, as short as it goes.
pub(super) fn number(value: f64) -> String {
    // What is no number would spoil the whole picture.
    let value = if value.is_finite() { value } else { 0.0 };
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The commands that draw a shape from its start, each with the point it leads to.
pub(super) fn commands(shape: &Shape) -> Vec<(String, Point)> {
    let line = |to: Point| (format!("L{to}"), to);
    match shape {
        Shape::Line { end, .. } => vec![line(point(end))],
        Shape::Arc(arc) if arc.plane() == Plane::Xy => {
            let radius = arc.radius().midpoint(arc.end_radius()) * 1e3;
            arcs(shape, [radius, radius], 0.0, arc.sweep())
        }
        Shape::Arc(arc) => {
            let parts = (arc.sweep().abs() / FRAC_PI_2 * LINES_PER_QUARTER).ceil();
            pieces(shape, parts).map(line).collect()
        }
        Shape::Ellipse(ellipse) => {
            let major = ellipse.major();
            let direction = major.y.atan2(major.x).to_degrees();
            let axes = [major.norm() * 1e3, ellipse.minor() * 1e3];
            arcs(shape, axes, direction, ellipse.sweep())
        }
        Shape::Cubic(cubic) => {
            let [_, first, second, end] = control_points(cubic);
            vec![(format!("C{first} {second} {end}"), end)]
        }
    }
}

/// The points of a cubic's Bézier form.
fn control_points(cubic: &Cubic) -> [Point; 4] {
    let control = |[a, b, c, _]: [f64; 4]| [(a + b / 3.0) * 1e3, (a + (2.0 * b + c) / 3.0) * 1e3];
    let ([x1, x2], [y1, y2]) = (control(cubic.x()), control(cubic.y()));
    let [first, second] = [Point { x: x1, y: y1 }, Point { x: x2, y: y2 }];
    [point(&cubic.start()), first, second, point(&cubic.end())]
}

/// The corners of the smallest convex polygon around those points, counter-clockwise (manual 3.5): the curve lies in
/// it. Fewer than three if they are in line.
pub(super) fn convex_hull(cubic: &Cubic) -> Vec<Point> {
    let mut points = control_points(cubic);
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut hull = half_hull(points.iter());
    hull.extend(half_hull(points.iter().rev()));
    hull
}

/// From the first to the last of `points`, always turning left; the last one left out, with which the other half begins.
fn half_hull<'a>(points: impl Iterator<Item = &'a Point>) -> Vec<Point> {
    let mut hull: Vec<Point> = Vec::new();
    for point in points {
        while let [.., a, b] = hull.as_slice()
            && (b.x - a.x) * (point.y - a.y) <= (b.y - a.y) * (point.x - a.x)
        {
            hull.pop();
        }
        hull.push(*point);
    }
    hull.pop();
    hull
}

/// Ends of equally long pieces.
fn pieces(shape: &Shape, count: f64) -> impl Iterator<Item = Point> {
    let count = count.clamp(1.0, 1e4);
    let length = shape.length();
    (1_u32..)
        .map(f64::from)
        .take_while(move |number| *number <= count)
        .map(move |number| point(&shape.at(length * (number / count)).position))
}

/// An elliptic arc in pieces of about a quarter: SVG draws none that closes, and none of more than a half without
/// being told.
fn arcs(
    shape: &Shape,
    [long, across]: [f64; 2],
    direction_deg: f64,
    sweep: f64,
) -> Vec<(String, Point)> {
    // Y points upwards here, so what turns counter-clockwise turns in the positive sense.
    let sense = u8::from(sweep > 0.0);
    let count = (sweep.abs() / FRAC_PI_2 - 1e-9).ceil();
    let [long, across, direction] = [long, across, direction_deg].map(number);
    pieces(shape, count)
        .map(|end| (format!("A{long} {across} {direction} 0 {sense} {end}"), end))
        .collect()
}
