//! `[body]`: moving links and joints of the machine, built from dimensions.

use super::design::{Design, LENGTH_MM};
use super::kind::{Family, Kind};
use crate::section::Section;
use crate::tool::Tool;
use nalgebra::Vector3;
use std::ops::RangeInclusive;
use twin_urdf::{
    DimensionError, GantryDimensions, HBelt, MachineJoint, Model, RotaryTool, ScaraDimensions,
    ScaraHand, TripodDimensions,
};

/// Masses in kg.
const MASS_KG: RangeInclusive<f64> = 1e-3..=100_000.0;

/// Masses and sizes, as far as the file says.
pub(super) enum Body {
    Gantry {
        bridge_mass: Option<f64>,
        carriage_mass: Option<f64>,
        quill_mass: Option<f64>,
        quill_length: Option<f64>,
        quill_width: Option<f64>,
        rotary_mass: Option<f64>,
    },
    Scara {
        arm_masses: Option<[f64; 2]>,
        arm_sections: Option<[[f64; 2]; 2]>,
        hand_mass: Option<f64>,
        quill_mass: Option<f64>,
        quill_length: Option<f64>,
        column_height: Option<f64>,
    },
    Tripod {
        carriage_mass: Option<f64>,
        rod_mass: Option<f64>,
        rod_radius: Option<f64>,
        platform_mass: Option<f64>,
    },
}

impl Body {
    pub(super) fn read(section: &Section<'_>, kind: &Kind) -> Self {
        let mass = |key: &str| section.number(key, MASS_KG);
        let length = |key: &str| section.number(key, LENGTH_MM).map(|length| length * 1e-3);
        match kind.family {
            Family::Scara => {
                let widths = section.numbers::<2>("arm_widths_mm", LENGTH_MM);
                let heights = section.numbers::<2>("arm_heights_mm", LENGTH_MM);
                if widths.is_some() != heights.is_some() {
                    section.complain(
                        "`arm_widths_mm` and `arm_heights_mm` are given together or not at all"
                            .to_owned(),
                    );
                }
                let arm_sections = widths
                    .zip(heights)
                    .map(|([w1, w2], [h1, h2])| [[w1 * 1e-3, h1 * 1e-3], [w2 * 1e-3, h2 * 1e-3]]);
                Self::Scara {
                    arm_masses: section.numbers::<2>("arm_masses_kg", MASS_KG),
                    arm_sections,
                    hand_mass: if kind.turns_tool() { mass("hand_mass_kg") } else { None },
                    quill_mass: mass("quill_mass_kg"),
                    quill_length: length("quill_length_mm"),
                    column_height: length("column_height_mm"),
                }
            }
            Family::Tripod => Self::Tripod {
                carriage_mass: mass("carriage_mass_kg"),
                rod_mass: mass("rod_mass_kg"),
                rod_radius: section
                    .number("rod_diameter_mm", LENGTH_MM)
                    .map(|diameter| diameter * 0.5e-3),
                platform_mass: mass("platform_mass_kg"),
            },
            Family::Gantry | Family::Cutter | Family::BesideTool(_) | Family::HBelt => {
                Self::Gantry {
                    bridge_mass: mass("bridge_mass_kg"),
                    carriage_mass: mass("carriage_mass_kg"),
                    quill_mass: mass("quill_mass_kg"),
                    quill_length: length("quill_length_mm"),
                    quill_width: length("quill_width_mm"),
                    rotary_mass: if kind.turns_tool() { mass("rotary_mass_kg") } else { None },
                }
            }
        }
    }

    /// The machine as links and joints; `None` if an axis is missing (that has been said already).
    pub(super) fn model(
        self,
        design: &Design,
        name: &str,
        joint: &dyn Fn(&str) -> Option<MachineJoint>,
        tool: &Tool,
    ) -> Option<Result<Model, DimensionError>> {
        match (self, design) {
            (body @ Self::Gantry { .. }, Design::Gantry { .. }) => {
                body.gantry(design, name, joint, tool)
            }
            (
                Self::Scara {
                    arm_masses,
                    arm_sections,
                    hand_mass,
                    quill_mass,
                    quill_length,
                    column_height,
                },
                Design::Scara { arms, offsets, has_hand, .. },
            ) => {
                let [first, second, third] = *arms;
                let hand = if *has_hand {
                    Some(ScaraHand {
                        offset: offsets[2],
                        mass: hand_mass,
                        ..ScaraHand::new(joint("C")?, third)
                    })
                } else {
                    None
                };
                let dimensions = ScaraDimensions {
                    offsets: [offsets[0], offsets[1]],
                    hand,
                    arm_sections,
                    arm_masses,
                    column_height,
                    quill_length,
                    quill_mass,
                    tool: tool.tip,
                    tool_mass: tool.mass,
                    tool_radius: tool.radius(),
                    ..ScaraDimensions::new(
                        name,
                        [joint("A")?, joint("B")?],
                        joint("Z"),
                        [first, second],
                    )
                };
                Some(dimensions.model())
            }
            (
                Self::Tripod { carriage_mass, rod_mass, rod_radius, platform_mass },
                Design::Tripod { dimensions, deviations, offsets },
            ) => {
                // A tripod whose rods do not fit has been refused as a transform.
                let rods = dimensions.rods(deviations).ok()?;
                let joints = [joint("A")?, joint("B")?, joint("C")?];
                let dimensions = TripodDimensions {
                    offsets: *offsets,
                    carriage_mass,
                    rod_radius,
                    rod_mass,
                    platform_mass,
                    tool: tool.tip,
                    tool_mass: tool.mass,
                    tool_radius: tool.radius(),
                    ..TripodDimensions::new(name, joints, rods)
                };
                Some(dimensions.model())
            }
            // Both come from one kind.
            _ => None,
        }
    }

    fn gantry(
        self,
        design: &Design,
        name: &str,
        joint: &dyn Fn(&str) -> Option<MachineJoint>,
        tool: &Tool,
    ) -> Option<Result<Model, DimensionError>> {
        let (
            Self::Gantry {
                bridge_mass,
                carriage_mass,
                quill_mass,
                quill_length,
                quill_width,
                rotary_mass,
            },
            Design::Gantry { offsets, rotary, beside, belt, .. },
        ) = (self, design)
        else {
            return None;
        };
        let bare = match belt {
            Some(layout) => {
                let by_drives = layout.coordinates_by_drives();
                let factors = [[by_drives.m11, by_drives.m12], [by_drives.m21, by_drives.m22]];
                let belt = HBelt { factors, ..HBelt::new([joint("A")?, joint("B")?]) };
                GantryDimensions::h_belt(name, belt, joint("Z"))
            }
            None => GantryDimensions::new(name, [joint("X")?, joint("Y")?], joint("Z")),
        };
        let rotary = match rotary {
            Some((offset, sense)) => Some(RotaryTool {
                offset: *offset,
                clockwise: sense.sign() < 0.0,
                mass: rotary_mass,
                ..RotaryTool::new(joint("R")?)
            }),
            None => None,
        };
        let offset = beside.map(|beside| beside.offset()).unwrap_or_default();
        let dimensions = GantryDimensions {
            offsets: *offsets,
            rotary,
            bridge_mass,
            carriage_mass,
            quill_mass,
            quill_length,
            quill_width,
            tool: tool.tip + Vector3::new(offset.x, offset.y, 0.0),
            tool_mass: tool.mass,
            tool_radius: tool.radius(),
            ..bare
        };
        Some(dimensions.model())
    }
}
