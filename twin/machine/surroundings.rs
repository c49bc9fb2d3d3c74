//! `[[obstacles]]`, `[[bodies]]`, `[[friction]]` and `[collision]`: what is around the machine, and pairs of parts for
//! the collision check.

use super::Machine;
use crate::grippers::{self, GripperControl};
use crate::section::{self, FileKind, MachineFileError, Problem, Section};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;
use twin_gcode::rs274::Tool;
use twin_kinematics::WorkFrame;
use twin_physics::{
    Body, ClearanceScan, Material, Obstacle, ObstacleKind, Part, PhysicsError, Surface,
    Surroundings,
};
use twin_urdf::{Mesh, Model, Solid, SolidShape};

/// mm; of bodies.
const SIZE_MM: RangeInclusive<f64> = 1e-3..=100_000.0;
/// mm; of places.
const PLACE_MM: RangeInclusive<f64> = -1e5..=1e5;
/// Range of the factors of a mesh's coordinates.
const SCALE: RangeInclusive<f64> = 1e-6..=1e6;
/// N.
const FORCE: RangeInclusive<f64> = 1e-3..=1e9;

/// Name of the tool in `leave_out`.
const TOOL: &str = "tool";

/// Collision check of a machine, and what it handles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Collision {
    /// Obstacles, loose bodies and grippers, and the pairs of parts that may touch.
    pub surroundings: Surroundings,
    /// Nearer than this is worth a warning, m.
    pub clearance: f64,
    /// Links that overlap with every axis in the middle of its travel, and are therefore not checked.
    pub overlapping: Vec<[Part; 2]>,
    /// Signals of the grippers, in the order of [`Surroundings::grippers`].
    pub controls: Vec<GripperControl>,
    /// Names of the materials, from number 1 on.
    materials: Vec<String>,
}

/// References of the tables of surroundings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frames<'a> {
    /// The file that they are in.
    pub(super) file: &'a Path,
    /// The work frame, if it is known.
    pub(super) work: Option<&'a WorkFrame>,
    /// The machine, and its flange in the link of the tip, if they are known.
    pub(super) machine: Option<(&'a Model, &'a Isometry3<f64>)>,
}

/// Reads the sections; `None` if the file has none of them, or has errors in them.
pub(super) fn read(root: &Section<'_>, frames: &Frames<'_>, has_tool: bool) -> Option<Collision> {
    let tables = ["obstacles", "collision", "bodies", "friction", "grippers"];
    let given = tables.into_iter().any(|table| root.has(table));
    let mut found = Collision::default();
    let collision = root.section("collision");
    let among_links = collision.flag("self_collision");
    let left_out = collision.pairs_of_names("leave_out");
    let stiffness = collision.number("stiffness_n_per_mm", 1.0..=1e7).map(|value| value * 1e3);
    found.clearance = collision.number("clearance_mm", 0.0..=1000.0).unwrap_or_default() * 1e-3;
    let around = &mut found.surroundings;
    around.machine_material = material(&collision, &mut found.materials);
    around.has_tool = has_tool;
    around.among_links = among_links.unwrap_or(around.among_links);
    around.stiffness = stiffness.unwrap_or(around.stiffness);
    collision.finish();
    let is_sound = found.read(root, frames);
    let (model, _) = frames.machine.filter(|_| given && is_sound)?;
    for (names, span) in left_out {
        match found.pair(model, &names) {
            Ok(pair) => found.surroundings.left_out.push(pair),
            Err(message) => root.complain_over(&span, message),
        }
    }
    Some(found)
}

impl Collision {
    /// True with loose bodies or grippers.
    pub fn handles_bodies(&self) -> bool {
        !(self.surroundings.bodies.is_empty() && self.controls.is_empty())
    }

    /// Adds the obstacles, bodies, frictions and grippers of a file; false if there are errors in them.
    fn read(&mut self, root: &Section<'_>, frames: &Frames<'_>) -> bool {
        let mut taken: Vec<(String, &str)> = Vec::new();
        let around = &self.surroundings;
        taken.extend(around.obstacles.iter().map(|one| (one.name.clone(), "an obstacle")));
        taken.extend(around.bodies.iter().map(|one| (one.name.clone(), "a body")));
        let mut is_sound = true;
        for section in root.sections("obstacles") {
            let is_free = has_free_name(&section, ("an obstacle", &mut taken), frames);
            let obstacle = obstacle(&section, frames, &mut self.materials);
            section.finish();
            is_sound &= is_free && obstacle.is_some();
            self.surroundings.obstacles.extend(obstacle);
        }
        for section in root.sections("bodies") {
            let is_free = has_free_name(&section, ("a body", &mut taken), frames);
            let body = body(&section, frames, &mut self.materials);
            section.finish();
            is_sound &= is_free && body.is_some();
            self.surroundings.bodies.extend(body);
        }
        for section in root.sections("friction") {
            let friction = self.friction(&section);
            section.finish();
            is_sound &= friction.is_some();
            self.surroundings.frictions.extend(friction);
        }
        for section in root.sections("grippers") {
            let known = &self.surroundings.grippers;
            let gripper = grippers::read(&section, (known, &self.controls), frames.machine);
            section.finish();
            is_sound &= gripper.is_some();
            let (gripper, control) = gripper.unzip();
            self.surroundings.grippers.extend(gripper);
            self.controls.extend(control);
        }
        is_sound
    }

