//! `[body] urdf`: links and joints from a URDF file.
//!
//! `base_mm` and `base_rotation_deg` place the file's base in the machine frame. An axis moves the joint that it
//! names, or else the joint of its own name; other joints are held. Chain and transform are compared over the whole
//! travel (`agree`): a file in which they differ is refused.

mod agree;
mod fit;
mod mass;

use super::design::{Design, Kind};
use super::{Built, mount, rounded};
use crate::axis::{Axis, AxisEntry};
use crate::axis_kind::AxisKind;
use crate::section::Section;
use crate::tool::Tool;
use crate::{additional_axis, limited_read};
use mass::Masses;
pub(crate) use mass::moving_links;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::path::{Path, PathBuf};
use twin_kinematics::{AxisSource, MachineAxes};
use twin_path::EXTRA_AXES;
use twin_urdf::{
    AxisJoint, BindError, Inertial, Joint, JointKind, Loaded, MachineJoint, Model, UrdfError,
    UrdfFileError, UrdfOptions,
};

/// Tool tips may be as far from each other, mm, unless the file says otherwise.
const TOLERANCE_MM: f64 = 1e-3;
/// Limits that are beyond each other by no more than this are the same, in degrees or mm: somebody has rounded them.
const SAME_LIMIT: f64 = 1e-6;

/// URDF keys of `[body]`.
pub(super) struct Source {
    path: PathBuf,
    options: UrdfOptions,
    base: Isometry3<f64>,
    /// m.
    tolerance: f64,
    /// By joints, degrees or mm as their kind has it.
    held: Vec<(String, f64)>,
    masses: Masses,
}

/// The rest of the machine file.
pub(super) struct Given<'a> {
    pub(super) root: &'a Section<'a>,
    pub(super) body: &'a Section<'a>,
    pub(super) kind: &'static Kind,
    pub(super) design: &'a dyn Design,
    pub(super) axes: &'a [AxisEntry],
    pub(super) tool: &'a Tool,
    pub(super) payload: Option<&'a Inertial>,
    pub(super) sources: Vec<AxisSource>,
}

impl Source {
    /// Reads the keys of a file that has `urdf`; `None`: something is wrong with that.
    pub(super) fn read(body: &Section<'_>, file: &Path) -> Option<Self> {
        let folder = file.parent().unwrap_or_else(|| Path::new(""));
        let path = body.text("urdf").map(|name| folder.join(name));
        let tip_link = body.text("tip_link").map(str::to_owned);
        let base = body.numbers::<3>("base_mm", -1e5..=1e5).unwrap_or_default();
        let rotation = body.numbers::<3>("base_rotation_deg", -360.0..=360.0).unwrap_or_default();
        let [roll, pitch, yaw] = rotation.map(f64::to_radians);
        let tolerance = body.number("tolerance_mm", 1e-6..=100.0).unwrap_or(TOLERANCE_MM);
        let right_angles = body.number("right_angle_tolerance_deg", 0.0..=5.0).unwrap_or(0.0);
        let named = body.section("packages");
        let packages = named
            .keys()
            .into_iter()
            .filter_map(|name| Some((name.to_owned(), folder.join(named.text(name)?))));
        let packages = packages.collect();
        let joints = body.section("held_joints");
        let held = joints
            .keys()
            .into_iter()
            .filter_map(|name| Some((name.to_owned(), joints.number(name, -1e6..=1e6)?)));
        let held = held.collect();
        let masses = Masses::read(body);
        let right_angle_tolerance = right_angles.to_radians();
        Some(Self {
            path: path?,
            options: UrdfOptions { packages, tip_link, right_angle_tolerance },
            base: Isometry3::from_parts(
                Translation3::from(Vector3::from(base) * 1e-3),
                UnitQuaternion::from_euler_angles(roll, pitch, yaw),
            ),
            tolerance: tolerance * 1e-3,
            held,
            masses,
        })
    }

