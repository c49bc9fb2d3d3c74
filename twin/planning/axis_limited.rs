//! Axis-limited planning: set-points of a program within the limits of the axes.

use crate::finding::{Finding, Rule};
use crate::limit::{LimitFailure, LimitRules, Profile, ProfileItem, not_solved};
use crate::m_function::{Acknowledgement, MCall, Waiting};
use crate::messages::unreachable;
use crate::planning::background_planner::{BackgroundPlanner, Fault};
use crate::program::{Findings, Halt, ProgramFile, ProgramItem};
use crate::setpoint_source::LEAST_OVERRIDE;
use std::io;
use std::num::NonZeroU32;
use std::sync::Arc;
use std::task::Poll;
use twin_machine::Machine;
use twin_planner::blended_path::BlendedElement;
use twin_planner::controller::{DEFAULT_CYCLE_NS, ToolSetpoint};
use twin_planner::planned_motion::PlannedPiece;
use twin_planner::time_optimal::{Follower, LimitError, Shown};

/// A program within the limits of the axes.
#[derive(Debug)]
pub(super) struct WithinAxes<'m> {
    motion: Motion<'m>,
    cycle_ns: i64,
    waiting: Waiting,
    /// The last one.
    tool: Option<ToolSetpoint>,
    /// The profile knows M functions that take their time. Those that somebody has to acknowledge take it one cycle each, and
    /// all that follows is later by what they have taken beyond that, ns.
    later_ns: i64,
}

impl<'m> WithinAxes<'m> {
    /// Planning for a check: every item is ready when it is requested.
    pub(super) fn for_check(
        machine: &'m Machine,
        program: &ProgramFile,
        rules: Acknowledgement,
    ) -> Result<Self, LimitFailure> {
        let profile = Profile::new(program, machine, LimitRules::default())?.for_check(&rules);
        Ok(Self::over(machine, Motion::Checked(Box::new(profile)), rules))
    }

    /// As it is run.
    pub(super) fn for_run(
        machine: &Machine,
        plan: BackgroundPlanner<'m>,
        rules: Acknowledgement,
    ) -> Self {
        let cycle = u32::try_from(machine.cycle_ns).ok().and_then(NonZeroU32::new);
        let follower = Follower::new(plan, cycle.unwrap_or(DEFAULT_CYCLE_NS));
        let follower = follower.with_m_times(rules.times());
        Self::over(machine, Motion::Run(Box::new(Running { follower, element: None })), rules)
    }

    fn over(machine: &Machine, motion: Motion<'m>, rules: Acknowledgement) -> Self {
        Self {
            motion,
            cycle_ns: machine.cycle_ns,
            waiting: Waiting::new(rules),
            tool: None,
            later_ns: 0,
        }
    }

    /// Records the pieces of the plan of a check; false in a run.
    pub(super) fn record(&mut self) -> bool {
        match &mut self.motion {
            Motion::Checked(profile) => {
                profile.record();
                true
            }
            Motion::Run(_) => false,
        }
    }

    /// Leaves out set-points of a check of which the pieces say everything.
    pub(super) fn leave_out_cycles(&mut self) {
        if let Motion::Checked(profile) = &mut self.motion {
            profile.show(Shown::Elements);
        }
    }

    /// The next piece of the plan of a check.
    pub(super) fn next_piece(&mut self) -> Option<PlannedPiece> {
        match &mut self.motion {
            Motion::Checked(profile) => profile.next_piece(),
            Motion::Run(_) => None,
        }
    }

    /// Known facts of the file during a check.
    pub(super) fn file(&self) -> Option<&Findings> {
        match &self.motion {
            Motion::Checked(profile) => Some(profile.file()),
            Motion::Run(_) => None,
        }
    }

    pub(super) fn m_call(&self) -> Option<MCall> {
        self.waiting.call()
    }

    pub(super) fn waits_for_word(&self) -> bool {
        self.waiting.for_word()
    }

    pub(super) fn acknowledge(&mut self) {
        self.waiting.acknowledge();
    }

    pub(super) fn request_stop(&mut self) {
        // That does not wait for an M function.
        self.waiting.acknowledge();
        if let Motion::Run(running) = &mut self.motion {
            running.follower.stop();
        }
    }

    pub(super) fn set_override(&mut self, factor: f64) {
        let factor = if factor < LEAST_OVERRIDE { 0.0 } else { factor };
        if let Motion::Run(running) = &mut self.motion {
            running.follower.set_override(factor);
        }
    }

