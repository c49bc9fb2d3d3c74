//! The rapier world: the links of the machine, whatever they may touch, and what comes of it.
//!
//! Links that are a tree are a multibody (`multibody`), those of a tripod bodies without joints (`posed`). As long as nothing touches,
//! rapier has no part in the motion: its bodies are put where the machine is, and it only looks for contacts, those that are less than
//! its prediction distance (2 mm) away included. From then on it makes whole steps until nothing touches.
//!
//! Facts about rapier 0.36 that shape this file: a step of no duration applies changes and looks for contacts, and nothing else, and what it
//! finds is there for the next step (the collision pipeline of its own would forget to tell the solver); mass properties and world
//! centres of mass are stale until the first step, so they are computed here.

use nalgebra::{Isometry3, Vector3};
use rapier3d_f64::dynamics::{RigidBodyBuilder, RigidBodyHandle};
use rapier3d_f64::geometry::{ColliderSet, ContactPair};
use rapier3d_f64::pipeline::PhysicsWorld;
use twin_urdf::Model;

use super::dynamics::JointVector;
use super::equation::Equation;
use super::error::PhysicsError;
use super::maths;
use super::multibody::Multibody;
use super::posed::Posed;
use super::solids::{self, Among};

/// The bodies and joints of the machine in rapier.
pub(super) struct RapierWorld {
    world: PhysicsWorld,
    model: Model,
    axis_count: usize,
    /// One per link of the model, the base first; none where it has nothing that could touch and rapier does not join it.
    links: Vec<Option<RigidBodyHandle>>,
    /// Workspace: where the links are.
    poses: Vec<Isometry3<f64>>,
    joined: Joined,
}

/// What moves the bodies.
#[derive(Clone, Debug)]
enum Joined {
    /// Joints of rapier.
    Tree(Box<Multibody>),
    /// The machine itself.
    Posed(Box<Posed>),
}

