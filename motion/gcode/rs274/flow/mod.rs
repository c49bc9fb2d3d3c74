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

mod error;
mod label;

use super::parameters::Locals;
use super::source::Spot;
use Keyword::{
    Break, Call, Continue, Do, Else, ElseIf, EndIf, EndRepeat, EndSub, EndWhile, If, Program,
    Repeat, Return, Sub, While,
};
use std::collections::HashMap;

pub use error::FlowError;
pub(super) use label::{Keyword, Label, Statement};

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

/// Search for the line that goes on.
#[derive(Clone, Debug)]
struct Search {
    label: Label,
    /// Keyword that ends it. `endif` includes the other branches of the condition. `sub` and a number find each other,
    /// which is an error of style.
    until: Keyword,
    /// Line that began it.
    from: u32,
}

/// An open loop or condition.
#[derive(Clone, Debug)]
struct Open {
    label: Label,
    kind: Keyword,
    /// The line that opens it.
    at: Spot,
    /// Repetitions that are left, or 1 if a branch has been executed.
    count: u64,
}

/// A subroutine that has been called and has not ended.
#[derive(Debug)]
struct Called {
    sub: Label,
    /// `sub`, or a number.
    style: Keyword,
    back: Spot,
    saved: Option<Locals>,
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
    subs: HashMap<Label, (Spot, Keyword)>,
    /// Lines of the labels of loops and conditions, by subroutine.
    labels: HashMap<(Option<Label>, Label), Spot>,
    calls: Vec<Called>,
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
        arguments: Option<Locals>,
        /// Its name, if it must be searched for: in files, then from the next line on.
        unknown: Option<Label>,
    },
    /// A subroutine begins anew.
    Again,
    /// A subroutine ends.
    Leave {
        /// Parameters of the caller.
        saved: Option<Locals>,
        /// Value behind `return` or `endsub`.
        value: Option<f64>,
    },
}

impl Flow {
    pub(super) fn new(limits: FlowLimits) -> Self {
        Self { limits, ..Self::default() }
    }

