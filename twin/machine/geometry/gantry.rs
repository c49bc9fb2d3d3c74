//! Gantries: straight axes, with a tool that turns, a tool beside the carriage, or two drives on one belt.

use super::design::{
    ANGLE_DEG, AtZero, DEG, DEVIATION_DEG, DEVIATION_MM, Design, Fit, FittedKey, Kind, MM, Mounted,
    OFFSET_MM, Sections, added, length, mass, numbers,
};
use super::rounded;
use crate::axis_kind::AxisKind::{Linear, Rotary};
use nalgebra::Vector3;
use std::ops::RangeInclusive;
use twin_kinematics::gantry::{
    BeltLayout, Gantry2, Gantry3, GantryCutter2, GantryCutter3, GantryH2, Sense, ToolBeside,
};
use twin_kinematics::{DimensionError, Kinematics};
use twin_urdf::{GantryDimensions, HBelt, Model, PlaneDrive, RotaryTool};

const PLANE: Kind = Kind {
    name: "gantry2",
    outputs: &[("X", Linear), ("Y", Linear)],
    moves_z: false,
    has_table: true,
    turns_tool: false,
    beyond_urdf: None,
    read: |sections| Some(read(sections, 2, Tool::Below)),
};
const SPACE: Kind = Kind {
    name: "gantry3",
    outputs: &[("X", Linear), ("Y", Linear), ("Z", Linear)],
    moves_z: true,
    read: |sections| Some(read(sections, 3, Tool::Below)),
    ..PLANE
};

pub(super) const KINDS: &[Kind] = &[
    PLANE,
    SPACE,
    Kind {
        name: "gantry_cutter2",
        outputs: &[("X", Linear), ("Y", Linear), ("R", Rotary)],
        turns_tool: true,
        read: |sections| Some(read(sections, 2, Tool::Turned)),
        ..PLANE
    },
    Kind {
        name: "gantry_cutter3",
        outputs: &[("X", Linear), ("Y", Linear), ("Z", Linear), ("R", Rotary)],
        turns_tool: true,
        read: |sections| Some(read(sections, 3, Tool::Turned)),
        ..SPACE
    },
    Kind { name: "gantry2_tool1", read: |sections| Some(read(sections, 2, Tool::Ahead)), ..PLANE },
    Kind {
        name: "gantry2_tool2",
        read: |sections| Some(read(sections, 2, Tool::AheadAndLeft)),
        ..PLANE
    },
    Kind { name: "gantry3_tool1", read: |sections| Some(read(sections, 3, Tool::Ahead)), ..SPACE },
    Kind {
        name: "gantry3_tool2",
        read: |sections| Some(read(sections, 3, Tool::AheadAndLeft)),
        ..SPACE
    },
    Kind {
        name: "gantry_h2",
        outputs: &[("A", Linear), ("B", Linear)],
        beyond_urdf: Some("two motors move each coordinate of an H gantry"),
        read: |sections| Some(read(sections, 2, Tool::OnBelt)),
        ..PLANE
    },
];

/// Place of the tool, and its drive.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Tool {
    Below,
    Turned,
    Ahead,
    AheadAndLeft,
    OnBelt,
}

#[derive(Clone, Debug)]
struct Gantry {
    offsets: [f64; 3],
    has_z: bool,
    /// Offset and sense of R.
    rotary: Option<(f64, Sense)>,
    beside: ToolBeside,
    belt: Option<BeltLayout>,
    /// Masses and sizes, as far as the file says.
    sizes: GantryDimensions,
    /// Of what R turns, kg.
    rotary_mass: Option<f64>,
}

