//! Shapes as commands of SVG paths, in mm and with Y upwards.

use nalgebra::Point3;
use std::f64::consts::FRAC_PI_2;
use twin_path::{Cubic, Plane, Shape};
use twin_plot::{Point, hull, number};

/// Lines per quarter of an upright arc.
const LINES_PER_QUARTER: f64 = 16.0;

/// A place as the picture has it, mm.
pub(super) fn point(at: &Point3<f64>) -> Point {
    (at.x * 1e3, at.y * 1e3)
}

/// A place as SVG commands have it.
pub(super) fn place((x, y): Point) -> String {
    format!("{} {}", number(x), number(y))
}

/// The commands that draw a shape from its start, each with the point it leads to.
pub(super) fn commands(shape: &Shape) -> Vec<(String, Point)> {
    let line = |to: Point| (format!("L{}", place(to)), to);
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
            vec![(format!("C{} {} {}", place(first), place(second), place(end)), end)]
        }
    }
}

/// The points of a cubic's Bézier form.
fn control_points(cubic: &Cubic) -> [Point; 4] {
    let control = |[a, b, c, _]: [f64; 4]| [(a + b / 3.0) * 1e3, (a + (2.0 * b + c) / 3.0) * 1e3];
    let ([x1, x2], [y1, y2]) = (control(cubic.x()), control(cubic.y()));
    [point(&cubic.start()), (x1, y1), (x2, y2), point(&cubic.end())]
}

/// The convex polygon around those points (manual 3.5): the curve lies in it. Fewer than three corners if they are in line.
pub(super) fn convex_hull(cubic: &Cubic) -> Vec<Point> {
    hull(control_points(cubic).to_vec())
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

/// An elliptic arc in pieces of about a quarter: SVG draws no closed one, and needs a flag for more than half.
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
        .map(|end| (format!("A{long} {across} {direction} 0 {sense} {}", place(end)), end))
        .collect()
}
