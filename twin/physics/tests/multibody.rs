//! The links of a tree as one multibody of rapier, fixed at its base: a reference with its own equation of motion.
//!
//! Facts about rapier 0.36 that shape this file: it has no call for generalised forces. An effort is therefore applied
//! as a pair of forces or torques on the two bodies of the joint, and remains until reset. Angular joints get a damping
//! of 0.1 by default, which is set to zero. The root has six degrees of freedom until the first forward kinematics
//! finds it fixed, so nothing is indexed before. Bodies in slow motion would fall asleep, so sleeping is disabled.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rapier3d_f64::dynamics::{
    GenericJointBuilder, JointAxesMask, MultibodyIndex, RigidBodyBuilder, RigidBodyHandle,
};
use rapier3d_f64::geometry::ColliderSet;
use rapier3d_f64::parry::mass_properties::MassProperties;
use rapier3d_f64::pipeline::PhysicsWorld;
use twin_kinematics::MAX_AXES;
use twin_urdf::{Joint, JointKind, Link, Model};

use super::PhysicsError;
use crate::bodies::Tree;
use crate::equation::Equation;
use crate::joint::{JointMatrix, JointVector};
use crate::maths;

/// A joint that moves and where rapier keeps it.
#[derive(Clone, Copy, Debug)]
struct MovingJoint {
    /// Its number in the [`Tree`].
    number: usize,
    revolute: bool,
    parent: RigidBodyHandle,
    child: RigidBodyHandle,
    /// Direction of motion in the frame of the child (rotation about it and translation along it leave it alone).
    direction: Vector3<f64>,
    /// Index of the child in the multibody's links.
    link: usize,
    /// Index into the multibody's generalised coordinates.
    coordinate: usize,
}

/// A machine that rapier moves, with all its joints.
pub(super) struct RapierAlone {
    world: PhysicsWorld,
    multibody: Multibody,
}

impl RapierAlone {
    /// The machine at rest at `position`, with `armature` per axis, in steps of `dt` s with `iterations` of the solver.
    pub(super) fn new(
        model: &Model,
        equation: &Equation,
        gravity: Vector3<f64>,
        (armature, position): (&JointVector, &JointVector),
        (dt, iterations): (f64, usize),
    ) -> Self {
        let Equation::Tree(dynamics) = equation else { panic!("a tree") };
        let mut world =
            PhysicsWorld { gravity: maths::vector_to_rapier(&gravity), ..PhysicsWorld::default() };
        world.integration_parameters.dt = dt;
        world.integration_parameters.num_solver_iterations = iterations;
        let coupling = dynamics.tree().coupling.map(|mut to_joints| {
            for beyond in equation.axis_count()..MAX_AXES {
                to_joints[(beyond, beyond)] = 1.0;
            }
            to_joints
        });
        let (mut multibody, _) = Multibody::join(&mut world, model, coupling.as_ref()).unwrap();
        // rapier knows them of the first step on.
        let no_colliders = ColliderSet::new();
        for (_, body) in world.bodies.iter_mut() {
            body.recompute_mass_properties_from_colliders(&no_colliders);
        }
        multibody.place(&mut world, dynamics.tree(), armature, position);
        Self { world, multibody }
    }

    /// Positions and velocities of the joints.
    pub(super) fn motion(&self) -> (JointVector, JointVector) {
        self.multibody.motion(&self.world)
    }

    /// Makes the joints move with `velocity` at the start of the next step.
    pub(super) fn set_velocity(&mut self, velocity: &JointVector) {
        self.multibody.set_velocity(&mut self.world, velocity);
    }

    /// Applies `effort` from the next step on.
    pub(super) fn apply_effort(&mut self, effort: &JointVector) {
        self.multibody.apply_effort(&mut self.world, effort);
    }

    pub(super) fn step(&mut self) {
        self.world.step();
    }
}

