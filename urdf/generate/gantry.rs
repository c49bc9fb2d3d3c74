//! A gantry: a table between posts, a bridge on two rails, a carriage on the bridge, a quill with a tool.
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
//! The machine frame is that of `twin_kinematics::gantry::Gantry3`: the flange (the lower end of the quill) is at the
//! origin when every axis is at its offset; the tool tip is a tool length below the flange. X moves the bridge, Y the
//! carriage, Z the quill. The table is just below the lowest tool tip, the bridge above the highest flange.

use super::{
    MachineJoint, check_joints, check_not_negative, check_positive, cuboid, paint, upright,
};
use crate::{DimensionError, Inertial, JointKind, Link, Model, Solid, Tip};
use nalgebra::{Isometry3, Point3, Vector3};

/// Between parts that pass each other, m.
const GAP: f64 = 0.003;
/// Around everything that the axes bring somewhere, m.
const CLEARANCE: f64 = 0.02;
/// A hollow aluminium beam as a uniform body, kg/m³.
const BRIDGE_DENSITY: f64 = 900.0;
/// A plate with guides, screw and motor as a uniform plate, kg/m³.
const CARRIAGE_DENSITY: f64 = 5400.0;
/// A quill with its spindle as a uniform body, kg/m³.
const QUILL_DENSITY: f64 = 2700.0;

/// The dimensions of a gantry with three axes. What is `None` is derived from the rest; the size of the machine follows
/// from how far its axes move.
#[derive(Clone, Debug, PartialEq)]
pub struct GantryDimensions {
    /// Name of the machine.
    pub name: String,
    /// The joints along x, y and z (m, N).
    pub joints: [MachineJoint; 3],
    /// Axis positions with the flange at the origin of the machine frame, m.
    pub offsets: [f64; 3],
    /// Width (along x) and height of the bridge's beam, m. Derived: a twelfth of its travel along y but 60 to 300 mm,
    /// and 1.3 times that.
    pub beam_section: Option<[f64; 2]>,
    /// kg. Derived: a beam of 900 kg/m³.
    pub bridge_mass: Option<f64>,
    /// kg. Derived: the carriage's plate at 5400 kg/m³.
    pub carriage_mass: Option<f64>,
    /// Edge of the quill's square section, m. Derived: an eighth of its travel but 40 to 150 mm.
    pub quill_width: Option<f64>,
    /// Flange to the upper end, m. Derived: so that the lowest quill still stands out of the carriage.
    pub quill_length: Option<f64>,
    /// kg. Derived: a quill of 2700 kg/m³.
    pub quill_mass: Option<f64>,
    /// Flange to tool tip, m; 0: the tip is the middle of the flange.
    pub tool_length: f64,
    /// m. Derived: a fifth of the quill's width.
    pub tool_radius: Option<f64>,
    /// kg.
    pub tool_mass: f64,
}

/// All dimensions, derived ones included.
struct Gantry<'a> {
    given: &'a GantryDimensions,
    /// Where the flange goes, machine frame.
    travel: [[f64; 2]; 3],
    beam: [f64; 2],
    bridge_mass: f64,
    carriage_mass: f64,
    /// Along y.
    carriage_width: f64,
    plate: f64,
    quill_width: f64,
    quill_length: f64,
    quill_mass: f64,
    tool_radius: f64,
}

impl GantryDimensions {
    /// A gantry with zero offsets and no tool; everything else derived.
    pub fn new(name: impl Into<String>, joints: [MachineJoint; 3]) -> Self {
        Self {
            name: name.into(),
            joints,
            offsets: [0.0; 3],
            beam_section: None,
            bridge_mass: None,
            carriage_mass: None,
            quill_width: None,
            quill_length: None,
            quill_mass: None,
            tool_length: 0.0,
            tool_radius: None,
            tool_mass: 0.0,
        }
    }

    /// The machine: links `base`, `bridge`, `carriage` and `quill`.
    ///
    /// # Errors
    /// [`DimensionError`] names the first dimension that makes no sense.
    pub fn model(&self) -> Result<Model, DimensionError> {
        let gantry = self.complete()?;
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let joints = self.joints.iter().zip(axes).zip(self.offsets).enumerate().map(
            |(link, ((joint, axis), offset))| {
                let origin = Isometry3::from(axis.into_inner() * -offset);
                joint.joint(JointKind::Prismatic, axis, link, link + 1, origin)
            },
        );
        Ok(Model {
            name: self.name.clone(),
            links: vec![
                Link { name: "base".to_owned(), inertial: None, solids: gantry.base() },
                gantry.bridge(),
                gantry.carriage(),
                gantry.quill(),
            ],
            joints: joints.collect(),
            loops: Vec::new(),
            tip: Tip { link: 3, point: Point3::new(0.0, 0.0, -self.tool_length) },
        })
    }

    /// Checks what is given and derives the rest.
    fn complete(&self) -> Result<Gantry<'_>, DimensionError> {
        check_not_negative(&[
            ("the length of the tool", self.tool_length),
            ("the mass of the tool", self.tool_mass),
        ])?;
        if !self.offsets.iter().all(|offset| offset.is_finite()) {
            return Err(DimensionError::NotFinite { what: "an offset" });
        }
        check_joints(self.joints.iter())?;

