//! Generated gantries: a table between posts, a bridge on two rails, a carriage on the bridge, a quill with a tool.
//!
//! ```text
//!        seen along +x                          seen along +y
//!
//!                 ┌┐ quill                       bridge ┌──┐▌┌┐ quill
//!      ┌──────────┤├─────────┐ bridge                   │  │▌││
//!      └┬─┬───────┤├───────┬─┘              truck ┌─────┴──┘▌││
//!       ├─┤ rail  └┘ ▼     ├─┤                ────┴──────────└┘──── rail
//!       │ │ post    tool   │ │                │ │             ▼ │ │ post
//!       │ │ ┌────────────┐ │ │                │ │ ┌───────────┐ │ │
//!       └─┘ └───table────┘ └─┘                └─┘ └───────────┘ └─┘
//! ```
//!
//! The machine frame is that of the transforms in `twin_kinematics::gantry`: the flange (the lower end of the quill, or of
//! the head that turns below it) is at the origin when every axis is at its offset. X moves the bridge, Y the carriage, Z
//! the quill; without Z the quill is fixed and the machine works in one plane. The table is just below the lowest tool
//! tip, the bridge above the highest flange.
//!
//! | Manual | Dimensions |
//! |---|---|
//! | 8.2.1, Gantry2 and Gantry3 | as they are |
//! | 8.2.1, GantryCutter2 and 3 | [`GantryDimensions::rotary`] |
//! | 8.2.2, Gantry2Tool1 and 2, with Z or without | [`GantryDimensions::tool`] beside the axis |
//! | 8.2.3, GantryH2 | [`PlaneDrive::HBelt`] |

mod belt;
mod solids;

pub use belt::{HBelt, PlaneDrive};

use super::tool::Tool;
use super::{Driven, MachineJoint, check_positive, fixed};
use crate::{DimensionError, JointKind, Link, Model, Tip};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Around everything that the axes bring somewhere, m.
const CLEARANCE: f64 = 0.02;
/// A hollow aluminium beam as a uniform body, kg/m³.
const BRIDGE_DENSITY: f64 = 900.0;
/// A plate with guides, screw and motor as a uniform plate, kg/m³.
const CARRIAGE_DENSITY: f64 = 5400.0;
/// A quill with its spindle as a uniform body, and a head that turns with its motor, kg/m³.
const QUILL_DENSITY: f64 = 2700.0;

/// A tool that an axis R turns about z, as a tangential cutter has it (manual, 8.2.1, `SMC_TRAFO_GantryCutter2` and `3`).
/// The flange points along (R − offset)·sense, counter-clockwise from +x.
#[derive(Clone, Debug, PartialEq)]
pub struct RotaryTool {
    /// The joint of R (rad, Nm).
    pub joint: MachineJoint,
    /// Axis position with the flange along +x (`dOffsetR`), rad.
    pub offset: f64,
    /// True if R counts clockwise (`iDirectionR` is −1).
    pub clockwise: bool,
    /// Of the part that turns, without the tool, kg. Derived: 2700 kg/m³.
    pub mass: Option<f64>,
}

impl RotaryTool {
    /// Counter-clockwise, without an offset; the mass is derived.
    pub fn new(joint: MachineJoint) -> Self {
        Self { joint, offset: 0.0, clockwise: false, mass: None }
    }
}

