//! Simulation error: an error of the physics with the names of the machine file.

use super::Machine;
use twin_physics::{PhysicsError, Subject};

/// A [`PhysicsError`] with the names of axes, joints and links in the place of their numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct SimulationError {
    /// The same, with numbers.
    pub error: PhysicsError,
    message: String,
}

impl SimulationError {
    /// `error` with the names of `machine`. Parts without a name keep their number.
    pub fn of(machine: &Machine, error: PhysicsError) -> Self {
        Self::with_tool(machine, error, None)
    }

    /// The same with this tool of a tool table in the spindle, by its number.
    pub fn with_tool(machine: &Machine, error: PhysicsError, tool: Option<u32>) -> Self {
        let message = error.message(|subject| {
            match subject {
                Subject::Axis(index) => {
                    machine.axes.get(index).map(|axis| format!("axis {}", axis.name))
                }
                Subject::Joint(index) => {
                    machine.model.joints.get(index).map(|joint| format!("joint {}", joint.name))
                }
                Subject::Link(index) => {
                    machine.model.links.get(index).map(|link| format!("link {}", link.name))
                }
                Subject::Part(part) => Some(machine.part_name_with(part, tool)),
            }
            .unwrap_or_else(|| subject.to_string())
        });
        Self { error, message }
    }
}
