//! Planar geometry: lines and arcs in X and Y, for tool radius correction and loop avoidance.

mod biarc;
mod distance;
mod intersect;
#[cfg(test)]
mod tests;

pub(super) use biarc::{Fit, fit};
pub(super) use distance::distance;
pub(super) use intersect::{Crossing, crossings};

use crate::{Plane, Shape};
use nalgebra::{Point2, Point3, Vector2};
use std::f64::consts::TAU;

/// The projection of a line or an arc onto X and Y, parametrised from 0 at its start to 1 at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Curve {
    /// Straight.
    Line {
        /// Start, m.
        start: Point2<f64>,
        /// End, m.
        end: Point2<f64>,
    },
    /// About a centre.
    Arc(Round),
}

/// An arc about a centre. Its radius grows linearly with the angle from that of the start to that of the end, as that
/// of [`crate::Arc`] does: they differ by the rounding of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Round {
    pub(super) start: Point2<f64>,
    pub(super) end: Point2<f64>,
    pub(super) center: Point2<f64>,
    pub(super) radius: f64,
    pub(super) end_radius: f64,
    pub(super) start_angle: f64,
    /// Positive counter-clockwise.
    pub(super) sweep: f64,
}

impl Round {
    pub(super) fn new(
        start: Point2<f64>,
        end: Point2<f64>,
        center: Point2<f64>,
        sweep: f64,
    ) -> Self {
        let (from, to) = (start - center, end - center);
        Self {
            start,
            end,
            center,
            radius: from.norm(),
            end_radius: to.norm(),
            start_angle: from.y.atan2(from.x),
            sweep,
        }
    }

    fn radius_at(&self, u: f64) -> f64 {
        self.radius + u * (self.end_radius - self.radius)
    }

    fn mean_radius(&self) -> f64 {
        self.radius.midpoint(self.end_radius)
    }

    /// The parameters, from 0 to 1, at which the arc is at `angle` as seen from its centre: several on more than one
    /// turn. `slack` is how far beyond the ends counts as the end.
    fn parameters_at(&self, angle: f64, slack: f64) -> impl Iterator<Item = f64> + use<> {
        let turn = TAU / self.sweep.abs();
        let forwards = (angle - self.start_angle) * self.sweep.signum();
        let first = forwards.rem_euclid(TAU) / self.sweep.abs();
        // Just before the start is a whole turn ahead.
        let first = if turn - first <= slack { first - turn } else { first };
        (0..MOST_TURNS)
            .map(move |turns| first + f64::from(turns) * turn)
            .take_while(move |u| *u <= 1.0 + slack)
            .map(|u| u.clamp(0.0, 1.0))
    }
}

/// No arc is followed for more turns than this where turns matter.
const MOST_TURNS: u32 = 8;

impl Curve {
    /// The projection of `shape`; none if that is neither a line nor an arc.
    pub(super) fn of(shape: &Shape) -> Option<Self> {
        match shape {
            Shape::Line { start, end } => Some(Self::Line { start: start.xy(), end: end.xy() }),
            Shape::Arc(arc) if arc.plane() == Plane::Xy => Some(Self::Arc(Round::new(
                arc.start().xy(),
                arc.end().xy(),
                arc.center().xy(),
                arc.sweep(),
            ))),
            Shape::Arc(_) | Shape::Ellipse(_) | Shape::Cubic(_) => None,
        }
    }

    /// The shape with this projection and these heights at its ends.
    pub(super) fn shape(&self, start_z: f64, end_z: f64) -> Shape {
        let at = |point: Point2<f64>, z: f64| Point3::new(point.x, point.y, z);
        match self {
            Self::Line { start, end } => {
                Shape::Line { start: at(*start, start_z), end: at(*end, end_z) }
            }
            Self::Arc(arc) => Shape::Arc(crate::Arc::new(
                at(arc.start, start_z),
                at(arc.end, end_z),
                at(arc.center, start_z),
                arc.sweep,
            )),
        }
    }

    pub(super) fn start(&self) -> Point2<f64> {
        match self {
            Self::Line { start, .. } => *start,
            Self::Arc(arc) => arc.start,
        }
    }

    pub(super) fn end(&self) -> Point2<f64> {
        match self {
            Self::Line { end, .. } => *end,
            Self::Arc(arc) => arc.end,
        }
    }

    /// Length in X and Y, m.
    pub(super) fn length(&self) -> f64 {
        match self {
            Self::Line { start, end } => (end - start).norm(),
            Self::Arc(arc) => (arc.mean_radius() * arc.sweep).hypot(arc.end_radius - arc.radius),
        }
    }

