//! The links of a tree as one multibody of rapier, fixed at its base: a reference with its own equation of motion.
//!
//! Facts about rapier 0.36 that shape this file: it has no call for generalised forces. An effort is therefore applied
//! as a pair of forces or torques on the two bodies of the joint, and remains until reset. Angular joints get a damping
//! of 0.1 by default, which is set to zero. The root has six degrees of freedom until the first forward kinematics
//! finds it fixed, so nothing is indexed before. Bodies in slow motion would fall asleep, so sleeping is disabled.

use nalgebra::UnitQuaternion;
use rapier3d_f64::dynamics::{
    GenericJointBuilder, JointAxesMask, Multibody, MultibodyIndex, RigidBodyBuilder,
    RigidBodyHandle,
};
use rapier3d_f64::geometry::ColliderSet;
use rapier3d_f64::parry::mass_properties::MassProperties;
use rapier3d_f64::pipeline::PhysicsWorld;

use super::*;
use crate::maths;

/// A joint that moves and where rapier keeps it.
struct MovingJoint {
    axis: usize,
    revolute: bool,
    /// Parent and child.
    bodies: [RigidBodyHandle; 2],
    /// In the frame of the child (rotation about it and translation along it leave it alone).
    direction: Vector3<f64>,
    /// Index of the child in the multibody's links.
    link: usize,
    /// Index into the multibody's generalised coordinates.
    coordinate: usize,
}

/// A machine that rapier moves, with all its joints.
pub(super) struct RapierAlone {
    world: PhysicsWorld,
    multibody: MultibodyIndex,
    joints: Vec<MovingJoint>,
}

impl RapierAlone {
    /// `model` at rest at `position` with `armature` per axis, every joint of which has an axis of its own; in steps of
    /// `dt` s with `iterations` of the solver.
    pub(super) fn new(
        model: &Model,
        (armature, position): (&JointVector, &JointVector),
        (dt, iterations): (f64, usize),
    ) -> Self {
        let mut world =
            PhysicsWorld { gravity: maths::vector_to_rapier(&down()), ..PhysicsWorld::default() };
        world.integration_parameters.dt = dt;
        world.integration_parameters.num_solver_iterations = iterations;
        let mut links = vec![world.insert_body(RigidBodyBuilder::fixed())];
        for (joint, link) in model.joints.iter().zip(&model.links[1..]) {
            let child = world.insert_body(body(link));
            let parent = links[joint.parent];
            world.insert_multibody_joint(parent, child, generic_joint(joint)).unwrap();
            links.push(child);
        }
        // rapier knows them of the first step on.
        let no_colliders = ColliderSet::new();
        for (_, body) in world.bodies.iter_mut() {
            body.recompute_mass_properties_from_colliders(&no_colliders);
        }
        let index = world.multibody_joints.rigid_body_link(links[1]).unwrap().multibody;

        let PhysicsWorld { bodies, multibody_joints, .. } = &mut world;
        let multibody = multibody_joints.get_multibody_mut(index).unwrap();
        multibody.forward_kinematics(bodies, true);
        let joints = model.joints.iter().filter_map(|joint| {
            let child = links[joint.child];
            let link = multibody.links().find(|link| link.rigid_body_handle() == child).unwrap();
            Some(MovingJoint {
                axis: joint.drive.axis()?,
                revolute: joint.kind == JointKind::Revolute,
                bodies: [links[joint.parent], child],
                direction: joint.axis.into_inner(),
                link: link.link_id(),
                coordinate: link.assembly_id(),
            })
        });
        let joints: Vec<_> = joints.collect();
        let mut displacement = vec![0.0; multibody.ndofs()];
        for joint in &joints {
            displacement[joint.coordinate] = position[joint.axis];
            multibody.armature_mut()[joint.coordinate] = armature[joint.axis];
        }
        multibody.damping_mut().fill(0.0);
        multibody.apply_displacements(&displacement);
        multibody.forward_kinematics(bodies, false);
        multibody.update_rigid_bodies(bodies, true);
        Self { world, multibody: index, joints }
    }

    /// Positions and velocities of the joints.
    pub(super) fn motion(&self) -> (JointVector, JointVector) {
        let multibody = self.world.multibody_joints.get_multibody(self.multibody).unwrap();
        let (mut position, mut velocity) = (JointVector::zeros(), JointVector::zeros());
        for joint in &self.joints {
            let coords = multibody.link(joint.link).unwrap().joint().coords();
            // Three of translation, three of rotation.
            position[joint.axis] = coords[if joint.revolute { 5 } else { 2 }];
            velocity[joint.axis] = multibody.generalized_velocity()[joint.coordinate];
        }
        (position, velocity)
    }

    /// Makes the joints move with `velocity` at the start of the next step.
    pub(super) fn set_velocity(&mut self, velocity: &JointVector) {
        let multibodies = &mut self.world.multibody_joints;
        let multibody: &mut Multibody = multibodies.get_multibody_mut(self.multibody).unwrap();
        for joint in &self.joints {
            multibody.generalized_velocity_mut()[joint.coordinate] = velocity[joint.axis];
        }
    }

    /// Applies `effort` from the next step on, as forces and torques on the two bodies of each joint, and nothing else.
    pub(super) fn apply_effort(&mut self, effort: &JointVector) {
        let bodies = &mut self.world.bodies;
        for (_, body) in bodies.iter_mut() {
            body.reset_forces(false);
            body.reset_torques(false);
        }
        for joint in &self.joints {
            let pose = *bodies[joint.bodies[1]].position();
            let direction = pose.rotation * maths::vector_to_rapier(&joint.direction);
            for (body, effort) in
                joint.bodies.into_iter().zip([-1.0, 1.0].map(|sign| sign * effort[joint.axis]))
            {
                let body = &mut bodies[body];
                if body.is_dynamic() && joint.revolute {
                    body.add_torque(direction * effort, false);
                } else if body.is_dynamic() {
                    body.add_force_at_point(direction * effort, pose.translation, false);
                }
            }
        }
    }

    pub(super) fn step(&mut self) {
        self.world.step();
    }
}

/// The rigid body of a link; multibody joints find its place.
fn body(link: &Link) -> RigidBodyBuilder {
    let builder = RigidBodyBuilder::dynamic().can_sleep(false);
    let Some(inertial) = &link.inertial else { return builder };
    builder.additional_mass_properties(MassProperties::with_inertia_matrix(
        maths::point_to_rapier(&inertial.center),
        inertial.mass,
        maths::matrix_to_rapier(&inertial.inertia),
    ))
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
