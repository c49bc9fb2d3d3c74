//! URDF reader: URDF text to a [`Model`].
//!
//! Two passes: every element is checked against the schema (`document`, `schema`), then they become a [`Model`] (`tree`,
//! `link`, `joint`). Every error names file, line and part.
//!
//! Planar, floating and spherical joints, which a [`Model`] cannot hold, are errors, not dropped. Elements other than
//! links, joints and materials (transmissions, simulator settings) are ignored, as URDF readers do. A difference in
//! appearance only is a [warning](UrdfWarning). A link with only one of visual and collision geometry has that one as
//! both. URDF is a tree: a model read from plain URDF has no loops, and every moving joint has a position of its own,
//! or mimics another.
//!
//! Before URDF 1.2 an absent limit of effort or velocity is 0 in the text; 0 is therefore read as "no limit" there.

mod beyond;
mod document;
mod joint;
mod link;
mod packages;
mod schema;
mod tree;

use crate::check::check_finite;
use crate::error::Place;
use crate::{
    Joint, JointDrive, JointKind, Model, Part, QUATERNION, TIP_NAME, Tip, UrdfError, UrdfFileError,
};
use document::{At, Element, Text};
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;
use std::fmt;
use std::path::{Path, PathBuf};
use tree::{Tree, TreeJoint};

/// Roll, pitch and yaw, written with all their digits, and the quaternion may be this far apart (rad).
const SAME_ORIENTATION: f64 = 1e-12;

/// Options of reading: information that the text does not contain.
#[derive(Clone, Debug, Default)]
pub struct UrdfOptions {
    /// Names of packages (`package://NAME/…`) and their folders; others are looked for around the URDF.
    pub packages: Vec<(String, PathBuf)>,
    /// The link at whose origin the tool tip is. `None`: the text has a link [`TIP_NAME`].
    pub tip_link: Option<String>,
    /// Roll, pitch and yaw no further than this from a multiple of a right angle are meant to be it, rad: many a URDF says
    /// 3.14 for half a turn.
    pub right_angle_tolerance: f64,
}

/// A model that has been read.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The model. Its joints that move and mimic none are axes of their own, counted in their order.
    pub model: Model,
    /// Differences from the text.
    pub warnings: Vec<UrdfWarning>,
}

/// A difference from the text, with its line.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfWarning {
    /// The file; empty if the text came from somewhere else.
    pub path: PathBuf,
    /// From 1.
    pub line: u32,
    /// The difference.
    pub note: UrdfNote,
}

impl fmt::Display for UrdfWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", Place { path: &self.path, line: self.line }, self.note)
    }
}

/// Difference between a text and the model read from it.
#[derive(Clone, Debug, PartialEq)]
pub enum UrdfNote {
    /// A material that has no colour anywhere in the text.
    NoColor {
        /// The link.
        link: String,
        /// The material.
        material: String,
    },
    /// A texture.
    Texture {
        /// The link.
        link: String,
        /// Its file.
        file: String,
    },
    /// An angle that is taken as a multiple of a right angle.
    RightAngle {
        /// Whose.
        part: Part,
        /// As written, rad.
        given: f64,
        /// As taken, rad.
        taken: f64,
    },
}

impl fmt::Display for UrdfNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoColor { link, material } => {
                write!(
                    f,
                    "link {link}: the colour of material \"{material}\" is not in this file; grey is taken"
                )
            }
            Self::Texture { link, file } => {
                write!(f, "link {link}: the texture {file} is not shown")
            }
            Self::RightAngle { part, given, taken } => {
                write!(f, "{part}: an angle of {given} rad is taken as {}°", taken.to_degrees())
            }
        }
    }
}

impl Model {
    /// Reads URDF text; `path` is its origin, for messages and for the meshes next to it.
    ///
    /// # Errors
    /// [`UrdfFileError`] with the line.
    pub fn read_urdf(
        text: &str,
        path: &Path,
        options: &UrdfOptions,
    ) -> Result<Loaded, UrdfFileError> {
        let mut reader = Reader::new(path, options);
        let model = reader.model(text).map(|(model, _)| model);
        let model = model.map_err(|at| at_line(path, at))?;
        Ok(Loaded { model, warnings: reader.warnings })
    }

