//! What devices mean with their codes, and numbers with their units.

use crate::smartdrive::RejectCode;
use std::fmt::Display;

/// The manual's words for an exception code ("Traitement des erreurs").
pub(super) fn exception_meaning(code: u8) -> &'static str {
    match code {
        1 => "invalid function",
        2 => "invalid address",
        3 => "invalid count or value",
        4 => "undetermined error",
        _ => "unknown code",
    }
}

/// The manual's words for a reason to refuse, with its number and name ("REJ").
pub(super) fn reject_meaning(reason: RejectCode) -> &'static str {
    match reason {
        RejectCode::Generic => "for no stated reason (0, GENERIC)",
        RejectCode::Working => "a long command is running (1, WORKING)",
        RejectCode::BadMode => "not in this mode (2, BADMODE)",
        RejectCode::BadParams => "a parameter is wrong (3, BADPARAMS)",
        RejectCode::NotAvailable => "there is no such command or index (4, NOTAVAILABLE)",
    }
}

/// A value as people write it: "5 steps", or "5" for what has no unit.
pub(super) fn with_unit(value: impl Display, unit: &str) -> String {
    if unit.is_empty() { value.to_string() } else { format!("{value} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table "REJ" of the manual of ATB.
    #[test]
    fn reasons_have_number_and_name_of_the_manual() {
        let named = ["GENERIC", "WORKING", "BADMODE", "BADPARAMS", "NOTAVAILABLE"];
        for ((number, name), reason) in (0..).zip(named).zip(RejectCode::ALL) {
            let said = reject_meaning(reason);
            assert!(said.ends_with(&format!("({number}, {name})")), "{said}");
        }
    }
}
