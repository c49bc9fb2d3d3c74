//! Place in a program: line and block number.

use std::fmt;

/// A block of the program: its line in the file and the number of its N word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// Line of the file, counted from 1; 0 is the time before the first line.
    pub line: u32,
    /// The block's N word, if it has one.
    pub block: Option<u32>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.block {
            Some(block) => write!(f, "line {} (N{block})", self.line),
            None => write!(f, "line {}", self.line),
        }
    }
}
