//! Program as a stream of path elements or set-points, with the findings on the way.

use super::inputs::{InputAt, Steps};
use super::operations::Operated;
use super::settings::ReadSettings;
use super::source::{Halt, Ledger, noticed};
use super::workpiece::ByPosition;
use crate::finding::Finding;
use crate::m_function::{Acknowledgement, MCall, Waiting};
use crate::spindle::ToolLeft;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::io;
use std::num::NonZeroU32;
use std::rc::Rc;
use std::task::Poll;
use twin_path::PathElement;
use twin_path::prepare::{CheckVelocities, Notices, PreparedPath};
use twin_planner::controller::{Inputs, Interpolator, LookAhead, Override, ToolSetpoint};
use twin_planner::planned_motion::PlannedPiece;

/// Path elements of a program.
#[derive(Debug)]
pub struct Elements {
    stage: Stage,
    notices: Notices,
    ledger: Rc<RefCell<Ledger>>,
}

impl Elements {
    pub(super) fn new(stage: Stage, notices: Notices, ledger: Rc<RefCell<Ledger>>) -> Self {
        Self { stage, notices, ledger }
    }

    /// Diagnostics of the text that were left out because there are too many.
    pub fn left_out(&self) -> u64 {
        self.ledger.borrow().left_out
    }

    /// Elements decoded so far, before anything was done to them.
    pub fn decoded(&self) -> u64 {
        self.ledger.borrow().elements
    }

    /// Known facts of the file after all of it has been read.
    pub fn facts(&self) -> Facts {
        Facts(Rc::clone(&self.ledger))
    }
}

/// Known facts of a file after all of it has been read.
#[derive(Debug)]
pub struct Facts(Rc<RefCell<Ledger>>);

/// Name and size of a program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FileFacts {
    /// The name it gives itself.
    pub name: Option<String>,
    /// Lines read; 0 if the file is not text.
    pub lines: u32,
}

impl Facts {
    /// Facts known by now.
    pub fn take(&self) -> FileFacts {
        self.0.borrow().facts.clone()
    }
}

#[derive(Debug)]
pub(super) enum Stage {
    Decoded(Box<Operated>),
    Prepared(Box<Prepared>),
}

/// The program's path, ready for look-ahead.
pub(crate) type Prepared = CheckVelocities<PreparedPath<Operated, Halt>, Halt>;

/// The next thing found: by the decoder, or by preparation.
fn found(ledger: &RefCell<Ledger>, notices: &Notices) -> Option<Finding> {
    let finding = ledger.borrow_mut().findings.pop_front();
    finding.or_else(|| notices.take().map(|notice| noticed(&notice)))
}

/// Findings of a path that another planner follows.
#[derive(Debug)]
pub(crate) struct Findings {
    notices: Notices,
    ledger: Rc<RefCell<Ledger>>,
}

impl Findings {
    pub(super) fn new(notices: Notices, ledger: Rc<RefCell<Ledger>>) -> Self {
        Self { notices, ledger }
    }

    /// The next thing found by now.
    pub(crate) fn take(&self) -> Option<Finding> {
        found(&self.ledger, &self.notices)
    }

    /// Path elements decoded so far.
    pub(crate) fn elements(&self) -> u64 {
        self.ledger.borrow().elements
    }

    /// Length of the path decoded so far, m.
    pub(crate) fn length(&self) -> f64 {
        self.ledger.borrow().length
    }

    /// Diagnostics of the text that were left out because there are too many.
    pub(crate) fn left_out(&self) -> u64 {
        self.ledger.borrow().left_out
    }

    /// The tool that an RS274 program leaves in the spindle, after all of it has been read.
    pub(crate) fn tool_left(&self) -> Option<ToolLeft> {
        self.ledger.borrow().tool
    }

    /// Bytes of the file read so far.
    pub(crate) fn bytes_read(&self) -> u64 {
        self.ledger.borrow().bytes
    }
}

