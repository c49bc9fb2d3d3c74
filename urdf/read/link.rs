//! Reader of links: visual and collision solids, materials, inertial properties.

use super::document::{At, Element};
use super::schema::SHAPES;
use super::{Reader, UrdfNote, packages};
use crate::check::{check_finite, check_inertial, check_measures};
use crate::inertial::turned;
use crate::mesh::load_first;
use crate::{Inertial, Link, Mesh, Part, Solid, SolidShape, UrdfError};
use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Colour of a solid without a colour in the file.
const GREY: [f64; 4] = [0.6, 0.6, 0.6, 1.0];

/// Meshes by the names that the text has for them.
pub(super) type Meshes = HashMap<String, Arc<Mesh>>;

/// Colours by the names of their materials, wherever in the file they are defined.
pub(super) type Colors<'a> = HashMap<&'a str, [f64; 4]>;

fn color_of(material: Element<'_>) -> Option<[f64; 4]> {
    material.child("color")?.numbers("rgba")
}

pub(super) fn colors(robot: Element<'_>) -> Colors<'_> {
    let visuals = robot.children("link").flat_map(|link| link.children("visual"));
    let inside = visuals.filter_map(|visual| visual.child("material"));
    // What the robot defines wins over what a link defines in passing.
    let all = inside.chain(robot.children("material"));
    all.filter_map(|material| Some((material.name(), color_of(material)?))).collect()
}

/// Mass and inertia as written; `None` if a link has neither.
pub(super) fn mass(link: Element<'_>) -> Option<(f64, Matrix3<f64>)> {
    let inertial = link.child("inertial")?;
    let mass = inertial.child("mass")?.number("value")?;
    let inertia = inertial.child("inertia")?;
    let of = |attribute: &str| inertia.number(attribute).unwrap_or_default();
    let [ixx, ixy, ixz] = ["ixx", "ixy", "ixz"].map(of);
    let [iyy, iyz, izz] = ["iyy", "iyz", "izz"].map(of);
    let written = Matrix3::new(ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz);
    (mass != 0.0 || written != Matrix3::zeros()).then_some((mass, written))
}

impl Reader<'_> {
    pub(super) fn link(&mut self, link: Element<'_>, colors: &Colors<'_>) -> At<Link> {
        let name = link.name();
        let mut solids = Vec::new();
        for visual in link.children("visual") {
            let (origin, shape) = self.body(name, visual)?;
            let color = self.color(name, visual, colors)?;
            solids.push(Solid { shape, origin, color });
        }
        let mut collision = Vec::new();
        for body in link.children("collision") {
            let (origin, shape) = self.body(name, body)?;
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
        let inertial = self.inertial(link)?;
        Ok(Link { collision, ..Link::new(name, inertial, solids) })
    }

    fn color(&mut self, link: &str, visual: Element<'_>, colors: &Colors<'_>) -> At<[f64; 4]> {
        let Some(material) = visual.child("material") else { return Ok(GREY) };
        let found = color_of(material).or_else(|| colors.get(material.name()).copied());
        let (link, line) = (link.to_owned(), visual.line());
        if let Some(texture) = material.child("texture") {
            let file = texture.text("filename").unwrap_or_default().to_owned();
            self.warn(line, UrdfNote::Texture { link: link.clone(), file });
        } else if found.is_none() {
            let material = material.name().to_owned();
            self.warn(line, UrdfNote::NoColor { link: link.clone(), material });
        }
        let color = found.unwrap_or(GREY);
        check_finite(&Part::Link(link), "a colour", &color).map_err(|error| (line, error))?;
        Ok(color)
    }

    /// A visible or a collision solid.
    fn body(&mut self, link: &str, solid: Element<'_>) -> At<(Isometry3<f64>, SolidShape)> {
        let part = Part::Link(link.to_owned());
        let line = solid.line();
        let mut geometry = solid.child("geometry").into_iter().flat_map(Element::all);
        let shape = geometry.find(|shape| SHAPES.contains(&shape.tag())).unwrap_or(solid);
        let measure = |attribute: &str| shape.number(attribute).unwrap_or_default();
        let [radius, length] = ["radius", "length"].map(measure);
        let edges = |attribute: &str| shape.numbers(attribute).map(Vector3::from);
        let shape = match shape.tag() {
            "cylinder" => SolidShape::Cylinder { radius, length },
            "sphere" => SolidShape::Sphere { radius },
            "capsule" => SolidShape::Capsule { radius, length },
            "mesh" => SolidShape::Mesh {
                mesh: self.mesh(link, shape.text("filename").unwrap_or_default(), line)?,
                scale: edges("scale").unwrap_or_else(|| Vector3::repeat(1.0)),
            },
            _ => SolidShape::Box { size: edges("size").unwrap_or_default() },
        };
        check_measures(&part, &shape).map_err(|error| (line, error))?;
        Ok((self.pose(&part, solid, line)?, shape))
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

    fn inertial(&mut self, link: Element<'_>) -> At<Option<Inertial>> {
        let Some((mass, written)) = mass(link) else { return Ok(None) };
        let place = link.child("inertial").unwrap_or(link);
        let origin = self.pose(&Part::Link(link.name().to_owned()), place, place.line())?;
        let inertia = if origin.rotation == UnitQuaternion::identity() {
            written
        } else {
            turned(&written, &origin.rotation)
        };
        let inertial = Inertial { mass, center: origin.translation.vector.into(), inertia };
        check_inertial(link.name(), &inertial).map_err(|error| (place.line(), error))?;
        Ok(Some(inertial))
    }
}