    /// True if lines that are read now may be read again.
    pub(super) fn keeps(&self) -> bool {
        let loops = self.open.iter().any(|open| open.kind != If);
        let sought = self.search.as_ref().is_some_and(|search| search.until != EndIf);
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
            Some(search) if (search.until, keyword) == (EndSub, Sub) => {
                Err(FlowError::Nested(search.from))
            }
            _ => Ok(()),
        }
    }

    /// Line of the program whose call is open.
    pub(super) fn main_line(&self) -> u32 {
        self.calls.first().map_or(self.next.line, |call| call.back.line)
    }

    /// True if a line with this label and keyword ends the search.
    pub(super) fn finds(&self, label: &Label, keyword: Keyword) -> bool {
        let Some(search) = &self.search else { return true };
        let fits = match search.until {
            EndIf => matches!(keyword, ElseIf | Else | EndIf),
            Sub | Program => matches!(keyword, Sub | Program),
            until => keyword == until,
        };
        fits && search.label == *label
    }

    /// A line that needs no value: a branch of a condition of which one has been executed, and the end of a subroutine
    /// that is only defined.
    pub(super) fn is_decided(&self, label: &Label, keyword: Keyword) -> bool {
        let defines = self.search.as_ref().is_some_and(|search| search.until == EndSub);
        if keyword == EndSub && defines {
            return true;
        }
        let open = self.open.iter().rfind(|open| open.label == *label);
        keyword == ElseIf && open.is_some_and(|open| open.count > 0)
    }

    /// Error of a file that ends here, if it must not, with the line to point at, and what follows from it.
    pub(super) fn at_end(&mut self) -> Option<(FlowError, u32, Effect)> {
        let not_closed = |keyword, label: &Label| FlowError::NotClosed(keyword, label.to_string());
        let (error, line) = match (self.search.take(), self.calls.last()) {
            (Some(Search { label, until: Sub | Program, from }), _) => {
                (FlowError::NotFound(label.to_string()), from)
            }
            (Some(Search { label, until, from }), _) => (not_closed(until.name(), &label), from),
            (None, Some(call)) => {
                let keyword = if call.style == Sub { EndSub.name() } else { "M99" };
                (not_closed(keyword, &call.sub), call.back.line)
            }
            (None, None) => return None,
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
    pub(super) fn execute(&mut self, statement: Statement, at: Spot) -> Result<Effect, FlowError> {
        let Statement { label, keyword, value, arguments } = statement;
        let is_true = value.is_some_and(|value| value != 0.0);
        match keyword {
            Sub | Program => return self.define(label, keyword, at),
            Call => return self.call(label, Sub, arguments, 1),
            EndSub | EndRepeat | EndWhile if self.search.take().is_some() => {}
            EndSub | Return => return self.leave(keyword.name(), Sub, value),
            Do => self.enter(label, keyword, at, 0),
            While => self.while_line(label, at, is_true)?,
            EndWhile => {
                let begin = self.close(&label, keyword, &[While])?.at;
                self.jump(begin)?;
            }
            Repeat => {
                self.once(&label, at)?;
                match repetitions(value.unwrap_or_default().round())? {
                    0 => self.seek(label, EndRepeat, at),
                    count => self.enter(label, keyword, at, count),
                }
            }
            EndRepeat => {
                let mut open = self.close(&label, keyword, &[Repeat])?;
                open.count -= 1;
                if open.count > 0 {
                    self.repeat(open)?;
                }
            }
            If => {
                self.once(&label, at)?;
                self.enter(label.clone(), keyword, at, u64::from(is_true));
                if !is_true {
                    self.seek(label, EndIf, at);
                }
            }
            ElseIf | Else => {
                self.search = None;
                let mut open = self.close(&label, keyword, &[If])?;
                let taken = open.count == 0 && (is_true || keyword == Else);
                open.count |= u64::from(taken);
                self.open.push(open);
                if !taken {
                    self.seek(label, EndIf, at);
                }
            }
            EndIf => {
                self.search = None;
                self.close(&label, keyword, &[If])?;
            }
            Break | Continue => {
                let open = self.close(&label, keyword, &[While, Do])?;
                let end = if open.kind == Do { While } else { EndWhile };
                match (keyword, open.kind) {
                    (Continue, While) => return self.jump(open.at).map(|()| Effect::None),
                    (Continue, _) => self.open.push(open),
                    _ => {}
                }
                self.seek(label, end, at);
            }
        }
        Ok(Effect::None)
    }

    /// Stores what the caller of the subroutine has saved.
    pub(super) fn save(&mut self, saved: Option<Locals>) {
        if let Some(call) = self.calls.last_mut() {
            call.saved = saved;
        }
    }

    fn seek(&mut self, label: Label, until: Keyword, at: Spot) {
        self.search = Some(Search { label, until, from: at.behind().line });
    }

    /// Opens a loop or condition, unless it is open already.
    fn enter(&mut self, label: Label, kind: Keyword, at: Spot, count: u64) {
        if self.find(&label, &[kind]).is_none() {
            self.open.push(Open { label, kind, at, count });
        }
    }

    /// The innermost loop or condition of `label` that is open in the current subroutine.
    fn find(&self, label: &Label, kinds: &[Keyword]) -> Option<usize> {
        let first = self.calls.last().map_or(0, |call| call.opened);
        let fits = |open: &Open| open.label == *label && kinds.contains(&open.kind);
        self.open.iter().skip(first).rposition(fits).map(|found| first + found)
    }

    /// Closes the loop or condition of `label`, with what is open within it.
    fn close(
        &mut self,
        label: &Label,
        keyword: Keyword,
        kinds: &[Keyword],
    ) -> Result<Open, FlowError> {
        let found = self.find(label, kinds).and_then(|found| self.open.drain(found..).next());
        let wanted = if let [kind] = kinds { kind.name() } else { "while or do" };
        found.ok_or_else(|| FlowError::NotOpen(keyword.name(), wanted, label.to_string()))
    }

    fn jump(&mut self, to: Spot) -> Result<(), FlowError> {
        self.jumps += 1;
        if self.jumps > self.limits.jumps {
            return Err(FlowError::Endless(self.limits.jumps));
        }
        self.next = to;
        Ok(())
    }

    /// Begins the next pass of a loop.
    fn repeat(&mut self, open: Open) -> Result<(), FlowError> {
        let behind = open.at.behind();
        self.open.push(open);
        self.jump(behind)
    }

    /// Checks that a label is not that of another line of its subroutine.
    fn once(&mut self, label: &Label, at: Spot) -> Result<(), FlowError> {
        let scope = self.calls.last().map(|call| call.sub.clone());
        let first = *self.labels.entry((scope, label.clone())).or_insert(at);
        if first == at {
            return Ok(());
        }
        Err(FlowError::Duplicate(label.to_string(), first.behind().line))
    }

    fn define(&mut self, label: Label, style: Keyword, at: Spot) -> Result<Effect, FlowError> {
        if let Some(search) = self.search.take() {
            if search.until != style {
                return Err(FlowError::Style(label.to_string()));
            }
            self.subs.insert(label, (at, style));
            return Ok(Effect::None);
        }
        // The label may be a value that the arguments have changed.
        let called = self.calls.last().and_then(|call| self.subs.get(&call.sub));
        if style == Program || called.is_some_and(|(begin, _)| *begin == at) {
            return Ok(Effect::None);
        }
        if let Some(call) = self.calls.last() {
            return Err(FlowError::Nested(call.back.line));
        }
        self.seek(label.clone(), EndSub, at);
        if let Some((known, _)) = self.subs.get(&label) {
            return Err(FlowError::Redefined(label.to_string(), known.behind().line));
        }
        self.subs.insert(label, (at, style));
        Ok(Effect::None)
    }

    /// Calls a subroutine `count` times, at least once.
    ///
    /// # Errors
    /// See [`FlowError`].
    pub(super) fn call(
        &mut self,
        sub: Label,
        style: Keyword,
        arguments: Option<Locals>,
        count: u32,
    ) -> Result<Effect, FlowError> {
        if self.calls.len() >= self.limits.depth {
            return Err(FlowError::TooDeep(self.limits.depth));
        }
        let (back, known) = (self.next, self.subs.get(&sub).copied());
        if known.is_some_and(|(_, other)| other != style) {
            return Err(FlowError::Style(sub.to_string()));
        }
        self.jump(known.map_or(back, |(begin, _)| begin))?;
        let unknown = known.is_none().then(|| sub.clone());
        if let Some(label) = unknown.clone() {
            self.search = Some(Search { label, until: style, from: back.line.max(1) });
        }
        let (opened, again) = (self.open.len(), count - 1);
        self.calls.push(Called { sub, style, back, saved: None, opened, again });
        Ok(Effect::Enter { arguments, unknown })
    }

    /// Returns from a subroutine at `keyword`.
    ///
    /// # Errors
    /// See [`FlowError`].
    pub(super) fn leave(
        &mut self,
        keyword: &'static str,
        style: Keyword,
        value: Option<f64>,
    ) -> Result<Effect, FlowError> {
        let Some(call) = self.calls.last_mut() else { return Err(FlowError::Outside(keyword)) };
        if call.style != style {
            return Err(FlowError::Style(call.sub.to_string()));
        }
        self.open.truncate(call.opened);
        if call.again > 0
            && let Some((begin, _)) = self.subs.get(&call.sub).copied()
        {
            call.again -= 1;
            self.jump(begin)?;
            return Ok(Effect::Again);
        }
        let call = self.calls.pop().ok_or(FlowError::Outside(keyword))?;
        self.next = call.back;
        Ok(Effect::Leave { saved: call.saved, value })
    }

    /// The beginning of a loop with its test before, or the end of one with its test behind.
    fn while_line(&mut self, label: Label, at: Spot, is_true: bool) -> Result<(), FlowError> {
        let passed_over = self.search.take().is_some();
        if self.find(&label, &[Do]).is_some() {
            let open = self.close(&label, While, &[Do])?;
            return if is_true { self.repeat(open) } else { Ok(()) };
        }
        if passed_over {
            // The end of a loop that `break` has closed.
            return Ok(());
        }
        self.once(&label, at)?;
        if is_true {
            self.enter(label, While, at, 0);
        } else {
            self.seek(label, EndWhile, at);
        }
        Ok(())
    }
}

/// Number of repetitions.
fn repetitions(value: f64) -> Result<u64, FlowError> {
    if value > 1e15 {
        return Err(FlowError::Repetitions(value));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 if it is less")]
    Ok(value as u64)
}
