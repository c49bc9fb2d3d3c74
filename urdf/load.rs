//! A model from URDF text.
//!
//! What a [`Model`] cannot hold is refused by name, not dropped: meshes, capsules and textures; mimicking, planar,
//! floating and spherical joints, calibration, safety controllers, damping and friction, limits of acceleration and jerk;
//! collision geometry other than the visual one. A link with only one of the two has that one as its solids. Elements
//! beside links, joints and materials (transmissions, simulator settings) say nothing about the machine's bodies and are
//! passed over, as URDF readers do. URDF is a tree in which every joint has a position of its own: what is read has neither
//! loops nor joints that axes share.
//!
//! Before URDF 1.2 an absent limit of effort or velocity is 0 in the text; 0 is therefore read as "no limit" there.

use crate::inertial::turned;
use crate::to_urdf::{check_inertial, check_measures};
use crate::{
    Inertial, Joint, JointDrive, JointKind, Link, Model, Part, Solid, SolidShape, TIP_NAME, Tip,
    UrdfError,
};
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use std::collections::{HashMap, HashSet};
use urdf_rs::{Geometry, JointType, Material, Pose};

/// What a solid looks like of which the file does not say it.
const GREY: [f64; 4] = [0.6, 0.6, 0.6, 1.0];

impl Model {
    /// Reads URDF text. A joint that moves is the joint of the machine axis of its name: `axis_names` are the names of
    /// the axes in the order of the machine file.
    ///
    /// # Errors
    /// [`UrdfError`] names the link or joint and what is wrong with it or not supported.
    pub fn from_urdf(text: &str, axis_names: &[&str]) -> Result<Self, UrdfError> {
        let robot = urdf_rs::read_from_string(text).map_err(UrdfError::Text)?;
        let colors = colors(&robot);
        let tree = Tree::new(&robot)?;
        if tree.base.name == TIP_NAME {
            return Err(UrdfError::Tip);
        }
        let limits_are_optional = is_1_2(robot.version.as_deref());

        let mut model = Self {
            name: robot.name.clone(),
            links: vec![read_link(tree.base, &colors)?],
            joints: Vec::new(),
            loops: Vec::new(),
            tip: Tip { link: 0, point: Point3::origin() },
        };
        let mut index_of = HashMap::from([(tree.base.name.as_str(), 0)]);
        let mut tip = None;
        for (joint, child) in tree.joints {
            let parent = index_of.get(joint.parent.link.as_str()).copied();
            let Some(parent) = parent else {
                return Err(UrdfError::Tip);
            };
            if child.name == TIP_NAME {
                tip = Some(read_tip(joint, child, parent)?);
                continue;
            }
            let index = model.links.len();
            index_of.insert(child.name.as_str(), index);
            model.links.push(read_link(child, &colors)?);
            model.joints.push(read_joint(joint, parent, index, axis_names, limits_are_optional)?);
        }
        model.tip = tip.ok_or(UrdfError::NoTip)?;
        let lacks_joint =
            |axis: &&&str| !model.moving_joints().any(|(_, joint)| joint.name == **axis);
        if let Some(axis) = axis_names.iter().find(lacks_joint) {
            return Err(UrdfError::NoJoint { axis: (*axis).to_owned() });
        }
        Ok(model)
    }
}

/// The joints of a robot, parents before children, otherwise as in the file.
struct Tree<'a> {
    base: &'a urdf_rs::Link,
    joints: Vec<(&'a urdf_rs::Joint, &'a urdf_rs::Link)>,
}

