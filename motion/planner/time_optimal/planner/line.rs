//! Closed form of the motion along a straight line between two stops, where every axis moves as evenly as the path.

use super::{Leg, Planned, Planner};
use crate::planned_motion::ProfileSegment;
use crate::time_optimal::axis_path::{AxisPath, AxisPoint};
use crate::time_optimal::bound::{CapSource, Constraint, number};
use crate::time_optimal::smooth::Beginning;
use std::sync::Arc;
use twin_kinematics::AxisVector;
use twin_path::prepare::CheckedElement;
use twin_profile::{AxisLimits, Profile, RampType, State};

/// A leg lasts no longer than this, s, or this part of the line: another plan can begin where a leg does.
const LONGEST: [f64; 2] = [0.01, 1e-4];
/// Part by which a limit is changed to see what it costs.
const SLIGHTLY: f64 = 1e-5;

/// Limit of the path along a line, and its source; none where it is infinite.
type Limit = (f64, Option<Constraint>);

/// Limits of velocity, acceleration, deceleration and jerk along a line, SI.
#[derive(Clone, Copy, Debug)]
struct Limits([Limit; 4]);

impl Limits {
    /// Lowers one of them.
    fn lower(&mut self, index: usize, limit: f64, constraint: Constraint) {
        if let Some(slot) = self.0.get_mut(index).filter(|(known, _)| limit < *known) {
            *slot = (limit, Some(constraint));
        }
    }

    /// The fastest motion over `length` m, with one of the limits (by its index) multiplied by a factor.
    fn profile(&self, length: f64, (index, factor): (usize, f64)) -> Option<Profile> {
        let mut limits = self.0.map(|(limit, _)| limit);
        *limits.get_mut(index)? *= factor;
        let [velocity, acceleration, deceleration, jerk] = limits;
        let smooth = jerk.is_finite();
        let ramp = if smooth { RampType::Parabolic } else { RampType::Trapezoid };
        let jerk = if smooth { jerk } else { 1.0 };
        let limits = AxisLimits { velocity, acceleration, deceleration, jerk };
        Profile::to_position(State::default(), length, 0.0, limits, ramp).ok()
    }
}

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Plans the cells at hand in closed form if they are one straight line from rest to rest on which all axes move evenly. False
    /// if they are not.
    pub(super) fn plan_line(&mut self) -> bool {
        let ([first, ..], [.., last]) = (self.cells.as_slice(), self.cells.as_slice()) else {
            return false;
        };
        let (element, from, length) = (&first.element, first.from, last.to - first.from);
        let Some(limits) = self.limits_of_line() else { return false };
        let Some(profile) = limits.profile(length, (0, 1.0)) else { return false };
        let ends = [first.start.position, last.end.position];
        let duration = profile.duration();
        let [longest, part] = LONGEST;
        let longest = longest.max(part * duration);
        let begins = profile.spans().map(|(begin, ..)| begin).skip(1).chain([duration]);
        let mut legs = Vec::new();
        let mut gone = 0.0;
        for ((begin, state, jerk), end) in profile.spans().zip(begins) {
            let count = ((end - begin) / longest).ceil().max(1.0);
            let takes = (end - begin) / count;
            let mut index = 0.0;
            while index < count {
                let State { velocity, acceleration, .. } = advanced(&state, jerk, index * takes);
                index += 1.0;
                let to = if end >= duration && index >= count {
                    length
                } else {
                    advanced(&state, jerk, index * takes).position.min(length)
                };
                let segment =
                    ProfileSegment::jerk((to - gone, takes), [velocity, acceleration, jerk]);
                let start = between(&ends, gone / length);
                legs.push(Leg {
                    element: Arc::clone(element),
                    from: from + gone,
                    stretch: segment,
                    start,
                    is_even: true,
                });
                gone = to;
            }
        }
        for (index, (_, constraint)) in limits.0.iter().enumerate() {
            let Some(constraint) = constraint else { continue };
            let takes = |factor: f64| {
                limits.profile(length, (index, factor)).map_or(duration, |other| other.duration())
            };
            let gain = (takes(1.0 - SLIGHTLY) - takes(1.0 + SLIGHTLY)) / (2.0 * SLIGHTLY);
            *self.costs.entry(*constraint).or_default() += gain;
        }
        self.effort.windows += 1;
        self.effort.cells += legs.len() as u64;
        self.effort.committed += legs.len() as u64;
        self.ready.extend(legs.into_iter().map(|leg| Ok(Planned::Leg(leg))));
        self.tail.clear();
        self.cells.clear();
        true
    }

    /// Limits along the cells at hand, if they are a line that [`Self::plan_line`] can plan.
    fn limits_of_line(&self) -> Option<Limits> {
        let ([first, ..], [.., last]) = (self.cells.as_slice(), self.cells.as_slice()) else {
            return None;
        };
        let (element, start) = (&first.element, &first.start);
        let rests = self.beginning == Beginning::Rest && self.kept.is_empty() && self.stops();
        let alone = Arc::ptr_eq(element, &last.element)
            && element.head().is_none()
            && element.tail().is_none();
        let axes = self.sampler.axes();
        if !rests || !alone || axes.further_rows() > 0 {
            return None;
        }
        let point = AxisPoint { position: start.position, rates: start.rates };
        if !axes.disc(element, first.from, &point)?.is_even {
            return None;
        }
        let cap = start.cap;
        let same = |other: f64| other.to_bits() == cap.v2.to_bits();
        if !self.cells.iter().all(|cell| same(cell.start.cap()) && same(cell.end.cap())) {
            return None;
        }
        let mut limits = Limits([(f64::INFINITY, None); 4]);
        limits.lower(0, cap.v2.sqrt(), Constraint::Velocity(cap.source));
        for (index, (rate, limit)) in start.rates.first.iter().zip(axes.limits()).enumerate() {
            let axis = number(index);
            let along = |limit: f64| if *rate == 0.0 { f64::INFINITY } else { limit / rate.abs() };
            let velocity = Constraint::Velocity(CapSource::AxisVelocity(axis));
            limits.lower(0, along(limit.velocity), velocity);
            limits.lower(1, along(limit.acceleration), Constraint::AxisAcceleration(axis));
            limits.lower(2, along(limit.deceleration), Constraint::AxisAcceleration(axis));
            limits.lower(3, along(limit.jerk.unwrap_or(f64::INFINITY)), Constraint::AxisJerk(axis));
        }
        for (row, along) in (0..).zip(&start.along) {
            let index = if along.a > 0.0 { 1 } else { 2 };
            limits.lower(index, 1.0 / along.a.abs(), Constraint::Further(row));
        }
        if let Some(disc) = &start.disc {
            let most = 1.0 / disc.a.iter().map(|part| part * part).sum::<f64>().sqrt();
            limits.lower(1, most, Constraint::ToolAcceleration);
            limits.lower(2, most, Constraint::ToolAcceleration);
        }
        Some(limits)
    }
}

/// A state `time` s later, with constant jerk.
fn advanced(state: &State, jerk: f64, time: f64) -> State {
    let State { position, velocity, acceleration } = *state;
    State {
        position: position + time * (velocity + time * (0.5 * acceleration + time * jerk / 6.0)),
        velocity: velocity + time * (acceleration + 0.5 * time * jerk),
        acceleration: acceleration + time * jerk,
    }
}

/// Positions a part of the way between two.
fn between([from, to]: &[AxisVector; 2], part: f64) -> AxisVector {
    AxisVector::from_values(from.iter().zip(to.iter()).map(|(from, to)| from + part * (to - from)))
}
