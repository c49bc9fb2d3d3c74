//! Controller mode and torque (`SMC_SetControllerMode`, `SMC_SetTorque`; manual 2.2.4, 5.5).

use super::home::ANSWER_S;
use crate::latch::{Latch, Outcome, Outputs};
use crate::{Axis, ControllerMode, SmcError};

/// Into another controller mode (`SMC_SetControllerMode`, manual 2.2.4).
#[doc(alias = "SMC_SetControllerMode")]
#[derive(Clone, Copy, Debug, Default)]
pub struct SetControllerMode {
    /// `nControllerMode`; taken over at the rising edge.
    pub mode: ControllerMode,
    /// What is asked for, what was before, and the time waited, s.
    asked: Option<(ControllerMode, i64, f64)>,
    latch: Latch,
}

impl SetControllerMode {
    /// A block for this mode, not begun.
    #[must_use]
    pub fn new(mode: ControllerMode) -> Self {
        Self { mode, ..Self::default() }
    }

    /// Calls it, for a cycle, with Execute and its axis: done when the drive has the mode, 70 if it does not take it.
    pub fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs {
        if self.latch.rises(execute) {
            self.asked = Some((self.mode, axis.values.controller_mode, 0.0));
            axis.values.controller_mode = self.mode.number();
        }
        if let Some((mode, before, waited)) = &mut self.asked {
            let outcome = if axis.values.real_controller_mode == mode.number() {
                Some(Outcome::Done)
            } else if *waited > ANSWER_S {
                axis.values.controller_mode = *before;
                Some(Outcome::Failed(SmcError::ScmNotSupported))
            } else {
                *waited += axis.cycle();
                None
            };
            if let Some(outcome) = outcome {
                self.asked = None;
                self.latch.end(outcome, axis);
            }
        }
        self.latch.outputs(self.asked.is_some())
    }
}

impl Axis {
    /// Set torque, Nm, or force, N, for a drive in torque mode (`SMC_SetTorque`, manual 5.5).
    ///
    /// # Errors
    ///
    /// [`SmcError::StWrongControllerMode`] (75) in another mode; the set torque stays. More than `fMaxTorque` is not set,
    /// where that is above 0.
    #[doc(alias = "SMC_SetTorque")]
    pub fn set_torque(&mut self, torque: f64) -> Result<(), SmcError> {
        if self.values.real_controller_mode != ControllerMode::Torque.number()
            || !torque.is_finite()
        {
            self.report(SmcError::StWrongControllerMode);
            return Err(SmcError::StWrongControllerMode);
        }
        let most = self.values.max_torque;
        self.values.set_torque = if most > 0.0 { torque.clamp(-most, most) } else { torque };
        Ok(())
    }
}
