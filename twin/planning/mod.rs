//! Set-points of a program from any planner.
//!
//! As programmed, a check and a run take the same set-points. Within the limits of the axes both plan the same path by the same
//! limits; a run, which an override may change, in shorter parts.

mod axis_limited;
mod background_planner;
mod source;

use crate::bridge::{Bridge, BridgeSetpoint};
use crate::job::JobSetpoints;
use crate::limit::{LimitFailure, Limits};
use crate::m_function::{Acknowledgement, MCall};
use crate::program::inputs::Steps;
use crate::program::{Dialect, ProgramFile};
use crate::setpoint::Transformer;
use crate::setpoint_source::PlanItem;
use crate::spindle::ToolLeft;
use axis_limited::WithinAxes;
use background_planner::BackgroundPlanner;
use source::SetpointSource;
use std::task::Poll;
use std::thread::Scope;
use twin_machine::Machine;
use twin_machine::tappets::Signal;
use twin_planner::controller::ToolSetpoint;
use twin_planner::planned_motion::PlannedPiece;

/// The set-points of a program, as the controller itself plans them or within the limits of the axes.
#[derive(Debug)]
pub(crate) struct Planning<'m> {
    source: Box<dyn SetpointSource<'m> + 'm>,
    /// A gap that the axes cross, and the set-point behind it.
    gap: Option<(Bridge, ToolSetpoint)>,
    /// The path has waited so long for axes that cross gaps, ns.
    later_ns: i64,
    /// It ends here.
    ended: bool,
}

impl<'m> Planning<'m> {
    /// The program `program` on `machine`, with M functions acknowledged as `rules` say.
    ///
    /// # Errors
    /// If it cannot be opened, or the machine is none whose axes a path can be planned for.
    pub(crate) fn new(
        machine: &'m Machine,
        program: &ProgramFile,
        limits: Limits,
        rules: Acknowledgement,
    ) -> Result<Self, LimitFailure> {
        if program.dialect() == Dialect::Job {
            return Ok(Self::over(Box::new(JobSetpoints::open(machine, program)?)));
        }
        Ok(Self::over(match limits {
            Limits::Programmed => Box::new(program.open(machine, rules)?),
            Limits::Axes => Box::new(WithinAxes::for_check(machine, program, rules)?),
        }))
    }

    fn over(source: Box<dyn SetpointSource<'m> + 'm>) -> Self {
        Self { source, gap: None, later_ns: 0, ended: false }
    }

