//! Feed limiting: the fastest motion along a path under the limits of every axis.
//!
//! ```text
//! CheckedElement ─ course (C²) ─ samples of the axes ─ grid, uniform in time ─ windows for Clarabel ─▶ stretches in time
//! ```
//!
//! [`course`] rounds the joints of the path within a tolerance, [`Grid`] holds what limits the motion along it,
//! [`reachable`] gives the fastest profile with limited acceleration in two passes, and Clarabel those profiles that are
//! followed: [`LinearSolver`] where accelerations alone are limited (there it is left with what two passes cannot prove),
//! [`SmoothSolver`] where jerks are as well.

mod asked;
mod axis_path;
mod bound;
mod cell;
mod convex;
pub mod course;
mod drag;
pub mod emergency;
mod feeds;
mod follow;
mod gain;
mod grid;
mod linear;
mod options;
mod plane;
mod planner;
pub mod reachable;
mod rows;
mod sample;
mod smooth;
mod spliced;
mod stretch;

pub use axis_path::{AxisPath, AxisPoint, KinematicPath, MOST_FURTHER_ROWS, axis_point};
pub use bound::{
    AxisLimits, Cap, CapSource, Constraint, Disc, FIRST_FURTHER_ROW, JerkRow, Rates, Row,
};
pub use convex::NotSolved;
pub use drag::DragRow;
pub use follow::{Followed, Follower, MTimes, Replan};
pub use gain::Gain;
pub use grid::{CellEnd, Grid};
pub use linear::{LinearProfile, LinearSolver};
pub use options::LimitOptions;
pub use planner::{Behind, Effort, Leg, LimitError, Piece, Pieces, Planned, Planner, Request};
pub use smooth::{Beginning, SmoothProfile, SmoothSolver};
pub use spliced::{Arrival, Lead, Spliced};
pub use stretch::{Law, Progress, Stretch};
