//! Loop avoidance: cuts loops off paths that cross themselves (`SMC_AvoidLoop`, manual 6.2.4).

mod crossing;

use self::crossing::{Meeting, Track};
use super::piece::{self, Station};
use super::{Notice, Notices};
use crate::{ElementKind, Marks, PathElement, Switch};
use std::collections::VecDeque;
use std::num::NonZeroUsize;

/// Elements among which [`AvoidLoops`] looks for crossings when nothing else is asked for.
pub const DEFAULT_LOOP_WINDOW: NonZeroUsize = match NonZeroUsize::new(100) {
    Some(window) => window,
    None => NonZeroUsize::MIN,
};

/// Cuts loops off the path (`SMC_AvoidLoop`) from an element marked [`Marks::LOOPS`] (G61) to one marked
/// [`Marks::LOOPS_END`] (G60).
///
/// Where the element at hand is crossed by one of those after it, it ends at the crossing, what lies between is
/// dropped, and the path goes on with the other from there. Of several crossings the first along the element counts.
/// [`Notice::LoopCut`] tells each.
///
/// A crossing is a point where the path leaves on the other side of itself: neither one where it only touches or runs
/// along itself, nor one of two corners, so that a closed contour stays, with or without a way in and out at its
/// corner. It is a point in space: paths at different heights do not cross. Positionings (G0) neither cross nor are
/// crossed, and no loop reaches over a jump (G92) or an error. Lines and arcs are cut exactly, curves to rounding after
/// a search along arcs within a micrometre of them.
///
/// M functions and dwells in a loop are not dropped: they are done at the crossing, in their order. So are the
/// switches, as far as the element there has room ([`Notice::SwitchLost`]). Extra axes go on linearly from where they
/// are at the crossing.
///
/// Memory, and the longest loop that is found, are bounded by the window, as in the manual by the size of its queue.
#[derive(Debug)]
pub struct AvoidLoops<I, E> {
    upstream: I,
    window: usize,
    notices: Notices,
    active: bool,
    queue: VecDeque<Slot<E>>,
    /// Slots in the queue that no loop reaches over.
    walls: usize,
    ready: VecDeque<Result<PathElement, E>>,
    ended: bool,
}

#[derive(Debug)]
struct Slot<E> {
    item: Result<PathElement, E>,
    /// Its path, if it can cross and be crossed.
    track: Option<Track>,
    /// No loop goes on behind it.
    wall: bool,
}

