//! The axes of a whole machine: those of a transform and those that are coordinates themselves.

use crate::{AxisMotion, AxisVector, Kinematics, KinematicsError, MAX_AXES, Pose, ToolMotion};
use nalgebra::Vector3;
use std::fmt;

/// How far a coordinate without an axis may be from 0, m: far below anything a machine can show, far above the
/// rounding of a work frame.
pub(crate) const ABSENT: f64 = 1e-9;

/// A coordinate of the tool tip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coordinate {
    /// Along +x.
    X,
    /// Along +y.
    Y,
    /// Along +z.
    Z,
}

impl Coordinate {
    /// All of them, in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    fn of(self, values: &Vector3<f64>) -> f64 {
        match self {
            Self::X => values.x,
            Self::Y => values.y,
            Self::Z => values.z,
        }
    }

    fn of_mut(self, values: &mut Vector3<f64>) -> &mut f64 {
        match self {
            Self::X => &mut values.x,
            Self::Y => &mut values.y,
            Self::Z => &mut values.z,
        }
    }
}

impl fmt::Display for Coordinate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "X",
            Self::Y => "Y",
            Self::Z => "Z",
        })
    }
}

/// What a machine axis is moved by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisSource {
    /// This output of the transform, from 0.
    Transform(usize),
    /// A coordinate that the transform does not use: the axis position is the coordinate.
    Coordinate(Coordinate),
    /// Nothing that has to do with the tool: the additional axis of this number (SoftMotion's P Q U V W are 0 to 4).
    /// The inverse leaves it where it is near.
    Additional(u8),
}

/// Axes that do not fit their transform.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MachineAxesError {
    /// More than [`MAX_AXES`].
    #[error("{given} axes given, a machine can have {MAX_AXES}")]
    TooMany {
        /// Axes given.
        given: usize,
    },
    /// An output that the transform does not have.
    #[error("output {output} of the transform is assigned to an axis, but the transform has {outputs}", output = output + 1)]
    NoSuchOutput {
        /// The output, from 0.
        output: usize,
        /// How many there are.
        outputs: usize,
    },
    /// An output of the transform that moves nothing.
    #[error("output {} of the transform moves no axis", output + 1)]
    OutputWithoutAxis {
        /// The output, from 0.
        output: usize,
    },
    /// One output, two axes.
    #[error("output {} of the transform is assigned to two axes", output + 1)]
    OutputTwice {
        /// The output, from 0.
        output: usize,
    },
    /// A coordinate that the transform turns into positions of its own axes.
    #[error("{coordinate} is assigned to an axis of its own, but the transform uses it")]
    CoordinateOfTransform {
        /// The coordinate.
        coordinate: Coordinate,
    },
    /// One coordinate, two axes.
    #[error("{coordinate} is assigned to two axes")]
    CoordinateTwice {
        /// The coordinate.
        coordinate: Coordinate,
    },
    /// One additional axis, two axes.
    #[error("additional axis {} is assigned to two axes", number + 1)]
    AdditionalTwice {
        /// Its number, from 0.
        number: u8,
    },
    /// A tool that no axis can bring to z = 0.
    #[error("a tool {:.3} mm long needs an axis that moves Z", length * 1e3)]
    ToolWithoutZ {
        /// Length of the tool, m.
        length: f64,
    },
    /// The length of the tool is infinite or not a number.
    #[error("the length of the tool is not a finite number")]
    ToolLength,
}

/// The kinematics of a whole machine, with axes in the order of the machine file.
///
/// The flange is where the transform says; the tool points along −z from it and is `tool_length` long, so that
/// tip z = flange z − tool length. Coordinates that the transform does not use move an axis of their own, or must
/// stay 0 (within 10⁻⁹ m). Additional axes have nothing to do with the tool: they stay where they are.
#[derive(Debug)]
pub struct MachineAxes {
    transform: Box<dyn Kinematics>,
    sources: Vec<AxisSource>,
    /// Coordinates that move something.
    coordinates: Vec<Coordinate>,
    tool_length: f64,
}

impl MachineAxes {
    /// A machine whose axis i is moved by `sources[i]`, with a tool of `tool_length` (m).
    ///
    /// # Errors
    /// Every output of the transform must move exactly one axis, and a coordinate at most one.
    pub fn new(
        transform: Box<dyn Kinematics>,
        sources: Vec<AxisSource>,
        tool_length: f64,
    ) -> Result<Self, MachineAxesError> {
        if sources.len() > MAX_AXES {
            return Err(MachineAxesError::TooMany { given: sources.len() });
        }
        let outputs = transform.axis_count();
        let mut coordinates = transform.coordinates().to_vec();
        for (position, source) in sources.iter().enumerate() {
            let earlier = sources.iter().take(position);
            let twice = earlier.into_iter().any(|other| other == source);
            match *source {
                AxisSource::Transform(output) if output >= outputs => {
                    return Err(MachineAxesError::NoSuchOutput { output, outputs });
                }
                AxisSource::Transform(output) if twice => {
                    return Err(MachineAxesError::OutputTwice { output });
                }
                AxisSource::Coordinate(coordinate) if twice => {
                    return Err(MachineAxesError::CoordinateTwice { coordinate });
                }
                AxisSource::Coordinate(coordinate)
                    if transform.coordinates().contains(&coordinate) =>
                {
                    return Err(MachineAxesError::CoordinateOfTransform { coordinate });
                }
                AxisSource::Coordinate(coordinate) => coordinates.push(coordinate),
                AxisSource::Additional(number) if twice => {
                    return Err(MachineAxesError::AdditionalTwice { number });
                }
                AxisSource::Transform(_) | AxisSource::Additional(_) => {}
            }
        }
        if let Some(output) =
            (0..outputs).find(|output| !sources.contains(&AxisSource::Transform(*output)))
        {
            return Err(MachineAxesError::OutputWithoutAxis { output });
        }
        if !tool_length.is_finite() {
            return Err(MachineAxesError::ToolLength);
        }
        if tool_length != 0.0 && !coordinates.contains(&Coordinate::Z) {
            return Err(MachineAxesError::ToolWithoutZ { length: tool_length });
        }
        coordinates.sort_unstable();
        Ok(Self { transform, sources, coordinates, tool_length })
    }

