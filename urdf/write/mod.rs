//! URDF writer: a model as URDF text.
//!
//! Every link has `<visual>` and `<collision>` solids, equal unless the model has separate collision solids; colours
//! are materials of the robot; the tool tip is the link [`TIP_NAME`], fixed to the link that carries it. Reading the
//! text gives the same numbers to the last digit: numbers have as many digits as needed, and an orientation that roll,
//! pitch and yaw cannot reproduce also has a quaternion attribute ([`QUATERNION`]), which other readers ignore.
//!
//! URDF has neither a joint moved by several axes nor a kinematic loop. Such joints are written as if they had
//! positions of their own, and an element `<twin>`, which other readers ignore, holds the couplings:
//!
//! ```xml
//! <twin>
//!   <drive joint="bridge"><part axis="0" factor="0.5"/><part axis="1" factor="-0.5"/></drive>
//!   <drive joint="Z" axis="0"/>                     <!-- where the axes are not in the order of their joints -->
//!   <passive joint="rod1_swing" rest="0.1"/>
//!   <loop from="rod2" to="platform"><point xyz="0 0 -0.5"/><point xyz="0.1 0 0"/></loop>
//! </twin>
//! ```
//!
//! URDF 1.0 cannot say "no limit" (an absent one is read as 0), and the readers most in use refuse anything newer. So
//! the text is URDF 1.0 if every prismatic or revolute joint has all limits and no other joint has any, and 1.2
//! otherwise.

mod xml;

use crate::check::{check_inertial, check_joint, check_solid};
use crate::{
    Inertial, Joint, JointDrive, JointKind, Loop, Model, QUATERNION, SolidShape, TIP_NAME,
    UrdfError,
};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use xml::Xml;

impl Model {
    /// This model as URDF text.
    ///
    /// # Errors
    /// [`UrdfError`] if names repeat or are empty, if a number is not finite, if a solid or a mass is not above 0, if
    /// the joints do not make a tree.
    pub fn to_urdf(&self) -> Result<String, UrdfError> {
        self.check_tree()?;
        let mut palette = Palette::default();
        let mut xml = Xml::default();
        xml.open("robot").attribute("name", &self.name);
        if !self.joints.iter().all(is_limited) {
            xml.attribute("version", "1.2");
        }
        for color in self.links.iter().flat_map(|link| &link.solids).map(|solid| solid.color) {
            palette.add(color);
        }
        for (color, name) in palette.colors.iter().zip(1..) {
            xml.open("material").attribute("name", format!("color_{name}"));
            xml.open("color").numbers("rgba", *color).close();
            xml.close();
        }
        for link in &self.links {
            xml.open("link").attribute("name", &link.name);
            if let Some(inertial) = &link.inertial {
                check_inertial(&link.name, inertial)?;
                write_inertial(&mut xml, inertial);
            }
            for solid in &link.solids {
                check_solid(&link.name, solid)?;
                xml.open("visual");
                write_origin(&mut xml, &solid.origin);
                write_geometry(&mut xml, &solid.shape);
                let name = format!("color_{}", palette.add(solid.color));
                xml.open("material").attribute("name", name).close();
                xml.close();
            }
            for solid in link.collision_solids() {
                check_solid(&link.name, solid)?;
                xml.open("collision");
                write_origin(&mut xml, &solid.origin);
                write_geometry(&mut xml, &solid.shape);
                xml.close();
            }
            xml.close();
        }
        xml.open("link").attribute("name", TIP_NAME).close();
        for joint in &self.joints {
            self.write_joint(&mut xml, joint, self.link_name(joint.child))?;
        }
        self.write_joint(&mut xml, &self.tip_joint(), TIP_NAME)?;
        self.write_beyond(&mut xml);
        Ok(format!("<?xml version=\"1.0\"?>\n{}", xml.finish()))
    }

    fn link_name(&self, index: usize) -> &str {
        self.links.get(index).map_or("", |link| link.name.as_str())
    }

