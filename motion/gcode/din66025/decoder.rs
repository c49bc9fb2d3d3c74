//! Decoder (`SMC_NCDecoder`): reads a program line by line.

use super::block::{Block, Complaints};
use super::error::{DecodeError, Failure, Item, Problem};
use super::lexer;
use super::output::Output;
use super::state::{JumpTo, State};
use super::variables::Variables;
use super::word::Word;
use crate::lines::read_line;
use nalgebra::Point3;
use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, BufRead, Seek};
use std::iter::FusedIterator;
use std::ops::Range;
use twin_path::ExtraPosition;
use twin_path::Place;

/// The longest line that is read, its end included, bytes.
pub const MAX_LINE_BYTES: usize = 1 << 16;

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Default limit of the jumps (G20) of a program.
pub const DEFAULT_JUMPS: u32 = 100_000;

/// Number of jump targets that are remembered; others are searched for each time.
const REMEMBERED_TARGETS: usize = 4096;

/// Options of a decoder.
#[derive(Clone, Debug, PartialEq)]
pub struct DecoderOptions {
    /// Start position if the program does not begin with G92, m (`piStartPosition`).
    pub start: [f64; 3],
    /// Start positions of the extra axes P Q U V W, u.
    pub start_extra: ExtraPosition,
    /// Leaves out the blocks that begin with `/` (`bStepSuppress`). Their contents are not checked.
    pub skip_suppressed_blocks: bool,
    /// Variables for `$name$`.
    pub variables: Variables,
    /// Jumps (G20) the program may take before it counts as endless.
    pub jumps: u32,
}

impl Default for DecoderOptions {
    fn default() -> Self {
        Self {
            start: [0.0; 3],
            start_extra: [0.0; 5],
            skip_suppressed_blocks: false,
            variables: Variables::default(),
            jumps: DEFAULT_JUMPS,
        }
    }
}

/// Decodes a program (`SMC_NCDecoder`, manual 6.2.1) as an iterator over its path elements.
///
/// Whatever the input, it ends with the input. A block with an error gives an error (or several) and no element; the
/// path goes on with the next block as if the erroneous one were not there, except that the modes, feed and
/// accelerations it sets hold. So all errors of a program are found in one run.
///
/// Jumps (G20) are taken as the program is read, so a program that loops gives its elements again and again.
#[doc(alias = "SMC_ReadNCFile")]
#[expect(
    clippy::struct_excessive_bools,
    reason = "an option, and what has been seen of the program"
)]
pub struct Decoder<R> {
    pub(super) reader: R,
    /// How the reader goes to another place; none if it cannot.
    seek: Option<Seeker<R>>,
    skip_suppressed_blocks: bool,
    jumps_left: u32,
    jumps: u32,
    /// Where the blocks are that jumps have led to.
    targets: BTreeMap<u32, Position>,
    /// Where the next line begins.
    next: Position,
    pub(super) line: Vec<u8>,
    name: Option<String>,
    /// The `%` line has been read, or missed.
    begun: bool,
    /// The bytes of a `%` that ends the program, in the last line.
    closing: Option<Range<usize>>,
    pub(super) ended: bool,
    /// Those of the last line.
    pub(super) words: Vec<Word>,
    complaints: Complaints,
    /// A block without N word has been reported.
    unnumbered: bool,
    pub(super) state: State,
    pub(super) out: Output,
}

/// How to go forwards and backwards in a reader, bytes.
type Seeker<R> = fn(&mut R, i64) -> io::Result<()>;

/// The beginning of a line.
#[derive(Clone, Copy, Debug, Default)]
struct Position {
    offset: u64,
    /// Lines before it.
    lines: u32,
}

impl<R> fmt::Debug for Decoder<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { next, state, .. } = self;
        f.debug_struct("Decoder").field("next", next).field("state", state).finish_non_exhaustive()
    }
}

impl<R: BufRead + Seek> Decoder<R> {
    /// Decodes the program in `reader`, which may jump (G20). It begins where the reader is.
    pub fn with_jumps(reader: R, options: DecoderOptions) -> Self {
        // Relative to where the reader is, what it has buffered is kept, and it need not have begun at its beginning.
        Self { seek: Some(R::seek_relative), ..Self::new(reader, options) }
    }
}

