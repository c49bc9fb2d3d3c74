//! `[[obstacles]]` and `[collision]`: obstacles around the machine, and pairs of parts for the collision check.

use super::Machine;
use crate::section::Section;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;
use twin_gcode::rs274::Tool;
use twin_kinematics::WorkFrame;
use twin_physics::{ClearanceScan, Obstacle, ObstacleKind, Part, PhysicsError, Surroundings};
use twin_urdf::{Mesh, Model, Solid, SolidShape};

/// mm; of bodies.
const SIZE_MM: RangeInclusive<f64> = 1e-3..=100_000.0;
/// mm; of places.
const PLACE_MM: RangeInclusive<f64> = -1e5..=1e5;
/// Range of the factors of a mesh's coordinates.
const SCALE: RangeInclusive<f64> = 1e-6..=1e6;

/// Name of the tool in `leave_out`.
const TOOL: &str = "tool";

/// Collision check of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Collision {
    /// Obstacles around the machine, and the pairs of parts that may touch.
    pub surroundings: Surroundings,
    /// Nearer than this is worth a warning, m.
    pub clearance: f64,
    /// Links that overlap with every axis in the middle of its travel, and are therefore not checked.
    pub overlapping: Vec<[Part; 2]>,
}

/// Contents of the sections, before the shape of the machine is known.
#[derive(Debug)]
pub(super) struct Entries {
    obstacles: Vec<Obstacle>,
    /// Places of their names in the file.
    names: Vec<std::ops::Range<usize>>,
    among_links: bool,
    /// By name, and where in the file.
    left_out: Vec<([String; 2], std::ops::Range<usize>)>,
    stiffness: f64,
    clearance: f64,
}

/// Reads the sections; `None` if the file has neither section, or has errors in them.
pub(super) fn read(root: &Section<'_>, file: &Path, frame: Option<&WorkFrame>) -> Option<Entries> {
    let given = root.has("obstacles") || root.has("collision");
    let sections = root.sections("obstacles");
    let obstacles: Vec<_> = sections.iter().map(|section| obstacle(section, file, frame)).collect();
    for (section, one) in sections.iter().zip(&obstacles) {
        let name = one.as_ref().map(|one| one.name.as_str());
        let earlier = obstacles.iter().take_while(|other| !std::ptr::eq(*other, one)).flatten();
        if name.is_some() && earlier.map(|other| Some(other.name.as_str())).any(|it| it == name) {
            section.complain_at("name", "there is an obstacle of this name already");
        }
    }
    let names = sections.iter().map(|section| section.span_of("name")).collect();
    sections.into_iter().for_each(Section::finish);
    let collision = root.section("collision");
    let among_links = collision.flag("self_collision").unwrap_or(true);
    let left_out = collision.pairs_of_names("leave_out");
    let stiffness = collision.number("stiffness_n_per_mm", 1.0..=1e7).map(|value| value * 1e3);
    let clearance = collision.number("clearance_mm", 0.0..=1000.0).unwrap_or_default() * 1e-3;
    collision.finish();
    given.then_some(())?;
    Some(Entries {
        obstacles: obstacles.into_iter().collect::<Option<_>>()?,
        names,
        among_links,
        left_out,
        stiffness: stiffness.unwrap_or(Surroundings::STIFFNESS),
        clearance,
    })
}

/// One of `[[obstacles]]`.
fn obstacle(section: &Section<'_>, file: &Path, frame: Option<&WorkFrame>) -> Option<Obstacle> {
    let name = section.required_text("name");
    let kinds = [
        ("fixture", ObstacleKind::Fixture),
        ("table", ObstacleKind::Fixture),
        ("stock", ObstacleKind::Stock),
    ];
    let kind = section.choice("kind", &kinds).unwrap_or_default();
    let in_work = section.choice("frame", &[("machine", false), ("work", true)]).unwrap_or(false);
    let place = section.numbers::<3>("position_mm", PLACE_MM).unwrap_or_default();
    let rotation = section.numbers::<3>("rotation_deg", -360.0..=360.0).unwrap_or_default();
    let shape = shape(section, file);
    let [roll, pitch, yaw] = rotation.map(f64::to_radians);
    let mut origin = Isometry3::from_parts(
        Translation3::from(Vector3::from(place) * 1e-3),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    );
    if in_work {
        origin = frame?.machine_from_work() * origin;
    }
    let color = match kind {
        ObstacleKind::Fixture => [0.55, 0.42, 0.36, 1.0],
        ObstacleKind::Stock => [0.72, 0.66, 0.50, 0.6],
    };
    let solid = Solid { shape: shape?, origin, color };
    Some(Obstacle { name: name?.to_owned(), kind, solids: vec![solid] })
}

