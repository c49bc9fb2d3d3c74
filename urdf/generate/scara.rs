//! A SCARA: a column, two arms, a quill with a tool.
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
//! The machine frame is that of `twin_kinematics::scara::Scara2`: the origin lies on the first arm's axis at the height
//! of the flange (the lower end of the quill) when the axis that moves Z is at 0; the tool tip is a tool length below
//! the flange. The arms stand above, so that the highest flange stays below arm 2.

use super::{
    MachineJoint, check_joints, check_not_negative, check_positive, cuboid, paint, upright,
};
use crate::{DimensionError, Inertial, Joint, JointKind, Link, Model, Solid, Tip};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

/// Between parts that pass each other, m.
const GAP: f64 = 0.003;
/// Around everything that the quill brings somewhere, m.
const CLEARANCE: f64 = 0.02;
/// A casting with a motor in it, as a uniform body, kg/m³.
const ARM_DENSITY: f64 = 2500.0;
/// Steel, kg/m³.
const QUILL_DENSITY: f64 = 7850.0;

/// The dimensions of a SCARA with two arms. What is `None` is derived from the rest.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaraDimensions {
    /// Name of the machine.
    pub name: String,
    /// The joints of the first and second arm (rad, Nm).
    pub arm_joints: [MachineJoint; 2],
    /// The joint that moves the quill up (m, N); `None`: the quill is fixed and the machine works in one plane.
    pub quill_joint: Option<MachineJoint>,
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
    /// m. Derived: 0.6 times the width of arm 1.
    pub column_radius: Option<f64>,
    /// m. Derived: a fifth of the width of arm 2.
    pub quill_radius: Option<f64>,
    /// Flange to the upper end, m. Derived: so that the lowest quill still stands out of arm 2.
    pub quill_length: Option<f64>,
    /// kg. Derived: solid steel.
    pub quill_mass: Option<f64>,
    /// Flange to tool tip, m; 0: the tip is the middle of the flange.
    pub tool_length: f64,
    /// m. Derived: half the radius of the quill.
    pub tool_radius: Option<f64>,
    /// kg.
    pub tool_mass: f64,
}

/// All dimensions, derived ones included.
struct Scara<'a> {
    given: &'a ScaraDimensions,
    sections: [[f64; 2]; 2],
    masses: [f64; 2],
    /// Lower and upper side of each arm, machine frame.
    heights: [[f64; 2]; 2],
    floor: f64,
    column_top: f64,
    column_radius: f64,
    quill_radius: f64,
    quill_length: f64,
    quill_mass: f64,
    tool_radius: f64,
}

impl ScaraDimensions {
    /// A SCARA with arms of the lengths `arms` (m), zero offsets and no tool; everything else derived.
    pub fn new(
        name: impl Into<String>,
        arm_joints: [MachineJoint; 2],
        quill_joint: Option<MachineJoint>,
        arms: [f64; 2],
    ) -> Self {
        Self {
            name: name.into(),
            arm_joints,
            quill_joint,
            arms,
            offsets: [0.0; 2],
            arm_sections: None,
            arm_masses: None,
            column_height: None,
            column_radius: None,
            quill_radius: None,
            quill_length: None,
            quill_mass: None,
            tool_length: 0.0,
            tool_radius: None,
            tool_mass: 0.0,
        }
    }