/// What goes on from one step to the next is copied; what a step needs for itself alone is made anew.
impl Clone for RapierWorld {
    fn clone(&self) -> Self {
        let world = PhysicsWorld {
            gravity: self.world.gravity,
            integration_parameters: self.world.integration_parameters,
            islands: self.world.islands.clone(),
            broad_phase: self.world.broad_phase.clone(),
            narrow_phase: self.world.narrow_phase.clone(),
            bodies: self.world.bodies.clone(),
            colliders: self.world.colliders.clone(),
            impulse_joints: self.world.impulse_joints.clone(),
            multibody_joints: self.world.multibody_joints.clone(),
            soft_bodies: self.world.soft_bodies.clone(),
            ..PhysicsWorld::default()
        };
        Self {
            world,
            model: self.model.clone(),
            axis_count: self.axis_count,
            links: self.links.clone(),
            poses: self.poses.clone(),
            joined: self.joined.clone(),
        }
    }
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
        let (joined, links) = match equation {
            Equation::Tree(dynamics) if dynamics.tree().followers == 0 => {
                let tree = dynamics.tree();
                let coupling = tree.coupling(axis_count)?;
                let (mut multibody, links) = Multibody::join(&mut world, model, coupling)?;
                compute_masses(&mut world);
                multibody.place(&mut world, tree, armature, position);
                let links = links.into_iter().map(Some).collect();
                (Joined::Tree(Box::new(multibody)), links)
            }
            // What holds joints that mimic others no joint of rapier says: their bodies are put where they are, too.
            Equation::Tree(_) => {
                let posed = Posed::of_tree(axis_count);
                (Joined::Posed(Box::new(posed)), posed_bodies(&mut world, model))
            }
            Equation::Tripod(tripod) => {
                let posed = Posed::of_tripod(model, tripod);
                (Joined::Posed(Box::new(posed)), posed_bodies(&mut world, model))
            }
        };
        let poses = vec![Isometry3::identity(); model.links.len()];
        let mut result = Self { world, model: model.clone(), axis_count, links, poses, joined };
        result.follow(position)?;
        Ok(result)
    }

    /// Gives the links their solids, against each other and against the ground, a slab whose top is at z =
    /// `ground` (m, machine frame).
    pub(super) fn insert_solids(&mut self, ground: f64) {
        let among = match self.joined {
            Joined::Tree(_) => Among::Links,
            Joined::Posed(_) => Among::Nothing,
        };
        solids::insert(&mut self.world, &self.model, &self.links, among, ground);
        self.look();
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
        let joined = match &self.joined {
            Joined::Tree(joined) if self.touches() => joined,
            _ => {
                self.follow(position)?;
                return Ok((*position, JointVector::zeros()));
            }
        };
        let velocity = joined.to_joints(velocity);
        joined.set_velocity(&mut self.world, &velocity);
        joined.apply_effort(&mut self.world, &joined.to_joint_efforts(bias));
        self.world.step();
        let (position, after) = joined.motion(&self.world);
        Ok((joined.to_axes(&position), joined.to_axes(&(after - velocity))))
    }

    /// Whether anything is so near to something that contact may change the motion in the next step.
    fn touches(&self) -> bool {
        self.world.narrow_phase.contact_pairs().any(ContactPair::has_any_active_contact)
    }

    /// Puts the bodies where the machine is with its axes at `position`, and looks what they touch there.
    fn follow(&mut self, position: &JointVector) -> Result<(), PhysicsError> {
        match &mut self.joined {
            Joined::Tree(joined) => {
                joined.jump(&mut self.world, position);
                let axes = position.as_slice();
                let axes = axes.get(..self.axis_count).unwrap_or(axes);
                self.model.link_poses_into(axes, &mut self.poses);
            }
            Joined::Posed(posed) => posed.poses(&self.model, position, &mut self.poses)?,
        }
        for (link, pose) in self.links.iter().zip(&self.poses).skip(1) {
            if let Some(body) = link.and_then(|link| self.world.bodies.get_mut(link)) {
                body.set_position(maths::pose_to_rapier(pose), false);
            }
        }
        self.look();
        Ok(())
    }

    /// A step of no duration.
    fn look(&mut self) {
        let dt = std::mem::take(&mut self.world.integration_parameters.dt);
        self.world.step();
        self.world.integration_parameters.dt = dt;
    }

    /// Poses of the links in the machine frame, the base first.
    pub(super) fn link_poses(&self) -> Vec<Isometry3<f64>> {
        let links = self.links.iter().zip(&self.poses);
        let poses = links.map(|(link, pose)| {
            let body = link.and_then(|link| self.world.bodies.get(link));
            body.map_or(*pose, |body| maths::pose_from_rapier(body.position()))
        });
        poses.collect()
    }
}

/// A body for every link that could touch something.
fn posed_bodies(world: &mut PhysicsWorld, model: &Model) -> Vec<Option<RigidBodyHandle>> {
    let links = model.links.iter().enumerate().map(|(index, link)| match index {
        0 => Some(world.insert_body(RigidBodyBuilder::fixed())),
        _ if link.solids.is_empty() => None,
        _ => Some(world.insert_body(RigidBodyBuilder::kinematic_position_based())),
    });
    links.collect()
}

/// rapier knows them of the first step on.
fn compute_masses(world: &mut PhysicsWorld) {
    let no_colliders = ColliderSet::new();
    for (_, body) in world.bodies.iter_mut() {
        body.recompute_mass_properties_from_colliders(&no_colliders);
    }
}

/// rapier's own joints, which tests look at.
#[cfg(test)]
impl RapierWorld {
    /// Positions and velocities of the joints.
    pub(super) fn joint_motion(&self) -> (JointVector, JointVector) {
        match &self.joined {
            Joined::Tree(joined) => joined.motion(&self.world),
            Joined::Posed(_) => (JointVector::zeros(), JointVector::zeros()),
        }
    }

    /// Makes the joints move with `velocity` at the start of the next step.
    pub(super) fn set_velocity(&mut self, velocity: &JointVector) {
        if let Joined::Tree(joined) = &self.joined {
            joined.set_velocity(&mut self.world, velocity);
        }
    }

    /// Applies `effort` during the next step.
    pub(super) fn apply_effort(&mut self, effort: &JointVector) {
        if let Joined::Tree(joined) = &self.joined {
            joined.apply_effort(&mut self.world, effort);
        }
    }

    /// One step of rapier.
    pub(super) fn step(&mut self) {
        self.world.step();
    }
}