impl<R: BufRead> Decoder<R> {
    /// Decodes the program in `reader`, which can be read only once: jumps are errors.
    pub fn new(reader: R, options: DecoderOptions) -> Self {
        let DecoderOptions { start, start_extra, skip_suppressed_blocks, variables, jumps } =
            options;
        Self {
            reader,
            seek: None,
            skip_suppressed_blocks,
            jumps_left: jumps,
            jumps,
            targets: BTreeMap::new(),
            next: Position::default(),
            line: Vec::new(),
            name: None,
            begun: false,
            closing: None,
            ended: false,
            words: Vec::new(),
            complaints: Complaints::default(),
            unnumbered: false,
            state: State::new(start, start_extra, variables),
            out: Output::default(),
        }
    }

    /// The program's name: what follows `%`. Known once the first item has been asked for.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Lines read so far; after a jump, those before the present place.
    pub fn lines(&self) -> u32 {
        self.next.lines
    }

    /// Position of the tool after the blocks read so far, m.
    pub fn position(&self) -> Point3<f64> {
        self.state.position()
    }

    /// Reads the next line; false at the end of the program.
    fn read_line(&mut self) -> io::Result<bool> {
        let Some(length) = read_line(&mut self.reader, MAX_LINE_BYTES, &mut self.line)? else {
            return Ok(false);
        };
        self.next.offset = self.next.offset.saturating_add(length);
        self.next.lines = self.next.lines.saturating_add(1);
        self.out.place = Place::at(self.next.lines);
        if self.line.len() > MAX_LINE_BYTES {
            self.line.clear();
            self.begun = true;
            self.state.forgive_missing_feed();
            self.out.push_error(None, DecodeError::LineTooLong(MAX_LINE_BYTES));
        }
        Ok(true)
    }

    /// Goes on with another block.
    fn jump(&mut self, to: JumpTo) -> io::Result<()> {
        let JumpTo { block, columns } = to;
        let Some(seek) = self.seek else {
            self.out.error(columns, DecodeError::JumpInStream);
            return Ok(());
        };
        let Some(left) = self.jumps_left.checked_sub(1) else {
            self.ended = true;
            self.state.finish(&mut self.out);
            self.out.error(columns, DecodeError::TooManyJumps(self.jumps));
            return Ok(());
        };
        self.jumps_left = left;
        self.out.repeats = true;
        let from = self.next;
        let known = self.targets.get(&block).copied();
        let target = match known {
            Some(target) => Some(target),
            None => self.find(seek, block)?,
        };
        if let Some(target) = target {
            if self.targets.len() < REMEMBERED_TARGETS {
                self.targets.insert(block, target);
            }
            self.go(seek, target)
        } else {
            self.out.error(columns, DecodeError::JumpTarget(block));
            self.go(seek, from)
        }
    }

    fn go(&mut self, seek: Seeker<R>, to: Position) -> io::Result<()> {
        let way = i128::from(to.offset) - i128::from(self.next.offset);
        self.next = to;
        seek(&mut self.reader, i64::try_from(way).map_err(io::Error::other)?)
    }

    /// The first line with the number `block`, looked for from the beginning. Suppressed blocks are not there.
    fn find(&mut self, seek: Seeker<R>, block: u32) -> io::Result<Option<Position>> {
        self.go(seek, Position::default())?;
        let mut begun = false;
        loop {
            let at = self.next;
            let Some(length) = read_line(&mut self.reader, MAX_LINE_BYTES, &mut self.line)? else {
                return Ok(None);
            };
            self.next.offset = self.next.offset.saturating_add(length);
            self.next.lines = self.next.lines.saturating_add(1);
            if begun && is_closing(&self.line) {
                return Ok(None);
            }
            begun |= !self.line.trim_ascii().is_empty();
            if block_number(&self.line, at.lines == 0, self.skip_suppressed_blocks) == Some(block) {
                return Ok(Some(at));
            }
        }
    }

    /// Reads and carries out the next line, or finds that there is none.
    pub(super) fn step(&mut self) -> io::Result<()> {
        self.words.clear();
        if self.ended {
            return Ok(());
        }
        if !self.read_line()? {
            self.ended = true;
            self.state.finish(&mut self.out);
        } else if let Some(jump) = self.decode_line() {
            self.jump(jump)?;
        } else if let Some(columns) = self.closing.take() {
            self.close(columns)?;
        }
        Ok(())
    }

