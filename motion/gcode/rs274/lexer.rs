//! Lexer: the bytes of a line to words.

use super::block::{Assignment, Block};
use super::error::{DecodeError, Problem};
use super::expression::ExpressionError;
use super::flow::{FlowError, Keyword, Label};
use super::message::Message;
use super::state::State;
use crate::number;
use std::ops::Range;

/// Reads the words of `line`, from byte `at` on, into `block`, and its errors into `problems`.
///
/// Blanks mean nothing, not even within numbers. A word that is well formed but of no use is left out and the words
/// after it are still read. After bytes that are not a word nothing more is read: what would follow are errors of
/// guessing where the next word begins. Values are those of the parameters before this line. Returns the label and the
/// keyword of a line of flow control, and where its values begin.
pub(super) fn lex(
    line: &[u8],
    at: usize,
    state: &State,
    block: &mut Block,
    problems: &mut Vec<Problem>,
) -> Option<(Label, Keyword, usize)> {
    let mut lexer = Lexer::new(line, at, state);
    match lexer.peek() {
        Some(b'N' | b'n') => {
            if let Err(problem) = lexer.block_number(block) {
                problems.push(problem);
                return None;
            }
        }
        // Most lines.
        Some(_) => {}
        None => return None,
    }
    if matches!(lexer.peek(), Some(b'O' | b'o')) {
        match lexer.label() {
            Ok((label, keyword)) => return Some((label, keyword, lexer.at)),
            Err(problem) => problems.push(problem),
        }
        return None;
    }
    if let Some((statement, rewrite)) = lexer.macro_statement() {
        let error = FlowError::Macro { statement, rewrite }.into();
        problems.push(lexer.problem(lexer.at, line.len(), error));
        return None;
    }
    while let Some(byte) = lexer.peek() {
        let result = match byte {
            b';' => {
                lexer.see("comment with ;", lexer.at..line.len());
                break;
            }
            b'(' => lexer.comment().map(|comment| block.message = comment),
            b'#' => lexer.assignment(block),
            b'@' | b'^' | b'$' => lexer.word(byte, block, problems),
            _ if byte.is_ascii_alphabetic() => lexer.word(byte, block, problems),
            _ => Err(lexer.unexpected(byte)),
        };
        if let Err(problem) = result {
            problems.push(problem);
            return None;
        }
    }
    block.seen.append(&mut lexer.seen);
    None
}

/// A line on the way to its words.
pub(super) struct Lexer<'a> {
    pub(super) line: &'a [u8],
    pub(super) at: usize,
    /// Nesting of the current value.
    pub(super) depth: u32,
    pub(super) state: &'a State,
    /// As [`Block::seen`].
    seen: Vec<(String, Range<usize>)>,
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\x0b' | b'\x0c')
}

impl<'a> Lexer<'a> {
    pub(super) fn new(line: &'a [u8], at: usize, state: &'a State) -> Self {
        Self { line, at, depth: 0, state, seen: Vec::new() }
    }

    /// The next byte that is not blank; it is at `self.at` then.
    pub(super) fn peek(&mut self) -> Option<u8> {
        loop {
            let byte = *self.line.get(self.at)?;
            if !is_blank(byte) {
                return Some(byte);
            }
            self.at += 1;
        }
    }

    pub(super) fn problem(&self, start: usize, end: usize, error: DecodeError) -> Problem {
        // At the end of the line: its last byte.
        let end = end.min(self.line.len());
        Problem { columns: Some(start.min(end.saturating_sub(1))..end), error }
    }

    /// An error of what has been read from `start` on.
    pub(super) fn since(&self, start: usize, error: impl Into<DecodeError>) -> Problem {
        self.problem(start, self.at.max(start + 1), error.into())
    }

    /// Keeps what not every control takes.
    pub(super) fn see(&mut self, word: &str, columns: Range<usize>) {
        if self.state.control.is_some() && !self.seen.iter().any(|(known, _)| known == word) {
            self.seen.push((word.to_owned(), columns));
        }
    }

    /// Keeps a word of `letter` and `value`, from byte `start` on.
    fn see_word(&mut self, letter: char, value: Option<f64>, start: usize) {
        if self.state.control.is_none() {
            return;
        }
        let columns = start..self.at;
        match (letter, value) {
            ('@' | '^', _) => self.see("@ and ^", columns),
            ('G' | 'M', Some(number)) => self.see(&format!("{letter}{number}"), columns),
            _ => self.see(letter.encode_utf8(&mut [0; 4]), columns),
        }
        let text = self.line.get(start + 1..self.at).unwrap_or_default();
        let is_whole =
            text.iter().all(|byte| is_blank(*byte) || matches!(byte, b'+' | b'-' | b'0'..=b'9'));
        if is_whole && matches!(letter, 'X' | 'Y' | 'Z' | 'I' | 'J' | 'R') && value != Some(0.0) {
            self.see("length without a decimal point", start..self.at);
        }
    }

    /// Where `text` ends if it is here, in whatever case.
    pub(super) fn end_of(&self, text: &str) -> Option<usize> {
        let mut at = self.at;
        for byte in text.bytes() {
            while self.line.get(at).is_some_and(|byte| is_blank(*byte)) {
                at += 1;
            }
            if !self.line.get(at)?.eq_ignore_ascii_case(&byte) {
                return None;
            }
            at += 1;
        }
        Some(at)
    }

    /// Reads to the end of a line on which only comments are left.
    pub(super) fn only_comments(&mut self) -> Result<(), Problem> {
        while let Some(byte) = self.peek() {
            match byte {
                b';' => break,
                b'(' => {
                    self.comment()?;
                }
                _ => return Err(self.unexpected(byte)),
            }
        }
        Ok(())
    }

