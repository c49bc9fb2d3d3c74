//! Conversion of entities to primitives.

use super::error::Reason;
use super::primitive::{Primitive, scaling};
use super::spline::Spline;
use ::dxf::entities::{self, Entity, EntityType};
use ::dxf::{Point, Vector};
use nalgebra::{Affine3, Point3, Vector2};
use std::f64::consts::TAU;

/// The pieces of an entity, connected, in the coordinates of the drawing or block; false if they are approximated.
///
/// # Errors
/// Why it is left out.
pub(super) fn pieces(entity: &Entity, tolerance: f64) -> Result<(Vec<Primitive>, bool), Reason> {
    let mut exact = true;
    let pieces = match &entity.specific {
        EntityType::Line(line) => {
            vec![Primitive::Line { start: point(&line.p1), end: point(&line.p2) }]
        }
        EntityType::Circle(circle) => {
            let arc = arc(&circle.center, circle.radius, 0.0, TAU)?;
            vec![arc.mapped(&frame(&circle.normal)?)]
        }
        EntityType::Arc(entity) => {
            let angles = [entity.start_angle, entity.end_angle].map(f64::to_radians);
            let arc = arc(&entity.center, entity.radius, angles[0], turn(angles)?)?;
            vec![arc.mapped(&frame(&entity.normal)?)]
        }
        EntityType::LwPolyline(polyline) => {
            let frame = frame(&polyline.extrusion_direction)?;
            let elevation = entity.common.elevation;
            let vertices = polyline
                .vertices
                .iter()
                .map(|vertex| (Point3::new(vertex.x, vertex.y, elevation), vertex.bulge));
            bulged(vertices, polyline.is_closed(), &frame)
        }
        EntityType::Polyline(polyline) => self::polyline(polyline)?,
        EntityType::Ellipse(ellipse) => vec![self::ellipse(ellipse)?],
        EntityType::Spline(spline) => {
            let (pieces, is_exact) = Spline::new(spline)?.pieces(tolerance);
            exact = is_exact;
            pieces
        }
        _ => return Err(Reason::NotUnderstood),
    };
    let pieces: Vec<_> =
        pieces.into_iter().filter(|piece| !piece.is_finite() || extent(piece) > 0.0).collect();
    if pieces.is_empty() || !pieces.iter().all(Primitive::is_finite) {
        return Err(Reason::Degenerate);
    }
    Ok((pieces, exact))
}

/// Zero for what has no length.
fn extent(piece: &Primitive) -> f64 {
    match piece {
        Primitive::Line { start, end } => (end - start).norm(),
        Primitive::Arc { u, v, sweep, .. } => (u.norm() + v.norm()) * sweep,
        Primitive::Bezier([a, b, c, d]) => (b - a).norm() + (c - b).norm() + (d - c).norm(),
    }
}

fn point(point: &Point) -> Point3<f64> {
    Point3::new(point.x, point.y, point.z)
}

/// From the coordinates of an entity with this normal to those of the drawing.
pub(super) fn frame(normal: &Vector) -> Result<Affine3<f64>, Reason> {
    let size = normal.z.abs();
    if !(size > 0.0 && normal.x.abs() <= 1e-9 * size && normal.y.abs() <= 1e-9 * size) {
        return Err(Reason::Tilted);
    }
    let side = normal.z.signum();
    Ok(scaling(side, 1.0, side))
}

/// The angle from the first to the second, counter-clockwise, more than 0 and at most a full turn.
fn turn([start, end]: [f64; 2]) -> Result<f64, Reason> {
    let turn = (end - start).rem_euclid(TAU);
    if turn.is_nan() {
        return Err(Reason::Degenerate);
    }
    // 0 to 360 degrees is a whole circle, however it was rounded.
    Ok(if turn <= 1e-12 { TAU } else { turn })
}

