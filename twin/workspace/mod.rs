//! The workspace of a machine: where its tool gets, and how well its axes move it there.
//!
//! What the tool reaches is found from the axes, by going through their positions ([`Sweep`]), and in a [`Section`] from
//! the tool, by asking at every node of a grid which axis positions lead there. A section knows, at each point, whether it
//! is within the software limits, beyond which of them it lies, or that it is out of reach, and the singularity measure:
//! the smallest singular value of the Jacobian, made dimensionless with the machine's length. It is how fast the tool goes
//! in its slowest direction where all axes together go at 1: 1 for a gantry, 0 where the axes cannot move the tool every way.
//!
//! Everything here is SI, in the machine frame.

mod example;
mod extent;
mod grid;
mod measure;
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