    /// The comment that begins here, if it is a message. It may contain any bytes.
    pub(super) fn comment(&mut self) -> Result<Option<Message>, Problem> {
        let inside = self.at + 1;
        let rest = self.line.get(inside..).unwrap_or_default();
        let end = rest.iter().position(|byte| matches!(byte, b'(' | b')'));
        let Some(length) = end else {
            return Err(self.problem(self.at, self.line.len(), DecodeError::UnclosedComment));
        };
        let end = inside + length;
        if self.line.get(end) == Some(&b'(') {
            return Err(self.problem(end, end + 1, DecodeError::NestedComment));
        }
        self.at = end + 1;
        Ok(Message::of_comment(rest.get(..length).unwrap_or_default(), self.state))
    }

    /// The parameter that is set here: `#1 = 2`.
    fn assignment(&mut self, block: &mut Block) -> Result<(), Problem> {
        let start = self.at;
        let target = self.parameter()?;
        self.expect('=')?;
        let value = self.value()?;
        self.state.check_settable(&target).map_err(|error| self.since(start, error))?;
        block.assignments.push(Assignment { target, value });
        Ok(())
    }

    fn word(
        &mut self,
        byte: u8,
        block: &mut Block,
        problems: &mut Vec<Problem>,
    ) -> Result<(), Problem> {
        let start = self.at;
        let upper = byte.to_ascii_uppercase();
        let letter = char::from(upper);
        match upper {
            b'N' => {
                return Err(self.problem(start, start + 1, DecodeError::MisplacedBlockNumber));
            }
            b'O' => {
                return Err(self.problem(start, start + 1, DecodeError::MisplacedLabel));
            }
            _ => self.at += 1,
        }
        match self.peek() {
            Some(b'0'..=b'9' | b'.' | b'+' | b'-' | b'#' | b'[') => {}
            Some(next) if next.is_ascii_alphabetic() && self.is_function() => {}
            _ => {
                return Err(self.problem(start, start + 1, DecodeError::MissingNumber(letter)));
            }
        }
        let value = if self.is_number() { self.plain_number() } else { self.value().map(Some)? };
        let columns = start..self.at;
        self.see_word(letter, value, start);
        match value {
            Some(value) => {
                let value = match self.state.numbers_of {
                    Some(control) if upper == b'G' => control.g_number(value),
                    _ => value,
                };
                block.add(upper, value, columns, self.state.strict, problems);
            }
            None => problems.push(Problem {
                columns: Some(columns),
                error: DecodeError::InvalidNumber(letter),
            }),
        }
        Ok(())
    }

    /// True if a number begins here, perhaps with a sign.
    pub(super) fn is_number(&self) -> bool {
        match self.line.get(self.at) {
            Some(b'0'..=b'9' | b'.') => true,
            Some(b'+' | b'-') => {
                let rest = self.line.get(self.at + 1..).unwrap_or_default();
                let next = rest.iter().find(|byte| !is_blank(**byte));
                matches!(next, Some(b'0'..=b'9' | b'.'))
            }
            _ => false,
        }
    }

    /// The number that begins here.
    pub(super) fn number(&mut self) -> Result<f64, Problem> {
        let start = self.at;
        self.plain_number().ok_or_else(|| self.since(start, ExpressionError::NotNumber))
    }

    /// The number that begins here; `None` if it is none. Leaves `self.at` behind its last byte.
    fn plain_number(&mut self) -> Option<f64> {
        let start = self.at;
        if matches!(self.line.get(self.at), Some(b'+' | b'-')) {
            self.at += 1;
            self.peek();
        }
        let (mut end, mut blanks) = (self.at, self.at > start + 1);
        while let Some(byte) = self.line.get(self.at) {
            match byte {
                b'0'..=b'9' | b'.' => {
                    blanks |= end != self.at && end > start;
                    self.at += 1;
                    end = self.at;
                }
                byte if is_blank(*byte) => self.at += 1,
                _ => break,
            }
        }
        self.at = end;
        let text = self.line.get(start..end).unwrap_or_default();
        if !blanks {
            return number::parse(text);
        }
        let digits: Vec<u8> = text.iter().copied().filter(|byte| !is_blank(*byte)).collect();
        number::parse(&digits)
    }

    /// The N word that begins here: digits, and perhaps a point and more digits, which are not kept.
    pub(super) fn block_number(&mut self, block: &mut Block) -> Result<(), Problem> {
        let start = self.at;
        self.at += 1;
        let (mut number, mut digits) = (Some(0_u32), 0);
        while let Some(byte @ b'0'..=b'9') = self.peek() {
            self.at += 1;
            digits += 1;
            number = number
                .and_then(|number| number.checked_mul(10))
                .and_then(|number| number.checked_add(u32::from(byte - b'0')));
        }
        if digits == 0 {
            return Err(self.problem(start, self.at, DecodeError::InvalidBlockNumber));
        }
        if self.peek() == Some(b'.') {
            self.at += 1;
            while let Some(b'0'..=b'9') = self.peek() {
                self.at += 1;
            }
        }
        block.number = number;
        Ok(())
    }

    /// The character here does not begin a word.
    fn unexpected(&self, byte: u8) -> Problem {
        let at = self.at;
        // No character is longer than four bytes.
        let bytes = self.line.get(at..self.line.len().min(at + 4)).unwrap_or_default();
        let character = bytes.utf8_chunks().next().and_then(|chunk| chunk.valid().chars().next());
        let (length, error) = match character {
            Some(character) => (character.len_utf8(), DecodeError::UnexpectedCharacter(character)),
            None => (1, DecodeError::UnexpectedByte(byte)),
        };
        self.problem(at, at + length, error)
    }
}
