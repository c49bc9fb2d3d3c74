//! Options of a check, and the errors that make a check impossible.

use crate::limit::{LimitFailure, Limits, MachinePathError};
use crate::m_function::Acknowledge;
use std::io;
use twin_kinematics::AxisVector;
use twin_machine::{Scenario, SimulationError};

/// Errors that make a check impossible.
#[derive(Debug, thiserror::Error)]
pub enum CheckFailure {
    /// The file.
    #[error(transparent)]
    Read(#[from] io::Error),
    /// The simulated machine.
    #[error(transparent)]
    Physics(#[from] SimulationError),
    /// The limits of the axes.
    #[error(transparent)]
    Limits(#[from] MachinePathError),
}

impl From<LimitFailure> for CheckFailure {
    fn from(failure: LimitFailure) -> Self {
        match failure {
            LimitFailure::Read(error) => Self::Read(error),
            LimitFailure::Machine(error) => Self::Limits(error),
        }
    }
}

/// Options of a check.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckOptions {
    /// Limits that the path is planned with.
    pub limits: Limits,
    /// Also on the simulated machine.
    pub physics: bool,
    /// Faults of the simulated machine.
    pub scenario: Scenario,
    /// Acknowledgement of M functions.
    pub acknowledge: Acknowledge,
    /// Also predict how well the drives of the machine file will follow.
    pub drives: bool,
    /// Axis positions at the end of the program before, m or rad: the axes bridge the gap to the start of this one.
    pub continues: Option<AxisVector>,
}

impl Default for CheckOptions {
    /// The plan within the limits of the axes, without physics and drives: what `twin check` looks at by default.
    fn default() -> Self {
        Self {
            limits: Limits::Axes,
            physics: false,
            scenario: Scenario::default(),
            acknowledge: Acknowledge::Auto,
            drives: false,
            continues: None,
        }
    }
}
