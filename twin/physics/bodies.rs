//! Links of a model as bodies on moving joints, with checks of the model.

use nalgebra::{Isometry3, Matrix3, Point3, Unit, Vector3};
use twin_kinematics::MAX_AXES;
use twin_urdf::{Joint, JointDrive, JointKind, Link, Model};

use crate::error::{PhysicsError, Result};
use crate::joint::JointMatrix;

/// Motion of a body against its parent: with the joint of this number.
#[derive(Clone, Copy, Debug)]
pub(super) enum Motion {
    Fixed,
    Revolute(usize, Unit<Vector3<f64>>),
    Prismatic(usize, Unit<Vector3<f64>>),
}

impl Motion {
    pub(super) fn joint(&self) -> Option<usize> {
        match self {
            Self::Fixed => None,
            Self::Revolute(joint, _) | Self::Prismatic(joint, _) => Some(*joint),
        }
    }
}

/// Mass, centre of mass (m) and inertia about it (kg·m²) of a link, in its frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct MassProperties {
    pub(super) mass: f64,
    pub(super) center: Point3<f64>,
    pub(super) inertia: Matrix3<f64>,
}

impl MassProperties {
    /// Of the link `index`, none if it has none.
    /// Errors: [`PhysicsError::MassProperties`] if no body can have them.
    pub(super) fn of(index: usize, link: &Link) -> Result<Self> {
        let found = link.inertial.map_or(
            Self { mass: 0.0, center: Point3::origin(), inertia: Matrix3::zeros() },
            |given| Self { mass: given.mass, center: given.center, inertia: given.inertia },
        );
        let Self { mass, center, inertia } = found;
        let possible = mass.is_finite()
            && mass >= 0.0
            && center.iter().chain(inertia.iter()).all(|value| value.is_finite())
            && (inertia - inertia.transpose()).amax() <= 1e-9 * inertia.amax()
            && inertia.symmetric_eigenvalues().min() >= -1e-9 * inertia.amax();
        if possible { Ok(found) } else { Err(PhysicsError::MassProperties { link: index, mass }) }
    }
}

/// A link with its joint; what does not change.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// `None`: the base.
    pub(super) parent: Option<usize>,
    pub(super) origin: Isometry3<f64>,
    pub(super) motion: Motion,
    pub(super) mass: MassProperties,
}

/// Links of a model behind the base. Joints have the numbers of their axes unless axes are coupled.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    pub(super) bodies: Vec<Body>,
    /// Joint motion (rows) per axis (columns), where an axis moves several joints.
    pub(super) coupling: Option<JointMatrix>,
    /// Number of joints that mimic others.
    pub(super) followers: usize,
}

