//! Cycle control of the interpolator: elements, stops, waits and changed inputs (manual 6.2.9).

use super::interpolator::{Interpolator, Stop};
use super::look_ahead::{Ahead, LookAhead};
use super::profile::{Limits, Profile};
use super::ramp::Smoothness;
use super::run::Motion;
use super::spans::{Leg, Now, decide};
use super::{Source, ToolSetpoint, VelocityMode};
use crate::planned_motion::Instant;
use twin_path::{ElementKind, prepare::CheckedElement};

/// A velocity above the feed by less than this part of it is the feed.
const ROUNDING: f64 = 1e-12;

/// Largest number of recorded pieces that wait while set-points are left out.
const MOST_WAITING: usize = 64;

/// Action for the present motion in the present cycle.
enum Due {
    /// Its set-point.
    Sample,
    /// It has ended.
    Over,
    /// Something else is asked for.
    Heed,
}

impl<I, E> Interpolator<LookAhead<I, E>, E>
where
    I: Source<Item = Result<CheckedElement, E>>,
{
    /// Runs on to the present cycle and makes its set-point.
    #[inline]
    pub(super) fn advance(&mut self) -> Option<ToolSetpoint> {
        if self.inputs.abort {
            return self.end_here();
        }
        if self.inputs.emergency_stop && self.hold() {
            return self.sample();
        }
        let leaves_out = self.leave_out();
        loop {
            let run = self.run.as_mut()?;
            let due = match &mut run.motion {
                Motion::Along { .. } | Motion::Smooth(_) => {
                    if run.end.reached_at(self.now_ns) {
                        Due::Over
                    } else if self.attention {
                        Due::Heed
                    } else {
                        Due::Sample
                    }
                }
                Motion::Still => {
                    if run.end.reached_at(self.now_ns) {
                        Due::Over
                    } else {
                        Due::Heed
                    }
                }
                Motion::Acknowledge { shown } => {
                    if std::mem::replace(shown, true) && self.inputs.acknowledge_m {
                        run.end = Instant::at_ns(self.now_ns);
                        Due::Over
                    } else {
                        Due::Heed
                    }
                }
                Motion::Rest { until_ns, .. } => {
                    if self.now_ns < *until_ns {
                        Due::Sample
                    } else {
                        Due::Over
                    }
                }
            };
            match due {
                Due::Sample if leaves_out && self.pass_unseen() => {}
                Due::Sample => break,
                Due::Over => {
                    if let Some(reached) = self.motion_over() {
                        return self.finish(reached);
                    }
                    if self.waits() {
                        break;
                    }
                }
                Due::Heed => {
                    let Some(moving) = self.heed() else { return self.end_here() };
                    if !moving {
                        break;
                    }
                }
            }
        }
        self.follow();
        self.sample()
    }

    /// Leaves out what is left of the set-points of the motion under way, if nobody needs them. True if it was along the path.
    fn leave_out(&mut self) -> bool {
        let run = self.run.as_ref().filter(|_| self.leaves_out && !self.attention);
        let Some((run, end)) = run.and_then(|run| Some((run, run.end_of_sampled()?))) else {
            return false;
        };
        self.now_ns = end.first_cycle(self.now_ns, self.cycle_ns);
        matches!(run.motion, Motion::Along { .. })
    }

    /// Leaves out all set-points of a cut of which the recorded pieces say everything, unless [`MOST_WAITING`] of these wait.
    fn pass_unseen(&mut self) -> bool {
        let Some((pieces, turning)) = &self.record else { return false };
        let Some(run) = &mut self.run else { return false };
        let is_plain = run.element.kind == ElementKind::Cut && run.element.details.is_none();
        let is_under_way = run.start.until(self.now_ns) > 0.0;
        run.sampled = is_plain && is_under_way && !turning && pieces.len() < MOST_WAITING;
        self.leave_out()
    }

    /// True if it rests and has to.
    fn waits(&mut self) -> bool {
        let Some(run) = &self.run else { return true };
        if self.stop == Stop::Requested {
            return false;
        }
        match run.motion {
            Motion::Rest { until_ns, .. } => {
                self.now_ns < until_ns
                    || self.held(run.done)
                    || (run.done && self.plan.ahead() == Ahead::NotYet)
            }
            _ => false,
        }
    }

    /// True if the inputs ask for staying at rest, at the end of an element (`done`) or elsewhere.
    pub(super) fn held(&self, done: bool) -> bool {
        self.inputs.slow_stop
            || self.inputs.emergency_stop
            || (done && self.inputs.wait_at_next_stop)
    }

    /// The path ends here, in this cycle.
    fn end_here(&mut self) -> Option<ToolSetpoint> {
        self.stop = Stop::Early;
        self.finish(Instant::at_ns(self.now_ns))
    }

    /// Velocity 0 at once. False if the path shall end anyway.
    fn hold(&mut self) -> bool {
        (self.braking, self.over) = (false, false);
        self.record_until_now();
        let Some(run) = &mut self.run else { return false };
        match run.motion {
            Motion::Along { .. } | Motion::Smooth(_) => {
                run.motion = Motion::Rest { at: self.position, until_ns: i64::MIN };
            }
            Motion::Still if run.end.reached_at(self.now_ns) => {
                run.end = Instant::at_ns(self.now_ns.saturating_add(self.cycle_ns));
            }
            Motion::Still | Motion::Acknowledge { .. } | Motion::Rest { .. } => {}
        }
        self.stop != Stop::Requested
    }

    /// Begins a motion at `from` of the element under way: nothing that could still be asked for is under way.
    pub(super) fn set_off(&mut self, start: Instant, from: f64, velocity: f64, velocity_v2: f64) {
        if velocity <= 0.0 {
            (self.braking, self.over) = (false, false);
        }
        if self.attention {
            if velocity <= 0.0 || self.smoothness.is_some() {
                self.adopt(from, velocity, true);
            }
            self.attention = self.pending();
        }
        let rests = velocity <= 0.0 && (self.stop == Stop::Requested || self.held(false));
        let Some(run) = &mut self.run else { return };
        if rests {
            run.motion = Motion::Rest { at: from, until_ns: i64::MIN };
            return;
        }
        if let Some(smoothness) = self.smoothness {
            let now = Now {
                element: &run.element,
                end_velocity: run.end_velocity,
                at: from,
                velocity,
                halting: self.braking,
                over: self.over,
            };
            let leg = decide(&mut self.plan, now, smoothness, &mut self.spans);
            run.set(start, Motion::Smooth(leg));
            return;
        }
        let remaining = run.element.path_length() - from;
        self.end_v2 =
            self.plan.plan(&run.element, remaining, velocity_v2, run.end_velocity, &mut self.over);
        let end_velocity = self.end_v2.sqrt();
        if self.braking {
            run.brake(start, from, velocity, end_velocity);
            return;
        }
        let limits = Limits::of(&run.element, self.plan.scale());
        let profile = if velocity > limits.feed * (1.0 + ROUNDING) {
            Profile::slowing(remaining, velocity, end_velocity, limits)
        } else {
            Profile::new(remaining, velocity, end_velocity, limits)
        };
        run.set(start, Motion::Along { profile, from, to_end: true });
        self.attention = self.attention || (self.plan.limited() && self.plan.starved());
    }

    /// True if something is asked for that is not in effect.
    fn pending(&self) -> bool {
        let stops = self.inputs.slow_stop || self.stop == Stop::Requested;
        (stops && !self.braking)
            || self.inputs.override_factor != self.scale
            || self.inputs.single_step != self.plan.stepping()
            || self.inputs.mode != self.mode
    }

    /// Takes over what is asked for, at `from` of the element under way with `velocity`; `constant`: outside of ramps.
    pub(super) fn adopt(&mut self, from: f64, velocity: f64, constant: bool) {
        let wanted = self.inputs.override_factor;
        if constant && wanted != self.scale {
            self.over = self.over || (velocity > 0.0 && wanted < self.scale);
            self.scale = wanted;
            self.plan.set_scale(wanted.factor());
            if let Some(run) = &mut self.run
                && run.end_velocity > 0.0
            {
                run.end_velocity = wanted.factor() * run.element.end_velocity;
            }
        }
        if self.inputs.single_step != self.plan.stepping() {
            if self.inputs.single_step {
                self.begin_stepping(from, velocity);
            } else {
                self.plan.stop_stepping();
                if let Some(run) = &mut self.run {
                    run.end_velocity = self.scale.factor() * run.element.end_velocity;
                }
            }
        }
        // Within limited jerk, braking takes longer than the path is prepared for in the other modes.
        let longer = matches!(self.inputs.mode, VelocityMode::JerkLimited { .. });
        if constant && self.inputs.mode != self.mode && (velocity <= 0.0 || !longer) {
            self.mode = self.inputs.mode;
            self.smoothness = Smoothness::of(self.mode);
        }
    }

    /// From now on every element ends at rest, from the first on whose end can be stopped at.
    fn begin_stepping(&mut self, from: f64, velocity: f64) {
        let smoothness = self.smoothness;
        let mut left = Stopping { velocity, length: 0.0, rate: 0.0, feed: 0.0 };
        let first = match &mut self.run {
            Some(run) if !run.done => {
                let remaining = run.element.path_length() - from;
                let goes_on = left.passes(&run.element, remaining, smoothness);
                if !goes_on {
                    run.end_velocity = 0.0;
                }
                goes_on
            }
            _ => false,
        };
        self.plan.step(|element| first && left.passes(element, element.path_length(), smoothness));
    }

    /// Takes notice of what is asked for: whether something else is under way now; none if the path ends here.
    fn heed(&mut self) -> Option<bool> {
        let run = self.run.as_mut()?;
        let now = Instant::at_ns(self.now_ns);
        let motion = run.motion;
        if let Motion::Still | Motion::Acknowledge { .. } | Motion::Rest { .. } = motion {
            return (self.stop != Stop::Requested).then_some(false);
        }
        self.follow();
        let run = self.run.as_mut()?;
        let state = run.state_at(self.now_ns);
        let motion = run.motion;
        let (at, velocity) = (state.position, state.velocity);
        let velocity_v2 = velocity * velocity;
        if (self.inputs.slow_stop || self.stop == Stop::Requested) && !self.braking {
            if velocity <= 0.0 {
                run.motion = Motion::Rest { at, until_ns: i64::MIN };
                self.position = at;
                return (self.stop != Stop::Requested).then_some(false);
            }
            self.braking = true;
            let ramp = match motion {
                Motion::Smooth(leg) if !leg.ramp.is_constant() => Some(leg.ramp),
                _ => None,
            };
            match ramp {
                None => {
                    self.record_until_now();
                    self.set_off(now, at, velocity, velocity_v2);
                }
                Some(ramp) => {
                    let time = run.start.until(self.now_ns);
                    if let Some(ramp) = ramp.cut(time) {
                        self.record_until_now();
                        let run = self.run.as_mut()?;
                        run.set(now, Motion::Smooth(Leg { ramp, from: at, ends: None }));
                    }
                }
            }
            self.attention = self.pending();
            return Some(true);
        }
        // A stop comes to rest first.
        if self.braking {
            return Some(false);
        }
        let constant = state.acceleration.abs() <= 0.0;
        let steps = self.inputs.single_step != self.plan.stepping() && self.smoothness.is_none();
        let starved = self.plan.limited() && self.plan.starved();
        let changes = (constant && self.pending()) || steps;
        if changes {
            self.adopt(at, velocity, constant);
        }
        let more = constant && starved && self.plan.pull();
        self.attention = self.pending() || (self.plan.limited() && self.plan.starved());
        if changes || more {
            self.record_until_now();
            self.set_off(now, at, velocity, velocity_v2);
            // What is pending still cannot be taken over in this cycle.
            let run = self.run.as_mut()?;
            return Some(run.end.reached_at(self.now_ns));
        }
        Some(false)
    }
}

