//! Modbus exceptions: requests that the board refuses.

use twin_drives::{DeviceFault, DriveError};

/// A request that the board refuses with an exception code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("refused with exception {code}, {}", self.meaning(), code = .0)]
pub struct Exception(pub u8);

impl DeviceFault for Exception {}

impl Exception {
    /// The code of an error, if the board has refused with one.
    pub(crate) fn code_of(error: &DriveError) -> Option<u8> {
        error.fault::<Self>().map(|exception| exception.0)
    }

    /// The manual's words for the code ("Traitement des erreurs").
    fn meaning(self) -> &'static str {
        match self.0 {
            1 => "invalid function",
            2 => "invalid address",
            3 => "invalid count or value",
            4 => "undetermined error",
            _ => "unknown code",
        }
    }
}
