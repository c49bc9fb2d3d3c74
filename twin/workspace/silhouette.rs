//! The machine and what is around it, as they are seen from a side.

use super::section::Plane;
use nalgebra::{Isometry3, Point2, Point3};
use std::f64::consts::TAU;
use twin_machine::Collision;
use twin_physics::ObstacleKind;

use twin_urdf::{Model, Solid, SolidShape};

/// Points around a cylinder or a sphere.
const AROUND: u32 = 32;

/// Outlines of all solids of a machine with its axes at `axes`, m, counter-clockwise, at any depth.
pub(super) fn silhouette(model: &Model, axes: &[f64], plane: &Plane) -> Vec<Vec<Point2<f64>>> {
    let poses = model.link_poses(axes);
    let links = model.links.iter().zip(&poses);
    let solids = links.flat_map(|(link, pose)| link.solids.iter().map(move |solid| (solid, pose)));
    solids.map(|(solid, pose)| outline(solid, pose, plane)).collect()
}

/// Outlines of the obstacles, with kind and colour.
pub(super) fn surroundings(
    collision: &Collision,
    plane: &Plane,
) -> Vec<(ObstacleKind, [f64; 4], Vec<Point2<f64>>)> {
    let obstacles = collision.surroundings.obstacles.iter();
    let solids = obstacles.flat_map(|one| one.solids.iter().map(|solid| (one.kind, solid)));
    let here = Isometry3::identity();
    solids.map(|(kind, solid)| (kind, solid.color, outline(solid, &here, plane))).collect()
}

fn outline(solid: &Solid, pose: &Isometry3<f64>, plane: &Plane) -> Vec<Point2<f64>> {
    let machine_from_solid = pose * solid.origin;
    let around = (0..AROUND).map(|step| (TAU * f64::from(step) / f64::from(AROUND)).sin_cos());
    let points: Vec<Point3<f64>> = match &solid.shape {
        SolidShape::Box { size } => {
            let half = size / 2.0;
            let ends = |half: f64| [-half, half];
            let corners = ends(half.x).into_iter().flat_map(|x| ends(half.y).map(|y| (x, y)));
            corners.flat_map(|(x, y)| ends(half.z).map(|z| Point3::new(x, y, z))).collect()
        }
        SolidShape::Cylinder { radius, length } => around
            .flat_map(|(sin, cos)| {
                [-length / 2.0, length / 2.0].map(|z| Point3::new(radius * cos, radius * sin, z))
            })
            .collect(),
        SolidShape::Sphere { radius } => {
            // From any side it is a circle.
            let center = plane.project(&(machine_from_solid * Point3::origin()));
            return around
                .map(|(sin, cos)| center + nalgebra::Vector2::new(cos, sin) * *radius)
                .collect();
        }
        SolidShape::Capsule { radius, length } => {
            // From any side two circles and what is between them.
            let ends = [-length / 2.0, length / 2.0]
                .map(|z| plane.project(&(machine_from_solid * Point3::new(0.0, 0.0, z))));
            let circles = around.flat_map(|(sin, cos)| {
                ends.map(|end| end + nalgebra::Vector2::new(cos, sin) * *radius)
            });
            return hull(circles.collect());
        }
        SolidShape::Mesh { mesh, scale } => {
            let scaled = |vertex: &Point3<f64>| Point3::from(vertex.coords.component_mul(scale));
            mesh.vertices().iter().map(scaled).collect()
        }
    };
    hull(points.iter().map(|point| plane.project(&(machine_from_solid * point))).collect())
}

fn hull(points: Vec<Point2<f64>>) -> Vec<Point2<f64>> {
    let points = points.into_iter().map(|point| (point.x, point.y)).collect();
    twin_plot::hull(points).into_iter().map(|(x, y)| Point2::new(x, y)).collect()
}
