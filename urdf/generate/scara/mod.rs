//! Generated SCARAs: a column, two arms, and a quill with a tool or with a third arm (hand).
//!
//! ```text
//!                            ┌──┐ quill
//!                  ┌───cover─┤  ├
//!                  │ arm 2   │  │
//!        ┌─────────┴─┬───────┤  ├
//!        │ arm 1     │       └──┘  ▲ clearance
//!        └─┬──────┬──┘        ┃ ── highest flange
//!          │column│           ┃
//!          │      │           ▼ tool
//!        ──┴──────┴──          ── floor: below the lowest tool tip
//! ```
//!
//! The machine frame is that of the transforms in `twin_kinematics::scara` (manual, 8.2.4 and 8.2.5): the origin lies
//! on the first arm's axis at the height of the flange when the axis that moves Z is at 0. The flange of two arms is
//! the lower end of the quill and stays parallel to arm 2. A third arm is a [hand](ScaraHand) that the quill carries
//! and turns (a spline shaft in a real machine); the flange is at its end and points along it. The arms are above the
//! work, so that everything on the quill stays below arm 2.

mod solids;

use super::tool::Tool;
use super::{MachineJoint, check_joints, check_not_negative, check_positive, fixed, paint};
use crate::{DimensionError, JointKind, Link, Model, Tip};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

/// Between parts that pass each other, m.
const GAP: f64 = 0.003;
/// Around everything that the quill brings somewhere, m.
const CLEARANCE: f64 = 0.02;
/// A casting with a motor in it, as a uniform body, kg/m³.
const ARM_DENSITY: f64 = 2500.0;
/// Steel, kg/m³.
const QUILL_DENSITY: f64 = 7850.0;

/// A third arm, which the quill carries at its lower end and turns.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaraHand {
    /// The joint of the third arm (rad, Nm).
    pub joint: MachineJoint,
    /// From the quill's axis to the flange, m; 0: the hand only turns the tool.
    pub length: f64,
    /// Axis position with the hand along arm 2 (`dOffsetC`), rad.
    pub offset: f64,
    /// Without the tool, kg. Derived: 2500 kg/m³.
    pub mass: Option<f64>,
}

impl ScaraHand {
    /// A hand of `length` (m) without an offset; the rest derived.
    pub fn new(joint: MachineJoint, length: f64) -> Self {
        Self { joint, length, offset: 0.0, mass: None }
    }

    /// All its dimensions below a quill of radius `quill` (m).
    fn complete(&self, quill: f64) -> Hand {
        let hand = Hand { length: self.length, width: 2.4 * quill, height: quill, mass: 0.0 };
        Hand { mass: self.mass.unwrap_or(ARM_DENSITY * hand.volume()), ..hand }
    }
}

/// The dimensions of a SCARA with two arms, or three with a hand. What is `None` is derived from the rest, unless it says
/// that something is not there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScaraDimensions {
    /// Name of the machine.
    pub name: String,
    /// The joints of the first and second arm (rad, Nm).
    pub arm_joints: [MachineJoint; 2],
    /// The joint that moves the quill up (m, N); `None`: the quill is fixed and the machine works in one plane.
    pub quill_joint: Option<MachineJoint>,
    /// The third arm; `None`: there are two, and the quill carries the tool.
    pub hand: Option<ScaraHand>,
    /// Lengths of the arms between their axes, m.
    pub arms: [f64; 2],
    /// Axis positions of the arm joints with both arms stretched along +x, rad.
    pub offsets: [f64; 2],
    /// Width and height of the cross section of each arm, m. Derived: a quarter and a fifth of the arm's length.
    pub arm_sections: Option<[[f64; 2]; 2]>,
    /// kg. Derived: uniform arms of 2500 kg/m³.
    pub arm_masses: Option<[f64; 2]>,
    /// Floor to the lower side of arm 1, m. Derived: so that the floor is just below the lowest tool tip.
    pub column_height: Option<f64>,
    /// m. Derived: a fifth of the width of arm 2.
    pub quill_radius: Option<f64>,
    /// Flange to the upper end, m. Derived: so that the lowest quill still shows above arm 2.
    pub quill_length: Option<f64>,
    /// kg. Derived: solid steel.
    pub quill_mass: Option<f64>,
    /// Flange to tool tip in the frame of the flange, x along the last arm, m; straight down is (0, 0, −length).
    pub tool: Vector3<f64>,
    /// m. Derived: half the radius of the quill.
    pub tool_radius: Option<f64>,
    /// kg.
    pub tool_mass: f64,
}

/// An arm with all its dimensions, in m and kg.
struct Arm {
    length: f64,
    width: f64,
    height: f64,
    mass: f64,
    /// Height of its lower side, machine frame.
    bottom: f64,
}

/// All dimensions, derived ones included.
struct Scara {
    first: Arm,
    second: Arm,
    floor: f64,
    column_top: f64,
    column_radius: f64,
    quill_radius: f64,
    quill_length: f64,
    quill_mass: f64,
    hand: Option<Hand>,
    tool: Tool,
}

/// A hand with all its dimensions, in m and kg.
#[derive(Clone, Copy)]
struct Hand {
    length: f64,
    width: f64,
    height: f64,
    mass: f64,
}

impl ScaraDimensions {
    /// A SCARA with arms of the lengths `arms` (m), zero offsets and no tool; everything else derived.
    pub fn new(
        name: impl Into<String>,
        arm_joints: [MachineJoint; 2],
        quill_joint: Option<MachineJoint>,
        arms: [f64; 2],
    ) -> Self {
        Self { name: name.into(), arm_joints, quill_joint, arms, ..Self::default() }
    }

