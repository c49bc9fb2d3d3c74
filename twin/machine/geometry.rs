//! `[kinematics]` and `[body]`: how the axes move the tool, and what moves with them.

use super::axis::{AxisEntry, AxisKind};
use super::section::Section;
use nalgebra::Vector3;
use std::f64::consts::PI;
use twin_kinematics::gantry::Gantry3;
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::{AxisSource, Coordinate, Kinematics, MachineAxes};
use twin_motion::path::EXTRA_AXES;
use twin_urdf::{DimensionError, GantryDimensions, MachineJoint, Model, ScaraDimensions};

/// Lengths in mm that a machine on earth has.
const LENGTH_MM: std::ops::RangeInclusive<f64> = 1.0..=100_000.0;
/// Masses in kg.
const MASS_KG: std::ops::RangeInclusive<f64> = 1e-3..=100_000.0;

/// What follows from `[kinematics]`, `[body]`, `[tool]` and the axes.
pub(super) struct Geometry {
    pub(super) kind: &'static str,
    pub(super) kinematics: MachineAxes,
    pub(super) model: Model,
}

#[derive(Clone, Copy)]
enum Kind {
    Scara2,
    Gantry3,
}

impl Kind {
    const fn name(self) -> &'static str {
        match self {
            Self::Scara2 => "scara2",
            Self::Gantry3 => "gantry3",
        }
    }

    /// What axes may move: outputs and the coordinates that the transform leaves alone.
    fn roles(self) -> Vec<&'static str> {
        let outputs = self.outputs().iter().map(|(output, _)| *output);
        let free: &[_] = match self {
            Self::Scara2 => &["Z"],
            Self::Gantry3 => &[],
        };
        outputs.chain(free.iter().copied()).collect()
    }

    /// Names of the transform's outputs, as the manual's blocks name them (dA, dB; dx, dy, dz).
    const fn outputs(self) -> &'static [(&'static str, AxisKind)] {
        match self {
            Self::Scara2 => &[("A", AxisKind::Rotary), ("B", AxisKind::Rotary)],
            Self::Gantry3 => {
                &[("X", AxisKind::Linear), ("Y", AxisKind::Linear), ("Z", AxisKind::Linear)]
            }
        }
    }
}

/// `[tool]`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tool {
    /// Flange to tip, m.
    pub(super) length: f64,
    /// kg.
    pub(super) mass: f64,
}

/// Reads the sections. `axes` are `None` if any of them is wrong; the sections are read all the same.
pub(super) fn read(
    root: &Section<'_>,
    name: &str,
    axes: Option<&[AxisEntry]>,
    tool: Tool,
) -> Option<Geometry> {
    let kinematics = root.section("kinematics");
    let body = root.section("body");
    if !root.has("kinematics") {
        root.complain("the file lacks [kinematics]".to_owned());
        return None;
    }
    let kind =
        kinematics.required_choice("kind", &[("scara2", Kind::Scara2), ("gantry3", Kind::Gantry3)]);
    let Some(kind) = kind else {
        kinematics.accept_all();
        body.accept_all();
        return None;
    };
    let geometry = match kind {
        Kind::Scara2 => scara(&kinematics, &body),
        Kind::Gantry3 => gantry(&kinematics, &body),
    };
    kinematics.check_unknown();
    body.finish();

    let axes = axes?;
    let sources = sources(root, kind, axes)?;
    let (transform, build) = geometry?;
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
    let model = build(name, &joints, tool)?;
    let mut model = model.map_err(|error| kinematics.complain(error.to_string())).ok()?;
    for (number, letter) in (0..).zip(EXTRA_AXES) {
        let role = letter.to_string();
        let Some(joint) = joints(&role) else { continue };
        let turns =
            axes.iter().any(|entry| entry.role == role && entry.axis.kind == AxisKind::Rotary);
        model.add_additional_axis(&joint, turns, number);
    }
    let machine_axes =
        MachineAxes::new(transform, sources, nalgebra::Vector3::new(0.0, 0.0, -tool.length));
    let kinematics = machine_axes.map_err(|error| kinematics.complain(error.to_string())).ok()?;
    Some(Geometry { kind: kind.name(), kinematics, model })
}

/// Builds the model of a machine once its axes are known; `None` if an axis is missing (that has been said already).
type Build<'a> = Box<
    dyn FnOnce(
            &str,
            &dyn Fn(&str) -> Option<MachineJoint>,
            Tool,
        ) -> Option<Result<Model, DimensionError>>
        + 'a,
>;