        let [x, y, z] = &self.joints;
        let travel_of =
            |joint: &MachineJoint, offset: f64| joint.position_limits.map(|limit| limit - offset);
        let travel = [
            travel_of(x, self.offsets[0]),
            travel_of(y, self.offsets[1]),
            travel_of(z, self.offsets[2]),
        ];
        let [span, stroke] = [travel[1][1] - travel[1][0], travel[2][1] - travel[2][0]];
        let beam = self.beam_section.unwrap_or_else(|| {
            let width = (span / 12.0).clamp(0.06, 0.3);
            [width, 1.3 * width]
        });
        let quill_width = self.quill_width.unwrap_or_else(|| (stroke / 8.0).clamp(0.04, 0.15));
        let carriage_width = 3.5 * quill_width;
        let plate = 0.4 * quill_width;
        let quill_length = self.quill_length.unwrap_or(stroke + beam[1] + 2.0 * CLEARANCE);
        let mut gantry = Gantry {
            given: self,
            travel,
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
            tool_radius: self.tool_radius.unwrap_or(quill_width / 5.0),
        };
        let length = gantry.beam_ends()[1] - gantry.beam_ends()[0];
        gantry.bridge_mass =
            self.bridge_mass.unwrap_or(BRIDGE_DENSITY * length * beam[0] * beam[1]);
        check_positive(&[
            ("the width of the beam", beam[0]),
            ("the height of the beam", beam[1]),
            ("the mass of the bridge", gantry.bridge_mass),
            ("the mass of the carriage", gantry.carriage_mass),
            ("the width of the quill", quill_width),
            ("the length of the quill", quill_length),
            ("the mass of the quill", gantry.quill_mass),
            ("the radius of the tool", gantry.tool_radius),
        ])?;
        Ok(gantry)
    }
}

impl Gantry<'_> {
    /// Width of the rails and posts.
    fn rail(&self) -> f64 {
        0.8 * self.beam[0]
    }

    /// Where the beam ends along y: the carriage stays between the rails.
    fn beam_ends(&self) -> [f64; 2] {
        let margin = self.carriage_width / 2.0 + CLEARANCE + self.rail();
        [self.travel[1][0] - margin, self.travel[1][1] + margin]
    }

    /// Where the two rails lie along y.
    fn rails(&self) -> [[f64; 2]; 2] {
        let [left, right] = self.beam_ends();
        [[left, left + self.rail()], [right - self.rail(), right]]
    }

    /// Back and front of the beam along x, from the axis of the quill.
    fn beam_sides(&self) -> [f64; 2] {
        let front = -(self.quill_width / 2.0 + GAP + self.plate + GAP);
        [front - self.beam[0], front]
    }

    /// Lower and upper side of the beam.
    fn beam_heights(&self) -> [f64; 2] {
        let bottom = self.travel[2][1] + CLEARANCE;
        [bottom, bottom + self.beam[1]]
    }

    /// Height of the trucks that carry the beam.
    fn truck(&self) -> f64 {
        0.5 * self.beam[0]
    }

    fn base(&self) -> Vec<Solid> {
        let [travel_x, travel_y, travel_z] = self.travel;
        let table = travel_z[0] - self.given.tool_length - CLEARANCE;
        let rail_top = self.beam_heights()[0] - self.truck() - GAP;
        let rail_bottom = rail_top - 0.5 * self.rail();
        // The posts reach below the table even if the tool is short and the beam thick.
        let floor = (table - self.rail()).min(rail_bottom - self.rail());
        let [back, front] = self.beam_sides();
        let ends = [travel_x[0] + back - self.truck(), travel_x[1] + front + self.truck()];
        let side = self.carriage_width / 2.0;
        let mut solids = vec![cuboid(
            [travel_x[0] - side, travel_y[0] - side, floor],
            [travel_x[1] + side, travel_y[1] + side, table],
            paint::SLATE,
        )];
        for [left, right] in self.rails() {
            solids.push(cuboid(
                [ends[0], left, rail_bottom],
                [ends[1], right, rail_top],
                paint::STEEL,
            ));
            for start in [ends[0], ends[1] - self.rail()] {
                let end = start + self.rail();
                solids.push(cuboid(
                    [start, left, floor],
                    [end, right, rail_bottom],
                    paint::GRAPHITE,
                ));
            }
        }
        solids
    }

    /// In a frame that moves along x with the flange.
    fn bridge(&self) -> Link {
        let ([back, front], [bottom, top], [left, right]) =
            (self.beam_sides(), self.beam_heights(), self.beam_ends());
        let beam = cuboid([back, left, bottom], [front, right, top], paint::IVORY);
        let inertial = Some(beam.uniform(self.bridge_mass));
        let mut solids = vec![beam];
        let overhang = 0.8 * self.truck();
        for [left, right] in self.rails() {
            let low = [back - overhang, left, bottom - self.truck()];
            solids.push(cuboid(low, [front + overhang, right, bottom], paint::GRAPHITE));
        }
        Link { name: "bridge".to_owned(), inertial, solids }
    }

    /// In a frame that moves along x and y with the flange.
    fn carriage(&self) -> Link {
        let [bottom, top] = self.beam_heights();
        let front = -(self.quill_width / 2.0 + GAP);
        let (back, side) = (front - self.plate, self.carriage_width / 2.0);
        let plate = cuboid([back, -side, bottom], [front, side, top], paint::BLUE);
        let inertial = Some(plate.uniform(self.carriage_mass));
        // A saddle over the beam, with the motor of the quill on it.
        let saddle = cuboid(
            [back - 0.6 * self.beam[0], -side, top + GAP],
            [front, side, top + GAP + self.plate],
            paint::BLUE,
        );
        let motor = upright(
            back - 0.3 * self.beam[0],
            0.0,
            [top + GAP + self.plate, top + GAP + self.plate + self.quill_width],
            0.25 * self.beam[0],
            paint::GRAPHITE,
        );
        Link { name: "carriage".to_owned(), inertial, solids: vec![plate, saddle, motor] }
    }

    /// The quill and its tool, in the frame of the flange.
    fn quill(&self) -> Link {
        let half = self.quill_width / 2.0;
        let quill = cuboid([-half, -half, 0.0], [half, half, self.quill_length], paint::STEEL);
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
