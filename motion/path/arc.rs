//! Circular arcs and helices about an axis parallel to z (G2, G3).

use nalgebra::Point3;

/// An arc in X and Y about a vertical axis, with Z linear in the path length (manual 3.1: only X and Y follow
/// curves).
#[derive(Clone, Debug, PartialEq)]
pub struct Arc {
    /// Centre, m; its z is that of the start.
    pub center: Point3<f64>,
    /// Radius, m.
    pub radius: f64,
    /// Angle of the start as seen from the centre, rad, 0 = +x, counter-clockwise.
    pub start_angle: f64,
    /// Angle swept, rad: positive counter-clockwise (G3), negative clockwise (G2). The manual's `dT2` has the
    /// opposite sign.
    pub sweep: f64,
    /// Height gained from start to end, m.
    pub rise: f64,
}
