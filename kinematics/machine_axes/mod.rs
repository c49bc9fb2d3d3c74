//! Kinematics of a whole machine: the axes of its transform and the axes that are tool coordinates themselves.

mod error;

pub use error::MachineAxesError;

use crate::kinematics::ABSENT;
use crate::turn::fold;
use crate::{
    AxisDisc, AxisMotion, AxisVector, Branch, Coordinate, Jacobian, Kinematics, KinematicsError,
    MAX_AXES, Margins, Pose, Result, ToolDisc, ToolJerk, ToolMotion,
};
use nalgebra::Vector3;

/// Source of the position of a machine axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisSource {
    /// This output of the transform, from 0.
    Transform(usize),
    /// A coordinate that the transform does not use: the axis position is the coordinate.
    Coordinate(Coordinate),
    /// The additional axis of this number (SoftMotion's P Q U V W are 0 to 4), which does not move the tool: the
    /// inverse leaves it where it is in `near`.
    Additional(u8),
}

/// The kinematics of a whole machine, with axes in the order of the machine file.
///
/// The transform is given a tool to hold, whose tip it puts at the target. Coordinates that the transform does not
/// use move an axis of their own, which carries the tool along, or must stay 0 (within 10⁻⁹ m). Additional axes
/// do not move the tool and stay where they are.
#[derive(Debug)]
pub struct MachineAxes {
    transform: Box<dyn Kinematics>,
    sources: Vec<AxisSource>,
    /// The axes are the outputs of the transform, in their order.
    is_in_order: bool,
    /// The transform uses x, y and z.
    is_spatial: bool,
    /// Coordinates that move something.
    coordinates: Vec<Coordinate>,
    tool: Vector3<f64>,
    /// [`beyond`] the transform.
    beyond: Vector3<f64>,
    periods: Vec<Option<f64>>,
}

