//! Splines: each knot span as a Bézier curve, or as straight lines.

use super::error::Reason;
use super::primitive::Primitive;
use crate::BSpline;
use nalgebra::Point3;

/// A piece is halved at most so often.
const MAX_DEPTH: u32 = 12;

/// A spline of the drawing.
pub(super) struct Spline(BSpline);

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
        // The sign of all weights together cancels.
        let sign = entity.weight_values.first().map_or(1.0, |first| first.signum());
        let (points, weights) = (&entity.control_points, &entity.weight_values);
        if !weights.is_empty() && weights.len() != points.len() {
            return Err(Reason::Degenerate);
        }
        let points = points.iter().enumerate().map(|(index, point)| {
            let weight = weights.get(index).map_or(1.0, |weight| weight * sign);
            (Point3::new(point.x, point.y, point.z), weight)
        });
        let points: Vec<_> = points.collect();
        BSpline::new(degree, entity.knot_values.clone(), &points)
            .map(Self)
            .ok_or(Reason::Degenerate)
    }

    /// Its pieces, exact where they can be, else straight lines that stay within `tolerance` (in units of the drawing);
    /// true if all are exact.
    pub(super) fn pieces(&self, tolerance: f64) -> (Vec<Primitive>, bool) {
        let Self(spline) = self;
        let (degree, level) = (spline.degree(), spline.is_level());
        let exact = !spline.is_rational() && (degree == 1 || degree <= 3 && level);
        let mut pieces = Vec::new();
        for (span, from, to) in spline.spans() {
            if exact {
                pieces.push(self.bezier(span, from, to));
            } else {
                let (start, end) = (spline.at(span, from), spline.at(span, to));
                self.lines(span, [(from, start), (to, end)], tolerance, 0, &mut pieces);
            }
        }
        (pieces, exact)
    }

    fn bezier(&self, span: usize, from: f64, to: f64) -> Primitive {
        let point = |arguments: &[f64]| {
            let point = self.0.blossom(span, arguments);
            Point3::from(point.xyz() / point.w)
        };
        let points = match self.0.degree() {
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
            let from = self.0.at(span, parameter(*part)) - start.1;
            let along = from.dot(&chord) / chord.norm_squared().max(f64::MIN_POSITIVE);
            (from - chord * along.clamp(0.0, 1.0)).norm() > tolerance
        });
        // A piece with an inflection may cross its chord where it is looked at.
        if depth < MAX_DEPTH && (off || depth < 2) {
            let middle = (parameter(0.5), self.0.at(span, parameter(0.5)));
            self.lines(span, [start, middle], tolerance, depth + 1, pieces);
            self.lines(span, [middle, end], tolerance, depth + 1, pieces);
        } else {
            pieces.push(Primitive::Line { start: start.1, end: end.1 });
        }
    }
}