    pub(super) fn follows_override(&self) -> bool {
        match &self.motion {
            Motion::Checked(_) => true,
            Motion::Run(running) => running.follower.plan().follows(),
        }
    }

    pub(super) fn late_plans(&self) -> u64 {
        match &self.motion {
            Motion::Checked(_) => 0,
            Motion::Run(running) => running.follower.plan().late(),
        }
    }

    /// The path rests where it is for one cycle more.
    fn wait(&mut self) -> Option<ToolSetpoint> {
        let mut tool = self.tool?;
        tool.time_ns += self.cycle_ns;
        self.later_ns += self.cycle_ns;
        self.tool = Some(tool);
        Some(tool)
    }

    /// The next item; with `waits`, or in a check, it is ready when this returns.
    pub(super) fn poll(&mut self, waits: bool) -> Poll<Option<ProgramItem>> {
        if self.waiting.for_word()
            && let Some(tool) = self.wait()
        {
            return Poll::Ready(Some(ProgramItem::Setpoint(tool)));
        }
        let next = match &mut self.motion {
            Motion::Checked(profile) => checked(profile),
            Motion::Run(running) => {
                let Poll::Ready(next) = running.poll(waits) else { return Poll::Pending };
                next
            }
        };
        Poll::Ready(next.map(|Next { item, enters }| match item {
            ProgramItem::Setpoint(mut tool) => {
                tool.time_ns += self.later_ns;
                // Two of the same number in a row are two calls all the same.
                self.waiting.observe(enters, &tool);
                self.tool = Some(tool);
                ProgramItem::Setpoint(tool)
            }
            other => other,
        }))
    }
}

/// What comes next.
#[derive(Debug)]
struct Next {
    item: ProgramItem,
    /// It is the first set-point on its element.
    enters: bool,
}

/// The motion within the limits of the axes.
#[derive(Debug)]
enum Motion<'m> {
    Checked(Box<Profile<'m>>),
    Run(Box<Running<'m>>),
}

fn checked(profile: &mut Profile<'_>) -> Option<Next> {
    loop {
        let item = match profile.next()? {
            ProfileItem::Sample(_) => match profile.tool() {
                Some(tool) => ProgramItem::Setpoint(*tool),
                None => continue,
            },
            // Whoever takes set-points finds that out itself.
            ProfileItem::Finding(finding) if finding.rule == Rule::AxisPosition => continue,
            ProfileItem::Finding(finding) => ProgramItem::Diagnostic(finding),
            ProfileItem::Io(error) => ProgramItem::Io(error),
        };
        return Some(Next { item, enters: profile.has_entered() });
    }
}

/// A plan that is executed while it is made.
#[derive(Debug)]
struct Running<'m> {
    follower: Follower<BackgroundPlanner<'m>>,
    /// The element that the last set-point is on.
    element: Option<Arc<BlendedElement>>,
}

impl Running<'_> {
    fn poll(&mut self, waits: bool) -> Poll<Option<Next>> {
        let plan = self.follower.plan_mut();
        plan.waits = waits;
        if plan.is_pending() && !waits {
            return Poll::Pending;
        }
        if let Some(finding) = plan.found() {
            return Poll::Ready(Some(Next {
                item: ProgramItem::Diagnostic(finding),
                enters: false,
            }));
        }
        let Some(next) = self.follower.next() else {
            let last = self.follower.plan_mut().found().map(ProgramItem::Diagnostic);
            return Poll::Ready(last.map(|item| Next { item, enters: false }));
        };
        Poll::Ready(Some(match next {
            Ok(followed) => {
                let enters =
                    !self.element.as_ref().is_some_and(|last| Arc::ptr_eq(last, &followed.element));
                self.element = Some(followed.element);
                Next { item: ProgramItem::Setpoint(followed.tool), enters }
            }
            Err(error) => Next { item: fault(error), enters: false },
        }))
    }
}

/// Why the path does not go on as programmed.
fn fault(error: LimitError<Fault>) -> ProgramItem {
    let diagnostic = |finding: Finding| ProgramItem::Diagnostic(finding);
    match error {
        LimitError::Upstream(halt) => match &*halt {
            Halt::Io(error) => ProgramItem::Io(io::Error::new(error.kind(), error.to_string())),
            Halt::Finding(finding) => diagnostic((**finding).clone()),
        },
        LimitError::Kinematics { element, error } => {
            diagnostic(unreachable(element.place(), &error))
        }
        LimitError::NotSolved { place, error } => diagnostic(not_solved(place, error)),
    }
}
