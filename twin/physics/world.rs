//! The rapier world: the links of the machine and what is around it as bodies, and where these are near to each other.
//!
//! The machine is where its equation of motion says; every body is put there, and rapier looks where it touches whatever it is near to
//! (`distances`). What contact does to the
//! motion is a matter of `contact`, in joint space: rapier's own solver closes loops to a fraction of a micrometre only,
//! and lets 89 N press its bodies 50 to 150 µm into each other.
//!
//! Facts about rapier 0.36 that shape this file: its collision pipeline finds points of contact anew whenever a body was moved (the one of
//! a whole step keeps old ones while little moves); boxes around bodies are widened by half of how far it looks, those of
//! bodies that never move by what was asked for when they came.

use nalgebra::{Isometry3, Point3, Vector3};
use rapier3d_f64::dynamics::{IslandManager, RigidBodyBuilder, RigidBodyHandle, RigidBodySet};
use rapier3d_f64::geometry::{
    ActiveCollisionTypes, BroadPhaseBvh, ColliderBuilder, ColliderSet, NarrowPhase, SolverFlags,
};
use rapier3d_f64::pipeline::{ActiveHooks, CollisionPipeline, PairFilterContext, PhysicsHooks};
use twin_urdf::Model;

use super::distances::Distances;
use super::dynamics::JointVector;
use super::equation::Equation;
use super::error::PhysicsError;
use super::maths;
use super::pairs::Pairs;
use super::posed::Posed;
use super::solids;
use super::surroundings::{Part, Surroundings};

/// How far is looked at least, m.
const REACH: f64 = 4e-3;

/// How much farther than the machine moves in a cycle is looked, as a factor of that.
const AHEAD: f64 = 1.5;

/// How deep things may be in each other where the machine starts, m: what stands on something touches it.
const TOUCHING: f64 = 1e-6;

/// The bodies of the machine in rapier.
#[derive(Clone)]
pub(super) struct RapierWorld {
    bodies: RigidBodySet,
    colliders: ColliderSet,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    model: Model,
    /// One per link of the model, the base first.
    links: Vec<RigidBodyHandle>,
    /// Where the links are.
    poses: Vec<Isometry3<f64>>,
    /// Workspace: where they would be.
    moved: Vec<Isometry3<f64>>,
    posed: Posed,
    /// If there is anything to touch.
    around: Option<Around>,
    /// How far was looked, m.
    reach: f64,
    /// Whether the tool is a probe at work, which gives way.
    pub(super) probing: bool,
}

impl std::fmt::Debug for RapierWorld {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RapierWorld")
            .field("links", &self.links)
            .field("around", &self.around)
            .finish_non_exhaustive()
    }
}

/// What may touch what.
#[derive(Clone, Debug)]
struct Around {
    pairs: Pairs,
    distances: Distances,
}

/// Two points of two parts that are near to each other, or in each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// Numbers of the parts.
    pub(super) parts: [usize; 2],
    /// The links in whose frames the points are.
    pub(super) links: [usize; 2],
    /// Of each part, m.
    pub(super) points: [Point3<f64>; 2],
    /// From the first part to the second, machine frame.
    pub(super) normal: Vector3<f64>,
}

impl Near {
    /// How far they are apart along the normal with the links at `poses`, m; below 0: in each other.
    pub(super) fn gap(&self, poses: &[Isometry3<f64>]) -> f64 {
        let [first, second] = self.places(poses);
        self.normal.dot(&(second - first))
    }

    /// Where the points are, m, machine frame.
    pub(super) fn places(&self, poses: &[Isometry3<f64>]) -> [Point3<f64>; 2] {
        let at =
            |link: usize, point: &Point3<f64>| poses.get(link).map_or(*point, |pose| pose * point);
        let ([one, other], [first, second]) = (self.links, &self.points);
        [at(one, first), at(other, second)]
    }
}