impl<'a> Tree<'a> {
    fn new(robot: &'a urdf_rs::Robot) -> Result<Self, UrdfError> {
        let mut links = HashMap::new();
        for link in &robot.links {
            if link.name.is_empty() {
                return Err(UrdfError::NoName);
            }
            if links.insert(link.name.as_str(), link).is_some() {
                return Err(UrdfError::Twice { part: Part::Link(link.name.clone()) });
            }
        }
        let mut names = HashSet::new();
        let mut parent_joint: HashMap<&str, &str> = HashMap::new();
        for joint in &robot.joints {
            if joint.name.is_empty() {
                return Err(UrdfError::NoName);
            }
            if !names.insert(joint.name.as_str()) {
                return Err(UrdfError::Twice { part: Part::Joint(joint.name.clone()) });
            }
            for end in [&joint.parent.link, &joint.child.link] {
                if !links.contains_key(end.as_str()) {
                    return Err(UrdfError::NoLink { joint: joint.name.clone(), link: end.clone() });
                }
            }
            if let Some(other) = parent_joint.insert(&joint.child.link, &joint.name) {
                let joints = [other.to_owned(), joint.name.clone()];
                return Err(UrdfError::TwoParents { link: joint.child.link.clone(), joints });
            }
        }
        let mut bases =
            robot.links.iter().filter(|link| !parent_joint.contains_key(link.name.as_str()));
        let base = bases.next().ok_or(UrdfError::NoBase)?;
        if let Some(other) = bases.next() {
            return Err(UrdfError::TwoBases { links: [base.name.clone(), other.name.clone()] });
        }

        let mut joints = Vec::with_capacity(robot.joints.len());
        let mut placed = HashSet::from([base.name.as_str()]);
        let mut waiting: Vec<&urdf_rs::Joint> = robot.joints.iter().collect();
        while !waiting.is_empty() {
            let before = waiting.len();
            waiting.retain(|joint| {
                let child = links.get(joint.child.link.as_str()).copied();
                match child {
                    Some(child) if placed.contains(joint.parent.link.as_str()) => {
                        placed.insert(child.name.as_str());
                        joints.push((*joint, child));
                        false
                    }
                    _ => true,
                }
            });
            if let Some(joint) = waiting.first()
                && waiting.len() == before
            {
                return Err(UrdfError::Loop { joint: joint.name.clone() });
            }
        }
        Ok(Self { base, joints })
    }
}

/// Whether absent limits are told apart from 0.
fn is_1_2(version: Option<&str>) -> bool {
    let numbers = version.and_then(|version| version.trim().split_once('.'));
    let numbers = numbers
        .and_then(|(major, minor)| Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?)));
    numbers.is_some_and(|version| version >= (1, 2))
}

/// Colours by the names of their materials, wherever in the file they are defined.
fn colors(robot: &urdf_rs::Robot) -> HashMap<&str, [f64; 4]> {
    let inside = robot
        .links
        .iter()
        .flat_map(|link| &link.visual)
        .filter_map(|visual| visual.material.as_ref());
    // What the robot defines wins over what a link defines in passing.
    let all = inside.chain(&robot.materials);
    all.filter_map(|material| Some((material.name.as_str(), *material.color.as_ref()?.rgba)))
        .collect()
}

fn read_color(
    link: &str,
    material: Option<&Material>,
    colors: &HashMap<&str, [f64; 4]>,
) -> Result<[f64; 4], UrdfError> {
    let Some(material) = material else { return Ok(GREY) };
    let part = || Part::Link(link.to_owned());
    if material.texture.is_some() {
        return Err(UrdfError::Unsupported { part: part(), what: "a texture" });
    }
    let own = material.color.as_ref().map(|color| *color.rgba);
    let Some(color) = own.or_else(|| colors.get(material.name.as_str()).copied()) else {
        return Err(UrdfError::NoColor { link: link.to_owned(), material: material.name.clone() });
    };
    if color.iter().all(|value| value.is_finite()) {
        Ok(color)
    } else {
        Err(UrdfError::NotFinite { part: part(), what: "a colour" })
    }
}

