//! Loose bodies in rapier, the clamps that hold them to the ground, and the grippers that take them.
//!
//! A gripper holds a body by a fixed joint framed at their present pose, so gripping moves nothing. rapier's joints give
//! their force; the moment about the gripper is that of the body's weight and acceleration,
//! I·α + ω×(I·ω) + r×F, because the angular part of a joint's impulse is not a moment. Moments of contacts are left out.

use nalgebra::{Isometry3, Point3, Vector3};
use rapier3d_f64::dynamics::{
    CoefficientCombineRule, FixedJointBuilder, ImpulseJointHandle, RigidBodyBuilder,
    RigidBodyHandle, RigidBodyType,
};
use rapier3d_f64::geometry::ColliderBuilder;
use rapier3d_f64::parry::mass_properties::MassProperties;
use rapier3d_f64::parry::query::distance as parry_distance;
use rapier3d_f64::pipeline::{ActiveHooks, PhysicsWorld};

use crate::contact::Touch;
use crate::error::{PhysicsError, Result};
use crate::event::{BodyEventKind, LossCause};
use crate::maths;
use crate::multibody::Place;
use crate::solids;
use crate::surroundings::{Body, Gripper, Part, Surroundings};

/// A body that has been pushed farther than this has moved, m.
const MOVED: f64 = 1e-4;

/// Slower than this (m/s, and rad/s) a body is at rest.
const AT_REST: f64 = 1e-4;

/// A loose body.
#[derive(Clone, Debug)]
struct Loose {
    handle: RigidBodyHandle,
    /// Force that its clamp holds, N. Until it gives way the body is fixed: a joint would be soft against the machine.
    clamp: Option<f64>,
    /// True if it lies on something at the start: then the clamp need not hold its weight.
    lies: bool,
    /// Mass that it has in rapier beyond its own, as a part of its own.
    ballast: f64,
    inertial: twin_urdf::Inertial,
    /// Where it was at rest, m.
    rest: Point3<f64>,
    /// The part of the machine that has pushed it since.
    pushed: Option<Part>,
    moved: bool,
    dropped: bool,
    /// The gripper that holds it.
    held: Option<usize>,
    /// Angular velocity after the last step, rad/s.
    turning: Vector3<f64>,
    /// Velocity before the step, at its centre of mass, m/s.
    velocity: Vector3<f64>,
}

/// A gripper at work.
#[derive(Clone, Debug)]
struct GripperAtWork {
    parameters: Gripper,
    /// The joint, and the body that it holds.
    holding: Option<(ImpulseJointHandle, usize)>,
    /// Force (N) and moment (Nm) in the last cycle.
    load: [f64; 2],
}

/// Loose bodies and grippers of a world.
#[derive(Clone, Debug, Default)]
pub(super) struct LooseBodies {
    bodies: Vec<Loose>,
    grippers: Vec<GripperAtWork>,
    /// Below this no body is carried any more, m.
    lowest: f64,
}

impl LooseBodies {
    /// Inserts the bodies of `surroundings`, whose parts are numbered from `first` on; a body that falls by `fall` (m)
    /// below everything is lost.
    /// Errors: [`PhysicsError::FlatMesh`].
    pub(super) fn new(
        world: &mut PhysicsWorld,
        surroundings: &Surroundings,
        first: usize,
        fall: f64,
    ) -> Result<Self> {
        let still = Vector3::zeros();
        let belts = surroundings.obstacles.iter().any(|one| one.surface.velocity != still);
        let mut bodies = Vec::with_capacity(surroundings.bodies.len());
        for (index, body) in surroundings.bodies.iter().enumerate() {
            // rapier would let what a slow belt carries fall asleep.
            let handle = insert(world, (body, index), first, belts)?;
            bodies.push(Loose {
                handle,
                clamp: body.clamp,
                lies: false,
                ballast: 0.0,
                inertial: body.inertial,
                rest: body.pose * body.inertial.center,
                pushed: None,
                moved: false,
                dropped: false,
                held: None,
                turning: Vector3::zeros(),
                velocity: Vector3::zeros(),
            });
        }
        for body in &mut bodies {
            body.lies = body.clamp.is_some() && body.lies_on_something(world);
        }
        let grippers = surroundings.grippers.iter().cloned();
        let grippers =
            grippers.map(|parameters| GripperAtWork { parameters, holding: None, load: [0.0; 2] });
        let lowest = world.colliders.iter().map(|(_, collider)| collider.compute_aabb().mins.z);
        let lowest = lowest.fold(f64::INFINITY, f64::min) - fall;
        Ok(Self { bodies, grippers: grippers.collect(), lowest })
    }

