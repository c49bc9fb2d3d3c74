//! Machine models of links and joints: the one source of geometry for physics and pictures.
//!
//! A [`Model`] is generated from the dimensions of a machine ([`GantryDimensions`], [`ScaraDimensions`],
//! [`TripodDimensions`]) or read from URDF ([`Model::from_urdf`]), and written as URDF ([`Model::to_urdf`]).
//! [`Model::link_poses`] computes the poses of its links; [`JointPositions`] closes kinematic loops.

mod bind;
mod check;
mod error;
mod generate;
mod inertial;
mod loops;
mod mesh;
mod mimic;
mod model;
mod pose;
mod read;
mod rotation;
#[cfg(test)]
mod tests;
mod write;

pub use bind::{AxisJoint, BindError};
pub use error::{Part, UrdfError, UrdfFileError};
pub use generate::{
    DimensionError, GantryDimensions, HBelt, MachineJoint, PlaneDrive, RotaryTool, ScaraDimensions,
    ScaraHand, ToolShape, TripodDimensions,
};
pub use loops::{JointPositions, LoopError};
pub use mesh::{Mesh, MeshError};
pub use mimic::Following;
pub use model::{
    Calibration, Inertial, Joint, JointDetails, JointDrive, JointKind, Link, Loop, Model,
    SafetyController, Solid, SolidShape, Tip,
};
pub use read::{Loaded, UrdfNote, UrdfOptions, UrdfWarning};

/// Name of the link that marks the tool tip in URDF text, and of the joint that fixes it.
pub const TIP_NAME: &str = "tool_tip";

/// Attribute of `<origin>` for orientations that roll, pitch and yaw do not give back to the last digit: w, x, y, z. Other
/// readers of URDF pass over it.
pub const QUATERNION: &str = "quaternion_wxyz";
