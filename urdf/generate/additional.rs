//! Additional axes, which move neither tool nor work: a feeder, a turntable, a second spindle's slide.

use super::{MachineJoint, cuboid, paint, upright};
use crate::{Inertial, JointKind, Link, Model};
use nalgebra::{Isometry3, Point3, Vector3};

/// Edge of a slide, and diameter of a turntable, m.
const SIZE: f64 = 0.06;
/// kg.
const MASS: f64 = 1.0;
/// Place of the first of them in the machine frame, m: behind most machines.
const PLACE: [f64; 2] = [-0.6, 0.0];
/// From one to the next along y, m.
const SPACING: f64 = 0.15;

impl Model {
    /// Adds an axis that moves neither tool nor work, as a table of 1 kg that turns about z or slides along x. The first
    /// is at x −0.6 m, every further one 0.15 m from it (`number`, from 0).
    pub fn add_additional_axis(&mut self, joint: &MachineJoint, turns: bool, number: u8) {
        let half = SIZE / 2.0;
        let (kind, axis, inertial, solid) = if turns {
            (
                JointKind::Revolute,
                Vector3::z_axis(),
                Inertial::uniform_cylinder(MASS, half, SIZE, Point3::origin()),
                upright(0.0, 0.0, [-half, half], half, paint::STEEL),
            )
        } else {
            (
                JointKind::Prismatic,
                Vector3::x_axis(),
                Inertial::uniform_box(MASS, Vector3::from_element(SIZE), Point3::origin()),
                cuboid([-half; 3], [half; 3], paint::STEEL),
            )
        };
        let child = self.links.len();
        let [x, y] = PLACE;
        let origin = Isometry3::translation(x, y + SPACING * f64::from(number), half);
        self.joints.push(joint.joint(kind, axis, 0, child, origin));
        self.links.push(Link::new(format!("{}_table", joint.name), Some(inertial), vec![solid]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::GantryDimensions;

    #[test]
    fn they_move_and_the_tool_does_not() {
        let joint = |name: &str, axis| MachineJoint::new(name, axis, [-1.0, 1.0]);
        let dimensions =
            GantryDimensions::new("portal", [joint("X", 0), joint("Y", 1)], Some(joint("Z", 2)));
        let mut model = dimensions.model().unwrap();
        let tip = model.tip_position(&[0.1, 0.2, 0.3]);
        model.add_additional_axis(&joint("P", 3), true, 0);
        model.add_additional_axis(&joint("Q", 4), false, 1);
        let axes = [0.1, 0.2, 0.3, 0.5, 0.25];
        assert_eq!(model.tip_position(&axes), tip);
        let poses = model.link_poses(&axes);
        let [.., turned, slid] = poses.as_slice() else { panic!("five moving links") };
        assert!((turned.rotation.angle() - 0.5).abs() < 1e-12);
        assert!((slid.translation.vector - Vector3::new(-0.35, 0.15, 0.03)).norm() < 1e-12);
        // What is written can be read.
        let text = model.to_urdf().unwrap();
        let read = Model::from_urdf(&text, &["X", "Y", "Z", "P", "Q"]).unwrap();
        assert_eq!(read.joints.len(), model.joints.len());
    }
}