    /// The machine: links `base`, `arm1`, `arm2` and `quill`.
    ///
    /// # Errors
    /// [`DimensionError`] names the first dimension that makes no sense.
    pub fn model(&self) -> Result<Model, DimensionError> {
        let scara = self.complete()?;
        let mid = |arm: usize| f64::midpoint(scara.heights[arm][0], scara.heights[arm][1]);
        let [first, second] = [mid(0), mid(1)];
        let quill_origin = Isometry3::translation(self.arms[1], 0.0, -second);
        let quill_joint = match &self.quill_joint {
            Some(joint) => joint.joint(JointKind::Prismatic, Vector3::z_axis(), 2, 3, quill_origin),
            None => Joint {
                name: "quill".to_owned(),
                kind: JointKind::Fixed,
                parent: 2,
                child: 3,
                origin: quill_origin,
                axis: Vector3::z_axis(),
                machine_axis: None,
                position_limits: None,
                velocity_limit: None,
                effort_limit: None,
            },
        };
        let arm_joint = |arm: usize, x: f64, z: f64| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -self.offsets[arm]);
            let origin = Isometry3::from_parts(Translation3::new(x, 0.0, z), turn);
            self.arm_joints[arm].joint(JointKind::Revolute, Vector3::z_axis(), arm, arm + 1, origin)
        };
        Ok(Model {
            name: self.name.clone(),
            links: vec![
                Link { name: "base".to_owned(), inertial: None, solids: scara.base() },
                Link {
                    name: "arm1".to_owned(),
                    inertial: Some(scara.arm_inertial(0)),
                    solids: scara.arm1(),
                },
                Link {
                    name: "arm2".to_owned(),
                    inertial: Some(scara.arm_inertial(1)),
                    solids: scara.arm2(),
                },
                scara.quill(),
            ],
            joints: vec![
                arm_joint(0, 0.0, first),
                arm_joint(1, self.arms[0], second - first),
                quill_joint,
            ],
            tip: Tip { link: 3, point: Point3::new(0.0, 0.0, -self.tool_length) },
        })
    }

    /// Checks what is given and derives the rest.
    fn complete(&self) -> Result<Scara<'_>, DimensionError> {
        check_positive(&[
            ("the length of arm 1", self.arms[0]),
            ("the length of arm 2", self.arms[1]),
        ])?;
        check_not_negative(&[
            ("the length of the tool", self.tool_length),
            ("the mass of the tool", self.tool_mass),
        ])?;
        if !self.offsets.iter().all(|offset| offset.is_finite()) {
            return Err(DimensionError::NotFinite { what: "an offset" });
        }
        check_joints(self.arm_joints.iter().chain(&self.quill_joint))?;

        let sections = self
            .arm_sections
            .unwrap_or_else(|| self.arms.map(|length| [length / 4.0, length / 5.0]));
        let [lowest, highest] =
            self.quill_joint.as_ref().map_or([0.0; 2], |joint| joint.position_limits);
        let arm2_bottom = highest + CLEARANCE;
        let arm1_top = arm2_bottom - GAP;
        let heights =
            [[arm1_top - sections[0][1], arm1_top], [arm2_bottom, arm2_bottom + sections[1][1]]];
        let column_top = heights[0][0] - GAP;
        let column_height = self.column_height.unwrap_or_else(|| {
            let below_tool = lowest - self.tool_length - CLEARANCE;
            (column_top - below_tool).max(sections[0][0])
        });
        let masses = self.arm_masses.unwrap_or_else(|| {
            [0, 1].map(|arm| ARM_DENSITY * self.arms[arm] * sections[arm][0] * sections[arm][1])
        });
        let quill_radius = self.quill_radius.unwrap_or(sections[1][0] / 5.0);
        let quill_length = self.quill_length.unwrap_or(heights[1][1] + CLEARANCE - lowest);
        let quill_volume = std::f64::consts::PI * quill_radius * quill_radius * quill_length;
        let scara = Scara {
            given: self,
            sections,
            masses,
            heights,
            floor: column_top - column_height,
            column_top,
            column_radius: self.column_radius.unwrap_or(0.6 * sections[0][0]),
            quill_radius,
            quill_length,
            quill_mass: self.quill_mass.unwrap_or(QUILL_DENSITY * quill_volume),
            tool_radius: self.tool_radius.unwrap_or(quill_radius / 2.0),
        };
        check_positive(&[
            ("the width of arm 1", sections[0][0]),
            ("the height of arm 1", sections[0][1]),
            ("the width of arm 2", sections[1][0]),
            ("the height of arm 2", sections[1][1]),
            ("the mass of arm 1", masses[0]),
            ("the mass of arm 2", masses[1]),
            ("the height of the column", column_height),
            ("the radius of the column", scara.column_radius),
            ("the radius of the quill", quill_radius),
            ("the length of the quill", quill_length),
            ("the mass of the quill", scara.quill_mass),
            ("the radius of the tool", scara.tool_radius),
        ])?;
        Ok(scara)
    }
}

impl Scara<'_> {
    fn base(&self) -> Vec<Solid> {
        let half = 1.6 * self.column_radius;
        let plate = self.floor + 0.1 * (self.column_top - self.floor).min(2.0 * self.column_radius);
        vec![
            cuboid([-half, -half, self.floor], [half, half, plate], paint::SLATE),
            upright(0.0, 0.0, [plate, self.column_top], self.column_radius, paint::GRAPHITE),
        ]
    }

    /// A beam with round ends, in the frame of the arm: at half its height.
    fn beam(&self, arm: usize, color: [f64; 4]) -> Vec<Solid> {
        let (length, [width, height]) = (self.given.arms[arm], self.sections[arm]);
        let (side, level) = (width / 2.0, height / 2.0);
        vec![
            cuboid([0.0, -side, -level], [length, side, level], color),
            upright(0.0, 0.0, [-level, level], side, color),
            upright(length, 0.0, [-level, level], side, color),
        ]
    }

    /// Of the box between the axes; the round ends are paint.
    fn arm_inertial(&self, arm: usize) -> Inertial {
        let (length, [width, height]) = (self.given.arms[arm], self.sections[arm]);
        let size = Vector3::new(length, width, height);
        Inertial::uniform_box(self.masses[arm], size, Point3::new(length / 2.0, 0.0, 0.0))
    }

    fn arm1(&self) -> Vec<Solid> {
        self.beam(0, paint::IVORY)
    }

    fn arm2(&self) -> Vec<Solid> {
        let (length, [width, height]) = (self.given.arms[1], self.sections[1]);
        let mut solids = self.beam(1, paint::BLUE);
        // The cover of the motors leaves the quill free.
        let (side, start) = (0.4 * width, -0.3 * width);
        let end = (0.65 * length).min(length - 2.0 * self.quill_radius);
        if end > start {
            let level = height / 2.0;
            solids.push(cuboid(
                [start, -side, level],
                [end, side, level + 0.7 * height],
                paint::GRAPHITE,
            ));
        }
        solids
    }

    /// The quill and its tool, in the frame of the flange.
    fn quill(&self) -> Link {
        let quill = upright(0.0, 0.0, [0.0, self.quill_length], self.quill_radius, paint::STEEL);
        let tool_length = self.given.tool_length;
        let tool = upright(0.0, 0.0, [-tool_length, 0.0], self.tool_radius, paint::AMBER);
        let parts = [quill.uniform(self.quill_mass), tool.uniform(self.given.tool_mass)];
        let mut solids = vec![quill];
        if tool_length > 0.0 {
            solids.push(tool);
        }
        Link { name: "quill".to_owned(), inertial: Inertial::union(&parts), solids }
    }
}