    /// One of `[[friction]]`.
    fn friction(&self, section: &Section<'_>) -> Option<([Material; 2], f64)> {
        let names = section.required_names::<2>("materials");
        let coefficient = section.required_number("coefficient", 0.0..=10.0);
        let numbers = names?.map(|name| {
            let number = self.materials.iter().position(|known| known == name);
            if number.is_none() {
                let known = self.materials.join(", ");
                let message = format!("no part is of the material \"{name}\"; known: {known}");
                section.complain_at("materials", message);
            }
            number.map(|number| number + 1)
        });
        let (one, other) = (numbers[0]?, numbers[1]?);
        let mut known = self.surroundings.frictions.iter().map(|(pair, _)| *pair);
        if known.any(|pair| pair == [one, other] || pair == [other, one]) {
            section.complain_at("materials", "these two have a coefficient already");
            return None;
        }
        Some(([one, other], coefficient?))
    }

    /// The parts of these names.
    ///
    /// Errors: a message about the one that is not there.
    fn pair(&self, model: &Model, names: &[String; 2]) -> Result<[Part; 2], String> {
        let around = &self.surroundings;
        let part = |name: &String| {
            let link = model.links.iter().position(|link| link.name == *name);
            let obstacle = around.obstacles.iter().position(|one| one.name == *name);
            let body = around.bodies.iter().position(|one| one.name == *name);
            let around = obstacle.map(Part::Obstacle).or(body.map(Part::Body));
            (name == TOOL).then_some(Part::Tool).or(link.map(Part::Link)).or(around)
        };
        let known = || {
            let links = model.links.iter().map(|link| link.name.as_str());
            let obstacles = around.obstacles.iter().map(|one| one.name.as_str());
            let bodies = around.bodies.iter().map(|one| one.name.as_str());
            let known: Vec<_> =
                [TOOL].into_iter().chain(links).chain(obstacles).chain(bodies).collect();
            known.join(", ")
        };
        let found = |name: &String| {
            part(name).ok_or_else(|| {
                format!(
                    "`leave_out` names \"{name}\", which is not a link, an obstacle or a body; there are {}",
                    known()
                )
            })
        };
        let [one, other] = names;
        Ok([found(one)?, found(other)?])
    }
}

/// True if the name of a section is not `taken`, and adds it there with its kind.
fn has_free_name(
    section: &Section<'_>,
    (kind, taken): (&'static str, &mut Vec<(String, &'static str)>),
    frames: &Frames<'_>,
) -> bool {
    let Some(name) = section.glance_at_text("name") else { return true };
    let earlier = taken.iter().find(|(known, _)| known == name).map(|(_, kind)| *kind);
    taken.push((name.to_owned(), kind));
    if let Some(earlier) = earlier {
        section.complain_at("name", format!("there is {earlier} of this name already"));
        return false;
    }
    let mut links = frames.machine.iter().flat_map(|(model, _)| &model.links);
    if name == TOOL || links.any(|link| link.name == name) {
        let message = format!("{kind} is called \"{name}\", as a link or the tool is");
        section.complain_at("name", message);
        return false;
    }
    true
}

/// Number of the material of a section, which is added to `known`; 0 without one.
fn material(section: &Section<'_>, known: &mut Vec<String>) -> Material {
    let Some(name) = section.text("material") else { return 0 };
    if !known.iter().any(|one| one == name) {
        known.push(name.to_owned());
    }
    known.iter().position(|one| one == name).map_or(0, |index| index + 1)
}

/// Place of a section in the machine frame.
fn place(section: &Section<'_>, work: Option<&WorkFrame>) -> Option<Isometry3<f64>> {
    let in_work = section.choice("frame", &[("machine", false), ("work", true)]).unwrap_or(false);
    let place = section.numbers::<3>("position_mm", PLACE_MM).unwrap_or_default();
    let rotation = section.numbers::<3>("rotation_deg", -360.0..=360.0).unwrap_or_default();
    let [roll, pitch, yaw] = rotation.map(f64::to_radians);
    let place = Isometry3::from_parts(
        Translation3::from(Vector3::from(place) * 1e-3),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    );
    if in_work { Some(work?.machine_from_work() * place) } else { Some(place) }
}

