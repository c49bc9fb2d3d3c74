//! The rapier world: links of the machine as bodies, and their near points to each other and to obstacles.
//!
//! Joint positions come from the equation of motion; collision bodies are placed from them each cycle. parry finds
//! the contact points of nearby pairs (`distances`), and `contact_solver` their effect. rapier's own solver is not
//! used: it closes loops to a fraction of a micrometre only, presses bodies 50 to 150 µm into each other at 89 N,
//! and keeps contact points while bodies slip by up to a millimetre.

use nalgebra::Isometry3;
use rapier3d_f64::dynamics::{RigidBodyBuilder, RigidBodyHandle, RigidBodySet};
use twin_urdf::Model;

use crate::distances::{Distances, Near};
use crate::equation::Equation;
use crate::error::{PhysicsError, Result};
use crate::joint::JointVector;
use crate::pairs::Pairs;
use crate::posed::Posed;
use crate::surroundings::{Part, Surroundings, YieldingTool};
use crate::{maths, solids};

/// Least search distance, m.
const REACH: f64 = 4e-3;

/// Search distance relative to the motion of the machine in a cycle.
const AHEAD: f64 = 1.5;

/// Largest penetration depth at the start, m: a part that rests on another one touches it.
const TOUCHING: f64 = 1e-6;

/// The bodies of the machine in rapier.
#[derive(Clone)]
pub(super) struct RapierWorld {
    bodies: RigidBodySet,
    model: Model,
    /// One per link of the model, the base first.
    links: Vec<RigidBodyHandle>,
    /// Poses of the links.
    poses: Vec<Isometry3<f64>>,
    /// Workspace: where they would be.
    moved: Vec<Isometry3<f64>>,
    posed: Posed,
    /// If there is anything to touch.
    around: Option<Around>,
    /// Search distance, m.
    reach: f64,
    /// Parts without contact force against the tool.
    pub(super) yielding: YieldingTool,
}

impl std::fmt::Debug for RapierWorld {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RapierWorld")
            .field("links", &self.links)
            .field("around", &self.around)
            .finish_non_exhaustive()
    }
}

/// Pairs that may touch, and their distances.
#[derive(Clone, Debug)]
struct Around {
    pairs: Pairs,
    distances: Distances,
    /// Pairs that are near to each other.
    near: Vec<[usize; 2]>,
}

impl RapierWorld {
    /// The machine of `model` at rest with its axes at `position`.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn new(model: &Model, equation: &Equation, position: &JointVector) -> Result<Self> {
        let mut bodies = RigidBodySet::new();
        let links = model.links.iter().enumerate().map(|(index, _)| {
            bodies.insert(match index {
                0 => RigidBodyBuilder::fixed(),
                _ => RigidBodyBuilder::kinematic_position_based(),
            })
        });
        let links: Vec<_> = links.collect();
        let poses = vec![Isometry3::identity(); model.links.len()];
        let mut result = Self {
            bodies,
            model: model.clone(),
            links,
            moved: poses.clone(),
            poses,
            posed: Posed::of(model, equation),
            around: None,
            reach: REACH,
            yielding: YieldingTool::Never,
        };
        result.follow(position)?;
        Ok(result)
    }

    /// Gives links and surroundings their solids, in the place of those they had; the links have those of `model`, which moves as before.
    /// Errors: [`PhysicsError::FlatMesh`] and [`PhysicsError::Overlap`]; nothing is changed then.
    pub(super) fn insert(&mut self, model: &Model, surroundings: &Surroundings) -> Result<()> {
        let has_tool = solids::tool(model, surroundings).is_some();
        let pairs = Pairs::new(model, surroundings, has_tool);
        let may_touch = |[one, other]: [usize; 2]| pairs.may_touch(one, other);
        let distances = Distances::new(model, surroundings, &pairs, may_touch)?;
        let mut around = Around { pairs, distances, near: Vec::new() };
        let deepest = around.distances.nearest(&self.poses);
        if let Some(deepest) = deepest.filter(|deepest| deepest.distance < -TOUCHING) {
            let [one, other] = deepest.parts;
            let parts = if one <= other { [one, other] } else { [other, one] };
            return Err(PhysicsError::Overlap { parts, depth: -deepest.distance });
        }
        around.look(self.reach, &self.poses);
        self.around = Some(around);
        self.model = model.clone();
        Ok(())
    }

    /// Links and joints.
    pub(super) fn model(&self) -> &Model {
        &self.model
    }

    /// The part of this number.
    pub(super) fn part(&self, number: usize) -> Option<Part> {
        self.around.as_ref()?.pairs.part(number)
    }

    /// Puts the bodies where the machine is with its axes at `position`, and looks what they are near to there.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn follow(&mut self, position: &JointVector) -> Result<()> {
        self.posed.poses(&self.model, position, &mut self.moved)?;
        if let Some(around) = &mut self.around {
            let way = around.distances.go(&self.poses, &self.moved);
            // Two parts may come towards each other.
            self.reach = (2.0 * AHEAD * way + 0.5 * REACH).max(REACH);
            around.look(self.reach, &self.moved);
        }
        std::mem::swap(&mut self.poses, &mut self.moved);
        for (link, pose) in self.links.iter().zip(&self.poses).skip(1) {
            if let Some(body) = self.bodies.get_mut(*link) {
                body.set_position(maths::pose_to_rapier(pose), false);
            }
        }
        Ok(())
    }

    /// Link poses with the axes at `position`; nothing moves.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn poses_at(&mut self, position: &JointVector) -> Result<&[Isometry3<f64>]> {
        self.posed.poses(&self.model, position, &mut self.moved)?;
        Ok(&self.moved)
    }

    /// Result true if two parts of these numbers overlap with the axes at `position`.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn meet(&mut self, numbers: [usize; 2], position: &JointVector) -> Result<bool> {
        self.posed.poses(&self.model, position, &mut self.moved)?;
        let around = self.around.as_ref();
        Ok(around.is_some_and(|around| around.distances.meet(numbers, &self.moved)))
    }

    /// Fills `found` with the near points of nearby pairs.
    pub(super) fn near(&self, found: &mut Vec<Near>) {
        found.clear();
        let Some(Around { pairs, distances, near }) = &self.around else { return };
        for numbers in near {
            let [one, other] = numbers.map(|number| pairs.part(number));
            if !self.yielding.gives_way([one, other]) {
                distances.contacts(*numbers, self.reach, &self.poses, found);
            }
        }
    }

    /// Link poses, the base first.
    pub(super) fn poses(&self) -> &[Isometry3<f64>] {
        &self.poses
    }

    /// Poses of the links in the machine frame as rapier's bodies have them, the base first.
    pub(super) fn link_poses(&self) -> Vec<Isometry3<f64>> {
        let poses = self.links.iter().filter_map(|link| self.bodies.get(*link));
        poses.map(|body| maths::pose_from_rapier(body.position())).collect()
    }
}

impl Around {
    fn look(&mut self, reach: f64, poses: &[Isometry3<f64>]) {
        self.distances.within(reach, poses, &mut self.near);
    }
}