/// Items of [`Elements`].
#[derive(Debug)]
pub enum ElementItem {
    /// The next element.
    Element(PathElement),
    /// Something wrong with the program; the elements after it follow.
    Diagnostic(Finding),
    /// The file cannot be read any further.
    Io(io::Error),
}

impl Iterator for Elements {
    type Item = ElementItem;

    fn next(&mut self) -> Option<ElementItem> {
        if let Some(finding) = found(&self.ledger, &self.notices) {
            return Some(ElementItem::Diagnostic(finding));
        }
        let next = match &mut self.stage {
            Stage::Decoded(decoded) => decoded.next(),
            Stage::Prepared(prepared) => prepared
                .next()
                .map(|next| next.map(twin_path::prepare::CheckedElement::into_element)),
        };
        match next {
            Some(Ok(element)) => Some(ElementItem::Element(element)),
            Some(Err(Halt::Io(error))) => Some(ElementItem::Io(error)),
            Some(Err(Halt::Finding(finding))) => Some(ElementItem::Diagnostic(*finding)),
            None => found(&self.ledger, &self.notices).map(ElementItem::Diagnostic),
        }
    }
}

/// Set-points of a program, one per cycle.
#[derive(Debug)]
pub struct Setpoints {
    motion: Motion,
    notices: Notices,
    ledger: Rc<RefCell<Ledger>>,
    inputs: Inputs,
    /// Changes of the inputs to come, in the order of time.
    changes: VecDeque<InputAt>,
    waiting: Waiting,
    now_ns: i64,
    /// Time of the next set-point.
    next_ns: i64,
    cycle_ns: i64,
}

type Planned = Interpolator<LookAhead<Prepared, Halt>, Halt>;

/// How the path is followed.
#[derive(Debug)]
pub(super) enum Motion {
    /// As programmed.
    Path(Box<Planned>),
    /// As a workpiece moves.
    Workpiece(Box<ByPosition>),
}

/// Items of [`Setpoints`].
#[derive(Debug)]
pub enum ProgramItem {
    /// The next set-point.
    Setpoint(ToolSetpoint),
    /// Something wrong with the program; the set-points after it follow the path as if the block were not there.
    Diagnostic(Finding),
    /// The file cannot be read any further.
    Io(io::Error),
}

impl Setpoints {
    pub(super) fn new(
        motion: Motion,
        (notices, ledger): (Notices, Rc<RefCell<Ledger>>),
        settings: &ReadSettings,
        cycle: NonZeroU32,
        acknowledgement: Acknowledgement,
    ) -> Self {
        let mut changes = settings.changes.clone();
        changes.sort_by_key(|change| change.time_ns);
        Self {
            motion,
            notices,
            ledger,
            inputs: settings.inputs,
            changes: changes.into(),
            waiting: Waiting::new(acknowledgement),
            now_ns: 0,
            next_ns: 0,
            cycle_ns: cycle.get().into(),
        }
    }

    /// Records the pieces of the plan from now on, with directions of the path if the tool turns with it. False if the path
    /// is not planned in pieces.
    pub(crate) fn record(&mut self, turning: bool) -> bool {
        match &mut self.motion {
            Motion::Path(path) => {
                path.record(turning);
                true
            }
            Motion::Workpiece(_) => false,
        }
    }

    /// Leaves out the set-points of every motion but its first where nothing changes on the way.
    pub(crate) fn leave_out_cycles(&mut self) {
        if let Motion::Path(path) = &mut self.motion
            && self.changes.is_empty()
        {
            path.leave_out_cycles();
        }
    }

    /// The next piece of the plan that is over.
    pub(crate) fn next_piece(&mut self) -> Option<PlannedPiece> {
        match &mut self.motion {
            Motion::Path(path) => path.next_piece(),
            Motion::Workpiece(_) => None,
        }
    }

    /// The M function at which the path waits at the last set-point.
    pub fn m_call(&self) -> Option<MCall> {
        self.waiting.call()
    }

    /// True if the path goes on only when [`Self::acknowledge`] is called.
    pub fn waits_for_word(&self) -> bool {
        self.waiting.for_word()
    }

