//! What the physics machine refuses, and why.

use super::event::Side;
use super::surroundings::Part;

/// A machine that cannot be simulated, or an input it cannot follow. Axes and joints are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PhysicsError {
    /// The number of values does not fit the number of axes.
    #[error("{given} axis values given, the machine has {expected} axes")]
    AxisCount {
        /// Values given.
        given: usize,
        /// Values expected.
        expected: usize,
    },
    /// More axes than [`twin_kinematics::MAX_AXES`], or none.
    #[error("{given} axes, a machine has 1 to {}", twin_kinematics::MAX_AXES)]
    AxisNumber {
        /// Axes asked for.
        given: usize,
    },
    /// No joint is moved by this axis.
    #[error("no joint of the model is moved by axis {axis}")]
    AxisWithoutJoint {
        /// The axis.
        axis: usize,
    },
    /// Two joints name the same axis.
    #[error("joint {joint} is moved by axis {axis}, which moves another joint already")]
    AxisMovesTwoJoints {
        /// The second joint.
        joint: usize,
        /// The axis.
        axis: usize,
    },
    /// A joint that can move has no axis (or one the machine does not have), or a fixed one has an axis.
    #[error(
        "joint {joint} and its machine axis do not belong together (a joint that moves has one, a fixed one none)"
    )]
    JointAxis {
        /// The joint.
        joint: usize,
    },
    /// A joint of a tree that no axis moves, or several axes in such a way that where they are does not tell where all joints are,
    /// or the other way round.
    #[error("joint {joint} is moved by no axis, or by axes that do not belong to it one to one")]
    CoupledJoint {
        /// The joint.
        joint: usize,
    },
    /// Links that go round in a circle.
    #[error("its links make {loops} closed loops where they have to be a tree")]
    ClosedLoops {
        /// How many.
        loops: usize,
    },
    /// Links that go round in a circle, and are no tripod: three carriages that slide upwards, two rods on each of them by
    /// two joints that turn, a platform on all of these.
    #[error("its links make {loops} closed loops, which are not those of a tripod")]
    UnknownMechanism {
        /// How many.
        loops: usize,
    },
    /// A rod whose mass is not the same all around it.
    #[error("link {link} is a rod whose mass is not the same all around it")]
    UnevenRod {
        /// The link.
        link: usize,
    },
    /// Rods that do not meet, or do not hold the platform.
    #[error("the rods of the platform do not meet there, or do not hold it")]
    Apart,
    /// The links are not ordered as a tree: `joints[i].child == i + 1` and parents first.
    #[error(
        "joint {joint} joins parent link {parent} and child link {child}, out of the order of a tree"
    )]
    NotATree {
        /// The joint.
        joint: usize,
        /// Its parent link.
        parent: usize,
        /// Its child link.
        child: usize,
    },
    /// A mass or an inertia is negative or not finite, or the inertia is not symmetric.
    #[error("link {link} of {mass} kg has mass properties no body can have")]
    MassProperties {
        /// The link.
        link: usize,
        /// Its mass, kg.
        mass: f64,
    },
    /// Nothing with mass hangs on the axis: a force would accelerate it without bound.
    #[error(
        "axis {axis} (from 0) moves {inertia} kg or kg·m²: no mass and no rotor inertia; links of a URDF without <inertial> get \
         their mass from [body] density_kg_per_m3 or [body.links.NAME] mass_kg"
    )]
    NoInertia {
        /// The axis.
        axis: usize,
        /// What it moves, kg or kg·m².
        inertia: f64,
    },
    /// A drive parameter is out of range.
    #[error("axis {axis}: {parameter} = {value} is out of range")]
    DriveParameter {
        /// The axis.
        axis: usize,
        /// Field of [`super::AxisDriveParameters`].
        parameter: &'static str,
        /// The value given.
        value: f64,
    },
    /// The cycle time is not between 1 µs and 1 s.
    #[error("a cycle of {cycle_ns} ns is not between 1 µs and 1 s")]
    CycleTime {
        /// The value given, ns.
        cycle_ns: i64,
    },
    /// Gravity, a set-point, an effort or a deceleration is infinite, not a number, or has the wrong sign.
    #[error("an input at {time_ns} ns is not a number that the machine can follow")]
    Input {
        /// Start of the cycle, ns.
        time_ns: i64,
    },
    /// An axis ran on a limit switch.
    #[error("axis {axis} ran on its {side} limit switch")]
    LimitSwitch {
        /// The axis.
        axis: usize,
        /// Which switch.
        side: Side,
    },
    /// A mesh without volume, which can touch nothing.
    #[error("solid {solid} (from 0) of {part:?} is a mesh without volume")]
    FlatMesh {
        /// What it belongs to.
        part: Part,
        /// Its place among the solids of that.
        solid: usize,
    },
    /// The machine is in something where it starts.
    #[error("{:?} and {:?} are {:.3} mm in each other where the machine starts", parts[0], parts[1], depth * 1e3)]
    Overlap {
        /// What is in what.
        parts: [Part; 2],
        /// m.
        depth: f64,
    },
    /// Parts of the machine touched each other, or something around it.
    #[error("{:?} ran into {:?} with {force:.0} N", parts[0], parts[1])]
    Collision {
        /// What touched what.
        parts: [Part; 2],
        /// N.
        force: f64,
    },
    /// The motion became infinite: the drive parameters make the loop unstable.
    #[error("the motion of the machine diverged at {time_ns} ns")]
    Diverged {
        /// Start of the cycle, ns.
        time_ns: i64,
    },
}
