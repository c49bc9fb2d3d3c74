//! The rapier world: links of the machine, their surroundings, and what contacts between them do to the axes.
//!
//! Link poses come from the joint positions of the equation of motion. Pairs of parts that may touch within a cycle are
//! found by their distances. Of a tree, rapier takes the step of such a cycle: its links are one multibody
//! (`multibody`). Links of a tripod are only placed, and `contact_solver` finds their contact forces.

use nalgebra::{Isometry3, Point3, Vector3};
use rapier3d_f64::geometry::{ColliderBuilder, ContactPair, SolverFlags};
use rapier3d_f64::pipeline::{ActiveHooks, PairFilterContext, PhysicsHooks};
use twin_urdf::Model;

use crate::bodies::Tree;
use crate::distances::{Distances, Near};
use crate::equation::Equation;
use crate::error::{PhysicsError, Result};
use crate::joint::{JointMatrix, JointVector};
use crate::multibody::Multibody;
use crate::pairs::Pairs;
use crate::posed::Posed;
use crate::sets::Sets;
use crate::surroundings::{Part, Surroundings, YieldingTool};
use crate::{maths, solids};

/// Least search distance, m.
const REACH: f64 = 4e-3;

/// Search distance relative to the motion of the machine in a cycle.
const AHEAD: f64 = 1.5;

/// Largest penetration depth at the start, m: a part that rests on another one touches it.
const TOUCHING: f64 = 1e-6;

/// Parts of a cycle at which it is looked whether parts meet.
const PLACES: [f64; 4] = [1.0, 0.75, 0.5, 0.25];

/// Singular values below this part of the largest count as 0.
const SINGULAR: f64 = 1e-9;

/// The machine and its surroundings in rapier.
#[derive(Clone)]
pub(super) struct RapierWorld {
    model: Model,
    /// Poses of the links, the base first.
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
    /// What rapier moves: the links of a tree.
    tree: Option<DrivenTree>,
    stepped: Option<Stepped>,
}

/// A tree of links, and how axes move its joints.
#[derive(Clone, Debug)]
struct DrivenTree {
    links: Tree,
    /// Rotor inertia per joint, kg or kg·m².
    armature: JointVector,
    to_joints: JointMatrix,
    to_axes: JointMatrix,
}

/// What rapier steps.
#[derive(Clone)]
struct Stepped {
    sets: Sets,
    multibody: Multibody,
}

/// Contact between two parts in a step of rapier.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// Numbers of the parts, the smaller first.
    pub(super) numbers: [usize; 2],
    /// N·s.
    pub(super) impulse: f64,
    /// Machine frame, m.
    pub(super) point: Point3<f64>,
    /// m.
    pub(super) depth: f64,
    /// Approach speed at the beginning of the step, m/s.
    pub(super) speed: f64,
}

impl std::fmt::Debug for RapierWorld {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RapierWorld")
            .field("poses", &self.poses)
            .field("around", &self.around)
            .finish_non_exhaustive()
    }
}

/// Pairs that may touch, and their distances.
#[derive(Clone, Debug)]
struct Around {
    pairs: Pairs,
    distances: Distances,
    /// Pairs that are near to each other, and their distances, m.
    near: Vec<([usize; 2], f64)>,
    /// Pairs with contact forces in this cycle.
    active: Vec<[usize; 2]>,
}

impl RapierWorld {
    /// The machine of `model` at rest with its axes at `position`, with rotors of `armature` (kg or kg·m²).
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn new(
        model: &Model,
        equation: &Equation,
        armature: &JointVector,
        position: &JointVector,
    ) -> Result<Self> {
        let poses = vec![Isometry3::identity(); model.links.len()];
        let tree = match equation {
            Equation::Tree(_) => Some(DrivenTree::new(model, equation.axis_count(), armature)?),
            Equation::Tripod(_) => None,
        };
        let mut result = Self {
            model: model.clone(),
            moved: poses.clone(),
            poses,
            posed: Posed::of(model, equation),
            around: None,
            reach: REACH,
            yielding: YieldingTool::Never,
            tree,
            stepped: None,
        };
        result.follow(position)?;
        Ok(result)
    }

