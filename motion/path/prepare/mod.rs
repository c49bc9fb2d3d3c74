//! Path preparation: stream adapters over path elements.
//!
//! Every adapter takes an iterator of `Result<PathElement, E>` and is one itself, so that adapters stack and an
//! upstream error arrives downstream at its place in the program. The consumer chooses `E`; an adapter with errors of
//! its own requires `E: From<` its own error `>`. An adapter reports changes that are not errors through the
//! [`Notices`] it was given: a bounded list separate from the stream.
//!
//! An adapter works between its [`crate::Marks`], leaves everything else unchanged, and removes the marks that it
//! has obeyed. Each holds back a bounded number of elements.
//!
//! [`Preparation`] connects them in the manual's order.
//!
//! [`CheckVelocities`] comes last and gives [`CheckedElement`]s, the only input of the look-ahead of the planner:
//! the mistake that the manual reports at run time as `SMC_INT_NO_CHECKVELOCITIES` (1006) does not compile here.

mod avoid_loops;
mod check_velocities;
mod corner;
mod limit_circular;
mod notice;
mod piece;
mod planar;
mod preparation;
mod sections;
#[cfg(test)]
mod tests;
mod tool_radius;

pub use avoid_loops::{AvoidLoops, DEFAULT_LOOP_WINDOW};
pub use check_velocities::{CheckError, CheckVelocities, CheckedElement, Limit};
pub use corner::{CornerError, CornerStyle, Corners, RoundPath, Rounding, SmoothPath, Smoothing};
pub use limit_circular::curvature;
pub use limit_circular::{CircularLimits, LimitCircularVelocities};
pub use notice::{Notice, Notices};
pub use preparation::{Incompatible, Optional, Preparation, PreparedPath, Stage};
pub use sections::Sections;
pub use tool_radius::{Side, ToolRadius, ToolRadiusError, ToolRadiusOptions};
