//! The rapier world: one multibody of the machine's links, fixed at its base.
//!
//! Facts about rapier 0.36 that shape this file: it has no call for generalised forces, so an effort is applied as a
//! pair of forces or torques on the two bodies of the joint (and stays until reset); angular joints get a damping of
//! 0.1 unasked, which is zeroed; the root has six degrees of freedom until the first forward kinematics finds it
//! fixed, so nothing is indexed before; bodies would fall asleep in slow motion, so they may not; mass properties and
//! world centres of mass are stale until the first step, so they are computed here.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rapier3d_f64::dynamics::{
    GenericJointBuilder, JointAxesMask, MultibodyIndex, RigidBodyBuilder, RigidBodyHandle,
};
use rapier3d_f64::geometry::ColliderSet;
use rapier3d_f64::parry::mass_properties::MassProperties;
use rapier3d_f64::pipeline::PhysicsWorld;
use twin_urdf::{Joint, JointKind, Link, Model};

use super::dynamics::{JointVector, at};
use super::error::PhysicsError;
use super::maths;

/// A driven joint and where rapier keeps it.
#[derive(Clone, Copy, Debug)]
struct DrivenJoint {
    axis: usize,
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

/// The bodies and joints of the machine in rapier.
pub(super) struct RapierWorld {
    world: PhysicsWorld,
    /// One per link of the model, the base first.
    links: Vec<RigidBodyHandle>,
    multibody: MultibodyIndex,
    joints: Vec<DrivenJoint>,
}

impl std::fmt::Debug for RapierWorld {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RapierWorld")
            .field("links", &self.links)
            .field("joints", &self.joints)
            .finish_non_exhaustive()
    }
}

impl RapierWorld {
    /// The machine at rest at `position`. `armature` is the reflected rotor inertia per axis, `dt` the step in s,
    /// `iterations` the solver's substeps per step.
    ///
    /// # Errors
    /// [`PhysicsError::NotATree`] if rapier cannot join the links.
    pub(super) fn new(
        model: &Model,
        gravity: Vector3<f64>,
        armature: &JointVector,
        position: &JointVector,
        dt: f64,
        iterations: usize,
    ) -> Result<Self, PhysicsError> {
        let mut world =
            PhysicsWorld { gravity: maths::vector_to_rapier(&gravity), ..PhysicsWorld::default() };
        world.integration_parameters.dt = dt;
        world.integration_parameters.num_solver_iterations = iterations;

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
        let multibody = multibody.ok_or(PhysicsError::AxisNumber { given: 0 })?;
        let no_colliders = ColliderSet::new();
        for (_, body) in world.bodies.iter_mut() {
            body.recompute_mass_properties_from_colliders(&no_colliders);
        }

        let mut result =
            Self { world, links, multibody, joints: Vec::with_capacity(model.joints.len()) };
        result.place(model, armature, position);
        Ok(result)
    }

    /// Finds the driven joints among rapier's generalised coordinates and moves them to `position`.
    fn place(&mut self, model: &Model, armature: &JointVector, position: &JointVector) {
        let Self { world, links, multibody, joints } = self;
        let PhysicsWorld { bodies, multibody_joints, .. } = world;
        let Some(multibody) = multibody_joints.get_multibody_mut(*multibody) else { return };
        multibody.forward_kinematics(bodies, true);

        let driven = model.joints.iter().filter_map(|joint| Some((joint, joint.drive.axis()?)));
        joints.extend(driven.filter_map(|(joint, axis)| {
            let parent = *links.get(joint.parent)?;
            let child = *links.get(joint.child)?;
            let link = multibody.links().find(|link| link.rigid_body_handle() == child)?;
            Some(DrivenJoint {
                axis,
                revolute: joint.kind == JointKind::Revolute,
                parent,
                child,
                direction: joint.axis.into_inner(),
                link: link.link_id(),
                coordinate: link.assembly_id(),
            })
        }));

        let mut displacement = vec![0.0; multibody.ndofs()];
        for joint in joints.iter() {
            if let Some(value) = displacement.get_mut(joint.coordinate) {
                *value = at(position, joint.axis);
            }
            if let Some(value) = multibody.armature_mut().get_mut(joint.coordinate) {
                *value = at(armature, joint.axis);
            }
        }
        multibody.damping_mut().fill(0.0);
        multibody.apply_displacements(&displacement);
        multibody.forward_kinematics(bodies, false);
        multibody.update_rigid_bodies(bodies, true);
    }

    /// Positions and velocities of the axes.
    pub(super) fn joint_motion(&self) -> (JointVector, JointVector) {
        let mut position = JointVector::zeros();
        let mut velocity = JointVector::zeros();
        if let Some(multibody) = self.world.multibody_joints.get_multibody(self.multibody) {
            let velocities = multibody.generalized_velocity();
            for joint in &self.joints {
                let slots = position.get_mut(joint.axis).zip(velocity.get_mut(joint.axis));
                if let Some(((position, velocity), link)) = slots.zip(multibody.link(joint.link)) {
                    let [_, _, linear, _, _, angular] = link.joint().coords();
                    *position = if joint.revolute { angular } else { linear };
                    *velocity = velocities.get(joint.coordinate).copied().unwrap_or_default();
                }
            }
        }
        (position, velocity)
    }

    /// Makes the axes move with `velocity` at the start of the next step.
    pub(super) fn set_velocity(&mut self, velocity: &JointVector) {
        if let Some(multibody) = self.world.multibody_joints.get_multibody_mut(self.multibody) {
            let mut velocities = multibody.generalized_velocity_mut();
            for joint in &self.joints {
                if let Some(value) = velocities.get_mut(joint.coordinate) {
                    *value = at(velocity, joint.axis);
                }
            }
        }
    }

    /// Applies `effort` during the next step, as forces and torques on the two bodies of each joint.
    pub(super) fn apply_effort(&mut self, effort: &JointVector) {
        let bodies = &mut self.world.bodies;
        for link in &self.links {
            if let Some(body) = bodies.get_mut(*link) {
                body.reset_forces(false);
                body.reset_torques(false);
            }
        }
        for joint in &self.joints {
            let Some(child) = bodies.get_mut(joint.child) else { continue };
            let pose = *child.position();
            let wrench =
                pose.rotation * maths::vector_to_rapier(&joint.direction) * at(effort, joint.axis);
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

    /// One step of rapier.
    pub(super) fn step(&mut self) {
        self.world.step();
    }

    /// Poses of the links in the machine frame, the base first.
    pub(super) fn link_poses(&self) -> Vec<Isometry3<f64>> {
        let bodies = self.links.iter().filter_map(|link| self.world.bodies.get(*link));
        bodies.map(|body| maths::pose_from_rapier(body.position())).collect()
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
        .local_frame1(maths::pose_to_rapier(&(joint.origin * axis_frame)))
        .local_frame2(maths::pose_to_rapier(&axis_frame))
}
