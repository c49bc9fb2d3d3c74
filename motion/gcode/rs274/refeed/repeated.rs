//! Feed reduction of programs with loops, conditions and subroutines.
//!
//! A line may be executed several times, after different lines and with different feeds. Its F is the least that one of its
//! executions needs. The modal F of a line without F comes from the line that was executed before it: where that has
//! another F than programmed, the line needs an F of its own. So the program is executed once, and recorded are, by line,
//! the smallest feeds, and which line the F comes from; then F is written in the lines that need it.

use super::{Cut, Moves, is_same};
use crate::decode;
use crate::lines;
use crate::refeed::{
    Edit, Limit, Limits, LineLimit, Reason, Refed, RefeedError, Unrepaired, has_room, is_below,
    is_suppressed, rounded_down,
};
use crate::rs274::block::Letter;
use crate::rs274::decoder::{Decoder, MAX_LINE_BYTES};
use crate::rs274::options::{DecoderOptions, LengthUnit};
use crate::rs274::state::{Feed, MAX_FEED};
use crate::rs274::word::{FeedMode, Motion};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::ops::Range;
use twin_path::{LineKey, PathElement, Place};

const IN_FILE: &str = "its moves are in a subroutine file of their own";
const MODE: &str = "it is not in feed per minute (G94)";
const EXPRESSION: &str = "its F is not a number";
const UNITS: &str = "it is executed with G20 and with G21";
const NO_ROOM: &str = "the line has no room for another word";
const SUPPRESSED: &str = "the control may leave out lines with /";
const RESTORED: &str = "M70 to M73 save and restore F";
const READ: &str = "the program reads its feed (#<_feed>)";

/// Writes `program` to `out` with feeds of at most `limits`. The path stays the same, each line goes with the least feed
/// that its executions need. Needs memory for the program.
///
/// `options` are those with which the limits were found.
///
/// # Errors
/// If writing or a limit fails, and [`RefeedError::Fixed`] if a line needs another F that it cannot have: in a
/// subroutine file, with G93 or G95, in place of an expression, together with M70 to M73 or block delete.
pub fn refeed_repeated(
    program: &[u8],
    options: &DecoderOptions,
    limits: impl IntoIterator<Item = io::Result<LineLimit>>,
    mut out: impl Write,
) -> Result<Refed, RefeedError> {
    let limits = Limits::new(limits.into_iter()).into_table()?;
    let mut survey = Survey { limits, ..Survey::default() };
    survey.execute(program, options)?;
    let changed = survey.changed();
    let mut refed = Refed::default();
    survey.report(&mut refed);
    let mut needed = changed.iter().filter_map(|key| survey.lines.get(key));
    let fixed = needed.find_map(|moved| Some((moved.place, moved.obstacle?)));
    if let Some((place, reason)) = fixed.or(survey.obstacle.filter(|_| !changed.is_empty())) {
        return Err(RefeedError::Fixed(place, reason));
    }
    let mut text = Vec::with_capacity(program.len());
    for (line, number) in lines::lines(program).zip(1_u32..) {
        refed.lines += 1;
        let moved = survey.lines.get(&(number, None));
        let moved = moved.filter(|_| changed.contains(&(number, None)));
        match moved.map(|moved| moved.edit(line)) {
            Some(edit) => {
                refed.changed += 1;
                refed.lowered += u64::from(moved.is_some_and(Moved::is_lowered));
                edit?.write(line, &mut text).map_err(RefeedError::Write)?;
            }
            None => text.extend_from_slice(line),
        }
    }
    verify([program, &text], options, &changed)?;
    out.write_all(&text).and_then(|()| out.flush()).map_err(RefeedError::Write)?;
    Ok(refed)
}

/// Checks that only feeds of `changed` lines differ in two programs: expressions may depend on the feed.
fn verify(
    programs: [&[u8]; 2],
    options: &DecoderOptions,
    changed: &BTreeSet<LineKey>,
) -> Result<(), RefeedError> {
    let [before, after] = programs.map(|program| {
        let decoder = Decoder::new(program, options.clone());
        decoder.filter_map(|item| match item {
            Ok(decode::Item::Element(element)) => Some(element),
            _ => None,
        })
    });
    let mut after = after.fuse();
    for before in before {
        let same = after.next().is_some_and(|after| {
            let keeps = changed.contains(&before.place.key()) || is_same(after.feed, before.feed);
            keeps && PathElement { feed: before.feed, ..after } == before
        });
        if !same {
            return Err(RefeedError::Fixed(before.place, READ));
        }
    }
    after.next().map_or(Ok(()), |more| Err(RefeedError::Fixed(more.place, READ)))
}