fn shape(section: &Section<'_>, file: &Path) -> Option<SolidShape> {
    let shapes = ["box", "cylinder", "sphere", "capsule", "mesh"].map(|shape| (shape, shape));
    let length = |key: &str| section.required_number(key, SIZE_MM).map(|value| value * 1e-3);
    let shape = section.required_choice("shape", &shapes)?;
    section.is_of_kind(shape);
    Some(match shape {
        "box" => {
            let size = section.required_numbers::<3>("size_mm", SIZE_MM)?;
            SolidShape::Box { size: Vector3::from(size) * 1e-3 }
        }
        "sphere" => SolidShape::Sphere { radius: length("radius_mm")? },
        "cylinder" | "capsule" => {
            let (radius, length) = (length("radius_mm"), length("length_mm"));
            let (radius, length) = (radius?, length?);
            match shape {
                "cylinder" => SolidShape::Cylinder { radius, length },
                _ => SolidShape::Capsule { radius, length },
            }
        }
        _ => {
            let name = section.required_text("file");
            let scale = section.number("scale", SCALE).unwrap_or(1.0);
            let name = name?;
            let path = file.parent().unwrap_or_else(|| Path::new("")).join(name);
            let mesh = Mesh::load(&path, name);
            let mesh = mesh.map_err(|error| {
                section.complain_at("file", format!("{}: {error}", path.display()));
            });
            let (mesh, scale) = (mesh.ok()?, Vector3::repeat(scale * 1e-3));
            let [low, high] = mesh.bounds(&scale);
            let farthest = low.coords.abs().sup(&high.coords.abs()).max() * 1e3;
            if !(PLACE_MM.contains(&farthest) && SIZE_MM.contains(&((high - low).max() * 1e3))) {
                let message = format!(
                    "{} goes to {farthest} mm from its origin; bodies are {} to {} mm large",
                    path.display(),
                    SIZE_MM.start(),
                    SIZE_MM.end()
                );
                section.complain_at("file", message);
                return None;
            }
            // What drawings are in, as everything else here.
            SolidShape::Mesh { mesh: Arc::new(mesh), scale }
        }
    })
}

impl Entries {
    /// Collision check for the machine `model`, without pairs that overlap in the rest pose.
    pub(super) fn of(self, root: &Section<'_>, model: &Model, has_tool: bool) -> Collision {
        let is_taken =
            |name: &str| name == TOOL || model.links.iter().any(|link| link.name == name);
        for (one, span) in
            self.obstacles.iter().zip(&self.names).filter(|(one, _)| is_taken(&one.name))
        {
            let message =
                format!("an obstacle is called \"{}\", as a link or the tool is", one.name);
            root.complain_over(span, message);
        }
        let mut left_out = Vec::new();
        for (names, span) in self.left_out {
            let part = |name: &String| {
                let link = model.links.iter().position(|link| link.name == *name);
                let obstacle = self.obstacles.iter().position(|one| one.name == *name);
                let tool = (name == TOOL).then_some(Part::Tool);
                tool.or(link.map(Part::Link)).or(obstacle.map(Part::Obstacle))
            };
            let [one, other] = names.each_ref().map(part);
            if let Some(pair) = one.zip(other) {
                left_out.push(pair.into());
                continue;
            }
            let links = model.links.iter().map(|link| link.name.as_str());
            let obstacles = self.obstacles.iter().map(|one| one.name.as_str());
            let known: Vec<_> = [TOOL].into_iter().chain(links).chain(obstacles).collect();
            for (name, _) in names.iter().zip([one, other]).filter(|(_, part)| part.is_none()) {
                let message = format!(
                    "`leave_out` names \"{name}\", which is neither a link nor an obstacle; there are {}",
                    known.join(", ")
                );
                root.complain_over(&span, message);
            }
        }
        let surroundings = Surroundings {
            obstacles: self.obstacles,
            among_links: self.among_links,
            has_tool,
            left_out,
            stiffness: self.stiffness,
        };
        Collision { surroundings, clearance: self.clearance, overlapping: Vec::new() }
    }
}

