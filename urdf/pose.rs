//! Where the links of a machine are when its axes are somewhere.

use crate::{Joint, JointKind, Model};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion};

impl Joint {
    /// Pose of the child link in the parent link with the joint at `position` (m or rad).
    pub fn transform(&self, position: f64) -> Isometry3<f64> {
        match self.kind {
            JointKind::Revolute => {
                self.origin * UnitQuaternion::from_axis_angle(&self.axis, position)
            }
            JointKind::Prismatic => {
                self.origin * Translation3::from(self.axis.into_inner() * position)
            }
            JointKind::Fixed => self.origin,
        }
    }

    /// The position of this joint among those of the machine's axes. A joint without an axis, or with one beyond the
    /// end of `axes`, stands at 0.
    fn position(&self, axes: &[f64]) -> f64 {
        self.machine_axis.and_then(|axis| axes.get(axis)).copied().unwrap_or_default()
    }
}

impl Model {
    /// The joints that move, with their indices.
    pub fn moving_joints(&self) -> impl Iterator<Item = (usize, &Joint)> {
        self.joints.iter().enumerate().filter(|(_, joint)| joint.kind != JointKind::Fixed)
    }

    /// Pose of every link in the machine frame with the machine's axes at `axes` (m or rad, machine-file order).
    pub fn link_poses(&self, axes: &[f64]) -> Vec<Isometry3<f64>> {
        let mut poses = vec![Isometry3::identity(); self.links.len()];
        self.link_poses_into(axes, &mut poses);
        poses
    }

    /// [`Self::link_poses`] without allocating. `poses` needs one element per link; links beyond its end are left out.
    pub fn link_poses_into(&self, axes: &[f64], poses: &mut [Isometry3<f64>]) {
        if let Some(base) = poses.first_mut() {
            *base = Isometry3::identity();
        }
        for joint in &self.joints {
            let Some(parent) = poses.get(joint.parent).copied() else { continue };
            if let Some(child) = poses.get_mut(joint.child) {
                *child = parent * joint.transform(joint.position(axes));
            }
        }
    }

    /// The tool tip in the machine frame (m) with the machine's axes at `axes` (m or rad, machine-file order).
    pub fn tip_position(&self, axes: &[f64]) -> Point3<f64> {
        let mut point = self.tip.point;
        let mut link = self.tip.link;
        // From the tool down to the base; a parent has a smaller index than its child, so this ends.
        while let Some(joint) = link.checked_sub(1).and_then(|index| self.joints.get(index)) {
            point = joint.transform(joint.position(axes)) * point;
            if joint.parent >= link {
                break;
            }
            link = joint.parent;
        }
        point
    }
}
