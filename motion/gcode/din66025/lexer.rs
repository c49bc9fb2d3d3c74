//! Lexer: the bytes of a line to words.

use super::error::{DecodeError, Problem};
use super::variables::Variables;
use super::word::{Letter, Word};
use super::{block, number};
use std::ops::Range;

/// Appends the words of `line`, from byte `at` on, with `variables` for names, to `words`, and its errors to `problems`.
///
/// A word that is well formed but of no use is left out and the words after it are still read. After bytes that are
/// no word at all nothing more is read: what would follow are errors of guessing where the next word begins.
pub(super) fn lex(
    line: &[u8],
    mut at: usize,
    variables: &Variables,
    words: &mut Vec<Word>,
    problems: &mut Vec<Problem>,
) {
    while let Some(&byte) = line.get(at) {
        let token = match byte {
            b' ' | b'\t' => Token::Nothing,
            b'(' => comment(line, at),
            _ if byte.is_ascii_alphabetic() => word(line, at, byte, variables),
            _ => unexpected(line, at, byte),
        };
        match token {
            Token::Nothing => at += 1,
            Token::Comment { end } => at = end,
            Token::Word(word) => {
                at = word.columns.end;
                words.push(word);
            }
            Token::Useless(problem) => {
                at = problem.columns.end;
                problems.push(problem);
            }
            Token::Broken(problem) => {
                problems.push(problem);
                return;
            }
        }
    }
}

enum Token {
    Nothing,
    Comment { end: usize },
    Word(Word),
    Useless(Problem),
    Broken(Problem),
}

fn rest(line: &[u8], at: usize) -> &[u8] {
    line.get(at..).unwrap_or_default()
}

/// The comment that begins at `at`. It may contain any bytes.
fn comment(line: &[u8], at: usize) -> Token {
    let inside = at + 1;
    match rest(line, inside).iter().position(|byte| matches!(byte, b'(' | b')')) {
        None => {
            Token::Broken(Problem { columns: at..line.len(), error: DecodeError::UnclosedComment })
        }
        Some(length) if line.get(inside + length) == Some(&b'(') => {
            let column = inside + length;
            Token::Broken(Problem {
                columns: column..column + 1,
                error: DecodeError::NestedComment,
            })
        }
        Some(length) => Token::Comment { end: inside + length + 1 },
    }
}

/// The word whose letter is at `at`.
#[inline]
fn word(line: &[u8], at: usize, byte: u8, variables: &Variables) -> Token {
    let letter = char::from(byte.to_ascii_uppercase());
    let after = rest(line, at + 1);
    if after.first() == Some(&b'$') {
        return variable(line, at, byte, variables);
    }
    let length = after
        .iter()
        .take_while(|byte| matches!(byte, b'0'..=b'9' | b'.' | b',' | b'+' | b'-'))
        .count();
    let columns = at..at + 1 + length;
    let Some(digits) = after.get(..length).filter(|digits| !digits.is_empty()) else {
        return Token::Broken(Problem { columns, error: DecodeError::MissingNumber(letter) });
    };
    let Some(value) = number::parse(digits) else {
        let error = if digits.contains(&b',') {
            DecodeError::DecimalComma(letter)
        } else {
            DecodeError::InvalidNumber(letter)
        };
        return Token::Useless(Problem { columns, error });
    };
    checked(byte, value, columns, false)
}

/// A word with its number, if the letter exists and takes it.
#[inline]
fn checked(byte: u8, value: f64, columns: Range<usize>, named: bool) -> Token {
    let letter = match Letter::from_byte(byte) {
        Ok(letter) => letter,
        Err(error) => return Token::Useless(Problem { columns, error }),
    };
    match letter.check(value) {
        Some(error) => Token::Useless(Problem { columns, error }),
        None => Token::Word(Word { letter, value, columns, named }),
    }
}

/// The word at `at` with a variable for its number. O may name what is not a number.
fn variable(line: &[u8], at: usize, byte: u8, variables: &Variables) -> Token {
    let begin = at + 2;
    let Some(length) = rest(line, begin).iter().position(|byte| *byte == b'$') else {
        return Token::Broken(Problem {
            columns: at + 1..begin,
            error: DecodeError::UnexpectedCharacter('$'),
        });
    };
    let name = begin..begin + length;
    let columns = at..name.end + 1;
    let text = String::from_utf8_lossy(line.get(name.clone()).unwrap_or_default());
    match variables.get(text.trim()) {
        Some(value) => checked(byte, value, columns, true),
        // Not a number: the words that need one report it.
        None if byte.eq_ignore_ascii_case(&b'O') => {
            Token::Word(Word { letter: Letter::O, value: f64::NAN, columns, named: true })
        }
        None => {
            let error = DecodeError::UnknownVariable(text.trim().to_owned());
            Token::Useless(Problem { columns, error })
        }
    }
}

/// The number of the block that begins at byte `at` of `line`, comments before it left out.
pub(super) fn block_number(line: &[u8], mut at: usize) -> Option<u32> {
    loop {
        match *line.get(at)? {
            b' ' | b'\t' => at += 1,
            b'(' => match comment(line, at) {
                Token::Comment { end } => at = end,
                _ => return None,
            },
            b'N' | b'n' => {
                let after = rest(line, at + 1);
                let length = after
                    .iter()
                    .take_while(|byte| matches!(byte, b'0'..=b'9' | b'.' | b',' | b'+' | b'-'))
                    .count();
                let value = number::parse(after.get(..length)?)?;
                return Letter::N.check(value).is_none().then(|| block::block_number(value));
            }
            _ => return None,
        }
    }
}

/// The character at `at` does not begin a word.
fn unexpected(line: &[u8], at: usize, byte: u8) -> Token {
    // No character is longer than four bytes.
    let bytes = line.get(at..line.len().min(at + 4)).unwrap_or_default();
    let character = bytes.utf8_chunks().next().and_then(|chunk| chunk.valid().chars().next());
    let (length, error) = match character {
        Some(character) => (character.len_utf8(), DecodeError::UnexpectedCharacter(character)),
        None => (1, DecodeError::UnexpectedByte(byte)),
    };
    Token::Broken(Problem { columns: at..at + length, error })
}
