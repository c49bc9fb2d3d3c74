//! Penetration depth of convex bodies.
//!
//! Depth: smallest distance that one body has to move to come free. parry's answer (EPA) is good between polyhedra
//! but may be many times too large for round sides; the bodies' own axes are therefore tried as well.

use nalgebra::{Point3, Vector3};
use rapier3d_f64::geometry::Shape;
use rapier3d_f64::math::{Pose, Vector};
use rapier3d_f64::parry::query::contact;

use crate::maths;

/// Penetration of two bodies.
pub(super) struct Penetration {
    /// m.
    pub(super) depth: f64,
    /// The point of the first that is deepest in the second, and where it would come out, machine frame, m.
    pub(super) points: [Point3<f64>; 2],
    /// Position of the overlap, machine frame, m: middle of the intersection of the bounding boxes.
    pub(super) middle: Point3<f64>,
    /// Direction in which the second comes free.
    pub(super) normal: Vector3<f64>,
}

/// Penetration of two intersecting shapes; of compound shapes, of the deepest parts. At most 0 deep if they touch.
pub(super) fn of(here: &Pose, one: &dyn Shape, there: &Pose, other: &dyn Shape) -> Penetration {
    let mut deepest = Penetration {
        depth: 0.0,
        points: [maths::vector_from_rapier(here.translation).into(); 2],
        normal: Vector3::z(),
        middle: shared_middle(here, one, there, other),
    };
    for (first_pose, first) in parts(here, one) {
        for (second_pose, second) in parts(there, other) {
            let found = of_convex(&first_pose, first, &second_pose, second);
            if let Some(found) = found.filter(|found| found.depth > deepest.depth) {
                deepest = found;
            }
        }
    }
    deepest
}

/// The convex parts of a shape.
fn parts<'s>(pose: &Pose, shape: &'s dyn Shape) -> Vec<(Pose, &'s dyn Shape)> {
    match shape.as_compound() {
        Some(compound) => {
            compound.shapes().iter().map(|(within, part)| (pose * within, &**part)).collect()
        }
        None => vec![(*pose, shape)],
    }
}

/// `None` if there is a direction in which they are apart.
fn of_convex(here: &Pose, one: &dyn Shape, there: &Pose, other: &dyn Shape) -> Option<Penetration> {
    let maps = one.as_support_map().zip(other.as_support_map())?;
    let axes = [Vector::X, Vector::Y, Vector::Z];
    let own = [here, there].map(|pose| axes.map(|axis| pose.rotation * axis));
    let own = own.into_iter().flatten().flat_map(|axis| [axis, -axis]);
    let parrys = contact(here, one, there, other, 0.0).ok().flatten();
    let middle = shared_middle(here, one, there, other);
    let mut least: Option<Penetration> = None;
    for direction in own.chain(parrys.map(|found| found.normal1)) {
        let farthest = maps.0.support_point(here, direction);
        let nearest = maps.1.support_point(there, -direction);
        let depth = (farthest - nearest).dot(direction);
        if depth <= 0.0 {
            return None;
        }
        if least.as_ref().is_none_or(|least| depth < least.depth) {
            let points = [farthest, farthest - direction * depth]
                .map(|point| maths::vector_from_rapier(point).into());
            let normal = maths::vector_from_rapier(direction);
            least = Some(Penetration { depth, points, middle, normal });
        }
    }
    least
}

/// The middle of the box that the boxes around two intersecting shapes share, put onto both of them.
fn shared_middle(here: &Pose, one: &dyn Shape, there: &Pose, other: &dyn Shape) -> Point3<f64> {
    let (first, second) = (one.compute_aabb(here), other.compute_aabb(there));
    let (low, high) = (first.mins.max(second.mins), first.maxs.min(second.maxs));
    let middle = (low + high) * 0.5;
    // Of bodies that are not along the axes the middle may be outside of them.
    let on_first = one.project_point(here, middle, true).point;
    maths::vector_from_rapier(other.project_point(there, on_first, true).point).into()
}
