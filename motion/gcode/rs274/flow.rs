//! Flow of control: O words, subroutines, M98 and M99.
//!
//! ```text
//! o1 sub … o1 endsub [value]      o1 return [value]      o1 call [1] [2]
//! o2 if [c] … o2 elseif [c] … o2 else … o2 endif
//! o3 while [c] … o3 endwhile      o3 do … o3 while [c]   o3 break   o3 continue
//! o4 repeat [n] … o4 endrepeat
//! O100 … M99                      M98 P100 L3
//! ```
//!
//! Labels are numbers, values or names in `< >`. Those of loops and conditions belong to their subroutine. A subroutine
//! that is called is searched for among those that have been read, then as a file, then in the rest of the program.

use super::error::Problem;
use super::lexer::Lexer;
use super::parameters::LOCAL;
use super::source::Spot;
use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

/// Limits of what a program may repeat, so that an endless one ends with an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlowLimits {
    /// Jumps back and calls of the whole program.
    pub jumps: u64,
    /// Subroutines within each other. LinuxCNC allows 9.
    pub depth: usize,
}

impl Default for FlowLimits {
    fn default() -> Self {
        Self { jumps: 100_000, depth: 9 }
    }
}

/// Error of the flow of control.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FlowError {
    /// Something else than a keyword behind a label.
    #[error(
        "a keyword must follow the label: sub endsub return call if elseif else endif while endwhile do repeat endrepeat break continue"
    )]
    UnknownKeyword,
    /// The keyword needs a value in brackets.
    #[error("{0} needs a value in brackets: [ ]")]
    MissingValue(&'static str),
    /// More arguments than parameters.
    #[error("a subroutine takes at most {LOCAL} arguments")]
    TooManyArguments,
    /// A label for the second time.
    #[error(
        "label {label} is used in line {line} already: a loop or condition needs a label of its own in its subroutine"
    )]
    Duplicate {
        /// The label.
        label: String,
        /// Line of its first use.
        line: u32,
    },
    /// A subroutine for the second time.
    #[error("subroutine {label} is defined in line {line} already")]
    Redefined {
        /// The label.
        label: String,
        /// Line of its definition.
        line: u32,
    },
    /// An end, or a jump, whose loop or condition is not in work.
    #[error("{keyword} without its beginning: no {wanted} with label {label} is open here")]
    NotOpen {
        /// The keyword.
        keyword: &'static str,
        /// The keyword that opens it.
        wanted: &'static str,
        /// The label.
        label: String,
    },
    /// A subroutine within another.
    #[error("a subroutine cannot be defined within another: the one of line {0} is not closed")]
    Nested(u32),
    /// Outside a subroutine.
    #[error("{0} outside of a subroutine")]
    Outside(&'static str),
    /// A subroutine that nobody defines.
    #[error(
        "subroutine {0} is neither defined in this program nor a file {0}.ngc in the folders of subroutines"
    )]
    NotFound(String),
    /// A subroutine of one style that is called or ended in the other.
    #[error(
        "subroutine {0} mixes two styles: sub goes with call and endsub, O and a number go with M98 and M99"
    )]
    Style(String),
    /// The end of the file within a part that is skipped or repeated.
    #[error("the file ends before the {keyword} of label {label} that this line needs")]
    NotClosed {
        /// Keyword that is missing.
        keyword: &'static str,
        /// Label of it.
        label: String,
    },
    /// Loops without end.
    #[error(
        "endless: loops and calls have jumped {0} times, the most that are allowed (--max-jumps)"
    )]
    Endless(u64),
    /// Recursion without end.
    #[error(
        "subroutines call each other {0} times in a row, the most that are allowed (--max-depth)"
    )]
    TooDeep(usize),
    /// The number of repetitions is negative or too large.
    #[error("{} is not a number of repetitions", twin_number::Short(*.0))]
    Repetitions(f64),
    /// M98 without P.
    #[error("M98 needs P, the number of a subroutine")]
    MissingProgram,
    /// M98 or M99 with other words.
    #[error("{0} has no effect next to M98 or M99: write it in a block of its own")]
    Beside(char),
    /// M99 outside of a subroutine: an endless program. A warning.
    #[error("M99 begins the program anew, without end: it is read once")]
    EndlessProgram,
    /// The message (ABORT, ...).
    #[error("the program ends itself: {0}")]
    Abort(String),
    /// The file of a subroutine cannot be read.
    #[error("the file of subroutine {label} cannot be read: {cause}")]
    File {
        /// Name of the subroutine.
        label: String,
        /// Reason of the system.
        cause: String,
    },
}

