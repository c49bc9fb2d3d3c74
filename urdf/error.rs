//! What is refused, and why.

use std::fmt;

/// Dimensions from which no machine can be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DimensionError {
    /// A length, a section or a mass.
    #[error("{what} is {value}; it must be a finite number above 0")]
    NotPositive {
        /// Which dimension.
        what: &'static str,
        /// Its value, m or kg.
        value: f64,
    },
    /// A measure that may be absent.
    #[error("{what} is {value}; it must be a finite number, 0 or above")]
    Negative {
        /// Which dimension.
        what: &'static str,
        /// Its value, m or kg.
        value: f64,
    },
    /// A limit or an offset.
    #[error("{what} is not a finite number")]
    NotFinite {
        /// Which dimension.
        what: &'static str,
    },
    /// Position limits of which the lower is not below the upper.
    #[error(
        "joint {joint} can move from {lower} to {upper}; the lower limit must be below the upper one"
    )]
    Limits {
        /// The joint.
        joint: String,
        /// m or rad.
        lower: f64,
        /// m or rad.
        upper: f64,
    },
    /// A rod of a tripod that is shorter than what it has to bridge.
    #[error(
        "rod {} of {:.3} mm is too short for its joints and the {:.3} mm between its ends as seen from above",
        rod + 1, length * 1e3, reach * 1e3
    )]
    Rod {
        /// Which, from 0.
        rod: usize,
        /// Its length, m.
        length: f64,
        /// Between its ends with the platform in the middle, as seen from above, m.
        reach: f64,
    },
    /// Rods of a tripod that are not two for each carriage.
    #[error("the rods hang on the carriages {carriages:?}; each of 0, 1 and 2 has two of them")]
    RodsOfCarriages {
        /// The carriage of each rod.
        carriages: [usize; 6],
    },
    /// Rods of a tripod that do not meet their platform.
    #[error(
        "the rods do not meet the platform with every axis in the middle of its travel; {gap} m are left open"
    )]
    RodsApart {
        /// m.
        gap: f64,
    },
    /// A belt that does not lead from two motors to two coordinates.
    #[error(
        "the factors {factors:?} of the belt are not ±0.5 each, or both coordinates move alike"
    )]
    Belt {
        /// What the motors (columns) contribute to x and y (rows).
        factors: [[f64; 2]; 2],
    },
    /// Two joints with one name, or moved by one machine axis.
    #[error("joints {} and {} have the same name or the same machine axis", joints[0], joints[1])]
    JointTwice {
        /// Their names.
        joints: [String; 2],
    },
}

/// A link or a joint, as errors name it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// A link of this name.
    Link(String),
    /// A joint of this name.
    Joint(String),
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Link(name) => write!(f, "link {name}"),
            Self::Joint(name) => write!(f, "joint {name}"),
        }
    }
}

/// URDF that cannot be read as a [`Model`](crate::Model), or a model that cannot be written as URDF.
#[derive(Debug, thiserror::Error)]
pub enum UrdfError {
    /// The text is no URDF.
    #[error("not URDF: {0}")]
    Text(#[source] urdf_rs::UrdfError),
    /// Something that URDF has and this program has not.
    #[error("{part}: {what} is not supported yet")]
    Unsupported {
        /// Whose.
        part: Part,
        /// What.
        what: &'static str,
    },
    /// A link or joint with an empty name.
    #[error("a link or joint has no name")]
    NoName,
    /// Two links or two joints of one name.
    #[error("there are two of {part}")]
    Twice {
        /// Which.
        part: Part,
    },
    /// A joint names a link that is not there.
    #[error("joint {joint}: there is no link {link}")]
    NoLink {
        /// The joint.
        joint: String,
        /// The link.
        link: String,
    },
    /// A link that hangs on two joints.
    #[error("link {link} is the child of joint {} and of joint {}; only a tree can be read", joints[0], joints[1])]
    TwoParents {
        /// The link.
        link: String,
        /// The joints.
        joints: [String; 2],
    },
    /// Every link is the child of a joint, or there is none.
    #[error("no link is the base: each is the child of a joint, or there is none")]
    NoBase,
    /// Links that hang on nothing.
    #[error("links {} and {} hang on no joint; only one can be the base", links[0], links[1])]
    TwoBases {
        /// The first two.
        links: [String; 2],
    },
    /// Joints that close a loop away from the base.
    #[error("joint {joint} does not hang on the base: its links make a loop")]
    Loop {
        /// One of the joints.
        joint: String,
    },
    /// The links and joints of a model are not in order.
    #[error("joint {joint}: a model's joint i moves link i + 1, and parents come before children")]
    Order {
        /// The joint.
        joint: String,
    },
    /// More or fewer joints than links that need one.
    #[error("{links} links need one joint each but for the base; there are {joints}")]
    Count {
        /// Number of links.
        links: usize,
        /// Number of joints.
        joints: usize,
    },
    /// No link says where the tool tip is.
    #[error(
        "there is no link {}: add one, fixed to the link that carries the tool, with its origin at the tool tip",
        crate::TIP_NAME
    )]
    NoTip,
    /// The link that marks the tool tip is more than a mark.
    #[error(
        "link {} marks the tool tip: it has neither body nor mass, hangs on a fixed joint and carries nothing",
        crate::TIP_NAME
    )]
    Tip,
    /// A number is infinite or not a number.
    #[error("{part}: {what} is not a finite number")]
    NotFinite {
        /// Whose.
        part: Part,
        /// What.
        what: &'static str,
    },
    /// A measure or a mass.
    #[error("{part}: {what} is {value}; it must be above 0")]
    NotPositive {
        /// Whose.
        part: Part,
        /// What.
        what: &'static str,
        /// m, kg or kg·m².
        value: f64,
    },
    /// What is seen and what collides differ.
    #[error(
        "link {link}: its collision geometry differs from its visual geometry, which is not supported yet"
    )]
    CollisionDiffers {
        /// The link.
        link: String,
    },
    /// A material without a colour.
    #[error("link {link}: no colour is given for material \"{material}\"")]
    NoColor {
        /// The link.
        link: String,
        /// Name of the material.
        material: String,
    },
    /// The axis of a joint that moves has no direction.
    #[error("joint {joint}: its axis is 0 0 0")]
    NoDirection {
        /// The joint.
        joint: String,
    },
    /// A joint without the limits that URDF asks for.
    #[error(
        "joint {joint}: it has no <limit> with lower and upper (a joint that turns without end is \"continuous\")"
    )]
    NoLimits {
        /// The joint.
        joint: String,
    },
    /// Limits that leave no position.
    #[error("joint {joint}: its lower limit {lower} is above its upper limit {upper}")]
    Limits {
        /// The joint.
        joint: String,
        /// m or rad.
        lower: f64,
        /// m or rad.
        upper: f64,
    },
    /// A joint that no axis of the machine moves.
    #[error("joint {joint} moves, but no axis of the machine is called {joint}")]
    NoAxis {
        /// The joint.
        joint: String,
    },
    /// An axis of the machine that moves nothing.
    #[error("no joint that moves is called {axis}, as an axis of the machine is")]
    NoJoint {
        /// The axis.
        axis: String,
    },
}