/// The joints of a tree.
#[derive(Clone, Debug)]
struct Multibody {
    index: MultibodyIndex,
    joints: Vec<MovingJoint>,
    /// If joints do not each move with an axis of their own.
    coupling: Option<JointMatrix>,
}

impl Multibody {
    /// Joins the links of `model` in `world`; also their bodies, the base first.
    ///
    /// # Errors
    /// [`PhysicsError::NotATree`] if rapier cannot, and [`PhysicsError::AxisNumber`].
    fn join(
        world: &mut PhysicsWorld,
        model: &Model,
        coupling: Option<&JointMatrix>,
    ) -> Result<(Self, Vec<RigidBodyHandle>), PhysicsError> {
        let mut links = vec![world.insert_body(RigidBodyBuilder::fixed())];
        let mut multibody = None;
        for (index, (joint, link)) in
            model.joints.iter().zip(model.links.iter().skip(1)).enumerate()
        {
            let not_a_tree =
                PhysicsError::NotATree { joint: index, parent: joint.parent, child: joint.child };
            let parent = *links.get(joint.parent).ok_or(not_a_tree)?;
            let child = world.insert_body(body(link));
            world.insert_multibody_joint(parent, child, generic_joint(joint)).ok_or(not_a_tree)?;
            multibody =
                world.multibody_joints.rigid_body_link(child).map(|id| id.multibody).or(multibody);
            links.push(child);
        }
        let index = multibody.ok_or(PhysicsError::AxisNumber(0))?;
        let joints = model.joints.iter().filter_map(|joint| {
            Some(MovingJoint {
                number: 0,
                revolute: joint.kind == JointKind::Revolute,
                parent: *links.get(joint.parent)?,
                child: *links.get(joint.child)?,
                direction: joint.axis.into_inner(),
                link: 0,
                coordinate: 0,
            })
        });
        let joints = joints.collect();
        Ok((Self { index, joints, coupling: coupling.copied() }, links))
    }

    /// Finds the moving joints among rapier's generalised coordinates and moves them to `position`.
    fn place(
        &mut self,
        world: &mut PhysicsWorld,
        tree: &Tree,
        armature: &JointVector,
        position: &JointVector,
    ) {
        let PhysicsWorld { bodies, multibody_joints, .. } = world;
        let Some(multibody) = multibody_joints.get_multibody_mut(self.index) else { return };
        multibody.forward_kinematics(bodies, true);

        let numbers = tree.bodies.iter().map(|body| body.motion.joint());
        let joints = std::mem::take(&mut self.joints).into_iter().zip(numbers);
        self.joints = joints
            .filter_map(|(joint, number)| {
                let link =
                    multibody.links().find(|link| link.rigid_body_handle() == joint.child)?;
                let (link, coordinate) = (link.link_id(), link.assembly_id());
                Some(MovingJoint { number: number?, link, coordinate, ..joint })
            })
            .collect();

        let position = self.to_joints(position);
        // Of rotors that turn with several joints rapier knows what each joint feels of them alone.
        let armature = match &self.coupling {
            None => *armature,
            Some(coupling) => {
                let to_axes = coupling.try_inverse().unwrap();
                to_axes.tr_mul(&(JointMatrix::from_diagonal(armature) * to_axes)).diagonal()
            }
        };
        let mut displacement = vec![0.0; multibody.ndofs()];
        for joint in &self.joints {
            if let Some(value) = displacement.get_mut(joint.coordinate) {
                *value = position[joint.number];
            }
            if let Some(value) = multibody.armature_mut().get_mut(joint.coordinate) {
                *value = armature[joint.number];
            }
        }
        multibody.damping_mut().fill(0.0);
        multibody.apply_displacements(&displacement);
        multibody.forward_kinematics(bodies, false);
        multibody.update_rigid_bodies(bodies, true);
    }

