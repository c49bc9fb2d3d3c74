//! The workspace of a machine: where its tool gets, and how well its axes move it there.
//!
//! Reach comes from a sweep of the axes ([`Sweep`]); a [`Section`] solves the inverse transform at every node of a
//! grid. Each point is within the software limits, beyond some of them, or out of reach. The singularity measure is
//! the smallest singular value of the dimensionless Jacobian: 1 for a gantry, 0 at a singularity.
//!
//! Everything here is SI, in the machine frame.

mod example;
mod extent;
mod grid;
mod picture;
pub mod region;
mod scale;
mod section;
mod silhouette;
mod space;
mod survey;
#[cfg(test)]
mod tests;
mod view;

pub use example::{Example, Way};
pub use extent::{Extent, Sweep};
pub use grid::Grid;
pub use picture::picture;
pub use scale::Scale;
pub use section::{Cut, MeasureAt, Plane, Section};
pub use space::{AxisSet, Sample, Space, State};
pub use survey::{Reach, View, Workspace, WorkspaceError};
pub use view::show;
