//! Splines: each knot span as a Bézier curve, or as straight lines.

use super::error::Reason;
use super::primitive::Primitive;
use nalgebra::{Point3, Vector4};

/// A piece is halved at most so often.
const MAX_DEPTH: u32 = 12;
/// Splines of higher degree are not drawn by anything.
const MAX_DEGREE: usize = 25;

/// A spline of the drawing.
pub(super) struct Spline {
    degree: usize,
    knots: Vec<f64>,
    /// x·w, y·w, z·w, w.
    points: Vec<Vector4<f64>>,
    rational: bool,
}

impl Spline {
    /// The spline of an entity.
    ///
    /// # Errors
    /// [`Reason::Degenerate`] if knots, weights and control points do not fit together; [`Reason::NotUnderstood`] if it
    /// is given by the points it passes only.
    pub(super) fn new(entity: &::dxf::entities::Spline) -> Result<Self, Reason> {
        if entity.control_points.is_empty() && !entity.fit_points.is_empty() {
            return Err(Reason::NotUnderstood);
        }
        let degree = usize::try_from(entity.degree_of_curve).unwrap_or(0);
        let count = entity.control_points.len();
        // The sign of all weights together cancels.
        let sign = entity.weight_values.first().map_or(1.0, |first| first.signum());
        let weights: Vec<f64> = entity.weight_values.iter().map(|weight| weight * sign).collect();
        let fits = (1..=MAX_DEGREE).contains(&degree)
            && count > degree
            && entity.knot_values.len() == count + degree + 1
            && (weights.is_empty() || weights.len() == count)
            && entity.knot_values.is_sorted()
            && weights.iter().all(|weight| *weight > 0.0 && weight.is_finite());
        if !fits {
            return Err(Reason::Degenerate);
        }
        let weight = |index: usize| weights.get(index).copied().unwrap_or(1.0);
        let points = entity.control_points.iter().enumerate();
        let first = weight(0);
        Ok(Self {
            degree,
            knots: entity.knot_values.clone(),
            points: points
                .map(|(index, point)| {
                    let weight = weight(index);
                    Vector4::new(point.x, point.y, point.z, 1.0) * weight
                })
                .collect(),
            rational: weights.iter().any(|weight| (weight - first).abs() > 1e-12 * first),
        })
    }

    /// Its pieces, exact where they can be, else straight lines that stay within `tolerance` (in units of the drawing);
    /// true if all are exact.
    pub(super) fn pieces(&self, tolerance: f64) -> (Vec<Primitive>, bool) {
        let level = self.points.iter().all(|point| {
            let z = |point: &Vector4<f64>| point.z / point.w;
            self.points.first().is_some_and(|first| (z(point) - z(first)).abs() <= 1e-9)
        });
        let exact = !self.rational && (self.degree == 1 || self.degree <= 3 && level);
        let mut pieces = Vec::new();
        // The knots on which the curve lives.
        let spans = self.degree..self.points.len();
        for span in spans {
            let (Some(from), Some(to)) = (self.knots.get(span), self.knots.get(span + 1)) else {
                continue;
            };
            if to <= from {
                continue;
            }
            if exact {
                pieces.push(self.bezier(span, *from, *to));
            } else {
                let (start, end) = (self.at(span, *from), self.at(span, *to));
                self.lines(span, [(*from, start), (*to, end)], tolerance, 0, &mut pieces);
            }
        }
        (pieces, exact)
    }

    /// The value of the span's polar form: with all arguments equal, the point there.
    fn blossom(&self, span: usize, arguments: &[f64]) -> Vector4<f64> {
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

    fn at(&self, span: usize, parameter: f64) -> Point3<f64> {
        let arguments = [parameter; MAX_DEGREE];
        let point = self.blossom(span, arguments.get(..self.degree).unwrap_or_default());
        Point3::from(point.xyz() / point.w)
    }

    fn bezier(&self, span: usize, from: f64, to: f64) -> Primitive {
        let point = |arguments: &[f64]| {
            let point = self.blossom(span, arguments);
            Point3::from(point.xyz() / point.w)
        };
        let points = match self.degree {
            1 => return Primitive::Line { start: point(&[from]), end: point(&[to]) },
            2 => {
                let [a, b, c] = [point(&[from, from]), point(&[from, to]), point(&[to, to])];
                // The same parabola as a cubic.
                [a, a + (b - a) * (2.0 / 3.0), c + (b - c) * (2.0 / 3.0), c]
            }
            _ => [
                point(&[from, from, from]),
                point(&[from, from, to]),
                point(&[from, to, to]),
                point(&[to, to, to]),
            ],
        };
        // Level to the last digit.
        let [Point3 { coords: first }, ..] = points;
        Primitive::Bezier(points.map(|point| Point3::new(point.x, point.y, first.z)))
    }

    /// Lines between two parameters and their points.
    fn lines(
        &self,
        span: usize,
        [start, end]: [(f64, Point3<f64>); 2],
        tolerance: f64,
        depth: u32,
        pieces: &mut Vec<Primitive>,
    ) {
        let parameter = |part: f64| start.0 + (end.0 - start.0) * part;
        let off = [0.25, 0.5, 0.75].iter().any(|part| {
            let chord = end.1 - start.1;
            let from = self.at(span, parameter(*part)) - start.1;
            let along = from.dot(&chord) / chord.norm_squared().max(f64::MIN_POSITIVE);
            (from - chord * along.clamp(0.0, 1.0)).norm() > tolerance
        });
        // A piece with an inflection may cross its chord where it is looked at.
        if depth < MAX_DEPTH && (off || depth < 2) {
            let middle = (parameter(0.5), self.at(span, parameter(0.5)));
            self.lines(span, [start, middle], tolerance, depth + 1, pieces);
            self.lines(span, [middle, end], tolerance, depth + 1, pieces);
        } else {
            pieces.push(Primitive::Line { start: start.1, end: end.1 });
        }
    }
}
