//! The rapier world: links of the machine, their surroundings, and what contacts between them do to the axes.
//!
//! Link poses come from the joint positions of the equation of motion. Pairs of parts that may touch within a cycle are
//! found by their distances. Of a tree, rapier takes the step of such a cycle: its links are one multibody
//! (`multibody`). Links of a tripod are only placed, and `contact_solver` finds their contact forces.

use nalgebra::{Isometry3, Point3, Vector3};
use rapier3d_f64::dynamics::{RigidBodyBuilder, RigidBodyHandle};
use rapier3d_f64::geometry::{
    ColliderBuilder, ColliderHandle, ColliderSet, ContactPair, SolverContact, SolverFlags,
};
use rapier3d_f64::math::{Pose, Vector};
use rapier3d_f64::pipeline::{
    ActiveHooks, ContactModificationContext, PairFilterContext, PhysicsHooks,
};
use twin_urdf::{JointKind, Model};

use crate::contact::Touch;
use crate::distances::{Distances, Near};
use crate::driven::{Coordinates, Driven};
use crate::equation::Equation;
use crate::error::{PhysicsError, Result};
use crate::event::BodyEventKind;
use crate::joint::JointVector;
use crate::loose::LooseBodies;
use crate::multibody::{Multibody, Place};
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
pub(super) const TOUCHING: f64 = 1e-6;

/// Parts of a cycle at which it is looked whether parts meet.
const PLACES: [f64; 4] = [1.0, 0.75, 0.5, 0.25];

/// Least mass of a body between the machine and something else, relative to what the machine moves.
const LIGHT: f64 = 0.05;

/// Sine of the angle between the axis of a cylinder and a normal on its round side, at least.
const ROUND: f64 = 0.9;

/// A body that falls farther than this below everything is lost, m.
const FALL: f64 = 0.1;

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
    /// m/s².
    gravity: Vector3<f64>,
    driven: Driven,
    /// True if rapier steps in every cycle, whether something can touch or not.
    pub(super) every_cycle: bool,
    stepped: Option<Box<Stepped>>,
}

/// World of rapier, and what it contains.
#[derive(Clone)]
struct Stepped {
    sets: Sets,
    multibody: Multibody,
    loose: LooseBodies,
    surroundings: Surroundings,
    /// Of every link.
    places: Vec<Place>,
    /// Links of a tripod that are only placed.
    placed: Vec<(usize, RigidBodyHandle)>,
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
    /// The machine of `model` at rest with its axes at `position`, with rotors of `armature` (kg or kg·m²),
    /// under `gravity` (m/s²).
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn new(
        model: &Model,
        equation: &Equation,
        (armature, gravity): (&JointVector, Vector3<f64>),
        position: &JointVector,
    ) -> Result<Self> {
        let poses = vec![Isometry3::identity(); model.links.len()];
        let driven = Driven::new(model, equation, armature)?;
        let mut result = Self {
            model: model.clone(),
            moved: poses.clone(),
            poses,
            posed: Posed::of(model, equation),
            around: None,
            reach: REACH,
            yielding: YieldingTool::Never,
            gravity,
            driven,
            every_cycle: false,
            stepped: None,
        };
        result.follow(position)?;
        Ok(result)
    }

