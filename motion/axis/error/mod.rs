//! The errors of `SoftMotion`: numbers, names and texts (`SM_Error.lib`, manual 9).
//!
//! Blocks show an [`SmcError`] beside their other outputs; an axis keeps the latest ones of its blocks
//! ([`Axis::read_fb_error`](super::Axis::read_fb_error)). Errors of the drive itself are numbers of its maker.
//!
//! ```
//! use twin_motion::axis::{Language, SmcError};
//!
//! let error = SmcError::from_number(626).expect("a number of the manual");
//! assert_eq!(error.name(), "SMC_CI_MASTER_OUT_OF_SCALE");
//! assert_eq!(error.text(Language::English), "the master is outside the range of the cam");
//! ```

mod english;
mod french;
mod german;
#[cfg(test)]
mod manual;
mod number;
mod remedy;
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

impl SmcError {
    /// Which blocks raise it: names of blocks as they are, the words for several of them in this language.
    #[must_use]
    pub fn raised_by_in(self, language: Language) -> &'static str {
        let english = self.raised_by();
        let [german, french] = match english {
            "every block" => ["jedem Baustein", "tous les blocs"],
            "motion blocks" => ["Bewegungsbausteinen", "les blocs de mouvement"],
            "drive interface" => ["der Antriebsschnittstelle", "l'interface d'entraînement"],
            "blocks that take a cam" => {
                ["Bausteinen, die eine Kurvenscheibe bekommen", "les blocs qui reçoivent une came"]
            }
            "blocks that take a CNC program" => [
                "Bausteinen, die ein CNC-Programm bekommen",
                "les blocs qui reçoivent un programme CNC",
            ],
            "blocks that take a queue" => {
                ["Bausteinen, die eine Warteschlange bekommen", "les blocs qui reçoivent une queue"]
            }
            name => [name; 2],
        };
        match language {
            Language::English => english,
            Language::German => german,
            Language::French => french,
        }
    }
}

impl fmt::Display for SmcError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}: {}", self.number(), self.name(), self.text(Language::English))
    }
}

impl std::error::Error for SmcError {}
