//! Errors of the simulated machine: invalid models, invalid inputs, and failures during motion.

use crate::side::Side;
use crate::surroundings::Part;
use std::fmt;
use twin_kinematics::MAX_AXES;

/// What the simulation gives.
pub type Result<T, E = PhysicsError> = std::result::Result<T, E>;

/// Subject of an error, counted from 0: axes in machine-file order, joints and links in that of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// An axis.
    Axis(usize),
    /// Index into [`twin_urdf::Model::joints`].
    Joint(usize),
    /// Index into [`twin_urdf::Model::links`].
    Link(usize),
    /// A part in contact.
    Part(Part),
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axis(axis) => write!(f, "axis {axis}"),
            Self::Joint(joint) => write!(f, "joint {joint}"),
            Self::Link(link) | Self::Part(Part::Link(link)) => write!(f, "link {link}"),
            Self::Part(Part::Tool) => f.write_str("the tool"),
            Self::Part(Part::Obstacle(obstacle)) => write!(f, "obstacle {obstacle}"),
            Self::Part(Part::Body(body)) => write!(f, "body {body}"),
        }
    }
}

/// A machine that cannot be simulated, or an input it cannot follow; [`Self::message`] replaces the numbers by
/// names.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.message(|part| part.to_string()))]
pub enum PhysicsError {
    /// The number of values does not fit the number of axes.
    AxisCount {
        /// Values given.
        given: usize,
        /// Values expected.
        expected: usize,
    },
    /// More axes than [`twin_kinematics::MAX_AXES`], or none.
    AxisNumber(usize),
    /// No joint is moved by this axis.
    AxisWithoutJoint(usize),
    /// Two joints name the same axis.
    AxisMovesTwoJoints {
        /// The second joint.
        joint: usize,
        /// The axis.
        axis: usize,
    },
    /// A joint that can move has no axis (or one the machine does not have), or a fixed one has an axis.
    JointAxis(usize),
    /// A joint that no axis moves, or axis positions that do not determine the joint positions one to one.
    CoupledJoint(usize),
    /// Closed loops of links.
    ClosedLoops(usize),
    /// Closed loops that are not a tripod: three vertical carriages, two rods on each, one platform.
    UnknownMechanism(usize),
    /// A rod whose mass is not the same all around it.
    UnevenRod(usize),
    /// Rods that do not meet, or do not hold the platform.
    Apart,
    /// The links are not ordered as a tree: `joints[i].child == i + 1` and parents first.
    NotATree {
        /// The joint.
        joint: usize,
        /// Its parent link.
        parent: usize,
        /// Its child link.
        child: usize,
    },
    /// A mass or an inertia is negative or not finite, or the inertia is not symmetric.
    MassProperties {
        /// The link.
        link: usize,
        /// Its mass, kg.
        mass: f64,
    },
    /// Nothing with mass hangs on the axis: a force would accelerate it without bound.
    NoInertia {
        /// The axis.
        axis: usize,
        /// Inertia that the axis moves, kg or kg·m².
        inertia: f64,
    },
    /// A drive parameter is out of range.
    DriveParameter {
        /// The axis.
        axis: usize,
        /// Field of [`super::AxisDriveParameters`].
        parameter: &'static str,
        /// The value given.
        value: f64,
    },
    /// The cycle time is not between 1 µs and 1 s.
    CycleTime(i64),
    /// Gravity, a set-point, an effort or a deceleration is not finite or has the wrong sign.
    Input(i64),
    /// An axis ran on a limit switch.
    LimitSwitch {
        /// The axis.
        axis: usize,
        /// Side of the switch.
        side: Side,
    },
    /// A mesh without volume, which can touch nothing.
    FlatMesh {
        /// Part that the mesh belongs to.
        part: Part,
        /// Its place among the solids of that.
        solid: usize,
    },
    /// Two parts overlap at the start.
    Overlap {
        /// The overlapping parts.
        parts: [Part; 2],
        /// m.
        depth: f64,
    },
    /// Parts of the machine touched each other or an obstacle.
    Collision {
        /// The parts in contact.
        parts: [Part; 2],
        /// Of the blow, N·s.
        impulse: f64,
    },
    /// Contact forces cannot be solved: the contact is too stiff for the inertia of an axis.
    Contact(i64),
    /// The motion became infinite: the drive parameters make the loop unstable.
    Diverged(i64),
}

