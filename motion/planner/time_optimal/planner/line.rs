//! Closed form of the motion along a straight line between two stops, of one element or of several in a row, where every axis
//! moves as evenly as the path.

use super::backlog::parts;
use super::{Leg, Planned, Planner};
use crate::planned_motion::{ProfileSegment, Progress};
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::bound::{CapSource, Constraint, number};
use crate::time_optimal::cell::Cell;
use crate::time_optimal::smooth::Beginning;
use std::collections::VecDeque;
use std::sync::Arc;
use twin_kinematics::AxisVector;
use twin_path::prepare::CheckedElement;
use twin_profile::{AxisLimits, Profile, RampType, State};

/// So much of the plan behind what is handed out, s, is in legs as short as elsewhere: another plan can begin in it.
const LOOK: f64 = 0.5;
/// Steps of the grid that a leg takes: a motion that needs no grid is as exact with fewer.
const STEPS: f64 = 2.0;
/// Times that differ by less are one, s.
const ROUNDING: f64 = 1e-12;
/// Values are the same to this part of them.
const SAME: f64 = 1e-9;
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
        let Some(first) = self.cells.first() else { return false };
        let length = self.cells.iter().map(Cell::length).sum();
        let Some(limits) = self.limits_of_line() else { return false };
        let Some(profile) = limits.profile(length, (0, 1.0)) else { return false };
        let (start, rates) = (first.start.position, first.start.rates.first);
        let duration = profile.duration();
        let ends = profile.spans().skip(1).map(|(begin, state, _)| (begin, state.position));
        let ends = ends.chain([(duration, length)]);
        let spans = profile.spans().zip(ends).map(|((begin, state, jerk), (end, to))| {
            let State { position, velocity, acceleration } = state;
            let motion = [velocity, acceleration, jerk];
            Leg {
                element: Arc::clone(&first.element),
                from: position,
                stretch: ProfileSegment::jerk((to - position, end - begin), motion),
                start: moved(&start, &rates, position),
                is_even: true,
            }
        });
        self.tail = spread(spans.collect(), &self.cells, &rates);
        self.along_line = Some(rates);
        for (index, (_, constraint)) in limits.0.iter().enumerate() {
            let Some(constraint) = constraint else { continue };
            let takes = |factor: f64| {
                limits.profile(length, (index, factor)).map_or(duration, |other| other.duration())
            };
            let gain = (takes(1.0 - SLIGHTLY) - takes(1.0 + SLIGHTLY)) / (2.0 * SLIGHTLY);
            *self.costs.entry(*constraint).or_default() += gain;
        }
        self.effort.windows += 1;
        self.go_along_line(&rates);
        true
    }

    /// Hands out what comes next of the plan so far along a line on which the axes have these `rates`.
    pub(super) fn go_along_line(&mut self, rates: &AxisVector) {
        let mut tail = VecDeque::from(std::mem::take(&mut self.tail));
        let (step, longest) = (STEPS * self.options.step, self.longest());
        let legs = pop(&mut tail, rates, [self.options.horizon, step, longest]);
        self.effort.cells += legs.len() as u64;
        self.effort.committed += legs.len() as u64;
        self.ready.extend(legs.into_iter().map(|leg| Ok(Planned::Leg(leg))));
        self.kept.clear();
        let cells = std::mem::take(&mut self.cells);
        let Some(next) = tail.front() else {
            (self.beginning, self.along_line) = (Beginning::Rest, None);
            return;
        };
        let (b, a) = next.stretch.at_position(0.0);
        (self.beginning, self.near) = (Beginning::Moving { b, a }, next.start);
        self.kept.push(b);
        let (element, from) = (Arc::clone(&next.element), next.from);
        // What may be planned anew is as fine as elsewhere.
        let mut legs = pop(&mut tail, rates, [LOOK, step, longest]);
        legs.extend(tail);
        self.tail = legs;
        let reached = |cell: &Cell| Arc::ptr_eq(&cell.element, &element) && cell.to > from;
        let rest = cells.into_iter().skip_while(|cell| !reached(cell));
        for part in parts(&rest.collect::<Vec<_>>()) {
            let begin = if Arc::ptr_eq(&part.element, &element) { from } else { part.from };
            let known = self.cells.len();
            let range = begin..part.to;
            if self.sampler.cells(&part.element, range, &self.near, &mut self.cells).is_err() {
                // The machine has been there.
                self.cells.truncate(known);
            }
            self.join(known);
        }
    }

    /// Limits along the cells at hand, if they are a line that [`Self::plan_line`] can plan.
    fn limits_of_line(&self) -> Option<Limits> {
        let ([first, ..], [.., last]) = (self.cells.as_slice(), self.cells.as_slice()) else {
            return None;
        };
        let (axes, start, cap) = (self.sampler.axes(), &first.start, first.start.cap);
        let rests = self.beginning == Beginning::Rest && self.kept.is_empty() && self.stops();
        let ends = [first, last].map(|cell| &cell.element);
        if !rests || ends[0].head().is_some() || ends[1].tail().is_some() {
            return None;
        }
        let goes_on = |cell: &Cell| {
            let along = cell.start.along.iter().zip(&start.along);
            cell.is_even
                && [&cell.start, &cell.end].into_iter().all(|end| same(end.cap(), cap.v2))
                && along.into_iter().all(|(here, there)| same(here.a, there.a))
                && are_same(&cell.start.rates.first, &start.rates.first)
        };
        let passes = |cell: &Cell| cell.joint.v2 >= cap.v2;
        if !self.cells.iter().all(goes_on) || !self.cells.iter().rev().skip(1).all(passes) {
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

/// True if two values are one but for rounding.
fn same(one: f64, other: f64) -> bool {
    (one - other).abs() <= SAME * one.abs() || one.to_bits() == other.to_bits()
}

/// True if the axes move in the same direction but for rounding.
fn are_same(one: &AxisVector, other: &AxisVector) -> bool {
    let most = one.iter().fold(0.0, |most: f64, rate| most.max(rate.abs()));
    one.iter().zip(other.iter()).all(|(one, other)| (one - other).abs() <= SAME * most)
}

/// Spans from rest to rest, whose places are ways from the start, as legs of the `cells` that they go through.
fn spread(mut spans: VecDeque<Leg>, cells: &[Cell], rates: &AxisVector) -> Vec<Leg> {
    let mut legs = Vec::new();
    let (mut begin, mut left) = (0.0, cells.len());
    for cell in cells {
        let end = begin + cell.length();
        left -= 1;
        while let Some(span) = spans.pop_front() {
            let (way, takes) = (end - span.from, span.stretch.duration());
            let ends = left > 0 && way <= span.stretch.length();
            let until =
                if ends { ProfileSegment::new(way, span.stretch.law()).duration() } else { takes };
            if until < takes - ROUNDING {
                spans.push_front(Leg { from: end, ..part(&span, rates, [until, takes]) });
            }
            let here = if ends { part(&span, rates, [0.0, until]) } else { span };
            let (element, from) = (Arc::clone(&cell.element), cell.from + here.from - begin);
            if until > ROUNDING {
                legs.push(Leg { element, from, ..here });
            }
            if ends {
                break;
            }
        }
        begin = end;
    }
    legs
}

/// Takes legs of a duration from the front of others, in parts of a step, or of the longest time where nothing changes, all s.
fn pop(legs: &mut VecDeque<Leg>, rates: &AxisVector, [time, step, longest]: [f64; 3]) -> Vec<Leg> {
    let mut parts = Vec::new();
    let mut left = time;
    while left > ROUNDING
        && let Some(leg) = legs.pop_front()
    {
        let takes = leg.stretch.duration();
        let until = if takes > left + ROUNDING { left } else { takes };
        let mut index = 0.0;
        let Progress { acceleration, jerk, .. } = leg.stretch.at(0.0);
        let step = if acceleration == 0.0 && jerk == 0.0 { longest } else { step };
        let count = (until / step - ROUNDING).ceil().max(1.0);
        while index < count {
            let begin = until * index / count;
            index += 1.0;
            parts.push(part(&leg, rates, [begin, until * index / count]));
        }
        if until < takes {
            legs.push_front(part(&leg, rates, [until, takes]));
        }
        left -= until;
    }
    parts
}

/// A leg between two times, s from its start.
fn part(leg: &Leg, rates: &AxisVector, [begin, end]: [f64; 2]) -> Leg {
    let stretch = &leg.stretch;
    let from = stretch.at(begin);
    let to = if end < stretch.duration() { stretch.at(end).position } else { stretch.length() };
    let motion = [from.velocity, from.acceleration, from.jerk];
    Leg {
        from: leg.from + from.position,
        stretch: ProfileSegment::jerk((to - from.position, end - begin), motion),
        start: moved(&leg.start, rates, from.position),
        ..leg.clone()
    }
}

/// Positions of axes with these `rates` a `way` further along the path.
fn moved(start: &AxisVector, rates: &AxisVector, way: f64) -> AxisVector {
    AxisVector::from_values(start.iter().zip(rates.iter()).map(|(start, rate)| start + rate * way))
}
