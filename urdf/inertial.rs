//! Mass properties of uniform bodies.

use crate::{Inertial, Solid, SolidShape};
use nalgebra::{Matrix3, Point3, UnitQuaternion, Vector3};

impl Inertial {
    /// A uniform box of `mass` (kg) with edges `size` (m) along the axes of the link frame.
    pub fn uniform_box(mass: f64, size: Vector3<f64>, center: Point3<f64>) -> Self {
        let squares = size.component_mul(&size);
        let moments =
            Vector3::new(squares.y + squares.z, squares.x + squares.z, squares.x + squares.y);
        Self { mass, center, inertia: Matrix3::from_diagonal(&(moments * (mass / 12.0))) }
    }

    /// A uniform cylinder of `mass` (kg), `radius` and `length` (m) about an axis parallel to z of the link frame.
    pub fn uniform_cylinder(mass: f64, radius: f64, length: f64, center: Point3<f64>) -> Self {
        let along = mass * radius * radius / 2.0;
        let across = mass * (3.0 * radius * radius + length * length) / 12.0;
        Self { mass, center, inertia: Matrix3::from_diagonal(&Vector3::new(across, across, along)) }
    }

    /// A uniform sphere of `mass` (kg) and `radius` (m).
    pub fn uniform_sphere(mass: f64, radius: f64, center: Point3<f64>) -> Self {
        Self { mass, center, inertia: Matrix3::from_diagonal_element(0.4 * mass * radius * radius) }
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

impl Solid {
    /// Mass properties of this solid in its link frame if it is uniform and of `mass` (kg).
    pub fn uniform(&self, mass: f64) -> Inertial {
        let own = match self.shape {
            SolidShape::Box { size } => Inertial::uniform_box(mass, size, Point3::origin()),
            SolidShape::Cylinder { radius, length } => {
                Inertial::uniform_cylinder(mass, radius, length, Point3::origin())
            }
            SolidShape::Sphere { radius } => {
                Inertial::uniform_sphere(mass, radius, Point3::origin())
            }
        };
        let center = self.origin.translation.vector.into();
        Inertial { mass, center, inertia: turned(&own.inertia, &self.origin.rotation) }
    }
}

/// An inertia given along turned axes, `rotation` taking them to those of the link.
pub(crate) fn turned(inertia: &Matrix3<f64>, rotation: &UnitQuaternion<f64>) -> Matrix3<f64> {
    let rotation = rotation.to_rotation_matrix();
    let product = rotation.matrix() * inertia * rotation.matrix().transpose();
    // Rounding must not make it unsymmetric.
    (product + product.transpose()) / 2.0
}
