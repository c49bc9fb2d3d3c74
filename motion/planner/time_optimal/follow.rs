//! Follower: set-points along the planned motion, one per cycle.

use super::axis_path::AxisPath;
use super::planner::{Leg, LimitError, Planned, Planner};
use crate::blended_path::{Bearing, BlendedElement};
use crate::controller::switches::SwitchBoard;
use crate::controller::{ExtraMotion, Heading, Status, ToolSetpoint};
use crate::planned_motion::Instant;
use crate::planned_motion::Progress;
use crate::planned_motion::{Law, Piece, PlannedPiece};
use std::collections::{BTreeMap, VecDeque};
use std::f64::consts::{PI, TAU};
use std::num::NonZeroU32;
use std::sync::Arc;
use twin_path::prepare::CheckedElement;
use twin_path::{ElementKind, ExtraPoint, PathPoint};

/// On curves every eighth set-point is shown where not all are.
const SPARSE: i64 = 8;

/// A set-point, and where on the course it is.
#[derive(Clone, Debug)]
pub struct Followed {
    /// The interpolator's output of the cycle.
    pub tool: ToolSetpoint,
    /// The element under way.
    pub element: Arc<BlendedElement>,
    /// The path parameter on it and its derivatives by time; its position is from the start of the element, m.
    pub progress: Progress,
}

/// Durations of M functions, in addition to the cycle that each of them takes, ns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MTimes {
    /// By their number.
    pub of: BTreeMap<u16, i64>,
    /// All others.
    pub otherwise: i64,
}

/// A plan that can be made anew from where it is executed next.
///
/// [`Planner`] is one that plans when its next item is asked for. A session with a thread for planning has one of its own that
/// hands items and calls to and fro.
pub trait Replan {
    /// [`Planner::set_override`], for what follows.
    fn set_override(&mut self, factor: f64);

    /// [`Planner::abandon`].
    fn abandon(&mut self);
}

impl<I, E, A> Replan for Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    fn set_override(&mut self, factor: f64) {
        Planner::set_override(self, factor);
    }

    fn abandon(&mut self) {
        Planner::abandon(self);
    }
}

/// Turns the planned motion into one set-point per cycle, as [`crate::controller::Interpolator`] does with unlimited
/// paths: the first is the start of the path at time 0, the last its end at the first cycle at or after the exact end time. A
/// dwell takes its time, a jump takes a cycle, and so does an M function unless [`Self::with_m_times`] says
/// otherwise.
///
/// After an error the path goes on from rest with what follows. Where it is held its set-points stay, [`Status::Waiting`].
#[derive(Debug)]
pub struct Follower<P> {
    plan: P,
    cycle_ns: i64,
    now_ns: i64,
    current: Option<Current>,
    /// When the last leg ended.
    reached: Instant,
    board: SwitchBoard,
    /// The element whose switches are being passed, and how many are.
    switching: Option<(Arc<BlendedElement>, usize)>,
    heading: Heading,
    /// Way to the start of the element under way, m.
    way: f64,
    /// The element at hand, and where on it the path comes to rest next.
    last: Option<(Arc<BlendedElement>, f64)>,
    m_times: MTimes,
    /// The path ends where it rests next.
    stopping: bool,
    over: bool,
    /// Pieces of the plan, if they are recorded.
    record: Option<VecDeque<PlannedPiece>>,
    shown: Shown,
    /// The last element that had a set-point.
    sampled: Option<Arc<BlendedElement>>,
}

/// Density of the set-points, for readers that also take the recorded pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shown {
    /// One per cycle.
    #[default]
    Cycles,
    /// Of legs where all axes move evenly the first, unless something is switched on their element.
    Legs,
    /// As with legs, but only the first of an element where all axes move evenly, and every eighth of other legs.
    Elements,
}

