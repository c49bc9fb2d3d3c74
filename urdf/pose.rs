//! Forward kinematics of a model: link poses from axis positions.

use crate::{Joint, JointDrive, JointKind, JointPositions, Model};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion};

impl JointDrive {
    /// The position that this drive gives its joint with the machine's axes at `axes` (m or rad, machine-file order). An
    /// axis beyond their end is at 0, a passive joint at rest; what a joint that mimics another does
    /// [`Model::joint_position`] says.
    fn position(&self, axes: &[f64]) -> f64 {
        let at = |axis: usize| axes.get(axis).copied().unwrap_or_default();
        match self {
            Self::Fixed | Self::Mimic { .. } => 0.0,
            Self::Axis(axis) => at(*axis),
            Self::Combination(parts) => parts.iter().map(|(axis, factor)| factor * at(*axis)).sum(),
            Self::Passive { rest } => *rest,
        }
    }
}

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
}

impl Model {
    /// The position of the joint `index` (m or rad) with the machine's axes at `axes` (m or rad, machine-file order). An
    /// axis beyond their end is at 0, a passive joint at rest.
    pub fn joint_position(&self, index: usize, axes: &[f64]) -> f64 {
        match self.joints.get(index).map(|joint| &joint.drive) {
            Some(JointDrive::Mimic { .. }) => self.following(index).map_or(0.0, |following| {
                let leader = self.joints.get(following.leader);
                following.position(leader.map_or(0.0, |leader| leader.drive.position(axes)))
            }),
            Some(drive) => drive.position(axes),
            None => 0.0,
        }
    }

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

    /// [`Self::link_poses`] without allocating, if there are no loops. `poses` needs one element per link; links beyond
    /// its end are left out.
    ///
    /// Loops that cannot be closed are shown as nearly closed as they can be; [`JointPositions::follow`] reports them.
    pub fn link_poses_into(&self, axes: &[f64], poses: &mut [Isometry3<f64>]) {
        if self.loops.is_empty() {
            self.place_links(|index, _| self.joint_position(index, axes), poses);
        } else {
            self.link_poses_at(self.nearest(axes).values(), poses);
        }
    }

    /// Poses of the links in the machine frame with the joints at `positions` (m or rad, one per joint). A joint beyond
    /// their end stands at 0.
    pub fn link_poses_at(&self, positions: &[f64], poses: &mut [Isometry3<f64>]) {
        self.place_links(|index, _| positions.get(index).copied().unwrap_or_default(), poses);
    }

    /// The tool tip in the machine frame (m) with the machine's axes at `axes` (m or rad, machine-file order). Of loops
    /// that cannot be closed the same holds as for [`Self::link_poses_into`].
    pub fn tip_position(&self, axes: &[f64]) -> Point3<f64> {
        if self.loops.is_empty() {
            self.tip_with(|index, _| self.joint_position(index, axes))
        } else {
            let positions = self.nearest(axes);
            self.tip_with(|index, _| positions.values().get(index).copied().unwrap_or_default())
        }
    }

    /// As nearly closed as the loops can be.
    fn nearest(&self, axes: &[f64]) -> JointPositions {
        let mut positions = JointPositions::at_rest(self);
        // A picture shows it.
        positions.follow(self, axes).unwrap_or_default();
        positions
    }

    fn place_links(&self, position: impl Fn(usize, &Joint) -> f64, poses: &mut [Isometry3<f64>]) {
        if let Some(base) = poses.first_mut() {
            *base = Isometry3::identity();
        }
        for (index, joint) in self.joints.iter().enumerate() {
            let Some(parent) = poses.get(joint.parent).copied() else { continue };
            if let Some(child) = poses.get_mut(joint.child) {
                *child = parent * joint.transform(position(index, joint));
            }
        }
    }

    fn tip_with(&self, position: impl Fn(usize, &Joint) -> f64) -> Point3<f64> {
        let mut point = self.tip.point;
        let mut link = self.tip.link;
        // From the tool down to the base; a parent has a smaller index than its child, so this ends.
        while let Some((index, joint)) =
            link.checked_sub(1).and_then(|index| Some((index, self.joints.get(index)?)))
        {
            point = joint.transform(position(index, joint)) * point;
            if joint.parent >= link {
                break;
            }
            link = joint.parent;
        }
        point
    }
}
