//! [`Kinematics`]: one trait for every transform, with any number of axes.

use crate::{
    AxisDisc, AxisMotion, AxisVector, Branch, Coordinate, Dexterity, Jacobian, Margins, Pose,
    Result, ToolDisc, ToolJerk, ToolMotion,
};
use nalgebra::Vector3;

/// Tolerance of a coordinate without an axis around 0, m: far below anything a machine can show, far above the rounding
/// of a work frame.
pub(crate) const ABSENT: f64 = 1e-9;

/// A transform between the tool pose in the machine frame and a fixed number of axes.
///
/// Implementations hold dimensions and the chosen branch (elbow low or high) and nothing else: no call changes what
/// a later call returns. An unreachable pose is an error, never a clamped answer.
///
/// Every method gives [`AxisCount`](crate::KinematicsError::AxisCount) for too few or too many axis values and
/// [`NotFinite`](crate::KinematicsError::NotFinite) for what is infinite or not a number.
pub trait Kinematics: std::fmt::Debug + Send + Sync {
    /// Number of axes that this transform moves.
    fn axis_count(&self) -> usize;

    /// The coordinates that this transform turns into axis positions. The other lengths must be 0: they have axes of
    /// their own or none ([`MachineAxes`](crate::MachineAxes)); a direction that the transform does not have is ignored.
    fn coordinates(&self) -> &[Coordinate];

    /// True if an axis is rotary (positions in rad), as far as the transform knows.
    fn is_rotary(&self, axis: usize) -> bool;

    /// True if an axis moves the tool.
    fn moves_tool(&self, axis: usize) -> bool {
        axis < self.axis_count()
    }

    /// The tool pose that the axis positions `axes` (m or rad) give, in the machine frame (`SMC_TRAFOF_x`).
    ///
    /// # Errors
    /// [`Apart`](crate::KinematicsError::Apart) where the rods of a tripod do not meet.
    fn forward(&self, axes: &AxisVector) -> Result<Pose>;

    /// The axis positions (m or rad) that put the tool at `pose` in the machine frame (`SMC_TRAFO_x`).
    ///
    /// `near` picks the turn of rotary axes: the answer is the one within half a turn of it. It never picks the
    /// branch, which is part of the transform.
    ///
    /// # Errors
    /// [`Unreachable`](crate::KinematicsError::Unreachable) if no axis position gives the pose,
    /// [`NoAxis`](crate::KinematicsError::NoAxis) if the pose needs a coordinate that no axis moves.
    fn inverse(&self, pose: &Pose, near: &AxisVector) -> Result<AxisVector>;

    /// The motion of the tool for moving axes.
    ///
    /// # Errors
    /// Those of [`Self::forward`], and [`Singular`](crate::KinematicsError::Singular) where the tool is not held.
    fn forward_motion(&self, axes: &AxisMotion) -> Result<ToolMotion>;

    /// Axis positions, velocities and accelerations for a moving tool (`SMC_TRAFOV_x`, one derivative
    /// further). `near` as in [`Self::inverse`].
    ///
    /// # Errors
    /// Those of [`Self::inverse`], and [`Singular`](crate::KinematicsError::Singular) where the axes cannot follow.
    fn inverse_motion(&self, tool: &ToolMotion, near: &AxisVector) -> Result<AxisMotion>;

    /// [`Self::inverse_motion`] with the jerks of the tool and of the axes (m/s³ or rad/s³).
    ///
    /// # Errors
    /// Those of [`Self::inverse_motion`].
    fn inverse_jerk(
        &self,
        tool: &ToolMotion,
        jerk: &ToolJerk,
        near: &AxisVector,
    ) -> Result<(AxisMotion, AxisVector)>;

    /// Jacobian with the axes at `axes`.
    ///
    /// # Errors
    /// Those of [`Self::forward_motion`].
    fn jacobian(&self, axes: &AxisVector) -> Result<Jacobian>;

    /// Branch that [`Self::inverse`] gives.
    fn branch(&self) -> Branch;

    /// Branch of axis positions.
    ///
    /// # Errors
    /// None but those of every method.
    fn branch_at(&self, axes: &AxisVector) -> Result<Branch>;

    /// Margins of a pose to the edge of the reach and to the place where two solutions meet.
    ///
    /// # Errors
    /// [`NoAxis`](crate::KinematicsError::NoAxis).
    fn margins(&self, pose: &Pose) -> Result<Margins>;

    /// A disc of the parameter of a tool path on which the axes are analytic, as [`Transform::disc`](crate::Transform::disc).
    fn disc(&self, _path: &ToolDisc) -> Option<AxisDisc> {
        None
    }

    /// A length in the order of the machine's size, m: what makes angles and lengths comparable unless the machine
    /// states another.
    fn characteristic_length(&self) -> f64;

    /// The same mechanism with a tool whose tip is at `tip` (m) in the frame of its flange: z up, x forward as the
    /// transform's docs say; straight down is −z. z counts only if the transform has it. A tool held before is taken off.
    fn holding(self: Box<Self>, tip: &Vector3<f64>) -> Box<dyn Kinematics>;

    /// Dexterity with the axes at `axes`; `length` (m) is what a radian counts, as [`Self::characteristic_length`]
    /// suggests.
    ///
    /// # Errors
    /// Those of [`Self::jacobian`].
    fn dexterity(&self, axes: &AxisVector, length: f64) -> Result<Dexterity> {
        let moves = |axis: usize| self.moves_tool(axis);
        let turns = |axis: usize| self.is_rotary(axis);
        Ok(self.jacobian(axes)?.dexterity(self.coordinates(), moves, turns, length))
    }
}
