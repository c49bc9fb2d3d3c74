//! Coupling output: set-point of the slave, tappets that acted, and the errors of a start.

use super::passage::Trigger;
use twin_number::Short;
use twin_profile::State;

/// Checks that a state is possible for an axis.
pub(super) fn check(state: &State, axis: &'static str) -> Result<(), CouplingError> {
    let all = [state.position, state.velocity, state.acceleration];
    match all.into_iter().find(|value| !value.is_finite()) {
        Some(value) => Err(CouplingError::NotFinite { what: axis, value }),
        None => Ok(()),
    }
}

/// Tappets that can be reported in one cycle (`SMC_TappetData`).
pub const MAX_TRIGGERS: usize = 3;

/// Tappets that acted in a cycle (`SMC_TappetData`): the first [`MAX_TRIGGERS`] of them.
#[doc(alias = "SMC_TappetData")]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TappetData {
    pub(super) triggers: [Option<Trigger>; MAX_TRIGGERS],
    /// Number of further ones, which are lost.
    pub lost: usize,
    /// Time of the cycle by the coupling's clock, ns. It has to go on from one coupling to the next: what a timed
    /// tappet has begun ends by it.
    pub now_ns: i64,
}

impl TappetData {
    /// In the order in which the master passed them.
    pub fn triggers(&self) -> impl Iterator<Item = &Trigger> {
        self.triggers.iter().flatten()
    }
}

/// Output of a coupling in a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupled {
    /// The slave's set-point. Its position does not jump at the ends of a period.
    pub slave: State,
    /// True if the slave is on the cam.
    pub in_sync: bool,
    /// True if the cam has been left at an end; of a periodic one, in this cycle only.
    pub end_of_profile: bool,
    /// Tappets.
    pub tappets: TappetData,
}

/// Reason why a coupling does not start.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CouplingError {
    /// Error 626, `SMC_CI_MASTER_OUT_OF_SCALE`.
    #[error("the master is at {} of the cam, which goes from {} to {} (error 626)", Short(*.master), Short(*.min), Short(*.max))]
    MasterOutOfRange {
        /// Its place, u of the cam.
        master: f64,
        /// Begin of the cam.
        min: f64,
        /// End of the cam.
        max: f64,
    },
    /// Error 627, `SMC_CI_RAMPIN_NEEDS_VELACC_VALUES`.
    #[error("a start with a ramp needs {name} greater than 0, it is {value} (error 627)")]
    RampNeedsValues {
        /// The input.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A position, velocity or input is not a finite number.
    #[error("{what}: {value} is not a finite number")]
    NotFinite {
        /// What.
        what: &'static str,
        /// Its value.
        value: f64,
    },
}

impl CouplingError {
    /// The manual's number (`SMC_ERROR`, 9.3); none for what it has no number for.
    pub const fn number(&self) -> Option<u16> {
        match self {
            Self::MasterOutOfRange { .. } => Some(626),
            Self::RampNeedsValues { .. } => Some(627),
            Self::NotFinite { .. } => None,
        }
    }
}
