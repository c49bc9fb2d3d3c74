//! Writer of one element: its G command and the words that describe its curve.

use super::{TOLERANCE, WriteError};
use crate::din66025::arc;
use crate::din66025::emit::joins;
use crate::din66025::word::Letter;
use crate::number::read_back;
use nalgebra::{Point2, Point3, Vector2};
use twin_path::{
    Arc, Cubic, ElementKind, Ellipse, PathElement, Plane, Shape, cardinal_tangent, end_tangent,
};

/// G and what describes the curve, in the units of the program.
#[derive(Debug)]
pub(super) struct Command {
    pub(super) number: i64,
    pub(super) words: Vec<(Letter, f64)>,
}

/// An element and where the decoder will have it start and end, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve<'a> {
    pub(super) element: &'a PathElement,
    pub(super) start: Point3<f64>,
    pub(super) end: Point3<f64>,
}

impl Curve<'_> {
    /// Command for the element; none if these decimals do not reproduce it.
    ///
    /// # Errors
    /// If no decimals would.
    pub(super) fn command(
        &self,
        spline: &Spline,
        next: Option<&PathElement>,
        decimals: usize,
    ) -> Result<Option<Command>, WriteError> {
        let place = self.element.place;
        let rapid = self.element.kind == ElementKind::Rapid;
        match &self.element.shape {
            Shape::Line { .. } => {
                let number = i64::from(!rapid);
                Ok(Some(Command { number, words: Vec::new() }))
            }
            _ if rapid => Err(WriteError::Inexpressible { place, what: "a rapid along a curve" }),
            // Too short to distinguish a curve from a full circle.
            shape if shape.length() <= TOLERANCE => {
                Ok(Some(Command { number: 1, words: Vec::new() }))
            }
            Shape::Arc(arc) if arc.plane() != Plane::Xy => Err(WriteError::UprightArc(place)),
            Shape::Arc(arc) => Ok(self.arc(arc, decimals)),
            Shape::Ellipse(ellipse) => Ok(self.ellipse(ellipse, decimals)),
            Shape::Cubic(cubic) => {
                if let Some(command) = self.spline(cubic, spline, next) {
                    return Ok(Some(command));
                }
                Ok(self.parabola(cubic, decimals))
            }
        }
    }

    /// The error for an element that cannot be said.
    pub(super) fn unsaid(element: &PathElement) -> WriteError {
        let place = element.place;
        match &element.shape {
            Shape::Cubic(cubic) if !nearly_parabola(cubic) => WriteError::Cubic(place),
            _ => WriteError::Curve(place),
        }
    }

    /// I and J as they are written and the point that the decoder makes of them.
    fn point(&self, point: Point2<f64>, decimals: usize) -> ([(Letter, f64); 2], Point2<f64>) {
        let offset = (point - self.start.xy()) * 1e3;
        let read = offset.map(|mm| read_back(mm, decimals) / 1e3);
        ([(Letter::I, offset.x), (Letter::J, offset.y)], self.start.xy() + read)
    }

    /// The command, if `shape` is what it should be.
    fn if_same(&self, shape: &Shape, number: i64, words: Vec<(Letter, f64)>) -> Option<Command> {
        same(&self.element.shape, shape).then_some(Command { number, words })
    }

    fn arc(&self, arc: &Arc, decimals: usize) -> Option<Command> {
        let clockwise = arc.sweep() < 0.0;
        let (words, center) = self.point(arc.center().xy(), decimals);
        let read = arc::about_center(self.start, self.end, center, clockwise).ok()?;
        let number = if clockwise { 2 } else { 3 };
        self.if_same(&Shape::Arc(read), number, words.to_vec())
    }

    fn ellipse(&self, ellipse: &Ellipse, decimals: usize) -> Option<Command> {
        let clockwise = ellipse.sweep() < 0.0;
        let (words, center) = self.point(ellipse.center(), decimals);
        let (major, minor) = (ellipse.major(), ellipse.minor().abs());
        // R is at most 1, so K is the direction of the longer axis.
        let (long, ratio) = if minor > major.norm() {
            (Vector2::new(-major.y, major.x), major.norm() / minor)
        } else {
            (major, minor / major.norm())
        };
        let direction_deg = long.y.atan2(long.x).to_degrees();
        let mut words = words.to_vec();
        words.extend([(Letter::K, direction_deg), (Letter::R, ratio)]);
        let read = Ellipse::through(
            self.start,
            self.end,
            center,
            read_back(direction_deg, decimals).to_radians(),
            Some(read_back(ratio, decimals)),
            clockwise,
        )
        .ok()?;
        let number = if clockwise { 8 } else { 9 };
        self.if_same(&Shape::Ellipse(Box::new(read)), number, words)
    }

    fn parabola(&self, cubic: &Cubic, decimals: usize) -> Option<Command> {
        if !nearly_parabola(cubic) {
            return None;
        }
        let ([x0, x1, ..], [y0, y1, ..]) = (cubic.x(), cubic.y());
        let (words, control) = self.point(Point2::new(x0 + x1 / 2.0, y0 + y1 / 2.0), decimals);
        let read = Cubic::parabola(self.start, control, self.end);
        self.if_same(&Shape::Cubic(Box::new(read)), 6, words.to_vec())
    }

    /// G5, if the decoder makes this piece of it between these neighbours.
    fn spline(
        &self,
        cubic: &Cubic,
        spline: &Spline,
        next: Option<&PathElement>,
    ) -> Option<Command> {
        let tangents = derivatives(cubic);
        let chord = (self.end - self.start).xy();
        let joined = next.filter(|next| is_joint(self.element, next));
        // A parabola says itself, unless it is a piece of a spline.
        if nearly_parabola(cubic) && !spline.goes_on(self.element) && joined.is_none() {
            return None;
        }
        let start = spline.start_tangent(self.element, chord);
        let end = match (joined, next) {
            (Some(next), _) => cardinal_tangent(self.start.xy(), next.end().xy()),
            (None, Some(next)) if joins(next) => {
                end_tangent(chord, Some(next.start_tangent().xy()))
            }
            _ => chord,
        };
        let close = |a: Vector2<f64>, b: Vector2<f64>| (a - b).norm() <= TOLERANCE;
        if chord.norm() <= 0.0 || !close(tangents[0], start) || !close(tangents[1], end) {
            return None;
        }
        let read = Cubic::hermite(self.start, self.end, start, end);
        self.if_same(&Shape::Cubic(Box::new(read)), 5, Vec::new())
    }
}

