//! Block calls: calls the blocks of an axis and handles their outputs.

use super::super::Call;
use super::super::block::{Fired, With};
use super::moved::Moved;
use super::{Engine, Running, STOP, watch};
use crate::finding::{Finding, Rule};
use crate::messages::starts_on_tappets;
use twin_axis::{Language, Master, Outputs, SmcError};
use twin_cam::Trigger;

/// The block that takes its axis from a gear or cam to follow 1:1.
const PHASING: &str = "MC_Phasing";

impl Engine {
    /// Calls the blocks of an axis; at the end of the job it is halted, before its slaves read its position.
    pub(super) fn call_on(&mut self, axis: usize) -> Result<(), Box<Finding>> {
        let mut place = 0;
        // A cam that begins meanwhile adds the blocks that wait for its end, behind it.
        while let Some(index) = self.active.get(axis).and_then(|active| active.get(place)).copied()
        {
            self.call(index)?;
            place += 1;
        }
        let (calls, active) = (&self.calls, self.active.get_mut(axis));
        if let Some(active) = active {
            active.retain(|index| is_called(calls, *index));
        }
        if self.is_halting() {
            let master_moves = self.master(axis).is_some_and(|master| !master.stands());
            if let Some(moved) = self.axes.get_mut(axis) {
                moved.halt(master_moves);
            }
        }
        Ok(())
    }

    /// True if a block waits for the end of a cam, and the cam has reported it in this cycle.
    fn comes_behind_a_profile(&self, index: usize) -> bool {
        let waiting = self.calls.get(index).filter(|running| running.begun_ns.is_none());
        let cam = waiting.and_then(|waiting| self.calls.get(waiting.behind?));
        !self.is_halting() && cam.is_some_and(|cam| cam.call.block.ends_profile())
    }

    /// Calls a block, if it has begun.
    fn call(&mut self, index: usize) -> Result<(), Box<Finding>> {
        if self.comes_behind_a_profile(index) {
            self.begin(index, self.now_ns - self.cycle_ns);
        }
        let Some(running) = self.calls.get_mut(index) else { return Ok(()) };
        let Some(begun_ns) = running.begun_ns else { return Ok(()) };
        #[cfg(test)]
        {
            self.called += 1;
        }
        let first = begun_ns + self.cycle_ns == self.now_ns;
        let call = &mut running.call;
        let master = call.master.and_then(|master| self.axes.get(master));
        let master = master.map(|moved| Master::of(&moved.axis));
        let Some(moved) = self.axes.get_mut(call.axis) else { return Ok(()) };
        // A stop keeps its axis until Execute falls: at rest, so that others may move it.
        let execute = !(call.name == STOP && running.over_ns.is_some());
        let with = With { master, triggers: self.inputs.triggers() };
        let Outputs { done, command_aborted, error, busy } =
            call.block.call(execute, &mut moved.axis, with);
        if let Some(error) = error {
            return self.failed(index, error);
        }
        if let (Some(data), Some(master)) = (call.block.tappets(), call.master) {
            self.lost = self.lost.saturating_add(u64::try_from(data.lost).unwrap_or(u64::MAX));
            // The axes had their power before the job began to count.
            let (slave, later_ns) = (call.axis, self.now_ns - data.now_ns);
            let dead_time = call.block.dead_time();
            self.fired.extend(data.triggers().map(|trigger| {
                let time_ns = trigger.time_ns.saturating_add(later_ns);
                Fired { slave, master, trigger: Trigger { time_ns, ..*trigger }, dead_time }
            }));
        }
        let over = running.over_ns.is_some();
        if (done || command_aborted) && !over {
            running.over_ns = Some(self.now_ns);
            self.changed_ns = self.now_ns;
            self.schedule.over(index, self.now_ns);
            self.notes.extend(recorded(call, moved));
        }
        running.ended = running.over_ns.is_some() && !busy;
        if command_aborted && !over && !self.is_halting() {
            return self.loses(index);
        }
        if first && !command_aborted {
            self.notes.extend(self.stands_on(index));
            self.notes.extend(self.ends_a_coupling(index));
            self.takes(index)?;
            return self.refuse_endless(index);
        }
        Ok(())
    }

    /// The finding of a block's error.
    fn failed(&self, index: usize, error: SmcError) -> Result<(), Box<Finding>> {
        let Some(Running { call, .. }) = self.calls.get(index) else { return Ok(()) };
        let axis = self.name(call.axis);
        let message = format!("{} of axis {axis}: {}", call.name, message(error));
        let mut finding = call.error(Rule::FunctionBlock, axis, message);
        let more = format!("`twin explain {}` says more", error.number());
        let start = call.block.cam_start().filter(|_| error == SmcError::CiMasterOutOfScale);
        let master = call.master.and_then(|master| self.axes.get(master));
        finding.hint = Some(if error.name().ends_with("_VELACC_VALUES") {
            format!("velocity, acceleration and deceleration have to be greater than 0; {more}")
        } else if let (Some(start), Some(master)) = (start, master) {
            format!("{}; {more}", watch::outside(start, master))
        } else {
            more
        });
        Err(finding.into())
    }

    /// Note that `MC_Phasing` ends the gear or cam that its axis has followed until now.
    fn ends_a_coupling(&self, index: usize) -> Option<Finding> {
        let call = &self.calls.get(index)?.call;
        let moved = self.axes.get(call.axis)?;
        let before = &self.calls.get(moved.taken_by?)?.call;
        let (name, master) = (&moved.name, self.axes.get(call.master?)?);
        if call.name != PHASING || before.name == PHASING {
            return None;
        }
        before.master?;
        let message = format!(
            "{PHASING} ends {} of axis {name} (line {}) and couples the axis 1:1 with {}; from then on `phase_shift_{}` \
             shifts {name} against its master, ahead if it is positive",
            before.name, before.line, master.name, moved.unit
        );
        Some(call.note(name, message))
    }

    /// Note on tappets at the master's position when a cam begins.
    fn stands_on(&self, index: usize) -> Option<Finding> {
        let call = &self.calls.get(index)?.call;
        let groups = call.block.stood_on();
        let (slave, master) = (self.name(call.axis), self.name(call.master?));
        (!groups.is_empty()).then(|| starts_on_tappets(call.place(), [slave, master], &groups))
    }
}

/// Whether a block has to be called in the next cycle, too.
fn is_called(calls: &[Running], index: usize) -> bool {
    let Some(running) = calls.get(index) else { return false };
    match running.begun_ns {
        Some(_) => !running.ended,
        // A cam that its axis has left for another one does not come to its end any more.
        None => running.behind.and_then(|cam| calls.get(cam)).is_some_and(|cam| !cam.ended),
    }
}

/// Note on the position that a block has recorded.
fn recorded(call: &Call, moved: &Moved) -> Option<Finding> {
    let (position, Moved { name, unit, .. }) = (call.block.recorded()?, moved);
    let message = format!("{} has recorded axis {name} at {position:.6} {unit}", call.name);
    Some(call.note(name, message))
}

/// An error in words.
pub(super) fn message(error: SmcError) -> String {
    format!("{} ({}): {}", error.name(), error.number(), error.text(Language::English))
}
