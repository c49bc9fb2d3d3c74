//! Primitives of a drawing that stay primitives under insertion: lines, arcs of ellipses, and Bézier curves.

use crate::{Arc, Cubic, Ellipse, Shape};
use nalgebra::{Affine3, Matrix4, Point3, Translation3, Vector2, Vector3};

/// Half axes that are as equal as this part of them make a circle.
const ROUND: f64 = 1e-9;

/// Scales by these factors. With (−1, 1, −1) it leads from the coordinates of an entity whose normal is −Z: X is turned
/// around (DXF reference, "arbitrary axis").
pub(super) fn scaling(x: f64, y: f64, z: f64) -> Affine3<f64> {
    Affine3::from_matrix_unchecked(Matrix4::new_nonuniform_scaling(&Vector3::new(x, y, z)))
}

/// A piece of a drawing. Arcs and Bézier curves are level.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Primitive {
    Line {
        start: Point3<f64>,
        end: Point3<f64>,
    },
    /// `center + u·cos t + v·sin t`, t from 0 to `sweep`.
    Arc {
        start: Point3<f64>,
        end: Point3<f64>,
        center: Point3<f64>,
        u: Vector3<f64>,
        v: Vector3<f64>,
        sweep: f64,
    },
    /// The cubic Bézier curve of four points.
    Bezier([Point3<f64>; 4]),
}

impl Primitive {
    /// About `center` from `center + u`, counter-clockwise if `v` is on the left of `u`.
    pub(super) fn arc(center: Point3<f64>, u: Vector2<f64>, v: Vector2<f64>, sweep: f64) -> Self {
        let [u, v] = [u, v].map(|flat| flat.push(0.0));
        let at = |t: f64| center + u * t.cos() + v * t.sin();
        let whole = (sweep - std::f64::consts::TAU).abs() < 1e-12;
        let (start, end) = (at(0.0), if whole { at(0.0) } else { at(sweep) });
        Self::Arc { start, end, center, u, v, sweep }
    }

    pub(super) fn start(&self) -> Point3<f64> {
        match self {
            Self::Line { start, .. } | Self::Arc { start, .. } | Self::Bezier([start, ..]) => {
                *start
            }
        }
    }

    pub(super) fn end(&self) -> Point3<f64> {
        match self {
            Self::Line { end, .. } | Self::Arc { end, .. } | Self::Bezier([.., end]) => *end,
        }
    }

    pub(super) fn mapped(&self, map: &Affine3<f64>) -> Self {
        match self {
            Self::Line { start, end } => Self::Line { start: map * start, end: map * end },
            Self::Arc { start, end, center, u, v, sweep } => Self::Arc {
                start: map * start,
                end: map * end,
                center: map * center,
                u: map * u,
                v: map * v,
                sweep: *sweep,
            },
            Self::Bezier(points) => Self::Bezier(points.map(|point| map * point)),
        }
    }

    pub(super) fn reversed(&self) -> Self {
        match *self {
            Self::Line { start, end } => Self::Line { start: end, end: start },
            Self::Arc { start, end, center, u, v, sweep } => {
                let (sin, cos) = sweep.sin_cos();
                let (u, v) = (u * cos + v * sin, u * sin - v * cos);
                Self::Arc { start: end, end: start, center, u, v, sweep }
            }
            Self::Bezier([a, b, c, d]) => Self::Bezier([d, c, b, a]),
        }
    }

    /// With other ends, which must be very near.
    pub(super) fn between(&self, from: Point3<f64>, to: Point3<f64>) -> Self {
        let mut moved = self.clone();
        match &mut moved {
            Self::Line { start, end } | Self::Arc { start, end, .. } => (*start, *end) = (from, to),
            Self::Bezier([first, second, third, last]) => {
                *second += from - *first;
                *third += to - *last;
                (*first, *last) = (from, to);
            }
        }
        moved
    }

    /// At one height.
    pub(super) fn at_height(&self, height: f64) -> Self {
        let to: Affine3<f64> = nalgebra::convert(Translation3::new(0.0, 0.0, height));
        self.mapped(&(to * scaling(1.0, 1.0, 0.0)))
    }

    pub(super) fn is_finite(&self) -> bool {
        let points = match self {
            Self::Line { start, end } => vec![*start, *end],
            Self::Arc { start, end, center, u, v, .. } => {
                vec![*start, *end, *center, Point3::from(*u), Point3::from(*v)]
            }
            Self::Bezier(points) => points.to_vec(),
        };
        points.iter().flat_map(|point| point.iter()).all(|value| value.is_finite())
    }

    pub(super) fn shape(&self) -> Shape {
        match self {
            Self::Line { start, end } => Shape::Line { start: *start, end: *end },
            Self::Arc { start, end, center, u, v, sweep } => {
                let (u, v) = (u.xy(), v.xy());
                let turn = if u.perp(&v) < 0.0 { -sweep } else { *sweep };
                let (long, across) = (u.norm(), v.norm());
                if (long - across).abs() <= ROUND * long && u.dot(&v).abs() <= ROUND * long * long {
                    let center = Point3::new(center.x, center.y, 0.0);
                    return Shape::Arc(Arc::new(*start, *end, center, turn));
                }
                // The half axes among all pairs of conjugate half diameters.
                let t = 0.5 * (2.0 * u.dot(&v)).atan2(u.norm_squared() - v.norm_squared());
                let (sin, cos) = t.sin_cos();
                let (major, minor) = (u * cos + v * sin, v * cos - u * sin);
                let ellipse = Ellipse::new(*start, *end, center.xy(), major, minor.norm(), turn);
                Shape::Ellipse(Box::new(ellipse))
            }
            Self::Bezier([a, b, c, d]) => {
                let cubic = Cubic::hermite(*a, *d, (b - a).xy() * 3.0, (d - c).xy() * 3.0);
                Shape::Cubic(Box::new(cubic))
            }
        }
    }
}
