//! Sources of set-points: the controller's own plan, a plan within the limits of the axes, and jobs.

use super::axis_limited::WithinAxes;
use crate::job::JobSetpoints;
use crate::m_function::MCall;
use crate::program::inputs::Steps;
use crate::program::{Findings, Setpoints};
use crate::setpoint_source::{MOST_OVERRIDE, PlanItem};
use crate::spindle::ToolLeft;
use std::fmt::Debug;
use std::task::Poll;
use twin_planner::planned_motion::PlannedPiece;

/// Set-points of one program, however they are planned. What a source does not know keeps its default.
pub(super) trait SetpointSource<'m>: Debug {
    /// The next item; with `waits` it is ready when this returns.
    fn poll(&mut self, waits: bool) -> Poll<Option<PlanItem>>;

    /// Bytes of the file that are done; none if the end is not known.
    fn bytes_done(&self) -> Option<u64>;

    /// Path elements (blocks of a job) decoded so far.
    fn elements(&self) -> u64;

    /// Length of the path decoded so far, m.
    fn length(&self) -> f64;

    /// Brakes along the path and ends.
    fn request_stop(&mut self);

    /// Multiplies programmed velocities by `factor`.
    fn set_override(&mut self, factor: f64);

    /// True if the last set-point follows the last override request.
    fn follows_override(&self) -> bool;

    /// The largest override that has an effect.
    fn most_override(&self) -> f64 {
        MOST_OVERRIDE
    }

    /// Single step and waiting at the next stop.
    fn set_steps(&mut self, _: Steps) {}

    /// Records the pieces of the plan from now on, with directions of the path if the tool turns with it (`turning`). False
    /// if it is not planned in pieces.
    fn record(&mut self, _turning: bool) -> bool {
        false
    }

    /// Leaves out set-points of which the pieces say everything.
    fn leave_out_cycles(&mut self) {}

    /// The next piece of the plan that is over.
    fn next_piece(&mut self) -> Option<PlannedPiece> {
        None
    }

    /// Diagnostics that were left out because there are too many.
    fn left_out(&self) -> u64 {
        0
    }

    /// The tool that an RS274 program leaves in the spindle, after all of it has been read.
    fn tool_left(&self) -> Option<ToolLeft> {
        None
    }

    /// The M function at which the path waits.
    fn m_call(&self) -> Option<MCall> {
        None
    }

    /// True if the path goes on only when it is acknowledged.
    fn waits_for_word(&self) -> bool {
        false
    }

    /// The M function is done.
    fn acknowledge(&mut self) {}

    /// True if it brakes as hard as the axes allow.
    fn is_within_axes(&self) -> bool {
        false
    }

    /// Plans that have come too late so far.
    fn late_plans(&self) -> u64 {
        0
    }

    /// The job, if it is one.
    fn job(&self) -> Option<&JobSetpoints<'m>> {
        None
    }
}

impl SetpointSource<'_> for Setpoints {
    fn poll(&mut self, _: bool) -> Poll<Option<PlanItem>> {
        Poll::Ready(self.next().map(PlanItem::from))
    }

    fn bytes_done(&self) -> Option<u64> {
        Some(self.bytes_read())
    }

    fn elements(&self) -> u64 {
        Setpoints::elements(self)
    }

    fn length(&self) -> f64 {
        Setpoints::length(self)
    }

    fn record(&mut self, turning: bool) -> bool {
        Setpoints::record(self, turning)
    }

    fn leave_out_cycles(&mut self) {
        Setpoints::leave_out_cycles(self);
    }

    fn next_piece(&mut self) -> Option<PlannedPiece> {
        Setpoints::next_piece(self)
    }

    fn request_stop(&mut self) {
        Setpoints::request_stop(self);
    }

    fn set_override(&mut self, factor: f64) {
        Setpoints::set_override(self, factor);
    }

    fn follows_override(&self) -> bool {
        Setpoints::follows_override(self)
    }

    fn set_steps(&mut self, steps: Steps) {
        Setpoints::set_steps(self, steps);
    }

    fn left_out(&self) -> u64 {
        Setpoints::left_out(self)
    }

    fn tool_left(&self) -> Option<ToolLeft> {
        Setpoints::tool_left(self)
    }

    fn m_call(&self) -> Option<MCall> {
        Setpoints::m_call(self)
    }

    fn waits_for_word(&self) -> bool {
        Setpoints::waits_for_word(self)
    }

    fn acknowledge(&mut self) {
        Setpoints::acknowledge(self);
    }
}

/// In a run within the limits of the axes nothing is known of the file.
impl<'m> SetpointSource<'m> for WithinAxes<'m> {
    fn poll(&mut self, waits: bool) -> Poll<Option<PlanItem>> {
        WithinAxes::poll(self, waits).map(|next| next.map(PlanItem::from))
    }

    fn bytes_done(&self) -> Option<u64> {
        Some(self.file().map_or(0, Findings::bytes_read))
    }

    fn elements(&self) -> u64 {
        self.file().map_or(0, Findings::elements)
    }

    fn length(&self) -> f64 {
        self.file().map_or(0.0, Findings::length)
    }

    fn record(&mut self, _turning: bool) -> bool {
        WithinAxes::record(self)
    }

    fn leave_out_cycles(&mut self) {
        WithinAxes::leave_out_cycles(self);
    }

    fn next_piece(&mut self) -> Option<PlannedPiece> {
        WithinAxes::next_piece(self)
    }

    fn request_stop(&mut self) {
        WithinAxes::request_stop(self);
    }

    fn set_override(&mut self, factor: f64) {
        WithinAxes::set_override(self, factor);
    }

    fn follows_override(&self) -> bool {
        WithinAxes::follows_override(self)
    }

    fn left_out(&self) -> u64 {
        self.file().map_or(0, Findings::left_out)
    }

    fn tool_left(&self) -> Option<ToolLeft> {
        self.file().and_then(Findings::tool_left)
    }

    fn m_call(&self) -> Option<MCall> {
        WithinAxes::m_call(self)
    }

    fn waits_for_word(&self) -> bool {
        WithinAxes::waits_for_word(self)
    }

    fn acknowledge(&mut self) {
        WithinAxes::acknowledge(self);
    }

    fn is_within_axes(&self) -> bool {
        true
    }

    fn late_plans(&self) -> u64 {
        WithinAxes::late_plans(self)
    }
}

impl<'m> SetpointSource<'m> for JobSetpoints<'m> {
    fn poll(&mut self, _: bool) -> Poll<Option<PlanItem>> {
        Poll::Ready(self.next())
    }

    fn bytes_done(&self) -> Option<u64> {
        JobSetpoints::bytes_done(self)
    }

    fn elements(&self) -> u64 {
        self.blocks()
    }

    fn length(&self) -> f64 {
        JobSetpoints::length(self)
    }

    fn request_stop(&mut self) {
        JobSetpoints::request_stop(self);
    }

    fn set_override(&mut self, factor: f64) {
        JobSetpoints::set_override(self, factor);
    }

    fn follows_override(&self) -> bool {
        JobSetpoints::follows_override(self)
    }

    fn most_override(&self) -> f64 {
        1.0
    }

    fn job(&self) -> Option<&JobSetpoints<'m>> {
        Some(self)
    }
}