    /// Gives links and surroundings their solids, in the place of those they had, in steps of `cycle` s; the links have
    /// those of `model`, which moves as before. Loose bodies stay where they are.
    /// Errors: [`PhysicsError::FlatMesh`] and [`PhysicsError::Overlap`]; nothing is changed then.
    pub(super) fn insert(
        &mut self,
        model: &Model,
        surroundings: &Surroundings,
        cycle: f64,
    ) -> Result<()> {
        let has_tool = solids::tool(model, surroundings).is_some();
        let pairs = Pairs::new(model, surroundings, has_tool);
        let may_touch = |[one, other]: [usize; 2]| pairs.may_touch(one, other);
        let distances = Distances::new(model, surroundings, &pairs, may_touch)?;
        let mut around = Around { pairs, distances, near: Vec::new(), active: Vec::new() };
        let deepest = around.distances.nearest(&self.poses);
        if let Some(deepest) = deepest.filter(|deepest| deepest.distance < -TOUCHING) {
            let [one, other] = deepest.parts;
            let parts = if one <= other { [one, other] } else { [other, one] };
            return Err(PhysicsError::Overlap { parts, depth: -deepest.distance });
        }
        around.look(self.reach, &self.poses);
        let is_stepped = self.solves_contacts() || !surroundings.bodies.is_empty();
        let stepped = is_stepped.then(|| {
            let sets = Sets::new(&self.gravity, cycle);
            Stepped::new(sets, &self.driven, (&around, surroundings), (model, &self.poses))
        });
        let mut stepped = stepped.transpose()?.map(Box::new);
        if let (Some(new), Some(old)) = (&mut stepped, &self.stepped) {
            new.loose.go_on(&mut new.sets.0, (&old.loose, &old.sets.0), &new.places);
        }
        self.stepped = stepped;
        self.around = Some(around);
        self.model = model.clone();
        Ok(())
    }

    /// True if rapier solves the contacts of the machine with what is fixed.
    pub(super) fn solves_contacts(&self) -> bool {
        self.driven.platform().is_none()
    }

    /// True if rapier may take a step.
    pub(super) fn is_stepped(&self) -> bool {
        self.stepped.is_some()
    }

