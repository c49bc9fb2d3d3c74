//! Volume, centre of mass and second moments of a body enclosed by triangles.
//!
//! A closed surface encloses the sum of the tetrahedra between its triangles and any one point, each with the sign of its
//! volume (Zhang and Chen, *Efficient feature extraction for 2D/3D objects in mesh representation*, 2001). With corners a, b, c as
//! seen from that point, a tetrahedron has the volume V = a·(b × c)/6, its first moment is V·(a + b + c)/4, and its
//! second moments are V/20·(aaᵀ + bbᵀ + ccᵀ + ssᵀ) with s = a + b + c.

use super::Mesh;
use nalgebra::{Matrix3, Point3, Vector3};

/// A surface is closed if its triangles, as vectors, sum up to no more than this part of their area.
const CLOSED: f64 = 1e-3;

/// Volume, centre and moments of a body of density 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moments {
    /// m³.
    pub(crate) volume: f64,
    pub(crate) center: Point3<f64>,
    /// About the centre, m⁵.
    pub(crate) inertia: Matrix3<f64>,
}

impl Moments {
    /// Of what `mesh`, scaled to m, encloses; `None` if it does not enclose anything.
    pub(crate) fn of_mesh(mesh: &Mesh, scale: &Vector3<f64>) -> Option<Self> {
        let [low, high] = mesh.bounds(scale);
        // Near the middle, so that little cancels.
        let middle = nalgebra::center(&low, &high);
        let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
        let (mut area, mut vector_area) = (0.0, Vector3::zeros());
        for corners in mesh.corners(scale) {
            let [a, b, c] = corners.map(|corner| corner - middle);
            let face = (b - a).cross(&(c - a));
            area += face.norm();
            vector_area += face;
            let part = a.dot(&b.cross(&c)) / 6.0;
            let sum = a + b + c;
            volume += part;
            first += sum * (part / 4.0);
            let squares = a * a.transpose() + b * b.transpose() + c * c.transpose();
            second += (squares + sum * sum.transpose()) * (part / 20.0);
        }
        // A surface that is seen from inside encloses as much.
        let sign = volume.signum();
        let (volume, first, second) = (volume * sign, first * sign, second * sign);
        let encloses = vector_area.norm() <= CLOSED * area
            && volume > 1e-9 * (high - low).product().abs()
            && volume.is_finite();
        if !encloses {
            return None;
        }
        let center = first / volume;
        let about = second - center * center.transpose() * volume;
        let inertia = Matrix3::from_diagonal_element(about.trace()) - about;
        let inertia = (inertia + inertia.transpose()) / 2.0;
        let possible = inertia.symmetric_eigenvalues().min() > 0.0;
        possible.then(|| Self { volume, center: middle + center, inertia })
    }
}