impl Machine {
    /// Scan of the distances between the machine and its obstacles; `None` without a collision check in the file.
    ///
    /// # Errors
    /// [`PhysicsError`].
    pub fn clearance_scan(&self) -> Result<Option<ClearanceScan>, PhysicsError> {
        self.clearance_scan_with(None)
    }

    /// The same with `tool` of a tool table in the spindle, which the generated table of a machine does not stop.
    ///
    /// # Errors
    /// [`PhysicsError`].
    pub fn clearance_scan_with(
        &self,
        tool: Option<&Tool>,
    ) -> Result<Option<ClearanceScan>, PhysicsError> {
        let Some(bodies) = self.spindle_bodies() else { return Ok(None) };
        Ok(Some(bodies.scan(tool)?).filter(|scan| !scan.is_empty()))
    }

    /// The same, and the tool and the stock, for motion that must not cut.
    ///
    /// # Errors
    /// [`PhysicsError`].
    pub fn scan_without_cuts(
        &self,
        tool: Option<&Tool>,
    ) -> Result<Option<ClearanceScan>, PhysicsError> {
        let Some(bodies) = self.spindle_bodies() else { return Ok(None) };
        Ok(Some(bodies.scan_without_cuts(tool)?).filter(|scan| !scan.is_empty()))
    }

    /// Meshes of these parts that are not closed, with the number of open edges.
    pub fn open_meshes(&self) -> Vec<(String, usize)> {
        let Some(collision) = &self.collision else { return Vec::new() };
        let links = self.model.links.iter().map(|link| {
            let solids = if link.collision.is_empty() { &link.solids } else { &link.collision };
            (&link.name, solids)
        });
        let obstacles = collision.surroundings.obstacles.iter();
        let bodies = links.chain(obstacles.map(|one| (&one.name, &one.solids)));
        let open = bodies.filter_map(|(name, solids)| {
            let edges = solids.iter().map(|solid| match &solid.shape {
                SolidShape::Mesh { mesh, .. } => mesh.open_edges(),
                _ => 0,
            });
            let edges: usize = edges.sum();
            (edges > 0).then(|| (name.clone(), edges))
        });
        open.collect()
    }

    /// Excludes links that overlap at mid-travel: solids are drawn with less care than joints.
    pub(super) fn leave_out_what_overlaps(&mut self) -> Result<(), PhysicsError> {
        let Some(mut scan) = self.clearance_scan()? else { return Ok(()) };
        // Where a tripod cannot be nothing overlaps.
        let overlapping = scan.overlapping(&self.middle()).unwrap_or_default();
        let Some(collision) = &mut self.collision else { return Ok(()) };
        let among = overlapping
            .into_iter()
            .filter(|pair| !pair.iter().any(|part| matches!(part, Part::Obstacle(_))));
        collision.overlapping = among.collect();
        collision.surroundings.left_out.extend(&collision.overlapping);
        Ok(())
    }

    /// Name of `part` with this tool of a tool table in the spindle, by its number.
    pub fn part_name_with(&self, part: Part, tool: Option<u32>) -> String {
        match (part, tool) {
            (Part::Tool, Some(number)) => format!("tool {number}"),
            (part, _) => self.part_name(part),
        }
    }

    /// Name of `part`.
    pub fn part_name(&self, part: Part) -> String {
        let name = match (&self.collision, part) {
            (_, Part::Tool) => "the tool",
            (_, Part::Link(index)) => {
                self.model.links.get(index).map_or("a link", |link| &link.name)
            }
            (Some(collision), part) => part.name(&self.model, &collision.surroundings),
            (None, Part::Obstacle(_)) => "an obstacle",
        };
        name.to_owned()
    }
}
