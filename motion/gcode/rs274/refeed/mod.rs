//! Feed reduction for this dialect: rewrites F words that a machine cannot reach; see [`crate::refeed`].
//!
//! F per minute (G94) and per revolution (G95) are modal, F of inverse time (G93) belongs to its line. F does not
//! govern rapids: those of G0, G28, G30 and of canned cycles are reported if they are too fast. So are threads and
//! tapping, whose feeds follow from the pitch.
//!
//! [`refeed`] goes from line to line and needs no memory for them; [`refeed_repeated`] is for programs with loops,
//! conditions and subroutines.

mod repeated;

use crate::decode;
use crate::refeed::{
    Edit, Interpreter, Limits, LineLimit, Reason, Refed, RefeedError, Unrepaired, has_room,
    is_below, is_suppressed, rewrite, rounded_down,
};
use crate::rs274::block::Letter;
use crate::rs274::decoder::{Decoder, MAX_LINE_BYTES};
use crate::rs274::options::{DecoderOptions, LengthUnit};
use crate::rs274::state::{Feed, MAX_FEED, State};
use crate::rs274::word::{FeedMode, Motion};
use std::io::{self, BufRead, Cursor, Write};
use twin_path::{ElementKind, PathElement};

pub use repeated::refeed_repeated;

/// Feeds that are nearer to each other are the same: one may have come back through another unit of length.
const SAME: f64 = 1e-9;

/// Writes the program in `reader` to `out` with feeds of at most `limits`; errors of the program stay.
///
/// `options` are those with which the limits were found. The limits come in the order of lines, each perhaps a little
/// late ([`RefeedError::Late`]); no more than a few lines are held.
///
/// # Errors
/// If reading, writing or a limit fails, and [`RefeedError::Repeated`] where a loop, a condition or a subroutine begins.
pub fn refeed(
    reader: impl BufRead,
    options: &DecoderOptions,
    limits: impl IntoIterator<Item = io::Result<LineLimit>>,
    out: impl Write,
) -> Result<Refed, RefeedError> {
    let mut decoder = Decoder::new(Cursor::new(Vec::new()), options.clone());
    // A compensated move comes with the next line. Its feed is that of the programmed one.
    decoder.state.ignore_compensation();
    let interpreter = Running {
        decoder,
        limits: Limits::new(limits.into_iter()),
        programmed: None,
        written: None,
        saved: None,
        doubtful: false,
    };
    rewrite(reader, interpreter, out)
}

/// The last F that counts, and its units, and the feed in force in the program as it is written.
type Feeds = (Option<(f64, LengthUnit)>, Option<Feed>);

struct Running<I: Iterator> {
    decoder: Decoder<Cursor<Vec<u8>>>,
    limits: Limits<I>,
    /// The last F that counts, and its units.
    programmed: Option<(f64, LengthUnit)>,
    /// In force in the program as it is written.
    written: Option<Feed>,
    /// Both as M70 or M73 have saved them.
    saved: Option<Feeds>,
    /// A block that the machine may leave out has changed it.
    doubtful: bool,
}

/// Moves of a line.
#[derive(Debug, Default)]
struct Moves {
    /// Its cut, or its probing move; of a canned cycle any of them.
    cut: Option<Cut>,
    /// Its rapid, m/s.
    rapid: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
struct Cut {
    /// As [`PathElement::feed`] has it.
    feed: f64,
    /// Only rotary axes move.
    turns: bool,
    /// What F is multiplied by for a feed per minute: 1, or the speed of the spindle with G95; more where rotary axes
    /// move with U, V, W.
    speed: f64,
}

impl Moves {
    /// Those of the line that `decoder` executed last. Takes its elements.
    fn of<R>(decoder: &mut Decoder<R>) -> Self {
        let mut moves = Self::default();
        for item in decoder.out.items.drain(..) {
            if let Ok(decode::Item::Element(element)) = item {
                moves.include(&element, &decoder.state);
            }
        }
        if let (Some(cut), Some(feed)) = (&mut moves.cut, decoder.state.feed)
            && decoder.state.feed_mode == FeedMode::PerRevolution
        {
            cut.speed *= cut.feed / cut.own(feed);
        }
        moves
    }