/// State of a spline: the elements before, as far as they shape it.
#[derive(Debug, Default)]
pub(super) struct Spline {
    /// The last element and whether it was written as a piece of a spline.
    last: Option<(PathElement, bool)>,
}

impl Spline {
    pub(super) fn advance(&mut self, element: &PathElement, is_spline: bool) {
        self.last = Some((element.clone(), is_spline));
    }

    /// True if `element` continues the spline before it.
    fn goes_on(&self, element: &PathElement) -> bool {
        matches!(&self.last, Some((last, true)) if is_joint(last, element))
    }

    /// The derivative that the decoder gives the start of a piece.
    fn start_tangent(&self, element: &PathElement, chord: Vector2<f64>) -> Vector2<f64> {
        match &self.last {
            Some((last, true)) => cardinal_tangent(last.start().xy(), element.end().xy()),
            Some((last, false)) if joins(last) => end_tangent(chord, Some(last.end_tangent().xy())),
            _ => chord,
        }
    }
}

/// True if two cubics meet like pieces of one cardinal spline, on both sides.
fn is_joint(element: &PathElement, next: &PathElement) -> bool {
    let (Shape::Cubic(first), Shape::Cubic(second)) = (&element.shape, &next.shape) else {
        return false;
    };
    let cardinal = cardinal_tangent(first.start().xy(), second.end().xy());
    let [_, arriving] = derivatives(first);
    let [leaving, _] = derivatives(second);
    next.kind == ElementKind::Cut
        && (arriving - cardinal).norm() <= TOLERANCE
        && (leaving - cardinal).norm() <= TOLERANCE
}

/// Derivatives with respect to the parameter at both ends.
fn derivatives(cubic: &Cubic) -> [Vector2<f64>; 2] {
    let (x, y) = (cubic.x(), cubic.y());
    let end = |[_, b, c, d]: [f64; 4]| b + 2.0 * c + 3.0 * d;
    [Vector2::new(x[1], y[1]), Vector2::new(end(x), end(y))]
}

/// True if leaving out the cubic term moves no point by more than the tolerance.
fn nearly_parabola(cubic: &Cubic) -> bool {
    let ([.., x], [.., y]) = (cubic.x(), cubic.y());
    x.abs() <= TOLERANCE && y.abs() <= TOLERANCE
}

/// True if both shapes are the same to the tolerance.
fn same(a: &Shape, b: &Shape) -> bool {
    const PARTS: [f64; 7] = [0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0];
    let (length, other) = (a.length(), b.length());
    (length - other).abs() <= TOLERANCE
        && PARTS.iter().all(|part| {
            (a.at(length * part).position - b.at(other * part).position).norm() <= TOLERANCE
        })
}