fn read(sections: &Sections<'_>, count: usize, tool: Tool) -> Box<dyn Design> {
    let Sections { nominal, deviations, body } = sections;
    let offsets = numbers(nominal, "offsets_mm", OFFSET_MM, count).unwrap_or_default();
    let measured = numbers(deviations, "offsets_mm", DEVIATION_MM, count);
    let with_deviation = |key: &str, ranges: [RangeInclusive<f64>; 2]| {
        let [range, deviation] = ranges;
        nominal.number(key, range).unwrap_or_default()
            + deviations.number(key, deviation).unwrap_or_default()
    };
    let rotary = (tool == Tool::Turned).then(|| {
        let offset = with_deviation("offset_r_deg", [ANGLE_DEG, DEVIATION_DEG]) * DEG;
        let sense = nominal.choice(
            "sense_r",
            &[("counterclockwise", Sense::CounterClockwise), ("clockwise", Sense::Clockwise)],
        );
        (offset, sense.unwrap_or_default())
    });
    let beside = match tool {
        Tool::Ahead | Tool::AheadAndLeft => ToolBeside {
            angle: with_deviation("tool_angle_deg", [ANGLE_DEG, DEVIATION_DEG]) * DEG,
            ahead: with_deviation("tool_ahead_mm", [OFFSET_MM, DEVIATION_MM]) * MM,
            left: if tool == Tool::AheadAndLeft {
                with_deviation("tool_left_mm", [OFFSET_MM, DEVIATION_MM]) * MM
            } else {
                0.0
            },
        },
        _ => ToolBeside::default(),
    };
    let belt = (tool == Tool::OnBelt).then(|| {
        let layout = |coordinates_exchanged, drives_exchanged| BeltLayout {
            coordinates_exchanged,
            drives_exchanged,
        };
        let layouts = [
            ("standard", layout(false, false)),
            ("coordinates_exchanged", layout(true, false)),
            ("drives_exchanged", layout(false, true)),
            ("both_exchanged", layout(true, true)),
        ];
        nominal.choice("belt", &layouts).unwrap_or_default()
    });
    let sizes = body.map(|body| GantryDimensions {
        bridge_mass: mass(body, "bridge_mass_kg"),
        carriage_mass: mass(body, "carriage_mass_kg"),
        quill_mass: mass(body, "quill_mass_kg"),
        quill_length: length(body, "quill_length_mm"),
        quill_width: length(body, "quill_width_mm"),
        ..GantryDimensions::default()
    });
    let turned = body.filter(|_| tool == Tool::Turned);
    Box::new(Gantry {
        offsets: added(offsets, measured, MM),
        has_z: count == 3,
        rotary,
        beside,
        belt,
        sizes: sizes.unwrap_or_default(),
        rotary_mass: turned.and_then(|body| mass(body, "rotary_mass_kg")),
    })
}

impl Design for Gantry {
    fn transform(&self) -> Result<Box<dyn Kinematics>, DimensionError> {
        let ([x, y, z], beside) = (self.offsets, self.beside);
        Ok(match (self.rotary, self.belt, self.has_z) {
            (Some((r, sense)), _, true) => Box::new(GantryCutter3::new([x, y, z, r], sense)?),
            (Some((r, sense)), _, false) => Box::new(GantryCutter2::new([x, y, r], sense)?),
            (None, Some(layout), _) => Box::new(GantryH2::new([x, y], layout)?),
            (None, None, true) => Box::new(Gantry3::with_tool_offset([x, y, z], beside)?),
            (None, None, false) => Box::new(Gantry2::with_tool_offset([x, y], beside)?),
        })
    }

    fn model(&self, mounted: &Mounted<'_>) -> Option<Result<Model, twin_urdf::DimensionError>> {
        let Mounted { name, joint, tool } = mounted;
        let plane = match self.belt {
            Some(layout) => {
                let by_drives = layout.coordinates_by_drives();
                let factors = [[by_drives.m11, by_drives.m12], [by_drives.m21, by_drives.m22]];
                let motors = [joint("A")?, joint("B")?];
                PlaneDrive::HBelt(HBelt { factors, ..HBelt::new(motors) })
            }
            None => PlaneDrive::Axes([joint("X")?, joint("Y")?]),
        };
        let rotary = match self.rotary {
            Some((offset, sense)) => Some(RotaryTool {
                offset,
                clockwise: sense.sign() < 0.0,
                mass: self.rotary_mass,
                ..RotaryTool::new(joint("R")?)
            }),
            None => None,
        };
        let offset = self.beside.offset();
        let dimensions = GantryDimensions {
            name: (*name).to_owned(),
            plane,
            quill_joint: joint("Z"),
            offsets: self.offsets,
            rotary,
            tool: tool.tip + Vector3::new(offset.x, offset.y, 0.0),
            tool_mass: tool.mass,
            tool_radius: tool.radius(),
            ..self.sizes.clone()
        };
        Some(dimensions.model())
    }

    fn fit(&self, urdf: &AtZero<'_>) -> Option<Fit> {
        let flange = urdf.flange;
        let count = if self.has_z { 3 } else { 2 };
        let [x, y, z] = [flange.x, flange.y, flange.z].map(|value| rounded(0.0 - value * 1e3));
        let found = [x, y, if self.has_z { z } else { 0.0 }];
        let present = self.offsets.map(|offset| offset * 1e3);
        Some(Fit {
            keys: vec![FittedKey {
                key: "offsets_mm",
                fitting: found.get(..count)?.to_vec(),
                present: present.get(..count)?.to_vec(),
            }],
            shift: if self.has_z { Vector3::zeros() } else { -Vector3::z() * flange.z },
            design: Box::new(Self { offsets: found.map(|offset| offset * MM), ..self.clone() }),
        })
    }
}
