//! B-splines and their rational form (NURBS): points, derivatives, and the cubics that they are made of.

use super::Cubic;
use nalgebra::{Point3, Vector2, Vector4};

/// Splines of higher degree are not drawn by anything.
const MAX_SPLINE_DEGREE: usize = 25;

/// Largest number of halvings of a knot span: weights that differ by 10¹² make a curve that fast at the end of a span.
const MAX_HALVINGS: u32 = 60;

/// Number of arguments of a polar form.
type Arguments = [f64; MAX_SPLINE_DEGREE];

/// A B-spline: knots, and control points with weights.
#[derive(Clone, Debug)]
pub struct BSpline {
    degree: usize,
    knots: Vec<f64>,
    /// x·w, y·w, z·w, w.
    points: Vec<Vector4<f64>>,
    rational: bool,
}

/// A knot span that is not empty: its number and its first and last parameter.
pub type Span = (usize, f64, f64);

impl BSpline {
    /// The spline with these control points and their weights; none if knots, weights and control points do not fit
    /// together: a degree from 1 to 25, degree + 1 control points at least, that many more knots than control points, in order, and weights
    /// above 0.
    pub fn new(degree: usize, knots: Vec<f64>, points: &[(Point3<f64>, f64)]) -> Option<Self> {
        let first = points.first().map_or(1.0, |(_, weight)| *weight);
        let fits = (1..=MAX_SPLINE_DEGREE).contains(&degree)
            && points.len() > degree
            && knots.len() == points.len() + degree + 1
            && knots.is_sorted()
            && points.iter().all(|(_, weight)| *weight > 0.0 && weight.is_finite());
        let rational = points.iter().any(|(_, weight)| (weight - first).abs() > 1e-12 * first);
        let points = points.iter().map(|(point, weight)| point.coords.push(1.0) * *weight);
        fits.then(|| Self { degree, knots, points: points.collect(), rational })
    }

    /// The same with knots at 0, 1, 2, …, of which the first and the last are repeated, so that the curve begins at the
    /// first control point and ends at the last one.
    pub fn clamped(degree: usize, points: &[(Point3<f64>, f64)]) -> Option<Self> {
        let last = points.len().checked_sub(degree)?;
        #[expect(clippy::cast_precision_loss, reason = "counts of control points")]
        let knot = |index: usize| index.saturating_sub(degree).min(last) as f64;
        Self::new(degree, (0..=points.len() + degree).map(knot).collect(), points)
    }

    /// Degree: order − 1.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// True if the weights differ.
    pub fn is_rational(&self) -> bool {
        self.rational
    }

    /// True if all control points have the same Z but for 1e-9.
    pub fn is_level(&self) -> bool {
        let z = |point: &Vector4<f64>| point.z / point.w;
        let first = self.points.first().map_or(0.0, z);
        self.points.iter().all(|point| (z(point) - first).abs() <= 1e-9)
    }