fn read_link(link: &urdf_rs::Link, colors: &HashMap<&str, [f64; 4]>) -> Result<Link, UrdfError> {
    let part = || Part::Link(link.name.clone());
    let mut solids = Vec::new();
    for visual in &link.visual {
        let (origin, shape) = read_body(part, &visual.origin, &visual.geometry)?;
        let color = read_color(&link.name, visual.material.as_ref(), colors)?;
        solids.push(Solid { shape, origin, color });
    }
    let mut collisions = Vec::new();
    for collision in &link.collision {
        let (origin, shape) = read_body(part, &collision.origin, &collision.geometry)?;
        collisions.push(Solid { shape, origin, color: GREY });
    }
    if solids.is_empty() {
        solids = collisions;
    } else if !collisions.is_empty() {
        let same =
            |(seen, hit): (&Solid, &Solid)| seen.shape == hit.shape && seen.origin == hit.origin;
        if solids.len() != collisions.len() || !solids.iter().zip(&collisions).all(same) {
            return Err(UrdfError::CollisionDiffers { link: link.name.clone() });
        }
    }
    Ok(Link { name: link.name.clone(), inertial: read_inertial(link)?, solids })
}

fn read_body(
    part: impl Fn() -> Part,
    origin: &Pose,
    geometry: &Geometry,
) -> Result<(Isometry3<f64>, SolidShape), UrdfError> {
    let shape = match *geometry {
        Geometry::Box { size } => SolidShape::Box { size: Vector3::from(*size) },
        Geometry::Cylinder { radius, length } => SolidShape::Cylinder { radius, length },
        Geometry::Sphere { radius } => SolidShape::Sphere { radius },
        Geometry::Capsule { .. } => {
            return Err(UrdfError::Unsupported { part: part(), what: "a capsule" });
        }
        Geometry::Mesh { .. } => {
            return Err(UrdfError::Unsupported { part: part(), what: "a mesh" });
        }
    };
    check_measures(&part, &shape)?;
    Ok((read_pose(&part, origin)?, shape))
}

fn read_pose(part: impl Fn() -> Part, pose: &Pose) -> Result<Isometry3<f64>, UrdfError> {
    if !pose.xyz.iter().chain(pose.rpy.iter()).all(|value| value.is_finite()) {
        return Err(UrdfError::NotFinite { part: part(), what: "an origin" });
    }
    let [roll, pitch, yaw] = *pose.rpy;
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Ok(Isometry3::from_parts(Translation3::from(Vector3::from(*pose.xyz)), rotation))
}

fn read_inertial(link: &urdf_rs::Link) -> Result<Option<Inertial>, UrdfError> {
    let urdf_rs::Inertial { origin, mass, inertia } = &link.inertial;
    let along = Matrix3::new(
        inertia.ixx,
        inertia.ixy,
        inertia.ixz, //
        inertia.ixy,
        inertia.iyy,
        inertia.iyz, //
        inertia.ixz,
        inertia.iyz,
        inertia.izz,
    );
    // What urdf-rs makes of a link without <inertial>.
    if mass.value == 0.0 && along == Matrix3::zeros() {
        return Ok(None);
    }
    let origin = read_pose(|| Part::Link(link.name.clone()), origin)?;
    let inertia = if origin.rotation == UnitQuaternion::identity() {
        along
    } else {
        turned(&along, &origin.rotation)
    };
    let inertial = Inertial { mass: mass.value, center: origin.translation.vector.into(), inertia };
    check_inertial(&link.name, &inertial)?;
    Ok(Some(inertial))
}

fn read_tip(joint: &urdf_rs::Joint, link: &urdf_rs::Link, parent: usize) -> Result<Tip, UrdfError> {
    let bare =
        link.visual.is_empty() && link.collision.is_empty() && read_inertial(link)?.is_none();
    if joint.joint_type != JointType::Fixed || !bare {
        return Err(UrdfError::Tip);
    }
    let origin = read_pose(|| Part::Joint(joint.name.clone()), &joint.origin)?;
    Ok(Tip { link: parent, point: origin.translation.vector.into() })
}

