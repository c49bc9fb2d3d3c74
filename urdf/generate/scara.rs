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
use crate::{DimensionError, Inertial, Joint, JointDrive, JointKind, Link, Model, Solid, Tip};
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
    tool_radius: f64,
    tool_length: f64,
    tool_mass: f64,
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
        let [first, second] = [scara.first.middle(), scara.second.middle()];
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
                drive: JointDrive::Fixed,
                position_limits: None,
                velocity_limit: None,
                effort_limit: None,
            },
        };
        let origin = |offset: f64, x: f64, z: f64| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -offset);
            Isometry3::from_parts(Translation3::new(x, 0.0, z), turn)
        };
        let [shoulder, elbow] = &self.arm_joints;
        let shoulder_origin = origin(self.offsets[0], 0.0, first);
        let elbow_origin = origin(self.offsets[1], self.arms[0], second - first);
        let part = |name: &str, inertial, solids| Link { name: name.to_owned(), inertial, solids };
        Ok(Model {
            name: self.name.clone(),
            links: vec![
                part("base", None, scara.base()),
                part("arm1", Some(scara.first.inertial()), scara.first.beam(paint::IVORY)),
                part("arm2", Some(scara.second.inertial()), scara.arm2()),
                part("quill", scara.quill_inertial(), scara.quill()),
            ],
            joints: vec![
                shoulder.joint(JointKind::Revolute, Vector3::z_axis(), 0, 1, shoulder_origin),
                elbow.joint(JointKind::Revolute, Vector3::z_axis(), 1, 2, elbow_origin),
                quill_joint,
            ],
            loops: Vec::new(),
            tip: Tip { link: 3, point: Point3::new(0.0, 0.0, -self.tool_length) },
        })
    }

    /// Checks what is given and derives the rest.
    fn complete(&self) -> Result<Scara, DimensionError> {
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
        let second = arm(self.arms[1], sections[1], masses[1], highest + CLEARANCE);
        let first = arm(self.arms[0], sections[0], masses[0], second.bottom - GAP - sections[0][1]);
        let column_top = first.bottom - GAP;
        let column_height = self.column_height.unwrap_or_else(|| {
            let below_tool = lowest - self.tool_length - CLEARANCE;
            (column_top - below_tool).max(first.width)
        });
        let quill_radius = self.quill_radius.unwrap_or(second.width / 5.0);
        let quill_length = self.quill_length.unwrap_or(second.top() + CLEARANCE - lowest);
        let quill_volume = std::f64::consts::PI * quill_radius * quill_radius * quill_length;
        let scara = Scara {
            floor: column_top - column_height,
            column_top,
            column_radius: self.column_radius.unwrap_or(0.6 * first.width),
            quill_radius,
            quill_length,
            quill_mass: self.quill_mass.unwrap_or(QUILL_DENSITY * quill_volume),
            tool_radius: self.tool_radius.unwrap_or(quill_radius / 2.0),
            tool_length: self.tool_length,
            tool_mass: self.tool_mass,
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
            ("the radius of the column", scara.column_radius),
            ("the radius of the quill", quill_radius),
            ("the length of the quill", quill_length),
            ("the mass of the quill", scara.quill_mass),
            ("the radius of the tool", scara.tool_radius),
        ])?;
        Ok(scara)
    }
}

impl Arm {
    fn top(&self) -> f64 {
        self.bottom + self.height
    }

    /// Height of the origin of its frame, machine frame.
    fn middle(&self) -> f64 {
        self.bottom + self.height / 2.0
    }

    /// A beam with round ends.
    fn beam(&self, color: [f64; 4]) -> Vec<Solid> {
        let (side, level) = (self.width / 2.0, self.height / 2.0);
        vec![
            cuboid([0.0, -side, -level], [self.length, side, level], color),
            upright(0.0, 0.0, [-level, level], side, color),
            upright(self.length, 0.0, [-level, level], side, color),
        ]
    }

    /// Of the box between the axes; the round ends are paint.
    fn inertial(&self) -> Inertial {
        let size = Vector3::new(self.length, self.width, self.height);
        Inertial::uniform_box(self.mass, size, Point3::new(self.length / 2.0, 0.0, 0.0))
    }
}

impl Scara {
    fn base(&self) -> Vec<Solid> {
        let half = 1.6 * self.column_radius;
        let plate = self.floor + 0.1 * (self.column_top - self.floor).min(2.0 * self.column_radius);
        vec![
            cuboid([-half, -half, self.floor], [half, half, plate], paint::SLATE),
            upright(0.0, 0.0, [plate, self.column_top], self.column_radius, paint::GRAPHITE),
        ]
    }

    fn arm2(&self) -> Vec<Solid> {
        let arm = &self.second;
        let mut solids = arm.beam(paint::BLUE);
        // The cover of the motors leaves the quill free.
        let (side, start) = (0.4 * arm.width, -0.3 * arm.width);
        let end = (0.65 * arm.length).min(arm.length - 2.0 * self.quill_radius);
        if end > start {
            let level = arm.height / 2.0;
            solids.push(cuboid(
                [start, -side, level],
                [end, side, level + 0.7 * arm.height],
                paint::GRAPHITE,
            ));
        }
        solids
    }

    /// The quill, in the frame of the flange.
    fn shaft(&self) -> Solid {
        upright(0.0, 0.0, [0.0, self.quill_length], self.quill_radius, paint::STEEL)
    }

    /// The tool, in the frame of the flange.
    fn tool(&self) -> Solid {
        upright(0.0, 0.0, [-self.tool_length, 0.0], self.tool_radius, paint::AMBER)
    }

    fn quill(&self) -> Vec<Solid> {
        let mut solids = vec![self.shaft()];
        if self.tool_length > 0.0 {
            solids.push(self.tool());
        }
        solids
    }

    fn quill_inertial(&self) -> Option<Inertial> {
        Inertial::union(&[
            self.shaft().uniform(self.quill_mass),
            self.tool().uniform(self.tool_mass),
        ])
    }
}
