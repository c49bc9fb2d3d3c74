//! What to do about an error; the manual has no such column, this is ours.

mod english;
mod french;
mod german;

use super::{Language, SmcError};

impl SmcError {
    /// What to do about it, in a language.
    #[must_use]
    pub const fn remedy(self, language: Language) -> &'static str {
        match language {
            Language::English => english::remedy(self),
            Language::German => german::remedy(self),
            Language::French => french::remedy(self),
        }
    }
}
