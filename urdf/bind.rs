//! Binding of a loaded model to the axes of a machine.
//!
//! A joint position is ± the position of its axis plus an offset. Binding puts sign and offset into the joint, so that
//! afterwards joint and axis positions are equal. Joints without an axis become fixed.

use crate::{Joint, JointDrive, JointKind, Model};
use nalgebra::Isometry3;

/// An axis of the machine and the joint that it moves.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisJoint {
    /// Index of the axis, in the order of the machine file.
    pub machine_axis: usize,
    /// Name of the joint.
    pub joint: String,
    /// The joint moves backwards when the axis moves forwards.
    pub reversed: bool,
    /// Position of the joint with the axis at 0, m or rad.
    pub offset: f64,
}

/// Axes and joints that do not belong together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BindError {
    /// A joint that is not there.
    #[error("there is no joint {joint}; those that move are {}", moving.join(", "))]
    NoJoint {
        /// Its name.
        joint: String,
        /// What there is.
        moving: Vec<String>,
    },
    /// A joint that does not move.
    #[error("joint {0} is fixed")]
    Fixed(String),
    /// A joint that another one moves.
    #[error("joint {0} mimics another joint and moves with it: name that joint instead")]
    Mimics(String),
    /// A joint that is named twice.
    #[error("joint {0} is assigned more than once: let one axis move it, or hold it, not both")]
    Twice(String),
    /// Joints that nothing is said of.
    #[error("no axis moves {}, and nothing holds {them}", .0.join(", "), them = if .0.len() == 1 { "it" } else { "them" })]
    Unmoved(Vec<String>),
    /// A joint that is held where it cannot be.
    #[error("joint {joint} is held at {position} (m or rad), beyond its limits {} … {}", limits[0], limits[1])]
    Beyond {
        /// Its name.
        joint: String,
        /// m or rad.
        position: f64,
        /// m or rad.
        limits: [f64; 2],
    },
}

impl Model {
    /// Lets `axes` move the joints that they name, and nothing the others, which are `held` at these positions (m or rad).
    /// What a joint may use its limits and its safety controller say, in positions of the axis then.
    ///
    /// # Errors
    /// The first of [`BindError`].
    pub fn bind(&mut self, axes: &[AxisJoint], held: &[(String, f64)]) -> Result<(), BindError> {
        let mut settled = vec![false; self.joints.len()];
        for axis in axes {
            let index = self.free_joint(&axis.joint, &mut settled)?;
            self.put_on_axis(index, axis);
        }
        for (name, position) in held {
            let index = self.free_joint(name, &mut settled)?;
            if let Some(limits) = self.joints.get(index).and_then(Joint::usable_limits) {
                let [lower, upper] = limits;
                if !(lower..=upper).contains(position) {
                    let (joint, position) = (name.clone(), *position);
                    return Err(BindError::Beyond { joint, position, limits });
                }
            }
            self.hold(index, *position);
        }
        let unmoved = |(joint, settled): (&Joint, &bool)| {
            let moves = joint.kind != JointKind::Fixed
                && !matches!(joint.drive, JointDrive::Mimic { .. } | JointDrive::Passive { .. });
            (moves && !settled).then(|| joint.name.clone())
        };
        let joints: Vec<_> = self.joints.iter().zip(&settled).filter_map(unmoved).collect();
        if joints.is_empty() { Ok(()) } else { Err(BindError::Unmoved(joints)) }
    }