    /// What moves each axis, in the order of the machine file.
    pub fn sources(&self) -> &[AxisSource] {
        &self.sources
    }

    /// Length of the tool, m.
    pub const fn tool_length(&self) -> f64 {
        self.tool_length
    }

    /// The outputs of the transform among machine axis values.
    fn outputs(&self, axes: &AxisVector) -> AxisVector {
        let mut outputs = AxisVector::zeros(self.transform.axis_count());
        for (value, source) in axes.iter().zip(&self.sources) {
            if let AxisSource::Transform(output) = *source
                && let Some(slot) = outputs.get_mut(output)
            {
                *slot = *value;
            }
        }
        outputs
    }

    /// Machine axis values from outputs of the transform and the coordinates of the flange (or their derivatives), and
    /// what the additional axes have, by place in the machine.
    fn machine(
        &self,
        outputs: &AxisVector,
        flange: &Vector3<f64>,
        additional: Option<&AxisVector>,
    ) -> AxisVector {
        AxisVector::from_values(self.sources.iter().enumerate().map(|(place, source)| {
            let value = match *source {
                AxisSource::Transform(output) => outputs.get(output).copied(),
                AxisSource::Coordinate(coordinate) => Some(coordinate.of(flange)),
                AxisSource::Additional(_) => {
                    additional.and_then(|values| values.get(place)).copied()
                }
            };
            value.unwrap_or_default()
        }))
    }

    fn check_count(&self, axes: &AxisVector) -> Result<(), KinematicsError> {
        let (given, expected) = (axes.len(), self.sources.len());
        if given == expected { Ok(()) } else { Err(KinematicsError::AxisCount { given, expected }) }
    }

    /// Where the flange must be for the tool tip to be at `pose`.
    fn flange(&self, pose: &Pose) -> Result<Vector3<f64>, KinematicsError> {
        if !pose.is_finite() {
            return Err(KinematicsError::NotFinite);
        }
        let flange = pose.position.coords + Vector3::new(0.0, 0.0, self.tool_length);
        for coordinate in Coordinate::ALL {
            let value = coordinate.of(&flange);
            if value.abs() > ABSENT && !self.coordinates.contains(&coordinate) {
                return Err(KinematicsError::NoAxis { coordinate, value });
            }
        }
        Ok(flange)
    }

    /// The coordinates of `flange` that the transform uses, 0 for the others.
    fn part_of_transform(&self, flange: &Vector3<f64>) -> Vector3<f64> {
        let mut part = Vector3::zeros();
        for coordinate in self.transform.coordinates() {
            *coordinate.of_mut(&mut part) = coordinate.of(flange);
        }
        part
    }
}

/// Lets an error speak of the tool tip that was asked for, not of the flange.
fn at_tip(error: KinematicsError, tip: &Pose) -> KinematicsError {
    let target = tip.position.into();
    match error {
        KinematicsError::Unreachable { distance, reach, .. } => {
            KinematicsError::Unreachable { target, distance, reach }
        }
        KinematicsError::Singular { .. } => KinematicsError::Singular { target },
        other => other,
    }
}

impl Kinematics for MachineAxes {
    fn axis_count(&self) -> usize {
        self.sources.len()
    }

    fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    fn forward(&self, axes: &AxisVector) -> Result<Pose, KinematicsError> {
        self.check_count(axes)?;
        if !axes.is_finite() {
            return Err(KinematicsError::NotFinite);
        }
        let mut pose = self.transform.forward(&self.outputs(axes))?;
        for (value, source) in axes.iter().zip(&self.sources) {
            if let AxisSource::Coordinate(coordinate) = *source {
                *coordinate.of_mut(&mut pose.position.coords) = *value;
            }
        }
        pose.position.z -= self.tool_length;
        Ok(pose)
    }

    fn inverse(&self, pose: &Pose, near: &AxisVector) -> Result<AxisVector, KinematicsError> {
        self.check_count(near)?;
        let flange = self.flange(pose)?;
        let target = Pose { position: self.part_of_transform(&flange).into(), ..*pose };
        let outputs = self
            .transform
            .inverse(&target, &self.outputs(near))
            .map_err(|error| at_tip(error, pose))?;
        Ok(self.machine(&outputs, &flange, Some(near)))
    }

    fn inverse_motion(
        &self,
        tool: &ToolMotion,
        near: &AxisVector,
    ) -> Result<AxisMotion, KinematicsError> {
        self.check_count(near)?;
        if !tool.is_finite() {
            return Err(KinematicsError::NotFinite);
        }
        let flange = self.flange(&tool.pose)?;
        let target = ToolMotion {
            pose: Pose { position: self.part_of_transform(&flange).into(), ..tool.pose },
            velocity: self.part_of_transform(&tool.velocity),
            acceleration: self.part_of_transform(&tool.acceleration),
            ..*tool
        };
        let outputs = self
            .transform
            .inverse_motion(&target, &self.outputs(near))
            .map_err(|error| at_tip(error, &tool.pose))?;
        Ok(AxisMotion {
            position: self.machine(&outputs.position, &flange, Some(near)),
            velocity: self.machine(&outputs.velocity, &tool.velocity, None),
            acceleration: self.machine(&outputs.acceleration, &tool.acceleration, None),
        })
    }
}
