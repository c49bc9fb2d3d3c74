//! Edits of a line, and the format of the written feeds.

use std::io::{self, Write};
use std::ops::Range;

/// Room that an F word may need, bytes.
const WORD: usize = 32;

/// Significant digits of a feed that is lowered. What rounding down costs is less than a thousandth.
const DIGITS: i32 = 4;

/// Edit of a line: these bytes become that text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Edit {
    bytes: Range<usize>,
    text: String,
}

impl Edit {
    /// Another number for the word at `word`.
    pub(crate) fn replace(line: &[u8], word: &Range<usize>, number: &str) -> Self {
        let number_at = word.start + 1;
        let blanks = line.get(number_at..word.end).unwrap_or_default();
        let blanks = blanks.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        Self { bytes: number_at + blanks..word.end, text: number.to_owned() }
    }

    /// An F word behind the one at `last`, written as that is: with or without a blank before it, in its case.
    pub(crate) fn insert(line: &[u8], last: &Range<usize>, number: &str) -> Self {
        let before = last.start.checked_sub(1).and_then(|at| line.get(at));
        let dense =
            before.is_some_and(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'$'));
        let blank = if dense { "" } else { " " };
        let lower = line.get(last.start).is_some_and(u8::is_ascii_lowercase);
        let letter = if lower { 'f' } else { 'F' };
        Self { bytes: last.end..last.end, text: format!("{blank}{letter}{number}") }
    }

    pub(crate) fn write(&self, line: &[u8], out: &mut impl Write) -> io::Result<()> {
        out.write_all(line.get(..self.bytes.start).unwrap_or_default())?;
        out.write_all(self.text.as_bytes())?;
        out.write_all(line.get(self.bytes.end..).unwrap_or_default())
    }
}

/// True if a line of at most `most` bytes has room for an F word.
pub(crate) fn has_room(line: &[u8], most: usize) -> bool {
    line.len() + WORD <= most
}

/// True if a line may be left out by the machine.
pub(crate) fn is_suppressed(line: &[u8]) -> bool {
    line.trim_ascii_start().first() == Some(&b'/')
}

/// A feed rounded down, as a number and as text. None if nothing is left of it.
pub(crate) fn rounded_down(value: f64) -> Option<(f64, String)> {
    if !(1e-9..=1e12).contains(&value) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, reason = "−9 to 12")]
    let exponent = value.log10().floor() as i32 - (DIGITS - 1);
    let scaled =
        if exponent < 0 { value * 10_f64.powi(-exponent) } else { value / 10_f64.powi(exponent) };
    // A limit that is a number of few digits itself stays one.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "about 10⁴")]
    let digits = (scaled * (1.0 + 1e-12)).floor() as u64;
    let mut text = digits.to_string();
    if exponent >= 0 {
        text.extend((0..exponent).map(|_| '0'));
    } else {
        let decimals = usize::try_from(-exponent).unwrap_or(0);
        text = format!("{text:0>width$}", width = decimals + 1);
        text.insert(text.len() - decimals, '.');
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    }
    Some((text.parse().ok()?, text))
}
