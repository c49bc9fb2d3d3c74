//! A machine as links and joints: the one source of geometry for physics and pictures.
//!
//! A [`Model`] is generated from the dimensions of a machine ([`GantryDimensions`], [`ScaraDimensions`],
//! [`TripodDimensions`]) or read from URDF ([`Model::from_urdf`]), and written as URDF ([`Model::to_urdf`]).
//! [`Model::link_poses`] says where its links are; where they go round in circles, [`JointPositions`] closes them.

mod error;
mod generate;
mod inertial;
mod load;
mod loops;
mod model;
mod pose;
#[cfg(test)]
mod tests;
mod to_urdf;

pub use error::{DimensionError, Part, UrdfError};
pub use generate::{
    GantryDimensions, HBelt, MachineJoint, PlaneDrive, RotaryTool, ScaraDimensions, ScaraHand,
    TripodDimensions,
};
pub use loops::{JointPositions, LoopError};
pub use model::{
    Inertial, Joint, JointDrive, JointKind, Link, Loop, Model, Solid, SolidShape, Tip,
};

/// Name of the link that marks the tool tip in URDF text, and of the joint that fixes it.
pub const TIP_NAME: &str = "tool_tip";
