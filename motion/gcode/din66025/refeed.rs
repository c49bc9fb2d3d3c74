//! Feed reduction for this dialect: rewrites F words that a machine cannot reach; see [`crate::refeed`].
//!
//! In this dialect F governs rapids (G0), too. An F word whose number is a variable becomes a number where it must be
//! lower. A line that is executed several times (G20) gets the smallest feed it needs, wherever the program comes from.

use super::decoder::{Decoder, DecoderOptions, MAX_LINE_BYTES};
use super::scan::may_jump;
use super::variables::Variables;
use super::word::{Letter, Word};
use crate::decode;
use crate::refeed::{
    Edit, Interpreter, Limit, Limits, LineLimit, Reason, Refed, RefeedError, Unrepaired, has_room,
    is_below, is_suppressed, rewrite, rounded_down,
};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, BufRead, Cursor, Seek, SeekFrom};

/// mm in one m: F is mm/s, feeds are m/s.
const MM: f64 = 1e3;

/// Writes the program in `reader` to `out` with feeds of at most `limits`; errors of the program stay.
///
/// `options` are those with which the limits were found. The limits come in the order of lines, each perhaps a little
/// late ([`RefeedError::Late`]). Of a program without jumps no more than a few lines are held. One that may jump (it
/// names G20) is gone through several times, as it runs, and the limits of all its lines are held; they may come in any
/// order then.
///
/// # Errors
/// If reading, writing or a limit fails.
pub fn refeed<R: BufRead + Seek>(
    mut reader: R,
    options: &DecoderOptions,
    limits: impl IntoIterator<Item = io::Result<LineLimit>>,
    out: impl io::Write,
) -> Result<Refed, RefeedError> {
    let limits = Limits::new(limits.into_iter());
    let begin = reader.stream_position().map_err(RefeedError::Read)?;
    let jumps = may_jump(&mut reader).map_err(RefeedError::Read)?;
    reader.seek(SeekFrom::Start(begin)).map_err(RefeedError::Read)?;
    if jumps {
        let limits = limits.into_table()?;
        let plan = Plan::new(&mut reader, begin, options, &limits).map_err(RefeedError::Read)?;
        return rewrite(reader, Planned::new(options, plan), out);
    }
    let interpreter = Running { decoder: follower(options), limits, modal: Modal::default() };
    rewrite(reader, interpreter, out)
}

/// A decoder that gets its program line by line.
type Follower = Decoder<Cursor<Vec<u8>>>;

fn follower(options: &DecoderOptions) -> Follower {
    Decoder::new(Cursor::new(Vec::new()), options.clone())
}

/// Feeds of a line that has just been executed.
struct Step {
    /// Its own F, mm/s.
    own: Option<f64>,
    /// It moves the tool.
    moves: bool,
    place: twin_path::Place,
}

/// Has a decoder carry out a line.
fn feed_line(decoder: &mut Follower, line: &[u8]) -> io::Result<Step> {
    let text = decoder.reader.get_mut();
    text.clear();
    text.extend_from_slice(line);
    decoder.reader.set_position(0);
    decoder.step()?;
    Ok(step(decoder))
}

/// Feeds of the line that `decoder` executed last. Takes its elements.
fn step<R>(decoder: &mut Decoder<R>) -> Step {
    let place = decoder.out.place;
    let mut moves = decoder
        .state
        .held()
        .is_some_and(|element| element.kind.is_motion() && element.place.line == place.line);
    for item in decoder.out.items.drain(..) {
        if let Ok(decode::Item::Element(element)) = item {
            moves |= element.kind.is_motion() && element.place.line == place.line;
        }
    }
    Step { own: feed_word(&decoder.words).map(|word| word.value), moves, place }
}

/// The F word that counts: of several the leftmost.
fn feed_word(words: &[Word]) -> Option<&Word> {
    words.iter().find(|word| word.letter == Letter::F)
}

/// Writes F`number` into a line with these words.
fn edit(line: &[u8], words: &[Word], number: &str) -> Option<Edit> {
    match (feed_word(words), words.last()) {
        (Some(word), _) => Some(Edit::replace(line, &word.columns, number)),
        (None, Some(last)) => Some(Edit::insert(line, &last.columns, number)),
        (None, None) => None,
    }
}

/// Feed that a line of the path needs, with `programmed` (mm/s) in force and `limit` (m/s) allowed.
enum Need {
    /// What is programmed.
    Programmed,
    /// Less, mm/s.
    Less(f64, String),
    /// Less than there is.
    Nothing,
}

fn need(programmed: f64, limit: f64) -> Need {
    if !is_below(limit, programmed / MM) {
        return Need::Programmed;
    }
    rounded_down(limit * MM).map_or(Need::Nothing, |(number, text)| Need::Less(number, text))
}

fn unrepaired(place: twin_path::Place, reason: Reason, programmed: f64, limit: f64) -> Unrepaired {
    Unrepaired { place, reason, programmed: programmed / MM, limit }
}

/// F in force, mm/s.
#[derive(Debug, Default)]
struct Modal {
    /// In the program as it was.
    programmed: Option<f64>,
    /// And as it is written.
    written: Option<f64>,
    /// A block that the machine may leave out has changed it.
    doubtful: bool,
}

/// A program that goes from line to line.
struct Running<I: Iterator> {
    decoder: Follower,
    limits: Limits<I>,
    modal: Modal,
}

impl<I: Iterator<Item = io::Result<LineLimit>>> Interpreter for Running<I> {
    const MAX_LINE_BYTES: usize = MAX_LINE_BYTES;

