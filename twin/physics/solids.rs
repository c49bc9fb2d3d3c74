//! Solids as rapier's shapes, with meshes split into convex parts.
//!
//! Contact with triangles costs a hundred times as much, and triangles have no inside.

use std::f64::consts::FRAC_PI_2;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rapier3d_f64::geometry::SharedShape;
use rapier3d_f64::math::{Pose, Vector};
use rapier3d_f64::parry::transformation::try_convex_hull;
use rapier3d_f64::parry::transformation::vhacd::{VHACD, VHACDParameters};
use rapier3d_f64::parry::transformation::voxelization::FillMode;
use twin_urdf::{Link, Mesh, Model, Solid, SolidShape};

use crate::error::{PhysicsError, Result};
use crate::maths;
use crate::surroundings::{Part, Surroundings};

/// Largest distance of a corner outside of a face of a convex mesh, relative to the size of the mesh.
const CONVEX: f64 = 1e-6;

/// Largest distance of the tool tip from the surface of the tool's solid, m.
const AT_TIP: f64 = 1e-6;

/// Limit of the convexity test, corners times triangles; larger meshes are always decomposed.
const MOST_LOOKS: usize = 200_000_000;

/// Convex decomposition: parts exceed their mesh by at most a sixtieth of its size.
const FINE: VHACDParameters = VHACDParameters {
    concavity: 1e-3,
    alpha: 0.05,
    beta: 0.05,
    resolution: 64,
    plane_downsampling: 2,
    convex_hull_downsampling: 1,
    fill_mode: FillMode::FloodFill { detect_cavities: false },
    convex_hull_approximation: true,
    max_convex_hulls: 256,
};

/// A shape with its pose in the frame of its part.
#[derive(Clone)]
pub(super) struct Placed {
    pub(super) shape: SharedShape,
    pub(super) pose: Isometry3<f64>,
}

impl Placed {
    /// Largest distance of its points from the origin, m.
    pub(super) fn reach(&self) -> f64 {
        let sphere = self.shape.compute_local_bounding_sphere();
        let middle = maths::pose_to_rapier(&self.pose) * sphere.center;
        middle.length() + sphere.radius
    }
}

impl std::fmt::Debug for Placed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Placed").field("pose", &self.pose).finish_non_exhaustive()
    }
}

/// `solid` as something that can touch; `None` for a mesh without volume.
pub(super) fn placed(solid: &Solid) -> Option<Placed> {
    let mut pose = solid.origin;
    let about_y = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
    let shape = match &solid.shape {
        SolidShape::Box { size } => {
            let half = size * 0.5;
            SharedShape::cuboid(half.x, half.y, half.z)
        }
        SolidShape::Cylinder { radius, length } => {
            // rapier's are about y.
            pose *= about_y;
            SharedShape::cylinder(0.5 * length, *radius)
        }
        SolidShape::Capsule { radius, length } => {
            pose *= about_y;
            SharedShape::capsule_y(0.5 * length, *radius)
        }
        SolidShape::Sphere { radius } => SharedShape::ball(*radius),
        SolidShape::Mesh { mesh, scale } => known_parts(mesh, scale)?,
    };
    Some(Placed { shape, pose })
}

/// Index of the tool among the collision solids of the last link: the solid that the tip lies on.
pub(super) fn tool(model: &Model, surroundings: &Surroundings) -> Option<usize> {
    if !surroundings.has_tool {
        return None;
    }
    let tip = maths::point_to_rapier(&model.tip.point);
    let solids = model.links.get(model.tip.link)?.collision_solids();
    solids.iter().position(|solid| {
        placed(solid).is_some_and(|Placed { shape, pose }| {
            let nearest = shape.project_point(&maths::pose_to_rapier(&pose), tip, false);
            (nearest.point - tip).length() <= AT_TIP
        })
    })
}

/// A mesh that has been taken apart, what it was multiplied by, and its parts.
type Known = (Weak<Mesh>, Vector3<f64>, Option<SharedShape>);

/// Cache of decomposed meshes: a decomposition takes a second.
static KNOWN: Mutex<Vec<Known>> = Mutex::new(Vec::new());

