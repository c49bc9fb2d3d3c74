//! Element under way: its motion, state and status.

use super::Heading;
use super::profile::Profile;
use super::setpoint::{ExtraMotion, Status};
use super::spans::Leg;
use crate::blended_path::BlendedElement;
use crate::planned_motion::Instant;
use crate::planned_motion::PathState;
use crate::planned_motion::{Piece, PlannedPiece};
use std::sync::Arc;
use twin_path::prepare::CheckedElement;
use twin_path::{ElementKind, MParameters, PathPoint};

/// An element under way.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) element: CheckedElement,
    /// Largest velocity at its end: that of the element times the override, or 0 where it is stepped.
    pub(super) end_velocity: f64,
    /// The element in the plan that is recorded, and how much of the motion is, s.
    pub(super) recorded: (Option<Arc<BlendedElement>>, f64),
    /// Of the motion.
    pub(super) start: Instant,
    pub(super) end: Instant,
    pub(super) motion: Motion,
    /// The motion has had a set-point.
    pub(super) sampled: bool,
    /// Number of its switches that are passed.
    pub(super) switched: usize,
    /// Its end is reached, and it is not known yet what follows.
    pub(super) done: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Motion {
    /// At rest at the start of something without a path, until the end comes.
    Still,
    /// The same, until somebody acknowledges an M function that has been shown.
    Acknowledge { shown: bool },
    /// At rest `at` a point of the element until `until_ns`, or until it is let go on.
    Rest { at: f64, until_ns: i64 },
    /// `profile` begins at path length `from` of the element. `to_end`: it lasts to the end of the element.
    Along { profile: Profile, from: f64, to_end: bool },
    /// Without steps of the acceleration, perhaps through several elements.
    Smooth(Leg),
}

impl Run {
    /// Sets off from the present point at `start`.
    pub(super) fn set(&mut self, start: Instant, motion: Motion) {
        self.start = start;
        self.motion = motion;
        self.recorded.1 = 0.0;
        self.sampled = false;
        let (duration, end_velocity) = match motion {
            Motion::Along { profile, .. } => (profile.duration(), profile.end_velocity()),
            Motion::Smooth(leg) => (leg.ramp.duration(), leg.ramp.end_velocity()),
            Motion::Still | Motion::Acknowledge { .. } | Motion::Rest { .. } => return,
        };
        self.end = start.after(duration);
        if end_velocity <= 0.0 {
            self.end = self.end.settled();
        }
    }

    /// End of a motion that has had a set-point and whose other set-points nobody needs: what happens in between is known at
    /// its end.
    pub(super) fn end_of_sampled(&self) -> Option<Instant> {
        let is_even = match self.motion {
            Motion::Along { .. } | Motion::Still => true,
            Motion::Acknowledge { .. } | Motion::Rest { .. } | Motion::Smooth(_) => false,
        };
        (is_even && self.sampled && self.element.switches().is_empty()).then_some(self.end)
    }

    /// Calls `record` with the pieces of the motion up to `until`, s after its start, that it has not been called with.
    /// `heading`: as [`BlendedElement::programmed`] has it.
    pub(super) fn record(
        &mut self,
        until: f64,
        heading: Option<f64>,
        mut record: impl FnMut(PlannedPiece),
    ) {
        let (parts, offset, duration) = match self.motion {
            Motion::Along { profile, from, .. } => {
                (profile.parts().to_vec(), from, profile.duration())
            }
            Motion::Smooth(leg) => (leg.ramp.parts(), leg.from, leg.ramp.duration()),
            Motion::Still | Motion::Acknowledge { .. } | Motion::Rest { .. } => return,
        };
        let from = std::mem::replace(&mut self.recorded.1, until);
        let element = &self.element;
        let element = self
            .recorded
            .0
            .get_or_insert_with(|| Arc::new(BlendedElement::programmed(element.clone(), heading)));
        let ends = parts.iter().skip(1).map(|(begin, ..)| *begin).chain([duration]);
        for ((begin, position, law), end) in parts.iter().zip(ends) {
            let (first, last) = (begin.max(from), end.min(until));
            if last <= first {
                continue;
            }
            let whole = Piece { from: offset + position, duration: end - begin, law: *law };
            let piece = whole.part(first - begin, last - first);
            record(PlannedPiece {
                element: Arc::clone(element),
                start: self.start.after(first),
                piece,
            });
        }
    }

    /// State at `now_ns`; its position is from the start of the element.
    #[inline]
    pub(super) fn state_at(&self, now_ns: i64) -> PathState {
        match self.motion {
            Motion::Still | Motion::Acknowledge { .. } => PathState::resting(0.0),
            Motion::Rest { at, .. } => PathState::resting(at),
            Motion::Along { profile, from, .. } => {
                let state = profile.at(self.start.until(now_ns));
                PathState { position: from + state.position, ..state }
            }
            Motion::Smooth(leg) => {
                let state = leg.ramp.at(self.start.until(now_ns));
                PathState { position: leg.from + state.position, ..state }
            }
        }
    }