    fn line(&mut self, line: &[u8], refed: &mut Refed) -> Result<Option<Edit>, RefeedError> {
        let Step { own, moves, place } =
            feed_line(&mut self.decoder, line).map_err(RefeedError::Read)?;
        let limit = self.limits.of(place.line)?.of_both();
        let modal = &mut self.modal;
        let suppressed = is_suppressed(line);
        if own.is_some() {
            modal.doubtful = suppressed && (modal.doubtful || modal.written != modal.programmed);
            (modal.programmed, modal.written) = (own, own);
        }
        let Some(programmed) = modal.programmed.filter(|_| moves) else { return Ok(None) };
        let (number, text) = match need(programmed, limit) {
            Need::Programmed => (programmed, programmed.to_string()),
            Need::Less(number, text) => {
                refed.lowered += 1;
                (number, text)
            }
            Need::Nothing => {
                refed.report(unrepaired(place, Reason::NoFeed, programmed, limit));
                (programmed, programmed.to_string())
            }
        };
        if modal.written == Some(number) && (own.is_some() || !modal.doubtful) {
            return Ok(None);
        }
        if !has_room(line, MAX_LINE_BYTES) {
            let reason = Reason::LongLine;
            refed.report(unrepaired(place, reason, modal.written.unwrap_or(programmed), limit));
            return Ok(None);
        }
        modal.written = Some(number);
        modal.doubtful = suppressed;
        Ok(edit(line, &self.decoder.words, &text))
    }
}

/// Feeds that the lines of a program with jumps need.
#[derive(Debug, Default)]
struct Plan {
    /// Lines with a feed of their own, mm/s.
    feeds: BTreeMap<u32, f64>,
    /// Those of them to which the tool comes with another one.
    changed: BTreeSet<u32>,
    lowered: BTreeSet<u32>,
    unrepaired: BTreeMap<u32, Unrepaired>,
}

impl Plan {
    /// Goes through a program as it runs until nothing is left to change. Ends, because each time there is a line more
    /// with a feed of its own, or one with less.
    fn new<R: BufRead + Seek>(
        mut reader: R,
        begin: u64,
        options: &DecoderOptions,
        limits: &BTreeMap<u32, Limit>,
    ) -> io::Result<Self> {
        let mut plan = Self::default();
        loop {
            reader.seek(SeekFrom::Start(begin))?;
            let grown = plan.run(&mut reader, options, limits)?;
            if !grown {
                reader.seek(SeekFrom::Start(begin))?;
                return Ok(plan);
            }
        }
    }

    /// Runs the program once; whether a feed has been found that was not there before.
    fn run<R: BufRead + Seek>(
        &mut self,
        reader: R,
        options: &DecoderOptions,
        limits: &BTreeMap<u32, Limit>,
    ) -> io::Result<bool> {
        self.changed.clear();
        let mut grown = false;
        let mut modal = Modal::default();
        let mut decoder = Decoder::with_jumps(reader, options.clone());
        loop {
            decoder.step()?;
            if decoder.ended {
                return Ok(grown);
            }
            let Step { own, moves, place } = step(&mut decoder);
            if own.is_some() {
                (modal.programmed, modal.written) = (own, own);
            }
            let Some(programmed) = modal.programmed.filter(|_| moves) else { continue };
            let limit = limits.get(&place.line).copied().unwrap_or_default().of_both();
            let wanted = match need(programmed, limit) {
                Need::Programmed => programmed,
                Need::Less(number, _) => {
                    self.lowered.insert(place.line);
                    number
                }
                Need::Nothing => {
                    let note = unrepaired(place, Reason::NoFeed, programmed, limit);
                    self.unrepaired.insert(place.line, note);
                    programmed
                }
            };
            let feed = match self.feeds.get_mut(&place.line) {
                Some(feed) => {
                    grown |= wanted < *feed;
                    *feed = feed.min(wanted);
                    *feed
                }
                None if modal.written == Some(wanted) => continue,
                None => {
                    grown = true;
                    self.feeds.insert(place.line, wanted);
                    wanted
                }
            };
            if modal.written != Some(feed) || modal.doubtful && own.is_none() {
                self.changed.insert(place.line);
            }
            modal.written = Some(feed);
            modal.doubtful = is_suppressed(&decoder.line);
        }
    }
}

/// A program that is written as planned.
struct Planned {
    decoder: Follower,
    /// Numbers for all variables with which an F word is one.
    variables: Variables,
    plan: Plan,
}

impl Planned {
    fn new(options: &DecoderOptions, plan: Plan) -> Self {
        let mut variables = options.variables.clone();
        for (name, _) in options.variables.iter() {
            variables.set(name, 1.0);
        }
        Self { decoder: follower(options), variables, plan }
    }
}

impl Interpreter for Planned {
    const MAX_LINE_BYTES: usize = MAX_LINE_BYTES;

    fn line(&mut self, line: &[u8], refed: &mut Refed) -> Result<Option<Edit>, RefeedError> {
        // Only for the words of the line: as written in the text, not as executed.
        self.decoder.state.variables.clone_from(&self.variables);
        let Step { place, .. } = feed_line(&mut self.decoder, line).map_err(RefeedError::Read)?;
        refed.lowered += u64::from(self.plan.lowered.contains(&place.line));
        if let Some(unrepaired) = self.plan.unrepaired.get(&place.line) {
            refed.report(*unrepaired);
        }
        let feed = self.plan.feeds.get(&place.line);
        let Some(feed) = feed.filter(|_| self.plan.changed.contains(&place.line)) else {
            return Ok(None);
        };
        if !has_room(line, MAX_LINE_BYTES) {
            refed.report(unrepaired(place, Reason::LongLine, f64::NAN, feed / MM));
            return Ok(None);
        }
        Ok(edit(line, &self.decoder.words, &feed.to_string()))
    }
}
