//! Path elements (`SMC_GEOINFO`, manual 6.5).
//!
//! [`PathElement`] is one curve of the tool's path with its feed and its place in the program. [`prepare`] changes paths
//! for the tool and for corners, [`dxf`] reads and writes drawings. Lengths are metres, times seconds.
//!
//! ```
//! use std::f64::consts::FRAC_PI_2;
//! use nalgebra::Point3;
//! use twin_path::{Arc, ElementKind, PathElement, Place, Shape};
//!
//! // A quarter circle of radius 50 mm about the origin, counter-clockwise from +x to +y.
//! let [start, end] = [Point3::new(0.05, 0.0, 0.0), Point3::new(0.0, 0.05, 0.0)];
//! let arc = Arc::new(start, end, Point3::origin(), FRAC_PI_2);
//! let mut element = PathElement::new(Place::default(), ElementKind::Cut, Shape::Arc(arc));
//! element.feed = 0.1; // 100 mm/s
//! assert!((element.length() - 0.05 * FRAC_PI_2).abs() < 1e-15);
//! // Half-way, at 45 degrees: the tangent has length 1, the curvature 1/r = 20 per metre towards the centre.
//! let middle = element.at(element.length() / 2.0);
//! assert!((middle.position.x - 0.05 * 0.5_f64.sqrt()).abs() < 1e-12);
//! assert!((middle.tangent.norm() - 1.0).abs() < 1e-12);
//! assert!((middle.curvature.norm() - 20.0).abs() < 1e-9);
//! ```

mod adapters;
mod arc;
mod bounds;
mod cubic;
mod curve;
mod details;
mod disc;
pub mod dxf;
mod ellipse;
mod marks;
mod operations;
mod place;
mod plane;
mod point;
pub mod prepare;
mod probing;
mod shape;
mod spline;
#[cfg(test)]
mod tests;
mod units;

pub use adapters::{Chords, Linearise, MapPath, SplitAt};
pub use arc::Arc;
pub use bounds::Bounds;
pub use cubic::{Cubic, cardinal_tangent, end_tangent};
pub use details::{
    AxisMask, Details, EXTRA_AXES, ExtraAxes, ExtraPosition, MAX_SWITCHES, MParameters, Spindle,
    Switch, Switches, Words,
};
pub use disc::PathDisc;
pub use ellipse::{Ellipse, EllipseError};
pub use marks::Marks;
pub use operations::{OperationError, Similarity, reversed};
pub use place::{FileLine, FilePath, LineKey, Place};
pub use plane::Plane;
pub use point::PathPoint;
pub use probing::{ProbeOutcome, ProbeTrip, Probing};
pub use shape::Shape;
pub use spline::{BSpline, Span};

use nalgebra::{Point3, Vector3};

/// One piece of the tool's path, in the work frame, with the limits that hold on it.
#[derive(Clone, Debug, PartialEq)]
pub struct PathElement {
    /// The block it comes from.
    pub place: Place,
    /// Kind of the element: a cut, a rapid, a jump or others.
    pub kind: ElementKind,
    /// Its geometry.
    pub shape: Shape,
    /// Programmed velocity along the path (F), m/s.
    pub feed: f64,
    /// Programmed acceleration along the path (E+), m/s², positive.
    pub acceleration: f64,
    /// Programmed deceleration along the path (E−), m/s², positive.
    pub deceleration: f64,
    /// Largest velocity with which the path may go on into the next element, m/s (`dVelEnd`). Infinite until something
    /// limits it; [`crate::prepare::CheckVelocities`] makes it what the path will do.
    pub end_velocity: f64,
    /// Tool radius (D) for radius correction, or radius or distance for rounding and smoothing, m (`dToolRadius`).
    pub tool_radius: f64,
    /// Begin and end of preparation (`byInternMark`).
    pub marks: Marks,
    /// Optional details.
    pub details: Option<Box<Details>>,
}

