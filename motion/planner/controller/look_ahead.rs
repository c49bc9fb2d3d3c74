//! Look-ahead: transition velocities that can be reached, and from which the path can still stop.

use super::Source;
use super::braking::Braking;
use super::profile::{Limits, Profile};
use std::collections::VecDeque;
use std::num::NonZeroUsize;
use std::task::Poll;
use twin_path::prepare::CheckedElement;

/// Elements looked at at once when nothing else is asked for: 0.4 m of segments of 0.1 mm, enough to stop from
/// 0.9 m/s with 1 m/s².
pub const DEFAULT_WINDOW: NonZeroUsize = match NonZeroUsize::new(4096) {
    Some(window) => window,
    None => NonZeroUsize::MIN,
};

/// A path element with the velocities at its two ends.
///
/// Each is within reach of the other with the element's own acceleration and deceleration, and the end velocity is
/// the start velocity of the next element.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedElement {
    element: CheckedElement,
    start_velocity: f64,
    end_velocity: f64,
}

impl PlannedElement {
    /// The element.
    pub fn element(&self) -> &CheckedElement {
        &self.element
    }

    /// Velocity at the start, m/s.
    pub fn start_velocity(&self) -> f64 {
        self.start_velocity
    }

    /// Velocity at the end, m/s; at most the element's [`twin_path::PathElement::end_velocity`].
    pub fn end_velocity(&self) -> f64 {
        self.end_velocity
    }

    /// The fastest profile between the two.
    pub fn profile(&self) -> Profile {
        let limits = Limits::of(&self.element, 1.0);
        Profile::new(self.element.path_length(), self.start_velocity, self.end_velocity, limits)
    }
}

/// Plans the velocities at the transitions: the fastest ones from which every later transition velocity can still be
/// met with the elements' own decelerations, and which their accelerations can reach (manual 6.2.7 and 6.2.9).
///
/// An element is handed out as soon as nothing that could still come would change its plan: when what is known of
/// the path behind it is long enough to stop on, or holds a stop anyway. So the result is that of infinite look-ahead,
/// however long the program. When the window is full before that, or upstream has nothing yet, the element is planned
/// so that the path can stop at the end of what is known; a larger window is faster there, never safer.
///
/// At an error from upstream the path stops; the error follows, and the next element starts from rest.
///
/// # How
///
/// All velocities are squared (`_v2`), where braking over a length adds 2·d·length. What the path behind an
/// element's end asks of the velocity there is a function of the velocity at the window's end,
/// `x ↦ min(cap, x + gain)` (`Braking`). These functions are closed under composition, so the window is a queue
/// with an aggregate, kept by the two-stack method: the older part of the queue stores for each element the function
/// from there to the end of that part, the newer part is one function. Every element is folded twice, whatever the
/// size of the window.
#[derive(Debug)]
pub struct LookAhead<I, E> {
    upstream: I,
    window: usize,
    queue: VecDeque<Queued>,
    /// How many elements at the front of the queue belong to its older part.
    folded: usize,
    /// The newer part of the queue as one function.
    newer: Braking,
    /// Velocity at the front of the queue, and its square.
    velocity: f64,
    velocity_v2: f64,
    boundary: Boundary<E>,
    /// Factor on all velocities.
    scale: f64,
    /// Every element ends at rest.
    stepping: bool,
    /// The last plan would be faster if more of the path were known.
    limited: bool,
    /// The upstream had nothing when it was last asked.
    starved: bool,
    /// How many elements at the front of the queue [`Self::find`] has looked at in vain.
    searched: usize,
}

/// Continuation after the newest element in the queue.
#[derive(Debug)]
enum Boundary<E> {
    Unknown,
    Failure(E),
    End,
}

#[derive(Debug)]
pub(super) struct Queued {
    pub(super) element: CheckedElement,
    /// Largest velocity at its end: that of the element times the override, or 0 where it is stepped.
    pub(super) end_velocity: f64,
    braking: Braking,
    /// `braking` composed with that of all behind it in the older part of the queue.
    suffix: Braking,
}

/// Answer to [`LookAhead::take`].
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "taken apart at once")]
pub(super) enum Taken<E> {
    /// The next element, and the velocity at its end as far as it itself is concerned.
    Element(CheckedElement, f64),
    /// An error, then perhaps more.
    Failure(E),
    /// Upstream has nothing yet.
    NotYet,
    End,
}

/// Answer to [`LookAhead::ahead`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ahead {
    Path,
    Failure,
    NotYet,
    End,
}

