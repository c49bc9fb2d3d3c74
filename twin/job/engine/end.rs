//! When a job is over: everything is done and stands, or waits for what never comes.

use super::super::read::LONGEST;
use super::super::{Begins, Call};
use super::Engine;
use super::moved::Moved;
use crate::finding::{Finding, Rule};
use crate::report::seconds;
use twin_motion::Place;
use twin_motion::axis::AxisState;

/// Where everything has stood for so long and nothing is due, nothing will move any more, ns.
const STUCK_NS: i64 = 1_000_000_000;

/// How long everything may take to come to rest behind `duration_s`, s.
const LONGEST_HALT: f64 = 600.0;

impl Engine {
    pub(super) fn is_halting(&self) -> bool {
        self.duration_ns.is_some_and(|end| self.now_ns > end)
    }

    /// Whether everything is done and stands.
    pub(super) fn is_over(&self) -> Result<bool, Box<Finding>> {
        let stand = self.axes.iter().all(Moved::stands);
        if self.is_halting() {
            self.all_begun()?;
            return if stand { Ok(true) } else { self.halts_in_time() };
        }
        let waits = self.calls.iter().find(|running| running.over_ns.is_none());
        let ends = self.duration_ns.is_some();
        if let Some(running) = waits {
            // A block that waits for a master that stands waits for ever.
            let long = self.now_ns - self.moved_ns > STUCK_NS;
            if stand && !ends && long && self.nothing_is_due() {
                let Call { line, name, .. } = running.call;
                let place = Place { line, block: None };
                let message = format!("{name} waits for ever: its axis and its master stand");
                return Err(Finding::error(Rule::FunctionBlock, place, message).into());
            }
            return self.in_time();
        }
        let endless = |moved: &&Moved| moved.axis.state() == AxisState::ContinuousMotion;
        if let Some(moved) = self.axes.iter().find(endless).filter(|_| !ends && !stand) {
            let message = format!(
                "axis {} still moves with {:.3} {}/s behind the last block, and nothing ends that: give the job a \
                 `duration_s`, or call MC_Halt",
                moved.name, moved.state.velocity, moved.unit
            );
            return Err(Finding::error(Rule::FunctionBlock, self.place(), message).into());
        }
        if stand && !ends { Ok(true) } else { self.in_time() }
    }

    /// Whether no block begins, and no trigger comes, by itself at a time to come.
    fn nothing_is_due(&self) -> bool {
        if !self.inputs.are_over(self.now_ns) {
            return false;
        }
        let (mut previous_begun, mut previous_over) = (true, true);
        self.calls.iter().all(|running| {
            let due = match running.call.begins {
                Begins::At(_) | Begins::Standing => true,
                Begins::WithPrevious => previous_begun,
                // By a master that moves.
                Begins::EndOfProfile => false,
                Begins::Next | Begins::After(_) => previous_over,
            };
            if running.call.begins != Begins::Standing {
                previous_begun = running.begun_ns.is_some();
                previous_over = running.over_ns.is_some();
            }
            running.begun_ns.is_some() || !due
        })
    }

    /// Behind `duration_s`, when everything comes to rest.
    fn halts_in_time(&self) -> Result<bool, Box<Finding>> {
        let over = seconds(self.now_ns - self.duration_ns.unwrap_or(0));
        let Some(moved) = self.axes.iter().find(|moved| !moved.stands()) else { return Ok(true) };
        if over <= LONGEST_HALT {
            return Ok(false);
        }
        let message = format!(
            "axis {} still moves with {:.3} {}/s {LONGEST_HALT:.0} s after `duration_s`, when everything has to come to \
             rest",
            moved.name, moved.state.velocity, moved.unit
        );
        let mut finding = Finding::error(Rule::FunctionBlock, self.place(), message);
        finding.axis = Some(moved.name.clone());
        Err(finding.into())
    }

    fn in_time(&self) -> Result<bool, Box<Finding>> {
        if seconds(self.now_ns) <= LONGEST {
            return Ok(false);
        }
        let message = format!("the job has not ended after {LONGEST:.0} s");
        Err(Finding::error(Rule::FunctionBlock, self.place(), message).into())
    }
}