    fn write_joint(&self, xml: &mut Xml, joint: &Joint, child: &str) -> Result<(), UrdfError> {
        check_joint(joint)?;
        let kind = match joint.kind {
            JointKind::Fixed => "fixed",
            JointKind::Prismatic => "prismatic",
            JointKind::Revolute if joint.position_limits.is_some() => "revolute",
            JointKind::Revolute => "continuous",
        };
        xml.open("joint").attribute("name", &joint.name).attribute("type", kind);
        write_origin(xml, &joint.origin);
        xml.open("parent").attribute("link", self.link_name(joint.parent)).close();
        xml.open("child").attribute("link", child).close();
        if joint.kind != JointKind::Fixed || joint.axis != Vector3::x_axis() {
            xml.open("axis").numbers("xyz", joint.axis.into_inner().into()).close();
        }
        if joint.kind != JointKind::Fixed {
            write_limit(xml, joint);
        }
        let details = &joint.details;
        if let Some(calibration) = &details.calibration {
            xml.open("calibration");
            for (name, value) in [("rising", calibration.rising), ("falling", calibration.falling)]
            {
                if let Some(value) = value {
                    xml.attribute(name, value);
                }
            }
            xml.close();
        }
        if details.damping != 0.0 || details.friction != 0.0 {
            xml.open("dynamics").attribute("damping", details.damping);
            xml.attribute("friction", details.friction).close();
        }
        if let JointDrive::Mimic { joint: leader, multiplier, offset } = joint.drive {
            let leader = self.joints.get(leader).map_or("", |leader| leader.name.as_str());
            xml.open("mimic").attribute("joint", leader);
            xml.attribute("multiplier", multiplier).attribute("offset", offset).close();
        }
        if let Some(safety) = &details.safety {
            let [lower, upper] = safety.soft_limits;
            xml.open("safety_controller").attribute("soft_lower_limit", lower);
            xml.attribute("soft_upper_limit", upper).attribute("k_position", safety.k_position);
            xml.attribute("k_velocity", safety.k_velocity).close();
        }
        xml.close();
        Ok(())
    }

    fn tip_joint(&self) -> Joint {
        let point = self.tip.point;
        let origin = Isometry3::translation(point.x, point.y, point.z);
        let (links, axis) = ([self.tip.link, self.links.len()], Vector3::x_axis());
        Joint::new(TIP_NAME, JointKind::Fixed, links, origin, axis, JointDrive::Fixed)
    }

    /// Writes `<twin>`: couplings and loops, which a tree of independent joints cannot express.
    fn write_beyond(&self, xml: &mut Xml) {
        let mut own = 0;
        let mut is_plain = |joint: &Joint| match &joint.drive {
            JointDrive::Fixed | JointDrive::Mimic { .. } => true,
            JointDrive::Axis(axis) => {
                own += 1;
                *axis + 1 == own
            }
            JointDrive::Combination(_) | JointDrive::Passive { .. } => false,
        };
        if self.joints.iter().all(&mut is_plain) && self.loops.is_empty() {
            return;
        }
        xml.open("twin");
        for joint in &self.joints {
            match &joint.drive {
                JointDrive::Fixed | JointDrive::Mimic { .. } => {}
                JointDrive::Axis(axis) => {
                    xml.open("drive").attribute("joint", &joint.name).attribute("axis", axis);
                    xml.close();
                }
                JointDrive::Combination(parts) => {
                    xml.open("drive").attribute("joint", &joint.name);
                    for (axis, factor) in parts {
                        xml.open("part").attribute("axis", axis).attribute("factor", factor);
                        xml.close();
                    }
                    xml.close();
                }
                JointDrive::Passive { rest } => {
                    xml.open("passive").attribute("joint", &joint.name).attribute("rest", rest);
                    xml.close();
                }
            }
        }
        for Loop { links: [one, other], points } in &self.loops {
            xml.open("loop").attribute("from", self.link_name(*one));
            xml.attribute("to", self.link_name(*other));
            for point in points {
                xml.open("point").numbers("xyz", (*point).into()).close();
            }
            xml.close();
        }
        xml.close();
    }
}

/// Colours as materials of the robot, one each.
#[derive(Default)]
struct Palette {
    colors: Vec<[f64; 4]>,
}

impl Palette {
    /// The number of `color`, from 1, added if it is new.
    fn add(&mut self, color: [f64; 4]) -> usize {
        let same = |other: &[f64; 4]| other.map(f64::to_bits) == color.map(f64::to_bits);
        if let Some(index) = self.colors.iter().position(same) {
            return index + 1;
        }
        self.colors.push(color);
        self.colors.len()
    }
}

