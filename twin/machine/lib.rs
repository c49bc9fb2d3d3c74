//! Machine file: one TOML file that describes a machine. The comments of `machines/*.toml` document it.
//!
//! ```
//! use std::path::Path;
//! use twin_kinematics::Kinematics;
//! use twin_machine::Machine;
//!
//! // A SCARA with arms of 250 mm and 200 mm, and a quill.
//! let machine = Machine::load(Path::new("../../machines/scara2.toml"))?;
//! let names: Vec<_> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
//! assert_eq!(names, ["A", "B", "Z"]);
//! // With all axes at 0 both arms are stretched along +x.
//! let pose = machine.kinematics.forward(&twin_kinematics::AxisVector::zeros(3))?;
//! assert!((pose.position.x - 0.45).abs() < 1e-12 && pose.position.y.abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod additional_axis;
mod approach;
mod around;
mod axis;
pub mod axis_couplings;
mod axis_drive;
pub mod axis_kind;
mod axis_pace;
pub mod cam_file;
mod conditions;
mod counting;
pub mod coupling_cycle;
mod couplings;
mod direction;
mod drives;
mod frame;
mod geometry;
mod grippers;
mod key_meaning;
mod limits;
mod m_functions;
mod payload;
mod physics;
mod plan_limits;
pub mod probe_trip;
mod scenario;
pub mod section;
mod simulated;
mod simulation_error;
mod surroundings;
pub mod switch_points;
mod tappet_outputs;
pub mod tappets;
#[cfg(test)]
mod tests;
mod tool;
mod tool_table;

use crate::section::FileKind;
pub use approach::{ApproachOrder, ApproachRule};
pub use axis::Axis;
pub use axis_drive::{AxisDrive, Switches};
pub use axis_pace::{Along, AxisPace};
pub use conditions::{PreparationInputs, ProgramConditions};
pub use counting::{Counting, IncrementRatio};
pub use couplings::{CamAxis, CamSelection, CoupledBy, Coupling, read_cam, read_ratio};
pub use direction::DirectionRule;
use drives::Seen;
pub use drives::{DeviceEntry, DriveFamily, FAMILIES};
pub use grippers::{GripperControl, GripperKind, GripperSignal};
pub use key_meaning::KeyMeaning;
pub use limits::{AxisLimit, PathLimits, VelocityLimit, VelocityLimits, VelocitySource};
pub use m_functions::MFunction;
pub use scenario::{FaultAt, FaultKind, FaultStart, Scenario};
pub use simulated::{
    FeedForward, SimulatedAxis, SimulatedMotor, SimulatedServo, SimulatedTransmission,
};
pub use simulation_error::SimulationError;
pub use surroundings::Collision;
pub use tool::SpindleBodies;
pub use tool_table::{ToolTableFileError, load_tool_table, parse_tool_table};
pub use twin_files::{limited_read, text};

use crate::section::{KeyUse, MachineFileError, Problem, Section};
use crate::switch_points::SwitchOutput;
use crate::tappets::TappetOutput;
use axis::AxisEntry;
use nalgebra::{Point3, Vector3};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tool::{Mount, Tool};
use twin_drives::MAX_DRIVE_AXES;
use twin_drives::family::Family;
use twin_kinematics::{AxisSource, AxisVector, Kinematics, MAX_AXES, MachineAxes, Pose, WorkFrame};
use twin_urdf::{Inertial, Model, UrdfWarning};

/// One set-point per millisecond.
const CYCLE_NS: i64 = 1_000_000;