    /// Joints and axes with the axes at `position`.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn coordinates(
        &self,
        equation: &mut Equation,
        position: &JointVector,
    ) -> Result<Coordinates> {
        self.driven.coordinates(equation, position)
    }

    /// Mean velocities of rapier's joints in a cycle of `cycle` s from where the machine is to the axes at `to`.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn mean_velocities(
        &mut self,
        [from, to]: [&JointVector; 2],
        cycle: f64,
    ) -> Result<JointVector> {
        self.posed.poses(&self.model, to, &mut self.moved)?;
        let [from, to] =
            [self.driven.joints(from, &self.poses), self.driven.joints(to, &self.moved)];
        Ok((to - from) / cycle)
    }

    /// Links and joints.
    pub(super) fn model(&self) -> &Model {
        &self.model
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
        if self.solves_contacts() {
            return;
        }
        for (numbers, _) in near {
            let [one, other] = numbers.map(|number| pairs.part(number));
            if !self.yielding.gives_way([one, other]) {
                distances.contacts(*numbers, self.reach, &self.poses, found);
            }
        }
    }

    /// A step of rapier of `cycle` s at `time_ns` in which the axes come from `from`, and the joints have the velocities `handed` and
    /// the inertia `mass`; without contact the axes would get to `to`. Returns the way of the joints and their velocities at
    /// its end, and whether anything acted on the machine; fills `touches` and `events`. `None` without a step.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn step(
        &mut self,
        [from, to]: [&JointVector; 2],
        (handed, mass): (&JointVector, &JointVector),
        (time_ns, cycle): (i64, f64),
        (touches, events): (&mut Vec<Touch>, &mut Vec<BodyEventKind>),
    ) -> Result<Option<([JointVector; 2], bool)>> {
        let (Some(stepped), Some(around)) = (&mut self.stepped, &mut self.around) else {
            return Ok(None);
        };
        let Stepped { sets, multibody, loose, surroundings, places, placed } = &mut **stepped;
        self.posed.poses(&self.model, to, &mut self.moved)?;
        let begun = self.driven.joints(from, &self.poses);
        multibody.place(&mut sets.0, &begun);
        if self.driven.platform().is_some() {
            multibody.weigh(&mut sets.0, mass);
            multibody.hand_over(&mut sets.0, handed, &[Isometry3::identity(); 4]);
        } else {
            multibody.hand_over(&mut sets.0, handed, &self.poses);
        }
        for (link, body) in placed.iter() {
            if let (Some(body), Some(pose)) = (sets.0.bodies.get_mut(*body), self.moved.get(*link))
            {
                body.set_next_kinematic_position(maths::pose_to_rapier(pose));
            }
        }
        loose.begin_step(&sets.0);
        let contacts = Contacts { places, around, loose, surroundings, yielding: self.yielding };
        sets.step(self.reach, &contacts, &());
        // rapier disables bodies that are not finite.
        if !sets.0.quarantine().is_empty() {
            return Err(PhysicsError::Diverged(time_ns));
        }
        let pairs = sets.0.narrow_phase.contact_pairs();
        let velocities = Velocities { multibody, loose, places };
        let found = pairs.filter_map(|pair| touch_of(pair, sets, &velocities, &around.pairs));
        touches.extend(found.filter(|touch| touch.impulse > 0.0));
        around.active.retain(|numbers| touches.iter().any(|touch| touch.numbers == *numbers));
        let was_holding = loose.is_holding();
        let heavy = multibody.mass(mass) * LIGHT;
        loose.end_step(&mut sets.0, &self.moved, (touches, cycle), heavy, events);
        // The base does not move.
        let moves = |part: &Part| matches!(part, Part::Link(1..) | Part::Tool);
        let acts = was_holding || touches.iter().any(|touch| touch.parts.iter().any(moves));
        let [position, velocity] = multibody.motion(&sets.0);
        Ok(Some(([position - begun, velocity], acts)))
    }

    /// Finds the pairs of the machine and what is fixed that touch within a cycle; result true if rapier has a step to
    /// take.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn must_step(&mut self, [from, to]: [&JointVector; 2]) -> Result<bool> {
        let meets = self.solves_contacts() && self.meets(from, to)?;
        let loose = self.loose().is_some_and(|loose| !loose.is_empty());
        Ok(meets || loose || self.every_cycle)
    }

    /// Closes or opens a gripper, and returns what happened.
    pub(super) fn grip(&mut self, gripper: usize, close: bool) -> Option<BodyEventKind> {
        let Some(stepped) = self.stepped.as_deref_mut() else {
            return close.then_some(BodyEventKind::Missed { gripper });
        };
        let Stepped { sets, loose, surroundings, places, .. } = stepped;
        if !close {
            return loose.open(&mut sets.0, gripper);
        }
        let link = surroundings.grippers.get(gripper)?.link;
        loose.close(&mut sets.0, places.get(link)?, gripper, self.poses.get(link)?)
    }

    /// Poses of the loose bodies, machine frame.
    pub(super) fn body_poses(&self) -> Vec<Isometry3<f64>> {
        let stepped = self.stepped.as_ref();
        stepped.map(|stepped| stepped.loose.poses(&stepped.sets.0)).unwrap_or_default()
    }

    /// The loose bodies and grippers.
    pub(super) fn loose(&self) -> Option<&LooseBodies> {
        self.stepped.as_ref().map(|stepped| &stepped.loose)
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

impl Stepped {
    /// Errors: [`PhysicsError::Apart`], and [`PhysicsError::FlatMesh`].
    fn new(
        mut sets: Sets,
        driven: &Driven,
        (around, surroundings): (&Around, &Surroundings),
        (model, poses): (&Model, &[Isometry3<f64>]),
    ) -> Result<Self> {
        let multibody = Multibody::new(&mut sets.0, &driven.tree, &driven.armature)?;
        let mut placed = Vec::new();
        let mut places: Vec<Place> = Vec::with_capacity(poses.len());
        for (link, pose) in poses.iter().enumerate() {
            let parent = link.checked_sub(1).and_then(|index| model.joints.get(index));
            let place = match (driven.platform(), parent) {
                (None, _) => multibody.place_of(link),
                (Some(_), None) => multibody.place_of(0),
                (Some(platform), _) if link == platform => {
                    let mut pose = *pose;
                    pose.translation.vector = Vector3::zeros();
                    Place { pose, ..multibody.place_of(driven.tree.bodies.len()) }
                }
                (Some(_), Some(joint)) => match places.get(joint.parent) {
                    Some(on) if joint.kind == JointKind::Fixed => {
                        Place { pose: on.pose * joint.origin, ..*on }
                    }
                    _ => {
                        let kinematic = RigidBodyBuilder::kinematic_position_based();
                        let body = sets.0.insert_body(kinematic.pose(maths::pose_to_rapier(pose)));
                        placed.push((link, body));
                        Place { body, pose: Isometry3::identity(), ..multibody.place_of(0) }
                    }
                },
            };
            places.push(place);
        }
        for (number, (link, solids)) in around.distances.solids().enumerate() {
            let is_body = matches!(around.pairs.part(number), Some(Part::Body(_)));
            let place = places.get(link).copied().ok_or(PhysicsError::Apart)?;
            for solid in solids.iter().filter(|_| !is_body) {
                let collider = ColliderBuilder::new(solid.shape.clone())
                    .position(maths::pose_to_rapier(&(place.pose * solid.pose)))
                    .density(0.0)
                    .friction(0.0)
                    .active_hooks(
                        ActiveHooks::FILTER_CONTACT_PAIRS | ActiveHooks::MODIFY_SOLVER_CONTACTS,
                    )
                    .user_data(number as u128);
                sets.0.insert_collider(collider, Some(place.body));
            }
        }
        let first = around.pairs.parts().len() - surroundings.bodies.len();
        let loose = LooseBodies::new(&mut sets.0, surroundings, first, FALL)?;
        let surroundings = surroundings.clone();
        Ok(Self { sets, multibody, loose, surroundings, places, placed })
    }
}

/// Velocities of parts at the beginning of a step.
struct Velocities<'a> {
    multibody: &'a Multibody,
    loose: &'a LooseBodies,
    places: &'a [Place],
}