/// The dimensions of a gantry. What is `None` is derived from the rest, unless it says that something is not there; the
/// size of the machine follows from how far its axes move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GantryDimensions {
    /// Name of the machine.
    pub name: String,
    /// Drive of bridge (x) and carriage (y).
    pub plane: PlaneDrive,
    /// The joint that moves the quill up (m, N); `None`: the quill is fixed and the machine works in one plane.
    pub quill_joint: Option<MachineJoint>,
    /// The axis that turns the tool about z; `None`: it does not turn.
    pub rotary: Option<RotaryTool>,
    /// x, y and z of bridge, carriage and quill, as their axes or their belt say, with the flange at the origin of the
    /// machine frame, m; the last means nothing if the quill is fixed.
    pub offsets: [f64; 3],
    /// kg. Derived: a beam of 900 kg/m³.
    pub bridge_mass: Option<f64>,
    /// kg. Derived: the carriage's plate at 5400 kg/m³.
    pub carriage_mass: Option<f64>,
    /// Edge of the quill's square section, m. Derived: an eighth of its travel but 40 to 150 mm.
    pub quill_width: Option<f64>,
    /// Flange to the upper end, m. Derived: so that the lowest quill still shows above the carriage.
    pub quill_length: Option<f64>,
    /// kg. Derived: a quill of 2700 kg/m³.
    pub quill_mass: Option<f64>,
    /// Flange to tool tip in the frame of the flange, m; straight down is (0, 0, −length), and a tool beside the axis
    /// (`SMC_TRAFO_Gantry2Tool2`) is at A·(cos α, sin α) + B·(−sin α, cos α).
    pub tool: Vector3<f64>,
    /// m. Derived: a fifth of the quill's width.
    pub tool_radius: Option<f64>,
    /// kg.
    pub tool_mass: f64,
}

/// All dimensions, derived ones included.
struct Gantry {
    /// Range of the flange, machine frame.
    travel: [[f64; 2]; 3],
    /// Two motors on one belt.
    belt: bool,
    /// Width (along x) and height of the bridge's beam, m.
    beam: [f64; 2],
    bridge_mass: f64,
    carriage_mass: f64,
    /// Along y.
    carriage_width: f64,
    plate: f64,
    quill_width: f64,
    quill_length: f64,
    quill_mass: f64,
    /// Height and mass of what turns below the quill.
    head: Option<[f64; 2]>,
    tool: Tool,
}

impl GantryDimensions {
    /// A gantry of which `plane` moves bridge and carriage and `quill_joint` the quill, with zero offsets and no tool;
    /// everything else derived.
    pub fn new(
        name: impl Into<String>,
        plane: [MachineJoint; 2],
        quill_joint: Option<MachineJoint>,
    ) -> Self {
        let plane = PlaneDrive::Axes(plane);
        Self { name: name.into(), plane, quill_joint, ..Self::default() }
    }

    /// A gantry of which `belt` moves bridge and carriage; the rest as in [`Self::new`].
    pub fn h_belt(name: impl Into<String>, belt: HBelt, quill_joint: Option<MachineJoint>) -> Self {
        let plane = PlaneDrive::HBelt(belt);
        Self { name: name.into(), plane, quill_joint, ..Self::default() }
    }

