//! Blended path (the course): the path of time-optimal planning, without steps of its derivatives.
//!
//! An axis that follows x(s(t)) has the velocity x′·ṡ and the acceleration x″·ṡ² + x′·s̈: a step of x′ is a step of the
//! velocity at every feed, and a step of x″ (line to arc) is a step of the acceleration. [`BlendedPath`] replaces the path
//! near such joints by a [`Blend`], a polynomial within a tolerance, and keeps the parameter: s is the length of the
//! original element everywhere, so switches, blocks and lengths keep their places.

mod blend;
mod deviation;
mod element;
mod joint;
#[cfg(test)]
mod tests;
mod turn;
mod width;

pub use blend::Blend;
pub use element::{BlendedElement, BlendedPoint, Transition};
pub use joint::Joint;
pub use turn::{Bearing, BearingDisc};

use joint::Steps;
use std::collections::VecDeque;
use std::sync::Arc;
use turn::Held;
use twin_path::prepare::{CheckedElement, curvature};

/// Velocities that differ by no more than this part of them are the same.
const SAME_FEED: f64 = 1e-9;
/// Number of elements searched for the first direction of the path.
const LOOK_AHEAD: usize = 256;

/// Order of the derivatives whose steps are blended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Order {
    /// Those of the first derivative: corners, and where an extra axis starts. Accelerations may step.
    Velocity,
    /// Those of the second derivative, too: joints of lines and arcs. What planning with jerk limits needs.
    #[default]
    Acceleration,
    /// Those of the third derivative in space, too: what planning with jerk limits needs of a machine whose tool turns with
    /// the path, since its direction is a derivative already. Blends are septics.
    Jerk,
}

/// Options of the course: tolerances and order of blending.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlendOptions {
    /// Largest distance in space between course and path at the same parameter, m. At 0 (and below, and no number)
    /// nothing is blended.
    pub tolerance: f64,
    /// The same for each extra axis, u. At 0 joints at which the extra axes have a step are not blended.
    pub extra_tolerance: f64,
    /// Order of the derivatives whose steps are blended.
    pub order: Order,
    /// The tool turns with the path: where the direction of the path seen from above steps the path stops, and the course has
    /// a turn at rest ([`BlendedElement::is_turn`]) before it goes on. [`BlendedElement::bearing`] is its direction.
    pub turning: bool,
}

impl BlendOptions {
    /// Blends within `tolerance`, m, all steps up to the second derivative; with the same number in mm as the tolerance
    /// of the extra axes in u.
    pub fn new(tolerance: f64) -> Self {
        let (extra_tolerance, order) = (tolerance * 1e3, Order::default());
        Self { tolerance, extra_tolerance, order, turning: false }
    }

    /// True if a blend of these steps would be off the path at all while nothing may be.
    fn forbid(&self, steps: &Steps) -> bool {
        let exact = |tolerance: f64| tolerance.is_nan() || tolerance <= 0.0;
        exact(self.tolerance) || steps.extra_step() && exact(self.extra_tolerance)
    }
}

/// The course along the elements of `upstream`: an iterator of [`BlendedElement`]s, one for each [`CheckedElement`].
///
/// A joint is left as it is where
/// - the path stops: [`twin_path::PathElement::end_velocity`] is 0, as [`twin_path::prepare::CheckVelocities`] sets it
///   at rapids, M functions, dwells, jumps and elements without length, or nothing or an error follows;
/// - the derivatives agree up to rounding: to within 10⁻⁹ of themselves (curvatures: 10⁻⁹ per length of the shorter
///   element) and what the rounding of the coordinates makes of them;
/// - the tolerance is 0, or the elements are so short that the coordinates have less than three digits along them;
/// - the path folds back: the two directions differ by more than 168.5° (the cosine of half of that is a tenth), or a blend
///   would be travelled at less than a tenth of the parameter's speed somewhere. A stop is then asked for;
/// - the elements do not meet, by more than a nanometre (10⁻⁹ of an extra axis' position and at least 10⁻⁹ u). A stop
///   is asked for there as well.
///
/// [`BlendedElement::joint`] has what is left of a step.
///
/// With [`BlendOptions::turning`] the path also stops where its direction steps and no blend leads on, where it seen from
/// above folds back, and where it begins or ends to go straight up or down; arcs that stand upright are cut there.
///
/// One element is held back, since its end depends on the next; errors from upstream come in their place.
#[derive(Debug)]
pub struct BlendedPath<I, E> {
    upstream: I,
    options: BlendOptions,
    /// The newest element, its end not yet joined to anything.
    held: Option<BlendedElement>,
    /// What comes before that: a turn.
    turn: Option<BlendedElement>,
    /// An error that comes after the element just handed out.
    failure: Option<E>,
    /// What was taken from upstream ahead of its time.
    ahead: VecDeque<Result<CheckedElement, E>>,
    /// The direction at the end of the newest element, if the tool turns with the path and there is one.
    bearing: Option<f64>,
    ended: bool,
}