impl Tree {
    /// The links of `model`, which are a tree, moved by the axes `0..axis_count`.
    /// Errors: a model that is not a tree.
    pub(super) fn new(model: &Model, axis_count: usize) -> Result<Self> {
        if !model.loops.is_empty() {
            return Err(PhysicsError::ClosedLoops(model.loops.len()));
        }
        let coupled = model.joints.iter().any(|joint| {
            matches!(joint.drive, JointDrive::Combination(_) | JointDrive::Mimic { .. })
        });
        let mut coupling = JointMatrix::zeros();
        let mut count = 0;
        let mut bodies: Vec<Body> = Vec::with_capacity(model.joints.len());
        let mut moved = [false; MAX_AXES];
        for (index, joint) in model.joints.iter().enumerate() {
            let not_a_tree =
                PhysicsError::NotATree { joint: index, parent: joint.parent, child: joint.child };
            if joint.child != index + 1 || joint.parent > index {
                return Err(not_a_tree);
            }
            let link = model.links.get(joint.child).ok_or(not_a_tree)?;
            let wrong = PhysicsError::JointAxis(index);
            let following = model.following(index).ok_or(PhysicsError::CoupledJoint(index))?;
            let drive =
                model.joints.get(following.leader).map_or(&joint.drive, |leader| &leader.drive);
            let own = if coupled { count } else { joint.drive.axis().unwrap_or_default() };
            let motion = match (joint.kind, drive) {
                (_, JointDrive::Passive { .. }) => {
                    return Err(PhysicsError::CoupledJoint(index));
                }
                (JointKind::Fixed, JointDrive::Fixed) => Motion::Fixed,
                (JointKind::Revolute, JointDrive::Axis(_) | JointDrive::Combination(_)) => {
                    Motion::Revolute(own, joint.axis)
                }
                (JointKind::Prismatic, JointDrive::Axis(_) | JointDrive::Combination(_)) => {
                    Motion::Prismatic(own, joint.axis)
                }
                _ => return Err(wrong),
            };
            if motion.joint().is_some() {
                count += 1;
                if coupled && count > MAX_AXES {
                    return Err(PhysicsError::AxisNumber(count));
                }
            }
            match drive {
                JointDrive::Axis(axis) if following.leader == index => {
                    let slot = moved.get_mut(*axis).filter(|_| *axis < axis_count).ok_or(wrong)?;
                    if *slot {
                        let axis = *axis;
                        return Err(PhysicsError::AxisMovesTwoJoints { joint: index, axis });
                    }
                    *slot = true;
                    coupling[(own, *axis)] = 1.0;
                }
                JointDrive::Combination(parts) => {
                    for (axis, factor) in parts {
                        let entry = coupling.get_mut((own, *axis));
                        let factor = following.multiplier * factor;
                        let possible = *axis < axis_count && factor.is_finite();
                        *entry.filter(|_| possible).ok_or(wrong)? += factor;
                    }
                }
                JointDrive::Axis(axis) => {
                    let entry = coupling.get_mut((own, *axis));
                    let possible = *axis < axis_count && following.multiplier.is_finite();
                    *entry.filter(|_| possible).ok_or(wrong)? += following.multiplier;
                }
                JointDrive::Fixed | JointDrive::Passive { .. } | JointDrive::Mimic { .. } => {}
            }
            // A joint that follows another begins where it is with that one at 0.
            let origin = match joint.drive {
                JointDrive::Mimic { .. } => joint.transform(following.offset),
                _ => joint.origin,
            };
            let parent = joint.parent.checked_sub(1);
            let mass = MassProperties::of(joint.child, link)?;
            bodies.push(Body { parent, origin, motion, mass });
        }
        if model.links.len() != bodies.len() + 1 {
            let joint = model.joints.len();
            return Err(PhysicsError::NotATree { joint, parent: 0, child: joint + 1 });
        }
        let mimics = |joint: &&Joint| matches!(joint.drive, JointDrive::Mimic { .. });
        let followers = model.joints.iter().filter(mimics).count();
        Ok(Self { bodies, coupling: coupled.then_some(coupling), followers })
    }

    /// Checks that axis positions determine all joint positions, and the other way round unless joints mimic
    /// others.
    /// Errors: [`PhysicsError::CoupledJoint`].
    pub(super) fn check_coupling(&self, axis_count: usize) -> Result<()> {
        let Some(mut to_joints) = self.coupling.filter(|_| self.followers == 0) else {
            return Ok(());
        };
        let moving = self.bodies.iter().position(|body| body.motion.joint().is_some());
        let uneven = PhysicsError::CoupledJoint(moving.unwrap_or_default());
        let joints = self.bodies.iter().filter(|body| body.motion.joint().is_some()).count();
        for beyond in axis_count..MAX_AXES {
            to_joints[(beyond, beyond)] = 1.0;
        }
        let is_even = joints == axis_count && to_joints.try_inverse().is_some();
        is_even.then_some(()).ok_or(uneven)
    }

    /// True if anything moves with `axis`.
    pub(super) fn moves_with(&self, axis: usize) -> bool {
        match &self.coupling {
            Some(coupling) => coupling.column(axis).iter().any(|factor| *factor != 0.0),
            None => self.bodies.iter().any(|body| body.motion.joint() == Some(axis)),
        }
    }
}
