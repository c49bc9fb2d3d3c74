//! Reader of LinuxCNC's parameter file (`.var`): the parameters that outlive a program.
//!
//! ```text
//! 5161    0.000000        number and value, in ascending order of the numbers
//! 5221    12.500000
//! ```

use super::parameters::LAST;
use crate::lines;
use std::io::{self, Read};

/// Parameters of the interpreter with their values, in ascending order of their numbers.
///
/// Lengths (#5161 to #5389) are in the units of the machine, that is of
/// [`DecoderOptions::units`](super::DecoderOptions::units); angles are in degrees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterFile {
    values: Vec<(u16, f64)>,
}

/// Error of a parameter file.
#[derive(Debug, thiserror::Error)]
pub enum ParameterFileError {
    /// It cannot be read.
    #[error("the parameter file cannot be read")]
    Io(#[source] io::Error),
    /// A line that is not a number and a value.
    #[error("line {0}: write the number of a parameter and its value, such as `5221 12.5`")]
    Line(u32),
    /// A number that no parameter has, in a line counted from 1.
    #[error("line {0}: parameter {1} does not exist: the numbers are 1 to {LAST}")]
    Number(u32, i64),
    /// A number that is not larger than the one before.
    #[error(
        "line {line}: parameter {number} follows {before}; the numbers must ascend: move the line up or delete it"
    )]
    Order {
        /// Line of the file, counted from 1.
        line: u32,
        /// The number.
        number: u16,
        /// That of the entry before.
        before: u16,
    },
    /// The file is too long.
    #[error(
        "the parameter file has more than {0} bytes, the most that are read; check that it is the right one"
    )]
    TooLong(u64),
}

/// The longest file that is read, bytes: every parameter with room for comments.
const MAX_BYTES: u64 = 1 << 20;

impl ParameterFile {
    /// Reads LinuxCNC's format. Blank lines are left out.
    ///
    /// # Errors
    /// See [`ParameterFileError`].
    pub fn read(reader: impl Read) -> Result<Self, ParameterFileError> {
        let text = lines::read_file(reader, MAX_BYTES).map_err(ParameterFileError::Io)?;
        if text.len() as u64 > MAX_BYTES {
            return Err(ParameterFileError::TooLong(MAX_BYTES));
        }
        let mut values: Vec<(u16, f64)> = Vec::new();
        for (line, text) in (1..).zip(lines::lines(&text)) {
            let Some((number, value)) = entry(text, line)? else { continue };
            match values.last() {
                Some((before, _)) if *before >= number => {
                    return Err(ParameterFileError::Order { line, number, before: *before });
                }
                _ => values.push((number, value)),
            }
        }
        Ok(Self { values })
    }

    /// Value of a parameter; none if the file does not have it.
    pub fn get(&self, number: u16) -> Option<f64> {
        let index = self.values.binary_search_by_key(&number, |(number, _)| *number).ok()?;
        self.values.get(index).map(|(_, value)| *value)
    }

    /// Number and value of all of them, in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = (u16, f64)> + '_ {
        self.values.iter().copied()
    }
}

/// Number and value of one line; none if it is blank.
fn entry(text: &[u8], line: u32) -> Result<Option<(u16, f64)>, ParameterFileError> {
    let text = std::str::from_utf8(text).ok().ok_or(ParameterFileError::Line(line))?;
    let mut words = text.split_whitespace();
    let Some(number) = words.next() else { return Ok(None) };
    let value = words.next().and_then(|value| value.parse::<f64>().ok());
    let (Ok(number), Some(value), None) = (number.parse::<i64>(), value, words.next()) else {
        return Err(ParameterFileError::Line(line));
    };
    if !value.is_finite() {
        return Err(ParameterFileError::Line(line));
    }
    match u16::try_from(number) {
        Ok(small) if (1..=LAST).contains(&small) => Ok(Some((small, value))),
        _ => Err(ParameterFileError::Number(line, number)),
    }
}
