//! Feed limiting: the fastest motion along a path under the limits of every axis.
//!
//! ```text
//! CheckedElement ─ course (C²) ─ samples of the axes ─ grid, uniform in time ─ windows for Clarabel ─▶ stretches in time
//! ```
//!
//! [`course`] rounds the joints of the path within a tolerance, [`Grid`] holds what limits the motion along it,
//! [`reachable`] gives the fastest profile with limited acceleration in two passes, and Clarabel those profiles that are
//! followed: [`LinearSolver`] where accelerations alone are limited, [`SmoothSolver`] where jerks are as well.

mod convex;
pub mod course;
mod grid;
mod linear;
pub mod reachable;
mod smooth;
mod stretch;

pub use convex::NotSolved;
pub use grid::{AxisLimits, Cap, CapSource, CellEnd, Disc, Grid, JerkRow, Rates, Row};
pub use linear::{LinearProfile, LinearSolver};
pub use smooth::{Beginning, SmoothProfile, SmoothSolver};
pub use stretch::{Law, Progress, Stretch};