impl RapierWorld {
    /// The machine of `model` at rest with its axes at `position`.
    ///
    /// # Errors
    /// [`PhysicsError::Apart`].
    pub(super) fn new(
        model: &Model,
        equation: &Equation,
        position: &JointVector,
    ) -> Result<Self, PhysicsError> {
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
            colliders: ColliderSet::new(),
            islands: IslandManager::new(),
            broad_phase: BroadPhaseBvh::new(),
            narrow_phase: NarrowPhase::new(),
            model: model.clone(),
            links,
            moved: poses.clone(),
            poses,
            posed: Posed::of(model, equation),
            around: None,
            reach: REACH,
            probing: false,
        };
        result.follow(position)?;
        Ok(result)
    }

    /// Gives links and surroundings their solids.
    ///
    /// # Errors
    /// [`PhysicsError::FlatMesh`] and [`PhysicsError::Overlap`].
    pub(super) fn insert(&mut self, surroundings: &Surroundings) -> Result<(), PhysicsError> {
        let tool = solids::tool(&self.model);
        let pairs = Pairs::new(&self.model, surroundings, tool.is_some());
        // Bodies that are put where they are do not look for each other by themselves.
        let types =
            ActiveCollisionTypes::KINEMATIC_FIXED | ActiveCollisionTypes::KINEMATIC_KINEMATIC;
        for (number, (part, link)) in (0_u128..).zip(pairs.parts()) {
            let Some(body) = self.links.get(*link) else { continue };
            for placed in solids::of_part(&self.model, surroundings, *part, tool)? {
                let collider = ColliderBuilder::new(placed.shape)
                    .position(maths::pose_to_rapier(&placed.pose))
                    .density(0.0)
                    .user_data(number)
                    .active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS)
                    .active_collision_types(types);
                self.colliders.insert_with_parent(collider, *body, &mut self.bodies);
            }
        }
        let may_touch = |[one, other]: [usize; 2]| pairs.may_touch(one, other);
        let distances = Distances::new(&self.model, surroundings, &pairs, may_touch)?;
        self.around = Some(Around { pairs, distances });
        self.look();
        let mut near = Vec::new();
        self.near(&mut near);
        let depths = near.iter().map(|near| (near, -near.gap(&self.poses)));
        let deepest = depths.max_by(|(_, one), (_, other)| one.total_cmp(other));
        let overlap = deepest.filter(|(_, depth)| *depth > TOUCHING).and_then(|(near, depth)| {
            let [one, other] = near.parts.map(|part| self.part(part));
            let (one, other) = one.zip(other)?;
            let parts = if one <= other { [one, other] } else { [other, one] };
            Some(PhysicsError::Overlap { parts, depth })
        });
        overlap.map_or(Ok(()), Err)
    }

    /// What a part of this number is.
    pub(super) fn part(&self, number: usize) -> Option<Part> {
        self.around.as_ref()?.pairs.part(number)
    }

    /// Puts the bodies where the machine is with its axes at `position`, and looks what they are near to there.
    ///
    /// # Errors
    /// [`PhysicsError::Apart`].
    pub(super) fn follow(&mut self, position: &JointVector) -> Result<(), PhysicsError> {
        self.posed.poses(&self.model, position, &mut self.moved)?;
        if let Some(around) = &mut self.around {
            let way = around.distances.go(&self.poses, &self.moved);
            // Two parts may come towards each other.
            self.reach = (2.0 * AHEAD * way + 0.5 * REACH).max(REACH);
        }
        std::mem::swap(&mut self.poses, &mut self.moved);
        for (link, pose) in self.links.iter().zip(&self.poses).skip(1) {
            if let Some(body) = self.bodies.get_mut(*link) {
                body.set_position(maths::pose_to_rapier(pose), false);
            }
        }
        self.look();
        Ok(())
    }

    /// Where the links would be with the axes at `position`.
    ///
    /// # Errors
    /// [`PhysicsError::Apart`].
    pub(super) fn poses_at(
        &mut self,
        position: &JointVector,
    ) -> Result<&[Isometry3<f64>], PhysicsError> {
        self.posed.poses(&self.model, position, &mut self.moved)?;
        Ok(&self.moved)
    }

    /// Fills `found` with what is near to what.
    pub(super) fn near(&self, found: &mut Vec<Near>) {
        found.clear();
        let Some(Around { pairs, .. }) = &self.around else { return };
        if !pairs.any_near() {
            return;
        }
        for pair in self.narrow_phase.contact_pairs() {
            let sides = [pair.collider1, pair.collider2].map(|side| self.colliders.get(side));
            let [Some(one), Some(other)] = sides else { continue };
            let side = |collider: &rapier3d_f64::geometry::Collider| {
                let number = usize::try_from(collider.user_data).ok()?;
                Some((number, pairs.parts().get(number)?.1))
            };
            let Some(((one_part, one_link), (other_part, other_link))) = side(one).zip(side(other))
            else {
                continue;
            };
            let parts = [pairs.part(one_part), pairs.part(other_part)];
            if self.probing && parts.contains(&Some(Part::Tool)) {
                continue;
            }
            for manifold in pair.manifolds() {
                let place = |collider: &rapier3d_f64::geometry::Collider, part: Option<_>| {
                    let within = collider.position_wrt_parent().copied().unwrap_or_default();
                    part.map_or(within, |part| within * part)
                };
                let here = place(one, manifold.subshape_pos1().copied());
                let there = place(other, manifold.subshape_pos2().copied());
                let Some(pose) = self.poses.get(one_link) else { continue };
                let normal = maths::vector_from_rapier(here.rotation * manifold.local_n1);
                for point in &manifold.points {
                    found.push(Near {
                        parts: [one_part, other_part],
                        links: [one_link, other_link],
                        points: [here * point.local_p1, there * point.local_p2]
                            .map(|point| maths::vector_from_rapier(point).into()),
                        normal: pose.rotation * normal,
                    });
                }
            }
        }
    }

    /// Looks at what is near, if anything is.
    fn look(&mut self) {
        let Some(Around { pairs, distances }) = &mut self.around else { return };
        distances.within(self.reach, &self.poses, pairs.near_mut());
        if !pairs.any_near() {
            return;
        }
        CollisionPipeline::new().step(
            self.reach,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &*pairs,
            &(),
        );
    }

    /// Where the links are, the base first.
    pub(super) fn poses(&self) -> &[Isometry3<f64>] {
        &self.poses
    }

    /// Poses of the links in the machine frame as rapier's bodies have them, the base first.
    pub(super) fn link_poses(&self) -> Vec<Isometry3<f64>> {
        let poses = self.links.iter().filter_map(|link| self.bodies.get(*link));
        poses.map(|body| maths::pose_from_rapier(body.position())).collect()
    }
}

/// Bodies that are all put where they are would have no contact but for this. Of pairs that are far apart nothing has to be found.
impl PhysicsHooks for Pairs {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let sides = [context.collider1, context.collider2];
        let number = |side| usize::try_from(context.colliders.get(side)?.user_data).ok();
        let [one, other] = sides.map(number);
        let (one, other) = one.zip(other)?;
        self.are_near(one, other).then(SolverFlags::empty)
    }
}