    /// Adds `element`; `state` is that behind it.
    fn include(&mut self, element: &PathElement, state: &State) {
        match element.kind {
            ElementKind::Cut | ElementKind::Probe { .. } => {
                let extra = element.extra().filter(|_| element.shape.length() <= 0.0);
                let [turn, shift] =
                    extra.map_or([0.0; 2], |extra| state.extra_distance(&extra.start, &extra.end));
                let turns = turn > 0.0 && shift <= 0.0;
                let speed = if shift > 0.0 { turn.hypot(shift) / shift } else { 1.0 };
                self.cut = Some(Cut { feed: element.feed, turns, speed });
            }
            ElementKind::Rapid if element.length() > 0.0 => {
                self.rapid = Some(self.rapid.map_or(element.feed, |feed| feed.max(element.feed)));
            }
            _ => {}
        }
    }
}

impl Cut {
    /// Part of a feed in force that applies to it, as in [`PathElement::feed`].
    fn own(self, feed: Feed) -> f64 {
        self.speed * if self.turns { feed.rotary * 1e-3 } else { feed.linear }
    }

    /// The F word of a feed.
    fn number(self, feed: f64, units: LengthUnit) -> f64 {
        let feed = feed / self.speed;
        if self.turns { feed * 1e3 * 60.0 } else { units.convert_metres(feed) * 60.0 }
    }

    /// The F word for the feed that is programmed, by the last F and its units.
    fn as_programmed(self, programmed: Option<(f64, LengthUnit)>, units: LengthUnit) -> f64 {
        match programmed {
            // Per minute, whatever the units.
            Some((number, was)) if self.turns || was == units => number,
            _ => {
                let number = self.number(self.feed, units);
                // What the change of units has added is noise.
                let text = format!("{number:.12e}");
                text.parse().unwrap_or(number)
            }
        }
    }
}

fn is_same(one: f64, other: f64) -> bool {
    (one - other).abs() <= SAME * other.abs()
}

impl<I: Iterator<Item = io::Result<LineLimit>>> Running<I> {
    /// Carries out a line; what it moves.
    fn carry_out(&mut self, line: &[u8]) -> io::Result<Moves> {
        let decoder = &mut self.decoder;
        // F is read before G20 and G21 of its line act.
        let units = decoder.state.units;
        let text = decoder.source.reader.get_mut();
        text.clear();
        text.extend_from_slice(line);
        decoder.source.reader.set_position(0);
        decoder.step()?;
        let moves = Moves::of(decoder);
        let word = decoder.block.get(Letter::F).filter(|f| (0.0..=MAX_FEED).contains(f));
        match word.filter(|_| decoder.state.feed_mode != FeedMode::InverseTime) {
            Some(number) => {
                let differs = self.written != self.programmed.map(feed_of);
                self.doubtful = is_suppressed(line) && (self.doubtful || differs);
                self.programmed = Some((number, units));
                self.written = decoder.state.feed;
            }
            None if decoder.block.g.feed_mode.is_some_and(|mode| mode != FeedMode::InverseTime) => {
                (self.programmed, self.written) = (None, None);
            }
            None => {}
        }
        if !decoder.state.feed_given && decoder.state.feed == Some(Feed::ASSUMED) {
            self.written = self.written.or(decoder.state.feed);
        }
        match decoder.block.m.modes {
            Some(70 | 73) => self.saved = Some((self.programmed, self.written)),
            Some(71) => self.saved = None,
            Some(_) if decoder.block.is_single_m() => {
                // Back comes the feed that was written, whatever was programmed.
                (self.programmed, self.written) =
                    self.saved.unwrap_or((self.programmed, self.written));
                self.doubtful |= is_suppressed(line);
            }
            _ => {}
        }
        Ok(moves)
    }