/// A line that cuts, over its executions.
#[derive(Debug)]
struct Moved {
    place: Place,
    units: LengthUnit,
    /// The smallest F that is programmed, and the largest.
    programmed: [f64; 2],
    /// The smallest F that a limit allows, and its text, where it is below the programmed one.
    lower: Option<(f64, String)>,
    /// Bytes of its F word, if it has one.
    own: Option<Range<usize>>,
    /// Bytes of its last word.
    last: Option<Range<usize>>,
    /// Reason why its F must stay.
    obstacle: Option<&'static str>,
}

impl Moved {
    /// F of the line if it is written, with its text.
    fn number(&self) -> (f64, String) {
        let [least, _] = self.programmed;
        let lower = self.lower.clone().filter(|(number, _)| *number < least);
        lower.unwrap_or_else(|| (least, least.to_string()))
    }

    fn is_lowered(&self) -> bool {
        self.number().0 < self.programmed[1]
    }

    /// Writes F into the line.
    fn edit(&self, line: &[u8]) -> Result<Edit, RefeedError> {
        let (_, text) = self.number();
        let fixed = |reason| Err(RefeedError::Fixed(self.place, reason));
        match (&self.own, &self.last) {
            (Some(own), _) if !is_number(line, own) => fixed(EXPRESSION),
            (Some(own), _) => Ok(Edit::replace(line, own, &text)),
            (None, Some(last)) if has_room(line, MAX_LINE_BYTES) => {
                Ok(Edit::insert(line, last, &text))
            }
            _ => fixed(NO_ROOM),
        }
    }
}

/// True if the word at `columns` is a letter and a number.
fn is_number(line: &[u8], columns: &Range<usize>) -> bool {
    let number = line.get(columns.start + 1..columns.end).unwrap_or_default();
    number.iter().all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'+' | b'-' | b' '))
}

/// Record of an execution of the program.
#[derive(Debug, Default)]
struct Survey {
    limits: BTreeMap<u32, Limit>,
    lines: BTreeMap<LineKey, Moved>,
    /// Lines without F after the line whose F they have, with the feed that is programmed; none if there are several.
    follows: BTreeMap<(LineKey, LineKey), Option<Feed>>,
    /// What no F changes, by line.
    unrepaired: BTreeMap<(LineKey, u8), Unrepaired>,
    /// Where F is more than a number that stays in force, and why.
    obstacle: Option<(Place, &'static str)>,
    /// The last F that counts, and its units.
    programmed: Option<(f64, LengthUnit)>,
    /// The last line with F or a cut.
    before: Option<LineKey>,
}

impl Survey {
    /// Executes `program`.
    fn execute(&mut self, program: &[u8], options: &DecoderOptions) -> Result<(), RefeedError> {
        let mut decoder = Decoder::new(program, options.clone());
        // A compensated move comes with the next line. Its feed is that of the programmed one.
        decoder.state.ignore_compensation();
        while !decoder.ended {
            let units = decoder.state.units;
            decoder.step().map_err(RefeedError::Read)?;
            let moves = Moves::of(&mut decoder);
            let place = decoder.out.place;
            if matches!(decoder.block.m.modes, Some(70..=73)) {
                self.obstacle.get_or_insert((place, RESTORED));
            }
            let inverse = decoder.state.feed_mode == FeedMode::InverseTime;
            let word = decoder.block.get(Letter::F).filter(|f| (0.0..=MAX_FEED).contains(f));
            if (word.is_some() || moves.cut.is_some()) && is_suppressed(decoder.text()) {
                self.obstacle.get_or_insert((place, SUPPRESSED));
            }
            if let Some(number) = word.filter(|_| !inverse) {
                self.programmed = Some((number, units));
                self.before = Some(place.key());
            }
            self.include(&decoder, &moves, units);
        }
        Ok(())
    }

