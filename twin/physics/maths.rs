//! Conversion between nalgebra's types and rapier's (glam's), in one place.
//!
//! Conversions copy components without normalising or rounding.

use nalgebra::{Isometry3, Matrix3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use rapier3d_f64::math::{Matrix, Pose, Rotation, Vector};

/// A direction, velocity or force.
pub(super) fn vector_to_rapier(vector: &Vector3<f64>) -> Vector {
    Vector::new(vector.x, vector.y, vector.z)
}

/// And back.
pub(super) fn vector_from_rapier(vector: Vector) -> Vector3<f64> {
    Vector3::new(vector.x, vector.y, vector.z)
}

/// A place; rapier has one type for places and directions.
pub(super) fn point_to_rapier(point: &Point3<f64>) -> Vector {
    vector_to_rapier(&point.coords)
}

/// A rotation.
pub(super) fn rotation_to_rapier(rotation: &UnitQuaternion<f64>) -> Rotation {
    Rotation::from_xyzw(rotation.i, rotation.j, rotation.k, rotation.w)
}

/// A frame.
pub(super) fn pose_to_rapier(pose: &Isometry3<f64>) -> Pose {
    Pose::from_parts(vector_to_rapier(&pose.translation.vector), rotation_to_rapier(&pose.rotation))
}

/// An inertia tensor (both sides store columns).
pub(super) fn matrix_to_rapier(matrix: &Matrix3<f64>) -> Matrix {
    Matrix::from_cols(
        vector_to_rapier(&matrix.column(0).into_owned()),
        vector_to_rapier(&matrix.column(1).into_owned()),
        vector_to_rapier(&matrix.column(2).into_owned()),
    )
}

/// And back.
pub(super) fn matrix_from_rapier(matrix: Matrix) -> Matrix3<f64> {
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    Matrix3::from_columns(&columns.map(vector_from_rapier))
}

/// A frame.
pub(super) fn pose_from_rapier(pose: &Pose) -> Isometry3<f64> {
    let rotation =
        Quaternion::new(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
    Isometry3::from_parts(
        Translation3::new(pose.translation.x, pose.translation.y, pose.translation.z),
        UnitQuaternion::new_unchecked(rotation),
    )
}

/// Largest displacement of any point of a body within `radius` (m) of its origin, m.
pub(super) fn way(from: &Isometry3<f64>, to: &Isometry3<f64>, radius: f64) -> f64 {
    let shift = to.translation.vector - from.translation.vector;
    // The chord of a turn, and less rounding near none than of an angle.
    let turn = (to.rotation.coords - from.rotation.coords).norm();
    let turn = turn.min((to.rotation.coords + from.rotation.coords).norm());
    shift.norm() + std::f64::consts::PI * turn * radius
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// There and back is the same frame, and both libraries agree on what the frame does to a point.
        #[test]
        fn a_pose_survives_the_way_there_and_back(
            axis_angle in prop::array::uniform3(-3.0..3.0_f64),
            translation in prop::array::uniform3(-2.0..2.0_f64),
            point in prop::array::uniform3(-2.0..2.0_f64),
        ) {
            let pose = Isometry3::new(Vector3::from(translation), Vector3::from(axis_angle));
            let rapier = pose_to_rapier(&pose);
            prop_assert_eq!(pose_from_rapier(&rapier), pose);

            let here = pose * Point3::from(point);
            let there = rapier * Vector::new(point[0], point[1], point[2]);
            prop_assert!((here.coords - Vector3::new(there.x, there.y, there.z)).norm() < 1e-14);
        }

        /// Both libraries multiply an inertia tensor alike (rows and columns are not swapped).
        #[test]
        fn a_matrix_means_the_same(
            entries in prop::array::uniform9(-2.0..2.0_f64),
            vector in prop::array::uniform3(-2.0..2.0_f64),
        ) {
            let matrix = Matrix3::from_row_slice(&entries);
            let here = matrix * Vector3::from(vector);
            let there = matrix_to_rapier(&matrix) * Vector::new(vector[0], vector[1], vector[2]);
            prop_assert!((here - Vector3::new(there.x, there.y, there.z)).norm() < 1e-14);
        }
    }
}