fn arc(center: &Point, radius: f64, start: f64, sweep: f64) -> Result<Primitive, Reason> {
    if radius <= 0.0 {
        return Err(Reason::Degenerate);
    }
    let (sin, cos) = start.sin_cos();
    let u = Vector2::new(cos, sin) * radius;
    let v = Vector2::new(-sin, cos) * radius;
    Ok(Primitive::arc(point(center), u, v, sweep))
}

fn ellipse(ellipse: &entities::Ellipse) -> Result<Primitive, Reason> {
    // Only the normal's sense matters: centre and axis are in the coordinates of the drawing.
    frame(&ellipse.normal)?;
    let axis = &ellipse.major_axis;
    if axis.z.abs() > 1e-9 * axis.x.hypot(axis.y) {
        return Err(Reason::Tilted);
    }
    let major = Vector2::new(axis.x, axis.y);
    let ratio = ellipse.minor_axis_ratio;
    if !(major.norm() > 0.0 && ratio != 0.0 && ratio.is_finite()) {
        return Err(Reason::Degenerate);
    }
    let minor = Vector2::new(-major.y, major.x) * (ratio * ellipse.normal.z.signum());
    let sweep = turn([ellipse.start_parameter, ellipse.end_parameter])?;
    let (sin, cos) = ellipse.start_parameter.sin_cos();
    let (u, v) = (major * cos + minor * sin, minor * cos - major * sin);
    Ok(Primitive::arc(point(&ellipse.center), u, v, sweep))
}

fn polyline(polyline: &entities::Polyline) -> Result<Vec<Primitive>, Reason> {
    if polyline.is_3d_polygon_mesh() || polyline.is_polyface_mesh() {
        return Err(Reason::NotUnderstood);
    }
    // The frame of a fitted curve is not a part of it.
    let vertices = polyline.vertices().filter(|vertex| !vertex.is_spline_frame_control_point());
    let closed = polyline.is_closed();
    if polyline.is_3d_polyline() {
        let straight = vertices.map(|vertex| (point(&vertex.location), 0.0));
        return Ok(bulged(straight, closed, &Affine3::identity()));
    }
    let elevation = polyline.location.z;
    let vertices = vertices
        .map(|vertex| (Point3::new(vertex.location.x, vertex.location.y, elevation), vertex.bulge));
    Ok(bulged(vertices, closed, &frame(&polyline.normal)?))
}

/// Lines and arcs from vertex to vertex. A bulge is the tangent of a quarter of the arc's angle, positive
/// counter-clockwise.
fn bulged(
    vertices: impl Iterator<Item = (Point3<f64>, f64)>,
    closed: bool,
    frame: &Affine3<f64>,
) -> Vec<Primitive> {
    let mut pieces = Vec::new();
    let mut first = None;
    let mut last: Option<(Point3<f64>, f64)> = None;
    for vertex in vertices {
        first.get_or_insert(vertex.0);
        if let Some((from, bulge)) = last.replace(vertex) {
            pieces.push(segment(from, vertex.0, bulge).mapped(frame));
        }
    }
    if let (true, Some((from, bulge)), Some(first)) = (closed, last, first) {
        pieces.push(segment(from, first, bulge).mapped(frame));
    }
    pieces
}

fn segment(start: Point3<f64>, end: Point3<f64>, bulge: f64) -> Primitive {
    let chord = (end - start).xy();
    if bulge == 0.0 || chord.norm() <= 0.0 {
        return Primitive::Line { start, end };
    }
    // The centre is on the left of the chord's middle, by (1 − b²)/4b of it.
    let left = Vector2::new(-chord.y, chord.x);
    let center = start.xy() + chord / 2.0 + left * ((1.0 - bulge * bulge) / (4.0 * bulge));
    let u = start.xy() - center;
    let v = Vector2::new(-u.y, u.x) * bulge.signum();
    let center = Point3::new(center.x, center.y, start.z);
    let sweep = 4.0 * bulge.abs().atan();
    Primitive::Arc { start, end, center, u: u.push(0.0), v: v.push(0.0), sweep }
}
