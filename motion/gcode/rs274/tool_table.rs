//! Reader of LinuxCNC's tool table (`.tbl`): one tool per line.
//!
//! ```text
//! ; T number, P pocket, X…W offsets, D diameter, I J angles, Q orientation
//! T1 P1 Z51.125 D6.35 ;quarter inch end mill
//! ```

use super::block::Letter;
use super::{LengthUnit, Position};
use crate::{lines, number};
use std::io::{self, Read};

/// A tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tool {
    /// Its number (T).
    pub number: u32,
    /// From the controlled point to the tip, the other way round: what G43 adds to X, Y and Z, m. The length of a
    /// milling tool is Z.
    pub offset: [f64; 3],
    /// The same for A, B and C, degrees.
    pub rotary_offset: [f64; 3],
    /// The same for U, V and W, m.
    pub parallel_offset: [f64; 3],
    /// Diameter (D), m. If it is negative, G41 and G42 change sides.
    pub diameter: f64,
    /// Front angle of a lathe tool (I), degrees.
    pub front_angle: f64,
    /// Back angle of a lathe tool (J), degrees.
    pub back_angle: f64,
    /// Orientation of a lathe tool (Q), 1 to 9; 0 of a mill.
    pub orientation: u8,
}

impl Tool {
    /// Offsets of all axes, m and degrees.
    pub(super) fn position(&self) -> Position {
        Position { linear: self.offset, rotary: self.rotary_offset, parallel: self.parallel_offset }
    }

    /// Sets [`Self::position`].
    pub(super) fn set_position(&mut self, position: &Position) {
        (self.offset, self.rotary_offset) = (position.linear, position.rotary);
        self.parallel_offset = position.parallel;
    }
}

/// Tools by number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolTable {
    /// Ordered by number, each once.
    tools: Vec<Tool>,
}

/// Error of a tool table.
#[derive(Debug, thiserror::Error)]
pub enum ToolTableError {
    /// It cannot be read.
    #[error("the tool table cannot be read")]
    Io(#[source] io::Error),
    /// An entry is not a letter with a number: its line, counted from 1, and its letter.
    #[error("line {0}: {1:?} is not followed by a number")]
    Number(u32, char),
    /// A letter the format does not have, in a line counted from 1.
    #[error("line {0}: tool tables have no {1:?}")]
    Letter(u32, char),
    /// A tool without number, or with one that is negative or no whole number.
    #[error("line {0}: a tool needs a whole number T")]
    ToolNumber(u32),
    /// A tool for the second time: the line, counted from 1, and the number of the tool.
    #[error("line {0}: tool {1} is there already")]
    Duplicate(u32, u32),
    /// A number beyond what any machine has, or an orientation other than 0 to 9.
    #[error("line {line}: {letter}{value} is out of range")]
    OutOfRange {
        /// Line of the file, counted from 1.
        line: u32,
        /// The entry's letter.
        letter: char,
        /// Its number.
        value: f64,
    },
    /// A line without end, or too many of them.
    #[error(
        "line {line}: the tool table has more than {limit} bytes, the most that are read; check that it is the right one, or shorten it"
    )]
    TooLong {
        /// Line of the file, counted from 1.
        line: u32,
        /// The longest table that is read.
        limit: u64,
    },
}

/// The longest table that is read, bytes: some ten thousand tools.
const MAX_BYTES: u64 = 1 << 20;

/// The largest offset or diameter, m, angle, degrees, and orientation.
const MAX_LENGTH: f64 = 1e3;
const MAX_ANGLE: f64 = 1e9;
const MAX_ORIENTATION: f64 = 9.0;

impl ToolTable {
    /// The table of `tools`; of several with the same number the last.
    pub fn new(tools: impl IntoIterator<Item = Tool>) -> Self {
        let mut table = Self::default();
        for tool in tools {
            table.insert(tool);
        }
        table
    }

    /// Adds `tool`, or replaces the one with its number.
    pub fn insert(&mut self, tool: Tool) {
        match self.tools.binary_search_by_key(&tool.number, |tool| tool.number) {
            Ok(index) => self.tools[index] = tool,
            Err(index) => self.tools.insert(index, tool),
        }
    }

