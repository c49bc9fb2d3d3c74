//! Path preparation: stream adapters over path elements.
//!
//! Every adapter takes an iterator of `Result<PathElement, E>` and is one itself, so that adapters stack and what
//! went wrong upstream arrives downstream at its place in the program. The consumer chooses `E`; an adapter that can
//! find fault itself asks for `E: From<` its own error `>`. What an adapter changes or cannot keep without that being
//! an error it tells through the [`Notices`] it was given: a bounded list beside the stream.
//!
//! An adapter works where the path's [`crate::path::Marks`] say so, leaves everything else as it is, and takes off the
//! marks it has obeyed. Each holds back a bounded number of elements, whatever the program.
//!
//! [`Preparation`] strings them together in the manual's order.
//!
//! [`CheckVelocities`] comes last and hands out [`CheckedElement`]s, the only thing
//! [`crate::interpolate::LookAhead`] takes: what the manual reports at run time as `SMC_INT_NO_CHECKVELOCITIES`
//! (1006) does not compile here.

mod avoid_loops;
mod check_velocities;
mod corner;
mod limit_circular;
mod notice;
mod piece;
mod planar;
mod preparation;
#[cfg(test)]
mod tests;
mod tool_radius;

pub use avoid_loops::{AvoidLoops, DEFAULT_LOOP_WINDOW};
pub use check_velocities::{CheckError, CheckVelocities, CheckedElement, Limit};
pub use corner::{CornerError, CornerStyle, Corners, RoundPath, Rounding, SmoothPath, Smoothing};
pub(crate) use limit_circular::curvature;
pub use limit_circular::{CircularLimits, LimitCircularVelocities};
pub use notice::{Notice, Notices};
pub use preparation::{Incompatible, Optional, Preparation, PreparedPath, Stage};
pub use tool_radius::{Side, ToolRadius, ToolRadiusError, ToolRadiusOptions};
