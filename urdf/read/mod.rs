//! URDF reader: URDF text to a [`Model`].
//!
//! Three passes: a survey of the text finds missing parts and notes lines (`document`), urdf-rs parses a robot, and the
//! robot becomes a [`Model`] (`tree`, `link`, `joint`). Every error names file, line and part.
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
use crate::{Joint, JointDrive, JointKind, Model, Part, TIP_NAME, Tip, UrdfError, UrdfFileError};
use document::{At, OriginPlace, Places};
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;
use std::fmt;
use std::path::{Path, PathBuf};
use tree::Tree;

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

/// The numbers of a version.
fn version(text: Option<&str>) -> Option<(u32, u32)> {
    let (major, minor) = text?.trim().split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

/// The lines of the robot and of the joints of the model.
type Lines = (u32, Vec<u32>);

/// Reads one text.
struct Reader<'a> {
    path: &'a Path,
    options: &'a UrdfOptions,
    warnings: Vec<UrdfWarning>,
    meshes: link::Meshes,
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path, options: &'a UrdfOptions) -> Self {
        Self { path, options, warnings: Vec::new(), meshes: link::Meshes::default() }
    }

    fn warn(&mut self, line: u32, note: UrdfNote) {
        self.warnings.push(UrdfWarning { path: self.path.to_owned(), line, note });
    }

    fn model(&mut self, text: &str) -> At<(Model, Lines)> {
        let places = document::survey(text)?;
        let robot = urdf_rs::read_from_string(text)
            .map_err(|error| (places.robot, UrdfError::Text(error)))?;
        let tree = Tree::new(&robot, &places)?;
        let colors = link::colors(&robot);
        let limits_are_optional =
            version(robot.version.as_deref()).is_some_and(|version| version >= (1, 2));
        let mark = self.mark(&robot, &places, &tree)?;

        let mut model = Model {
            name: robot.name.clone(),
            links: vec![self.link(&robot, tree.base, &places, &colors)?],
            joints: Vec::new(),
            loops: Vec::new(),
            tip: Tip { link: 0, point: Point3::origin() },
        };
        let mut numbers = vec![0; robot.links.len()];
        let mut tip = None;
        // Of the joints of the model, in the text.
        let mut of_text = Vec::with_capacity(tree.joints.len());
        for &(index, parent, child) in &tree.joints {
            let Some(joint) = robot.joints.get(index) else { continue };
            let parent = numbers.get(parent).copied().unwrap_or_default();
            if mark == Some(child) {
                let place = places.joints.get(index).map(|joint| joint.origin);
                let part = Part::Joint(joint.name.clone());
                let origin = self.pose(&part, &joint.origin, place.unwrap_or_default())?;
                tip = Some(Tip { link: parent, point: origin.translation.vector.into() });
                continue;
            }
            let number = model.links.len();
            if let Some(slot) = numbers.get_mut(child) {
                *slot = number;
            }
            model.links.push(self.link(&robot, child, &places, &colors)?);
            let place = places.joints.get(index);
            model.joints.push(self.joint(joint, [parent, number], place, limits_are_optional)?);
            of_text.push(index);
        }
        joint::mimic(&mut model, &robot, &of_text, &places)?;
        let mut count = 0;
        for joint in &mut model.joints {
            if joint.kind != JointKind::Fixed && joint.drive == JointDrive::Fixed {
                joint.drive = JointDrive::Axis(count);
                count += 1;
            }
        }
        beyond::add(&mut model, &places)?;
        let lines = of_text.iter().map(|index| places.joint(*index)).collect();
        model.tip = self.tip(&model, tip, places.robot)?;
        Ok((model, (places.robot, lines)))
    }

    /// The link that marks the tool tip and is nothing else, if there is one.
    fn mark(&self, robot: &urdf_rs::Robot, places: &Places, tree: &Tree) -> At<Option<usize>> {
        let Some(mark) = robot.links.iter().position(|link| link.name == TIP_NAME) else {
            return Ok(None);
        };
        let bare = robot.links.get(mark).is_some_and(|link| {
            link.visual.is_empty() && link.collision.is_empty() && link::is_massless(link)
        });
        let hangs = |&(joint, _, child): &(usize, usize, usize)| {
            let kind = robot.joints.get(joint).map(|joint| &joint.joint_type);
            child == mark && kind == Some(&urdf_rs::JointType::Fixed)
        };
        let carries = tree.joints.iter().any(|(_, parent, _)| *parent == mark);
        if bare && !carries && tree.joints.iter().any(hangs) {
            return Ok(Some(mark));
        }
        let other = self.options.tip_link.as_ref().is_some_and(|name| name != TIP_NAME);
        if other { Ok(None) } else { Err((places.link(mark), UrdfError::Tip)) }
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

    fn pose(
        &mut self,
        part: &Part,
        pose: &urdf_rs::Pose,
        place: OriginPlace,
    ) -> At<Isometry3<f64>> {
        let refuse = |error| (place.line, error);
        let numbers = place.given.iter().chain(&place.exact).flatten();
        let numbers = pose.xyz.iter().chain(pose.rpy.iter()).chain(numbers);
        check_finite(part, "an origin", numbers).map_err(refuse)?;
        let quaternion = |[w, x, y, z]: [f64; 4]| Quaternion::new(w, x, y, z);
        let translation = Translation3::from(Vector3::from(*pose.xyz));
        if let Some(given) = place.given {
            let rotation = UnitQuaternion::try_new(quaternion(given), 1e-12);
            let no_unit = || UrdfError::NotFinite { part: part.clone(), what: "an origin" };
            let rotation = rotation.ok_or_else(|| refuse(no_unit()))?;
            return Ok(Isometry3::from_parts(translation, rotation));
        }
        let angles = pose.rpy.map(|angle| self.right_angle(angle));
        let [roll, pitch, yaw] = angles;
        let mut rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        for (given, taken) in pose.rpy.iter().zip(angles) {
            if given.to_bits() != taken.to_bits() {
                let note = UrdfNote::RightAngle { part: part.clone(), given: *given, taken };
                self.warn(place.line, note);
            }
        }
        if let Some(exact) = place.exact
            && angles.map(f64::to_bits) == pose.rpy.map(f64::to_bits)
        {
            let exact = UnitQuaternion::new_unchecked(quaternion(exact));
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
