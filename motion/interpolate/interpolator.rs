//! Samples the planned path once per cycle.

use super::ToolSetpoint;
use super::instant::Instant;
use super::look_ahead::PlannedElement;
use super::profile::{PathState, Profile};
use crate::path::{ElementKind, PathPoint};
use nalgebra::{Point3, Vector3};
use std::num::NonZeroU32;

/// Cycle time when nothing else is asked for, ns: 1 ms (the manual's `dwIpoTime`).
pub const DEFAULT_CYCLE_NS: NonZeroU32 = match NonZeroU32::new(1_000_000) {
    Some(cycle) => cycle,
    None => NonZeroU32::MIN,
};

/// Turns planned elements into one set-point per cycle (`SMC_Interpolator`, trapezoidal profiles, override 1).
///
/// - The first set-point is the start of the path at time 0, at rest (its acceleration is the one that begins
///   there). The last is the end of the path at the first cycle at or after the exact end time, with velocity and
///   acceleration 0. Without elements there is no set-point.
/// - Several elements may pass within one cycle; time runs on exactly from one into the next. A set-point at the
///   very transition belongs to the later element.
/// - What has no path (a jump, G92, and elements of length zero) starts at a cycle and takes exactly one: one
///   set-point at rest at its start, and at the next cycle the path goes on from its end. That is the cycle of output
///   which manual 3.2 promises for a G1 between two G92.
/// - After an error from upstream, which is handed on, nothing follows: nothing says where the path would go on. The
///   tool has come to rest before.
#[derive(Debug)]
pub struct Interpolator<I, E> {
    planned: I,
    cycle_ns: i64,
    /// Time of the next set-point, ns.
    now_ns: i64,
    state: State<E>,
    /// The element under way, while running.
    run: Option<Run>,
    stop: Stop,
    elements_done: u64,
    length_done: Sum,
    /// Travelled on the current element, m.
    position: f64,
    /// Time of the latest set-point; at the end, when the path came to rest.
    reached: Instant,
}

#[derive(Debug)]
enum State<E> {
    Idle,
    Running,
    Failing(E),
    Ended,
}

/// Progress of [`Interpolator::request_stop`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stop {
    No,
    Requested,
    Braking,
    /// At rest, with path left over.
    Early,
}

/// An element under way.
#[derive(Debug)]
struct Run {
    planned: PlannedElement,
    start: Instant,
    end: Instant,
    motion: Motion,
}

#[derive(Clone, Copy, Debug)]
enum Motion {
    /// At rest at the start of something without a path.
    Still,
    /// `profile` begins at path length `from` of the element. `to_end`: it lasts to the end of the element.
    Along { profile: Profile, from: f64, to_end: bool },
}

