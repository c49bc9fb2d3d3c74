//! Tests of frames given by unit vectors or by roll, pitch and yaw.

use crate::tests::seeded;
use crate::{FrameError, UNIT_VECTOR_TOLERANCE, UnitVectors, WorkFrame};
use nalgebra::{Point3, Rotation3, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// The other way up: R = Ry(−90°)·Rx(0.4) by hand, and −0 in what is left of x.
#[test]
fn singular_downwards() {
    let (sin, cos) = 0.4_f64.sin_cos();
    let columns = [[-0.0, -0.0, 1.0], [-sin, cos, 0.0], [-cos, -sin, 0.0]];
    let [x, y, z] = columns.map(Vector3::from);
    let found = UnitVectors::new(x, y, z).unwrap().roll_pitch_yaw();
    for (one, other) in found.into_iter().zip([0.4, -FRAC_PI_2, 0.0]) {
        assert!((one - other).abs() < 1e-15, "{found:?}");
    }
}

/// Every vector and every pair is looked at, and lengths come before angles, angles before the sense.
#[test]
fn each_axis_and_each_pair() {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    for (index, name) in ['x', 'y', 'z'].into_iter().enumerate() {
        for length in [0.0, 1.0 + 2e-6, 1.0 - 2e-6, 1e200, f64::INFINITY, f64::NAN] {
            let mut axes = axes;
            axes[index][index] = length;
            axes[(index + 1) % 3] *= -1.0;
            let found = UnitVectors::new(axes[0], axes[1], axes[2]).unwrap_err();
            assert!(matches!(found, FrameError::NotUnit { axis, .. } if axis == name), "{found}");
        }
        let mut leaning = axes;
        let next = (index + 1) % 3;
        leaning[next] = (axes[next] + axes[index] * 2e-6).normalize();
        leaning[(index + 2) % 3] *= -1.0;
        let found = UnitVectors::new(leaning[0], leaning[1], leaning[2]).unwrap_err();
        assert_eq!(found.error_number(), 2, "{found}");
    }
}

#[test]
fn what_is_within_the_tolerance_passes() {
    let off = UNIT_VECTOR_TOLERANCE * 0.9;
    let x = Vector3::x() * (1.0 + off);
    let axes = UnitVectors::new(x, Vector3::new(off, 1.0, 0.0), Vector3::z()).unwrap();
    assert_eq!(axes.x(), &x);
    // The rotation is one all the same.
    assert!(axes.rotation().angle() < 1e-15, "{}", axes.rotation());
}

#[test]
fn angles_that_are_not_finite_are_refused() {
    for angles in [[f64::NAN, 0.0, 0.0], [0.0, f64::INFINITY, 0.0], [0.0, 0.0, f64::NAN]] {
        let found = UnitVectors::from_roll_pitch_yaw(angles[0], angles[1], angles[2]);
        assert_eq!(found.unwrap_err().error_number(), 1);
    }
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn the_vectors_are_the_columns_of_the_rotation(angles in prop::array::uniform3(-10.0..10.0)) {
        let [roll, pitch, yaw] = angles;
        let axes = UnitVectors::from_roll_pitch_yaw(roll, pitch, yaw).unwrap();
        let expected = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), pitch)
            * Rotation3::from_axis_angle(&Vector3::x_axis(), roll);
        for (found, expected) in [axes.x(), axes.y(), axes.z()].into_iter().zip(expected.matrix().column_iter()) {
            prop_assert!((found - expected).norm() < 2e-15, "{found} {expected}");
        }
        let off = axes.rotation().to_rotation_matrix().matrix() - expected.matrix();
        prop_assert!(off.norm() < 4e-15, "{off}");
    }

    #[test]
    fn angles_come_back(roll in -PI..PI, pitch in -1.5..1.5, yaw in -PI..PI) {
        let axes = UnitVectors::from_roll_pitch_yaw(roll, pitch, yaw).unwrap();
        let found = axes.roll_pitch_yaw();
        // Near a quarter turn of pitch the two others are that much less certain.
        let within = 2e-15 / pitch.cos();
        for (one, other) in found.into_iter().zip([roll, pitch, yaw]) {
            prop_assert!((one - other).abs() < within, "{found:?} {:?}", [roll, pitch, yaw]);
        }
    }

    /// However close the pitch is to a quarter turn, the three angles say the same frame.
    #[test]
    fn angles_give_the_frame_back(
        roll in -PI..PI, exponent in -20.0..0.0, up in any::<bool>(), below in any::<bool>(), yaw in -PI..PI,
    ) {
        let away = 10_f64.powf(exponent) * if below { -1.0 } else { 1.0 };
        let pitch = (FRAC_PI_2 - away) * if up { 1.0 } else { -1.0 };
        let axes = UnitVectors::from_roll_pitch_yaw(roll, pitch, yaw).unwrap();
        let [a, b, c] = axes.roll_pitch_yaw();
        prop_assert!(b.abs() <= FRAC_PI_2 && a.abs() <= PI && c.abs() <= PI);
        let again = UnitVectors::from_roll_pitch_yaw(a, b, c).unwrap();
        for (one, other) in [axes.x(), axes.y(), axes.z()].into_iter().zip([again.x(), again.y(), again.z()]) {
            prop_assert!((one - other).norm() < 1e-14, "{one} {other}");
        }
    }

    /// A frame given by its vectors and the old origin in it is the work frame at −R·t.
    #[test]
    fn a_work_frame_is_a_coordinate_transformation(
        axis in prop::array::uniform3(-1.0..1.0), angle in -PI..PI,
        translation in prop::array::uniform3(-2.0..2.0), point in prop::array::uniform3(-2.0..2.0),
    ) {
        let axis = Vector3::from(axis);
        prop_assume!(axis.norm() > 1e-3);
        let rotation = UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), angle);
        let axes = UnitVectors::new(rotation * Vector3::x(), rotation * Vector3::y(), rotation * Vector3::z()).unwrap();
        let (translation, point) = (Vector3::from(translation), Point3::from(point));
        let frame = WorkFrame::placed(axes.rotation(), -(rotation * translation));
        let expected = axes.coordinate_transformation(&point, &translation);
        prop_assert!((frame.point_to_work(&point) - expected).norm() < 1e-14);
        let [roll, pitch, yaw] = axes.roll_pitch_yaw();
        let by_angles = WorkFrame::new(-(rotation * translation), roll, pitch, yaw);
        prop_assert!((by_angles.point_to_work(&point) - expected).norm() < 1e-14);
    }
}