    /// The machine: links `base`, `bridge`, `carriage` and `quill`, and `head` if it has a [rotary tool](RotaryTool).
    ///
    /// # Errors
    /// [`DimensionError`] names the first dimension that makes no sense.
    pub fn model(&self) -> Result<Model, DimensionError> {
        let [bridge, carriage] = self.checked_joints()?;
        let gantry = self.complete(&[&bridge, &carriage])?;
        let [x, y, z] = self.offsets;
        let slide = JointKind::Prismatic;
        let mut joints = vec![
            bridge.joint(slide, Vector3::x_axis(), 0, 1, Isometry3::translation(-x, 0.0, 0.0)),
            carriage.joint(slide, Vector3::y_axis(), 1, 2, Isometry3::translation(0.0, -y, 0.0)),
            match &self.quill_joint {
                Some(joint) => {
                    let origin = Isometry3::translation(0.0, 0.0, -z);
                    joint.joint(slide, Vector3::z_axis(), 2, 3, origin)
                }
                None => fixed("quill", 2, 3, Isometry3::identity()),
            },
        ];
        let mut links = vec![
            Link::new("base", None, gantry.base()),
            gantry.bridge(),
            gantry.carriage(),
            gantry.quill(),
        ];
        if let Some(RotaryTool { joint, offset, clockwise, .. }) = &self.rotary {
            let (axis, sense) =
                if *clockwise { (-Vector3::z_axis(), -1.0) } else { (Vector3::z_axis(), 1.0) };
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -sense * offset);
            let origin = Isometry3::from_parts(Translation3::identity(), turn);
            joints.push(joint.joint(JointKind::Revolute, axis, 3, 4, origin));
            links.push(gantry.head());
        }
        let tip = Tip { link: joints.len(), point: self.tool.into() };
        Ok(Model { name: self.name.clone(), links, joints, loops: Vec::new(), tip })
    }

    /// Checks axes and offsets, and gives the joints of bridge and carriage.
    fn checked_joints(&self) -> Result<[Driven; 2], DimensionError> {
        Tool::check(&self.tool, self.tool_mass)?;
        let turn = self.rotary.as_ref().map(|rotary| rotary.offset);
        if !self.offsets.iter().chain(&turn).all(|offset| offset.is_finite()) {
            return Err(DimensionError::NotFinite { what: "an offset" });
        }
        let rotary = self.rotary.as_ref().map(|rotary| &rotary.joint);
        self.plane.joints(self.quill_joint.iter().chain(rotary))
    }

    /// Checks what is given and derives the rest.
    fn complete(&self, plane: &[&Driven; 2]) -> Result<Gantry, DimensionError> {
        let [x, y, z] = self.offsets;
        let travel_of = |limits: Option<[f64; 2]>, offset: f64| {
            limits.map_or([0.0; 2], |l| l.map(|l| l - offset))
        };
        let travel = [
            travel_of(plane[0].position_limits, x),
            travel_of(plane[1].position_limits, y),
            travel_of(self.quill_joint.as_ref().map(|joint| joint.position_limits), z),
        ];
        let [span, stroke] = [travel[1][1] - travel[1][0], travel[2][1] - travel[2][0]];
        let beam_width = (span / 12.0).clamp(0.06, 0.3);
        let beam = [beam_width, 1.3 * beam_width];
        let quill_width = self.quill_width.unwrap_or_else(|| (stroke / 8.0).clamp(0.04, 0.15));
        let carriage_width = 3.5 * quill_width;
        let plate = 0.4 * quill_width;
        let quill_length = self.quill_length.unwrap_or(stroke + beam[1] + 2.0 * CLEARANCE);
        let head = self.rotary.as_ref().map(|rotary| {
            let height = (1.2 * quill_width).min(0.5 * quill_length);
            let volume = solids::head_volume(quill_width, height);
            [height, rotary.mass.unwrap_or(QUILL_DENSITY * volume)]
        });
        let mut gantry = Gantry {
            travel,
            belt: matches!(self.plane, PlaneDrive::HBelt(_)),
            beam,
            bridge_mass: 0.0,
            carriage_mass: self
                .carriage_mass
                .unwrap_or(CARRIAGE_DENSITY * plate * carriage_width * beam[1]),
            carriage_width,
            plate,
            quill_width,
            quill_length,
            quill_mass: self
                .quill_mass
                .unwrap_or(QUILL_DENSITY * quill_width * quill_width * quill_length),
            head,
            tool: Tool {
                tip: self.tool,
                radius: self.tool_radius.unwrap_or(quill_width / 5.0),
                mass: self.tool_mass,
                blade: self.rotary.is_some(),
            },
        };
        let length = gantry.beam_ends()[1] - gantry.beam_ends()[0];
        gantry.bridge_mass =
            self.bridge_mass.unwrap_or(BRIDGE_DENSITY * length * beam[0] * beam[1]);
        check_positive(&[
            ("the mass of the bridge", gantry.bridge_mass),
            ("the mass of the carriage", gantry.carriage_mass),
            ("the width of the quill", quill_width),
            ("the length of the quill", quill_length),
            ("the mass of the quill", gantry.quill_mass),
            ("the mass of the head", head.map_or(1.0, |[_, mass]| mass)),
            ("the radius of the tool", gantry.tool.radius),
        ])?;
        Ok(gantry)
    }
}
