//! A worked example: what the axes do in the middle of the workspace.

use super::space::Space;
use nalgebra::{Point3, Vector3};
use twin_kinematics::{AxisVector, Branch, Kinematics, KinematicsError, Margins, ToolMotion};

/// The name of a turning tool's way.
const DIRECTION: &str = "direction";

/// Axis motion for one direction of tool motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// x, y, z, or the direction of the tool.
    pub name: &'static str,
    /// Axis velocities per velocity of the tool: rad/m, 1, or m/rad.
    pub rates: AxisVector,
    /// The first axis at its velocity limit, and the tool velocity then (m/s or rad/s); `None` if no axis moves.
    pub fastest: Option<(usize, f64)>,
}

impl Way {
    /// True for the direction of the tool, whose velocity is in rad/s.
    pub fn turns(&self) -> bool {
        self.name == DIRECTION
    }
}

/// One pose, worked out.
#[derive(Clone, Debug, PartialEq)]
pub struct Example {
    /// Tool tip, m, machine frame.
    pub position: Point3<f64>,
    /// Axis positions, m or rad.
    pub axes: AxisVector,
    /// Margins to the edge of reach and to the other branches.
    pub margins: Margins,
    /// Branch of the solution.
    pub branch: Branch,
    /// x, y and, where the machine has axes for them, z and the direction of the tool.
    pub ways: Vec<Way>,
}

impl Example {
    /// Works out the pose of the tool at `position` (m, machine frame).
    ///
    /// # Errors
    /// If the tool cannot be there, or the axes cannot follow it every way.
    pub fn new(
        space: &Space<'_>,
        position: Point3<f64>,
        turns_tool: bool,
    ) -> Result<Self, KinematicsError> {
        let kinematics = &space.machine().kinematics;
        let pose = space.pose(position);
        let near = space.machine().middle();
        let axes = kinematics.inverse(&pose, &near)?;
        let rest = ToolMotion::at_rest(pose);
        let along = |name, velocity| (name, ToolMotion { velocity, ..rest });
        let moves = [
            along("x", Vector3::x()),
            along("y", Vector3::y()),
            along("z", Vector3::z()),
            (DIRECTION, ToolMotion { direction_velocity: 1.0, ..rest }),
        ];
        let mut ways = Vec::new();
        for (name, motion) in moves {
            if name == DIRECTION && !turns_tool {
                continue;
            }
            let rates = match kinematics.inverse_motion(&motion, &near) {
                Ok(motion) => motion.velocity,
                Err(KinematicsError::NoAxis { .. }) => continue,
                Err(error) => return Err(error),
            };
            let limits = space.machine().axes.iter().map(|axis| axis.max_velocity);
            let speeds = rates.iter().zip(limits).map(|(rate, limit)| limit / rate.abs());
            let fastest = speeds
                .enumerate()
                .filter(|(_, speed)| speed.is_finite())
                .min_by(|(_, one), (_, other)| one.total_cmp(other));
            // A coordinate without an axis of its own is one that nothing moves.
            if rates.iter().any(|rate| *rate != 0.0) {
                ways.push(Way { name, rates, fastest });
            }
        }
        let (margins, branch) = (kinematics.margins(&pose)?, kinematics.branch_at(&axes)?);
        Ok(Self { position, axes, margins, branch, ways })
    }
}
