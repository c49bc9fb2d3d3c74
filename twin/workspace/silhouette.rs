//! The machine and what is around it, as they are seen from a side.

use super::section::Plane;
use crate::machine::Collision;
use crate::physics::ObstacleKind;
use nalgebra::{Isometry3, Point2, Point3};
use std::f64::consts::TAU;
use twin_urdf::{Model, Solid, SolidShape};

/// Points around a cylinder or a sphere.
const AROUND: u32 = 32;

/// The outlines of all solids of a machine with its axes at `axes`, m, counter-clockwise. What lies behind the plane is
/// seen like what lies before it.
pub(super) fn silhouette(model: &Model, axes: &[f64], plane: &Plane) -> Vec<Vec<Point2<f64>>> {
    let poses = model.link_poses(axes);
    let links = model.links.iter().zip(&poses);
    let solids = links.flat_map(|(link, pose)| link.solids.iter().map(move |solid| (solid, pose)));
    solids.map(|(solid, pose)| outline(solid, pose, plane)).collect()
}

/// The outlines of what is around a machine, as [`silhouette`] has them, with what each is and its colour.
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

/// The convex hull, counter-clockwise (Andrew's monotone chain).
fn hull(mut points: Vec<Point2<f64>>) -> Vec<Point2<f64>> {
    points.sort_by(|one, other| one.x.total_cmp(&other.x).then(one.y.total_cmp(&other.y)));
    let mut hull: Vec<Point2<f64>> = Vec::new();
    let forth = points.iter();
    let back = points.iter().rev();
    let mut half = |points: &mut dyn Iterator<Item = &Point2<f64>>| {
        let begin = hull.len();
        for point in points {
            while let [.., one, other] = hull.get(begin..).unwrap_or_default()
                && (other - one).perp(&(point - one)) <= 0.0
            {
                hull.pop();
            }
            hull.push(*point);
        }
        // The last point begins the other half.
        hull.pop();
    };
    half(&mut forth.into_iter());
    half(&mut back.into_iter());
    hull
}

/// The part of a convex polygon that lies within a rectangle (Sutherland and Hodgman 1974).
pub(super) fn clip(
    polygon: &[Point2<f64>],
    min: &Point2<f64>,
    max: &Point2<f64>,
) -> Vec<Point2<f64>> {
    let mut polygon = polygon.to_vec();
    for axis in 0..2 {
        for (limit, sign) in [(min, 1.0), (max, -1.0)] {
            let depth = |point: &Point2<f64>| {
                let of = |point: &Point2<f64>| point.coords.get(axis).copied().unwrap_or_default();
                (of(point) - of(limit)) * sign
            };
            let mut clipped = Vec::new();
            for (one, other) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
                let (here, there) = (depth(one), depth(other));
                if here >= 0.0 {
                    clipped.push(*one);
                }
                if (here >= 0.0) != (there >= 0.0) {
                    clipped.push(one + (other - one) * (here / (here - there)));
                }
            }
            polygon = clipped;
        }
    }
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_goes_around_every_point() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [1.0, 1.0], [0.0, 1.0], [0.5, 0.0]];
        let hull = hull(points.map(Point2::from).to_vec());
        assert_eq!(hull, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Point2::from));
    }

    #[test]
    fn clipping_keeps_what_is_within() {
        let triangle = [[-1.0, 0.0], [1.0, 0.0], [1.0, 2.0]].map(Point2::from);
        let clipped = clip(&triangle, &Point2::new(0.0, -1.0), &Point2::new(2.0, 1.0));
        // The unit square: the side from (-1, 0) to (1, 2) passes through its corner.
        let double = clipped.iter().zip(clipped.iter().cycle().skip(1));
        let area = double.map(|(one, other)| one.coords.perp(&other.coords)).sum::<f64>() / 2.0;
        assert!((area - 1.0).abs() < 1e-12, "{clipped:?}");
        let within = |point: &Point2<f64>| point.iter().all(|value| (0.0..=1.0).contains(value));
        assert!(clipped.iter().all(within), "{clipped:?}");
        assert!(clip(&triangle, &Point2::new(3.0, 0.0), &Point2::new(4.0, 1.0)).is_empty());
    }
}
