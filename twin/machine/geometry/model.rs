//! `[body]`: moving links and joints of the machine, built from dimensions.

use super::design::{Design, LENGTH_MM};
use super::kind::{Family, Kind};
use crate::section::Section;
use crate::tool::Tool;
use nalgebra::Vector3;
use std::ops::RangeInclusive;
use twin_urdf::{
    DimensionError, GantryDimensions, HBelt, MachineJoint, Model, PlaneDrive, RotaryTool,
    ScaraDimensions, ScaraHand, TripodDimensions,
};

/// Masses in kg.
const MASS_KG: RangeInclusive<f64> = 1e-3..=100_000.0;

/// Masses and sizes, as far as the file says; joints, lengths and offsets come with the design.
pub(super) enum Body {
    /// With the mass of what R turns.
    Gantry(Box<GantryDimensions>, Option<f64>),
    /// With the mass of the hand.
    Scara(Box<ScaraDimensions>, Option<f64>),
    Tripod(Box<TripodDimensions>),
}

impl Body {
    pub(super) fn read(section: &Section<'_>, kind: &Kind) -> Self {
        let mass = |key: &str| section.number(key, MASS_KG);
        let length = |key: &str| section.number(key, LENGTH_MM).map(|length| length * 1e-3);
        let turning_mass = |key: &str| if kind.turns_tool() { mass(key) } else { None };
        match kind.family {
            Family::Scara => {
                let widths = section.numbers::<2>("arm_widths_mm", LENGTH_MM);
                let heights = section.numbers::<2>("arm_heights_mm", LENGTH_MM);
                if widths.is_some() != heights.is_some() {
                    section.complain(
                        "`arm_widths_mm` and `arm_heights_mm` are given together or not at all",
                    );
                }
                let arm_sections = widths
                    .zip(heights)
                    .map(|([w1, w2], [h1, h2])| [[w1 * 1e-3, h1 * 1e-3], [w2 * 1e-3, h2 * 1e-3]]);
                let sizes = ScaraDimensions {
                    arm_masses: section.numbers::<2>("arm_masses_kg", MASS_KG),
                    arm_sections,
                    quill_mass: mass("quill_mass_kg"),
                    quill_length: length("quill_length_mm"),
                    column_height: length("column_height_mm"),
                    ..ScaraDimensions::default()
                };
                Self::Scara(Box::new(sizes), turning_mass("hand_mass_kg"))
            }
            Family::Tripod => Self::Tripod(Box::new(TripodDimensions {
                carriage_mass: mass("carriage_mass_kg"),
                rod_mass: mass("rod_mass_kg"),
                rod_radius: section
                    .number("rod_diameter_mm", LENGTH_MM)
                    .map(|diameter| diameter * 0.5e-3),
                platform_mass: mass("platform_mass_kg"),
                ..TripodDimensions::default()
            })),
            Family::Gantry | Family::Cutter | Family::BesideTool(_) | Family::HBelt => {
                let sizes = GantryDimensions {
                    bridge_mass: mass("bridge_mass_kg"),
                    carriage_mass: mass("carriage_mass_kg"),
                    quill_mass: mass("quill_mass_kg"),
                    quill_length: length("quill_length_mm"),
                    quill_width: length("quill_width_mm"),
                    ..GantryDimensions::default()
                };
                Self::Gantry(Box::new(sizes), turning_mass("rotary_mass_kg"))
            }
        }
    }

    /// The machine as links and joints; `None` if an axis is missing, which is reported already.
    pub(super) fn model(
        self,
        design: &Design,
        name: &str,
        joint: &dyn Fn(&str) -> Option<MachineJoint>,
        tool: &Tool,
    ) -> Option<Result<Model, DimensionError>> {
        let name = name.to_owned();
        let (tool_mass, tool_radius) = (tool.mass, tool.radius());
        match (self, design) {
            (
                Self::Gantry(sizes, rotary_mass),
                Design::Gantry { offsets, rotary, beside, belt, .. },
            ) => {
                let plane = match belt {
                    Some(layout) => {
                        let by_drives = layout.coordinates_by_drives();
                        let factors =
                            [[by_drives.m11, by_drives.m12], [by_drives.m21, by_drives.m22]];
                        let motors = [joint("A")?, joint("B")?];
                        PlaneDrive::HBelt(HBelt { factors, ..HBelt::new(motors) })
                    }
                    None => PlaneDrive::Axes([joint("X")?, joint("Y")?]),
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
                let offset = beside.offset();
                let dimensions = GantryDimensions {
                    name,
                    plane,
                    quill_joint: joint("Z"),
                    offsets: *offsets,
                    rotary,
                    tool: tool.tip + Vector3::new(offset.x, offset.y, 0.0),
                    tool_mass,
                    tool_radius,
                    ..*sizes
                };
                Some(dimensions.model())
            }
            (Self::Scara(sizes, hand_mass), Design::Scara { arms, offsets, has_hand, .. }) => {
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
                    name,
                    arm_joints: [joint("A")?, joint("B")?],
                    quill_joint: joint("Z"),
                    arms: [first, second],
                    offsets: [offsets[0], offsets[1]],
                    hand,
                    tool: tool.tip,
                    tool_mass,
                    tool_radius,
                    ..*sizes
                };
                Some(dimensions.model())
            }
            (Self::Tripod(sizes), Design::Tripod { dimensions, deviations, offsets }) => {
                let dimensions = TripodDimensions {
                    name,
                    joints: [joint("A")?, joint("B")?, joint("C")?],
                    // A tripod whose rods do not fit has been refused as a transform.
                    rods: dimensions.rods(deviations).ok()?,
                    offsets: *offsets,
                    tool: tool.tip,
                    tool_mass,
                    tool_radius,
                    ..*sizes
                };
                Some(dimensions.model())
            }
            // Both come from one kind.
            _ => None,
        }
    }
}