    /// Takes over what `old` and its world know of the same bodies and grippers; links are at `places` in rapier.
    pub(super) fn go_on(
        &mut self,
        world: &mut PhysicsWorld,
        (old, old_world): (&Self, &PhysicsWorld),
        places: &[Place],
    ) {
        for (body, old) in self.bodies.iter_mut().zip(&old.bodies) {
            if let (Some(to), Some(from)) =
                (world.bodies.get_mut(body.handle), old_world.bodies.get(old.handle))
            {
                to.set_body_type(from.body_type(), true);
                to.set_position(*from.position(), true);
                to.set_linvel(from.linvel(), true);
                to.set_angvel(from.angvel(), true);
                to.set_enabled(from.is_enabled());
                to.set_additional_mass_properties(mass_of(&old.inertial, 1.0 + old.ballast), true);
                to.set_gravity_scale(from.gravity_scale(), true);
            }
            *body = Loose { handle: body.handle, ..old.clone() };
        }
        for (gripper, old) in self.grippers.iter_mut().zip(&old.grippers) {
            let Some((joint, index)) = old.holding else { continue };
            let joint = old_world.impulse_joints.get(joint).map(|joint| joint.data);
            let (Some(joint), Some(place), Some(body)) =
                (joint, places.get(gripper.parameters.link), self.bodies.get(index))
            else {
                self.bodies.get_mut(index).iter_mut().for_each(|body| body.held = None);
                continue;
            };
            let joint = world.insert_impulse_joint(place.body, body.handle, joint);
            gripper.holding = Some((joint, index));
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// True if a gripper holds a body.
    pub(super) fn is_holding(&self) -> bool {
        self.grippers.iter().any(|gripper| gripper.holding.is_some())
    }

    /// The gripper that holds this body.
    pub(super) fn holder(&self, body: usize) -> Option<usize> {
        self.bodies.get(body)?.held
    }

    /// The body that a gripper holds.
    pub(super) fn held_by(&self, gripper: usize) -> Option<usize> {
        self.grippers.get(gripper)?.holding.map(|(_, body)| body)
    }

    /// Force (N) and moment (Nm) at a gripper in the last cycle.
    pub(super) fn load(&self, gripper: usize) -> [f64; 2] {
        self.grippers.get(gripper).map_or([0.0; 2], |gripper| gripper.load)
    }

    /// Poses of the bodies, machine frame.
    pub(super) fn poses(&self, world: &PhysicsWorld) -> Vec<Isometry3<f64>> {
        let pose = |body: &Loose| world.bodies.get(body.handle).map(|body| *body.position());
        let poses = self.bodies.iter().filter_map(pose);
        poses.map(|pose| maths::pose_from_rapier(&pose)).collect()
    }

    /// Velocity of a body before the step, m/s.
    pub(super) fn velocity(&self, body: usize) -> Vector3<f64> {
        self.bodies.get(body).map_or_else(Vector3::zeros, |body| body.velocity)
    }

    /// Notes the velocities before a step.
    pub(super) fn begin_step(&mut self, world: &PhysicsWorld) {
        for body in &mut self.bodies {
            let Some(found) = world.bodies.get(body.handle) else { continue };
            body.velocity = maths::vector_from_rapier(found.linvel());
            body.turning = maths::vector_from_rapier(found.angvel());
        }
    }

    /// Closes a gripper whose link is at `link_pose`, and at `place` in rapier: it takes the body nearest to its point.
    pub(super) fn close(
        &mut self,
        world: &mut PhysicsWorld,
        place: &Place,
        gripper: usize,
        link_pose: &Isometry3<f64>,
    ) -> Option<BodyEventKind> {
        let at_work = self.grippers.get_mut(gripper)?;
        if at_work.holding.is_some() {
            return None;
        }
        let Gripper { point, reach, .. } = at_work.parameters;
        let here = maths::point_to_rapier(&(link_pose * point));
        let distance = |body: &Loose| {
            let colliders = world.bodies.get(body.handle)?.colliders();
            let distances = colliders.iter().filter_map(|handle| {
                let collider = world.colliders.get(*handle)?;
                let nearest = collider.shape().project_point(collider.position(), here, true);
                Some((nearest.point - here).length())
            });
            distances.reduce(f64::min)
        };
        let free = self
            .bodies
            .iter()
            .enumerate()
            .filter(|(_, body)| body.held.is_none() && !body.dropped && body.clamp.is_none());
        let near = free.filter_map(|(index, body)| Some((distance(body)?, index)));
        let nearest = near
            .filter(|(distance, _)| *distance <= reach)
            .min_by(|one, other| one.0.total_cmp(&other.0));
        let Some((_, index)) = nearest else { return Some(BodyEventKind::Missed { gripper }) };
        let body = self.bodies.get_mut(index)?;
        let pose = maths::pose_from_rapier(world.bodies.get(body.handle)?.position());
        let frame = place.pose * (link_pose.inverse() * pose);
        let joint = FixedJointBuilder::new().local_frame1(maths::pose_to_rapier(&frame));
        let joint = world.insert_impulse_joint(place.body, body.handle, joint);
        body.held = Some(gripper);
        at_work.holding = Some((joint, index));
        Some(BodyEventKind::Gripped { gripper, body: index })
    }

    /// Opens a gripper.
    pub(super) fn open(
        &mut self,
        world: &mut PhysicsWorld,
        gripper: usize,
    ) -> Option<BodyEventKind> {
        let at_work = self.grippers.get_mut(gripper)?;
        let (joint, body) = at_work.holding.take()?;
        at_work.load = [0.0; 2];
        world.remove_impulse_joint(joint);
        self.let_go(world, body);
        Some(BodyEventKind::Released { gripper, body })
    }

    fn let_go(&mut self, world: &PhysicsWorld, body: usize) {
        let Some(body) = self.bodies.get_mut(body) else { return };
        body.held = None;
        body.put_down(world);
    }

    /// Looks at loads, places and falls after a step of `cycle` s with `touches`, and adds what happened to `events`.
    pub(super) fn end_step(
        &mut self,
        world: &mut PhysicsWorld,
        link_poses: &[Isometry3<f64>],
        (touches, cycle): (&[Touch], f64),
        heavy: f64,
        events: &mut Vec<BodyEventKind>,
    ) {
        self.load_grippers(world, link_poses, (touches, cycle), events);
        for (index, body) in self.bodies.iter_mut().enumerate() {
            if let Some(limit) = body.clamp {
                let force = body.clamped_force(world, index, (touches, cycle)).norm();
                if force > limit {
                    body.clamp = None;
                    if let Some(found) = world.bodies.get_mut(body.handle) {
                        found.set_body_type(RigidBodyType::Dynamic, true);
                    }
                    events.push(BodyEventKind::ClampGaveWay { body: index, force });
                }
            }
            body.watch(world, index, touches, events);
            body.weigh(world, index, touches, heavy);
            let Some(found) = world.bodies.get_mut(body.handle) else { continue };
            let is_free = body.clamp.is_none() && body.held.is_none() && !body.dropped;
            if is_free && found.translation().z < self.lowest {
                body.dropped = true;
                found.set_enabled(false);
                events.push(BodyEventKind::Dropped { body: index });
            }
        }
    }

    /// Loads of the grippers; lets go what is too heavy for them.
    fn load_grippers(
        &mut self,
        world: &mut PhysicsWorld,
        link_poses: &[Isometry3<f64>],
        (touches, cycle): (&[Touch], f64),
        events: &mut Vec<BodyEventKind>,
    ) {
        for number in 0..self.grippers.len() {
            let Some(gripper) = self.grippers.get_mut(number) else { break };
            let Some((joint, index)) = gripper.holding else { continue };
            let Some(body) = self.bodies.get(index) else { continue };
            let Some(link_pose) = link_poses.get(gripper.parameters.link) else { continue };
            let force = force_of(world, joint, cycle);
            let moment = body.moment(world, &(link_pose * gripper.parameters.point), &force, cycle);
            let direction = link_pose.rotation * gripper.parameters.direction.into_inner();
            let held = force - direction * force.dot(&direction).max(0.0);
            gripper.load = [held.norm(), moment.norm()];
            let [force, moment] = gripper.load;
            if force <= gripper.parameters.force && moment <= gripper.parameters.moment {
                continue;
            }
            gripper.holding = None;
            world.remove_impulse_joint(joint);
            let touched = touches.iter().any(|touch| touch.parts.contains(&Part::Body(index)));
            let cause = if touched { LossCause::Collision } else { LossCause::Acceleration };
            let load = [force, moment];
            events.push(BodyEventKind::Lost { gripper: number, body: index, cause, load });
            self.let_go(world, index);
        }
    }
}

impl Loose {
    /// True if something is nearer than a tenth of a millimetre.
    fn lies_on_something(&self, world: &PhysicsWorld) -> bool {
        let own = world.bodies.get(self.handle).map_or(&[][..], |body| body.colliders());
        own.iter().filter_map(|handle| world.colliders.get(*handle)).any(|mine| {
            world.colliders.iter().filter(|(handle, _)| !own.contains(handle)).any(|(_, other)| {
                let [one, two] = [mine, other].map(|it| (it.position(), it.shape()));
                let distance = parry_distance(one.0, one.1, two.0, two.1);
                distance.is_ok_and(|found| found.distance < MOVED)
            })
        })
    }

    /// Force that its clamp holds in a step with `touches`, N, machine frame.
    fn clamped_force(
        &self,
        world: &PhysicsWorld,
        index: usize,
        (touches, cycle): (&[Touch], f64),
    ) -> Vector3<f64> {
        let pushes = touches.iter().filter_map(|touch| match touch.parts {
            [_, Part::Body(body)] if body == index => Some(touch.push),
            [Part::Body(body), _] if body == index => Some(-touch.push),
            _ => None,
        });
        let pushed = pushes.sum::<Vector3<f64>>() / cycle;
        let weight = maths::vector_from_rapier(world.gravity) * self.inertial.mass;
        if self.lies { pushed } else { pushed + weight }
    }

    /// Gives a body between the machine and something else at least `heavy` (kg) in rapier, with the same weight: its
    /// passes carry a force through a light body only slowly. What it weighs in motion is then too much, by less
    /// than a twentieth of the machine.
    fn weigh(&mut self, world: &mut PhysicsWorld, index: usize, touches: &[Touch], heavy: f64) {
        let own = Part::Body(index);
        let others = touches.iter().filter(|touch| touch.parts.contains(&own)).map(|touch| {
            let [one, other] = touch.parts;
            matches!(if one == own { other } else { one }, Part::Link(1..) | Part::Tool)
        });
        let (by_machine, by_other) = others
            .fold((self.held.is_some(), false), |(a, b), machine| (a || machine, b || !machine));
        let mass = self.inertial.mass;
        let is_between = by_machine && by_other && mass < heavy;
        let ballast = if is_between { heavy / mass - 1.0 } else { 0.0 };
        if (ballast - self.ballast).abs() <= f64::EPSILON {
            return;
        }
        self.ballast = ballast;
        let factor = 1.0 + ballast;
        let Some(body) = world.bodies.get_mut(self.handle) else { return };
        body.set_additional_mass_properties(mass_of(&self.inertial, factor), true);
        body.recompute_mass_properties_from_colliders(&world.colliders);
        body.set_gravity_scale(1.0 / factor, true);
    }

    /// It is at rest where it is.
    fn put_down(&mut self, world: &PhysicsWorld) {
        let Some(found) = world.bodies.get(self.handle) else { return };
        self.rest = maths::pose_from_rapier(found.position()) * self.inertial.center;
        (self.pushed, self.moved) = (None, false);
    }

    /// Notes what pushes it, and how far it has come.
    fn watch(
        &mut self,
        world: &PhysicsWorld,
        index: usize,
        touches: &[Touch],
        events: &mut Vec<BodyEventKind>,
    ) {
        if self.held.is_some() || self.dropped {
            return;
        }
        let pushes = touches.iter().find_map(|touch| {
            let [one, other] = touch.parts;
            let by = if other == Part::Body(index) { one } else { other };
            let is_it = touch.parts.contains(&Part::Body(index));
            // The base carries.
            (is_it && matches!(by, Part::Link(1..) | Part::Tool)).then_some(by)
        });
        let Some(found) = world.bodies.get(self.handle) else { return };
        let place = maths::pose_from_rapier(found.position()) * self.inertial.center;
        if pushes.is_some() && self.pushed.is_none() {
            self.rest = place;
        }
        self.pushed = pushes.or(self.pushed);
        if let Some(by) = self.pushed
            && !self.moved
            && (place - self.rest).norm() > MOVED
        {
            self.moved = true;
            events.push(BodyEventKind::Moved { body: index, by });
        }
        let speed = found.linvel().length().max(found.angvel().length());
        if pushes.is_none() && speed < AT_REST {
            self.rest = place;
            (self.pushed, self.moved) = (None, false);
        }
    }

    /// Moment about `place` with which it is held by `force`, Nm.
    fn moment(
        &self,
        world: &PhysicsWorld,
        place: &Point3<f64>,
        force: &Vector3<f64>,
        cycle: f64,
    ) -> Vector3<f64> {
        let Some(found) = world.bodies.get(self.handle) else { return Vector3::zeros() };
        let pose = maths::pose_from_rapier(found.position());
        let rotation = pose.rotation.to_rotation_matrix();
        let inertia = rotation * self.inertial.inertia * rotation.transpose();
        let turning = maths::vector_from_rapier(found.angvel());
        let change = (turning - self.turning) / cycle;
        let lever = pose * self.inertial.center - place;
        inertia * change + turning.cross(&(inertia * turning)) + lever.cross(force)
    }
}

/// Force of a joint in the last step on its second body, N, machine frame.
fn force_of(world: &PhysicsWorld, joint: ImpulseJointHandle, cycle: f64) -> Vector3<f64> {
    let Some(joint) = world.impulse_joints.get(joint) else { return Vector3::zeros() };
    // The impulse acts on the first body.
    let [x, y, z] = [0, 1, 2].map(|row| -joint.impulses[row] / cycle);
    // The rows are directions of the joint's frame on its first body.
    let frame =
        world.bodies.get(joint.body1()).map(|body| *body.position() * joint.data.local_frame1);
    let rotation = frame.map_or_else(Isometry3::identity, |frame| maths::pose_from_rapier(&frame));
    rotation.rotation * Vector3::new(x, y, z)
}

/// `inertial` times `factor`.
fn mass_of(inertial: &twin_urdf::Inertial, factor: f64) -> MassProperties {
    MassProperties::with_inertia_matrix(
        maths::point_to_rapier(&inertial.center),
        inertial.mass * factor,
        maths::matrix_to_rapier(&(inertial.inertia * factor)),
    )
}

fn insert(
    world: &mut PhysicsWorld,
    (body, index): (&Body, usize),
    first: usize,
    keep_awake: bool,
) -> Result<RigidBodyHandle> {
    let builder = match body.clamp {
        Some(_) => RigidBodyBuilder::fixed(),
        None => RigidBodyBuilder::dynamic(),
    };
    let builder = builder
        .can_sleep(!keep_awake)
        .pose(maths::pose_to_rapier(&body.pose))
        .additional_mass_properties(mass_of(&body.inertial, 1.0));
    let handle = world.insert_body(builder);
    for (solid, one) in body.solids.iter().enumerate() {
        let part = Part::Body(index);
        let placed = solids::placed(one).ok_or(PhysicsError::FlatMesh { part, solid })?;
        let collider = ColliderBuilder::new(placed.shape)
            .position(maths::pose_to_rapier(&placed.pose))
            .density(0.0)
            .friction(0.0)
            .restitution(body.restitution)
            .restitution_combine_rule(CoefficientCombineRule::Max)
            .active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS | ActiveHooks::MODIFY_SOLVER_CONTACTS)
            .user_data((first + index) as u128);
        world.insert_collider(collider, Some(handle));
    }
    Ok(handle)
}
