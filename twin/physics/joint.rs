//! Vectors and matrices of joint space: one value per axis.

use nalgebra::{SMatrix, SVector};
use twin_kinematics::{AxisVector, MAX_AXES};

/// One value per axis, indexed by axis; axes the machine does not have are 0.
pub(super) type JointVector = SVector<f64, MAX_AXES>;

/// One value per pair of axes.
pub(super) type JointMatrix = SMatrix<f64, MAX_AXES, MAX_AXES>;

/// The joint vector of `values` in axis order; missing values are 0.
pub(super) fn joint_vector(values: impl Iterator<Item = f64>) -> JointVector {
    let mut result = JointVector::zeros();
    for (slot, value) in result.iter_mut().zip(values) {
        *slot = value;
    }
    result
}

/// The first `axes` values.
pub(super) fn axis_vector(values: &JointVector, axes: usize) -> AxisVector {
    AxisVector::from_values(values.iter().copied().take(axes))
}
