//! Parameters 1000–1301 of an axis (`AXIS_REF`, manual 2.4), by number.
//!
//! Blocks read and write them by name; a program has [`Axis::read_parameter`] and its companions, which take the numbers
//! of the manual and those of PLCopen.

mod table;
#[cfg(test)]
mod tests;
mod value;

pub(crate) use table::AxisRef;
pub use table::PARAMETERS;
pub use value::{Access, Parameter, Value};

use super::Axis;
use crate::SmcError;

impl Parameter {
    /// The parameter of a number: the manual's from 1000, or PLCopen's.
    #[must_use]
    pub(crate) fn by_number(number: u16) -> Option<&'static Self> {
        let is_it = |parameter: &&Self| {
            parameter.number == number || (number != 0 && parameter.plcopen == number)
        };
        PARAMETERS.iter().find(is_it)
    }
}

impl Axis {
    /// A parameter by its number (`MC_ReadParameter`, manual 5.3). Integers come as numbers.
    ///
    /// # Errors
    ///
    /// [`SmcError::RpParamUnknown`] (130) for a number that is unknown or a `BOOL`.
    #[doc(alias = "MC_ReadParameter")]
    pub fn read_parameter(&self, number: u16) -> Result<f64, SmcError> {
        match self.value(number) {
            Some(Value::Real(value)) => Ok(value),
            #[expect(clippy::cast_precision_loss, reason = "of at most 32 bits")]
            Some(Value::Integer(value)) => Ok(value as f64),
            Some(Value::Bool(_)) | None => Err(SmcError::RpParamUnknown),
        }
    }

    /// A `BOOL` parameter by its number (`MC_ReadBoolParameter`, manual 5.3).
    ///
    /// # Errors
    ///
    /// [`SmcError::RpParamUnknown`] (130) for a number that is unknown or not of a `BOOL`.
    #[doc(alias = "MC_ReadBoolParameter")]
    pub fn read_bool_parameter(&self, number: u16) -> Result<bool, SmcError> {
        match self.value(number) {
            Some(Value::Bool(value)) => Ok(value),
            _ => Err(SmcError::RpParamUnknown),
        }
    }

    /// Sets a parameter by its number (`MC_WriteParameter`, manual 5.3).
    ///
    /// # Errors
    ///
    /// [`SmcError::WpParamInvalid`] (140) for a number that is unknown, write-protected or a `BOOL`, for a value that is
    /// not finite, for a fraction of an integer, for a largest velocity, rate or jerk that is not positive, and for a ratio
    /// of 0.
    #[doc(alias = "MC_WriteParameter")]
    pub fn write_parameter(&mut self, number: u16, value: f64) -> Result<(), SmcError> {
        self.write(number, Value::Real(value))
    }

    /// Sets a `BOOL` parameter by its number (`MC_WriteBoolParameter`, manual 5.3).
    ///
    /// # Errors
    ///
    /// [`SmcError::WpParamInvalid`] (140) for a number that is unknown, write-protected or not of a `BOOL`.
    #[doc(alias = "MC_WriteBoolParameter")]
    pub fn write_bool_parameter(&mut self, number: u16, value: bool) -> Result<(), SmcError> {
        self.write(number, Value::Bool(value))
    }

    fn value(&self, number: u16) -> Option<Value> {
        self.values.read(Parameter::by_number(number)?.number)
    }

    fn write(&mut self, number: u16, value: Value) -> Result<(), SmcError> {
        let parameter = Parameter::by_number(number);
        let parameter = parameter.filter(|parameter| parameter.access == Access::Write);
        let parameter = parameter.filter(|parameter| match (parameter.number, value) {
            (1112 | 1113 | 1122 | 1123 | 1132 | 1133 | 1142 | 1143, Value::Real(most)) => {
                most > 0.0
            }
            (1051 | 1052, Value::Real(part)) => part != 0.0,
            _ => true,
        });
        let written = parameter.is_some_and(|it| self.values.write(it.number, value));
        if written { Ok(()) } else { Err(SmcError::WpParamInvalid) }
    }
}
