//! Parameter blocks: parameters of an axis and of its drive (manual 5.3).

use super::home::ANSWER_S;
use crate::drive::{Answer, Transfer};
use crate::latch::{Latch, Outcome, Outputs};
use crate::{Axis, SmcError};

/// A parameter: of the axis, or of the drive itself, whose numbers are its maker's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterNumber {
    /// Of `AXIS_REF` (1000–1301) or of PLCopen (1–16).
    Axis(u16),
    /// Of the drive; it is asked for over the bus, and takes some cycles.
    Drive(u32),
}

/// A transfer that is to be made, or is under way.
#[derive(Clone, Copy, Debug)]
struct Asked {
    transfer: Transfer,
    sent: bool,
    /// Time waited for the bus and for the drive, s.
    waited: f64,
}

impl Asked {
    fn new(number: u32, write: Option<f64>) -> Self {
        Self { transfer: Transfer { number, write }, sent: false, waited: 0.0 }
    }

    /// A cycle of it: its value or failure at the end. One block after the other has the bus.
    fn go_on(&mut self, axis: &mut Axis) -> Option<Result<f64, ()>> {
        let ours = self.has_the_bus(axis);
        let answer = axis.drive.answer.filter(|_| ours);
        let ended = match answer {
            Some(Answer::Value(value)) if value.is_finite() => Ok(value),
            Some(_) => Err(()),
            None if self.waited > ANSWER_S || !axis.values.communication => Err(()),
            None => {
                if ours || (!self.sent && axis.transfer.is_none()) {
                    self.sent = true;
                    axis.transfer = Some((self.transfer, true));
                }
                self.waited += axis.cycle();
                return None;
            }
        };
        self.release(axis);
        Some(ended)
    }

    fn has_the_bus(&self, axis: &Axis) -> bool {
        self.sent && axis.transfer.is_some_and(|(transfer, _)| transfer == self.transfer)
    }

    fn release(&self, axis: &mut Axis) {
        if self.has_the_bus(axis) {
            axis.transfer = None;
        }
    }
}

/// Reads a parameter as long as it is enabled (`MC_ReadParameter`, manual 5.3); a `BOOL` reads as 0 or 1.
///
/// 130 for an unknown number of the axis, 131 if the drive refuses, does not answer within a second, or the bus is down.
#[doc(alias = "MC_ReadParameter")]
#[doc(alias = "MC_ReadBoolParameter")]
#[derive(Clone, Debug)]
pub struct ReadParameter {
    /// `ParameterNumber`.
    pub number: ParameterNumber,
    asked: Option<Asked>,
    value: Option<f64>,
    failed: bool,
}

impl ReadParameter {
    /// A block for this parameter, not enabled.
    #[must_use]
    pub fn new(number: ParameterNumber) -> Self {
        Self { number, asked: None, value: None, failed: false }
    }

    /// Calls it, for a cycle, with Enable and its axis: `Value`, none before the first one is there.
    ///
    /// # Errors
    ///
    /// 130 and 131. It goes on trying while it is enabled.
    pub fn call(&mut self, enable: bool, axis: &mut Axis) -> Result<Option<f64>, SmcError> {
        if !enable {
            if let Some(asked) = self.asked.take() {
                asked.release(axis);
            }
            (self.value, self.failed) = (None, false);
            return Ok(None);
        }
        match self.number {
            ParameterNumber::Axis(number) => {
                let value = match axis.read_bool_parameter(number) {
                    Ok(value) => Ok(f64::from(u8::from(value))),
                    Err(_no_bool) => axis.read_parameter(number),
                };
                self.show(value.map(Some), axis)
            }
            ParameterNumber::Drive(number) => {
                let mut asked = self.asked.take().unwrap_or(Asked::new(number, None));
                let error = SmcError::RpRequestingError;
                if let Some(ended) = asked.go_on(axis) {
                    return self.show(ended.map(Some).map_err(|()| error), axis);
                }
                self.asked = Some(asked);
                if self.failed { Err(error) } else { Ok(self.value) }
            }
        }
    }

    /// Keeps the result, and reports a new error to the axis.
    fn show(
        &mut self,
        value: Result<Option<f64>, SmcError>,
        axis: &mut Axis,
    ) -> Result<Option<f64>, SmcError> {
        if let Err(error) = value
            && !self.failed
        {
            axis.report(error);
        }
        self.failed = value.is_err();
        self.value = value.unwrap_or_default();
        value
    }
}

/// Writes a parameter once (`MC_WriteParameter`, manual 5.3); of a `BOOL` 0 is FALSE.
///
/// 140 for a number of the axis that is unknown or write-protected and for a value that does not fit, 141 if the drive
/// refuses, does not answer within a second, or the bus is down.
#[doc(alias = "MC_WriteParameter")]
#[doc(alias = "MC_WriteBoolParameter")]
#[derive(Clone, Debug)]
pub struct WriteParameter {
    /// `ParameterNumber`; taken over at the rising edge.
    pub number: ParameterNumber,
    /// `Value`; taken over at the rising edge.
    pub value: f64,
    asked: Option<Asked>,
    latch: Latch,
}

impl WriteParameter {
    /// A block for this parameter and value, not begun.
    #[must_use]
    pub fn new(number: ParameterNumber, value: f64) -> Self {
        Self { number, value, asked: None, latch: Latch::default() }
    }

    /// Calls it, for a cycle, with Execute and its axis.
    pub fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs {
        if self.latch.rises(execute) {
            if let Some(asked) = self.asked.take() {
                asked.release(axis);
            }
            match self.number {
                ParameterNumber::Axis(number) => {
                    let flag = self.value != 0.0;
                    let written = axis
                        .write_bool_parameter(number, flag)
                        .or_else(|_no_bool| axis.write_parameter(number, self.value));
                    self.latch.end(written.map_or_else(Outcome::Failed, |()| Outcome::Done), axis);
                }
                ParameterNumber::Drive(number) if self.value.is_finite() => {
                    self.asked = Some(Asked::new(number, Some(self.value)));
                }
                ParameterNumber::Drive(_) => {
                    self.latch.end(Outcome::Failed(SmcError::WpParamInvalid), axis);
                }
            }
        }
        if let Some(ended) = self.asked.as_mut().and_then(|asked| asked.go_on(axis)) {
            self.asked = None;
            let failed = |()| Outcome::Failed(SmcError::WpSendingError);
            self.latch.end(ended.map_or_else(failed, |_| Outcome::Done), axis);
        }
        self.latch.outputs(self.asked.is_some())
    }
}
