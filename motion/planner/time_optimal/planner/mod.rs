//! Planner: time-optimal motion along the blended path, window by window.
//!
//! A window begins at the end of the committed motion and ends at rest: at a stop of the path, or at the end of the
//! known path. Of a window that does not end at a stop, only the part that this provisional end does not influence is
//! committed.

mod backlog;
mod budget;
mod commit;
mod drag;
mod even;
mod fallback_scaling;
mod guess;
mod line;
mod minimum_speed;
mod parallel;
mod pieces;
mod refine;
mod replan;
#[cfg(test)]
#[allow(clippy::expect_used, clippy::panic, reason = "tests")]
mod tests;
mod verify;
mod window;

use super::axis_path::AxisPath;
use super::bound::Constraint;
use super::cell::Cell;
use super::convex::NotSolved;
use super::options::LimitOptions;
use super::sample::{Sampler, grid};
use super::smooth::{Beginning, SmoothSolver};
use crate::blended_path::{BlendedElement, BlendedPath};
use crate::planned_motion::ProfileSegment;
use crate::time_optimal::sensitivity::Sensitivity;
use backlog::{Backlog, Part};
use budget::Budget;
use clarabel::solver::SolverStatus;
pub use parallel::ParallelPlanner;
pub use pieces::{Behind, Piece, Pieces, Request};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use twin_kinematics::{AxisVector, KinematicsError};
use twin_path::Place;
use twin_path::prepare::CheckedElement;

/// Leg: a part of an element and the motion through it.
#[derive(Clone, Debug)]
pub struct Leg {
    /// The element.
    pub element: Arc<BlendedElement>,
    /// Begin of the part on it, m.
    pub from: f64,
    /// Motion through it.
    pub stretch: ProfileSegment,
    /// Axis positions at its start, m or rad.
    pub start: AxisVector,
    /// True if all axes move as evenly as the path.
    pub is_even: bool,
}

impl Leg {
    /// True if the path rests at its beginning.
    pub(crate) fn begins_at_rest(&self) -> bool {
        backlog::rests(self.stretch.at_position(0.0).0)
    }

    /// True if the path rests at its end.
    pub(crate) fn ends_at_rest(&self) -> bool {
        backlog::rests(self.stretch.at_position(self.stretch.length()).0)
    }
}

/// Next item along the course: motion, pause or hold.
#[derive(Clone, Debug)]
pub enum Planned {
    /// Motion.
    Leg(Leg),
    /// Item without motion: an M function, a dwell, a jump. The path rests before it.
    Pause(Arc<BlendedElement>),
    /// The path rests until [`Planner::set_override`] lets it go on, and would go on from here. It comes again and again until then.
    Hold {
        /// The element that is next.
        element: Arc<BlendedElement>,
        /// Its place on it, m.
        at: f64,
    },
}

/// Reason why the path does not go on as programmed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LimitError<E> {
    /// An error from upstream.
    #[error(transparent)]
    Upstream(E),
    /// The machine cannot follow an element, which is left out.
    #[error("{error}")]
    Kinematics {
        /// It.
        element: Arc<BlendedElement>,
        /// Error of the kinematics.
        error: KinematicsError,
    },
    /// No profile was found for some elements, which are left out.
    #[error("{error}")]
    NotSolved {
        /// The first block.
        place: Place,
        /// Error of the solver (Clarabel).
        error: NotSolved,
    },
}

/// Effort of planning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Windows planned.
    pub windows: u64,
    /// Windows for which Clarabel came to no answer, so that another profile was taken: with limited jerk only.
    pub failed: u64,
    /// Windows in which a limit is still exceeded somewhere between the places where it was asked for, after all that was
    /// tried.
    pub exceeded: u64,
    /// Iterations of Clarabel; banded solves count by their time.
    pub iterations: u64,
    /// Cells planned, those planned again included.
    pub cells: u64,
    /// Cells committed.
    pub committed: u64,
    /// Number of replannings because of an override or a hold.
    pub replanned: u64,
    /// Number of replannings without a plan: the path then goes on for a moment as it was planned, and the next attempt
    /// is from there.
    pub not_replanned: u64,
    /// Work spent on that, in cells times iterations of Clarabel, and the most that one attempt took.
    pub replanning: u64,
    /// The most that one attempt took of it: less than twice [`Planner::MOST_WORK`].
    pub most_replanning: u64,
}

