//! Circular arcs and helices (G2, G3).

use super::{PathPoint, Plane};
use nalgebra::{Point3, Vector3};

/// An arc in a plane, with the coordinate along the plane's normal linear in the path length: the manual's `CLW` and
/// `CCLW`, which lie in X and Y (manual 3.1).
///
/// Start and end are kept as programmed, bit for bit, so that neighbouring elements meet exactly. In a real program
/// start and end are rarely at exactly the same distance from the centre, because its numbers are rounded; the radius
/// then grows linearly with the angle from the one to the other, which is a circle up to that rounding.
///
/// ```text
/// position(u) = center + r(u)·(cos φ(u), sin φ(u), 0) + u·rise·normal,   u = s / length from 0 to 1
/// r(u) = radius + u·(end radius − radius),   φ(u) = start angle + u·sweep
/// length² = (mean radius · sweep)² + (end radius − radius)² + rise²
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Arc {
    plane: Plane,
    start: Point3<f64>,
    end: Point3<f64>,
    center: Point3<f64>,
    rise: f64,
    radius: f64,
    end_radius: f64,
    start_angle: f64,
    sweep: f64,
    length: f64,
}

impl Arc {
    /// The arc in X and Y from `start` to `end` (m) about the vertical axis through `center` (its z does not matter),
    /// turning by `sweep` (rad, positive counter-clockwise).
    ///
    /// The caller answers for `sweep` being an angle from start to end, and for both lying on one circle about the
    /// centre but for rounding.
    pub fn new(start: Point3<f64>, end: Point3<f64>, center: Point3<f64>, sweep: f64) -> Self {
        Self::in_plane(Plane::Xy, start, end, center, sweep)
    }

    /// The same in any `plane`; the component of `center` along the plane's normal does not matter.
    pub fn in_plane(
        plane: Plane,
        start: Point3<f64>,
        end: Point3<f64>,
        center: Point3<f64>,
        sweep: f64,
    ) -> Self {
        let from = plane.split(&(start - center));
        let to = plane.split(&(end - center));
        let radius = from[0].hypot(from[1]);
        let end_radius = to[0].hypot(to[1]);
        // Not by way of the centre, whose height does not matter.
        let [_, _, rise] = plane.split(&(end - start));
        let around = radius.midpoint(end_radius) * sweep;
        let length = Vector3::new(around, end_radius - radius, rise).norm();
        let [first, second, _] = plane.split(&center.coords);
        let [_, _, height] = plane.split(&start.coords);
        Self {
            plane,
            start,
            end,
            center: Point3::from(plane.join([first, second, height])),
            rise,
            radius,
            end_radius,
            start_angle: from[1].atan2(from[0]),
            sweep,
            length,
        }
    }

    /// The plane in which it turns.
    pub fn plane(&self) -> Plane {
        self.plane
    }

    /// Start, m.
    pub fn start(&self) -> Point3<f64> {
        self.start
    }

    /// End, m.
    pub fn end(&self) -> Point3<f64> {
        self.end
    }

    /// Centre, m, at the height of the start (the manual's `dP1`, `dP2`).
    pub fn center(&self) -> Point3<f64> {
        self.center
    }

    /// Radius at the start, m (the manual's `dP3`).
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Radius at the end, m: that at the start but for the rounding of the program.
    pub fn end_radius(&self) -> f64 {
        self.end_radius
    }

    /// Angle of the start as seen from the centre, rad, 0 = the plane's first axis, counter-clockwise, −π to π (the
    /// manual's `dT1`).
    pub fn start_angle(&self) -> f64 {
        self.start_angle
    }

    /// Angle swept, rad: positive counter-clockwise (G3), negative clockwise (G2). The manual's `dT2` has the opposite
    /// sign.
    pub fn sweep(&self) -> f64 {
        self.sweep
    }

    /// Distance from start to end along the plane's normal, m.
    pub fn rise(&self) -> f64 {
        self.rise
    }

    /// Path length, m (manual 6.2.9): along the helix, √(Lxy² + ΔZ²).
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Position and derivatives at `s` m from the start.
    pub(super) fn at(&self, s: f64) -> PathPoint {
        if self.length <= 0.0 {
            return PathPoint::resting(self.end);
        }
        let u = s / self.length;
        let growth = self.end_radius - self.radius;
        let radius = self.radius + u * growth;
        let (sin, cos) = (self.start_angle + u * self.sweep).sin_cos();
        let outward = self.plane.join([cos, sin, 0.0]);
        let around = self.plane.join([-sin, cos, 0.0]);
        let normal = self.plane.normal();
        let position = if s <= 0.0 {
            self.start
        } else if s >= self.length {
            self.end
        } else {
            self.center + outward * radius + normal * (u * self.rise)
        };
        // Angle and radius per metre of path.
        let turn = self.sweep / self.length;
        let widening = growth / self.length;
        let tangent =
            outward * widening + around * (radius * turn) + normal * (self.rise / self.length);
        let curvature = (around * (2.0 * widening) - outward * (radius * turn)) * turn;
        let curvature_rate =
            (outward * (3.0 * widening) + around * (radius * turn)) * (-turn * turn);
        PathPoint { position, tangent, curvature, curvature_rate }
    }

    /// The fourth derivative of the position at `s` m from the start, 1/m³.
    pub(super) fn fourth(&self, s: f64) -> Vector3<f64> {
        let (sin, cos) = (self.start_angle + s / self.length * self.sweep).sin_cos();
        let outward = self.plane.join([cos, sin, 0.0]);
        let around = self.plane.join([-sin, cos, 0.0]);
        let growth = self.end_radius - self.radius;
        let radius = self.radius + s / self.length * growth;
        let turn = self.sweep / self.length;
        let widening = growth / self.length;
        (outward * (radius * turn) - around * (4.0 * widening)) * (turn * turn * turn)
    }
}
