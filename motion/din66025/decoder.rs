//! Reads a program line by line.

use super::block::Block;
use super::error::{DecodeError, Diagnostic, Failure, Item, Problem};
use super::lexer;
use super::state::State;
use super::word::Word;
use crate::Place;
use crate::path::PathElement;
use nalgebra::Point3;
use std::collections::VecDeque;
use std::io::{self, BufRead, Read};
use std::iter::FusedIterator;
use std::ops::Range;

/// The longest line that is read, its end included, bytes.
pub const MAX_LINE_BYTES: usize = 1 << 16;

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// What a decoder must know besides the program.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DecoderOptions {
    /// Where the program starts if it does not begin with G92, m (`piStartPosition`).
    pub start: [f64; 3],
    /// Leaves out the blocks that begin with `/` (`bStepSuppress`). What is in them is not looked at.
    pub skip_suppressed_blocks: bool,
}

/// Decodes a program (`SMC_NCDecoder`, manual 6.2.1) as an iterator over its path elements.
///
/// Whatever the input, it ends with the input. A block with an error gives an error (or several) and no element; the
/// path goes on with the next block as if the erroneous one were not there, except that the modes, feed and
/// accelerations it sets hold. So all errors of a program are found in one run.
#[derive(Debug)]
pub struct Decoder<R> {
    reader: R,
    skip_suppressed_blocks: bool,
    line: Vec<u8>,
    line_number: u32,
    name: Option<String>,
    /// The `%` line has been read, or missed.
    begun: bool,
    ended: bool,
    words: Vec<Word>,
    problems: Vec<Problem>,
    state: State,
    out: Output,
}

impl<R: BufRead> Decoder<R> {
    /// Decodes the program in `reader`.
    pub fn new(reader: R, options: DecoderOptions) -> Self {
        Self {
            reader,
            skip_suppressed_blocks: options.skip_suppressed_blocks,
            line: Vec::new(),
            line_number: 0,
            name: None,
            begun: false,
            ended: false,
            words: Vec::new(),
            problems: Vec::new(),
            state: State::new(options.start),
            out: Output::default(),
        }
    }

    /// The program's name: what follows `%`. Known once the first item has been asked for.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Lines read so far.
    pub fn lines(&self) -> u32 {
        self.line_number
    }

    /// Where the blocks read so far leave the tool, m.
    pub fn position(&self) -> Point3<f64> {
        self.state.position()
    }

    /// Reads the next line; false at the end of the program.
    fn read_line(&mut self) -> io::Result<bool> {
        self.line.clear();
        let limit = MAX_LINE_BYTES as u64 + 1;
        if self.reader.by_ref().take(limit).read_until(b'\n', &mut self.line)? == 0 {
            return Ok(false);
        }
        self.line_number = self.line_number.saturating_add(1);
        self.out.place = Place { line: self.line_number, block: None };
        if self.line.len() > MAX_LINE_BYTES {
            if self.line.last() != Some(&b'\n') {
                skip_line(&mut self.reader)?;
            }
            self.line.clear();
            self.begun = true;
            self.state.forgive_missing_feed();
            self.out.push_error(None, DecodeError::LineTooLong { limit: MAX_LINE_BYTES });
        }
        Ok(true)
    }

    fn decode_line(&mut self) {
        let line = self.line.strip_suffix(b"\n").unwrap_or(&self.line);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let mark = if self.line_number == 1 && line.starts_with(BYTE_ORDER_MARK) {
            BYTE_ORDER_MARK.len()
        } else {
            0
        };
        let Some((begin, first)) = first_word(line, mark) else { return };
        let begun = std::mem::replace(&mut self.begun, true);
        match (first, begun) {
            (b'%', false) => {
                let name = line.get(begin + 1..).unwrap_or_default().trim_ascii();
                self.name = (!name.is_empty()).then(|| String::from_utf8_lossy(name).into_owned());
                return;
            }
            (b'%', true) => return self.out.error(begin..begin + 1, DecodeError::MisplacedPercent),
            (_, false) => self.out.error(begin..line.len(), DecodeError::MissingPercent),
            (_, true) => {}
        }
        let begin = match first {
            b'/' if self.skip_suppressed_blocks => return,
            b'/' => begin + 1,
            _ => begin,
        };
        self.words.clear();
        lexer::lex(line, begin, &mut self.words, &mut self.problems);
        let block = Block::new(&self.words, &mut self.problems);
        self.out.place.block = block.number;
        self.state.store(&block);
        if self.problems.is_empty() {
            self.state.execute(&block, &self.words, &mut self.out);
            return;
        }
        self.problems.sort_by_key(|problem| problem.columns.start);
        let unread = self
            .problems
            .first()
            .and_then(|problem| line.get(problem.columns.start..))
            .unwrap_or_default();
        if unread.iter().any(|byte| byte.eq_ignore_ascii_case(&b'F')) {
            // The F that is missing later may well be one that could not be read here.
            self.state.forgive_missing_feed();
        }
        for Problem { columns, error } in self.problems.drain(..) {
            self.out.error(columns, error);
        }
    }
}

impl<R: BufRead> Iterator for Decoder<R> {
    type Item = Result<Item, Failure>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(item) = self.out.items.pop_front() {
                return Some(item);
            }
            if self.ended {
                return None;
            }
            match self.read_line() {
                Ok(true) => self.decode_line(),
                Ok(false) => {
                    self.ended = true;
                    self.state.finish(&mut self.out);
                }
                Err(error) => {
                    self.ended = true;
                    return Some(Err(Failure::Io(error)));
                }
            }
        }
    }
}

impl<R: BufRead> FusedIterator for Decoder<R> {}

/// Where the first byte that is not blank is, from `at` on, and which.
fn first_word(line: &[u8], at: usize) -> Option<(usize, u8)> {
    line.iter().copied().enumerate().skip(at).find(|(_, byte)| !matches!(byte, b' ' | b'\t'))
}

/// Reads up to the end of the line without keeping it.
fn skip_line(reader: &mut impl BufRead) -> io::Result<()> {
    loop {
        let buffer = match reader.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            other => other?,
        };
        let end = buffer.iter().position(|byte| *byte == b'\n');
        let length = end.map_or(buffer.len(), |end| end + 1);
        reader.consume(length);
        if end.is_some() || length == 0 {
            return Ok(());
        }
    }
}

/// What a line gives: a few items, in order.
#[derive(Debug, Default)]
pub(super) struct Output {
    items: VecDeque<Result<Item, Failure>>,
    place: Place,
}

impl Output {
    /// The block at hand.
    pub(super) fn place(&self) -> Place {
        self.place
    }

    pub(super) fn element(&mut self, element: PathElement) {
        self.items.push_back(Ok(Item::Element(element)));
    }

    pub(super) fn warning(&mut self, columns: Range<usize>, error: DecodeError) {
        let diagnostic = Diagnostic { place: self.place, columns: Some(columns), error };
        self.items.push_back(Ok(Item::Warning(diagnostic)));
    }

    pub(super) fn error(&mut self, columns: Range<usize>, error: DecodeError) {
        self.push_error(Some(columns), error);
    }

    fn push_error(&mut self, columns: Option<Range<usize>>, error: DecodeError) {
        let diagnostic = Diagnostic { place: self.place, columns, error };
        self.items.push_back(Err(diagnostic.into()));
    }
}
