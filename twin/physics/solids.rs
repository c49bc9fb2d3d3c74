//! The solids of links as rapier's colliders: what they have no part in is the mass, which the model says.

use rapier3d_f64::dynamics::RigidBodyHandle;
use rapier3d_f64::geometry::{
    ActiveCollisionTypes, ColliderBuilder, Group, InteractionGroups, InteractionTestMode,
};
use rapier3d_f64::pipeline::PhysicsWorld;
use std::f64::consts::FRAC_PI_2;

use nalgebra::{UnitQuaternion, Vector3};
use twin_urdf::{Model, Solid, SolidShape};

use super::maths;

/// What is around the machine.
const SURROUNDINGS: Group = Group::GROUP_1;
/// Links of the machine.
const MACHINE: Group = Group::GROUP_2;

/// Half the edges of the slab that the ground is, m. A half-space would be near to everything, and looked at every cycle.
const GROUND: Vector3<f64> = Vector3::new(5.0, 5.0, 0.5);

/// Which of the links are looked at against each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Among {
    /// All that no joint joins.
    Links,
    /// None: links are only held against what is around the machine.
    Nothing,
}

/// Gives `links`, the bodies of the links of `model`, their solids, and puts the ground under them: a slab whose top is at z = `ground`
/// (m, machine frame).
pub(super) fn insert(
    world: &mut PhysicsWorld,
    model: &Model,
    links: &[Option<RigidBodyHandle>],
    among: Among,
    ground: f64,
) {
    let filter = match among {
        Among::Links => SURROUNDINGS | MACHINE,
        Among::Nothing => SURROUNDINGS,
    };
    let groups = InteractionGroups::new(MACHINE, filter, InteractionTestMode::And);
    // Bodies that are put where they are do not look for fixed ones by themselves.
    let types = ActiveCollisionTypes::default() | ActiveCollisionTypes::KINEMATIC_FIXED;
    for (link, body) in model.links.iter().zip(links) {
        for solid in link.collision_solids() {
            let collider = collider(solid).collision_groups(groups).active_collision_types(types);
            world.insert_collider(collider, *body);
        }
    }
    let groups = InteractionGroups::new(SURROUNDINGS, MACHINE, InteractionTestMode::And);
    let middle = maths::vector_to_rapier(&Vector3::new(0.0, 0.0, ground - GROUND.z));
    let slab = ColliderBuilder::cuboid(GROUND.x, GROUND.y, GROUND.z).translation(middle);
    world.insert_collider(slab.collision_groups(groups), None);
}

/// Without mass, in the frame of its link.
fn collider(solid: &Solid) -> ColliderBuilder {
    let mut pose = solid.origin;
    let about_y = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
    let shape = match &solid.shape {
        SolidShape::Box { size } => {
            let half = size * 0.5;
            ColliderBuilder::cuboid(half.x, half.y, half.z)
        }
        SolidShape::Cylinder { radius, length } => {
            // rapier's are about y.
            pose *= about_y;
            ColliderBuilder::cylinder(0.5 * length, *radius)
        }
        SolidShape::Capsule { radius, length } => {
            pose *= about_y;
            ColliderBuilder::capsule_y(0.5 * length, *radius)
        }
        SolidShape::Sphere { radius } => ColliderBuilder::ball(*radius),
        // In convex parts: contact with triangles costs a hundred times as much.
        SolidShape::Mesh { mesh, scale } => {
            let vertices: Vec<_> = mesh
                .vertices()
                .iter()
                .map(|vertex| maths::vector_to_rapier(&vertex.coords.component_mul(scale)))
                .collect();
            ColliderBuilder::convex_decomposition(&vertices, mesh.triangles())
        }
    };
    shape.position(maths::pose_to_rapier(&pose)).density(0.0)
}