    /// Puts the base at `machine_from_base`: the frame of link 0 is that of the machine, so another link becomes link 0.
    pub fn stand_at(&mut self, machine_from_base: Isometry3<f64>) {
        if machine_from_base == Isometry3::identity() {
            return;
        }
        let is_free = |name: &&String| !self.links.iter().any(|link| link.name == **name);
        let numbered = |number: u32| match number {
            0 => "machine".to_owned(),
            number => format!("machine{number}"),
        };
        let names: Vec<_> = (0..1000).map(numbered).collect();
        let name = names.iter().find(is_free).cloned().unwrap_or_default();
        for joint in &mut self.joints {
            joint.parent += 1;
            joint.child += 1;
            if let JointDrive::Mimic { joint, .. } = &mut joint.drive {
                *joint += 1;
            }
        }
        for closing in &mut self.loops {
            closing.links = closing.links.map(|link| link + 1);
        }
        self.tip.link += 1;
        self.links.insert(0, crate::Link::new(name.clone(), None, Vec::new()));
        let axis = nalgebra::Vector3::x_axis();
        let name = format!("{name}_base");
        let stand =
            Joint::new(name, JointKind::Fixed, [0, 1], machine_from_base, axis, JointDrive::Fixed);
        self.joints.insert(0, stand);
    }

    /// The joint called `name`, which nothing has been said of before.
    fn free_joint(&self, name: &str, settled: &mut [bool]) -> Result<usize, BindError> {
        let joint = || name.to_owned();
        let Some(index) = self.joints.iter().position(|joint| joint.name == name) else {
            let free =
                |(_, joint): &(usize, &Joint)| !matches!(joint.drive, JointDrive::Mimic { .. });
            let moving = self.moving_joints().filter(free);
            let moving = moving.map(|(_, joint)| joint.name.clone()).collect();
            return Err(BindError::NoJoint { joint: joint(), moving });
        };
        match self.joints.get(index) {
            Some(found) if found.kind == JointKind::Fixed && settled.get(index) == Some(&false) => {
                return Err(BindError::Fixed(joint()));
            }
            Some(Joint { drive: JointDrive::Mimic { .. }, .. }) => {
                return Err(BindError::Mimics(joint()));
            }
            _ => {}
        }
        match settled.get_mut(index) {
            Some(settled) if !*settled => {
                *settled = true;
                Ok(index)
            }
            _ => Err(BindError::Twice(joint())),
        }
    }

    fn put_on_axis(&mut self, index: usize, axis: &AxisJoint) {
        let sign = if axis.reversed { -1.0 } else { 1.0 };
        let Some(joint) = self.joints.get_mut(index) else { return };
        let to_axis = |position: f64| sign * (position - axis.offset);
        let between = |[lower, upper]: [f64; 2]| {
            if axis.reversed {
                [to_axis(upper), to_axis(lower)]
            } else {
                [lower, upper].map(to_axis)
            }
        };
        joint.position_limits = joint.position_limits.map(between);
        if let Some(safety) = &mut joint.details.safety {
            let [lower, upper] = safety.soft_limits;
            if lower < upper {
                safety.soft_limits = between([lower, upper]);
            }
        }
        if let Some(calibration) = &mut joint.details.calibration {
            let edges = (calibration.rising.map(to_axis), calibration.falling.map(to_axis));
            // What rises one way falls the other.
            (calibration.rising, calibration.falling) =
                if axis.reversed { (edges.1, edges.0) } else { edges };
        }
        if axis.offset != 0.0 {
            joint.origin = joint.transform(axis.offset);
        }
        if axis.reversed {
            joint.axis = -joint.axis;
        }
        joint.drive = JointDrive::Axis(axis.machine_axis);
        for follower in &mut self.joints {
            if let JointDrive::Mimic { joint, multiplier, offset } = &mut follower.drive
                && *joint == index
            {
                *offset += *multiplier * axis.offset;
                *multiplier *= sign;
            }
        }
    }

    /// Fixes the joint at `position`, and those that follow it.
    fn hold(&mut self, index: usize, position: f64) {
        let follows = |follower: usize| {
            let following =
                self.following(follower).filter(|following| following.leader == index)?;
            Some((follower, following.position(position)))
        };
        let held: Vec<_> = (0..self.joints.len()).filter_map(follows).collect();
        for (index, position) in held {
            if let Some(joint) = self.joints.get_mut(index) {
                *joint = Joint::new(
                    joint.name.clone(),
                    JointKind::Fixed,
                    [joint.parent, joint.child],
                    joint.transform(position),
                    joint.axis,
                    JointDrive::Fixed,
                );
            }
        }
    }
}
