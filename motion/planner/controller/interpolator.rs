//! Interpolator: samples the planned path once per cycle (`SMC_Interpolator`).

use super::heading::{Bearing, Heading};
use super::look_ahead::{LookAhead, Taken};
use super::ramp::Smoothness;
use super::run::{Motion, Run};
use super::spans::Span;
use super::sum::Sum;
use super::switches::SwitchBoard;
use super::{Inputs, Override, Source, Status, ToolSetpoint, VelocityMode};
use crate::planned_motion::Instant;
use crate::planned_motion::PathState;
use crate::planned_motion::PlannedPiece;
use nalgebra::Point3;
use std::collections::VecDeque;
use std::num::NonZeroU32;
use std::task::Poll;
use twin_path::prepare::CheckedElement;
use twin_path::{ElementKind, MParameters};

/// Cycle time when nothing else is asked for, ns: 1 ms (the manual's `dwIpoTime`).
pub const DEFAULT_CYCLE_NS: NonZeroU32 = match NonZeroU32::new(1_000_000) {
    Some(cycle) => cycle,
    None => NonZeroU32::MIN,
};

/// Turns the path into one set-point per cycle (`SMC_Interpolator`).
///
/// [`Self::poll_cycle`] is the manual's call with all of its inputs. As an iterator it goes through the path with the inputs
/// it was given last, at first the default ones.
///
/// - The first set-point is the start of the path at time 0, at rest (its acceleration is the one that begins
///   there). The last is the end of the path at the first cycle at or after the exact end time, with velocity and
///   acceleration 0. Without elements there is no set-point.
/// - Several elements may pass within one cycle; time runs on exactly from one into the next. A set-point at the
///   very transition belongs to the later element.
/// - What has no path (a jump, G92, and elements of length zero) starts at a cycle and takes exactly one: one
///   set-point at rest at its start, and at the next cycle the path goes on from its end. That is the cycle of output
///   which manual 3.2 promises for a G1 between two G92. A dwell takes its time, an M function until it is
///   acknowledged, both a cycle at least.
/// - After an error from upstream, which is handed on, nothing follows: nothing says where the path would go on. The
///   tool has come to rest before.
///
/// A ramp once begun is completed before an override or another profile counts; only stops interrupt one. A stop that
/// brakes comes to rest before the path goes on.
#[derive(Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a state of its own")]
pub struct Interpolator<P, E> {
    pub(super) plan: P,
    pub(super) cycle_ns: i64,
    /// Time of the next set-point, ns.
    pub(super) now_ns: i64,
    pub(super) inputs: Inputs,
    /// The override in effect.
    pub(super) scale: Override,
    /// The mode in effect, and what it does.
    pub(super) mode: VelocityMode,
    pub(super) smoothness: Option<Smoothness>,
    /// Something is asked for that is not in effect yet.
    pub(super) attention: bool,
    /// On the way to rest because a stop was asked for.
    pub(super) braking: bool,
    /// Perhaps faster than the path allows, since the override was lowered.
    pub(super) over: bool,
    pub(super) stop: Stop,
    pub(super) state: State<E>,
    /// The element under way, from the beginning on.
    pub(super) run: Option<Run>,
    /// Square of the velocity with which it is to end.
    pub(super) end_v2: f64,
    pub(super) board: SwitchBoard,
    pub(super) spans: Vec<Span>,
    pub(super) elements_done: u64,
    pub(super) length_done: Sum,
    /// Travelled on the current element, m.
    pub(super) position: f64,
    /// Time of the latest set-point; at the end, when the path came to rest.
    pub(super) reached: Instant,
    /// Where the first element begins, m.
    resume_at: f64,
    /// Positions of the two latest set-points.
    before: Point3<f64>,
    latest: Point3<f64>,
    pub(super) bearing: Bearing,
    /// Set-points of a motion but its first are left out.
    pub(super) leaves_out: bool,
    /// Pieces of the plan that are over, if they are recorded, and whether the tool turns with the path.
    pub(super) record: Option<(VecDeque<PlannedPiece>, bool)>,
}

/// State taken over from another interpolator.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resume {
    /// Its place on the first element, m.
    pub(super) at: f64,
    pub(super) now_ns: i64,
    /// Path length so far, m.
    pub(super) way: f64,
    pub(super) board: SwitchBoard,
    pub(super) bearing: Bearing,
}

#[derive(Debug)]
pub(super) enum State<E> {
    Idle,
    /// There is something, but not enough to begin (`IPO_INIT`).
    Filling,
    Active,
    Failing(E),
    Ended,
}

/// Progress of [`Interpolator::request_stop`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    No,
    Requested,
    /// At rest, with path left over.
    Early,
}