    /// The spans on which the curve lives.
    pub fn spans(&self) -> impl Iterator<Item = Span> + '_ {
        (self.degree..self.points.len()).filter_map(|span| {
            let (from, to) = (*self.knots.get(span)?, *self.knots.get(span + 1)?);
            (to > from).then_some((span, from, to))
        })
    }

    /// The value of the span's polar form, weighted: with all arguments equal, the point there.
    pub fn blossom(&self, span: usize, arguments: &[f64]) -> Vector4<f64> {
        let degree = self.degree;
        let first = span - degree;
        let mut points: Vec<Vector4<f64>> =
            self.points.iter().skip(first).take(degree + 1).copied().collect();
        for (round, argument) in (1..).zip(arguments) {
            for index in (round..=degree).rev() {
                let (Some(low), Some(high)) = (
                    self.knots.get(first + index),
                    self.knots.get(first + index + degree + 1 - round),
                ) else {
                    continue;
                };
                let part = (argument - low) / (high - low);
                let (Some(before), Some(here)) =
                    (points.get(index - 1).copied(), points.get(index).copied())
                else {
                    continue;
                };
                if let Some(slot) = points.get_mut(index) {
                    *slot = before + (here - before) * part;
                }
            }
        }
        points.last().copied().unwrap_or_default()
    }

    /// The point at a parameter of a span.
    pub fn at(&self, span: usize, parameter: f64) -> Point3<f64> {
        let arguments: Arguments = [parameter; MAX_SPLINE_DEGREE];
        let point = self.blossom(span, arguments.get(..self.degree).unwrap_or_default());
        Point3::from(point.xyz() / point.w)
    }

    /// The point at a parameter of a span, and the derivative there with respect to the parameter.
    fn with_derivative(&self, (span, from, to): Span, parameter: f64) -> Knot {
        let mut arguments: Arguments = [parameter; MAX_SPLINE_DEGREE];
        let mut value = |last: f64| {
            if let Some(slot) = arguments.first_mut() {
                *slot = last;
            }
            self.blossom(span, arguments.get(..self.degree).unwrap_or_default())
        };
        let (point, low, high) = (value(parameter), value(from), value(to));
        #[expect(clippy::cast_precision_loss, reason = "at most 25")]
        let rate = (high - low) * (self.degree as f64 / (to - from));
        let position = point.xyz() / point.w;
        let derivative = (rate.xyz() - position * rate.w) / point.w;
        Knot { parameter, point: position.into(), derivative: derivative.xy() }
    }

    /// The curve in X and Y as cubics, from `start` to `end` (m, at one height), where it begins and ends but for
    /// rounding: exact, one of each
    /// span, if it is not rational and its degree is at most 3; else within `tolerance` of it (m), with its directions
    /// where they meet.
    pub fn cubics(&self, start: Point3<f64>, end: Point3<f64>, tolerance: f64) -> Vec<Cubic> {
        let mut begin = start;
        let mut cubics = Vec::new();
        let exact = !self.rational && self.degree <= 3;
        let depth = if exact { 0 } else { MAX_HALVINGS };
        for span in self.spans() {
            let (_, from, to) = span;
            let mut ends = [from, to].map(|parameter| self.with_derivative(span, parameter));
            ends[0].point = begin;
            ends[1].point.z = begin.z;
            if span.0 + 1 == self.points.len() {
                ends[1].point = end;
            }
            begin = ends[1].point;
            self.divide(span, ends, tolerance, depth, &mut cubics);
        }
        cubics
    }

    /// Appends the cubics between two parameters of a span.
    fn divide(
        &self,
        span: Span,
        [start, end]: [Knot; 2],
        tolerance: f64,
        depth: u32,
        cubics: &mut Vec<Cubic>,
    ) {
        let width = end.parameter - start.parameter;
        let tangents = [start, end].map(|knot| knot.derivative * width);
        let cubic = Cubic::hermite(start.point, end.point, tangents[0], tangents[1]);
        let off = |part: f64| {
            let point = self.at(span.0, start.parameter + width * part);
            let value = |[a, b, c, d]: [f64; 4]| a + part * (b + part * (c + part * d));
            (value(cubic.x()) - point.x).hypot(value(cubic.y()) - point.y) > tolerance
        };
        if depth == 0 || ![0.25, 0.5, 0.75].into_iter().any(off) {
            cubics.push(cubic);
            return;
        }
        let mut middle = self.with_derivative(span, start.parameter.midpoint(end.parameter));
        middle.point.z = start.point.z;
        self.divide(span, [start, middle], tolerance, depth - 1, cubics);
        self.divide(span, [middle, end], tolerance, depth - 1, cubics);
    }
}

/// A point of a curve.
#[derive(Clone, Copy, Debug)]
struct Knot {
    parameter: f64,
    point: Point3<f64>,
    /// In X and Y.
    derivative: Vector2<f64>,
}
