//! Decoder: reads a program line by line.

use super::block::{Block, Letter, Letters};
use super::control::{self, Control};
use super::error::{DecodeError, Failure, Item, Problem};
use super::flow::{Effect, Flow, FlowError, Keyword, Label, Statement};
use super::leniency::Leniency;
use super::lexer::{self, Lexer};
use super::options::{DecoderOptions, PathMode, Position};
use super::output::Output;
use super::source::{Reading, Source, Spot};
use super::state::State;
use crate::decode::{Rule, TextError};
use std::io::{self, BufRead};
use std::iter::FusedIterator;
use twin_path::Place;

/// The longest line that is read, its end included, bytes.
pub const MAX_LINE_BYTES: usize = 1 << 16;

/// The same where LinuxCNC is obeyed.
const STRICT_LINE_BYTES: usize = 253;

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Decodes a program as an iterator over its path elements.
///
/// Whatever the input, it ends with the input, with M2, M30 or the second `%`; text behind them is not read. A
/// block with an error gives an error (or several); the path goes on with the next block where the erroneous one was to
/// lead as far as that is known, with a jump in between. So all errors of a program are found in one run.
#[derive(Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each has a name of its own")]
pub struct Decoder<R> {
    pub(super) source: Source<R>,
    pub(super) flow: Flow,
    skip_suppressed_blocks: bool,
    line: Vec<u8>,
    program_number: Option<u32>,
    /// There was a `%`, or anything else but comments and blanks.
    begun: bool,
    /// It was a `%`.
    percent: bool,
    /// There was anything but comments, blanks, a `%` and an O word.
    under_way: bool,
    pub(super) ended: bool,
    /// The last block that was carried out.
    last: Place,
    /// That of the last line.
    pub(super) block: Block,
    problems: Vec<Problem>,
    /// Labels of loops and conditions whose values could not be read.
    unread: Vec<Label>,
    pub(super) state: State,
    pub(super) out: Output,
}

impl<R: BufRead> Decoder<R> {
    /// Decodes the program in `reader`.
    pub fn new(reader: R, options: DecoderOptions) -> Self {
        Self {
            source: Source::new(reader, options.subroutine_folders.clone()),
            flow: Flow::new(options.flow_limits),
            skip_suppressed_blocks: options.skip_suppressed_blocks,
            line: Vec::new(),
            program_number: None,
            begun: false,
            percent: false,
            under_way: false,
            ended: false,
            last: Place::default(),
            block: Block::default(),
            problems: Vec::new(),
            unread: Vec::new(),
            state: State::new(options),
            out: Output::default(),
        }
    }

    /// The number of the O word at the beginning of the program.
    pub fn program_number(&self) -> Option<u32> {
        self.program_number
    }

    /// Lines read so far; those of loops count once.
    pub fn lines(&self) -> u32 {
        self.source.lines()
    }