/// Item under way; `shown`: the leg already has a set-point.
#[derive(Debug)]
enum Current {
    Along { leg: Leg, start: Instant, end: Instant, shown: bool },
    Still { until_ns: i64 },
    Held { until_ns: i64 },
}

impl<P, E> Follower<P>
where
    P: Iterator<Item = Result<Planned, LimitError<E>>> + Replan,
{
    /// Follows `plan` with a cycle of `cycle_ns`, ns.
    pub fn new(plan: P, cycle_ns: NonZeroU32) -> Self {
        Self {
            plan,
            cycle_ns: i64::from(cycle_ns.get()),
            now_ns: 0,
            current: None,
            reached: Instant::at_ns(0),
            board: SwitchBoard::default(),
            switching: None,
            heading: Heading::default(),
            way: 0.0,
            last: None,
            m_times: MTimes::default(),
            stopping: false,
            over: false,
            record: None,
            shown: Shown::Cycles,
            sampled: None,
        }
    }

    /// Records the pieces of the plan from now on.
    pub fn record(&mut self) {
        self.record = Some(VecDeque::new());
    }

    /// Sets the density of the set-points from now on.
    pub fn show(&mut self, shown: Shown) {
        self.shown = shown;
    }

    /// The next piece of the plan that is over and was recorded.
    pub fn next_piece(&mut self) -> Option<PlannedPiece> {
        self.record.as_mut()?.pop_front()
    }

    /// With M functions that take longer than a cycle.
    #[must_use]
    pub fn with_m_times(self, m_times: MTimes) -> Self {
        Self { m_times, ..self }
    }

    /// The plan.
    pub fn plan(&self) -> &P {
        &self.plan
    }

    /// The plan.
    pub fn plan_mut(&mut self) -> &mut P {
        &mut self.plan
    }

    /// Time at which the path came to rest, s since its start.
    pub fn duration(&self) -> f64 {
        self.reached.seconds()
    }

    /// Multiplies programmed velocities by `factor`: [`Planner::set_override`]. From the item that is executed next the path
    /// brakes, or is faster, as fast as the limits of the axes allow. 0 is a feed hold: the path comes to rest as early as it can,
    /// on the path, and its set-points stay until another factor lets it go on.
    pub fn set_override(&mut self, factor: f64) {
        self.stopping = false;
        self.plan.set_override(factor);
        if let Some(Current::Held { until_ns }) = &mut self.current {
            // The path need not wait for the end of the cycle.
            *until_ns = self.now_ns;
        }
    }

    /// As an override of 0, and then the path ends where it rests. A pause that is under way ends at the next set-point.
    pub fn stop(&mut self) {
        self.set_override(0.0);
        self.stopping = true;
        if let Some(Current::Still { until_ns }) = &mut self.current {
            *until_ns = (*until_ns).min(self.now_ns);
        }
    }

    /// Takes over what comes next; false at the end.
    fn advance(&mut self) -> Result<bool, LimitError<E>> {
        let Some(next) = self.plan.next().transpose()? else { return Ok(false) };
        self.current = Some(match next {
            Planned::Leg(leg) => {
                self.enter(&leg.element, leg.from + leg.stretch.length());
                let start = self.reached;
                let end = start.after(leg.stretch.duration());
                Current::Along { end, start, leg, shown: false }
            }
            Planned::Pause(element) => {
                self.enter(&element, 0.0);
                let until_ns = self.now_ns.saturating_add(self.pause_ns(&element));
                Current::Still { until_ns }
            }
            Planned::Hold { element, at } => {
                if self.last.is_none() {
                    self.enter(&element, at);
                }
                if std::mem::take(&mut self.stopping) {
                    self.plan.abandon();
                    return Ok(false);
                }
                Current::Held { until_ns: self.now_ns.saturating_add(self.cycle_ns) }
            }
        });
        Ok(true)
    }

    /// True if a leg needs no further set-point; `shown`: it already has one.
    fn is_left_out(&self, leg: &Leg, shown: bool) -> bool {
        let sampled = || {
            let same = |last: &Arc<BlendedElement>| Arc::ptr_eq(last, &leg.element);
            leg.is_even && self.sampled.as_ref().is_some_and(same)
        };
        let enough = match self.shown {
            Shown::Cycles => false,
            Shown::Legs => shown && leg.is_even,
            Shown::Elements => shown || sampled(),
        };
        enough && leg.element.element().switches().is_empty()
    }

    /// Duration of a pause, ns.
    fn pause_ns(&self, element: &BlendedElement) -> i64 {
        match element.element().kind {
            ElementKind::Dwell { time_ns } => time_ns.max(self.cycle_ns),
            ElementKind::MFunction { number } => {
                let MTimes { of, otherwise } = &self.m_times;
                let takes = of.get(&number).copied().unwrap_or(*otherwise).max(0);
                takes.saturating_add(self.cycle_ns)
            }
            _ => self.cycle_ns,
        }
    }

    /// The element before is left behind; the path goes as far as `to` on this one, m.
    fn enter(&mut self, element: &Arc<BlendedElement>, to: f64) {
        if let Some((passed, count)) = &mut self.switching
            && !Arc::ptr_eq(passed, element)
        {
            self.board.pass_all(passed.element().switches(), count);
            self.way += passed.element().path_length();
            self.switching = None;
        }
        if self.switching.is_none() {
            self.switching = Some((Arc::clone(element), 0));
        }
        self.last = Some((Arc::clone(element), to));
    }

    fn along(&mut self, element: &Arc<BlendedElement>, progress: Progress) -> Followed {
        let status = Status::of_acceleration(progress.acceleration);
        if self.shown == Shown::Elements {
            self.sampled = Some(Arc::clone(element));
        }
        self.setpoint(element, progress, status)
    }

    fn setpoint(
        &mut self,
        element: &Arc<BlendedElement>,
        progress: Progress,
        status: Status,
    ) -> Followed {
        let Progress { position: s, velocity, acceleration, .. } = progress;
        if let Some((element, passed)) = &mut self.switching {
            self.board.pass(element.element().switches(), passed, s, element.length());
        }
        let point = element.at(s);
        let path = PathPoint {
            position: point.position,
            tangent: point.first,
            curvature: point.second,
            curvature_rate: point.third,
        };
        // Where there is no direction it stays as it was.
        let still = Heading { rate: 0.0, acceleration: 0.0, ..self.heading };
        self.heading = match element.bearing(s, &point) {
            Some(bearing) => heading(&bearing, [velocity, acceleration]),
            None => Heading::at(&path, [velocity, acceleration], false).unwrap_or(still),
        };
        let (way, path_velocity) =
            if element.is_turn() { (0.0, 0.0) } else { (s, velocity * speed(&path)) };
        let time_ns = self.now_ns;
        self.now_ns = self.now_ns.saturating_add(self.cycle_ns);
        let path_element = element.element();
        let pauses = matches!(self.current, Some(Current::Still { .. }));
        let m_function = match path_element.kind {
            ElementKind::MFunction { number } if pauses => Some(number),
            _ => None,
        };
        // As the interpolator does, a jump shows its start for a cycle; what follows begins at its end.
        let jumping = pauses && path_element.kind == ElementKind::Jump;
        let position = if jumping { path_element.start() } else { point.position };
        let extra = match path_element.extra().filter(|_| jumping) {
            Some(extra) => ExtraMotion { position: extra.start, ..ExtraMotion::default() },
            None => point.extra.map(|extra| extra_motion(&extra, &progress)).unwrap_or_default(),
        };
        let tool = ToolSetpoint {
            time_ns,
            place: element.place(),
            rapid: element.rapid(),
            probing: path_element.kind.is_probe(),
            jumping,
            status,
            last_switch: self.board.last,
            m_function,
            m_parameters: m_function.map(|_| path_element.m_parameters()).unwrap_or_default(),
            switches: self.board.states,
            feed: element.feed(),
            position,
            velocity: point.first * velocity,
            acceleration: point.second * (velocity * velocity) + point.first * acceleration,
            path_velocity,
            way: self.way + way,
            heading: self.heading,
            extra,
        };
        Followed { tool, element: Arc::clone(element), progress }
    }
}