impl<I, E> Interpolator<I, E>
where
    I: Iterator<Item = Result<PlannedElement, E>>,
{
    /// Interpolates with a cycle of `cycle_ns`, ns.
    pub fn new(planned: I, cycle_ns: NonZeroU32) -> Self {
        Self {
            planned,
            cycle_ns: i64::from(cycle_ns.get()),
            now_ns: 0,
            state: State::Idle,
            run: None,
            stop: Stop::No,
            elements_done: 0,
            length_done: Sum::default(),
            position: 0.0,
            reached: Instant::at_ns(0),
        }
    }

    /// Brakes along the path, from the velocity of the next set-point, with each element's own deceleration
    /// (`bSlow_Stop`); one set-point at rest ends the iteration. Nothing if it has ended already.
    ///
    /// The velocity stays at or below the planned one at every point of the path: the plan never decelerates by
    /// more than the element's own deceleration, so from a common start the squared velocity of braking, which falls
    /// by exactly 2·d per length, cannot lie above the planned one further on. In particular the path still stops
    /// where it was planned to.
    pub fn request_stop(&mut self) {
        if self.stop == Stop::No {
            self.stop = Stop::Requested;
        }
    }

    /// Whether a requested stop left some of the path undone.
    pub fn stopped_early(&self) -> bool {
        self.stop == Stop::Early
    }

    /// Time since the start, s: that of the latest set-point, and once ended the exact time at which the path came
    /// to rest.
    pub fn duration(&self) -> f64 {
        self.reached.seconds()
    }

    /// Path length up to the latest set-point, m. Jumps have none.
    pub fn path_length(&self) -> f64 {
        self.length_done.value() + self.position
    }

    /// Number of elements traversed to their end.
    pub fn elements_done(&self) -> u64 {
        self.elements_done
    }

    /// Runs on from `run` to the present cycle and makes its set-point.
    fn advance(&mut self, mut run: Run) -> ToolSetpoint {
        while run.end.reached_at(self.now_ns) {
            if matches!(run.motion, Motion::Along { to_end: false, .. }) {
                self.stop = Stop::Early;
                return self.finish(&run);
            }
            self.elements_done += 1;
            self.length_done.add(run.planned.element().path_length());
            let next = match self.planned.next() {
                Some(Ok(next)) => next,
                Some(Err(error)) => {
                    let setpoint = self.finish(&run);
                    self.state = State::Failing(error);
                    return setpoint;
                }
                None => return self.finish(&run),
            };
            if self.stop == Stop::Braking {
                let velocity = run.end_velocity();
                if velocity <= 0.0 {
                    self.stop = Stop::Early;
                    return self.finish(&run);
                }
                run = Run::braking(next, run.end, 0.0, velocity);
            } else {
                run = self.begin(next, run.end);
            }
        }
        if self.stop == Stop::Requested {
            let state = run.state_at(self.now_ns);
            if state.velocity <= 0.0 {
                return self.stand(run, state);
            }
            self.stop = Stop::Braking;
            run = Run::braking(
                run.planned,
                Instant::at_ns(self.now_ns),
                state.position,
                state.velocity,
            );
        }
        self.sample(run)
    }

    /// Starts `planned` as planned, after what ended at `start`.
    fn begin(&self, planned: PlannedElement, start: Instant) -> Run {
        if planned.element().has_path() {
            Run::along(planned, start)
        } else {
            // The present cycle is the first one at or after `start`: the cycle that is taken begins here.
            let end = Instant::at_ns(self.now_ns.saturating_add(self.cycle_ns));
            Run { planned, start, end, motion: Motion::Still }
        }
    }

    /// The set-point of the present cycle, on `run`.
    fn sample(&mut self, run: Run) -> ToolSetpoint {
        let state = run.state_at(self.now_ns);
        let element = run.planned.element();
        let point = match run.motion {
            Motion::Still => PathPoint {
                position: element.start(),
                tangent: Vector3::zeros(),
                curvature: Vector3::zeros(),
            },
            Motion::Along { .. } => element.at(state.position),
        };
        let setpoint = self.setpoint(&run, point, state);
        self.position = state.position;
        self.reached = Instant::at_ns(setpoint.time_ns);
        self.state = State::Running;
        self.run = Some(run);
        setpoint
    }

    /// The last set-point: at rest where `run` ends.
    fn finish(&mut self, run: &Run) -> ToolSetpoint {
        let element = run.planned.element();
        let position = match run.motion {
            Motion::Along { profile, from, to_end: false } => {
                self.position = from + profile.length();
                element.at(self.position).position
            }
            Motion::Along { .. } | Motion::Still => {
                self.position = 0.0;
                element.end()
            }
        };
        self.reached = run.end;
        self.at_rest(run, position)
    }

    /// The last set-point: a stop was requested while `run` is at rest anyway.
    fn stand(&mut self, run: Run, state: PathState) -> ToolSetpoint {
        self.stop = Stop::Early;
        let mut setpoint = self.sample(run);
        setpoint.acceleration = Vector3::zeros();
        setpoint.velocity = Vector3::zeros();
        self.position = state.position;
        self.state = State::Ended;
        setpoint
    }

    fn at_rest(&mut self, run: &Run, position: Point3<f64>) -> ToolSetpoint {
        let point = PathPoint { position, tangent: Vector3::zeros(), curvature: Vector3::zeros() };
        let state = PathState { position: 0.0, velocity: 0.0, acceleration: 0.0 };
        self.setpoint(run, point, state)
    }

    fn setpoint(&mut self, run: &Run, point: PathPoint, state: PathState) -> ToolSetpoint {
        let time_ns = self.now_ns;
        self.now_ns = self.now_ns.saturating_add(self.cycle_ns);
        ToolSetpoint {
            time_ns,
            place: run.planned.element().place,
            rapid: run.planned.element().kind == ElementKind::Rapid,
            feed: run.planned.element().feed,
            position: point.position,
            velocity: point.tangent * state.velocity,
            acceleration: point.curvature * (state.velocity * state.velocity)
                + point.tangent * state.acceleration,
            path_velocity: state.velocity,
        }
    }
}