/// Number or name behind O.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Label(Arc<str>);

impl Label {
    pub(super) fn of_number(number: i64) -> Self {
        Self(number.to_string().into())
    }

    pub(super) fn text(&self) -> &str {
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
pub(super) enum Keyword {
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
    /// Nothing: the number of a program.
    Program,
}

/// Keywords by their text; a longer one before its beginning.
const KEYWORDS: [(&[u8], Keyword); 15] = [
    (b"SUB", Keyword::Sub),
    (b"ENDSUB", Keyword::EndSub),
    (b"RETURN", Keyword::Return),
    (b"CALL", Keyword::Call),
    (b"DO", Keyword::Do),
    (b"WHILE", Keyword::While),
    (b"ENDWHILE", Keyword::EndWhile),
    (b"REPEAT", Keyword::Repeat),
    (b"ENDREPEAT", Keyword::EndRepeat),
    (b"IF", Keyword::If),
    (b"ELSEIF", Keyword::ElseIf),
    (b"ELSE", Keyword::Else),
    (b"ENDIF", Keyword::EndIf),
    (b"BREAK", Keyword::Break),
    (b"CONTINUE", Keyword::Continue),
];

impl Keyword {
    fn name(self) -> &'static str {
        match self {
            Self::Sub => "sub",
            Self::EndSub => "endsub",
            Self::Return => "return",
            Self::Call => "call",
            Self::Do => "do",
            Self::While => "while",
            Self::EndWhile => "endwhile",
            Self::Repeat => "repeat",
            Self::EndRepeat => "endrepeat",
            Self::If => "if",
            Self::ElseIf => "elseif",
            Self::Else => "else",
            Self::EndIf => "endif",
            Self::Break => "break",
            Self::Continue => "continue",
            Self::Program => "O",
        }
    }
}

/// Meaning of a line of flow control, its values computed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Control {
    pub(super) label: Label,
    pub(super) keyword: Keyword,
    /// Condition, repetitions or value of the subroutine.
    value: Option<f64>,
    /// Arguments of a call.
    arguments: Option<Box<[f64; LOCAL]>>,
}

impl Control {
    /// A branch whose condition does not matter.
    pub(super) fn untested(label: Label, keyword: Keyword) -> Self {
        Self { label, keyword, value: None, arguments: None }
    }
}

/// Search for the line that goes on.
#[derive(Clone, Debug)]
struct Search {
    label: Label,
    until: Until,
    /// Line that began it.
    from: u32,
}

/// Keywords that end a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Until {
    /// Next branch of a condition.
    Branch,
    EndWhile,
    EndRepeat,
    /// Test at the end of a loop that begins with `do`; it counts unless the loop is broken off.
    DoTest {
        /// By `break`.
        broken: bool,
    },
    /// Definition of the subroutine that is called.
    Definition(Style),
    /// End of the subroutine that is defined.
    EndSub,
}

/// Kind of a subroutine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Style {
    /// `sub` to `endsub`.
    Named,
    /// A number to M99.
    Numbered,
}

/// A loop or condition in work.
#[derive(Clone, Debug)]
struct Open {
    label: Label,
    kind: Keyword,
    /// The line that opens it.
    at: Spot,
    /// Repetitions that are left, or 1 if a branch has been executed.
    count: u64,
}

/// A subroutine in work.
#[derive(Debug)]
struct Call {
    sub: Label,
    style: Style,
    back: Spot,
    saved: Option<Box<[f64; LOCAL]>>,
    /// Loops and conditions that were open when it was called.
    opened: usize,
    /// Calls that are left (L).
    again: u32,
}

/// Flow of control of a program.
#[derive(Debug, Default)]
pub(super) struct Flow {
    /// The next line.
    pub(super) next: Spot,
    limits: FlowLimits,
    jumps: u64,
    subs: HashMap<Label, (Spot, Style)>,
    /// Lines of the labels of loops and conditions, by subroutine.
    labels: HashMap<(Option<Label>, Label), Spot>,
    calls: Vec<Call>,
    open: Vec<Open>,
    search: Option<Search>,
}