/// [`convex_parts`], once for each mesh.
fn known_parts(mesh: &Arc<Mesh>, scale: &Vector3<f64>) -> Option<SharedShape> {
    let lock = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let is_it = |(known, by, _): &&Known| {
        by == scale && known.upgrade().is_some_and(|known| Arc::ptr_eq(&known, mesh))
    };
    if let Some((_, _, parts)) = lock().iter().find(is_it) {
        return parts.clone();
    }
    // parry asserts what it expects of hulls, and files have any triangles.
    let taken = std::panic::catch_unwind(|| convex_parts(mesh, scale));
    let parts = taken.unwrap_or_default();
    let mut known = lock();
    known.retain(|(mesh, ..)| mesh.strong_count() > 0);
    known.push((Arc::downgrade(mesh), *scale, parts.clone()));
    parts
}

/// The mesh as one convex body, if it is one; as several otherwise.
fn convex_parts(mesh: &Mesh, scale: &Vector3<f64>) -> Option<SharedShape> {
    let vertices: Vec<Vector> = mesh
        .vertices()
        .iter()
        .map(|vertex| maths::vector_to_rapier(&vertex.coords.component_mul(scale)))
        .collect();
    let whole = || hull(&vertices);
    let effort = vertices.len().saturating_mul(mesh.triangles().len());
    if effort <= MOST_LOOKS && is_convex(mesh, scale) {
        return whole();
    }
    let [low, high] = mesh.bounds(scale);
    if (high - low).min() <= CONVEX * (high - low).max() {
        return whole();
    }
    let decomposition = VHACD::decompose(&FINE, &vertices, mesh.triangles(), true);
    let parts = decomposition.compute_primitive_intersections(&vertices, mesh.triangles());
    // What has no volume has nothing that could be left out.
    let parts: Vec<_> =
        parts.iter().filter_map(|part| Some((Pose::IDENTITY, hull(part)?))).collect();
    match parts.as_slice() {
        [] => whole(),
        [(_, only)] => Some(only.clone()),
        _ => Some(SharedShape::compound(parts)),
    }
}

/// `None` if the points have no volume.
fn hull(points: &[Vector]) -> Option<SharedShape> {
    let (vertices, faces) = try_convex_hull(points).ok()?;
    let shape = SharedShape::convex_mesh(vertices, &faces)?;
    let size = shape.compute_local_bounding_sphere().radius;
    (shape.mass_properties(1.0).mass() > CONVEX * size.powi(3)).then_some(shape)
}

/// True if no corner of the mesh is outside of one of its faces.
fn is_convex(mesh: &Mesh, scale: &Vector3<f64>) -> bool {
    let [low, high] = mesh.bounds(scale);
    let slack = CONVEX * (high - low).norm();
    mesh.corners(scale).all(|[a, b, c]| {
        let normal = (b - a).cross(&(c - a));
        normal.try_normalize(0.0).is_none_or(|normal| {
            mesh.vertices()
                .iter()
                .all(|vertex| normal.dot(&(vertex.coords.component_mul(scale) - a.coords)) <= slack)
        })
    })
}

/// Collision shapes of `part` in its link frame; `tool` is the index of the tool among the last link's solids.
/// Errors: [`PhysicsError::FlatMesh`].
pub(super) fn of_part(
    model: &Model,
    surroundings: &Surroundings,
    part: Part,
    tool: Option<usize>,
) -> Result<Vec<Placed>> {
    let of_link = |link: usize| model.links.get(link).map_or(&[][..], Link::collision_solids);
    let (solids, is_tip): (&[Solid], bool) = match part {
        Part::Link(link) => (of_link(link), link == model.tip.link),
        Part::Tool => (of_link(model.tip.link), true),
        Part::Obstacle(index) => {
            let obstacle = surroundings.obstacles.get(index);
            (obstacle.map_or(&[], |obstacle| obstacle.solids.as_slice()), false)
        }
        Part::Body(index) => {
            let body = surroundings.bodies.get(index);
            (body.map_or(&[], |body| body.solids.as_slice()), false)
        }
    };
    let is_tool = |index| is_tip && Some(index) == tool;
    let wanted = solids.iter().enumerate();
    let wanted = wanted.filter(|(index, _)| is_tool(*index) == (part == Part::Tool));
    wanted.map(|(solid, it)| placed(it).ok_or(PhysicsError::FlatMesh { part, solid })).collect()
}