    /// Ends the program at a second `%`. What follows is read only to see whether there is anything.
    fn close(&mut self, columns: Range<usize>) -> io::Result<()> {
        self.ended = true;
        self.state.finish(&mut self.out);
        let mut error = DecodeError::ClosingPercent;
        while read_line(&mut self.reader, MAX_LINE_BYTES, &mut self.line)?.is_some() {
            if !self.line.trim_ascii().is_empty() {
                error = DecodeError::LinesBehindPercent;
                break;
            }
        }
        self.out.warning(columns, error);
        Ok(())
    }

    /// Decodes the current line; returns the offset to go on from if that is not the next line.
    fn decode_line(&mut self) -> Option<JumpTo> {
        let line = self.line.strip_suffix(b"\n").unwrap_or(&self.line);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let mark = if self.next.lines == 1 && line.starts_with(BYTE_ORDER_MARK) {
            BYTE_ORDER_MARK.len()
        } else {
            0
        };
        let (begin, first) = first_word(line, mark)?;
        let begun = std::mem::replace(&mut self.begun, true);
        match (first, begun) {
            (b'%', false) => {
                let name = line.get(begin + 1..).unwrap_or_default().trim_ascii();
                self.name = (!name.is_empty()).then(|| String::from_utf8_lossy(name).into_owned());
                return None;
            }
            (b'%', true) if is_closing(line) => {
                self.closing = Some(begin..begin + 1);
                return None;
            }
            (b'%', true) => {
                self.out.error(begin..begin + 1, DecodeError::MisplacedPercent);
                return None;
            }
            (_, false) => self.out.error(begin..line.len(), DecodeError::MissingPercent),
            (_, true) => {}
        }
        let begin = match first {
            b'/' if self.skip_suppressed_blocks => return None,
            b'/' => begin + 1,
            _ => begin,
        };
        let Complaints { problems, notes } = &mut self.complaints;
        notes.clear();
        lexer::lex(line, begin, &self.state.variables, &mut self.words, problems);
        let block = Block::new(&self.words, &mut self.complaints);
        self.out.place.block = block.number;
        self.state.store(&block);
        for Problem { columns, error } in self.complaints.notes.drain(..).rev() {
            self.out.warning(columns, error);
        }
        let problems = &mut self.complaints.problems;
        if problems.is_empty() {
            if let Some(first) = self.words.first()
                && block.number.is_none()
                && !std::mem::replace(&mut self.unnumbered, true)
            {
                self.out.warning(first.columns.clone(), DecodeError::MissingBlockNumber);
            }
            return self.state.execute(&block, &self.words, line, &mut self.out);
        }
        problems.sort_by_key(|problem| problem.columns.start);
        let unread = problems
            .first()
            .and_then(|problem| line.get(problem.columns.start..))
            .unwrap_or_default();
        if unread.iter().any(|byte| byte.eq_ignore_ascii_case(&b'F')) {
            // The F that is missing later may well be one that could not be read here.
            self.state.forgive_missing_feed();
        }
        for Problem { columns, error } in problems.drain(..) {
            self.out.error(columns, error);
        }
        None
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
            if let Err(error) = self.step() {
                self.ended = true;
                self.state.finish(&mut self.out);
                self.out.items.push_back(Err(Failure::Io(error)));
            }
        }
    }
}

impl<R: BufRead> FusedIterator for Decoder<R> {}

/// Place and value of the first byte that is not blank, from `at` on.
fn first_word(line: &[u8], at: usize) -> Option<(usize, u8)> {
    line.iter().copied().enumerate().skip(at).find(|(_, byte)| !matches!(byte, b' ' | b'\t'))
}

/// True for a line that ends the program if it is not its first.
fn is_closing(line: &[u8]) -> bool {
    line.trim_ascii() == b"%"
}

/// The number of the N word with which a line begins, `/`, blanks and comments before it left out.
fn block_number(line: &[u8], is_first: bool, skip_suppressed: bool) -> Option<u32> {
    let line = if is_first { line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line) } else { line };
    if line.len() > MAX_LINE_BYTES {
        return None;
    }
    match first_word(line, 0)? {
        (_, b'/') if skip_suppressed => None,
        (begin, b'/') => lexer::block_number(line, begin + 1),
        (begin, _) => lexer::block_number(line, begin),
    }
}
