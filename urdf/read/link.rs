//! Reader of links: visual and collision solids, materials, inertial properties.

use super::document::{At, OriginPlace, Places};
use super::{Reader, UrdfNote, packages};
use crate::check::{check_finite, check_inertial, check_measures};
use crate::inertial::turned;
use crate::mesh::load_first;
use crate::{Inertial, Link, Mesh, Part, Solid, SolidShape, UrdfError};
use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;
use urdf_rs::{Geometry, Material};

/// Colour of a solid without a colour in the file.
const GREY: [f64; 4] = [0.6, 0.6, 0.6, 1.0];

/// Meshes by the names that the text has for them.
pub(super) type Meshes = HashMap<String, Arc<Mesh>>;

/// Colours by the names of their materials, wherever in the file they are defined.
pub(super) fn colors(robot: &urdf_rs::Robot) -> HashMap<&str, [f64; 4]> {
    let inside = robot
        .links
        .iter()
        .flat_map(|link| &link.visual)
        .filter_map(|visual| visual.material.as_ref());
    // What the robot defines wins over what a link defines in passing.
    let all = inside.chain(&robot.materials);
    all.filter_map(|material| Some((material.name.as_str(), *material.color.as_ref()?.rgba)))
        .collect()
}

/// True if a link has no mass: urdf-rs gives that to a link without `<inertial>`.
pub(super) fn is_massless(link: &urdf_rs::Link) -> bool {
    link.inertial.mass.value == 0.0 && along(link) == Matrix3::zeros()
}

/// The inertia as written.
fn along(link: &urdf_rs::Link) -> Matrix3<f64> {
    let inertia = &link.inertial.inertia;
    Matrix3::new(
        inertia.ixx,
        inertia.ixy,
        inertia.ixz, //
        inertia.ixy,
        inertia.iyy,
        inertia.iyz, //
        inertia.ixz,
        inertia.iyz,
        inertia.izz,
    )
}

impl Reader<'_> {
    pub(super) fn link(
        &mut self,
        robot: &urdf_rs::Robot,
        index: usize,
        places: &Places,
        colors: &HashMap<&str, [f64; 4]>,
    ) -> At<Link> {
        let Some(link) = robot.links.get(index) else {
            return Err((places.robot, UrdfError::NoBase));
        };
        let nowhere = OriginPlace { line: places.link(index), ..OriginPlace::default() };
        let place = places.links.get(index);
        let of = |list: Option<&Vec<OriginPlace>>, number: usize| {
            list.and_then(|list| list.get(number)).copied().unwrap_or(nowhere)
        };
        let mut solids = Vec::with_capacity(link.visual.len());
        for (number, visual) in link.visual.iter().enumerate() {
            let place = of(place.map(|link| &link.visuals), number);
            let (origin, shape) = self.body(&link.name, &visual.origin, &visual.geometry, place)?;
            let color = self.color(&link.name, visual.material.as_ref(), colors, place.line)?;
            solids.push(Solid { shape, origin, color });
        }
        let mut collision = Vec::with_capacity(link.collision.len());
        for (number, body) in link.collision.iter().enumerate() {
            let place = of(place.map(|link| &link.collisions), number);
            let (origin, shape) = self.body(&link.name, &body.origin, &body.geometry, place)?;
            collision.push(Solid { shape, origin, color: GREY });
        }
        if solids.is_empty() {
            solids = std::mem::take(&mut collision);
        }
        let same =
            |(seen, hit): (&Solid, &Solid)| seen.shape == hit.shape && seen.origin == hit.origin;
        if solids.len() == collision.len() && solids.iter().zip(&collision).all(same) {
            collision.clear();
        }
        let place = place.map(|link| link.inertial).filter(|place| place.line > 0);
        let inertial = self.inertial(link, place.unwrap_or(nowhere))?;
        Ok(Link { collision, ..Link::new(link.name.clone(), inertial, solids) })
    }

    fn color(
        &mut self,
        link: &str,
        material: Option<&Material>,
        colors: &HashMap<&str, [f64; 4]>,
        line: u32,
    ) -> At<[f64; 4]> {
        let Some(material) = material else { return Ok(GREY) };
        let own = material.color.as_ref().map(|color| *color.rgba);
        let found = own.or_else(|| colors.get(material.name.as_str()).copied());
        if let Some(texture) = &material.texture {
            let (link, file) = (link.to_owned(), texture.filename.clone());
            self.warn(line, UrdfNote::Texture { link, file });
        } else if found.is_none() {
            let (link, material) = (link.to_owned(), material.name.clone());
            self.warn(line, UrdfNote::NoColor { link, material });
        }
        let color = found.unwrap_or(GREY);
        check_finite(&Part::Link(link.to_owned()), "a colour", &color)
            .map_err(|error| (line, error))?;
        Ok(color)
    }

    fn body(
        &mut self,
        link: &str,
        origin: &urdf_rs::Pose,
        geometry: &Geometry,
        place: OriginPlace,
    ) -> At<(Isometry3<f64>, SolidShape)> {
        let part = Part::Link(link.to_owned());
        let shape = match geometry {
            Geometry::Box { size } => SolidShape::Box { size: Vector3::from(**size) },
            Geometry::Cylinder { radius, length } => {
                SolidShape::Cylinder { radius: *radius, length: *length }
            }
            Geometry::Sphere { radius } => SolidShape::Sphere { radius: *radius },
            Geometry::Capsule { radius, length } => {
                SolidShape::Capsule { radius: *radius, length: *length }
            }
            Geometry::Mesh { filename, scale } => SolidShape::Mesh {
                mesh: self.mesh(link, filename, place.line)?,
                scale: scale.map_or_else(|| Vector3::repeat(1.0), |scale| Vector3::from(*scale)),
            },
        };
        check_measures(&part, &shape).map_err(|error| (place.line, error))?;
        Ok((self.pose(&part, origin, place)?, shape))
    }

    fn mesh(&mut self, link: &str, name: &str, line: u32) -> At<Arc<Mesh>> {
        if let Some(mesh) = self.meshes.get(name) {
            return Ok(mesh.clone());
        }
        let folder = self.path.parent().unwrap_or_else(|| Path::new(""));
        let places = packages::places(name, folder, &self.options.packages);
        let link = link.to_owned();
        let mesh = match load_first(&places, name) {
            Some(Ok(mesh)) => Arc::new(mesh),
            Some(Err((path, error))) => {
                return Err((line, UrdfError::Mesh { link, path, error }));
            }
            None => {
                return Err((line, UrdfError::NoMesh { link, file: name.to_owned(), places }));
            }
        };
        self.meshes.insert(name.to_owned(), mesh.clone());
        Ok(mesh)
    }

    fn inertial(&mut self, link: &urdf_rs::Link, place: OriginPlace) -> At<Option<Inertial>> {
        if is_massless(link) {
            return Ok(None);
        }
        let part = Part::Link(link.name.clone());
        let origin = self.pose(&part, &link.inertial.origin, place)?;
        let inertia = if origin.rotation == UnitQuaternion::identity() {
            along(link)
        } else {
            turned(&along(link), &origin.rotation)
        };
        let center = origin.translation.vector.into();
        let inertial = Inertial { mass: link.inertial.mass.value, center, inertia };
        check_inertial(&link.name, &inertial).map_err(|error| (place.line, error))?;
        Ok(Some(inertial))
    }
}
