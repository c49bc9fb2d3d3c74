//! The same program with feeds that its machine can go: F words lowered where they are too high, and nothing else.
//!
//! F is modal. A line on which the machine allows less than is programmed gets a lower F, in place of its own or added
//! to it; the next line of the path that allows more gets the programmed one back. All other bytes stay: comments,
//! blanks, line ends, numbers, whatever encoding they are in. Feeds are rounded down to four significant digits, so that
//! they do not exceed what is allowed, and a program that needs nothing comes back as it was.
//!
//! Each dialect has its own function, on top of its decoder: [`crate::din66025::refeed`], [`crate::rs274::refeed`].

use crate::Place;
use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, BufRead, Read, Write};
use std::iter::Fuse;
use std::ops::Range;

/// Differences between a feed and its limit that are rounding and no reason to change a line.
const ROUNDING: f64 = 1e-9;

/// Significant digits of a feed that is lowered. What rounding down costs is less than a thousandth.
const DIGITS: i32 = 4;

/// How many lines a limit may come late, behind those of later lines: path preparation lets M functions and the pieces
/// it puts in at corners change places with their neighbours.
const LATE: u32 = 256;

/// So many of the lines that no F can help are kept.
const KEPT: usize = 1000;

/// Room that an F word may need, bytes.
const WORD: usize = 32;

/// The largest feed that a machine allows on a line of a program, or on a piece of it: of several for one line the
/// smallest counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLimit {
    /// Line of the file, from 1.
    pub line: u32,
    /// It is that of a rapid (G0). In RS274 no F word governs rapids.
    pub rapid: bool,
    /// m/s, or where only further axes move a thousandth of their velocity in u/s, as in
    /// [`crate::path::PathElement::feed`]. What is no number counts as 0.
    pub feed: f64,
}

/// Why no F makes a line feasible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reason {
    /// A rapid of RS274: its velocity is the machine's.
    Rapid,
    /// No feed is low enough: the limit is (next to) zero.
    NoFeed,
    /// Inverse time (G93) goes no slower than a tenth of a unit per minute.
    InverseTime,
    /// The line is so long that there is no room for a word more.
    LongLine,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rapid => "F does not govern rapids",
            Self::NoFeed => "no feed is low enough",
            Self::InverseTime => "inverse time (G93) goes no slower",
            Self::LongLine => "the line has no room for another word",
        })
    }
}

/// A line that stays too fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unrepaired {
    /// The block.
    pub place: Place,
    /// Why.
    pub reason: Reason,
    /// Its velocity, m/s.
    pub programmed: f64,
    /// What the machine allows, m/s.
    pub limit: f64,
}

/// What became of a program.
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

/// Why a program could not be written.
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
    #[error("the limit of line {line} came too late")]
    Late {
        /// The line.
        line: u32,
    },
}

/// The limits of a line, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limit {
    pub(crate) feed: f64,
    pub(crate) rapid: f64,
}

impl Default for Limit {
    fn default() -> Self {
        Self { feed: f64::INFINITY, rapid: f64::INFINITY }
    }
}

impl Limit {
    /// For a dialect whose F governs rapids, too.
    pub(crate) fn of_both(self) -> f64 {
        self.feed.min(self.rapid)
    }

    pub(crate) fn include(&mut self, limit: &LineLimit) {
        let feed = if limit.feed > 0.0 { limit.feed } else { 0.0 };
        let slot = if limit.rapid { &mut self.rapid } else { &mut self.feed };
        *slot = slot.min(feed);
    }
}

/// Limits in the order of lines, more or less.
#[derive(Debug)]
pub(crate) struct Limits<I: Iterator> {
    source: Fuse<I>,
    waiting: BTreeMap<u32, Limit>,
    newest: u32,
    ended: bool,
}

impl<I: Iterator<Item = io::Result<LineLimit>>> Limits<I> {
    pub(crate) fn new(source: I) -> Self {
        Self { source: source.fuse(), waiting: BTreeMap::new(), newest: 0, ended: false }
    }

    /// The limit of `line`, which is the next one.
    pub(crate) fn of(&mut self, line: u32) -> Result<Limit, RefeedError> {
        while !self.ended && self.newest <= line.saturating_add(LATE) {
            match self.source.next() {
                None => self.ended = true,
                Some(limit) => {
                    let limit = limit.map_err(RefeedError::Limits)?;
                    if limit.line < line {
                        return Err(RefeedError::Late { line: limit.line });
                    }
                    self.newest = self.newest.max(limit.line);
                    self.waiting.entry(limit.line).or_default().include(&limit);
                }
            }
        }
        Ok(self.waiting.remove(&line).unwrap_or_default())
    }