/// State of a stop, from element to element.
struct Stopping {
    velocity: f64,
    /// Length at disposal with the same limits.
    length: f64,
    rate: f64,
    feed: f64,
}

impl Stopping {
    /// True if the path cannot stop at the end of `element`, of which `length` is left; then it goes on to the next.
    fn passes(
        &mut self,
        element: &CheckedElement,
        length: f64,
        smoothness: Option<Smoothness>,
    ) -> bool {
        if self.velocity <= 0.0 || !element.has_path() {
            return false;
        }
        let Some(smoothness) = smoothness else {
            let rest_v2 = self.velocity * self.velocity - 2.0 * element.deceleration * length;
            let passes = rest_v2 > 1e-9 * self.velocity * self.velocity;
            self.velocity = rest_v2.max(0.0).sqrt();
            return passes;
        };
        let same = self.rate.to_bits() == element.deceleration.to_bits()
            && self.feed.to_bits() == element.feed.to_bits();
        if same {
            self.length += length;
        } else {
            if self.length > 0.0 {
                self.velocity = smoothness.slowest(self.velocity, 0.0, self.length, self.rate);
            }
            (self.length, self.rate, self.feed) = (length, element.deceleration, element.feed);
        }
        smoothness.length(self.velocity, 0.0, self.rate) > self.length * (1.0 + 1e-9)
    }
}
