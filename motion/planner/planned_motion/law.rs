//! Laws of motion along one piece of a plan.

use super::{Instant, ProfileSegment};
use crate::blended_path::BlendedElement;
use std::sync::Arc;

/// Motion along the path at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathState {
    /// Path length from the start, m.
    pub position: f64,
    /// Velocity along the path, m/s.
    pub velocity: f64,
    /// Acceleration along the path, m/s².
    pub acceleration: f64,
}

impl PathState {
    /// At rest at `position`.
    pub(crate) fn resting(position: f64) -> Self {
        Self { position, velocity: 0.0, acceleration: 0.0 }
    }
}

/// cosh 1: no hyperbolic cosine of a complex number of size 1 is larger.
const COSH_1: f64 = 1.543_080_634_815_243_8;

/// Path length over time from the start of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// s = v·t + a·t²/2 + j·t³/6.
    Poly {
        /// Velocity at the start, m/s.
        velocity: f64,
        /// Acceleration at the start, m/s².
        acceleration: f64,
        /// Jerk, m/s³.
        jerk: f64,
    },
    /// A part of a ramp v = v₀ + ½·Δv·(1 − cos ω·(t + t₀)), which is slower where the ramp was cut.
    Sine {
        /// v₀ less what is cut, m/s.
        velocity: f64,
        /// Δv of the whole ramp, m/s.
        change: f64,
        /// ω, rad/s.
        angular: f64,
        /// t₀, s.
        skipped: f64,
    },
    /// v² is a quadratic function of the path length.
    Segment(ProfileSegment),
}

/// Part of an element and the law by which it is travelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its begin on the element, m.
    pub from: f64,
    /// s.
    pub duration: f64,
    /// Its law.
    pub law: Law,
}

/// A piece in the plan of a program.
#[derive(Clone, Debug)]
pub struct PlannedPiece {
    /// Its element.
    pub element: Arc<BlendedElement>,
    /// When it begins.
    pub(crate) start: Instant,
    /// Part of the element, and law of motion.
    pub piece: Piece,
}

impl PlannedPiece {
    /// The cycles of `cycle_ns` behind the one at `shown_ns` that are in it, s from its start.
    pub fn cycles(&self, shown_ns: i64, cycle_ns: i64) -> impl Iterator<Item = f64> {
        let first = self.start.first_cycle(shown_ns.saturating_add(cycle_ns), cycle_ns);
        let cycles = std::iter::successors(Some(first), move |ns| ns.checked_add(cycle_ns));
        let times = cycles.map(|ns| self.start.until(ns));
        times.take_while(|time| *time < self.piece.duration)
    }

    /// Goes on to the end of `next`, if that follows on the same element with the same jerk. False if it does not.
    pub(crate) fn take_over(&mut self, next: &Self) -> bool {
        let (Law::Segment(before), Law::Segment(after)) = (self.piece.law, next.piece.law) else {
            return false;
        };
        let both = before.joined(&after).filter(|_| Arc::ptr_eq(&self.element, &next.element));
        if let Some(both) = both {
            (self.piece.law, self.piece.duration) = (Law::Segment(both), both.duration());
        }
        both.is_some()
    }

    /// When it begins, s after the start of the program.
    pub fn start(&self) -> f64 {
        self.start.seconds()
    }
}

impl Piece {
    /// The part of this `duration` (s) that begins `time` s after its begin.
    #[must_use]
    pub(crate) fn part(&self, time: f64, duration: f64) -> Self {
        let (PathState { position, velocity, acceleration }, jerk) = self.at(time);
        match self.law {
            Law::Poly { .. } => {
                let law = Law::Poly { velocity, acceleration, jerk };
                Self { from: position, duration, law }
            }
            Law::Sine { skipped, velocity, change, angular } => {
                let law = Law::Sine { skipped: skipped + time, velocity, change, angular };
                Self { from: position, duration, law }
            }
            Law::Segment(_) => Self { duration, ..*self },
        }
    }

