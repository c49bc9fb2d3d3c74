//! Rotations of URDF: roll, pitch and yaw about the fixed axes, in radians.

use nalgebra::UnitQuaternion;

/// R = Rz(yaw)·Ry(pitch)·Rx(roll).
pub(crate) fn rotation_from_rpy([roll, pitch, yaw]: [f64; 3]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(roll, pitch, yaw)
}
