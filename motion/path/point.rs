//! Path point: position and its derivatives over path length.

use nalgebra::{Point3, Vector3};

/// Position and its derivatives with respect to path length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Position, m.
    pub position: Point3<f64>,
    /// First derivative: the unit tangent (zero on an element of length zero).
    pub tangent: Vector3<f64>,
    /// Second derivative: curvature times the unit normal, 1/m.
    pub curvature: Vector3<f64>,
    /// Third derivative, 1/m²: zero on a line, −κ² times the tangent on a circle, and zero at a cusp.
    pub curvature_rate: Vector3<f64>,
}

impl PathPoint {
    /// A point from which nothing leads on.
    pub fn resting(position: Point3<f64>) -> Self {
        let zero = Vector3::zeros();
        Self { position, tangent: zero, curvature: zero, curvature_rate: zero }
    }
}
