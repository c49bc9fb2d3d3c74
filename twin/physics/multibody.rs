//! Moving links of a tree as one multibody of rapier that follows the equation of motion.
//!
//! Links on fixed joints are part of the link that carries them. Gravity does not act on the links, and each step
//! begins with forces that cancel what the velocities alone would change, so without contact the joints keep the
//! velocities that they are given. Facts about rapier 0.36 that shape this file: it has no call for generalised
//! forces; angular joints get a damping of 0.1, which is set to 0; the root has six degrees of freedom until the first
//! forward kinematics finds it fixed; bodies in slow motion would fall asleep.

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use rapier3d_f64::dynamics::{
    GenericJointBuilder, JointAxesMask, MultibodyIndex, RigidBodyBuilder, RigidBodyHandle,
};
use rapier3d_f64::geometry::ColliderSet;
use rapier3d_f64::parry::mass_properties::MassProperties;
use rapier3d_f64::pipeline::PhysicsWorld;

use crate::bodies::{Motion, Tree};
use crate::error::{PhysicsError, Result};
use crate::joint::JointVector;
use crate::maths;

/// Direction of a joint in rapier's joint frame: the third of translation, and the last of rotation.
const COORDINATES: [usize; 2] = [2, 5];

/// A link that moves, with the links fixed to it.
#[derive(Clone, Debug)]
struct MovingLink {
    /// Its place in [`twin_urdf::Model::links`].
    link: usize,
    body: RigidBodyHandle,
    /// The moving link that carries it; `None`: the base.
    parent: Option<usize>,
    /// Number of the joint.
    joint: usize,
    revolute: bool,
    /// Of the joint, in the frame of the link.
    direction: Vector3<f64>,
    mass: f64,
    /// Centre of mass, link frame, m.
    center: Vector3<f64>,
    /// About it, link frame, kg·m².
    inertia: Matrix3<f64>,
    /// Number of the link in the multibody, and its place among the generalised coordinates.
    numbers: [usize; 2],
}

/// Place of a link: the moving link that it belongs to, if it moves, the body of that, and its pose in the body's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) moving: Option<usize>,
    pub(super) body: RigidBodyHandle,
    pub(super) pose: Isometry3<f64>,
}

/// Motion of a link frame: velocities, and accelerations without those of the joints; machine frame.
#[derive(Clone, Copy, Debug, Default)]
struct Motions {
    origin: Vector3<f64>,
    velocity: Vector3<f64>,
    omega: Vector3<f64>,
    acceleration: Vector3<f64>,
    alpha: Vector3<f64>,
}

/// The links of a tree in rapier.
#[derive(Clone, Debug)]
pub(super) struct Multibody {
    index: Option<MultibodyIndex>,
    base: RigidBodyHandle,
    moving: Vec<MovingLink>,
    /// Of every link of the tree, the base first.
    places: Vec<Place>,
    /// Workspace.
    motions: Vec<Motions>,
    displacement: Vec<f64>,
}

impl Multibody {
    /// Inserts the links of `tree` into `world`, with `armature` (kg or kg·m²) per joint and the joints at 0.
    /// Errors: [`PhysicsError::Apart`] if rapier refuses a link.
    pub(super) fn new(
        world: &mut PhysicsWorld,
        tree: &Tree,
        armature: &JointVector,
    ) -> Result<Self> {
        let base = world.insert_body(RigidBodyBuilder::fixed());
        let mut places = vec![Place { moving: None, body: base, pose: Isometry3::identity() }];
        let mut moving: Vec<MovingLink> = Vec::new();
        let mut masses: Vec<MassProperties> = Vec::new();
        for (index, link) in tree.bodies.iter().enumerate() {
            let parent = link.parent.map_or(0, |parent| parent + 1);
            let on = places.get(parent).copied().ok_or(PhysicsError::Apart)?;
            let origin = on.pose * link.origin;
            let place = match link.motion {
                Motion::Fixed => Place { pose: origin, ..on },
                Motion::Revolute(joint, axis) | Motion::Prismatic(joint, axis) => {
                    let revolute = matches!(link.motion, Motion::Revolute(..));
                    let frame = along_z(&axis.into_inner());
                    let free = if revolute { JointAxesMask::ANG_Z } else { JointAxesMask::LIN_Z };
                    let data = GenericJointBuilder::new(JointAxesMask::all() ^ free)
                        .local_frame1(maths::pose_to_rapier(&(origin * frame)))
                        .local_frame2(maths::pose_to_rapier(&frame));
                    let dynamic = RigidBodyBuilder::dynamic().can_sleep(false).gravity_scale(0.0);
                    let body = world.insert_body(dynamic);
                    let inserted = world.insert_multibody_joint(on.body, body, data);
                    inserted.ok_or(PhysicsError::Apart)?;
                    moving.push(MovingLink {
                        link: index + 1,
                        body,
                        parent: on.moving,
                        joint,
                        revolute,
                        direction: axis.into_inner(),
                        mass: 0.0,
                        center: Vector3::zeros(),
                        inertia: Matrix3::zeros(),
                        numbers: [0; 2],
                    });
                    masses.push(MassProperties::default());
                    Place { moving: Some(moving.len() - 1), body, pose: Isometry3::identity() }
                }
            };
            if let Some(sum) = place.moving.and_then(|carrier| masses.get_mut(carrier)) {
                let own = MassProperties::with_inertia_matrix(
                    maths::point_to_rapier(&link.mass.center),
                    link.mass.mass,
                    maths::matrix_to_rapier(&link.mass.inertia),
                );
                if link.mass.mass > 0.0 {
                    *sum += own.transform_by(&maths::pose_to_rapier(&place.pose));
                }
            }
            places.push(place);
        }
        for (link, mass) in moving.iter_mut().zip(&masses) {
            link.mass = mass.mass();
            link.center = maths::vector_from_rapier(mass.local_com);
            link.inertia = maths::matrix_from_rapier(mass.reconstruct_inertia_matrix());
            if let Some(body) = world.bodies.get_mut(link.body) {
                body.set_additional_mass_properties(*mass, false);
                body.recompute_mass_properties_from_colliders(&ColliderSet::new());
            }
        }
        let motions = vec![Motions::default(); moving.len()];
        let mut multibody =
            Self { index: None, base, moving, places, motions, displacement: Vec::new() };
        multibody.number(world, armature);
        Ok(multibody)
    }