/// Everything known about a machine. SI inside.
#[derive(Debug)]
pub struct Machine {
    /// The file it was read from.
    pub path: PathBuf,
    /// Its name.
    pub name: String,
    /// Kind of its transform, as in the file: `scara2`, `gantry_h2`.
    pub kind: &'static str,
    /// `[kinematics]` as in the file, without the kind.
    pub dimensions: toml::Table,
    /// From the tool to the axes and back.
    pub kinematics: Arc<MachineAxes>,
    /// Source of the tool direction.
    pub direction: DirectionRule,
    /// Length that weighs as much as a radian in measures of singularity, m.
    pub length_scale: f64,
    /// Pose of the program's frame.
    pub frame: WorkFrame,
    /// The axes.
    pub axes: Vec<Axis>,
    /// Links and joints, for physics and pictures.
    pub model: Model,
    /// Where its tools are.
    mount: Mount,
    /// Deviations of the model from the URDF that the file names.
    pub urdf_warnings: Vec<UrdfWarning>,
    /// Warnings about the file or its URDF: parts that are perhaps not meant as written.
    pub hints: Vec<String>,
    /// Payload of the tool, in the frame of the flange.
    pub payload: Option<Inertial>,
    /// Obstacles, loose bodies, grippers and collision check; `None`: no check.
    pub collision: Option<Collision>,
    /// The devices on the wires.
    pub drives: Vec<DeviceEntry>,
    /// M functions and their outputs.
    pub m_functions: Vec<MFunction>,
    /// Outputs that follow the tappets of cams.
    pub tappet_outputs: Vec<TappetOutput>,
    /// Outputs that follow the switches of the path.
    pub switch_outputs: Vec<SwitchOutput>,
    /// Acceleration of free fall in the machine frame, m/s².
    pub gravity: Vector3<f64>,
    /// Initial conditions of programs.
    pub conditions: ProgramConditions,
    /// Programs are planned by F and E alone unless a command says otherwise (`[controller]`, `plan`).
    pub plans_as_programmed: bool,
    /// Limits of the path in a plan.
    pub path_limits: PathLimits,
    /// Axes that follow others, masters before their slaves.
    pub couplings: Vec<Coupling>,
    /// Time between set-points, ns.
    pub cycle_ns: i64,
}

impl Machine {
    /// Reads a machine file.
    ///
    /// # Errors
    /// With everything that is wrong with it.
    pub fn load(path: &Path) -> Result<Self, MachineFileError> {
        section::load("machine file", path, |text| Self::parse(path, text))
    }

    /// Reads the text of a machine file; `path` is for messages.
    ///
    /// # Errors
    /// With everything that is wrong with it, in file order.
    pub fn parse(path: &Path, text: &str) -> Result<Self, Vec<Problem>> {
        Self::parse_with(path, text, FAMILIES)
    }

