//! End of a job: everything is done and at rest, or `duration_s` has passed.

use super::super::read::LONGEST;
use super::super::{ON_TOP, SUPERIMPOSED};
use super::moved::Moved;
use super::{Engine, Running, nanoseconds};
use crate::finding::{Finding, Rule};
use twin_axis::AxisState;
use twin_number::{seconds, significant};

/// Time at rest with nothing due after which nothing will move any more, ns.
const STUCK_NS: i64 = 1_000_000_000;

/// Longest time to come to rest after `duration_s`, s.
const LONGEST_HALT: f64 = 600.0;

impl Engine {
    pub(super) fn is_halting(&self) -> bool {
        self.duration_ns.is_some_and(|end| self.now_ns > end)
    }

    /// Result true if everything is done and at rest.
    pub(super) fn is_over(&self) -> Result<bool, Box<Finding>> {
        let stand = self.axes.iter().all(Moved::stands);
        if self.is_halting() {
            self.all_begun()?;
            return if stand { Ok(true) } else { self.halts_in_time() };
        }
        let waits = self.calls.get(self.open);
        let ends = self.duration_ns.is_some();
        if let Some(running) = waits {
            // A block that waits for a master at rest waits for ever.
            let long = self.now_ns - self.moved_ns > STUCK_NS;
            if stand && !ends && long && self.nothing_is_due() && !self.is_under_way() {
                let call = &running.call;
                let message =
                    format!("{} waits for ever: its axis and its master are at rest", call.name);
                return Err(Finding::error(Rule::FunctionBlock, call.place(), message).into());
            }
            if !stand && !ends && self.nothing_is_due() {
                self.refuse_to_wait(self.open)?;
            }
            return self.in_time();
        }
        let endless = |moved: &&Moved| moved.axis.state() == AxisState::ContinuousMotion;
        if let Some(moved) = self.axes.iter().find(endless).filter(|_| !ends && !stand) {
            let message = format!(
                "axis {} still moves with {:.3} {}/s after the last block, without end: give the job a \
                 `duration_s`, or call MC_Halt",
                moved.name, moved.state.velocity, moved.unit
            );
            return Err(Finding::error(Rule::FunctionBlock, self.place(), message).into());
        }
        if stand && !ends { Ok(true) } else { self.in_time() }
    }

    /// True if a block with a known duration is under way: its axis may rest meanwhile.
    fn is_under_way(&self) -> bool {
        self.calls.iter().any(|running| {
            let begun_ns = running.begun_ns.filter(|_| running.over_ns.is_none());
            let lasts = begun_ns.and(running.call.block.lasts()).map(nanoseconds);
            begun_ns.zip(lasts).is_some_and(|(begun, lasts)| {
                begun.saturating_add(lasts).saturating_add(STUCK_NS) >= self.now_ns
            })
        })
    }

    /// True if no block begins and no trigger comes at a later time.
    fn nothing_is_due(&self) -> bool {
        self.schedule.is_empty() && self.inputs.are_over(self.now_ns)
    }

    /// Refuses a block that would be done only after the longest time of a job, unless `duration_s` ends the job or another
    /// block may take the axis before.
    pub(super) fn refuse_endless(&self, index: usize) -> Result<(), Box<Finding>> {
        let Some(call) = self.calls.get(index).map(|running| &running.call) else { return Ok(()) };
        let begun = seconds(self.now_ns - self.cycle_ns);
        let Some(time) = call.block.lasts().filter(|time| begun + time > LONGEST) else {
            return Ok(());
        };
        let takes = |(other, running): (usize, &Running)| {
            running.begun_ns.is_none()
                && running.call.axis == call.axis
                && (!ON_TOP.contains(&running.call.name)
                    || [running.call.name, call.name] == [SUPERIMPOSED; 2])
                && !self.schedule.waits_for(index, other)
        };
        if self.duration_ns.is_some() || self.calls.iter().enumerate().any(takes) {
            return Ok(());
        }
        let name = self.name(call.axis);
        let message = format!(
            "{} of axis {name} would take {} s; the limit for a job is {LONGEST:.0} s, and what follows is not planned",
            call.name,
            significant(time, 6)
        );
        let finding = call.error(Rule::FunctionBlock, name, message);
        Err(finding.with_value(time, LONGEST, "s").into())
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