    /// As [`Self::new`], for a run, in which the override may change. If it is `paced`, planning cannot block: a
    /// background planner in a thread of `scope` then plans ahead. It ends when the planning is dropped.
    ///
    /// # Errors
    /// As [`Self::new`], and if no thread can be had.
    pub(crate) fn for_run<'scope>(
        scope: &'scope Scope<'scope, '_>,
        machine: &'m Machine,
        program: &'scope ProgramFile,
        limits: Limits,
        rules: Acknowledgement,
        paced: bool,
    ) -> Result<Self, LimitFailure>
    where
        'm: 'scope,
    {
        if limits == Limits::Programmed || program.dialect() == Dialect::Job {
            return Self::new(machine, program, limits, rules);
        }
        let plan = if paced {
            BackgroundPlanner::thread(scope, machine, program)?
        } else {
            BackgroundPlanner::here(machine, program)?
        };
        Ok(Self::over(Box::new(WithinAxes::for_run(machine, plan, rules))))
    }

    /// The next item; with `waits`, or without a background planner, it is ready when this returns.
    pub(crate) fn poll(&mut self, waits: bool) -> Poll<Option<PlanItem>> {
        if self.gap.is_some() {
            return Poll::Ready(self.cross());
        }
        if self.ended {
            return Poll::Ready(None);
        }
        let next = self.source.poll(waits);
        let Poll::Ready(Some(PlanItem::Tool(mut tool))) = next else { return next };
        tool.time_ns += self.later_ns;
        Poll::Ready(Some(PlanItem::Tool(tool)))
    }

    /// Lets the axes cross a gap before the last item, `tool`, which comes again behind it.
    pub(crate) fn bridge(&mut self, bridge: Bridge, tool: &ToolSetpoint) {
        self.gap = Some((bridge, *tool));
    }

    /// The next item on the way across a gap.
    fn cross(&mut self) -> Option<PlanItem> {
        let (bridge, tool) = self.gap.as_mut()?;
        // The set-point before the gap is a cycle before the one behind it.
        let since_ns = bridge.now_ns();
        let place = bridge.place;
        if let Some(axes) = bridge.next() {
            let time_ns = tool.time_ns + since_ns;
            return Some(PlanItem::Bridging(BridgeSetpoint { time_ns, place, axes }));
        }
        let (bridge, mut tool) = self.gap.take()?;
        if bridge.is_braked() {
            self.ended = true;
            return None;
        }
        self.later_ns += since_ns;
        tool.time_ns += since_ns;
        Some(PlanItem::Tool(tool))
    }

    /// Records the pieces of the plan from now on, with directions of the path if the tool turns with it (`turning`). False
    /// if it is not planned in pieces.
    pub(crate) fn record(&mut self, turning: bool) -> bool {
        self.source.record(turning)
    }

    /// Leaves out set-points of which the pieces say everything.
    pub(crate) fn leave_out_cycles(&mut self) {
        self.source.leave_out_cycles();
    }

    /// The next piece of the plan that is over.
    pub(crate) fn next_piece(&mut self) -> Option<PlannedPiece> {
        self.source.next_piece()
    }

    /// Signals of the tappets: the bits of the set-points in their order. Those of a path are of `transformer`.
    pub(crate) fn signals<'t>(&'t self, transformer: &'t Transformer<'_>) -> &'t [Signal] {
        self.source.job().map_or_else(|| transformer.signals(), JobSetpoints::signals)
    }

    /// Bytes of the file that are done; none if the end is not known.
    pub(crate) fn bytes_done(&self) -> Option<u64> {
        self.source.bytes_done()
    }

    /// Path elements decoded so far.
    pub(crate) fn elements(&self) -> u64 {
        self.source.elements()
    }

    /// Length of the path decoded so far, m.
    pub(crate) fn length(&self) -> f64 {
        self.source.length()
    }

    /// Diagnostics of the text that were left out because there are too many.
    pub(crate) fn left_out(&self) -> u64 {
        self.source.left_out()
    }

    /// The tool that an RS274 program leaves in the spindle, after all of it has been read.
    pub(crate) fn tool_left(&self) -> Option<ToolLeft> {
        self.source.tool_left()
    }

    /// The job, if it is one.
    pub(crate) fn job(&self) -> Option<&JobSetpoints<'m>> {
        self.source.job()
    }

    /// The M function at which the path waits at the last set-point.
    pub(crate) fn m_call(&self) -> Option<MCall> {
        if self.gap.is_some() {
            return None;
        }
        let call = self.source.m_call()?;
        Some(MCall { since_ns: call.since_ns + self.later_ns, ..call })
    }

    /// True if the path goes on only when [`Self::acknowledge`] is called.
    pub(crate) fn waits_for_word(&self) -> bool {
        self.gap.is_none() && self.source.waits_for_word()
    }

    /// The M function is done; the path goes on with the next set-point.
    pub(crate) fn acknowledge(&mut self) {
        self.source.acknowledge();
    }

    /// Asks for set-points that brake along the path and end. In a gap every axis brakes.
    pub(crate) fn request_stop(&mut self) {
        if let Some((bridge, _)) = &mut self.gap {
            bridge.brake();
        }
        self.source.request_stop();
    }

    /// Multiplies programmed velocities by `factor` from the next set-point on that can be had so; below
    /// [`LEAST_OVERRIDE`](crate::setpoint_source::LEAST_OVERRIDE) the path is held.
    pub(crate) fn set_override(&mut self, factor: f64) {
        self.source.set_override(factor);
    }

    /// Single step and waiting at the next stop from the next set-point on.
    pub(crate) fn set_steps(&mut self, steps: Steps) {
        self.source.set_steps(steps);
    }

    /// The largest override that has an effect.
    pub(crate) fn most_override(&self) -> f64 {
        self.source.most_override()
    }

    /// True if it brakes as hard as the axes allow.
    pub(crate) fn is_within_axes(&self) -> bool {
        self.source.is_within_axes()
    }

    /// True if the last set-point follows the last override request.
    pub(crate) fn follows_override(&self) -> bool {
        self.source.follows_override()
    }

    /// Plans that have come too late so far, so that the path went on as planned before.
    pub(crate) fn late_plans(&self) -> u64 {
        self.source.late_plans()
    }
}

impl Iterator for Planning<'_> {
    type Item = PlanItem;

    fn next(&mut self) -> Option<PlanItem> {
        match self.poll(true) {
            Poll::Ready(next) => next,
            Poll::Pending => None,
        }
    }
}