/// Consequence of a line of flow control for the rest of the interpreter.
#[derive(Debug)]
pub(super) enum Effect {
    /// None.
    None,
    /// A subroutine begins.
    Enter {
        /// Its parameters, unless they are those of the caller.
        arguments: Option<Box<[f64; LOCAL]>>,
        /// Its name, if it must be searched for: in files, then from the next line on.
        unknown: Option<Label>,
    },
    /// A subroutine begins anew.
    Again,
    /// A subroutine ends.
    Leave {
        /// Parameters of the caller.
        saved: Option<Box<[f64; LOCAL]>>,
        /// Value behind `return` or `endsub`.
        value: Option<f64>,
    },
}

impl Lexer<'_> {
    /// The label that begins here with O, and the keyword behind it; their values are not read.
    pub(super) fn label(&mut self) -> Result<(Label, Keyword), Problem> {
        let start = self.at;
        self.at += 1;
        let label = if self.peek() == Some(b'<') {
            Label(String::from_utf8_lossy(&self.name()?).into())
        } else {
            Label::of_number(self.whole()?)
        };
        match self.peek() {
            None | Some(b'(' | b';') => return Ok((label, Keyword::Program)),
            Some(_) => {}
        }
        match self.one_of(&KEYWORDS) {
            Some((keyword, end)) => {
                self.at = end;
                Ok((label, keyword))
            }
            None => Err(self.since(start, FlowError::UnknownKeyword)),
        }
    }

    /// Values behind a keyword.
    pub(super) fn control(&mut self, label: Label, keyword: Keyword) -> Result<Control, Problem> {
        let start = self.at;
        let (mut value, mut arguments) = (None, None);
        match keyword {
            Keyword::While | Keyword::Repeat | Keyword::If | Keyword::ElseIf => {
                if self.peek() != Some(b'[') {
                    return Err(self.since(start, FlowError::MissingValue(keyword.name())));
                }
                value = Some(self.expression()?);
            }
            Keyword::EndSub | Keyword::Return if self.peek() == Some(b'[') => {
                value = Some(self.expression()?);
            }
            Keyword::Call => {
                let mut values = Box::new([0.0; LOCAL]);
                let mut slots = values.iter_mut();
                while let Some(next @ (b'[' | b'(')) = self.peek() {
                    let at = self.at;
                    if next == b'(' {
                        self.comment()?;
                        continue;
                    }
                    let argument = self.expression()?;
                    let Some(slot) = slots.next() else {
                        return Err(self.since(at, FlowError::TooManyArguments));
                    };
                    *slot = argument;
                }
                arguments = Some(values);
            }
            _ => {}
        }
        self.only_comments()?;
        Ok(Control { label, keyword, value, arguments })
    }
}

impl Flow {
    pub(super) fn new(limits: FlowLimits) -> Self {
        Self { limits, ..Self::default() }
    }

    /// True if lines that are read now may be read again.
    pub(super) fn keeps(&self) -> bool {
        let loops = self.open.iter().any(|open| open.kind != Keyword::If);
        let sought = self.search.as_ref().is_some_and(|search| search.until != Until::Branch);
        loops || sought || !self.subs.is_empty() || !self.calls.is_empty()
    }

    /// True while lines are passed over.
    pub(super) fn searches(&self) -> bool {
        self.search.is_some()
    }

    /// Checks that no subroutine is defined within the one that is passed over.
    ///
    /// # Errors
    /// [`FlowError::Nested`].
    pub(super) fn check_nested(&self, keyword: Keyword) -> Result<(), FlowError> {
        match &self.search {
            Some(search) if search.until == Until::EndSub && keyword == Keyword::Sub => {
                Err(FlowError::Nested(search.from))
            }
            _ => Ok(()),
        }
    }

    /// Line of the program whose call is in work.
    pub(super) fn main_line(&self) -> u32 {
        self.calls.first().map_or(self.next.line, |call| call.back.line)
    }

    /// True in a subroutine.
    pub(super) fn is_in_subroutine(&self) -> bool {
        !self.calls.is_empty()
    }

    /// True if a line with this label and keyword ends the search.
    pub(super) fn finds(&self, label: &Label, keyword: Keyword) -> bool {
        let Some(search) = &self.search else { return true };
        let fits = match search.until {
            Until::Branch => {
                matches!(keyword, Keyword::ElseIf | Keyword::Else | Keyword::EndIf)
            }
            Until::EndWhile => keyword == Keyword::EndWhile,
            Until::EndRepeat => keyword == Keyword::EndRepeat,
            Until::DoTest { .. } => keyword == Keyword::While,
            Until::Definition(_) => matches!(keyword, Keyword::Sub | Keyword::Program),
            Until::EndSub => keyword == Keyword::EndSub,
        };
        fits && search.label == *label
    }