impl<I, E> Iterator for Interpolator<I, E>
where
    I: Iterator<Item = Result<PlannedElement, E>>,
{
    type Item = Result<ToolSetpoint, E>;

    fn next(&mut self) -> Option<Self::Item> {
        // Running on to a set-point puts the state back unless it was the last one.
        let run = match std::mem::replace(&mut self.state, State::Ended) {
            State::Idle => match self.planned.next()? {
                Ok(first) => self.begin(first, Instant::at_ns(0)),
                Err(error) => return Some(Err(error)),
            },
            State::Running => self.run.take()?,
            State::Failing(error) => return Some(Err(error)),
            State::Ended => return None,
        };
        Some(Ok(self.advance(run)))
    }
}

impl Run {
    fn along(planned: PlannedElement, start: Instant) -> Self {
        let motion = Motion::Along { profile: planned.profile(), from: 0.0, to_end: true };
        Self::new(planned, start, motion)
    }

    /// Braking from path length `from` of `planned` with `velocity`: to rest, or as far as the element goes.
    fn braking(planned: PlannedElement, start: Instant, from: f64, velocity: f64) -> Self {
        let deceleration = planned.element().deceleration;
        let length = planned.element().path_length();
        let remaining = length - from;
        let to_rest = velocity * velocity / (2.0 * deceleration);
        // A stop at the very end of the element is the planned one. It may seem to lie a rounding before it or
        // behind it: before it, it would leave the element undone.
        let motion = if to_rest < remaining - 1e-12 * length {
            let profile = Profile::braking(to_rest, velocity, 0.0, deceleration);
            Motion::Along { profile, from, to_end: false }
        } else {
            let left_v2 = velocity * velocity - 2.0 * deceleration * remaining;
            let end_velocity = left_v2.max(0.0).sqrt().min(planned.end_velocity());
            let profile = Profile::braking(remaining, velocity, end_velocity, deceleration);
            Motion::Along { profile, from, to_end: true }
        };
        Self::new(planned, start, motion)
    }

    fn new(planned: PlannedElement, start: Instant, motion: Motion) -> Self {
        let mut run = Self { planned, start, end: start, motion };
        if let Motion::Along { profile, .. } = motion {
            run.end = start.after(profile.duration());
            if profile.end_velocity() <= 0.0 {
                run.end = run.end.settled();
            }
        }
        run
    }

    fn end_velocity(&self) -> f64 {
        match self.motion {
            Motion::Still => 0.0,
            Motion::Along { profile, .. } => profile.end_velocity(),
        }
    }

    /// State at `now_ns`; its position is from the start of the element.
    fn state_at(&self, now_ns: i64) -> PathState {
        match self.motion {
            Motion::Still => PathState { position: 0.0, velocity: 0.0, acceleration: 0.0 },
            Motion::Along { profile, from, .. } => {
                let state = profile.at(self.start.until(now_ns));
                PathState { position: from + state.position, ..state }
            }
        }
    }
}

/// A sum whose rounding does not grow with the number of terms (Neumaier).
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    sum: f64,
    rest: f64,
}

impl Sum {
    fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        self.rest += if self.sum.abs() >= term.abs() {
            (self.sum - sum) + term
        } else {
            (term - sum) + self.sum
        };
        self.sum = sum;
    }

    fn value(self) -> f64 {
        self.sum + self.rest
    }
}
