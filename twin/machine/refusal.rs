//! What the simulated machine refuses, in the words of the machine file.

use super::Machine;
use crate::physics::{Part, PhysicsError};
use std::fmt;

/// A [`PhysicsError`] with the names of axes, joints and links in the place of their numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationError {
    /// The same, with numbers.
    pub error: PhysicsError,
    said: String,
}

impl SimulationError {
    /// `error` as it is said of `machine`. What has no name keeps its number.
    pub fn of(machine: &Machine, error: PhysicsError) -> Self {
        let said = error.said(|part| match part {
            Part::Axis(index) => {
                named("axis", part, machine.axes.get(index).map(|axis| &axis.name))
            }
            Part::Joint(index) => {
                named("joint", part, machine.model.joints.get(index).map(|joint| &joint.name))
            }
            Part::Link(index) => {
                named("link", part, machine.model.links.get(index).map(|link| &link.name))
            }
        });
        Self { error, said }
    }
}

fn named(what: &str, part: Part, name: Option<&String>) -> String {
    name.map_or_else(|| part.to_string(), |name| format!("{what} {name}"))
}

impl fmt::Display for SimulationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.said)
    }
}

impl std::error::Error for SimulationError {}
