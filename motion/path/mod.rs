//! Path elements: what the manual calls `SMC_GEOINFO` (6.5).

mod arc;
mod shape;
#[cfg(test)]
mod tests;

pub use arc::Arc;
pub use shape::{PathPoint, Shape};

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

impl PathElement {
    /// Length of the path to travel, m (`dLength`). A jump has none, however far it goes.
    pub fn length(&self) -> f64 {
        match self.kind {
            ElementKind::Jump => 0.0,
            ElementKind::Rapid | ElementKind::Cut => self.shape.length(),
        }
    }

    /// Start, m (`piStartPos`).
    pub fn start(&self) -> Point3<f64> {
        self.shape.start()
    }

    /// End, m (`piDestPos`).
    pub fn end(&self) -> Point3<f64> {
        self.shape.end()
    }

    /// Position and derivatives at path length `s`, m, from the start; see [`Shape::at`].
    pub fn at(&self, s: f64) -> PathPoint {
        self.shape.at(s)
    }

    /// Direction in which the path leaves the start; zero on an element of length zero.
    pub fn start_tangent(&self) -> Vector3<f64> {
        self.shape.start_tangent()
    }

    /// Direction in which the path arrives at the end; zero on an element of length zero.
    pub fn end_tangent(&self) -> Vector3<f64> {
        self.shape.end_tangent()
    }
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
