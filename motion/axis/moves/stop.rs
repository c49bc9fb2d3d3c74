//! `MC_Stop` and `MC_Halt`: brake the axis, with or without locking it.

use super::{Planned, PlannedMotion};
use crate::ownership::{Refusal, Start};
use crate::{Axis, AxisState, SmcError};

/// Brakes and locks the axis (`MC_Stop`, manual 5.3).
///
/// Nothing can interrupt it: the axis is locked until it is at rest and Execute is FALSE.
#[doc(alias = "MC_Stop")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Deceleration, u/s².
    pub deceleration: f64,
}

impl PlannedMotion for Stop {
    const STATE: AxisState = AxisState::Stopping;

    fn admitted(&self, axis: &Axis) -> Result<(), Refusal> {
        match axis.state() {
            AxisState::ErrorStop => Err(SmcError::MsAxisInErrorstop.into()),
            // Another stop holds the axis; MC_Stop has no CommandAborted.
            AxisState::Stopping => Err(SmcError::MsUnknownStoppingError.into()),
            _ => axis.admits(Self::STATE),
        }
    }

    fn plan(&self, start: Start, axis: &Axis) -> Result<Planned, SmcError> {
        Planned::halt(self.deceleration, start, axis)
            .map_err(|_invalid| SmcError::MsInvalidAccdecValues)
    }
}

/// Brakes the axis, without locking it (`MC_Halt`, manual 5.3).
#[doc(alias = "MC_Halt")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halt {
    /// Deceleration, u/s².
    pub deceleration: f64,
}

impl PlannedMotion for Halt {
    // The manual has no error of MC_Halt's own; it shows MC_Stop's.
    fn plan(&self, start: Start, axis: &Axis) -> Result<Planned, SmcError> {
        Planned::halt(self.deceleration, start, axis)
            .map_err(|_invalid| SmcError::MsInvalidAccdecValues)
    }
}