    /// The M function is done; the path goes on with the next set-point.
    pub fn acknowledge(&mut self) {
        self.waiting.acknowledge();
    }

    /// Override, stops and single step from the next set-point on. M functions are acknowledged elsewhere.
    pub fn set_inputs(&mut self, inputs: Inputs) {
        self.inputs = inputs;
    }

    /// Single step and waiting at the next stop from the next set-point on (`bSingleStep`, `bWaitAtNextStop`). Along a
    /// workpiece they have no effect.
    pub fn set_steps(&mut self, steps: Steps) {
        let Steps { single_step, wait_at_next_stop } = steps;
        (self.inputs.single_step, self.inputs.wait_at_next_stop) = (single_step, wait_at_next_stop);
    }

    /// Multiplies programmed velocities by `factor` from the end of a ramp that is under way on; less than the least of
    /// [`Override`] holds the path.
    pub fn set_override(&mut self, factor: f64) {
        match Override::new(factor) {
            Ok(factor) => {
                self.inputs.override_factor = factor;
                self.inputs.slow_stop = false;
            }
            Err(_moves_nothing) => self.inputs.slow_stop = true,
        }
    }

    /// True if the last requested override is in effect.
    pub fn follows_override(&self) -> bool {
        match &self.motion {
            Motion::Path(path) => {
                self.inputs.slow_stop || path.override_factor() == self.inputs.override_factor
            }
            Motion::Workpiece(_) => true,
        }
    }

    /// Brakes along the path and ends.
    pub fn request_stop(&mut self) {
        match &mut self.motion {
            Motion::Path(path) => path.request_stop(),
            Motion::Workpiece(path) => path.request_stop(),
        }
    }

    /// Path elements decoded so far.
    pub fn elements(&self) -> u64 {
        self.ledger.borrow().elements
    }

    /// Length of the path decoded so far, m.
    pub fn length(&self) -> f64 {
        self.ledger.borrow().length
    }

    /// Diagnostics of the text that were left out because there are too many.
    pub fn left_out(&self) -> u64 {
        self.ledger.borrow().left_out
    }

    /// The tool that an RS274 program leaves in the spindle, after all of it has been read.
    pub(crate) fn tool_left(&self) -> Option<ToolLeft> {
        self.ledger.borrow().tool
    }

    /// Bytes of the file read so far.
    pub fn bytes_read(&self) -> u64 {
        self.ledger.borrow().bytes
    }
}

impl Iterator for Setpoints {
    type Item = ProgramItem;

    fn next(&mut self) -> Option<ProgramItem> {
        if let Some(finding) = found(&self.ledger, &self.notices) {
            return Some(ProgramItem::Diagnostic(finding));
        }
        while let Some(due) = self.changes.pop_front_if(|next| next.time_ns <= self.next_ns) {
            // An override that moves nothing has been refused before.
            due.change.apply(&mut self.inputs).unwrap_or_default();
        }
        let acknowledge_m = self.waiting.is_over(self.now_ns);
        let inputs = Inputs { acknowledge_m, ..self.inputs };
        let next = match &mut self.motion {
            Motion::Path(path) => match path.poll_cycle(&inputs) {
                Poll::Ready(next) => next,
                // A file is there at once: its stages never say that they have nothing yet.
                Poll::Pending => return None,
            },
            Motion::Workpiece(path) => {
                let next = path.next();
                if let Some(finding) = path.ending().filter(|_| next.is_none()) {
                    self.ledger.borrow_mut().report(finding);
                }
                next
            }
        };
        match next {
            Some(Ok(setpoint)) => {
                self.waiting.observe(acknowledge_m, &setpoint);
                self.now_ns = setpoint.time_ns;
                self.next_ns = setpoint.time_ns + self.cycle_ns;
                Some(ProgramItem::Setpoint(setpoint))
            }
            Some(Err(Halt::Io(error))) => Some(ProgramItem::Io(error)),
            Some(Err(Halt::Finding(finding))) => Some(ProgramItem::Diagnostic(*finding)),
            None => found(&self.ledger, &self.notices).map(ProgramItem::Diagnostic),
        }
    }
}
