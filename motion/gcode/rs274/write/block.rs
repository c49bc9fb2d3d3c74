//! Block under construction.

use super::WriteError;
use crate::number::{ALL_DECIMALS, read_back, text};
use crate::rs274::Control;
use std::fmt::Write as _;
use twin_path::Place;

/// X, Y, Z in mm, A, B, C in degrees, U, V, W in mm.
pub(super) type Axes = [f64; 9];

/// The letters of [`Axes`].
pub(super) const LETTERS: [char; 9] = ['X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'];

/// Numbers beyond this are not written, in their own units.
const MAX_NUMBER: f64 = 1e9;

/// The words of a block.
#[derive(Debug)]
pub(super) struct Block {
    pub(super) text: String,
    place: Place,
    /// Numbers without a decimal point are micrometres, not mm.
    needs_point: bool,
}

impl Block {
    pub(super) fn new(place: Place, control: Control) -> Self {
        Self { text: String::new(), place, needs_point: control == Control::Fanuc }
    }

    /// True if it moves nothing: it consists of G words.
    pub(super) fn is_without_numbers(&self) -> bool {
        self.text.split_ascii_whitespace().all(|word| word.starts_with('G'))
    }

    /// Appends a word.
    pub(super) fn push(&mut self, word: &str) {
        if !self.text.is_empty() {
            self.text.push(' ');
        }
        self.text.push_str(word);
    }

    /// Appends a length, an angle or a feed with up to `decimals` decimals, and gives what a decoder reads.
    ///
    /// # Errors
    /// [`WriteError::Value`].
    pub(super) fn number(
        &mut self,
        letter: char,
        value: f64,
        decimals: usize,
    ) -> Result<f64, WriteError> {
        self.plain(letter, value, decimals)?;
        if self.needs_point && text(value, decimals).bytes().all(|byte| byte != b'.') {
            self.text.push('.');
        }
        Ok(read_back(value, decimals))
    }

    /// Appends a number that is not a length, as it is: a speed, or a parameter of an M function.
    ///
    /// # Errors
    /// As [`Self::number`].
    pub(super) fn exact(&mut self, letter: char, value: f64) -> Result<(), WriteError> {
        self.plain(letter, value, ALL_DECIMALS)
    }

    fn plain(&mut self, letter: char, value: f64, decimals: usize) -> Result<(), WriteError> {
        if value.is_nan() || value.abs() > MAX_NUMBER {
            return Err(WriteError::Value { place: self.place, letter, value });
        }
        self.push("");
        // A String takes everything.
        let _infallible = write!(self.text, "{letter}{}", text(value, decimals));
        Ok(())
    }
}