    /// The machine: links `base`, `arm1`, `arm2` and `quill`, and `hand` if it has one.
    ///
    /// # Errors
    /// [`DimensionError`] names the first dimension that makes no sense.
    pub fn model(&self) -> Result<Model, DimensionError> {
        let scara = self.complete()?;
        let [first, second] = [scara.first.middle(), scara.second.middle()];
        let quill_origin = Isometry3::translation(self.arms[1], 0.0, -second);
        let quill_joint = match &self.quill_joint {
            Some(joint) => joint.joint(JointKind::Prismatic, Vector3::z_axis(), 2, 3, quill_origin),
            None => fixed("quill", 2, 3, quill_origin),
        };
        let origin = |offset: f64, x: f64, z: f64| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -offset);
            Isometry3::from_parts(Translation3::new(x, 0.0, z), turn)
        };
        let [shoulder, elbow] = &self.arm_joints;
        let shoulder_origin = origin(self.offsets[0], 0.0, first);
        let elbow_origin = origin(self.offsets[1], self.arms[0], second - first);
        let mut links = vec![
            Link::new("base", None, scara.base()),
            Link::new("arm1", Some(scara.first.inertial()), scara.first.beam(paint::IVORY)),
            Link::new("arm2", Some(scara.second.inertial()), scara.arm2()),
            scara.quill(),
        ];
        let mut joints = vec![
            shoulder.joint(JointKind::Revolute, Vector3::z_axis(), 0, 1, shoulder_origin),
            elbow.joint(JointKind::Revolute, Vector3::z_axis(), 1, 2, elbow_origin),
            quill_joint,
        ];
        let mut flange = Point3::origin();
        if let (Some(hand), Some(given)) = (&scara.hand, &self.hand) {
            let wrist = origin(given.offset, 0.0, 0.0);
            joints.push(given.joint.joint(JointKind::Revolute, Vector3::z_axis(), 3, 4, wrist));
            links.push(scara.hand(hand));
            flange.x = hand.length;
        }
        let tip = Tip { link: joints.len(), point: flange + self.tool };
        Ok(Model { name: self.name.clone(), links, joints, loops: Vec::new(), tip })
    }

    /// Checks what is given and derives the rest.
    fn complete(&self) -> Result<Scara, DimensionError> {
        check_positive(&[
            ("the length of arm 1", self.arms[0]),
            ("the length of arm 2", self.arms[1]),
        ])?;
        Tool::check(&self.tool, self.tool_mass)?;
        let hand = self.hand.as_ref();
        check_not_negative(&[("the length of the hand", hand.map_or(0.0, |hand| hand.length))])?;
        let offsets = self.offsets.iter().copied().chain(hand.map(|hand| hand.offset));
        if !offsets.into_iter().all(f64::is_finite) {
            return Err(DimensionError::NotFinite { what: "an offset" });
        }
        let wrist = hand.map(|hand| &hand.joint);
        check_joints(self.arm_joints.iter().chain(&self.quill_joint).chain(wrist))?;

        let derived_section = |length: f64| [length / 4.0, length / 5.0];
        let sections = self.arm_sections.unwrap_or_else(|| self.arms.map(derived_section));
        let derived_mass =
            |length: f64, [width, height]: [f64; 2]| ARM_DENSITY * length * width * height;
        let masses = self.arm_masses.unwrap_or_else(|| {
            [derived_mass(self.arms[0], sections[0]), derived_mass(self.arms[1], sections[1])]
        });
        let [lowest, highest] =
            self.quill_joint.as_ref().map_or([0.0; 2], |joint| joint.position_limits);
        let arm = |length, [width, height]: [f64; 2], mass, bottom| Arm {
            length,
            width,
            height,
            mass,
            bottom,
        };
        let quill_radius = self.quill_radius.unwrap_or(sections[1][0] / 5.0);
        let hand = hand.map(|hand| hand.complete(quill_radius));
        let room = CLEARANCE + hand.map_or(0.0, |hand| hand.height + GAP);
        let second = arm(self.arms[1], sections[1], masses[1], highest + room);
        let bottom = second.bottom - GAP - sections[0][1];
        let first = arm(self.arms[0], sections[0], masses[0], bottom);
        let column_top = first.bottom - GAP;
        let column_height = self.column_height.unwrap_or_else(|| {
            let below_tool = lowest + self.tool.z - CLEARANCE;
            (column_top - below_tool).max(first.width)
        });
        let quill_length = self.quill_length.unwrap_or(second.top() + CLEARANCE - lowest);
        let quill_volume = std::f64::consts::PI * quill_radius * quill_radius * quill_length;
        let scara = Scara {
            floor: column_top - column_height,
            column_top,
            column_radius: 0.6 * first.width,
            quill_radius,
            quill_length,
            quill_mass: self.quill_mass.unwrap_or(QUILL_DENSITY * quill_volume),
            hand,
            tool: Tool {
                tip: self.tool,
                radius: self.tool_radius.unwrap_or(quill_radius / 2.0),
                mass: self.tool_mass,
                blade: false,
            },
            first,
            second,
        };
        check_positive(&[
            ("the width of arm 1", scara.first.width),
            ("the height of arm 1", scara.first.height),
            ("the mass of arm 1", scara.first.mass),
            ("the width of arm 2", scara.second.width),
            ("the height of arm 2", scara.second.height),
            ("the mass of arm 2", scara.second.mass),
            ("the height of the column", column_height),
            ("the radius of the quill", quill_radius),
            ("the length of the quill", quill_length),
            ("the mass of the quill", scara.quill_mass),
            ("the radius of the tool", scara.tool.radius),
        ])?;
        if let Some(hand) = &scara.hand {
            check_positive(&[("the mass of the hand", hand.mass)])?;
        }
        Ok(scara)
    }
}
