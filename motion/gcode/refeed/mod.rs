//! Feed reduction: lowers F words to feeds that the machine can reach, and changes nothing else.
//!
//! F is modal. A line whose limit is below the programmed feed gets a lower F, in place of its own or added to it; the
//! next line of the path with a higher limit gets the programmed feed back. All other bytes stay: comments, blanks,
//! line ends, numbers, in any encoding. Feeds are rounded down to four significant digits, so that they do not exceed
//! their limit. A program that needs no change is returned unchanged.
//!
//! Each dialect has its own function, on top of its decoder: [`crate::din66025::refeed`], [`crate::rs274::refeed`].

mod edit;
mod limits;
#[cfg(test)]
pub(crate) mod tests;

pub(crate) use edit::{Edit, has_room, is_suppressed, rounded_down};
pub(crate) use limits::{Limit, Limits, is_below};

use std::fmt;
use std::io::{self, BufRead, Read, Write};
use twin_path::Place;

/// Number of lines without a feasible feed that are kept.
const KEPT: usize = 1000;

/// The largest feed that a machine allows on a line of a program, or on a piece of it: of several for one line the
/// smallest counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLimit {
    /// Line of the file, from 1.
    pub line: u32,
    /// It is that of a rapid (G0). In RS274 no F word governs rapids.
    pub rapid: bool,
    /// m/s, or where only further axes move a thousandth of their velocity in u/s, as in
    /// [`twin_path::PathElement::feed`]. NaN counts as 0.
    pub feed: f64,
}

/// Reason why no F makes a line feasible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reason {
    /// A rapid of RS274: its velocity is the machine's.
    Rapid,
    /// A thread of RS274: F does not govern it, or another F would spoil it.
    Thread,
    /// No feed is low enough: the limit is (next to) zero.
    NoFeed,
    /// The line has no room for another word.
    LongLine,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rapid => "F does not govern rapids",
            Self::Thread => {
                "the feed of a thread follows from its pitch and the spindle speed; lower S"
            }
            Self::NoFeed => "no feed is low enough",
            Self::LongLine => "the line has no room for another word",
        })
    }
}

/// A line that stays too fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unrepaired {
    /// The block.
    pub place: Place,
    /// The reason.
    pub reason: Reason,
    /// Its velocity, m/s.
    pub programmed: f64,
    /// Limit of the machine, m/s.
    pub limit: f64,
}

/// Result of a feed reduction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Refed {
    /// Lines of the program.
    pub lines: u64,
    /// Lines with another F than before, or with one where there was none.
    pub changed: u64,
    /// Lines of the path whose feed is lower than programmed. Most share the F of the line before.
    pub lowered: u64,
    /// Lines that stay too fast, the first thousand of them.
    pub unrepaired: Vec<Unrepaired>,
    /// And how many more.
    pub unrepaired_left_out: u64,
}

impl Refed {
    pub(crate) fn report(&mut self, unrepaired: Unrepaired) {
        if self.unrepaired.len() < KEPT {
            self.unrepaired.push(unrepaired);
        } else {
            self.unrepaired_left_out += 1;
        }
    }
}

/// Error of writing a program.
#[derive(Debug, thiserror::Error)]
pub enum RefeedError {
    /// The program.
    #[error("the program cannot be read: {0}")]
    Read(#[source] io::Error),
    /// The new one.
    #[error("the program cannot be written: {0}")]
    Write(#[source] io::Error),
    /// Whoever knows the limits.
    #[error("the limits are not known: {0}")]
    Limits(#[source] io::Error),
    /// A limit that comes when its line has been written.
    #[error("the limit of line {0} came too late")]
    Late(u32),
    /// A line that may be executed several times has several limits.
    #[error(
        "line {0} begins a loop or subroutine: feeds of such a program cannot be rewritten line by line"
    )]
    Repeated(u32),
    /// A line needs another feed, and its F cannot be changed.
    #[error("{0}: the feed of this line cannot be changed: {1}")]
    Fixed(Place, &'static str),
}

/// Interface to a dialect: the edits of each line.
pub(crate) trait Interpreter {
    /// The longest line it reads, its end included, bytes.
    const MAX_LINE_BYTES: usize;

    /// Takes the next line, its end included, and returns its edit. Lines that are too long come as their
    /// beginning.
    fn line(&mut self, line: &[u8], refed: &mut Refed) -> Result<Option<Edit>, RefeedError>;
}

/// Writes a program line by line.
pub(crate) fn rewrite<D: Interpreter>(
    mut reader: impl BufRead,
    mut interpreter: D,
    mut out: impl Write,
) -> Result<Refed, RefeedError> {
    let mut refed = Refed::default();
    let mut line = Vec::new();
    let limit = D::MAX_LINE_BYTES as u64 + 1;
    loop {
        line.clear();
        let read = reader.by_ref().take(limit).read_until(b'\n', &mut line);
        if read.map_err(RefeedError::Read)? == 0 {
            break;
        }
        refed.lines += 1;
        let edit = interpreter.line(&line, &mut refed)?;
        refed.changed += u64::from(edit.is_some());
        let written = match edit {
            Some(edit) => edit.write(&line, &mut out),
            None => out.write_all(&line),
        };
        written.map_err(RefeedError::Write)?;
        if line.len() > D::MAX_LINE_BYTES && line.last() != Some(&b'\n') {
            copy_line(&mut reader, &mut out)?;
        }
    }
    out.flush().map_err(RefeedError::Write)?;
    Ok(refed)
}

/// Copies the rest of a line.
fn copy_line(reader: &mut impl BufRead, out: &mut impl Write) -> Result<(), RefeedError> {
    loop {
        let buffer = match reader.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            other => other.map_err(RefeedError::Read)?,
        };
        let end = buffer.iter().position(|byte| *byte == b'\n');
        let length = end.map_or(buffer.len(), |end| end + 1);
        out.write_all(buffer.get(..length).unwrap_or_default()).map_err(RefeedError::Write)?;
        reader.consume(length);
        if end.is_some() || length == 0 {
            return Ok(());
        }
    }
}