    /// The point at `u`.
    pub(super) fn at(&self, u: f64) -> Point2<f64> {
        if u <= 0.0 {
            return self.start();
        }
        if u >= 1.0 {
            return self.end();
        }
        match self {
            Self::Line { start, end } => start + (end - start) * u,
            Self::Arc(arc) => {
                let (sin, cos) = (arc.start_angle + u * arc.sweep).sin_cos();
                arc.center + Vector2::new(cos, sin) * arc.radius_at(u)
            }
        }
    }

    /// Derivative with respect to `u`, m.
    pub(super) fn derivative(&self, u: f64) -> Vector2<f64> {
        match self {
            Self::Line { start, end } => end - start,
            Self::Arc(arc) => {
                let (sin, cos) = (arc.start_angle + u * arc.sweep).sin_cos();
                Vector2::new(-sin, cos) * (arc.radius_at(u) * arc.sweep)
                    + Vector2::new(cos, sin) * (arc.end_radius - arc.radius)
            }
        }
    }

    /// Unit direction at `u`; zero on a curve of length zero.
    pub(super) fn direction(&self, u: f64) -> Vector2<f64> {
        self.derivative(u).try_normalize(0.0).unwrap_or_default()
    }

    /// The piece between two parameters.
    pub(super) fn section(&self, from: f64, to: f64) -> Self {
        let (start, end) = (self.at(from), self.at(to));
        match self {
            Self::Line { .. } => Self::Line { start, end },
            Self::Arc(arc) => {
                let part = to.min(1.0) - from.max(0.0);
                Self::Arc(Round::new(start, end, arc.center, arc.sweep * part))
            }
        }
    }

    /// The same curve with ends that lie elsewhere by rounding.
    pub(super) fn with_ends(&self, start: Point2<f64>, end: Point2<f64>) -> Self {
        match self {
            Self::Line { .. } => Self::Line { start, end },
            Self::Arc(arc) => Self::Arc(Round::new(start, end, arc.center, arc.sweep)),
        }
    }

    /// The curve at `distance` to the left of this one (negative: to the right). An arc whose radius is smaller turns
    /// inside out: it then runs on the other side of its centre and backwards, which the second value says.
    pub(super) fn offset(&self, distance: f64) -> (Self, bool) {
        match self {
            Self::Line { start, end } => {
                let direction = self.direction(0.0);
                let shift = left(&direction) * distance;
                (Self::Line { start: start + shift, end: end + shift }, false)
            }
            Self::Arc(arc) => {
                let growth = -distance * arc.sweep.signum();
                let moved = |point: &Point2<f64>, radius: f64| {
                    let outward = (point - arc.center) / radius;
                    point + outward * growth
                };
                let start = moved(&arc.start, arc.radius);
                let end = moved(&arc.end, arc.end_radius);
                let inside_out = arc.radius + growth <= 0.0 || arc.end_radius + growth <= 0.0;
                (Self::Arc(Round::new(start, end, arc.center, arc.sweep)), inside_out)
            }
        }
    }

    /// A box around it.
    pub(super) fn bounds(&self) -> Bounds {
        let (start, end) = (self.start(), self.end());
        let corners = Bounds { low: start.inf(&end), high: start.sup(&end) };
        match self {
            Self::Line { .. } => corners,
            Self::Arc(arc) => {
                let radius = arc.radius.max(arc.end_radius);
                // Height of an arc above its chord.
                let half = 0.5 * arc.sweep.abs();
                let bulge = if half < std::f64::consts::FRAC_PI_2 {
                    radius * (1.0 - half.cos()) + (arc.end_radius - arc.radius).abs()
                } else {
                    2.0 * radius
                };
                corners.widened(bulge)
            }
        }
    }
}

/// The vector turned by a quarter to the left.
pub(super) fn left(vector: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-vector.y, vector.x)
}

/// A box with sides along X and Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    low: Point2<f64>,
    high: Point2<f64>,
}

impl Bounds {
    /// The same with a margin.
    pub(super) fn widened(&self, margin: f64) -> Self {
        let margin = Vector2::repeat(margin);
        Self { low: self.low - margin, high: self.high + margin }
    }

    /// The box around both.
    pub(super) fn around(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// True if the two have a point in common.
    pub(super) fn meets(&self, other: &Self) -> bool {
        self.low.x <= other.high.x
            && other.low.x <= self.high.x
            && self.low.y <= other.high.y
            && other.low.y <= self.high.y
    }
}
