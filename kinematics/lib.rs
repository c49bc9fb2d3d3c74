//! Kinematic transforms (`SM_Trafo`): from the tool pose to the axes of the machine, and back.
//!
//! Everything here is pure mathematics: no I/O, no clock, no allocation on the solve path. Lengths are metres,
//! angles radians, times seconds.
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
pub use error::{DimensionError, KinematicsError, ReachOf};
pub use frame::{Cuboid, CuboidError, FrameError, UNIT_VECTOR_TOLERANCE, UnitVectors, WorkFrame};
pub use jacobian::{Dexterity, Jacobian};
pub use kinematics::Kinematics;
pub use machine_axes::{AxisSource, MachineAxes, MachineAxesError};
pub use pose::{Pose, ToolJerk, ToolMotion};
pub use smooth::SmoothMap;
pub use transform::Transform;