    /// Positions and velocities of the joints.
    fn motion(&self, world: &PhysicsWorld) -> (JointVector, JointVector) {
        let mut position = JointVector::zeros();
        let mut velocity = JointVector::zeros();
        if let Some(multibody) = world.multibody_joints.get_multibody(self.index) {
            let velocities = multibody.generalized_velocity();
            for joint in &self.joints {
                let slots = position.get_mut(joint.number).zip(velocity.get_mut(joint.number));
                if let Some(((position, velocity), link)) = slots.zip(multibody.link(joint.link)) {
                    let [_, _, linear, _, _, angular] = link.joint().coords();
                    *position = if joint.revolute { angular } else { linear };
                    *velocity = velocities.get(joint.coordinate).copied().unwrap_or_default();
                }
            }
        }
        (position, velocity)
    }

    /// Makes the joints move with `velocity` at the start of the next step.
    fn set_velocity(&self, world: &mut PhysicsWorld, velocity: &JointVector) {
        if let Some(multibody) = world.multibody_joints.get_multibody_mut(self.index) {
            let mut velocities = multibody.generalized_velocity_mut();
            for joint in &self.joints {
                if let Some(value) = velocities.get_mut(joint.coordinate) {
                    *value = velocity[joint.number];
                }
            }
        }
    }

    /// Applies `effort` during the next step, as forces and torques on the two bodies of each joint, and nothing else.
    fn apply_effort(&self, world: &mut PhysicsWorld, effort: &JointVector) {
        let bodies = &mut world.bodies;
        for joint in &self.joints {
            for body in [joint.parent, joint.child] {
                if let Some(body) = bodies.get_mut(body) {
                    body.reset_forces(false);
                    body.reset_torques(false);
                }
            }
        }
        for joint in &self.joints {
            let Some(child) = bodies.get_mut(joint.child) else { continue };
            let pose = *child.position();
            let effort = effort[joint.number];
            let wrench = pose.rotation * maths::vector_to_rapier(&joint.direction) * effort;
            if joint.revolute {
                child.add_torque(wrench, false);
            } else {
                child.add_force_at_point(wrench, pose.translation, false);
            }
            if let Some(parent) = bodies.get_mut(joint.parent).filter(|parent| parent.is_dynamic())
            {
                if joint.revolute {
                    parent.add_torque(-wrench, false);
                } else {
                    parent.add_force_at_point(-wrench, pose.translation, false);
                }
            }
        }
    }

    /// Positions or velocities of the joints from those of the axes.
    fn to_joints(&self, axes: &JointVector) -> JointVector {
        self.coupling.as_ref().map_or(*axes, |coupling| coupling * axes)
    }
}

/// The rigid body of a link; multibody joints find its place.
fn body(link: &Link) -> RigidBodyBuilder {
    let builder = RigidBodyBuilder::dynamic().can_sleep(false);
    match &link.inertial {
        None => builder,
        Some(inertial) => builder.additional_mass_properties(MassProperties::with_inertia_matrix(
            maths::point_to_rapier(&inertial.center),
            inertial.mass,
            maths::matrix_to_rapier(&inertial.inertia),
        )),
    }
}

/// The joint with z as its free axis.
fn generic_joint(joint: &Joint) -> GenericJointBuilder {
    let free = match joint.kind {
        JointKind::Revolute => JointAxesMask::ANG_Z,
        JointKind::Prismatic => JointAxesMask::LIN_Z,
        JointKind::Fixed => JointAxesMask::empty(),
    };
    // For a direction of exactly −z the rotation is not unique: half a turn about x does.
    let axis_from_z = UnitQuaternion::rotation_between_axis(&Vector3::z_axis(), &joint.axis)
        .unwrap_or_else(|| {
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
        });
    let axis_frame = Isometry3::from_parts(nalgebra::Translation3::identity(), axis_from_z);
    GenericJointBuilder::new(JointAxesMask::all() ^ free)
        .contacts_enabled(false)
        .local_frame1(maths::pose_to_rapier(&(joint.origin * axis_frame)))
        .local_frame2(maths::pose_to_rapier(&axis_frame))
}
