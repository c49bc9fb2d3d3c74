//! Kinds of machines: their axes, and the designs that families read from `[kinematics]` and `[body]`.
//!
//! A family is a file beside this one: its kinds, their keys, the transform and the links. [`FAMILIES`] lists them.

use super::{gantry, scara, tripod};
use crate::axis_kind::AxisKind;
use crate::section::Section;
use crate::tool::Tool;
use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;
use std::fmt::Debug;
use std::ops::RangeInclusive;
use twin_kinematics::{DimensionError, Kinematics};
use twin_urdf::{MachineJoint, Model};

/// Kinds by families, in the order of the manual.
pub(super) const FAMILIES: [&[Kind]; 3] = [gantry::KINDS, scara::KINDS, tripod::KINDS];

/// `kinematics.kind`.
#[derive(Debug)]
pub(super) struct Kind {
    /// In the file.
    pub(super) name: &'static str,
    /// Names of the transform's outputs, as the manual's blocks name them (dx, dy, dz, dr; da, db; dA, dB, dC).
    pub(super) outputs: &'static [(&'static str, AxisKind)],
    /// True if the transform determines Z.
    pub(super) moves_z: bool,
    /// True if its generated links have a table just below the lowest place of the tool.
    pub(super) has_table: bool,
    /// True if it can turn its tool about the vertical.
    pub(super) turns_tool: bool,
    /// Reason that no URDF can describe its links, if there is one.
    pub(super) beyond_urdf: Option<&'static str>,
    /// Reads the dimensions. Complains about what is wrong with them, and is `None` then.
    pub(super) read: fn(&Sections<'_>) -> Option<Box<dyn Design>>,
}

impl Kind {
    /// Roles of axes: outputs, and the coordinate that the transform leaves alone.
    pub(super) fn roles(&self) -> Vec<&'static str> {
        let outputs = self.outputs.iter().map(|(output, _)| *output);
        outputs.chain((!self.moves_z).then_some("Z")).collect()
    }
}

/// Sections of a machine file with the dimensions of a machine.
pub(super) struct Sections<'a> {
    /// `[kinematics]`.
    pub(super) nominal: &'a Section<'a>,
    /// `[kinematics.deviations]`: what was measured beyond the nominal dimensions.
    pub(super) deviations: &'a Section<'a>,
    /// `[body]`, unless a URDF describes the links.
    pub(super) body: Option<&'a Section<'a>>,
}

/// The dimensions of a machine with its deviations in them. SI.
pub(super) trait Design: Debug {
    /// The transform of the machine.
    fn transform(&self) -> Result<Box<dyn Kinematics>, DimensionError>;

    /// The machine as links and joints; `None` if an axis is missing, which is reported already.
    fn model(&self, mounted: &Mounted<'_>) -> Option<Result<Model, twin_urdf::DimensionError>>;

    /// The dimensions that the joints of a URDF have; `None` where a URDF lacks a joint, or describes no such machine.
    fn fit(&self, urdf: &AtZero<'_>) -> Option<Fit>;
}

/// Inputs of a model besides the design.
pub(super) struct Mounted<'a> {
    /// Of the machine.
    pub(super) name: &'a str,
    /// Joints by the roles of their axes.
    pub(super) joint: &'a dyn Fn(&str) -> Option<MachineJoint>,
    pub(super) tool: &'a Tool,
}

/// Places of joints and flange of a URDF with every axis at 0, m, machine frame.
pub(super) struct AtZero<'a> {
    /// Joints by the roles of their axes.
    pub(super) joint: &'a dyn Fn(&str) -> Option<Point3<f64>>,
    pub(super) flange: Point3<f64>,
}

/// Dimensions that fit a URDF.
pub(super) struct Fit {
    pub(super) design: Box<dyn Design>,
    /// Shift of the base, m.
    pub(super) shift: Vector3<f64>,
    pub(super) keys: Vec<FittedKey>,
}

/// A key of `[kinematics]` with the values that fit and those that it has, mm or degrees.
pub(super) struct FittedKey {
    pub(super) key: &'static str,
    pub(super) fitting: Vec<f64>,
    pub(super) present: Vec<f64>,
}

/// Lengths in mm that a machine on earth has.
pub(super) const LENGTH_MM: RangeInclusive<f64> = 1.0..=100_000.0;
/// Offsets of axes, mm.
pub(super) const OFFSET_MM: RangeInclusive<f64> = -1e5..=1e5;
/// Angles, degrees.
pub(super) const ANGLE_DEG: RangeInclusive<f64> = -360.0..=360.0;
/// Largest deviation of a measured length from its nominal value, mm: more is another machine.
pub(super) const DEVIATION_MM: RangeInclusive<f64> = -20.0..=20.0;
/// Largest deviation of a measured angle from its nominal value, degrees.
pub(super) const DEVIATION_DEG: RangeInclusive<f64> = -10.0..=10.0;
/// Masses in kg.
const MASS_KG: RangeInclusive<f64> = 1e-3..=100_000.0;

/// One mm, m.
pub(super) const MM: f64 = 1e-3;
/// One degree, rad.
pub(super) const DEG: f64 = PI / 180.0;

/// Two or three numbers, as the kind has; what is not there is 0.
pub(super) fn numbers(
    section: &Section<'_>,
    key: &str,
    range: RangeInclusive<f64>,
    count: usize,
) -> Option<[f64; 3]> {
    if count == 2 {
        section.numbers::<2>(key, range).map(|[first, second]| [first, second, 0.0])
    } else {
        section.numbers::<3>(key, range)
    }
}

/// Nominal values and what was measured beyond them.
pub(super) fn added<const N: usize>(
    nominal: [f64; N],
    deviation: Option<[f64; N]>,
    unit: f64,
) -> [f64; N] {
    let mut deviation = deviation.unwrap_or([0.0; N]).into_iter();
    nominal.map(|value| (value + deviation.next().unwrap_or_default()) * unit)
}

/// A mass of `[body]`, kg.
pub(super) fn mass(body: &Section<'_>, key: &str) -> Option<f64> {
    body.number(key, MASS_KG)
}

/// Masses of `[body]`, kg.
pub(super) fn masses<const N: usize>(body: &Section<'_>, key: &str) -> Option<[f64; N]> {
    body.numbers(key, MASS_KG)
}

/// A length of `[body]`, m.
pub(super) fn length(body: &Section<'_>, key: &str) -> Option<f64> {
    body.number(key, LENGTH_MM).map(|length| length * MM)
}
