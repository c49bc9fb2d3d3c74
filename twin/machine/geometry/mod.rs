//! `[kinematics]` and `[body]`: the transform from axes to tool, and the links that move.
//!
//! The links come from dimensions (`design` and a file per family) or from a URDF (`urdf`).

mod design;
mod gantry;
mod scara;
mod sources;
mod tripod;
mod urdf;

use super::axis::{Axis, AxisEntry};
use super::direction::DirectionRule;
use super::tool::{Mount, Tool};
use crate::axis_kind::AxisKind;
use crate::section::Section;
use design::{FAMILIES, Kind, LENGTH_MM, Mounted, Sections};
use nalgebra::{Isometry3, Translation3};
use std::path::Path;
use twin_kinematics::MachineAxes;
use twin_path::EXTRA_AXES;
use twin_urdf::{Inertial, MachineJoint, Model, UrdfWarning};
pub(crate) use urdf::moving_links;
use urdf::{Given, Source};

/// Geometry from `[kinematics]`, `[body]`, `[tool]`, `[payload]` and the axes.
pub(super) struct Geometry {
    pub(super) kind: &'static str,
    pub(super) kinematics: MachineAxes,
    pub(super) direction: DirectionRule,
    /// Length that weighs as much as a radian in measures of singularity, m.
    pub(super) length_scale: f64,
    pub(super) model: Model,
    pub(super) mount: Mount,
    /// The axes, with what a URDF says of their friction.
    pub(super) axes: Vec<Axis>,
    pub(super) warnings: Vec<UrdfWarning>,
    pub(super) hints: Vec<String>,
}

/// The machine file.
#[derive(Clone, Copy)]
pub(super) struct File<'a> {
    pub(super) path: &'a Path,
    /// Of the machine.
    pub(super) name: &'a str,
}