    /// Reads URDF text of which a joint that moves is the joint of the machine axis of its name: `axis_names` are the
    /// names of the axes in the order of the machine file.
    ///
    /// # Errors
    /// [`UrdfFileError`] with the line.
    pub fn from_urdf(text: &str, axis_names: &[&str]) -> Result<Self, UrdfFileError> {
        let (path, options) = (Path::new(""), UrdfOptions::default());
        let at = |at| at_line(path, at);
        let (mut model, places) = Reader::new(path, &options).model(text).map_err(at)?;
        let (robot, lines) = places;
        for (joint, line) in model.joints.iter_mut().zip(lines) {
            if let JointDrive::Axis(slot) = &mut joint.drive {
                let axis = axis_names.iter().position(|name| *name == joint.name);
                let no_axis = || UrdfError::NoAxis(joint.name.clone());
                *slot = axis.ok_or_else(|| at((line, no_axis())))?;
            }
        }
        let moves = |axis: usize, joint: &Joint| match &joint.drive {
            JointDrive::Axis(own) => *own == axis,
            JointDrive::Combination(parts) => parts.iter().any(|(part, _)| *part == axis),
            JointDrive::Fixed | JointDrive::Passive { .. } | JointDrive::Mimic { .. } => false,
        };
        let lacks_joint =
            |(axis, _): &(usize, &&str)| !model.joints.iter().any(|joint| moves(*axis, joint));
        match axis_names.iter().enumerate().find(lacks_joint) {
            Some((_, axis)) => Err(at((robot, UrdfError::NoJoint((*axis).to_owned())))),
            None => Ok(model),
        }
    }
}

fn at_line(path: &Path, (line, error): (u32, UrdfError)) -> UrdfFileError {
    UrdfFileError { path: path.to_owned(), line, error: Box::new(error) }
}

/// The lines of the robot and of the joints of the model.
type Lines = (u32, Vec<u32>);

