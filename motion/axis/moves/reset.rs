//! `MC_Reset`: out of errorstop.

use super::home::ANSWER_S;
use crate::latch::{Latch, Outcome, Outputs};
use crate::{Axis, AxisState, SmcError};

/// Out of errorstop (`MC_Reset`, manual 5.3): to standstill, without power to `power_off`.
///
/// It waits until the axis has come to rest and the drive has let go of its own error: 122 if that cannot be reset, 121
/// if the drive does not do it, 123 if it does not answer.
#[doc(alias = "MC_Reset")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Reset {
    /// Time it has waited for the drive, s.
    waited: Option<f64>,
    latch: Latch,
}

impl Reset {
    /// Calls it, for a cycle, with Execute and its axis.
    pub fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs {
        if self.latch.rises(execute) {
            self.waited = axis.values.error.then_some(0.0);
            if self.waited.is_none() {
                self.latch.end(Outcome::Failed(SmcError::RNoErrorToReset));
            }
        }
        if let Some(waited) = &mut self.waited {
            axis.values.error_acknowledged = true;
            let rests = axis.total().velocity == 0.0;
            let stays = axis.drive.error.is_some() && !axis.drive.resettable;
            let outcome = if stays && axis.values.communication {
                Some(Outcome::Failed(SmcError::RErrorNotResettable))
            } else if !axis.values.error {
                // Another reset was faster.
                Some(Outcome::Done)
            } else if axis.drive.error.is_none() && axis.values.communication && rests {
                axis.leave_errorstop();
                Some(Outcome::Done)
            } else if *waited > ANSWER_S && rests {
                let silent = !axis.values.communication;
                Some(Outcome::Failed(if silent {
                    SmcError::RDriveDoesntAnswerInTime
                } else {
                    SmcError::RDriveDoesntAnswer
                }))
            } else {
                *waited += axis.cycle();
                None
            };
            if let Some(outcome) = outcome {
                self.waited = None;
                axis.values.error_acknowledged = false;
                self.latch.end(outcome);
            }
        }
        self.latch.outputs(self.waited.is_some())
    }
}

impl Axis {
    fn leave_errorstop(&mut self) {
        self.values.error = false;
        self.values.error_id = 0;
        self.rest();
        if !self.is_powered() {
            self.enter(AxisState::PowerOff);
        }
    }
}