/// Way per parameter: 1 but in blends, and where only extra axes move.
fn speed(point: &PathPoint) -> f64 {
    let speed = point.tangent.norm();
    if speed > 0.0 { speed } else { 1.0 }
}

/// Heading of the path for a velocity and acceleration of the parameter.
fn heading(bearing: &Bearing, [velocity, acceleration]: [f64; 2]) -> Heading {
    let Bearing { along, first, second, .. } = *bearing;
    // A turn may go on beyond half a turn.
    let along = if along.abs() > PI { (along + PI).rem_euclid(TAU) - PI } else { along };
    let rate = first * velocity;
    Heading { along, rate, acceleration: second * (velocity * velocity) + first * acceleration }
}

fn extra_motion(extra: &ExtraPoint, progress: &Progress) -> ExtraMotion {
    let mut motion = ExtraMotion { position: extra.position, ..ExtraMotion::default() };
    let v2 = progress.velocity * progress.velocity;
    let slots = motion.velocity.iter_mut().zip(&mut motion.acceleration);
    for ((velocity, acceleration), (first, second)) in
        slots.zip(extra.first.iter().zip(extra.second))
    {
        *velocity = first * progress.velocity;
        *acceleration = second * v2 + first * progress.acceleration;
    }
    motion
}

impl<P, E> Iterator for Follower<P>
where
    P: Iterator<Item = Result<Planned, LimitError<E>>> + Replan,
{
    type Item = Result<Followed, LimitError<E>>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.over {
            match self.current.take() {
                None => match self.advance() {
                    Ok(true) => {}
                    Ok(false) => self.over = true,
                    Err(error) => return Some(Err(error)),
                },
                Some(Current::Along { leg, start, end, shown }) => {
                    if self.is_left_out(&leg, shown) {
                        let last_ns = end.first_cycle(self.now_ns, self.cycle_ns);
                        let next_ns = self.now_ns.saturating_add((SPARSE - 1) * self.cycle_ns);
                        self.now_ns = if leg.is_even { last_ns } else { last_ns.min(next_ns) };
                    }
                    if end.reached_at(self.now_ns) {
                        self.reached = end;
                        if let Some(record) = &mut self.record {
                            let (element, duration) = (leg.element, leg.stretch.duration());
                            let law = Law::Segment(leg.stretch);
                            let piece = Piece { from: leg.from, duration, law };
                            let piece = PlannedPiece { element, start, piece };
                            if !record.back_mut().is_some_and(|last| last.take_over(&piece)) {
                                record.push_back(piece);
                            }
                        }
                        continue;
                    }
                    let mut progress = leg.stretch.at(start.until(self.now_ns));
                    progress.position += leg.from;
                    let followed = self.along(&leg.element, progress);
                    self.current = Some(Current::Along { leg, start, end, shown: true });
                    return Some(Ok(followed));
                }
                Some(Current::Still { until_ns } | Current::Held { until_ns })
                    if self.now_ns >= until_ns =>
                {
                    self.reached = Instant::at_ns(until_ns);
                }
                Some(current) => {
                    self.current = Some(current);
                    let (element, position) = self.last.clone()?;
                    let at = Progress { position, ..Progress::default() };
                    return Some(Ok(self.setpoint(&element, at, Status::Waiting)));
                }
            }
        }
        // The end, at rest.
        let (element, position) = self.last.take()?;
        let at = Progress { position, ..Progress::default() };
        Some(Ok(self.setpoint(&element, at, Status::Finished)))
    }
}
