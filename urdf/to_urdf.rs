//! A model as URDF text.
//!
//! Every link is written with its solids both as `<visual>` and as `<collision>`; colours are materials of the robot;
//! the tool tip is the link [`TIP_NAME`], fixed to the link that carries it. Numbers are written with the digits it takes
//! to read the same number back. Rotations pass through roll, pitch and yaw and come back to within rounding.
//!
//! URDF knows neither a joint that several axes move nor a circle of links: such joints are written as if they had
//! positions of their own, and a comment says how they hang together.
//!
//! URDF 1.0 cannot say "no limit" (an absent one is read as 0), and the readers most in use refuse anything newer. So
//! the text is URDF 1.0 where every prismatic or revolute joint has all limits, and 1.2, which can, where one lacks.

use crate::{
    Inertial, Joint, JointDrive, JointKind, Loop, Model, Part, Solid, SolidShape, TIP_NAME,
    UrdfError,
};
use nalgebra::{Isometry3, Point3, Vector3};
use std::collections::HashSet;
use urdf_rs::{
    Axis, Collision, Color, Geometry, JointLimit, JointType, LinkName, Mass, Material, Pose, Vec3,
    Vec4, Visual,
};

impl Model {
    /// This model as URDF text.
    ///
    /// # Errors
    /// [`UrdfError`] if names repeat or are empty, if a number is not finite, if a solid or a mass is not above 0, if
    /// the joints do not make a tree.
    pub fn to_urdf(&self) -> Result<String, UrdfError> {
        self.check_tree()?;
        let mut palette = Palette::default();
        let mut links = Vec::with_capacity(self.links.len() + 1);
        for link in &self.links {
            let mut visual = Vec::with_capacity(link.solids.len());
            let mut collision = Vec::with_capacity(link.solids.len());
            for solid in &link.solids {
                check_solid(&link.name, solid)?;
                let (origin, geometry) = (pose(&solid.origin), geometry(&solid.shape));
                let material =
                    Some(Material { name: palette.name(solid.color), color: None, texture: None });
                visual.push(Visual {
                    name: None,
                    origin: origin.clone(),
                    geometry: geometry.clone(),
                    material,
                });
                collision.push(Collision { name: None, origin, geometry });
            }
            let inertial = link
                .inertial
                .as_ref()
                .map(|inertial| write_inertial(&link.name, inertial))
                .transpose()?;
            links.push(urdf_rs::Link {
                name: link.name.clone(),
                inertial: inertial.unwrap_or_default(),
                visual,
                collision,
            });
        }
        let mut joints = Vec::with_capacity(self.joints.len() + 1);
        for joint in &self.joints {
            joints.push(self.write_joint(joint)?);
        }
        links.push(urdf_rs::Link {
            name: TIP_NAME.to_owned(),
            inertial: urdf_rs::Inertial::default(),
            visual: Vec::new(),
            collision: Vec::new(),
        });
        joints.push(self.tip_joint()?);
        let limited = self.joints.iter().all(is_limited);
        let robot = urdf_rs::Robot {
            name: self.name.clone(),
            version: if limited { None } else { Some("1.2".to_owned()) },
            links,
            joints,
            materials: palette.materials,
        };
        let body = urdf_rs::write_to_string(&robot).map_err(UrdfError::Text)?;
        Ok(format!("<?xml version=\"1.0\"?>\n{}{body}\n", self.coupling_comment()))
    }
}

impl Model {
    /// That links and joints are in the order that [`Model`] promises and have names of their own.
    fn check_tree(&self) -> Result<(), UrdfError> {
        if self.links.len() != self.joints.len() + 1 {
            return Err(UrdfError::Count { links: self.links.len(), joints: self.joints.len() });
        }
        for (index, joint) in self.joints.iter().enumerate() {
            if joint.child != index + 1 || joint.parent > index {
                return Err(UrdfError::Order { joint: joint.name.clone() });
            }
        }
        if self.tip.link >= self.links.len() {
            return Err(UrdfError::NoTip);
        }
        check_names(
            self.links.iter().map(|link| link.name.as_str()).chain([TIP_NAME]),
            Part::Link,
        )?;
        check_names(
            self.joints.iter().map(|joint| joint.name.as_str()).chain([TIP_NAME]),
            Part::Joint,
        )
    }