    /// The machine: the file's links and joints, moved by the axes, with the tool. Complains about all that does not fit.
    pub(super) fn build(self, given: &Given<'_>, machine: &MachineAxes) -> Option<Built> {
        let body = given.body;
        let refuse = |message: String| body.complain_at("urdf", message);
        if let Some(what) = given.kind.beyond_urdf {
            refuse(format!(
                "{what}, and a URDF is a tree of joints that one axis moves each: leave `urdf` out, and the machine is built \
                 from its dimensions"
            ));
            return None;
        }
        let text = limited_read::read_to_string(&self.path).map_err(|source| UrdfFileError {
            path: self.path.clone(),
            line: 1,
            error: Box::new(UrdfError::Read(source)),
        });
        let loaded = text.and_then(|text| Model::read_urdf(&text, &self.path, &self.options));
        let Loaded { mut model, warnings } =
            loaded.map_err(|error| refuse(error.to_string())).ok()?;
        if !model.loops.is_empty() {
            refuse(format!("{}: its links go round in loops", self.path.display()));
            return None;
        }
        let (bound, additional): (Vec<_>, Vec<_>) =
            given.axes.iter().enumerate().partition(|(_, entry)| is_in(&model, entry));
        let held = self.held_positions(given, &model)?;
        let joints: Vec<_> = bound
            .iter()
            .map(|(index, entry)| AxisJoint {
                machine_axis: *index,
                joint: joint_name(entry).to_owned(),
                reversed: entry.joint.reversed,
                offset: entry.joint.offset,
            })
            .collect();
        let kinds_fit = bound.iter().all(|(_, entry)| kind_fits(given, &model, entry));
        if let Err(error) = model.bind(&joints, &held) {
            self.complain_of(given, &bound, &error);
            return None;
        }
        if !kinds_fit {
            return None;
        }
        model.stand_at(self.base);
        let mut hints = Vec::new();
        let axes: Vec<_> = given
            .axes
            .iter()
            .enumerate()
            .map(|(index, entry)| {
                let joint = model.joints.iter_mut().find(|joint| joint.drive.axis() == Some(index));
                let Some(joint) = joint else { return entry.axis.clone() };
                let placeholder = joint.effort_limit == Some(PLACEHOLDER);
                let axis = self.settle(given, index, entry, joint);
                if placeholder && axis.effort_limit() == Some(PLACEHOLDER) {
                    hints.push(self.weak(&axis, joint));
                }
                axis
            })
            .collect();
        for (index, entry) in additional {
            let axis = &entry.axis;
            let joint = MachineJoint {
                velocity_limit: Some(axis.max_velocity),
                effort_limit: axis.effort_limit(),
                ..MachineJoint::new(axis.name.clone(), index, axis.position_limits)
            };
            let number = additional_axis::number(&entry.role).unwrap_or_default();
            model.add_additional_axis(&joint, axis.kind == AxisKind::Rotary, number);
        }
        self.masses.complete(&mut model, body)?;
        let flange = agree::flange(given, machine, &model);
        let tool = given.tool;
        model
            .mount_tool(&flange, &tool.tip, tool.mass)
            .map_err(|error| refuse(error.to_string()))
            .ok()?;
        mount(given.payload, given.tool, &mut model, &flange, [given.root, body])?;
        agree::check(&self, given, machine, &model, &flange)?;
        Some(Built { model, flange, axes, warnings, hints })
    }

    /// Warning about a motor with a very small effort limit in the URDF.
    fn weak(&self, axis: &Axis, joint: &Joint) -> String {
        let (name, unit) = (axis.kind.effort_name(), axis.kind.effort_unit());
        let (key, file) = (format!("max_{name}_{}", unit.to_lowercase()), self.path.display());
        format!(
            "axis {}: its motor gives 1 {unit} at most, as effort=\"1\" of joint {} in {file} says; is that a placeholder? `{key}` in \
             [axes.physics] says what it gives",
            axis.name, joint.name
        )
    }

    /// Positions of the joints that are held, m or rad.
    fn held_positions(&self, given: &Given<'_>, model: &Model) -> Option<Vec<(String, f64)>> {
        let held = given.body.section("held_joints");
        let mut positions = Vec::with_capacity(self.held.len());
        let mut complete = true;
        for (name, position) in &self.held {
            if let Some(joint) = model.joints.iter().find(|joint| joint.name == *name) {
                positions.push((name.clone(), position * axis_kind(joint).scale()));
            } else {
                complete = false;
                held.complain_at(name, format!("{} has no joint {name}", self.path.display()));
            }
        }
        complete.then_some(positions)
    }

    /// Says where in the machine file an axis and its joint do not belong together.
    fn complain_of(&self, given: &Given<'_>, bound: &[(usize, &AxisEntry)], error: &BindError) {
        let file = self.path.display();
        let message = format!("{file}: {error}");
        let joint = match error {
            BindError::Unmoved(_) => {
                let help = "let an axis move it (`joint` of [[axes]]), or hold it in \
                            [body.held_joints] (degrees or mm)";
                given.body.complain_with_help("urdf", message, Some(help.to_owned()));
                return;
            }
            BindError::NoJoint { joint, .. }
            | BindError::Fixed(joint)
            | BindError::Mimics(joint)
            | BindError::Twice(joint)
            | BindError::Beyond { joint, .. } => joint,
        };
        let is_held = matches!(error, BindError::Beyond { .. })
            || self.held.iter().any(|(name, _)| name == joint);
        // The one that came second.
        let entry = bound.iter().rev().find(|(_, entry)| joint_name(entry) == joint);
        match entry.filter(|_| !is_held) {
            Some((_, entry)) => given.root.complain_over(&entry.joint.span, message),
            None => given.body.section("held_joints").complain_at(joint, message),
        }
    }