impl<I, E> BlendedPath<I, E>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
{
    /// The course along the elements of `upstream`.
    pub fn new(upstream: I, options: BlendOptions) -> Self {
        Self {
            upstream,
            options,
            held: None,
            turn: None,
            failure: None,
            ahead: VecDeque::new(),
            bearing: None,
            ended: false,
        }
    }

    fn pull(&mut self) -> Option<Result<CheckedElement, E>> {
        if !self.options.turning {
            return self.upstream.next();
        }
        if self.bearing.is_none() {
            let known = self.look_ahead();
            self.bearing = Some(known.unwrap_or_default());
        }
        if self.ahead.is_empty() {
            self.take_one();
        }
        self.ahead.pop_front()
    }

    /// Takes one more element from upstream, in parts if need be; its direction, if it has one.
    fn take_one(&mut self) -> Option<Result<Option<f64>, ()>> {
        Some(match self.upstream.next()? {
            Ok(element) => {
                let known = self.ahead.len();
                self.ahead.extend(turn::cut_upright(element).map(Ok));
                let mut new = self.ahead.range(known..).filter_map(|part| part.as_ref().ok());
                Ok(new.find_map(|part| turn::directions(part).map(|[first, _]| first)))
            }
            Err(error) => {
                self.ahead.push_back(Err(error));
                Err(())
            }
        })
    }

    /// The first direction of the path, as far as it is known.
    fn look_ahead(&mut self) -> Option<f64> {
        for _ in 0..LOOK_AHEAD {
            match self.take_one()? {
                Ok(None) => {}
                Ok(known) => return known,
                Err(()) => return None,
            }
        }
        None
    }

    /// `element`, which comes next, and the turn that has to come before it, unless a blend leads into it.
    fn turned(&mut self, element: CheckedElement) -> (BlendedElement, Option<BlendedElement>) {
        let mut next = BlendedElement::new(element);
        let Some(bearing) = self.bearing else { return (next, None) };
        let directions = turn::directions(next.element());
        let [start, end] = directions.unwrap_or([bearing; 2]);
        next.hold(Held { along: start, turn: 0.0 });
        self.bearing = Some(end);
        let turn = turn::turn_between(bearing, start);
        let turn = turn.map(|turn| BlendedElement::turn(next.element(), bearing, turn));
        (next, turn)
    }
}

impl<I, E> Iterator for BlendedPath<I, E>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
{
    type Item = Result<BlendedElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(error) = self.failure.take() {
            return Some(Err(error));
        }
        if let Some(turn) = self.turn.take() {
            return Some(Ok(turn));
        }
        while !self.ended {
            match self.pull() {
                Some(Ok(next)) => {
                    let (mut next, turn) = self.turned(next);
                    let element = self.held.take().map(|mut element| {
                        join(&mut element, &mut next, &self.options, turn.is_some());
                        element
                    });
                    self.held = Some(next);
                    match element {
                        Some(mut element) => {
                            if turn.is_some() && element.tail().is_none() {
                                element.stop();
                                self.turn = turn;
                            }
                            return Some(Ok(element));
                        }
                        None if turn.is_some() => return turn.map(Ok),
                        None => {}
                    }
                }
                Some(Err(error)) => match self.held.take() {
                    Some(element) => {
                        self.failure = Some(error);
                        return Some(Ok(element));
                    }
                    None => return Some(Err(error)),
                },
                None => self.ended = true,
            }
        }
        self.held.take().map(Ok)
    }
}

/// Leads the course from `element`, which ends in a stop so far, into `next`. `turns`: its direction seen from above turns.
fn join(
    element: &mut BlendedElement,
    next: &mut BlendedElement,
    options: &BlendOptions,
    turns: bool,
) {
    let (from, to) = (element.element(), next.element());
    if from.end_velocity <= 0.0 || !from.has_path() || !to.has_path() {
        return;
    }
    let jump = curvature(&to.shape, 0.0) - curvature(&from.shape, from.shape.length());
    let feed = from.feed.min(to.feed);
    let velocity = if from.end_velocity < feed * (1.0 - SAME_FEED) {
        from.end_velocity
    } else {
        f64::INFINITY
    };
    let transition = Transition { curvature_jump: jump.norm(), velocity };
    let steps = Steps::between(from, to, options.order);
    let left = if steps.apart() {
        Joint { stop: true, ..steps.joint() }
    } else if !steps.to_blend(options.order) || options.forbid(&steps) {
        steps.joint()
    } else if steps.folds() || options.turning && turn::turns_at_once(&steps, turns) {
        Joint { stop: true, ..steps.joint() }
    } else {
        match width::widest(from, to, element.head_end(), &steps, options) {
            Ok(blend) => {
                let blend = Arc::new(blend);
                element.lead_out(Arc::clone(&blend));
                next.lead_in(blend);
                element.pass_into(next, transition);
                return;
            }
            Err(width::NoBlend::Folds) => Joint { stop: true, ..steps.joint() },
            Err(width::NoBlend::TooShort) => steps.joint(),
        }
    };
    element.leave(left);
    element.pass_into(next, transition);
}