    /// The branch of a condition that needs no test: one has been executed.
    pub(super) fn is_decided(&self, label: &Label, keyword: Keyword) -> bool {
        keyword == Keyword::ElseIf
            && self
                .open
                .iter()
                .rev()
                .find(|open| open.label == *label)
                .is_some_and(|it| it.count > 0)
    }

    /// Error of a file that ends here, if it must not, with the line to point at, and what follows from it.
    pub(super) fn at_end(&mut self) -> Option<(FlowError, u32, Effect)> {
        let not_closed = |keyword: &'static str, label: &Label| {
            let label = label.to_string();
            FlowError::NotClosed { keyword, label }
        };
        let (error, line) = if let Some(Search { label, until, from }) = self.search.take() {
            let error = match until {
                Until::Definition(_) => FlowError::NotFound(label.to_string()),
                Until::Branch => not_closed("endif", &label),
                Until::EndWhile => not_closed("endwhile", &label),
                Until::EndRepeat => not_closed("endrepeat", &label),
                Until::DoTest { .. } => not_closed("while", &label),
                Until::EndSub => not_closed("endsub", &label),
            };
            (error, from)
        } else {
            let call = self.calls.last()?;
            let keyword = if call.style == Style::Named { "endsub" } else { "M99" };
            (not_closed(keyword, &call.sub), call.back.line)
        };
        // After the call, as far as there is one.
        let effect = self.calls.pop().map_or(Effect::None, |call| {
            self.open.truncate(call.opened);
            self.next = call.back;
            Effect::Leave { saved: call.saved, value: None }
        });
        Some((error, line, effect))
    }

    /// Carries out the line before [`Flow::next`].
    ///
    /// # Errors
    /// [`FlowError`]; the line has no effect then.
    pub(super) fn execute(&mut self, control: Control, at: Spot) -> Result<Effect, FlowError> {
        let Control { label, keyword, value, arguments } = control;
        let is_true = value.is_some_and(|value| value != 0.0);
        match keyword {
            Keyword::Sub | Keyword::Program => return self.define(label, keyword, at),
            Keyword::Call => return self.call(label, Style::Named, arguments, 1),
            Keyword::EndSub if self.search.is_some() => self.search = None,
            Keyword::EndSub | Keyword::Return => {
                return self.leave(keyword.name(), Style::Named, value);
            }
            Keyword::Do => self.enter(label, keyword, at, 0),
            Keyword::Repeat => {
                self.once(&label, at)?;
                let count = repetitions(value.unwrap_or_default().round())?;
                if count == 0 {
                    self.seek(label, Until::EndRepeat, at);
                } else {
                    self.enter(label, keyword, at, count);
                }
            }
            Keyword::EndRepeat | Keyword::EndWhile if self.search.take().is_some() => {}
            Keyword::EndRepeat => self.end_repeat(&label)?,
            Keyword::While => self.while_line(label, at, is_true)?,
            Keyword::EndWhile => {
                let back = self.close(&label, keyword, Keyword::While)?.at;
                self.jump(back)?;
            }
            Keyword::If => {
                self.once(&label, at)?;
                self.enter(label.clone(), keyword, at, u64::from(is_true));
                if !is_true {
                    self.seek(label, Until::Branch, at);
                }
            }
            Keyword::ElseIf | Keyword::Else => self.branch(label, keyword, at, is_true)?,
            Keyword::EndIf => {
                self.search = None;
                self.close(&label, keyword, Keyword::If)?;
            }
            Keyword::Break | Keyword::Continue => self.leave_pass(label, keyword, at)?,
        }
        Ok(Effect::None)
    }

    /// Calls the subroutine of M98.
    ///
    /// # Errors
    /// See [`FlowError`].
    pub(super) fn call_numbered(&mut self, number: i64, count: u32) -> Result<Effect, FlowError> {
        if count == 0 {
            return Ok(Effect::None);
        }
        self.call(Label::of_number(number), Style::Numbered, None, count)
    }

    /// Returns from the subroutine at M99.
    ///
    /// # Errors
    /// See [`FlowError`].
    pub(super) fn return_numbered(&mut self) -> Result<Effect, FlowError> {
        self.leave("M99", Style::Numbered, None)
    }

    /// Goes on in the file of the subroutine that was called.
    pub(super) fn go_to_file(&mut self, file: usize) {
        self.next = Spot { file: Some(file), line: 0 };
    }

    /// Stores what the caller of the subroutine has saved.
    pub(super) fn save(&mut self, saved: Option<Box<[f64; LOCAL]>>) {
        if let Some(call) = self.calls.last_mut() {
            call.saved = saved;
        }
    }

    fn seek(&mut self, label: Label, until: Until, at: Spot) {
        self.search = Some(Search { label, until, from: at.line + 1 });
    }

    fn enter(&mut self, label: Label, kind: Keyword, at: Spot, count: u64) {
        let first = self.first_open();
        let known =
            self.open.iter().skip(first).any(|open| open.label == label && open.kind == kind);
        if !known {
            self.open.push(Open { label, kind, at, count });
        }
    }

    /// Number of loops and conditions that belong to callers.
    fn first_open(&self) -> usize {
        self.calls.last().map_or(0, |call| call.opened)
    }

    fn jump(&mut self, to: Spot) -> Result<(), FlowError> {
        self.jumps += 1;
        if self.jumps > self.limits.jumps {
            return Err(FlowError::Endless(self.limits.jumps));
        }
        self.next = to;
        Ok(())
    }

    /// Checks that a label is not that of another line of its subroutine.
    fn once(&mut self, label: &Label, at: Spot) -> Result<(), FlowError> {
        let scope = self.calls.last().map(|call| call.sub.clone());
        let first = *self.labels.entry((scope, label.clone())).or_insert(at);
        if first == at {
            return Ok(());
        }
        Err(FlowError::Duplicate { label: label.to_string(), line: first.line + 1 })
    }

    /// Closes the loop or condition of `label`, with what is open within it.
    fn close(&mut self, label: &Label, keyword: Keyword, kind: Keyword) -> Result<Open, FlowError> {
        let first = self.first_open();
        let found =
            self.open.iter().skip(first).rposition(|it| it.label == *label && it.kind == kind);
        let Some(found) = found else {
            return Err(FlowError::NotOpen {
                keyword: keyword.name(),
                wanted: kind.name(),
                label: label.to_string(),
            });
        };
        let mut inner = self.open.drain(first + found..);
        let open = inner.next();
        drop(inner);
        open.ok_or(FlowError::UnknownKeyword)
    }

    fn define(&mut self, label: Label, keyword: Keyword, at: Spot) -> Result<Effect, FlowError> {
        let style = if keyword == Keyword::Sub { Style::Named } else { Style::Numbered };
        if let Some(search) = self.search.take() {
            if search.until != Until::Definition(style) {
                return Err(FlowError::Style(label.to_string()));
            }
            self.subs.insert(label, (at, style));
            return Ok(Effect::None);
        }
        // The label may be a value that the arguments have changed.
        let called = self.calls.last().and_then(|call| self.subs.get(&call.sub));
        let is_called = called.is_some_and(|(begin, _)| *begin == at);
        if keyword == Keyword::Program || is_called {
            return Ok(Effect::None);
        }
        if let Some(call) = self.calls.last() {
            return Err(FlowError::Nested(call.back.line));
        }
        if let Some((known, _)) = self.subs.get(&label) {
            let line = known.line + 1;
            self.seek(label.clone(), Until::EndSub, at);
            return Err(FlowError::Redefined { label: label.to_string(), line });
        }
        self.subs.insert(label.clone(), (at, style));
        self.seek(label, Until::EndSub, at);
        Ok(Effect::None)
    }

    fn call(
        &mut self,
        sub: Label,
        style: Style,
        arguments: Option<Box<[f64; LOCAL]>>,
        count: u32,
    ) -> Result<Effect, FlowError> {
        if self.calls.len() >= self.limits.depth {
            return Err(FlowError::TooDeep(self.limits.depth));
        }
        let back = self.next;
        let known = self.subs.get(&sub).copied();
        if known.is_some_and(|(_, other)| other != style) {
            return Err(FlowError::Style(sub.to_string()));
        }
        self.jump(known.map_or(back, |(at, _)| at))?;
        let opened = self.open.len();
        self.calls.push(Call {
            sub: sub.clone(),
            style,
            back,
            saved: None,
            opened,
            again: count - 1,
        });
        let unknown = known.is_none().then_some(sub);
        if let Some(sub) = &unknown {
            let from = Spot { line: back.line.saturating_sub(1), ..back };
            self.seek(sub.clone(), Until::Definition(style), from);
        }
        Ok(Effect::Enter { arguments, unknown })
    }

    fn leave(
        &mut self,
        keyword: &'static str,
        style: Style,
        value: Option<f64>,
    ) -> Result<Effect, FlowError> {
        let Some(call) = self.calls.last_mut() else { return Err(FlowError::Outside(keyword)) };
        if call.style != style {
            return Err(FlowError::Style(call.sub.to_string()));
        }
        let (opened, saved) = (call.opened, call.saved.take());
        self.open.truncate(opened);
        if call.again > 0 {
            call.again -= 1;
            let begin = self.subs.get(&call.sub).map(|(at, _)| *at);
            if let Some(begin) = begin {
                self.jump(begin)?;
                return Ok(Effect::Again);
            }
        }
        if let Some(call) = self.calls.pop() {
            self.next = call.back;
        }
        Ok(Effect::Leave { saved, value })
    }

    fn end_repeat(&mut self, label: &Label) -> Result<(), FlowError> {
        let mut open = self.close(label, Keyword::EndRepeat, Keyword::Repeat)?;
        open.count -= 1;
        if open.count > 0 {
            let behind = Spot { line: open.at.line + 1, ..open.at };
            self.open.push(open);
            self.jump(behind)?;
        }
        Ok(())
    }

    /// The beginning of a loop with its test before, or the end of one with its test behind.
    fn while_line(&mut self, label: Label, at: Spot, is_true: bool) -> Result<(), FlowError> {
        if self.search.take().is_some_and(|it| it.until == Until::DoTest { broken: true }) {
            return Ok(());
        }
        let first = self.first_open();
        let ends = |open: &Open| open.label == label && open.kind == Keyword::Do;
        if self.open.iter().skip(first).any(ends) {
            let open = self.close(&label, Keyword::While, Keyword::Do)?;
            if is_true {
                let behind = Spot { line: open.at.line + 1, ..open.at };
                self.open.push(open);
                self.jump(behind)?;
            }
            return Ok(());
        }
        self.once(&label, at)?;
        if is_true {
            self.enter(label, Keyword::While, at, 0);
        } else {
            self.seek(label, Until::EndWhile, at);
        }
        Ok(())
    }

    fn branch(
        &mut self,
        label: Label,
        keyword: Keyword,
        at: Spot,
        is_true: bool,
    ) -> Result<(), FlowError> {
        self.search = None;
        let mut open = self.close(&label, keyword, Keyword::If)?;
        let taken = open.count == 0 && (is_true || keyword == Keyword::Else);
        open.count |= u64::from(taken);
        self.open.push(open);
        if !taken {
            self.seek(label, Until::Branch, at);
        }
        Ok(())
    }

    /// `break` and `continue`.
    fn leave_pass(&mut self, label: Label, keyword: Keyword, at: Spot) -> Result<(), FlowError> {
        let first = self.first_open();
        let is_loop = |open: &Open| matches!(open.kind, Keyword::While | Keyword::Do);
        let found = self.open.iter().skip(first).rfind(|open| open.label == label && is_loop(open));
        let Some(kind) = found.map(|open| open.kind) else {
            return Err(FlowError::NotOpen {
                keyword: keyword.name(),
                wanted: "while or do",
                label: label.to_string(),
            });
        };
        let open = self.close(&label, keyword, kind)?;
        match (keyword, kind) {
            (Keyword::Continue, Keyword::While) => self.jump(open.at),
            (Keyword::Continue, _) => {
                self.open.push(open);
                self.seek(label, Until::DoTest { broken: false }, at);
                Ok(())
            }
            (_, Keyword::While) => {
                self.seek(label, Until::EndWhile, at);
                Ok(())
            }
            _ => {
                self.seek(label, Until::DoTest { broken: true }, at);
                Ok(())
            }
        }
    }
}

/// Number of repetitions.
fn repetitions(value: f64) -> Result<u64, FlowError> {
    if value < 1.0 {
        return Ok(0);
    }
    if value > 1e15 {
        return Err(FlowError::Repetitions(value));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
    Ok(value as u64)
}
