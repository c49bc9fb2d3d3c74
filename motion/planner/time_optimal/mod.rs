//! Time-optimal planning (feed limiting): the fastest motion along a path under the limits of every axis.
//!
//! ```text
//! CheckedElement ─ blended path (C²) ─ samples of the axes ─ grid, uniform in time ─ windows ─▶ profile segments
//! ```
//!
//! [`crate::blended_path`] blends the joints of the path within a tolerance. [`Grid`] holds the limits along it. [`reachable`]
//! computes the fastest profile within velocities and accelerations in two passes (reachability analysis). Where jerk is
//! limited as well, [`SmoothSolver`] solves convex programs: by bands, or with Clarabel.

mod adjoint;
mod asked;
mod axis_path;
mod banded;
mod bound;
mod cell;
mod convex;
mod drag;
pub mod emergency;
mod feeds;
mod follow;
#[expect(clippy::indexing_slicing, reason = "an axis counts below the number of the limits")]
mod grid;
mod options;
mod plan_executor;
mod plane;
mod planner;
pub mod reachable;
mod rows;
mod sample;
mod sensitivity;
mod smooth;

pub use axis_path::{AxisPath, AxisPoint, KinematicPath, MOST_FURTHER_ROWS, axis_point, within};
pub use bound::{
    AxisLimits, Cap, CapSource, Constraint, Disc, FIRST_FURTHER_ROW, JerkRow, Rates, Row,
};
pub use convex::NotSolved;
pub use drag::DragRow;
pub use follow::{Followed, Follower, MTimes, Replan, Shown};
pub use grid::{CellEnd, Grid};
pub use options::LimitOptions;
pub use plan_executor::{Arrival, Lead, PlanExecutor};
pub use planner::{
    Behind, Effort, Leg, LimitError, ParallelPlanner, Piece, Pieces, Planned, Planner, Request,
};
pub use sensitivity::Sensitivity;
pub use smooth::{Beginning, SmoothProfile, SmoothSolver};
