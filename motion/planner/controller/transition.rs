//! Transitions: from one element into the next, to rest, and on from rest.

use super::Source;
use super::interpolator::{Interpolator, State, Stop};
use super::look_ahead::{Ahead, LookAhead, Taken};
use super::run::{Motion, Run};
use super::spans::Leg;
use crate::planned_motion::Instant;
use twin_path::ElementKind;
use twin_path::prepare::CheckedElement;

impl<I, E> Interpolator<LookAhead<I, E>, E>
where
    I: Source<Item = Result<CheckedElement, E>>,
{
    /// Completes the motion under way. Returns the time if the path ends with it.
    pub(super) fn motion_over(&mut self) -> Option<Instant> {
        let run = self.run.as_mut()?;
        let (end, now) = (run.end, Instant::at_ns(self.now_ns));
        match run.motion {
            Motion::Still | Motion::Acknowledge { .. } => {
                self.complete();
                self.arrive(end, 0.0)
            }
            Motion::Rest { at, .. } => {
                if self.stop == Stop::Requested {
                    self.stop = Stop::Early;
                    return Some(now);
                }
                if run.done {
                    return if self.held(true) { None } else { self.go_on(now) };
                }
                if !self.held(false) {
                    self.set_off(now, at, 0.0, 0.0);
                }
                None
            }
            Motion::Along { profile, from, to_end } => {
                self.record_until(|_| profile.duration());
                let velocity = profile.end_velocity();
                if to_end {
                    self.complete();
                    return self.arrive(end, velocity);
                }
                self.rest_at(from + profile.length(), end)
            }
            Motion::Smooth(leg) => {
                let velocity = leg.ramp.end_velocity();
                if let Some(count) = leg.ends {
                    for _ in 1..count {
                        self.pass_on();
                    }
                    self.record_until(|_| leg.ramp.duration());
                    self.complete();
                    return self.arrive(end, velocity);
                }
                self.follow_to(leg.from + leg.ramp.length());
                self.record_until(|_| leg.ramp.duration());
                let at = self.smooth_from() + leg.ramp.length();
                if velocity > 0.0 {
                    self.set_off(end, at, velocity, velocity * velocity);
                    return None;
                }
                self.rest_at(at, end)
            }
        }
    }

    /// A stop has come to rest within an element.
    fn rest_at(&mut self, at: f64, end: Instant) -> Option<Instant> {
        self.position = at;
        if self.stop == Stop::Requested {
            self.stop = Stop::Early;
            return Some(end);
        }
        self.braking = false;
        let run = self.run.as_mut()?;
        run.motion = Motion::Rest { at, until_ns: i64::MIN };
        if !self.held(false) {
            self.set_off(end, at, 0.0, 0.0);
        }
        None
    }

    /// The element under way is done.
    fn complete(&mut self) {
        let Some(run) = &mut self.run else { return };
        self.elements_done += 1;
        self.length_done.add(run.element.path_length());
        self.position = 0.0;
        self.bearing.pass(&run.element);
        if let Some(details) = &run.element.details {
            self.board.pass_all(details.switches.as_slice(), &mut run.switched);
        }
    }

    /// At the end of an element at `start` with `velocity`.
    fn arrive(&mut self, start: Instant, velocity: f64) -> Option<Instant> {
        if velocity > 0.0
            && let Taken::Element(element, end_velocity) = self.plan.take()
        {
            let braked = self.braking || self.smoothness.is_some();
            let velocity_v2 = if braked { velocity * velocity } else { self.end_v2 };
            self.enter(element, end_velocity, start, [velocity, velocity_v2]);
            return None;
        }
        let braked = std::mem::replace(&mut self.braking, false);
        let run = self.run.as_mut()?;
        let until_ns = if self.plan.stepping() && run.element.has_path() {
            self.now_ns.saturating_add(self.cycle_ns)
        } else {
            i64::MIN
        };
        run.motion = Motion::Rest { at: run.element.path_length(), until_ns };
        run.done = true;
        match self.plan.ahead() {
            Ahead::Path | Ahead::NotYet if braked && self.stop == Stop::Requested => {
                self.stop = Stop::Early;
                Some(start)
            }
            Ahead::Path if until_ns < self.now_ns && !self.held(true) => self.go_on(start),
            Ahead::Path | Ahead::NotYet => None,
            Ahead::Failure | Ahead::End => self.go_on(start),
        }
    }

    /// Goes on from rest at the end of an element.
    fn go_on(&mut self, start: Instant) -> Option<Instant> {
        match self.plan.take() {
            Taken::Element(element, end_velocity) => {
                self.enter(element, end_velocity, start, [0.0; 2]);
                None
            }
            Taken::NotYet => None,
            Taken::Failure(error) => {
                self.state = State::Failing(error);
                Some(start)
            }
            Taken::End => Some(start),
        }
    }

    /// Begins `element` at `start`, with a velocity given with its square.
    pub(super) fn enter(
        &mut self,
        element: CheckedElement,
        end_velocity: f64,
        start: Instant,
        [velocity, velocity_v2]: [f64; 2],
    ) {
        self.position = 0.0;
        // What has no path begins at the present cycle, which is the first one at or after `start`.
        let (motion, time_ns) = match element.kind {
            ElementKind::MFunction { .. } => (Motion::Acknowledge { shown: false }, self.cycle_ns),
            ElementKind::Dwell { time_ns } => (Motion::Still, time_ns.max(self.cycle_ns)),
            _ => (Motion::Still, self.cycle_ns),
        };
        let has_path = element.has_path();
        self.run = Some(Run {
            element,
            end_velocity,
            recorded: (None, 0.0),
            start,
            end: Instant::at_ns(self.now_ns.saturating_add(time_ns)),
            motion,
            sampled: false,
            switched: 0,
            done: false,
        });
        if has_path {
            self.set_off(start, 0.0, velocity, velocity_v2);
        }
    }

    /// Begin of the smooth leg under way, from the start of the element under way.
    fn smooth_from(&self) -> f64 {
        match self.run.as_ref().map(|run| run.motion) {
            Some(Motion::Smooth(leg)) => leg.from,
            _ => 0.0,
        }
    }

    /// Sets off `from` within the element that was just entered.
    pub(super) fn skip_to(&mut self, start: Instant, from: f64) {
        let Some(run) = &mut self.run else { return };
        let length = run.element.path_length();
        let passed = |at: f64| at * length < from;
        run.switched = run.element.switches().iter().take_while(|switch| passed(switch.at)).count();
        self.position = from;
        self.set_off(start, from, 0.0, 0.0);
    }

    /// Passes from element to element as far as the smooth leg under way has come.
    pub(super) fn follow(&mut self) {
        if let Some(run) = &self.run
            && let Motion::Smooth(_) = run.motion
        {
            let at = run.state_at(self.now_ns).position;
            self.follow_to(at);
        }
    }

    fn follow_to(&mut self, mut at: f64) {
        while let Some(run) = &self.run {
            let length = run.element.path_length();
            let last = matches!(run.motion, Motion::Smooth(Leg { ends: Some(..=1), .. }));
            if at < length || last || !self.pass_on() {
                return;
            }
            at -= length;
        }
    }

    /// The next element is under way, on the same leg.
    fn pass_on(&mut self) -> bool {
        if self.plan.ahead() != Ahead::Path {
            return false;
        }
        self.record_until(|run| match run.motion {
            Motion::Smooth(leg) => leg.ramp.time_at(run.element.path_length() - leg.from),
            _ => 0.0,
        });
        self.complete();
        let Taken::Element(element, end_velocity) = self.plan.take() else { return false };
        let Some(run) = &mut self.run else { return false };
        let length = run.element.path_length();
        run.element = element;
        run.recorded.0 = None;
        run.end_velocity = end_velocity;
        run.switched = 0;
        if let Motion::Smooth(leg) = &mut run.motion {
            leg.from -= length;
            leg.ends = leg.ends.map(|ends| ends.saturating_sub(1));
        }
        true
    }
}
