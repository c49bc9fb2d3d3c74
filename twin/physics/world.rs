//! The rapier world: one multibody of the machine's links, fixed at its base, if they are a tree. Links that go round in
//! circles are bodies of their own, which are put where the machine is: rapier closes loops to a fraction of a micrometre
//! only, and at ten times the cost.
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
use twin_urdf::{Joint, JointKind, JointPositions, Link, Model};

use super::bodies::{Coupling, Tree};
use super::dynamics::{JointVector, at};
use super::equation::Equation;
use super::error::PhysicsError;
use super::maths;

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

/// The bodies and joints of the machine in rapier.
pub(super) struct RapierWorld {
    world: PhysicsWorld,
    /// One per link of the model, the base first.
    links: Vec<RigidBodyHandle>,
    joined: Joined,
}

/// What moves the bodies.
#[derive(Debug)]
enum Joined {
    /// Joints of rapier.
    Tree(Box<Multibody>),
    /// The machine itself.
    Posed(Box<Posed>),
}

/// The joints of a tree.
#[derive(Debug)]
struct Multibody {
    index: MultibodyIndex,
    joints: Vec<MovingJoint>,
    /// If joints do not each move with an axis of their own.
    coupling: Option<Box<Coupling>>,
}

/// Where bodies are that rapier does not join.
#[derive(Debug)]
struct Posed {
    model: Model,
    axis_count: usize,
    positions: JointPositions,
    poses: Vec<Isometry3<f64>>,
}

impl std::fmt::Debug for RapierWorld {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RapierWorld")
            .field("links", &self.links)
            .field("joined", &self.joined)
            .finish_non_exhaustive()
    }
}

impl RapierWorld {
    /// The machine at rest with its axes at `position`: joined, if its `equation` of motion is that of a tree, or bodies without
    /// joints. `armature` is the reflected rotor inertia per axis, `dt` the step in s, `iterations` the solver's substeps per step.
    ///
    /// # Errors
    /// [`PhysicsError::NotATree`] if rapier cannot join the links, [`PhysicsError::CoupledJoint`], and
    /// [`PhysicsError::Apart`].
    pub(super) fn new(
        model: &Model,
        equation: &Equation,
        gravity: Vector3<f64>,
        armature: &JointVector,
        position: &JointVector,
        (dt, iterations): (f64, usize),
    ) -> Result<Self, PhysicsError> {
        let mut world =
            PhysicsWorld { gravity: maths::vector_to_rapier(&gravity), ..PhysicsWorld::default() };
        world.integration_parameters.dt = dt;
        world.integration_parameters.num_solver_iterations = iterations;
        let axis_count = equation.axis_count();
        // What holds joints that mimic others no joint of rapier says: their bodies are put where they are.
        let tree = equation.tree().filter(|tree| tree.followers == 0);
        let mut result = match tree {
            Some(tree) => Self::joined(world, model, tree.coupling(axis_count)?)?,
            None => Self::posed(world, model, axis_count),
        };
        let no_colliders = ColliderSet::new();
        for (_, body) in result.world.bodies.iter_mut() {
            body.recompute_mass_properties_from_colliders(&no_colliders);
        }
        if let Some(tree) = tree {
            result.place(tree, armature, position);
        } else {
            result.follow(position)?;
            result.step();
        }
        Ok(result)
    }

    fn joined(
        mut world: PhysicsWorld,
        model: &Model,
        coupling: Option<Box<Coupling>>,
    ) -> Result<Self, PhysicsError> {
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
        let index = multibody.ok_or(PhysicsError::AxisNumber { given: 0 })?;
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
        let joined = Joined::Tree(Box::new(Multibody { index, joints, coupling }));
        Ok(Self { world, links, joined })
    }

    fn posed(mut world: PhysicsWorld, model: &Model, axis_count: usize) -> Self {
        let mut links = vec![world.insert_body(RigidBodyBuilder::fixed())];
        for _ in model.links.iter().skip(1) {
            links.push(world.insert_body(RigidBodyBuilder::kinematic_position_based()));
        }
        let joined = Joined::Posed(Box::new(Posed {
            axis_count,
            positions: JointPositions::at_rest(model),
            poses: vec![Isometry3::identity(); model.links.len()],
            model: model.clone(),
        }));
        Self { world, links, joined }
    }