    /// The line that was read last.
    pub(super) fn text(&self) -> &[u8] {
        &self.line
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

    /// Tool offset in force (G43 to G43.2), m and degrees.
    pub fn tool_offset(&self) -> &Position {
        self.state.offsets.tool()
    }

    /// Kept memory: bytes of the line, and items that have not been taken yet.
    #[cfg(test)]
    pub(super) fn capacity(&self) -> usize {
        self.line.capacity()
            + self.source.capacity()
            + self.problems.capacity()
            + self.out.items.capacity()
    }

    /// Reads and carries out the next line, or finds that there is none.
    pub(super) fn step(&mut self) -> io::Result<()> {
        self.block.clear();
        let at = self.flow.next;
        match self.source.read(at, self.flow.keeps(), &mut self.line)? {
            Reading::Line if self.state.strict && self.line.len() > STRICT_LINE_BYTES => {
                self.refuse_line(at, STRICT_LINE_BYTES);
            }
            Reading::Line => {
                self.arrive(at);
                self.decode_line(at);
                if self.ended {
                    self.state.end(&mut self.out);
                    self.out.end();
                }
            }
            Reading::TooLong => self.refuse_line(at, MAX_LINE_BYTES),
            Reading::End => self.end_file(at),
        }
        Ok(())
    }

    /// Reports that the line behind `at` has more bytes than `limit`.
    fn refuse_line(&mut self, at: Spot, limit: usize) {
        self.arrive(at);
        self.state.feed_reported = true;
        self.out.error(DecodeError::LineTooLong(limit));
    }

    /// Makes the line behind `at` the current one.
    fn arrive(&mut self, at: Spot) {
        let line = at.line.saturating_add(1);
        self.flow.next.line = line;
        self.state.parameters.line = line;
        let shown = at.file.map_or(line, |_| self.flow.main_line());
        let within = self.source.line_of(at.behind());
        self.out.place = Place { within, ..Place::at(shown) };
    }

    /// The file has no line behind `at`.
    fn end_file(&mut self, at: Spot) {
        let within = self.source.line_of(at);
        self.out.place = Place { within, ..Place::at(self.lines().max(1)) };
        let main_line = self.flow.main_line();
        if let Some((error, line, effect)) = self.flow.at_end() {
            // A file that misses a part of itself is that of the call.
            self.out.place.line = if at.file.is_some() { main_line } else { line };
            self.out.error(error);
            self.apply(effect);
            return;
        }
        self.ended = true;
        if self.begun {
            let forgiven = self.state.forgive(Leniency::NoEnd, None, &mut self.out);
            self.report(forgiven);
        }
        self.out.place = self.last;
        self.state.end(&mut self.out);
        self.out.end();
    }

    /// Reports what the control does with a line of %.
    fn note_percent(&mut self) {
        if let Some(control) = self.state.control {
            control::percent(control, &mut self.out);
        }
    }

    fn decode_line(&mut self, at: Spot) {
        let line = self.line.strip_suffix(b"\n").unwrap_or(&self.line);
        let mut begin = 0;
        if at.line == 0 && line.starts_with(BYTE_ORDER_MARK) {
            begin = BYTE_ORDER_MARK.len();
        }
        let rest = line.get(begin..).unwrap_or_default();
        match rest.iter().find(|byte| !byte.is_ascii_whitespace()) {
            None => return,
            Some(b'%') if rest.trim_ascii() == b"%" => {
                // Those of subroutine files and of parts that are passed over mean nothing.
                if at.file.is_some() || self.flow.searches() {
                    return;
                }
                if !self.begun {
                    (self.begun, self.percent) = (true, true);
                    self.note_percent();
                    return;
                }
                self.ended = true;
                self.note_percent();
                if !self.percent {
                    let forgiven =
                        self.state.forgive(Leniency::ClosingPercent, None, &mut self.out);
                    self.report(forgiven);
                }
                return;
            }
            Some(b'/') if self.skip_suppressed_blocks => return,
            Some(b'/') => {
                begin = line.iter().position(|byte| *byte == b'/').unwrap_or_default() + 1;
            }
            Some(_) => {}
        }
        if self.flow.searches() {
            self.pass_over(at, begin);
            return;
        }
        let flow = lexer::lex(line, begin, &self.state, &mut self.block, &mut self.problems);
        self.out.place.block = self.block.number;
        if let Some(control) = self.state.numbers_of {
            let translated = control.translate(&mut self.block, self.state.motion);
            self.problems.extend(translated.err());
        }
        if let Some(control) = self.state.control.filter(|_| self.problems.is_empty()) {
            let keyword = flow.as_ref().map(|(_, keyword, _)| *keyword);
            control::check(control, line, &self.block, keyword, &self.state, &mut self.out);
        }
        if let Some((label, keyword, values)) = flow {
            match Lexer::new(line, values, &self.state).statement(label.clone(), keyword) {
                Ok(statement) => self.follow(statement, at),
                Err(problem) => {
                    self.out.error(problem);
                    if matches!(keyword, Keyword::EndSub | Keyword::Return) {
                        self.follow(Statement::untested(label, keyword), at);
                    } else {
                        self.unread.push(label);
                    }
                }
            }
        }
        if self.problems.is_empty() {
            if !self.block.is_empty() {
                (self.begun, self.under_way) = (true, true);
                self.last = self.out.place;
                self.execute();
            }
            return;
        }
        (self.begun, self.under_way) = (true, true);
        self.state.adopt(&self.block);
        // The F that is missing later may well be one that could not be read here.
        self.state.feed_reported = true;
        let unread = self.problems.iter().any(|one| one.error.rule() == Rule::Syntax);
        self.problems.drain(..).for_each(|problem| self.out.error(problem));
        self.state.recover(&self.block, &mut self.out);
        if unread {
            self.state.uncertain = self.state.uncertain.with(Letters::LINEAR);
        }
        self.ended = matches!(self.block.m.stop, Some(2 | 30));
    }

    /// Carries out the block.
    fn execute(&mut self) {
        if let Some(message) = self.block.message.take() {
            if message.kind == "ABORT" {
                self.out.error(FlowError::Abort(message.text));
                self.ended = true;
                return;
            }
            self.out.warning(None, DecodeError::Message(message));
        }
        for assignment in std::mem::take(&mut self.block.assignments) {
            self.state.set_parameter(&assignment.target, assignment.value);
        }
        if let Some(number) = self.block.subroutine {
            let gone = self.block.check_subroutine(number).and_then(|count| self.go(number, count));
            return self.report(gone);
        }
        let before = self.state.location;
        match self.state.execute(&self.block, &mut self.out) {
            Ok(true) => {}
            Ok(false) => self.ended = true,
            Err(problem) => {
                self.state.adopt(&self.block);
                self.out.error(problem);
                if self.state.location == before {
                    self.state.recover(&self.block, &mut self.out);
                }
                self.ended = matches!(self.block.m.stop, Some(2 | 30));
            }
        }
    }

    /// Carries out M98 with the number of a subroutine and of its calls, or M99.
    fn go(&mut self, m: u16, (program, count): (u32, u32)) -> Result<(), Problem> {
        let has_l = self.block.get(Letter::L).is_some();
        let calls = |control: Control| control.calls((program, count), has_l);
        let (program, count) = self.state.numbers_of.map_or((program, count), calls);
        let effect = if m == 98 && count == 0 {
            return Ok(());
        } else if m == 98 {
            self.flow.call(Label::of_number(program.into()), Keyword::Program, None, count)
        } else if self.state.parameters.depth() > 0 {
            self.flow.leave("M99", Keyword::Program, None)
        } else {
            self.out.warning(None, FlowError::EndlessProgram.into());
            self.ended = true;
            return Ok(());
        };
        self.apply(effect?);
        Ok(())
    }

    /// Carries out a line of flow control.
    fn follow(&mut self, statement: Statement, at: Spot) {
        if statement.keyword == Keyword::Program && !self.under_way {
            self.program_number = statement.label.text().parse().ok();
        }
        (self.begun, self.under_way) = (true, true);
        match self.flow.execute(statement, at) {
            Ok(effect) => self.apply(effect),
            // Its beginning is the error.
            Err(FlowError::NotOpen(.., label))
                if self.unread.iter().any(|unread| unread.to_string() == label) => {}
            Err(error) => {
                self.ended = matches!(error, FlowError::Endless(_) | FlowError::TooDeep(_));
                self.out.error(error);
            }
        }
        if self.flow.keeps() {
            self.source.keep(at, &self.line);
        }
    }

    /// Looks for the line that ends the search in the current line.
    fn pass_over(&mut self, at: Spot, begin: usize) {
        let line = self.line.strip_suffix(b"\n").unwrap_or(&self.line);
        let mut lexer = Lexer::new(line, begin, &self.state);
        if matches!(lexer.peek(), Some(b'N' | b'n')) && lexer.block_number(&mut self.block).is_err()
        {
            return;
        }
        if !matches!(lexer.peek(), Some(b'O' | b'o')) {
            return;
        }
        // A line that is passed over may be as wrong as it likes.
        let Ok((label, keyword)) = lexer.label() else { return };
        if !self.flow.finds(&label, keyword) {
            if let Err(error) = self.flow.check_nested(keyword) {
                self.out.error(error);
            }
            return;
        }
        self.out.place.block = self.block.number;
        let decided = self.flow.is_decided(&label, keyword);
        match if decided {
            Ok(Statement::untested(label, keyword))
        } else {
            lexer.statement(label, keyword)
        } {
            Ok(statement) => self.follow(statement, at),
            Err(problem) => self.out.error(problem),
        }
    }

    /// Restores what M73 has saved in the subroutine that ends.
    fn restore_modes(&mut self) {
        let restored = self.state.return_modes(&mut self.out);
        self.report(restored);
    }

    fn report(&mut self, result: Result<(), Problem>) {
        if let Err(problem) = result {
            self.out.error(problem);
        }
    }

    /// Lets parameters and files follow the flow of control.
    fn apply(&mut self, effect: Effect) {
        match effect {
            Effect::None => {}
            Effect::Enter { arguments, unknown } => {
                let saved = self.state.parameters.enter(arguments);
                self.flow.save(saved);
                let Some(label) = unknown else { return };
                match self.source.open(label.text()) {
                    Ok(Some(file)) => self.flow.next = Spot { file: Some(file), line: 0 },
                    // Perhaps it follows.
                    Ok(None) => {}
                    Err(cause) => {
                        let (label, cause) = (label.to_string(), cause.to_string());
                        self.out.error(FlowError::File(label, cause));
                    }
                }
            }
            Effect::Again => {
                self.restore_modes();
                self.state.parameters.leave(None);
                self.state.parameters.enter(None);
            }
            Effect::Leave { saved, value } => {
                self.restore_modes();
                self.state.parameters.leave(saved);
                self.state.parameters.returned = value;
            }
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