    /// Constant deceleration from path length `from` with `velocity`: to rest, or as far as the element goes, and there
    /// with at most `end_velocity`.
    pub(super) fn brake(&mut self, start: Instant, from: f64, velocity: f64, end_velocity: f64) {
        let deceleration = self.element.deceleration;
        let length = self.element.path_length();
        let remaining = length - from;
        let to_rest = velocity * velocity / (2.0 * deceleration);
        // A stop at the very end of the element is the planned one. It may seem to lie a rounding before it or
        // behind it: before it, it would leave the element undone.
        let motion = if to_rest < remaining - 1e-12 * length {
            let profile = Profile::braking(to_rest, velocity, 0.0, deceleration);
            Motion::Along { profile, from, to_end: false }
        } else {
            let left_v2 = velocity * velocity - 2.0 * deceleration * remaining;
            let end_velocity = left_v2.max(0.0).sqrt().min(end_velocity);
            let profile = Profile::braking(remaining, velocity, end_velocity, deceleration);
            Motion::Along { profile, from, to_end: true }
        };
        self.set(start, motion);
    }

    /// Status of the interpolator in `state`.
    #[inline]
    pub(super) fn status(&self, state: &PathState) -> Status {
        match self.motion {
            Motion::Acknowledge { .. } | Motion::Rest { .. } => Status::Waiting,
            Motion::Still if matches!(self.element.kind, ElementKind::Dwell { .. }) => {
                Status::Waiting
            }
            Motion::Still => Status::Constant,
            Motion::Along { .. } => Status::of_acceleration(state.acceleration),
            Motion::Smooth(leg) => leg.ramp.status(),
        }
    }

    /// The M function that waits to be acknowledged.
    pub(super) fn m_function(&self) -> Option<u16> {
        match (self.motion, self.element.kind) {
            (Motion::Acknowledge { .. }, ElementKind::MFunction { number }) => Some(number),
            _ => None,
        }
    }

    /// Parameters of the M function that waits to be acknowledged.
    pub(super) fn m_parameters(&self) -> Option<MParameters> {
        self.m_function()?;
        Some(self.element.m_parameters())
    }

    /// The point at `state`.
    #[inline]
    pub(super) fn point(&self, state: &PathState) -> PathPoint {
        let element = &self.element;
        match self.motion {
            _ if self.done => PathPoint::resting(element.end()),
            Motion::Still | Motion::Acknowledge { .. } => PathPoint::resting(element.start()),
            Motion::Rest { at, .. } => PathPoint::resting(element.at(at).position),
            Motion::Along { .. } | Motion::Smooth(_) => element.at(state.position),
        }
    }

    /// The direction of the path at `state`, where [`Self::point`] is `point`; none on what has no such direction.
    #[inline]
    pub(super) fn heading(
        &self,
        point: &PathPoint,
        state: &PathState,
        backwards: bool,
    ) -> Option<Heading> {
        let element = &self.element;
        if !element.kind.is_motion() {
            return None;
        }
        let rates = [state.velocity, state.acceleration];
        match self.motion {
            _ if self.done => Heading::at(&element.at(element.path_length()), [0.0; 2], backwards),
            Motion::Still | Motion::Acknowledge { .. } => None,
            Motion::Rest { at, .. } => Heading::at(&element.at(at), [0.0; 2], backwards),
            Motion::Along { .. } | Motion::Smooth(_) => Heading::at(point, rates, backwards),
        }
    }

    /// The extra axes at `state`: their derivatives over time follow from those over path length by the chain rule.
    pub(super) fn extra(&self, state: &PathState) -> ExtraMotion {
        let still = |position| ExtraMotion { position, ..ExtraMotion::default() };
        let Some(extra) = self.element.extra() else { return ExtraMotion::default() };
        if self.done {
            return still(extra.end);
        }
        if matches!(self.motion, Motion::Still | Motion::Acknowledge { .. }) {
            return still(extra.start);
        }
        let point = self.element.extra_at(state.position).unwrap_or_default();
        let PathState { velocity, acceleration, .. } = *state;
        let mut motion = still(point.position);
        for (slot, first) in motion.velocity.iter_mut().zip(point.first) {
            *slot = first * velocity;
        }
        let derivatives = point.first.iter().zip(point.second);
        for (slot, (first, second)) in motion.acceleration.iter_mut().zip(derivatives) {
            *slot = second * (velocity * velocity) + first * acceleration;
        }
        motion
    }
}
