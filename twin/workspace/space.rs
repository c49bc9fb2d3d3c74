//! State of one point of the workspace: within limits, beyond limits of some axes, or out of reach.

use nalgebra::Point3;
use twin_kinematics::{AxisVector, Kinematics, Pose};
use twin_machine::Machine;

/// Beyond a limit by no more than this is rounding, m or rad.
const SLACK: f64 = 1e-9;

/// Some of the axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct AxisSet(u8);

impl AxisSet {
    /// True for the axes in it.
    pub const fn contains(self, axis: usize) -> bool {
        axis < 8 && self.0 & (1 << axis) != 0
    }

    /// True if there is none.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    const fn with(self, axis: usize) -> Self {
        if axis < 8 { Self(self.0 | 1 << axis) } else { self }
    }
}

/// Reachability of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// No axis positions put it there.
    OutOfReach,
    /// Axis positions do, but these axes would be beyond their software limits.
    Beyond(AxisSet),
    /// Yes.
    Within,
}

/// Sample of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Reachability.
    pub state: State,
    /// Singularity measure, 0 to 1; 0 out of reach.
    pub measure: f64,
}

impl Sample {
    /// True within reach and software limits.
    pub fn is_within(&self) -> bool {
        self.state == State::Within
    }

    /// True if `axis` is beyond its limits.
    pub fn is_beyond(&self, axis: usize) -> bool {
        matches!(self.state, State::Beyond(axes) if axes.contains(axis))
    }
}

/// The space around a machine.
#[derive(Clone, Copy, Debug)]
pub struct Space<'m> {
    machine: &'m Machine,
    /// Of the turns of a rotary axis the one nearest to the middle of its limits is within them if any is.
    near: AxisVector,
    /// Direction of the tool about +z, rad.
    direction: f64,
}

impl<'m> Space<'m> {
    /// The space around `machine`, with the tool in `direction` (rad about +z) where the machine can turn it.
    pub fn new(machine: &'m Machine, direction: f64) -> Self {
        Self { machine, near: machine.middle(), direction }
    }

    /// The machine.
    pub fn machine(&self) -> &'m Machine {
        self.machine
    }

    /// Direction of the tool about +z, rad.
    pub fn direction(&self) -> f64 {
        self.direction
    }

    /// The pose of the tool at a point (m, machine frame).
    pub fn pose(&self, position: Point3<f64>) -> Pose {
        Pose { position, direction: self.direction }
    }

    /// The axis positions at a point; `None` out of reach.
    pub fn axes(&self, position: Point3<f64>) -> Option<AxisVector> {
        self.machine.kinematics.inverse(&self.pose(position), &self.near).ok()
    }

    /// Axes beyond their limits.
    pub fn beyond(&self, axes: &AxisVector) -> AxisSet {
        let limits = self.machine.axes.iter().map(|axis| axis.position_limits);
        let axes = axes.iter().zip(limits).enumerate();
        axes.fold(AxisSet::default(), |set, (index, (position, [low, high]))| {
            let fits = (low - SLACK..=high + SLACK).contains(position);
            if fits { set } else { set.with(index) }
        })
    }

    /// State and singularity measure at a point.
    pub fn sample(&self, position: Point3<f64>) -> Sample {
        let Some(axes) = self.axes(position) else {
            return Sample { state: State::OutOfReach, measure: 0.0 };
        };
        let beyond = self.beyond(&axes);
        let state = if beyond.is_empty() { State::Within } else { State::Beyond(beyond) };
        // The smallest singular value of the Jacobian; 0 without a Jacobian.
        let dexterity = self.machine.kinematics.dexterity(&axes, self.machine.length_scale);
        Sample { state, measure: dexterity.map_or(0.0, |dexterity| dexterity.smallest) }
    }

    /// [`Self::sample`] without the measure.
    pub fn state(&self, position: Point3<f64>) -> State {
        match self.axes(position).map(|axes| self.beyond(&axes)) {
            None => State::OutOfReach,
            Some(beyond) if beyond.is_empty() => State::Within,
            Some(beyond) => State::Beyond(beyond),
        }
    }
}