    /// Reads LinuxCNC's format with lengths in `unit`, that of the machine. The pocket is read but not kept.
    ///
    /// # Errors
    /// See [`ToolTableError`].
    pub fn read(reader: impl Read, unit: LengthUnit) -> Result<Self, ToolTableError> {
        let text = lines::read_file(reader, MAX_BYTES).map_err(ToolTableError::Io)?;
        let mut tools: Vec<(u32, Tool)> = Vec::new();
        if text.len() as u64 > MAX_BYTES {
            let last = (1..).zip(lines::lines(&text)).last();
            return Err(ToolTableError::TooLong {
                line: last.map_or(1, |(line, _)| line),
                limit: MAX_BYTES,
            });
        }
        for (line, text) in (1..).zip(lines::lines(&text)) {
            tools.extend(entry(text, line, unit)?.map(|tool| (line, tool)));
        }
        tools.sort_by_key(|(_, tool)| tool.number);
        for pair in tools.windows(2) {
            if let [(_, first), (line, second)] = pair
                && first.number == second.number
            {
                return Err(ToolTableError::Duplicate(*line, second.number));
            }
        }
        Ok(Self { tools: tools.into_iter().map(|(_, tool)| tool).collect() })
    }

    /// The tool of this number.
    pub fn get(&self, number: u32) -> Option<&Tool> {
        let index = self.tools.binary_search_by_key(&number, |tool| tool.number).ok()?;
        self.tools.get(index)
    }

    /// All of them, ordered by number.
    pub fn as_slice(&self) -> &[Tool] {
        &self.tools
    }
}

/// The tool of one line; none if it is blank or a comment.
fn entry(text: &[u8], line: u32, unit: LengthUnit) -> Result<Option<Tool>, ToolTableError> {
    let text = text.split(|byte| *byte == b';').next().unwrap_or_default();
    let mut tool = Tool::default();
    let (mut number, mut empty, mut axes) = (None, true, [0.0; 9]);
    for word in text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
        let [letter, digits @ ..] = word else { continue };
        empty = false;
        let letter = char::from(letter.to_ascii_uppercase());
        if !matches!(letter, 'A'..='D' | 'I' | 'J' | 'P' | 'Q' | 'T' | 'U'..='Z') {
            return Err(ToolTableError::Letter(line, letter));
        }
        let value = number::parse(digits).ok_or(ToolTableError::Number(line, letter))?;
        let length = unit.to_metres(value);
        let limited = match letter {
            'A' | 'B' | 'C' | 'I' | 'J' => value / MAX_ANGLE,
            'U'..='Z' | 'D' => length / MAX_LENGTH,
            'Q' => value / MAX_ORIENTATION,
            _ => 0.0,
        };
        if limited.is_nan() || limited.abs() > 1.0 {
            return Err(ToolTableError::OutOfRange { line, letter, value });
        }
        if let Some(axis) = Letter::AXES.iter().position(|axis| axis.as_char() == letter) {
            axes[axis] = if matches!(letter, 'A'..='C') { value } else { length };
        }
        match letter {
            'T' => number = whole(value),
            'D' => tool.diameter = length,
            'I' => tool.front_angle = value,
            'J' => tool.back_angle = value,
            'Q' => {
                let orientation = whole(value).and_then(|number| u8::try_from(number).ok());
                let error = ToolTableError::OutOfRange { line, letter, value };
                tool.orientation = orientation.ok_or(error)?;
            }
            _ => {}
        }
    }
    if empty {
        return Ok(None);
    }
    tool.number = number.ok_or(ToolTableError::ToolNumber(line))?;
    tool.set_position(&Position::from_axes(axes));
    Ok(Some(tool))
}

/// `value` as a tool's number.
fn whole(value: f64) -> Option<u32> {
    if value.fract() != 0.0 || !(0.0..=f64::from(u32::MAX)).contains(&value) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
    Some(value as u32)
}
