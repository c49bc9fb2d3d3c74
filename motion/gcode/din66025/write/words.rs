//! Words of a block under construction, with their decimals.

use super::WriteError;
use crate::din66025::word::Letter;
use crate::number::{self, ALL_DECIMALS, text};
use std::fmt::Write as _;
use twin_path::Place;

/// Decimals that numbers are written with when they will do.
pub(super) const DECIMALS: usize = 9;
/// The words of a block behind its N word.
#[derive(Clone, Debug)]
pub(super) struct Words {
    pub(super) text: String,
    place: Place,
    decimals: usize,
}

impl Words {
    pub(super) fn new(place: Place, decimals: usize) -> Self {
        Self { text: String::new(), place, decimals }
    }

    /// Appends a word and gives what the decoder will read.
    ///
    /// # Errors
    /// [`WriteError::Value`] if the decoder does not take such a number.
    pub(super) fn word(&mut self, letter: Letter, value: f64) -> Result<f64, WriteError> {
        self.exact_to(letter, value, self.decimals)
    }

    /// The same with a number as it is, whatever decimals it takes.
    pub(super) fn exact(&mut self, letter: Letter, value: f64) -> Result<f64, WriteError> {
        self.exact_to(letter, value, ALL_DECIMALS)
    }

    fn exact_to(&mut self, letter: Letter, value: f64, decimals: usize) -> Result<f64, WriteError> {
        let refused = WriteError::Value { place: self.place, letter: letter.as_char(), value };
        if !value.is_finite() {
            return Err(refused);
        }
        let text = text(value, decimals);
        let read = number::parse(text.as_bytes()).filter(|read| letter.check(*read).is_none());
        let Some(read) = read else { return Err(refused) };
        self.separate();
        self.text.push(letter.as_char());
        self.text.push_str(&text);
        Ok(read)
    }

    /// Appends a word with a whole number.
    pub(super) fn whole(&mut self, letter: Letter, value: i64) {
        self.separate();
        // A String takes everything.
        let _infallible = write!(self.text, "{}{value}", letter.as_char());
    }

    fn separate(&mut self) {
        if !self.text.is_empty() {
            self.text.push(' ');
        }
    }
}