    /// As [`Self::parse`], with these drive families instead of [`FAMILIES`].
    ///
    /// # Errors
    /// As [`Self::parse`].
    pub fn parse_with(
        path: &Path,
        text: &str,
        families: &[&'static dyn Family],
    ) -> Result<Self, Vec<Problem>> {
        let machine = section::parse(text, |root| read(path, root, families))?;
        Ok(machine.completed(text))
    }

    /// As [`Self::parse`], with every key that the readers ask for.
    ///
    /// # Errors
    /// As [`Self::parse`].
    pub fn parse_recorded(path: &Path, text: &str) -> Result<(Self, Vec<KeyUse>), Vec<Problem>> {
        let read = |root: &Section<'_>| read(path, root, FAMILIES);
        let (machine, keys) = section::parse_recorded(text, read)?;
        Ok((machine.completed(text), keys))
    }

    fn completed(self, text: &str) -> Self {
        let mut machine = Self { dimensions: dimensions(text), ..self };
        machine.conditions.rs274.work_frame = *machine.frame.machine_from_work();
        machine.conditions.rs274.surroundings = around::surroundings(&machine);
        machine.conditions.pace = Some((Arc::new(AxisPace::of(&machine)), Along::Weakest));
        machine
    }

    /// The axes on a device, with their places in the file.
    pub fn axes_of(&self, device: usize) -> impl Iterator<Item = (usize, &Axis)> {
        let on_it = move |axis: &Axis| axis.drive.as_ref().is_some_and(|at| at.device == device);
        self.axes.iter().enumerate().filter(move |(_, axis)| on_it(axis))
    }

    /// Puts every device between set-points and motors of the simulated machine.
    pub fn put_drives_in_loop(&mut self) {
        for device in &mut self.drives {
            device.in_loop = true;
        }
    }

    /// Height of the tool tip above the machine frame's origin with every linear axis at 0, m.
    pub fn rest_height(&self) -> f64 {
        let axes = AxisVector::zeros(self.axes.len());
        self.kinematics.forward(&axes).map_or(0.0, |pose| pose.position.z)
    }

    /// Mass of everything that the axes move, kg.
    pub fn moving_mass(&self) -> f64 {
        let moves = geometry::moving_links(&self.model);
        let moving = self.model.links.iter().zip(moves).filter(|(_, moves)| *moves);
        moving.filter_map(|(link, _)| link.inertial).map(|body| body.mass).sum()
    }

    /// Middle of the software limits of every axis: start value for choosing among turns of rotary axes.
    pub fn middle(&self) -> AxisVector {
        let middle = |axis: &Axis| {
            let [min, max] = axis.position_limits;
            min.midpoint(max)
        };
        AxisVector::from_values(self.axes.iter().map(middle))
    }

    /// Axis positions at a start that the program leaves open, before slaves are put where their masters have them.
    pub fn start_without_slaves(&self) -> Option<AxisVector> {
        let mut axes = self.kinematics.inverse(&self.start_pose(), &self.middle()).ok()?;
        // The transform knows nothing of additional axes: they start where the file says.
        let sources = self.kinematics.sources().iter().zip(&self.axes);
        for (index, (source, axis)) in sources.enumerate() {
            let AxisSource::Additional(number) = *source else { continue };
            let start = self.conditions.start_additional.get(usize::from(number));
            if let (Some(slot), Some(start)) = (axes.get_mut(index), start) {
                *slot = axis.to_si(*start);
            }
        }
        Some(axes)
    }

    /// Tool pose at the default start of programs, machine frame.
    pub fn start_pose(&self) -> Pose {
        let position = Point3::from(self.conditions.start);
        self.frame.pose_to_machine(&Pose { position, direction: self.direction.at_start() })
    }
}

fn read(path: &Path, root: &Section<'_>, families: &[&'static dyn Family]) -> Option<Machine> {
    if FileKind::Machine.refuses(root) {
        return None;
    }
    let name = root.required_text("name");
    let drives = root.sections("drives");
    let devices: Vec<_> = drives.iter().map(|section| drives::read(section, families)).collect();
    let seen = drives.iter().zip(&devices);
    let seen: Vec<_> =
        seen.map(|(section, entry)| Seen::of(section, entry.as_ref(), families)).collect();
    for (section, one) in drives.iter().zip(&seen) {
        let earlier = seen.iter().take_while(|other| !std::ptr::eq(*other, one));
        if earlier.into_iter().any(|other| other.name == one.name) && section.has("name") {
            section.complain_at("name", format!("there is a drive \"{}\" already", one.name));
        }
    }
    let ports: Vec<_> =
        devices.iter().map(|entry| entry.as_ref().and_then(DeviceEntry::place)).collect();
    for (index, (section, place)) in drives.iter().zip(&ports).enumerate() {
        let earlier = ports.iter().take(index).zip(&seen);
        if let Some((_, other)) =
            earlier.into_iter().find(|(one, _)| place.is_some() && *one == place)
        {
            let message = format!(
                "drive \"{}\" is on this port already: each device has its own",
                other.name
            );
            section.complain_at("port", message);
        }
    }
    let axis_sections = root.sections("axes");
    for (section, one) in drives.iter().zip(&seen) {
        let hang =
            axis_sections.iter().filter(|axis| axis.glance_at_text("drive") == Some(&one.name));
        let names: Vec<_> = hang.filter_map(|axis| axis.glance_at_text("drive_axis")).collect();
        drives::check_encoder(section, one.family, &names);
    }
    drives.into_iter().for_each(Section::finish);
    let hanging = |one: &Seen| {
        let axes = axis_sections.iter();
        axes.filter(|axis| axis.glance_at_text("drive") == Some(&one.name)).count()
    };
    let with_axes: Vec<_> = seen.iter().map(|one| (one, hanging(one))).collect();
    let tappet_outputs = tappet_outputs::read(root, &with_axes);
    let switch_outputs = tappet_outputs::read_switches(root, &with_axes, &tappet_outputs);

    let entries: Vec<_> = axis_sections.iter().map(|section| axis::read(section, &seen)).collect();
    let unique = check_axes(root, &axis_sections, &entries);
    axis_sections.into_iter().for_each(Section::finish);
    let axes: Option<Vec<_>> = entries.into_iter().collect::<Option<_>>().filter(|_| unique);

    let conditions = conditions::read(root, path, !seen.is_empty());
    let mounted = Tool::read(root, conditions.rs274.tools.is_some());
    let payload = payload::read(root, &mounted);
    let frame = frame::read(root);

    let path_limits = limits::read_path(root, &conditions.preparation);
    let controller = root.section("controller");
    let plan = controller.choice("plan", &[("axes", false), ("programmed", true)]);
    controller.check_unknown();
    let m_functions = m_functions::read(root, !seen.is_empty());

    let environment = root.section("environment");
    let gravity = environment.numbers("gravity_m_per_s2", -100.0..=100.0);
    environment.finish();

    let file = geometry::File { path, name: name.unwrap_or_default() };
    let geometry = geometry::read(root, file, axes.as_deref(), &mounted, payload.as_ref());
    let machine = geometry.as_ref().map(|built| (&built.model, &built.mount.flange));
    let frames = surroundings::Frames { file: path, work: frame.as_ref(), machine };
    let collision = surroundings::read(root, &frames, mounted.tip.z < 0.0);
    let axes = geometry.as_ref().map(|geometry| &*geometry.axes);
    let couplings = couplings::read(root, path, axes);
    root.check_unknown();

    let geometry = geometry?;
    let mut machine = Machine {
        path: path.to_owned(),
        name: name?.to_owned(),
        kind: geometry.kind,
        dimensions: toml::Table::new(),
        kinematics: Arc::new(geometry.kinematics),
        model: geometry.model,
        mount: geometry.mount,
        direction: geometry.direction,
        length_scale: geometry.length_scale,
        frame: frame?,
        axes: geometry.axes,
        urdf_warnings: geometry.warnings,
        hints: geometry.hints,
        payload,
        drives: devices.into_iter().collect::<Option<_>>()?,
        gravity: Vector3::from(gravity.unwrap_or([0.0, 0.0, -9.81])),
        conditions,
        plans_as_programmed: plan.unwrap_or(false),
        path_limits,
        m_functions,
        tappet_outputs,
        switch_outputs,
        collision,
        couplings: couplings?,
        cycle_ns: CYCLE_NS,
    };
    let checked = machine.leave_out_what_overlaps();
    let said = |error| root.complain(SimulationError::of(&machine, error).to_string());
    checked.map_err(said).ok()?;
    Some(machine)
}

