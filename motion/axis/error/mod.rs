//! Errors of `SoftMotion`: numbers, names and texts (`SM_Error.lib`, manual 9).
//!
//! Blocks show an [`SmcError`] among their outputs; an axis keeps the latest ones of its blocks
//! ([`Axis::read_fb_error`](super::Axis::read_fb_error)). Errors of the drive itself are numbers of its maker.
//!
//! ```
//! use twin_axis::{Language, SmcError};
//!
//! let error = SmcError::from_number(626).expect("a number of the manual");
//! assert_eq!(error.name(), "SMC_CI_MASTER_OUT_OF_SCALE");
//! assert_eq!(error.text(Language::English), "the master is outside the range of the cam");
//! ```

mod number;
#[cfg(test)]
mod tests;

pub use number::SmcError;

use std::fmt;

/// A language of the texts (`SMC_LANGUAGE_TYPE`, manual 9.2.1; French is ours).
#[doc(alias = "SMC_LANGUAGE_TYPE")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Language {
    /// `english`.
    #[default]
    English,
    /// `german`.
    German,
    /// Français.
    French,
}

/// One row per error: number, name, then raisers, text and remedy in English, German and French. The manual has no
/// remedies; they are ours.
const TABLE: &str = include_str!("errors.tsv");

/// The first of three columns of [`TABLE`], one per language.
#[derive(Clone, Copy, Debug)]
enum Columns {
    RaisedBy = 2,
    Text = 5,
    Remedy = 8,
}

impl SmcError {
    /// Text of the error, in a language (`SMC_ErrorString`, manual 9.2.1).
    #[doc(alias = "SMC_ErrorString")]
    #[must_use]
    pub fn text(self, language: Language) -> &'static str {
        self.cell(Columns::Text, language)
    }

    /// Remedy, in a language.
    #[must_use]
    pub fn remedy(self, language: Language) -> &'static str {
        self.cell(Columns::Remedy, language)
    }

    /// The blocks that raise it, in English.
    #[must_use]
    pub fn raised_by(self) -> &'static str {
        self.raised_by_in(Language::English)
    }

    /// The blocks that raise it: their names, or words for several blocks in this language.
    #[must_use]
    pub fn raised_by_in(self, language: Language) -> &'static str {
        self.cell(Columns::RaisedBy, language)
    }

    /// One cell of its row; empty where the table has none.
    fn cell(self, columns: Columns, language: Language) -> &'static str {
        let number = self.number().to_string();
        let mut rows = TABLE.lines().map(|row| row.split('\t'));
        let row = rows.find(|row| row.clone().next() == Some(&number));
        row.and_then(|mut row| row.nth(columns as usize + language as usize)).unwrap_or_default()
    }
}

impl fmt::Display for SmcError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}: {}", self.number(), self.name(), self.text(Language::English))
    }
}

impl std::error::Error for SmcError {}
