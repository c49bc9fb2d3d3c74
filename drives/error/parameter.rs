//! Errors of parameters: unknown, read-only, impossible value.

use super::{DriveError, Exchange};
use crate::{ParameterId, ParameterInfo};

impl ParameterInfo {
    /// Checks that the parameter can be set to a value; `at` says where the error is.
    ///
    /// # Errors
    /// If the parameter is read-only or takes other values only.
    pub fn check(&self, value: i64, at: impl FnOnce() -> Exchange) -> Result<(), DriveError> {
        let id = self.id;
        if !self.writable {
            Err(DriveError::ReadOnly { at: at(), id })
        } else if self.values.contain(value) {
            Ok(())
        } else {
            let values = self.values.clone();
            Err(DriveError::ParameterValue { at: at(), id, value, values })
        }
    }
}

/// The parameter of this number among those a device has.
///
/// # Errors
/// [`DriveError::NoParameter`].
pub fn find_parameter(
    all: Vec<ParameterInfo>,
    id: ParameterId,
    at: impl FnOnce() -> Exchange,
) -> Result<ParameterInfo, DriveError> {
    all.into_iter()
        .find(|info| info.id == id)
        .ok_or_else(|| DriveError::NoParameter { at: at(), id })
}