    /// True if acceleration, velocity and jerk along the path are largest at its ends: constant jerk, or acceleration linear in
    /// the path length, and a velocity that only grows or only falls.
    pub(crate) fn is_monotone(&self) -> bool {
        let [from, to] = [0.0, self.duration].map(|time| self.at(time).0.acceleration);
        !matches!(self.law, Law::Sine { .. }) && from * to >= 0.0
    }

    /// At rest.
    pub fn resting(from: f64, duration: f64) -> Self {
        let law = Law::Poly { velocity: 0.0, acceleration: 0.0, jerk: 0.0 };
        Self { from, duration, law }
    }

    /// State `time` s after its begin, on the element, and the jerk along the path, m/s³.
    pub fn at(&self, time: f64) -> (PathState, f64) {
        let (mut state, jerk) = self.law.at(time);
        state.position += self.from;
        (state, jerk)
    }
}

impl Law {
    fn at(&self, t: f64) -> (PathState, f64) {
        match *self {
            Self::Poly { velocity, acceleration, jerk } => {
                let position = t * (velocity + t * (0.5 * acceleration + t * (jerk / 6.0)));
                let velocity = velocity + t * (acceleration + t * (0.5 * jerk));
                (PathState { position, velocity, acceleration: acceleration + jerk * t }, jerk)
            }
            Self::Sine { velocity, change, angular, skipped } => {
                let half = 0.5 * change;
                let (sin0, _) = (angular * skipped).sin_cos();
                let (sin, cos) = (angular * (t + skipped)).sin_cos();
                let state = PathState {
                    position: (velocity + half) * t - half * (sin - sin0) / angular,
                    velocity: velocity + half * (1.0 - cos),
                    acceleration: half * angular * sin,
                };
                (state, half * angular * angular * cos)
            }
            Self::Segment(segment) => {
                let progress = segment.at(t);
                let state = PathState {
                    position: progress.position,
                    velocity: progress.velocity,
                    acceleration: progress.acceleration,
                };
                (state, progress.jerk)
            }
        }
    }

    /// The largest |θ| for which the law is bounded by [`Self::bend`]; it may be infinite.
    fn radius(&self) -> f64 {
        match self {
            Self::Poly { .. } => f64::INFINITY,
            Self::Sine { angular, .. } => 1.0 / angular,
            Self::Segment(segment) => segment.rate().map_or(f64::INFINITY, |rate| 1.0 / rate),
        }
    }

    /// |s(t + θ) − s(t) − v·θ| ≤ ½·bend·|θ|² for complex |θ| ≤ `radius`, in `state`.
    fn bend(&self, state: &PathState, jerk: f64, radius: f64) -> f64 {
        match self {
            Self::Poly { .. } => state.acceleration.abs() + jerk.abs() * radius / 3.0,
            Self::Sine { change, angular, .. } => 0.5 * change.abs() * angular * COSH_1,
            Self::Segment(segment) => match segment.rate() {
                Some(rate) => (state.acceleration.abs() + state.velocity.abs() * rate) * COSH_1,
                None => state.acceleration.abs() + jerk.abs() * radius / 3.0,
            },
        }
    }

    /// The largest |θ|, or nearly, within which s changes by no more than `way` about `state`, and by how much it changes.
    pub(crate) fn time_for(&self, state: &PathState, jerk: f64, way: f64) -> [f64; 2] {
        if way <= 0.0 || way.is_nan() {
            return [0.0; 2];
        }
        let (velocity, most) = (state.velocity.abs(), self.radius());
        let change = |time: f64| (velocity + 0.5 * self.bend(state, jerk, time) * time) * time;
        // By each of the terms alone, and then down.
        let curve = self.bend(state, jerk, 0.0);
        let cubic = if jerk == 0.0 { f64::INFINITY } else { (6.0 * way / jerk.abs()).cbrt() };
        let quadratic = 2.0 * way / (velocity + (velocity * velocity + 2.0 * curve * way).sqrt());
        let mut time = most.min(quadratic).min(cubic);
        if !time.is_finite() {
            return [time, 0.0];
        }
        while change(time) > way {
            time *= 0.9;
        }
        [time, change(time)]
    }
}