    /// Gives links and surroundings their solids, in the place of those they had; in steps of `cycle` s.
    /// Errors: [`PhysicsError::FlatMesh`] and [`PhysicsError::Overlap`]; nothing is changed then.
    pub(super) fn insert(&mut self, surroundings: &Surroundings, cycle: f64) -> Result<()> {
        let has_tool = solids::tool(&self.model, surroundings).is_some();
        let pairs = Pairs::new(&self.model, surroundings, has_tool);
        let may_touch = |[one, other]: [usize; 2]| pairs.may_touch(one, other);
        let distances = Distances::new(&self.model, surroundings, &pairs, may_touch)?;
        let mut around = Around { pairs, distances, near: Vec::new(), active: Vec::new() };
        let deepest = around.distances.nearest(&self.poses);
        if let Some(deepest) = deepest.filter(|deepest| deepest.distance < -TOUCHING) {
            let [one, other] = deepest.parts;
            let parts = if one <= other { [one, other] } else { [other, one] };
            return Err(PhysicsError::Overlap { parts, depth: -deepest.distance });
        }
        around.look(self.reach, &self.poses);
        let stepped = self.tree.as_ref().map(|tree| Stepped::new(tree, &around.distances, cycle));
        self.stepped = stepped.transpose()?;
        self.around = Some(around);
        Ok(())
    }

    /// True if rapier takes the steps with contacts.
    pub(super) fn is_stepped(&self) -> bool {
        self.stepped.is_some()
    }

    /// The part of this number.
    pub(super) fn part(&self, number: usize) -> Option<Part> {
        self.around.as_ref()?.pairs.part(number)
    }

    /// Puts the machine where it is with its axes at `position`, and looks what it is near to there.
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

    /// Fills `found` with the near points of nearby pairs, unless rapier takes the step.
    pub(super) fn near(&self, found: &mut Vec<Near>) {
        found.clear();
        let Some(Around { pairs, distances, near, .. }) = &self.around else { return };
        if self.stepped.is_some() {
            return;
        }
        for (numbers, _) in near {
            let [one, other] = numbers.map(|number| pairs.part(number));
            if !self.yielding.gives_way([one, other]) {
                distances.contacts(*numbers, self.reach, &self.poses, found);
            }
        }
    }

    /// A step of rapier in which the axes come from `from` with the velocities `handed`; without contact they would get
    /// to `to`. Returns their positions and velocities at its end, and fills `touches`; `None` if no parts meet.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn step(
        &mut self,
        [from, to, handed]: [&JointVector; 3],
        touches: &mut Vec<Touch>,
    ) -> Result<Option<[JointVector; 2]>> {
        touches.clear();
        if self.stepped.is_none() || !self.meets(from, to)? {
            return Ok(None);
        }
        let (Some(stepped), Some(around), Some(tree)) =
            (&mut self.stepped, &mut self.around, &self.tree)
        else {
            return Ok(None);
        };
        let Stepped { sets, multibody } = stepped;
        multibody.place(&mut sets.0, &(tree.to_joints * from));
        multibody.hand_over(&mut sets.0, &(tree.to_joints * handed), &self.poses);
        sets.step(self.reach, &ActivePairs(&around.active), &());
        for pair in sets.0.narrow_phase.contact_pairs() {
            let touch = touch_of(pair, sets, multibody, &around.pairs);
            touches.extend(touch.filter(|touch| touch.impulse > 0.0));
        }
        around.active.retain(|numbers| touches.iter().any(|touch| touch.numbers == *numbers));
        let [position, velocity] = multibody.motion(&sets.0);
        Ok(Some([tree.to_axes * position, tree.to_axes * velocity]))
    }

    /// Finds the pairs that touch, or meet on the way of the axes; result true if there are any.
    fn meets(&mut self, from: &JointVector, to: &JointVector) -> Result<bool> {
        let Some(around) = &mut self.around else { return Ok(false) };
        let yielding = self.yielding;
        let gives_way = |around: &Around, numbers: [usize; 2]| {
            yielding.gives_way(numbers.map(|number| around.pairs.part(number)))
        };
        let mut active = std::mem::take(&mut around.active);
        active.retain(|numbers| !gives_way(around, *numbers));
        self.posed.poses(&self.model, to, &mut self.moved)?;
        let way = around.distances.way(&self.poses, &self.moved);
        let candidates: Vec<_> = around
            .near
            .iter()
            .filter(|(numbers, distance)| {
                *distance <= 2.0 * way && !active.contains(numbers) && !gives_way(around, *numbers)
            })
            .map(|(numbers, _)| *numbers)
            .collect();
        for part in PLACES.into_iter().filter(|_| !candidates.is_empty()) {
            self.posed.poses(&self.model, &(from + (to - from) * part), &mut self.moved)?;
            for numbers in &candidates {
                if !active.contains(numbers) && around.distances.meet(*numbers, &self.moved) {
                    active.push(*numbers);
                }
            }
        }
        around.active = active;
        Ok(!around.active.is_empty())
    }

    /// Link poses in the machine frame, the base first.
    pub(super) fn poses(&self) -> &[Isometry3<f64>] {
        &self.poses
    }
}

