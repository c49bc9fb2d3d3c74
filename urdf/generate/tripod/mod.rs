//! Generated tripods: three carriages that slide up and down, six rods, and a level platform.
//!
//! ```text
//!      seen from the side                     seen from above
//!
//!   ║┌┐                     ┌┐║                    A
//!   ║│● carriage            ●│║                   ┌─┐
//!   ║└┘\                   /└┘║                   ● ●
//!   ║   \ rods            /   ║                   │ │
//!   ║    \               /    ║                   ●─●
//!   ║     ●──platform───●     ║                  ●   ●
//!   ║           ┃             ║               ● ╱ ●─● ╲ ●
//!   ║           ▼ tool        ║              B ●       ● C
//! ──╨─────────────────────────╨──
//! ```
//!
//! The machine frame is that of the manual (8.2.6, `SMC_TRAFO_Tripod`): z is the axis of the machine, up, and the position
//! of an axis is the height of its rods' upper ends above the origin, plus its offset. The platform hangs below the
//! carriages; the tool tip is given from its reference point, in the middle of its rod ends.
//!
//! The links make five loops: rod 1 carries the platform, by three joints that make a ball, and
//! [`Model::loops`](crate::Model) hold it to the lower ends of the others. A rod hangs on its carriage by two joints;
//! its rotation about itself is left out. If the two rods of each carriage are parallel, the platform cannot tilt; with
//! measured rods it tilts as they require.

mod linkage;
mod solids;

use super::tool::Tool;
use super::{MachineJoint, check_joints, check_positive};
use crate::{DimensionError, JointDrive, JointPositions, Link, LoopError, Model, Tip};
use linkage::Linkage;
use nalgebra::Vector3;
use twin_kinematics::tripod::Rod;

/// Around everything that the axes bring somewhere, m.
const CLEARANCE: f64 = 0.02;
/// A plate with guides and a motor, as a uniform plate, kg/m³.
const CARRIAGE_DENSITY: f64 = 5400.0;
/// Carbon fibre, kg/m³.
const ROD_DENSITY: f64 = 1600.0;
/// Aluminium, kg/m³.
const PLATFORM_DENSITY: f64 = 2700.0;

/// The dimensions of a tripod. What is `None` is derived from the rest; the size of the machine follows from how far its
/// axes move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TripodDimensions {
    /// Name of the machine.
    pub name: String,
    /// The joints that move the carriages A, B and C up (m, N).
    pub joints: [MachineJoint; 3],
    /// Axis positions with the upper ends of the rods at height 0, m.
    pub offsets: [f64; 3],
    /// Two for each carriage, as designed or as measured (`twin_kinematics::tripod::TripodDimensions::rods`).
    pub rods: [Rod; 6],
    /// Of a carriage, kg. Derived: its plate at 5400 kg/m³.
    pub carriage_mass: Option<f64>,
    /// m. Derived: an eightieth of the length of the first rod but 3 to 20 mm.
    pub rod_radius: Option<f64>,
    /// Of a rod, kg. Derived: solid, 1600 kg/m³.
    pub rod_mass: Option<f64>,
    /// Without the tool, kg. Derived: a disc of 2700 kg/m³.
    pub platform_mass: Option<f64>,
    /// Reference point of the platform to tool tip, m; straight down is (0, 0, −length).
    pub tool: Vector3<f64>,
    /// m. Derived: a quarter of the platform's radius.
    pub tool_radius: Option<f64>,
    /// kg.
    pub tool_mass: f64,
}

/// All dimensions, derived ones included.
struct Tripod {
    linkage: Linkage,
    rods: [Rod; 6],
    /// Lowest and highest height of each carriage.
    travel: [[f64; 2]; 3],
    carriage_mass: Option<f64>,
    rod_radius: f64,
    rod_mass: Option<f64>,
    platform_mass: Option<f64>,
    /// Of the platform's disc.
    platform_radius: f64,
    tool: Tool,
}

impl TripodDimensions {
    /// A tripod with these rods, zero offsets and no tool; everything else derived.
    pub fn new(name: impl Into<String>, joints: [MachineJoint; 3], rods: [Rod; 6]) -> Self {
        Self { name: name.into(), joints, rods, ..Self::default() }
    }