fn read_joint(
    joint: &urdf_rs::Joint,
    parent: usize,
    child: usize,
    axis_names: &[&str],
    limits_are_optional: bool,
) -> Result<Joint, UrdfError> {
    let part = || Part::Joint(joint.name.clone());
    let unsupported = |what| Err(UrdfError::Unsupported { part: part(), what });
    let kind = match joint.joint_type {
        JointType::Revolute | JointType::Continuous => JointKind::Revolute,
        JointType::Prismatic => JointKind::Prismatic,
        JointType::Fixed => JointKind::Fixed,
        JointType::Floating => return unsupported("a floating joint"),
        JointType::Planar => return unsupported("a planar joint"),
        JointType::Spherical => return unsupported("a spherical joint"),
    };
    if joint.mimic.is_some() {
        return unsupported("<mimic>");
    }
    if joint.calibration.is_some() {
        return unsupported("<calibration>");
    }
    if joint.safety_controller.is_some() {
        return unsupported("<safety_controller>");
    }
    if joint
        .dynamics
        .as_ref()
        .is_some_and(|dynamics| dynamics.damping != 0.0 || dynamics.friction != 0.0)
    {
        return unsupported("<dynamics> with damping or friction");
    }
    let origin = read_pose(part, &joint.origin)?;
    let axis = read_axis(joint, kind)?;
    let mut read = Joint {
        name: joint.name.clone(),
        kind,
        parent,
        child,
        origin,
        axis,
        drive: JointDrive::Fixed,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    if kind == JointKind::Fixed {
        return Ok(read);
    }
    let axis = axis_names.iter().position(|name| *name == joint.name);
    let no_axis = || UrdfError::NoAxis { joint: joint.name.clone() };
    read.drive = JointDrive::Axis(axis.ok_or_else(no_axis)?);
    read_limits(joint, &mut read, limits_are_optional)?;
    Ok(read)
}

fn read_axis(joint: &urdf_rs::Joint, kind: JointKind) -> Result<Unit<Vector3<f64>>, UrdfError> {
    let axis = Vector3::from(*joint.axis.xyz);
    if !axis.iter().all(|value| value.is_finite()) {
        return Err(UrdfError::NotFinite {
            part: Part::Joint(joint.name.clone()),
            what: "its axis",
        });
    }
    // A direction that has length 1 already is kept to the last digit.
    if (axis.norm() - 1.0).abs() <= 4.0 * f64::EPSILON {
        return Ok(Unit::new_unchecked(axis));
    }
    match Unit::try_new(axis, 0.0) {
        Some(direction) => Ok(direction),
        None if kind == JointKind::Fixed => Ok(Vector3::x_axis()),
        None => Err(UrdfError::NoDirection { joint: joint.name.clone() }),
    }
}

fn read_limits(
    joint: &urdf_rs::Joint,
    read: &mut Joint,
    limits_are_optional: bool,
) -> Result<(), UrdfError> {
    let limit = &joint.limit;
    let part = || Part::Joint(joint.name.clone());
    if [limit.lower, limit.upper, limit.velocity, limit.effort].iter().any(|value| value.is_nan()) {
        return Err(UrdfError::NotFinite { part: part(), what: "a limit" });
    }
    if [limit.acceleration, limit.deceleration, limit.jerk].iter().any(|value| value.is_finite()) {
        return Err(UrdfError::Unsupported {
            part: part(),
            what: "a limit of acceleration or jerk",
        });
    }
    let given =
        |value: f64| (value.is_finite() && (limits_are_optional || value != 0.0)).then_some(value);
    read.velocity_limit = given(limit.velocity);
    read.effort_limit = given(limit.effort);
    if joint.joint_type == JointType::Continuous {
        return Ok(());
    }
    if !limits_are_optional && limit.lower == 0.0 && limit.upper == 0.0 {
        return Err(UrdfError::NoLimits { joint: joint.name.clone() });
    }
    if limit.lower > limit.upper {
        return Err(UrdfError::Limits {
            joint: joint.name.clone(),
            lower: limit.lower,
            upper: limit.upper,
        });
    }
    if limit.lower.is_finite() || limit.upper.is_finite() {
        read.position_limits = Some([limit.lower, limit.upper]);
    }
    Ok(())
}