impl Around {
    fn look(&mut self, reach: f64, poses: &[Isometry3<f64>]) {
        self.distances.within(reach, poses, &mut self.near);
    }
}

impl DrivenTree {
    fn new(model: &Model, axis_count: usize, armature: &JointVector) -> Result<Self> {
        let links = Tree::new(model, axis_count)?;
        let to_joints = links.coupling.unwrap_or_else(JointMatrix::identity);
        let to_axes = to_joints.pseudo_inverse(SINGULAR).map_err(|_| PhysicsError::Apart)?;
        // Rotors that several joints share are felt by each as if the others were at rest.
        let rotors = to_axes.tr_mul(&(JointMatrix::from_diagonal(armature) * to_axes));
        Ok(Self { links, armature: rotors.diagonal(), to_joints, to_axes })
    }
}

impl Stepped {
    /// Errors: [`PhysicsError::Apart`].
    fn new(tree: &DrivenTree, distances: &Distances, cycle: f64) -> Result<Self> {
        let mut sets = Sets::new(&Vector3::zeros(), cycle);
        let multibody = Multibody::new(&mut sets.0, &tree.links, &tree.armature)?;
        for (number, (link, solids)) in distances.solids().enumerate() {
            let (body, within) = multibody.carrier(link);
            for solid in solids {
                let collider = ColliderBuilder::new(solid.shape.clone())
                    .position(maths::pose_to_rapier(&(within * solid.pose)))
                    .density(0.0)
                    .friction(0.0)
                    .active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS)
                    .user_data(number as u128);
                sets.0.insert_collider(collider, Some(body));
            }
        }
        Ok(Self { sets, multibody })
    }
}

/// The pairs of parts that have contact forces.
struct ActivePairs<'a>(&'a [[usize; 2]]);

impl PhysicsHooks for ActivePairs<'_> {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let [one, other] = [context.collider1, context.collider2]
            .map(|collider| context.colliders.get(collider).map(|found| found.user_data));
        let is_it = |pair: &&[usize; 2]| {
            let [first, second] = pair.map(|number| Some(number as u128));
            (first, second) == (one, other) || (second, first) == (one, other)
        };
        self.0.iter().find(is_it).map(|_| SolverFlags::COMPUTE_RIGID_IMPULSES)
    }
}

/// Contact of the parts of `pair`; `None` if rapier has forgotten a collider.
fn touch_of(
    pair: &ContactPair,
    sets: &Sets,
    multibody: &Multibody,
    pairs: &Pairs,
) -> Option<Touch> {
    let colliders = [pair.collider1, pair.collider2].map(|handle| sets.0.colliders.get(handle));
    let [one, other] = colliders;
    let (one, other) = (one?, other?);
    let numbers = [one, other].map(|collider| usize::try_from(collider.user_data).ok());
    let [first, second] = numbers;
    let (first, second) = (first?, second?);
    let link_of = |number: usize| pairs.parts().get(number).map(|(_, link)| *link);
    let (first_link, second_link) = (link_of(first)?, link_of(second)?);
    let (mut impulse, mut middle) = (0.0, Vector3::zeros());
    let (mut depth, mut speed) = (0.0_f64, 0.0_f64);
    for manifold in pair.solver_manifolds() {
        let normal = maths::vector_from_rapier(manifold.data.normal);
        for point in manifold.points.iter().filter(|point| point.data.impulse > 0.0) {
            let local =
                manifold.subshape_pos1().map_or(point.local_p1, |pose| pose * point.local_p1);
            let place = maths::vector_from_rapier(*one.position() * local);
            impulse += point.data.impulse;
            middle += place * point.data.impulse;
            depth = depth.max(-point.dist);
            let approach = multibody.velocity_at(first_link, &place)
                - multibody.velocity_at(second_link, &place);
            speed = speed.max(normal.dot(&approach));
        }
    }
    let numbers = [first.min(second), first.max(second)];
    let point = Point3::from(if impulse > 0.0 { middle / impulse } else { middle });
    Some(Touch { numbers, impulse, point, depth, speed })
}
