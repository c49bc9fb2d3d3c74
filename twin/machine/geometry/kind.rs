//! Kinematic kinds of machines, and the names of their axes.

use crate::axis_kind::AxisKind;

/// Families of kinds in a machine file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// Straight axes.
    Gantry,
    /// Straight axes and one that turns the tool.
    Cutter,
    /// Straight axes with a tool offset by a number of legs.
    BesideTool(u8),
    /// Two drives on one belt.
    HBelt,
    /// Arms that turn about vertical axes.
    Scara,
    /// Carriages on vertical rails, with rods to a platform.
    Tripod,
}

/// `kinematics.kind`.
#[derive(Debug)]
pub(super) struct Kind {
    /// In the file.
    pub(super) name: &'static str,
    pub(super) family: Family,
    /// Names of the transform's outputs, as the manual's blocks name them (dx, dy, dz, dr; da, db; dA, dB, dC).
    pub(super) outputs: &'static [(&'static str, AxisKind)],
    /// True if the transform determines Z.
    pub(super) moves_z: bool,
}

const X: (&str, AxisKind) = ("X", AxisKind::Linear);
const Y: (&str, AxisKind) = ("Y", AxisKind::Linear);
const Z: (&str, AxisKind) = ("Z", AxisKind::Linear);
const R: (&str, AxisKind) = ("R", AxisKind::Rotary);
const A: &str = "A";
const B: &str = "B";
const C: &str = "C";

const fn kind(
    name: &'static str,
    family: Family,
    outputs: &'static [(&'static str, AxisKind)],
    moves_z: bool,
) -> Kind {
    Kind { name, family, outputs, moves_z }
}

/// All kinds, in the order of the manual.
pub(super) static KINDS: [Kind; 12] = [
    kind("gantry2", Family::Gantry, &[X, Y], false),
    kind("gantry3", Family::Gantry, &[X, Y, Z], true),
    kind("gantry_cutter2", Family::Cutter, &[X, Y, R], false),
    kind("gantry_cutter3", Family::Cutter, &[X, Y, Z, R], true),
    kind("gantry2_tool1", Family::BesideTool(1), &[X, Y], false),
    kind("gantry2_tool2", Family::BesideTool(2), &[X, Y], false),
    kind("gantry3_tool1", Family::BesideTool(1), &[X, Y, Z], true),
    kind("gantry3_tool2", Family::BesideTool(2), &[X, Y, Z], true),
    kind("gantry_h2", Family::HBelt, &[(A, AxisKind::Linear), (B, AxisKind::Linear)], false),
    kind("scara2", Family::Scara, &[(A, AxisKind::Rotary), (B, AxisKind::Rotary)], false),
    kind(
        "scara3",
        Family::Scara,
        &[(A, AxisKind::Rotary), (B, AxisKind::Rotary), (C, AxisKind::Rotary)],
        false,
    ),
    kind(
        "tripod",
        Family::Tripod,
        &[(A, AxisKind::Linear), (B, AxisKind::Linear), (C, AxisKind::Linear)],
        true,
    ),
];

impl Kind {
    /// Roles of axes: outputs, and the coordinate that the transform leaves alone.
    pub(super) fn roles(&self) -> Vec<&'static str> {
        let outputs = self.outputs.iter().map(|(output, _)| *output);
        outputs.chain((!self.moves_z).then_some("Z")).collect()
    }

    /// True if it can turn its tool about the vertical.
    pub(super) fn turns_tool(&self) -> bool {
        self.family == Family::Cutter || (self.family == Family::Scara && self.outputs.len() == 3)
    }
}
