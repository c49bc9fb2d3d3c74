//! Axis ownership: the block that controls each axis, and the errors of a block that loses its axis.

use super::super::block::CamStart;
use super::moved::Moved;
use super::{Begins, Call, Engine, ON_TOP, STOP, SUPERIMPOSED};
use crate::finding::{Finding, Rule};
use twin_number::{seconds, significant};

/// A block that only reads its axis, and that another block may end.
const PROBE: &str = "MC_TouchProbe";

/// Blocks that release a slave of the machine file.
const RELEASES: [&str; 2] = ["MC_CamOut", "MC_GearOut"];

/// Blocks whose purpose is to take over from others.
const TAKES_OVER: [&str; 5] = ["MC_Halt", STOP, "MC_MoveAdditive", "MC_CamOut", "MC_GearOut"];

/// Hint on a cam that does not start at the position of its master (error 626).
pub(super) fn outside(start: CamStart, master: &Moved) -> String {
    let Moved { name, unit, state, .. } = master;
    let [from, to] = start.masters.map(|end| significant(end, 6));
    if start.laid {
        return format!(
            "with master_absolute = false, master_offset has to be from {from} to {to} of the cam"
        );
    }
    format!(
        "master {name} is at {} {unit}; the cam starts with it from {from} to {to} {unit}",
        significant(state.position, 6)
    )
}

/// Hint on a start without a jump, for a cam that makes its slave jump by `jump`.
fn onto(start: CamStart, axis: &str, unit: &str, jump: f64) -> String {
    let CamStart { relative, slave_offset, .. } = start;
    let lay = significant(slave_offset - jump, 6);
    let lay = format!("set `slave_offset_{unit} = {lay}`, so that the cam starts at the axis");
    let ramp = "set `start_mode = \"ramp_in\"`, so that the axis joins the cam on a ramp";
    if relative {
        let begins = significant(jump, 6);
        return format!(
            "a relative start adds the cam's value at its start, {begins} {unit}, to the position of {axis} (manual 4.6.1): {lay}; \
             or {ramp}"
        );
    }
    format!("{ramp}; or {lay}; or move the axis there first")
}

impl Engine {
    /// A block has begun, and has its axis: it must not be a slave of the machine file.
    pub(super) fn takes(&mut self, index: usize) -> Result<(), Box<Finding>> {
        let Some(call) = self.calls.get(index).map(|running| &running.call) else { return Ok(()) };
        let Some(moved) = self.axes.get_mut(call.axis) else { return Ok(()) };
        if call.name == SUPERIMPOSED {
            moved.topped_by = Some(index);
        }
        // Motion below goes on.
        if ON_TOP.contains(&call.name) {
            return Ok(());
        }
        let before = moved.taken_by.replace(index);
        let held = before.and_then(|before| self.calls.get(before)).map(|held| &held.call);
        let Some(held) = held.filter(|held| held.begins == Begins::Standing) else { return Ok(()) };
        if RELEASES.contains(&call.name) {
            return Ok(());
        }
        let master = held.master.and_then(|master| self.axes.get(master));
        let master = master.map_or("another axis", |master| &master.name);
        let (by, out) =
            if held.name == "MC_CamIn" { ("cam", "MC_CamOut") } else { ("gear", "MC_GearOut") };
        let name = self.name(call.axis);
        let message = format!(
            "{} moves axis {name}, which follows {master} by a {by} of the machine file",
            call.name
        );
        let mut finding = call.error(Rule::Coupling, name, message);
        finding.hint = Some(format!("{out} of the axis lets it go first"));
        Err(finding.into())
    }

    /// Refuses cams that make their slave jump because they begin away from its position.
    pub(super) fn refuse_jumps(&self) -> Result<(), Box<Finding>> {
        for moved in self.axes.iter().filter(|moved| moved.jumped != 0.0) {
            let taker = moved.taken_by.and_then(|taker| self.calls.get(taker));
            let Some(call) = taker.map(|taker| &taker.call) else { continue };
            if call.name != "MC_CamIn" {
                continue;
            }
            let (axis, unit, to) = (&moved.name, moved.unit, moved.state.position);
            let message = format!(
                "MC_CamIn: the cam wants {axis} at {} {unit}, it is at {} {unit}",
                significant(to, 6),
                significant(to - moved.jumped, 6)
            );
            let mut finding = call.error(Rule::Coupling, axis, message);
            let start = call.block.cam_start();
            finding.hint = start.map(|start| onto(start, axis, unit, moved.jumped));
            return Err(finding.into());
        }
        Ok(())
    }

    /// Master of an axis by the block that controls it.
    pub(super) fn master(&self, axis: usize) -> Option<&Moved> {
        let taker = self.axes.get(axis)?.taken_by?;
        self.axes.get(self.calls.get(taker)?.call.master?)
    }

    /// A block has lost its axis before it was done: fine if another one began later and was meant to take it.
    pub(super) fn loses(&self, index: usize) -> Result<(), Box<Finding>> {
        let Some(loser) = self.calls.get(index) else { return Ok(()) };
        let call = &loser.call;
        if call.name == PROBE {
            return Ok(());
        }
        let Some(moved) = self.axes.get(call.axis) else { return Ok(()) };
        // A superimposed motion ends with the motion below, and with the next one on top.
        let topped_by = moved.topped_by.filter(|_| call.name == SUPERIMPOSED);
        // Of two that began in the same cycle the one on top counts.
        let takers = moved.taken_by.into_iter().chain(topped_by).filter(|taker| *taker != index);
        let taker = takers.filter_map(|taker| self.calls.get(taker)).max_by_key(|it| it.begun_ns);
        let later = taker.is_some_and(|taker| taker.begun_ns > loser.begun_ns);
        let meant = taker.is_some_and(|taker| {
            taker.call.begins != Begins::Next || TAKES_OVER.contains(&taker.call.name)
        });
        if (later && meant) || call.begins == Begins::Standing {
            return Ok(());
        }
        let when = if later { "was done" } else { "moved" };
        let (name, axis) = (call.name, &moved.name);
        let message = match taker.map(|taker| &taker.call) {
            Some(Call { begins: Begins::Standing, name: other, .. }) => {
                format!(
                    "{name} of axis {axis} is refused while {other} of the machine file moves it"
                )
            }
            Some(Call { name: other, line, .. }) => {
                format!(
                    "{name} of axis {axis} has lost its axis to {other} (line {line}) before it {when}"
                )
            }
            None => format!(
                "{name} of axis {axis} is refused: in {:?} there is nothing it could act on",
                moved.axis.state()
            ),
        };
        let mut finding = call.error(Rule::FunctionBlock, axis, message);
        finding.hint = Some(
            "a block interrupts the motion of its axis with `at_s` or `after_s`; without them it waits for the end of the block before it on this axis"
                .to_owned(),
        );
        Err(finding.into())
    }

    /// At the end that `duration_s` sets, every block must have begun.
    pub(super) fn all_begun(&self) -> Result<(), Box<Finding>> {
        if self.unbegun == 0 {
            return Ok(());
        }
        let Some(running) = self.calls.iter().find(|running| running.begun_ns.is_none()) else {
            return Ok(());
        };
        let (call, axis) = (&running.call, self.name(running.call.axis));
        let message = format!(
            "{} of axis {axis} never begins: `duration_s` is over after {} s",
            call.name,
            self.duration_ns.map_or(0.0, seconds)
        );
        Err(call.error(Rule::FunctionBlock, axis, message).into())
    }
}
