//! Circular arcs and helices about an axis parallel to z (G2, G3).

use super::PathPoint;
use nalgebra::{Point3, Vector3};

/// An arc in X and Y about a vertical axis, with Z linear in the path length (manual 3.1: only X and Y follow
/// curves): the manual's `CLW` and `CCLW`.
///
/// Start and end are kept as programmed, bit for bit, so that neighbouring elements meet exactly. In a real program
/// start and end are rarely at exactly the same distance from the centre, because its numbers are rounded; the radius
/// then grows linearly with the angle from the one to the other, which is a circle up to that rounding.
///
/// ```text
/// position(u) = center + r(u)·(cos φ(u), sin φ(u), 0) + u·rise·z,   u = s / length from 0 to 1
/// r(u) = radius + u·(end radius − radius),   φ(u) = start angle + u·sweep
/// length² = (mean radius · sweep)² + (end radius − radius)² + rise²
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Arc {
    start: Point3<f64>,
    end: Point3<f64>,
    center: Point3<f64>,
    radius: f64,
    end_radius: f64,
    start_angle: f64,
    sweep: f64,
    length: f64,
}

impl Arc {
    /// The arc from `start` to `end` (m) about the vertical axis through `center` (its z does not matter), turning by
    /// `sweep` (rad, positive counter-clockwise).
    ///
    /// The caller answers for `sweep` being an angle from start to end, and for both lying on one circle about the
    /// centre but for rounding.
    pub fn new(start: Point3<f64>, end: Point3<f64>, center: Point3<f64>, sweep: f64) -> Self {
        let (from, to) = (start - center, end - center);
        let radius = from.x.hypot(from.y);
        let end_radius = to.x.hypot(to.y);
        let around = radius.midpoint(end_radius) * sweep;
        let length = Vector3::new(around, end_radius - radius, end.z - start.z).norm();
        Self {
            start,
            end,
            center: Point3::new(center.x, center.y, start.z),
            radius,
            end_radius,
            start_angle: from.y.atan2(from.x),
            sweep,
            length,
        }
    }

    /// Start, m.
    pub fn start(&self) -> Point3<f64> {
        self.start
    }

    /// End, m.
    pub fn end(&self) -> Point3<f64> {
        self.end
    }

    /// Centre, m; its z is that of the start (the manual's `dP1`, `dP2`).
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

    /// Angle of the start as seen from the centre, rad, 0 = +x, counter-clockwise, −π to π (the manual's `dT1`).
    pub fn start_angle(&self) -> f64 {
        self.start_angle
    }

    /// Angle swept, rad: positive counter-clockwise (G3), negative clockwise (G2). The manual's `dT2` has the opposite
    /// sign.
    pub fn sweep(&self) -> f64 {
        self.sweep
    }

    /// Height gained from start to end, m.
    pub fn rise(&self) -> f64 {
        self.end.z - self.start.z
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
        let outward = Vector3::new(cos, sin, 0.0);
        let around = Vector3::new(-sin, cos, 0.0);
        let position = if s <= 0.0 {
            self.start
        } else if s >= self.length {
            self.end
        } else {
            self.center + outward * radius + Vector3::z() * (u * self.rise())
        };
        // Angle and radius per metre of path.
        let turn = self.sweep / self.length;
        let widening = growth / self.length;
        let tangent = outward * widening
            + around * (radius * turn)
            + Vector3::z() * (self.rise() / self.length);
        let curvature = (around * (2.0 * widening) - outward * (radius * turn)) * turn;
        PathPoint { position, tangent, curvature }
    }
}
