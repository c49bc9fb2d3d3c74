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

/// The manual's words for a reason to refuse ("REJ").
pub(super) fn reject_meaning(reason: RejectCode) -> &'static str {
    match reason {
        RejectCode::Generic => "for no stated reason",
        RejectCode::Working => "a long command is running",
        RejectCode::BadMode => "not in this mode",
        RejectCode::BadParams => "a parameter is wrong",
        RejectCode::NotAvailable => "there is no such command or index",
    }
}

/// A value as people write it: "5 steps", or "5" for what has no unit.
pub(super) fn with_unit(value: impl Display, unit: &str) -> String {
    if unit.is_empty() { value.to_string() } else { format!("{value} {unit}") }
}