/// Reads one text.
struct Reader<'a> {
    path: &'a Path,
    options: &'a UrdfOptions,
    warnings: Vec<UrdfWarning>,
    meshes: link::Meshes,
    /// The text may have `quat_xyzw`.
    has_quaternions: bool,
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path, options: &'a UrdfOptions) -> Self {
        let (warnings, meshes) = (Vec::new(), link::Meshes::default());
        Self { path, options, warnings, meshes, has_quaternions: false }
    }

    fn warn(&mut self, line: u32, note: UrdfNote) {
        self.warnings.push(UrdfWarning { path: self.path.to_owned(), line, note });
    }

    fn model(&mut self, text: &str) -> At<(Model, Lines)> {
        let text = Text::new(text)?;
        let robot = text.robot();
        self.has_quaternions = robot.is_since(1);
        let tree = Tree::new(robot)?;
        let colors = link::colors(robot);
        let mark = self.mark(robot, &tree)?;

        let mut model = Model {
            name: robot.name().to_owned(),
            links: vec![self.link(tree.base, &colors)?],
            joints: Vec::new(),
            loops: Vec::new(),
            tip: Tip { link: 0, point: Point3::origin() },
        };
        let mut numbers = HashMap::from([(tree.base.name(), 0)]);
        let mut tip = None;
        // The joints of the model in the text.
        let mut of_text = Vec::with_capacity(tree.joints.len());
        for TreeJoint { joint, parent, child } in tree.joints {
            let parent = numbers.get(parent).copied().unwrap_or_default();
            if mark == Some(child.name()) {
                let part = Part::Joint(joint.name().to_owned());
                let origin = self.pose(&part, joint, joint.line())?;
                tip = Some(Tip { link: parent, point: origin.translation.vector.into() });
                continue;
            }
            let number = model.links.len();
            numbers.insert(child.name(), number);
            model.links.push(self.link(child, &colors)?);
            model.joints.push(self.joint(joint, [parent, number], robot.is_since(2))?);
            of_text.push(joint);
        }
        joint::mimic(&mut model, robot, &of_text)?;
        let mut count = 0;
        for joint in &mut model.joints {
            if joint.kind != JointKind::Fixed && joint.drive == JointDrive::Fixed {
                joint.drive = JointDrive::Axis(count);
                count += 1;
            }
        }
        beyond::add(&mut model, robot)?;
        model.tip = self.tip(&model, tip, robot.line())?;
        Ok((model, (robot.line(), of_text.iter().map(Element::line).collect())))
    }

    /// The link that marks the tool tip and is nothing else, if there is one.
    fn mark<'t>(&self, robot: Element<'t>, tree: &Tree<'t>) -> At<Option<&'t str>> {
        let Some(mark) = robot.children("link").find(|link| link.name() == TIP_NAME) else {
            return Ok(None);
        };
        let bare = mark.child("visual").or(mark.child("collision")).is_none();
        let bare = bare && link::mass(mark).is_none();
        let hangs = |joint: &TreeJoint<'_>| {
            joint.child.name() == TIP_NAME && joint.joint.text("type") == Some("fixed")
        };
        let carries = tree.joints.iter().any(|joint| joint.parent == TIP_NAME);
        if bare && !carries && tree.joints.iter().any(hangs) {
            return Ok(Some(mark.name()));
        }
        let other = self.options.tip_link.as_ref().is_some_and(|name| name != TIP_NAME);
        if other { Ok(None) } else { Err((mark.line(), UrdfError::Tip)) }
    }

    fn tip(&self, model: &Model, marked: Option<Tip>, line: u32) -> At<Tip> {
        let Some(name) = &self.options.tip_link else {
            return marked.ok_or((line, UrdfError::NoTip));
        };
        if let Some(tip) = marked.filter(|_| name == TIP_NAME) {
            return Ok(tip);
        }
        let link = model.links.iter().position(|link| link.name == *name);
        let no_link = || (line, UrdfError::NoTipLink(name.clone()));
        Ok(Tip { link: link.ok_or_else(no_link)?, point: Point3::origin() })
    }

    /// The `<origin>` in an element of `part`; `line` is that of its errors.
    fn pose(&mut self, part: &Part, within: Element<'_>, line: u32) -> At<Isometry3<f64>> {
        let origin = within.child("origin");
        let numbers = |attribute: &str| origin?.numbers(attribute);
        let [xyz, rpy] = ["xyz", "rpy"].map(|name| numbers(name).unwrap_or([0.0; 3]));
        let four = |attribute: &str| origin?.numbers::<4>(attribute);
        // In place of roll, pitch and yaw, since URDF 1.1.
        let given = four("quat_xyzw").filter(|_| self.has_quaternions);
        let exact = four(QUATERNION);
        let refuse = |error| (line, error);
        let all = xyz.iter().chain(&rpy).chain(given.iter().chain(&exact).flatten());
        check_finite(part, "an origin", all).map_err(refuse)?;
        let translation = Translation3::from(Vector3::from(xyz));
        if let Some([x, y, z, w]) = given {
            let rotation = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-12);
            let no_unit = || UrdfError::NotFinite { part: part.clone(), what: "an origin" };
            let rotation = rotation.ok_or_else(|| refuse(no_unit()))?;
            return Ok(Isometry3::from_parts(translation, rotation));
        }
        let angles = rpy.map(|angle| self.right_angle(angle));
        let [roll, pitch, yaw] = angles;
        let mut rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        for (given, taken) in rpy.into_iter().zip(angles) {
            if given.to_bits() != taken.to_bits() {
                self.warn(line, UrdfNote::RightAngle { part: part.clone(), given, taken });
            }
        }
        if let Some([w, x, y, z]) = exact
            && angles.map(f64::to_bits) == rpy.map(f64::to_bits)
        {
            let exact = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
            let difference =
                exact.to_rotation_matrix().matrix() - rotation.to_rotation_matrix().matrix();
            let angle = difference.norm().max((exact.norm() - 1.0).abs());
            if angle > SAME_ORIENTATION {
                return Err(refuse(UrdfError::Orientation { part: part.clone(), angle }));
            }
            rotation = exact;
        }
        Ok(Isometry3::from_parts(translation, rotation))
    }

    /// `angle`, or the multiple of a right angle that it is meant to be.
    fn right_angle(&self, angle: f64) -> f64 {
        let nearest = (angle / FRAC_PI_2).round() * FRAC_PI_2;
        if (angle - nearest).abs() <= self.options.right_angle_tolerance { nearest } else { angle }
    }
}