/// Reads the sections. `axes` are `None` if any of them is wrong; the sections are read all the same.
pub(super) fn read(
    root: &Section<'_>,
    file: File<'_>,
    axes: Option<&[AxisEntry]>,
    tool: &Tool,
    payload: Option<&Inertial>,
) -> Option<Geometry> {
    let kinematics = root.section("kinematics");
    let body = root.section("body");
    if !root.has("kinematics") {
        root.complain("the file lacks [kinematics]");
        return None;
    }
    let kinds = FAMILIES.into_iter().flatten();
    let kinds: Vec<(&str, &'static Kind)> = kinds.map(|kind| (kind.name, kind)).collect();
    let Some(kind) = kinematics.required_choice("kind", &kinds) else {
        kinematics.accept_all();
        body.accept_all();
        return None;
    };
    kinematics.is_of_kind(kind.name);
    body.accept("urdf");
    let is_urdf = body.has("urdf");
    body.is_of_kind(if is_urdf { "urdf" } else { kind.name });
    let deviations = kinematics.section("deviations");
    let design = (kind.read)(&Sections {
        nominal: &kinematics,
        deviations: &deviations,
        body: (!is_urdf).then_some(&body),
    });
    deviations.finish();
    let direction = DirectionRule::read(&kinematics, kind.turns_tool, kind.name);
    let length_scale = kinematics.number("length_scale_mm", LENGTH_MM);
    let source = if is_urdf { Source::read(&body, file.path) } else { None };
    kinematics.check_unknown();
    body.check_unknown();

    let axes = axes?;
    if !is_urdf {
        for entry in axes.iter().filter(|entry| entry.joint.given) {
            let message = "joints are named of a URDF, and [body] has no `urdf`".to_owned();
            root.complain_over(&entry.joint.span, message);
        }
    }
    let sources = sources::sources(root, kind, axes)?;
    let design = design?;
    let transform = design.transform();
    let transform = transform.map_err(|error| kinematics.complain(error.to_string())).ok()?;
    let length_scale =
        length_scale.map_or_else(|| transform.characteristic_length(), |length| length * 1e-3);
    let periods: Vec<_> = axes.iter().map(|entry| entry.axis.period).collect();
    let machine_axes = MachineAxes::new(transform, sources.clone(), tool.tip)
        .and_then(|machine_axes| machine_axes.with_periods(&periods));
    let machine_axes = machine_axes.map_err(|error| kinematics.complain(error.to_string())).ok()?;
    let built = if is_urdf {
        let design = design.as_ref();
        let given = Given { root, body: &body, kind, design, axes, tool, payload, sources };
        source?.build(&given, &machine_axes)?
    } else {
        let build = |joint: &dyn Fn(&str) -> Option<MachineJoint>| {
            design.model(&Mounted { name: file.name, joint, tool })
        };
        let mut model = model(&kinematics, axes, build)?;
        // Frames of flanges are not turned in their links.
        let flange = Isometry3::from(Translation3::from(model.tip.point.coords - tool.tip));
        mount(payload, tool, &mut model, &flange, [root, &body])?;
        let axes = axes.iter().map(|entry| entry.axis.clone()).collect();
        Built { model, flange, axes, warnings: Vec::new(), hints: Vec::new() }
    };
    let Built { model, flange, axes, warnings, hints } = built;
    let mount = Mount {
        flange,
        tip: tool.tip,
        diameter: tool.shape.diameter,
        has_table: kind.has_table && !is_urdf,
    };
    let (kind, kinematics) = (kind.name, machine_axes);
    Some(Geometry {
        kind,
        kinematics,
        direction,
        length_scale,
        model,
        mount,
        axes,
        warnings,
        hints,
    })
}

/// Lets `model` carry `payload` at its `flange`, and gives its `tool` the shape it has.
fn mount(
    payload: Option<&Inertial>,
    tool: &Tool,
    model: &mut Model,
    flange: &Isometry3<f64>,
    [root, body]: [&Section<'_>; 2],
) -> Option<()> {
    // A tool without a length gives its diameter to those of the table that have none.
    let is_point = tool.tip.z >= 0.0;
    let has_use = model.shape_tool(flange, &tool.shape) || (is_point && tool.has_table);
    if !has_use {
        let message = if is_point {
            "the tool has a diameter and no length: add `length_mm`, the length from flange to tip, or a `tool_table` with lengths to [rs274]"
        } else {
            "[tool] has a diameter_mm, and this machine has no round tool"
        };
        root.section("tool").complain_at("diameter_mm", message);
    }
    let Some(payload) = payload else { return Some(()) };
    let mounted = model.mount_payload(flange, payload);
    mounted.map_err(|error| body.complain(error.to_string())).ok()
}

/// Links and axes of the machine.
struct Built {
    model: Model,
    /// Its place in the link where the tip is, m.
    flange: Isometry3<f64>,
    axes: Vec<Axis>,
    warnings: Vec<UrdfWarning>,
    hints: Vec<String>,
}

/// The links and joints that `build` makes, and those of additional axes.
fn model(
    kinematics: &Section<'_>,
    axes: &[AxisEntry],
    build: impl FnOnce(
        &dyn Fn(&str) -> Option<MachineJoint>,
    ) -> Option<Result<Model, twin_urdf::DimensionError>>,
) -> Option<Model> {
    let joints = |role: &str| {
        let (index, entry) = axes.iter().enumerate().find(|(_, entry)| entry.role == role)?;
        let axis = &entry.axis;
        let effort = axis.simulated.effort_limit;
        Some(MachineJoint {
            velocity_limit: Some(axis.max_velocity),
            effort_limit: effort.is_finite().then_some(effort),
            ..MachineJoint::new(axis.name.clone(), index, axis.position_limits)
        })
    };
    let model = build(&joints)?;
    let mut model = model.map_err(|error| kinematics.complain(error.to_string())).ok()?;
    for (number, letter) in (0..).zip(EXTRA_AXES) {
        let role = letter.to_string();
        let Some(joint) = joints(&role) else { continue };
        let turns =
            axes.iter().any(|entry| entry.role == role && entry.axis.kind == AxisKind::Rotary);
        model.add_additional_axis(&joint, turns, number);
    }
    Some(model)
}

/// Rounds to six decimals.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}