fn scara<'a>(
    kinematics: &Section<'_>,
    body: &Section<'_>,
) -> Option<(Box<dyn Kinematics>, Build<'a>)> {
    let arms = kinematics.required_numbers::<2>("arm_lengths_mm", LENGTH_MM);
    let offsets = kinematics.numbers::<2>("offsets_deg", -360.0..=360.0).unwrap_or_default();
    let elbow = kinematics
        .choice("elbow", &[("low", Elbow::Low), ("high", Elbow::High)])
        .unwrap_or(Elbow::Low);
    let masses = body.numbers::<2>("arm_masses_kg", MASS_KG);
    let widths = body.numbers::<2>("arm_widths_mm", LENGTH_MM);
    let heights = body.numbers::<2>("arm_heights_mm", LENGTH_MM);
    let quill_mass = body.number("quill_mass_kg", MASS_KG);
    let quill_length = body.number("quill_length_mm", LENGTH_MM);
    let column_height = body.number("column_height_mm", LENGTH_MM);
    if widths.is_some() != heights.is_some() {
        body.complain(
            "`arm_widths_mm` and `arm_heights_mm` are given together or not at all".to_owned(),
        );
    }
    let arms = arms?.map(|arm| arm * 1e-3);
    let offsets = offsets.map(|offset| offset * PI / 180.0);
    let transform = Scara2::new(arms, offsets, elbow);
    let transform = transform.map_err(|error| kinematics.complain(error.to_string())).ok()?;
    let build: Build<'a> = Box::new(move |name, joint, tool| {
        let sections = widths
            .zip(heights)
            .map(|([w1, w2], [h1, h2])| [[w1 * 1e-3, h1 * 1e-3], [w2 * 1e-3, h2 * 1e-3]]);
        let dimensions = ScaraDimensions {
            offsets,
            arm_sections: sections,
            arm_masses: masses,
            column_height: column_height.map(|height| height * 1e-3),
            quill_length: quill_length.map(|length| length * 1e-3),
            quill_mass,
            tool: Vector3::new(0.0, 0.0, -tool.length),
            tool_mass: tool.mass,
            ..ScaraDimensions::new(name, [joint("A")?, joint("B")?], joint("Z"), arms)
        };
        Some(dimensions.model())
    });
    Some((Box::new(transform), build))
}

fn gantry<'a>(
    kinematics: &Section<'_>,
    body: &Section<'_>,
) -> Option<(Box<dyn Kinematics>, Build<'a>)> {
    let offsets = kinematics.numbers::<3>("offsets_mm", -1e5..=1e5).unwrap_or_default();
    let bridge_mass = body.number("bridge_mass_kg", MASS_KG);
    let carriage_mass = body.number("carriage_mass_kg", MASS_KG);
    let quill_mass = body.number("quill_mass_kg", MASS_KG);
    let quill_length = body.number("quill_length_mm", LENGTH_MM);
    let quill_width = body.number("quill_width_mm", LENGTH_MM);
    let offsets = offsets.map(|offset| offset * 1e-3);
    let build: Build<'a> = Box::new(move |name, joint, tool| {
        let dimensions = GantryDimensions {
            offsets,
            bridge_mass,
            carriage_mass,
            quill_mass,
            quill_length: quill_length.map(|length| length * 1e-3),
            quill_width: quill_width.map(|width| width * 1e-3),
            tool: Vector3::new(0.0, 0.0, -tool.length),
            tool_mass: tool.mass,
            ..GantryDimensions::new(name, [joint("X")?, joint("Y")?], Some(joint("Z")?))
        };
        Some(dimensions.model())
    });
    Gantry3::new(offsets).ok().map(|gantry| (Box::new(gantry) as Box<dyn Kinematics>, build))
}

/// The number of an additional axis.
fn additional(role: &str) -> Option<u8> {
    (0..).zip(EXTRA_AXES).find(|(_, letter)| letter.to_string() == role).map(|(number, _)| number)
}

/// What moves each axis; complains where that is not one to one.
fn sources(root: &Section<'_>, kind: Kind, axes: &[AxisEntry]) -> Option<Vec<AxisSource>> {
    let mut complete = true;
    let outputs = kind.outputs();
    let mut sources = Vec::new();
    for (index, entry) in axes.iter().enumerate() {
        let (name, role) = (&entry.axis.name, &entry.role);
        let complain = |message| root.complain_over(&entry.role_span, message);
        let output = outputs.iter().position(|(output, _)| output == role);
        let coordinate =
            Coordinate::TRANSLATIONS.into_iter().find(|coordinate| coordinate.to_string() == *role);
        let used =
            matches!((kind, coordinate), (Kind::Scara2, Some(Coordinate::X | Coordinate::Y)));
        let expected = match (output, coordinate) {
            (Some(output), _) => {
                sources.push(AxisSource::Transform(output));
                outputs.get(output).map(|(_, kind)| *kind)
            }
            _ if let Some(number) = additional(role) => {
                sources.push(AxisSource::Additional(number));
                // In degrees or mm, as the machine has it.
                None
            }
            (None, Some(coordinate)) if !used => {
                sources.push(AxisSource::Coordinate(coordinate));
                Some(AxisKind::Linear)
            }
            _ => {
                complete = false;
                complain(format!(
                    "axis \"{name}\" has the role \"{role}\"; of a {} axes move {}, or P Q U V W beside it",
                    kind.name(),
                    kind.roles().join(", ")
                ));
                continue;
            }
        };
        if let Some(expected) = expected.filter(|expected| *expected != entry.axis.kind) {
            let (is, should) = (format!("{:?}", entry.axis.kind), format!("{expected:?}"));
            let (is, should) = (is.to_lowercase(), should.to_lowercase());
            complete = false;
            complain(format!(
                "axis \"{name}\" is {is}; what moves {role} of a {} is {should}",
                kind.name()
            ));
        }
        if axes.iter().take(index).any(|other| other.role == *role) {
            complete = false;
            complain(format!(
                "axis \"{name}\" has the role \"{role}\", which another axis has already"
            ));
        }
    }
    for (output, _) in outputs {
        if !axes.iter().any(|entry| entry.role == *output) {
            complete = false;
            root.complain_at("axes", format!("no axis moves {output} of the {}", kind.name()));
        }
    }
    complete.then_some(sources)
}