impl<I, E> Interpolator<LookAhead<I, E>, E>
where
    I: Source<Item = Result<CheckedElement, E>>,
{
    /// Interpolates with a cycle of `cycle_ns`, ns.
    pub fn new(plan: LookAhead<I, E>, cycle_ns: NonZeroU32) -> Self {
        Self {
            plan,
            cycle_ns: i64::from(cycle_ns.get()),
            now_ns: 0,
            inputs: Inputs::default(),
            scale: Override::default(),
            mode: VelocityMode::default(),
            smoothness: None,
            attention: false,
            braking: false,
            over: false,
            stop: Stop::No,
            state: State::Idle,
            run: None,
            end_v2: 0.0,
            board: SwitchBoard::default(),
            spans: Vec::new(),
            elements_done: 0,
            length_done: Sum::default(),
            position: 0.0,
            reached: Instant::at_ns(0),
            resume_at: 0.0,
            before: Point3::origin(),
            latest: Point3::origin(),
            bearing: Bearing::default(),
            leaves_out: false,
            record: None,
        }
    }

    /// Records the pieces of the plan from now on, with the directions of the path if the tool turns with it (`turning`).
    pub fn record(&mut self, turning: bool) {
        self.record = Some((VecDeque::new(), turning));
    }

    /// Leaves out the set-points of every motion but its first, for those who take the recorded pieces, and of cuts mostly that,
    /// too. Elements with switches and profiles without steps of the acceleration keep all of them.
    pub fn leave_out_cycles(&mut self) {
        self.leaves_out = true;
    }

    /// The next piece of the plan that is over and was recorded.
    pub fn next_piece(&mut self) -> Option<PlannedPiece> {
        self.record.as_mut()?.0.pop_front()
    }

    /// Records what the motion under way has done until `until`.
    pub(super) fn record_until(&mut self, until: impl FnOnce(&Run) -> f64) {
        if let (Some((pieces, turning)), Some(run)) = (&mut self.record, &mut self.run) {
            let heading = turning.then(|| self.bearing.latest.unwrap_or_default());
            run.record(until(run), heading, |piece| pieces.push_back(piece));
        }
    }

    /// Records what the motion under way has done until now.
    pub(super) fn record_until_now(&mut self) {
        let now_ns = self.now_ns;
        self.record_until(|run| run.start.until(now_ns));
    }

    /// The same, going on within the first element.
    pub(super) fn resuming(mut self, resume: Resume) -> Self {
        self.resume_at = resume.at;
        self.now_ns = resume.now_ns;
        self.board = resume.board;
        self.bearing = resume.bearing;
        self.length_done.add(resume.way - resume.at);
        self
    }

    /// The override in effect.
    pub fn override_factor(&self) -> Override {
        self.scale
    }

    /// Sets the inputs for the cycles to come.
    pub fn set_inputs(&mut self, inputs: Inputs) {
        self.inputs = inputs;
        self.attention = true;
    }

    /// The next set-point, under `inputs`: `Ready(None)` after the last, `Pending` as long as upstream has not given
    /// enough to begin (`IPO_INIT`). Once begun there is a set-point in every cycle; where upstream has nothing yet, the
    /// path comes to rest and waits.
    pub fn poll_cycle(&mut self, inputs: &Inputs) -> Poll<Option<Result<ToolSetpoint, E>>> {
        if *inputs != self.inputs {
            self.set_inputs(*inputs);
        }
        self.poll()
    }

    /// Brakes along the path, from the velocity of the next set-point, with each element's own deceleration
    /// (`bSlow_Stop`); one set-point at rest ends the iteration. Nothing if it has ended already.
    ///
    /// With constant acceleration the velocity stays at or below the planned one at every point of the path: the plan
    /// never decelerates by more than the element's own deceleration, so from a common start the squared velocity of
    /// braking, which falls by exactly 2·d per length, cannot lie above the planned one further on. In particular the
    /// path still stops where it was planned to.
    pub fn request_stop(&mut self) {
        if self.stop == Stop::No {
            self.stop = Stop::Requested;
            self.attention = true;
        }
    }

    /// True if a requested stop, or an abort, left a part of the path undone.
    pub fn stopped_early(&self) -> bool {
        self.stop == Stop::Early
    }

    /// True if upstream had nothing when the path could have used more (`SMC_INT_DATA_UNDERRUN`, 1003).
    pub fn starved(&self) -> bool {
        self.plan.starved()
    }

    /// True if the path would be faster now if more of it were known: see [`LookAhead::limited`]
    /// (`SMC_WAR_INT_OUTQUEUE_TOO_SMALL`, warning 1080).
    pub fn limited(&self) -> bool {
        self.plan.limited()
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
    pub(crate) fn elements_done(&self) -> u64 {
        self.elements_done
    }

    /// Mean velocity over the latest cycle as the positions show it, m/s (`dVel`).
    #[expect(clippy::cast_precision_loss, reason = "a cycle is shorter than 5 s")]
    pub fn mean_velocity(&self) -> f64 {
        (self.latest - self.before).norm() / (self.cycle_ns as f64 * 1e-9)
    }

    /// Parameters of the M function that waits to be acknowledged (`SMC_GetMParameters`, manual 6.2.10); none if none
    /// does (`bMActive`).
    pub fn m_parameters(&self) -> Option<MParameters> {
        self.run.as_ref()?.m_parameters()
    }

    fn poll(&mut self) -> Poll<Option<Result<ToolSetpoint, E>>> {
        match self.state {
            State::Active => {}
            State::Idle | State::Filling => {
                if self.inputs.abort {
                    self.state = State::Ended;
                    return Poll::Ready(None);
                }
                match self.begin() {
                    Taken::Element(element, end_velocity) => {
                        self.state = State::Active;
                        let from = std::mem::take(&mut self.resume_at);
                        self.latest = element.at(from).position;
                        let start = Instant::at_ns(self.now_ns);
                        self.enter(element, end_velocity, start, [0.0; 2]);
                        if from > 0.0 {
                            self.skip_to(start, from);
                        }
                    }
                    Taken::Failure(error) => {
                        self.state = State::Ended;
                        return Poll::Ready(Some(Err(error)));
                    }
                    Taken::NotYet => return Poll::Pending,
                    Taken::End => return Poll::Ready(None),
                }
            }
            State::Failing(_) | State::Ended => {
                return match std::mem::replace(&mut self.state, State::Ended) {
                    State::Failing(error) => Poll::Ready(Some(Err(error))),
                    _ => Poll::Ready(None),
                };
            }
        }
        Poll::Ready(self.advance().map(Ok))
    }

    /// Takes the first element, as soon as it can be set off with all speed or nothing more would fit.
    fn begin(&mut self) -> Taken<E> {
        if self.attention {
            self.adopt(0.0, 0.0, true);
        }
        if matches!(self.state, State::Filling) {
            while self.plan.pull() {}
            if !self.plan.is_full() {
                return Taken::NotYet;
            }
        }
        let taken = self.plan.take();
        if let Taken::Element(element, end_velocity) = &taken {
            let length = element.path_length();
            self.plan.plan(element, length, 0.0, *end_velocity, &mut false);
            if self.plan.starved() && self.plan.limited() && !self.plan.is_full() {
                if let Taken::Element(element, _) = taken {
                    self.plan.put_back(element);
                }
                self.state = State::Filling;
                return Taken::NotYet;
            }
        }
        taken
    }

    /// The set-point of the present cycle.
    #[inline]
    pub(super) fn sample(&mut self) -> Option<ToolSetpoint> {
        let run = self.run.as_mut()?;
        run.sampled = true;
        let state = run.state_at(self.now_ns);
        self.position = if run.done { 0.0 } else { state.position };
        self.reached = Instant::at_ns(self.now_ns);
        let status = run.status(&state);
        self.setpoint(state, status)
    }

    /// The last set-point: at rest where the run is.
    pub(super) fn finish(&mut self, reached: Instant) -> Option<ToolSetpoint> {
        self.record_until_now();
        let run = self.run.as_mut()?;
        self.reached = reached;
        if let Motion::Along { .. } | Motion::Smooth(_) = run.motion {
            run.motion = Motion::Rest { at: self.position, until_ns: i64::MIN };
        }
        if !matches!(self.state, State::Failing(_)) {
            self.state = State::Ended;
        }
        self.setpoint(PathState::resting(self.position), Status::Finished)
    }

    #[inline]
    fn setpoint(&mut self, state: PathState, status: Status) -> Option<ToolSetpoint> {
        let time_ns = self.now_ns;
        self.now_ns = self.now_ns.saturating_add(self.cycle_ns);
        let run = self.run.as_mut()?;
        let point = run.point(&state);
        let mut extra = super::ExtraMotion::default();
        if let Some(details) = run.element.details.as_ref() {
            if !run.done {
                let switches = details.switches.as_slice();
                let length = run.element.path_length();
                self.board.pass(switches, &mut run.switched, self.position, length);
            }
            extra = run.extra(&state);
        }
        let backwards = self.bearing.backwards;
        let now = run.heading(&point, &state, backwards);
        let heading = self.bearing.follow(now, || {
            if state.velocity > 0.0 {
                return None;
            }
            let here = if run.done { None } else { Heading::of_start(&run.element, backwards) };
            here.or_else(|| self.plan.find(|element| Heading::of_start(element, backwards)))
        });
        self.before = self.latest;
        self.latest = point.position;
        let m_function = if status == Status::Waiting { run.m_function() } else { None };
        Some(ToolSetpoint {
            time_ns,
            place: run.element.place,
            rapid: run.element.kind == ElementKind::Rapid,
            probing: run.element.kind.is_probe(),
            jumping: run.element.kind == ElementKind::Jump,
            status,
            last_switch: self.board.last,
            m_function,
            m_parameters: m_function.and(run.m_parameters()).unwrap_or_default(),
            switches: self.board.states,
            feed: run.element.feed,
            position: point.position,
            velocity: point.tangent * state.velocity,
            acceleration: point.curvature * (state.velocity * state.velocity)
                + point.tangent * state.acceleration,
            path_velocity: state.velocity,
            way: self.length_done.value() + self.position,
            heading,
            extra,
        })
    }
}

impl<I, E> Iterator for Interpolator<LookAhead<I, E>, E>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
{
    type Item = Result<ToolSetpoint, E>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.poll() {
            Poll::Ready(item) => item,
            // An iterator always has an answer.
            Poll::Pending => None,
        }
    }
}
