//! Model of a machine: links, joints, solids and inertial properties, for physics and pictures.

use crate::Mesh;
use nalgebra::{Isometry3, Matrix3, Point3, Unit, Vector3};
use std::sync::Arc;

/// A tree of links, joined by joints. Link 0 is the base, fixed in the machine frame; every other link is the child
/// of exactly one joint, and joints are ordered so that a parent comes before its children. Machines whose links go round
/// in a circle are cut open somewhere, and [`Model::loops`] says where.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Name of the machine.
    pub name: String,
    /// The links; 0 is the base.
    pub links: Vec<Link>,
    /// The joints, `joints[i].child == i + 1`.
    pub joints: Vec<Joint>,
    /// Loops that close the tree of joints; the positions of passive joints follow from it.
    pub loops: Vec<Loop>,
    /// The link that carries the tool, and the tool tip in its frame, m.
    pub tip: Tip,
}

/// A ball joint that closes a circle of links: a point of one link is where a point of another is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// Indices into [`Model::links`].
    pub links: [usize; 2],
    /// A point in the frame of each, m.
    pub points: [Point3<f64>; 2],
}

/// Tool tip: its link and its position there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tip {
    /// Index into [`Model::links`].
    pub link: usize,
    /// In the frame of that link, m.
    pub point: Point3<f64>,
}

/// A rigid body. Its frame is the frame of the joint that moves it.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Unique name.
    pub name: String,
    /// Mass and inertia; `None` for the base or a massless frame.
    pub inertial: Option<Inertial>,
    /// Visible solids.
    pub solids: Vec<Solid>,
    /// Solids for collisions, if they differ from the visible ones; empty if they do not. Colours mean nothing here.
    pub collision: Vec<Solid>,
}

impl Link {
    /// A link whose visible solids are its collision solids.
    pub fn new(name: impl Into<String>, inertial: Option<Inertial>, solids: Vec<Solid>) -> Self {
        Self { name: name.into(), inertial, solids, collision: Vec::new() }
    }

    /// Solids for collisions.
    pub fn collision_solids(&self) -> &[Solid] {
        if self.collision.is_empty() { &self.solids } else { &self.collision }
    }
}

/// Mass properties of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertial {
    /// kg.
    pub mass: f64,
    /// Centre of mass in the link frame, m.
    pub center: Point3<f64>,
    /// Inertia about the centre of mass, axes parallel to the link frame, kg·m².
    pub inertia: Matrix3<f64>,
}

/// A simple body in the frame of its link.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Shape, centred on its own origin.
    pub shape: SolidShape,
    /// Pose of the shape in the link frame.
    pub origin: Isometry3<f64>,
    /// Red, green, blue, alpha in 0..=1.
    pub color: [f64; 4],
}

/// The shape of a [`Solid`], all measures in m.
#[derive(Clone, Debug, PartialEq)]
pub enum SolidShape {
    /// Edge lengths along x, y, z.
    Box {
        /// Full edge lengths.
        size: Vector3<f64>,
    },
    /// About the z axis.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Full length along z.
        length: f64,
    },
    /// About the origin.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// About the z axis: a cylinder between two half spheres.
    Capsule {
        /// Radius.
        radius: f64,
        /// Length along z between the centres of the half spheres.
        length: f64,
    },
    /// Triangles from a file.
    Mesh {
        /// The mesh of the file.
        mesh: Arc<Mesh>,
        /// Factor from its coordinates to m; below 0 mirrors.
        scale: Vector3<f64>,
    },
}

/// A joint: moves its child link along or about [`Joint::axis`].
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Unique name; the name of the machine axis that moves it, if a single one does.
    pub name: String,
    /// Kind of motion.
    pub kind: JointKind,
    /// Parent link.
    pub parent: usize,
    /// Child link.
    pub child: usize,
    /// Pose of the joint frame in the parent link at joint position 0.
    pub origin: Isometry3<f64>,
    /// Direction of motion in the joint frame.
    pub axis: Unit<Vector3<f64>>,
    /// Source of its position. Zero offsets of a machine are inside [`Joint::origin`].
    pub drive: JointDrive,
    /// Lower and upper position, m or rad.
    pub position_limits: Option<[f64; 2]>,
    /// m/s or rad/s.
    pub velocity_limit: Option<f64>,
    /// N or Nm.
    pub effort_limit: Option<f64>,
    /// Further properties from URDF.
    pub details: JointDetails,
}

