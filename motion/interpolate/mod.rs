//! The interpolator: one set-point per cycle along the prepared path (`SMC_Interpolator`, manual 6.2.9).
//!
//! [`LookAhead`] plans the velocities at the transitions, [`Profile`] fills in the element between them, and
//! [`Interpolator`] samples the result at the cycle:
//!
//! ```text
//! CheckedElement ─ LookAhead ─▶ PlannedElement ─ Interpolator ─▶ ToolSetpoint
//! ```

mod instant;
mod interpolator;
mod look_ahead;
mod profile;
#[cfg(test)]
mod tests;

pub use interpolator::{DEFAULT_CYCLE_NS, Interpolator};
pub use look_ahead::{DEFAULT_WINDOW, LookAhead, PlannedElement};
pub use profile::{PathState, Profile};

use crate::Place;
use nalgebra::{Point3, Vector3};

/// Where the tool shall be at one instant, in the work frame: what [`Interpolator`] makes per cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolSetpoint {
    /// Time since the start of the program, ns.
    pub time_ns: i64,
    /// The block whose element is being traversed.
    pub place: Place,
    /// True on a rapid (G0): the tool is not engaged.
    pub rapid: bool,
    /// Programmed velocity along the path (F), m/s.
    pub feed: f64,
    /// Position, m.
    pub position: Point3<f64>,
    /// Velocity, m/s.
    pub velocity: Vector3<f64>,
    /// Acceleration, m/s².
    pub acceleration: Vector3<f64>,
    /// Velocity along the path, m/s.
    pub path_velocity: f64,
}