impl<I, E> AvoidLoops<I, E>
where
    I: Iterator<Item = Result<PathElement, E>>,
{
    /// Looks for loops of `upstream` of up to [`DEFAULT_LOOP_WINDOW`] elements.
    pub fn new(upstream: I, notices: Notices) -> Self {
        Self::with_window(upstream, DEFAULT_LOOP_WINDOW, notices)
    }

    /// Looks for loops of up to `window` elements.
    pub fn with_window(upstream: I, window: NonZeroUsize, notices: Notices) -> Self {
        Self {
            upstream,
            window: window.get(),
            notices,
            active: false,
            queue: VecDeque::new(),
            walls: 0,
            ready: VecDeque::new(),
            ended: false,
        }
    }

    /// True if loops are avoided behind the element taken in last (`iStatus`: `AL_ON`, else `AL_OFF`).
    pub fn is_on(&self) -> bool {
        self.active
    }

    /// Takes one more item into the queue.
    fn pull(&mut self) {
        let slot = match self.upstream.next() {
            None => {
                self.ended = true;
                return;
            }
            Some(Err(error)) => Slot { item: Err(error), track: None, wall: true },
            Some(Ok(mut element)) => {
                self.active |= element.marks.contains(Marks::LOOPS);
                let inside = self.active;
                let ends = element.marks.contains(Marks::LOOPS_END);
                if inside {
                    element.marks = element.marks.without(Marks::LOOPS).without(Marks::LOOPS_END);
                    self.active = !ends;
                }
                let track = if inside { Track::of(&element) } else { None };
                // What a probe has been sent to feel is not left out.
                let barred = matches!(element.kind, ElementKind::Jump | ElementKind::Probe { .. });
                let wall = !inside || ends || barred;
                Slot { item: Ok(element), track, wall }
            }
        };
        self.walls += usize::from(slot.wall);
        self.queue.push_back(slot);
    }

    /// Cuts the loop that begins on the first element of the queue; false if there is none.
    fn cut(&mut self) -> bool {
        let Some((meeting, index)) = self.first_meeting() else { return false };
        let mut slots = self.queue.drain(..=index);
        let first = slots.next().and_then(|slot| slot.item.ok());
        let resumed = slots.next_back();
        let dropped: Vec<_> = slots.collect();
        let Some((first, Slot { item: Ok(last), wall, .. })) = first.zip(resumed) else {
            return false;
        };
        self.walls -= usize::from(wall);
        let Meeting { s, t } = meeting;
        let lengths = [first.shape.length(), last.shape.length()];
        let mut length = lengths[0] - s + t;

        let mut before = piece::section(&first, 0.0, s);
        let mut after = piece::section(&last, t, lengths[1]);
        piece::end_at(&mut before, after.start());
        let here = Station::end(&before);
        piece::set_start_extra(&mut after, here.extra);
        let mut carry = |switch: Switch, from: &PathElement| {
            let switch = Switch { at: 0.0, ..switch };
            piece::add_switch(&mut after, switch, from.place, &self.notices);
        };
        for switch in piece::part_of_switches(&first, s, lengths[0], s, lengths[0]) {
            carry(switch, &first);
        }
        let mut marks = Marks::default();
        let mut waiting = Vec::new();
        for mut element in dropped.into_iter().filter_map(|slot| slot.item.ok()) {
            if !element.kind.is_motion() {
                piece::relocate(&mut element, &here);
                waiting.push(element);
                continue;
            }
            length += element.shape.length();
            marks = marks.with(element.marks);
            for switch in element.switches() {
                carry(*switch, &element);
            }
        }
        for switch in piece::part_of_switches(&last, 0.0, t, 0.0, t) {
            carry(switch, &last);
        }
        let ends = piece::end_marks(marks);
        before.marks = before.marks.with(ends);
        after.marks = after.marks.with(marks.without(ends));
        self.notices.add(Notice::LoopCut { place: first.place, resumed: last.place, length });
        self.ready.push_back(Ok(before));
        self.ready.extend(waiting.into_iter().map(Ok));
        // Of an element that is crossed at its end nothing may be left.
        if t < lengths[1] || after.details.is_some() || after.marks != Marks::default() {
            let track = Track::of(&after);
            self.queue.push_front(Slot { item: Ok(after), track, wall });
            self.walls += usize::from(wall);
        }
        true
    }

    /// The first point along the first element of the queue at which a later one crosses it, and the number of that.
    fn first_meeting(&self) -> Option<(Meeting, usize)> {
        let slot = |index: usize| self.queue.get(index);
        let track = |index: usize| slot(index)?.track.as_ref();
        let element = |index: usize| slot(index)?.item.as_ref().ok();
        let front = (element(0)?, track(0)?);
        // Where the walk has come to behind the end of the first element, m.
        let mut walked = 0.0;
        let mut found: Option<(Meeting, usize)> = None;
        let mut index = 0;
        while !slot(index)?.wall {
            index += 1;
            let Some(later) = element(index) else { break };
            if let Some(track) = track(index).filter(|track| track.is_near(front.1)) {
                let neighbours = [self.next_track(0), self.next_track(index)];
                let meeting = crossing::first(front, (later, track), neighbours, walked);
                let sooner = |new: &Meeting| {
                    found.as_ref().is_none_or(|(old, _)| new.s <= old.s + piece::POINT_EPS)
                };
                if let Some(meeting) = meeting.filter(sooner) {
                    found = Some((meeting, index));
                }
            }
            walked += later.length();
        }
        found
    }

    /// The next element behind the one with this number that has a path, if the queue has it yet.
    fn next_track(&self, index: usize) -> Option<&PathElement> {
        let mut behind = self.queue.iter().skip(index);
        while !behind.next()?.wall {
            let slot = behind.clone().next()?;
            if slot.track.is_some() {
                return slot.item.as_ref().ok();
            }
        }
        None
    }
}

impl<I, E> Iterator for AvoidLoops<I, E>
where
    I: Iterator<Item = Result<PathElement, E>>,
{
    type Item = Result<PathElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(item) = self.ready.pop_front() {
                return Some(item);
            }
            let crossable = match self.queue.front() {
                None if self.ended => return None,
                None => {
                    self.pull();
                    continue;
                }
                Some(front) => front.track.is_some(),
            };
            let complete = self.walls > 0 || self.ended || self.queue.len() > self.window;
            if crossable && !complete {
                self.pull();
                continue;
            }
            if crossable && self.cut() {
                continue;
            }
            let slot = self.queue.pop_front()?;
            self.walls -= usize::from(slot.wall);
            return Some(slot.item);
        }
    }
}
