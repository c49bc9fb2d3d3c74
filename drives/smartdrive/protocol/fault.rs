//! Faults that a drive reports: refusals and alarms.

use crate::{Alarms, RejectCode};
use twin_drives::{DeviceFault, DriveError, Exchange};

/// A fault that a drive reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// It refused the command.
    #[error("refused, {}", meaning(*.0))]
    Rejected(RejectCode),
    /// It is in alarm and has switched its power off.
    #[error("the drive is in alarm, {0}")]
    Alarm(Alarms),
}

impl DeviceFault for Fault {}

impl Fault {
    /// Why a drive has refused, if it has.
    pub(crate) fn rejection(error: &DriveError) -> Option<RejectCode> {
        match error.fault()? {
            Self::Rejected(reason) => Some(*reason),
            Self::Alarm(_) => None,
        }
    }

    /// As an error.
    pub(crate) fn at(self, at: Exchange) -> DriveError {
        DriveError::device(at, self)
    }
}

/// The manual's words for a reason to refuse, with its number and name ("REJ").
fn meaning(reason: RejectCode) -> &'static str {
    match reason {
        RejectCode::Generic => "for no stated reason (0, GENERIC)",
        RejectCode::Working => "a long command is running (1, WORKING)",
        RejectCode::BadMode => "not in this mode (2, BADMODE)",
        RejectCode::BadParams => "a parameter is wrong (3, BADPARAMS)",
        RejectCode::NotAvailable => "there is no such command or index (4, NOTAVAILABLE)",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table "REJ" of the manual of ATB.
    #[test]
    fn reasons_have_number_and_name_of_the_manual() {
        let named = ["GENERIC", "WORKING", "BADMODE", "BADPARAMS", "NOTAVAILABLE"];
        for ((number, name), reason) in (0..).zip(named).zip(RejectCode::ALL) {
            let said = meaning(reason);
            assert!(said.ends_with(&format!("({number}, {name})")), "{said}");
        }
    }
}
