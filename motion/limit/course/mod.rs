//! The course: the path as feed limiting plans on it, without steps of its derivatives.
//!
//! An axis that follows x(s(t)) has the velocity x′·ṡ and the acceleration x″·ṡ² + x′·s̈: where x′ steps the velocity
//! does at every feed, and where x″ steps (line to arc) the acceleration does. [`Course`] replaces the path about such
//! joints by a [`Blend`], a quintic within a tolerance, and keeps the parameter: s is the length of the original
//! element everywhere, so that switches, blocks and the way are attributed as before.

mod blend;
mod element;
mod joint;
#[cfg(test)]
mod tests;
mod width;

pub use blend::Blend;
pub use element::{CourseElement, CoursePoint, Transition};
pub use joint::Joint;

use crate::prepare::{CheckedElement, curvature};
use joint::Steps;
use std::sync::Arc;

/// Velocities that differ by no more than this part of them are the same.
const SAME_FEED: f64 = 1e-9;

/// Which steps are blended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Order {
    /// Those of the first derivative: corners, and where an extra axis starts. Accelerations may step.
    Velocity,
    /// Those of the second derivative, too: joints of lines and arcs. What planning with jerk limits needs.
    #[default]
    Acceleration,
}

/// How far the course may be off the path, and what for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CourseOptions {
    /// Largest distance in space between course and path at the same parameter, m. At 0 (and below, and no number)
    /// nothing is blended.
    pub tolerance: f64,
    /// The same for each extra axis, u. At 0 joints at which the extra axes have a step are not blended.
    pub extra_tolerance: f64,
    /// Which steps are blended.
    pub order: Order,
}

impl CourseOptions {
    /// Blends within `tolerance`, m, all steps up to the second derivative; with the same number in mm as the tolerance
    /// of the extra axes in u.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, extra_tolerance: tolerance * 1e3, order: Order::default() }
    }

    /// Whether a blend of these steps would be off the path at all while nothing may be.
    fn forbid(&self, steps: &Steps) -> bool {
        let exact = |tolerance: f64| tolerance.is_nan() || tolerance <= 0.0;
        exact(self.tolerance) || steps.extra_step() && exact(self.extra_tolerance)
    }
}

/// The course along the elements of `upstream`: an iterator of [`CourseElement`]s, one for each [`CheckedElement`].
///
/// A joint is left as it is where
/// - the path stops: [`crate::path::PathElement::end_velocity`] is 0, as [`crate::prepare::CheckVelocities`] sets it
///   at rapids, M functions, dwells, jumps and elements without length, or nothing or an error follows;
/// - the derivatives agree up to rounding: to within 10⁻⁹ of themselves (curvatures: 10⁻⁹ per length of the shorter
///   element) and what the rounding of the coordinates makes of them;
/// - the tolerance is 0, or the elements are so short that the coordinates have less than three digits along them;
/// - the path folds back: the two directions differ by more than 168.5° (the cosine of half of that is a tenth), or a blend
///   would be travelled at less than a tenth of the parameter's speed somewhere. A stop is then asked for;
/// - the elements do not meet, by more than a nanometre (10⁻⁹ of an extra axis' position and at least 10⁻⁹ u). A stop
///   is asked for there as well.
///
/// What is left is told by [`CourseElement::joint`].
///
/// One element is held back, since its end depends on the next; errors from upstream come in their place.
#[derive(Debug)]
pub struct Course<I, E> {
    upstream: I,
    options: CourseOptions,
    /// The newest element, its end not yet joined to anything.
    held: Option<CourseElement>,
    /// An error that comes after the element just handed out.
    failure: Option<E>,
    ended: bool,
}

impl<I, E> Course<I, E>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
{
    /// The course along the elements of `upstream`.
    pub fn new(upstream: I, options: CourseOptions) -> Self {
        Self { upstream, options, held: None, failure: None, ended: false }
    }
}

impl<I, E> Iterator for Course<I, E>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
{
    type Item = Result<CourseElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(error) = self.failure.take() {
            return Some(Err(error));
        }
        while !self.ended {
            match self.upstream.next() {
                Some(Ok(next)) => {
                    let mut next = CourseElement::new(next);
                    match self.held.take() {
                        Some(mut element) => {
                            join(&mut element, &mut next, &self.options);
                            self.held = Some(next);
                            return Some(Ok(element));
                        }
                        None => self.held = Some(next),
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

/// Leads the course from `element`, which ends in a stop so far, into `next`.
fn join(element: &mut CourseElement, next: &mut CourseElement, options: &CourseOptions) {
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
    let steps = Steps::between(from, to);
    let left = if steps.apart() {
        Joint { stop: true, ..steps.joint() }
    } else if !steps.to_blend(options.order) || options.forbid(&steps) {
        steps.joint()
    } else if steps.folds() {
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
