//! Lexer: the bytes of a line to words.

use super::block::Block;
use super::error::{DecodeError, Problem, UnsupportedReason};
use crate::number;

/// The functions whose names may follow a letter in place of a number.
const FUNCTIONS: [&[u8]; 15] = [
    b"ABS", b"ACOS", b"ASIN", b"ATAN", b"COS", b"EXISTS", b"EXP", b"FIX", b"FUP", b"LN", b"ROUND",
    b"SIN", b"SQRT", b"TAN", b"MOD",
];

/// Kind of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Line {
    /// Words, or nothing.
    Words,
    /// An O word with a number and nothing else; the bytes of it.
    ProgramNumber {
        /// First byte.
        start: usize,
        /// Behind the last one.
        end: usize,
    },
}

/// Reads the words of `line`, from byte `at` on, into `block`, and its errors into `problems`.
///
/// Blanks mean nothing, not even within numbers. A word that is well formed but of no use is left out and the words
/// after it are still read. After bytes that are not a word nothing more is read: what would follow are errors of
/// guessing where the next word begins.
pub(super) fn lex(line: &[u8], at: usize, block: &mut Block, problems: &mut Vec<Problem>) -> Line {
    let mut lexer = Lexer { line, at };
    let mut kind = Line::Words;
    match lexer.peek() {
        Some(b'N' | b'n') => {
            if let Err(problem) = lexer.block_number(block) {
                problems.push(problem);
                return kind;
            }
        }
        // Most lines.
        Some(_) => {}
        None => return kind,
    }
    if matches!(lexer.peek(), Some(b'O' | b'o')) {
        match lexer.program_number() {
            Ok(number) => kind = number,
            Err(problem) => {
                problems.push(problem);
                return kind;
            }
        }
    }
    while let Some(byte) = lexer.peek() {
        let result = match byte {
            b';' => return kind,
            b'(' => lexer.comment(),
            _ if byte.is_ascii_alphabetic() => lexer.word(byte, block, problems),
            _ => Err(lexer.unexpected(byte)),
        };
        if let Err(problem) = result {
            problems.push(problem);
            return kind;
        }
    }
    kind
}

struct Lexer<'a> {
    line: &'a [u8],
    at: usize,
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\x0b' | b'\x0c')
}

impl Lexer<'_> {
    /// The next byte that is not blank; it is at `self.at` then.
    fn peek(&mut self) -> Option<u8> {
        loop {
            let byte = *self.line.get(self.at)?;
            if !is_blank(byte) {
                return Some(byte);
            }
            self.at += 1;
        }
    }

    fn problem(&self, start: usize, end: usize, error: DecodeError) -> Problem {
        Problem { columns: Some(start..end.min(self.line.len())), error }
    }

    /// The comment that begins here. It may contain any bytes.
    fn comment(&mut self) -> Result<(), Problem> {
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
            b'O' => return Err(self.unsupported(start, UnsupportedReason::Subroutine)),
            _ => self.at += 1,
        }
        match self.peek() {
            Some(b'0'..=b'9' | b'.' | b'+' | b'-') => {}
            Some(b'#') => return Err(self.unsupported(start, UnsupportedReason::Parameter)),
            Some(b'[') => return Err(self.unsupported(start, UnsupportedReason::Expression)),
            Some(next) if next.is_ascii_alphabetic() && self.is_function() => {
                return Err(self.unsupported(start, UnsupportedReason::Expression));
            }
            _ => {
                return Err(self.problem(start, start + 1, DecodeError::MissingNumber(letter)));
            }
        }
        let value = self.number();
        let columns = start..self.at;
        match value {
            Ok(Some(value)) => block.add(upper, value, columns, problems),
            Ok(None) => problems.push(Problem {
                columns: Some(columns),
                error: DecodeError::InvalidNumber(letter),
            }),
            // A sign, and then something else.
            Err(reason) => return Err(self.unsupported(start, reason)),
        }
        Ok(())
    }

    /// The number that begins here; `None` if it is none. Leaves `self.at` behind its last byte.
    ///
    /// # Errors
    /// If a sign is followed by a parameter or an expression.
    fn number(&mut self) -> Result<Option<f64>, UnsupportedReason> {
        let start = self.at;
        if matches!(self.line.get(self.at), Some(b'+' | b'-')) {
            self.at += 1;
            match self.peek() {
                Some(b'#') => return Err(UnsupportedReason::Parameter),
                Some(b'[') => return Err(UnsupportedReason::Expression),
                _ => {}
            }
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
            return Ok(number::parse(text));
        }
        let digits: Vec<u8> = text.iter().copied().filter(|byte| !is_blank(*byte)).collect();
        Ok(number::parse(&digits))
    }

    /// The N word that begins here: digits, and perhaps a point and more digits, which are not kept.
    fn block_number(&mut self, block: &mut Block) -> Result<(), Problem> {
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

    /// The O word that begins here, if it is a program's number: digits, and nothing but comments behind it.
    fn program_number(&mut self) -> Result<Line, Problem> {
        let start = self.at;
        self.at += 1;
        let (mut end, mut digits) = (self.at, 0);
        while let Some(b'0'..=b'9') = self.peek() {
            self.at += 1;
            digits += 1;
            end = self.at;
        }
        match self.peek() {
            None | Some(b'(' | b';') if digits > 0 => Ok(Line::ProgramNumber { start, end }),
            _ => Err(self.unsupported(start, UnsupportedReason::Subroutine)),
        }
    }

    /// True if a function's name and a bracket follow.
    fn is_function(&self) -> bool {
        let rest = self.line.get(self.at..).unwrap_or_default();
        FUNCTIONS.iter().any(|name| {
            rest.get(..name.len()).is_some_and(|head| head.eq_ignore_ascii_case(name))
                && rest.iter().skip(name.len()).find(|byte| !is_blank(**byte)) == Some(&b'[')
        })
    }

    fn unsupported(&self, start: usize, reason: UnsupportedReason) -> Problem {
        self.problem(start, self.line.len(), DecodeError::Unsupported(reason))
    }

    /// The character here does not begin a word.
    fn unexpected(&self, byte: u8) -> Problem {
        let at = self.at;
        match byte {
            b'#' => return self.unsupported(at, UnsupportedReason::Parameter),
            b'[' => return self.unsupported(at, UnsupportedReason::Expression),
            b'@' | b'^' | b'$' => {
                let letter = char::from(byte);
                return self.problem(at, at + 1, DecodeError::UnsupportedLetter(letter));
            }
            _ => {}
        }
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
