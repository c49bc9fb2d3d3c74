//! `SM_Trafo`: from the tool in space to the axes of the machine, and back.
//!
//! Everything here is pure mathematics: no I/O, no clock, no allocation on the solve path. Lengths are metres,
//! angles radians, times seconds.
//!
//! Frames: *machine* is the fixed frame in which a transform is written down (its docs say where the origin is);
//! *work* is the frame of the program, placed in the machine frame by a [`WorkFrame`].
//!
//! The manual's `SMC_TRAFO_x` (path to axes) is [`Kinematics::inverse`], `SMC_TRAFOF_x` (axes to path) is
//! [`Kinematics::forward`].

mod axes;
mod direction;
mod error;
mod frame;
pub mod gantry;
mod machine_axes;
mod pose;
pub mod scara;
#[cfg(test)]
mod tests;

pub use axes::{AxisMotion, AxisVector, MAX_AXES};
pub use direction::{ToPath, direction_rates};
pub use error::KinematicsError;
pub use frame::{Cuboid, CuboidError, FrameError, UNIT_VECTOR_TOLERANCE, UnitVectors, WorkFrame};
pub use machine_axes::{AxisSource, Coordinate, MachineAxes, MachineAxesError};
pub use pose::{Pose, ToolMotion};

/// A transform between the tool pose in the machine frame and a fixed number of axes.
///
/// Implementations hold dimensions and the chosen branch (elbow low or high) and nothing else: no call changes what
/// a later call returns. An unreachable pose is an error, never a clamped answer.
pub trait Kinematics: std::fmt::Debug + Send + Sync {
    /// How many axes this transform moves.
    fn axis_count(&self) -> usize;

    /// The coordinates that this transform turns into axis positions. It must be given 0 for the others, which have
    /// axes of their own or none ([`MachineAxes`]).
    fn coordinates(&self) -> &[Coordinate];

    /// The tool pose that the axis positions `axes` (m or rad) give, in the machine frame.
    ///
    /// # Errors
    /// [`KinematicsError::AxisCount`] if `axes` has another length than [`Self::axis_count`], and
    /// [`KinematicsError::NotFinite`].
    fn forward(&self, axes: &AxisVector) -> Result<Pose, KinematicsError>;

    /// The axis positions (m or rad) that put the tool at `pose` in the machine frame.
    ///
    /// `near` picks the turn of rotary axes: the answer is the one within half a turn of it. It never picks the
    /// branch, which is part of the transform.
    ///
    /// # Errors
    /// [`KinematicsError::Unreachable`] if no axis position gives the pose, [`KinematicsError::NoAxis`] if the pose
    /// needs a coordinate the machine has no axis for, [`KinematicsError::AxisCount`] if `near` has another length
    /// than [`Self::axis_count`] and is needed, [`KinematicsError::NotFinite`].
    fn inverse(&self, pose: &Pose, near: &AxisVector) -> Result<AxisVector, KinematicsError>;

    /// Axis positions, velocities and accelerations for a moving tool (the manual's `SMC_TRAFOV_x`, one derivative
    /// further). `near` as in [`Self::inverse`].
    ///
    /// # Errors
    /// Those of [`Self::inverse`], and [`KinematicsError::Singular`] where the axes cannot follow the tool velocity.
    fn inverse_motion(
        &self,
        tool: &ToolMotion,
        near: &AxisVector,
    ) -> Result<AxisMotion, KinematicsError>;
}