impl PathElement {
    /// An element of `kind` and `shape` with nothing else set: no feed and accelerations, no marks, no details.
    pub fn new(place: Place, kind: ElementKind, shape: Shape) -> Self {
        Self {
            place,
            kind,
            shape,
            feed: 0.0,
            acceleration: 0.0,
            deceleration: 0.0,
            end_velocity: f64::INFINITY,
            tool_radius: 0.0,
            marks: Marks::default(),
            details: None,
        }
    }

    /// Length of the path to travel, m (`dLength`): that of the shape, or where only extra axes move a thousandth of
    /// their Euclidean length in u, so that F is u/s for them. What is no motion has none, however far a jump goes.
    pub fn length(&self) -> f64 {
        if !self.kind.is_motion() {
            return 0.0;
        }
        let length = self.shape.length();
        if length > 0.0 { length } else { self.extra().map_or(0.0, |extra| extra.length() * 1e-3) }
    }

    /// Length of the tool's path, m: 0 where only extra axes move, and for elements without motion.
    pub fn tool_length(&self) -> f64 {
        if self.kind.is_motion() { self.shape.length() } else { 0.0 }
    }

    /// The extra axes, if the program has named any.
    pub fn extra(&self) -> Option<&ExtraAxes> {
        self.details.as_ref()?.extra.as_ref()
    }

    /// The switches along the element.
    pub fn switches(&self) -> &[Switch] {
        self.details.as_ref().map_or(&[], |details| details.switches.as_slice())
    }

    /// Parameters of an M function; none of them on any other element.
    pub fn m_parameters(&self) -> MParameters {
        self.details.as_ref().map(|details| details.parameters).unwrap_or_default()
    }

    /// Start, m (`piStartPos`).
    pub fn start(&self) -> Point3<f64> {
        self.shape.start()
    }

    /// End, m (`piDestPos`).
    pub fn end(&self) -> Point3<f64> {
        self.shape.end()
    }

    /// Position and derivatives at path length `s`, m, from the start; see [`Shape::at`]. Where Z moves with the S
    /// profile, its derivatives are those of that motion and the tangent is no unit vector.
    pub fn at(&self, s: f64) -> PathPoint {
        let mut point = self.shape.at(s);
        if self.smooth_z() {
            let z = along(self.start().z, self.end().z, s, self.shape.length(), true);
            [point.position.z, point.tangent.z, point.curvature.z, point.curvature_rate.z] = z;
        }
        point.tangent = finite(point.tangent);
        point.curvature = finite(point.curvature);
        point.curvature_rate = finite(point.curvature_rate);
        point
    }

    /// True if Z moves with the S profile.
    fn smooth_z(&self) -> bool {
        self.details.as_ref().is_some_and(|details| details.s_profile.contains(AxisMask::Z))
    }

    /// The extra axes at path length `s`, m, from the start; none if the program has not named any.
    pub fn extra_at(&self, s: f64) -> Option<ExtraPoint> {
        let details = self.details.as_ref()?;
        let extra = details.extra.as_ref()?;
        let length = self.length();
        let mut point = ExtraPoint::default();
        for (index, (start, end)) in extra.start.iter().zip(extra.end).enumerate() {
            let smooth = details.s_profile.contains(AxisMask::extra(index));
            let [position, first, second, third] = along(*start, end, s, length, smooth);
            let slots = (
                point.position.get_mut(index),
                point.first.get_mut(index),
                point.second.get_mut(index),
                point.third.get_mut(index),
            );
            if let (Some(at), Some(d1), Some(d2), Some(d3)) = slots {
                let [first, second, third] = [first, second, third].map(finite_or_zero);
                (*at, *d1, *d2, *d3) = (position, first, second, third);
            }
        }
        Some(point)
    }

    /// Direction in which the path leaves the start; zero on an element of length zero.
    pub fn start_tangent(&self) -> Vector3<f64> {
        if self.smooth_z() { self.at(0.0).tangent } else { self.shape.start_tangent() }
    }

