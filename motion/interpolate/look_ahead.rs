//! Look-ahead: which velocities at the transitions can really be reached, and stopped from.

use super::profile::{Limits, Profile};
use crate::prepare::CheckedElement;
use std::collections::VecDeque;
use std::num::NonZeroUsize;

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

    /// Velocity at the end, m/s; at most the element's [`crate::path::PathElement::end_velocity`].
    pub fn end_velocity(&self) -> f64 {
        self.end_velocity
    }

    /// The fastest profile between the two.
    pub fn profile(&self) -> Profile {
        let limits = Limits {
            feed: self.element.feed,
            acceleration: self.element.acceleration,
            deceleration: self.element.deceleration,
        };
        Profile::new(self.element.path_length(), self.start_velocity, self.end_velocity, limits)
    }
}

/// Plans the velocities at the transitions: the fastest ones from which every later transition velocity can still be
/// met with the elements' own decelerations, and which their accelerations can reach (manual 6.2.7 and 6.2.9).
///
/// An element is handed out as soon as nothing that could still come would change its plan: when what is known of
/// the path behind it is long enough to stop on, or holds a stop anyway. So the result is that of infinite look-ahead,
/// however long the program. When the window is full before that, the element is planned so that the path can stop
/// at the window's end; a larger window is faster there, never safer.
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
}

/// What comes after the newest element in the queue.
#[derive(Debug)]
enum Boundary<E> {
    Unknown,
    Failure(E),
    End,
}

#[derive(Debug)]
struct Queued {
    element: CheckedElement,
    braking: Braking,
    /// `braking` composed with that of all behind it in the older part of the queue.
    suffix: Braking,
}

/// Largest squared velocity at the start of a piece of path as a function of the one at its end:
/// `x ↦ min(cap, x + gain)`.
#[derive(Clone, Copy, Debug)]
struct Braking {
    cap_v2: f64,
    gain_v2: f64,
}

impl Braking {
    /// A piece of length zero.
    const NONE: Self = Self { cap_v2: f64::INFINITY, gain_v2: 0.0 };

    fn over(element: &CheckedElement) -> Self {
        // Without a path there are no limits to multiply with.
        let gain_v2 = if element.has_path() {
            2.0 * element.deceleration * element.path_length()
        } else {
            0.0
        };
        Self { cap_v2: element.end_velocity * element.end_velocity + gain_v2, gain_v2 }
    }

    /// This piece followed by `later`.
    fn then(self, later: Self) -> Self {
        Self {
            cap_v2: self.cap_v2.min(later.cap_v2 + self.gain_v2),
            gain_v2: self.gain_v2 + later.gain_v2,
        }
    }
}

impl<I, E> LookAhead<I, E>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
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
        }
    }

    /// Takes one more element from upstream into the queue.
    fn pull(&mut self) {
        match self.upstream.next() {
            Some(Ok(element)) => {
                let braking = Braking::over(&element);
                self.newer = self.newer.then(braking);
                self.queue.push_back(Queued { element, braking, suffix: Braking::NONE });
            }
            Some(Err(error)) => self.boundary = Boundary::Failure(error),
            None => self.boundary = Boundary::End,
        }
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

    /// What the path behind the front element asks of the velocity at its end.
    fn ahead(&self) -> Braking {
        match self.queue.get(1) {
            Some(second) if self.folded > 1 => second.suffix.then(self.newer),
            _ => self.newer,
        }
    }
}

impl<I, E> Iterator for LookAhead<I, E>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
{
    type Item = Result<PlannedElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if self.folded == 0 {
                self.fold();
            }
            let more = matches!(self.boundary, Boundary::Unknown);
            let Some(front) = self.queue.front() else {
                if more {
                    self.pull();
                    continue;
                }
                return match std::mem::replace(&mut self.boundary, Boundary::Unknown) {
                    Boundary::Failure(error) => Some(Err(error)),
                    Boundary::End | Boundary::Unknown => {
                        self.boundary = Boundary::End;
                        None
                    }
                };
            };
            let element = &front.element;
            let reach_v2 = if element.has_path() {
                self.velocity_v2 + 2.0 * element.acceleration * element.path_length()
            } else {
                0.0
            };
            let ahead = self.ahead();
            // With no bound on the velocity at the window's end; then with rest there. Where the two agree, what
            // lies beyond the window does not matter.
            let free_v2 =
                reach_v2.min(element.end_velocity * element.end_velocity).min(ahead.cap_v2);
            let end_v2 = free_v2.min(ahead.gain_v2);
            if end_v2 < free_v2 && more && self.queue.len() < self.window {
                self.pull();
                continue;
            }
            self.folded -= 1;
            let Queued { element, .. } = self.queue.pop_front()?;
            let start_velocity = self.velocity;
            self.velocity_v2 = end_v2;
            self.velocity = end_v2.sqrt();
            return Some(Ok(PlannedElement {
                element,
                start_velocity,
                end_velocity: self.velocity,
            }));
        }
    }
}