    /// Finds the moving joints among rapier's generalised coordinates and moves them to `position`.
    fn place(&mut self, tree: &Tree, armature: &JointVector, position: &JointVector) {
        let Joined::Tree(joined) = &mut self.joined else { return };
        let PhysicsWorld { bodies, multibody_joints, .. } = &mut self.world;
        let Some(multibody) = multibody_joints.get_multibody_mut(joined.index) else { return };
        multibody.forward_kinematics(bodies, true);

        let numbers = tree.bodies.iter().map(|body| body.motion.joint());
        let joints = std::mem::take(&mut joined.joints).into_iter().zip(numbers);
        joined.joints = joints
            .filter_map(|(joint, number)| {
                let link =
                    multibody.links().find(|link| link.rigid_body_handle() == joint.child)?;
                let (link, coordinate) = (link.link_id(), link.assembly_id());
                Some(MovingJoint { number: number?, link, coordinate, ..joint })
            })
            .collect();

        let position = joined.to_joints(position);
        // Of rotors that turn with several joints rapier knows what each joint feels of them alone.
        let armature = match &joined.coupling {
            None => *armature,
            Some(coupling) => {
                let scaled = nalgebra::SMatrix::from_diagonal(armature) * coupling.to_axes;
                coupling.to_axes.tr_mul(&scaled).diagonal()
            }
        };
        let mut displacement = vec![0.0; multibody.ndofs()];
        for joint in &joined.joints {
            if let Some(value) = displacement.get_mut(joint.coordinate) {
                *value = at(&position, joint.number);
            }
            if let Some(value) = multibody.armature_mut().get_mut(joint.coordinate) {
                *value = at(&armature, joint.number);
            }
        }
        multibody.damping_mut().fill(0.0);
        multibody.apply_displacements(&displacement);
        multibody.forward_kinematics(bodies, false);
        multibody.update_rigid_bodies(bodies, true);
    }

    /// Takes the machine from where it is to `position` in the next step, and tells where its axes are then, and how much faster
    /// than `velocity`, the mean on the way, they are by what they touched. `bias` are the efforts without which `velocity` would
    /// change on the way.
    ///
    /// # Errors
    /// [`PhysicsError::Apart`].
    pub(super) fn advance(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        bias: &JointVector,
    ) -> Result<(JointVector, JointVector), PhysicsError> {
        match &self.joined {
            Joined::Posed(_) => {
                self.follow(position)?;
                self.step();
                Ok((*position, JointVector::zeros()))
            }
            Joined::Tree(joined) => {
                let velocity = joined.to_joints(velocity);
                let bias = joined.to_joint_efforts(bias);
                self.set_velocity(&velocity);
                self.apply_effort(&bias);
                self.step();
                let (position, after) = self.joint_motion();
                let Joined::Tree(joined) = &self.joined else { return Err(PhysicsError::Apart) };
                Ok((joined.to_axes(&position), joined.to_axes(&(after - velocity))))
            }
        }
    }

    /// Positions and velocities of the joints.
    pub(super) fn joint_motion(&self) -> (JointVector, JointVector) {
        let mut position = JointVector::zeros();
        let mut velocity = JointVector::zeros();
        let Joined::Tree(joined) = &self.joined else { return (position, velocity) };
        if let Some(multibody) = self.world.multibody_joints.get_multibody(joined.index) {
            let velocities = multibody.generalized_velocity();
            for joint in &joined.joints {
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
    pub(super) fn set_velocity(&mut self, velocity: &JointVector) {
        let Joined::Tree(joined) = &self.joined else { return };
        if let Some(multibody) = self.world.multibody_joints.get_multibody_mut(joined.index) {
            let mut velocities = multibody.generalized_velocity_mut();
            for joint in &joined.joints {
                if let Some(value) = velocities.get_mut(joint.coordinate) {
                    *value = at(velocity, joint.number);
                }
            }
        }
    }

    /// Applies `effort` during the next step, as forces and torques on the two bodies of each joint.
    pub(super) fn apply_effort(&mut self, effort: &JointVector) {
        let Joined::Tree(joined) = &self.joined else { return };
        let bodies = &mut self.world.bodies;
        for link in &self.links {
            if let Some(body) = bodies.get_mut(*link) {
                body.reset_forces(false);
                body.reset_torques(false);
            }
        }
        for joint in &joined.joints {
            let Some(child) = bodies.get_mut(joint.child) else { continue };
            let pose = *child.position();
            let effort = at(effort, joint.number);
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

    /// Lets the bodies be where the machine is with its axes at `position` after the next step.
    fn follow(&mut self, position: &JointVector) -> Result<(), PhysicsError> {
        let Joined::Posed(posed) = &mut self.joined else { return Ok(()) };
        let axes = position.as_slice();
        let axes = axes.get(..posed.axis_count).unwrap_or(axes);
        posed.positions.follow(&posed.model, axes).map_err(|_open| PhysicsError::Apart)?;
        posed.model.link_poses_at(posed.positions.values(), &mut posed.poses);
        for (link, pose) in self.links.iter().zip(&posed.poses).skip(1) {
            if let Some(body) = self.world.bodies.get_mut(*link) {
                body.set_next_kinematic_position(maths::pose_to_rapier(pose));
            }
        }
        Ok(())
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

impl Multibody {
    /// Positions or velocities of the joints from those of the axes.
    fn to_joints(&self, axes: &JointVector) -> JointVector {
        self.coupling.as_ref().map_or(*axes, |coupling| coupling.to_joints * axes)
    }

    /// And back.
    fn to_axes(&self, joints: &JointVector) -> JointVector {
        self.coupling.as_ref().map_or(*joints, |coupling| coupling.to_axes * joints)
    }

    /// What efforts of the axes are at the joints.
    fn to_joint_efforts(&self, efforts: &JointVector) -> JointVector {
        self.coupling.as_ref().map_or(*efforts, |coupling| coupling.to_axes.tr_mul(efforts))
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
