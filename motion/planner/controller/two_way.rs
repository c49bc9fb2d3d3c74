//! Two-way interpolation: forwards and backwards along a path held as a whole (`SMC_Interpolator2Dir`, manual 6.2.11).

use super::heading::Bearing;
use super::interpolator::Resume;
use super::{Inputs, Interpolator, IpoError, LookAhead, Override, Status, ToolSetpoint};
use std::convert::Infallible;
use std::num::{NonZeroU32, NonZeroUsize};
use std::sync::Arc;
use std::task::Poll;
use twin_path::PathElement;
use twin_path::prepare::{CheckError, CheckVelocities, CheckedElement};

/// A path prepared for both ways: what `SMC_Interpolator2Dir_SlowTask` makes.
#[derive(Clone, Debug)]
pub struct TwoWayPath {
    forwards: Arc<[CheckedElement]>,
    backwards: Arc<[CheckedElement]>,
}

impl TwoWayPath {
    /// Holds `elements`, at most `capacity` of them (`nSizeOutQueue`), and the same path from its end to its start;
    /// turns of up to `angle_tolerance` (rad, `dAngleTol`) are passed without a stop.
    ///
    /// # Errors
    /// [`IpoError::PathTooLong`], what [`CheckVelocities`] refuses, and errors from upstream.
    pub fn new<I, E>(elements: I, angle_tolerance: f64, capacity: NonZeroUsize) -> Result<Self, E>
    where
        I: Iterator<Item = Result<PathElement, E>>,
        E: From<CheckError> + From<IpoError>,
    {
        let mut forwards = Vec::new();
        for element in elements {
            if forwards.len() == capacity.get() {
                return Err(IpoError::PathTooLong { capacity: capacity.get() }.into());
            }
            forwards.push(element?);
        }
        let mut backwards = twin_path::reversed(&forwards);
        // The velocity into an element is, backwards, the one out of it.
        let entries = forwards.iter().rev().skip(1).map(|element| element.end_velocity);
        for (element, velocity) in backwards.iter_mut().zip(entries.chain([f64::INFINITY])) {
            element.end_velocity = velocity;
        }
        let check = |elements: Vec<PathElement>| {
            CheckVelocities::new(elements.into_iter().map(Ok), angle_tolerance)
                .collect::<Result<Arc<[CheckedElement]>, E>>()
        };
        Ok(Self { forwards: check(forwards)?, backwards: check(backwards)? })
    }

    fn along(&self, forwards: bool) -> &Arc<[CheckedElement]> {
        if forwards { &self.forwards } else { &self.backwards }
    }
}

/// Direction of the motion along the path (`SMC_Direction`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// `IPO_positive`: from its start to its end.
    Positive,
    /// `IPO_negative`: from its end to its start.
    Negative,
    /// `IPO_standstill`.
    Standstill,
}

/// The elements of a path from one on.
#[derive(Debug)]
struct Cursor {
    elements: Arc<[CheckedElement]>,
    next: usize,
}

impl Iterator for Cursor {
    type Item = Result<CheckedElement, Infallible>;

    fn next(&mut self) -> Option<Self::Item> {
        let element = self.elements.get(self.next)?.clone();
        self.next += 1;
        Some(Ok(element))
    }
}

/// Goes along a path in either direction, as the sign of the override says (`SMC_Interpolator2Dir`): with a knob the
/// user moves the tool to and fro.
///
/// When the sign changes the path comes to rest as by a slow stop and goes back from there. At either end it stays and
/// says so ([`Self::end_of_path`] instead of `bDone`) until it is sent back. Backwards, switches and M functions are
/// passed at the same places and act as they are written, as on any other path: the manual's reverse path is a queue
/// like the other, and nothing is said of undoing.
#[derive(Debug)]
pub struct TwoWayInterpolator {
    path: TwoWayPath,
    cycle_ns: NonZeroU32,
    forwards: bool,
    inner: Interpolator<LookAhead<Cursor, Infallible>, Infallible>,
    /// Index of the element with which the inner one began.
    first: usize,
    latest: Option<ToolSetpoint>,
    ended: bool,
    aborted: bool,
}