impl Effort {
    fn add(&mut self, other: &Self) {
        let sums = [
            (&mut self.windows, other.windows),
            (&mut self.failed, other.failed),
            (&mut self.exceeded, other.exceeded),
            (&mut self.iterations, other.iterations),
            (&mut self.cells, other.cells),
            (&mut self.committed, other.committed),
        ];
        for (sum, more) in sums {
            *sum += more;
        }
    }
}

/// Plans the motion along the elements of `upstream` on a machine: an iterator of [`Planned`].
#[derive(Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a state of its own")]
pub struct Planner<I, E, A> {
    course: BlendedPath<I, E>,
    sampler: Sampler<A>,
    options: LimitOptions,
    jerk_limited: bool,
    /// What is known of the path and not committed.
    cells: Vec<Cell>,
    /// b at the nodes of those of them that were planned before and stay as they are.
    kept: Vec<f64>,
    /// What the last window had planned behind what was committed of it: to rest.
    tail: Vec<Leg>,
    /// If that is the rest of a line, planned in closed form: how the axes move by the path.
    along_line: Option<AxisVector>,
    beginning: Beginning,
    /// What follows the cells, if they end at a stop.
    after: Option<After<E>>,
    near: AxisVector,
    /// What of the path was known before and is not in the cells: it comes before the rest of the course.
    returned: VecDeque<Backlog<E>>,
    ready: VecDeque<Result<Planned, LimitError<E>>>,
    /// The override that is asked for, and whether that is to be seen to.
    asked: f64,
    changed: bool,
    held: bool,
    smooth: SmoothSolver,
    effort: Effort,
    /// What is left of the work that this attempt may take.
    budget: Budget,
    /// Attempts to plan anew, since the last that was not in vain.
    misses: u32,
    /// What limits cost in the window that is being planned, and in all that was committed.
    gains: Vec<Sensitivity>,
    costs: BTreeMap<Constraint, f64>,
    over: bool,
}