    /// Finds the numbers of links and coordinates, and sets `armature` and no damping.
    fn number(&mut self, world: &mut PhysicsWorld, armature: &JointVector) {
        let first = self.moving.first().map(|link| link.body);
        let link = first.and_then(|body| world.multibody_joints.rigid_body_link(body));
        let Some(index) = link.map(|link| link.multibody) else { return };
        self.index = Some(index);
        let PhysicsWorld { bodies, multibody_joints, .. } = world;
        let Some(multibody) = multibody_joints.get_multibody_mut(index) else { return };
        multibody.forward_kinematics(bodies, true);
        multibody.set_self_contacts_enabled(true);
        multibody.damping_mut().fill(0.0);
        for moving in &mut self.moving {
            let found = multibody.links().find(|link| link.rigid_body_handle() == moving.body);
            let Some(link) = found else { continue };
            moving.numbers = [link.link_id(), link.assembly_id()];
        }
        self.set_armature(multibody, armature);
        self.displacement = vec![0.0; multibody.ndofs()];
    }

    fn set_armature(
        &self,
        multibody: &mut rapier3d_f64::dynamics::Multibody,
        armature: &JointVector,
    ) {
        for moving in &self.moving {
            let [_, coordinate] = moving.numbers;
            if let Some(slot) = multibody.armature_mut().get_mut(coordinate) {
                *slot = armature[moving.joint];
            }
        }
    }

    /// What moves: the mass of the links, or the largest of the `inertia` (kg) of a slide, kg.
    pub(super) fn mass(&self, inertia: &JointVector) -> f64 {
        let links: f64 = self.moving.iter().map(|link| link.mass).sum();
        let slides = self.moving.iter().filter(|link| !link.revolute);
        slides.map(|link| inertia[link.joint]).fold(links, f64::max)
    }

    /// Gives the joints the inertia `mass` (kg or kg·m²): what their links lack becomes rotors.
    pub(super) fn weigh(&self, world: &mut PhysicsWorld, mass: &JointVector) {
        let carried: f64 = self.moving.iter().map(|link| link.mass).sum();
        let found = self.index.and_then(|index| world.multibody_joints.get_multibody_mut(index));
        if let Some(multibody) = found {
            self.set_armature(multibody, &mass.map(|mass| (mass - carried).max(0.0)));
        }
    }

    /// Place of `link` of the tree, the base being 0.
    pub(super) fn place_of(&self, link: usize) -> Place {
        let base = Place { moving: None, body: self.base, pose: Isometry3::identity() };
        self.places.get(link).copied().unwrap_or(base)
    }

    /// Velocity of the point at `point` (machine frame, m) of what is at `place`, as handed over last, m/s.
    pub(super) fn velocity_at(&self, place: &Place, point: &Vector3<f64>) -> Vector3<f64> {
        let motion = place.moving.and_then(|moving| self.motions.get(moving));
        motion.map_or_else(Vector3::zeros, |motion| {
            motion.velocity + motion.omega.cross(&(point - motion.origin))
        })
    }