    /// All of them, for a program that does not go from line to line.
    pub(crate) fn into_table(self) -> Result<BTreeMap<u32, Limit>, RefeedError> {
        let mut table = self.waiting;
        for limit in self.source {
            let limit = limit.map_err(RefeedError::Limits)?;
            table.entry(limit.line).or_default().include(&limit);
        }
        Ok(table)
    }
}

/// Whether a limit is below what is programmed by more than rounding.
pub(crate) fn is_below(limit: f64, programmed: f64) -> bool {
    limit < programmed * (1.0 - ROUNDING)
}

/// What changes in a line: these bytes become that text.
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

    fn write(&self, line: &[u8], out: &mut impl Write) -> io::Result<()> {
        out.write_all(line.get(..self.bytes.start).unwrap_or_default())?;
        out.write_all(self.text.as_bytes())?;
        out.write_all(line.get(self.bytes.end..).unwrap_or_default())
    }
}

/// Whether a line of at most `most` bytes has room for an F word.
pub(crate) fn has_room(line: &[u8], most: usize) -> bool {
    line.len() + WORD <= most
}

/// Whether a line may be left out by the machine.
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
    let scaled = if exponent < 0 {
        value * 10_f64.powi(-exponent)
    } else {
        value / 10_f64.powi(exponent)
    };
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

/// What a dialect has to say to each line.
pub(crate) trait Interpreter {
    /// The longest line it reads, its end included, bytes.
    const MAX_LINE_BYTES: usize;

    /// Takes the next line, its end included, and tells what is to change in it. Lines that are too long come as their
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn feeds_are_rounded_down_to_four_digits() {
        for (value, text) in [
            (1.0, "1"),
            (0.999_99, "0.9999"),
            (20.0 - 4e-15, "20"),
            (123.456, "123.4"),
            (1_234_567.0, "1234000"),
            (1e6, "1000000"),
            (0.001_239_9, "0.001239"),
            (1e-9, "0.000000001"),
            (59.999_9, "59.99"),
            (0.1 + 0.2, "0.3"),
        ] {
            let (number, written) = rounded_down(value).unwrap();
            assert_eq!(written, text, "{value}");
            assert_eq!(number.to_bits(), text.parse::<f64>().unwrap().to_bits());
        }
        for value in [0.0, -1.0, 1e-10, f64::NAN, f64::INFINITY, 1e13] {
            assert_eq!(rounded_down(value), None, "{value}");
        }
    }

    proptest! {
        #[test]
        fn a_rounded_feed_is_below_and_near(mantissa in 1.0..10.0_f64, exponent in -9..12_i32) {
            let value = mantissa * 10_f64.powi(exponent);
            prop_assume!((1e-9..=1e12).contains(&value));
            let (number, text) = rounded_down(value).unwrap();
            prop_assert!(number <= value * (1.0 + 1e-11) && number > value * (1.0 - 1.001e-3), "{value} {text}");
            prop_assert!(text.bytes().filter(u8::is_ascii_digit).collect::<Vec<_>>()
                .trim_ascii().iter().skip_while(|digit| **digit == b'0').count() <= 13);
            prop_assert_eq!(crate::number::parse(text.as_bytes()), Some(number));
        }

        /// However limits are shuffled within the room they have, each line gets the smallest of its own.
        #[test]
        fn limits_may_come_late(order in prop::collection::vec((1..60_u32, any::<bool>(), 0.0..1.0_f64), 0..80)) {
            let mut limits = Limits::new(order.iter().map(|(line, rapid, feed)| {
                Ok(LineLimit { line: *line, rapid: *rapid, feed: *feed })
            }));
            for line in 1..=60 {
                let least = |rapid: bool| {
                    let own = order.iter().filter(|one| one.0 == line && one.1 == rapid);
                    own.fold(f64::INFINITY, |least, one| least.min(one.2))
                };
                let limit = limits.of(line).unwrap();
                prop_assert_eq!([limit.feed, limit.rapid], [least(false), least(true)]);
            }
        }
    }

    #[test]
    fn a_limit_that_comes_too_late_is_an_error() {
        let limits = [1, 2 + LATE, 3 + LATE, 1].map(|line| LineLimit { line, rapid: false, feed: 0.1 });
        let mut limits = Limits::new(limits.into_iter().map(Ok));
        assert!(limits.of(1).is_ok());
        assert!(limits.of(2).is_ok());
        assert!(matches!(limits.of(3), Err(RefeedError::Late { line: 1 })));
    }
}