    /// A comment of what a tree of independent joints does not say; empty if there is nothing.
    fn coupling_comment(&self) -> String {
        let mut lines = Vec::new();
        for joint in &self.joints {
            match &joint.drive {
                JointDrive::Fixed | JointDrive::Axis(_) => {}
                JointDrive::Combination(parts) => {
                    let parts: Vec<_> = parts
                        .iter()
                        .map(|(axis, factor)| format!("{factor} * axis {axis}"))
                        .collect();
                    lines.push(format!("position of joint {} = {}", joint.name, parts.join(" + ")));
                }
                JointDrive::Passive { rest } => {
                    lines.push(format!("joint {} is passive; near {rest}", joint.name));
                }
            }
        }
        for Loop { links: [one, other], points: [point, other_point] } in &self.loops {
            let end = |link: usize, point: &Point3<f64>| {
                format!("{} {} {} of link {}", point.x, point.y, point.z, self.link_name(link).link)
            };
            lines.push(format!("point {} = point {}", end(*one, point), end(*other, other_point)));
        }
        if lines.is_empty() {
            return String::new();
        }
        // Two hyphens may not stand together in a comment, whatever the names are.
        let text = lines.join("\n  ").replace("--", "- -").replace("--", "- -");
        format!("<!--\n  Not said by URDF (axes counted from 0):\n  {text}\n-->\n")
    }

    fn link_name(&self, index: usize) -> LinkName {
        LinkName { link: self.links.get(index).map(|link| link.name.clone()).unwrap_or_default() }
    }

    fn write_joint(&self, joint: &Joint) -> Result<urdf_rs::Joint, UrdfError> {
        let finite = [
            ("its origin", is_finite(&joint.origin)),
            ("its axis", joint.axis.iter().all(|value| value.is_finite())),
            ("a limit", !joint.position_limits.iter().flatten().any(|limit| limit.is_nan())),
            (
                "a limit",
                !joint.velocity_limit.iter().chain(&joint.effort_limit).any(|limit| limit.is_nan()),
            ),
        ];
        if let Some(&(what, _)) = finite.iter().find(|(_, finite)| !finite) {
            return Err(UrdfError::NotFinite { part: Part::Joint(joint.name.clone()), what });
        }
        let [lower, upper] = joint.position_limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        let limit = JointLimit {
            lower,
            upper,
            effort: joint.effort_limit.unwrap_or(f64::INFINITY),
            velocity: joint.velocity_limit.unwrap_or(f64::INFINITY),
            ..JointLimit::default()
        };
        let joint_type = match joint.kind {
            JointKind::Fixed => JointType::Fixed,
            JointKind::Prismatic => JointType::Prismatic,
            JointKind::Revolute if joint.position_limits.is_some() => JointType::Revolute,
            JointKind::Revolute => JointType::Continuous,
        };
        Ok(urdf_rs::Joint {
            name: joint.name.clone(),
            origin: pose(&joint.origin),
            parent: self.link_name(joint.parent),
            child: self.link_name(joint.child),
            axis: Axis { xyz: Vec3(joint.axis.into_inner().into()) },
            // urdf-rs writes a <limit> whatever the joint; one without attributes it would not read again.
            limit: if joint_type == JointType::Fixed { JointLimit::default() } else { limit },
            joint_type,
            calibration: None,
            dynamics: None,
            mimic: None,
            safety_controller: None,
        })
    }

    fn tip_joint(&self) -> Result<urdf_rs::Joint, UrdfError> {
        let point = self.tip.point;
        self.write_joint(&Joint {
            name: TIP_NAME.to_owned(),
            kind: JointKind::Fixed,
            parent: self.tip.link,
            child: self.links.len(),
            origin: Isometry3::translation(point.x, point.y, point.z),
            axis: Vector3::x_axis(),
            drive: JointDrive::Fixed,
            position_limits: None,
            velocity_limit: None,
            effort_limit: None,
        })
        .map(|joint| urdf_rs::Joint { child: LinkName { link: TIP_NAME.to_owned() }, ..joint })
    }
}

/// Colours as materials of the robot, one each.
#[derive(Default)]
struct Palette {
    materials: Vec<Material>,
}

impl Palette {
    /// The material of `color`, added if it is new.
    fn name(&mut self, color: [f64; 4]) -> String {
        let same = |rgba: &Vec4| rgba.map(f64::to_bits) == color.map(f64::to_bits);
        let is_it =
            |material: &&Material| material.color.as_ref().is_some_and(|own| same(&own.rgba));
        if let Some(material) = self.materials.iter().find(is_it) {
            return material.name.clone();
        }
        let name = format!("color_{}", self.materials.len() + 1);
        self.materials.push(Material {
            name: name.clone(),
            color: Some(Color { rgba: Vec4(color) }),
            texture: None,
        });
        name
    }
}

