//! How a program is checked, and why that may not be possible.

use crate::limit::{LimitFailure, Limits, MachinePathError};
use crate::m_function::Acknowledge;
use crate::machine::{Scenario, SimulationError};
use std::io;

/// Why a program could not be checked.
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

/// How a program is checked.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckOptions {
    /// Whose limits the path is planned with.
    pub limits: Limits,
    /// Also on the simulated machine.
    pub physics: bool,
    /// What goes wrong on the simulated machine.
    pub scenario: Scenario,
    /// Who acknowledges M functions.
    pub acknowledge: Acknowledge,
    /// Also predict how well the drives of the machine file will follow.
    pub drives: bool,
}

impl Default for CheckOptions {
    /// What a run needs to know before it moves anything.
    fn default() -> Self {
        Self {
            limits: Limits::Softmotion,
            physics: false,
            scenario: Scenario::default(),
            acknowledge: Acknowledge::Auto,
            drives: false,
        }
    }
}
