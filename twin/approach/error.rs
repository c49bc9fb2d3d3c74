//! Errors of approaches: the obstacle, limit or reach that rules out every path that was tried.

use super::place;
use super::step::Leg;
use twin_kinematics::KinematicsError;
use twin_machine::SimulationError;

/// Why the axes cannot go to the start of a program. Nothing has moved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ApproachError {
    /// Parts are in each other before anything moves.
    #[error(
        "{part} is {depth_mm:.3} mm deep in {other} where the axes are now, with the tool tip at {}",
        place(*.tip_mm)
    )]
    Inside {
        /// The part that moves.
        part: String,
        /// What it is in.
        other: String,
        /// mm.
        depth_mm: f64,
        /// Tool tip, mm, machine frame.
        tip_mm: [f64; 3],
    },
    /// Parts would collide.
    #[error(
        "{leg}, {part} would be {depth_mm:.3} mm deep in {other}, with the tool tip at {}",
        place(*.tip_mm)
    )]
    Collision {
        /// On which leg.
        leg: Leg,
        /// The part that moves.
        part: String,
        /// What it would be in.
        other: String,
        /// mm; of the first cycle in which they touch.
        depth_mm: f64,
        /// Tool tip, mm, machine frame.
        tip_mm: [f64; 3],
    },
    /// An axis would leave its software limits.
    #[error(
        "{leg}, axis {axis} would go to {position:.3} {unit}, and its software limit is {limit:.3} {unit}"
    )]
    Limit {
        /// On which leg.
        leg: Leg,
        /// The axis.
        axis: String,
        /// Where it would go, in `unit`.
        position: f64,
        /// In `unit`.
        limit: f64,
        /// "mm" or "deg".
        unit: &'static str,
    },
    /// The tool cannot be there.
    #[error("{leg}, the tool cannot be there: {source}")]
    Reach {
        /// On which leg.
        leg: Leg,
        /// Why.
        source: KinematicsError,
    },
    /// The position of the tool does not follow from that of the axes.
    #[error("the position of the tool cannot be computed from that of the axes: {0}")]
    Tool(KinematicsError),
    /// The clearance cannot be measured.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A motion that no profile describes.
    #[error("{leg}, the motion cannot be planned: {source}")]
    Profile {
        /// On which leg.
        leg: Leg,
        /// Why.
        source: twin_profile::ProfileError,
    },
}

impl ApproachError {
    /// True if a way higher up cannot help.
    pub(super) fn ends_search(&self) -> bool {
        !matches!(self, Self::Collision { .. })
    }
}
