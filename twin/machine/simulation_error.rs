//! Simulation error: an error of the physics with the names of the machine file.

use super::Machine;
use std::fmt;
use twin_physics::{PhysicsError, Subject};

/// A [`PhysicsError`] with the names of axes, joints and links in the place of their numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationError {
    /// The same, with numbers.
    pub error: PhysicsError,
    message: String,
}

impl SimulationError {
    /// `error` with the names of `machine`. Parts without a name keep their number.
    pub fn of(machine: &Machine, error: PhysicsError) -> Self {
        let message = error.message(|subject| match subject {
            Subject::Axis(index) => {
                named("axis", subject, machine.axes.get(index).map(|axis| &axis.name))
            }
            Subject::Joint(index) => {
                named("joint", subject, machine.model.joints.get(index).map(|joint| &joint.name))
            }
            Subject::Link(index) => {
                named("link", subject, machine.model.links.get(index).map(|link| &link.name))
            }
            Subject::Part(part) => machine.part_name(part),
        });
        Self { error, message }
    }
}

fn named(what: &str, subject: Subject, name: Option<&String>) -> String {
    name.map_or_else(|| subject.to_string(), |name| format!("{what} {name}"))
}

impl fmt::Display for SimulationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for SimulationError {}