/// One of `[[obstacles]]`.
fn obstacle(
    section: &Section<'_>,
    frames: &Frames<'_>,
    materials: &mut Vec<String>,
) -> Option<Obstacle> {
    let name = section.required_text("name");
    let kinds = [
        ("fixture", ObstacleKind::Fixture),
        ("table", ObstacleKind::Fixture),
        ("stock", ObstacleKind::Stock),
    ];
    let kind = section.choice("kind", &kinds).unwrap_or_default();
    let origin = place(section, frames.work);
    let material = material(section, materials);
    let belt = section.numbers::<3>("belt_mm_per_s", -1e5..=1e5).unwrap_or_default();
    let shape = shape(section, frames.file);
    let color = match kind {
        ObstacleKind::Fixture => [0.55, 0.42, 0.36, 1.0],
        ObstacleKind::Stock => [0.72, 0.66, 0.50, 0.6],
    };
    let solid = Solid { shape: shape?, origin: origin?, color };
    let surface = Surface { material, velocity: Vector3::from(belt) * 1e-3 };
    Some(Obstacle { name: name?.to_owned(), kind, solids: vec![solid], surface })
}

/// One of `[[bodies]]`.
fn body(section: &Section<'_>, frames: &Frames<'_>, materials: &mut Vec<String>) -> Option<Body> {
    let name = section.required_text("name");
    let pose = place(section, frames.work);
    let material = material(section, materials);
    let restitution = section.number("restitution", 0.0..=1.0).unwrap_or_default();
    let clamp = section.number("clamp_n", FORCE);
    let mass = section.number("mass_kg", 1e-6..=1e6);
    let density = section.number("density_kg_per_m3", 1e-3..=50_000.0);
    let shape = shape(section, frames.file);
    if section.has("mass_kg") == section.has("density_kg_per_m3") {
        let whose = name.map_or_else(String::new, |name| format!("body \"{name}\": "));
        section.complain(format!("{whose}give either `mass_kg` or `density_kg_per_m3`"));
        return None;
    }
    let solid =
        Solid { shape: shape?, origin: Isometry3::identity(), color: [0.30, 0.48, 0.65, 1.0] };
    let Some(volume) = solid.shape.volume() else {
        section.complain_at("file", "the mesh of a body has to enclose a volume");
        return None;
    };
    let inertial = solid.uniform(mass.or(density.map(|density| density * volume))?);
    let (name, solids, pose) = (name?.to_owned(), vec![solid], pose?);
    Some(Body { name, solids, inertial, pose, material, restitution, clamp })
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

impl Machine {
    /// Adds obstacles, bodies, frictions and grippers of the scene file at `path`.
    ///
    /// # Errors
    /// With everything that is wrong with it; the machine is as before then.
    pub fn add_scene(&mut self, path: &Path) -> Result<(), MachineFileError> {
        let collision = section::load("scene file", path, |text| self.with_scene(path, text))?;
        let had_check = self.collision.replace(collision).is_some();
        if !had_check {
            // A machine that cannot be measured is an error of the commands that measure it.
            self.leave_out_what_overlaps().unwrap_or_default();
        }
        self.conditions.rs274.surroundings = crate::around::surroundings(self);
        Ok(())
    }

    /// The collision check with what the scene in `text` adds.
    fn with_scene(&self, path: &Path, text: &str) -> Result<Collision, Vec<Problem>> {
        section::parse(text, |root| {
            if FileKind::Scene.refuses(root) {
                return None;
            }
            let machine = Some((&self.model, &self.mount.flange));
            let frames = Frames { file: path, work: Some(&self.frame), machine };
            let mut collision = self.collision.clone().unwrap_or_else(|| {
                let surroundings =
                    Surroundings { has_tool: self.mount.tip.z < 0.0, ..Surroundings::default() };
                Collision { surroundings, ..Collision::default() }
            });
            let is_sound = collision.read(root, &frames);
            root.check_unknown();
            is_sound.then_some(collision)
        })
    }

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
        let loose = collision.surroundings.bodies.iter();
        let solids = links.chain(obstacles.map(|one| (&one.name, &one.solids)));
        let solids = solids.chain(loose.map(|one| (&one.name, &one.solids)));
        let open = solids.filter_map(|(name, solids)| {
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
            (None, Part::Body(_)) => "a body",
        };
        name.to_owned()
    }
}
