//! Generator of machine models from dimensions.
//!
//! A generated machine is in the frame of its transform (`twin_kinematics`), and its joint positions are the machine's
//! axis positions or follow from them: zero offsets are inside the origins of the joints. Masses and inertias are those
//! of uniform bodies; the solids are boxes and cylinders that do not overlap, except where a real machine has a bore
//! that a box cannot have (the quill runs through its arm or carriage).

mod additional;
mod error;
mod gantry;
mod scara;
mod tool;
mod tripod;

pub use error::DimensionError;
pub use gantry::{GantryDimensions, HBelt, PlaneDrive, RotaryTool};
pub use scara::{ScaraDimensions, ScaraHand};
pub use tool::ToolShape;
pub use tripod::TripodDimensions;

use crate::{Joint, JointDrive, JointKind, Solid, SolidShape};
use nalgebra::{Isometry3, Unit, Vector3};

/// A joint of a generated machine: the axis that moves it, and its limits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MachineJoint {
    /// Name of the machine axis; becomes the name of the joint.
    pub name: String,
    /// Index of the machine axis, in the order of the machine file.
    pub machine_axis: usize,
    /// Lower and upper axis position, m or rad.
    pub position_limits: [f64; 2],
    /// m/s or rad/s.
    pub velocity_limit: Option<f64>,
    /// N or Nm.
    pub effort_limit: Option<f64>,
}

impl MachineJoint {
    /// A joint without limits of velocity and effort.
    pub fn new(name: impl Into<String>, machine_axis: usize, position_limits: [f64; 2]) -> Self {
        Self { name: name.into(), machine_axis, position_limits, ..Self::default() }
    }

    /// Drive of the joint, with its name and limits.
    fn driven(&self) -> Driven {
        Driven {
            name: self.name.clone(),
            drive: JointDrive::Axis(self.machine_axis),
            position_limits: Some(self.position_limits),
            velocity_limit: self.velocity_limit,
            effort_limit: self.effort_limit,
        }
    }

    /// Moves `child` on `parent`.
    fn joint(
        &self,
        kind: JointKind,
        axis: Unit<Vector3<f64>>,
        parent: usize,
        child: usize,
        origin: Isometry3<f64>,
    ) -> Joint {
        self.driven().joint(kind, axis, parent, child, origin)
    }
}

/// Driven joint before its place is known: name, drive and limits.
#[derive(Clone, Debug, Default)]
struct Driven {
    name: String,
    drive: JointDrive,
    position_limits: Option<[f64; 2]>,
    velocity_limit: Option<f64>,
    effort_limit: Option<f64>,
}

impl Driven {
    /// Without limits.
    fn new(name: impl Into<String>, drive: JointDrive) -> Self {
        Self { name: name.into(), drive, ..Self::default() }
    }

    /// Moves `child` on `parent`.
    fn joint(
        self,
        kind: JointKind,
        axis: Unit<Vector3<f64>>,
        parent: usize,
        child: usize,
        origin: Isometry3<f64>,
    ) -> Joint {
        let Self { name, drive, position_limits, velocity_limit, effort_limit } = self;
        Joint {
            position_limits,
            velocity_limit,
            effort_limit,
            ..Joint::new(name, kind, [parent, child], origin, axis, drive)
        }
    }
}

/// Holds `child` on `parent`.
fn fixed(name: &str, parent: usize, child: usize, origin: Isometry3<f64>) -> Joint {
    let driven = Driven::new(name, JointDrive::Fixed);
    driven.joint(JointKind::Fixed, Vector3::z_axis(), parent, child, origin)
}

/// Colours of generated machines: red, green, blue, alpha.
mod paint {
    /// Cast frame parts that stand still.
    pub(super) const GRAPHITE: [f64; 4] = [0.23, 0.25, 0.28, 1.0];
    /// Tables and feet.
    pub(super) const SLATE: [f64; 4] = [0.42, 0.45, 0.49, 1.0];
    /// The first moving part.
    pub(super) const IVORY: [f64; 4] = [0.91, 0.90, 0.87, 1.0];
    /// The second moving part.
    pub(super) const BLUE: [f64; 4] = [0.22, 0.42, 0.62, 1.0];
    /// Ground shafts and rails.
    pub(super) const STEEL: [f64; 4] = [0.70, 0.73, 0.76, 1.0];
    /// The tool, to be seen first.
    pub(super) const AMBER: [f64; 4] = [0.95, 0.61, 0.13, 1.0];
}

/// A box between two corners.
fn cuboid(low: [f64; 3], high: [f64; 3], color: [f64; 4]) -> Solid {
    let (low, high) = (Vector3::from(low), Vector3::from(high));
    Solid {
        shape: SolidShape::Box { size: high - low },
        origin: Isometry3::from((low + high) / 2.0),
        color,
    }
}

/// An upright cylinder about (`x`, `y`) between two heights.
fn upright(x: f64, y: f64, heights: [f64; 2], radius: f64, color: [f64; 4]) -> Solid {
    Solid {
        shape: SolidShape::Cylinder { radius, length: heights[1] - heights[0] },
        origin: Isometry3::translation(x, y, f64::midpoint(heights[0], heights[1])),
        color,
    }
}

/// `solid`, moved by `pose`.
fn placed(solid: Solid, pose: &Isometry3<f64>) -> Solid {
    Solid { origin: pose * solid.origin, ..solid }
}

fn check_positive(dimensions: &[(&'static str, f64)]) -> Result<(), DimensionError> {
    match dimensions.iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
        Some(&(what, value)) => Err(DimensionError::NotPositive { what, value }),
        None => Ok(()),
    }
}

fn check_not_negative(dimensions: &[(&'static str, f64)]) -> Result<(), DimensionError> {
    match dimensions.iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
        Some(&(what, value)) => Err(DimensionError::Negative { what, value }),
        None => Ok(()),
    }
}

fn check_joints<'a>(joints: impl Iterator<Item = &'a MachineJoint>) -> Result<(), DimensionError> {
    let mut earlier: Vec<&MachineJoint> = Vec::new();
    for joint in joints {
        let [lower, upper] = joint.position_limits;
        if !(lower.is_finite() && upper.is_finite() && lower < upper) {
            return Err(DimensionError::Limits { joint: joint.name.clone(), lower, upper });
        }
        let same = |other: &&&MachineJoint| {
            other.name == joint.name || other.machine_axis == joint.machine_axis
        };
        if let Some(other) = earlier.iter().find(same) {
            return Err(DimensionError::JointTwice([other.name.clone(), joint.name.clone()]));
        }
        earlier.push(joint);
    }
    Ok(())
}