    /// Adds the execution of a line.
    fn include<R>(&mut self, decoder: &Decoder<R>, moves: &Moves, units: LengthUnit) {
        let place = decoder.out.place;
        let limit = self.limits.get(&place.line).copied().unwrap_or_default();
        if let Some(rapid) = moves.rapid.filter(|rapid| is_below(limit.rapid, *rapid)) {
            self.stays(place, Reason::Rapid, rapid, limit.rapid);
        }
        let Some(cut) = moves.cut else { return };
        let motion = decoder.state.motion;
        let threads = matches!(motion, Motion::Thread(_));
        let taps = threads || matches!(motion, Motion::Cycle(cycle) if cycle.taps());
        let mut below = is_below(limit.feed, cut.feed);
        if taps && below {
            self.stays(place, Reason::Thread, cut.feed, limit.feed);
        }
        if threads {
            return;
        }
        below &= !taps;
        let lower = if below { rounded_down(cut.number(limit.feed, units)) } else { None };
        if below && lower.is_none() {
            self.stays(place, Reason::NoFeed, cut.feed, limit.feed);
        }
        let inverse = decoder.state.feed_mode == FeedMode::InverseTime;
        if let (Some(before), false, None) = (self.before, inverse, decoder.block.get(Letter::F)) {
            let feed = decoder.state.feed;
            let known = self.follows.entry((before, place.key())).or_insert(feed);
            *known = known.filter(|known| Some(*known) == feed);
        }
        if !inverse {
            self.before = Some(place.key());
        }
        let mode = (decoder.state.feed_mode != FeedMode::PerMinute).then_some(MODE);
        let obstacle = place.within.map(|_| IN_FILE).or(mode);
        self.add(decoder, cut, (place, units), (lower, obstacle));
    }

    /// Adds an execution of a line that cuts.
    fn add<R>(
        &mut self,
        decoder: &Decoder<R>,
        cut: Cut,
        (place, units): (Place, LengthUnit),
        (lower, obstacle): (Option<(f64, String)>, Option<&'static str>),
    ) {
        let number = cut.as_programmed(self.programmed, units);
        // Limits of a subroutine file are those of its call.
        let shown = if place.within.is_some() { Place::at(place.line) } else { place };
        let moved = self.lines.entry(place.key()).or_insert_with(|| Moved {
            place: shown,
            units,
            programmed: [number; 2],
            lower: None,
            own: decoder.block.get(Letter::F).and(decoder.block.columns(Letter::F)),
            last: decoder.block.last_columns(),
            obstacle: None,
        });
        let [least, most] = moved.programmed;
        moved.programmed = [least.min(number), most.max(number)];
        if let Some((number, text)) = lower
            && moved.lower.as_ref().is_none_or(|(least, _)| number < *least)
        {
            moved.lower = Some((number, text));
        }
        let units = (units != moved.units).then_some(UNITS);
        moved.obstacle = moved.obstacle.or(obstacle).or(units);
    }

    /// Remembers the worst execution of a line that no F changes.
    fn stays(&mut self, place: Place, reason: Reason, programmed: f64, limit: f64) {
        let unrepaired = Unrepaired { place, reason, programmed, limit };
        let known = self.unrepaired.entry((place.key(), reason as u8)).or_insert(unrepaired);
        known.programmed = known.programmed.max(programmed);
    }

    fn report(&self, refed: &mut Refed) {
        self.unrepaired.values().for_each(|unrepaired| refed.report(*unrepaired));
    }

    /// Lines whose F must be written: those with a lower limit, and those that would have the F of such a line.
    fn changed(&self) -> BTreeSet<LineKey> {
        let lowered = self.lines.iter().filter(|(_, moved)| moved.lower.is_some());
        let mut changed: BTreeSet<LineKey> = lowered.map(|(key, _)| *key).collect();
        let mut next: Vec<LineKey> = changed.iter().copied().collect();
        let first = (0, None);
        while let Some(before) = next.pop() {
            let Some(moved) = self.lines.get(&before) else { continue };
            let written = Feed::per_minute(moved.number().0, moved.units);
            for ((_, key), programmed) in
                self.follows.range((before, first)..).take_while(|((from, _), _)| *from == before)
            {
                let is_there = programmed.is_some_and(|feed| {
                    is_same(feed.linear, written.linear) && is_same(feed.rotary, written.rotary)
                });
                if !is_there && changed.insert(*key) {
                    next.push(*key);
                }
            }
        }
        changed
    }
}
