//! Three straight axes along x, y and z (`SMC_TRAFO_Gantry3`, `SMC_TRAFOF_Gantry3`, `SMC_TRAFOV_Gantry3`;
//! SoftMotion manual 8.2.1).
//!
//! ```text
//!   z ▲  ▲ y        axis X = x + offset X
//!     │ ╱           axis Y = y + offset Y
//!     │╱            axis Z = z + offset Z
//!     └────▶ x
//! ```
//!
//! Zero pose: with offsets 0 the tool tip is at the origin of the machine frame when every axis is at 0. An offset
//! is the position of its axis when the tip is there. Positive is along the coordinate. There are no branches, no
//! singularities and no bound of reach; velocities and accelerations pass unchanged, because offsets are constant
//! (the manual's `dvx = dVel · vx`).

use crate::{AxisMotion, AxisVector, Coordinate, Kinematics, KinematicsError, Pose, ToolMotion};

/// A gantry with three axes along x, y and z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gantry3 {
    /// Added to the coordinate to give the axis position, m: `dOffsetX`, `dOffsetY`, `dOffsetZ`.
    pub offset: [f64; 3],
}

impl Gantry3 {
    /// A gantry whose axes are at `offset` (m) when the tool tip is at the machine's origin.
    pub const fn new(offset: [f64; 3]) -> Self {
        Self { offset }
    }
}

impl Kinematics for Gantry3 {
    fn axis_count(&self) -> usize {
        3
    }

    fn coordinates(&self) -> &[Coordinate] {
        &[Coordinate::X, Coordinate::Y, Coordinate::Z]
    }

    fn forward(&self, axes: &AxisVector) -> Result<Pose, KinematicsError> {
        let &[x, y, z] = &**axes else {
            return Err(KinematicsError::AxisCount { given: axes.len(), expected: 3 });
        };
        let pose = Pose::at(x - self.offset[0], y - self.offset[1], z - self.offset[2]);
        if pose.is_finite() { Ok(pose) } else { Err(KinematicsError::NotFinite) }
    }

    fn inverse(&self, pose: &Pose, _near: &AxisVector) -> Result<AxisVector, KinematicsError> {
        let axes = AxisVector::from_values(
            pose.position.iter().zip(&self.offset).map(|(value, offset)| value + offset),
        );
        if axes.is_finite() { Ok(axes) } else { Err(KinematicsError::NotFinite) }
    }

    fn inverse_motion(
        &self,
        tool: &ToolMotion,
        near: &AxisVector,
    ) -> Result<AxisMotion, KinematicsError> {
        let motion = AxisMotion {
            position: self.inverse(&tool.pose, near)?,
            velocity: AxisVector::from_values(tool.velocity.iter().copied()),
            acceleration: AxisVector::from_values(tool.acceleration.iter().copied()),
        };
        if motion.is_finite() { Ok(motion) } else { Err(KinematicsError::NotFinite) }
    }
}

#[cfg(test)]
mod tests {
    use super::Gantry3;
    use crate::{AxisVector, Kinematics, KinematicsError, Pose, ToolMotion};
    use nalgebra::Vector3;
    use proptest::prelude::*;

    fn axes(values: [f64; 3]) -> AxisVector {
        AxisVector::from_values(values)
    }

    /// SoftMotion vector `trafo-gantry3`, mm.
    #[test]
    fn trafo_gantry3() {
        let gantry = Gantry3::new([1e-3, 2e-3, 3e-3]);
        let pose = Pose::at(10e-3, 20e-3, 30e-3);
        let found = gantry.inverse(&pose, &AxisVector::zeros(3)).unwrap();
        for (found, expected) in found.iter().zip([11e-3, 22e-3, 33e-3]) {
            assert!((found - expected).abs() < 1e-17, "{found} {expected}");
        }
        let back = gantry.forward(&axes([11e-3, 22e-3, 33e-3])).unwrap();
        assert!((back.position - pose.position).norm() < 1e-17, "{back:?}");
    }

    /// SoftMotion vector `trafov-gantry3`, mm/s: velocity 26 along (3, 4, 12)/13.
    #[test]
    fn trafov_gantry3() {
        let mut tool = ToolMotion::at_rest(Pose::at(0.0, 0.0, 0.0));
        tool.velocity = Vector3::new(3.0, 4.0, 12.0) / 13.0 * 26e-3;
        tool.acceleration = Vector3::new(1.0, -2.0, 3.0);
        let motion =
            Gantry3::new([1.0, 2.0, 3.0]).inverse_motion(&tool, &AxisVector::zeros(3)).unwrap();
        for (found, expected) in motion.velocity.iter().zip([6e-3, 8e-3, 24e-3]) {
            assert!((found - expected).abs() < 1e-17, "{found} {expected}");
        }
        assert_eq!(*motion.acceleration, [1.0, -2.0, 3.0]);
    }

    #[test]
    fn refuses_what_is_no_number_and_the_wrong_number_of_axes() {
        let gantry = Gantry3::default();
        let near = AxisVector::zeros(3);
        assert_eq!(
            gantry.inverse(&Pose::at(0.0, f64::NAN, 0.0), &near),
            Err(KinematicsError::NotFinite)
        );
        assert_eq!(
            gantry.forward(&axes([0.0, 0.0, f64::INFINITY])),
            Err(KinematicsError::NotFinite)
        );
        let wrong = Err(KinematicsError::AxisCount { given: 2, expected: 3 });
        assert_eq!(gantry.forward(&AxisVector::zeros(2)), wrong);
    }

    proptest! {
        #![proptest_config(crate::tests::seeded())]

        #[test]
        fn forward_undoes_inverse(
            offset in prop::array::uniform3(-5.0..5.0),
            target in prop::array::uniform3(-5.0..5.0),
        ) {
            let gantry = Gantry3::new(offset);
            let pose = Pose::at(target[0], target[1], target[2]);
            let found = gantry.inverse(&pose, &AxisVector::zeros(3)).unwrap();
            let back = gantry.forward(&found).unwrap();
            prop_assert!((back.position - pose.position).norm() < 1e-14);
        }
    }
}