/// Whether URDF 1.0 can say what limits this joint.
fn is_limited(joint: &Joint) -> bool {
    let speaks = |limit: Option<f64>| limit.is_some_and(|limit| limit.is_finite() && limit > 0.0);
    let position = match joint.position_limits {
        Some(limits) => limits.iter().all(|limit| limit.is_finite()) && limits != [0.0, 0.0],
        None => joint.kind == JointKind::Revolute,
    };
    joint.kind == JointKind::Fixed
        || position && speaks(joint.velocity_limit) && speaks(joint.effort_limit)
}

fn check_names<'a>(
    names: impl Iterator<Item = &'a str>,
    part: impl Fn(String) -> Part,
) -> Result<(), UrdfError> {
    let mut known = HashSet::new();
    for name in names {
        if name.is_empty() {
            return Err(UrdfError::NoName);
        }
        if !known.insert(name) {
            return Err(UrdfError::Twice { part: part(name.to_owned()) });
        }
    }
    Ok(())
}

fn is_finite(origin: &Isometry3<f64>) -> bool {
    origin.translation.vector.iter().chain(&origin.rotation.coords).all(|value| value.is_finite())
}

fn check_solid(link: &str, solid: &Solid) -> Result<(), UrdfError> {
    let part = || Part::Link(link.to_owned());
    if !is_finite(&solid.origin) {
        return Err(UrdfError::NotFinite { part: part(), what: "the origin of a solid" });
    }
    if !solid.color.iter().all(|value| value.is_finite()) {
        return Err(UrdfError::NotFinite { part: part(), what: "a colour" });
    }
    check_measures(part, &solid.shape)
}

/// That every measure of `shape` is finite and above 0.
pub(crate) fn check_measures(part: impl Fn() -> Part, shape: &SolidShape) -> Result<(), UrdfError> {
    let measures = match *shape {
        SolidShape::Box { size } => vec![
            ("an edge of a box", size.x),
            ("an edge of a box", size.y),
            ("an edge of a box", size.z),
        ],
        SolidShape::Cylinder { radius, length } => {
            vec![("the radius of a cylinder", radius), ("the length of a cylinder", length)]
        }
        SolidShape::Sphere { radius } => vec![("the radius of a sphere", radius)],
    };
    for (what, value) in measures {
        if !value.is_finite() {
            return Err(UrdfError::NotFinite { part: part(), what });
        }
        if value <= 0.0 {
            return Err(UrdfError::NotPositive { part: part(), what, value });
        }
    }
    Ok(())
}

/// That `inertial` is finite, has mass and no negative principal moment.
pub(crate) fn check_inertial(link: &str, inertial: &Inertial) -> Result<(), UrdfError> {
    let part = || Part::Link(link.to_owned());
    let finite = [
        ("its mass", inertial.mass.is_finite()),
        ("its centre of mass", inertial.center.iter().all(|value| value.is_finite())),
        ("its inertia", inertial.inertia.iter().all(|value| value.is_finite())),
    ];
    if let Some(&(what, _)) = finite.iter().find(|(_, finite)| !finite) {
        return Err(UrdfError::NotFinite { part: part(), what });
    }
    if inertial.mass <= 0.0 {
        return Err(UrdfError::NotPositive {
            part: part(),
            what: "its mass",
            value: inertial.mass,
        });
    }
    let smallest = inertial.inertia.symmetric_eigenvalues().min();
    if smallest < -1e-12 * inertial.inertia.trace().abs() {
        return Err(UrdfError::NotPositive {
            part: part(),
            what: "a principal moment of inertia",
            value: smallest,
        });
    }
    Ok(())
}

fn write_inertial(link: &str, inertial: &Inertial) -> Result<urdf_rs::Inertial, UrdfError> {
    check_inertial(link, inertial)?;
    let m = &inertial.inertia;
    Ok(urdf_rs::Inertial {
        origin: Pose { xyz: Vec3(inertial.center.into()), rpy: Vec3([0.0; 3]) },
        mass: Mass { value: inertial.mass },
        inertia: urdf_rs::Inertia {
            ixx: m.m11,
            ixy: m.m12,
            ixz: m.m13,
            iyy: m.m22,
            iyz: m.m23,
            izz: m.m33,
        },
    })
}

fn geometry(shape: &SolidShape) -> Geometry {
    match *shape {
        SolidShape::Box { size } => Geometry::Box { size: Vec3(size.into()) },
        SolidShape::Cylinder { radius, length } => Geometry::Cylinder { radius, length },
        SolidShape::Sphere { radius } => Geometry::Sphere { radius },
    }
}

fn pose(origin: &Isometry3<f64>) -> Pose {
    Pose { xyz: Vec3(origin.translation.vector.into()), rpy: Vec3(roll_pitch_yaw(origin)) }
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
    [roll, pitch, yaw]
}