/// True if URDF 1.0 can say what limits this joint.
fn is_limited(joint: &Joint) -> bool {
    let speaks = |limit: Option<f64>| limit.is_some_and(|limit| limit.is_finite() && limit > 0.0);
    let position = match joint.position_limits {
        Some(limits) => limits.iter().all(|limit| limit.is_finite()) && limits != [0.0, 0.0],
        None => joint.kind == JointKind::Revolute,
    };
    joint.kind == JointKind::Fixed
        || position
            && speaks(joint.velocity_limit)
            && speaks(joint.effort_limit)
            && joint.details.motion_limits == [None; 3]
}

fn write_limit(xml: &mut Xml, joint: &Joint) {
    let [lower, upper] = joint.position_limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let [acceleration, deceleration, jerk] = joint.details.motion_limits;
    let limits = [
        ("lower", Some(lower)),
        ("upper", Some(upper)),
        ("effort", joint.effort_limit),
        ("velocity", joint.velocity_limit),
        ("acceleration", acceleration),
        ("deceleration", deceleration),
        ("jerk", jerk),
    ];
    xml.open("limit");
    for (name, value) in limits {
        if let Some(value) = value.filter(|value| value.is_finite()) {
            xml.attribute(name, value);
        } else if name == "deceleration" && acceleration.is_some() {
            // Absent, it would be as large as the acceleration.
            xml.attribute(name, "inf");
        }
    }
    xml.close();
}

fn write_inertial(xml: &mut Xml, inertial: &Inertial) {
    let m = &inertial.inertia;
    xml.open("inertial");
    xml.open("origin").numbers("xyz", inertial.center.into()).numbers("rpy", [0.0; 3]).close();
    xml.open("mass").attribute("value", inertial.mass).close();
    xml.open("inertia");
    let moments = [m.m11, m.m12, m.m13, m.m22, m.m23, m.m33];
    for (name, value) in ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"].into_iter().zip(moments) {
        xml.attribute(name, value);
    }
    xml.close();
    xml.close();
}

fn write_geometry(xml: &mut Xml, shape: &SolidShape) {
    xml.open("geometry");
    match shape {
        SolidShape::Box { size } => xml.open("box").numbers("size", (*size).into()),
        SolidShape::Cylinder { radius, length } => {
            xml.open("cylinder").attribute("radius", radius).attribute("length", length)
        }
        SolidShape::Sphere { radius } => xml.open("sphere").attribute("radius", radius),
        SolidShape::Capsule { radius, length } => {
            xml.open("capsule").attribute("radius", radius).attribute("length", length)
        }
        SolidShape::Mesh { mesh, scale } => {
            xml.open("mesh").attribute("filename", mesh.file());
            if *scale != Vector3::repeat(1.0) {
                xml.numbers("scale", (*scale).into());
            }
            &mut *xml
        }
    }
    .close();
    xml.close();
}

fn write_origin(xml: &mut Xml, origin: &Isometry3<f64>) {
    let angles = roll_pitch_yaw(origin);
    xml.open("origin").numbers("xyz", origin.translation.vector.into()).numbers("rpy", angles);
    let [x, y, z, w] = origin.rotation.coords.into();
    let [roll, pitch, yaw] = angles;
    let back: [f64; 4] = UnitQuaternion::from_euler_angles(roll, pitch, yaw).coords.into();
    // −0 is 0.
    let bits = |values: [f64; 4]| values.map(|value| (value + 0.0).to_bits());
    if bits(back) != bits([x, y, z, w]) {
        xml.numbers(QUATERNION, [w, x, y, z]);
    }
    xml.close();
}

/// Roll, pitch and yaw of R = Rz(yaw)·Ry(pitch)·Rx(roll), to within rounding also where the pitch is ±90° and an arc
/// sine would lose half the digits: pitch and roll are read from the matrix with the yaw, whatever it is, undone.
fn roll_pitch_yaw(origin: &Isometry3<f64>) -> [f64; 3] {
    let rotation = origin.rotation.to_rotation_matrix();
    let m = rotation.matrix();
    let yaw = m.m21.atan2(m.m11);
    let (sin, cos) = yaw.sin_cos();
    let pitch = (0.0 - m.m31).atan2(cos * m.m11 + sin * m.m21);
    let roll = (sin * m.m13 - cos * m.m23).atan2(cos * m.m22 - sin * m.m12);
    [roll, pitch, yaw].map(|angle| angle + 0.0)
}
