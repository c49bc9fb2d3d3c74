//! Path elements: what the manual calls `SMC_GEOINFO` (6.5).

mod arc;

pub use arc::Arc;

use crate::Place;
use nalgebra::{Point3, Vector3};

/// One piece of the tool's path, in the work frame, with the limits that hold on it.
#[derive(Clone, Debug, PartialEq)]
pub struct PathElement {
    /// The block it comes from.
    pub place: Place,
    /// Whether the tool cuts, travels or is set somewhere else.
    pub kind: ElementKind,
    /// Its geometry.
    pub shape: Shape,
    /// Programmed velocity along the path (F), m/s.
    pub feed: f64,
    /// Programmed acceleration along the path (E+), m/s², positive.
    pub acceleration: f64,
    /// Programmed deceleration along the path (E−), m/s², positive.
    pub deceleration: f64,
    /// Largest velocity with which the path may go on into the next element, m/s. The decoder leaves it at 0;
    /// [`crate::prepare::CheckVelocities`] sets it.
    pub end_velocity: f64,
}

/// What an element does, apart from its shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ElementKind {
    /// G0: positioning, tool not engaged (the manual's `LINPOS`). The path stops at both of its ends.
    Rapid,
    /// G1, G2, G3: the tool cuts along the shape.
    Cut,
    /// G92 after the first motion: the set-point jumps from the start of the shape to its end, without a path.
    Jump,
}

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
}

/// Position and its derivatives with respect to path length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Position, m.
    pub position: Point3<f64>,
    /// First derivative: the unit tangent (zero on an element of length zero).
    pub tangent: Vector3<f64>,
    /// Second derivative: curvature times the unit normal, 1/m.
    pub curvature: Vector3<f64>,
}
