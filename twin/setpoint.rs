//! Set-points per axis: the one stream that physics and drives both get.

use crate::machine::Machine;
use twin_kinematics::{AxisMotion, AxisVector, Kinematics, KinematicsError, Pose, ToolMotion};
use twin_motion::Place;
use twin_motion::interpolate::ToolSetpoint;

/// Where every axis shall be at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisSetpoint {
    /// Since the start of the program, ns.
    pub time_ns: i64,
    /// The block being traversed.
    pub place: Place,
    /// Axes in machine-file order.
    pub axes: AxisMotion,
    /// The tool in the machine frame.
    pub tool: ToolMotion,
    /// Velocity along the path, m/s.
    pub path_velocity: f64,
    /// Programmed velocity along the path, m/s; `None` on a rapid.
    pub feed: Option<f64>,
}

/// Turns tool set-points into axis set-points. Rotary axes go on from turn to turn along the path.
#[derive(Clone, Debug)]
pub struct Transformer<'m> {
    machine: &'m Machine,
    near: AxisVector,
}

impl<'m> Transformer<'m> {
    /// For a program that starts anywhere: the first answer is the one nearest to the middle of the software limits.
    pub fn new(machine: &'m Machine) -> Self {
        Self { machine, near: machine.middle() }
    }

    /// The axes for one tool set-point.
    ///
    /// # Errors
    /// What the kinematics refuses.
    pub fn axes(&mut self, tool: &ToolSetpoint) -> Result<AxisSetpoint, KinematicsError> {
        let work = ToolMotion {
            pose: Pose { position: tool.position, direction: 0.0 },
            velocity: tool.velocity,
            acceleration: tool.acceleration,
            direction_velocity: 0.0,
            direction_acceleration: 0.0,
        };
        let motion = self.machine.frame.motion_to_machine(&work);
        let axes = self.machine.kinematics.inverse_motion(&motion, &self.near)?;
        self.near = axes.position;
        Ok(AxisSetpoint {
            time_ns: tool.time_ns,
            place: tool.place,
            axes,
            tool: motion,
            path_velocity: tool.path_velocity,
            feed: (!tool.rapid).then_some(tool.feed),
        })
    }
}
