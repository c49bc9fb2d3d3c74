//! Errors of reading and writing URDF, with file, line and part.

use crate::MeshError;
use std::path::{Path, PathBuf};
use std::{fmt, io};

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

/// URDF that cannot be used: where, and why.
#[derive(Debug)]
pub struct UrdfFileError {
    /// The file; empty if the text came from somewhere else.
    pub path: PathBuf,
    /// From 1.
    pub line: u32,
    /// The error.
    pub error: Box<UrdfError>,
}

impl fmt::Display for UrdfFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", Place { path: &self.path, line: self.line }, self.error)
    }
}

impl std::error::Error for UrdfFileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.error.source()
    }
}

/// `file:line`, or `line N` of a text without a file.
pub(crate) struct Place<'a> {
    pub(crate) path: &'a Path,
    pub(crate) line: u32,
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.path.as_os_str().is_empty() {
            write!(f, "line {}", self.line)
        } else {
            write!(f, "{}:{}", self.path.display(), self.line)
        }
    }
}

/// URDF that cannot be read as a [`Model`](crate::Model), or a model that cannot be written as URDF.
#[derive(Debug, thiserror::Error)]
pub enum UrdfError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[source] io::Error),
    /// The text is not XML.
    #[error("not URDF: {0}")]
    Xml(#[source] roxmltree::Error),
    /// The text is not a URDF.
    #[error("not URDF: {0}")]
    Text(#[source] urdf_rs::UrdfError),
    /// The text is URDF only when a macro processor has been over it.
    #[error(
        "this is xacro, of which URDF is made: run `xacro IN.urdf.xacro > OUT.urdf` and take what it writes"
    )]
    Xacro,
    /// Not `<robot>`.
    #[error("not URDF: the text is a <{0}>, not a <robot>")]
    Root(String),
    /// Elements within elements beyond anything that URDF has.
    #[error("not URDF: elements are within each other {0} deep")]
    Deep(usize),
    /// More attributes than any element of URDF has.
    #[error(
        "not URDF: an element has {count} attributes, and at most {most} are read; remove those that URDF does not know"
    )]
    Attributes {
        /// Number of attributes.
        count: usize,
        /// Largest number.
        most: usize,
    },
    /// More namespaces than any file needs.
    #[error(
        "not URDF: more than {most} namespaces are declared (xmlns), the most that are read; remove those that are not used"
    )]
    Namespaces {
        /// Largest number.
        most: usize,
    },
    /// An element without something it needs.
    #[error("{}<{element}> has no {what}", of(part.as_ref()))]
    Lacks {
        /// Whose, if it belongs to a link or a joint.
        part: Option<Part>,
        /// The element.
        element: String,
        /// An attribute or an element in it.
        what: String,
    },
    /// An element that is there more often than it may.
    #[error("{}<{element}> has more than one {what}", of(part.as_ref()))]
    TooMany {
        /// Whose, if it belongs to a link or a joint.
        part: Option<Part>,
        /// The element.
        element: String,
        /// An element in it.
        what: String,
    },
    /// An attribute that is not what it has to be.
    #[error("{}{attribute} of <{element}> is \"{value}\"; expected {expected}", of(part.as_ref()))]
    Attribute {
        /// Whose, if it belongs to a link or a joint.
        part: Option<Part>,
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
        /// The value found.
        value: String,
        /// The expected form.
        expected: &'static str,
    },
    /// Roll, pitch and yaw contradict the quaternion.
    #[error(
        "{part}: rpy and {} of an <origin> are {angle} rad apart; take one of them out",
        crate::QUATERNION
    )]
    Orientation {
        /// Whose.
        part: Part,
        /// Between them.
        angle: f64,
    },
    /// A mesh file that is nowhere.
    #[error("link {link}: there is no mesh {file}; looked at {}", list(places))]
    NoMesh {
        /// The link.
        link: String,
        /// As the text names it.
        file: String,
        /// Paths that were searched.
        places: Vec<PathBuf>,
    },
    /// A mesh file that cannot be used.
    #[error("link {link}: mesh {}: {error}", path.display())]
    Mesh {
        /// The link.
        link: String,
        /// The file.
        path: PathBuf,
        /// The cause.
        #[source]
        error: MeshError,
    },
    /// A joint that mimics one that is not there.
    #[error("joint {joint} mimics {leader}, which is not a joint")]
    NoLeader {
        /// The joint.
        joint: String,
        /// The joint it mimics.
        leader: String,
    },
    /// A joint that mimics one that does not move, or that does not move itself.
    #[error("joint {joint} mimics {leader}; a fixed joint neither mimics nor is mimicked")]
    MimicFixed {
        /// The joint.
        joint: String,
        /// The joint it mimics.
        leader: String,
    },
    /// Joints that mimic each other.
    #[error("joint {0} mimics itself, by way of others or directly")]
    MimicCircle(String),
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
    #[error("there are two of {0}")]
    Twice(Part),
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
    #[error("links {} and {} hang on no joint; only one can be the base", .0[0], .0[1])]
    TwoBases([String; 2]),
    /// Joints that close a loop away from the base.
    #[error(
        "joint {0} is not connected to the base link: its parent links form a loop; correct a <parent> or <child>"
    )]
    Loop(String),
    /// `<twin>` speaks of a joint that is not there, or that nothing can move.
    #[error("<twin>: there is no joint {0} that moves and mimics no other")]
    NoDrivenJoint(String),
    /// `<twin>` speaks of a link that is not there.
    #[error("<twin>: there is no link {0}")]
    NoLoopLink(String),
    /// A loop that is not of two points.
    #[error("<twin>: a loop has two points, not {0}")]
    LoopPoints(usize),
    /// The links and joints of a model are not in order.
    #[error("joint {0}: a model's joint i moves link i + 1, and parents come before children")]
    Order(String),
    /// More or fewer joints than links that need one.
    #[error("{links} links need one joint each, except the base; there are {joints}")]
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
    /// The link that is said to be where the tool tip is is not there.
    #[error("there is no link {0}, which tip_link names")]
    NoTipLink(String),
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
    /// A measure that may be 0.
    #[error("{part}: {what} is {value}; it must be 0 or above")]
    Negative {
        /// Whose.
        part: Part,
        /// What.
        what: &'static str,
        /// Its value.
        value: f64,
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
    /// The axis of a joint that moves has no direction.
    #[error("joint {0}: its axis is 0 0 0")]
    NoDirection(String),
    /// A joint without the limits that URDF asks for.
    #[error(
        "joint {0}: it has no <limit> with lower and upper (a joint that turns without end is \"continuous\")"
    )]
    NoLimits(String),
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
    #[error("joint {0} moves, but no axis of the machine is called {0}")]
    NoAxis(String),
    /// An axis of the machine that moves nothing.
    #[error("no joint that moves is called {0}, as an axis of the machine is")]
    NoJoint(String),
}

/// "link slide: ", or nothing.
fn of(part: Option<&Part>) -> String {
    part.map_or_else(String::new, |part| format!("{part}: "))
}

fn list(paths: &[PathBuf]) -> String {
    let paths: Vec<_> = paths.iter().map(|path| path.display().to_string()).collect();
    paths.join(", ")
}
