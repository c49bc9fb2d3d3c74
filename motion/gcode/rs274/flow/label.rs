//! Reading of a line of flow control: label, keyword and values.

use super::FlowError;
use crate::rs274::error::Problem;
use crate::rs274::lexer::Lexer;
use crate::rs274::parameters::{LOCAL, Locals};
use std::fmt;
use std::sync::Arc;

/// Number or name behind O.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(in crate::rs274) struct Label(Arc<str>);

impl Label {
    pub(in crate::rs274) fn of_number(number: i64) -> Self {
        Self(number.to_string().into())
    }

    pub(in crate::rs274) fn text(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Word behind a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::rs274) enum Keyword {
    Sub,
    EndSub,
    Return,
    Call,
    Do,
    While,
    EndWhile,
    Repeat,
    EndRepeat,
    If,
    ElseIf,
    Else,
    EndIf,
    Break,
    Continue,
    /// Nothing: the number of a program, or of a subroutine that M98 calls.
    Program,
}

/// Keywords by their text; a longer one before its beginning.
const KEYWORDS: [(&str, Keyword); 15] = [
    ("sub", Keyword::Sub),
    ("endsub", Keyword::EndSub),
    ("return", Keyword::Return),
    ("call", Keyword::Call),
    ("do", Keyword::Do),
    ("while", Keyword::While),
    ("endwhile", Keyword::EndWhile),
    ("repeat", Keyword::Repeat),
    ("endrepeat", Keyword::EndRepeat),
    ("if", Keyword::If),
    ("elseif", Keyword::ElseIf),
    ("else", Keyword::Else),
    ("endif", Keyword::EndIf),
    ("break", Keyword::Break),
    ("continue", Keyword::Continue),
];

impl Keyword {
    pub(super) fn name(self) -> &'static str {
        KEYWORDS.iter().find(|(_, keyword)| *keyword == self).map_or("O", |(name, _)| name)
    }
}

/// Meaning of a line of flow control, its values computed.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::rs274) struct Statement {
    pub(in crate::rs274) label: Label,
    pub(in crate::rs274) keyword: Keyword,
    /// Condition, repetitions or value of the subroutine.
    pub(super) value: Option<f64>,
    /// Arguments of a call.
    pub(super) arguments: Option<Locals>,
}

impl Statement {
    /// A line without values, or with a condition that does not matter.
    pub(in crate::rs274) fn untested(label: Label, keyword: Keyword) -> Self {
        Self { label, keyword, value: None, arguments: None }
    }
}

/// Statements of Fanuc's macro language, which of these bytes follows, and how to write them.
const MACROS: [(&str, (&[u8], &str)); 5] = [
    ("IF", (b"[", "`O100 if [...]` before what depends on it, and `O100 endif` behind")),
    ("WHILE", (b"[", "`O100 while [...]`, and `O100 endwhile` in place of its END")),
    (
        "GOTO",
        (
            b"0123456789#[",
            "`O100 if [...]` and `O100 endif` skip lines, `O100 while [...]` and `O100 endwhile` repeat them",
        ),
    ),
    ("DO", (b"0123456789", "`O100 while [1]`, and `O100 endwhile` in place of its END")),
    ("END", (b"0123456789", "`O100 endwhile`")),
];

impl Lexer<'_> {
    /// The word of the statement of Fanuc's macro language that begins here, and its rewrite, if there is one.
    pub(in crate::rs274) fn macro_statement(&self) -> Option<(&'static str, &'static str)> {
        let (&(word, (follows, rewrite)), end) = self.one_of(&MACROS)?;
        let next = Lexer::new(self.line, end, self.state).peek()?;
        follows.contains(&next).then_some((word, rewrite))
    }

    /// The label that begins here with O, and the keyword behind it; their values are not read.
    pub(in crate::rs274) fn label(&mut self) -> Result<(Label, Keyword), Problem> {
        let start = self.at;
        self.at += 1;
        let label = if self.peek() == Some(b'<') {
            Label(String::from_utf8_lossy(&self.name()?).into())
        } else {
            Label::of_number(self.whole()?)
        };
        if matches!(self.peek(), None | Some(b'(' | b';')) {
            return Ok((label, Keyword::Program));
        }
        let Some((&(_, keyword), end)) = self.one_of(&KEYWORDS) else {
            return Err(self.since(start, FlowError::UnknownKeyword));
        };
        self.at = end;
        Ok((label, keyword))
    }

    /// Values behind a keyword.
    pub(in crate::rs274) fn statement(
        &mut self,
        label: Label,
        keyword: Keyword,
    ) -> Result<Statement, Problem> {
        use Keyword::{Call, ElseIf, EndSub, If, Repeat, Return, While};
        let start = self.at;
        let mut statement = Statement::untested(label, keyword);
        match keyword {
            While | Repeat | If | ElseIf | EndSub | Return if self.peek() == Some(b'[') => {
                statement.value = Some(self.expression()?);
            }
            While | Repeat | If | ElseIf => {
                return Err(self.since(start, FlowError::MissingValue(keyword.name())));
            }
            Call => statement.arguments = Some(self.arguments()?),
            _ => {}
        }
        self.only_comments()?;
        Ok(statement)
    }

    /// Arguments of a call, with comments between them.
    fn arguments(&mut self) -> Result<Locals, Problem> {
        let mut values = Box::new([0.0; LOCAL]);
        let mut slots = values.iter_mut();
        while let Some(next @ (b'[' | b'(')) = self.peek() {
            let start = self.at;
            if next == b'(' {
                self.comment()?;
                continue;
            }
            let argument = self.expression()?;
            let too_many = || self.since(start, FlowError::TooManyArguments);
            *slots.next().ok_or_else(too_many)? = argument;
        }
        Ok(values)
    }
}