impl PhysicsError {
    /// Message of the error, with `name` for the axes, joints and links that it concerns.
    pub fn message(&self, name: impl Fn(Subject) -> String) -> String {
        let axis = |axis| name(Subject::Axis(axis));
        let joint = |joint| name(Subject::Joint(joint));
        let link = |link| name(Subject::Link(link));
        let part = |part| name(Subject::Part(part));
        match *self {
            Self::AxisCount { given, expected } => {
                format!("{given} axis values given, the machine has {expected} axes")
            }
            Self::AxisNumber(given) => format!("{given} axes, a machine has 1 to {MAX_AXES}"),
            Self::AxisWithoutJoint(number) => {
                format!("no joint of the model is moved by {}", axis(number))
            }
            Self::AxisMovesTwoJoints { joint: second, axis: number } => format!(
                "{} is moved by {}, which moves another joint already",
                joint(second),
                axis(number)
            ),
            Self::JointAxis(number) => format!(
                "{} and its machine axis do not belong together (a joint that moves has one, a fixed one none)",
                joint(number)
            ),
            Self::CoupledJoint(number) => format!(
                "{} is moved by no axis, or by axes that do not belong to it one to one",
                joint(number)
            ),
            Self::ClosedLoops(loops) => {
                format!("its links make {loops} closed loops where they have to be a tree")
            }
            Self::UnknownMechanism(loops) => {
                format!("its links make {loops} closed loops, which are not those of a tripod")
            }
            Self::UnevenRod(rod) => {
                format!("{} is a rod whose mass is not the same all around it", link(rod))
            }
            Self::Apart => {
                "the rods of the platform do not meet there, or do not hold it".to_owned()
            }
            Self::NotATree { joint: number, parent, child } => format!(
                "{} joins parent {} and child {}, out of the order of a tree",
                joint(number),
                link(parent),
                link(child)
            ),
            Self::MassProperties { link: number, mass } => {
                format!("{} of {mass} kg has mass properties no body can have", link(number))
            }
            Self::NoInertia { axis: number, inertia } => format!(
                "{} moves {inertia} kg or kg·m²: no mass and no rotor inertia; links of a URDF without <inertial> get their mass \
                 from [body] density_kg_per_m3 or [body.links.NAME] mass_kg",
                axis(number)
            ),
            Self::DriveParameter { axis: number, parameter, value } => {
                format!("{}: {parameter} = {value} is out of range", axis(number))
            }
            Self::CycleTime(cycle_ns) => {
                format!("a cycle of {cycle_ns} ns is not between 1 µs and 1 s")
            }
            Self::Input(time_ns) => {
                format!("an input at {time_ns} ns is not a number that the machine can follow")
            }
            Self::LimitSwitch { axis: number, side } => {
                format!("{} ran on its {side} limit switch", axis(number))
            }
            Self::FlatMesh { part: owner, solid } => {
                format!("solid {} of {} is a mesh without volume", solid + 1, part(owner))
            }
            Self::Overlap { parts: [one, other], depth } => format!(
                "{} is {:.3} mm deep in {} where the machine starts",
                part(one),
                depth * 1e3,
                part(other)
            ),
            Self::Collision { parts: [one, other], impulse } => {
                format!("{} ran into {} with {impulse:.3} N·s", part(one), part(other))
            }
            Self::Contact(time_ns) => format!(
                "at {time_ns} ns nothing keeps apart what touches: it is too stiff for what an axis moves (stiffness_n_per_mm)"
            ),
            Self::Diverged(time_ns) => {
                format!("the motion of the machine diverged at {time_ns} ns")
            }
        }
    }

    /// The same error for a model that has these joints and links under the numbers `joints` and `links`.
    pub(super) fn renumbered(self, joints: &[usize], links: &[usize]) -> Self {
        let joint_of = |joint: usize| joints.get(joint).copied().unwrap_or(joint);
        let link_of = |link: usize| links.get(link).copied().unwrap_or(link);
        match self {
            Self::AxisMovesTwoJoints { joint, axis } => {
                Self::AxisMovesTwoJoints { joint: joint_of(joint), axis }
            }
            Self::JointAxis(joint) => Self::JointAxis(joint_of(joint)),
            Self::CoupledJoint(joint) => Self::CoupledJoint(joint_of(joint)),
            Self::UnevenRod(link) => Self::UnevenRod(link_of(link)),
            Self::NotATree { joint, parent, child } => Self::NotATree {
                joint: joint_of(joint),
                parent: link_of(parent),
                child: link_of(child),
            },
            Self::MassProperties { link, mass } => {
                Self::MassProperties { link: link_of(link), mass }
            }
            other => other,
        }
    }
}