impl Velocities<'_> {
    /// Of the point of `part`, which is in the frame of `link`, at `point` (machine frame, m), m/s.
    fn of(&self, (part, link): (Part, usize), point: &Vector3<f64>) -> Vector3<f64> {
        match (part, self.places.get(link)) {
            (Part::Body(body), _) => self.loose.velocity(body),
            (_, Some(place)) => self.multibody.velocity_at(place, point),
            (_, None) => Vector3::zeros(),
        }
    }
}

/// Rules of the contacts of a step: which parts touch, and with what friction.
struct Contacts<'a> {
    places: &'a [Place],
    around: &'a Around,
    loose: &'a LooseBodies,
    surroundings: &'a Surroundings,
    yielding: YieldingTool,
}

impl Contacts<'_> {
    /// Numbers and parts of two colliders.
    fn pair(
        &self,
        colliders: &ColliderSet,
        handles: [ColliderHandle; 2],
    ) -> Option<([usize; 2], [Part; 2])> {
        let [one, other] = handles.map(|handle| {
            let number = usize::try_from(colliders.get(handle)?.user_data).ok()?;
            Some((number, self.around.pairs.part(number)?))
        });
        let ((one, first), (other, second)) = (one?, other?);
        Some(([one, other], [first, second]))
    }
}

impl PhysicsHooks for Contacts<'_> {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let handles = [context.collider1, context.collider2];
        let ([one, other], parts) = self.pair(context.colliders, handles)?;
        let body = parts.iter().find_map(|part| match part {
            Part::Body(body) => Some(*body),
            _ => None,
        });
        let touch = if let Some(body) = body {
            // A gripper does not push what it holds.
            let by =
                self.loose.holder(body).and_then(|gripper| self.surroundings.grippers.get(gripper));
            let carries = by.and_then(|gripper| self.places.get(gripper.link));
            let other = if parts[0] == Part::Body(body) { other } else { one };
            let of_other = self.around.pairs.parts().get(other);
            let is_machine = matches!(of_other, Some((Part::Link(_) | Part::Tool, _)));
            let of_other = of_other.and_then(|(_, link)| self.places.get(*link));
            let is_holder = is_machine
                && carries.zip(of_other).is_some_and(|(one, other)| one.body == other.body);
            let left_out = self.surroundings.names(parts)
                || self.yielding.gives_way(parts.map(Some))
                || is_holder;
            !left_out
        } else {
            self.around.active.contains(&[one.min(other), one.max(other)])
        };
        touch.then_some(SolverFlags::COMPUTE_RIGID_IMPULSES)
    }

    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let handles = [context.collider1, context.collider2];
        let Some((_, parts)) = self.pair(context.colliders, handles) else { return };
        let friction = self.surroundings.friction(parts);
        let [one, other] = parts.map(|part| self.surroundings.surface(part).velocity);
        let belt = maths::vector_to_rapier(&(one - other));
        let round = handles.map(|handle| round_side(context.colliders, handle));
        let Some(manifold) = context.rigid_mut() else { return };
        *manifold.friction = friction;
        let normal = *manifold.normal;
        for contact in manifold.solver_contacts.iter_mut() {
            contact.tangent_velocity = belt;
            match &round {
                [Some(side), None] => side.touch(contact, normal, true),
                [None, Some(side)] => side.touch(contact, normal, false),
                _ => {}
            }
        }
    }
}

