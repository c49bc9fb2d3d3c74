//! Triangle meshes of STL and OBJ files.

mod file;
pub(crate) use file::load_first;
mod mass;

pub use file::MeshError;
pub(crate) use mass::Moments;

use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// Triangles from a file, in the file's own unit and frame: see [`SolidShape::Mesh`](crate::SolidShape::Mesh).
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// The file as URDF names it: a path from the URDF, `package://…` or `file://…`.
    file: String,
    vertices: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Triangles whose corners are `vertices`, counter-clockwise as seen from outside. `file` is the name that is
    /// written to URDF.
    ///
    /// # Errors
    /// [`MeshError`] if a triangle has a corner that is not there, a coordinate is not finite, or there is no triangle.
    pub fn new(
        file: impl Into<String>,
        vertices: Vec<Point3<f64>>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self, MeshError> {
        if triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        if let Some(vertex) =
            vertices.iter().position(|vertex| !vertex.iter().all(|value| value.is_finite()))
        {
            return Err(MeshError::NotFinite(vertex));
        }
        let missing =
            |corner: &&u32| usize::try_from(**corner).map_or(true, |i| i >= vertices.len());
        if let Some(corner) = triangles.iter().flatten().find(missing) {
            return Err(MeshError::Corner { corner: *corner, vertices: vertices.len() });
        }
        Ok(Self { file: file.into(), vertices, triangles })
    }

    /// The file as URDF names it.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The corners of the triangles, in the file's unit.
    pub fn vertices(&self) -> &[Point3<f64>] {
        &self.vertices
    }

    /// The corners of each triangle, by their places in [`Self::vertices`], counter-clockwise as seen from outside (clockwise
    /// where a scale mirrors).
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of every triangle in m, counter-clockwise as seen from outside.
    pub fn corners<'a>(
        &'a self,
        scale: &'a Vector3<f64>,
    ) -> impl Iterator<Item = [Point3<f64>; 3]> + 'a {
        let mirrored = scale.product() < 0.0;
        self.triangles.iter().filter_map(move |[first, second, third]| {
            let corner = |index: u32| {
                let vertex = self.vertices.get(usize::try_from(index).ok()?)?;
                Some(Point3::from(vertex.coords.component_mul(scale)))
            };
            let (one, other) = if mirrored { (third, second) } else { (second, third) };
            Some([corner(*first)?, corner(*one)?, corner(*other)?])
        })
    }

    /// Number of open edges: those that are not between two triangles of opposite sense; 0 for the surface of a body.
    /// Corners at the same place are one: in STL every triangle has its own.
    pub fn open_edges(&self) -> usize {
        let place = |index: u32| {
            let vertex = self.vertices.get(usize::try_from(index).ok()?)?;
            // Both zeros are one.
            Some([vertex.x, vertex.y, vertex.z].map(|value| (value + 0.0).to_bits()))
        };
        let mut passed = BTreeMap::<_, i32>::new();
        for [first, second, third] in &self.triangles {
            for (from, to) in [(first, second), (second, third), (third, first)] {
                let (Some(from), Some(to)) = (place(*from), place(*to)) else { continue };
                if from < to {
                    *passed.entry([from, to]).or_default() += 1;
                } else if to < from {
                    *passed.entry([to, from]).or_default() -= 1;
                }
            }
        }
        passed.values().filter(|sum| **sum != 0).count()
    }

    /// Lowest and highest corner of the box around it, m.
    pub fn bounds(&self, scale: &Vector3<f64>) -> [Point3<f64>; 2] {
        let corners = self.vertices.iter().map(|vertex| vertex.coords.component_mul(scale));
        let first = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        let (low, high) =
            corners.fold(first, |(low, high), corner| (low.inf(&corner), high.sup(&corner)));
        [low.into(), high.into()]
    }
}
