//! Mass properties of uniform bodies.

use crate::mesh::Moments;
use crate::{Inertial, Link, Solid, SolidShape};
use nalgebra::{Matrix3, Point3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

impl Inertial {
    /// A uniform box of `mass` (kg) with edges `size` (m) along the axes of the link frame.
    pub fn uniform_box(mass: f64, size: Vector3<f64>, center: Point3<f64>) -> Self {
        let squares = size.component_mul(&size);
        let moments =
            Vector3::new(squares.y + squares.z, squares.x + squares.z, squares.x + squares.y);
        Self { mass, center, inertia: Matrix3::from_diagonal(&(moments * (mass / 12.0))) }
    }

    /// A uniform cylinder of `mass` (kg), `radius` and `length` (m) about an axis parallel to z of the link frame.
    pub(crate) fn uniform_cylinder(
        mass: f64,
        radius: f64,
        length: f64,
        center: Point3<f64>,
    ) -> Self {
        let along = mass * radius * radius / 2.0;
        let across = mass * (3.0 * radius * radius + length * length) / 12.0;
        Self { mass, center, inertia: Matrix3::from_diagonal(&Vector3::new(across, across, along)) }
    }

    /// A uniform sphere of `mass` (kg) and `radius` (m).
    pub(crate) fn uniform_sphere(mass: f64, radius: f64, center: Point3<f64>) -> Self {
        Self { mass, center, inertia: Matrix3::from_diagonal_element(0.4 * mass * radius * radius) }
    }

    /// A uniform capsule of `mass` (kg) about z: a cylinder of `radius` and `length` (m) between two half spheres.
    fn uniform_capsule(mass: f64, radius: f64, length: f64) -> Self {
        let (cylinder, ball) = (length, 4.0 / 3.0 * radius);
        let (cylinder, ball) =
            (mass * cylinder / (cylinder + ball), mass * ball / (cylinder + ball));
        let square = radius * radius;
        let along = cylinder * square / 2.0 + ball * 0.4 * square;
        // The centre of a half sphere is 3/8 of the radius from its flat side.
        let ends = 0.4 * square + length * length / 4.0 + 3.0 / 8.0 * length * radius;
        let across = cylinder * (3.0 * square + length * length) / 12.0 + ball * ends;
        let inertia = Matrix3::from_diagonal(&Vector3::new(across, across, along));
        Self { mass, center: Point3::origin(), inertia }
    }

    /// The rigid union of `parts`, all in the same link frame (parallel-axis theorem); `None` if they have no mass.
    pub fn union(parts: &[Self]) -> Option<Self> {
        let mass: f64 = parts.iter().map(|part| part.mass).sum();
        if mass <= 0.0 {
            return None;
        }
        let moment: Vector3<f64> = parts.iter().map(|part| part.center.coords * part.mass).sum();
        let center = Point3::from(moment / mass);
        let inertia = parts
            .iter()
            .map(|part| {
                let arm = part.center - center;
                part.inertia
                    + (Matrix3::from_diagonal_element(arm.norm_squared()) - arm * arm.transpose())
                        * part.mass
            })
            .sum();
        Some(Self { mass, center, inertia })
    }
}

impl SolidShape {
    /// Lowest and highest corner of the box around it in its own frame, m.
    pub fn bounds(&self) -> [Point3<f64>; 2] {
        let half = match self {
            Self::Box { size } => size / 2.0,
            Self::Cylinder { radius, length } => Vector3::new(*radius, *radius, length / 2.0),
            Self::Sphere { radius } => Vector3::repeat(*radius),
            Self::Capsule { radius, length } => {
                Vector3::new(*radius, *radius, length / 2.0 + radius)
            }
            Self::Mesh { mesh, scale } => return mesh.bounds(scale),
        };
        [(-half).into(), half.into()]
    }

    /// Volume, m³; `None` for a mesh that encloses nothing.
    pub fn volume(&self) -> Option<f64> {
        Some(match self {
            Self::Box { size } => size.product(),
            Self::Cylinder { radius, length } => PI * radius * radius * length,
            Self::Sphere { radius } => 4.0 / 3.0 * PI * radius.powi(3),
            Self::Capsule { radius, length } => {
                PI * radius * radius * (length + 4.0 / 3.0 * radius)
            }
            Self::Mesh { mesh, scale } => Moments::of_mesh(mesh, scale)?.volume,
        })
    }

    /// Mass properties in its own frame if it is uniform and of `mass` (kg).
    fn uniform(&self, mass: f64) -> Inertial {
        let origin = Point3::origin();
        match self {
            Self::Box { size } => Inertial::uniform_box(mass, *size, origin),
            Self::Cylinder { radius, length } => {
                Inertial::uniform_cylinder(mass, *radius, *length, origin)
            }
            Self::Sphere { radius } => Inertial::uniform_sphere(mass, *radius, origin),
            Self::Capsule { radius, length } => Inertial::uniform_capsule(mass, *radius, *length),
            Self::Mesh { mesh, scale } => {
                if let Some(found) = Moments::of_mesh(mesh, scale) {
                    let Moments { volume, center, inertia } = found;
                    return Inertial { mass, center, inertia: inertia * (mass / volume) };
                }
                let [low, high] = self.bounds();
                Inertial::uniform_box(mass, high - low, nalgebra::center(&low, &high))
            }
        }
    }
}

impl Solid {
    /// Mass properties of this solid in its link frame if it is uniform and of `mass` (kg). A mesh that encloses nothing
    /// is taken as the box around it.
    pub fn uniform(&self, mass: f64) -> Inertial {
        let own = self.shape.uniform(mass);
        let inertia = turned(&own.inertia, &self.origin.rotation);
        Inertial { mass, center: self.origin * own.center, inertia }
    }
}

impl Link {
    /// Mass properties of the visible solids at `density` (kg/m³); `None` without solids, or for a mesh that encloses
    /// nothing. The intersection of two solids counts twice.
    pub fn uniform_at(&self, density: f64) -> Option<Inertial> {
        let parts: Option<Vec<_>> = self
            .visible()
            .iter()
            .map(|solid| Some(solid.uniform(density * solid.shape.volume()?)))
            .collect();
        Inertial::union(&parts?)
    }

    /// Mass properties of the link for a total `mass` (kg), if all its visible solids have one density; a point mass at
    /// its origin if it has none.
    pub fn uniform_of(&self, mass: f64) -> Inertial {
        let box_volume = |solid: &Solid| {
            let [low, high] = solid.shape.bounds();
            (high - low).product().abs()
        };
        let volume = |solid: &Solid| solid.shape.volume().unwrap_or_else(|| box_volume(solid));
        let volumes: Vec<_> = self.visible().iter().map(volume).collect();
        let total: f64 = volumes.iter().sum();
        let parts: Vec<_> = self
            .visible()
            .iter()
            .zip(&volumes)
            .map(|(solid, volume)| solid.uniform(mass * volume / total))
            .collect();
        let point = Inertial { mass, center: Point3::origin(), inertia: Matrix3::zeros() };
        Inertial::union(&parts).map_or(point, |found| Inertial { mass, ..found })
    }

    fn visible(&self) -> &[Solid] {
        if self.solids.is_empty() { &self.collision } else { &self.solids }
    }
}

/// An inertia given along turned axes, `rotation` taking them to those of the link.
pub(crate) fn turned(inertia: &Matrix3<f64>, rotation: &UnitQuaternion<f64>) -> Matrix3<f64> {
    let rotation = rotation.to_rotation_matrix();
    let product = rotation.matrix() * inertia * rotation.matrix().transpose();
    // Rounding must not make it unsymmetric.
    (product + product.transpose()) / 2.0
}