impl<I, E> LookAhead<I, E>
where
    I: Source<Item = Result<CheckedElement, E>>,
{
    /// Looks ahead over at most [`DEFAULT_WINDOW`] elements.
    pub fn new(upstream: I) -> Self {
        Self::with_window(upstream, DEFAULT_WINDOW)
    }

    /// Looks ahead over at most `window` elements: the bound on memory.
    pub fn with_window(upstream: I, window: NonZeroUsize) -> Self {
        Self {
            upstream,
            window: window.get(),
            queue: VecDeque::new(),
            folded: 0,
            newer: Braking::NONE,
            velocity: 0.0,
            velocity_v2: 0.0,
            boundary: Boundary::Unknown,
            scale: 1.0,
            stepping: false,
            limited: false,
            starved: false,
            searched: 0,
        }
    }

    /// True if the latest plan would be faster if more of the path were known: the window is too small
    /// (`SMC_WAR_INT_OUTQUEUE_TOO_SMALL`, warning 1080; stops are kept nevertheless) or upstream has nothing yet.
    pub fn limited(&self) -> bool {
        self.limited
    }

    /// True if upstream had nothing when it was last asked (`SMC_INT_DATA_UNDERRUN`, 1003).
    pub fn starved(&self) -> bool {
        self.starved
    }

    pub(super) fn set_limited(&mut self, limited: bool) {
        self.limited = limited && matches!(self.boundary, Boundary::Unknown);
    }

    /// Known part of the path.
    pub(super) fn known(&self) -> impl Iterator<Item = &Queued> {
        self.queue.iter()
    }

    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    pub(super) fn stepping(&self) -> bool {
        self.stepping
    }

    fn queued(&self, element: CheckedElement, stepped: bool) -> Queued {
        let end_velocity = if stepped { 0.0 } else { self.scale * element.end_velocity };
        let braking = Braking::over(&element, end_velocity);
        Queued { element, end_velocity, braking, suffix: Braking::NONE }
    }

    /// Takes one more element from upstream into the queue; false if there is none, none yet, or no room.
    pub(super) fn pull(&mut self) -> bool {
        if self.queue.len() >= self.window || !matches!(self.boundary, Boundary::Unknown) {
            return false;
        }
        self.starved = false;
        match self.upstream.poll_next() {
            Poll::Ready(Some(Ok(element))) => {
                let queued = self.queued(element, self.stepping);
                self.newer = self.newer.then(queued.braking);
                self.queue.push_back(queued);
                return true;
            }
            Poll::Ready(Some(Err(error))) => self.boundary = Boundary::Failure(error),
            Poll::Ready(None) => self.boundary = Boundary::End,
            Poll::Pending => self.starved = true,
        }
        false
    }

    /// True if the queue takes nothing more now, except that it may be starved.
    pub(super) fn is_full(&self) -> bool {
        self.queue.len() >= self.window || !matches!(self.boundary, Boundary::Unknown)
    }

    /// State of the path ahead: known, not known yet, failed or ended.
    pub(super) fn ahead(&mut self) -> Ahead {
        if self.queue.is_empty() && !self.pull() {
            return match self.boundary {
                Boundary::Unknown => Ahead::NotYet,
                Boundary::Failure(_) => Ahead::Failure,
                Boundary::End => Ahead::End,
            };
        }
        Ahead::Path
    }

    /// The first that `wanted` finds on the path ahead, as far as it is known or can be taken into the window now. Until
    /// it is found no element is looked at twice, so it must always be the same `wanted`.
    pub(super) fn find<T>(&mut self, wanted: impl Fn(&CheckedElement) -> Option<T>) -> Option<T> {
        loop {
            while let Some(queued) = self.queue.get(self.searched) {
                if let Some(found) = wanted(&queued.element) {
                    return Some(found);
                }
                self.searched += 1;
            }
            // What the plan waits for, the plan shall see come.
            if self.limited {
                return None;
            }
            let starved = self.starved;
            if !self.pull() {
                // The path itself needs no more.
                self.starved = starved;
                return None;
            }
        }
    }

    /// Takes the front element.
    pub(super) fn take(&mut self) -> Taken<E> {
        match self.ahead() {
            Ahead::Path => {}
            Ahead::NotYet => return Taken::NotYet,
            Ahead::End => return Taken::End,
            Ahead::Failure => {
                let boundary = std::mem::replace(&mut self.boundary, Boundary::Unknown);
                return match boundary {
                    Boundary::Failure(error) => Taken::Failure(error),
                    Boundary::Unknown | Boundary::End => Taken::End,
                };
            }
        }
        if self.folded == 0 {
            self.fold();
        }
        self.folded = self.folded.saturating_sub(1);
        self.searched = self.searched.saturating_sub(1);
        match self.queue.pop_front() {
            Some(queued) => Taken::Element(queued.element, queued.end_velocity),
            None => Taken::End,
        }
    }

    /// Gives the front element back.
    pub(super) fn put_back(&mut self, element: CheckedElement) {
        self.searched = 0;
        if self.folded == 0 {
            self.fold();
        }
        let mut queued = self.queued(element, self.stepping);
        let behind = self.queue.front().map_or(Braking::NONE, |front| front.suffix);
        queued.suffix = queued.braking.then(behind);
        self.queue.push_front(queued);
        self.folded += 1;
    }

    /// Sets the factor on all velocities.
    pub(super) fn set_scale(&mut self, scale: f64) {
        self.scale = scale;
        for queued in &mut self.queue {
            let stepped = queued.end_velocity <= 0.0;
            let end_velocity = if stepped { 0.0 } else { scale * queued.element.end_velocity };
            queued.end_velocity = end_velocity;
            queued.braking = Braking::over(&queued.element, end_velocity);
        }
        self.fold();
    }

    /// From now on no element ends at rest that need not.
    pub(super) fn stop_stepping(&mut self) {
        self.stepping = false;
        for queued in &mut self.queue {
            queued.end_velocity = self.scale * queued.element.end_velocity;
            queued.braking = Braking::over(&queued.element, queued.end_velocity);
        }
        self.fold();
    }

    /// From now on every element ends at rest: from the first in the queue on that can, if its start is passed with a
    /// velocity whose stop needs `needs_more` of the length at its disposal.
    pub(super) fn step(&mut self, mut needs_more: impl FnMut(&CheckedElement) -> bool) {
        self.stepping = true;
        let mut passing = true;
        for queued in &mut self.queue {
            passing = passing && needs_more(&queued.element);
            if !passing {
                queued.end_velocity = 0.0;
                queued.braking = Braking::over(&queued.element, 0.0);
            }
        }
        self.fold();
    }

    /// Makes the whole queue the older part.
    fn fold(&mut self) {
        let mut suffix = Braking::NONE;
        for queued in self.queue.iter_mut().rev() {
            suffix = queued.braking.then(suffix);
            queued.suffix = suffix;
        }
        self.folded = self.queue.len();
        self.newer = Braking::NONE;
    }

    /// Braking bound of the known path at its front.
    fn asked(&self) -> Braking {
        match self.queue.front() {
            Some(front) if self.folded > 0 => front.suffix.then(self.newer),
            _ => self.newer,
        }
    }

    /// Squared velocity at the end of `element`, which is no longer in the queue, `remaining` before its end at
    /// `velocity_v2`. It ends with at most `end_velocity`. If the path is too fast for that (`over`), it brakes all the
    /// way, and keeps the stops.
    pub(super) fn plan(
        &mut self,
        element: &CheckedElement,
        remaining: f64,
        velocity_v2: f64,
        end_velocity: f64,
        over: &mut bool,
    ) -> f64 {
        self.limited = false;
        if !element.has_path() {
            return 0.0;
        }
        let reach_v2 = velocity_v2 + 2.0 * element.acceleration * remaining;
        let own_v2 = reach_v2.min(end_velocity * end_velocity);
        let braked_v2 = velocity_v2 - 2.0 * element.deceleration * remaining;
        loop {
            if self.folded == 0 {
                self.fold();
            }
            let asked = self.asked();
            // With no bound on the velocity at the window's end; then with rest there. Where the two agree, what
            // lies beyond the window does not matter.
            let free_v2 = own_v2.min(asked.cap_v2);
            let end_v2 = free_v2.min(asked.gain_v2);
            self.limited = end_v2 < free_v2;
            // The element under way counts.
            if self.limited && self.queue.len() + 1 < self.window && self.pull() {
                continue;
            }
            // The end may have become known just now.
            self.set_limited(self.limited);
            if *over && braked_v2 > end_v2 && end_velocity > 0.0 {
                return braked_v2.min(asked.stop_v2).min(asked.gain_v2).max(end_v2);
            }
            *over = false;
            return end_v2;
        }
    }
}

impl<I, E> Iterator for LookAhead<I, E>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
{
    type Item = Result<PlannedElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.take() {
            Taken::Element(element, end_velocity) => {
                let length = element.path_length();
                let end_v2 =
                    self.plan(&element, length, self.velocity_v2, end_velocity, &mut false);
                let start_velocity = self.velocity;
                self.velocity_v2 = end_v2;
                self.velocity = end_v2.sqrt();
                Some(Ok(PlannedElement { element, start_velocity, end_velocity: self.velocity }))
            }
            Taken::Failure(error) => Some(Err(error)),
            Taken::NotYet | Taken::End => None,
        }
    }
}
