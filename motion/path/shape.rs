//! Geometry of a path element: position and derivatives over path length.

use super::{Arc, Cubic, Ellipse, PathPoint};
use nalgebra::{Point3, Vector2, Vector3};

/// Geometry of an element. Parametrised by the path length `s` in m from its start.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Straight from start to end.
    Line {
        /// Start, m.
        start: Point3<f64>,
        /// End, m.
        end: Point3<f64>,
    },
    /// Circular arc or helix.
    Arc(Arc),
    /// Arc of an ellipse.
    Ellipse(Box<Ellipse>),
    /// Cubic curve: spline or parabola.
    Cubic(Box<Cubic>),
}

impl Shape {
    /// Path length, m (`SMC_CalcLengthGeo`, manual 11.8).
    pub fn length(&self) -> f64 {
        match self {
            Self::Line { start, end } => (end - start).norm(),
            Self::Arc(arc) => arc.length(),
            Self::Ellipse(ellipse) => ellipse.length(),
            Self::Cubic(cubic) => cubic.length(),
        }
    }

    /// Start, m.
    pub fn start(&self) -> Point3<f64> {
        match self {
            Self::Line { start, .. } => *start,
            Self::Arc(arc) => arc.start(),
            Self::Ellipse(ellipse) => ellipse.start(),
            Self::Cubic(cubic) => cubic.start(),
        }
    }

    /// End, m (`SMC_CalcEndPnt`, manual 11.8).
    pub fn end(&self) -> Point3<f64> {
        match self {
            Self::Line { end, .. } => *end,
            Self::Arc(arc) => arc.end(),
            Self::Ellipse(ellipse) => ellipse.end(),
            Self::Cubic(cubic) => cubic.end(),
        }
    }

    /// Position and derivatives at `s` m from the start, 0 ≤ `s` ≤ [`Self::length`].
    ///
    /// At 0 and at the length the positions are start and end, bit for bit. Beyond them it is the caller who is wrong;
    /// the position stays at start or end.
    pub fn at(&self, s: f64) -> PathPoint {
        match self {
            Self::Line { start, end } => on_line(start, end, s),
            Self::Arc(arc) => arc.at(s),
            Self::Ellipse(ellipse) => ellipse.at(s),
            Self::Cubic(cubic) => cubic.at(s),
        }
    }

    /// Fourth derivative of X and Y at `s` m from the start, 1/m³: needed with [`Self::at`] for the third derivative of
    /// the direction seen from above. Zero on a line and at a cusp.
    pub fn fourth_at(&self, s: f64) -> Vector2<f64> {
        match self {
            Self::Arc(arc) if arc.length() > 0.0 => arc.fourth(s).xy(),
            Self::Line { .. } | Self::Arc(_) => Vector2::zeros(),
            Self::Ellipse(ellipse) => ellipse.fourth(s),
            Self::Cubic(cubic) => cubic.fourth(s),
        }
    }

    /// Unit tangent at the start; zero on a shape of length zero.
    pub fn start_tangent(&self) -> Vector3<f64> {
        match self {
            Self::Line { start, end } => direction(start, end),
            _ => self.at(0.0).tangent,
        }
    }

    /// Unit tangent at the end; zero on a shape of length zero.
    pub fn end_tangent(&self) -> Vector3<f64> {
        match self {
            Self::Line { start, end } => direction(start, end),
            _ => self.at(self.length()).tangent,
        }
    }
}

/// From `start` to `end`; zero if they are the same.
fn direction(start: &Point3<f64>, end: &Point3<f64>) -> Vector3<f64> {
    (end - start).try_normalize(0.0).unwrap_or_default()
}

fn on_line(start: &Point3<f64>, end: &Point3<f64>, s: f64) -> PathPoint {
    let length = (end - start).norm();
    if length <= 0.0 {
        return PathPoint::resting(*end);
    }
    let position = if s <= 0.0 {
        *start
    } else if s >= length {
        *end
    } else {
        start + (end - start) * (s / length)
    };
    PathPoint { tangent: (end - start) / length, ..PathPoint::resting(position) }
}
