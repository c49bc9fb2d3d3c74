//! Machine models of links and joints: the one source of geometry for physics and pictures.
//!
//! A [`Model`] is generated from the dimensions of a machine ([`GantryDimensions`], [`ScaraDimensions`],
//! [`TripodDimensions`]) or read from URDF ([`Model::from_urdf`]), and written as URDF ([`Model::to_urdf`]).
//! [`Model::link_poses`] computes the poses of its links; [`JointPositions`] closes kinematic loops.
//!
//! ```
//! use twin_urdf::Model;
//!
//! // One arm of 300 mm that turns about z, with the tool tip at its end.
//! let text = r#"
//! <robot name="arm">
//!   <link name="base"/>
//!   <link name="arm">
//!     <inertial>
//!       <mass value="2"/>
//!       <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>
//!     </inertial>
//!   </link>
//!   <link name="tool_tip"/>
//!   <joint name="A" type="revolute">
//!     <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
//!     <limit lower="-3" upper="3" effort="10" velocity="2"/>
//!   </joint>
//!   <joint name="tool_tip" type="fixed">
//!     <parent link="arm"/><child link="tool_tip"/><origin xyz="0.3 0 0"/>
//!   </joint>
//! </robot>"#;
//! let model = Model::from_urdf(text, &["A"])?;
//! // A quarter turn: the tip is at (0, 300) mm.
//! let tip = model.tip_position(&[std::f64::consts::FRAC_PI_2]);
//! assert!(tip.x.abs() < 1e-12 && (tip.y - 0.3).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
pub(crate) const QUATERNION: &str = "quaternion_wxyz";