    /// Puts the joints exactly at `position`.
    pub(super) fn place(&mut self, world: &mut PhysicsWorld, position: &JointVector) {
        let PhysicsWorld { bodies, multibody_joints, .. } = world;
        let found = self.index.and_then(|index| multibody_joints.get_multibody_mut(index));
        let Some(multibody) = found else { return };
        let mut moves = false;
        // To 0 and on: a coordinate cannot be set, and this leaves nothing of where it was.
        for pass in 0..2 {
            for link in &self.moving {
                let [number, coordinate] = link.numbers;
                let now = multibody.link(number).map_or(0.0, |found| coordinate_of(link, found));
                let target = position[link.joint];
                moves |= pass == 0 && now.to_bits() != target.to_bits();
                if let Some(slot) = self.displacement.get_mut(coordinate) {
                    *slot = if pass == 0 { -now } else { target };
                }
            }
            if !moves {
                return;
            }
            multibody.apply_displacements(&self.displacement);
        }
        multibody.forward_kinematics(bodies, false);
        multibody.update_rigid_bodies(bodies, true);
    }

    /// Gives the joints `velocity`, with links at `poses`, and the forces that keep it.
    pub(super) fn hand_over(
        &mut self,
        world: &mut PhysicsWorld,
        velocity: &JointVector,
        poses: &[Isometry3<f64>],
    ) {
        let PhysicsWorld { bodies, multibody_joints, .. } = world;
        let found = self.index.and_then(|index| multibody_joints.get_multibody_mut(index));
        let Some(multibody) = found else { return };
        for (index, link) in self.moving.iter().enumerate() {
            let [_, coordinate] = link.numbers;
            let rate = velocity[link.joint];
            if let Some(slot) = multibody.generalized_velocity_mut().get_mut(coordinate) {
                *slot = rate;
            }
            let Some(pose) = poses.get(link.link) else { continue };
            let parent = link.parent.and_then(|parent| self.motions.get(parent)).copied();
            let motion = moved_on(&parent.unwrap_or_default(), link, pose, rate);
            if let Some(slot) = self.motions.get_mut(index) {
                *slot = motion;
            }
            let Some(body) = bodies.get_mut(link.body) else { continue };
            let rotation = pose.rotation.to_rotation_matrix();
            let lever = rotation * link.center;
            let at_center = motion.acceleration
                + motion.alpha.cross(&lever)
                + motion.omega.cross(&motion.omega.cross(&lever));
            let inertia = rotation * link.inertia * rotation.transpose();
            let torque = inertia * motion.alpha + motion.omega.cross(&(inertia * motion.omega));
            body.reset_forces(false);
            body.reset_torques(false);
            body.add_force(maths::vector_to_rapier(&(at_center * link.mass)), false);
            body.add_torque(maths::vector_to_rapier(&torque), false);
        }
    }

    /// Positions and velocities of the joints.
    pub(super) fn motion(&self, world: &PhysicsWorld) -> [JointVector; 2] {
        let mut result = [JointVector::zeros(); 2];
        let found = self.index.and_then(|index| world.multibody_joints.get_multibody(index));
        let Some(multibody) = found else { return result };
        let [position, velocity] = &mut result;
        for link in &self.moving {
            let [number, coordinate] = link.numbers;
            position[link.joint] =
                multibody.link(number).map_or(0.0, |found| coordinate_of(link, found));
            let rates = multibody.generalized_velocity();
            velocity[link.joint] = rates.get(coordinate).copied().unwrap_or_default();
        }
        result
    }
}

fn coordinate_of(link: &MovingLink, found: &rapier3d_f64::dynamics::MultibodyLink) -> f64 {
    let [linear, angular] = COORDINATES;
    found.joint().coords()[if link.revolute { angular } else { linear }]
}

/// Motion of a link at `pose` whose joint moves with `rate` (m/s or rad/s) on a parent in motion.
fn moved_on(parent: &Motions, link: &MovingLink, pose: &Isometry3<f64>, rate: f64) -> Motions {
    let origin = pose.translation.vector;
    let lever = origin - parent.origin;
    let along = pose.rotation * link.direction * rate;
    let swing = parent.omega.cross(&lever);
    let mut motion = Motions {
        origin,
        velocity: parent.velocity + swing,
        omega: parent.omega,
        acceleration: parent.acceleration + parent.alpha.cross(&lever) + parent.omega.cross(&swing),
        alpha: parent.alpha,
    };
    if link.revolute {
        motion.omega += along;
        motion.alpha += parent.omega.cross(&along);
    } else {
        motion.velocity += along;
        motion.acceleration += parent.omega.cross(&along) * 2.0;
    }
    motion
}

/// A frame whose z axis is `direction`.
fn along_z(direction: &Vector3<f64>) -> Isometry3<f64> {
    // For exactly −z the rotation is not unique: half a turn about x does.
    let turn = UnitQuaternion::rotation_between(&Vector3::z(), direction).unwrap_or_else(|| {
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
    });
    Isometry3::from_parts(Translation3::identity(), turn)
}