impl MachineAxes {
    /// A machine whose axis i is moved by `sources[i]`, with a tool whose tip is at `tool` (m) in the frame of the
    /// flange: z up, so that a tool of the length l straight down is (0, 0, −l).
    ///
    /// # Errors
    /// Every output of the transform must move exactly one axis, and a coordinate at most one.
    pub fn new(
        transform: Box<dyn Kinematics>,
        sources: Vec<AxisSource>,
        tool: Vector3<f64>,
    ) -> Result<Self, MachineAxesError> {
        if sources.len() > MAX_AXES {
            return Err(MachineAxesError::TooMany(sources.len()));
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
                    return Err(MachineAxesError::OutputTwice(output));
                }
                AxisSource::Coordinate(coordinate) if twice => {
                    return Err(MachineAxesError::CoordinateTwice(coordinate));
                }
                AxisSource::Coordinate(coordinate)
                    if transform.coordinates().contains(&coordinate)
                        || coordinate == Coordinate::Direction =>
                {
                    return Err(MachineAxesError::CoordinateOfTransform(coordinate));
                }
                AxisSource::Coordinate(coordinate) => coordinates.push(coordinate),
                AxisSource::Additional(number) if twice => {
                    return Err(MachineAxesError::AdditionalTwice(number));
                }
                AxisSource::Transform(_) | AxisSource::Additional(_) => {}
            }
        }
        if let Some(output) =
            (0..outputs).find(|output| !sources.contains(&AxisSource::Transform(*output)))
        {
            return Err(MachineAxesError::OutputWithoutAxis(output));
        }
        if !tool.iter().all(|value| value.is_finite()) {
            return Err(MachineAxesError::Tool);
        }
        if tool.z != 0.0 && !coordinates.contains(&Coordinate::Z) {
            return Err(MachineAxesError::ToolWithoutZ(-tool.z));
        }
        coordinates.sort_unstable();
        let beyond = beyond(&*transform, tool);
        let periods = vec![None; sources.len()];
        let transform = transform.holding(&tool);
        let is_in_order = sources.iter().copied().eq((0..outputs).map(AxisSource::Transform));
        let used = transform.coordinates();
        let is_spatial = Coordinate::TRANSLATIONS.iter().all(|one| used.contains(one));
        Ok(Self { transform, sources, is_in_order, is_spatial, coordinates, tool, beyond, periods })
    }

    /// The same machine with axes that show their position within a period (m or rad; `None`: as far as they go):
    /// modulo axes. The kinematics goes on from period to period; [`Self::fold`] gives what such an axis shows.
    ///
    /// # Errors
    /// [`MachineAxesError::Period`].
    pub fn with_periods(mut self, periods: &[Option<f64>]) -> Result<Self, MachineAxesError> {
        for (axis, (slot, period)) in self.periods.iter_mut().zip(periods).enumerate() {
            if let Some(period) = *period
                && !(period.is_finite() && period > 0.0)
            {
                return Err(MachineAxesError::Period { axis, period });
            }
            *slot = *period;
        }
        Ok(self)
    }

    /// Source of each axis position, in the order of the machine file.
    pub fn sources(&self) -> &[AxisSource] {
        &self.sources
    }

    /// The transform of those axes that are not coordinates themselves, holding the tool.
    pub fn transform(&self) -> &dyn Kinematics {
        &*self.transform
    }

    /// Tip of the tool in the frame of the flange, m.
    pub const fn tool(&self) -> &Vector3<f64> {
        &self.tool
    }

    /// The period of an axis, m or rad.
    pub fn period(&self, axis: usize) -> Option<f64> {
        self.periods.get(axis).copied().flatten()
    }

    /// Axis positions as modulo axes show them: 0 ≤ position < period.
    #[must_use]
    pub fn fold(&self, axes: &AxisVector) -> AxisVector {
        AxisVector::from_values(axes.iter().enumerate().map(|(axis, position)| {
            self.period(axis).map_or(*position, |period| fold(*position, period))
        }))
    }

    /// The outputs of the transform among machine axis values.
    fn outputs(&self, axes: &AxisVector) -> AxisVector {
        if self.is_in_order {
            return *axes;
        }
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

    fn outputs_of_motion(&self, axes: &AxisMotion) -> AxisMotion {
        AxisMotion {
            position: self.outputs(&axes.position),
            velocity: self.outputs(&axes.velocity),
            acceleration: self.outputs(&axes.acceleration),
        }
    }

    /// Machine axis values from outputs of the transform and the coordinates of the flange (or their derivatives), and
    /// what the additional axes have, by place in the machine.
    fn machine(
        &self,
        outputs: &AxisVector,
        flange: &Vector3<f64>,
        additional: Option<&AxisVector>,
    ) -> AxisVector {
        if self.is_in_order {
            return *outputs;
        }
        AxisVector::from_values(self.sources.iter().enumerate().map(|(place, source)| {
            let value = match *source {
                AxisSource::Transform(output) => outputs.get(output).copied(),
                AxisSource::Coordinate(coordinate) => Some(coordinate.of(flange, 0.0)),
                AxisSource::Additional(_) => {
                    additional.and_then(|values| values.get(place)).copied()
                }
            };
            value.unwrap_or_default()
        }))
    }

    /// Adds the axes that are coordinates to what the transform says of the tool.
    fn add_coordinates(&self, axes: &AxisVector, tool: &mut Vector3<f64>) {
        for (value, source) in axes.iter().zip(&self.sources) {
            if let AxisSource::Coordinate(coordinate) = *source {
                *coordinate.of_mut(tool, &mut 0.0) = *value;
            }
        }
    }

    fn check(&self, axes: &AxisVector) -> Result<()> {
        let (given, expected) = (axes.len(), self.sources.len());
        if given != expected {
            return Err(KinematicsError::AxisCount { given, expected });
        }
        if axes.is_finite() { Ok(()) } else { Err(KinematicsError::NotFinite) }
    }

    fn check_motion(&self, axes: &AxisMotion) -> Result<()> {
        [&axes.position, &axes.velocity, &axes.acceleration]
            .map(|axes| self.check(axes))
            .into_iter()
            .collect()
    }

    /// Positions of the axes that are coordinates for the tool tip at `pose`, and the pose for the transform.
    fn split(&self, pose: &Pose) -> Result<(Vector3<f64>, Pose)> {
        if !pose.is_finite() {
            return Err(KinematicsError::NotFinite);
        }
        let flange = pose.position.coords - self.beyond;
        for coordinate in Coordinate::TRANSLATIONS {
            let value = coordinate.of(&flange, 0.0);
            if value.abs() > ABSENT && !self.coordinates.contains(&coordinate) {
                return Err(KinematicsError::NoAxis { coordinate, value });
            }
        }
        Ok((flange, Pose { position: self.part_of_transform(&flange).into(), ..*pose }))
    }

    fn split_motion(&self, tool: &ToolMotion) -> Result<(Vector3<f64>, ToolMotion)> {
        if !tool.is_finite() {
            return Err(KinematicsError::NotFinite);
        }
        let (flange, pose) = self.split(&tool.pose)?;
        let part = ToolMotion {
            pose,
            velocity: self.part_of_transform(&tool.velocity),
            acceleration: self.part_of_transform(&tool.acceleration),
            ..*tool
        };
        Ok((flange, part))
    }

    /// The coordinates of `flange` that the transform uses, 0 for the others.
    fn part_of_transform(&self, flange: &Vector3<f64>) -> Vector3<f64> {
        if self.is_spatial {
            return *flange;
        }
        let mut part = Vector3::zeros();
        for coordinate in self.transform.coordinates() {
            *coordinate.of_mut(&mut part, &mut 0.0) = coordinate.of(flange, 0.0);
        }
        part
    }

    /// Pose of the transform's tool with the other coordinates added.
    fn joined_pose(&self, mut pose: Pose, axes: &AxisVector) -> Pose {
        self.add_coordinates(axes, &mut pose.position.coords);
        pose.position += self.beyond;
        pose
    }

    fn joined_motion(&self, mut tool: ToolMotion, axes: &AxisMotion) -> ToolMotion {
        tool.pose = self.joined_pose(tool.pose, &axes.position);
        self.add_coordinates(&axes.velocity, &mut tool.velocity);
        self.add_coordinates(&axes.acceleration, &mut tool.acceleration);
        tool
    }

    fn machine_motion(
        &self,
        outputs: &AxisMotion,
        flange: &Vector3<f64>,
        tool: &ToolMotion,
        near: &AxisVector,
    ) -> AxisMotion {
        AxisMotion {
            position: self.machine(&outputs.position, flange, Some(near)),
            velocity: self.machine(&outputs.velocity, &tool.velocity, None),
            acceleration: self.machine(&outputs.acceleration, &tool.acceleration, None),
        }
    }

    /// The Jacobian of the machine from that of the transform.
    fn joined_jacobian(&self, of_transform: &Jacobian) -> Jacobian {
        let mut jacobian = Jacobian::zeros(self.sources.len());
        for (axis, source) in self.sources.iter().enumerate() {
            match *source {
                AxisSource::Transform(output) => {
                    for coordinate in self.transform.coordinates() {
                        jacobian.set(*coordinate, axis, of_transform.get(*coordinate, output));
                    }
                }
                AxisSource::Coordinate(coordinate) => jacobian.set(coordinate, axis, 1.0),
                AxisSource::Additional(_) => {}
            }
        }
        jacobian
    }
}

