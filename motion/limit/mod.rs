//! Feed limiting: the fastest motion along a path under the limits of every axis.

mod convex;
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