    /// The machine: links `base`, `carriage1` to `carriage3`, `rod1` to `rod6`, `platform`, and the crosses of their
    /// joints, which have neither body nor mass.
    ///
    /// # Errors
    /// [`DimensionError`] names the first dimension that makes no sense.
    pub fn model(&self) -> Result<Model, DimensionError> {
        let tripod = self.complete()?;
        let mut model = Model {
            name: self.name.clone(),
            links: vec![Link::new("base", None, tripod.base())],
            joints: Vec::new(),
            loops: Vec::new(),
            tip: Tip { link: 0, point: self.tool.into() },
        };
        tripod.join(&mut model, self);
        self.find_rest(&mut model)?;
        Ok(model)
    }

    /// Checks what is given and derives the rest.
    fn complete(&self) -> Result<Tripod, DimensionError> {
        Tool::check(&self.tool, self.tool_mass)?;
        if !self.offsets.iter().all(|offset| offset.is_finite()) {
            return Err(DimensionError::NotFinite { what: "an offset" });
        }
        check_joints(self.joints.iter())?;
        let [first, ..] = &self.rods;
        let rod_radius =
            self.rod_radius.unwrap_or_else(|| (first.length / 80.0).clamp(0.003, 0.02));
        check_positive(&[
            ("the radius of the rods", rod_radius),
            ("the mass of a carriage", self.carriage_mass.unwrap_or(1.0)),
            ("the mass of a rod", self.rod_mass.unwrap_or(1.0)),
            ("the mass of the platform", self.platform_mass.unwrap_or(1.0)),
        ])?;
        let [a, b, c] = &self.joints;
        let [offset_a, offset_b, offset_c] = self.offsets;
        let travel_of =
            |joint: &MachineJoint, offset: f64| joint.position_limits.map(|limit| limit - offset);
        let travel = [travel_of(a, offset_a), travel_of(b, offset_b), travel_of(c, offset_c)];
        let linkage = Linkage::new(&self.rods)?;
        for (number, rod) in self.rods.iter().enumerate() {
            if rod.length <= 4.0 * solids::BALL * rod_radius {
                let length = rod.length;
                return Err(DimensionError::Rod { rod: number, length, reach: 0.0 });
            }
        }
        let from_axis = |rod: &Rod| rod.lower.x.hypot(rod.lower.y);
        let ring = self.rods.iter().map(from_axis).fold(f64::INFINITY, f64::min);
        let platform_radius =
            (ring - 1.5 * solids::BALL * rod_radius).max(2.0 * solids::BALL * rod_radius);
        let tool = Tool {
            tip: self.tool,
            radius: self.tool_radius.unwrap_or(platform_radius / 4.0),
            mass: self.tool_mass,
            blade: false,
        };
        check_positive(&[("the radius of the tool", tool.radius)])?;
        Ok(Tripod {
            linkage,
            rods: self.rods,
            travel,
            carriage_mass: self.carriage_mass,
            rod_radius,
            rod_mass: self.rod_mass,
            platform_mass: self.platform_mass,
            platform_radius,
            tool,
        })
    }

    /// Closes the loops of `model` with every axis in the middle of its travel, where its passive joints rest from then
    /// on. They are given for all carriages at one height.
    fn find_rest(&self, model: &mut Model) -> Result<(), DimensionError> {
        // Axes 0, 1 and 2, regardless of the machine's numbers.
        for (axis, joint) in model.joints.iter_mut().take(3).enumerate() {
            joint.drive = JointDrive::Axis(axis);
        }
        let middles = self.joints.each_ref().map(|joint| {
            let [lower, upper] = joint.position_limits;
            lower.midpoint(upper)
        });
        let heights = middles.iter().zip(self.offsets).map(|(middle, offset)| middle - offset);
        let height = heights.sum::<f64>() / 3.0;
        let mut start = vec![0.0; model.joints.len()];
        for (position, offset) in start.iter_mut().zip(self.offsets) {
            *position = height + offset;
        }
        let mut positions = JointPositions::at_rest(model);
        let closed = positions.start_from(&start).and_then(|()| positions.follow(model, &middles));
        closed.map_err(|error| match error {
            LoopError::Open(gap) => DimensionError::RodsApart(gap),
            LoopError::NotFinite | LoopError::Start { .. } => {
                DimensionError::NotFinite { what: "an end of a rod" }
            }
        })?;
        for (joint, position) in model.joints.iter_mut().zip(positions.values()) {
            if let JointDrive::Passive { rest } = &mut joint.drive {
                *rest = *position;
            }
        }
        for (joint, given) in model.joints.iter_mut().zip(&self.joints) {
            joint.drive = JointDrive::Axis(given.machine_axis);
        }
        Ok(())
    }
}