/// The part of `tool` that the transform does not use.
fn beyond(transform: &dyn Kinematics, mut tool: Vector3<f64>) -> Vector3<f64> {
    for coordinate in transform.coordinates() {
        *coordinate.of_mut(&mut tool, &mut 0.0) = 0.0;
    }
    tool
}

/// Puts the tool tip that was asked for into an error: the transform does not know all of its coordinates.
fn at_tip(error: KinematicsError, tip: &Pose) -> KinematicsError {
    let target = tip.position.into();
    match error {
        KinematicsError::Unreachable { of, distance, reach, .. } => {
            KinematicsError::Unreachable { target, of, distance, reach }
        }
        KinematicsError::Singular(_) => KinematicsError::Singular(target),
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

    fn is_rotary(&self, axis: usize) -> bool {
        match self.sources.get(axis) {
            Some(AxisSource::Transform(output)) => self.transform.is_rotary(*output),
            _ => false,
        }
    }

    fn moves_tool(&self, axis: usize) -> bool {
        !matches!(self.sources.get(axis), None | Some(AxisSource::Additional(_)))
    }

    fn forward(&self, axes: &AxisVector) -> Result<Pose> {
        self.check(axes)?;
        Ok(self.joined_pose(self.transform.forward(&self.outputs(axes))?, axes))
    }

    fn inverse(&self, pose: &Pose, near: &AxisVector) -> Result<AxisVector> {
        self.check(near)?;
        let (flange, target) = self.split(pose)?;
        let outputs = self.transform.inverse(&target, &self.outputs(near));
        let outputs = outputs.map_err(|error| at_tip(error, pose))?;
        Ok(self.machine(&outputs, &flange, Some(near)))
    }

    fn forward_motion(&self, axes: &AxisMotion) -> Result<ToolMotion> {
        self.check_motion(axes)?;
        Ok(self.joined_motion(self.transform.forward_motion(&self.outputs_of_motion(axes))?, axes))
    }

    fn inverse_motion(&self, tool: &ToolMotion, near: &AxisVector) -> Result<AxisMotion> {
        self.check(near)?;
        let (flange, target) = self.split_motion(tool)?;
        let outputs = self.transform.inverse_motion(&target, &self.outputs(near));
        let outputs = outputs.map_err(|error| at_tip(error, &tool.pose))?;
        Ok(self.machine_motion(&outputs, &flange, tool, near))
    }

    fn inverse_jerk(
        &self,
        tool: &ToolMotion,
        jerk: &ToolJerk,
        near: &AxisVector,
    ) -> Result<(AxisMotion, AxisVector)> {
        self.check(near)?;
        let (flange, target) = self.split_motion(tool)?;
        let part = ToolJerk { linear: self.part_of_transform(&jerk.linear), ..*jerk };
        let outputs = self.transform.inverse_jerk(&target, &part, &self.outputs(near));
        let (outputs, axis_jerk) = outputs.map_err(|error| at_tip(error, &tool.pose))?;
        let motion = self.machine_motion(&outputs, &flange, tool, near);
        Ok((motion, self.machine(&axis_jerk, &jerk.linear, None)))
    }

    fn jacobian(&self, axes: &AxisVector) -> Result<Jacobian> {
        self.check(axes)?;
        Ok(self.joined_jacobian(&self.transform.jacobian(&self.outputs(axes))?))
    }

    fn branch(&self) -> Branch {
        self.transform.branch()
    }

    fn branch_at(&self, axes: &AxisVector) -> Result<Branch> {
        self.check(axes)?;
        self.transform.branch_at(&self.outputs(axes))
    }

    fn margins(&self, pose: &Pose) -> Result<Margins> {
        self.transform.margins(&self.split(pose)?.1)
    }

    fn disc(&self, path: &ToolDisc) -> Option<AxisDisc> {
        let (_, pose) = self.split(&path.pose).ok()?;
        let [rate, bend] = [&path.rate, &path.bend].map(|values| self.part_of_transform(values));
        let part = ToolDisc { pose, rate, bend, ..*path };
        let AxisDisc { radius, change, is_even } = self.transform.disc(&part)?;
        // Axes of their own change as much as the tool at most; what additional axes do is unknown here.
        let change = self.sources.iter().map(|source| match *source {
            AxisSource::Transform(output) => change.get(output).copied().unwrap_or_default(),
            AxisSource::Coordinate(coordinate) => coordinate.of(&path.way(radius), 0.0),
            AxisSource::Additional(_) => 0.0,
        });
        let is_even = is_even && path.is_even();
        Some(AxisDisc { radius, change: AxisVector::from_values(change), is_even })
    }

    fn characteristic_length(&self) -> f64 {
        self.transform.characteristic_length()
    }

    fn holding(self: Box<Self>, tip: &Vector3<f64>) -> Box<dyn Kinematics> {
        let beyond = beyond(&*self.transform, *tip);
        let transform = self.transform.holding(tip);
        Box::new(Self { transform, tool: *tip, beyond, ..*self })
    }
}
