//! Decoder: reads a program line by line.

use super::block::Block;
use super::error::{DecodeError, Failure, Item, Problem};
use super::lexer::{self, Line};
use super::options::{DecoderOptions, PathMode, Position};
use super::output::Output;
use super::state::State;
use std::io::{self, BufRead, Read};
use std::iter::FusedIterator;
use twin_path::Place;

/// The longest line that is read, its end included, bytes.
pub const MAX_LINE_BYTES: usize = 1 << 16;

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Decodes a program as an iterator over its path elements.
///
/// Whatever the input, it ends with the input, with M2, M30 or the second `%`; text behind them is not read. A
/// block with an error gives an error (or several); the path goes on with the next block where the erroneous one was to
/// lead as far as that is known, with a jump in between. So all errors of a program are found in one run.
#[derive(Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each has a name of its own")]
pub struct Decoder<R> {
    pub(super) reader: R,
    skip_suppressed_blocks: bool,
    line: Vec<u8>,
    line_number: u32,
    program_number: Option<u32>,
    /// There was a `%`, or anything else but comments and blanks.
    begun: bool,
    /// There was anything but comments, blanks, a `%` and an O word.
    under_way: bool,
    pub(super) ended: bool,
    /// The last block that was carried out.
    last: Place,
    /// That of the last line.
    pub(super) block: Block,
    problems: Vec<Problem>,
    pub(super) state: State,
    pub(super) out: Output,
}

impl<R: BufRead> Decoder<R> {
    /// Decodes the program in `reader`.
    pub fn new(reader: R, options: DecoderOptions) -> Self {
        Self {
            reader,
            skip_suppressed_blocks: options.skip_suppressed_blocks,
            line: Vec::new(),
            line_number: 0,
            program_number: None,
            begun: false,
            under_way: false,
            ended: false,
            last: Place::default(),
            block: Block::default(),
            problems: Vec::new(),
            state: State::new(options),
            out: Output::default(),
        }
    }

    /// The number of the O word at the beginning of the program.
    pub fn program_number(&self) -> Option<u32> {
        self.program_number
    }

    /// Lines read so far.
    pub fn lines(&self) -> u32 {
        self.line_number
    }

    /// Position of the machine after the blocks read so far.
    pub fn position(&self) -> Position {
        self.state.location.machine
    }

    /// G61 or G64 in force.
    pub fn path_mode(&self) -> PathMode {
        self.state.path_mode
    }

    /// S in force, revolutions per minute.
    pub fn spindle_speed(&self) -> Option<f64> {
        self.state.speed
    }

    /// Number of the tool in the spindle, 0 = none.
    pub fn tool(&self) -> u32 {
        self.state.tool
    }

    /// Kept memory: bytes of the line, and items that nobody has taken yet.
    #[cfg(test)]
    pub(super) fn capacity(&self) -> usize {
        self.line.capacity() + self.problems.capacity() + self.out.items.capacity()
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
                self.reader.skip_until(b'\n')?;
            }
            self.line.clear();
            self.state.forgive_missing_feed();
            self.out.error(None, DecodeError::LineTooLong(MAX_LINE_BYTES));
        }
        Ok(true)
    }

    /// Reads and carries out the next line, or finds that there is none.
    pub(super) fn step(&mut self) -> io::Result<()> {
        self.block.clear();
        if self.read_line()? {
            self.decode_line();
            if self.ended {
                self.state.end(&mut self.out);
            }
        } else {
            self.ended = true;
            self.out.place = Place { line: self.line_number.max(1), block: None };
            self.out.warning(None, DecodeError::MissingEnd);
            self.out.place = self.last;
            self.state.end(&mut self.out);
        }
        Ok(())
    }

    fn decode_line(&mut self) {
        let line = self.line.strip_suffix(b"\n").unwrap_or(&self.line);
        let mut at = 0;
        if self.line_number == 1 && line.starts_with(BYTE_ORDER_MARK) {
            at = BYTE_ORDER_MARK.len();
        }
        match line.get(at..).and_then(|line| line.iter().find(|byte| !byte.is_ascii_whitespace())) {
            None => return,
            Some(b'%') if line.get(at..).is_some_and(|line| line.trim_ascii() == b"%") => {
                self.ended = std::mem::replace(&mut self.begun, true);
                return;
            }
            Some(b'/') if self.skip_suppressed_blocks => return,
            Some(b'/') => {
                at = line.iter().position(|byte| *byte == b'/').unwrap_or_default() + 1;
            }
            Some(_) => {}
        }
        let kind = lexer::lex(line, at, &mut self.block, &mut self.problems);
        self.out.place.block = self.block.number;
        if let Line::ProgramNumber { start, end } = kind {
            if self.under_way {
                let reason = super::UnsupportedReason::Subroutine;
                self.out.error(Some(start..end), DecodeError::Unsupported(reason));
            } else {
                let digits = line.get(start + 1..end).unwrap_or_default();
                let digits = digits.iter().filter(|byte| byte.is_ascii_digit());
                self.program_number =
                    digits.map(|byte| u32::from(byte - b'0')).try_fold(0_u32, |number, digit| {
                        number.checked_mul(10).and_then(|n| n.checked_add(digit))
                    });
            }
            (self.begun, self.under_way) = (true, true);
            return;
        }
        if self.problems.is_empty() {
            if self.block.is_empty() {
                return;
            }
            (self.begun, self.under_way) = (true, true);
            self.last = self.out.place;
            match self.state.execute(&self.block, &mut self.out) {
                Ok(true) => {}
                Ok(false) => self.ended = true,
                Err(Problem { columns, error }) => {
                    self.state.adopt(&self.block);
                    self.out.error(columns, error);
                    self.ended = matches!(self.block.m.stop, Some(2 | 30));
                }
            }
            return;
        }
        (self.begun, self.under_way) = (true, true);
        self.state.adopt(&self.block);
        // The F that is missing later may well be one that could not be read here.
        self.state.forgive_missing_feed();
        for Problem { columns, error } in self.problems.drain(..) {
            self.out.error(columns, error);
        }
        self.ended = matches!(self.block.m.stop, Some(2 | 30));
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
            match self.step() {
                Ok(()) => {}
                Err(error) => {
                    self.ended = true;
                    return Some(Err(Failure::Io(error)));
                }
            }
        }
    }
}

impl<R: BufRead> FusedIterator for Decoder<R> {}