/// The round side of a cylinder. parry keeps its contact points while it turns by up to a degree, and a rod that lies on
/// a table would begin to roll.
struct RoundSide {
    middle: Vector,
    axis: Vector,
    radius: f64,
}

fn round_side(colliders: &ColliderSet, handle: ColliderHandle) -> Option<RoundSide> {
    let collider = colliders.get(handle)?;
    let radius = collider.shape().as_cylinder()?.radius;
    let Pose { translation: middle, rotation } = *collider.position();
    Some(RoundSide { middle, axis: rotation * Vector::Y, radius })
}

impl RoundSide {
    /// Moves `contact`, whose `normal` goes from the first collider to the second, to where this side is now; it is that
    /// of the first collider or of the second.
    fn touch(&self, contact: &mut SolverContact, normal: Vector, is_first: bool) {
        let outward = if is_first { normal } else { -normal };
        let across = outward - self.axis * outward.dot(self.axis);
        // Its ends are flat.
        if across.length() < ROUND {
            return;
        }
        let (own, other) = if is_first {
            (contact.anchor1, contact.anchor2)
        } else {
            (contact.anchor2, contact.anchor1)
        };
        let along = self.axis * (own - self.middle).dot(self.axis);
        let own = self.middle + along + across * (self.radius / across.length());
        contact.dist = (other - own).dot(outward);
        let other = own + outward * contact.dist;
        (contact.anchor1, contact.anchor2) = if is_first { (own, other) } else { (other, own) };
    }
}

/// Contact of the parts of `pair`; `None` if rapier has forgotten a collider.
fn touch_of(
    pair: &ContactPair,
    sets: &Sets,
    velocities: &Velocities<'_>,
    pairs: &Pairs,
) -> Option<Touch> {
    let colliders = [pair.collider1, pair.collider2].map(|handle| sets.0.colliders.get(handle));
    let [one, other] = colliders;
    let (one, other) = (one?, other?);
    let numbers = [one, other].map(|collider| usize::try_from(collider.user_data).ok());
    let [first, second] = numbers;
    let (first, second) = (first?, second?);
    let (first_part, second_part) = (*pairs.parts().get(first)?, *pairs.parts().get(second)?);
    let (mut impulse, mut middle) = (0.0, Vector3::zeros());
    let mut push = Vector3::zeros();
    let (mut depth, mut speed) = (0.0_f64, 0.0_f64);
    for manifold in pair.solver_manifolds() {
        let normal = maths::vector_from_rapier(manifold.data.normal);
        for point in manifold.points.iter().filter(|point| point.data.impulse > 0.0) {
            let local =
                manifold.subshape_pos1().map_or(point.local_p1, |pose| pose * point.local_p1);
            let place = maths::vector_from_rapier(*one.position() * local);
            impulse += point.data.impulse;
            push += normal * point.data.impulse;
            middle += place * point.data.impulse;
            depth = depth.max(-point.dist);
            let approach = velocities.of(first_part, &place) - velocities.of(second_part, &place);
            speed = speed.max(normal.dot(&approach));
        }
    }
    let (numbers, parts) = if first <= second {
        ([first, second], [first_part.0, second_part.0])
    } else {
        push = -push;
        ([second, first], [second_part.0, first_part.0])
    };
    let point = Point3::from(if impulse > 0.0 { middle / impulse } else { middle });
    Some(Touch { numbers, parts, impulse, push, point, depth, speed })
}
