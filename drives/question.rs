//! What manuals leave open, as a list.

/// A question that a manual leaves open, what is assumed, and the option that decides otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenQuestion {
    /// Line of the family's digest on which the assumption stands; 0 for those that came up later.
    pub line: u16,
    /// The question.
    pub question: &'static str,
    /// The option, as `Type.field`. Fields of `Assumptions` are the same on both sides.
    pub option: &'static str,
    /// Its default, the assumption, as `Debug` shows it.
    pub default: &'static str,
    /// Other answers.
    pub alternatives: &'static str,
    /// What the driver makes of it.
    pub driver: &'static str,
}

impl OpenQuestion {
    /// Of a digest's line: question and option with its default, alternatives, what the driver makes of it.
    pub(crate) const fn new(
        line: u16,
        question: &'static str,
        (option, default): (&'static str, &'static str),
        alternatives: &'static str,
        driver: &'static str,
    ) -> Self {
        Self { line, question, option, default, alternatives, driver }
    }
}