    /// Completes axis and joint from each other; complains where the axis exceeds the limits of the joint.
    fn settle(
        &self,
        given: &Given<'_>,
        index: usize,
        entry: &AxisEntry,
        joint: &mut Joint,
    ) -> Axis {
        let sections = given.root.sections("axes");
        let mut axis = entry.axis.clone();
        let unit = axis.kind.unit();
        let file = self.path.display().to_string();
        let complain = |key: &str, message: String| {
            if let Some(section) = sections.get(index) {
                section.complain_at(key, message);
            }
        };
        let shown = |value: f64| rounded(entry.axis.from_si(value));
        if let Some(limits) = joint.usable_limits() {
            let [lower, upper] = limits.map(shown);
            let [min, max] = axis.position_limits.map(shown);
            let why = if joint.position_limits == Some(limits) {
                "<limit>"
            } else {
                "<safety_controller>"
            };
            let name = &joint.name;
            let ends = [
                ("min", min, lower, min < lower - SAME_LIMIT),
                ("max", max, upper, max > upper + SAME_LIMIT),
            ];
            for (end, found, limit, _) in
                ends.into_iter().filter(|(.., beyond)| axis.limited && *beyond)
            {
                complain(
                    &format!("position_{end}_{unit}"),
                    format!(
                        "axis \"{}\" goes to {found} {unit}; joint {name} of {file} ends at {limit} {unit} ({why})",
                        axis.name
                    ),
                );
            }
            if !axis.limited {
                complain(
                    "name",
                    format!(
                        "axis \"{}\" has no limits; joint {name} of {file} goes from {lower} to {upper} {unit} ({why})",
                        axis.name
                    ),
                );
            }
        }
        if let Some(limit) = joint.velocity_limit {
            let (velocity, limit) = (shown(axis.max_velocity), shown(limit));
            if velocity > limit * (1.0 + SAME_LIMIT) {
                complain(
                    &format!("max_velocity_{unit}_per_s"),
                    format!(
                        "axis \"{}\" makes {velocity} {unit}/s; joint {} of {file} makes {limit} {unit}/s (<limit>)",
                        axis.name, joint.name
                    ),
                );
            }
        }
        let physics = sections.get(index).map(|section| section.section("physics"));
        let silent = |keys: [&str; 2]| {
            physics.as_ref().is_none_or(|physics| !keys.iter().any(|key| physics.has(key)))
        };
        if silent(["coulomb_friction_nm", "coulomb_friction_n"]) {
            let friction = &mut axis.simulated.friction;
            friction.coulomb = joint.details.friction;
            friction.breakaway = friction.breakaway.max(friction.coulomb);
        }
        if silent(["viscous_friction_nm_s_per_rad", "viscous_friction_n_s_per_m"]) {
            axis.simulated.friction.viscous = joint.details.damping;
        }
        if silent(["max_torque_nm", "max_force_n"])
            && let Some(limit) = joint.effort_limit
        {
            axis.simulated.limit_effort(limit);
        }
        if axis.limited {
            joint.position_limits = Some(axis.position_limits);
        }
        joint.velocity_limit = Some(axis.max_velocity);
        joint.effort_limit = axis.effort_limit();
        axis
    }
}

/// N or Nm: what generators of URDFs write where nobody has said a limit.
const PLACEHOLDER: f64 = 1.0;

/// The name of the joint that an axis moves.
fn joint_name(entry: &AxisEntry) -> &str {
    entry.joint.name.as_deref().unwrap_or(&entry.axis.name)
}

/// True if an axis moves a joint of the URDF: all do but additional axes without a `joint` of that name.
fn is_in(model: &Model, entry: &AxisEntry) -> bool {
    let additional = EXTRA_AXES.iter().any(|letter| letter.to_string() == entry.role);
    let known = model.joints.iter().any(|joint| joint.name == joint_name(entry));
    !additional || entry.joint.given || known
}

/// Kind of an axis on this joint.
fn axis_kind(joint: &Joint) -> AxisKind {
    match joint.kind {
        JointKind::Revolute => AxisKind::Rotary,
        JointKind::Prismatic | JointKind::Fixed => AxisKind::Linear,
    }
}

/// True if axis and joint both turn or both slide; complains if not.
fn kind_fits(given: &Given<'_>, model: &Model, entry: &AxisEntry) -> bool {
    let name = joint_name(entry);
    let Some(joint) = model.joints.iter().find(|joint| joint.name == name) else { return true };
    let fits = joint.kind == JointKind::Fixed || axis_kind(joint) == entry.axis.kind;
    if !fits {
        let (is, moves) = match joint.kind {
            JointKind::Revolute => ("linear", "turns"),
            _ => ("rotary", "slides"),
        };
        let message = format!("axis \"{}\" is {is}; joint {name} {moves}", entry.axis.name);
        given.root.complain_over(&entry.joint.span, message);
    }
    fits
}