/// `[kinematics]` as it is written, without the kind.
fn dimensions(text: &str) -> toml::Table {
    let file: toml::Table = text.parse().unwrap_or_default();
    let mut dimensions = match file.get("kinematics") {
        Some(toml::Value::Table(table)) => table.clone(),
        _ => toml::Table::new(),
    };
    dimensions.remove("kind");
    dimensions
}

/// Checks the axes against each other. False if two have the same name.
fn check_axes(root: &Section<'_>, sections: &[Section<'_>], entries: &[Option<AxisEntry>]) -> bool {
    let mut unique = true;
    if sections.is_empty() {
        root.complain("the file lacks [[axes]]");
    }
    if let Some(beyond) = sections.get(MAX_AXES) {
        beyond.complain(format!("{} axes; at most {MAX_AXES} are supported", sections.len()));
    }
    let known: Vec<_> = entries.iter().flatten().collect();
    for (section, entry) in sections.iter().zip(entries) {
        let Some(entry) = entry else { continue };
        let mut earlier = known.iter().take_while(|other| !std::ptr::eq(**other, entry));
        if earlier.clone().any(|other| other.axis.name == entry.axis.name) {
            let message = format!("there is an axis \"{}\" already", entry.axis.name);
            section.complain_at("name", message);
            unique = false;
        }
        let place = |drive: &AxisDrive| (drive.device, drive.index);
        let Some(mine) = entry.axis.drive.as_ref().map(place) else { continue };
        if let Some(other) =
            earlier.find(|other| other.axis.drive.as_ref().map(place) == Some(mine))
        {
            let message =
                format!("axis \"{}\" already hangs on this axis of the drive", other.axis.name);
            let keys = ["drive_address", "drive_axis"];
            let key = keys.into_iter().find(|key| section.has(key)).unwrap_or("drive");
            section.complain_at(key, message);
        }
    }
    for (section, entry) in sections.iter().zip(entries) {
        let Some(entry) = entry else { continue };
        let device = |entry: &AxisEntry| entry.axis.drive.as_ref().map(|drive| drive.device);
        let earlier = known.iter().take_while(|other| !std::ptr::eq(**other, entry));
        let same =
            earlier.filter(|other| device(other).is_some() && device(other) == device(entry));
        if same.count() == MAX_DRIVE_AXES {
            let message = format!("a device has at most {MAX_DRIVE_AXES} axes of the machine");
            section.complain_at("drive", message);
        }
    }
    if known.iter().any(|entry| entry.driven) {
        for (section, entry) in sections.iter().zip(entries) {
            if let Some(entry) = entry.as_ref().filter(|entry| !entry.driven) {
                let name = &entry.axis.name;
                section.complain(format!(
                    "axis \"{name}\" has no `drive`, but others have: all or none"
                ));
            }
        }
    }
    unique
}