impl TwoWayInterpolator {
    /// At the start of `path`, with a cycle of `cycle_ns`, ns.
    pub fn new(path: TwoWayPath, cycle_ns: NonZeroU32) -> Self {
        let inner = Interpolator::new(Self::plan(&path, true, 0), cycle_ns);
        Self {
            path,
            cycle_ns,
            forwards: true,
            inner,
            first: 0,
            latest: None,
            ended: false,
            aborted: false,
        }
    }

    fn plan(path: &TwoWayPath, forwards: bool, first: usize) -> LookAhead<Cursor, Infallible> {
        let elements = Arc::clone(path.along(forwards));
        LookAhead::new(Cursor { elements, next: first })
    }

    /// The next set-point, under `inputs` and with an override whose sign is the direction (`dOverride`): its
    /// magnitude takes the place of [`Inputs::override_factor`]; less than 0.01 is a slow stop. None only for a path
    /// without elements.
    pub fn cycle(&mut self, inputs: &Inputs, velocity: f64) -> Option<ToolSetpoint> {
        let factor = Override::new(velocity.abs()).ok();
        let turns = |forwards: bool| factor.is_some() && (velocity > 0.0) != forwards;
        if turns(self.forwards) && !self.aborted && self.rests() {
            self.turn();
        }
        let slow_stop = inputs.slow_stop || factor.is_none() || turns(self.forwards);
        let inputs = Inputs { override_factor: factor.unwrap_or_default(), slow_stop, ..*inputs };
        let setpoint = match self.inner.poll_cycle(&inputs) {
            Poll::Ready(Some(Ok(setpoint))) => setpoint,
            // It stays at the end.
            Poll::Ready(None) | Poll::Pending => {
                let time_ns = self.inner.now_ns;
                self.inner.now_ns = time_ns.saturating_add(i64::from(self.cycle_ns.get()));
                ToolSetpoint { time_ns, status: Status::Finished, ..self.latest? }
            }
        };
        self.aborted = self.aborted || inputs.abort;
        self.ended = setpoint.status == Status::Finished;
        self.latest = Some(setpoint);
        Some(setpoint)
    }

    /// True if the end of the path is reached in the present direction (`bEndOfPath`).
    pub fn end_of_path(&self) -> bool {
        self.ended
    }

    /// Present direction (`nDirection`).
    pub fn direction(&self) -> Direction {
        match self.latest {
            Some(setpoint) if setpoint.path_velocity > 0.0 && self.forwards => Direction::Positive,
            Some(setpoint) if setpoint.path_velocity > 0.0 => Direction::Negative,
            _ => Direction::Standstill,
        }
    }

    /// True if it has begun and come to rest.
    fn rests(&self) -> bool {
        self.latest.is_some_and(|setpoint| {
            matches!(setpoint.status, Status::Waiting | Status::Finished)
                && setpoint.path_velocity <= 0.0
        })
    }

    /// From here back.
    fn turn(&mut self) {
        let done = usize::try_from(self.inner.elements_done()).unwrap_or(usize::MAX);
        let index = self.first.saturating_add(done);
        let at = self.inner.position;
        let (elements, count) = (self.path.along(self.forwards), self.path.forwards.len());
        // At the start of an element the way back begins with the one before.
        let (first, at) = match elements.get(index) {
            Some(element) if at > 0.0 => (count - 1 - index, element.path_length() - at),
            _ => (count.saturating_sub(index), 0.0),
        };
        self.forwards = !self.forwards;
        self.first = first;
        let resume = Resume {
            at: at.max(0.0),
            now_ns: self.inner.now_ns,
            way: self.inner.path_length(),
            board: self.inner.board,
            bearing: Bearing { backwards: !self.forwards, ..self.inner.bearing },
        };
        let plan = Self::plan(&self.path, self.forwards, first);
        self.inner = Interpolator::new(plan, self.cycle_ns).resuming(resume);
    }
}