/// Further properties of a joint in URDF: damping, friction, safety limits, calibration, motion limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointDetails {
    /// Friction proportional to velocity, N·s/m or Nm·s/rad.
    pub damping: f64,
    /// Dry friction, N or Nm.
    pub friction: f64,
    /// Limits that keep the joint away from its own.
    pub safety: Option<SafetyController>,
    /// Position of its reference switch.
    pub calibration: Option<Calibration>,
    /// Limits of acceleration, deceleration and jerk (m/s², m/s³; rad alike), since URDF 1.2.
    pub motion_limits: [Option<f64>; 3],
}

/// `<safety_controller>`: within the soft limits a controller leaves a joint alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafetyController {
    /// Lower and upper position, m or rad; as URDF has it, two zeros if the file does not say them.
    pub soft_limits: [f64; 2],
    /// Velocity limit per distance from a soft limit, 1/s.
    pub k_position: f64,
    /// Effort limit per distance from the velocity limit, N·s/m or Nm·s/rad.
    pub k_velocity: f64,
}

/// `<calibration>`: where the edges of a reference switch are, m or rad. It is kept, and nothing here follows from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Calibration {
    /// Moving up.
    pub rising: Option<f64>,
    /// Moving down.
    pub falling: Option<f64>,
}

impl Joint {
    /// A joint without limits.
    pub fn new(
        name: impl Into<String>,
        kind: JointKind,
        links: [usize; 2],
        origin: Isometry3<f64>,
        axis: Unit<Vector3<f64>>,
        drive: JointDrive,
    ) -> Self {
        let [parent, child] = links;
        Self {
            name: name.into(),
            kind,
            parent,
            child,
            origin,
            axis,
            drive,
            position_limits: None,
            velocity_limit: None,
            effort_limit: None,
            details: JointDetails::default(),
        }
    }

    /// Lower and upper position that may be used (m or rad): the limits, narrowed by those of a
    /// [safety controller](SafetyController) that has any.
    pub fn usable_limits(&self) -> Option<[f64; 2]> {
        let soft = self.details.safety.map(|safety| safety.soft_limits);
        let soft = soft.filter(|[lower, upper]| lower < upper);
        match (self.position_limits, soft) {
            (Some([lower, upper]), Some([soft_lower, soft_upper])) => {
                Some([lower.max(soft_lower), upper.min(soft_upper)])
            }
            (limits, soft) => limits.or(soft),
        }
    }
}

/// Kind of a joint's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Rotates about the axis, rad.
    Revolute,
    /// Slides along the axis, m.
    Prismatic,
    /// Does not move.
    Fixed,
}

/// Source of a joint's position (m or rad). Axes are counted from 0 in the order of the machine file.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum JointDrive {
    /// Nothing: the joint does not move.
    #[default]
    Fixed,
    /// It is the position of this axis.
    Axis(usize),
    /// It is the sum of axis positions, each times its factor: two motors on one belt.
    Combination(Vec<(usize, f64)>),
    /// Its position closes the [loops](Model::loops). Without loops the joint is at `rest`.
    Passive {
        /// Its position with every driven joint in the middle of its limits (at 0 without): where the search begins.
        rest: f64,
    },
    /// It is that of another joint times `multiplier`, and `offset` more (`<mimic>`).
    Mimic {
        /// Index into [`Model::joints`].
        joint: usize,
        /// m or rad per m or rad of the other joint.
        multiplier: f64,
        /// m or rad.
        offset: f64,
    },
}

impl JointDrive {
    /// The axis whose position is the joint's, if there is one.
    pub const fn axis(&self) -> Option<usize> {
        match self {
            Self::Axis(axis) => Some(*axis),
            Self::Fixed | Self::Combination(_) | Self::Passive { .. } | Self::Mimic { .. } => None,
        }
    }
}