#[derive(Debug)]
enum After<E> {
    /// The path goes on from rest.
    Path,
    Pause(Arc<BlendedElement>),
    Error(LimitError<E>),
    /// The path is to rest here until it is let go on.
    Hold,
    End,
}

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Plans the elements of `upstream` on the machine `axes`.
    pub fn new(upstream: I, axes: A, options: LimitOptions) -> Self {
        let near = axes.home();
        let jerk_limited = axes.limits().iter().any(|limits| limits.jerk.is_some());
        Self {
            course: BlendedPath::new(upstream, options.course),
            sampler: Sampler::new(axes, options),
            options,
            jerk_limited,
            cells: Vec::new(),
            kept: Vec::new(),
            tail: Vec::new(),
            along_line: None,
            beginning: Beginning::Rest,
            after: None,
            near,
            returned: VecDeque::new(),
            ready: VecDeque::new(),
            asked: 1.0,
            changed: false,
            held: false,
            smooth: SmoothSolver::default(),
            effort: Effort::default(),
            budget: Budget::default(),
            misses: 0,
            gains: Vec::new(),
            costs: BTreeMap::new(),
            over: false,
        }
    }

    /// Effort of planning so far.
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// Sensitivity to each limit so far: the time saved per part by which the limit were raised, s. At 20 % more it is
    /// about a fifth of that, as long as nothing else holds the path back. It may be less than 0 without jerk limits: a
    /// raised limit can lead the two passes into a slower profile.
    pub fn costs(&self) -> &BTreeMap<Constraint, f64> {
        &self.costs
    }

    /// Takes one more part of the path.
    fn pull(&mut self) {
        self.after = match self.take_next() {
            Some(Backlog::Part(part)) => self.add(&part),
            Some(Backlog::Pause(element)) => Some(After::Pause(element)),
            Some(Backlog::Error(error)) => Some(After::Error(error)),
            Some(Backlog::Hold) => Some(After::Hold),
            None => Some(After::End),
        };
    }

    /// Adds the cells of a part; what follows, if the path stops there.
    fn add(&mut self, part: &Part) -> Option<After<E>> {
        let Part { element, from, to } = part;
        let known = self.cells.len();
        match self.sampler.cells(element, *from..*to, &self.near, &mut self.cells) {
            Ok(()) => {
                self.budget.sampled(self.cells.len().saturating_sub(known));
                self.join(known);
            }
            Err(error) => {
                self.cells.truncate(known);
                let element = Arc::clone(element);
                return Some(After::Error(LimitError::Kinematics { element, error }));
            }
        }
        (part.ends() && element.stops_at_end()).then_some(After::Path)
    }

    /// Bounds the velocity at the joint before the cell `index`.
    fn join(&mut self, index: usize) {
        if let Some(last) = self.cells.last() {
            self.near = last.end.position;
        }
        if let Some((before, [after, ..])) = self.cells.split_at_mut_checked(index)
            && let Some(before) = before.last_mut()
        {
            before.joint = self.sampler.joint(&before.end, &after.start);
        }
    }

    /// Pulls elements until `horizon` s of the path are known, or a stop.
    fn fill(&mut self, horizon: f64) {
        let mut check = 16;
        while self.after.is_none() && !self.budget.is_spent() {
            if self.cells.len() >= check {
                if self.horizons().iter().sum::<f64>() >= horizon {
                    return;
                }
                check = self.cells.len() + self.cells.len() / 2;
            }
            self.pull();
        }
    }

    /// True if the path stops at the end of the window.
    fn stops(&self) -> bool {
        self.after.is_some()
    }

    /// Plans what comes next.
    fn plan(&mut self) {
        if std::mem::take(&mut self.changed) {
            self.along_line = None;
            self.replan();
            if !self.ready.is_empty() || self.held {
                return;
            }
        }
        if let Some(rates) = self.along_line {
            self.go_along_line(&rates);
            self.pass_stop();
            return;
        }
        match self.plan_window(self.options.horizon, false) {
            Ok(()) | Err(NoWindow::Slower) => {}
            Err(NoWindow::Kinematics(element, error)) => {
                self.rest_instead();
                self.ready.push_back(Err(LimitError::Kinematics { element, error }));
            }
            Err(NoWindow::NotSolved(error)) => self.fall_back(error),
        }
        self.pass_stop();
    }

    /// Plans a window of about `horizon` s and commits what can be. `exactly`: it has to begin as fast as the path is.
    fn plan_window(&mut self, mut horizon: f64, exactly: bool) -> Result<(), NoWindow> {
        loop {
            if self.budget.is_spent() {
                return Err(NoWindow::NotSolved(NOT_SOLVED));
            }
            self.fill(horizon);
            if self.cells.is_empty() {
                // What would have to come next cannot: there is only the plan so far.
                let moving = self.beginning != Beginning::Rest;
                return if moving { Err(NoWindow::NotSolved(NOT_SOLVED)) } else { Ok(()) };
            }
            if self.plan_line() {
                return Ok(());
            }
            self.cut_off(horizon).and_then(|()| self.refine())?;
            if exactly {
                // Else the motors may not be able to go on as they do.
                self.take_tangents_of_plan();
            }
            let (safe, _) = self.safe(&grid(&self.sampler, &self.cells));
            if safe == 0 {
                // All that is known is within braking distance.
                horizon *= 2.0;
                self.coarsen(self.kept.len().saturating_sub(1));
                continue;
            }
            let stretches = self.solve_verified().map_err(NoWindow::NotSolved)?;
            if (exactly || self.jerk_limited) && !window::can_be_followed(&stretches) {
                self.effort.failed += 1;
                return Err(NoWindow::NotSolved(NOT_SOLVED));
            }
            if exactly && !self.begins_with(&stretches) {
                return Err(NoWindow::Slower);
            }
            let safe = self.safe(&grid(&self.sampler, &self.cells));
            if safe.0 == 0 {
                // In shorter cells the path may have to brake earlier.
                horizon *= 2.0;
                self.coarsen(self.kept.len().saturating_sub(1));
                continue;
            }
            self.commit(&stretches, safe);
            return Ok(());
        }
    }

    /// Goes on to what follows the cells, once there are none left.
    fn pass_stop(&mut self) {
        if self.cells.is_empty()
            && let Some(after) = self.after.take()
        {
            match after {
                After::Path => {}
                After::Pause(element) => self.ready.push_back(Ok(Planned::Pause(element))),
                After::Error(error) => self.ready.push_back(Err(error)),
                After::Hold => self.held = true,
                After::End => self.over = true,
            }
        }
    }
}

/// A profile that cannot be followed.
const NOT_SOLVED: NotSolved = NotSolved { status: SolverStatus::Unsolved, iterations: 0 };

/// Why there is no plan for a window.
enum NoWindow {
    /// An element cannot be followed.
    Kinematics(Arc<BlendedElement>, KinematicsError),
    NotSolved(NotSolved),
    /// It begins slower than the path is.
    Slower,
}

impl<I, E, A> Iterator for Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    type Item = Result<Planned, LimitError<E>>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.ready.is_empty() && !self.over {
            if self.held {
                return self.hold();
            }
            self.plan();
        }
        self.ready.pop_front()
    }
}