    /// Lowers the F word of inverse time.
    fn inverse(&mut self, line: &[u8], cut: Cut, limit: f64, refed: &mut Refed) -> Option<Edit> {
        if !is_below(limit, cut.feed) {
            return None;
        }
        let block = &self.decoder.block;
        let word = block.get(Letter::F).zip(block.columns(Letter::F));
        let lower = word.and_then(|(number, columns)| {
            let (_, text) = rounded_down(number * (limit / cut.feed))?;
            Some(Edit::replace(line, &columns, &text))
        });
        if lower.is_some() {
            refed.lowered += 1;
        } else {
            self.report(Reason::NoFeed, cut.feed, limit, refed);
        }
        lower
    }

    fn report(&self, reason: Reason, programmed: f64, limit: f64, refed: &mut Refed) {
        let place = self.decoder.out.place;
        refed.report(Unrepaired { place, reason, programmed, limit });
    }
}

fn feed_of((number, units): (f64, LengthUnit)) -> Feed {
    Feed::per_minute(number, units)
}

impl<I: Iterator<Item = io::Result<LineLimit>>> Interpreter for Running<I> {
    const MAX_LINE_BYTES: usize = MAX_LINE_BYTES;

    fn line(&mut self, line: &[u8], refed: &mut Refed) -> Result<Option<Edit>, RefeedError> {
        if self.decoder.ended {
            return Ok(None);
        }
        let units = self.decoder.state.units;
        let moves = self.carry_out(line).map_err(RefeedError::Read)?;
        if self.decoder.flow.keeps() {
            return Err(RefeedError::Repeated(self.decoder.lines()));
        }
        let limit = self.limits.of(self.decoder.lines())?;
        if let Some(rapid) = moves.rapid.filter(|rapid| is_below(limit.rapid, *rapid)) {
            self.report(Reason::Rapid, rapid, limit.rapid, refed);
        }
        let Some(cut) = moves.cut else { return Ok(None) };
        let motion = self.decoder.state.motion;
        let threads = matches!(motion, Motion::Thread(_));
        let taps = threads || matches!(motion, Motion::Cycle(cycle) if cycle.taps());
        if taps && is_below(limit.feed, cut.feed) {
            self.report(Reason::Thread, cut.feed, limit.feed, refed);
        }
        if threads {
            return Ok(None);
        }
        if self.decoder.state.feed_mode == FeedMode::InverseTime {
            return Ok(self.inverse(line, cut, limit.feed, refed));
        }
        let lowered = !taps && is_below(limit.feed, cut.feed);
        let lower = if lowered { rounded_down(cut.number(limit.feed, units)) } else { None };
        match &lower {
            Some(_) => refed.lowered += 1,
            None if lowered => self.report(Reason::NoFeed, cut.feed, limit.feed, refed),
            None => {}
        }
        let (number, text) = lower.unwrap_or_else(|| {
            let number = cut.as_programmed(self.programmed, units);
            (number, number.to_string())
        });
        let feed = Feed::per_minute(number, units);
        let is_there = self.written.is_some_and(|now| is_same(cut.own(now), cut.own(feed)));
        let columns = self.decoder.block.get(Letter::F).and(self.decoder.block.columns(Letter::F));
        if is_there && (columns.is_some() || !self.doubtful) {
            return Ok(None);
        }
        let last = self.decoder.block.last_columns();
        let edit = match (columns, last) {
            (Some(columns), _) => Edit::replace(line, &columns, &text),
            (None, Some(last)) if has_room(line, MAX_LINE_BYTES) => {
                Edit::insert(line, &last, &text)
            }
            _ => {
                let written = self.written.map_or(cut.feed, |now| cut.own(now));
                self.report(Reason::LongLine, written, limit.feed, refed);
                return Ok(None);
            }
        };
        self.written = Some(feed);
        self.doubtful = is_suppressed(line);
        Ok(Some(edit))
    }
}