    /// Direction in which the path arrives at the end; zero on an element of length zero.
    pub fn end_tangent(&self) -> Vector3<f64> {
        if self.smooth_z() {
            self.at(self.shape.length()).tangent
        } else {
            self.shape.end_tangent()
        }
    }
}

/// The extra axes at one point of an element and their derivatives with respect to path length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExtraPoint {
    /// Position, u.
    pub position: ExtraPosition,
    /// First derivative, u/m.
    pub first: ExtraPosition,
    /// Second derivative, u/m².
    pub second: ExtraPosition,
    /// Third derivative, u/m³.
    pub third: ExtraPosition,
}

/// A derivative, or zero where the element is too small for it to be a number (10⁻¹⁵⁰ m and less, from a queue file).
fn finite(derivative: Vector3<f64>) -> Vector3<f64> {
    if derivative.iter().all(|value| value.is_finite()) { derivative } else { Vector3::zeros() }
}

/// As [`finite`], for one axis.
fn finite_or_zero(derivative: f64) -> f64 {
    if derivative.is_finite() { derivative } else { 0.0 }
}

/// Position and derivatives with respect to `s` of an axis that goes from `start` to `end` along a path of `length`:
/// linearly or, with the S profile (manual 3.2 and 6.2.9), by 10w³ − 15w⁴ + 6w⁵ with w = s/length.
fn along(start: f64, end: f64, s: f64, length: f64, smooth: bool) -> [f64; 4] {
    if length <= 0.0 {
        return [end, 0.0, 0.0, 0.0];
    }
    if s <= 0.0 || s >= length {
        let way = end - start;
        // The third as it is on the way: beside the element it has a step.
        let (slope, third) = if smooth {
            (0.0, way * 60.0 / (length * length) / length)
        } else {
            (way / length, 0.0)
        };
        return [if s <= 0.0 { start } else { end }, slope, 0.0, third];
    }
    let (way, w) = (end - start, s / length);
    if smooth {
        let left = 1.0 - w;
        [
            start + way * (w * w * w * (10.0 + w * (6.0 * w - 15.0))),
            way * 30.0 * (w * left).powi(2) / length,
            way * 60.0 * w * left * (left - w) / (length * length),
            way * 60.0 * (1.0 - 6.0 * w * left) / (length * length) / length,
        ]
    } else {
        [start + way * w, way / length, 0.0, 0.0]
    }
}

/// Kind of an element, apart from its shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ElementKind {
    /// G0: positioning, tool not engaged (the manual's `LINPOS`). The path stops at both of its ends.
    Rapid,
    /// The tool cuts along the shape.
    Cut,
    /// G38.2 to G38.5 of RS274: a probe feels its way along a line, which ends where it trips, if it does. The path
    /// stops at both of its ends, and preparation leaves it as it is.
    Probe {
        /// The programmed move.
        probing: Probing,
        /// Outcome that ends the line.
        outcome: ProbeOutcome,
    },
    /// G92 after the first motion: the set-point jumps from the start of the shape to its end, without a path.
    Jump,
    /// The path waits here until M function `number` is acknowledged (the manual's `MCOMMAND`). Its shape is a line
    /// of length zero.
    MFunction {
        /// Number of the M word (`wM`).
        number: u16,
    },
    /// The path waits here for a time (RS274: G4). Its shape is a line of length zero.
    Dwell {
        /// Duration, ns.
        time_ns: i64,
    },
}

impl ElementKind {
    /// True if it ends where a probe trips.
    pub const fn is_probe(self) -> bool {
        matches!(self, Self::Probe { .. })
    }

    /// True if there is a path to travel.
    pub const fn is_motion(self) -> bool {
        matches!(self, Self::Rapid | Self::Cut | Self::Probe { .. })
    }
}
