//! Kinematic transforms (`SM_Trafo`): from the tool pose to the axes of the machine, and back.
//!
//! Everything here is pure mathematics: no I/O, no clock, no allocation on the solve path. Lengths are metres,
//! angles radians, times seconds.
//!
//! ```
//! use twin_kinematics::scara::{Elbow, Scara2};
//! use twin_kinematics::{AxisVector, Kinematics, Pose};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // Arms of 300 mm and 400 mm; both axes are at 0 when the arms are stretched along +x.
//! let scara = Scara2::new([0.3, 0.4], [0.0, 0.0], Elbow::Low)?;
//! // Tool 300 mm along x and 400 mm along y: a right triangle, so A is at 0 degrees and B at 90 degrees.
//! let pose = Pose::at(0.3, 0.4, 0.0);
//! let axes = scara.inverse(&pose, &AxisVector::zeros(2))?;
//! let [a, b] = *axes else { return Err("two axes expected".into()) };
//! assert!(a.abs() < 1e-12 && (b.to_degrees() - 90.0).abs() < 1e-9);
//! // The forward transform leads back to the same point.
//! assert!((scara.forward(&axes)?.position - pose.position).norm() < 1e-12);
//! # Ok(())
//! # }
//! ```
//!
//! Frames: *machine* is the fixed frame in which a transform is written down (its docs say where the origin is);
//! *work* is the frame of the program, placed in the machine frame by a [`WorkFrame`].
//!
//! The manual's `SMC_TRAFO_x` (path to axes) is [`Kinematics::inverse`], `SMC_TRAFOF_x` (axes to path) is
//! [`Kinematics::forward`], `SMC_TRAFOV_x` (with velocities) is [`Kinematics::inverse_motion`]. [`Transform`] is the
//! same for code that knows the machine at compile time and needs speed.
//!
//! A custom transform (manual 11.8) implements [`Kinematics`] and is used like those of this crate, for example in
//! [`MachineAxes`] with a tool and further axes. Example: `tests/own_transform`, a turntable under a slide.

#![allow(
    clippy::indexing_slicing,
    reason = "numeric code: an index beyond an array is a fault that must stop, not a 0.0 for an axis"
)]

mod axes;
mod branch;
mod coordinate;
mod direction;
mod disc;
mod error;
mod frame;
pub mod gantry;
mod implement;
mod jacobian;
mod kinematics;
mod machine_axes;
mod pose;
pub mod scara;
mod smooth;
#[cfg(test)]
mod tests;
pub mod transform;
pub mod tripod;
pub mod turn;

pub use axes::{AxisMotion, AxisVector, MAX_AXES};
pub use branch::{Branch, Margins};
pub use coordinate::Coordinate;
pub use direction::{ToPath, direction_rates};
pub use disc::{AxisDisc, ToolDisc};
pub use error::{DimensionError, KinematicsError, ReachOf, Result};
pub use frame::{Cuboid, CuboidError, FrameError, UNIT_VECTOR_TOLERANCE, UnitVectors, WorkFrame};
pub use jacobian::{Dexterity, Jacobian};
pub use kinematics::Kinematics;
pub use machine_axes::{AxisSource, MachineAxes, MachineAxesError};
pub use pose::{Pose, ToolJerk, ToolMotion};
pub use smooth::SmoothMap;
pub use transform::Transform;
