//! Primitives of a drawing that stay primitives under insertion: lines, arcs of ellipses, and Bézier curves.

use crate::{Arc, Cubic, Ellipse, Shape};
use nalgebra::{Matrix2, Point2, Point3, Vector2, Vector3};

/// Half axes that are as equal as this part of them make a circle.
const ROUND: f64 = 1e-9;

/// A map of drawings: any in X and Y, scaled along Z, and moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Affine {
    pub(super) plane: Matrix2<f64>,
    pub(super) z: f64,
    pub(super) offset: Vector3<f64>,
}

impl Affine {
    /// Scales everything.
    pub(super) fn scaling(factor: f64) -> Self {
        Self { plane: Matrix2::identity() * factor, z: factor, offset: Vector3::zeros() }
    }

    /// From the coordinates of an entity whose normal is −Z: X is turned around (DXF reference, "arbitrary axis").
    pub(super) fn upside_down() -> Self {
        Self { plane: Matrix2::new(-1.0, 0.0, 0.0, 1.0), z: -1.0, offset: Vector3::zeros() }
    }

    /// `inner` first.
    pub(super) fn after(&self, inner: &Self) -> Self {
        Self {
            plane: self.plane * inner.plane,
            z: self.z * inner.z,
            offset: self.vector(inner.offset) + self.offset,
        }
    }

    pub(super) fn point(&self, point: Point3<f64>) -> Point3<f64> {
        Point3::from(self.vector(point.coords) + self.offset)
    }

    fn vector(&self, vector: Vector3<f64>) -> Vector3<f64> {
        let flat = self.plane * vector.xy();
        Vector3::new(flat.x, flat.y, vector.z * self.z)
    }
}

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
        center: Point2<f64>,
        u: Vector2<f64>,
        v: Vector2<f64>,
        sweep: f64,
    },
    /// The cubic Bézier curve of four points, at one height.
    Bezier {
        points: [Point2<f64>; 4],
        z: f64,
    },
}

impl Primitive {
    /// Counter-clockwise about `center` from the angle `start`, at the height of `center`.
    pub(super) fn arc(center: Point3<f64>, u: Vector2<f64>, v: Vector2<f64>, sweep: f64) -> Self {
        let at = |t: f64| {
            let flat = u * t.cos() + v * t.sin();
            center + Vector3::new(flat.x, flat.y, 0.0)
        };
        let whole = (sweep - std::f64::consts::TAU).abs() < 1e-12;
        let (start, end) = (at(0.0), if whole { at(0.0) } else { at(sweep) });
        Self::Arc { start, end, center: center.xy(), u, v, sweep }
    }

    pub(super) fn start(&self) -> Point3<f64> {
        match self {
            Self::Line { start, .. } | Self::Arc { start, .. } => *start,
            Self::Bezier { points: [start, ..], z } => Point3::new(start.x, start.y, *z),
        }
    }

    pub(super) fn end(&self) -> Point3<f64> {
        match self {
            Self::Line { end, .. } | Self::Arc { end, .. } => *end,
            Self::Bezier { points: [.., end], z } => Point3::new(end.x, end.y, *z),
        }
    }

    pub(super) fn mapped(&self, map: &Affine) -> Self {
        match self {
            Self::Line { start, end } => {
                Self::Line { start: map.point(*start), end: map.point(*end) }
            }
            Self::Arc { start, end, center, u, v, sweep } => Self::Arc {
                start: map.point(*start),
                end: map.point(*end),
                center: map.point(Point3::new(center.x, center.y, 0.0)).xy(),
                u: map.plane * u,
                v: map.plane * v,
                sweep: *sweep,
            },
            Self::Bezier { points, z } => Self::Bezier {
                points: points.map(|point| map.point(Point3::new(point.x, point.y, 0.0)).xy()),
                z: map.point(Point3::new(0.0, 0.0, *z)).z,
            },
        }
    }

    pub(super) fn reversed(&self) -> Self {
        match self {
            Self::Line { start, end } => Self::Line { start: *end, end: *start },
            Self::Arc { start, end, center, u, v, sweep } => {
                let (sin, cos) = sweep.sin_cos();
                Self::Arc {
                    start: *end,
                    end: *start,
                    center: *center,
                    u: u * cos + v * sin,
                    v: u * sin - v * cos,
                    sweep: *sweep,
                }
            }
            Self::Bezier { points: [a, b, c, d], z } => {
                Self::Bezier { points: [*d, *c, *b, *a], z: *z }
            }
        }
    }

    /// With other ends, which must be very near.
    pub(super) fn between(&self, from: Point3<f64>, to: Point3<f64>) -> Self {
        let mut moved = self.clone();
        match &mut moved {
            Self::Line { start, end } | Self::Arc { start, end, .. } => {
                (*start, *end) = (from, to);
            }
            Self::Bezier { points: [first, second, third, last], z } => {
                *second += from.xy() - *first;
                *third += to.xy() - *last;
                (*first, *last, *z) = (from.xy(), to.xy(), from.z);
            }
        }
        moved
    }

    /// At one height.
    pub(super) fn at_height(&self, height: f64) -> Self {
        let mut flat = self.clone();
        match &mut flat {
            Self::Line { start, end } | Self::Arc { start, end, .. } => {
                (start.z, end.z) = (height, height);
            }
            Self::Bezier { z, .. } => *z = height,
        }
        flat
    }

    pub(super) fn is_finite(&self) -> bool {
        let points = |point: Point3<f64>| point.iter().all(|value| value.is_finite());
        points(self.start())
            && points(self.end())
            && match self {
                Self::Line { .. } => true,
                Self::Arc { center, u, v, .. } => {
                    [center.coords, *u, *v].iter().flatten().all(|value| value.is_finite())
                }
                Self::Bezier { points, .. } => {
                    points.iter().flat_map(|point| point.iter()).all(|value| value.is_finite())
                }
            }
    }

    pub(super) fn shape(&self) -> Shape {
        match self {
            Self::Line { start, end } => Shape::Line { start: *start, end: *end },
            Self::Arc { start, end, center, u, v, sweep } => {
                let turn = if u.perp(v) < 0.0 { -sweep } else { *sweep };
                let (long, across) = (u.norm(), v.norm());
                if (long - across).abs() <= ROUND * long && u.dot(v).abs() <= ROUND * long * long {
                    let center = Point3::new(center.x, center.y, 0.0);
                    return Shape::Arc(Arc::new(*start, *end, center, turn));
                }
                // The half axes among all pairs of conjugate half diameters.
                let t = 0.5 * (2.0 * u.dot(v)).atan2(u.norm_squared() - v.norm_squared());
                let (sin, cos) = t.sin_cos();
                let (major, minor) = (u * cos + v * sin, v * cos - u * sin);
                let ellipse = Ellipse::new(*start, *end, *center, major, minor.norm(), turn);
                Shape::Ellipse(Box::new(ellipse))
            }
            Self::Bezier { points: [a, b, c, d], z } => Shape::Cubic(Box::new(Cubic::hermite(
                Point3::new(a.x, a.y, *z),
                Point3::new(d.x, d.y, *z),
                (b - a) * 3.0,
                (d - c) * 3.0,
            ))),
        }
    }
}
